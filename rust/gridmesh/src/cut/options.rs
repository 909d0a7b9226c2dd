//! What can be chosen about a cut.

use glam::DVec3;

use crate::error::{Error, Result, told, told_all};
use crate::fill::options::Smooth;
use crate::options::CellShape;

/// Which pieces to return.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// The one on the left of the stroke; of a closed stroke, what is inside.
    Left,
    /// The one on the right of the stroke; of a closed stroke, what is outside.
    Right,
    /// Both.
    #[default]
    Both,
}

impl Keep {
    /// True if `side`, which is not `Both`, is among them.
    pub fn has(self, side: Keep) -> bool {
        self == Keep::Both || self == side
    }
}

/// How the stroke becomes a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// Along this direction, which points away from the viewer; any length but zero.
    Along(DVec3),
    /// Through this point, the viewer's eye, to which the whole mesh must lie in front.
    Through(DVec3),
}

/// A plane of symmetry: the mesh is half of a symmetric one, open at this plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// A point of the plane.
    pub point: DVec3,
    /// Its normal, of length 1.
    pub normal: DVec3,
    /// Vertices no farther from it lie on it.
    pub within: f64,
}

impl Mirror {
    fn is_sound(&self) -> bool {
        self.point.is_finite() && self.normal.is_normalized() && self.within.is_finite() && self.within >= 0.0
    }

    /// Signed distance of a point from the plane.
    pub(super) fn off(&self, p: DVec3) -> f64 {
        (p - self.point).dot(self.normal)
    }
}

/// Options of [`cut`](super::cut).
#[derive(Clone, Debug, PartialEq)]
pub struct CutOptions {
    /// How the stroke becomes a surface.
    pub sweep: Sweep,
    /// Which pieces to return.
    pub keep: Keep,
    /// Close the pieces.
    pub cap: bool,
    /// Length of the edges along the cut; `None`: as the mesh's edges divide it.
    pub edge_length: Option<f64>,
    /// Width of what is taken away between the pieces: half of it on either side of the stroke. With an
    /// eye, at the mean distance of the stroke.
    pub gap: f64,
    /// How caps continue the surface.
    pub smooth: Smooth,
    /// The faces of caps. A cap of quads has one triangle if its lines have an odd number of edges in sum.
    pub cells: CellShape,
    /// Continue the ends of an open stroke to infinity. Otherwise they are continued as far as the part of the
    /// mesh that the stroke itself crosses: only those cut lines are cut that it meets, and others around the
    /// same caps. What it does not cross stays whole: on the side of the line on which all of it lies, or
    /// else, and where the line continued would cross what is cut elsewhere, in the larger piece, or in the only one that is kept.
    pub extend_ends: bool,
    /// Planes that the mesh is open at: cut lines with both ends on one of them are closed along it, flat.
    pub mirrors: Vec<Mirror>,
}

impl CutOptions {
    /// Both pieces, capped on the swept surface.
    pub fn new(sweep: Sweep) -> Self {
        CutOptions {
            sweep,
            keep: Keep::Both,
            cap: true,
            edge_length: None,
            gap: 0.0,
            smooth: Smooth::Flat,
            cells: CellShape::Triangle,
            extend_ends: true,
            mirrors: vec![],
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        let invalid = |name, value: String, allowed| Err(Error::InvalidOption { name, value, allowed });
        match self.sweep {
            Sweep::Along(d) if !(d.is_finite() && d != DVec3::ZERO) => {
                return invalid("direction", told_all(&d.to_array()), "three finite numbers, not all zero");
            }
            Sweep::Through(eye) if !eye.is_finite() => {
                return invalid("eye", told_all(&eye.to_array()), "three finite numbers");
            }
            _ => {}
        }
        if let Some(length) = self.edge_length.filter(|l| !(l.is_finite() && *l > 0.0)) {
            return invalid("edge_length", told(length), "a finite number above 0, or None");
        }
        if let Some(m) = self.mirrors.iter().find(|m| !m.is_sound()) {
            return invalid(
                "mirrors",
                format!(
                    "point {}, normal {}, distance {}",
                    told_all(&m.point.to_array()),
                    told_all(&m.normal.to_array()),
                    told(m.within)
                ),
                "finite points, normals that are not zero, of length 1, and distances of 0 or more",
            );
        }
        if !(self.gap.is_finite() && self.gap >= 0.0) {
            return invalid("gap", told(self.gap), "a finite number, 0 or more");
        }
        Ok(())
    }
}
