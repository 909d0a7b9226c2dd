//! Mirror axes, and the one that fits a closed curve best.

use std::cmp::Ordering;

use glam::DVec2;

use super::palindromes::palindromes;
use crate::drawing::curve::{ClosedCurve, bounds};
use crate::error::{Error, Result};
use crate::geometry::segments::{SegmentGrid, nearest_on_segment};

/// Samples of the curve that an axis is fitted to.
const SAMPLES: usize = 256;
/// Rough axes that are refined.
const CANDIDATES: usize = 6;
/// What the rounding of coordinates to floats, or to six digits, may move a point, relative to the size.
const FLOATS: f64 = 1e-6;

/// A line with a direction, in the units of the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    pub(crate) point: DVec2,
    /// Of length one.
    pub(crate) direction: DVec2,
}

impl Axis {
    /// # Errors
    /// [`Error::InvalidOption`] if a number is not finite or the direction is zero.
    pub(crate) fn new(point: DVec2, direction: DVec2) -> Result<Self> {
        // Scaled first, so that no square leaves the range.
        let scaled = direction / direction.abs().max_element();
        if !point.is_finite() || !scaled.is_finite() {
            let value = format!("({}, {}), ({}, {})", point.x, point.y, direction.x, direction.y);
            let allowed = "a finite point and a finite direction that is not zero, or \"auto\"";
            return Err(Error::InvalidOption { name: "mirror", value, allowed });
        }
        Ok(Self { point, direction: scaled.normalize() })
    }

    /// Signed distance of a point: above 0 on the left.
    pub(crate) fn offset(&self, p: DVec2) -> f64 {
        self.direction.perp_dot(p - self.point)
    }

    /// The mirror image of a point.
    pub(crate) fn reflected(&self, p: DVec2) -> DVec2 {
        p - 2.0 * self.offset(p) * self.direction.perp()
    }

    /// The nearest point of the axis.
    pub(crate) fn foot(&self, p: DVec2) -> DVec2 {
        self.point + self.direction.dot(p - self.point) * self.direction
    }

    /// The axis about which a curve is most nearly its own mirror image; of several that fit as
    /// well the most upright one. As well fit all that are exact but for the rounding of doubles; then
    /// those that are but for rounding to floats; then those within the same thousandth of the size.
    ///
    /// Reflection makes a closed curve run backwards. For each of 256 offsets along the curve the
    /// best reflection of its evenly spaced points onto themselves, backwards, has a closed form.
    /// The best ones, the upright and level lines through the centroid, and of the axes about which the
    /// drawn points are each other's images the most upright one are refined against the
    /// curve itself by Gauss-Newton steps, which end exactly on the axis if there is one.
    pub(crate) fn of(curve: &ClosedCurve) -> Self {
        let samples: Vec<DVec2> =
            (0..SAMPLES).map(|i| curve.point_at(curve.length() * i as f64 / SAMPLES as f64)).collect();
        let centre = samples[0] + samples.iter().map(|&p| p - samples[0]).sum::<DVec2>() / SAMPLES as f64;
        let fit = Fit::new(curve, samples, centre);
        let mut best: Option<(f64, Axis)> = None;
        for axis in fit.candidates().into_iter().chain(fit.of_drawn_points(curve.points())) {
            let (residual, axis) = fit.refined(axis);
            let axis =
                if axis.direction.y < 0.0 { Axis { direction: -axis.direction, ..axis } } else { axis };
            let level = fit.level(residual);
            let better = best.is_none_or(|(known, other)| match level.total_cmp(&known) {
                Ordering::Less => true,
                Ordering::Equal => axis.direction.y > other.direction.y + 1e-9,
                Ordering::Greater => false,
            });
            if better {
                best = Some((level, axis));
            }
        }
        best.map_or(Axis { point: centre, direction: DVec2::Y }, |(_, axis)| axis)
    }
}

struct Fit {
    segments: Vec<[DVec2; 2]>,
    grid: SegmentGrid,
    samples: Vec<DVec2>,
    centre: DVec2,
    size: f64,
    /// What the rounding of coordinates to doubles may move a point.
    rounding: f64,
}

impl Fit {
    fn new(curve: &ClosedCurve, samples: Vec<DVec2>, centre: DVec2) -> Self {
        let segments = curve.segments();
        let (low, high) = bounds(curve.points());
        let size = low.distance(high);
        let rounding = 64.0 * f64::EPSILON * (size + low.abs().max(high.abs()).max_element());
        Self { grid: SegmentGrid::new(&segments), segments, samples, centre, size, rounding }
    }

    /// How well an axis with this root mean square distance fits: 0 exactly, 1 but for the rounding of
    /// coordinates to floats, then the thousandths of the size.
    fn level(&self, residual: f64) -> f64 {
        if residual <= self.rounding {
            0.0
        } else if residual <= FLOATS * self.size {
            1.0
        } else {
            2.0 + (residual / (1e-3 * self.size)).floor()
        }
    }

