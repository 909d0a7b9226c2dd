//! Boundaries on bent lattices.

use std::iter::Peekable;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use crate::bend::conformal::Operators;
use crate::bend::{Bent, Ground, choose};
use crate::drawing::symmetry::Symmetry;
use crate::error::{Error, Result};
use crate::options::{BoundaryMethod, CellShape, Mirror, SketchOptions};
use crate::patch::place::loses_corners;
use crate::patch::placed::Placed;
use crate::path::outline::{Obstacle, Outline};
use crate::path::placement::Lattice;
use crate::progress::Progress;
use crate::sketch::found::Found;
use crate::sketch::job::{Asked, Effort, Job};

/// So many bends are traced at most, and so many for quads.
const TRACED: usize = 3;
const TRACED_OF_QUADS: usize = 2;

/// Shares of the bend that are tried too: of quads the first where no patch on the whole bend is good, of triangles while the
/// best patch has edges that are too long.
const WEAKER: [f64; 2] = [0.75, 0.5];

/// A bent lattice with the path of a drawing on it.
type Traced = (Bent, Lattice, Outline);

/// A patch with its lattice, or why there is none.
type Tried = (Traced, Result<Result<(Placed, Option<f64>), Obstacle>>);

/// What a path on a bent lattice costs beside others, in turns.
fn expected((bent, _, outline): &Traced) -> f64 {
    bent.price + bent.price_of_limbs + outline.cost
}

fn cheapest_first(mut traced: Vec<Traced>) -> Vec<Traced> {
    traced.sort_by(|a, b| expected(a).total_cmp(&expected(b)));
    traced
}

