//! The immersed band: the lattice points near a curve, once for each stretch of it they are near.

use std::iter;
use std::marker::PhantomData;
use std::sync::OnceLock;

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::lattice::axial::Axial;
use crate::lattice::dir::Dir;
use crate::lattice::grid::{Grid, Triangular};
use crate::path::placement::Laid;
use crate::path::target::Target;

/// How much farther than the path's greatest distance a stretch of curve may be from its point.
pub const SLACK: f64 = 0.3;

/// A lattice point and one stretch of the curve beside it.
///
/// The stretch is a maximal run of target segments within reach of the point. Both walls of a
/// narrow part, and both sides of an inlet, give nodes of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// The lattice point.
    pub point: Axial,
    /// First segment of the run, from 0 to the number of samples.
    pub first: u32,
    /// Last segment of the run, at least `first`; past the number of samples where the run goes
    /// round the end.
    pub last: u32,
    /// Parameter of the nearest point of the run, in samples; from `first` to `last + 1`.
    pub parameter: f64,
    /// Distance to the nearest point of the run, in edges.
    pub distance: f64,
}

/// A node beside another: their points are lattice neighbours and their runs overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// Number of the neighbouring node.
    pub node: u32,
    /// The runs overlap when the neighbour's is moved by this many turns round the curve.
    pub wrap: i8,
}

/// All nodes within a distance of a target and the links between them, in time and space
/// proportional to its length.
#[derive(Clone, Debug)]
pub struct Band<G = Triangular> {
    /// Nodes in order of their run's first segment; ties in scan order.
    pub nodes: Vec<Node>,
    /// Where the links of node `i` in direction `d` start: entry `D i + d`, where D is the
    /// number of directions; and the end.
    starts: Vec<u32>,
    links: Vec<Link>,
    by_point: OnceLock<ByPoint>,
    n_samples: usize,
    grid: PhantomData<G>,
}

/// The nodes of each point, latest run first.
#[derive(Clone, Debug)]
struct ByPoint {
    latest: FxHashMap<Axial, u32>,
    earlier: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl<G: Laid> Band<G> {
    /// Collects the nodes whose nearest distance is at most `max_distance`; runs reach out to
    /// `max_distance + SLACK`.
    pub(crate) fn beside(target: &Target, max_distance: f64) -> Self {
        Scan::new(&target.points, true, max_distance + SLACK).finish(max_distance)
    }

    /// Likewise for the open line through some points: runs do not go round its ends, and no link
    /// does.
    pub(crate) fn along(points: &[DVec2], max_distance: f64) -> Self {
        Scan::new(points, false, max_distance + SLACK).finish(max_distance)
    }
}

impl<G: Grid> Band<G> {
    /// Number of samples of the target: parameters are taken modulo this.
    pub fn n_samples(&self) -> usize {
        self.n_samples
    }

    /// The neighbours of a node in one direction.
    pub(crate) fn links_in(&self, node: usize, dir: u32) -> &[Link] {
        let entry = G::DIRECTIONS as usize * node + dir as usize;
        &self.links[self.starts[entry] as usize..self.starts[entry + 1] as usize]
    }

    /// Numbers of the nodes of a lattice point, latest run first.
    pub fn nodes_at(&self, point: Axial) -> impl Iterator<Item = usize> {
        let some = |i: u32| (i != NONE).then_some(i as usize);
        let index = self.by_point.get_or_init(|| {
            let mut latest = FxHashMap::default();
            let earlier = (0..)
                .zip(&self.nodes)
                .map(|(i, node)| latest.insert(node.point, i).unwrap_or(NONE))
                .collect();
            ByPoint { latest, earlier }
        });
        iter::successors(index.latest.get(&point).map(|&i| i as usize), move |&i| some(index.earlier[i]))
    }

    /// The node of a lattice point that is nearest to the curve.
    pub fn nearest(&self, point: Axial) -> Option<&Node> {
        self.nodes_at(point)
            .map(|i| &self.nodes[i])
            .min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.first.cmp(&b.first)))
    }
}

impl Band {
    /// Collects the nodes whose nearest distance is at most `max_distance`; runs reach out to
    /// `max_distance + SLACK`.
    pub fn new(target: &Target, max_distance: f64) -> Self {
        Self::beside(target, max_distance)
    }

