//! What can be chosen about a bridge.

use crate::fill::options::Smooth;
use crate::options::CellShape;

/// What can be chosen about a bridge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BridgeOptions {
    /// What the new faces are: with quads one triangle, if the sum of the loops' vertices is odd.
    pub cells: CellShape,
    /// How the tube continues the surfaces at its ends: straight from loop to loop, with their slope, or with their slope
    /// and curvature.
    pub smooth: Smooth,
    /// Rows of faces between the loops, at least one; `None`: as the edges' lengths ask for.
    pub rows: Option<usize>,
    /// By how much the second loop is turned on against the best fit, in radians.
    pub twist: f64,
    /// Refuse a tube that meets itself or the mesh, instead of counting that.
    pub strict: bool,
    /// See [`FillOptions::polygons`](crate::fill::FillOptions::polygons).
    pub polygons: Vec<u32>,
}
