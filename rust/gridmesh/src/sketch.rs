//! From a drawn outline to a flat patch: the whole of the paper's section IV.

mod bent;
mod lattices;
mod least;
mod size;

use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;
use size::Miss;

use crate::axial::Axial;
use crate::bend::Bent;
use crate::contours::read_contours;
use crate::curve::ClosedCurve;
use crate::error::{Error, Needed, Result};
use crate::lattice::Lattice;
use crate::mirror;
use crate::options::{
    BoundaryMethod, DEFAULT_TRIANGLES, Density, LEAST_CHOSEN, MAX_TRIANGLES, SelfCrossing, SketchOptions,
    SketchReport,
};
use crate::outline::{Obstacle, Outline};
use crate::patch::Patch;
use crate::place::{Placed, min_angle, min_angle_off_corners, place};
use crate::progress::{Progress, Rising};
use crate::symmetry::Symmetry;
use crate::thickness::{self, Limb};
use crate::union::{nearest_source, outer_outline};

/// A placement whose triangles have this angle, 14 degrees, away from drawn corners, and which lies
/// this close to the drawing, in edges, is good enough not to try another lattice angle.
const ENOUGH: (f64, f64) = (14.0 * std::f64::consts::PI / 180.0, 1.0);

/// Faults of a patch on a bent lattice up to which no straight one is tried, and how many turns a fault
/// of one outweighs between the two.
const SLIGHT: f64 = 0.1;
const TURNS_OF_FAULT: f64 = 12.0;

/// Where a patch on a bent lattice has triangles below this angle, 20 degrees, others are placed too; and
/// how many turns it outweighs that an angle is zero.
const GOOD_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;
const TURNS_OF_ANGLE: f64 = 16.0;

/// A flat patch with the numbers of its making.
#[derive(Clone, Debug)]
pub struct Sketch {
    /// The patch.
    pub patch: Patch,
    /// What was done.
    pub report: SketchReport,
}

