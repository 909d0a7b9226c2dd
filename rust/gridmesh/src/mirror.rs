//! Mirror-symmetric meshes: the lattice laid on the axis, symmetric paths, symmetric placement.
//!
//! A lattice has two kinds of mirror axes, along a direction and across one. The path of a symmetric
//! contour is found for the mean of its two sides, so that both have the same topology however
//! unlike they were drawn; the vertices then go onto each side's own line.

mod placing;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use glam::DVec2;

use crate::curve::ClosedCurve;
use crate::error::{Error, Result};
use crate::lattice::{Lattice, ROW_HEIGHT};
use crate::options::SketchOptions;
use crate::outline::{Obstacle, Outline};
use crate::place::CORNER_WINDOW;
use crate::progress::Progress;
use crate::reflection::Reflection;
use crate::symmetry::{Pairing, Symmetry};
use crate::target::{SPACING, Target};
use crate::trace::{Part, TraceFailure, TraceOptions, trace_mirrored};

pub(crate) use self::placing::symmetrised;

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
            return Ok(Err(Obstacle::new(failure.to_string(), at)));
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
