//! Mirror-symmetric meshes: the lattice laid on the axis, symmetric paths, symmetric placement.
//!
//! A lattice has two kinds of mirror axes, along a direction and across one. The path of a symmetric
//! contour is found for the mean of its two sides, so that both have the same topology however
//! unlike they were drawn; the vertices then go onto each side's own line.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::assemble::{Region, assemble};
use crate::axial::Axial;
use crate::curve::ClosedCurve;
use crate::deviation::{beside, crossings, deviation};
use crate::error::{Error, Result};
use crate::lattice::{Lattice, ROW_HEIGHT};
use crate::options::SketchOptions;
use crate::outline::{Obstacle, Outline};
use crate::patch::{Loop, Patch};
use crate::place::{CORNER_WINDOW, INLET, Placed, STRAY, min_angle, nearest_drawn};
use crate::pockets::pockets;
use crate::progress::Progress;
use crate::reflection::Reflection;
use crate::relax::first_inverted;
use crate::symmetry::{Pairing, Symmetry};
use crate::target::{SPACING, Target};
use crate::trace::{Part, TraceFailure, TraceOptions, trace_mirrored};

/// A corner of the drawing this near to where a vertex's image belongs gets it, in edges.
const CORNER_REACH: f64 = 0.5;

/// The lattices to try: angle, and shift in edges along the lattice's own axes. With an angle given,
/// those that lie that way.
pub(crate) fn placements(symmetry: &Symmetry, angle: Option<f64>) -> Vec<(f64, DVec2)> {
    const SHIFTS: [f64; 4] = [0.0, 0.5, 0.25, 0.75];
    let direction = symmetry.axis.direction;
    let along = direction.y.atan2(direction.x);
    let on_direction = SHIFTS.map(|shift| (along, DVec2::new(shift, 0.0)));
    // Rows lie across the axis: every other one has a point on it.
    let on_rows = SHIFTS.map(|shift| (along + FRAC_PI_2, DVec2::new(0.0, 2.0 * ROW_HEIGHT * shift)));
    let all = on_direction.into_iter().zip(on_rows).flat_map(|(a, b)| [a, b]);
    all.filter(|(it, _)| angle.is_none_or(|angle| is_alike(*it, angle))).collect()
}

/// # Errors
/// [`Error::InvalidOption`] if the lattice cannot be laid on the axis at the angle given.
pub(crate) fn check_angle(symmetry: Option<&Symmetry>, angle: Option<f64>) -> Result<()> {
    let Some((symmetry, angle)) = symmetry.zip(angle) else { return Ok(()) };
    if placements(symmetry, Some(angle)).is_empty() {
        let value = format!("{angle}, beside mirror");
        let allowed = "none, or the angle of the axis or 30 degrees from it, modulo 60 degrees";
        return Err(Error::InvalidOption { name: "angle", value, allowed });
    }
    Ok(())
}

/// True if two angles are those of the same lattice.
fn is_alike(a: f64, b: f64) -> bool {
    const NEAR: f64 = 1e-6;
    let between = (a - b).rem_euclid(FRAC_PI_3);
    between.min(FRAC_PI_3 - between) < NEAR
}

/// How the axis lies in a lattice that was laid on it.
pub(crate) fn reflection(symmetry: &Symmetry, lattice: &Lattice) -> Reflection {
    let across = symmetry.axis.direction.perp_dot(DVec2::from_angle(lattice.angle)).abs();
    if across < 0.5 { Reflection::Along } else { Reflection::Across }
}

