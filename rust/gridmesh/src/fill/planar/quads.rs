//! A patch of quads in the plane for a loop, vertex for vertex; one triangle if the loop is odd.
//!
//! Candidates compete as those of triangles do: regions of the square lattice bounded by the cheapest path of exactly
//! as many steps as the loop has edges; the same behind a row of quads along the whole loop, so that what turns lies
//! inside; and a patch of triangles for every second vertex, each cut into three quads, which exists for every loop.
//! An odd loop gets one more vertex, outside one of its edges, which is the corner of one quad; without it that quad is the triangle.

mod cells;
pub(in crate::fill) mod measure;
mod paths;
mod refined;

use glam::DVec2;

use self::cells::{Belt, Cells, Plan};
use self::measure::measure;
use self::paths::Search;
use super::flat_patch::{FlatFill, FlatPatch, Method};
use super::place::{self, Similarity};
use super::scaled::Scaled;
use super::settle::extend;
use crate::error::Result;
use crate::geometry::stars::{CornerStars, Stars};
use crate::progress::Progress;

/// Badness below which no further way is tried.
const GOOD: f64 = 0.9;

/// Sweeps for what a guess of the harmonic extension leaves.
const SWEEPS: usize = 12;

/// Fills a loop in the plane with quads.
///
/// * `polygon`: n >= 3 points, counter-clockwise, simple if possible.
/// * `wanted`: for each vertex how many right angles the mesh leaves it, which is the number of quads that makes it
///   regular; 2 if there is no mesh.
/// * `taken(i, j)`: the mesh has an edge between these loop vertices already; asked with i < j.
/// * `single`: the loop may be one face.
///
/// Of the triangles of the result each of the first pairs is a quad, counter-clockwise from the first of each; for
/// an odd loop a single one follows. The patch is a disk whose boundary is the loop, without an edge that is taken.
/// Unless it is `folded`, every quad is convex and counter-clockwise by the exact predicate.
///
/// # Errors
/// [`Error::TooFewPoints`], [`Error::NotFinite`], [`Error::NoPatch`], [`Error::Cancelled`].
pub(crate) fn fill_flat_quads(
    polygon: &[DVec2],
    wanted: &[f64],
    taken: &(dyn Fn(usize, usize) -> bool + Sync),
    single: bool,
    progress: Progress<'_>,
) -> Result<FlatFill> {
    let mut found = flat_quads(polygon, wanted, taken, single, false, progress)?;
    Ok(found.swap_remove(0))
}

/// Several patches as those of [`fill_flat_quads`], the best one first. With `all` every kind is looked for, without it none
/// after one that is good.
///
/// # Errors
/// As there; the list is never empty.
pub(crate) fn flat_quads(
    polygon: &[DVec2],
    wanted: &[f64],
    taken: &(dyn Fn(usize, usize) -> bool + Sync),
    single: bool,
    all: bool,
    progress: Progress<'_>,
) -> Result<Vec<FlatFill>> {
    let Scaled { points, restore } = Scaled::new(polygon, wanted.len())?;
    let mut contest =
        Contest { points: &points, wanted, taken, all, best: [const { vec![] }; KINDS], candidates: 0 };
    contest.run(single, progress)?;
    let candidates = contest.candidates;
    let mut found: Vec<(f64, FlatFill)> = contest.best.into_iter().flatten().collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(SEVERAL);
    if found.is_empty() {
        return Err(restore.nothing());
    }
    let restored = found.into_iter().map(|(_, mut fill)| {
        restore.apply(&mut fill.patch.interior);
        FlatFill { candidates, ..fill }
    });
    Ok(restored.collect())
}

/// Kinds of patches: with rows along the loop or not, and those that are no lattice's.
const KINDS: usize = 4;

/// Patches that are kept of each kind, and in all.
const OF_A_KIND: usize = 3;
const SEVERAL: usize = 8;

struct Contest<'a> {
    points: &'a [DVec2],
    wanted: &'a [f64],
    taken: &'a (dyn Fn(usize, usize) -> bool + Sync),
    /// Whether to go on after a patch that is good.
    all: bool,
    /// Of each kind, the best first.
    best: [Vec<(f64, FlatFill)>; KINDS],
    candidates: usize,
}

