//! Even edges along the cut, and the faces along it rebuilt to match.
//!
//! The line gets vertices at even distances, more where it bends; the others are collapsed into them. Then triangles
//! with small angles near the line are flipped, collapsed or split while that helps.

use std::collections::BTreeSet;

use glam::DVec3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use rustc_hash::FxHashSet;

use super::input::{Polygons, triangles};
use super::report::Tally;
use super::split::{Part, Parted};
use super::strip::{SPACING, Strip, closest, samples};

/// The line keeps its vertices where it turns by more.
const CORNER: f64 = 0.6;

/// Corners that stay are at least this far apart, in edge lengths.
const APART: f64 = 0.3;

/// Vertices nearer to the line than this, in edge lengths, are taken out where the surface allows it.
const BESIDE: f64 = 0.45;

/// Angles below this are worked on.
const SMALL: f64 = 0.42;

/// Rounds of collapsing, flipping and splitting.
const ROUNDS: usize = 8;

pub(super) fn even_out(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    parted: &mut Parted,
    length: f64,
    tally: &mut Tally,
) {
    let parts = gather(vertices, faces, parted);
    let old = std::mem::take(&mut parted.parts);
    let own = old.iter().map(|p| p.face).collect::<FxHashSet<_>>();
    let mut strip = Strip::new(vertices, parted, parts, length);
    let kept = resample(&mut strip, length);
    for round in 0..ROUNDS {
        let mut changes = thin_out(&mut strip, &kept);
        changes += clear_beside(&mut strip, BESIDE * length);
        changes += thin_out(&mut strip, &kept);
        changes += improve(&mut strip, &kept, length, round);
        if changes == 0 {
            break;
        }
    }
    let Strip { parts, altered, .. } = strip;
    let parts = parts.into_iter().flatten().collect::<Vec<_>>();
    tally.report.defect = defect(vertices, faces, parted, &parts, &altered, SPACING * length);
    for &f in &altered {
        parted.divided[f as usize] = true;
    }
    parted.parts =
        parts.into_iter().filter(|p| parted.divided[p.face as usize] || own.contains(&p.face)).collect();
}

/// Triangles of the faces that the cut meets, and of those around them.
fn gather(vertices: &[DVec3], faces: Polygons<'_>, parted: &Parted) -> Vec<Part> {
    let mut near = parted.on_cut();
    near.truncate(parted.n_old);
    for v in parted.parts.iter().flat_map(|p| p.corners) {
        if let Some(near) = near.get_mut(v as usize) {
            *near = true;
        }
    }
    let mut parts = parted.parts.clone();
    // Two rings.
    let mut wider = near.clone();
    for f in (0..faces.len()).filter(|&f| !parted.divided[f]) {
        let corners = faces.face(f);
        if corners.iter().any(|&v| near[v as usize]) {
            corners.iter().for_each(|&v| wider[v as usize] = true);
        }
    }
    for f in (0..faces.len()).filter(|&f| !parted.divided[f]) {
        let corners = faces.face(f);
        if corners.iter().any(|&v| wider[v as usize]) {
            triangles(vertices, corners, |t| {
                parts.push(Part { corners: t, face: f as u32, home: t, left: parted.left[f] });
            });
        }
    }
    parts
}

/// A stretch of the line between two vertices that stay, or all around.
struct Stretch {
    nodes: Vec<u32>,
    /// The last vertex is the first one.
    around: bool,
}

/// Puts vertices on the line at even distances; returns those that stay.
fn resample(strip: &mut Strip<'_>, length: f64) -> FxHashSet<u32> {
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
                next = Some((k, m, t));
            }
        }
    }
    kept
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
        let uneven = ((to.0 - from.0) / step).max(1e-6).ln();
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

/// Collapses vertices of the line that do not stay into those beside them.
fn thin_out(strip: &mut Strip<'_>, kept: &FxHashSet<u32>) -> usize {
    let mut on = strip.parted.cut.keys().flat_map(|&(a, b)| [a, b]).collect::<Vec<_>>();
    on.sort_unstable();
    on.dedup();
    let mut changes = 0;
    for u in on.into_iter().filter(|v| !kept.contains(v)) {
        let mut beside = strip.on_line(u).to_vec();
        let p = strip.position(u);
        beside.sort_by(|&a, &b| {
            let near = |v: u32| strip.position(v).distance_squared(p);
            near(a).total_cmp(&near(b))
        });
        if beside.into_iter().any(|v| strip.collapse(u, v, 0.0)) {
            changes += 1;
        }
    }
    changes
}

/// Collapses vertices that lie close to the line into it.
fn clear_beside(strip: &mut Strip<'_>, distance: f64) -> usize {
    let mut near: BTreeSet<u32> = BTreeSet::new();
    for &(a, b) in strip.parted.cut.keys() {
        let (p, q) = (strip.position(a), strip.position(b));
        for v in [a, b] {
            let corners = strip.triangles_at(v).iter().filter_map(|&t| strip.part(t)).flat_map(|t| t.corners);
            near.extend(corners.filter(|&x| {
                strip.on_line(x).is_empty() && closest(strip.position(x), [p, q, q]).0 < distance
            }));
        }
    }
    let mut changes = 0;
    for x in near {
        let p = strip.position(x);
        let own = strip.triangles_at(x).iter().filter_map(|&t| strip.part(t)).flat_map(|t| t.corners);
        let mut line = own.filter(|&v| !strip.on_line(v).is_empty()).collect::<Vec<_>>();
        line.sort_by(|&a, &b| {
            let far = |v: u32| strip.position(v).distance_squared(p);
            far(a).total_cmp(&far(b)).then(a.cmp(&b))
        });
        line.dedup();
        changes += usize::from(line.into_iter().any(|v| strip.collapse(x, v, 0.0)));
    }
    changes
}

