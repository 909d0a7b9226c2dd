//! How far a corner of a face is from the corner that it should be, as a function of the vertex that moves.
//!
//! With J the linear map from the ideal, `stretch` is half of |J|^2 and `det` is det J: their ratio is the conformal
//! distortion, one where the angles are those of the ideal, whatever the size.

use glam::{DVec2, DVec3};

use super::quadratic::Quadratic;
use crate::path::placement::ROW_HEIGHT;

/// Squared sides over twice the area, of an equilateral triangle.
pub(crate) const EQUILATERAL: f64 = 3.464_101_615_137_754_4;

/// A corner with a smaller share of area in its squared sides counts as one with this.
const THINNEST: f64 = 0.02;

/// What a triangle should look like, of which one vertex moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ideal {
    /// Equilateral.
    Equilateral,
    /// With a right angle between equal edges at the vertex that moves: the corner of a quad.
    Own,
    /// The same at the vertex that follows it.
    Next,
    /// The same at the vertex before it.
    Last,
}

impl Ideal {
    /// Twice the area over that of the ideal with edges of one; `a` and `b` lead from the vertex that moves to
    /// the others.
    pub fn det(self, a: DVec2, b: DVec2) -> f64 {
        a.perp_dot(b) / self.height()
    }

    pub fn height(self) -> f64 {
        if self == Ideal::Equilateral { ROW_HEIGHT } else { 1.0 }
    }

    /// Half of |J|^2, J the map from the ideal: equals `det` if it is one.
    pub fn stretch(self, a: DVec2, b: DVec2) -> f64 {
        let sides = self.sides([a.length_squared(), b.length_squared(), (b - a).length_squared()]);
        if self == Ideal::Equilateral { sides / 3.0 } else { 0.5 * sides }
    }

    /// Sum of the squared sides that are compared with the area: all, or those of the quad. Given are the squares of the
    /// two sides at the vertex that moves, the one to the vertex that follows it first, and of that across.
    pub fn sides(self, [a, b, across]: [f64; 3]) -> f64 {
        match self {
            Ideal::Equilateral => a + b + across,
            Ideal::Own => a + b,
            Ideal::Next => a + across,
            Ideal::Last => b + across,
        }
    }

    /// Those sides over twice the area, at best.
    pub fn best(self) -> f64 {
        if self == Ideal::Equilateral { EQUILATERAL } else { 2.0 }
    }

    /// Gradient of `stretch` as the vertex moves, and its second derivative, times the identity.
    pub fn slope(self, a: DVec2, b: DVec2) -> (DVec2, f64) {
        match self {
            Ideal::Equilateral => ((a + b) * (-2.0 / 3.0), 4.0 / 3.0),
            Ideal::Own => (-(a + b), 2.0),
            Ideal::Next => (-a, 1.0),
            Ideal::Last => (-b, 1.0),
        }
    }

    /// Whether the corner is that of the vertex that moves: each face has one.
    pub fn is_own(self) -> bool {
        matches!(self, Ideal::Own | Ideal::Equilateral)
    }
}

/// A corner in space, seen from the vertex that moves in a tangent plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Sum of the squared sides that the ideal compares.
    pub sides: f64,
    /// Its gradient as the vertex moves.
    pub lengthening: DVec3,
    /// Its second derivative, times the identity.
    pub curvature: f64,
    /// One over twice the area. A folded corner is seen in the tangent plane, where it has to unfold; its area counts as small.
    pub inverse: f64,
    /// Gradient of the area.
    pub widening: DVec3,
    /// `area / sides` of the ideal.
    share: f64,
}

impl Corner {
    /// The corner with the sides `a` and, counter-clockwise, `b`, in a surface with this unit normal.
    pub fn new(ideal: Ideal, a: DVec3, b: DVec3, normal: DVec3) -> Self {
        Self::crossed(ideal, [a, b, a.cross(b)], normal)
    }

