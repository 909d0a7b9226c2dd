//! Lattices that stay while a drawing changes step by step.

use std::sync::Arc;

use super::job::{Asked, Effort, Found, Job, faults};
use crate::bend::Bent;
use crate::error::{Error, Result};
use crate::options::SketchOptions;
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
    bent: Option<(Arc<Bent>, Lattice)>,
}

impl Kept {
    /// A lattice, straight unless it comes with a map.
    pub(super) fn new(lattice: Lattice, bent: Option<(Arc<Bent>, Lattice)>) -> Self {
        Self { lattice, bent }
    }

    /// A straight lattice.
    pub fn straight(lattice: Lattice) -> Self {
        Self { lattice, bent: None }
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

impl Job<'_> {
    /// The patch on the bent lattice that is to be kept; none where there is none, or none that the drawing
    /// can follow.
    pub(super) fn on_kept(&mut self, progress: Progress<'_>) -> Result<Option<Found>> {
        let Some((bent, lattice)) = self.keep.and_then(|kept| kept.bent.as_ref()) else {
            return Ok(None);
        };
        let Some(bent) = bent.followed(&self.contours) else { return Ok(None) };
        let options = SketchOptions {
            edge_length: None,
            triangles: None,
            angle: Some(lattice.angle),
            origin: Some(lattice.origin),
            ..self.of_bent()
        };
        let job = self.in_bent_plane(&bent, &options, None);
        let angle = lattice.angle;
        let asked = Asked::EdgeLength(lattice.edge_length);
        let found = job.outline(asked, Effort::Full, angle, glam::DVec2::ZERO, progress.part(0.0, 0.3))?;
        let Ok((lattice, outline)) = found else { return Ok(None) };
        let outline = bent.outline(outline, &lattice);
        self.placements += 1;
        let placed = self.place(Some(&bent), &lattice, &outline, progress.part(0.3, 0.9))?;
        Ok(placed.ok().filter(|(placed, _)| placed.fault(self.options).is_none()).map(
            |(placed, mirror_error)| {
                let bent = Some((Arc::new(bent), lattice));
                Found { faults: faults(&placed), bent, outline, placed, mirror_error }
            },
        ))
    }
}
