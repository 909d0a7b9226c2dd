//! Even edges along the cut, and the faces along it rebuilt to match.
//!
//! The line gets vertices at even distances, more where it bends; the others are collapsed into them. Then triangles
//! with small angles near the line are flipped, collapsed or split while that helps.

pub(crate) mod beside;
pub(crate) mod defect;
pub(crate) mod ground;
mod improve;
pub(crate) mod line;
pub(crate) mod nearness;
pub(crate) mod reshape;
pub(crate) mod slide;
pub(crate) mod spacing;
pub(crate) mod strip;
pub(crate) mod thin;

use std::collections::BTreeSet;

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::cutting::Cutting;
use super::input::{Polygons, triangles};
use super::report::Tally;
use crate::cut::divide::parted::{Part, Parted, SEAM};
use crate::cut::rim::defect::defect;
use crate::cut::rim::improve::{BATCH, POOR, ROUNDS, SMALL, improve};
use crate::cut::rim::nearness::closest;
use crate::cut::rim::slide::Course;
use crate::cut::rim::spacing::resample;
use crate::cut::rim::strip::{Strip, Trial};
use crate::error::Result;
use crate::progress::Progress;

/// Vertices nearer to the line than this, in edge lengths, are taken out where the surface allows it.
const BESIDE: f64 = 0.45;

/// Vertices of the line slide where angles are below this.
const SLIDE: f64 = 0.3;

/// The line's edges stay between these when vertices slide, in edge lengths.
const SHORT: f64 = 0.6;
const LONG: f64 = 1.4;

/// So often the line is drawn through vertices beside it, where it is.
const DRAWN: usize = 2;

/// What the line is to become, and which old vertices it may be drawn through.
pub(super) struct Through<'a> {
    /// Its edges' length.
    pub length: f64,
    /// The distance of the old vertices from the line at most.
    pub reach: f64,
    /// How far each is off where the line was drawn.
    pub off: &'a dyn Fn(u32) -> f64,
}

/// Evens out the line and the faces along it. Returns false if the cut must be repeated: `again` gets the old vertices
/// beside the line whose triangles stay thin, in order, and says whether to snap the line to them.
pub(super) fn even_out(
    cutting: Cutting<'_>,
    parted: &mut Parted,
    through: &Through<'_>,
    tally: &mut Tally,
    again: impl FnOnce(Vec<u32>) -> bool,
    progress: Progress<'_>,
) -> Result<bool> {
    let Cutting { vertices, faces, .. } = cutting;
    let length = through.length;
    let parts = gather(vertices, faces, parted);
    let old = std::mem::take(&mut parted.parts);
    let own = old.iter().map(|p| p.face).collect::<FxHashSet<_>>();
    let mut strip = Strip::new(vertices, parted, parts, length);
    let (mut kept, mut course) = resample(&mut strip, length);
    progress.report(0.0)?;
    beside::divide(&mut strip, length, progress.part(0.0, 0.0))?;
    let mut part = 0.0;
    // Once the line is drawn through others, only what is new there is looked at.
    for from in [0].into_iter().chain([ROUNDS / 2; DRAWN]) {
        for round in from..ROUNDS {
            // Later rounds have less and less to do.
            let here = progress.part(part, 0.5 * (1.0 + part));
            part = 0.5 * (1.0 + part);
            let mut changes = thin_out(&mut strip, &kept, here)?;
            changes += clear_beside(&mut strip, BESIDE * length, here)?;
            changes += thin_out(&mut strip, &kept, here)?;
            changes += improve(&mut strip, &kept, length, round, here)?;
            changes += slide(&mut strip, &mut course, length, here)?;
            if changes == 0 {
                break;
            }
        }
        if !draw_through(&mut strip, &mut kept, through) {
            break;
        }
    }
    if again(in_the_way(&strip, through.reach)) {
        return Ok(false);
    }
    tally.report.defect = defect(faces, &strip, progress)?;
    let Strip { parts, altered, .. } = strip;
    let parts = parts.into_iter().flatten();
    for &f in &altered {
        parted.divided[f as usize] = true;
    }
    parted.parts = parts.filter(|p| parted.divided[p.face as usize] || own.contains(&p.face)).collect();
    Ok(true)
}