    /// Of the axes about which each drawn point is the image of another the most upright one: as exact
    /// as doubles are, and as floats are. Linear.
    fn of_drawn_points(&self, points: &[DVec2]) -> impl Iterator<Item = Axis> {
        let n = points.len();
        let along = |i: usize| points[i].distance(points[(i + 1) % n]);
        let across = |i: usize| {
            let (a, p, b) = (points[(i + n - 1) % n], points[i], points[(i + 1) % n]);
            a.distance(b).copysign((p - a).perp_dot(b - p))
        };
        // Corners and segments in turn.
        let measures: Vec<f64> =
            (0..2 * n).map(|j| if j % 2 == 0 { across(j / 2) } else { along(j / 2) }).collect();
        // Corner or segment k is its own image; what lies a quarter of the way around is far from it.
        let about = |k: usize| {
            let (p, q) = (points[(k.div_ceil(2) + n / 4) % n], points[(k / 2 + n - n / 4) % n]);
            let normal = (q - p).try_normalize()?;
            Some(Axis { point: 0.5 * (p + q), direction: normal.perp() })
        };
        let upright = |a: &Axis, b: &Axis| a.direction.y.abs().total_cmp(&b.direction.y.abs());
        let best = |near: f64| palindromes(&measures, near).into_iter().filter_map(about).max_by(upright);
        [best(self.rounding), best(FLOATS * self.size)].into_iter().flatten()
    }

    /// The upright and the level line through the centroid, then the best of those that map the
    /// samples onto themselves, best first.
    fn candidates(&self) -> Vec<Axis> {
        let n = self.samples.len();
        let around: Vec<DVec2> = self.samples.iter().map(|&p| p - self.centre).collect();
        let mut found: Vec<(f64, usize, DVec2)> = (0..n)
            .map(|k| {
                // The sum of products as complex numbers: its half angle is the axis's direction.
                let sum: DVec2 = (0..n).map(|i| around[i].rotate(around[(k + n - i) % n])).sum();
                (sum.length(), k, sum)
            })
            .collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut axes: Vec<Axis> =
            [DVec2::Y, DVec2::X].map(|direction| Axis { point: self.centre, direction }).to_vec();
        let mut taken: Vec<usize> = Vec::new();
        for (_, k, sum) in found {
            let apart = |&other: &usize| {
                let gap = k.abs_diff(other);
                gap.min(n - gap) > 2
            };
            if taken.len() < CANDIDATES && taken.iter().all(apart) {
                taken.push(k);
                axes.push(Axis { point: self.centre, direction: DVec2::from_angle(0.5 * sum.to_angle()) });
            }
        }
        axes
    }

    /// The axis moved and turned until the images of the samples lie nearest to the curve; and their
    /// root mean square distance from it.
    fn refined(&self, mut axis: Axis) -> (f64, Axis) {
        const STEPS: usize = 30;
        let mut reach = 0.1 * self.size;
        let mut best = (f64::INFINITY, axis);
        for _ in 0..STEPS {
            let normal = axis.direction.perp();
            let (mut m, mut right, mut squares) = ([[0.0; 2]; 2], [0.0; 2], 0.0);
            for &p in &self.samples {
                let image = axis.reflected(p);
                let (squared, away) = self.nearest(image, reach);
                squares += squared;
                let Some((residual, across)) = away else { continue };
                // How the residual grows with a turn of the axis and with a move to its left.
                let row = [2.0 * across.dot((image - axis.point).perp()), 2.0 * across.dot(normal)];
                for i in 0..2 {
                    right[i] -= row[i] * residual;
                    for j in 0..2 {
                        m[i][j] += row[i] * row[j];
                    }
                }
            }
            let residual = (squares / self.samples.len() as f64).sqrt();
            if residual < best.0 {
                best = (residual, axis);
            }
            reach = (4.0 * residual).clamp(1e-3 * self.size, reach);
            let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
            // About the centre of a circle all axes are alike.
            let turns = det > 1e-9 * m[0][0] * m[1][1];
            let (turn, shift) = if turns {
                (
                    (right[0] * m[1][1] - right[1] * m[0][1]) / det,
                    (right[1] * m[0][0] - right[0] * m[1][0]) / det,
                )
            } else {
                (0.0, right[1] / m[1][1])
            };
            if !(turn.is_finite() && shift.is_finite()) {
                break;
            }
            let turn = turn.clamp(-0.1, 0.1);
            axis.point += shift * normal;
            axis.direction = DVec2::from_angle(turn).rotate(axis.direction).normalize();
            if turn.abs() < 1e-16 && shift.abs() < 1e-16 * self.size {
                break;
            }
        }
        best
    }

    /// The squared distance of a point from the curve; its signed distance from the nearest segment's
    /// line and the segment's normal. Far points count as `reach` away and do not pull.
    fn nearest(&self, p: DVec2, reach: f64) -> (f64, Option<(f64, DVec2)>) {
        let mut best: Option<(f64, usize)> = None;
        self.grid.near(p - reach, p + reach, |i| {
            let [a, b] = self.segments[i];
            let squared = nearest_on_segment(p, a, b).1;
            if best.is_none_or(|(least, known)| squared < least || (squared == least && i < known)) {
                best = Some((squared, i));
            }
        });
        match best.filter(|(squared, _)| *squared <= reach * reach) {
            Some((squared, i)) => {
                let [a, b] = self.segments[i];
                let across = (b - a).perp().normalize_or_zero();
                (squared, Some((across.dot(p - a), across)))
            }
            None => (reach * reach, None),
        }
    }
}
