//! Divides the faces that the line meets.
//!
//! The line runs through a triangle in chains from edge to edge. Which of its crossings belong together follows from
//! exact answers alone: a segment and a triangle are convex, so they meet in one stretch, and between two
//! segments the line is inside or it is not.

use glam::{DVec2, DVec3};
use rustc_hash::{FxHashMap, FxHashSet};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::cross::{Crossed, Node};
use super::input::Polygons;
use super::locate::{Locator, Met};
use super::sheet::{Sheet, side_of_edge};
use crate::error::{Error, Result};

/// How far vertices that the cut is drawn through may be off the swept surface, in diameters of their line.
const SEAM: f64 = 0.018;

/// A part of a triangle has at least this part of the square over its longest edge as its area, twice.
const AREA: f64 = 1e-9;

/// What counts as one point, in edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerance {
    /// Between the cut and a vertex.
    pub vertex: f64,
    /// Between crossings, and between the stroke's points and crossings.
    pub node: f64,
    /// Between the cut and a vertex, in units of the mesh.
    pub length: f64,
}

/// A part of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub corners: [u32; 3],
    pub face: u32,
    /// The old triangle that it is a part of.
    pub home: [u32; 3],
    pub left: bool,
}

/// A mesh with its faces divided along the cut, both sides still together.
pub(super) struct Parted {
    /// Number of old vertices; new ones follow.
    pub n_old: usize,
    pub nodes: Vec<Node>,
    /// Of every face: on the left. Means nothing for those that are divided.
    pub left: Vec<bool>,
    /// Of every face: replaced by parts.
    pub divided: Vec<bool>,
    pub parts: Vec<Part>,
    /// Edges of the cut, lower vertex first, with the places of its ends on the unrolled line; on a closed line,
    /// one of the two may be off by a turn, their difference is right.
    pub cut: FxHashMap<(u32, u32), [f64; 2]>,
    pub cut_faces: usize,
}

impl Parted {
    pub fn position(&self, vertices: &[DVec3], v: u32) -> DVec3 {
        match (v as usize).checked_sub(self.n_old) {
            Some(k) => self.nodes[k].position,
            None => vertices[v as usize],
        }
    }

    /// Old vertices in which the cut touches itself.
    pub fn touching(&self) -> Vec<u32> {
        let mut ends = FxHashMap::<u32, u32>::default();
        for v in self.cut.keys().flat_map(|&(a, b)| [a, b]).filter(|&v| (v as usize) < self.n_old) {
            *ends.entry(v).or_default() += 1;
        }
        let mut found = ends.into_iter().filter(|e| e.1 > 2).map(|e| e.0).collect::<Vec<_>>();
        found.sort_unstable();
        found
    }

    /// Old vertices that the cut was drawn through, farther from the swept surface than suits their line's size.
    pub fn far(&self, vertices: &[DVec3], sheet: &Sheet, locator: &Locator<'_>, reach: f64) -> Vec<u32> {
        let mut line_of: FxHashMap<u32, u32> = FxHashMap::default();
        let mut edges = self.cut.keys().copied().collect::<Vec<_>>();
        edges.sort_unstable();
        fn root(line_of: &mut FxHashMap<u32, u32>, mut v: u32) -> u32 {
            while let Some(&next) = line_of.get(&v).filter(|&&next| next != v) {
                let onward = line_of.get(&next).copied().unwrap_or(next);
                line_of.insert(v, onward);
                v = onward;
            }
            v
        }
        for &(a, b) in &edges {
            let (a, b) = (root(&mut line_of, a), root(&mut line_of, b));
            line_of.insert(a.max(b), a.min(b));
        }
        let mut boxes: FxHashMap<u32, [DVec3; 2]> = FxHashMap::default();
        for v in edges.iter().flat_map(|&(a, b)| [a, b]) {
            let p = self.position(vertices, v);
            let around = boxes.entry(root(&mut line_of, v)).or_insert([p, p]);
            *around = [around[0].min(p), around[1].max(p)];
        }
        let mut own =
            edges.iter().flat_map(|&(a, b)| [a, b]).filter(|&v| (v as usize) < self.n_old).collect::<Vec<_>>();
        own.sort_unstable();
        own.dedup();
        own.retain(|&v| {
            let [low, high] = boxes.get(&root(&mut line_of, v)).copied().unwrap_or_default();
            let allowed = SEAM * low.distance(high);
            let depth = sheet.view.depth(vertices[v as usize]);
            allowed < reach && depth * locator.distance(sheet.seen[v as usize], reach / depth) > allowed
        });
        own
    }

