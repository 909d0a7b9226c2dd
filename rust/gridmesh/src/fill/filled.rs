//! A filled hole, what is kept to solve it again, and the loop being worked on.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::fill::options::Smooth;
use crate::fill::report::FillReport;
use crate::fill::surface::patchwork::Patchwork;
use crate::progress::Progress;

/// A filled hole.
#[derive(Clone, Debug)]
pub struct Fill {
    /// The loop as it was given.
    pub loop_: Vec<u32>,
    /// The new vertices.
    pub vertices: Vec<DVec3>,
    /// The new triangles: numbers below that of the mesh's vertices are those, the following ones the new
    /// vertices in order. Wound against the triangles at the loop.
    pub triangles: Vec<[u32; 3]>,
    /// Numbers about it.
    pub report: FillReport,
    /// Edges of the patch along which a hard edge of the surroundings goes on, numbered as the triangles are.
    pub creases: Vec<[u32; 2]>,
    pub(crate) shape: Arc<Shape>,
}

/// Of a patch between two loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bridged {
    /// Vertices of the first loop; those of the second follow.
    pub first: usize,
    /// The second loop was given the other way round.
    pub reversed: bool,
}

/// What is needed to solve the same patch again.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) work: Patchwork,
    pub(crate) loop_: Vec<u32>,
    pub(crate) reversed: bool,
    /// What is known of the second loop, of a patch between two.
    pub(crate) bridged: Option<Bridged>,
    pub(crate) flat: Vec<glam::DVec2>,
    pub(crate) smooth: Smooth,
    pub(crate) vertices: usize,
    pub(crate) positions: Vec<DVec3>,
    /// Hard edges; where there are some, `flat` has each planar part in a place of its own.
    pub(crate) creases: Vec<[u32; 2]>,
}

pub(crate) const NO_ITEM: Error = Error::Internal { reason: "a loop has neither a fill nor an error" };

impl Fill {
    /// Extends data at the loop (`columns` values for each of its vertices, in the order of the loop as
    /// given, row by row) to the new vertices: harmonically, one factorisation for all columns, each
    /// value within the range of its column.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if the number of values does not fit, [`Error::NotFinite`].
    pub fn extend(&self, values: &[f64], columns: usize) -> Result<Vec<f64>> {
        self.extended(values, columns, Progress::NONE)
    }

    /// As [`Fill::extend`], and asks whether to go on.
    pub(crate) fn extended(
        &self,
        values: &[f64],
        columns: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>> {
        self.shape.extend(values, columns, progress)
    }

    /// The new vertices if those of the mesh were at `vertices`: the same triangles, solved again. For
    /// other poses of one mesh, such as shape keys; where the surroundings are equal, so is the result.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if there are not as many vertices as before, [`Error::NotFinite`] for one near
    /// the loop.
    pub fn refit(&self, vertices: &[DVec3]) -> Result<Vec<DVec3>> {
        if vertices.len() != self.shape.vertices {
            return Err(Error::InvalidOption {
                name: "vertices",
                value: format!("of length {}", vertices.len()),
                allowed: "as many vertices as the filled mesh has",
            });
        }
        let near = self.shape.loop_.iter().chain(&self.shape.work.outer);
        if let Some(&v) = near.into_iter().find(|&&v| !vertices[v as usize].is_finite()) {
            return Err(Error::NotFinite { what: "mesh".into(), point: v as usize });
        }
        if !self.shape.creases.is_empty() {
            return self.shape.carried(vertices);
        }
        let positions = match self.shape.bridged {
            Some(bridged) => self.shape.lofted(vertices, bridged.first)?,
            None => self.shape.solve(vertices, Progress::NONE)?.positions,
        };
        Ok(positions[self.shape.work.inner()].to_vec())
    }
}

impl PartialEq for Fill {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices && self.triangles == other.triangles && self.loop_ == other.loop_
    }
}

/// Seconds per stage.
pub(crate) struct Clock {
    pub(crate) since: Instant,
    pub(crate) seconds: Vec<(&'static str, f64)>,
}

impl Clock {
    pub(crate) fn new() -> Self {
        Clock { since: Instant::now(), seconds: vec![] }
    }

    pub(crate) fn stage(&mut self, name: &'static str) {
        let elapsed = self.since.elapsed().as_secs_f64();
        match self.seconds.iter_mut().find(|(known, _)| *known == name) {
            Some((_, seconds)) => *seconds += elapsed,
            None => self.seconds.push((name, elapsed)),
        }
        self.since = Instant::now();
    }
}
