//! Even distances on the line of a cut, between its corners.

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::slide::{Course, Curve};
use super::strip::Strip;

/// The line keeps its vertices where it turns by more.
const CORNER: f64 = 0.6;

/// Corners that stay are at least this far apart, in edge lengths.
const APART: f64 = 0.3;

/// A stretch of the line between two vertices that stay, or all around.
struct Stretch {
    nodes: Vec<u32>,
    /// The last vertex is the first one.
    around: bool,
}

/// Puts vertices on the line at even distances; returns those that stay,
/// and the line as it was.
pub(in crate::cut) fn resample(strip: &mut Strip<'_>, length: f64) -> (FxHashSet<u32>, Course) {
    let mut course = Course::default();
    let mut kept = FxHashSet::default();
    for stretch in stretches(strip, length) {
        let points = stretch.nodes.iter().map(|&v| strip.position(v)).collect::<Vec<_>>();
        let normals = stretch.nodes.iter().map(|&v| strip.normal(v)).collect::<Vec<_>>();
        let mut arc = vec![0.0];
        for pair in points.windows(2) {
            arc.push(arc[arc.len() - 1] + pair[0].distance(pair[1]));
        }
        let total = arc[arc.len() - 1];
        let least = if stretch.around { 6.0 } else { 1.0 };
        let step = total / (total / length).round().max(least);
        let old = stretch.nodes.iter().map(|&v| (v as usize) < strip.parted.n_old).collect::<Vec<_>>();
        let line = Line { arc: &arc, points: &points, normals: &normals, old: &old };
        let mut targets = line.spread(step, 0.8 * strip.tolerance);
        let places = places(strip, &stretch.nodes);
        let curve = course.add(Curve { arc: arc.clone(), points: points.clone(), places });
        for (&v, &s) in stretch.nodes.iter().zip(&arc).skip(1).take(arc.len() - 2) {
            course.put(v, curve, s);
        }
        kept.insert(stretch.nodes[0]);
        kept.insert(stretch.nodes[stretch.nodes.len() - 1]);
        // From the end, so that the edges before stay as they are.
        let mut next: Option<(usize, u32, f64)> = None;
        targets.pop();
        for &s in targets[1..].iter().rev() {
            let (k, t) = line.at(s);
            let near = if t < 0.5 { k - 1 } else { k };
            if (arc[near] - s).abs() <= 0.04 * step {
                kept.insert(stretch.nodes[near]);
                continue;
            }
            // The part of this edge that is left of a vertex put on it before.
            let (end, share) = match next {
                Some((edge, v, before)) if edge == k => (v, t / before),
                _ => (stretch.nodes[k], t),
            };
            if let Some(m) = strip.split(stretch.nodes[k - 1], end, share) {
                kept.insert(m);
                course.put(m, curve, s);
                next = Some((k, m, t));
            }
        }
    }
    (kept, course)
}

/// Places of a stretch's vertices on the unrolled line, without jumps.
fn places(strip: &Strip<'_>, nodes: &[u32]) -> Vec<f64> {
    let mut places = vec![0.0];
    for pair in nodes.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let [x, y] = strip.parted.cut.get(&(a.min(b), a.max(b))).copied().unwrap_or_default();
        places.push(places[places.len() - 1] + if a < b { y - x } else { x - y });
    }
    places
}

/// A stretch of the line, measured.
struct Line<'a> {
    arc: &'a [f64],
    points: &'a [DVec3],
    normals: &'a [DVec3],
    /// Vertices of the old mesh.
    old: &'a [bool],
}

impl Line<'_> {
    /// The edge at a length, by the number of its second point, and the share of it.
    fn at(&self, s: f64) -> (usize, f64) {
        let k = self.arc.partition_point(|&a| a <= s).clamp(1, self.arc.len() - 1);
        let t = (s - self.arc[k - 1]) / (self.arc[k] - self.arc[k - 1]).max(f64::MIN_POSITIVE);
        (k, t.clamp(0.0, 1.0))
    }

    /// Lengths at which vertices should be, the first and the last among them: near `step` apart, with edges that stay
    /// within the tolerance of the surface, and at old vertices rather than beside them. By dynamic
    /// programming over the line's own points and others between them.
    fn spread(&self, step: f64, tolerance: f64) -> Vec<f64> {
        const LONGEST: f64 = 1.9;
        // Length, and the number of line points before it.
        let mut places: Vec<(f64, usize)> = vec![(0.0, 0)];
        for k in 1..self.arc.len() {
            let (from, to) = (self.arc[k - 1], self.arc[k]);
            let parts = ((to - from) / (0.25 * step)).ceil().clamp(1.0, 1e6);
            places.extend((1..parts as usize).map(|i| (from + (to - from) * i as f64 / parts, k)));
            places.push((to, k));
        }
        let mut best = vec![(f64::INFINITY, 0usize); places.len()];
        best[0] = (0.0, 0);
        for j in 1..places.len() {
            for i in (0..j).rev() {
                let length = places[j].0 - places[i].0;
                if length > LONGEST * step && i + 1 < j {
                    break;
                }
                let cost = best[i].0 + self.cost(places[i], places[j], step, tolerance);
                if cost < best[j].0 {
                    best[j] = (cost, i);
                }
            }
        }
        let mut chosen = vec![places.len() - 1];
        while let Some(&last) = chosen.last().filter(|&&k| k > 0) {
            chosen.push(best[last].1);
        }
        chosen.iter().rev().map(|&k| places[k].0).collect()
    }

    /// What an edge between two places costs.
    fn cost(&self, from: (f64, usize), to: (f64, usize), step: f64, tolerance: f64) -> f64 {
        const SAMPLES: usize = 12;
        let uneven = libm::log(((to.0 - from.0) / step).max(1e-6));
        let point = |s: f64| {
            let (k, t) = self.at(s);
            self.points[k - 1].lerp(self.points[k], t)
        };
        let (p, q) = (point(from.0), point(to.0));
        let along = (q - p) / (q - p).length_squared().max(f64::MIN_POSITIVE);
        let first = self.arc.partition_point(|&a| a <= from.0);
        let last = self.arc.partition_point(|&a| a < to.0);
        let stride = ((last.max(first) - first) / SAMPLES).max(1);
        let mut off = 0.0f64;
        let mut passed = 0.0;
        for k in (first..last).step_by(stride) {
            let foot = p + (self.points[k] - p).dot(along).clamp(0.0, 1.0) * (q - p);
            off = off.max((self.points[k] - foot).dot(self.normals[k]).abs() / tolerance);
            passed += if self.old[k] { 0.4 } else { 0.0 };
        }
        6.0 * uneven * uneven
            + passed
            + if off <= 1.0 { 0.3 * off * off } else { (4.0 * off * off).min(100.0) }
    }
}

