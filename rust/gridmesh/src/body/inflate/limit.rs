//! A rim whose limit under subdivision lies on the drawing.
//!
//! Subdivided by the rules of Catmull and Clark a body draws in its rim, the more the flatter it is there and
//! the more the rim turns. Where each vertex comes to lie in the limit is a fixed sum of it and those around it; as
//! front and back lie on each other in the drawing's plane, that is a linear system for the rim alone.

use glam::DVec2;

use crate::body::stitch::projects_well;
use crate::body::surface::contours;
use crate::geometry::embed::crossing_edges;
use crate::patch::Patch;

/// Rounds of the iteration: each leaves half of what is missing at most.
const ROUNDS: usize = 50;

/// So often the way of vertices is halved at which the mesh would overlap itself in projection; then they stay.
const HALVINGS: usize = 6;

/// No vertex is moved farther than the rim's edges at it are long, in means: in coarse tips the limit is far off, and quads
/// of the plain body would get long corners.
const FARTHEST: f64 = 1.0;

/// So often the limit is found anew for the others after some have to stay nearer.
const ATTEMPTS: usize = 4;

/// Moves the rim of a body of quads in the plane to where its limit is the rim at `positions`, as far as the mesh stays one
/// in projection. `is_creased`: see [`rim_for_limit`]. Near-linear.
pub(super) fn fit_rim(patch: &Patch, positions: &mut [DVec2], is_creased: bool) {
    let drawn = positions.to_vec();
    let (low, high) = drawn
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    // Far above what rounding to f32 can turn over.
    let least_area = 4.0 * f64::from(f32::EPSILON) * (high - low).max_element() * patch.lattice.edge_length;
    // Vertices that cannot go where their limit would be right.
    let mut held = vec![false; patch.n_boundary()];
    for _ in 0..ATTEMPTS {
        rim_for_limit(patch, &drawn, positions, &held, is_creased);
        if !take_back(patch, &drawn, positions, &mut held, least_area) {
            break;
        }
    }
    if !projects_well(patch, positions) {
        positions.copy_from_slice(&drawn);
    }
}

/// Takes rim vertices back toward the drawing until no triangle is turned over and no edges of the rim cross, and holds those;
/// true if there are any.
fn take_back(
    patch: &Patch,
    drawn: &[DVec2],
    positions: &mut [DVec2],
    held: &mut [bool],
    least_area: f64,
) -> bool {
    let n = patch.n_boundary();
    let corners = patch.corners();
    let loops = contours(patch);
    for round in 1..=HALVINGS {
        let is_turned = |t: &&[u32; 3]| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            (b - a).perp_dot(c - a) < least_area
        };
        let mut bad: Vec<u32> = corners.iter().filter(is_turned).flatten().copied().collect();
        bad.extend(crossing_edges(positions, &loops).iter().flat_map(|&v| [v, next_of(patch, v)]));
        bad.retain(|&v| (v as usize) < n);
        if bad.is_empty() {
            return round > 1;
        }
        bad.sort_unstable();
        bad.dedup();
        for v in bad.into_iter().map(|v| v as usize) {
            held[v] = true;
            positions[v] = if round < HALVINGS { 0.5 * (positions[v] + drawn[v]) } else { drawn[v] };
        }
    }
    true
}

/// The vertex of the rim after one.
fn next_of(patch: &Patch, v: u32) -> u32 {
    let within = |contour: &&crate::patch::Loop| contour.vertices().contains(&v);
    patch
        .loops
        .iter()
        .find(within)
        .map_or(v, |contour| contour.start + (v + 1 - contour.start) % contour.len() as u32)
}