    /// Of every vertex: an end of an edge of the cut.
    pub fn on_cut(&self) -> Vec<bool> {
        let mut on = vec![false; self.n_old + self.nodes.len()];
        for &(a, b) in self.cut.keys() {
            on[a as usize] = true;
            on[b as usize] = true;
        }
        on
    }

    /// The new vertex of this number, or an old one, as a combination of old ones.
    pub fn source(&self, vertices: &[DVec3], v: u32) -> Node {
        match (v as usize).checked_sub(self.n_old) {
            Some(k) => self.nodes[k],
            None => Node { position: vertices[v as usize], source: [v; 3], weights: [1.0, 0.0, 0.0] },
        }
    }
}

/// A chain's edge: both ends with their places, counted once for each time the line runs along it.
type Chains = Vec<([u32; 2], [f64; 2], bool)>;

/// Divides all faces that the line meets. With an error comes the triangle that stood in the way.
pub(super) fn split(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    sheet: &Sheet,
    met: &Met,
    crossed: Crossed<'_>,
    tolerance: Tolerance,
) -> Result<Parted, (Error, Option<[u32; 3]>)> {
    let Crossed { triangles, edges, hits, nodes } = crossed;
    let mut divider = Divider {
        vertices,
        sheet,
        met,
        edges: &edges,
        hits: &hits,
        nodes,
        tolerance,
        parts: vec![],
        cut: FxHashMap::default(),
    };
    let mut left: Vec<bool> = (0..faces.len()).map(|f| met.left[faces.face(f)[0] as usize]).collect();
    let mut divided = vec![false; faces.len()];
    let mut cut_faces = 0;
    let mut at = 0;
    while at < triangles.len() {
        let face = triangles[at].1;
        let end = at + triangles[at..].iter().take_while(|t| t.1 == face).count();
        let first = divider.parts.len();
        for &(corners, face) in &triangles[at..end] {
            divider.triangle(corners, face).map_err(|error| (error, Some(corners)))?;
        }
        at = end;
        let new = &divider.parts[first..];
        let whole = new.len() + 2 == faces.face(face as usize).len()
            && new.iter().all(|p| p.left == new[0].left)
            && new.iter().flat_map(|p| p.corners).all(|v| (v as usize) < vertices.len());
        if whole {
            left[face as usize] = new[0].left;
            divider.parts.truncate(first);
        } else {
            divided[face as usize] = true;
            cut_faces += 1;
        }
    }
    let Divider { nodes, parts, cut, .. } = divider;
    let parted = Parted { n_old: vertices.len(), nodes, left, divided, parts, cut, cut_faces };
    let has = |side: bool| {
        parted.parts.iter().any(|p| p.left == side)
            || parted.left.iter().zip(&parted.divided).any(|(&l, &d)| !d && l == side)
    };
    if !has(true) || !has(false) {
        return Err((Error::StrokeMisses, None));
    }
    Ok(parted)
}

struct Divider<'a> {
    vertices: &'a [DVec3],
    sheet: &'a Sheet,
    met: &'a Met,
    edges: &'a FxHashMap<(u32, u32), u32>,
    hits: &'a [Vec<super::cross::Hit>],
    nodes: Vec<Node>,
    tolerance: Tolerance,
    parts: Vec<Part>,
    cut: FxHashMap<(u32, u32), [f64; 2]>,
}

/// A point of a chain.
#[derive(Clone, Copy)]
struct Stop {
    node: u32,
    place: f64,
}

