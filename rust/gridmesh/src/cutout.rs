//! Meshes of all that a picture shows: its parts, with edges of about one length, no finer than is worth it.
//!
//! [`mesh_cutout`] meshes each part at fixed numbers of cells (`steps`), from the one asked for on, and takes the mesh whose number,
//! as many times as what it lacks is worth (`lacks`), is least. Then parts are made finer beside which others have short edges (`even`).

mod even;
mod lacks;
mod made;
mod options;
mod steps;

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use crate::body::inflate::inflate;
use crate::body::stitch::flat;
use crate::body::surface::Surface;
use crate::cover::{Covering, Rim, cover_sketch};
use crate::cutout::even::{Edges, evened};
use crate::cutout::lacks::{Allowed, Lacks, Measures};
use crate::cutout::made::{Made, best, is_coarse};
pub use crate::cutout::options::{CutoutOptions, CutoutRim, Finer};
use crate::cutout::steps::Step;
use crate::drawing::combine::Part;
use crate::error::{Error, Result};
use crate::options::{CellShape, DEFAULT_CORNER_ANGLE, SketchOptions};
use crate::patch::Patch;
use crate::progress::{Progress, Rising};
use crate::sketch::mesh_sketch;

/// How far whole pixels may reach over the outline of what they cover, at most: so much less than the margin has to be covered.
const SQUARE: f64 = 0.75;

/// Share of the time of a part that its outline takes; inflating takes the rest.
const OUTLINED: f64 = 0.7;

/// The meshes of a picture.
#[derive(Clone, Debug)]
pub struct Cutout {
    /// That of each part, or why there is none.
    pub surfaces: Vec<Result<Surface>>,
    /// Why most of what is finer than asked for is so; `None` if nothing is.
    pub finer: Option<Finer>,
}

/// Meshes the parts of a picture, as [`trace_image`](crate::picture::trace_image) finds them, with edges of about one length.
///
/// A part that lacks something with the cells that its share of `number` gives, as a tip that is cut off, or is too thin for
/// them, gets more, as far as that is worth it; of two numbers asked for the smaller never leads to a larger step. Parts are done in parallel.
///
/// # Errors
/// [`Error::InvalidOption`] if an option is not allowed; [`Error::Cancelled`]. What refuses a single part ([`mesh_sketch`], [`inflate`]) is its item.
pub fn mesh_cutout(parts: &[Part], options: &CutoutOptions, progress: Progress<'_>) -> Result<Cutout> {
    options.check()?;
    if parts.is_empty() {
        return Ok(Cutout { surfaces: Vec::new(), finer: None });
    }
    let rising = Rising::new(progress);
    let callback = |fraction: f64| rising.report(fraction);
    let search = Search {
        parts,
        options,
        measures: Measures::of(parts),
        known: parts.iter().map(|_| Mutex::default()).collect(),
        progress: Progress::new(&callback),
    };
    let asked = Step::nearest(options.number as f64);
    let each = (0..parts.len()).into_par_iter();
    // At least the first step was made.
    let best =
        |k: usize| search.best(k, asked)?.ok_or(Error::Internal { reason: "no step of a part was made" });
    let mut made = each.map(best).collect::<Result<Vec<Made>>>()?;
    let mut why: BTreeMap<Finer, f64> = BTreeMap::new();
    for k in (0..parts.len()).filter(|&k| made[k].step > asked) {
        if let Some(reason) = search.why_not(k, asked) {
            *why.entry(reason).or_default() += search.measures.areas[k];
        }
    }
    if parts.len() > 1 && options.cells == CellShape::Triangle {
        for k in evened(&mut made, |k, step| search.best(k, step))? {
            *why.entry(Finer::Beside).or_default() += search.measures.areas[k];
        }
    }
    search.progress.report(1.0)?;
    let finer = why.into_iter().max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(finer, _)| finer);
    Ok(Cutout { surfaces: made.into_iter().map(|made| made.surface).collect(), finer })
}

/// What is tried for the parts of a picture.
struct Search<'a> {
    parts: &'a [Part],
    options: &'a CutoutOptions,
    measures: Measures,
    /// By part, the meshes that were made.
    known: Vec<Mutex<BTreeMap<Step, Made>>>,
    progress: Progress<'a>,
}

