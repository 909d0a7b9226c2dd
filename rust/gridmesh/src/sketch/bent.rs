//! Boundaries on bent lattices.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;

use super::centroid;
use crate::bend::conformal::Operators;
use crate::bend::{Bent, Ground, choose};
use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::Symmetry;
use crate::error::{Error, Result};
use crate::options::{BoundaryMethod, CellShape, Mirror, SketchOptions};
use crate::patch::place::loses_corners;
use crate::path::outline::Outline;
use crate::path::placement::Lattice;
use crate::progress::{Meter, Progress};
use crate::sketch::found::Found;
use crate::sketch::job::{Asked, Effort, Job};

/// So many bends are traced at most, and so many for quads.
const TRACED: usize = 3;
const TRACED_OF_QUADS: usize = 2;

/// Shares of the bend that are tried too: of quads the first where no patch on the whole bend is good, of triangles while the
/// best patch has edges that are too long.
const WEAKER: [f64; 2] = [0.75, 0.5];

/// What a path on a bent lattice costs beside others, in turns.
fn expected((bent, _, outline): &(Bent, Lattice, Outline)) -> f64 {
    bent.price + bent.price_of_limbs + outline.cost
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
        let mut best: Option<Found> = None;
        if let Some((ground, operators)) = ground {
            let ground = (&ground, &operators);
            let is_good = self.best_bent_by(1.0, ground, asked, &mut best, progress)?;
            match self.options.cells {
                CellShape::Quad if !is_good => {
                    self.best_bent_by(WEAKER[0], ground, asked, &mut best, progress)?;
                }
                CellShape::Quad => {}
                CellShape::Triangle => {
                    for strength in WEAKER {
                        if best.as_ref().is_some_and(Found::is_uneven) {
                            self.best_bent_by(strength, ground, asked, &mut best, progress)?;
                        }
                    }
                }
            }
        }
        Ok(best)
    }

    /// Places patches on lattices bent by a share of what is asked for until one is good, and keeps the best; true if one
    /// was good.
    fn best_bent_by(
        &mut self,
        strength: f64,
        ground: (&Arc<Ground>, &Operators),
        asked: Asked,
        best: &mut Option<Found>,
        progress: Progress<'_>,
    ) -> Result<bool> {
        let started = Instant::now();
        let bend = strength * self.options.bend;
        let count = if self.options.cells == CellShape::Quad { TRACED_OF_QUADS } else { TRACED };
        let bends = unless_unsolved(choose::candidates(ground, bend, count, progress.part(0.0, 0.1)))?;
        self.lap("bend", started);
        let mut bends = bends.into_iter().peekable();
        // The next bend is traced if the one before was not expected to be better, or is not good when it is placed.
        while bends.peek().is_some() {
            let started = Instant::now();
            let mut outlines: Vec<(Bent, Lattice, Outline)> = Vec::new();
            while let Some((mut bent, _)) = bends.next() {
                bent.share *= strength;
                let Some(traced) = self.bent_outline(asked, bent, progress.part(0.1, 0.3))? else { continue };
                let next = bends.peek().map_or(f64::INFINITY, |next| next.1);
                let is_enough = expected(&traced) <= next && !self.loses_corners(&traced);
                outlines.push(traced);
                if is_enough {
                    break;
                }
            }
            outlines.sort_by(|a, b| expected(a).total_cmp(&expected(b)));
            self.lap("bend", started);
            if self.best_placed(outlines, best, progress)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Places patches until one is good, and keeps the best; true if one was good. One that must lose a corner of the drawing
    /// will not be good: the next is placed at the same time.
    fn best_placed(
        &mut self,
        outlines: Vec<(Bent, Lattice, Outline)>,
        best: &mut Option<Found>,
        progress: Progress<'_>,
    ) -> Result<bool> {
        let mut outlines = VecDeque::from(outlines);
        while let Some(first) = outlines.pop_front() {
            if self.is_no_better(&first, best.as_ref()) {
                continue;
            }
            let started = Instant::now();
            let second = if self.loses_corners(&first) { outlines.pop_front() } else { None };
            let part = progress.part(0.3, 0.6);
            let place = |(bent, lattice, outline): &(Bent, Lattice, Outline)| {
                self.place(Some(bent), lattice, outline, part)
            };
            let (placed, beside) = rayon::join(|| place(&first), || second.as_ref().map(place));
            self.lap("placement", started);
            for (traced, placed) in [(Some(first), Some(placed)), (second, beside)] {
                let (Some(traced), Some(placed)) = (traced, placed) else { continue };
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
        }
        Ok(false)
    }

    /// True if a path of quads costs no less by itself than the best patch with all that speaks against that.
    fn is_no_better(&self, traced: &(Bent, Lattice, Outline), best: Option<&Found>) -> bool {
        self.options.cells == CellShape::Quad
            && best.is_some_and(|best| expected(traced) >= best.score_of_bent())
    }

    /// True if some corner of the drawing finds no vertex of a path of quads, so that their patch will not be good.
    fn loses_corners(&self, (bent, lattice, outline): &(Bent, Lattice, Outline)) -> bool {
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
    fn bent_outline(
        &self,
        asked: Asked,
        bent: Bent,
        progress: Progress<'_>,
    ) -> Result<Option<(Bent, Lattice, Outline)>> {
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
        let Some(&(angle, shift)) = job.placements_to_try(asked, Effort::Quick(0)).first() else {
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
        let contours = bent.contours().to_vec();
        let area = contours[0].area() - contours[1..].iter().map(ClosedCurve::area).sum::<f64>();
        let centre = centroid(contours[0].points());
        let centre = symmetry.as_ref().map_or(centre, |symmetry| symmetry.axis.foot(centre));
        Job {
            contours,
            symmetry,
            options,
            proves: self.proves,
            keep: None,
            area,
            centre,
            thinnest: None,
            seconds: Vec::new(),
            placements: 0,
            states: Meter::new(u64::MAX),
            bent_states: Meter::new(u64::MAX),
        }
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