/// The symmetric boundary of least cost for a lattice laid on the axis.
pub(crate) fn traced(
    contours: &[ClosedCurve],
    symmetry: &Symmetry,
    lattice: &Lattice,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Result<Outline, Obstacle>> {
    let axis = reflection(symmetry, lattice);
    let sides = Sides { contours, lattice, axis, corner_angle: options.corner_angle };
    let parts: Vec<Part> = symmetry.pairings.iter().map(|pairing| sides.part(pairing)).collect();
    let wanted = TraceOptions {
        max_distance: options.max_distance,
        closeness: options.closeness,
        proof_nodes: options.proof_nodes,
    };
    let traced = match trace_mirrored(&parts, axis, &wanted, progress) {
        Ok(traced) => traced,
        Err(TraceFailure::Cancelled) => return Err(Error::Cancelled),
        Err(failure) => {
            let near = contours[0].points()[0];
            let at = failure.at().map_or(near, |at| lattice.from_units(Lattice::units(at)));
            return Ok(Err(Obstacle { reason: failure.to_string(), at }));
        }
    };
    let mut outline = Outline {
        paths: vec![Vec::new(); contours.len()],
        arcs: vec![Vec::new(); contours.len()],
        cost: traced.cost,
        cost_bound: Some(traced.cost_bound),
        turns_bound: Some(traced.turns_bound),
        optimal: traced.optimal,
        max_distance_used: traced.max_distance_used,
        ..Outline::default()
    };
    let mut paths = traced.paths.into_iter();
    for (pairing, part) in symmetry.pairings.iter().zip(&parts) {
        let targets = part.targets(axis);
        for (side, (contour, target)) in contours_of(pairing).into_iter().zip(targets).enumerate() {
            let Some(path) = paths.next() else { continue };
            let whole = target.len() as f64;
            let arc = |u: &f64| arc_at(contours, pairing, side, u / whole) / lattice.edge_length;
            outline.arcs[contour] = path.parameters.iter().map(arc).collect();
            outline.paths[contour] = path.points;
        }
    }
    Ok(Ok(outline))
}

/// The contours of a pairing: the one on the left first.
fn contours_of(pairing: &Pairing) -> Vec<usize> {
    match pairing {
        Pairing::Own { contour, .. } => vec![*contour],
        Pairing::Two { contours, .. } => contours.to_vec(),
    }
}

/// Arc length on a contour of a pairing at a number of turns along its symmetric target.
fn arc_at(contours: &[ClosedCurve], pairing: &Pairing, side: usize, turns: f64) -> f64 {
    let (lap, part) = (turns.floor(), turns - turns.floor());
    match pairing {
        Pairing::Own { contour, start, left, right, matching } => {
            let length = contours[*contour].length();
            start
                + lap * length
                + if part <= 0.5 {
                    matching.pair(2.0 * part)[0] * left
                } else {
                    length - matching.pair(2.0 - 2.0 * part)[1] * right
                }
        }
        Pairing::Two { contours: [a, _], matching, .. } if side == 0 => {
            (lap + matching.pair(part)[0]) * contours[*a].length()
        }
        Pairing::Two { contours: [_, b], start, matching } => {
            start + (lap + 1.0 - matching.pair(1.0 - part)[1]) * contours[*b].length()
        }
    }
}

/// The mean of both sides of a drawing, in lattice units.
struct Sides<'a> {
    contours: &'a [ClosedCurve],
    lattice: &'a Lattice,
    axis: Reflection,
    corner_angle: f64,
}

impl Sides<'_> {
    fn part(&self, pairing: &Pairing) -> Part {
        match pairing {
            Pairing::Own { contour, start, left, .. } => {
                let length = self.contours[*contour].length() / self.lattice.edge_length;
                let n = ((0.5 * length / SPACING).ceil() as usize).max(6);
                let mut samples: Vec<DVec2> =
                    (0..=n).map(|i| self.mean(pairing, 0.5 * i as f64 / n as f64)).collect();
                for on_axis in [0, n] {
                    samples[on_axis] =
                        0.5 * (samples[on_axis] + Lattice::reflected(self.axis, samples[on_axis]));
                }
                let images: Vec<DVec2> =
                    samples[1..n].iter().rev().map(|&p| Lattice::reflected(self.axis, p)).collect();
                samples.extend(images);
                Part::Symmetric {
                    target: Target::faired(&samples, 0.5 * length / n as f64),
                    corners: [*start, start + left].map(|s| self.is_corner(&self.contours[*contour], s)),
                }
            }
            Pairing::Two { contours, .. } => {
                let length = self.contours[contours[0]].length() / self.lattice.edge_length;
                let n = ((length / SPACING).ceil() as usize).max(12);
                let samples: Vec<DVec2> = (0..n).map(|i| self.mean(pairing, i as f64 / n as f64)).collect();
                Part::Pair(Target::faired(&samples, length / n as f64))
            }
        }
    }

    /// True if a contour turns sharply at an arc length.
    fn is_corner(&self, contour: &ClosedCurve, s: f64) -> bool {
        let window = CORNER_WINDOW * self.lattice.edge_length;
        let p = contour.point_at(s);
        let (before, after) = (p - contour.point_at(s - window), contour.point_at(s + window) - p);
        before.perp_dot(after).atan2(before.dot(after)).abs() > self.corner_angle
    }

    /// The point on the left and the image of its partner, halfway between.
    fn mean(&self, pairing: &Pairing, turns: f64) -> DVec2 {
        let on = |contour: usize, side: usize, turns: f64| {
            self.lattice.to_units(self.contours[contour].point_at(arc_at(
                self.contours,
                pairing,
                side,
                turns,
            )))
        };
        let (p, q) = match pairing {
            Pairing::Own { contour, .. } => (on(*contour, 0, turns), on(*contour, 0, 1.0 - turns)),
            Pairing::Two { contours: [a, b], .. } => (on(*a, 0, turns), on(*b, 1, 1.0 - turns)),
        };
        0.5 * (p + Lattice::reflected(self.axis, q))
    }
}

