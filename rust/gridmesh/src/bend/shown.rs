//! What a bent lattice is made of, for pictures of it.

use std::ops::Range;

use glam::DVec2;

use super::Bent;
use super::choose::TURN;
use crate::drawing::curve::ClosedCurve;
use crate::error::Result;
use crate::path::placement::Lattice;
use crate::progress::Progress;

/// The conformal map of a drawing on its carrier, a coarse triangulation, and the straight lattice of the bent plane.
pub struct Shown {
    /// Vertices of the carrier in the drawing, those of the boundary first.
    pub vertices: Vec<DVec2>,
    /// Its triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The vertices on each contour.
    pub contours: Vec<Range<usize>>,
    /// At each vertex on a contour the multiple of 60 degrees, of 90 for quads, that the outline shall have in the bent plane.
    pub steps: Vec<i32>,
    /// By how many of them it changes from each to the next.
    pub changes: Vec<i32>,
    /// At each vertex the direction in the drawing, in radians, of what is the first axis of the bent plane.
    pub axes: Vec<f64>,
    /// At each vertex the length in the drawing of an edge of the lattice.
    pub lengths: Vec<f64>,
    /// The contours in the bent plane.
    pub bent: Vec<ClosedCurve>,
    /// The lattice of the bent plane.
    pub lattice: Lattice,
    /// What squared distances of the path count there, in turns.
    pub closeness: f64,
}

impl Bent {
    /// The map, with the lattice of the bent plane and what distances count there.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled), [`Error::Solver`](crate::error::Error::Solver).
    pub(crate) fn shown(&self, lattice: Lattice, closeness: f64, progress: Progress<'_>) -> Result<Shown> {
        let (ground, image) = (&self.ground, &self.image);
        let carrier = &ground.carrier;
        let operators = ground.operators(progress)?;
        let steps: Vec<i32> =
            operators.directions(&image.v, TURN).into_iter().flat_map(|found| found.steps).collect();
        let mut changes = Vec::with_capacity(steps.len());
        for &(start, n, total) in operators.contours() {
            // Once around they gain what the contour turns by.
            let next = |i: usize| if i + 1 < n { steps[start + i + 1] } else { steps[start] + total };
            changes.extend((0..n).map(|i| next(i) - steps[start + i]));
        }
        let frame = &ground.frame;
        let edge = frame.edge_length * lattice.edge_length;
        Ok(Shown {
            vertices: carrier.vertices.iter().map(|&p| frame.from_units(p)).collect(),
            triangles: carrier.triangles.clone(),
            contours: carrier.rims.iter().map(|rim| rim.start..rim.start + rim.len()).collect(),
            steps,
            changes,
            axes: image.v.iter().map(|v| frame.angle - v).collect(),
            lengths: image.u.iter().map(|u| edge * libm::exp(-u)).collect(),
            bent: self.contours().to_vec(),
            lattice,
            closeness,
        })
    }
}