    /// The neighbours of a node in one direction.
    pub fn links(&self, node: usize, dir: Dir) -> &[Link] {
        self.links_in(node, dir.index() as u32)
    }
}

/// A walk along the target that opens, extends and links runs.
struct Scan<G> {
    nodes: Vec<Node>,
    /// Pairs of nodes active on a common segment, and the direction from the first to the second.
    pairs: Vec<(u32, u32, u8)>,
    /// Nodes active on segment 0 are the first so many.
    heads: usize,
    n_samples: usize,
    closed: bool,
    grid: PhantomData<G>,
}

/// The latest node of each point near the segment at hand: a square of slots that the axial
/// coordinates wrap around. It is wider than any segment's reach, so active points never share one.
struct Window {
    slots: Vec<u32>,
    shift: u32,
}

impl Window {
    fn new<G: Laid>(points: &[DVec2], n_segments: usize, reach: f64) -> Self {
        let longest = (0..n_segments)
            .map(|i| points[i].distance_squared(points[(i + 1) % points.len()]))
            .fold(0.0, f64::max)
            .sqrt();
        let width = (2.0 * reach + longest) / G::ROW_HEIGHT + 2.0;
        let shift = (width.ceil() as u32).next_power_of_two().trailing_zeros();
        Self { slots: vec![NONE; 1 << (2 * shift)], shift }
    }

    fn slot(&self, point: Axial) -> usize {
        let mask = (1u32 << self.shift) - 1;
        (((point.r as u32 & mask) << self.shift) | (point.q as u32 & mask)) as usize
    }
}

impl<G: Laid> Scan<G> {
    fn new(points: &[DVec2], closed: bool, reach: f64) -> Self {
        let n = if closed { points.len() } else { points.len().saturating_sub(1) };
        let mut window = Window::new::<G>(points, n, reach);
        let mut nodes: Vec<Node> = Vec::with_capacity(2 * n);
        let mut pairs = Vec::with_capacity(G::DIRECTIONS as usize * n);
        let mut heads = 0;
        for segment in 0..n {
            let (a, b) = (points[segment], points[(segment + 1) % points.len()]);
            let at = segment as u32;
            let fresh = nodes.len();
            points_near::<G>(a, b, reach, |point, t, squared| {
                let slot = window.slot(point);
                let known = window.slots[slot];
                if let Some(node) = nodes.get_mut(known as usize)
                    && node.point == point
                    && node.last + 1 >= at
                {
                    // Without a branch: which one is nearer is hard to predict.
                    let is_nearer = squared < node.distance;
                    node.last = at;
                    node.parameter = if is_nearer { f64::from(at) + t } else { node.parameter };
                    node.distance = if is_nearer { squared } else { node.distance };
                    return;
                }
                window.slots[slot] = nodes.len() as u32;
                nodes.push(Node {
                    point,
                    first: at,
                    last: at,
                    parameter: f64::from(at) + t,
                    distance: squared,
                });
            });
            for i in fresh..nodes.len() {
                for dir in 0..G::DIRECTIONS {
                    let beside = nodes[i].point + G::offset(dir);
                    let j = window.slots[window.slot(beside)];
                    let active =
                        nodes.get(j as usize).is_some_and(|node| node.point == beside && node.last == at);
                    // Of two that open together the later one links them.
                    if active && (j as usize) < i {
                        pairs.push((i as u32, j, dir as u8));
                    }
                }
            }
            if segment == 0 {
                heads = nodes.len();
            }
        }
        Self { nodes, pairs, heads, n_samples: n, closed, grid: PhantomData }
    }

