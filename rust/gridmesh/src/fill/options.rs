//! What can be chosen about a fill.

use crate::error::{Error, Result, told};
use crate::options::CellShape;

/// How a patch continues the surface around its loop. One that would meet something then is flat, if that meets nothing.
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
    /// What the new faces are: with quads one triangle, if the loop is odd.
    pub cells: CellShape,
    /// How the patch continues the surface.
    pub smooth: Smooth,
    /// Refuse fills that meet themselves or the mesh, instead of counting that.
    pub strict: bool,
    /// Of [`fill_holes`](super::fill_holes) without given loops: leave holes with more edges open.
    pub max_edges: Option<usize>,
    /// For each triangle the polygon that it is a part of, the triangles of one following each other; empty
    /// if all are faces of their own. Vertices of the loop are then to be regular by the polygons' corners,
    /// not by diagonals that happen to cut them.
    pub polygons: Vec<u32>,
    /// Hard edges of the surroundings that run into a loop go on in the patch: edges with more than this angle (in
    /// radians) between their triangles.
    pub sharp: Option<f64>,
    /// With `sharp`: edges of the mesh that are hard whatever their angle is.
    pub creases: Vec<[u32; 2]>,
}

impl FillOptions {
    /// Refuses options that do not fit a mesh.
    pub(super) fn check(&self, triangles: &[[u32; 3]]) -> Result<()> {
        if let Some(angle) = self.sharp.filter(|angle| !(0.0..=std::f64::consts::PI).contains(angle)) {
            let allowed = "an angle from 0 to pi, in radians, or nothing";
            return Err(Error::InvalidOption { name: "sharp", value: told(angle), allowed });
        }
        if self.polygons.is_empty() || self.polygons.len() == triangles.len() {
            return Ok(());
        }
        Err(Error::InvalidOption {
            name: "polygons",
            value: format!("of length {}", self.polygons.len()),
            allowed: "one number for each triangle, or none",
        })
    }
}
