//! Positions and data of the new vertices.

use glam::{DMat3, DVec2, DVec3};

use super::fair::{Bending, Membrane, seams};
use super::meet::{count_meetings, is_graph};
use super::patchwork::Patchwork;
use super::sweep::sweep;
use crate::error::{Error, Result};
use crate::fill::filled::Shape;
use crate::fill::layout::unroll::area_vector;
use crate::fill::options::Smooth;
use crate::progress::Progress;

/// Weight of the angles across the loop's edges against the curvatures at the vertices. Chosen on disks cut
/// from meshes: with 0.7 the seam is rougher than its surroundings by a fifth, with more than 3 the
/// triangles at it get worse.
pub(super) const SEAM: f64 = 3.0;

/// The same where the curvature is to continue: then a curved surface has angles across the loop, too.
pub(in crate::fill) const SEAM_OF_CURVATURE: f64 = 0.7;

/// Rounds of tangential sweeps and a normal step, at most.
const ROUNDS: usize = 2;

/// Sweeps in each round.
const SWEEPS: usize = 3;

/// A round that lowers the bending by less than this share is the last.
const SETTLED: f64 = 1e-3;

/// Weights are limited to this from below where all must be positive, so that no value leaves the range
/// of those given.
pub(in crate::fill) const LEAST_WEIGHT: f64 = 1e-3;

/// Patches with this many meetings count as equally tangled: to count on takes time and helps nobody.
pub(super) const TANGLED: usize = 2000;

/// A loop counts as planar if it leaves its plane by less than this share of its size.
const PLANAR: f64 = 1e-12;

/// What [`Shape::solve`] found.
pub(in crate::fill) struct Solved {
    /// Of all vertices of the patchwork.
    pub positions: Vec<DVec3>,
    pub faults: Faults,
    /// Fallbacks.
    pub repaired: usize,
    /// Mean angle between the film and the surface around the loop, in radians.
    pub rim_angle: f64,
}

/// What is wrong with a patch in space; less is better.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::fill) struct Faults {
    /// Pairs of triangles, of the patch or one of it and one around it, that meet.
    pub meetings: usize,
    /// The surface is not continued although it should be: the film was the only one without meetings.
    pub film: bool,
    /// Inner edges with more than 120 degrees between the triangles; those of [`Shape::faults`] concave corners of quads, too.
    pub folds: usize,
}

impl Faults {
    /// Meetings are counted up to `most`, or some more.
    pub(in crate::fill) fn of(
        work: &Patchwork,
        positions: &[DVec3],
        most: usize,
        progress: Progress<'_>,
    ) -> Result<Faults> {
        let (own, around) = work.triangles.split_at(work.n_patch);
        let apart = is_graph(&positions[..work.n], &positions[..work.end], own);
        let (meetings, _) = count_meetings(|v| positions[v as usize], own, around, apart, most, progress)?;
        let meetings = meetings.min(TANGLED);
        Ok(Faults { meetings, film: false, folds: folded_edges(work, positions) })
    }
}

impl Shape {
    /// Positions for a mesh with vertices at `mesh`.
    ///
    /// First a film: the harmonic map with the metric of the flat patch, whose grid it inherits. Then the
    /// thin plate on the film's metric. Then rounds that separate shape and sampling: sweeps within
    /// the surface make the triangles good, a step along the normals makes the bending small. Neither undoes
    /// the other, as each solve in three coordinates would.
    pub(in crate::fill) fn solved(&self, mesh: &[DVec3], progress: Progress<'_>) -> Result<Solved> {
        let work = &self.work;
        let mut positions = vec![DVec3::ZERO; work.len()];
        for (k, &v) in self.loop_.iter().enumerate() {
            positions[k] = mesh[v as usize];
        }
        for (k, &v) in work.outer.iter().enumerate() {
            positions[work.end + k] = mesh[v as usize];
        }
        let membrane = if work.inner().is_empty() { None } else { self.film(&mut positions, progress)? };
        let rim_angle = rim_angle(work, &positions);
        progress.report(0.2)?;
        let mut solved = Solved { positions, faults: Faults::default(), repaired: 0, rim_angle };
        let mut stages = vec![];
        if !work.inner().is_empty() && self.smooth != Smooth::Flat && work.closed[..work.n].contains(&true) {
            stages.push(solved.positions.clone());
            let part = progress.part(0.2, 0.6);
            let bent = if self.is_coarse(rim_angle) {
                self.bend_finer(&mut solved.positions, part)
            } else {
                self.bend(&mut solved.positions, membrane, &mut stages, part)
            };
            match bent {
                Ok(()) => {}
                // Triangles without area can spoil the equations: what was reached before has to do.
                Err(Error::Solver { .. }) => {
                    let before = stages.pop().ok_or(Error::Internal { reason: "no film to fall back on" })?;
                    solved.positions = before;
                    solved.repaired = 1;
                }
                Err(other) => return Err(other),
            }
        }
        solved.faults = Faults::of(work, &solved.positions, TANGLED, progress.part(0.6, 0.8))?;
        // The film has the fewest faults, but it does not continue the surface: it is for patches that meet
        // something and could do without.
        for (k, stage) in stages.into_iter().enumerate().rev() {
            if solved.faults == Faults::default() || (k == 0 && solved.faults.meetings == 0) {
                break;
            }
            // More than these need not be counted: such a stage is no better.
            let most = if k == 0 { 1 } else { solved.faults.meetings + 1 };
            let faults = Faults::of(work, &stage, most, progress.part(0.8, 1.0))?;
            let faults = Faults { film: k == 0, ..faults };
            if faults < solved.faults && (k > 0 || faults.meetings == 0) {
                (solved.positions, solved.faults, solved.repaired) = (stage, faults, 1);
            }
        }
        Ok(solved)
    }