impl Divider<'_> {
    fn hits(&self, a: u32, b: u32) -> &[super::cross::Hit] {
        self.edges.get(&(a.min(b), a.max(b))).map_or(&[], |&k| &self.hits[k as usize])
    }

    fn position(&self, v: u32) -> DVec3 {
        match (v as usize).checked_sub(self.vertices.len()) {
            Some(k) => self.nodes[k].position,
            None => self.vertices[v as usize],
        }
    }

    fn failed(&self, corners: [u32; 3], reason: &'static str) -> Error {
        let at = corners.iter().map(|&v| self.vertices[v as usize]).sum::<DVec3>() / 3.0;
        Error::CutFailed { reason, at: at.into() }
    }

    /// Divides one triangle.
    fn triangle(&mut self, corners: [u32; 3], face: u32) -> Result<()> {
        // The boundary: vertices in order, each followed by the side of the stretch after it.
        let mut ring: Vec<(u32, bool)> = vec![];
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let hits = self.hits(a, b);
            let mut side = self.met.left[a as usize];
            let mut at = a;
            let mut pass = |node: u32| {
                if node != at {
                    ring.push((at, side));
                    at = node;
                }
                side = !side;
            };
            if a < b {
                hits.iter().for_each(|h| pass(h.node));
            } else {
                hits.iter().rev().for_each(|h| pass(h.node));
            }
            if at != b {
                ring.push((at, side));
            }
            if side != self.met.left[b as usize] {
                return Err(self.failed(corners, "an edge has its ends on the wrong sides"));
            }
        }
        let chains = self.chains(corners)?;
        if ring.len() == 3 && chains.iter().all(|c| c.0.iter().all(|v| corners.contains(v))) {
            // Whole: at most the line runs along its edges.
            let flips = |a: u32, b: u32| chains.iter().any(|c| c.2 && (c.0 == [a, b] || c.0 == [b, a]));
            let sides = [0, 1, 2].map(|k| ring[k].1 != flips(ring[k].0, ring[(k + 1) % 3].0));
            if sides[0] != sides[1] || sides[1] != sides[2] {
                return Err(self.failed(corners, "a face is on both sides"));
            }
            self.parts.push(Part { corners, face, home: corners, left: sides[0] });
        } else {
            self.divide(corners, face, &ring, &chains)?;
        }
        for ([a, b], [x, y], odd) in chains {
            if odd {
                // On closed lines the short way.
                let width = self.sheet.width();
                let y = if self.sheet.closed { y + width * ((x - y) / width).round() } else { y };
                self.cut.insert((a.min(b), a.max(b)), if a < b { [x, y] } else { [y, x] });
            }
        }
        Ok(())
    }

    /// The line within a triangle.
    fn chains(&mut self, corners: [u32; 3]) -> Result<Chains> {
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
            if self.sheet.closed && self.is_inside(corners, 0) {
                let n = self.sheet.n_segments();
                let stops = (0..n).map(|k| self.inner(corners, k)).collect::<Option<Vec<_>>>();
                let Some(mut stops) = stops else { return Ok(chains) };
                stops.push(stops[0]);
                add_chain(&mut chains, &stops);
            }
            return Ok(chains);
        }
        // Begin where the line is outside: at a segment with two crossings, or after one that leaves.
        let is_alone = |k: usize| {
            let same = |j: usize| events[j].0 == events[k].0;
            !((k > 0 && same(k - 1)) || (k + 1 < events.len() && same(k + 1)))
        };
        let start = (0..events.len())
            .find(|&k| {
                let first_of_pair = k + 1 < events.len() && events[k].0 == events[k + 1].0;
                first_of_pair || (is_alone(k) && !self.is_inside(corners, events[k].0 as usize))
            })
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

    /// True if the stroke's point `k` is in the triangle.
    fn is_inside(&self, corners: [u32; 3], k: usize) -> bool {
        let [a, b, c] = corners.map(|v| self.sheet.seen[v as usize]);
        if a == b || b == c || c == a {
            return false;
        }
        let p = self.sheet.point(k);
        let left = side_of_edge(a, b, p) > 0.0;
        (side_of_edge(b, c, p) > 0.0) == left && (side_of_edge(c, a, p) > 0.0) == left
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

    /// Divides a triangle with a boundary `ring` along `chains`.
    fn divide(&mut self, corners: [u32; 3], face: u32, ring: &[(u32, bool)], chains: &Chains) -> Result<()> {
        let [x, y, z] = corners.map(|v| self.vertices[v as usize]);
        let u = (y - x).normalize_or(DVec3::X);
        let normal = (y - x).cross(z - x);
        let v = normal.cross(u).normalize_or_zero();
        let size = x.distance(y).max(y.distance(z)).max(z.distance(x));
        let flat = |p: DVec3| DVec2::new((p - x).dot(u), (p - x).dot(v)) / size;
        let centre = flat((x + y + z) / 3.0);
        let failed = |reason| self.failed(corners, reason);

        // Points on an edge are drawn in by next to nothing, lest rounding make triangles of three of them.
        const BEND: f64 = 1e-9;
        let mut points: Vec<(u32, DVec2)> = vec![];
        let mut side = 0;
        for &(node, _) in ring {
            let p = flat(self.position(node));
            if let Some(k) = corners.iter().position(|&c| c == node) {
                side = k;
                points.push((node, p));
                continue;
            }
            let [a, b] = [side, (side + 1) % 3].map(|k| flat(self.vertices[corners[k] as usize]));
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let foot = a.lerp(b, t);
            points.push((node, foot + 4.0 * t * (1.0 - t) * BEND * (centre - foot).normalize_or_zero()));
        }
        let known = points.iter().map(|p| p.0).collect::<FxHashSet<_>>();
        let mut inner = chains.iter().flat_map(|c| c.0).filter(|v| !known.contains(v)).collect::<Vec<_>>();
        inner.sort_unstable();
        inner.dedup();
        points.extend(inner.into_iter().map(|node| (node, flat(self.position(node)))));

        let mut mesh: ConstrainedDelaunayTriangulation<Point2<f64>> = ConstrainedDelaunayTriangulation::new();
        let mut number: Vec<u32> = vec![];
        let mut handles = FxHashMap::default();
        for (node, p) in points {
            let handle = mesh.insert(Point2::new(p.x, p.y)).map_err(|_| failed("a face has no area"))?;
            if handle.index() < number.len() {
                return Err(failed("two points of the cut coincide"));
            }
            number.push(node);
            handles.insert(node, handle);
        }
        let mut odd = FxHashSet::default();
        let edges = (0..ring.len()).map(|k| ([ring[k].0, ring[(k + 1) % ring.len()].0], false));
        let all = edges.chain(chains.iter().map(|c| (c.0, c.2)));
        for (ends, is_odd) in all {
            let [a, b] = ends.map(|v| handles.get(&v).copied());
            let (Some(a), Some(b)) = (a, b) else { return Err(failed("a point of the cut is missing")) };
            if mesh.get_edge_from_neighbors(a, b).is_none_or(|e| !e.is_constraint_edge())
                && (mesh.try_add_constraint(a, b).is_empty() || mesh.get_edge_from_neighbors(a, b).is_none())
            {
                return Err(failed("stretches of the cut meet where they should not"));
            }
            if is_odd {
                odd.insert((ends[0].min(ends[1]), ends[0].max(ends[1])));
            }
        }
        // Flood from the boundary.
        let is_odd = |a: u32, b: u32| odd.contains(&(a.min(b), a.max(b)));
        let mut sides: Vec<Option<bool>> = vec![None; mesh.num_all_faces()];
        let mut stack = vec![];
        for (k, &(node, left)) in ring.iter().enumerate() {
            let next = ring[(k + 1) % ring.len()].0;
            let edge = mesh.get_edge_from_neighbors(handles[&node], handles[&next]);
            let Some(edge) = edge else { return Err(failed("an edge of a face is missing")) };
            stack.push((edge.face().fix(), left != is_odd(node, next)));
        }
        let border =
            (0..ring.len()).map(|k| (ring[k].0, ring[(k + 1) % ring.len()].0)).collect::<FxHashSet<_>>();
        let mut new = vec![];
        while let Some((face_handle, left)) = stack.pop() {
            match sides[face_handle.index()] {
                Some(known) if known == left => continue,
                Some(_) => return Err(failed("the cut does not divide a face")),
                None => sides[face_handle.index()] = Some(left),
            }
            let Some(inner) = mesh.face(face_handle).as_inner() else {
                return Err(failed("a face is turned over"));
            };
            for edge in inner.adjacent_edges() {
                let (a, b) = (number[edge.from().index()], number[edge.to().index()]);
                if !border.contains(&(a, b)) {
                    stack.push((edge.rev().face().fix(), left != is_odd(a, b)));
                }
            }
            let own = inner.vertices().map(|v| number[v.index()]);
            let [p, q, r] = own.map(|v| self.position(v));
            let longest = p.distance_squared(q).max(q.distance_squared(r)).max(r.distance_squared(p));
            if self.tolerance.length > 0.0 && (q - p).cross(r - p).length() <= AREA * longest {
                return Err(failed("a part of a face has no area"));
            }
            new.push(Part { corners: own, face, home: corners, left });
        }
        self.parts.extend(new);
        Ok(())
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
