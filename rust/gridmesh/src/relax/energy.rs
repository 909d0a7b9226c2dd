//! Energies of a triangle, and their sum over the triangles around one vertex.
//!
//! With J the linear map from the equilateral triangle of edge one, `stretch` = |J|^2 is two
//! thirds of the sum of squared edge lengths and `det` = det J is the signed area over that of the
//! equilateral triangle. Seen as functions of one vertex, `stretch` is a quadratic with Hessian
//! 8/3 and `det` is linear, so a 2 x 2 Newton step costs a few operations for each triangle; and
//! stretch / det is convex where det is positive (a square over a linear function).

use std::ops::Mul;

use glam::DVec2;
use wide::f64x2;

use crate::geometry::quadratic::Quadratic;
use crate::path::placement::ROW_HEIGHT;

/// Second derivative of `stretch` in one vertex, times the identity.
const STRETCH_HESSIAN: f64 = 8.0 / 3.0;

/// Value and derivatives of an energy by `stretch` (u) and `det` (d), for two triangles.
#[derive(Clone, Copy)]
pub struct Derivatives {
    pub value: f64x2,
    pub u: f64x2,
    pub d: f64x2,
    pub uu: f64x2,
    pub ud: f64x2,
    pub dd: f64x2,
}

/// An energy of a triangle: a function of `stretch` and `det`.
pub trait Energy {
    /// True if the energy is infinite where `det` is not positive, and convex elsewhere.
    const BARRIER: bool;
    fn value(&self, stretch: f64, det: f64) -> f64;
    fn derivatives(&self, stretch: f64x2, det: f64x2) -> Derivatives;
}

/// A high power, 2^`SQUARINGS`, of |J|^2 / det with a little weight on the area, one for a unit
/// equilateral triangle and infinite at area zero: what counts is the worst triangle.
///
/// Above [`LINEAR`] (a least angle below some 18 degrees) it goes on linearly, so that the sharp
/// tip of a drawing, which nothing can mend, does not blow up the triangle in it.
pub(super) struct Power<const SQUARINGS: usize>;

const LINEAR: f64 = 2.0;
const AREA: f64 = 0.07;
const SCALE: f64 = 1.0 / (2.0 + 2.0 * AREA);

impl<const SQUARINGS: usize> Power<SQUARINGS> {
    const EXPONENT: f64 = (1u32 << SQUARINGS) as f64;

    /// The powers `EXPONENT - 2` and `EXPONENT - 1`.
    fn powers<T: Copy + From<f64> + Mul<Output = T>>(base: T) -> (T, T) {
        (1..SQUARINGS)
            .fold((T::from(1.0), base), |(second, first), _| (second * first * base, first * first * base))
    }
}

impl<const SQUARINGS: usize> Energy for Power<SQUARINGS> {
    const BARRIER: bool = true;

    fn value(&self, stretch: f64, det: f64) -> f64 {
        if det <= 0.0 {
            return f64::INFINITY;
        }
        let e = ((stretch + AREA) / det + AREA * det) * SCALE;
        let low = e.min(LINEAR);
        let (_, first) = Self::powers(low);
        first * (low + Self::EXPONENT * (e - low))
    }

    fn derivatives(&self, stretch: f64x2, det: f64x2) -> Derivatives {
        let inverse = 1.0 / det;
        let ratio = (stretch + AREA) * inverse;
        let e = (ratio + det * AREA) * SCALE;
        let (eu, ed) = (inverse * SCALE, (AREA - ratio * inverse) * SCALE);
        let (eud, edd) = (-inverse * eu, ratio * inverse * eu * 2.0);
        let low = e.fast_min(f64x2::splat(LINEAR));
        let (second, power) = Self::powers(low);
        let first = power * Self::EXPONENT;
        let curved = second * (Self::EXPONENT * (Self::EXPONENT - 1.0));
        let second = e.simd_gt(low).select(f64x2::ZERO, curved);
        let (su, sd) = (second * eu, second * ed);
        Derivatives {
            value: power * low + first * (e - low),
            u: first * eu,
            d: first * ed,
            uu: su * eu,
            ud: first * eud + su * ed,
            dd: first * edd + sd * ed,
        }
    }
}

