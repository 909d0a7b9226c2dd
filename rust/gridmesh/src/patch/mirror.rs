//! Mirror-symmetric meshes: the lattice laid on the axis, symmetric paths, symmetric placement.
//!
//! A lattice has two kinds of mirror axes, along a direction and across one. The path of a symmetric
//! contour is found for the mean of its two sides, so that both have the same topology however
//! unlike they were drawn; the vertices then go onto each side's own line.

mod placing;
mod sides;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use glam::DVec2;

pub(crate) use self::placing::symmetrised;
use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::Symmetry;
use crate::error::{Error, Result};
use crate::options::SketchOptions;
use crate::patch::mirror::sides::{Sides, arc_at, contours_of, reflection};
use crate::path::outline::{Obstacle, Outline};
use crate::path::placement::{Lattice, ROW_HEIGHT};
use crate::path::trace::outcome::{TraceFailure, TraceOptions};
use crate::path::trace::{Part, trace_mirrored};
use crate::progress::Progress;

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
