//! A patch in the plane for a loop, vertex for vertex.
//!
//! Candidates from several methods compete: lattice patches at several angles and with more or
//! less of the loop's unevenness developed away, tiny patches, and graded ones where a lattice
//! would be too distorted. What each got wrong is measured, and the best is returned with its name.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use glam::DVec2;

use super::exact::{Layers, TURN, Wishes, conflicts, route};
use super::flat_patch::{FlatFill, FlatPatch, Method};
use super::graded::graded;
use super::grown::grown;
use super::place;
use super::quality::measure;
use super::scaled::Scaled;
use super::small::{SMALL, around_centre, without_interior};
use crate::error::{Error, Result};
use crate::fill::layout::develop::Loop;
use crate::fill::layout::lobes::without_lobes;
use crate::fill::layout::thin::{put_back, thinned};
use crate::lattice::assemble::assemble_asking;
use crate::lattice::axial::Axial;
use crate::lattice::grid::Triangular;
use crate::options::BoundaryMethod;
use crate::progress::Progress;

/// How to fill a loop in the plane.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FlatOptions {
    /// A loop of three may be one triangle.
    pub single: bool,
    /// Where lattice patches get their boundary from.
    pub boundary: BoundaryMethod,
    /// Cost of a squared lattice distance from the developed loop, in turns.
    pub closeness: f64,
    /// Cost of a squared logarithm of an angle at the loop against 60 degrees, in turns.
    pub shape: f64,
    /// Lattice steps that a vertex may be off its place in the developed loop.
    pub reach: i32,
    /// Lattice angles compared in the range of 60 degrees.
    pub angles: usize,
    /// Of the paths found, how many are placed and measured.
    pub placed: usize,
    /// Badness up to which no graded patch is tried.
    pub enough: f64,
    /// Large uneven loops are first tried with a patch for some of their vertices only.
    pub thin: bool,
}

impl Default for FlatOptions {
    fn default() -> Self {
        FlatOptions {
            single: true,
            boundary: BoundaryMethod::Optimal,
            closeness: 0.3,
            shape: 2.0,
            reach: 2,
            angles: 6,
            placed: 2,
            enough: GOOD,
            thin: false,
        }
    }
}

/// Fills a loop in the plane.
///
/// * `polygon`: n >= 3 points, counter-clockwise, simple if possible.
/// * `wanted`: for each vertex the patch valence (edges within the patch, its two loop edges
///   counted) that would make it regular in the mesh; 4 if there is no mesh.
/// * `taken(i, j)`: the mesh has an edge between these loop vertices already; asked with i < j.
///
/// The patch is a disk whose boundary is the loop, without an edge that is taken. If the polygon is
/// simple, every triangle is counter-clockwise by the exact predicate unless `folded` says
/// otherwise (points on one line can leave no choice).
///
/// # Errors
/// [`Error::TooFewPoints`], [`Error::NotFinite`], [`Error::Cancelled`].
pub(crate) fn fill_flat(
    polygon: &[DVec2],
    wanted: &[i32],
    taken: &(dyn Fn(usize, usize) -> bool + Sync),
    options: &FlatOptions,
    progress: Progress<'_>,
) -> Result<FlatFill> {
    let Scaled { points, restore } = Scaled::new(polygon, wanted.len())?;
    let n = points.len();
    let lengths = (0..n).map(|k| points[k].distance(points[(k + 1) % n]));
    let (least, most) = lengths.fold((f64::INFINITY, 0.0f64), |(a, b), l| (a.min(l), b.max(l)));
    let even = most <= 1.5 * least;
    let mut contest = Contest { points: &points, wanted, taken, best: None, candidates: 0, even };
    contest.run(options, progress)?;
    let (_, mut fill) = contest.best.ok_or_else(|| restore.nothing())?;
    restore.apply(&mut fill.patch.interior);
    fill.candidates = contest.candidates;
    Ok(fill)
}

/// Loops with more vertices are tried with fewer candidates.
const LARGE: usize = 300;

/// Badness below which no further method is tried. With 1.5 the mean radius ratio on disks cut from meshes
/// is lower by a hundredth, with 0.8 it is the same.
const GOOD: f64 = 1.0;

/// Does the second work and beside it, if there are threads, the first; the first one's result, if the second
/// says that it is needed.
///
/// Only the calling thread asks whether to go on, also while it waits.
fn beside<T: Send>(
    first: impl FnOnce(Progress<'_>) -> Result<T> + Send,
    second: impl FnOnce(Progress<'_>) -> Result<bool>,
    progress: Progress<'_>,
) -> Result<Option<Result<T>>> {
    const WAIT: Duration = Duration::from_millis(1);
    /// Set also if the work panics.
    struct Ends<'a>(&'a AtomicBool);
    impl Drop for Ends<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Release);
        }
    }
    let (needless, ended) = (AtomicBool::new(false), AtomicBool::new(false));
    let caller = thread::current().id();
    let go_on = |_: f64| {
        let is_stopped = || thread::current().id() == caller && progress.report(0.0).is_err();
        !needless.load(Ordering::Relaxed) && !is_stopped()
    };
    let mut made = None;
    let found = &mut made;
    rayon::in_place_scope(|scope| {
        scope.spawn(|_| {
            let _ends = Ends(&ended);
            *found = Some(first(Progress::new(&go_on)));
        });
        let is_needed = second(progress);
        needless.store(!matches!(is_needed, Ok(true)), Ordering::Relaxed);
        let is_needed = is_needed?;
        while is_needed && !ended.load(Ordering::Acquire) {
            progress.report(0.0).inspect_err(|_| needless.store(true, Ordering::Relaxed))?;
            if rayon::yield_now() != Some(rayon::Yield::Executed) {
                thread::sleep(WAIT);
            }
        }
        Ok(())
    })?;
    Ok(made.filter(|_| !needless.load(Ordering::Relaxed)))
}

