//! One patch for three loops or more.
//!
//! No lattice fits them all. Where there is room a tube runs from each loop to a circle around a point before them all (`hub`), and only between
//! the circles (`arms`), or else between the loops themselves, lies a patch in one (`in_one`): the loops are joined to one polygon (`tour`), which is
//! triangulated with the least bending and area (`polygon`), and the triangles are made even on that surface and smooth to what lies
//! beyond (`even`). For quads triangles of twice the size are laid on that surface, joined to pairs (`pairs`) and cut (`halves`).

mod arms;
mod border;
mod halves;
mod hub;
mod in_one;
mod pairs;
mod polygon;
mod quads;
mod rows;
mod tour;

use glam::DVec3;

use self::border::Several;
use self::hub::{BENT, Limits, SHARES, STRAIGHT, circles};
use self::tour::turned;
use crate::error::{Error, LoopError, Result};
use crate::fill::bridge::apart;
use crate::fill::filled::{Fill, NO_ITEM, Shape};
use crate::fill::job::{Job, SOUND_RINGS};
use crate::fill::layout::unroll::Unrolling;
use crate::fill::loops::check::{Checked, check_loops, check_near};
use crate::fill::loops::mesh::Rim;
use crate::fill::loops::touching::check_apart;
use crate::fill::options::{FillOptions, Smooth};
use crate::fill::report::{FillReport, Grid};
use crate::fill::surface::faces::good_corner;
use crate::fill::surface::fit::{folds, rim_angle};
use crate::progress::{Clock, Progress};

/// How bad a patch is: what it meets, its folds, and how far its least corner is below a good one, in radians.
type Rank = (usize, usize, f64);

/// A patch between circles that lacks less of the least corner is not compared with those between others.
const GOOD: f64 = 0.05;

/// A patch that is not worse is not compared with those made in other ways.
const SOUND: Rank = (0, 0, 0.3);

/// See [`fill_loops`](super::fill_loops), for three or more.
pub(super) fn fill_several(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loops: &[Vec<u32>],
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    progress.report(0.0)?;
    options.check(triangles)?;
    let seeds = loops.concat();
    let rim = Rim::new(vertices.len(), triangles, &seeds, rings(options.smooth))?;
    let mut checked = check_loops(loops, vertices, &rim)?;
    check_apart(loops, vertices)?;
    if vertices.iter().any(|p| !p.is_finite()) {
        let wide = Rim::new(vertices.len(), triangles, &seeds, SOUND_RINGS)?;
        loops.iter().try_for_each(|l| check_near(l, vertices, &wide))?;
    }
    progress.report(0.1)?;
    let spanning = tour::spanning(&checked, vertices);
    turned(&mut checked, &spanning, vertices);
    let apart = apart(vertices, triangles, loops)?;
    let span =
        Several { vertices, triangles, rim: &rim, options, checked: &checked, spanning: &spanning, apart };
    let fill = span.fill(progress.part(0.1, 0.95))?;
    if fill.report.self_intersections > 0 {
        span.refuse_apart()?;
        if options.strict {
            // Says where.
            let mut fills = [Ok(fill)];
            Job { vertices, triangles, options }.count_meetings(&mut fills, progress.part(0.95, 1.0))?;
            let [refused] = fills;
            return refused;
        }
    }
    progress.report(1.0)?;
    Ok(fill)
}

/// Rings of triangles around the loops that a patch looks at.
fn rings(smooth: Smooth) -> usize {
    if smooth == Smooth::Curvature { 2 } else { 1 }
}

/// Whether to go on with something else makes no sense.
fn is_final(error: &Error) -> bool {
    matches!(error, Error::Cancelled | Error::Internal { .. })
}

