//! A loop in the size that patches are made in.

use glam::DVec2;

use crate::error::{Error, Result};

/// A loop moved to the origin and scaled to edges of mean length one.
pub(super) struct Scaled {
    pub points: Vec<DVec2>,
    pub restore: Restore,
}

/// Takes a patch back to where its loop was.
pub(super) struct Restore {
    centre: DVec2,
    scale: f64,
}

impl Scaled {
    /// For a loop of which so much is wanted at each vertex.
    ///
    /// # Errors
    /// [`Error::TooFewPoints`], [`Error::NotFinite`].
    pub fn new(polygon: &[DVec2], wanted: usize) -> Result<Scaled> {
        let n = polygon.len();
        if n < 3 || wanted != n {
            return Err(Error::TooFewPoints { what: "loop".into(), distinct: n });
        }
        if let Some(point) = polygon.iter().position(|p| !p.is_finite()) {
            return Err(Error::NotFinite { what: "flattened loop".into(), point });
        }
        let centre = polygon.iter().sum::<DVec2>() / n as f64;
        let length: f64 = (0..n).map(|k| polygon[k].distance(polygon[(k + 1) % n])).sum();
        let scale = if length > 0.0 { length / n as f64 } else { 1.0 };
        let points = polygon.iter().map(|&p| (p - centre) / scale).collect();
        Ok(Scaled { points, restore: Restore { centre, scale } })
    }
}

impl Restore {
    /// The positions of a patch there.
    pub fn apply(&self, positions: &mut [DVec2]) {
        positions.iter_mut().for_each(|p| *p = *p * self.scale + self.centre);
    }

    /// That the loop has no patch.
    pub fn nothing(&self) -> Error {
        let reason = "no patch without an edge that the mesh has already".into();
        Error::NoPatch { reason, at: self.centre.to_array() }
    }
}