/// One round of edits to triangles with small angles.
fn improve(strip: &mut Strip<'_>, kept: &FxHashSet<u32>, length: f64, round: usize) -> usize {
    let mut changes = 0;
    // Near the line: its triangles, and those that were made.
    let touches = |strip: &Strip<'_>, part: &Part| {
        part.corners.iter().any(|&v| v as usize >= strip.parted.n_old || !strip.on_line(v).is_empty())
    };
    let fresh = std::mem::take(&mut strip.fresh);
    let looked_at: BTreeSet<u32> = if round == 0 {
        (0..strip.parts.len() as u32).collect()
    } else {
        // Only what has changed, and what is next to it.
        let corners = fresh.iter().filter_map(|&t| strip.part(t)).flat_map(|p| p.corners);
        corners.flat_map(|v| strip.triangles_at(v)).copied().collect()
    };
    let is_sharp =
        |t: &u32| strip.part(*t).is_some_and(|p| touches(strip, p) && strip.min_angle(p.corners) < SMALL);
    let mut queue: BTreeSet<u32> = looked_at.into_iter().filter(is_sharp).collect();
    let mut budget = 8 * queue.len() + 64;
    while let Some(t) = queue.pop_first() {
        if budget == 0 {
            break;
        }
        budget -= 1;
        let Some(part) = strip.part(t).copied() else { continue };
        let least = strip.min_angle(part.corners);
        if least >= SMALL {
            continue;
        }
        let mut edges = [0, 1, 2].map(|k| {
            let (a, b) = (part.corners[k], part.corners[(k + 1) % 3]);
            (strip.position(a).distance(strip.position(b)), a, b)
        });
        edges.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut done = edges.iter().any(|&(_, a, b)| strip.flip(a, b));
        if !done {
            // The shortest edge goes, if that leaves better angles than there were.
            let (short, a, b) = edges[2];
            done = short < 0.75 * length
                && [(a, b), (b, a)].into_iter().any(|(u, v)| {
                    if kept.contains(&u) {
                        return false;
                    }
                    let worst = strip.triangles_at(u).iter().filter_map(|&t| strip.part(t));
                    let worst = worst.map(|p| strip.min_angle(p.corners)).fold(f64::INFINITY, f64::min);
                    strip.collapse(u, v, worst.max(1e-3) * 1.05)
                });
        }
        if !done && round + 2 < ROUNDS {
            // The longest edge is halved if it is much longer than the others should be.
            let (long, a, b) = edges[0];
            if long > 1.6 * length
                && long > 1.6 * edges[2].0
                && !strip.parted.cut.contains_key(&(a.min(b), a.max(b)))
                && let Some(m) = strip.split(a, b, 0.5)
            {
                done = true;
                queue.extend(strip.triangles_at(m));
            }
        }
        if done {
            changes += 1;
            for v in part.corners {
                let own = strip.triangles_at(v).iter().copied();
                queue.extend(own.filter(|&t| strip.part(t).is_some_and(|p| touches(strip, p))));
            }
        }
    }
    let new = (strip.parted.n_old..strip.parted.n_old + strip.parted.nodes.len()).map(|v| v as u32);
    for v in new.collect::<Vec<_>>() {
        if !strip.triangles_at(v).is_empty() {
            changes += usize::from(strip.centre(v));
        }
    }
    changes
}

/// Largest distance of the changed triangles from the old surface.
fn defect(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    parted: &Parted,
    parts: &[Part],
    altered: &FxHashSet<u32>,
    spacing: f64,
) -> f64 {
    let mut old = vec![];
    let mut known = FxHashSet::default();
    for f in parts.iter().map(|p| p.face) {
        if known.insert(f) {
            triangles(vertices, faces.face(f as usize), |t| old.push(Facet(t.map(|v| vertices[v as usize]))));
        }
    }
    for &f in altered {
        if known.insert(f) {
            triangles(vertices, faces.face(f as usize), |t| old.push(Facet(t.map(|v| vertices[v as usize]))));
        }
    }
    let tree = RTree::bulk_load(old);
    let mut most = 0.0f64;
    for part in parts.iter().filter(|p| altered.contains(&p.face)) {
        let home = part.home.map(|v| vertices[v as usize]);
        for p in samples(part.corners.map(|v| parted.position(vertices, v)), spacing) {
            // Most are near the triangle that they come from.
            if closest(p, home).0 > most {
                most = most.max(tree.nearest_neighbor(&p.to_array()).map_or(0.0, |f| closest(p, f.0).0));
            }
        }
    }
    most
}

/// An old triangle.
struct Facet([DVec3; 3]);

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let [a, b, c] = self.0;
        AABB::from_corners(a.min(b).min(c).to_array(), a.max(b).max(c).to_array())
    }
}

impl PointDistance for Facet {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let off = closest(DVec3::from_array(*point), self.0).0;
        off * off
    }
}