impl Several<'_> {
    fn rank(&self, fill: &Fill) -> Rank {
        let report = &fill.report;
        let lack = good_corner(self.options.cells) - report.min_angle;
        // A film in place of a smooth surface counts as a fold.
        (report.self_intersections, report.folds + report.repaired, lack.max(0.0))
    }

    fn better(&self, one: Option<Fill>, other: Fill) -> Fill {
        one.filter(|one| self.rank(one) <= self.rank(&other)).unwrap_or(other)
    }

    /// The best of patches made in different ways.
    fn fill(&self, progress: Progress<'_>) -> Result<Fill> {
        let mut clock = Clock::new();
        let unsound = |best: &Option<Fill>| best.as_ref().is_none_or(|fill| self.rank(fill) > SOUND);
        let mut best = self.best_arms(&STRAIGHT, None, &mut clock, progress.part(0.0, 0.3))?;
        let mut refused = None;
        if unsound(&best) {
            match self.in_one(&mut clock, progress.part(0.3, 0.6)) {
                Ok((shape, repaired)) => {
                    let fill = self.counted(shape, repaired, &mut clock, progress.part(0.6, 0.7))?;
                    best = Some(self.better(best, fill));
                }
                Err(error) if is_final(&error) => return Err(error),
                Err(error) => refused = Some(error),
            }
        }
        if unsound(&best) {
            best = self.best_arms(&BENT, best, &mut clock, progress.part(0.7, 1.0))?;
        }
        let mut fill = match (best, refused) {
            (Some(fill), None) => fill,
            (Some(fill), Some(_)) if fill.report.self_intersections == 0 => fill,
            (_, Some(error)) => return Err(error),
            (None, None) => return Err(NO_ITEM),
        };
        fill.report.seconds = clock.seconds;
        Ok(fill)
    }

    /// The best of a patch and those of tubes that come together.
    fn best_arms(
        &self,
        limits: &Limits,
        mut best: Option<Fill>,
        clock: &mut Clock,
        progress: Progress<'_>,
    ) -> Result<Option<Fill>> {
        let part = |k: usize| k as f64 / SHARES.len() as f64;
        for (k, share) in SHARES.into_iter().enumerate() {
            let part = progress.part(part(k), part(k + 1));
            let Some(circles) = circles(self, limits, share) else { continue };
            match self.arms(&circles, clock, part.part(0.0, 0.8)) {
                Ok((shape, least)) => {
                    let fill = self.counted(shape, 0, clock, part.part(0.8, 1.0))?;
                    let (meetings, folds, _) = self.rank(&fill);
                    best = Some(self.better(best, fill));
                    // What tubes lack in corners they lack beside any hub.
                    if (meetings, folds) == (0, 0) && least > good_corner(self.options.cells) - GOOD {
                        break;
                    }
                }
                Err(error) if is_final(&error) => return Err(error),
                // What cannot be made so is made otherwise.
                Err(_) => {}
            }
        }
        Ok(best)
    }

    /// A patch that knows what it meets.
    fn counted(
        &self,
        shape: Shape,
        repaired: usize,
        clock: &mut Clock,
        progress: Progress<'_>,
    ) -> Result<Fill> {
        let options = FillOptions { strict: false, ..self.options.clone() };
        let job = Job { vertices: self.vertices, triangles: self.triangles, options: &options };
        let mut fills = [Ok(self.finish(shape, repaired))];
        job.count_meetings(&mut fills, progress)?;
        clock.stage("intersections");
        let [fill] = fills;
        fill
    }

    /// Refuses loops that look away from each other, if any do.
    fn refuse_apart(&self) -> Result<()> {
        let Some(loops) = self.apart else { return Ok(()) };
        let vertices = loops.map(|k| self.checked[k].vertices[0]);
        Err(Error::Loops(LoopError::LookApart { loops, vertices }))
    }

    fn finish(&self, shape: Shape, repaired: usize) -> Fill {
        let work = &shape.work;
        let loops = self.checked.iter().map(|c| c.vertices.as_slice());
        let [irregular, irregular_loop] = work.irregular(loops, self.rim, &self.options.polygons);
        let [min_angle, max_angle] = work.corner_range(&shape.positions);
        let report = FillReport {
            triangles: work.single().len(),
            quads: work.quads,
            vertices: work.inner().len(),
            irregular,
            irregular_loop,
            grid: Grid::Even,
            rim_angle: rim_angle(work, &shape.positions),
            unrolling: Unrolling::default(),
            winding_conflicts: self.checked.iter().map(|c| c.conflicts).sum(),
            wire_edges: self.checked.iter().map(|c| c.wire).sum(),
            min_angle,
            max_angle,
            folds: folds(work, &shape.positions),
            repaired,
            ..FillReport::default()
        };
        let given = |c: &Checked| {
            let mut vertices = c.vertices.clone();
            if c.reversed {
                vertices.reverse();
            }
            vertices
        };
        Fill::of(self.checked.iter().flat_map(given).collect(), shape, report)
    }
}
