//! What is told about a fill.

use crate::fill::layout::unroll::Unrolling;
use crate::fill::planar::flat_patch::Method;

/// Numbers about a [`super::Fill`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FillReport {
    /// New triangles; of a patch of quads one if its loops have an odd number of edges.
    pub triangles: usize,
    /// New quads.
    pub quads: usize,
    /// New vertices.
    pub vertices: usize,
    /// New vertices of valence other than six, or four in a patch of quads: poles.
    pub irregular: usize,
    /// Loop vertices that have a valence other than six now, edges of the mesh counted; with quads those whose number
    /// of new faces is not what the corners of the mesh there leave room for.
    pub irregular_loop: usize,
    /// How the patch was made.
    pub grid: Grid,
    /// Rows of faces between two loops, on average; 0 for a patch in one.
    pub rows: usize,
    /// True if no patch was found whose triangles are all counter-clockwise in the plane.
    pub folded: bool,
    /// Mean angle between the surface at the loop and a film in the loop, in radians: near zero where the
    /// surface goes on, about a right angle at the end of a tube.
    pub rim_angle: f64,
    /// How the loop was laid out in the plane.
    pub unrolling: Unrolling,
    /// Largest relative change of a loop edge's length thereby.
    pub distortion: f64,
    /// Loop edges whose neighbour is wound against most others.
    pub winding_conflicts: usize,
    /// Loop edges without a neighbour.
    pub wire_edges: usize,
    /// Smallest corner of a new face, in radians.
    pub min_angle: f64,
    /// Largest corner, in radians; more than pi where a quad is concave.
    pub max_angle: f64,
    /// Inner edges of the patch with more than 120 degrees between the triangles, and concave corners of quads.
    pub folds: usize,
    /// Pairs of triangles, at least one of them new, that meet where they should not; counted up to 100,000.
    pub self_intersections: usize,
    /// Hard edges of the surroundings that run into the loop; looked for only if they are to go on.
    pub creases: usize,
    /// Those of them that go on: all or none.
    pub creases_kept: usize,
    /// Fallbacks: solves that failed and were replaced by simpler ones, smooth patches that met something and are films.
    pub repaired: usize,
    /// Seconds spent in each stage.
    pub seconds: Vec<(&'static str, f64)>,
}

/// How a patch was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Grid {
    /// The loop's own vertices, no others.
    #[default]
    NoInterior,
    /// One vertex in the middle.
    Centre,
    /// A lattice patch: the cheapest of exactly as many edges as the loop.
    Lattice,
    /// A lattice patch grown as in the paper's section V.
    Grown,
    /// Points of nested lattices, for loops too uneven for one.
    Graded,
    /// Triangles for every second vertex of the loop, each cut into three quads.
    Refined,
    /// Triangles made even, or pairs of these cut in four, between three loops or more, or the ends of tubes from these.
    Even,
}

impl Grid {
    pub(super) fn of(method: Method) -> Self {
        match method {
            Method::NoInterior => Grid::NoInterior,
            Method::Centre => Grid::Centre,
            Method::Optimal => Grid::Lattice,
            Method::Grown => Grid::Grown,
            Method::Graded => Grid::Graded,
            Method::Refined => Grid::Refined,
        }
    }

    /// A stable word, for programs.
    pub fn word(self) -> &'static str {
        match self {
            Grid::NoInterior => "no_interior",
            Grid::Centre => "centre",
            Grid::Lattice => "lattice",
            Grid::Grown => "grown",
            Grid::Graded => "graded",
            Grid::Refined => "refined",
            Grid::Even => "even",
        }
    }
}
