//! How the line runs through a triangle: chains of its crossings and of the stroke's points between them.
//!
//! Which crossings belong together follows from exact answers alone: a segment and a triangle are convex, so they
//! meet in one stretch, and between two segments the line is inside or it is not.

use glam::DVec3;

use crate::cut::divide::divider::{Chains, Divider};
use crate::cut::divide::node::Node;
use crate::cut::sheet::{Sheet, side_of_edge};
use crate::error::Result;

/// A point of a chain.
#[derive(Clone, Copy)]
struct Stop {
    node: u32,
    place: f64,
}

/// Of a triangle's crossings, told by their segments in order, one at which the line enters: it begins where it is
/// outside, at a segment with two crossings, or after one that leaves.
pub(in crate::cut) fn start(segments: &[u32], is_inside: impl Fn(usize) -> bool) -> Option<usize> {
    let is_alone = |k: usize| {
        let same = |j: usize| segments[j] == segments[k];
        !((k > 0 && same(k - 1)) || (k + 1 < segments.len() && same(k + 1)))
    };
    (0..segments.len()).find(|&k| {
        let first_of_pair = k + 1 < segments.len() && segments[k] == segments[k + 1];
        first_of_pair || (is_alone(k) && !is_inside(segments[k] as usize))
    })
}

/// True if the stroke's point `k` is in the triangle.
pub(in crate::cut) fn is_inside(sheet: &Sheet, corners: [u32; 3], k: usize) -> bool {
    let [a, b, c] = corners.map(|v| sheet.seen[v as usize]);
    if a == b || b == c || c == a {
        return false;
    }
    let p = sheet.point(k);
    let left = side_of_edge(a, b, p) > 0.0;
    (side_of_edge(b, c, p) > 0.0) == left && (side_of_edge(c, a, p) > 0.0) == left
}

