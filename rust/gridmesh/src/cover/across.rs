//! Boundary vertices moved until the boundary lies across the contours: as much of its edges outside as inside.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::cover::boundary::Boundary;
use crate::cover::outside::{Followers, loop_of};
use crate::cover::short::Lengths;
use crate::error::Result;
use crate::geometry::lengthen::THIN;
use crate::patch::Patch;
use crate::progress::Progress;

/// Rounds over the boundary.
const ROUNDS: usize = 6;

/// The longest move of the first round, in edge lengths, and what those of each further round are of those before.
const FIRST: f64 = 0.12;
const LATER: f64 = 0.8;

/// Moves tried: parts of the longest, and directions.
const PARTS: [f64; 2] = [1.0, 0.4];
const DIRECTIONS: usize = 8;

/// What the area between boundary and contours near a vertex must become less by to move it.
const BETTER: f64 = 0.995;

/// Vertices to each side whose moves may change what is best for one.
const BESIDE: usize = 3;

/// Moves boundary vertices so that less area lies between the boundary and the contours, where no face becomes thin, no edge short
/// and no edges meet by that.
pub(super) fn settled(
    patch: &mut Patch,
    fine: &[Vec<DVec2>],
    followers: &[Followers],
    progress: Progress<'_>,
) -> Result<()> {
    let lengths = Lengths::new(patch);
    let mut boundary = Boundary::new(patch);
    for (k, (contour, follow)) in fine.iter().zip(followers).enumerate() {
        let (start, n) = (patch.loops[k].start as usize, patch.loops[k].len());
        let weights = weights(contour);
        let mut moved = vec![true; n];
        for round in 0..ROUNDS {
            let reach = FIRST * LATER.powi(round as i32) * patch.lattice.edge_length;
            let before = std::mem::replace(&mut moved, vec![false; n]);
            for i in 0..n {
                if i.is_multiple_of(1 << 10) {
                    progress.report(0.0)?;
                }
                let around = || (i + n - BESIDE.min(n)..=i + n + BESIDE).map(|j| j % n);
                if !around().any(|j| before[j] || moved[j]) {
                    continue;
                }
                let near: Vec<usize> = follow.points_near(i).collect();
                let between = |patch: &Patch| {
                    let loop_ = loop_of(patch, k);
                    near.iter()
                        .map(|&at| weights[at] * follow.beyond(loop_, at, contour[at]).abs())
                        .sum::<f64>()
                };
                let (vertex, here) = (start + i, patch.vertices[start + i]);
                let thin = lengths.sharpest(patch, vertex).max(THIN[0]);
                let lacked = lengths.lacking(patch, vertex);
                let mut best = (BETTER * between(patch), here);
                for (part, turn) in
                    PARTS.into_iter().flat_map(|part| (0..DIRECTIONS).map(move |turn| (part, turn)))
                {
                    let way = DVec2::from_angle(TAU * turn as f64 / DIRECTIONS as f64);
                    patch.vertices[vertex] = here + part * reach * way;
                    let then = between(patch);
                    if then < best.0
                        && lengths.sharpest(patch, vertex) <= thin
                        && lengths.lacking(patch, vertex) <= lacked
                        && boundary.stays_simple(patch, vertex)
                    {
                        best = (then, patch.vertices[vertex]);
                    }
                }
                patch.vertices[vertex] = best.1;
                if best.1 != here {
                    moved[i] = true;
                    boundary.moved(patch, vertex, here);
                }
            }
        }
    }
    Ok(())
}

/// The area between the boundary and the contours.
pub(super) fn between(patch: &Patch, fine: &[Vec<DVec2>], followers: &[Followers]) -> f64 {
    let of = |k: usize| -> f64 {
        let (contour, follow, loop_) = (&fine[k], &followers[k], loop_of(patch, k));
        let n = contour.len();
        let strip = |at: usize| {
            let edge = follow.edge(at)?;
            let along = (loop_[(edge + 1) % loop_.len()] - loop_[edge]).normalize_or_zero();
            // Walls of an inlet that an edge passes over go back and forth, but not along it.
            let width = 0.5 * (contour[(at + 1) % n] - contour[(at + n - 1) % n]).dot(along);
            Some(width * follow.beyond(loop_, at, contour[at]).abs())
        };
        (0..n).filter_map(strip).sum::<f64>().max(0.0)
    };
    (0..fine.len()).map(of).sum()
}

/// The length of a contour that each of its points stands for.
fn weights(contour: &[DVec2]) -> Vec<f64> {
    let n = contour.len();
    let length = |k: usize| contour[k % n].distance(contour[(k + 1) % n]);
    (0..n).map(|k| 0.5 * (length(k) + length(k + n - 1))).collect()
}
