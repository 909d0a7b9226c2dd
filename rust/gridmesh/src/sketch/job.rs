//! What is wanted of a lattice, and how hard it is tried.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use crate::bend::Bent;
use crate::drawing::contours::centroid;
use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::Symmetry;
use crate::drawing::thickness;
use crate::drawing::thickness::Limb;
use crate::error::{Error, Result};
use crate::lattice::axial::Axial;
use crate::lattice::grid::{Square, Triangular};
use crate::options::{CellShape, SketchOptions, SketchReport};
use crate::patch::Patch;
use crate::patch::angles::min_angle;
use crate::patch::mirror::{self, Partners};
use crate::patch::open::opened;
use crate::patch::place::place;
use crate::patch::placed::Placed;
use crate::path::outline::{Obstacle, Outline};
use crate::path::placement::{Laid, Lattice};
use crate::progress::{Meter, Progress};
use crate::sketch::found::Found;
use crate::sketch::kept::{Kept, Paths};

/// States that one search may take, and more for each triangle: where a drawing has no mesh most are spent to find out, and a
/// larger number is found sooner than it is shown that a smaller one fails.
const MOST: u64 = 200_000;
const MOST_EACH: u64 = 200;

#[derive(Clone, Copy)]
pub(crate) enum Asked {
    EdgeLength(f64),
    Cells(usize),
}

/// How hard to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    /// All placements.
    Full,
    /// One.
    Once,
    /// One, and a few shifts of it where it has a boundary but no patch; the search takes so many states at most and is given up where
    /// there is little hope. Now and then it ends with a patch where all placements have none.
    Quick(u64),
}

impl Effort {
    /// That with which it is told whether so many cells work. Whoever asks for them has it tried, too.
    pub(crate) fn quick(cells: f64) -> Self {
        Self::Quick(MOST + MOST_EACH * cells.round() as u64)
    }
}

pub(crate) struct Job<'a> {
    pub(crate) contours: Vec<ClosedCurve>,
    pub(crate) symmetry: Option<Symmetry>,
    pub(crate) options: &'a SketchOptions,
    /// Whether boundaries are proved, as far as the options say.
    pub(crate) proves: bool,
    /// The lattice that is to stay.
    pub(crate) keep: Option<&'a Kept>,
    pub(crate) area: f64,
    pub(crate) centre: DVec2,
    pub(crate) thinnest: Option<Limb>,
    pub(crate) seconds: Vec<(&'static str, f64)>,
    pub(crate) placements: usize,
    /// States that the searches of boundaries on straight lattices took.
    pub(crate) states: Meter,
    /// And on bent ones, which do not count where the others are bounded.
    pub(crate) bent_states: Meter,
}

/// Boundaries on several lattices.
struct Boundaries {
    /// The cheapest first.
    outlines: Vec<(Lattice, Outline)>,
    /// Some lattice gives a boundary, though maybe not of the number asked for.
    is_passable: bool,
    /// Why the first of the others gives none.
    obstacle: Option<Obstacle>,
}

