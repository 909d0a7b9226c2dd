//! Where a model is thin: there the rebuilt faces stay nearer to the old ones than elsewhere, so that its two walls do not intersect.

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashMap;

use super::nearness::Facet;

/// How far the new faces may be off the old ones, in thicknesses of the model.
const SHARE: f64 = 0.05;

/// Walls face away from each other if the cosine of the angle between their normals is less.
const AWAY: f64 = -0.3;

/// For those of the old triangles (with their faces) behind which the model is thin, how far new ones may be off;
/// elsewhere `tolerance` does.
pub(in crate::cut) fn tolerances(
    vertices: &[DVec3],
    homes: &[(u32, [u32; 3])],
    tolerance: f64,
) -> FxHashMap<[u32; 3], f64> {
    let reach = tolerance / SHARE;
    let corners = homes.iter().map(|h| h.1.map(|v| vertices[v as usize])).collect::<Vec<_>>();
    let normals =
        corners.iter().map(|[a, b, c]| (b - a).cross(c - a).normalize_or_zero()).collect::<Vec<_>>();
    let boxed = |(i, [a, b, c]): (usize, &[DVec3; 3])| {
        let own = Rectangle::from_corners(a.min(*b).min(*c).to_array(), a.max(*b).max(*c).to_array());
        GeomWithData::new(own, i)
    };
    let tree = RTree::bulk_load(corners.iter().enumerate().map(boxed).collect());
    let mut found = FxHashMap::default();
    for (i, (&(_, names), &[a, b, c])) in homes.iter().zip(&corners).enumerate() {
        let (low, high) = (a.min(b).min(c) - reach, a.max(b).max(c) + reach);
        let near = tree.locate_in_envelope_intersecting(AABB::from_corners(low.to_array(), high.to_array()));
        let across = near
            .map(|other| other.data)
            .filter(|&k| normals[i].dot(normals[k]) < AWAY && !homes[k].1.iter().any(|v| names.contains(v)));
        let least = across.fold(reach, |least, k| least.min(distance(&corners[i], &corners[k], least)));
        if least < reach {
            found.insert(names, SHARE * least);
        }
    }
    found
}

/// Distance of two triangles that do not meet, if it is less than `reach`; else no less than that.
fn distance(one: &[DVec3; 3], other: &[DVec3; 3], reach: f64) -> f64 {
    let to_face = |from: &[DVec3; 3], to: &[DVec3; 3]| {
        let facet = Facet::new(*to);
        from.iter().filter_map(|&p| facet.within(p, reach)).fold(reach, f64::min)
    };
    let mut least = to_face(one, other).min(to_face(other, one));
    for k in 0..3 {
        for l in 0..3 {
            least = least.min(between([one[k], one[(k + 1) % 3]], [other[l], other[(l + 1) % 3]]));
        }
    }
    least
}

/// Distance of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
fn between([p, q]: [DVec3; 2], [r, s]: [DVec3; 2]) -> f64 {
    let (u, v, w) = (q - p, s - r, p - r);
    let (a, e, f) = (u.length_squared(), v.length_squared(), v.dot(w));
    let (b, c) = (u.dot(v), u.dot(w));
    let area = a * e - b * b;
    let mut x = if area > 1e-12 * a * e { ((b * f - c * e) / area).clamp(0.0, 1.0) } else { 0.0 };
    let mut y = (b * x + f) / e.max(f64::MIN_POSITIVE);
    if !(0.0..=1.0).contains(&y) {
        y = y.clamp(0.0, 1.0);
        x = ((b * y - c) / a.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    }
    (p + x * u).distance(r + y * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_walls_of_a_plate_are_thin() {
        let at = |z: f64| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| DVec3::new(x, y, z));
        let vertices = [at(0.0), at(0.01), at(5.0)].concat();
        // Looking down, up, and up far away.
        let homes = [(0, [0, 2, 1]), (1, [3, 4, 5]), (2, [6, 7, 8])];
        let found = tolerances(&vertices, &homes, 0.1);
        assert_eq!(found.len(), 2);
        assert!((found[&[3, 4, 5]] - SHARE * 0.01).abs() < 1e-15);
        assert!(tolerances(&vertices, &homes, 1e-4).is_empty());
    }
}