/// The line, divided at its corners and where it branches or ends.
fn stretches(strip: &Strip<'_>, length: f64) -> Vec<Stretch> {
    let mut on = strip.parted.cut.keys().flat_map(|&(a, b)| [a, b]).collect::<Vec<_>>();
    on.sort_unstable();
    on.dedup();
    // Corners are told by the turn between two stretches as long as a quarter of an edge.
    let reach = |from: u32, next: u32| {
        let (mut before, mut at, mut gone) = (from, next, 0.0);
        loop {
            gone += strip.position(before).distance(strip.position(at));
            let line = strip.on_line(at);
            if gone >= 0.25 * length || line.len() != 2 || at == from {
                return strip.position(at);
            }
            let onward = if line[0] == before { line[1] } else { line[0] };
            (before, at) = (at, onward);
        }
    };
    let is_stop = |v: u32| {
        let line = strip.on_line(v);
        if line.len() != 2 || strip.is_border(v) {
            return true;
        }
        let p = strip.position(v);
        let (a, b) = (p - reach(v, line[0]), reach(v, line[1]) - p);
        a.angle_between(b) > CORNER
    };
    // Of neighbouring corners the sharpest would do; the nearest to even is decided by the spacing.
    let mut stops: FxHashSet<u32> = FxHashSet::default();
    let turn = |v: u32| {
        let line = strip.on_line(v);
        if line.len() != 2 || strip.is_border(v) {
            return f64::INFINITY;
        }
        let p = strip.position(v);
        (p - reach(v, line[0])).angle_between(reach(v, line[1]) - p)
    };
    let mut candidates = on.iter().copied().filter(|&v| is_stop(v)).map(|v| (turn(v), v)).collect::<Vec<_>>();
    candidates.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for (sharp, v) in candidates {
        let crowded = || {
            strip.on_line(v).iter().any(|&next| {
                let (mut before, mut at, mut gone) = (v, next, 0.0);
                loop {
                    gone += strip.position(before).distance(strip.position(at));
                    if gone >= APART * length {
                        return false;
                    }
                    if stops.contains(&at) {
                        return true;
                    }
                    let line = strip.on_line(at);
                    if line.len() != 2 || at == v {
                        return false;
                    }
                    let onward = if line[0] == before { line[1] } else { line[0] };
                    (before, at) = (at, onward);
                }
            })
        };
        if sharp == f64::INFINITY || !crowded() {
            stops.insert(v);
        }
    }
    let mut seen: FxHashSet<(u32, u32)> = FxHashSet::default();
    let mut found = vec![];
    let walk = |start: u32, next: u32, seen: &mut FxHashSet<(u32, u32)>| {
        let mut nodes = vec![start, next];
        seen.insert((start.min(next), start.max(next)));
        loop {
            let (before, at) = (nodes[nodes.len() - 2], nodes[nodes.len() - 1]);
            if at == start || stops.contains(&at) {
                return nodes;
            }
            let line = strip.on_line(at);
            let onward = if line[0] == before { line[1] } else { line[0] };
            seen.insert((at.min(onward), at.max(onward)));
            nodes.push(onward);
        }
    };
    let ordered = on.iter().copied().filter(|v| stops.contains(v)).collect::<Vec<_>>();
    for v in ordered.into_iter().chain(on.iter().copied()) {
        for &next in strip.on_line(v) {
            if !seen.contains(&(v.min(next), v.max(next))) {
                let nodes = walk(v, next, &mut seen);
                let around = nodes[0] == nodes[nodes.len() - 1];
                found.push(Stretch { nodes, around });
            }
        }
    }
    found
}