impl<'a> Job<'a> {
    /// A job that proves and keeps nothing.
    pub(crate) fn new(
        contours: Vec<ClosedCurve>,
        symmetry: Option<Symmetry>,
        options: &'a SketchOptions,
    ) -> Self {
        let area = contours[0].area() - contours[1..].iter().map(ClosedCurve::area).sum::<f64>();
        let centre = centroid(contours[0].points());
        let centre = symmetry.as_ref().map_or(centre, |symmetry| symmetry.axis.foot(centre));
        Job {
            contours,
            symmetry,
            options,
            proves: false,
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
}

impl Job<'_> {
    pub(crate) fn lap(&mut self, stage: &'static str, since: Instant) {
        let spent = since.elapsed().as_secs_f64();
        match self.seconds.iter_mut().find(|s| s.0 == stage) {
            Some(known) => known.1 += spent,
            None => self.seconds.push((stage, spent)),
        }
    }

    pub(crate) fn attempt_unless_hopeless(
        &mut self,
        asked: Asked,
        expected: f64,
        progress: Progress<'_>,
    ) -> Result<Result<Sketch, Obstacle>> {
        if self.is_hopeless(expected.round() as usize) {
            let at = self.contours[0].points()[0];
            let reason = match self.options.cells {
                CellShape::Triangle => "the drawing is too thin for two rows of triangles",
                CellShape::Quad => "the drawing is too thin for three rows of quads",
            };
            return Ok(Err(Obstacle::new(reason, at)));
        }
        let found = self.attempt(asked, Effort::Full, progress)?;
        match found {
            Err(obstacle) if !self.proves && !obstacle.is_inverted => {
                // A number is said to work where this does.
                let found = self.attempt(asked, Effort::quick(expected), progress)?;
                Ok(found.map_err(|_| obstacle))
            }
            found => Ok(found),
        }
    }

    /// Tries lattice placements until one gives a valid patch of the size asked for: the angles
    /// first, cheapest boundary first, then shifts of the lattice. Where the cheapest boundary
    /// starves triangles or cuts off a tip, the other angles are tried too, and the best is taken.
    pub(crate) fn attempt(
        &mut self,
        asked: Asked,
        effort: Effort,
        progress: Progress<'_>,
    ) -> Result<Result<Sketch, Obstacle>> {
        if let Some(found) = self.on_kept(progress)? {
            return Ok(Ok(self.report(found, progress)?));
        }
        let mut bent = self.best_bent(asked, effort, progress)?;
        if let Some(found) = bent.take_if(|found| self.is_settled(found)) {
            return Ok(Ok(self.report(found, progress)?));
        }
        let mut best: Option<Found> = None;
        let started = Instant::now();
        let begun = self.states.taken();
        let lattices = self.placements_to_try(asked, effort);
        let mut first = None;
        if let (None, Some(found)) = (&self.symmetry, &bent) {
            // The first is the most promising: where it turns much more the others do not matter.
            let (angle, shift) = lattices[0];
            let traced = self.outline(asked, effort, angle, shift, progress.part(0.0, 0.3))?;
            if traced.as_ref().is_ok_and(|(_, outline)| outline.cost > MUCH * found.score())
                && let Some(found) = bent.take()
            {
                self.lap("boundary", started);
                return Ok(Ok(self.report(found, progress)?));
            }
            first = Some(traced);
        }
        let Boundaries { mut outlines, is_passable, mut obstacle } =
            self.boundaries(first, &lattices, asked, effort, progress.part(0.0, 0.3))?;
        if let Some(bent) = &bent {
            outlines.retain(|(_, outline)| outline.cost < bent.score());
        }
        self.lap("boundary", started);
        // Where no angle gives a boundary a shift does not either.
        let mut shifts = self.shifts(&lattices);
        shifts.truncate(match effort {
            Effort::Full if is_passable && bent.is_none() => usize::MAX,
            // Placements in jagged lines fail by chance.
            Effort::Quick(_) if !outlines.is_empty() => QUICK_SHIFTS,
            _ => 0,
        });
        let part_of = |k: usize| 0.4 + 0.5 * k as f64 / shifts.len() as f64;
        let mut shifts = shifts.iter().copied().enumerate();
        let mut outlines = outlines.into_iter();
        // The first alone, those after it side by side; where a bend is not good the first is seldom faultless either.
        let many = rayon::current_num_threads();
        let mut count = if bent.is_some() { many } else { 1 };
        'placing: loop {
            let mut next: Vec<(Lattice, Outline)> = outlines.by_ref().take(count).collect();
            count = many;
            if next.is_empty() {
                if best.as_ref().is_some_and(|best| best.placed.fault(self.options).is_none())
                    || self.states.taken() - begun > STATES_BEFORE_SHIFTS
                {
                    break;
                }
                let Some((k, (angle, shift))) = shifts.next() else { break };
                let started = Instant::now();
                let part = progress.part(part_of(k), part_of(k + 1));
                let found = self.shifted(asked, effort, angle, shift, part)?;
                self.lap("boundary", started);
                match found {
                    Ok(found) => next.push(found),
                    Err(miss) => {
                        obstacle = obstacle.or(Some(miss.obstacle));
                        continue;
                    }
                }
            }
            let started = Instant::now();
            let part = progress.part(0.3, 0.9);
            let place = |(lattice, outline): (Lattice, Outline)| {
                let placed = self.place(None, &lattice, &outline, part);
                (outline, placed)
            };
            let placed: Vec<_> = next.into_par_iter().map(place).collect();
            self.lap("placement", started);
            for (outline, placed) in placed {
                self.placements += 1;
                match placed? {
                    Ok((placed, mirror_error)) => {
                        let found = Found::new(None, outline, placed, mirror_error);
                        let is_faultless = found.faults == 0.0;
                        if best.as_ref().is_none_or(|best| found.faults < best.faults) {
                            best = Some(found);
                        }
                        if is_faultless {
                            break 'placing;
                        }
                    }
                    Err(found) => obstacle = Some(found),
                }
            }
        }
        if let Some(bent) = bent
            && best.as_ref().is_none_or(|best| best.lost() || bent.score() < best.score())
        {
            best = Some(bent);
        }
        match (best, obstacle) {
            (Some(best), _) => Ok(match best.placed.fault(self.options) {
                Some(reason) => {
                    let at = best.placed.patch.inlets.first().map_or(self.centre, |inlet| inlet[0]);
                    Err(Obstacle::new(reason, at))
                }
                None => Ok(self.report(best, progress)?),
            }),
            (None, Some(obstacle)) => Ok(Err(obstacle)),
            (None, None) => Err(Error::Internal { reason: "no lattice was tried" }),
        }
    }