/// Makes a placement symmetric: partners take the mean of their two places, or both that of the one
/// side, whatever leaves the best triangles; on each side's own line.
///
/// Proves again what placing proves. If the sides differ and no symmetric placement is valid, the
/// one given is kept. The second number is the greatest distance of a vertex from the image of its
/// partner, in edges.
pub(crate) fn symmetrised(
    contours: &[ClosedCurve],
    symmetry: &Symmetry,
    outline: &Outline,
    placed: Placed,
    options: &SketchOptions,
) -> Result<(Placed, f64), Obstacle> {
    let lattice = placed.patch.lattice;
    let axis = reflection(symmetry, &lattice);
    let region = assemble(&outline.paths);
    let at = contours[0].points()[0];
    let partner =
        partners(&region, axis).ok_or(Obstacle { reason: "the boundary is not symmetric".to_owned(), at })?;
    let both = Both { contours, symmetry, region: &region, axis, partner, placed: &placed };
    let mut best: Option<(usize, f64, Placed)> = None;
    for side in [Side::Mean, Side::Left, Side::Right] {
        let Some(found) = both.placed_by(side, options) else { continue };
        // The mean, unless it bends triangles that a single side leaves in shape.
        let angle = min_angle(&found.patch) * if side == Side::Mean { 1.1 } else { 1.0 };
        let lost = found.lost();
        let is_better =
            |&(fewest, least, _): &(usize, f64, Placed)| lost < fewest || lost == fewest && angle > least;
        if best.as_ref().is_none_or(is_better) {
            best = Some((lost, angle, found));
        }
    }
    let exact = is_exact(symmetry, lattice.edge_length);
    let placed = match best {
        Some((.., placed)) => placed,
        None if exact => return Err(Obstacle { reason: "a triangle stays inverted".to_owned(), at }),
        None => placed.clone(),
    };
    let error = (0..region.points.len())
        .map(|v| {
            let image = placed.patch.vertices[both.partner[v]];
            symmetry.axis.reflected(placed.patch.vertices[v]).distance(image)
        })
        .fold(0.0, f64::max);
    Ok((placed, error / lattice.edge_length))
}

/// True if the sides of a drawing differ by rounding only.
fn is_exact(symmetry: &Symmetry, edge_length: f64) -> bool {
    symmetry.difference <= 1e-9 * edge_length
}

/// The vertex at the mirror image of each vertex.
fn partners(region: &Region, axis: Reflection) -> Option<Vec<usize>> {
    let number: FxHashMap<Axial, usize> = region.points.iter().enumerate().map(|(v, &p)| (p, v)).collect();
    region.points.iter().map(|&p| number.get(&axis.point(p)).copied()).collect()
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Mean,
    Left,
    Right,
}

struct Both<'a> {
    contours: &'a [ClosedCurve],
    symmetry: &'a Symmetry,
    region: &'a Region,
    axis: Reflection,
    partner: Vec<usize>,
    placed: &'a Placed,
}

