//! A flat patch: the planar mesh of a drawing.

pub(crate) mod angles;
pub(crate) mod deviation;
pub(crate) mod expel;
mod judge;
pub(crate) mod mirror;
pub(crate) mod open;
pub(crate) mod place;
pub(crate) mod placed;
pub(crate) mod pockets;
pub(crate) mod sizes;
mod tips;

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use crate::error::Result;
use crate::options::CellShape;
use crate::path::placement::Lattice;

/// One contour of a [`Patch`] as a cycle of boundary vertices.
///
/// The outer contour runs counter-clockwise, holes clockwise: the patch lies on the left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loop {
    /// The vertices of this loop are numbered consecutively, in order, from here.
    pub start: u32,
    /// Arc length of each vertex along its contour, from the contour's first input point in the
    /// loop's direction; cyclically increasing. Units of the drawing.
    pub arc: Vec<f64>,
    /// Input segment of each vertex (segment `i` joins input points `i` and `i + 1`) and the
    /// parameter on it, 0 to 1.
    pub source: Vec<(u32, f64)>,
    /// Turning angle (radians, positive where convex) of the drawn corner that a vertex lies on,
    /// zero for all other vertices.
    pub corner: Vec<f64>,
    /// Length of the contour.
    pub length: f64,
}

impl Loop {
    /// Number of vertices of the loop.
    pub fn len(&self) -> usize {
        self.arc.len()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.arc.is_empty()
    }

    /// The loop's vertex numbers.
    pub fn vertices(&self) -> Range<u32> {
        self.start..self.start + self.arc.len() as u32
    }
}

/// A planar mesh: of triangles whose interior vertices all have valence six, or of quads whose boundary
/// vertices have two of them, or one on a sharp convex corner of the drawing, and whose interior ones have valence four but
/// for one of three or five for each turn, or beside such a corner.
///
/// Boundary vertices are numbered first, loop by loop; they lie on the drawn contours. No interior
/// edge joins two boundary vertices, so that two copies glued along the boundary are a manifold; of quads those of [`Patch::belted`] are
/// glued.
/// No triangle is inverted and no quad is concave, also after rounding to `f32` relative to `lattice.origin`.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Positions in the units of the drawing, boundary first.
    pub vertices: Vec<DVec2>,
    /// Vertex numbers, counter-clockwise; none in a patch of quads.
    pub triangles: Vec<[u32; 3]>,
    /// Vertex numbers, counter-clockwise; none in a patch of triangles.
    pub quads: Vec<[u32; 4]>,
    /// The contours, outer first.
    pub loops: Vec<Loop>,
    /// Inlets of the drawing that boundary edges bridge by more than a twentieth of an edge: each
    /// the edge's first vertex, the drawn points beside it, the edge's last vertex. No interior
    /// vertex should come to lie in them.
    pub inlets: Vec<Vec<DVec2>>,
    /// The lattice that the patch was cut from.
    pub lattice: Lattice,
    /// The patch that bodies are made of, where sharp corners of this one have a single quad; see [`Patch::belted`].
    pub belt: Option<Arc<Patch>>,
}

impl Patch {
    /// Number of boundary vertices: they are the vertices `0..n_boundary`.
    pub fn n_boundary(&self) -> usize {
        self.loops.iter().map(Loop::len).sum()
    }

    /// What its cells are.
    pub fn cells(&self) -> CellShape {
        if self.quads.is_empty() { CellShape::Triangle } else { CellShape::Quad }
    }

    /// The patch that bodies are made of: itself, unless sharp corners of it have a single quad, whose vertex would have two
    /// edges in a body. There it has two quads at every boundary vertex, and vertices of its own.
    pub fn belted(&self) -> &Patch {
        self.belt.as_deref().unwrap_or(self)
    }

    /// Does the same to the patch and to the one that bodies are made of.
    pub(crate) fn both(&mut self, mut change: impl FnMut(&mut Patch) -> Result<()>) -> Result<()> {
        change(self)?;
        self.belt.as_mut().map_or(Ok(()), |belt| change(Arc::make_mut(belt)))
    }

    /// The triangles, or the quads each cut in two along its shorter diagonal.
    pub fn triangulated(&self) -> Cow<'_, [[u32; 3]]> {
        if self.quads.is_empty() {
            return Cow::Borrowed(&self.triangles);
        }
        let cut = |&[a, b, c, d]: &[u32; 4]| {
            let length =
                |v: u32, w: u32| self.vertices[v as usize].distance_squared(self.vertices[w as usize]);
            if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[b, c, d], [b, d, a]] }
        };
        self.quads.iter().flat_map(cut).collect()
    }

    /// The triangles that must all be positive for the patch to be valid: its own, or those at the four corners of
    /// each quad, which are the triangles of both its triangulations.
    pub fn corners(&self) -> Cow<'_, [[u32; 3]]> {
        if self.quads.is_empty() {
            return Cow::Borrowed(&self.triangles);
        }
        self.quads.iter().flat_map(|&[a, b, c, d]| [[d, a, b], [a, b, c], [b, c, d], [c, d, a]]).collect()
    }

    /// The sides of all faces as they run around them, so that those between two faces come twice.
    pub(crate) fn sides(&self) -> impl Iterator<Item = [u32; 2]> {
        let faces = self.triangles.iter().map(|t| &t[..]).chain(self.quads.iter().map(|q| &q[..]));
        faces.flat_map(|face| (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]))
    }

    /// The patch itself, or with its quads cut in two.
    pub(crate) fn of_triangles(&self) -> Cow<'_, Patch> {
        if self.quads.is_empty() {
            return Cow::Borrowed(self);
        }
        let triangles = self.triangulated().into_owned();
        Cow::Owned(Patch { triangles, quads: Vec::new(), belt: None, ..self.clone() })
    }

    /// Signed area of the meshed region.
    pub fn area(&self) -> f64 {
        let doubled: f64 = self
            .triangulated()
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| self.vertices[v as usize]);
                (b - a).perp_dot(c - a)
            })
            .sum();
        0.5 * doubled
    }
}