/// Moves the rim of a body of quads in the plane to where in the limit its vertices are where they are `drawn`, but no vertex
/// that is `held`. Corners of the drawing stay: they are to be creased. So is the whole rim if `is_creased`: then
/// the limit of the rim depends on the rim alone. Linear.
fn rim_for_limit(patch: &Patch, drawn: &[DVec2], positions: &mut [DVec2], held: &[bool], is_creased: bool) {
    let n = patch.n_boundary();
    // Quads at each vertex, and the weighted sum of the inner vertices beside and across from it.
    let mut counts = vec![0.0; n];
    let mut inner = vec![DVec2::ZERO; n];
    // Vertices of the rim, those of the rim beside or across from them, and what these weigh.
    let mut on_rim: Vec<(usize, usize, f64)> = Vec::new();
    for quad in &patch.quads {
        for k in 0..4 {
            let v = quad[k] as usize;
            if v >= n {
                continue;
            }
            counts[v] += 1.0;
            for (step, weight) in [(1, 4.0), (2, 2.0), (3, 4.0)] {
                let w = quad[(k + step) % 4] as usize;
                if w < n { on_rim.push((v, w, weight)) } else { inner[v] += weight * positions[w] }
            }
        }
    }
    let mut is_fixed = held.to_vec();
    let mut farthest = vec![0.0; n];
    if is_creased {
        on_rim.clear();
    }
    for contour in &patch.loops {
        let (start, len) = (contour.start as usize, contour.len());
        for k in 0..len {
            let [before, here, after] = [k + len - 1, k, k + 1].map(|i| drawn[start + i % len]);
            farthest[start + k] = FARTHEST * 0.5 * (here.distance(before) + here.distance(after));
            is_fixed[start + k] |= contour.corner[k] != 0.0;
            if is_creased {
                on_rim.push((start + k, start + (k + 1) % len, 1.0));
                on_rim.push((start + k, start + (k + len - 1) % len, 1.0));
            }
        }
    }
    for _ in 0..ROUNDS {
        let mut sums = if is_creased { vec![DVec2::ZERO; n] } else { inner.clone() };
        for &(v, w, weight) in &on_rim {
            sums[v] += weight * positions[w];
        }
        for v in (0..n).filter(|&v| !is_fixed[v]) {
            // A body has as many quads again at the back.
            let valence = 2.0 * counts[v];
            let (own, all) =
                if is_creased { (4.0, 6.0) } else { (valence * valence, valence * (valence + 5.0)) };
            let to = (all * drawn[v] - sums[v]) / own;
            positions[v] = drawn[v] + (to - drawn[v]).clamp_length_max(farthest[v]);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::error::Result;
    use crate::options::SketchOptions;
    use crate::progress::Progress;

    /// The limit of each rim vertex by the rules of Catmull and Clark, for a closed body.
    fn limits(quads: &[[u32; 4]], at: &[glam::DVec3]) -> Vec<glam::DVec3> {
        let mut around = vec![(0.0, glam::DVec3::ZERO, glam::DVec3::ZERO); at.len()];
        for quad in quads {
            for k in 0..4 {
                let entry = &mut around[quad[k] as usize];
                entry.0 += 1.0;
                // Each edge is met twice.
                entry.1 += 0.5 * (at[quad[(k + 1) % 4] as usize] + at[quad[(k + 3) % 4] as usize]);
                entry.2 += at[quad[(k + 2) % 4] as usize];
            }
        }
        let limit = |(p, (n, edges, faces)): (&glam::DVec3, (f64, glam::DVec3, glam::DVec3))| {
            (n * n * *p + 4.0 * edges + faces) / (n * (n + 5.0))
        };
        at.iter().zip(around).map(limit).collect()
    }

    #[test]
    fn the_limit_of_the_rim_is_the_drawing() -> Result<()> {
        let outline: Vec<DVec2> = (0..240)
            .map(|i| {
                let t = TAU * f64::from(i) / 240.0;
                (1.0 + 0.25 * libm::cos(3.0 * t)) * DVec2::from_angle(t)
            })
            .collect();
        let options = SketchOptions { triangles: Some(400), ..SketchOptions::quads() };
        let sketch = crate::sketch::mesh_sketch(&outline, &[], &options, Progress::NONE)?;
        let options = super::super::InflateOptions { subdivided: true, ..Default::default() };
        let body = super::super::inflate(&sketch.patch, &options, Progress::NONE)?;
        assert!(body.report.watertight && body.report.embedded);
        let limits = limits(&body.quads, &body.vertices);
        let edge = sketch.patch.lattice.edge_length;
        let off = |k: usize| limits[k].truncate().distance(sketch.patch.vertices[k]) / edge;
        let mut off: Vec<f64> = (0..sketch.patch.n_boundary()).map(off).collect();
        off.sort_by(f64::total_cmp);
        // But for the few that the mesh has no room for.
        assert!(off[off.len() / 2] < 1e-9 && off[off.len() - 1] < 0.05, "{off:?}");
        Ok(())
    }
}