/// Meshes the inside of a closed planar drawing.
///
/// `outline` is closed implicitly, in either direction, in any units; it is not modified. `holes`
/// lie inside it. For every patch returned: each boundary vertex lies on its cleaned contour; no
/// interior edge joins two boundary vertices; interior vertices have valence six; no triangle is
/// inverted (exact predicate), also after rounding to `f32` at `patch.lattice.origin`. The same
/// drawing gives the same patch, bit for bit, whichever point it starts at and in whichever
/// direction it runs. Time is linear in the number of triangles and points for ordinary drawings.
///
/// # Errors
/// [`Error::TooCoarse`] if no valid patch of about the size asked for was found, with the least number of
/// triangles that works unless [`SketchOptions::least`] is off or the search for it would take too long;
/// [`Error::NoPatch`] if there is none at any size up to [`MAX_TRIANGLES`]; [`Error::Inverted`] without
/// relaxation; and the errors of [`ClosedCurve::new`] and [`SketchOptions::check`].
///
/// Source: Nealen et al., GridMesh, 2009, section IV.
pub fn mesh_sketch(
    outline: &[DVec2],
    holes: &[Vec<DVec2>],
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Sketch> {
    options.check()?;
    progress.report(0.0)?;
    // Angles are solved side by side, and failed placements start again: only what rises is passed on.
    let rising = Rising::new(progress);
    let callback = |fraction: f64| rising.report(fraction);
    let progress = Progress::new(&callback);
    let started = Instant::now();
    check_density(options, outline, holes)?;
    let union = match options.self_crossing {
        SelfCrossing::Error => None,
        SelfCrossing::Union => Some(outer_outline(outline, "outline")?),
    };
    if options.boundary == BoundaryMethod::Grown && !holes.is_empty() {
        return Err(Error::InvalidOption {
            name: "boundary",
            value: "grown, with holes".to_owned(),
            allowed: "optimal, if there are holes",
        });
    }
    let contours = read_contours(union.as_ref().map_or(outline, |(points, _)| points), holes)?;
    let area = contours[0].area() - contours[1..].iter().map(ClosedCurve::area).sum::<f64>();
    let mut thinnest = None;
    let triangles = if options.automatic {
        thinnest = thickness::limbs_of(&contours)?.first().copied();
        chosen_triangles(area, thinnest, options.max_triangles)
    } else {
        options.triangles.unwrap_or(DEFAULT_TRIANGLES)
    };
    let edge_length = match options.edge_length {
        Some(h) => h,
        None => Lattice::edge_length_for(area, triangles as f64),
    };
    let expected = area / (0.5 * crate::lattice::ROW_HEIGHT * edge_length * edge_length);
    if expected.is_nan() || expected > MAX_TRIANGLES {
        return Err(Error::TooLarge { triangles: expected, limit: MAX_TRIANGLES });
    }
    check_origin(options, &contours[0], edge_length)?;
    let find = |mirror| Symmetry::find(&contours, mirror, edge_length);
    let symmetry = options.mirror.map(find).transpose()?;
    mirror::check_angle(symmetry.as_ref(), options.angle)?;
    let centre = centroid(contours[0].points());
    let centre = symmetry.as_ref().map_or(centre, |symmetry| symmetry.axis.foot(centre));
    let mut job =
        Job { contours, symmetry, options, area, centre, thinnest, seconds: Vec::new(), placements: 0 };
    job.lap("curve", started);
    let asked = match options.edge_length {
        Some(h) => Asked::EdgeLength(h),
        None => Asked::Triangles(triangles),
    };
    let mut attempt = job.attempt_unless_hopeless(asked, expected, progress)?;
    if let (true, Err(obstacle)) = (options.automatic, &attempt)
        && !obstacle.is_inverted
    {
        // A number that was chosen gives way to one that works.
        match job.least_that_works(expected, obstacle.clone(), progress)? {
            Error::TooCoarse { needed: Needed::Least(least), .. } if least <= options.max_triangles => {
                attempt = job.attempt(Asked::Triangles(least), Effort::Full, progress)?;
            }
            refused => return Err(refused),
        }
    }
    let mut sketch = match attempt {
        Ok(sketch) => sketch,
        Err(Obstacle { at, is_inverted: true, .. }) => return Err(Error::Inverted { at: at.to_array() }),
        Err(_) if !options.least => {
            let triangles = expected.round().max(1.0) as usize;
            return Err(Error::TooCoarse { triangles, needed: Needed::Unknown });
        }
        Err(obstacle) => return Err(job.least_that_works(expected, obstacle, progress)?),
    };
    if let Some((_, slivers)) = union {
        // The sources so far lead to the outer outline.
        let Patch { vertices, loops, .. } = &mut sketch.patch;
        for (source, &vertex) in loops[0].source.iter_mut().zip(&*vertices) {
            *source = nearest_source(outline, vertex);
        }
        sketch.report.repaired += slivers;
    }
    progress.report(1.0)?;
    Ok(sketch)
}

#[derive(Clone, Copy)]
enum Asked {
    EdgeLength(f64),
    Triangles(usize),
}

/// How hard to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Effort {
    /// All placements.
    Full,
    /// One.
    Quick,
}

/// A patch on one lattice, and how far it is from being good enough.
struct Found {
    faults: f64,
    /// None on a straight lattice.
    bent: Option<Bent>,
    outline: Outline,
    placed: Placed,
    mirror_error: Option<f64>,
}

impl Found {
    /// How far the least angle is from a good one: 0 to 1.
    fn starved(&self) -> f64 {
        (1.0 - min_angle(&self.placed.patch) / GOOD_ANGLE).max(0.0)
    }

    /// Cost, faults and starved triangles in turns.
    fn score(&self) -> f64 {
        let price = self.bent.as_ref().map_or(0.0, |bent| bent.price);
        self.outline.cost + price + TURNS_OF_FAULT * self.faults + TURNS_OF_ANGLE * self.starved()
    }

    /// True if a part of the drawing is lost in the mesh.
    fn lost(&self) -> bool {
        self.placed.lost() > 0
    }
}

struct Job<'a> {
    contours: Vec<ClosedCurve>,
    symmetry: Option<Symmetry>,
    options: &'a SketchOptions,
    area: f64,
    centre: DVec2,
    thinnest: Option<Limb>,
    seconds: Vec<(&'static str, f64)>,
    placements: usize,
}

