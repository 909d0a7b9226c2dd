//! The mesh of a part at a number of cells, and the best of them.

use crate::body::surface::Surface;
use crate::cutout::lacks::Lacks;
use crate::cutout::steps::Step;
use crate::error::{Error, Result};

/// What no size below so many times the number asked for could follow is thin all over, and meshed with the first that can.
const THIN: f64 = 4.0;

/// The mesh of a part at a step.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub(super) surface: Result<Surface>,
    pub(super) step: Step,
    pub(super) lacks: Lacks,
}

impl Made {
    /// The less the better: binary logarithm of the cells, as many times as what it lacks is worth.
    pub(super) fn score(&self) -> f64 {
        libm::log2(self.step.number()) + self.lacks.sum()
    }
}

/// Whether no mesh of its size could follow a part.
pub(super) fn is_coarse(error: &Error) -> bool {
    matches!(error, Error::TooCoarse { .. } | Error::NoPatch { .. })
}

/// The best of all steps from the first on: only what it has and lacks itself decides, so that from a later one on none with
/// fewer cells is the best.
///
/// `make` makes that of a step, or nothing if its score is not below one. As many as asked for are made where they lack nothing;
/// steps whose number alone is worse than the best so far are not tried.
pub(super) fn best(
    first: Step,
    number: f64,
    most: f64,
    make: impl Fn(Step, f64) -> Result<Option<Made>>,
) -> Result<Option<Made>> {
    let mut found: Option<Made> = None;
    let mut refused: Option<Made> = None;
    for step in first.tried(number, most) {
        let score = found.as_ref().map_or(f64::INFINITY, Made::score);
        if libm::log2(step.number()) >= score {
            break;
        }
        let Some(made) = make(step, score)? else { continue };
        match &made.surface {
            Ok(_) if made.score() < score => {
                found = Some(made);
                if step.number() > THIN * number && refused.is_some() {
                    break;
                }
            }
            Ok(_) => {}
            Err(error) if is_coarse(error) => refused = refused.or(Some(made)),
            // Nothing finer helps, as where an outline meets itself.
            Err(_) => return Ok(found.or(Some(made))),
        }
    }
    Ok(found.or(refused))
}