/// (|J|^2 + (det^2 + 1) / 2) / chi with chi = (det + sqrt(det^2 + eps^2)) / 2 in place of det:
/// finite for inverted triangles too, which it drives to positive area.
pub(super) struct Regularised {
    pub eps: f64,
}

impl Energy for Regularised {
    const BARRIER: bool = false;

    fn value(&self, stretch: f64, det: f64) -> f64 {
        let chi = 0.5 * (det + (det * det + self.eps * self.eps).sqrt());
        (stretch + 0.5 * (det * det + 1.0)) / chi
    }

    fn derivatives(&self, stretch: f64x2, det: f64x2) -> Derivatives {
        let root = (det * det + self.eps * self.eps).sqrt();
        let chi = (det + root) * 0.5;
        let (chi1, chi2) = (chi / root, 0.5 * self.eps * self.eps / (root * root * root));
        let inverse = 1.0 / chi;
        let value = (stretch + (det * det + 1.0) * 0.5) * inverse;
        Derivatives {
            value,
            u: inverse,
            d: det * inverse - value * chi1 * inverse,
            uu: f64x2::ZERO,
            ud: -chi1 * inverse * inverse,
            dd: inverse - det * chi1 * inverse * inverse * 2.0
                + value * (chi1 * chi1 * inverse * inverse * 2.0 - chi2 * inverse),
        }
    }
}

/// `det` of the triangle with two edges `a` and `b` from one vertex.
pub(super) fn det(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b) / ROW_HEIGHT
}

pub(super) fn stretch(a: DVec2, b: DVec2) -> f64 {
    let e = b - a;
    (2.0 / 3.0) * (a.dot(a) + b.dot(b) + e.dot(e))
}

/// Sum over the triangles around a vertex, as a function of the vertex.
#[derive(Clone, Copy)]
pub struct Local {
    pub value: f64,
    pub model: Quadratic,
    /// Least `det`.
    pub det: f64,
    /// Greatest squared length of an opposite edge.
    pub edge: f64,
}

/// The energy of the triangles (x, ring[i], ring[i + 1]).
pub(super) fn value<E: Energy>(energy: &E, x: DVec2, ring: &[u32], positions: &[DVec2]) -> f64 {
    let mut sum = 0.0;
    let mut a = positions[ring[0] as usize] - x;
    for &v in &ring[1..] {
        let b = positions[v as usize] - x;
        sum += energy.value(stretch(a, b), det(a, b));
        a = b;
    }
    sum
}

