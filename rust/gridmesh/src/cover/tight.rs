//! Boundary vertices pulled back into inlets and corners that a wider outline, or the lattice, has left empty.

use glam::DVec2;

use crate::cover::ENOUGH;
use crate::cover::boundary::Boundary;
use crate::cover::outside::{Followers, loop_of};
use crate::cover::short::Lengths;
use crate::error::Result;
use crate::geometry::lengthen::THIN;
use crate::patch::Patch;
use crate::progress::Progress;

/// How far the drawing is inside, in edge lengths, for which a vertex is moved.
const WORTH: f64 = 0.1;

/// Rounds over the boundary: a vertex gives room to the next one.
const ROUNDS: usize = 2;

/// Places on the contour that are tried for a vertex, and parts of the way to each.
const PLACES: usize = 8;
const PARTS: [f64; 2] = [1.0, 0.5];

/// What the squares of the depths must become less by to move a vertex.
const BETTER: f64 = 0.95;

/// Moves boundary vertices back towards the contours, as far as no more of these comes to lie outside, no face becomes thin, no
/// edge short and no edges meet by that.
pub(super) fn pulled(
    patch: &mut Patch,
    fine: &[Vec<DVec2>],
    followers: &[Followers],
    slack: f64,
    progress: Progress<'_>,
) -> Result<()> {
    let lengths = Lengths::new(patch);
    let mut boundary = Boundary::new(patch);
    let (worth, enough) = (WORTH * patch.lattice.edge_length, ENOUGH * patch.lattice.edge_length);
    for (k, (contour, follow)) in fine.iter().zip(followers).enumerate() {
        let (start, n) = (patch.loops[k].start as usize, patch.loops[k].len());
        for i in (0..ROUNDS).flat_map(|_| 0..n) {
            if i.is_multiple_of(1 << 10) {
                progress.report(0.0)?;
            }
            let near: Vec<usize> = follow.points_near(i).collect();
            let fit = |patch: &Patch| Fit::new(loop_of(patch, k), contour, follow, &near);
            let now = fit(patch);
            if now.deepest <= worth {
                continue;
            }
            let (vertex, before) = (start + i, patch.vertices[start + i]);
            let (thin, lacked) =
                (lengths.sharpest(patch, vertex).max(THIN[0]), lengths.lacking(patch, vertex));
            let most = (now.farthest - slack).max(enough);
            let mut best = (BETTER * now.squares, before);
            for at in near.iter().step_by(near.len().div_ceil(PLACES)) {
                for part in PARTS {
                    patch.vertices[vertex] = before.lerp(contour[*at], part);
                    let then = fit(patch);
                    if then.squares < best.0
                        && then.farthest - slack <= most
                        && lengths.sharpest(patch, vertex) <= thin
                        && lengths.lacking(patch, vertex) <= lacked
                        && boundary.stays_simple(patch, vertex)
                    {
                        best = (then.squares, patch.vertices[vertex]);
                    }
                }
            }
            patch.vertices[vertex] = best.1;
            boundary.moved(patch, vertex, before);
        }
    }
    Ok(())
}

/// How a loop lies to some points of its contour.
struct Fit {
    /// Sum of the squares of the depths.
    squares: f64,
    deepest: f64,
    /// The largest distance of a point outside.
    farthest: f64,
}

impl Fit {
    fn new(loop_: &[DVec2], contour: &[DVec2], follow: &Followers, near: &[usize]) -> Self {
        let mut fit = Self { squares: 0.0, deepest: 0.0, farthest: 0.0 };
        for &at in near {
            let beyond = follow.beyond(loop_, at, contour[at]);
            let depth = (-beyond).max(0.0);
            fit.squares += depth * depth;
            fit.deepest = fit.deepest.max(depth);
            fit.farthest = fit.farthest.max(beyond);
        }
        fit
    }
}
