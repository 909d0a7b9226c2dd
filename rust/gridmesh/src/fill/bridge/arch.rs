//! Handles: tubes between loops that look the same way, which no straight tube can join.
//!
//! Such a tube leaves the surface along the normals, turns round in an arc and comes down again. Where it is to be smooth, the wall
//! of each hole goes on into it by a quarter of a circle.

use glam::DVec3;

use super::align::Ring;
use super::loft::{Curves, Edge, Rail, Spot};

/// Loops look the same way if the cosine of the angle between their normals is above this.
const ALIKE: f64 = 0.25;

/// They look at each other if both see the other one in front of them, by this cosine.
const FACING: f64 = 0.5;

/// One stands behind the other, seen along the normals, if half the difference of these cosines is above this: then an arc from
/// one to the other would go through what is around the other.
const BEHIND: f64 = 0.8;

/// Radius of the quarters of circles, in mean radii of the loop.
const FILLET: f64 = 0.35;

/// The end of the quarters is smoothed in so many rounds at most, one for each so many vertices.
const ROUNDS: usize = 4;
const VERTICES_A_ROUND: usize = 12;

/// A slope of a quarter of a circle of radius 1, as a cubic has it.
const QUARTER: f64 = 1.657;

/// Whether a tube between these loops, both as the tube runs, is a handle.
pub(super) fn is_arch(lower: &Ring, upper: &Ring) -> bool {
    let way = (upper.centre - lower.centre).normalize_or_zero();
    let (a, b) = (lower.axis.dot(way), upper.axis.dot(way));
    lower.axis.dot(upper.axis) < -ALIKE && a.min(b) < FACING && (a - b).abs() < 2.0 * BEHIND
}

/// How the tube of a handle leaves its loops.
#[derive(Clone, Debug)]
pub(super) struct Arch {
    /// Directions along the tube at its ends.
    axes: [DVec3; 2],
    /// Where the quarters of circles end, by places around the axis.
    necks: [Rail; 2],
    /// Radii of the quarters of circles, zero where the tube stands on the surface with a crease.
    radii: [f64; 2],
    /// How far the arc's curves go on as they leave, in chords.
    reach: f64,
    /// Where the quarters of circles end on the way from 0 to 1.
    knots: [f64; 2],
}