    /// The cheapest boundaries on lattices, in parallel; that on the first may be known.
    fn boundaries(
        &self,
        first: Option<Result<(Lattice, Outline), Miss>>,
        lattices: &[(f64, DVec2)],
        asked: Asked,
        effort: Effort,
        progress: Progress<'_>,
    ) -> Result<Boundaries> {
        let rest = &lattices[usize::from(first.is_some())..];
        let found: Vec<Result<Result<(Lattice, Outline), Miss>>> = rest
            .par_iter()
            .map(|&(angle, shift)| self.outline(asked, effort, angle, shift, progress))
            .collect();
        let (mut outlines, mut obstacle) = (vec![], None);
        let mut is_passable = self.symmetry.is_some();
        for found in first.map(Ok).into_iter().chain(found) {
            match found? {
                Ok(found) => {
                    is_passable = true;
                    outlines.push(found);
                }
                Err(miss) => {
                    is_passable |= miss.is_of_count;
                    obstacle = obstacle.or(Some(miss.obstacle));
                }
            }
        }
        outlines.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
        Ok(Boundaries { outlines, is_passable, obstacle })
    }

    /// True if no straight lattice is tried beside a bent one: it has no faults, and with quads hardly more turns than
    /// there must be. Of 198 drawings whose bent triangles had no faults none had a straight lattice that cost less.
    pub(crate) fn is_settled(&self, found: &Found) -> bool {
        const FEW: usize = 12;
        let cells = self.options.cells;
        let price = found.bent.as_ref().map_or(0.0, |(bent, _)| bent.price);
        let is_plain = || price < 1.0 && found.outline.turns(cells) <= FEW * self.contours.len();
        found.is_good() && (cells == CellShape::Triangle || is_plain())
    }

    /// The patch of an outline, symmetric if that was asked for; and by how much it is not.
    pub(crate) fn place(
        &self,
        bent: Option<&Bent>,
        lattice: &Lattice,
        outline: &Outline,
        progress: Progress<'_>,
    ) -> Result<Result<(Placed, Option<f64>), Obstacle>> {
        let cells = self.options.cells;
        let placed = match bent {
            None => {
                let laid = |points: &[Axial]| match cells {
                    CellShape::Triangle => points.iter().map(|&p| Triangular::units(p)).collect(),
                    CellShape::Quad => points.iter().map(|&p| Square::units(p)).collect(),
                };
                place(&self.contours, lattice, laid, outline, self.options, progress)?
            }
            Some(bent) => {
                let laid = |points: &[Axial]| match cells {
                    CellShape::Triangle => bent.positions::<Triangular>(outline, lattice, points),
                    CellShape::Quad => bent.positions::<Square>(outline, lattice, points),
                };
                place(&self.contours, &bent.lattice(lattice), laid, outline, self.options, progress)?
            }
        };
        Ok(match &self.symmetry {
            None => placed.map(|placed| (placed, None)),
            Some(symmetry) => placed
                .and_then(|p| {
                    let lattice = &p.patch.lattice;
                    let partners = Partners::of(&self.contours, symmetry, outline, lattice, cells)?;
                    mirror::symmetrised(&self.contours, symmetry, &partners, p, self.options)
                })
                .map(|(placed, error)| (placed, Some(error))),
        })
    }