    /// Joins the runs across the end, drops the nodes that are too far, numbers and links the rest.
    fn finish(mut self, max_distance: f64) -> Band<G> {
        // Where a node went: to itself or to the one it was joined to, and how many turns on.
        let mut rep: Vec<(u32, i8)> = (0..self.nodes.len() as u32).map(|i| (i, 0)).collect();
        if self.closed {
            self.join_ends(&mut rep);
        }
        let near = max_distance * max_distance;
        let mut number = vec![NONE; self.nodes.len()];
        let mut nodes = Vec::with_capacity(self.nodes.len());
        for (i, node) in self.nodes.iter().enumerate() {
            if rep[i].0 == i as u32 && node.distance <= near {
                number[i] = nodes.len() as u32;
                nodes.push(Node { distance: node.distance.sqrt(), ..*node });
            }
        }
        let mut entries: Vec<(u32, Link)> = Vec::with_capacity(2 * self.pairs.len());
        for &(a, b, dir) in &self.pairs {
            let ((ra, turn_a), (rb, turn_b)) = (rep[a as usize], rep[b as usize]);
            let (na, nb) = (number[ra as usize], number[rb as usize]);
            if na == NONE || nb == NONE {
                continue;
            }
            let wrap = turn_a - turn_b;
            let back = G::turned(u32::from(dir), G::OPPOSITE as i32);
            entries.push((G::DIRECTIONS * na + u32::from(dir), Link { node: nb, wrap }));
            entries.push((G::DIRECTIONS * nb + back, Link { node: na, wrap: -wrap }));
        }
        let (starts, links) = sorted_rows(G::DIRECTIONS as usize * nodes.len(), &entries);
        Band { nodes, starts, links, by_point: OnceLock::new(), n_samples: self.n_samples, grid: PhantomData }
    }

    /// Joins a run that ends with the last segment to one of the same point that starts with the
    /// first.
    fn join_ends(&mut self, rep: &mut [(u32, i8)]) {
        let n = self.n_samples as u32;
        let mut ends: FxHashMap<Axial, usize> = FxHashMap::default();
        for (i, node) in self.nodes.iter().enumerate() {
            if node.last + 1 == n {
                ends.insert(node.point, i);
            }
        }
        for (start, rep) in rep.iter_mut().enumerate().take(self.heads) {
            let head = self.nodes[start];
            let Some(&end) = ends.get(&head.point) else {
                continue;
            };
            if end == start {
                continue;
            }
            let tail = &mut self.nodes[end];
            tail.last = n + head.last;
            if head.distance < tail.distance {
                tail.distance = head.distance;
                tail.parameter = head.parameter + f64::from(n);
            }
            *rep = (end as u32, 1);
        }
    }
}

/// Sorts entries by row, dropping repetitions; where each row starts, and the entries.
fn sorted_rows(n_rows: usize, entries: &[(u32, Link)]) -> (Vec<u32>, Vec<Link>) {
    let mut next = vec![0u32; n_rows + 1];
    for (row, _) in entries {
        next[*row as usize + 1] += 1;
    }
    for i in 1..next.len() {
        next[i] += next[i - 1];
    }
    let from = next.clone();
    let mut sorted = vec![Link { node: 0, wrap: 0 }; entries.len()];
    for (row, link) in entries {
        sorted[next[*row as usize] as usize] = *link;
        next[*row as usize] += 1;
    }
    let mut links = Vec::with_capacity(sorted.len());
    let mut starts = Vec::with_capacity(n_rows + 1);
    for row in from.windows(2) {
        let start = links.len();
        starts.push(start as u32);
        for link in &sorted[row[0] as usize..row[1] as usize] {
            if !links[start..].contains(link) {
                links.push(*link);
            }
        }
    }
    starts.push(links.len() as u32);
    (starts, links)
}

/// Calls `visit` with each lattice point within reach of a segment, the parameter of the nearest
/// point of the segment, 0 to 1, and the squared distance to it; row by row.
#[inline]
fn points_near<G: Laid>(a: DVec2, b: DVec2, reach: f64, mut visit: impl FnMut(Axial, f64, f64)) {
    let ab = b - a;
    let squared = ab.length_squared();
    let inverse = if squared > 0.0 { 1.0 / squared } else { 0.0 };
    let squared_reach = reach * reach;
    let (low, high) = (a.min(b), a.max(b));
    for r in ceil((low.y - reach) / G::ROW_HEIGHT)..=-ceil(-(high.y + reach) / G::ROW_HEIGHT) {
        let y = G::ROW_HEIGHT * f64::from(r);
        // How far the row passes the segment by: the points within reach are in this span.
        let beside = (y - high.y).max(low.y - y).max(0.0);
        let half = (squared_reach - beside * beside).max(0.0).sqrt() + 1e-9;
        let shift = G::ROW_SHIFT * f64::from(r);
        let first = ceil(low.x - half - shift);
        let last = -ceil(-(high.x + half - shift));
        let dy = y - a.y;
        let mut dx = f64::from(first) + shift - a.x;
        for q in first..=last {
            let t = ((dx * ab.x + dy * ab.y) * inverse).clamp(0.0, 1.0);
            let (x, y) = (dx - t * ab.x, dy - t * ab.y);
            let squared = x * x + y * y;
            if squared <= squared_reach {
                visit(Axial::new(q, r), t, squared);
            }
            dx += 1.0;
        }
    }
}

