//! What is asked for of the meshes of a picture.

use crate::body::inflate::InflateOptions;
use crate::error::{Error, Result, told};
use crate::options::CellShape;

/// What is made of the parts of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct CutoutOptions {
    /// Triangles or quads of one side, shared by the parts according to their areas; at least 1.
    pub number: usize,
    /// Which of them.
    pub cells: CellShape,
    /// Where the boundary lies.
    pub rim: CutoutRim,
    /// How many times fainter than an edge what lies at the outlines is: of that more may be cut off. At least 1.
    pub faint: f64,
    /// How parts are inflated; `None` for flat sprites.
    pub body: Option<InflateOptions>,
    /// What is too thin, or lacks much, is meshed with up to so many times the number asked for; at least 1.
    ///
    /// Beyond 16 times only where no fewer can follow it, and with no more than 100 000 for the whole.
    pub most: f64,
}

impl Default for CutoutOptions {
    fn default() -> Self {
        Self {
            number: 1000,
            cells: CellShape::Triangle,
            rim: CutoutRim::Across,
            faint: 1.0,
            body: None,
            most: 250.0,
        }
    }
}

/// Where the boundaries of meshes lie to the outlines of a picture's parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutoutRim {
    /// Boundary vertices lie on the outlines.
    On,
    /// Edges lie across them, see [`Rim::Across`](crate::cover::Rim::Across).
    Across,
    /// They cover the parts, whose outlines have this margin in pixels around what is to be covered; see [`Rim::Around`](crate::cover::Rim::Around).
    Around {
        /// Above 0; what is covered of it is all but three quarters of a pixel.
        margin: f64,
    },
}

/// Why a mesh is finer than asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Finer {
    /// Fewer cells could not follow thin lines.
    Thin,
    /// Fewer would cut off more of its tips.
    CutOff,
    /// Fewer would follow the outline less closely.
    Area,
    /// Fewer had short edges.
    Short,
    /// Other parts have short edges.
    Beside,
}

impl CutoutOptions {
    /// Refuses what is not allowed.
    pub(super) fn check(&self) -> Result<()> {
        let at_least_1 = "a finite number, at least 1";
        if self.number == 0 {
            let name = self.cells.plural();
            return Err(Error::InvalidOption { name, value: "0".into(), allowed: "1 or more" });
        }
        for (name, value) in [("faint", self.faint), ("most", self.most)] {
            if !(value.is_finite() && value >= 1.0) {
                return Err(Error::InvalidOption { name, value: told(value), allowed: at_least_1 });
            }
        }
        if let Some(body) = &self.body {
            body.check()?;
        }
        match self.rim {
            CutoutRim::Around { margin } if !(margin.is_finite() && margin > 0.0) => {
                let allowed = "a finite number of pixels above 0";
                Err(Error::InvalidOption { name: "margin", value: told(margin), allowed })
            }
            _ => Ok(()),
        }
    }

    /// The length of the edges of so many cells of this area.
    pub(super) fn edge_length(&self, area: f64, number: f64) -> f64 {
        let cell = match self.cells {
            CellShape::Triangle => 0.25 * 3f64.sqrt(),
            CellShape::Quad => 1.0,
        };
        (area / number / cell).sqrt()
    }
}