impl Job<'_> {
    fn lap(&mut self, stage: &'static str, since: Instant) {
        let spent = since.elapsed().as_secs_f64();
        match self.seconds.iter_mut().find(|s| s.0 == stage) {
            Some(known) => known.1 += spent,
            None => self.seconds.push((stage, spent)),
        }
    }

    fn attempt_unless_hopeless(
        &mut self,
        asked: Asked,
        expected: f64,
        progress: Progress<'_>,
    ) -> Result<Result<Sketch, Obstacle>> {
        if self.is_hopeless(expected.round() as usize) {
            let at = self.contours[0].points()[0];
            return Ok(Err(Obstacle::new("the drawing is too thin for two rows of triangles", at)));
        }
        self.attempt(asked, Effort::Full, progress)
    }

    /// Tries lattice placements until one gives a valid patch of the size asked for: the angles
    /// first, cheapest boundary first, then shifts of the lattice. Where the cheapest boundary
    /// starves triangles or cuts off a tip, the other angles are tried too, and the best is taken.
    fn attempt(
        &mut self,
        asked: Asked,
        effort: Effort,
        progress: Progress<'_>,
    ) -> Result<Result<Sketch, Obstacle>> {
        let mut bent = self.best_bent(asked, effort, progress)?;
        if let Some(found) = bent.take_if(|found| self.is_settled(found)) {
            return Ok(Ok(self.report(found)));
        }
        let mut best: Option<Found> = None;
        let started = Instant::now();
        let lattices = self.placements_to_try(asked, effort);
        let found: Vec<Result<Result<(Lattice, Outline), Miss>>> = lattices
            .par_iter()
            .map(|&(angle, shift)| self.outline(asked, effort, angle, shift, progress.part(0.0, 0.3)))
            .collect();
        let mut obstacle = None;
        let mut outlines = Vec::new();
        let mut is_passable = self.symmetry.is_some();
        for found in found {
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
        if let Some(bent) = &bent {
            outlines.retain(|(_, outline)| outline.cost < bent.score());
        }
        self.lap("boundary", started);
        // Where no angle gives a boundary a shift does not either.
        let shifts = match effort {
            Effort::Full if is_passable && bent.is_none() => self.shifts(&lattices),
            _ => Vec::new(),
        };
        let part_of = |k: usize| 0.4 + 0.5 * k as f64 / shifts.len() as f64;
        let mut shifts = shifts.iter().copied().enumerate();
        let mut outlines = outlines.into_iter();
        loop {
            let (lattice, outline) = match outlines.next() {
                Some(next) => next,
                None if best.as_ref().is_some_and(|best| best.placed.fault(self.options).is_none()) => break,
                None => {
                    let Some((k, (angle, shift))) = shifts.next() else { break };
                    let started = Instant::now();
                    let part = progress.part(part_of(k), part_of(k + 1));
                    let found = self.outline(asked, effort, angle, shift, part)?;
                    self.lap("boundary", started);
                    match found {
                        Ok(found) => found,
                        Err(miss) => {
                            obstacle = obstacle.or(Some(miss.obstacle));
                            continue;
                        }
                    }
                }
            };
            self.placements += 1;
            let started = Instant::now();
            let placed = self.place(None, &lattice, &outline, progress.part(0.3, 0.9))?;
            self.lap("placement", started);
            match placed {
                Ok((placed, mirror_error)) => {
                    let faults = faults(&placed);
                    if best.as_ref().is_none_or(|best| faults < best.faults) {
                        best = Some(Found { faults, bent: None, outline, placed, mirror_error });
                    }
                    if faults == 0.0 {
                        break;
                    }
                }
                Err(found) => obstacle = Some(found),
            }
        }
        if let Some(bent) = bent
            && best.as_ref().is_none_or(|best| best.lost() || bent.score() < best.score())
        {
            best = Some(bent);
        }
        if let Some(best) = best {
            if let Some(reason) = best.placed.fault(self.options) {
                let at = best.placed.patch.inlets.first().map_or(self.centre, |inlet| inlet[0]);
                return Ok(Err(Obstacle::new(reason, at)));
            }
            return Ok(Ok(self.report(best)));
        }
        match obstacle {
            Some(obstacle) => Ok(Err(obstacle)),
            None => Err(Error::Internal { reason: "no lattice was tried" }),
        }
    }

    /// True if no straight lattice is tried beside a bent one: it has no faults and hardly more turns than
    /// there must be.
    fn is_settled(&self, found: &Found) -> bool {
        const FEW: usize = 12;
        let price = found.bent.as_ref().map_or(0.0, |bent| bent.price);
        found.faults <= SLIGHT
            && found.starved() == 0.0
            && price < 1.0
            && found.outline.turns() <= FEW * self.contours.len()
    }

    /// The patch of an outline, symmetric if that was asked for; and by how much it is not.
    fn place(
        &self,
        bent: Option<&Bent>,
        lattice: &Lattice,
        outline: &Outline,
        progress: Progress<'_>,
    ) -> Result<Result<(Placed, Option<f64>), Obstacle>> {
        let placed = match bent {
            None => {
                let laid = |points: &[Axial]| points.iter().map(|&p| Lattice::units(p)).collect();
                place(&self.contours, lattice, laid, outline, self.options, progress)?
            }
            Some(bent) => {
                let laid = |points: &[Axial]| bent.positions(outline, lattice, points);
                place(&self.contours, &bent.lattice(lattice), laid, outline, self.options, progress)?
            }
        };
        Ok(match &self.symmetry {
            None => placed.map(|placed| (placed, None)),
            Some(symmetry) => placed
                .and_then(|p| mirror::symmetrised(&self.contours, symmetry, outline, p, self.options))
                .map(|(placed, error)| (placed, Some(error))),
        })
    }

    /// The patch with its numbers.
    fn report(&mut self, found: Found) -> Sketch {
        let Found { bent, outline, placed, mirror_error, .. } = found;
        let started = Instant::now();
        let mut patch = placed.patch;
        patch.lattice = patch.lattice.of_least_angle();
        let mut report = SketchReport {
            triangles: patch.triangles.len(),
            irregular: outline.irregular(),
            minimum_irregular: 6 + 3 * (self.contours.len() - 1),
            turns: outline.turns(),
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
            across: self.thinnest.map(|limb| thickness::across(limb.width, patch.lattice.edge_length)),
            repaired: self.contours.iter().map(ClosedCurve::repaired).sum(),
            mirror_error,
            bend: bent.as_ref().map_or(0.0, |bent| bent.share * self.options.bend),
            scale_range: bent.as_ref().map_or(1.0, |bent| bent.scale_range()),
            placements: self.placements,
            seconds: Vec::new(),
        };
        self.lap("report", started);
        report.seconds = self.seconds.clone();
        Sketch { patch, report }
    }
}

