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
            let fit = Fit { contour, follow, near: &near, vertex: i };
            let now = fit.depths(loop_of(patch, k));
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
                    if let Some(squares) = fit.squares(loop_of(patch, k), best.0, slack + most)
                        && lengths.sharpest(patch, vertex) <= thin
                        && lengths.lacking(patch, vertex) <= lacked
                        && boundary.stays_simple(patch, vertex)
                    {
                        best = (squares, patch.vertices[vertex]);
                    }
                }
            }
            patch.vertices[vertex] = best.1;
            boundary.moved(patch, vertex, before);
        }
    }
    Ok(())
}

/// The points of a contour near a vertex of its loop.
struct Fit<'a> {
    contour: &'a [DVec2],
    follow: &'a Followers,
    near: &'a [usize],
    vertex: usize,
}

/// How a loop lies to some points of its contour.
struct Depths {
    /// Sum of the squares of the depths.
    squares: f64,
    deepest: f64,
    /// The largest distance of a point outside.
    farthest: f64,
}

impl Fit<'_> {
    fn depths(&self, loop_: &[DVec2]) -> Depths {
        let dents = self.follow.beyond_dents(loop_, self.vertex, self.contour);
        let mut depths = Depths { squares: 0.0, deepest: 0.0, farthest: dents.max(0.0) };
        for &at in self.near {
            let beyond = self.follow.beyond(loop_, at, self.contour[at]);
            let depth = (-beyond).max(0.0);
            depths.squares += depth * depth;
            depths.deepest = depths.deepest.max(depth);
            depths.farthest = depths.farthest.max(beyond);
        }
        depths
    }

    /// The sum of squares, if it is below `least` and no point is farther outside than `most`.
    fn squares(&self, loop_: &[DVec2], least: f64, most: f64) -> Option<f64> {
        let mut squares = 0.0;
        for &at in self.near {
            let beyond = self.follow.beyond(loop_, at, self.contour[at]);
            let depth = (-beyond).max(0.0);
            squares += depth * depth;
            if squares >= least || beyond > most {
                return None;
            }
        }
        (self.follow.beyond_dents(loop_, self.vertex, self.contour) <= most).then_some(squares)
    }
}