impl Search<'_> {
    /// The best mesh of a part from a step on; none if each was known to be worse than what was asked for.
    fn best(&self, k: usize, first: Step) -> Result<Option<Made>> {
        best(first, self.options.number as f64, self.options.most, |step, score| self.made(k, step, score))
    }

    /// The mesh of a part at a step; none if its score is not below this one.
    fn made(&self, k: usize, step: Step, score: f64) -> Result<Option<Made>> {
        if let Some(made) = self.known(k).get(&step) {
            return Ok(Some(made.clone()));
        }
        let (count, part) = (self.parts.len() as f64, k as f64);
        let progress = self.progress.part(part / count, (part + 1.0) / count);
        let allowed = self.measures.allowed(k, step.number(), self.options);
        let made = match self.meshed(&self.parts[k], step, (&allowed, score), progress) {
            Ok(None) => return Ok(None),
            Ok(Some(made)) => made,
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            Err(error) => Made { surface: Err(error), step, lacks: Lacks::default() },
        };
        self.known(k).insert(step, made.clone());
        Ok(Some(made))
    }

    /// A mesh at a step, unless its score is not below this one.
    fn meshed(
        &self,
        part: &Part,
        step: Step,
        (allowed, score): (&Allowed, f64),
        progress: Progress<'_>,
    ) -> Result<Option<Made>> {
        let body = self.options.body.as_ref();
        let (patch, lacks) = self.outlined(part, step, allowed, progress.part(0.0, OUTLINED))?;
        let made = |surface: Surface, lacks: Lacks| Made { surface: Ok(surface), step, lacks };
        if libm::log2(step.number()) + lacks.sum() >= score {
            return Ok(None);
        }
        let Some(body) = body else {
            return Ok(Some(made(flat(&patch), lacks)));
        };
        let surface = inflate(&patch, body, progress.part(OUTLINED, 1.0))?;
        // Quads at a rim are low by themselves.
        let is_short = self.options.cells == CellShape::Triangle && Edges::of(&surface).has_short();
        Ok(Some(made(surface, if is_short { lacks.with_short() } else { lacks })))
    }

    /// The patch of a part, and what it lacks.
    fn outlined(
        &self,
        part: &Part,
        step: Step,
        allowed: &Allowed,
        progress: Progress<'_>,
    ) -> Result<(Patch, Lacks)> {
        let body = self.options.body.as_ref();
        let mut options = SketchOptions {
            edge_length: Some(self.options.edge_length(self.measures.area, step.number())),
            cells: self.options.cells,
            // Only flat corners have a single quad.
            open_corners: body.is_none(),
            corner_angle: body.map_or(DEFAULT_CORNER_ANGLE, |body| body.corner_angle),
            least: false,
            ..SketchOptions::default()
        };
        if body.is_none() && self.options.cells == CellShape::Triangle {
            // The even sizes of a straight lattice leave less that is empty around the ends of limbs, for some more irregular vertices, which
            // nobody sees on what is flat.
            options.bend = 0.0;
        }
        let rim = match self.options.rim {
            CutoutRim::On => {
                let sketch = mesh_sketch(&part.outline, &part.holes, &options, progress)?;
                return Ok((sketch.patch, Lacks::default()));
            }
            CutoutRim::Across => Rim::Across,
            CutoutRim::Around { margin } => {
                let slack = (margin - SQUARE).max(0.0);
                // The rims of bodies keep their lengths, while other edges become longer.
                match body {
                    None => Rim::Whole { slack, beyond: allowed.cut_off },
                    Some(_) => Rim::Around(slack),
                }
            }
        };
        let covering: Covering = cover_sketch(&part.outline, &part.holes, rim, &options, progress)?;
        let lacks = allowed.lacks(&covering);
        Ok((covering.sketch.patch, lacks))
    }

    /// What a part lacks at a step that was made.
    fn why_not(&self, k: usize, step: Step) -> Option<Finer> {
        match self.known(k).get(&step)? {
            Made { surface: Err(error), .. } => is_coarse(error).then_some(Finer::Thin),
            Made { lacks, .. } => lacks.gravest(),
        }
    }

    fn known(&self, k: usize) -> MutexGuard<'_, BTreeMap<Step, Made>> {
        self.known[k].lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod cutout_tests;
