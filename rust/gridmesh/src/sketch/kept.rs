//! Lattices that stay while a drawing changes step by step.

use std::sync::Arc;

use crate::bend::Bent;
use crate::bend::shown::Shown;
use crate::error::{Error, Result};
use crate::options::SketchOptions;
use crate::path::outline::Outline;
use crate::path::placement::Lattice;
use crate::progress::Progress;

/// The lattice of a patch, with its bend: [`mesh_sketch_on`](crate::sketch::mesh_sketch_on).
///
/// It belongs to the plane in which it was made and has the size of the drawing. Cheap to clone.
#[derive(Clone)]
pub struct Kept {
    /// The lattice of the patch.
    pub lattice: Lattice,
    /// The map, and the straight lattice of the bent plane.
    pub(super) bent: Option<(Arc<Bent>, Lattice)>,
    /// The paths of the patch; none for a lattice alone.
    pub(super) paths: Option<Arc<Paths>>,
}

/// The boundary of a patch as paths on a lattice, which is straight or that of the bent plane.
pub(super) struct Paths {
    pub(super) lattice: Lattice,
    pub(super) outline: Outline,
}

impl Kept {
    /// A lattice, straight unless it comes with a map.
    pub(super) fn new(lattice: Lattice, bent: Option<(Arc<Bent>, Lattice)>, paths: Paths) -> Self {
        Self { lattice, bent, paths: Some(Arc::new(paths)) }
    }

    /// A straight lattice.
    pub fn straight(lattice: Lattice) -> Self {
        Self { lattice, bent: None, paths: None }
    }

    /// The bend, for pictures of it; none where the lattice is straight. `options` are those of the patch.
    ///
    /// # Errors
    /// [`Error::Cancelled`], [`Error::Solver`].
    pub fn shown(&self, options: &SketchOptions, progress: Progress<'_>) -> Result<Option<Shown>> {
        let Some((bent, lattice)) = &self.bent else { return Ok(None) };
        bent.shown(*lattice, bent.closeness(options), progress).map(Some)
    }

    /// The options for a straight lattice that stays.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if the options decide what the lattice does.
    pub(super) fn options(&self, options: &SketchOptions) -> Result<SketchOptions> {
        let is_asked = options.edge_length.is_some() || options.triangles.is_some() || options.automatic;
        let is_laid = options.angle.is_some() || options.origin.is_some() || options.mirror.is_some();
        if is_asked || is_laid {
            return Err(Error::InvalidOption {
                name: "keep",
                value: "given beside what it decides".to_owned(),
                allowed: "no edge_length, number of cells, angle, origin or mirror beside it, or none",
            });
        }
        Ok(SketchOptions {
            edge_length: Some(self.lattice.edge_length),
            triangles: None,
            automatic: false,
            angle: Some(self.lattice.angle),
            origin: Some(self.lattice.origin),
            ..options.clone()
        })
    }
}

impl std::fmt::Debug for Kept {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Kept").field("lattice", &self.lattice).field("bent", &self.bent.is_some()).finish()
    }
}