impl Both<'_> {
    /// The placement with both sides as one of them is; none if it is not valid.
    fn placed_by(&self, side: Side, options: &SketchOptions) -> Option<Placed> {
        let patch = &self.placed.patch;
        let mut vertices = self.interior(side);
        let mut loops = patch.loops.clone();
        let mut arcs: Vec<Vec<f64>> = vec![Vec::new(); loops.len()];
        for pairing in &self.symmetry.pairings {
            for (of, contour) in contours_of(pairing).into_iter().enumerate() {
                arcs[contour] = self.rim(pairing, of, side, &mut loops[contour], &mut vertices)?;
            }
        }
        if options.relax && first_inverted(&vertices, &patch.triangles, patch.lattice.origin).is_some() {
            return None;
        }
        let h = patch.lattice.edge_length;
        let beside = beside(self.contours, &vertices, &arcs);
        let (farthest, _) = deviation(&beside, &vertices, &arcs, STRAY * h);
        if farthest > STRAY * h {
            return None;
        }
        let found = pockets(&beside, &vertices, &patch.triangles, &arcs, INLET * h);
        let crossing = if options.relax { crossings(&beside, &vertices, &arcs).len() } else { 0 };
        let kept = loops.iter().flat_map(|l| &l.corner).filter(|&&angle| angle != 0.0).count();
        let triangles = patch.triangles.clone();
        Some(Placed {
            patch: Patch { vertices, triangles, loops, inlets: found.inlets, lattice: patch.lattice },
            released_corners: self.placed.corners.saturating_sub(kept),
            max_deviation: farthest / h,
            bridged_inlets: found.occupied.len(),
            crossings: crossing,
            ..self.placed.clone()
        })
    }

    /// All vertices placed symmetrically; those of the rims are still to go onto their lines.
    fn interior(&self, side: Side) -> Vec<DVec2> {
        let axis = self.symmetry.axis;
        let at = &self.placed.patch.vertices;
        (0..at.len())
            .map(|v| {
                let partner = self.partner[v];
                let is_left = self.axis.side(self.region.points[v]) > 0;
                match side {
                    _ if partner == v => axis.foot(at[v]),
                    Side::Mean if is_left => 0.5 * (at[v] + axis.reflected(at[partner])),
                    Side::Mean => axis.reflected(0.5 * (at[partner] + axis.reflected(at[v]))),
                    Side::Left if !is_left => axis.reflected(at[partner]),
                    Side::Right if is_left => axis.reflected(at[partner]),
                    _ => at[v],
                }
            })
            .collect()
    }

    /// Puts a contour's vertices where they belong; their arc lengths, unwrapped. None if they are not
    /// in order.
    fn rim(
        &self,
        pairing: &Pairing,
        of: usize,
        side: Side,
        placed: &mut Loop,
        vertices: &mut [DVec2],
    ) -> Option<Vec<f64>> {
        let contour_number = contours_of(pairing)[of];
        let contour = &self.contours[contour_number];
        let old = &self.placed.patch.loops;
        let mut arcs: Vec<f64> = Vec::with_capacity(placed.len());
        for v in placed.vertices().map(|v| v as usize) {
            let w = self.partner[v];
            let partner_loop = old.iter().find(|l| l.vertices().contains(&(w as u32)))?;
            let i = v - placed.start as usize;
            let is_left = self.axis.side(self.region.points[v]) > 0;
            let own = self.left_turns(pairing, of, v);
            let other =
                self.left_turns(pairing, if contours_of(pairing).len() == 2 { 1 - of } else { of }, w);
            // A corner on the axis belongs to a vertex on the axis or to none.
            let corner = [
                (own, old[contour_number].corner[i]),
                (other, partner_loop.corner[w - partner_loop.start as usize]),
            ]
            .map(|(turns, angle)| if v != w && self.is_crossing(pairing, turns) { 0.0 } else { angle });
            // Which vertex, this one or its partner, says where both are.
            let (turns, from) = match side {
                _ if v != w && self.is_crossing(pairing, own) => (other, 1),
                _ if v != w && self.is_crossing(pairing, other) => (own, 0),
                Side::Left if is_left => (own, 0),
                Side::Right if !is_left => (own, 0),
                Side::Left | Side::Right => (other, 1),
                Side::Mean if corner[0] != 0.0 && (is_left || corner[1] == 0.0) => (own, 0),
                Side::Mean if corner[1] != 0.0 => (other, 1),
                Side::Mean => (own + 0.5 * nearest_lap(other - own), 2),
            };
            let (s, angle) = if v == w {
                let old_s = contour.own_arc(old[contour_number].arc[i]);
                self.on_axis(pairing, contour, own, (old_s, corner[0]))?
            } else if from == 0 {
                (contour.own_arc(old[contour_number].arc[i]), corner[0])
            } else {
                let right = matches!(pairing, Pairing::Own { .. }) && !is_left
                    || matches!(pairing, Pairing::Two { .. }) && of == 1;
                let s = arc_at(self.contours, pairing, of, if right { 1.0 - turns } else { turns });
                self.at_corner(contour, contour.wrap(s), if from == 1 { corner[1] } else { 0.0 }, corner[0])
            };
            let s = if angle == 0.0 { s } else { nearest_drawn(contour, s) };
            vertices[v] = contour.point_at(s);
            placed.arc[i] = contour.input_arc(s);
            placed.source[i] = contour.source(s);
            placed.corner[i] = angle;
            let unwrapped = match arcs.last() {
                Some(last) => last + contour.wrap(s - last),
                None => s,
            };
            arcs.push(unwrapped);
        }
        let steps = arcs.windows(2).all(|s| s[0] < s[1]);
        (steps && arcs.last()? < &(arcs[0] + contour.length())).then_some(arcs)
    }

    /// Where a vertex is, in turns along the target of the side on the left: partners agree.
    fn left_turns(&self, pairing: &Pairing, of: usize, v: usize) -> f64 {
        let loops = &self.placed.patch.loops;
        let s = |contour: usize| {
            let arc = loops[contour].arc[v - loops[contour].start as usize];
            self.contours[contour].own_arc(arc)
        };
        match pairing {
            Pairing::Own { contour, start, left, right, matching } => {
                let length = self.contours[*contour].length();
                let along = self.contours[*contour].wrap(s(*contour) - start);
                let turns = if along <= *left {
                    0.5 * matching.parameter(0, along / left)
                } else {
                    1.0 - 0.5 * matching.parameter(1, (length - along) / right)
                };
                if self.axis.side(self.region.points[v]) >= 0 { turns } else { 1.0 - turns }
            }
            Pairing::Two { contours: [a, b], start, matching } => {
                if of == 0 {
                    matching.parameter(0, s(*a) / self.contours[*a].length())
                } else {
                    let back = self.contours[*b].wrap(start - s(*b)) / self.contours[*b].length();
                    matching.parameter(1, back)
                }
            }
        }
    }

    /// The crossing of the axis that a vertex on it belongs to, or the drawn corner near it that it is
    /// on; and the angle of the corner.
    fn on_axis(
        &self,
        pairing: &Pairing,
        contour: &ClosedCurve,
        turns: f64,
        (old, angle): (f64, f64),
    ) -> Option<(f64, f64)> {
        let Pairing::Own { start, left, .. } = pairing else { return None };
        let is_end = (turns - 0.5).abs() < 0.25;
        let s = contour.wrap(if is_end { start + left } else { *start });
        let gap = nearest_lap((old - s) / contour.length()).abs() * contour.length();
        // Of an exactly symmetric drawing only a corner on the axis leaves the mesh symmetric.
        let h = self.placed.patch.lattice.edge_length;
        let reach = if is_exact(self.symmetry, h) { 1e-9 } else { CORNER_REACH };
        let on_corner = angle != 0.0 && gap <= reach * h;
        Some(if on_corner { (old, angle) } else { (s, 0.0) })
    }

    /// True where the target meets the axis.
    fn is_crossing(&self, pairing: &Pairing, turns: f64) -> bool {
        const NEAR: f64 = 0.05;
        let Pairing::Own { contour, .. } = pairing else { return false };
        let gap = nearest_lap(2.0 * turns).abs() * 0.5 * self.contours[*contour].length();
        gap < NEAR * self.placed.patch.lattice.edge_length
    }

    /// The drawn corner beside an arc length, if the partner is on one; else the arc length itself.
    fn at_corner(&self, contour: &ClosedCurve, s: f64, partner: f64, own: f64) -> (f64, f64) {
        if partner == 0.0 {
            return (s, 0.0);
        }
        let drawn = nearest_drawn(contour, s);
        let gap = nearest_lap((drawn - s) / contour.length()).abs() * contour.length();
        if gap > CORNER_REACH * self.placed.patch.lattice.edge_length {
            return (s, 0.0);
        }
        (drawn, if own != 0.0 { own } else { partner })
    }
}

/// A number of turns without whole ones, -1/2 to 1/2.
fn nearest_lap(turns: f64) -> f64 {
    turns - turns.round()
}
