//! A filled hole, what is kept to solve it again, and the loop being worked on.

use std::sync::Arc;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::fill::loops::reserve::edges;
use crate::fill::options::Smooth;
use crate::fill::parallel::steady;
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
    /// The new quads, numbered and wound in the same way. With `triangles` they are the faces: of a patch of quads
    /// that is one triangle if the loop is odd, none if it is even.
    pub quads: Vec<[u32; 4]>,
    /// Numbers about it.
    pub report: FillReport,
    /// Edges of the patch along which a hard edge of the surroundings goes on, numbered as the triangles are.
    pub creases: Vec<[u32; 2]>,
    pub(crate) shape: Arc<Shape>,
}

/// A further loop of a patch between several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridged {
    /// Vertices of the loops before.
    pub first: usize,
    /// It was given the other way round.
    pub reversed: bool,
    /// How far the surface of a tube between two loops goes on as it leaves them, 1 as far as arcs do.
    pub pull: f64,
    /// How that tube leaves the loops.
    pub leaving: Leaving,
}

/// How a tube between two loops leaves them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Leaving {
    /// As the surface around goes on, or towards the other loop.
    #[default]
    Direct,
    /// By necks on the outside of the surface.
    Outwards,
    /// By necks on its inside.
    Inwards,
}

/// What is needed to solve the same patch again.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) work: Patchwork,
    pub(crate) loop_: Vec<u32>,
    pub(crate) reversed: bool,
    /// The loops after the first.
    pub(crate) bridged: Vec<Bridged>,
    pub(crate) flat: Vec<glam::DVec2>,
    pub(crate) smooth: Smooth,
    pub(crate) vertices: usize,
    pub(crate) positions: Vec<DVec3>,
    /// Hard edges; where there are some, `flat` has each planar part in a place of its own.
    pub(crate) creases: Vec<[u32; 2]>,
}

impl Shape {
    /// The patch's faces as triangles, quads cut in two.
    pub(crate) fn facets(&self) -> Vec<[u32; 3]> {
        let work = &self.work;
        work.triangles[..work.n_patch].iter().map(|t| t.map(|v| self.name(v))).collect()
    }

    /// What the patch's vertices are called in the mesh with the new ones after its own.
    fn name(&self, v: u32) -> u32 {
        match self.loop_.get(v as usize) {
            Some(&name) => name,
            None => v - self.loop_.len() as u32 + self.vertices as u32,
        }
    }
}

pub(crate) const NO_ITEM: Error = Error::Internal { reason: "a loop has neither a fill nor an error" };

impl Fill {
    /// The fill that a solved shape is.
    pub(in crate::fill) fn of(loop_: Vec<u32>, shape: Shape, report: FillReport) -> Fill {
        let work = &shape.work;
        Fill {
            loop_,
            vertices: shape.positions[work.inner()].to_vec(),
            triangles: work.single().iter().map(|t| t.map(|v| shape.name(v))).collect(),
            quads: work.quads().map(|quad| quad.map(|v| shape.name(v))).collect(),
            creases: shape.creases.iter().map(|edge| edge.map(|v| shape.name(v))).collect(),
            report,
            shape: Arc::new(shape),
        }
    }

    /// Cuts the quads anew where they are now, see [`Patchwork::recut`].
    ///
    /// # Errors
    /// [`Error::Internal`].
    pub(in crate::fill) fn recut(&mut self) -> Result<()> {
        let shape = Arc::make_mut(&mut self.shape);
        if let Some(work) = shape.work.recut(&shape.positions)? {
            shape.work = work;
            self.quads = shape.work.quads().map(|quad| quad.map(|v| shape.name(v))).collect();
        }
        Ok(())
    }

    /// The new faces as triangles, quads cut in two.
    pub(crate) fn facets(&self) -> Vec<[u32; 3]> {
        self.shape.facets()
    }

    /// The edges of the new faces, once for each face, lower vertex first.
    pub(crate) fn sides(&self) -> impl Iterator<Item = [u32; 2]> {
        let quads = self.quads.iter().flat_map(|q| [0, 1, 2, 3].map(|k| [q[k], q[(k + 1) % 4]]));
        self.triangles.iter().flat_map(edges).chain(quads.map(|[a, b]| [a.min(b), a.max(b)]))
    }

    /// Extends data at the loop (`columns` values for each of its vertices, in the order of the loop as
    /// given, row by row) to the new vertices: harmonically, one factorisation for all columns, each
    /// value within the range of its column.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if the number of values does not fit, [`Error::NotFinite`], [`Error::Cancelled`].
    pub fn extend(&self, values: &[f64], columns: usize, progress: Progress<'_>) -> Result<Vec<f64>> {
        whole(progress, |progress| self.shape.extend(values, columns, progress))
    }

    /// The new vertices if those of the mesh were at `vertices`: the same triangles, solved again. For
    /// other poses of one mesh, such as shape keys; where the surroundings are equal, so is the result.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if there are not as many vertices as before, [`Error::NotFinite`] for one near
    /// the loop, [`Error::Cancelled`].
    pub fn refit(&self, vertices: &[DVec3], progress: Progress<'_>) -> Result<Vec<DVec3>> {
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
        whole(progress, |progress| self.solved(vertices, progress))
    }

    fn solved(&self, vertices: &[DVec3], progress: Progress<'_>) -> Result<Vec<DVec3>> {
        if !self.shape.creases.is_empty() {
            return self.shape.carried(vertices, progress);
        }
        let positions = match self.shape.bridged.as_slice() {
            [bridged] => self.shape.lofted(vertices, *bridged, progress)?,
            [_, _, ..] => return self.shape.carried(vertices, progress),
            [] => self.shape.solve(vertices, progress)?.positions,
        };
        Ok(positions[self.shape.work.inner()].to_vec())
    }
}

/// Runs work whose progress does not fall, and asks before and after it.
fn whole<T>(progress: Progress<'_>, work: impl FnOnce(Progress<'_>) -> Result<T>) -> Result<T> {
    steady(progress, |progress| {
        progress.report(0.0)?;
        let done = work(progress)?;
        progress.report(1.0)?;
        Ok(done)
    })
}

impl PartialEq for Fill {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices
            && self.triangles == other.triangles
            && self.quads == other.quads
            && self.loop_ == other.loop_
    }
}
