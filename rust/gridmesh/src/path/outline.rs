//! The lattice path for a drawing: the boundary of its patch, before anything moves.

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::drawing::curve::ClosedCurve;
use crate::error::{Error, Result};
use crate::lattice::axial::Axial;
use crate::lattice::grid::{Grid, Square, Triangular};
use crate::options::{CellShape, SketchOptions};
use crate::path::band::Band;
use crate::path::growth::{clear_chords, grow_inside, straighten};
use crate::path::mapping::{complete, project};
use crate::path::placement::Lattice;
use crate::path::raster::Raster;
use crate::path::target::Target;
use crate::path::trace::outcome::{TraceFailure, TraceOptions, Traced};
use crate::path::trace::trace_on;
use crate::progress::Progress;

/// Narrow parts are widened to this many edges before growing; wider than two rows of triangles.
const NECK_WIDTH: f64 = 2.4;

/// How much farther than `max_distance` the patch may grow to get rid of a chord, in edges.
const CHORD_ROOM: f64 = 1.0;

/// A turn on squares makes two poles a row inside, and the belt and the rows behind it take up what the path is
/// off by: distances count so much less beside turns than on triangles, and may be so many times greater; with twice as great ones more drawings are lost in placement.
const QUAD_SHARE: f64 = 0.1;
const QUAD_DISTANCE: f64 = 4.0 / 3.0;

/// Closed lattice paths, one a contour, and where their vertices belong on the contours.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outline {
    pub(crate) paths: Vec<Vec<Axial>>,
    /// Arc length of each vertex on its contour in lattice units: strictly increasing, unwrapped.
    pub(crate) arcs: Vec<Vec<f64>>,
    /// Turns of the grown path before it was straightened.
    pub(crate) turns_before: Option<usize>,
    /// No traced path at this distance turns less often.
    pub(crate) turns_bound: Option<usize>,
    pub(crate) cost: f64,
    pub(crate) cost_bound: Option<f64>,
    pub(crate) optimal: bool,
    pub(crate) max_distance_used: f64,
}

/// Why a lattice placement gives no outline, and where (units of the drawing).
#[derive(Clone, Debug)]
pub(crate) struct Obstacle {
    pub(crate) reason: String,
    pub(crate) at: DVec2,
    /// Triangles are inverted, and relaxation was not allowed.
    pub(crate) is_inverted: bool,
}

impl Obstacle {
    pub(crate) fn new(reason: impl Into<String>, at: DVec2) -> Self {
        Self { reason: reason.into(), at, is_inverted: false }
    }
}

impl Outline {
    /// Number of cells of the patch.
    pub(crate) fn count(&self, shape: CellShape) -> usize {
        match shape {
            CellShape::Triangle => self.doubled_area(),
            // The squares inside, and one in the belt for each edge of the paths.
            CellShape::Quad => self.doubled_area() / 2 + self.paths.iter().map(Vec::len).sum::<usize>(),
        }
    }

    /// Twice the number of unit parallelograms that the paths enclose: the lattice's own shoelace formula.
    fn doubled_area(&self) -> usize {
        let doubled = |path: &Vec<Axial>| -> i64 {
            let origin = path.first().copied().unwrap_or_default();
            path.iter()
                .enumerate()
                .map(|(i, &p)| {
                    let (a, b) = (p - origin, path[(i + 1) % path.len()] - origin);
                    i64::from(a.q) * i64::from(b.r) - i64::from(b.q) * i64::from(a.r)
                })
                .sum()
        };
        self.paths.iter().map(doubled).sum::<i64>().unsigned_abs() as usize
    }

    /// Sum of absolute turns.
    pub(crate) fn turns(&self, shape: CellShape) -> usize {
        self.each_turn(shape).map(|turn| turn.unsigned_abs() as usize).sum()
    }

    /// Number of irregular vertices after stitching: boundary vertices that turn; with a belt each turn is
    /// one vertex inside on either sheet.
    pub(crate) fn irregular(&self, shape: CellShape) -> usize {
        let turning = self.each_turn(shape).filter(|&turn| turn != 0).count();
        if shape == CellShape::Quad { 2 * turning } else { turning }
    }

    fn each_turn(&self, shape: CellShape) -> impl Iterator<Item = i32> {
        let turns = move |path: &Vec<Axial>| -> Vec<i32> {
            match shape {
                CellShape::Triangle => Triangular::turns(path).collect(),
                CellShape::Quad => Square::turns(path).collect(),
            }
        };
        self.paths.iter().flat_map(turns)
    }
}

