//! Single boundary vertices moved to tips of a drawing that the patch cuts off.

use glam::DVec2;

use crate::cover::outside::LoopEdges;
use crate::cover::short::Lengths;
use crate::geometry::segments::nearest_on_segment;
use crate::patch::Patch;

/// Vertices that are moved at most, for each contour.
const MOVES: usize = 12;

/// How far outside a point is, in edge lengths, for which a vertex is moved.
const WORTH: f64 = 0.03;

/// Cotangent of the angle, 12 degrees, to which corners of faces may fall for a tip's sake.
const THINNEST: f64 = 4.704_630_109_478_455;

/// Moves vertices so that less of the contours lies outside, where no face becomes thin and no edge short by that;
/// returns how far the farthest point still is outside.
pub(super) fn moved(patch: &mut Patch, fine: &[Vec<DVec2>], slack: f64) -> f64 {
    let worth = WORTH * patch.lattice.edge_length;
    let lengths = Lengths::new(patch);
    let mut left = 0.0f64;
    for (k, contour) in fine.iter().enumerate() {
        let edges = LoopEdges::new(patch, k);
        let mut need: Vec<f64> = contour.iter().map(|&point| edges.outside(point, slack)).collect();
        let mut tried: Vec<bool> = need.iter().map(|&need| need <= worth).collect();
        for _ in 0..MOVES {
            let open = (0..need.len()).filter(|&i| !tried[i]);
            let Some(at) = open.max_by(|&i, &j| need[i].total_cmp(&need[j]).then(j.cmp(&i))) else { break };
            tried[at] = true;
            for vertex in nearest_ends(patch, k, contour[at]) {
                let (before, lacked) = (patch.vertices[vertex], lengths.lacking(patch, vertex));
                patch.vertices[vertex] = contour[at];
                if lengths.sharpest(patch, vertex) <= THINNEST
                    && lengths.lacking(patch, vertex) <= lacked
                    && let Some(after) = better(patch, k, contour, slack, &need)
                {
                    need = after;
                    tried.iter_mut().zip(&need).for_each(|(tried, &need)| *tried |= need <= worth);
                    break;
                }
                patch.vertices[vertex] = before;
            }
        }
        left = need.iter().copied().fold(left, f64::max);
    }
    left
}

/// The needs of a contour, if their sum of squares is less by a tenth.
fn better(patch: &Patch, k: usize, contour: &[DVec2], slack: f64, need: &[f64]) -> Option<Vec<f64>> {
    let edges = LoopEdges::new(patch, k);
    let after: Vec<f64> = contour.iter().map(|&point| edges.outside(point, slack)).collect();
    let squares = |need: &[f64]| need.iter().map(|need| need * need).sum::<f64>();
    (squares(&after) < 0.9 * squares(need)).then_some(after)
}

/// The ends of the loop's edge nearest to a point, the nearer one first.
fn nearest_ends(patch: &Patch, k: usize, point: DVec2) -> [usize; 2] {
    let range = patch.loops[k].vertices();
    let (start, n) = (range.start as usize, range.len());
    let place = |i: usize| patch.vertices[start + i % n];
    let distance = |i: usize| nearest_on_segment(point, place(i), place(i + 1)).1;
    let edge = (0..n).min_by(|&i, &j| distance(i).total_cmp(&distance(j))).unwrap_or(0);
    let (a, b) = (start + edge, start + (edge + 1) % n);
    if place(edge).distance_squared(point) <= place(edge + 1).distance_squared(point) {
        [a, b]
    } else {
        [b, a]
    }
}
