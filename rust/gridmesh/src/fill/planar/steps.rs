//! What the search of closed paths needs to know of a grid besides its directions.

use glam::DVec2;

use crate::lattice::axial::Axial;
use crate::lattice::grid::{Square, Triangular};
use crate::path::placement::{Laid, ROW_HEIGHT};

/// A grid in whose steps distances are counted.
pub(in crate::fill) trait Steps: Laid {
    /// The number of an offset among those of at most `reach` steps (a square has those at its corners too), row by
    /// row; none beyond.
    fn cell(offset: Axial, reach: i32) -> Option<usize>;

    /// Steps along a vector: one for the unit vectors of the grid, more between.
    fn along(vector: DVec2) -> f64;
}

impl Steps for Triangular {
    fn cell(offset: Axial, reach: i32) -> Option<usize> {
        if offset.distance(Axial::default()) > reach {
            return None;
        }
        // Cells before this row: the rows of a hexagon, of 2 reach + 1 - |r| cells each.
        let below = offset.r + reach;
        let full = |rows: i32| rows * (2 * reach + 1);
        // Rows -reach..=0 lack reach, ..., 0; rows 1..r lack 1, ..., r - 1.
        let cut = if offset.r <= 0 {
            below * (2 * reach + 1 - below) / 2
        } else {
            reach * (reach + 1) / 2 + (offset.r - 1) * offset.r / 2
        };
        let first = (-reach).max(-reach - offset.r);
        Some((full(below) - cut + offset.q - first) as usize)
    }

    fn along(vector: DVec2) -> f64 {
        let r = vector.y / ROW_HEIGHT;
        let q = vector.x - 0.5 * r;
        q.abs().max(r.abs()).max((q + r).abs())
    }
}

impl Steps for Square {
    fn cell(offset: Axial, reach: i32) -> Option<usize> {
        let inside = offset.q.abs() <= reach && offset.r.abs() <= reach;
        inside.then(|| ((offset.r + reach) * (2 * reach + 1) + offset.q + reach) as usize)
    }

    fn along(vector: DVec2) -> f64 {
        vector.x.abs() + vector.y.abs()
    }
}
