//! Where a triangular lattice lies in the plane.

use glam::DVec2;

use crate::lattice::axial::Axial;
use crate::lattice::grid::{Grid, Square, Triangular};
use crate::lattice::reflection::Reflection;
use crate::options::CellShape;

/// Half the square root of three: the height of an equilateral triangle of edge one.
pub const ROW_HEIGHT: f64 = 0.866_025_403_784_438_6;

/// A grid as it lies in the plane, with edges of length one: lattice units.
///
/// Row `r` lies [`Laid::ROW_HEIGHT`] times `r` above the first and is shifted by [`Laid::ROW_SHIFT`] times `r`.
pub trait Laid: Grid {
    /// Distance of neighbouring rows, in edges.
    const ROW_HEIGHT: f64;
    /// By how much a row is shifted against the one below, in edges.
    const ROW_SHIFT: f64;

    /// The nearest lattice point of a position in lattice units.
    fn nearest(units: DVec2) -> Axial;

    /// The position of a lattice point, in lattice units.
    fn units(point: Axial) -> DVec2 {
        let r = f64::from(point.r);
        DVec2::new(f64::from(point.q) + Self::ROW_SHIFT * r, Self::ROW_HEIGHT * r)
    }
}

impl Laid for Triangular {
    const ROW_HEIGHT: f64 = ROW_HEIGHT;
    const ROW_SHIFT: f64 = 0.5;

    fn nearest(units: DVec2) -> Axial {
        Lattice::nearest(units)
    }
}

impl Laid for Square {
    const ROW_HEIGHT: f64 = 1.0;
    const ROW_SHIFT: f64 = 0.0;

    fn nearest(units: DVec2) -> Axial {
        Axial::new(units.x.round() as i32, units.y.round() as i32)
    }
}

impl CellShape {
    /// The angle between two neighbouring directions of the lattice, in radians.
    pub const fn step(self) -> f64 {
        match self {
            CellShape::Triangle => std::f64::consts::FRAC_PI_3,
            CellShape::Quad => std::f64::consts::FRAC_PI_2,
        }
    }

    /// The position of a lattice point, in lattice units.
    pub fn units(self, point: Axial) -> DVec2 {
        match self {
            CellShape::Triangle => Triangular::units(point),
            CellShape::Quad => Square::units(point),
        }
    }

    /// The area of one cell with edges of length one.
    pub const fn area(self) -> f64 {
        match self {
            CellShape::Triangle => 0.5 * ROW_HEIGHT,
            CellShape::Quad => 1.0,
        }
    }
}

/// A triangular lattice in the plane: an origin, the angle of its direction 0, an edge length.
///
/// Algorithms work in *lattice units*: coordinates with the origin at a lattice point, the first
/// axis along direction 0 and an edge length of one. [`Lattice::to_units`] and
/// [`Lattice::from_units`] convert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Position of the lattice point (0, 0).
    pub origin: DVec2,
    /// Angle of direction 0 against the first axis, in radians.
    pub angle: f64,
    /// Length of an edge, in the units of the drawing.
    pub edge_length: f64,
}

impl Lattice {
    /// The same lattice with the one of its angles that is in [0, pi/3), of a lattice of squares in [0, pi/2).
    pub fn of_least_angle(self, shape: CellShape) -> Self {
        let step = shape.step();
        let angle = self.angle.rem_euclid(step);
        Self { angle: if angle < step { angle } else { 0.0 }, ..self }
    }

    /// The position of a lattice point, in lattice units.
    pub fn units(point: Axial) -> DVec2 {
        DVec2::new(f64::from(point.q) + 0.5 * f64::from(point.r), ROW_HEIGHT * f64::from(point.r))
    }

    /// The mirror image of a position in lattice units, exact.
    pub fn reflected(axis: Reflection, units: DVec2) -> DVec2 {
        match axis {
            Reflection::Along => DVec2::new(units.x, -units.y),
            Reflection::Across => DVec2::new(-units.x, units.y),
        }
    }

    /// The real axial coordinates `(q, r)` of a position in lattice units.
    pub fn axial_of(units: DVec2) -> DVec2 {
        let r = units.y / ROW_HEIGHT;
        DVec2::new(units.x - 0.5 * r, r)
    }

    /// The nearest lattice point of a position in lattice units.
    pub fn nearest(units: DVec2) -> Axial {
        let a = Self::axial_of(units);
        let (q, r, s) = (a.x.round(), a.y.round(), (-a.x - a.y).round());
        let (dq, dr, ds) = ((q - a.x).abs(), (r - a.y).abs(), (s + a.x + a.y).abs());
        if dq > dr && dq > ds {
            Axial::new((-r - s) as i32, r as i32)
        } else if dr > ds {
            Axial::new(q as i32, (-q - s) as i32)
        } else {
            Axial::new(q as i32, r as i32)
        }
    }

    /// From the units of the drawing to lattice units.
    pub fn to_units(&self, point: DVec2) -> DVec2 {
        let (sin, cos) = libm::sincos(self.angle);
        let d = (point - self.origin) / self.edge_length;
        DVec2::new(cos * d.x + sin * d.y, cos * d.y - sin * d.x)
    }

    /// From lattice units to the units of the drawing.
    pub fn from_units(&self, units: DVec2) -> DVec2 {
        let (sin, cos) = libm::sincos(self.angle);
        self.origin
            + self.edge_length * DVec2::new(cos * units.x - sin * units.y, sin * units.x + cos * units.y)
    }

    /// The edge length at which a triangular lattice covers `area` with `triangles` triangles.
    pub fn edge_length_for(area: f64, triangles: f64) -> f64 {
        (area / (triangles * 0.5 * ROW_HEIGHT)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions_are_evenly_spaced<G: Laid>() {
        for dir in 0..G::DIRECTIONS {
            let [here, ahead] = [G::offset(dir), G::offset(G::turned(dir, 1))].map(G::units);
            assert!((here.length() - 1.0).abs() < 1e-15);
            let angle = here.angle_to(ahead);
            assert!((angle - std::f64::consts::TAU / f64::from(G::DIRECTIONS)).abs() < 1e-12);
            assert_eq!(G::nearest(here), G::offset(dir));
        }
    }

    #[test]
    fn directions_are_evenly_spaced_on_both_grids() {
        directions_are_evenly_spaced::<Triangular>();
        directions_are_evenly_spaced::<Square>();
    }

    #[test]
    fn units_and_drawing_are_inverse() {
        let lattice = Lattice { origin: DVec2::new(3.0, -1.0), angle: 0.4, edge_length: 0.25 };
        let p = DVec2::new(1.7, 2.9);
        assert!(lattice.from_units(lattice.to_units(p)).distance(p) < 1e-14);
    }

    #[test]
    fn nearest_point_is_nearest() {
        for i in 0..40 {
            for j in 0..40 {
                let p = DVec2::new(0.17 * f64::from(i) - 3.0, 0.13 * f64::from(j) - 2.5);
                let n = Lattice::nearest(p);
                let d = Lattice::units(n).distance(p);
                for m in n.neighbours() {
                    assert!(Lattice::units(m).distance(p) >= d - 1e-12);
                }
            }
        }
    }
}