/// Turns edges of these triangles, where they have small angles, and of those around while that makes them larger.
pub(super) fn flip_all(
    strip: &mut Strip<'_>,
    mut queue: BTreeSet<u32>,
    progress: Progress<'_>,
) -> Result<()> {
    let mut budget = 20 * queue.len();
    while let Some(t) = queue.pop_first().filter(|_| budget > 0) {
        budget -= 1;
        if budget.is_multiple_of(BATCH) {
            progress.report(0.0)?;
        }
        let Some(part) = strip.part(t).copied() else { continue };
        if strip.min_angle(part.corners) >= SMALL {
            continue;
        }
        for k in 0..3 {
            let (a, b) = (part.corners[k], part.corners[(k + 1) % 3]);
            let both = strip.with_edge(a, b);
            if strip.flip(a, b) {
                let corners = both.iter().filter_map(|&t| strip.part(t)).map(|p| p.corners);
                let sides = corners.flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]).collect::<Vec<_>>();
                queue.extend(sides.into_iter().flat_map(|(a, b)| strip.with_edge(a, b)));
                break;
            }
        }
    }
    Ok(())
}

/// Draws the line through vertices that are in the way, where that makes the angles there larger.
fn draw_through(strip: &mut Strip<'_>, kept: &mut FxHashSet<u32>, through: &Through<'_>) -> bool {
    let mut drawn = false;
    for v in in_the_way(strip, through.reach) {
        let off = (through.off)(v);
        let mut line: Vec<u32> =
            strip.neighbours(v).into_iter().filter(|&u| !strip.on_line(u).is_empty()).collect();
        let far = |u: u32| strip.position(u).distance_squared(strip.position(v));
        line.sort_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
        for u in line {
            if off > through.reach.min(SEAM * strip.line_size(u)) {
                continue;
            }
            let around =
                [u, v].into_iter().flat_map(|w| strip.triangles_at(w)).filter_map(|&t| strip.part(t));
            let worst = around.map(|p| strip.min_angle(p.corners)).fold(f64::INFINITY, f64::min);
            if strip.draw_through(u, v, 1.05 * worst) {
                kept.insert(v);
                drawn = true;
                break;
            }
        }
    }
    drawn
}

