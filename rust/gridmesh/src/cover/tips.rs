//! Single boundary vertices moved to tips of a drawing that the patch cuts off.

use glam::DVec2;

use crate::cover::boundary::Boundary;
use crate::cover::needs_of;
use crate::cover::outside::{Followers, loop_of};
use crate::cover::short::Lengths;
use crate::geometry::segments::nearest_on_segment;
use crate::patch::Patch;

/// Vertices that are moved at most, for each contour.
const MOVES: usize = 48;

/// Ends of edges are moved at most so far, in edge lengths, for the edges to pass through points.
const FARTHEST: f64 = 0.5;

/// How far outside a point is, in edge lengths, for which a vertex is moved.
const WORTH: f64 = 0.015;

/// Cotangent of the angle, 12 degrees, to which corners of faces may fall for a tip's sake.
const THINNEST: f64 = 4.704_630_109_478_455;

/// Moves vertices so that less of the contours lies outside, where no face becomes thin, no edge short and no edges meet by that;
/// returns how far the farthest point still is outside.
pub(super) fn moved(patch: &mut Patch, fine: &[Vec<DVec2>], followers: &[Followers], slack: f64) -> f64 {
    let worth = WORTH * patch.lattice.edge_length;
    let lengths = Lengths::new(patch);
    let mut boundary = Boundary::new(patch);
    let mut left = 0.0f64;
    for (k, contour) in fine.iter().enumerate() {
        let mut need = needs_of(patch, k, contour, &followers[k], slack);
        let mut tried: Vec<bool> = need.iter().map(|&need| need <= worth).collect();
        for _ in 0..MOVES {
            let open = (0..need.len()).filter(|&i| !tried[i]);
            let Some(at) = open.max_by(|&i, &j| need[i].total_cmp(&need[j]).then(j.cmp(&i))) else { break };
            tried[at] = true;
            let Some(edge) = followers[k].edge(at) else { continue };
            for (vertex, place) in places(patch, k, edge, contour[at]) {
                let (before, lacked) = (patch.vertices[vertex], lengths.lacking(patch, vertex));
                let thinnest = lengths.sharpest(patch, vertex).max(THINNEST);
                patch.vertices[vertex] = place;
                if lengths.sharpest(patch, vertex) <= thinnest
                    && lengths.lacking(patch, vertex) <= lacked
                    && boundary.stays_simple(patch, vertex)
                    && let Some(after) = better(patch, k, (contour, &followers[k]), slack, (&need, vertex))
                {
                    need = after;
                    boundary.moved(patch, vertex, before);
                    tried.iter_mut().zip(&need).for_each(|(tried, &need)| *tried |= need <= worth);
                    break;
                }
                patch.vertices[vertex] = before;
            }
        }
        let need = needs_of(patch, k, contour, &followers[k], slack);
        left = need.iter().copied().fold(left, f64::max);
    }
    left
}

/// The needs after a move of a vertex, if their sum of squares is less by a tenth.
fn better(
    patch: &Patch,
    k: usize,
    (contour, followers): (&[DVec2], &Followers),
    slack: f64,
    (need, vertex): (&[f64], usize),
) -> Option<Vec<f64>> {
    let (mut after, loop_) = (need.to_vec(), loop_of(patch, k));
    let own = vertex - patch.loops[k].start as usize;
    for at in followers.points_near(own) {
        after[at] = (followers.beyond(loop_, at, contour[at]) - slack).max(0.0);
    }
    let at = followers.point_at(own);
    after[at] = after[at].max(followers.beyond_dents(loop_, own, contour) - slack);
    let squares = |need: &[f64]| need.iter().map(|need| need * need).sum::<f64>();
    (squares(&after) < 0.9 * squares(need)).then_some(after)
}

/// Vertices that may be moved so that an edge of a loop takes in a point, and where to: each end to the point, the nearer one
/// first, or so that the edge passes through the point.
fn places(patch: &Patch, k: usize, edge: usize, point: DVec2) -> Vec<(usize, DVec2)> {
    let range = patch.loops[k].vertices();
    let (start, n) = (range.start as usize, range.len());
    let [a, b] = [start + edge, start + (edge + 1) % n];
    let at = |vertex: usize| patch.vertices[vertex];
    let (share, squared) = nearest_on_segment(point, at(a), at(b));
    let away = point - at(a).lerp(at(b), share);
    let ends = if share <= 0.5 { [(a, 1.0 - share), (b, share)] } else { [(b, share), (a, 1.0 - share)] };
    let mut places: Vec<(usize, DVec2)> = ends.iter().map(|&(vertex, _)| (vertex, point)).collect();
    let lifted =
        ends.into_iter().filter(|&(_, part)| part * FARTHEST * patch.lattice.edge_length >= squared.sqrt());
    places.extend(lifted.map(|(vertex, part)| (vertex, at(vertex) + away / part)));
    places
}