struct Contest<'a> {
    points: &'a [DVec2],
    wanted: &'a [i32],
    taken: &'a (dyn Fn(usize, usize) -> bool + Sync),
    best: Option<(f64, FlatFill)>,
    candidates: usize,
    /// The loop's edges differ by half at most: the patch should be regular inside.
    even: bool,
}

impl Contest<'_> {
    fn run(&mut self, options: &FlatOptions, progress: Progress<'_>) -> Result<()> {
        let (points, wanted, taken) = (self.points, self.wanted, self.taken);
        let n = points.len();
        let bare = n <= SMALL && (n > 3 || options.single);
        if let Some(triangles) = bare.then(|| without_interior(points, taken)).flatten() {
            self.enter(Vec::new(), triangles, Method::NoInterior, progress)?;
        }
        if n <= SMALL {
            let (centre, triangles) = around_centre(points);
            let interior = place::settled(points, vec![centre], &triangles, progress)?;
            self.enter(interior, triangles, Method::Centre, progress)?;
        }
        if options.thin && n > LARGE && !self.even {
            self.of_some(thinned(points), options, progress.part(0.0, 0.3))?;
            if self.is_settled(options) {
                return Ok(());
            }
        }
        let mut made = None;
        // With one thread the caller would wait for the other in the middle, deaf.
        if n > LARGE && !self.even && rayon::current_num_threads() > 1 {
            // Often the lattice does not fit, and both take their time: side by side.
            made = beside(
                |progress| graded(points, wanted, taken, progress),
                |progress| {
                    self.lattice(options, progress.part(0.0, 0.7))?;
                    Ok(!self.is_settled(options))
                },
                progress,
            )?;
        } else if n >= 5 {
            self.lattice(options, progress.part(0.0, 0.7))?;
        }
        if n > 3 && !self.is_settled(options) {
            match made.unwrap_or_else(|| graded(points, wanted, taken, progress.part(0.7, 1.0))) {
                Ok((interior, triangles)) => self.enter(interior, triangles, Method::Graded, progress)?,
                Err(Error::Solver { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        let folded = self.best.as_ref().is_none_or(|(_, fill)| fill.folded);
        if folded && n > SMALL {
            self.of_some(without_lobes(points), options, progress.part(0.7, 1.0))?;
        }
        if self.best.is_none() {
            // A loop that lies upon itself: the triangles of a round loop with the same edges.
            let round = place::round_loop(points);
            let (interior, triangles) = graded(&round, wanted, taken, progress.part(0.7, 1.0))?;
            let interior = place::carried_over(&round, interior, &triangles, points, progress)?;
            self.enter(interior, triangles, Method::Graded, progress)?;
        }
        Ok(())
    }

    /// A patch for some of the vertices, if there are any, with the others on its edges.
    fn of_some(
        &mut self,
        kept: Option<Vec<usize>>,
        options: &FlatOptions,
        progress: Progress<'_>,
    ) -> Result<()> {
        let Some(kept) = kept else { return Ok(()) };
        let points: Vec<DVec2> = kept.iter().map(|&k| self.points[k]).collect();
        let wanted: Vec<i32> = kept.iter().map(|&k| self.wanted[k]).collect();
        let taken = |i: usize, j: usize| (self.taken)(kept[i], kept[j]);
        let options = FlatOptions { thin: false, ..options.clone() };
        let made = match fill_flat(&points, &wanted, &taken, &options, progress) {
            Err(Error::NoPatch { .. } | Error::Solver { .. }) => return Ok(()),
            made => made?,
        };
        let triangles = put_back(&made.patch.triangles, &kept, self.points.len());
        let interior = place::settled_by_loop(self.points, made.patch.interior, &triangles, progress)?;
        self.enter(interior, triangles, made.method, progress)?;
        Ok(())
    }

    /// Whether the best patch so far needs no other beside it.
    fn is_settled(&self, options: &FlatOptions) -> bool {
        let regular = |fill: &FlatFill| fill.quality.irregular == 0 && !fill.folded;
        let settled =
            |(badness, fill): &(f64, FlatFill)| *badness <= options.enough || (self.even && regular(fill));
        self.best.as_ref().is_some_and(settled)
    }

    /// Lattice patches: the cheapest paths over several angles, placed and measured.
    fn lattice(&mut self, options: &FlatOptions, progress: Progress<'_>) -> Result<()> {
        let shape = Loop::new(self.points, progress)?;
        let turns = turn_costs(&shape.turning, self.wanted, self.taken, options.shape);
        // The whole flux is right where it is right at all; where the developed loop covers itself,
        // less of it may not.
        let rounds = if self.points.len() > LARGE { ROUNDS / 2 } else { ROUNDS };
        let strengths: &[f64] = if self.points.len() > LARGE { &[1.0] } else { &[1.0, 0.6, 0.2] };
        for &strength in strengths {
            let mut found: Vec<(u32, Vec<DVec2>)> = Vec::with_capacity(options.angles);
            for a in 0..options.angles {
                progress.report(0.5 * a as f64 / options.angles as f64)?;
                let angle = std::f64::consts::FRAC_PI_3 * a as f64 / options.angles as f64;
                let target = shape.developed::<Triangular>(strength, angle);
                let wishes = Wishes {
                    target: &target,
                    turns: &turns,
                    closeness: options.closeness,
                    reach: options.reach,
                };
                found.push((Layers::<Triangular>::new(&wishes).least(), target));
            }
            found.sort_by_key(|f| f.0);
            for (i, (_, target)) in found.iter().take(options.placed).enumerate() {
                if i > 0 && self.points.len() > LARGE && self.is_good() {
                    break;
                }
                let here = progress.part(0.5, 1.0);
                here.report(i as f64 / options.placed as f64)?;
                let wishes =
                    Wishes { target, turns: &turns, closeness: options.closeness, reach: options.reach };
                match options.boundary {
                    BoundaryMethod::Optimal => {
                        if let Some(path) = route::<Triangular>(&wishes, self.taken, STARTS, rounds, here)? {
                            self.place(&path, Method::Optimal, here)?;
                        }
                    }
                    BoundaryMethod::Grown => {
                        let path =
                            grown(target).filter(|path| conflicts::<Triangular>(path, self.taken).is_empty());
                        if let Some(path) = path {
                            self.place(&path, Method::Grown, here)?;
                        }
                    }
                }
            }
            let uneven = shape.flux.iter().map(|f| f.abs()).sum::<f64>() > 1.0;
            if !uneven || self.is_good() {
                break;
            }
        }
        Ok(())
    }

    fn is_good(&self) -> bool {
        self.best.as_ref().is_some_and(|(badness, _)| *badness < GOOD)
    }

    /// Triangles inside a path, mapped to the loop.
    fn place(&mut self, path: &[Axial], method: Method, progress: Progress<'_>) -> Result<()> {
        progress.report(0.0)?;
        let patch = assemble_asking(&[path.to_vec()], || progress.report(0.0))?;
        progress.report(0.0)?;
        if let Some(interior) = place::off_lattice(self.points, &patch, progress)? {
            self.enter(interior, patch.triangles, method, progress)?;
        }
        Ok(())
    }

    fn enter(
        &mut self,
        interior: Vec<DVec2>,
        triangles: Vec<[u32; 3]>,
        method: Method,
        progress: Progress<'_>,
    ) -> Result<()> {
        let n = self.points.len();
        let positions = [self.points, &interior].concat();
        let quality = measure(&positions, &triangles, self.wanted, self.taken, progress)?;
        let badness = quality.badness(n, self.even);
        self.candidates += 1;
        if badness < self.best.as_ref().map_or(f64::INFINITY, |b| b.0) {
            let folded = !quality.embedded;
            let fill = FlatFill {
                patch: FlatPatch { interior, triangles, quads: 0 },
                method,
                quality,
                folded,
                candidates: 0,
            };
            self.best = Some((badness, fill));
        }
        Ok(())
    }
}

/// Starts of the exact search tried at most.
const STARTS: usize = 24;

/// Times that conflicts are priced.
const ROUNDS: usize = 8;

/// What each turn costs at each vertex: how far the valence is from the wanted one, and how far the
/// angles between its edges are from 60 degrees.
fn turn_costs(
    turning: &[f64],
    wanted: &[i32],
    taken: &dyn Fn(usize, usize) -> bool,
    shape: f64,
) -> Vec<[u32; 5]> {
    let n = turning.len();
    let cost = |k: usize| {
        std::array::from_fn(|t| {
            let valence = 6 - t as i32;
            let angle = (std::f64::consts::PI - turning[k]).clamp(0.05, 6.2) / f64::from(valence - 1);
            let off = libm::log(angle / std::f64::consts::FRAC_PI_3);
            let mut cost = f64::from((valence - wanted[k]).abs()) + shape * off * off;
            if valence == 2 {
                // A triangle at the tip: no room for it where the loop is straight, and its third
                // edge joins loop vertices.
                let (i, j) = ((k + n - 1) % n, (k + 1) % n);
                let closed = angle > 0.85 * std::f64::consts::PI || taken(i.min(j), i.max(j));
                cost += if closed { 1000.0 } else { 1.0 };
            }
            (f64::from(TURN) * cost).round() as u32
        })
    };
    (0..n).map(cost).collect()
}

#[cfg(test)]
#[path = "flat_tests.rs"]
mod tests;
