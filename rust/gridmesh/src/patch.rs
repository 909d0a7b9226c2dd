//! A flat patch: the planar mesh of a drawing.

use std::ops::Range;

use glam::DVec2;

use crate::lattice::Lattice;

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

/// A planar triangle mesh whose interior vertices all have valence six.
///
/// Boundary vertices are numbered first, loop by loop; they lie on the drawn contours. No interior
/// edge joins two boundary vertices, so that two copies glued along the boundary are a manifold.
/// No triangle is inverted, also after rounding to `f32` relative to `lattice.origin`.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Positions in the units of the drawing, boundary first.
    pub vertices: Vec<DVec2>,
    /// Vertex numbers, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The contours, outer first.
    pub loops: Vec<Loop>,
    /// Inlets of the drawing that boundary edges bridge by more than a twentieth of an edge: each
    /// the edge's first vertex, the drawn points beside it, the edge's last vertex. No interior
    /// vertex should come to lie in them.
    pub inlets: Vec<Vec<DVec2>>,
    /// The lattice that the patch was cut from.
    pub lattice: Lattice,
}

impl Patch {
    /// Number of boundary vertices: they are the vertices `0..n_boundary`.
    pub fn n_boundary(&self) -> usize {
        self.loops.iter().map(Loop::len).sum()
    }

    /// Signed area of the meshed region.
    pub fn area(&self) -> f64 {
        let doubled: f64 = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| self.vertices[v as usize]);
                (b - a).perp_dot(c - a)
            })
            .sum();
        0.5 * doubled
    }
}