    /// New vertices for a mesh at `mesh`, moved with the loop: by the affine map that fits its displacement best,
    /// and what that leaves extended harmonically. So hard edges stay straight.
    pub(in crate::fill) fn carried(&self, mesh: &[DVec3], progress: Progress<'_>) -> Result<Vec<DVec3>> {
        let work = &self.work;
        let before = |v: usize| self.positions[v];
        let after = |v: usize| {
            if v < work.n { mesh[self.loop_[v] as usize] } else { mesh[work.outer[v - work.end] as usize] }
        };
        let given = (0..work.n).chain(work.end..work.len()).collect::<Vec<_>>();
        let count = given.len() as f64;
        let centre = given.iter().map(|&v| before(v)).sum::<DVec3>() / count;
        let shift = given.iter().map(|&v| after(v) - before(v)).sum::<DVec3>() / count;
        let size = given.iter().map(|&v| before(v).distance(centre)).fold(f64::MIN_POSITIVE, f64::max);
        let (mut spread, mut moved) = (DMat3::ZERO, DMat3::ZERO);
        for &v in &given {
            let (x, d) = ((before(v) - centre) / size, after(v) - before(v) - shift);
            spread += DMat3::from_cols(x * x.x, x * x.y, x * x.z);
            moved += DMat3::from_cols(d * x.x, d * x.y, d * x.z);
        }
        // Of planar surroundings the way across the plane is not known: it stays as it is.
        let turned = moved * (spread + DMat3::IDENTITY * 1e-9).inverse();
        let affine = |p: DVec3| shift + turned * ((p - centre) / size);
        let mut found = self.positions[work.inner()].iter().map(|&p| p + affine(p)).collect::<Vec<_>>();
        let left = |v: usize| after(v) - before(v) - affine(before(v));
        if found.is_empty() || (0..work.n).all(|v| left(v) == DVec3::ZERO) {
            return Ok(found);
        }
        let weights =
            work.cotangents(&self.positions).into_iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
        let rest = Membrane::new(work, progress)?.harmonic(&weights, |v| left(v).to_array(), progress)?;
        for (p, rest) in found.iter_mut().zip(rest) {
            *p += DVec3::from(rest);
        }
        sound(&found)?;
        Ok(found)
    }

