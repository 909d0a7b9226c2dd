//! The sharpest corners of a patch.

use glam::DVec2;

use crate::patch::Patch;

/// Smallest angle of any triangle, in radians; of quads the smallest corner, or what the largest one is short of
/// pi, if that is less.
pub(crate) fn min_angle(patch: &Patch) -> f64 {
    sharpest(patch, |_| true)
}

/// Smallest angle of the triangles that have no vertex on a corner of the drawing, in radians: what
/// the placement answers for.
pub(crate) fn min_angle_off_corners(patch: &Patch) -> f64 {
    let mut on_corner = vec![false; patch.vertices.len()];
    for l in &patch.loops {
        for (flag, &turning) in on_corner[l.start as usize..].iter_mut().zip(&l.corner) {
            *flag = turning != 0.0;
        }
    }
    sharpest(patch, |t| t.iter().all(|&v| !on_corner[v as usize]))
}

fn sharpest(patch: &Patch, counts: impl Fn(&[u32; 3]) -> bool) -> f64 {
    // The cotangent of the least angle.
    let mut most = -f64::INFINITY;
    // Seen from a corner of a quad: the angle between its sides, or between one and the other drawn on.
    let bent = |a: DVec2, b: DVec2| a.dot(b).abs() / a.perp_dot(b);
    for q in patch.quads.iter() {
        let p = q.map(|v| patch.vertices[v as usize]);
        for k in 0..4 {
            let [last, own, next] = [3, 0, 1].map(|ahead| (k + ahead) % 4);
            if counts(&[q[last], q[own], q[next]]) {
                most = most.max(bent(p[next] - p[own], p[last] - p[own]));
            }
        }
    }
    for t in patch.triangles.iter().filter(|t| counts(t)) {
        let p = t.map(|v| patch.vertices[v as usize]);
        let [a, b, c] = [p[2] - p[1], p[0] - p[2], p[1] - p[0]];
        let dot = (-a.dot(b)).max(-b.dot(c)).max(-c.dot(a));
        most = most.max(dot / a.perp_dot(b));
    }
    libm::atan2(1.0, most)
}
