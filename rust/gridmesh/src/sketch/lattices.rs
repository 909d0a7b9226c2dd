//! Which lattices are tried for a drawing.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::lattice::grid::{Square, Triangular};
use crate::options::{BoundaryMethod, CellShape};
use crate::patch::mirror;
use crate::path::orient::predicted_angles;
use crate::path::placement::{Laid, Lattice};
use crate::sketch::job::{Asked, Effort, Job};

/// Lattice placements tried before the drawing is called too coarse for its edge length: shifts of
/// the origin in edges.
const SHIFTS: [[f64; 2]; 6] =
    [[0.0, 0.0], [0.5, 0.29], [0.5, -0.29], [0.25, 0.43], [0.25, -0.14], [0.75, 0.14]];

/// Of the lattices laid on a mirror axis, so many are tried first.
const MIRROR_CANDIDATES: usize = 4;

/// Triangles for each edge length of a drawing that is as narrow as patches get: median of 1400 patches of spirals,
/// combs and the like.
const LEAST_EACH: f64 = 1.9;

/// The guess for narrow drawings is taken where it is so many times the other: three rows of triangles and less.
const NARROW: f64 = 1.05;

impl Job<'_> {
    /// The lattices to try: angles, and shifts of the origin in edges.
    pub(super) fn placements_to_try(&self, asked: Asked, effort: Effort) -> Vec<(f64, DVec2)> {
        if let Some(symmetry) = &self.symmetry {
            let mut lattices = mirror::placements(symmetry, self.options.angle, self.options.cells);
            lattices.truncate(if effort == Effort::Full { MIRROR_CANDIDATES } else { MIRROR_CANDIDATES / 2 });
            return lattices;
        }
        self.angles(asked, effort).into_iter().map(|angle| (angle, DVec2::ZERO)).collect()
    }

    /// The lattices to try where those do not do.
    pub(super) fn shifts(&self, tried: &[(f64, DVec2)]) -> Vec<(f64, DVec2)> {
        match &self.symmetry {
            Some(symmetry) => mirror::placements(symmetry, self.options.angle, self.options.cells)
                .into_iter()
                .skip(MIRROR_CANDIDATES)
                .collect(),
            None if self.options.origin.is_some() => Vec::new(),
            None => {
                let of = |&(angle, _): &(f64, DVec2)| {
                    SHIFTS[1..].iter().map(move |&shift| (angle, DVec2::from_array(shift)))
                };
                tried.iter().flat_map(of).collect()
            }
        }
    }

    /// The lattice angles to try: the one asked for, or those with the fewest turns predicted.
    fn angles(&self, asked: Asked, effort: Effort) -> Vec<f64> {
        const CANDIDATES: usize = 4;
        if let Some(angle) = self.options.angle {
            return vec![angle.rem_euclid(self.options.cells.step())];
        }
        let count = match (self.options.boundary, effort) {
            (BoundaryMethod::Optimal, Effort::Full) => CANDIDATES,
            _ => 1,
        };
        let edge_length = match asked {
            Asked::EdgeLength(h) => h,
            Asked::Cells(n) => self.first_guess(n),
        };
        let angles = predicted_angles(&self.contours, edge_length, count, self.options.cells);
        if angles.is_empty() { vec![0.0] } else { angles }
    }

    /// The edge length at which a patch has about `n` cells.
    pub(super) fn first_guess(&self, n: usize) -> f64 {
        self.guess(n).0
    }

    /// The same, and how many times as many cells there are where edges are so many times shorter, as a power.
    pub(super) fn guess(&self, n: usize) -> (f64, f64) {
        let ample = self.of_ample(n);
        if self.options.cells == CellShape::Triangle && self.options.boundary == BoundaryMethod::Optimal {
            let narrow = self.of_narrow(n);
            if narrow > NARROW * ample {
                let cells = self.area / (self.options.cells.area() * narrow * narrow);
                return (narrow, 1.0 + (cells / n as f64).powi(3).min(1.0));
            }
        }
        (ample, 2.0)
    }

    /// Where the drawing is so narrow that its walls get in each other's way there is no patch with fewer than two
    /// triangles for each edge of boundary. So of patches with that few `n^3 = (area / h^2)^3 + (least * length / h)^3`.
    fn of_narrow(&self, n: usize) -> f64 {
        let of_area = (self.area / (self.options.cells.area() * n as f64)).sqrt();
        let length = self.contours.iter().map(ClosedCurve::length).sum::<f64>();
        let crowded = (LEAST_EACH * length / (n as f64 * of_area)).powi(3);
        of_area * libm::cbrt(0.5 * crowded + (0.25 * crowded * crowded + 1.0).sqrt())
    }

    /// The edge length where the drawing is wide enough for `n` cells. The lattice path cuts off what it
    /// cannot follow, and growth stops inside the curve: on average a patch is so many triangles for
    /// each edge length of curve short of its area. That of quads covers it.
    pub(super) fn of_ample(&self, n: usize) -> f64 {
        let area = self.area / self.options.cells.area();
        let short = match (self.options.cells, self.options.boundary) {
            (CellShape::Quad, _) => 0.0,
            (CellShape::Triangle, BoundaryMethod::Optimal) => 0.09,
            (CellShape::Triangle, BoundaryMethod::Grown) => 0.28,
        };
        let short = short * self.contours.iter().map(ClosedCurve::length).sum::<f64>();
        2.0 * area / (short + (short * short + 4.0 * area * n as f64).sqrt())
    }

    pub(super) fn lattice(&self, edge_length: f64, angle: f64, shift: DVec2) -> Lattice {
        let angle = if self.symmetry.is_some() { angle } else { self.turned_with_drawing(angle) };
        let origin = self.centre + edge_length * DVec2::from_angle(angle).rotate(shift);
        let Some(asked) = self.options.origin else {
            return Lattice { origin, angle, edge_length };
        };
        // The point of the asked lattice that is nearest to the drawing: coordinates stay small.
        let asked = Lattice { origin: asked, angle, edge_length };
        let centre = asked.to_units(self.centre);
        let nearest = match self.options.cells {
            CellShape::Triangle => Triangular::units(Triangular::nearest(centre)),
            CellShape::Quad => Square::units(Square::nearest(centre)),
        };
        let nearest = asked.from_units(nearest);
        Lattice { origin: nearest, ..asked }
    }

    /// From the centre to the farthest point of the outline.
    pub(super) fn farthest(&self) -> DVec2 {
        let mut farthest = DVec2::ZERO;
        for &point in self.contours[0].points() {
            let out = point - self.centre;
            if out.length_squared() >= farthest.length_squared() {
                farthest = out;
            }
        }
        farthest
    }

    /// Of the angles of one lattice that which turns with the drawing: the search breaks ties by
    /// lattice direction, and shifts are not the same in all those frames.
    fn turned_with_drawing(&self, angle: f64) -> f64 {
        let ahead = self.farthest().to_angle();
        ahead + (angle - ahead).rem_euclid(self.options.cells.step())
    }
}
