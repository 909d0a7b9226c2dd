//! The boundary on one lattice, of the size asked for.

use glam::DVec2;

use crate::error::Result;
use crate::options::{BoundaryMethod, SketchOptions};
use crate::patch::mirror;
use crate::path::outline::{Obstacle, Outline, grown, traced};
use crate::path::placement::Lattice;
use crate::progress::{Meter, Progress};
use crate::sketch::job::{Asked, Effort, Job, Miss};

/// States that pricing conflicts may take on one lattice, over all corrections of its edge length, and more for each
/// cell asked for: a fifth of a second. Where more are needed, nearly every vertex is in conflict with another.
const MOST_STATES: u64 = 1_500_000;
const MOST_STATES_EACH: f64 = 100.0;

impl Job<'_> {
    /// The outline for one placement, its work noted.
    pub(super) fn outline(
        &self,
        asked: Asked,
        effort: Effort,
        angle: f64,
        shift: DVec2,
        progress: Progress<'_>,
    ) -> Result<Result<(Lattice, Outline), Miss>> {
        let most = self.most_states(asked);
        let meter = match effort {
            Effort::Full | Effort::Once => Meter::new(most),
            Effort::Quick(less) => Meter::hasty(less.min(most)),
        };
        let found = self.sized(asked, effort, angle, shift, progress.metered(&meter));
        self.states.add(meter.taken());
        found
    }

    /// States that the search on one lattice may take.
    fn most_states(&self, asked: Asked) -> u64 {
        let cells = match asked {
            Asked::EdgeLength(h) => self.area / (self.options.cells.area() * h * h),
            Asked::Cells(n) => n as f64,
        };
        MOST_STATES + (MOST_STATES_EACH * cells) as u64
    }

    /// The outline for one placement; with a number of triangles asked for, the edge length is
    /// corrected until the number of cells is reached within 5 % (10 % are accepted in the end). Only then
    /// is a proof worth its time.
    fn sized(
        &self,
        asked: Asked,
        effort: Effort,
        angle: f64,
        shift: DVec2,
        progress: Progress<'_>,
    ) -> Result<Result<(Lattice, Outline), Miss>> {
        const CORRECTIONS: usize = 6;
        let unproved = SketchOptions { proof_nodes: 0, ..self.options.clone() };
        let mut edge_length = match asked {
            Asked::EdgeLength(h) => h,
            Asked::Cells(n) => self.first_guess(n),
        };
        let mut best: Option<(f64, Lattice, Outline)> = None;
        let mut obstacle =
            Obstacle::new("the number of triangles is not reached", self.contours[0].points()[0]);
        let mut before = None;
        let is_spent = || progress.meter().is_some_and(|meter| meter.left() == 0);
        for _ in 0..CORRECTIONS {
            progress.report(0.0)?;
            if before.is_some() && is_spent() {
                break;
            }
            let lattice = self.lattice(edge_length, angle, shift);
            let outline = match self.path(&lattice, &unproved, progress)? {
                Ok(outline) => outline,
                Err(found) => {
                    obstacle = found;
                    if effort != Effort::Full && is_spent() {
                        // With more effort it may end otherwise.
                        best = None;
                    }
                    break;
                }
            };
            let Asked::Cells(n) = asked else {
                best = Some((0.0, lattice, outline));
                break;
            };
            let ratio = outline.count(self.options.cells) as f64 / n as f64;
            let off = (ratio - 1.0).abs();
            if best.as_ref().is_none_or(|(least, ..)| off < *least) {
                best = Some((off, lattice, outline));
            }
            if off <= 0.05 {
                break;
            }
            // Of a drawing that is all outline the number changes less than by the square.
            let here = (libm::log(edge_length), libm::log(ratio));
            let power =
                before.map_or_else(|| self.guess(n).1, |(h, r): (f64, f64)| (r - here.1) / (here.0 - h));
            edge_length *= libm::pow(ratio, 1.0 / power.clamp(1.0, 2.0)).clamp(0.7, 1.4);
            before = Some(here);
        }
        let allowed = match asked {
            Asked::EdgeLength(_) => 0.0,
            // A handful of triangles comes in few sizes: 6, 10, 13, 14, 16...
            Asked::Cells(n) => f64::max(0.1, 6.0 / n as f64),
        };
        let is_near = |outline: &Outline| match asked {
            Asked::EdgeLength(_) => true,
            Asked::Cells(n) => (outline.count(self.options.cells) as f64 / n as f64 - 1.0).abs() <= allowed,
        };
        let Some((off, lattice, mut outline)) = best else {
            return Ok(Err(Miss { obstacle, is_of_count: false }));
        };
        if off > allowed {
            return Ok(Err(Miss { obstacle, is_of_count: true }));
        }
        let is_asked = self.proves && self.options.boundary == BoundaryMethod::Optimal;
        if is_asked && effort == Effort::Full && !outline.optimal {
            // It may come out a little larger or smaller.
            if let Ok(proved) = self.path(&lattice, self.options, progress)?
                && is_near(&proved)
            {
                outline = proved;
            }
        }
        Ok(Ok((lattice, outline)))
    }

    /// The outline for a shift of the lattice: proved only if without a proof it gives a patch, for most that are
    /// tried do not.
    pub(super) fn shifted(
        &self,
        asked: Asked,
        effort: Effort,
        angle: f64,
        shift: DVec2,
        progress: Progress<'_>,
    ) -> Result<Result<(Lattice, Outline), Miss>> {
        if effort == Effort::Full && self.proves {
            let unproved = self.outline(asked, Effort::Once, angle, shift, progress)?;
            let Ok((lattice, outline)) = &unproved else { return Ok(unproved) };
            let placed = self.place(None, lattice, outline, progress)?;
            if !placed.is_ok_and(|(placed, _)| placed.fault(self.options).is_none()) {
                return Ok(unproved);
            }
        }
        self.outline(asked, effort, angle, shift, progress)
    }

    fn path(
        &self,
        lattice: &Lattice,
        options: &SketchOptions,
        progress: Progress<'_>,
    ) -> Result<Result<Outline, Obstacle>> {
        if let Some(symmetry) = &self.symmetry {
            return mirror::traced(&self.contours, symmetry, lattice, options, progress);
        }
        match options.boundary {
            BoundaryMethod::Grown => grown(&self.contours[0], lattice, options, progress),
            BoundaryMethod::Optimal => traced(&self.contours, lattice, options, progress),
        }
    }
}