    /// A patch of quads with its sharp corners opened, if it has any; and by how much it is not symmetric.
    fn opened(&self, found: &Found, progress: Progress<'_>) -> Result<Option<(Placed, Option<f64>)>> {
        let Found { placed, outline, .. } = found;
        let SketchOptions { cells, relax, open_corners, .. } = *self.options;
        if cells != CellShape::Quad || !relax || !open_corners {
            return Ok(None);
        }
        let Some(symmetry) = &self.symmetry else {
            return opened(&self.contours, placed, None, self.options, progress);
        };
        let partners = Partners::of(&self.contours, symmetry, outline, &placed.patch.lattice, cells);
        match &partners {
            Ok(partners) => {
                opened(&self.contours, placed, Some((symmetry, partners)), self.options, progress)
            }
            Err(_) => Ok(None),
        }
    }

    /// The patch with its numbers.
    pub(crate) fn report(&mut self, mut found: Found, progress: Progress<'_>) -> Result<Sketch> {
        let started = Instant::now();
        let opened = self.opened(&found, progress)?;
        self.lap("corners", started);
        let belt = opened.map(|(placed, mirror_error)| {
            found.mirror_error = mirror_error;
            std::mem::replace(&mut found.placed, placed).patch
        });
        let Found { bent, outline, placed, mirror_error, .. } = found;
        let started = Instant::now();
        let mut patch = placed.patch;
        patch.belt = belt.map(|belt| {
            let lattice = belt.lattice.of_least_angle(self.options.cells);
            Arc::new(Patch { lattice, ..belt })
        });
        let laid_on = bent.as_ref().map_or(patch.lattice, |(_, lattice)| *lattice);
        let cells = self.options.cells;
        // Each contour turns four times at least.
        let (is_quads, least_poles) = (cells == CellShape::Quad, 8 * self.contours.len());
        patch.lattice = patch.lattice.of_least_angle(self.options.cells);
        let mut report = SketchReport {
            triangles: patch.triangles.len(),
            quads: patch.quads.len(),
            irregular: outline.irregular(cells),
            minimum_irregular: if is_quads { least_poles } else { 6 + 3 * (self.contours.len() - 1) },
            poles: if is_quads { outline.irregular(cells) } else { 0 },
            minimum_poles: if is_quads { least_poles } else { 0 },
            turns: outline.turns(cells),
            turns_before: outline.turns_before,
            turns_bound: outline.turns_bound,
            cost: outline.cost,
            cost_bound: outline.cost_bound,
            optimal: outline.optimal,
            max_distance_used: outline.max_distance_used,
            max_deviation: placed.max_deviation,
            bridged_inlets: placed.bridged_inlets,
            min_angle: min_angle(&patch),
            corners: placed.corners,
            released_corners: placed.released_corners,
            across: self.thinnest.map(|limb| thickness::across(limb.width, patch.lattice.edge_length, cells)),
            repaired: self.contours.iter().map(ClosedCurve::repaired).sum(),
            mirror_error,
            bend: bent.as_ref().map_or(0.0, |(bent, _)| bent.share * self.options.bend),
            scale_range: bent.as_ref().map_or(1.0, |(bent, _)| bent.scale_range()),
            placements: self.placements,
            search_states: self.states.taken() + self.bent_states.taken(),
            seconds: Vec::new(),
        };
        self.lap("report", started);
        report.seconds = self.seconds.clone();
        let kept = Kept::new(patch.lattice, bent, Paths { lattice: laid_on, outline });
        Ok(Sketch { patch, report, kept })
    }
}

/// Straight lattices are not tried where the cost of the first is so many times that of a bent one.
const MUCH: f64 = 1.2;

/// Shifts of the lattice that are tried with little effort.
const QUICK_SHIFTS: usize = 2;

/// After so many states no more shifts of the lattice are tried: half a second. Of 1416 outlines that took long at 500 triangles
/// none had its patch later.
const STATES_BEFORE_SHIFTS: u64 = 4_500_000;

/// A flat patch with the numbers of its making.
#[derive(Clone, Debug)]
pub struct Sketch {
    /// The patch.
    pub patch: Patch,
    /// What was done.
    pub report: SketchReport,
    /// Its lattice, to be kept for drawings that differ a little.
    pub kept: Kept,
}

/// Why a lattice angle gives no boundary of the size asked for.
pub(crate) struct Miss {
    pub(super) obstacle: Obstacle,
    /// There is a boundary, but with too many or too few triangles: a shift of the lattice may help.
    pub(super) is_of_count: bool,
}
