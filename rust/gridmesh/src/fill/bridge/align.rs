//! Which vertices of two loops belong together.

use glam::{DMat3, DVec3};

use crate::fill::layout::unroll::area_vector;

/// Places along each loop that are compared.
const SAMPLES: usize = 96;

/// A closed polygon with its vertices' share of its length before them.
#[derive(Clone, Debug)]
pub(in crate::fill) struct Ring {
    pub points: Vec<DVec3>,
    /// Ascending from 0 to below 1.
    pub shares: Vec<f64>,
    pub length: f64,
    pub centre: DVec3,
    /// Along the axis: the loop runs counter-clockwise around it. Zero if there is none.
    pub axis: DVec3,
}

impl Ring {
    pub fn new(points: Vec<DVec3>) -> Ring {
        let n = points.len();
        let mut before = 0.0;
        let mut shares = Vec::with_capacity(n);
        let mut centre = DVec3::ZERO;
        for k in 0..n {
            let next = points[(k + 1) % n];
            let edge = points[k].distance(next);
            shares.push(before);
            before += edge;
            centre += 0.5 * edge * (points[k] + next);
        }
        shares.iter_mut().for_each(|share| *share /= before);
        let axis = area_vector(&points);
        // A loop there and back has no axis.
        let axis = if axis.length() > 1e-6 * before * before { axis.normalize() } else { DVec3::ZERO };
        Ring { shares, length: before, centre: centre / before, axis, points }
    }

    /// The same loop run through the other way.
    pub fn reversed(&self) -> Ring {
        Ring::new(self.points.iter().rev().copied().collect())
    }

    /// Places at equal distances along it, from its centre.
    pub(super) fn samples(&self) -> Vec<DVec3> {
        let n = self.points.len();
        let at = |k: usize| {
            let share = k as f64 / SAMPLES as f64;
            let i = self.shares.partition_point(|&s| s <= share) - 1;
            let end = self.shares.get(i + 1).copied().unwrap_or(1.0);
            let t = (share - self.shares[i]) / (end - self.shares[i]);
            self.points[i].lerp(self.points[(i + 1) % n], t) - self.centre
        };
        (0..SAMPLES).map(at).collect()
    }
}

/// The share of `upper` to which the start of `lower` belongs.
///
/// The lower loop is carried along to the upper one without twist and compared with it there.
pub(super) fn best_fit(lower: &Ring, upper: &Ring) -> f64 {
    let carry = carried(lower, upper);
    let from = lower.samples().into_iter().map(|p| carry * p).collect::<Vec<_>>();
    let to = upper.samples();
    let fit = |shift: usize| (0..SAMPLES).map(|k| from[k].dot(to[(k + shift) % SAMPLES])).sum::<f64>();
    let fits = (0..SAMPLES).map(fit).collect::<Vec<_>>();
    let most = fits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Of equally good ones the first, whatever rounding makes of them.
    let spread = fits.iter().map(|fit| most - fit).fold(0.0, f64::max);
    let best = fits.iter().position(|&fit| most - fit <= 1e-9 * spread).unwrap_or(0);
    let (before, after) = (fits[(best + SAMPLES - 1) % SAMPLES], fits[(best + 1) % SAMPLES]);
    let bend = before - 2.0 * fits[best] + after;
    let more = if bend < 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    let share = (best as f64 + more) / SAMPLES as f64;
    share - share.floor()
}

/// The rotation that carries a frame from one loop to the other, along an arc between them.
///
/// Source: Wang, Jüttler, Zheng and Liu, *Computation of rotation minimizing frames*, 2008 (double reflection).
fn carried(lower: &Ring, upper: &Ring) -> DMat3 {
    let mirror = |v: DVec3| {
        let c = 2.0 / v.length_squared().max(f64::MIN_POSITIVE);
        DMat3::IDENTITY - DMat3::from_cols(v * (v.x * c), v * (v.y * c), v * (v.z * c))
    };
    if lower.axis == DVec3::ZERO || upper.axis == DVec3::ZERO {
        return DMat3::IDENTITY;
    }
    // As long as the axes are less than a right angle apart, straight from one to the other: so nested loops are
    // compared as they lie.
    if lower.axis.dot(upper.axis) > 0.0 {
        return mirror(lower.axis + upper.axis) * mirror(lower.axis);
    }
    let first = mirror(upper.centre - lower.centre);
    let second = upper.axis - first * lower.axis;
    if second.length() < 1e-6 { DMat3::IDENTITY } else { mirror(second) * first }
}

/// Whether a tube between two loops that run as they do is straight (1), or is turned inside out on its way (-1). Between: less
/// than sure.
pub(super) fn facing(lower: &Ring, upper: &Ring) -> f64 {
    const UNSURE: f64 = 0.5;
    let apart = upper.centre - lower.centre;
    let way = apart.normalize_or_zero();
    let (a, b) = (lower.axis.dot(way), upper.axis.dot(way));
    let alike = lower.axis.dot(upper.axis);
    if a.abs().min(b.abs()) > 0.3 {
        a.signum() * b.signum()
    } else if apart.length() < 0.5 * lower.length.max(upper.length) / std::f64::consts::TAU {
        // One in the other.
        alike.signum()
    } else {
        UNSURE * alike
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(n: usize, at: impl Fn(f64) -> DVec3) -> Ring {
        Ring::new((0..n).map(|k| at(std::f64::consts::TAU * k as f64 / n as f64)).collect())
    }

    /// How far apart two shares are.
    fn off(a: f64, b: f64) -> f64 {
        (a - b - (a - b).round()).abs()
    }

    #[test]
    fn loops_fit_where_they_face_each_other() {
        let oval = |t: f64| DVec3::new(2.0 * t.cos(), t.sin(), 0.0);
        let lower = circle(40, oval);
        for turn in [0.0, 1.0, 2.5] {
            let upper = circle(57, |t| oval(t - turn) + DVec3::new(0.3, 0.1, 3.0));
            assert!(off(best_fit(&lower, &upper), turn / std::f64::consts::TAU) < 0.05, "{turn}");
        }
        // A bend by a right angle.
        let lower = circle(40, |t| DVec3::new(t.cos(), t.sin(), 0.0));
        let upper = circle(40, |t| DVec3::new(3.0, t.sin(), 3.0 - t.cos()));
        assert!(off(best_fit(&lower, &upper), 0.0) < 0.02, "{}", best_fit(&lower, &upper));
    }

    #[test]
    fn loops_beside_each_other_meet_at_their_near_sides() {
        let lower = circle(40, |t| DVec3::new(t.cos(), t.sin(), 0.0));
        let upper = circle(40, |t| DVec3::new(4.0 - t.cos(), t.sin(), 0.0));
        assert!(off(best_fit(&lower, &upper), 0.0) < 0.02);
    }
}
