//! From a lattice outline to a patch: vertices on the drawn curve, the interior relaxed, checked.

use glam::DVec2;

use crate::assemble::assemble;
use crate::curve::ClosedCurve;
use crate::error::Result;
use crate::lattice::Lattice;
use crate::mapping::{Corner, corners, snap};
use crate::options::SketchOptions;
use crate::outline::{Obstacle, Outline};
use crate::patch::{Loop, Patch};
use crate::progress::Progress;
use crate::relax::{Contour, RelaxOptions, Rim, first_inverted, relax};
use crate::segments::{SegmentGrid, nearest_on_segment};

/// Half the length over which a corner's turning angle is measured, in edges.
const CORNER_WINDOW: f64 = 0.5;

/// A patch and what placing it cost.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) patch: Patch,
    pub(crate) corners: usize,
    pub(crate) released_corners: usize,
}

/// Puts the boundary on the contours, snaps corners, relaxes the interior and proves that no
/// triangle is inverted, also after rounding to `f32` at the lattice origin.
pub(crate) fn place(
    contours: &[ClosedCurve],
    lattice: &Lattice,
    mut outline: Outline,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Result<Placed, Obstacle>> {
    let region = assemble(&outline.paths);
    let mut positions: Vec<DVec2> = region.points.iter().map(|&p| Lattice::units(p)).collect();
    let h = lattice.edge_length;
    let mut n_corners = 0;
    let mut angles: Vec<Vec<f64>> = Vec::new();
    for (contour, arcs) in contours.iter().zip(&mut outline.arcs) {
        let found = corners_of(contour, options.corner_angle, h);
        n_corners += found.len();
        angles.push(snap(arcs, &found, contour.length() / h, 1.0));
    }
    let drawn: Vec<(Vec<DVec2>, Vec<f64>)> = contours
        .iter()
        .map(|contour| {
            let points = contour.points().iter().map(|&p| lattice.to_units(p)).collect();
            (points, contour.arc().iter().map(|&s| s / h).collect())
        })
        .collect();
    let lines: Vec<Contour<'_>> = drawn.iter().map(|(points, arc)| Contour { points, arc }).collect();
    let mut start = 0;
    let mut rims: Vec<Rim> = Vec::new();
    for (arcs, angle) in outline.arcs.into_iter().zip(&angles) {
        let pinned = angle.iter().map(|&a| a != 0.0).collect();
        let n = arcs.len();
        rims.push(Rim { start, s: arcs, pinned });
        start += n;
    }
    if options.relax {
        relax(&region.triangles, &mut positions, &lines, &mut rims, &RelaxOptions::default(), progress)?;
    }
    let mut vertices: Vec<DVec2> = positions.iter().map(|&p| lattice.from_units(p)).collect();
    let mut loops = Vec::new();
    for ((contour, rim), angle) in contours.iter().zip(&rims).zip(&angles) {
        let mut placed = Loop { start: rim.start as u32, length: contour.length(), ..Loop::default() };
        for (i, &s) in rim.s.iter().enumerate() {
            let on_corner = rim.pinned[i];
            let s = if on_corner { nearest_drawn(contour, s * h) } else { contour.wrap(s * h) };
            vertices[rim.start + i] = contour.point_at(s);
            placed.arc.push(contour.input_arc(s));
            placed.source.push(contour.source(s));
            placed.corner.push(if on_corner { angle[i] } else { 0.0 });
        }
        loops.push(placed);
    }
    if options.relax
        && let Some(triangle) = first_inverted(&vertices, &region.triangles, lattice.origin)
    {
        let at = vertices[region.triangles[triangle][0] as usize];
        return Ok(Err(Obstacle { reason: "a triangle stays inverted", at }));
    }
    let pinned = rims.iter().flat_map(|rim| &rim.pinned).filter(|&&pinned| pinned).count();
    let patch = Patch { vertices, triangles: region.triangles, loops, lattice: *lattice };
    Ok(Ok(Placed { patch, corners: n_corners, released_corners: n_corners - pinned }))
}

/// The corners of a contour, with arc lengths in edges.
fn corners_of(contour: &ClosedCurve, angle: f64, h: f64) -> Vec<Corner> {
    let arcs: Vec<f64> = contour.arc().iter().map(|&s| s / h).collect();
    let turning = contour.turning(CORNER_WINDOW * h);
    corners(&arcs[..turning.len()], &turning, contour.length() / h, angle, 1.0)
}

/// Arc length of the drawn point nearest to arc length `s`, along the curve.
fn nearest_drawn(contour: &ClosedCurve, s: f64) -> f64 {
    let (segment, t) = contour.locate(s);
    contour.arc()[if t < 0.5 { segment } else { segment + 1 }]
}

/// Smallest angle of any triangle, in radians.
pub(crate) fn min_angle(patch: &Patch) -> f64 {
    let mut least = f64::INFINITY;
    for t in &patch.triangles {
        let p = t.map(|v| patch.vertices[v as usize]);
        for i in 0..3 {
            let (a, b) = (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
            least = least.min(a.perp_dot(b).atan2(a.dot(b)));
        }
    }
    least
}

/// The greatest distance from the drawn points to the mesh boundary, and where.
///
/// Each point is measured against the boundary edge beside it, which bounds the distance of all
/// the curve between its points; only where that exceeds `limit`, against all edges nearby.
pub(crate) fn deviation(contours: &[ClosedCurve], patch: &Patch, limit: f64) -> (f64, DVec2) {
    let mut worst = (0.0f64, contours[0].points()[0]);
    let mut far: Vec<DVec2> = Vec::new();
    for (contour, rim) in contours.iter().zip(&patch.loops) {
        let n = rim.len();
        let vertices = &patch.vertices[rim.start as usize..rim.start as usize + n];
        let first = contour.input_arc(0.0);
        let start = (0..n).min_by(|&i, &j| rim.arc[i].total_cmp(&rim.arc[j])).unwrap_or(0);
        let sorted: Vec<f64> = (0..n).map(|i| rim.arc[(start + i) % n]).collect();
        for (&point, &s) in contour.points().iter().zip(contour.arc()) {
            let before = sorted.partition_point(|&a| a <= (s + first) % contour.length());
            let i = (start + before + n - 1) % n;
            let squared = nearest_on_segment(point, vertices[i], vertices[(i + 1) % n]).1;
            if squared > limit * limit {
                far.push(point);
            } else if squared > worst.0 * worst.0 {
                worst = (squared.sqrt(), point);
            }
        }
    }
    if far.is_empty() {
        return worst;
    }
    let edges: Vec<[DVec2; 2]> = patch
        .loops
        .iter()
        .flat_map(|rim| (0..rim.len()).map(move |i| [i, (i + 1) % rim.len()].map(|k| rim.start as usize + k)))
        .map(|edge| edge.map(|v| patch.vertices[v]))
        .collect();
    let grid = SegmentGrid::new(&edges);
    for point in far {
        let mut squared = f64::INFINITY;
        grid.near(point - limit, point + limit, |i| {
            squared = squared.min(nearest_on_segment(point, edges[i][0], edges[i][1]).1);
        });
        if squared > limit * limit {
            squared =
                edges.iter().map(|e| nearest_on_segment(point, e[0], e[1]).1).fold(f64::INFINITY, f64::min);
        }
        if squared > worst.0 * worst.0 {
            worst = (squared.sqrt(), point);
        }
    }
    worst
}
