//! The faired curve that steers the lattice path (paper, section IV-A).

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::geometry::segments::SegmentGrid;
use crate::path::placement::Lattice;

/// Spacing of the samples in lattice edges.
pub(crate) const SPACING: f64 = 0.4;
/// Standard deviation of the smoothing in lattice edges.
const SIGMA: f64 = 0.5;

/// A closed polyline in lattice units, sampled evenly along the drawn curve and faired.
///
/// Sample `i` stands for arc length `i * step` of the *drawn* curve: a parameter found on the
/// target is a parameter of the drawing. The drawing itself is never altered; the target only
/// decides which lattice path is taken.
#[derive(Clone, Debug)]
pub struct Target {
    /// The samples, in lattice units.
    pub points: Vec<DVec2>,
    /// Arc length of the drawn curve, in lattice units, from a sample to the next.
    pub step: f64,
}

impl Target {
    /// Samples the curve every 0.4 edges and smooths it by a Gaussian of half an edge.
    ///
    /// Features smaller than the lattice can show vanish, so that the path does not zigzag after
    /// them. O(length of the curve in edges + number of its points).
    pub fn new(curve: &ClosedCurve, lattice: &Lattice) -> Self {
        let length = curve.length() / lattice.edge_length;
        let n = ((length / SPACING).ceil() as usize).max(12);
        let step = length / n as f64;
        let drawn: Vec<DVec2> = curve.points().iter().map(|&p| lattice.to_units(p)).collect();
        let mut sampled = Vec::with_capacity(n);
        let mut segment = 0;
        for i in 0..n {
            let s = curve.length() * (i as f64 / n as f64);
            while segment + 1 < drawn.len() && curve.arc()[segment + 1] <= s {
                segment += 1;
            }
            let (from, to) = (curve.arc()[segment], curve.arc()[segment + 1]);
            let (a, b) = (drawn[segment], drawn[(segment + 1) % drawn.len()]);
            sampled.push(a.lerp(b, ((s - from) / (to - from)).clamp(0.0, 1.0)));
        }
        Self::faired(&sampled, step)
    }

    /// Smooths evenly spaced samples of a closed curve, in lattice units. Where they are symmetric, so is
    /// the result, to the last bit.
    pub(crate) fn faired(samples: &[DVec2], step: f64) -> Self {
        Self { points: smooth(samples, SIGMA / step), step }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Never: a target has at least twelve samples.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The end points of the segment from sample `i` (of any turn) to the next.
    pub fn segment(&self, i: usize) -> (DVec2, DVec2) {
        let n = self.points.len();
        (self.points[i % n], self.points[(i + 1) % n])
    }

    /// Pushes the walls of narrow parts outwards until they are `width` apart, where there is room.
    ///
    /// The paper widens narrow parts by fairing and gives no algorithm (section IV-A, figure 6).
    /// Ours: a wall facing another one across the inside at less than `width` moves out along its
    /// normal by half of what is missing, but by at most 0.4 of the room that it has outside. The
    /// displacement is smoothed along the curve; a few rounds let both walls give way.
    pub fn widen(&mut self, width: f64) {
        const ROUNDS: usize = 3;
        for _ in 0..ROUNDS {
            let n = self.points.len();
            let segments: Vec<[DVec2; 2]> = (0..n).map(|i| self.segment(i).into()).collect();
            let grid = SegmentGrid::new(&segments);
            let normal: Vec<DVec2> = (0..n)
                .map(|i| {
                    let tangent = self.points[(i + 1) % n] - self.points[(i + n - 1) % n];
                    -tangent.perp().normalize_or_zero()
                })
                .collect();
            let push: Vec<f64> = (0..n)
                .map(|i| {
                    let p = self.points[i];
                    let (mut inside, mut outside) = (f64::INFINITY, f64::INFINITY);
                    grid.near(p - width, p + width, |j| {
                        let q = self.points[j];
                        let offset = q - p;
                        let distance = offset.length();
                        let gap = i.abs_diff(j);
                        let along = gap.min(n - gap) as f64 * self.step;
                        // Facing walls: far along the curve, opposite normals, straight across.
                        if along < 2.0 * distance || normal[i].dot(normal[j]) > -0.3 {
                            return;
                        }
                        let across = offset.dot(normal[i]);
                        if across < -0.7 * distance {
                            inside = inside.min(distance);
                        } else if across > 0.7 * distance {
                            outside = outside.min(distance);
                        }
                    });
                    (0.5 * (width - inside)).clamp(0.0, 0.4 * outside)
                })
                .collect();
            if push.iter().all(|&d| d < 0.01) {
                break;
            }
            let moved: Vec<DVec2> = (0..n).map(|i| DVec2::new(push[i], 0.0)).collect();
            let moved = smooth(&moved, 2.0 * SIGMA / self.step);
            for i in 0..n {
                self.points[i] += moved[i].x * normal[i];
            }
        }
    }
}

/// Cyclic Gaussian smoothing; `sigma` in samples.
pub(crate) fn smooth(points: &[DVec2], sigma: f64) -> Vec<DVec2> {
    let n = points.len();
    let radius = ((3.0 * sigma).ceil() as usize).min(n / 2);
    let weights: Vec<f64> = (0..=radius).map(|k| libm::exp(-0.5 * (k as f64 / sigma).powi(2))).collect();
    let total = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    (0..n)
        .map(|i| {
            let mut sum = weights[0] * points[i];
            for (k, w) in weights.iter().enumerate().skip(1) {
                sum += *w * (points[(i + k) % n] + points[(i + n - k) % n]);
            }
            sum / total
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::curve::Winding;
    use crate::error::Result;

    fn target(points: &[DVec2]) -> Result<Target> {
        let curve = ClosedCurve::new(points, Winding::CounterClockwise, "outline")?;
        let lattice = Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 };
        Ok(Target::new(&curve, &lattice))
    }

    #[test]
    fn a_large_circle_stays_where_it_is() -> Result<()> {
        let circle: Vec<DVec2> = (0..400)
            .map(|i| 30.0 * DVec2::from_angle(f64::from(i) / 400.0 * std::f64::consts::TAU))
            .collect();
        for p in target(&circle)?.points {
            assert!((p.length() - 30.0).abs() < 0.02);
        }
        Ok(())
    }

    #[test]
    fn a_narrow_neck_becomes_wide_enough() -> Result<()> {
        let dumbbell = [[-20.0, -9.0], [-6.0, -9.0], [-6.0, -0.3], [6.0, -0.3], [6.0, -9.0], [20.0, -9.0]];
        let mut outline: Vec<DVec2> = dumbbell.iter().map(|&c| DVec2::from_array(c)).collect();
        outline.extend(dumbbell.iter().rev().map(|&[x, y]| DVec2::new(x, -y)));
        let mut target = target(&outline)?;
        let neck = |t: &Target| {
            let in_neck = |p: &&DVec2| p.x.abs() < 3.0;
            let up = t
                .points
                .iter()
                .filter(in_neck)
                .filter(|p| p.y > 0.0)
                .map(|p| p.y)
                .fold(f64::INFINITY, f64::min);
            let down = t
                .points
                .iter()
                .filter(in_neck)
                .filter(|p| p.y < 0.0)
                .map(|p| p.y)
                .fold(f64::NEG_INFINITY, f64::max);
            up - down
        };
        assert!(neck(&target) < 0.7);
        target.widen(2.3);
        assert!(neck(&target) > 2.2, "{}", neck(&target));
        Ok(())
    }
}