/// The boundary as the paper makes it: sections IV-A to IV-D in turn.
///
/// Different from the paper, and why:
/// * a point joins only if the boundary stays simple; two boundary neighbours do not ensure it;
/// * vertices are mapped by each one's own stretch of curve and kept in order (section IV-C leaves
///   out-of-order vertices to "arc-length parameterization");
/// * chords go by enclosing one of their ends, not "by adding a single triangle".
pub(crate) fn grown(
    curve: &ClosedCurve,
    lattice: &Lattice,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Result<Outline, Obstacle>> {
    let faired = Target::new(curve, lattice);
    let mut widened = faired.clone();
    widened.widen(NECK_WIDTH);
    let reach = options.max_distance + CHORD_ROOM;
    let band = Band::new(&faired, reach);
    let raster = Raster::new(&widened, reach.ceil() as i32 + 2);
    progress.report(0.3)?;
    let obstacle = |reason: &str, at: DVec2| Ok(Err(Obstacle::new(reason, lattice.from_units(at))));
    let Some(mut boundary) = grow_inside(&raster, progress.part(0.3, 0.6))? else {
        return obstacle("no lattice hexagon fits inside the drawing", faired.points[0]);
    };
    let known = project(&boundary.path(), &band);
    let distance = |p: Axial| band.nearest(p).map(|node| node.distance);
    let within = |p: Axial, limit: f64| distance(p).map_or(raster.is_inside(p), |d| d <= limit);
    if let Err(vertex) = clear_chords(&mut boundary, |p| within(p, reach)) {
        return obstacle("two parts of the boundary stay one edge apart", Lattice::units(vertex));
    }
    let turns_before = Some(boundary.bend().unsigned_abs() as usize);
    let admit = |p: Axial| within(p, options.max_distance);
    straighten(&mut boundary, admit, progress.part(0.6, 0.9))?;
    let path = boundary.path();
    let known: FxHashMap<Axial, f64> = path.iter().filter_map(|p| known.get(p).map(|&s| (*p, s))).collect();
    let arcs: Vec<f64> = complete(&path, &known, band.n_samples() as f64)
        .into_iter()
        .map(|parameter| parameter * faired.step)
        .collect();
    let squared: f64 = path.iter().map(|&p| distance(p).unwrap_or(reach).powi(2)).sum();
    Ok(Ok(Outline {
        cost: boundary.bend() as f64 + options.closeness * squared,
        paths: vec![path],
        arcs: vec![arcs],
        turns_before,
        max_distance_used: options.max_distance,
        ..Outline::default()
    }))
}

/// Traces paths of quads: they may stray farther than those of triangles, or as far where that leads to none.
pub(crate) fn of_quads(
    wanted: &TraceOptions,
    progress: Progress<'_>,
    trace: impl Fn(&TraceOptions, Progress<'_>) -> Result<Traced, TraceFailure>,
) -> Result<Traced, TraceFailure> {
    let closeness = QUAD_SHARE * wanted.closeness;
    let max_distance = QUAD_DISTANCE * wanted.max_distance;
    let far = TraceOptions { max_distance, closeness, ..wanted.clone() };
    match trace(&far, progress.part(0.0, 0.5)) {
        // Paths that may stray less get less into each other's way.
        Err(failure) if failure != TraceFailure::Cancelled => {
            trace(&TraceOptions { closeness, ..wanted.clone() }, progress.part(0.5, 1.0))
        }
        found => found,
    }
}

/// The boundary of least cost for this lattice: a shortest path for each contour.
pub(crate) fn traced(
    contours: &[ClosedCurve],
    lattice: &Lattice,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Result<Outline, Obstacle>> {
    let mut targets: Vec<Target> = contours.iter().map(|contour| Target::new(contour, lattice)).collect();
    if options.cells == CellShape::Quad {
        targets = Target::inset(&targets, 1.0);
    }
    let wanted = TraceOptions {
        max_distance: options.max_distance,
        closeness: options.closeness,
        proof_nodes: options.proof_nodes,
    };
    let found = match options.cells {
        CellShape::Triangle => trace_on::<Triangular>(&targets, &wanted, progress),
        CellShape::Quad => {
            of_quads(&wanted, progress, |wanted, progress| trace_on::<Square>(&targets, wanted, progress))
        }
    };
    let traced = match found {
        Ok(traced) => traced,
        Err(TraceFailure::Cancelled) => return Err(Error::Cancelled),
        Err(failure) => {
            let at = failure.at().map_or(targets[0].points[0], |at| options.cells.units(at));
            return Ok(Err(Obstacle::new(failure.to_string(), lattice.from_units(at))));
        }
    };
    let arcs = traced
        .paths
        .iter()
        .zip(&targets)
        .map(|(path, target)| path.parameters.iter().map(|parameter| parameter * target.step).collect());
    Ok(Ok(Outline {
        arcs: arcs.collect(),
        turns_before: None,
        cost: traced.cost,
        cost_bound: Some(traced.cost_bound),
        optimal: traced.optimal,
        max_distance_used: traced.max_distance_used,
        turns_bound: Some(traced.turns_bound),
        paths: traced.paths.into_iter().map(|path| path.points).collect(),
    }))
}
