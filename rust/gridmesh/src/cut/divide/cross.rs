//! Where the line meets the edges of the mesh: once for each edge, for all its faces.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::locate::{Locator, Met};
use crate::cut::divide::node::{Node, Tolerance};
use crate::cut::input::{Polygons, triangles};
use crate::cut::sheet::{Sheet, side_of_edge};

/// Where the line crosses an edge.
#[derive(Clone, Copy, Debug)]
pub(in crate::cut) struct Hit {
    /// Share of the edge, from its lower numbered vertex.
    pub t: f64,
    /// Segment of the line, and the share of it.
    pub segment: u32,
    pub s: f64,
    /// The vertex that it becomes: one of the edge's own, or a new one.
    pub node: u32,
}

/// Crossings of all edges near the line.
pub(in crate::cut) struct Edges {
    /// Triangles of the faces near the line, with their faces.
    pub triangles: Vec<([u32; 3], u32)>,
    /// Edges that are crossed, lower vertex first, ascending.
    pub keys: Vec<(u32, u32)>,
    /// Crossings of each, along it.
    pub hits: Vec<Vec<Hit>>,
}

/// All crossings, as vertices.
pub(in crate::cut) struct Crossed<'a> {
    pub triangles: &'a [([u32; 3], u32)],
    /// For each edge that is crossed, lower vertex first, its place in `hits`.
    pub edges: FxHashMap<(u32, u32), u32>,
    /// Crossings of each edge along it.
    pub hits: Vec<Vec<Hit>>,
    /// New vertices, numbered from that of the old ones on.
    pub nodes: Vec<Node>,
}

/// The part of the reach at which any vertex takes a crossing.
const SLIGHT: f64 = 0.1;

pub(in crate::cut) fn cross(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    sheet: &Sheet,
    locator: &Locator<'_>,
    met: &Met,
) -> Edges {
    let mut parts = Vec::with_capacity(met.faces.len());
    for &f in &met.faces {
        triangles(vertices, faces.face(f as usize), |t| parts.push((t, f)));
    }
    let mut keys = Vec::with_capacity(3 * parts.len());
    for (t, _) in &parts {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            keys.push((a.min(b), a.max(b)));
        }
    }
    keys.sort_unstable();
    keys.dedup();
    let found: Vec<Vec<Hit>> = keys
        .par_iter()
        .with_min_len(64)
        .map_init(Vec::new, |near, &(a, b)| edge_hits(vertices, sheet, locator, a, b, near))
        .collect();
    let (keys, hits) = keys.into_iter().zip(found).filter(|(_, hits)| !hits.is_empty()).unzip();
    Edges { triangles: parts, keys, hits }
}

impl Crossed<'_> {
    /// The vertices that the crossings become, edge by edge: what is divided follows from these.
    pub fn names(&self) -> Vec<u32> {
        self.hits.iter().flatten().map(|hit| hit.node).collect()
    }
}

impl Edges {
    /// Makes vertices of the crossings: those near an end of their edge become that end, from farther away if it
    /// is `wanted`, unless it is `released`.
    pub fn named(
        &self,
        vertices: &[DVec3],
        tolerance: Tolerance,
        wanted: &FxHashSet<u32>,
        released: &FxHashSet<u32>,
    ) -> Crossed<'_> {
        let mut crossed = Crossed {
            triangles: &self.triangles,
            edges: FxHashMap::default(),
            hits: self.hits.clone(),
            nodes: vec![],
        };
        for (k, (&(a, b), hits)) in self.keys.iter().zip(&mut crossed.hits).enumerate() {
            crossed.edges.insert((a, b), k as u32);
            let length = vertices[a as usize].distance(vertices[b as usize]);
            let [near_a, near_b] = [a, b].map(|v| {
                let reach = match v {
                    v if released.contains(&v) => 0.0,
                    v if wanted.contains(&v) => tolerance.length,
                    _ => SLIGHT * tolerance.length,
                };
                (reach / length.max(f64::MIN_POSITIVE)).min(0.45).max(tolerance.vertex)
            });
            let mut last: Option<(f64, u32)> = None;
            for hit in hits {
                hit.node = if hit.t <= near_a {
                    a
                } else if hit.t >= 1.0 - near_b {
                    b
                } else if let Some((_, node)) = last.filter(|l| hit.t - l.0 <= tolerance.node) {
                    node
                } else {
                    let node = (vertices.len() + crossed.nodes.len()) as u32;
                    crossed.nodes.push(Node::between(vertices, a, b, hit.t));
                    last = Some((hit.t, node));
                    node
                };
            }
        }
        crossed
    }
}

/// Crossings with the edge from `a` to `b`, along it.
fn edge_hits(
    vertices: &[DVec3],
    sheet: &Sheet,
    locator: &Locator<'_>,
    a: u32,
    b: u32,
    near: &mut Vec<u32>,
) -> Vec<Hit> {
    let (p, q) = (sheet.seen[a as usize], sheet.seen[b as usize]);
    let mut hits = vec![];
    if p == q {
        return hits;
    }
    locator.near(p.min(q), p.max(q), near);
    let [depth_a, depth_b] = [a, b].map(|v| sheet.view.depth(vertices[v as usize]));
    for &k in near.iter() {
        let (u, v) = (sheet.side_of_segment(k as usize, p), sheet.side_of_segment(k as usize, q));
        if (u > 0.0) == (v > 0.0) {
            continue;
        }
        let [from, to] = sheet.segment(k as usize);
        let (x, y) = (side_of_edge(p, q, from), side_of_edge(p, q, to));
        if (x > 0.0) == (y > 0.0) {
            continue;
        }
        let (along, s) = shares(p, q, from, to);
        // Seen from an eye, the nearer half of an edge looks longer.
        let t = along * depth_a / (depth_b * (1.0 - along) + depth_a * along);
        hits.push(Hit { t: t.clamp(0.0, 1.0), segment: k, s, node: u32::MAX });
    }
    hits.sort_by(|x, y| x.t.total_cmp(&y.t).then(x.segment.cmp(&y.segment)));
    hits
}

/// Shares of the segments `p q` and `from to` at which they cross.
fn shares(p: glam::DVec2, q: glam::DVec2, from: glam::DVec2, to: glam::DVec2) -> (f64, f64) {
    let (edge, line) = (q - p, to - from);
    let cross = edge.perp_dot(line);
    if cross != 0.0 {
        let t = (from - p).perp_dot(line) / cross;
        let s = (from - p).perp_dot(edge) / cross;
        if t.is_finite() && s.is_finite() {
            return (t.clamp(0.0, 1.0), s.clamp(0.0, 1.0));
        }
    }
    // On one line: the middle of what they share.
    let along = |x: glam::DVec2| ((x - p).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
    let t = 0.5 * (along(from) + along(to));
    let s = ((p + t * edge - from).dot(line) / line.length_squared()).clamp(0.0, 1.0);
    (t, s)
}