/// The least integer that is not below `x` (a library call without newer processor instructions).
#[inline]
fn ceil(x: f64) -> i32 {
    let whole = x as i32;
    whole + i32::from(f64::from(whole) < x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::segments::nearest_on_segment;
    use crate::path::placement::Lattice;

    /// Every node of a brute-force band over a box, as (point, first, last).
    fn brute_force(target: &Target, max_distance: f64) -> Vec<(Axial, u32, u32)> {
        let n = target.len();
        let mut found = Vec::new();
        for q in -40..40 {
            for r in -40..40 {
                let p = Axial::new(q, r);
                let d: Vec<f64> = (0..n)
                    .map(|i| {
                        let (a, b) = target.segment(i);
                        nearest_on_segment(Lattice::units(p), a, b).1.sqrt()
                    })
                    .collect();
                let within = |i: usize| d[i % n] <= max_distance + SLACK;
                for first in (0..n).filter(|&i| within(i) && !within(i + n - 1)) {
                    let last = (first..2 * n).find(|&i| !within(i + 1)).unwrap_or(2 * n);
                    if (first..=last).any(|i| d[i % n] <= max_distance) {
                        found.push((p, first as u32, last as u32));
                    }
                }
            }
        }
        found.sort_unstable();
        found
    }

    fn flower(shift: usize) -> Target {
        let mut points: Vec<DVec2> = (0..300)
            .map(|i| {
                let t = f64::from(i) / 300.0 * std::f64::consts::TAU;
                (7.0 + 5.0 * (5.0 * t).cos()) * DVec2::from_angle(t)
            })
            .collect();
        points.rotate_left(shift);
        Target { points, step: 0.4 }
    }

    #[test]
    fn nodes_are_the_maximal_runs() {
        for shift in [0, 10, 77, 150, 299] {
            let target = flower(shift);
            for max_distance in [0.7, 1.5] {
                let band = Band::new(&target, max_distance);
                let mut found: Vec<_> = band.nodes.iter().map(|n| (n.point, n.first, n.last)).collect();
                found.sort_unstable();
                assert_eq!(found, brute_force(&target, max_distance));
                let mut listed: Vec<usize> = band
                    .nodes
                    .iter()
                    .flat_map(|node| band.nodes_at(node.point).collect::<Vec<_>>())
                    .collect();
                listed.sort_unstable();
                listed.dedup();
                assert_eq!(listed.len(), band.nodes.len());
            }
        }
    }

    #[test]
    fn links_are_the_overlapping_runs_of_neighbours() {
        for shift in [0, 10, 77, 150, 299] {
            for max_distance in [0.7, 1.5, 2.0] {
                let band = Band::new(&flower(shift), max_distance);
                let n = band.n_samples() as i64;
                for (i, a) in band.nodes.iter().enumerate() {
                    for dir in Dir::ALL {
                        let mut expected = Vec::new();
                        for j in band.nodes_at(a.point + dir) {
                            let b = &band.nodes[j];
                            for wrap in -1..=1i8 {
                                let move_by = n * i64::from(wrap);
                                let (first, last) =
                                    (i64::from(b.first) + move_by, i64::from(b.last) + move_by);
                                if first <= i64::from(a.last) && i64::from(a.first) <= last {
                                    expected.push((j as u32, wrap));
                                }
                            }
                        }
                        let mut found: Vec<_> =
                            band.links(i, dir).iter().map(|link| (link.node, link.wrap)).collect();
                        expected.sort_unstable();
                        found.sort_unstable();
                        assert_eq!(found, expected, "node {i} {a:?} {dir:?}");
                    }
                }
            }
        }
    }
}
