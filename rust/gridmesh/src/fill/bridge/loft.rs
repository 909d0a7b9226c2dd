//! The surface of a bridge: curves from one loop to the other that leave both as the surroundings come.

use glam::DVec3;

use super::necks::Necks;
use super::rail::{Curves, Edge, Rail, Spot, ahead, arc_slope, is_pipe};
use crate::fill::filled::Leaving;

/// Where a curve leaves its loop it bends within this many mean radii of the loop, so that a tube between
/// parallel sheets does not close in its middle. Between ends of pipes that look the same way there is no such limit: the bend
/// between them would have no room in it.
const REACH: f64 = 2.0;

/// A surface over `(around, height)`: rounds, and 0 at the lower loop to 1 at the upper one.
#[derive(Clone, Debug)]
pub(super) struct Loft {
    lower: Rail,
    upper: Rail,
    /// With them the slopes of the rails are the directions in which the surface goes on.
    necks: Option<Necks>,
    /// As given.
    pub pull: f64,
    pub leaving: Leaving,
}

impl Loft {
    /// `pull`: how far the curves go on as they leave the loops, 1 as far as arcs do; the less, the tighter they are.
    pub fn new(lower: &Edge<'_>, upper: &Edge<'_>, pull: f64, leaving: Leaving) -> Loft {
        if leaving != Leaving::Direct {
            let rail = |e: &Edge<'_>| Rail::new(e.around.to_vec(), e.ring.points.clone(), e.onward.to_vec());
            let necks = Some(Necks::new([lower, upper], leaving == Leaving::Inwards, pull));
            return Loft { lower: rail(lower), upper: rail(upper), necks, pull, leaving };
        }
        let straight = |edge: &Edge<'_>| Rail::flat(edge.around, edge.ring.points.clone());
        let (a, b) = (straight(lower), straight(upper));
        let [from, to] = [lower, upper].map(|edge| ahead(edge.onward));
        let turns = is_pipe(lower.onward) && is_pipe(upper.onward) && from.dot(to) > 0.0;
        let reach = if turns { f64::INFINITY } else { REACH };
        let slopes = |own: &Edge<'_>, other: &Edge<'_>, there: &Rail, sign: f64| {
            let facing = straight_onward(other, there);
            let most = reach * own.ring.length / std::f64::consts::TAU;
            let slope = |k: usize| {
                let point = own.ring.points[k];
                let (far, back) = facing(own.around[k]);
                let slope = slope(point, own.onward[k], far, back, most);
                slope * if own.onward[k] == DVec3::ZERO { sign } else { sign * pull }
            };
            (0..own.around.len()).map(slope).collect::<Vec<_>>()
        };
        let lower_slopes = slopes(lower, upper, &b, 1.0);
        let upper_slopes = slopes(upper, lower, &a, -1.0);
        Loft {
            lower: a.with_slopes(lower_slopes),
            upper: b.with_slopes(upper_slopes),
            necks: None,
            pull,
            leaving,
        }
    }

    pub fn at(&self, around: f64, height: f64) -> Spot {
        if let Some(necks) = &self.necks {
            return necks.at([&self.lower, &self.upper], around, height);
        }
        let ([p, dp, u, du], [q, dq, v, dv]) = (self.lower.at(around), self.upper.at(around));
        let curves = Curves { ends: [p, q], along: [dp, dq], slopes: [u, v], turns: [du, dv] };
        curves.at(height, [0.0, 1.0])
    }

    /// The length of the curve across.
    pub fn length(&self, around: f64) -> f64 {
        let steps = if self.necks.is_some() { 24 } else { 6 };
        let points = (0..=steps).map(|k| self.at(around, k as f64 / steps as f64).point).collect::<Vec<_>>();
        points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }
}

/// The point of a loop at a place around the axis, and where its surface goes on there.
fn straight_onward(edge: &Edge<'_>, rail: &Rail) -> impl Fn(f64) -> (DVec3, DVec3) {
    move |around: f64| {
        let (k, t) = rail.segment(around);
        let onward = edge.onward[k].lerp(edge.onward[(k + 1) % edge.onward.len()], t).normalize_or_zero();
        (rail.at(around)[0], onward)
    }
}