impl Contest<'_> {
    fn run(&mut self, single: bool, progress: Progress<'_>) -> Result<()> {
        let n = self.points.len();
        if n <= 4 {
            if single {
                self.enter(vec![], &Cells::face(n), Method::NoInterior, 0)?;
            }
            if n == 3 || !self.is_good() {
                if !self.is_good() {
                    self.place(&Cells::of(&Plan::ring(n)), 1, progress)?;
                }
                return Ok(());
            }
        }
        let search = Search::new(self.points, self.wanted, self.taken, progress)?;
        self.lattice(&search, false, progress.part(0.0, 0.4))?;
        if !self.is_good() {
            self.lattice(&search, true, progress.part(0.4, 0.8))?;
        }
        if self.all || self.badness() > refined::WORSE {
            self.refined(progress.part(0.8, 1.0))?;
        }
        Ok(())
    }

    /// Of the best patch so far.
    fn badness(&self) -> f64 {
        self.best.iter().filter_map(|kind| kind.first()).map(|best| best.0).fold(f64::INFINITY, f64::min)
    }

    fn is_good(&self) -> bool {
        !self.all && self.badness() < GOOD
    }

    /// Regions of the lattice, with rows of quads around them or none.
    fn lattice(&mut self, search: &Search<'_>, belts: bool, progress: Progress<'_>) -> Result<()> {
        for round in 0..Search::ROUNDS {
            let share = |part: f64| (round as f64 + part) / Search::ROUNDS as f64;
            let found = search.paths(belts, round, progress.part(share(0.0), share(0.8)))?;
            for plan in found.into_iter().flatten() {
                let kind = match plan.belt {
                    Belt::None => 0,
                    Belt::Whole => 1,
                    Belt::Part { .. } => 2,
                };
                self.place(&Cells::of(&plan), kind, progress.part(share(0.8), share(1.0)))?;
            }
            if self.is_good() || !search.is_uneven() {
                break;
            }
        }
        Ok(())
    }

    /// Patches of triangles for every second vertex, cut into quads.
    fn refined(&mut self, progress: Progress<'_>) -> Result<()> {
        for cells in refined::candidates(self.points, self.wanted, progress)? {
            let stars = cells.stars();
            let mut positions = cells.start.clone();
            positions[..self.points.len()].copy_from_slice(self.points);
            place::settle(&stars, &mut positions, progress)?;
            self.enter(positions.split_off(self.points.len()), &cells, Method::Refined, KINDS - 1)?;
        }
        Ok(())
    }

    /// Brings the vertices of a region from the lattice to the loop.
    fn place(&mut self, cells: &Option<Cells>, kind: usize, progress: Progress<'_>) -> Result<()> {
        let Some(cells) = cells else { return Ok(()) };
        progress.report(0.0)?;
        let n = self.points.len();
        let mut positions = cells.start.clone();
        let fit = Similarity::between(&positions[..n], self.points);
        positions.iter_mut().for_each(|p| *p = fit.apply(*p));
        let mut moved: Vec<DVec2> = self.points.iter().zip(&positions).map(|(p, q)| *p - *q).collect();
        moved.extend(cells.spread(&moved, progress)?);
        let stars = cells.stars();
        extend(&stars, &mut positions, moved, cells.wave(), SWEEPS, progress)?;
        positions[..n].copy_from_slice(self.points);
        place::settle(&stars, &mut positions, progress)?;
        self.enter(positions.split_off(n), cells, Method::Optimal, kind)
    }

    fn enter(&mut self, interior: Vec<DVec2>, cells: &Cells, method: Method, kind: usize) -> Result<()> {
        let positions = [self.points, &interior].concat();
        let measured = measure(&positions, cells, self.wanted, self.taken);
        self.candidates += 1;
        let kept = &mut self.best[kind];
        let place = kept.partition_point(|other| other.0 <= measured.badness);
        let triangles = cells.triangles(&positions);
        let known = kept[..place].iter().any(|(_, other)| other.patch.triangles == triangles);
        if measured.badness < f64::INFINITY && place < OF_A_KIND && !known {
            let folded = !measured.quality.embedded;
            let patch = FlatPatch { interior, triangles, quads: cells.quads.len() };
            let fill = FlatFill { patch, method, quality: measured.quality, folded, candidates: 0 };
            kept.insert(place, (measured.badness, fill));
            kept.truncate(OF_A_KIND);
        }
        Ok(())
    }
}

impl Cells {
    fn stars(&self) -> CornerStars {
        let stars = CornerStars::new(&self.quads, self.odd, self.n_loop, self.start.len());
        debug_assert_eq!(stars.len() + self.n_loop, self.start.len());
        stars
    }
}

#[cfg(test)]
#[path = "quads/tests.rs"]
mod tests;
