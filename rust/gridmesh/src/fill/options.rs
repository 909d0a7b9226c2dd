//! What can be chosen about a fill.

/// How a patch continues the surface around its loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Smooth {
    /// Not at all: a soap film in the loop.
    Flat,
    /// With its slope.
    #[default]
    Tangent,
    /// With its slope and curvature.
    Curvature,
}

/// Options of [`fill_hole`](super::fill_hole) and [`fill_holes`](super::fill_holes).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FillOptions {
    /// How the patch continues the surface.
    pub smooth: Smooth,
    /// Refuse fills that meet themselves or the mesh, instead of counting that.
    pub strict: bool,
    /// Of [`fill_holes`](super::fill_holes) without given loops: leave holes with more edges open.
    pub max_edges: Option<usize>,
}