    /// The same where the product of the two sides is known: `[a, b, a x b]`.
    #[inline]
    pub fn crossed(ideal: Ideal, [a, b, cross]: [DVec3; 3], normal: DVec3) -> Self {
        let sides = ideal.sides([a.length_squared(), b.length_squared(), (b - a).length_squared()]);
        let (lengthening, curvature) = match ideal {
            Ideal::Equilateral | Ideal::Own => (-2.0 * (a + b), 4.0),
            Ideal::Next => (-2.0 * a, 2.0),
            Ideal::Last => (-2.0 * b, 2.0),
        };
        let length = cross.length();
        let least = THINNEST * sides;
        // One division does for both, but where the area counts as another.
        let over = 1.0 / length;
        let (mut facing, mut inverse) = (cross * over, over);
        let height = cross.dot(normal);
        if height <= 0.0 {
            facing = normal;
            inverse = 1.0 / height.max(least);
        } else if length.is_nan() || length < least {
            inverse = 1.0 / least;
        }
        Self {
            sides,
            lengthening,
            curvature,
            inverse,
            widening: (a - b).cross(facing),
            share: 1.0 / ideal.best(),
        }
    }

    /// Squared sides over area, against the ideal's: one at best.
    #[inline]
    pub fn badness(&self) -> f64 {
        self.sides * self.inverse * self.share
    }

    /// A positive definite model of `weight * sides / area` in the plane of two axes.
    #[inline]
    pub fn model(&self, weight: f64, [e, f]: [DVec3; 2]) -> Quadratic {
        let in_plane = |v: DVec3| DVec2::new(v.dot(e), v.dot(f));
        let (ds, da) = (in_plane(self.lengthening), in_plane(self.widening));
        let m = self.inverse;
        let (ratio, k) = (self.sides * m, weight * m);
        let n = 2.0 * ratio * m;
        Quadratic {
            gradient: k * (ds - da * ratio),
            xx: k * (self.curvature - 2.0 * m * ds.x * da.x + n * da.x * da.x),
            xy: k * (n * da.x * da.y - m * (ds.x * da.y + ds.y * da.x)),
            yy: k * (self.curvature - 2.0 * m * ds.y * da.y + n * da.y * da.y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const IDEALS: [Ideal; 4] = [Ideal::Equilateral, Ideal::Own, Ideal::Next, Ideal::Last];

    #[test]
    fn the_model_of_a_corner_has_the_gradient_and_curvature_of_its_badness() {
        let (i, j) = (DVec3::new(1.0, 0.2, 0.0), DVec3::new(0.3, 0.9, 0.0));
        let axes = [DVec3::X, DVec3::Y];
        for ideal in IDEALS {
            let at = |x: DVec2| Corner::new(ideal, i - x.extend(0.0), j - x.extend(0.0), DVec3::Z);
            let ratio = |x: DVec2| at(x).badness() * ideal.best();
            let x = DVec2::new(0.1, -0.05);
            let model = at(x).model(1.0, axes);
            let h = 1e-4;
            let along = |d: DVec2| (ratio(x + h * d), ratio(x - h * d));
            for (d, slope, curved) in
                [(DVec2::X, model.gradient.x, model.xx), (DVec2::Y, model.gradient.y, model.yy)]
            {
                let (after, before) = along(d);
                assert!(
                    ((after - before) / (2.0 * h) - slope).abs() < 1e-4 * (1.0 + slope.abs()),
                    "{ideal:?}"
                );
                let second = (after + before - 2.0 * ratio(x)) / (h * h);
                assert!((second - curved).abs() < 1e-3 * (1.0 + curved.abs()), "{ideal:?} {second} {curved}");
            }
        }
    }

    #[test]
    fn the_distortion_of_a_corner_is_one_where_it_is_ideal() {
        let corners = [
            (Ideal::Equilateral, DVec2::X, DVec2::new(0.5, ROW_HEIGHT)),
            (Ideal::Own, DVec2::X, DVec2::Y),
            (Ideal::Next, DVec2::X, DVec2::ONE),
            (Ideal::Last, DVec2::ONE, DVec2::Y),
        ];
        for (ideal, a, b) in corners {
            let (a, b) = (3.0 * a, 3.0 * b);
            assert!((ideal.stretch(a, b) / ideal.det(a, b) - 1.0).abs() < 1e-12, "{ideal:?}");
            let seen = Corner::new(ideal, a.extend(0.0), b.extend(0.0), DVec3::Z);
            assert!((seen.badness() - 1.0).abs() < 1e-12, "{ideal:?}");
            assert!(seen.model(1.0, [DVec3::X, DVec3::Y]).minimum().is_some(), "{ideal:?}");
        }
    }
}