/// The energy of the triangles (x, ring[i], ring[i + 1]) with gradient and Hessian in x.
///
/// Triangles are taken in pairs; a last one without a partner is taken twice at half its weight.
pub(super) fn local<E: Energy>(energy: &E, x: DVec2, ring: &[u32], positions: &[DVec2]) -> Local {
    let zero = f64x2::ZERO;
    let (mut value, mut gx, mut gy, mut xx, mut xy, mut yy) = (zero, zero, zero, zero, zero, zero);
    let (mut least, mut most) = (f64x2::splat(f64::INFINITY), zero);
    let at = |i: usize| positions[ring[i] as usize] - x;
    let n = ring.len() - 1;
    let mut p = at(0);
    for i in (0..n).step_by(2) {
        let single = i + 1 == n;
        let q = at(i + 1);
        let r = if single { q } else { at(i + 2) };
        let (ax, ay) = (
            f64x2::new([p.x, if single { p.x } else { q.x }]),
            f64x2::new([p.y, if single { p.y } else { q.y }]),
        );
        let (bx, by) = (f64x2::new([q.x, r.x]), f64x2::new([q.y, r.y]));
        p = r;
        let (ex, ey) = (bx - ax, by - ay);
        let det = (ax * by - ay * bx) * (1.0 / ROW_HEIGHT);
        let edge = ex * ex + ey * ey;
        let stretch = (ax * ax + ay * ay + bx * bx + by * by + edge) * (2.0 / 3.0);
        let mut d = energy.derivatives(stretch, det);
        if single {
            for part in [&mut d.value, &mut d.u, &mut d.d, &mut d.uu, &mut d.ud, &mut d.dd] {
                *part *= 0.5;
            }
        }
        let (ux, uy) = ((ax + bx) * (-4.0 / 3.0), (ay + by) * (-4.0 / 3.0));
        let (nx, ny) = (ey * (-1.0 / ROW_HEIGHT), ex * (1.0 / ROW_HEIGHT));
        value += d.value;
        gx += d.u * ux + d.d * nx;
        gy += d.u * uy + d.d * ny;
        let (pux, puy) = (d.uu * ux + d.ud * nx, d.uu * uy + d.ud * ny);
        let (pnx, pny) = (d.ud * ux + d.dd * nx, d.ud * uy + d.dd * ny);
        let identity = d.u * STRETCH_HESSIAN;
        xx += identity + pux * ux + pnx * nx;
        xy += pux * uy + pnx * ny;
        yy += identity + puy * uy + pny * ny;
        least = least.fast_min(det);
        most = most.fast_max(edge);
    }
    let [det, other_det] = least.to_array();
    let [edge, other_edge] = most.to_array();
    Local {
        value: value.reduce_add(),
        model: Quadratic {
            gradient: DVec2::new(gx.reduce_add(), gy.reduce_add()),
            xx: xx.reduce_add(),
            xy: xy.reduce_add(),
            yy: yy.reduce_add(),
        },
        det: det.min(other_det),
        edge: edge.max(other_edge),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn ring() -> (Vec<u32>, Vec<DVec2>) {
        let mut positions: Vec<DVec2> =
            (0..6).map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 6.0)).collect();
        positions[2] *= 0.7;
        positions[4] *= 1.3;
        (vec![0, 1, 2, 3, 4, 5, 0], positions)
    }

    /// Asserts that derivatives at a place are those of the values around it, to a relative tolerance.
    pub(in crate::relax) fn match_differences(
        at: impl Fn(DVec2) -> Local,
        value: f64,
        x: DVec2,
        tolerance: f64,
    ) {
        let l = at(x);
        assert!((l.value - value).abs() < 1e-12 * l.value.abs());
        let h = 1e-5;
        let (px, mx) = (at(x + DVec2::X * h), at(x - DVec2::X * h));
        let (py, my) = (at(x + DVec2::Y * h), at(x - DVec2::Y * h));
        let close =
            |a: f64, b: f64| assert!((a - b).abs() < tolerance * (1.0 + a.abs().max(b.abs())), "{a} {b}");
        close(l.model.gradient.x, (px.value - mx.value) / (2.0 * h));
        close(l.model.gradient.y, (py.value - my.value) / (2.0 * h));
        close(l.model.xx, (px.model.gradient.x - mx.model.gradient.x) / (2.0 * h));
        close(l.model.xy, (py.model.gradient.x - my.model.gradient.x) / (2.0 * h));
        close(l.model.yy, (py.model.gradient.y - my.model.gradient.y) / (2.0 * h));
    }

    fn derivatives_match_differences<E: Energy>(energy: &E, x: DVec2) {
        let (ring, positions) = ring();
        let at = |x: DVec2| local(energy, x, &ring, &positions);
        match_differences(at, value(energy, x, &ring, &positions), x, 1e-5);
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        for x in [DVec2::ZERO, DVec2::new(0.2, -0.1), DVec2::new(-0.3, 0.25)] {
            derivatives_match_differences(&Power::<2>, x);
            derivatives_match_differences(&Power::<4>, x);
            derivatives_match_differences(&Regularised { eps: 0.3 }, x);
        }
        // Outside the ring: two inverted triangles.
        derivatives_match_differences(&Regularised { eps: 0.3 }, DVec2::new(1.4, 0.6));
    }

    #[test]
    fn unit_equilateral_triangle_is_the_minimum() {
        let hexagon: Vec<DVec2> =
            (0..6).map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 6.0)).collect();
        let ring = [0, 1, 2, 3, 4, 5, 0];
        let l = local(&Power::<2>, DVec2::ZERO, &ring, &hexagon);
        assert!((l.value - 6.0).abs() < 1e-12);
        assert!(l.model.gradient.length() < 1e-12);
    }
}
