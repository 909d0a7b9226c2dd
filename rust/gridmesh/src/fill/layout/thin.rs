//! Loops with many more vertices than their size asks for: a patch for every second or third of them, and the
//! others put back on its edges.
//!
//! Where a cut passes through a mesh as it is, the loop's edges are as long as the mesh's and as short as they
//! come, in turn. A lattice with all of them has steps of their mean length; one with those that are about as far
//! apart as the longest edges are long has a quarter of the triangles.

use glam::DVec2;

/// Edges of the loop that one edge of the patch may stand for.
const MOST: usize = 8;

/// How far a vertex may be from the edge on which it is put back, in lengths of that edge.
const OFF: f64 = 0.08;

/// Edges before and behind a vertex whose longest says how far apart vertices should be.
const NEAR: usize = 4;

/// Cost of a vertex left out, against that of an edge twice too long.
const LEFT_OUT: f64 = 0.01;

/// Numbers of the vertices, ascending, that are about as far apart as the longest edges around are long.
/// `None` if that is nearly all of them, or too few.
pub(in crate::fill) fn thinned(points: &[DVec2]) -> Option<Vec<usize>> {
    let n = points.len();
    let lengths: Vec<f64> = (0..n).map(|k| points[k].distance(points[(k + 1) % n])).collect();
    let wished = |k: usize| {
        let near = (0..2 * NEAR).map(|i| lengths[(k + n + i - NEAR) % n]);
        near.fold(f64::MIN_POSITIVE, f64::max)
    };
    // The cheapest way around from the longest edge.
    let first = (0..n).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]).then(b.cmp(&a)))?;
    let mut best = vec![(f64::INFINITY, 0); n + 1];
    best[0].0 = 0.0;
    for from in 0..n {
        let i = (first + from) % n;
        let size = wished(i);
        for span in 1..=MOST.min(n - from) {
            if !stands_for(points, i, span) {
                continue;
            }
            let off = points[i].distance(points[(i + span) % n]) / size - 1.0;
            let cost = best[from].0 + off * off + LEFT_OUT * (span - 1) as f64;
            if cost < best[from + span].0 {
                best[from + span] = (cost, from);
            }
        }
    }
    let mut kept = vec![];
    let mut at = n;
    while at > 0 {
        at = best[at].1;
        kept.push((first + at) % n);
    }
    kept.sort_unstable();
    (kept.len() >= 8 && 5 * kept.len() <= 4 * n).then_some(kept)
}

/// Whether an edge from vertex `i` over `span` edges passes by the vertices between, one after the other.
fn stands_for(points: &[DVec2], i: usize, span: usize) -> bool {
    let n = points.len();
    let edge = points[(i + span) % n] - points[i];
    let length = edge.length_squared();
    let mut last = 0.0;
    (1..span).all(|k| {
        let d = points[(i + k) % n] - points[i];
        let along = d.dot(edge);
        let before = std::mem::replace(&mut last, along);
        before < along && along < length && edge.perp_dot(d).abs() <= OFF * length
    })
}

/// Triangles of a patch of the `kept` vertices with the other ones of the loop of `n` put back.
pub(in crate::fill) fn put_back(triangles: &[[u32; 3]], kept: &[usize], n: usize) -> Vec<[u32; 3]> {
    let m = kept.len();
    let name = |v: u32| kept.get(v as usize).map_or(v + (n - m) as u32, |&v| v as u32);
    // Edges of the loop that an edge between these vertices of the patch stands for.
    let span = |a: u32, b: u32| match (kept.get(a as usize), kept.get(b as usize)) {
        (Some(from), Some(to)) if (a as usize + 1) % m == b as usize => (to + n - from) % n,
        _ => 1,
    };
    let mut all = Vec::with_capacity(triangles.len() + n - m);
    for &[a, b, c] in triangles {
        // An edge without others on it comes last.
        let [a, b, c] = if span(b, c) == 1 {
            [c, a, b]
        } else if span(a, b) == 1 {
            [b, c, a]
        } else {
            [a, b, c]
        };
        let mut cut_off = |from: u32, span: usize, apex: u32| {
            let on = |k: usize| ((from as usize + k) % n) as u32;
            all.extend((1..span).map(|k| [on(k - 1), on(k), apex]));
            if span > 1 { on(span - 1) } else { from }
        };
        let (first, second) = (span(a, b), span(b, c));
        let [a, b, c] = [a, b, c].map(name);
        let a = cut_off(a, first, c);
        let b = cut_off(b, second, a);
        all.push([a, b, c]);
    }
    all
}
