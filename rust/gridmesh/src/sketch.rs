//! From a drawn outline to a flat patch: the whole of the paper's section IV.

pub(crate) mod again;
mod bent;
mod found;
mod job;
mod kept;
mod lattices;
mod least;
mod size;

use std::time::Instant;

use glam::DVec2;

use crate::drawing::contours::read_contours;
use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::Symmetry;
use crate::drawing::thickness;
use crate::drawing::thickness::Limb;
use crate::drawing::union::{nearest_sources, outer_outline};
use crate::error::{Error, Needed, Result, told};
use crate::options::{
    BoundaryMethod, CellShape, DEFAULT_QUADS, DEFAULT_TRIANGLES, Density, LEAST_CHOSEN, MAX_TRIANGLES,
    SelfCrossing, SketchOptions,
};
use crate::patch::{Patch, mirror};
use crate::path::outline::Obstacle;
use crate::progress::{Progress, Rising};
pub use crate::sketch::job::Sketch;
use crate::sketch::job::{Asked, Job};
pub use crate::sketch::kept::Kept;

/// Meshes the inside of a closed planar drawing.
///
/// `outline` is closed implicitly, in either direction, in any units; it is not modified. `holes`
/// lie inside it. For every patch returned: each boundary vertex lies on its cleaned contour; no
/// interior edge joins two boundary vertices; interior vertices have valence six; no triangle is
/// inverted (exact predicate), also after rounding to `f32` at `patch.lattice.origin`. The same
/// drawing gives the same patch, bit for bit, whichever point it starts at and in whichever
/// direction it runs. Time is linear in the number of triangles and points for ordinary drawings.
///
/// # Errors
/// [`Error::TooCoarse`] if no valid patch of about the size asked for was found, with a number of triangles that works, the
/// least one where that is found in time, unless [`SketchOptions::least`] is off, the search takes too long, or
/// none works up to 40 times the number asked for or that the length of the outline alone asks for, nor up to 20,000;
/// [`Error::NoPatch`] if there is none at any size up to [`MAX_TRIANGLES`]; [`Error::Inverted`] without
/// relaxation; and the errors of [`ClosedCurve::new`] and [`SketchOptions::check`].
///
/// Source: Nealen et al., GridMesh, 2009, section IV.
pub fn mesh_sketch(
    outline: &[DVec2],
    holes: &[Vec<DVec2>],
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Sketch> {
    mesh(outline, holes, options, None, progress)
}

/// The same on the lattice of an earlier patch, which stays where it is, with its bend: for drawings that change
/// step by step. No other lattice is tried but the straight one of its angle, where the drawing has left the
/// bent one.
///
/// # Errors
/// Those of [`mesh_sketch`]; [`Error::InvalidOption`] if the options give an edge length, a number, an angle, an
/// origin or a mirror.
pub fn mesh_sketch_on(
    kept: &Kept,
    outline: &[DVec2],
    holes: &[Vec<DVec2>],
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Sketch> {
    let options = kept.options(options)?;
    mesh(outline, holes, &options, Some(kept), progress)
}

fn mesh(
    outline: &[DVec2],
    holes: &[Vec<DVec2>],
    options: &SketchOptions,
    keep: Option<&Kept>,
    progress: Progress<'_>,
) -> Result<Sketch> {
    options.check()?;
    progress.report(0.0)?;
    // Angles are solved side by side, and failed placements start again: only what rises is passed on.
    let rising = Rising::new(progress);
    let callback = |fraction: f64| rising.report(fraction);
    let progress = Progress::new(&callback);
    let started = Instant::now();
    check_density(options, outline, holes)?;
    let union = match options.self_crossing {
        SelfCrossing::Error => None,
        SelfCrossing::Union => Some(outer_outline(outline, "outline")?),
    };
    if options.boundary == BoundaryMethod::Grown && !holes.is_empty() {
        return Err(Error::InvalidOption {
            name: "boundary",
            value: "grown, with holes".to_owned(),
            allowed: "optimal, if there are holes",
        });
    }
    let contours = read_contours(union.as_ref().map_or(outline, |(points, _)| points), holes)?;
    let area = contours[0].area() - contours[1..].iter().map(ClosedCurve::area).sum::<f64>();
    let mut thinnest = None;
    let triangles = if options.automatic {
        thinnest = thickness::limbs_of(&contours)?.first().copied();
        chosen_number(area, thinnest, options)
    } else {
        options.triangles.unwrap_or(match options.cells {
            CellShape::Triangle => DEFAULT_TRIANGLES,
            CellShape::Quad => DEFAULT_QUADS,
        })
    };
    let edge_length = match options.edge_length {
        Some(h) => h,
        None => (area / (triangles as f64 * options.cells.area())).sqrt(),
    };
    let expected = area / (options.cells.area() * edge_length * edge_length);
    if expected.is_nan() || expected > MAX_TRIANGLES {
        return Err(Error::TooLarge { triangles: expected, limit: MAX_TRIANGLES });
    }
    check_origin(options, &contours[0], edge_length)?;
    let find = |mirror| Symmetry::find(&contours, mirror, edge_length);
    let symmetry = options.mirror.map(find).transpose()?;
    mirror::check_angle(symmetry.as_ref(), options.angle, options.cells)?;
    let mut job =
        Job { proves: options.proof_nodes > 0, keep, thinnest, ..Job::new(contours, symmetry, options) };
    job.lap("curve", started);
    let asked = match options.edge_length {
        Some(h) => Asked::EdgeLength(h),
        None => Asked::Cells(triangles),
    };
    let mut sketch = attempted(&mut job, asked, expected, progress)?;
    if let Some((_, slivers)) = union {
        // The sources so far lead to the outer outline.
        sketch.patch.both(|Patch { vertices, loops, .. }| {
            loops[0].source = nearest_sources(outline, &vertices[..loops[0].source.len()]);
            Ok(())
        })?;
        sketch.report.repaired += slivers;
    }
    progress.report(1.0)?;
    Ok(sketch)
}

/// The sketch of a job; where its number was chosen and is too small, with the least that works. `expected` cells.
fn attempted(job: &mut Job<'_>, asked: Asked, expected: f64, progress: Progress<'_>) -> Result<Sketch> {
    let options = job.options;
    let mut attempt = job.attempt_unless_hopeless(asked, expected, progress)?;
    if attempt.is_err() && job.proves {
        // The cheapest boundary may be one that no patch can be placed in.
        job.proves = false;
        attempt = job.attempt_unless_hopeless(asked, expected, progress)?;
    }
    if let (true, Err(obstacle)) = (options.automatic, &attempt)
        && !obstacle.is_inverted
    {
        // A number that was chosen gives way to one that works.
        match job.least_that_works(expected, obstacle.clone(), progress)? {
            Error::TooCoarse { needed: Needed::Least(least), .. } if least <= options.max_triangles => {
                attempt = job.attempt_unless_hopeless(Asked::Cells(least), least as f64, progress)?;
            }
            refused => return Err(refused),
        }
    }
    match attempt {
        Ok(sketch) => Ok(sketch),
        Err(Obstacle { at, is_inverted: true, .. }) => Err(Error::Inverted { at: at.to_array() }),
        Err(_) if !options.least => {
            let triangles = expected.round().max(1.0) as usize;
            Err(Error::TooCoarse { triangles, cells: options.cells.plural(), needed: Needed::Unknown })
        }
        Err(obstacle) => Err(job.least_that_works(expected, obstacle, progress)?),
    }
}

/// The number of cells where it is left to the drawing.
fn chosen_number(area: f64, thinnest: Option<Limb>, options: &SketchOptions) -> usize {
    let wanted = |limb: Limb| thickness::cells_for(area, limb.width, thickness::ACROSS, options.cells);
    let wanted = thinnest.map_or(0, |limb| wanted(limb).min(MAX_TRIANGLES).ceil() as usize);
    let least = match options.cells {
        CellShape::Triangle => LEAST_CHOSEN,
        CellShape::Quad => LEAST_CHOSEN / 2,
    };
    wanted.max(least).min(options.max_triangles)
}

/// Lattice coordinates are whole numbers: a lattice may be laid from a point this many edges away.
const FARTHEST_ORIGIN: f64 = 1e6;

fn check_origin(options: &SketchOptions, outline: &ClosedCurve, edge_length: f64) -> Result<()> {
    let far = |origin: &DVec2| origin.distance(outline.points()[0]) > FARTHEST_ORIGIN * edge_length;
    let Some(origin) = options.origin.filter(far) else {
        return Ok(());
    };
    let value = format!("{}, {}", told(origin.x), told(origin.y));
    let allowed = "a point within a million edge lengths of the outline, or none";
    Err(Error::InvalidOption { name: "origin", value, allowed })
}

/// # Errors
/// [`Error::InvalidOption`] if there is not one number for each point.
fn check_density(options: &SketchOptions, outline: &[DVec2], holes: &[Vec<DVec2>]) -> Result<()> {
    let Some(Density::PerPoint(given)) = &options.density else { return Ok(()) };
    let points = std::iter::once(outline.len()).chain(holes.iter().map(Vec::len));
    let fits = given.len() <= 1 + holes.len()
        && given.iter().zip(points).all(|(given, points)| given.is_empty() || given.len() == points);
    if fits {
        return Ok(());
    }
    let numbers: Vec<String> = given.iter().map(|given| given.len().to_string()).collect();
    let value = format!("{} numbers", numbers.join(" + "));
    let allowed = "one number for each point of the outline, and of each hole that has any";
    Err(Error::InvalidOption { name: "density", value, allowed })
}
