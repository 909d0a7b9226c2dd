//! One loop filled: laid out, triangulated, placed, and tried another way if that went wrong.

use glam::DVec3;
use rustc_hash::FxHashSet;

use crate::error::{Error, Result};
use crate::fill::filled::{Fill, Shape};
use crate::fill::job::Job;
use crate::fill::layout::unroll::{Unrolled, Unrolling, unroll, unroll_least_bent};
use crate::fill::loops::check::Checked;
use crate::fill::loops::mesh::Rim;
use crate::fill::loops::reserve::{Taken, room, wanted};
use crate::fill::options::Smooth;
use crate::fill::planar::flat::{FlatOptions, fill_flat};
use crate::fill::planar::flat_patch::FlatFill;
use crate::fill::planar::quads::{fill_flat_quads, flat_quads};
use crate::fill::report::{FillReport, Grid};
use crate::fill::surface::fit::{Faults, Solved};
use crate::fill::surface::looks::Worth;
use crate::fill::surface::patchwork::Patchwork;
use crate::options::CellShape;
use crate::progress::{Clock, Progress};

/// Patches of quads whose faces are less misshapen in space are taken, and no other ones tried.
const GOOD: f64 = 0.7;

/// By how much a patch of quads must be better than the best so far, and by how much more for each pole that it has more:
/// the best one in the plane comes first.
const CLEARLY: f64 = 0.1;
const MORE: f64 = 1.5;

/// Loops with more vertices get the patch of quads that is best in the plane.
const LARGE: usize = 300;

/// Other patches are tried until they have this many new vertices in sum: those that come later are worse in the plane, and each
/// takes a second for every ten thousand.
const TRIED: usize = 10_000;

/// A patch in space.
pub(super) struct Attempt {
    pub unrolled: Unrolled,
    pub patch: FlatFill,
    pub shape: Shape,
    pub solved: Solved,
    /// How bad it is in space if it is of quads.
    pub worth: Option<Worth>,
}

impl Attempt {
    fn is_good(&self) -> bool {
        let shapely = self.worth.is_none_or(|worth| worth.misshape < GOOD && self.solved.repaired == 0);
        shapely && self.solved.faults == Faults::default()
    }

    /// Whether it is to be taken instead of one that was found before.
    fn is_better(&self, best: &Attempt) -> bool {
        match (&self.worth, &best.worth) {
            (Some(own), Some(other)) => {
                let more = own.poles.saturating_sub(other.poles);
                own.badness + CLEARLY + MORE * (more as f64) < other.badness
            }
            _ => self.solved.faults < best.solved.faults,
        }
    }
}