fn in_the_way(strip: &Strip<'_>, reach: f64) -> Vec<u32> {
    let is_old = |v: u32| (v as usize) < strip.parted.n_old && strip.on_line(v).is_empty();
    let is_near = |v: u32, u: u32| {
        let beside = strip.on_line(u).iter();
        beside.into_iter().any(|&w| {
            let (p, q) = (strip.position(u), strip.position(w));
            closest(strip.position(v), [p, q, q]).0 < reach
        })
    };
    let poor = strip.parts.iter().flatten().filter(|part| strip.min_angle(part.corners) < POOR);
    let mut found: Vec<u32> = poor
        .flat_map(|part| {
            let [a, b, c] = part.corners;
            [(a, b, c), (b, c, a), (c, a, b)]
        })
        .filter(|&(v, a, b)| is_old(v) && (is_near(v, a) || is_near(v, b)))
        .map(|(v, ..)| v)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Triangles of the faces that the cut meets, and of those around them.
fn gather(vertices: &[DVec3], faces: Polygons<'_>, parted: &Parted) -> Vec<Part> {
    let mut near = parted.on_cut();
    near.truncate(parted.n_old);
    for v in parted.parts.iter().flat_map(|p| p.corners) {
        if let Some(near) = near.get_mut(v as usize) {
            *near = true;
        }
    }
    let mut parts = parted.parts.clone();
    // Two rings.
    let mut wider = near.clone();
    for f in (0..faces.len()).filter(|&f| !parted.divided[f]) {
        let corners = faces.face(f);
        if corners.iter().any(|&v| near[v as usize]) {
            corners.iter().for_each(|&v| wider[v as usize] = true);
        }
    }
    for f in (0..faces.len()).filter(|&f| !parted.divided[f]) {
        let corners = faces.face(f);
        if corners.iter().any(|&v| wider[v as usize]) {
            triangles(vertices, corners, |t| {
                parts.push(Part { corners: t, face: f as u32, home: t, left: parted.left[f] });
            });
        }
    }
    parts
}

/// Collapses vertices of the line that do not stay into those beside them.
fn thin_out(strip: &mut Strip<'_>, kept: &FxHashSet<u32>, progress: Progress<'_>) -> Result<usize> {
    let mut on = strip.parted.cut.keys().flat_map(|&(a, b)| [a, b]).collect::<Vec<_>>();
    on.sort_unstable();
    on.dedup();
    let mut changes = 0;
    for (k, u) in on.into_iter().filter(|v| !kept.contains(v)).enumerate() {
        if k % BATCH == 0 {
            progress.report(0.0)?;
        }
        if strip.is_hopeless(u, Trial::Thin) {
            continue;
        }
        let mut beside = strip.on_line(u).to_vec();
        let p = strip.position(u);
        beside.sort_by(|&a, &b| {
            let near = |v: u32| strip.position(v).distance_squared(p);
            near(a).total_cmp(&near(b))
        });
        if beside.into_iter().any(|v| strip.collapse(u, v, 0.0)) {
            changes += 1;
        } else {
            strip.give_up(u, Trial::Thin);
        }
    }
    Ok(changes)
}

/// Collapses vertices that lie close to the line into it.
fn clear_beside(strip: &mut Strip<'_>, distance: f64, progress: Progress<'_>) -> Result<usize> {
    let mut near: BTreeSet<u32> = BTreeSet::new();
    for (k, &(a, b)) in strip.parted.cut.keys().enumerate() {
        if k % BATCH == 0 {
            progress.report(0.0)?;
        }
        let (p, q) = (strip.position(a), strip.position(b));
        for v in [a, b] {
            let corners = strip.triangles_at(v).iter().filter_map(|&t| strip.part(t)).flat_map(|t| t.corners);
            near.extend(corners.filter(|&x| {
                strip.on_line(x).is_empty() && closest(strip.position(x), [p, q, q]).0 < distance
            }));
        }
    }
    let mut changes = 0;
    for (k, x) in near.into_iter().enumerate() {
        if k % BATCH == 0 {
            progress.report(0.0)?;
        }
        if strip.is_hopeless(x, Trial::Clear) {
            continue;
        }
        let p = strip.position(x);
        let own = strip.triangles_at(x).iter().filter_map(|&t| strip.part(t)).flat_map(|t| t.corners);
        let mut line = own.filter(|&v| !strip.on_line(v).is_empty()).collect::<Vec<_>>();
        line.sort_by(|&a, &b| {
            let far = |v: u32| strip.position(v).distance_squared(p);
            far(a).total_cmp(&far(b)).then(a.cmp(&b))
        });
        line.dedup();
        if line.into_iter().any(|v| strip.collapse(x, v, 0.0)) {
            changes += 1;
        } else {
            strip.give_up(x, Trial::Clear);
        }
    }
    Ok(changes)
}

/// Slides vertices of the line at thin triangles along it.
fn slide(strip: &mut Strip<'_>, course: &mut Course, length: f64, progress: Progress<'_>) -> Result<usize> {
    let mut on = strip.parted.cut.keys().flat_map(|&(a, b)| [a, b]).collect::<Vec<_>>();
    on.sort_unstable();
    on.dedup();
    let mut changes = 0;
    for (k, v) in on.into_iter().enumerate() {
        if k % BATCH == 0 {
            progress.report(1.0)?;
        }
        if strip.is_hopeless(v, Trial::Slide) {
            continue;
        }
        let own = strip.triangles_at(v).iter().filter_map(|&t| strip.part(t));
        let is_thin = own.map(|p| strip.min_angle(p.corners)).any(|angle| angle < SLIDE);
        if is_thin && course.slide(strip, v, SHORT * length, LONG * length) {
            changes += 1;
        } else {
            strip.give_up(v, Trial::Slide);
        }
    }
    Ok(changes)
}
