//! What can be chosen about a bridge.

use crate::error::{Error, Result, told};
use crate::fill::options::{FillOptions, Smooth};
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

impl BridgeOptions {
    /// What a tube has in common with a fill, after a look at all options.
    pub(super) fn rest(&self, triangles: &[[u32; 3]]) -> Result<FillOptions> {
        if self.rows == Some(0) {
            let allowed = "a whole number above 0, or nothing";
            return Err(Error::InvalidOption { name: "rows", value: "0".into(), allowed });
        }
        if !self.twist.is_finite() {
            let allowed = "a finite angle in radians";
            return Err(Error::InvalidOption { name: "twist", value: told(self.twist), allowed });
        }
        let rest = FillOptions {
            cells: self.cells,
            smooth: self.smooth,
            strict: self.strict,
            polygons: self.polygons.clone(),
            ..FillOptions::default()
        };
        rest.check(triangles)?;
        Ok(rest)
    }
}
