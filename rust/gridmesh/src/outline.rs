//! The lattice path for a drawing: the boundary of its patch, before anything moves.

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::axial::Axial;
use crate::band::Band;
use crate::curve::ClosedCurve;
use crate::error::{Error, Result};
use crate::growth::{clear_chords, grow_inside, straighten};
use crate::lattice::Lattice;
use crate::mapping::{complete, project};
use crate::options::SketchOptions;
use crate::progress::Progress;
use crate::raster::Raster;
use crate::target::Target;
use crate::trace::{TraceFailure, TraceOptions, trace};

/// Narrow parts are widened to this many edges before growing; wider than two rows of triangles.
const NECK_WIDTH: f64 = 2.4;

/// How much farther than `max_distance` the patch may grow to get rid of a chord, in edges.
const CHORD_ROOM: f64 = 1.0;

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
    /// Number of triangles that the paths enclose: the lattice's own shoelace formula.
    pub(crate) fn triangles(&self) -> usize {
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
    pub(crate) fn turns(&self) -> usize {
        self.paths.iter().map(|path| turns(path).map(|t| t.unsigned_abs() as usize).sum::<usize>()).sum()
    }

    /// Number of boundary vertices that turn: irregular after stitching.
    pub(crate) fn irregular(&self) -> usize {
        self.paths.iter().map(|path| turns(path).filter(|&t| t != 0).count()).sum()
    }
}

/// The turn at each vertex of a closed lattice path.
fn turns(path: &[Axial]) -> impl Iterator<Item = i32> {
    let n = path.len();
    (0..n).map(move |i| {
        let enter = path[(i + n - 1) % n].step_to(path[i]);
        let leave = path[i].step_to(path[(i + 1) % n]);
        enter.zip(leave).map_or(0, |(enter, leave)| enter.turn_to(leave))
    })
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

/// The boundary of least cost for this lattice: a shortest path for each contour.
pub(crate) fn traced(
    contours: &[ClosedCurve],
    lattice: &Lattice,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Result<Outline, Obstacle>> {
    let targets: Vec<Target> = contours.iter().map(|contour| Target::new(contour, lattice)).collect();
    let wanted = TraceOptions {
        max_distance: options.max_distance,
        closeness: options.closeness,
        proof_nodes: options.proof_nodes,
    };
    let traced = match trace(&targets, &wanted, progress) {
        Ok(traced) => traced,
        Err(TraceFailure::Cancelled) => return Err(Error::Cancelled),
        Err(failure) => {
            let at = failure.at().map_or(targets[0].points[0], Lattice::units);
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