impl Job<'_> {
    /// Fills one loop; `reserved` edges are taken by earlier fills.
    pub(super) fn one(
        &self,
        checked: &Checked,
        rim: &Rim,
        reserved: &FxHashSet<[u32; 2]>,
        progress: Progress<'_>,
    ) -> Result<Fill> {
        progress.report(0.0)?;
        let mut clock = Clock::new();
        let task = Task { job: self, checked, rim, taken: Taken::new(checked, rim, reserved) };
        let creases = self.options.sharp.map_or(vec![], |angle| task.creases(angle));
        let n_creases = creases.iter().flatten().count();
        if n_creases > 0
            && let Some(sharp) = task.sharp(&creases, &mut clock, progress.part(0.0, 0.1))?
        {
            return Ok(task.finish(sharp, n_creases, clock));
        }
        let around = checked.vertices.iter().map(|&v| self.vertices[v as usize]).collect::<Vec<_>>();
        let unrolled = unroll(&around);
        clock.stage("unroll");
        let mut best = task.attempt(unrolled, &mut clock, progress.part(0.1, 0.7))?;
        // There is no other way to lay out a loop that is nearly planar already.
        let bent = best.solved.faults != Faults::default() || best.unrolled.method != Unrolling::Projected;
        if bent
            && !best.is_good()
            && let Some(unrolled) = unroll_least_bent(&around, &task.outside())
        {
            match task.attempt(unrolled, &mut clock, progress.part(0.7, 1.0)) {
                Ok(other) if other.is_better(&best) => best = other,
                Ok(_) | Err(Error::NoPatch { .. } | Error::Solver { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(task.finish(best, n_creases, clock))
    }
}

/// A loop, and what has to be known about it.
pub(super) struct Task<'a> {
    pub job: &'a Job<'a>,
    pub checked: &'a Checked,
    pub rim: &'a Rim,
    pub taken: Taken,
}

impl Task<'_> {
    fn attempt(&self, unrolled: Unrolled, clock: &mut Clock, progress: Progress<'_>) -> Result<Attempt> {
        let loop_ = &self.checked.vertices;
        let polygons = &self.job.options.polygons;
        let is_taken = |i: usize, j: usize| self.taken.has(i, j);
        // A face that the mesh has already is filled with others.
        let single = !self.taken.face;
        let here = progress.part(0.0, 0.6);
        let room = match self.job.options.cells {
            CellShape::Triangle => vec![],
            CellShape::Quad => room(loop_, self.rim, polygons),
        };
        let made = match self.job.options.cells {
            CellShape::Triangle => {
                let options = FlatOptions { single, ..FlatOptions::default() };
                fill_flat(&unrolled.points, &wanted(loop_, self.rim, polygons), &is_taken, &options, here)?
            }
            CellShape::Quad => fill_flat_quads(&unrolled.points, &room, &is_taken, single, here)?,
        };
        clock.stage("grid");
        progress.report(0.6)?;
        if made.quality.repeated > 0 {
            return Err(Error::NoPatch {
                reason: "every patch repeats an edge of the mesh".into(),
                at: self.job.vertices[loop_[0] as usize].truncate().to_array(),
            });
        }
        let mut best = self.in_space(&unrolled, made, &room, progress.part(0.6, 0.7))?;
        clock.stage("fair");
        if self.job.options.cells == CellShape::Triangle || best.is_good() || loop_.len() > LARGE {
            return Ok(best);
        }
        // What is bent in space may be better with another patch than the best one in the plane.
        let others = flat_quads(&unrolled.points, &room, &is_taken, single, true, progress.part(0.7, 0.8))?;
        clock.stage("grid");
        let first = best.patch.patch.triangles.clone();
        let mut tried = 0;
        for made in others {
            if made.folded || made.patch.triangles == first {
                continue;
            }
            tried += made.patch.interior.len();
            if tried > TRIED {
                break;
            }
            let other = match self.in_space(&unrolled, made, &room, progress.part(0.8, 1.0)) {
                Err(Error::Solver { .. }) => continue,
                other => other?,
            };
            if other.is_better(&best) {
                best = other;
            }
        }
        clock.stage("fair");
        Ok(best)
    }

    /// A patch in the plane brought to space.
    fn in_space(
        &self,
        unrolled: &Unrolled,
        made: FlatFill,
        room: &[f64],
        progress: Progress<'_>,
    ) -> Result<Attempt> {
        let loop_ = &self.checked.vertices;
        let smooth = self.job.options.smooth;
        let rings = if smooth == Smooth::Curvature { 2 } else { 1 };
        let work = Patchwork::new(loop_, made.patch.interior.len(), &made.patch.triangles, self.rim, rings)?;
        let work = work.of_quads(made.patch.quads);
        let mut shape = Shape {
            work,
            loop_: loop_.clone(),
            reversed: self.checked.reversed,
            bridged: vec![],
            flat: [unrolled.points.as_slice(), &made.patch.interior].concat(),
            smooth,
            vertices: self.job.vertices.len(),
            positions: vec![],
            creases: vec![],
        };
        let solved = shape.cut_and_solve(self.job.vertices, progress)?;
        let quads = self.job.options.cells == CellShape::Quad;
        let worth = quads.then(|| Worth::of(&shape.work, &solved, room));
        Ok(Attempt { unrolled: unrolled.clone(), patch: made, shape, solved, worth })
    }

    /// See [`outside`].
    pub(super) fn outside(&self) -> Vec<Option<DVec3>> {
        outside(&self.checked.vertices, self.rim, self.job.vertices)
    }

    fn finish(&self, attempt: Attempt, creases: usize, clock: Clock) -> Fill {
        let Attempt { unrolled, patch, mut shape, solved, .. } = attempt;
        let checked = self.checked;
        let loop_ = &checked.vertices;
        shape.positions = solved.positions;
        let work = &shape.work;
        let [min_angle, max_angle] = work.corner_range(&shape.positions);
        let loops = std::iter::once(loop_.as_slice());
        let [irregular, irregular_loop] = work.irregular(loops, self.rim, &self.job.options.polygons);
        let report = FillReport {
            triangles: work.single().len(),
            quads: work.quads,
            vertices: work.inner().len(),
            irregular,
            irregular_loop,
            grid: Grid::of(patch.method),
            rows: 0,
            folded: patch.folded,
            rim_angle: solved.rim_angle,
            unrolling: unrolled.method,
            distortion: unrolled.distortion,
            winding_conflicts: checked.conflicts,
            wire_edges: checked.wire,
            min_angle,
            max_angle,
            folds: solved.faults.folds,
            self_intersections: 0,
            creases,
            creases_kept: if shape.creases.is_empty() { 0 } else { creases },
            repaired: solved.repaired,
            seconds: clock.seconds,
        };
        let given = if checked.reversed { loop_.iter().rev().copied().collect() } else { loop_.clone() };
        Fill::of(given, shape, report)
    }
}

/// Normals of the triangles beyond a loop's edges, as if wound like the patch.
pub(super) fn outside(loop_: &[u32], rim: &Rim, vertices: &[DVec3]) -> Vec<Option<DVec3>> {
    let at = |v: u32| vertices[rim.ids[v as usize] as usize];
    let beyond = |k: usize| {
        let (a, b) = (rim.local(loop_[k])?, rim.local(loop_[(k + 1) % loop_.len()])?);
        let fan = rim.around(a).iter().map(|&t| rim.triangles[t as usize]);
        let triangle = fan.into_iter().find(|t| t.contains(&b))?;
        let [p, q, r] = triangle.map(at);
        let along = (0..3).any(|i| triangle[i] == a && triangle[(i + 1) % 3] == b);
        Some((q - p).cross(r - p) * if along { -1.0 } else { 1.0 })
    };
    (0..loop_.len()).map(beyond).collect()
}
