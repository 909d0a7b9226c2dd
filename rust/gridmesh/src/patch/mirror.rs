//! Mirror-symmetric meshes: the lattice laid on the axis, symmetric paths, symmetric placement.
//!
//! A lattice has two kinds of mirror axes, along a direction and across one. The path of a symmetric
//! contour is found for the mean of its two sides, so that both have the same topology however
//! unlike they were drawn; the vertices then go onto each side's own line.

mod placing;
mod sides;

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

pub(crate) use self::placing::{Partners, symmetrised};
use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::Symmetry;
use crate::error::{Error, Result};
use crate::lattice::grid::{Square, Triangular};
use crate::lattice::reflection::Reflection;
use crate::options::{CellShape, SketchOptions};
use crate::patch::mirror::sides::{Sides, arc_at, contours_of, reflection};
use crate::path::outline::{Obstacle, Outline, of_quads};
use crate::path::placement::{Lattice, ROW_HEIGHT};
use crate::path::target::Target;
use crate::path::trace::outcome::{TraceFailure, TraceOptions};
use crate::path::trace::{Part, trace_mirrored};
use crate::progress::Progress;

/// The lattices to try: angle, and shift in edges along the lattice's own axes. With an angle given,
/// those that lie that way.
pub(crate) fn placements(symmetry: &Symmetry, angle: Option<f64>, cells: CellShape) -> Vec<(f64, DVec2)> {
    const SHIFTS: [f64; 4] = [0.0, 0.5, 0.25, 0.75];
    let direction = symmetry.axis.direction;
    let along = libm::atan2(direction.y, direction.x);
    let on_direction = SHIFTS.map(|shift| (along, DVec2::new(shift, 0.0)));
    // Rows lie across the axis: every other one has a point on it.
    let on_rows = SHIFTS.map(|shift| (along + FRAC_PI_2, DVec2::new(0.0, 2.0 * ROW_HEIGHT * shift)));
    let all = on_direction.into_iter().zip(on_rows).flat_map(|(a, b)| [a, b]);
    let fits = |(it, _): &(f64, DVec2)| angle.is_none_or(|angle| is_alike(*it, angle, cells));
    match cells {
        CellShape::Triangle => all.filter(fits).collect(),
        // Turned by 90 degrees a square lattice is the same.
        CellShape::Quad => on_direction.into_iter().filter(fits).collect(),
    }
}

/// # Errors
/// [`Error::InvalidOption`] if the lattice cannot be laid on the axis at the angle given.
pub(crate) fn check_angle(symmetry: Option<&Symmetry>, angle: Option<f64>, cells: CellShape) -> Result<()> {
    let Some((symmetry, angle)) = symmetry.zip(angle) else { return Ok(()) };
    if placements(symmetry, Some(angle), cells).is_empty() {
        let value = format!("{angle}, beside mirror");
        let allowed = match cells {
            CellShape::Triangle => "none, or the angle of the axis or 30 degrees from it, modulo 60 degrees",
            CellShape::Quad => "none, or the angle of the axis, modulo 90 degrees",
        };
        return Err(Error::InvalidOption { name: "angle", value, allowed });
    }
    Ok(())
}

/// True if two angles are those of the same lattice.
fn is_alike(a: f64, b: f64, cells: CellShape) -> bool {
    const NEAR: f64 = 1e-6;
    let between = (a - b).rem_euclid(cells.step());
    between.min(cells.step() - between) < NEAR
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
    let mut parts: Vec<Part> = symmetry.pairings.iter().map(|pairing| sides.part(pairing)).collect();
    if options.cells == CellShape::Quad {
        drawn_in(&mut parts, axis);
    }
    let wanted = TraceOptions {
        max_distance: options.max_distance,
        closeness: options.closeness,
        proof_nodes: options.proof_nodes,
    };
    let found = match options.cells {
        CellShape::Triangle => trace_mirrored::<Triangular>(&parts, axis, &wanted, progress),
        CellShape::Quad => of_quads(&wanted, progress, |wanted, progress| {
            trace_mirrored::<Square>(&parts, axis, wanted, progress)
        }),
    };
    let traced = match found {
        Ok(traced) => traced,
        Err(TraceFailure::Cancelled) => return Err(Error::Cancelled),
        Err(failure) => {
            let near = contours[0].points()[0];
            let at = failure.at().map_or(near, |at| lattice.from_units(options.cells.units(at)));
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

/// Moves the targets into the patch, where a belt is to come around it, alike on both sides.
fn drawn_in(parts: &mut [Part], axis: Reflection) {
    let targets: Vec<Target> = parts.iter().flat_map(|part| part.targets(axis)).collect();
    let mut inset = Target::inset(&targets, 1.0).into_iter();
    for part in parts {
        let (own, image) = match part {
            Part::Symmetric { .. } => (inset.next(), None),
            Part::Pair(_) => (inset.next(), inset.next()),
        };
        let (Part::Symmetric { target, .. } | Part::Pair(target)) = part;
        let Some(own) = own else { continue };
        let other = image.as_ref().unwrap_or(&own);
        let n = own.len();
        target.points = (0..n)
            .map(|i| 0.5 * (own.points[i] + Lattice::reflected(axis, other.points[(n - i) % n])))
            .collect();
    }
}
