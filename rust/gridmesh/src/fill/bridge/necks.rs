//! Tubes from holes in sheets. Beside a hole the surface goes on by a quarter of a circle into a neck, which stands on the hole, and
//! the tube goes from neck to neck by an arc. Between loops that look the same way it is a handle.

use glam::DVec3;

use super::align::Ring;
use super::rail::{Curves, Edge, Rail, Spot, ahead, arc_slope, is_pipe, is_sheet};
use crate::fill::filled::Leaving;

/// Loops look the same way if the cosine of the angle between their normals is above this.
pub(in crate::fill) const ALIKE: f64 = 0.25;

/// Loops see each other if the sum of the cosines with which each has the other one in front of it is above this, and none is
/// below the opposite; likewise behind them. Below it they lie side by side, or one in the other.
const SEEN: f64 = 0.3;

/// Loops that look the same way look at each other, too, as the walls of a valley do, if this is the cosine for both.
const FACING: f64 = 0.5;

/// One of two loops that look the same way stands behind the other if half the difference of these cosines is above this: then
/// an arc from one to the other would go through what is around the other.
const BEHIND: f64 = 0.8;

/// A tube turns by no more than this: handles between loops that look the same way are below.
const MOST: f64 = 4.6;

/// The radius of the quarters of circles, in mean radii of the loop, and at most in distances of the loops.
const FILLET: f64 = 0.35;
const SHARE: f64 = 0.3;

/// Necks are smoothed in so many rounds at most, one for each so many vertices.
const ROUNDS: usize = 4;
const VERTICES_A_ROUND: usize = 12;

/// The surface goes on into the tube along it at the lower end, against it at the upper one.
const ALONG: [f64; 2] = [1.0, -1.0];

/// The ways in which a tube between two loops with faces may leave them, the best first. Both are given as the tube runs.
pub(super) fn ways(lower: &Ring, upper: &Ring, onward: [&[DVec3]; 2]) -> Vec<Leaving> {
    let [a, b] = seen(lower, upper);
    let no_axis = lower.axis == DVec3::ZERO || upper.axis == DVec3::ZERO;
    if is_handle(lower, upper, onward) {
        vec![Leaving::Outwards]
    } else if no_axis || !onward.into_iter().any(is_sheet) {
        vec![Leaving::Direct]
    } else if a + b > SEEN && a.min(b) > -SEEN {
        vec![Leaving::Direct, Leaving::Outwards]
    } else if a + b < -SEEN && a.max(b) < SEEN {
        vec![Leaving::Direct, Leaving::Inwards]
    } else {
        vec![Leaving::Direct]
    }
}

/// Whether such a tube is a handle: no direct tube joins the loops.
pub(super) fn is_handle(lower: &Ring, upper: &Ring, onward: [&[DVec3]; 2]) -> bool {
    let [a, b] = seen(lower, upper);
    let alike = lower.axis.dot(upper.axis) < -ALIKE;
    let pipes = onward.into_iter().all(is_pipe);
    let nested = || encloses(lower, upper.centre) || encloses(upper, lower.centre);
    alike && a.min(b) < FACING && (a - b).abs() < 2.0 * BEHIND && !pipes && !nested()
}

/// Whether a loop goes around a point, seen along its axis.
fn encloses(ring: &Ring, point: DVec3) -> bool {
    let from = |k: usize| (ring.points[k % ring.points.len()] - point).reject_from_normalized(ring.axis);
    let angle = |k: usize| {
        let (a, b) = (from(k), from(k + 1));
        libm::atan2(a.cross(b).dot(ring.axis), a.dot(b))
    };
    (0..ring.points.len()).map(angle).sum::<f64>().abs() > std::f64::consts::PI
}

/// The cosines with which each of two loops has the other one in front of it.
fn seen(lower: &Ring, upper: &Ring) -> [f64; 2] {
    let way = (upper.centre - lower.centre).normalize_or_zero();
    [lower.axis.dot(way), upper.axis.dot(way)]
}

