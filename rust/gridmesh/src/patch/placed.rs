//! A patch and what placing it cost.

use glam::DVec2;

use crate::options::SketchOptions;
use crate::patch::Patch;

/// A patch and what placing it cost.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) patch: Patch,
    /// For each loop the arc length of each vertex on its contour, from the contour's own first point:
    /// unlike that from the first input point it does not depend on where the drawing starts.
    pub(crate) arcs: Vec<Vec<f64>>,
    /// For each loop which vertices do not slide: on drawn corners, and where the drawing strayed.
    pub(crate) pinned: Vec<Vec<bool>>,
    /// Those among them that stay even if a cell starves there.
    pub(crate) held: Vec<Vec<bool>>,
    pub(crate) corners: usize,
    pub(crate) released_corners: usize,
    /// Corners wider than tips that the boundary cuts off: a mesh without them looks worn.
    pub(crate) worn: Vec<DVec2>,
    /// Greatest distance of the drawing from the boundary, in edges.
    pub(crate) max_deviation: f64,
    /// The same elsewhere than at blunted tips.
    pub(crate) strayed: f64,
    /// Boundary edges that bridge an inlet with a mesh vertex in it.
    pub(crate) bridged_inlets: usize,
    /// Boundary edges that cross others.
    pub(crate) crossings: usize,
}

impl Placed {
    /// In how many places a part of the drawing is lost in the mesh.
    pub(crate) fn lost(&self) -> usize {
        self.bridged_inlets + self.crossings
    }

    /// Why the patch is not to be had, if it is not; without relaxation bridges and crossings are no fault.
    pub(crate) fn fault(&self, options: &SketchOptions) -> Option<&'static str> {
        match self {
            _ if !options.relax => None,
            Placed { crossings: 1.., .. } => Some("two walls of the drawing are too near to each other"),
            Placed { bridged_inlets: 1.., .. } => Some("an inlet is narrower than the grid"),
            _ => None,
        }
    }
}
