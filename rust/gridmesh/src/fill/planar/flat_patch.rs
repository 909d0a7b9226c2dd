//! Faces in the plane between loops, and how they were made.

use glam::DVec2;

use super::quality::Quality;

/// Faces in the plane between loops of n points together: vertices `0..n` are the loops', `n..` are new.
#[derive(Clone, Debug)]
pub(crate) struct FlatPatch {
    /// Positions of the new vertices.
    pub interior: Vec<DVec2>,
    /// Counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// How many pairs of them, from the first on, are quads.
    pub quads: usize,
}

impl FlatPatch {
    /// The faces that are quads.
    pub fn quads(&self) -> impl Iterator<Item = [u32; 4]> {
        quads_of(&self.triangles[..2 * self.quads])
    }

    /// The faces that are triangles.
    pub fn single(&self) -> &[[u32; 3]] {
        &self.triangles[2 * self.quads..]
    }

    /// The edges of the faces, once for each face, lower vertex first.
    pub fn sides(&self) -> impl Iterator<Item = [u32; 2]> {
        fn of<const N: usize>(face: [u32; N]) -> impl Iterator<Item = [u32; 2]> {
            (0..N).map(move |k| [face[k], face[(k + 1) % N]]).map(|[a, b]| [a.min(b), a.max(b)])
        }
        self.quads().flat_map(of).chain(self.single().iter().copied().flat_map(of))
    }
}

/// The quads of which these are halves: `[a, b, c]` and `[a, c, d]` are `[a, b, c, d]`.
pub(crate) fn quads_of(halves: &[[u32; 3]]) -> impl Iterator<Item = [u32; 4]> {
    halves.chunks_exact(2).map(|pair| {
        let ([a, b, c], [.., d]) = (pair[0], pair[1]);
        [a, b, c, d]
    })
}

/// A patch for one loop.
#[derive(Clone, Debug)]
pub(crate) struct FlatFill {
    pub patch: FlatPatch,
    /// How it was made.
    pub method: Method,
    /// What was counted and measured on it.
    pub quality: Quality,
    /// The polygon meets itself, or no embedding was found: the patch lies folded in the plane.
    pub folded: bool,
    /// Candidates that were made and measured.
    pub candidates: usize,
}

/// How a patch was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// The loop's own vertices, no others.
    NoInterior,
    /// One vertex in the middle.
    Centre,
    /// Lattice patch bounded by the cheapest path of n steps.
    Optimal,
    /// Lattice patch grown as the paper's section V does.
    Grown,
    /// Points of nested lattices, constrained Delaunay.
    Graded,
    /// Triangles for every second vertex, each cut into three quads.
    Refined,
}