/// The curves of a tube that leaves its loops by necks.
#[derive(Clone, Debug)]
pub(super) struct Necks {
    ends: [End; 2],
    /// How far the curves between the necks go on as they leave them, in chords.
    reach: f64,
    /// Where the necks end on the way from 0 to 1.
    knots: [f64; 2],
}

/// One end of such a tube.
#[derive(Clone, Debug)]
struct End {
    /// Of the quarters of circles, zero where there are none.
    radius: f64,
    /// Where these end, and the directions along the tube there.
    neck: Rail,
}

impl Necks {
    /// `pull`: see [`super::loft::Loft::new`].
    pub fn new(edges: [&Edge<'_>; 2], inwards: bool, pull: f64) -> Necks {
        let chord = edges[1].ring.centre - edges[0].ring.centre;
        let pipes = edges.map(|edge| is_pipe(edge.onward));
        let side = if inwards { -1.0 } else { 1.0 };
        // Along the tube.
        let axes = [0, 1].map(|k| match pipes[k] {
            true => ALONG[k] * ahead(edges[k].onward).normalize(),
            false => side * edges[k].ring.axis,
        });
        // By how much the tube turns: more than half a turn where the axes lean away from each other.
        let between = libm::acos(axes[0].dot(axes[1]).clamp(-1.0, 1.0)).max(1e-3);
        let away = (axes[0] + axes[1]).dot(chord) < 0.0;
        let angle = if away { std::f64::consts::TAU - between } else { between }.min(MOST);
        let arc = 0.5 * angle / libm::sin(0.5 * angle) * chord.length();
        let means = edges.map(|edge| edge.ring.length / std::f64::consts::TAU);
        let radii = [0, 1].map(|k| match is_sheet(edges[k].onward) {
            true => pull * (FILLET * means[k]).min(SHARE * chord.length()),
            false => 0.0,
        });
        // By how much it grows wider on its way.
        let growth = (means[1] - radii[1] - means[0] + radii[0]) / arc.max(f64::MIN_POSITIVE);
        let end = |k: usize| {
            let Edge { ring, around, onward } = *edges[k];
            let points = match radii[k] > 0.0 {
                true => neck(ring, radii[k] / means[k], radii[k] * ALONG[k] * axes[k]),
                false => ring.points.clone(),
            };
            let along = |(&point, &onward): (&DVec3, &DVec3)| {
                if pipes[k] {
                    return ALONG[k] * onward;
                }
                let out = (point - ring.centre).reject_from_normalized(axes[k]).normalize_or_zero();
                (axes[k] + growth * out).normalize()
            };
            let along = points.iter().zip(onward).map(along).collect();
            End { radius: radii[k], neck: Rail::new(around.to_vec(), points, along) }
        };
        let quarters = radii.map(|radius| radius * std::f64::consts::FRAC_PI_2);
        let whole = (quarters[0] + arc + quarters[1]).max(f64::MIN_POSITIVE);
        let knots = [quarters[0] / whole, 1.0 - quarters[1] / whole];
        Necks { ends: [end(0), end(1)], reach: pull * arc_slope(angle), knots }
    }

    /// The point of the surface at a place around the axis and a height. `rails`: the loops, whose slopes are the directions
    /// in which the surface goes on.
    pub fn at(&self, rails: [&Rail; 2], around: f64, height: f64) -> Spot {
        let ([p, dp, u, du], [q, dq, v, dv]) = (rails[0].at(around), rails[1].at(around));
        let [lower, upper] = &self.ends;
        let ([p1, dp1, a, da], [q1, dq1, b, db]) = (lower.neck.at(around), upper.neck.at(around));
        let [from, to] = self.knots;
        // The slopes of a quarter of a circle.
        let quarter = std::f64::consts::SQRT_2 * arc_slope(std::f64::consts::FRAC_PI_2);
        if height < from {
            let k = quarter * lower.radius;
            let (slopes, turns) = ([k * u, k * a], [k * du, k * da]);
            return Curves { ends: [p, p1], along: [dp, dp1], slopes, turns }.at(height, [0.0, from]);
        }
        if height > to {
            let k = quarter * upper.radius;
            let (slopes, turns) = ([k * b, -k * v], [k * db, -k * dv]);
            return Curves { ends: [q1, q], along: [dq1, dq], slopes, turns }.at(height, [to, 1.0]);
        }
        let way = q1 - p1;
        let (chord, change) =
            (self.reach * way.length(), self.reach * way.normalize_or_zero().dot(dq1 - dp1));
        let turns = [change * a + chord * da, change * b + chord * db];
        Curves { ends: [p1, q1], along: [dp1, dq1], slopes: [chord * a, chord * b], turns }
            .at(height, [from, to])
    }
}

/// A loop drawn together towards its centre and moved, with fewer corners than it has.
fn neck(ring: &Ring, together: f64, rise: DVec3) -> Vec<DVec3> {
    let n = ring.points.len();
    let mut points = ring.points.clone();
    for _ in 0..(n / VERTICES_A_ROUND).min(ROUNDS) {
        points = (0..n)
            .map(|k| 0.25 * (points[(k + n - 1) % n] + 2.0 * points[k] + points[(k + 1) % n]))
            .collect();
    }
    for point in &mut points {
        *point += together * (ring.centre - *point).reject_from(rise) + rise;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle in a plane, run through as a tube runs that leaves it upwards, or arrives there from above.
    fn circle(centre: DVec3, leaves: bool) -> Ring {
        let at = |k: usize| {
            let t = std::f64::consts::TAU * k as f64 / 60.0;
            centre + DVec3::new(t.cos(), if leaves { t.sin() } else { -t.sin() }, 0.0)
        };
        Ring::new((0..60).map(at).collect())
    }

    fn inward(ring: &Ring) -> Vec<DVec3> {
        ring.points.iter().map(|&p| ring.centre - p).collect()
    }

    #[test]
    fn the_side_is_that_on_which_the_other_loop_is() {
        let (here, beside, above) = (DVec3::ZERO, 5.0 * DVec3::X, 5.0 * DVec3::Z);
        let lower = circle(here, true);
        let to = |upper: &Ring| ways(&lower, upper, [&inward(&lower), &inward(upper)]);
        assert_eq!(to(&circle(beside, false)), [Leaving::Outwards], "a handle");
        assert_eq!(to(&circle(beside + DVec3::Z, false)), [Leaving::Outwards], "up a step");
        assert_eq!(to(&circle(0.5 * DVec3::X, false)), [Leaving::Direct], "one in the other");
        assert_eq!(to(&circle(above, true)), [Leaving::Direct, Leaving::Outwards]);
        assert_eq!(to(&circle(-above, true)), [Leaving::Direct, Leaving::Inwards], "through a plate");
        assert_eq!(to(&circle(above, false)), [Leaving::Direct], "one behind the other");
        assert_eq!(to(&circle(beside, true)), [Leaving::Direct], "side by side, one turned over");
        let (up, down) = (vec![DVec3::Z; 60], vec![-DVec3::Z; 60]);
        assert_eq!(ways(&lower, &circle(above, true), [&up, &down]), [Leaving::Direct], "pipes");
    }

    #[test]
    fn a_handle_leaves_the_surface_smoothly_and_derivatives_are_those_of_its_points() {
        let (lower, upper) = (circle(DVec3::ZERO, true), circle(5.0 * DVec3::X, false));
        let (below, above) = (inward(&lower), inward(&upper));
        let lower = Edge { ring: &lower, around: &lower.shares, onward: &below };
        let upper = Edge { ring: &upper, around: &upper.shares, onward: &above };
        let necks = Necks::new([&lower, &upper], false, 1.0);
        let rail = |e: &Edge<'_>| Rail::new(e.around.to_vec(), e.ring.points.clone(), e.onward.to_vec());
        let rails = [rail(&lower), rail(&upper)];
        let at = |x: f64, y: f64| necks.at([&rails[0], &rails[1]], x, y);
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
            for knot in necks.knots {
                let [before, after] = [knot - 1e-9, knot + 1e-9].map(|y| at(x, y));
                assert!(before.point.distance(after.point) < 1e-6);
                assert!(before.across.normalize().dot(after.across.normalize()) > 0.999);
            }
        }
    }
}
