//! A target drawn in from its curve, where the path of a patch with a belt should run.

use glam::DVec2;

use crate::geometry::segments::SegmentGrid;
use crate::path::target::{Target, smooth};

/// Facing walls nearer than this are looked for, in edges.
const REACH: f64 = 4.0;
/// Standard deviation of the smoothing of depths, in edges.
const SIGMA: f64 = 1.0;

impl Target {
    /// The same samples moved to the left, into the patch, by up to `depth` edges: by less where a facing wall
    /// leaves no room for one more edge between the two.
    ///
    /// Near-linear for ordinary curves.
    pub fn inset(targets: &[Target], depth: f64) -> Vec<Target> {
        let segments: Vec<[DVec2; 2]> =
            targets.iter().flat_map(|t| (0..t.len()).map(|i| t.segment(i).into())).collect();
        let grid = SegmentGrid::new(&segments);
        let normals: Vec<DVec2> = targets.iter().flat_map(normals).collect();
        let mut start = 0;
        let mut found = Vec::with_capacity(targets.len());
        for target in targets {
            let n = target.len();
            let depths: Vec<DVec2> = (0..n)
                .map(|i| {
                    let (p, normal) = (target.points[i], normals[start + i]);
                    let mut width = f64::INFINITY;
                    grid.near(p - REACH, p + REACH, |j| {
                        let offset = segments[j][0] - p;
                        let distance = offset.length();
                        // Facing walls: straight across the inside, with opposite normals, and not just ahead.
                        let ahead = if (start..start + n).contains(&j) {
                            let gap = j.abs_diff(start + i);
                            gap.min(n - gap) as f64 * target.step
                        } else {
                            f64::INFINITY
                        };
                        let faces = normal.dot(normals[j]) < -0.3 && offset.dot(normal) > 0.7 * distance;
                        if faces && ahead > 2.0 * distance {
                            width = width.min(distance);
                        }
                    });
                    DVec2::new((0.5 * (width - 1.0)).clamp(0.0, depth), 0.0)
                })
                .collect();
            let depths = smooth(&depths, SIGMA / target.step);
            let points = (0..n).map(|i| target.points[i] + depths[i].x * normals[start + i]).collect();
            found.push(Target { points, step: target.step });
            start += n;
        }
        found
    }
}

/// Unit normals to the left at the samples.
fn normals(target: &Target) -> Vec<DVec2> {
    let n = target.len();
    let ahead = |i: usize| target.points[(i + 1) % n] - target.points[(i + n - 1) % n];
    (0..n).map(|i| ahead(i).perp().normalize_or_zero()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oval(length: f64, width: f64) -> Target {
        let n = 400;
        let at = |i: usize| {
            let t = std::f64::consts::TAU * i as f64 / n as f64;
            0.5 * DVec2::new(length * t.cos(), width * t.sin())
        };
        Target { points: (0..n).map(at).collect(), step: 2.0 * length / n as f64 }
    }

    #[test]
    fn a_wide_curve_is_drawn_in_by_the_depth_and_a_thin_one_by_what_there_is_room_for() {
        let wide = &Target::inset(&[oval(30.0, 30.0)], 1.0)[0];
        assert!(wide.points.iter().all(|p| (p.length() - 14.0).abs() < 0.02));
        let thin = &Target::inset(&[oval(60.0, 2.0)], 1.0)[0];
        let middle = thin.points.iter().filter(|p| p.x.abs() < 3.0);
        assert!(middle.clone().count() > 3 && middle.clone().all(|p| (p.y.abs() - 0.5).abs() < 0.1));
    }
}