/// The number of triangles where it is left to the drawing.
fn chosen_triangles(area: f64, thinnest: Option<Limb>, limit: usize) -> usize {
    let wanted = |limb: Limb| thickness::triangles_for(area, limb.width, thickness::ACROSS);
    let wanted = thinnest.map_or(0, |limb| wanted(limb).min(MAX_TRIANGLES).ceil() as usize);
    wanted.max(LEAST_CHOSEN).min(limit)
}

/// Lattice coordinates are whole numbers: a lattice may be laid from a point this many edges away.
const FARTHEST_ORIGIN: f64 = 1e6;

fn check_origin(options: &SketchOptions, outline: &ClosedCurve, edge_length: f64) -> Result<()> {
    let far = |origin: &DVec2| origin.distance(outline.points()[0]) > FARTHEST_ORIGIN * edge_length;
    let Some(origin) = options.origin.filter(far) else {
        return Ok(());
    };
    let value = format!("{}, {}", origin.x, origin.y);
    let allowed = "a point within a million edge lengths of the outline, or none";
    Err(Error::InvalidOption { name: "origin", value, allowed })
}

/// # Errors
/// [`Error::InvalidOption`] if there is not one number for each point.
fn check_density(options: &SketchOptions, outline: &[DVec2], holes: &[Vec<DVec2>]) -> Result<()> {
    let Some(Density::PerPoint(given)) = &options.density else { return Ok(()) };
    let points = std::iter::once(outline.len()).chain(holes.iter().map(Vec::len));
    let fits = given.len() <= 1 + holes.len()
        && given.iter().zip(points).all(|(given, points)| given.is_empty() || given.len() == points);
    if fits {
        return Ok(());
    }
    let numbers: Vec<String> = given.iter().map(|given| given.len().to_string()).collect();
    let value = format!("{} numbers", numbers.join(" + "));
    let allowed = "one number for each point of the outline, and of each hole that has any";
    Err(Error::InvalidOption { name: "density", value, allowed })
}

/// How far a placement is from being good enough: zero if it is.
fn faults(placed: &Placed) -> f64 {
    let (angle, distance) = ENOUGH;
    let starved = (1.0 - min_angle_off_corners(&placed.patch) / angle).max(0.0);
    // A patch that has lost a part of the drawing serves only to say where.
    let lost = 100.0 * placed.lost() as f64;
    lost + 4.0 * starved + (placed.max_deviation - distance).max(0.0)
}

/// The centroid of the enclosed area.
fn centroid(points: &[DVec2]) -> DVec2 {
    let origin = points[0];
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for pair in points.windows(2) {
        let (a, b) = (pair[0] - origin, pair[1] - origin);
        let cross = a.perp_dot(b);
        area += cross;
        sum += cross * (a + b);
    }
    origin + sum / (3.0 * area)
}