    /// Places the new vertices on a film in the loop.
    fn film(&self, positions: &mut [DVec3], progress: Progress<'_>) -> Result<Option<Membrane<'_>>> {
        let work = &self.work;
        let around = &positions[..work.n];
        if let Some(lift) = lift(around, &self.flat) {
            for v in work.inner() {
                positions[v] = lift(self.flat[v]);
            }
            return Ok(None);
        }
        let weights = work.cotangents(&self.laid_out());
        progress.report(0.05)?;
        let membrane = Membrane::new(work, progress.part(0.05, 0.05))?;
        progress.report(0.1)?;
        let film = membrane.harmonic(&weights, |v| positions[v].to_array(), progress.part(0.1, 0.1))?;
        for (v, p) in work.inner().zip(film) {
            positions[v] = p.into();
        }
        Ok(Some(membrane))
    }

    /// See [`bend`].
    pub(in crate::fill) fn bend(
        &self,
        positions: &mut [DVec3],
        membrane: Option<Membrane<'_>>,
        stages: &mut Vec<Vec<DVec3>>,
        progress: Progress<'_>,
    ) -> Result<()> {
        bend(&self.work, self.smooth, positions, membrane, stages, progress)
    }

    /// The loop, the patch's vertices and its triangles.
    pub(in crate::fill) fn graph(&self) -> (&[DVec3], &[DVec3], &[[u32; 3]]) {
        let work = &self.work;
        (&self.positions[..work.n], &self.positions[..work.end], &work.triangles[..work.n_patch])
    }

    /// The patch as it lies in the plane; vertices around it at the origin.
    fn laid_out(&self) -> Vec<DVec3> {
        let mut flat = self.flat.iter().map(|p: &DVec2| p.extend(0.0)).collect::<Vec<_>>();
        flat.resize(self.work.len(), DVec3::ZERO);
        flat
    }

    /// The place of a loop vertex in the loop as it was given.
    fn given(&self, v: usize) -> usize {
        let range = self.work.loop_of(v);
        let later = self.bridged.iter().find(|bridged| bridged.first == range.start);
        if later.map_or(self.reversed, |bridged| bridged.reversed) {
            range.start + range.end - 1 - v
        } else {
            v
        }
    }

    /// See [`crate::fill::Fill::extend`].
    pub(in crate::fill) fn extend(
        &self,
        values: &[f64],
        columns: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>> {
        const TOGETHER: usize = 8;
        let work = &self.work;
        if values.len() != work.n * columns {
            return Err(Error::InvalidOption {
                name: "values",
                value: format!("of length {}", values.len()),
                allowed: "one row for each vertex of the loop",
            });
        }
        if let Some(k) = values.iter().position(|x| !x.is_finite()) {
            return Err(Error::NotFinite { what: "values".into(), point: k / columns });
        }
        let row = |v: usize| self.given(v);
        let inner = work.inner().len();
        let mut all = vec![0.0; inner * columns];
        if all.is_empty() {
            return Ok(all);
        }
        let weights =
            work.cotangents(&self.positions).into_iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
        let membrane = Membrane::new(work, progress)?;
        for first in (0..columns).step_by(TOGETHER) {
            let part = first..columns.min(first + TOGETHER);
            let value = |v: usize, c: usize| {
                if first + c < part.end { values[row(v) * columns + first + c] } else { 0.0 }
            };
            let known = |v: usize| std::array::from_fn(|c| value(v, c));
            let found = membrane.harmonic::<TOGETHER>(&weights, known, progress)?;
            for column in part {
                let own = values.iter().skip(column).step_by(columns);
                let (low, high) =
                    own.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
                for (k, x) in found.iter().enumerate() {
                    all[k * columns + column] = x[column - first].clamp(low, high);
                }
            }
        }
        Ok(all)
    }
}

/// Bends the film; `stages` gets what lies between, to fall back on.
pub(super) fn bend(
    work: &Patchwork,
    smooth: Smooth,
    positions: &mut [DVec3],
    membrane: Option<Membrane<'_>>,
    stages: &mut Vec<Vec<DVec3>>,
    progress: Progress<'_>,
) -> Result<()> {
    let bending = Bending::new(work, progress.part(0.0, 0.0))?;
    progress.report(0.1)?;
    bending.positions(positions, progress.part(0.1, 0.1))?;
    sound(positions)?;
    progress.report(0.15)?;
    let membrane = match (smooth, membrane) {
        (Smooth::Curvature, None) => Some(Membrane::new(work, progress.part(0.15, 0.15))?),
        (Smooth::Curvature, some) => some,
        _ => None,
    };
    let seam = if membrane.is_some() { SEAM_OF_CURVATURE } else { SEAM };
    let rounds = match work.inner().len() {
        0..5_000 => ROUNDS,
        5_000..30_000 => 1,
        _ => 0,
    };
    for _ in 0..rounds {
        stages.push(positions.to_vec());
        for _ in 0..SWEEPS {
            progress.report(0.2)?;
            sweep(work, positions);
        }
        progress.report(0.5)?;
        let here = progress.part(0.5, 0.5);
        let target = membrane.as_ref().map(|m| curvature_target(work, m, positions, here)).transpose()?;
        let [before, after] = bending.normal_step(positions, seam, target.as_deref(), here)?;
        sound(positions)?;
        if after > (1.0 - SETTLED) * before {
            break;
        }
    }
    Ok(())
}

/// Refuses positions that are not finite, as surroundings of very different sizes can bring about.
pub(super) fn sound(positions: &[DVec3]) -> Result<()> {
    if positions.iter().all(|p| p.is_finite()) {
        return Ok(());
    }
    Err(Error::Solver { stage: "fill", reason: "a vertex is not finite".into() })
}

/// The way from the plane to space if the flat loop is the loop itself, moved rigidly.
fn lift(around: &[DVec3], flat: &[DVec2]) -> Option<impl Fn(DVec2) -> DVec3 + use<>> {
    let n = around.len();
    let far = (1..n).max_by(|&a, &b| flat[0].distance(flat[a]).total_cmp(&flat[0].distance(flat[b])))?;
    let normal = area_vector(around).try_normalize()?;
    let along = (flat[far] - flat[0]).try_normalize()?;
    let u = (around[far] - around[0]).reject_from(normal).try_normalize()?;
    let w = normal.cross(u);
    let (origin, start) = (flat[0], around[0]);
    let place = move |p: DVec2| {
        let d = p - origin;
        start + d.dot(along) * u + d.dot(along.perp()) * w
    };
    let size = flat[0].distance(flat[far]);
    (0..n).all(|k| place(flat[k]).distance(around[k]) <= PLANAR * size).then_some(place)
}

/// The mean curvature that a patch is to have: at the loop that of the ring around it, inside harmonic.
pub(in crate::fill) fn curvature_target(
    work: &Patchwork,
    membrane: &Membrane<'_>,
    positions: &[DVec3],
    progress: Progress<'_>,
) -> Result<Vec<f64>> {
    let cotangents = work.cotangents(positions);
    let areas = work.areas(positions);
    let normals = work.normals(positions);
    let curvature = |v: usize| {
        let near = work.range(v).map(|slot| (cotangents[slot], work.near[slot] as usize));
        let laplacian: DVec3 = near.map(|(w, u)| w * (positions[u] - positions[v])).sum();
        normals[v].dot(laplacian) / areas[v].max(f64::MIN_POSITIVE)
    };
    // The mean over the neighbours outside, which see the given surface alone.
    let beside = |v: usize| {
        let near = work.near[work.range(v)].iter().map(|&u| u as usize);
        let outside = near.filter(|&u| u >= work.end && work.closed[u]);
        let (sum, area) =
            outside.fold((0.0, 0.0), |(sum, area), u| (sum + areas[u] * curvature(u), area + areas[u]));
        if area > 0.0 { sum / area } else { 0.0 }
    };
    let mut target = (0..work.n).map(beside).collect::<Vec<_>>();
    for _ in 0..2 {
        let before = target.clone();
        target.iter_mut().for_each(|h| *h *= 0.5);
        for v in 0..work.n {
            let next = work.after(v);
            target[v] += 0.25 * before[next];
            target[next] += 0.25 * before[v];
        }
    }
    let weights = cotangents.iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
    target.extend(membrane.harmonic(&weights, |v| [target[v]], progress)?.into_iter().flatten());
    Ok(target)
}

/// Mean angle across the loop's edges, weighted by length.
pub(in crate::fill) fn rim_angle(work: &Patchwork, positions: &[DVec3]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (length, angle) in across_seams(work, positions) {
        sum += length * angle;
        total += length;
    }
    if total > 0.0 { sum / total } else { 0.0 }
}

/// The root mean square of the angles across the loop's edges.
pub(in crate::fill) fn seam_angle(work: &Patchwork, positions: &[DVec3]) -> f64 {
    let angles = across_seams(work, positions);
    let squares = angles.iter().map(|(_, angle)| angle * angle).sum::<f64>();
    (squares / angles.len().max(1) as f64).sqrt()
}

/// The length of each edge of the loop that has triangles on both sides, and the angle across it.
fn across_seams(work: &Patchwork, positions: &[DVec3]) -> Vec<(f64, f64)> {
    let across = |[a, b, c, d]: [u32; 4]| {
        let [a, b, c, d] = [a, b, c, d].map(|v| positions[v as usize]);
        let edge = b - a;
        let (inner, outer) = (edge.cross(c - a), (d - a).cross(edge));
        (edge.length(), libm::atan2(inner.cross(outer).length(), inner.dot(outer)))
    };
    seams(work).into_iter().map(across).collect()
}

/// Inner edges of a patch whose triangles are more than 120 degrees apart, and concave corners of quads.
pub(in crate::fill) fn folds(work: &Patchwork, positions: &[DVec3]) -> usize {
    folded_edges(work, positions) + work.concave(positions)
}

fn folded_edges(work: &Patchwork, positions: &[DVec3]) -> usize {
    const NONE: u32 = u32::MAX;
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let normals = work.triangles[..work.n_patch].iter().map(normal).collect::<Vec<_>>();
    // The first triangle at each edge.
    let mut first = vec![NONE; work.near.len()];
    let mut count = 0;
    for t in 0..work.n_patch {
        for edge in work.edge_slots(t) {
            let other = &mut first[edge as usize];
            if *other == NONE {
                *other = t as u32;
            } else {
                count += usize::from(normals[t].dot(normals[*other as usize]) < -0.5);
            }
        }
    }
    count
}