impl Divider<'_> {
    /// The line within a triangle.
    pub(in crate::cut) fn chains(&mut self, corners: [u32; 3]) -> Result<Chains> {
        // Crossings by segment; which of a segment's two comes first does not matter.
        let mut events: Vec<(u32, Stop)> = vec![];
        for k in 0..3 {
            for hit in self.hits(corners[k], corners[(k + 1) % 3]) {
                let place = self.sheet.place(hit.segment as usize, hit.s);
                events.push((hit.segment, Stop { node: hit.node, place }));
            }
        }
        events.sort_by(|x, y| x.0.cmp(&y.0).then(x.1.place.total_cmp(&y.1.place)));
        let mut chains = Chains::new();
        if events.is_empty() {
            if self.sheet.closed && is_inside(self.sheet, corners, 0) {
                let n = self.sheet.n_segments();
                let stops = (0..n).map(|k| self.inner(corners, k)).collect::<Option<Vec<_>>>();
                let Some(mut stops) = stops else { return Ok(chains) };
                stops.push(stops[0]);
                add_chain(&mut chains, &stops);
            }
            return Ok(chains);
        }
        let segments = events.iter().map(|e| e.0).collect::<Vec<_>>();
        let start = start(&segments, |k| is_inside(self.sheet, corners, k))
            .ok_or_else(|| self.failed(corners, "the line never enters a face"))?;
        let n = self.sheet.n_segments() as u32;
        let count = events.len();
        if count % 2 == 1 {
            return Err(self.failed(corners, "the line enters a face and does not leave it"));
        }
        for pair in 0..count / 2 {
            let (first, second) =
                (events[(start + 2 * pair) % count], events[(start + 2 * pair + 1) % count]);
            let mut stops = vec![first.1];
            let steps = (second.0 + n - first.0) % n;
            for step in 1..=steps {
                let k = (first.0 + step) as usize % self.sheet.points.len();
                stops.extend(self.inner(corners, k));
            }
            stops.push(second.1);
            self.merge(&mut stops);
            add_chain(&mut chains, &stops);
        }
        Ok(chains)
    }

    /// The stroke's point `k` as a vertex within a triangle; none if that is seen edge on.
    fn inner(&mut self, corners: [u32; 3], k: usize) -> Option<Stop> {
        const EDGE_ON: f64 = 1e-5;
        let [a, b, c] = corners.map(|v| self.sheet.seen[v as usize]);
        let place = self.sheet.place(k.min(self.sheet.n_segments()), 0.0);
        let p = self.sheet.point(k);
        let [x, y, z] = corners.map(|v| self.vertices[v as usize]);
        let normal = (y - x).cross(z - x);
        if normal.dot(self.sheet.view.ray(p)).abs() <= EDGE_ON * normal.length() {
            return None;
        }
        let mut weights = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)];
        let sum: f64 = weights.iter().sum();
        for (w, v) in weights.iter_mut().zip([x, y, z]) {
            *w = (*w / sum).clamp(0.0, 1.0) / self.sheet.view.depth(v);
        }
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= sum);
        if !weights.iter().all(|w| w.is_finite()) {
            return None;
        }
        let node = (self.vertices.len() + self.nodes.len()) as u32;
        self.nodes.push(Node::within(self.vertices, corners, weights));
        Some(Stop { node, place })
    }

    /// Leaves out the stroke's points that nearly coincide with the ends of their chain.
    fn merge(&mut self, stops: &mut Vec<Stop>) {
        if stops.len() < 3 {
            return;
        }
        let (first, last) = (stops[0].node, stops[stops.len() - 1].node);
        let (p, q) = (self.position(first), self.position(last));
        let n_old = self.vertices.len();
        let near = |v: u32, p: DVec3, end: u32| {
            let node = &self.nodes[v as usize - n_old];
            let [a, b, c] = node.source.map(|v| self.vertices[v as usize]);
            let size = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let share = if (end as usize) < n_old { self.tolerance.vertex } else { self.tolerance.node };
            let reach = if (end as usize) < n_old { self.tolerance.length } else { 0.0 };
            node.position.distance(p) <= (share * size).max(reach)
        };
        let inner = stops[1..stops.len() - 1].to_vec();
        let kept = inner.into_iter().filter(|s| !near(s.node, p, first) && !near(s.node, q, last));
        let mut all = vec![stops[0]];
        all.extend(kept);
        all.push(stops[stops.len() - 1]);
        *stops = self.straightened(&all);
    }

    /// A chain without the stroke's points that its neighbours make superfluous. Next to a side of the triangle they would
    /// be on the wrong side of it after rounding.
    fn straightened(&self, stops: &[Stop]) -> Vec<Stop> {
        const MOST: usize = 32;
        let [Some(&start), Some(&end)] = [stops.first(), stops.last()] else { return stops.to_vec() };
        let reach = self.tolerance.node * self.position(start.node).distance(self.position(end.node));
        let mut kept = vec![start];
        let mut from = 0;
        for k in 1..stops.len() - 1 {
            let (p, q) = (self.position(stops[from].node), self.position(stops[k + 1].node));
            let along = (q - p) / (q - p).length_squared().max(f64::MIN_POSITIVE);
            let is_straight = |s: &Stop| {
                let r = self.position(s.node);
                r.distance(p + (r - p).dot(along).clamp(0.0, 1.0) * (q - p)) <= reach
            };
            if k - from > MOST || !stops[from + 1..=k].iter().all(is_straight) {
                kept.push(stops[k]);
                from = k;
            }
        }
        kept.push(end);
        kept
    }
}

/// Appends the edges of a chain; running along one twice cancels out.
fn add_chain(chains: &mut Chains, stops: &[Stop]) {
    for pair in stops.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        if a.node == b.node {
            continue;
        }
        let known = chains.iter_mut().find(|c| c.0 == [a.node, b.node] || c.0 == [b.node, a.node]);
        match known {
            Some(known) => known.2 = !known.2,
            None => chains.push(([a.node, b.node], [a.place, b.place], true)),
        }
    }
}