impl Job<'_> {
    /// True if the lattice may bend.
    fn bends(&self) -> bool {
        let options = self.options;
        options.bend > 0.0
            && options.boundary == BoundaryMethod::Optimal
            && options.angle.is_none()
            && options.origin.is_none()
    }

    /// The best patch on a bent lattice, by cost, faults and least angle; none where the lattice does not
    /// bend.
    pub(super) fn best_bent(
        &mut self,
        asked: Asked,
        effort: Effort,
        progress: Progress<'_>,
    ) -> Result<Option<Found>> {
        if effort != Effort::Full || !self.bends() {
            return Ok(None);
        }
        let started = Instant::now();
        let ground = unless_unsolved(self.ground(asked, progress))?;
        self.lap("bend", started);
        let Some((ground, operators)) = ground else { return Ok(None) };
        let ground = (&ground, &operators);
        match self.options.cells {
            CellShape::Triangle => self.best_bent_of_triangles(ground, asked, progress),
            CellShape::Quad => self.best_bent_of_quads(ground, asked, progress),
        }
    }

    /// Places patches on lattices until one is good; on those bent less where edges are too long.
    fn best_bent_of_triangles(
        &mut self,
        ground: (&Arc<Ground>, &Operators),
        asked: Asked,
        progress: Progress<'_>,
    ) -> Result<Option<Found>> {
        let mut best: Option<Found> = None;
        for strength in [1.0].into_iter().chain(WEAKER) {
            if strength < 1.0 && !best.as_ref().is_some_and(Found::is_uneven) {
                break;
            }
            let started = Instant::now();
            let mut bends = self.bends_by(strength, ground, TRACED, progress)?.into_iter().peekable();
            self.lap("bend", started);
            // The next bend is traced if the one before was not expected to be better, or is not good when it is placed.
            'placing: while bends.peek().is_some() {
                let started = Instant::now();
                let traced = self.next_traced(&mut bends, asked, progress)?;
                self.lap("bend", started);
                for next in cheapest_first(traced) {
                    let started = Instant::now();
                    let tried = self.placed(vec![next], progress);
                    self.lap("placement", started);
                    if self.keeps_good(tried, &mut best)? {
                        break 'placing;
                    }
                }
            }
        }
        Ok(best)
    }

    /// Places a patch on the most promising lattice, and where it is not good on the others, side by side: where the first is
    /// not they hardly ever are either, and the best of them all is sought.
    fn best_bent_of_quads(
        &mut self,
        ground: (&Arc<Ground>, &Operators),
        asked: Asked,
        progress: Progress<'_>,
    ) -> Result<Option<Found>> {
        let mut best: Option<Found> = None;
        let started = Instant::now();
        let mut bends = self.bends_by(1.0, ground, TRACED_OF_QUADS, progress)?.into_iter().peekable();
        let mut first = cheapest_first(self.next_traced(&mut bends, asked, progress)?);
        self.lap("bend", started);
        let started = Instant::now();
        // One that must lose a corner of the drawing will not be good.
        let count = if first.first().is_some_and(|first| self.loses_corners(first)) { 2 } else { 1 };
        let others = first.split_off(count.min(first.len()));
        let tried = self.placed(first, progress);
        self.lap("placement", started);
        if self.keeps_good(tried, &mut best)? {
            return Ok(best);
        }
        let started = Instant::now();
        let most = best.as_ref().map_or(f64::INFINITY, Found::score_of_bent);
        let rest = |mut others: Vec<Traced>, bends: Vec<(Bent, f64)>| -> Result<Vec<Tried>> {
            others.extend(self.all_traced(bends, asked, progress)?);
            others.retain(|traced| expected(traced) < most);
            Ok(self.placed(cheapest_first(others), progress))
        };
        let (tried, weaker) = rayon::join(
            || rest(others, bends.collect()),
            || rest(Vec::new(), self.bends_by(WEAKER[0], ground, TRACED_OF_QUADS, progress)?),
        );
        self.lap("placement", started);
        if !self.keeps_good(tried?, &mut best)? {
            self.keeps_good(weaker?, &mut best)?;
        }
        Ok(best)
    }

    /// The most promising bends by a share of what is asked for, each with what it is expected to cost.
    fn bends_by(
        &self,
        strength: f64,
        ground: (&Arc<Ground>, &Operators),
        count: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<(Bent, f64)>> {
        let bend = strength * self.options.bend;
        let mut bends = unless_unsolved(choose::candidates(ground, bend, count, progress.part(0.0, 0.1)))?;
        bends.iter_mut().for_each(|(bent, _)| bent.share *= strength);
        Ok(bends)
    }

    /// The next paths: until one is expected to be better than the next bend, and no corner of the drawing is lost. After a
    /// bend that has none, which those that follow seldom have either, all that are left, side by side.
    fn next_traced(
        &self,
        bends: &mut Peekable<impl Iterator<Item = (Bent, f64)>>,
        asked: Asked,
        progress: Progress<'_>,
    ) -> Result<Vec<Traced>> {
        let mut all = Vec::new();
        while let Some((bent, _)) = bends.next() {
            let Some(traced) = self.bent_outline(asked, bent, progress.part(0.1, 0.3))? else {
                all.extend(self.all_traced(bends.collect(), asked, progress)?);
                break;
            };
            let next = bends.peek().map_or(f64::INFINITY, |next| next.1);
            let is_enough = expected(&traced) <= next && !self.loses_corners(&traced);
            all.push(traced);
            if is_enough {
                break;
            }
        }
        Ok(all)
    }

    /// The paths on all bends that have one.
    fn all_traced(
        &self,
        bends: Vec<(Bent, f64)>,
        asked: Asked,
        progress: Progress<'_>,
    ) -> Result<Vec<Traced>> {
        let part = progress.part(0.1, 0.3);
        let traced: Vec<Result<Option<Traced>>> =
            bends.into_par_iter().map(|(bent, _)| self.bent_outline(asked, bent, part)).collect();
        traced.into_iter().filter_map(Result::transpose).collect()
    }

    /// Patches on lattices, placed side by side.
    fn placed(&self, traced: Vec<Traced>, progress: Progress<'_>) -> Vec<Tried> {
        let part = progress.part(0.3, 0.6);
        let place = |traced: Traced| {
            let (bent, lattice, outline) = &traced;
            let placed = self.place(Some(bent), lattice, outline, part);
            (traced, placed)
        };
        traced.into_par_iter().map(place).collect()
    }

    /// Keeps the best of patches up to the first that is good; true if there is one.
    fn keeps_good(&mut self, tried: Vec<Tried>, best: &mut Option<Found>) -> Result<bool> {
        for (traced, placed) in tried {
            if self.is_no_better(&traced, best.as_ref()) {
                continue;
            }
            self.placements += 1;
            let Ok((placed, mirror_error)) = placed? else { continue };
            if placed.fault(self.options).is_some() {
                continue;
            }
            let (bent, lattice, outline) = traced;
            let found = Found::new(Some((Arc::new(bent), lattice)), outline, placed, mirror_error);
            let is_good = found.is_good();
            if best.as_ref().is_none_or(|best| found.score_of_bent() < best.score_of_bent()) {
                *best = Some(found);
            }
            if is_good {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// True if a path of quads costs no less by itself than the best patch with all that speaks against that.
    fn is_no_better(&self, traced: &Traced, best: Option<&Found>) -> bool {
        self.options.cells == CellShape::Quad
            && best.is_some_and(|best| expected(traced) >= best.score_of_bent())
    }

    /// True if some corner of the drawing finds no vertex of a path of quads, so that their patch will not be good.
    fn loses_corners(&self, (bent, lattice, outline): &Traced) -> bool {
        self.options.cells == CellShape::Quad
            && loses_corners(&self.contours, &bent.lattice(lattice), outline, self.options)
    }

    /// What all bends of the drawing share, and what they are found with; none where it cannot bend.
    fn ground(&self, asked: Asked, progress: Progress<'_>) -> Result<Option<(Arc<Ground>, Operators)>> {
        let edge_length = match asked {
            Asked::EdgeLength(h) => h,
            Asked::Cells(n) => self.first_guess(n),
        };
        let ahead = self.symmetry.as_ref().map_or(self.farthest(), |symmetry| symmetry.axis.direction);
        let frame = Lattice { angle: ahead.to_angle(), origin: self.centre, edge_length };
        let density = self.options.density.as_ref();
        let is_symmetric = self.symmetry.is_some();
        let ground = Ground::new(&self.contours, frame, density, is_symmetric, self.options.cells, progress)?;
        ground.map(|ground| ground.operators(progress).map(|found| (Arc::new(ground), found))).transpose()
    }

    /// The boundary on the straight lattice of a bent plane, where there is one.
    fn bent_outline(&self, asked: Asked, bent: Bent, progress: Progress<'_>) -> Result<Option<Traced>> {
        let asked = match asked {
            Asked::EdgeLength(_) => Asked::EdgeLength(1.0),
            Asked::Cells(n) => Asked::Cells(n),
        };
        let symmetry = match &self.symmetry {
            None => None,
            Some(_) => {
                let mirror = Mirror::Axis { point: DVec2::ZERO, direction: bent.axis() };
                match Symmetry::find(bent.contours(), mirror, 1.0) {
                    Ok(symmetry) => Some(symmetry),
                    Err(_) => return Ok(None),
                }
            }
        };
        let along = symmetry.is_some().then_some(0.0);
        let options =
            SketchOptions { edge_length: None, triangles: None, angle: along, ..self.of_bent(&bent) };
        let job = self.in_bent_plane(&bent, &options, symmetry);
        let Some(&(angle, shift)) = job.placements_to_try(asked, Effort::Once).first() else {
            return Ok(None);
        };
        let found = job.outline(asked, Effort::Full, angle, shift, progress)?;
        self.bent_states.add(job.states.taken());
        let Ok((lattice, outline)) = found else { return Ok(None) };
        let outline = bent.outline(outline, &lattice);
        Ok(Some((bent, lattice, outline)))
    }

    /// The options in a bent plane.
    pub(super) fn of_bent(&self, bent: &Bent) -> SketchOptions {
        SketchOptions { closeness: bent.closeness(self.options), ..self.options.clone() }
    }

    /// The same job for the bent drawing.
    pub(super) fn in_bent_plane<'b>(
        &self,
        bent: &Bent,
        options: &'b SketchOptions,
        symmetry: Option<Symmetry>,
    ) -> Job<'b> {
        Job { proves: self.proves, ..Job::new(bent.contours().to_vec(), symmetry, options) }
    }

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
            ..self.of_bent(&bent)
        };
        let job = self.in_bent_plane(&bent, &options, None);
        let angle = lattice.angle;
        let asked = Asked::EdgeLength(lattice.edge_length);
        let found = job.outline(asked, Effort::Full, angle, DVec2::ZERO, progress.part(0.0, 0.3))?;
        self.bent_states.add(job.states.taken());
        let Ok((lattice, outline)) = found else { return Ok(None) };
        let outline = bent.outline(outline, &lattice);
        self.placements += 1;
        let placed = self.place(Some(&bent), &lattice, &outline, progress.part(0.3, 0.9))?;
        Ok(placed.ok().filter(|(placed, _)| placed.fault(self.options).is_none()).map(
            |(placed, mirror_error)| {
                Found::new(Some((Arc::new(bent), lattice)), outline, placed, mirror_error)
            },
        ))
    }
}

/// Nothing where the solver cannot go on: that is left to the straight lattice, and the report says so.
fn unless_unsolved<T: Default>(found: Result<T>) -> Result<T> {
    match found {
        Err(Error::Solver { .. }) => Ok(T::default()),
        found => found,
    }
}