/// How a curve leaves `from` in the direction `onward` for `to`, which it reaches against `back`; it goes aside by at most `most`.
fn slope(from: DVec3, onward: DVec3, to: DVec3, back: DVec3, most: f64) -> DVec3 {
    let chord = to - from;
    if onward == DVec3::ZERO {
        return chord;
    }
    let length = chord.length();
    let back = if back == DVec3::ZERO { chord / length.max(f64::MIN_POSITIVE) } else { -back };
    let angle = libm::acos(onward.dot(back).clamp(-1.0, 1.0)).clamp(1e-3, 2.8);
    let slope = onward * (length * arc_slope(angle));
    let aside = slope.reject_from_normalized(chord.try_normalize().unwrap_or(onward));
    if aside.length() > most { slope * (most / aside.length()) } else { slope }
}

#[cfg(test)]
mod tests {
    use super::super::align::Ring;
    use super::*;

    fn ring(n: usize, radius: f64, z: f64) -> (Ring, Vec<f64>) {
        let at = |k: usize| {
            let t = std::f64::consts::TAU * k as f64 / n as f64;
            DVec3::new(radius * t.cos(), radius * t.sin(), z)
        };
        let ring = Ring::new((0..n).map(at).collect());
        let around = ring.shares.clone();
        (ring, around)
    }

    #[test]
    fn a_gap_in_a_cylinder_is_closed_by_a_cylinder() {
        let ((a, s), (b, t)) = (ring(60, 1.0, 0.0), ring(60, 1.0, 5.0));
        let (up, down) = (vec![DVec3::Z; 60], vec![-DVec3::Z; 60]);
        let lower = Edge { ring: &a, around: &s, onward: &up };
        let upper = Edge { ring: &b, around: &t, onward: &down };
        let loft = Loft::new(&lower, &upper, 1.0, Leaving::Direct);
        for k in 0..100 {
            let spot = loft.at(0.01 * f64::from(k), 0.37);
            assert!((spot.point.truncate().length() - 1.0).abs() < 1e-3);
            assert!((spot.point.z - 5.0 * 0.37).abs() < 1e-6);
        }
        assert!((loft.length(0.2) - 5.0).abs() < 1e-6);
    }

    #[test]
    fn pipes_beside_each_other_are_joined_by_a_bend_with_room_in_it() {
        let ((a, s), (b, _)) = (ring(60, 1.0, 0.0), ring(60, 1.0, 0.0));
        let far = b.points.iter().map(|p| DVec3::new(12.0 - p.x, p.y, p.z)).collect();
        let (b, up) = (Ring::new(far), vec![DVec3::Z; 60]);
        let edge = |ring| Edge { ring, around: &s, onward: &up };
        let loft = Loft::new(&edge(&a), &edge(&b), 1.0, Leaving::Direct);
        let middle = [0.0, 0.5].map(|around| loft.at(around, 0.5).point.z);
        assert!(middle[0] > 2.0 && middle[1] > middle[0] + 1.0, "{middle:?}");
    }

    #[test]
    fn derivatives_are_those_of_the_points() {
        let ((a, s), (b, mut t)) = (ring(17, 1.0, 0.0), ring(31, 2.0, 3.0));
        t.iter_mut().for_each(|t| *t += 0.13);
        let (up, none) = (vec![DVec3::new(0.6, 0.0, 0.8); 17], vec![DVec3::ZERO; 31]);
        let lower = Edge { ring: &a, around: &s, onward: &up };
        let loft = Loft::new(&lower, &Edge { ring: &b, around: &t, onward: &none }, 1.0, Leaving::Direct);
        let d = 1e-6;
        for (x, y) in [(0.1, 0.2), (0.5, 0.9), (1.3, 0.4)] {
            let (here, along, across) = (loft.at(x, y), loft.at(x + d, y), loft.at(x, y + d));
            assert!(((along.point - here.point) / d - here.along).length() < 1e-3);
            assert!(((across.point - here.point) / d - here.across).length() < 1e-3);
        }
        assert!(loft.at(s[3], 0.0).point.distance(a.points[3]) < 1e-12);
        assert!(loft.at(t[3], 1.0).point.distance(b.points[3]) < 1e-12);
    }
}