impl Arch {
    /// `pull`: see [`super::loft::Loft::new`].
    pub fn new(edges: [&Edge<'_>; 2], pull: f64) -> Arch {
        let [lower, upper] = edges.map(|edge| edge.ring);
        let chord = upper.centre - lower.centre;
        let mut angle = libm::acos(lower.axis.dot(upper.axis).clamp(-1.0, 1.0));
        if (lower.axis - upper.axis).dot(chord) < 0.0 || angle == 0.0 {
            // The ends lean away from each other.
            angle = std::f64::consts::PI;
        }
        let reach = pull * 2.0 * libm::tan(0.25 * angle) / libm::sin(0.5 * angle);
        let smooth = edges.map(|edge| edge.onward.iter().any(|&way| way != DVec3::ZERO));
        let radius = |k: usize| pull * FILLET * edges[k].ring.length / std::f64::consts::TAU;
        let radii = [0, 1].map(|k| if smooth[k] { radius(k) } else { 0.0 });
        let quarters = radii.map(|radius| radius * std::f64::consts::FRAC_PI_2);
        let arc = 0.5 * angle / libm::sin(0.5 * angle) * chord.length();
        let whole = (quarters[0] + arc + quarters[1]).max(f64::MIN_POSITIVE);
        let knots = [quarters[0] / whole, 1.0 - quarters[1] / whole];
        let neck = |k: usize, rise: DVec3| match smooth[k] {
            true => neck(edges[k], pull * FILLET, rise * radii[k]),
            false => Rail::flat(edges[k].around, edges[k].ring.points.clone()),
        };
        let necks = [neck(0, lower.axis), neck(1, -upper.axis)];
        Arch { axes: [lower.axis, upper.axis], necks, radii, reach, knots }
    }

    /// The point of the surface at a place around the axis and a height. `rails`: the loops, whose slopes are the directions
    /// in which the surface goes on.
    pub fn at(&self, rails: [&Rail; 2], around: f64, height: f64) -> Spot {
        let ([p, dp, u, du], [q, dq, v, dv]) = (rails[0].at(around), rails[1].at(around));
        let ([p1, dp1, ..], [q1, dq1, ..]) = (self.necks[0].at(around), self.necks[1].at(around));
        let [r, s] = self.radii;
        let [a, b] = self.axes;
        let [from, to] = self.knots;
        if height < from {
            let (k, slope) = (QUARTER * r, DVec3::ZERO);
            let curves =
                Curves { ends: [p, p1], along: [dp, dp1], slopes: [k * u, k * a], turns: [k * du, slope] };
            return curves.at(height, [0.0, from]);
        }
        if height > to {
            let (k, slope) = (QUARTER * s, DVec3::ZERO);
            let curves =
                Curves { ends: [q1, q], along: [dq1, dq], slopes: [k * b, -k * v], turns: [slope, -k * dv] };
            return curves.at(height, [to, 1.0]);
        }
        let way = q1 - p1;
        let (chord, change) =
            (self.reach * way.length(), self.reach * way.normalize_or_zero().dot(dq1 - dp1));
        let slopes = [chord * a, chord * b];
        let turns = [change * a, change * b];
        Curves { ends: [p1, q1], along: [dp1, dq1], slopes, turns }.at(height, [from, to])
    }
}

/// A loop drawn together towards its centre and moved along its axis, with fewer corners than it has.
fn neck(edge: &Edge<'_>, together: f64, rise: DVec3) -> Rail {
    let Ring { points, centre, axis, .. } = edge.ring;
    let n = points.len();
    let mut points = points.clone();
    for _ in 0..(n / VERTICES_A_ROUND).min(ROUNDS) {
        points = (0..n)
            .map(|k| 0.25 * (points[(k + n - 1) % n] + 2.0 * points[k] + points[(k + 1) % n]))
            .collect();
    }
    for point in &mut points {
        *point += together * (*centre - *point).reject_from_normalized(*axis) + rise;
    }
    Rail::flat(edge.around, points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle in a plane, run through as a tube runs that leaves upwards, or arrives there.
    fn circle(x: f64, leaves: bool) -> Ring {
        let at = |k: usize| {
            let t = std::f64::consts::TAU * k as f64 / 60.0;
            DVec3::new(x + t.cos(), if leaves { t.sin() } else { -t.sin() }, 0.0)
        };
        Ring::new((0..60).map(at).collect())
    }

    fn placed(ring: &Ring, by: DVec3) -> Ring {
        Ring::new(ring.points.iter().map(|&p| p + by).collect())
    }

    #[test]
    fn loops_that_look_the_same_way_are_joined_by_a_handle() {
        let (leaves, arrives) = (circle(0.0, true), circle(5.0, false));
        assert!(is_arch(&leaves, &arrives));
        assert!(is_arch(&leaves, &placed(&arrives, DVec3::Z)), "on a step");
        assert!(!is_arch(&leaves, &placed(&circle(0.0, false), 5.0 * DVec3::Z)), "one behind the other");
        assert!(!is_arch(&leaves, &circle(5.0, true)), "looking away from each other");
        assert!(!is_arch(&leaves, &placed(&circle(0.0, true), 5.0 * DVec3::Z)), "looking at each other");
    }

    #[test]
    fn a_handle_leaves_the_surface_smoothly_and_derivatives_are_those_of_its_points() {
        let (lower, upper) = (circle(0.0, true), circle(5.0, false));
        let inward = |ring: &Ring| ring.points.iter().map(|&p| ring.centre - p).collect::<Vec<_>>();
        let (below, above) = (inward(&lower), inward(&upper));
        let lower = Edge { ring: &lower, around: &lower.shares, onward: &below };
        let upper = Edge { ring: &upper, around: &upper.shares, onward: &above };
        let arch = Arch::new([&lower, &upper], 1.0);
        let rails =
            [lower, upper].map(|e| Rail::new(e.around.to_vec(), e.ring.points.clone(), e.onward.to_vec()));
        let at = |x: f64, y: f64| arch.at([&rails[0], &rails[1]], x, y);
        let d = 1e-7;
        for (x, y) in [(0.1, 0.02), (0.5, 0.5), (0.3, 0.97), (0.8, 0.3)] {
            let here = at(x, y);
            assert!(((at(x + d, y).point - here.point) / d - here.along).length() < 1e-4, "{x} {y}");
            assert!(((at(x, y + d).point - here.point) / d - here.across).length() < 1e-4, "{x} {y}");
        }
        for k in 0..12 {
            let x = f64::from(k) / 12.0;
            let [first, last] = [0.0, 1.0].map(|y| at(x, y).across.normalize());
            assert!(first.dot(rails[0].at(x)[2].normalize()) > 0.999);
            assert!(last.dot(rails[1].at(x)[2].normalize()) < -0.999);
            assert!(at(x, 0.5).point.z > 1.0, "it has room under it");
            // The parts of a curve go on into each other.
            for knot in arch.knots {
                let [before, after] = [knot - 1e-9, knot + 1e-9].map(|y| at(x, y));
                assert!(before.point.distance(after.point) < 1e-6);
                assert!(before.across.normalize().dot(after.across.normalize()) > 0.999);
            }
        }
    }
}
