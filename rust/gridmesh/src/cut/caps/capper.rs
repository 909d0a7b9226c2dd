//! What caps are made with, and what they are.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use rustc_hash::FxHashSet;

use crate::cut::caps::regions::Spot;
use crate::cut::caps::sources;
use crate::cut::cutting::Cutting;
use crate::cut::divide::node::Node;
use crate::cut::divide::parted::Parted;
use crate::cut::options::Keep;
use crate::cut::report::Tally;
use crate::cut::sheet::Sheet;
use crate::cut::sheet::roll::Roll;
use crate::error::{Error, Result};
use crate::fill::planar::flat::{FlatFill, FlatOptions, fill_flat};
use crate::progress::Progress;

/// What closes the pieces.
#[derive(Default)]
pub(in crate::cut) struct Caps {
    /// New vertices, numbered after those of the divided mesh.
    pub vertices: Vec<Node>,
    /// As the right piece needs them.
    pub triangles: Vec<[u32; 3]>,
}

pub(in crate::cut) struct Capper<'a> {
    pub cutting: Cutting<'a>,
    pub parted: &'a Parted,
    pub(crate) sheet: &'a Sheet,
    /// Edges between vertices of the cut that are there already, and triangles.
    pub edges: FxHashSet<(u32, u32)>,
    pub(crate) facets: FxHashSet<[u32; 3]>,
    /// Number of the first new vertex.
    pub first: u32,
    pub caps: Caps,
    /// Edges of the caps along planes of symmetry.
    pub(crate) seams: FxHashSet<(u32, u32)>,
}

/// An edge, its lower vertex first.
pub(in crate::cut) fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Capper<'_> {
    /// Notes which edges and triangles between vertices of the cut exist.
    pub(crate) fn reserve(&mut self) {
        let on_cut = self.parted.on_cut();
        let mut note = |corners: &[u32]| {
            let n = corners.len();
            let on = corners.iter().filter(|&&v| on_cut[v as usize]).count();
            if on < 2 {
                return;
            }
            for k in 0..n {
                let (a, b) = (corners[k], corners[(k + 1) % n]);
                if on_cut[a as usize] && on_cut[b as usize] {
                    self.edges.insert((a.min(b), a.max(b)));
                }
            }
            if let [a, b, c] = *corners
                && on == 3
            {
                let mut facet = [a, b, c];
                facet.sort_unstable();
                self.facets.insert(facet);
            }
        };
        // Of a piece that is not kept nothing can be repeated.
        let is_kept = |left: bool| self.cutting.options.keep.has(if left { Keep::Left } else { Keep::Right });
        for part in self.parted.parts.iter().filter(|part| is_kept(part.left)) {
            note(&part.corners);
        }
        let whole = (0..self.cutting.faces.len()).filter(|&f| !self.parted.divided[f]);
        for f in whole.filter(|&f| is_kept(self.parted.left[f])) {
            note(self.cutting.faces.face(f));
        }
    }

    /// A vertex of the sheet; its source follows.
    pub(crate) fn node(&self, at: DVec2) -> Node {
        Node { position: self.sheet.lift(at.x, at.y), source: [u32::MAX; 3], weights: [1.0, 0.0, 0.0] }
    }

    /// Fills a polygon of the unrolled sheet.
    pub(crate) fn plan(&self, polygon: &[Spot], progress: Progress<'_>) -> Result<FlatFill> {
        let n = polygon.len();
        let roll = Roll::new(self.sheet, polygon);
        let flat = polygon.iter().map(|s| roll.flatten(s.at)).collect::<Vec<_>>();
        let taken = |i: usize, j: usize| self.edges.contains(&key(polygon[i].node, polygon[j].node));
        let mut single = true;
        if let [a, b, c] = polygon {
            let mut facet = [a.node, b.node, c.node];
            facet.sort_unstable();
            single = !self.facets.contains(&facet);
        }
        let mut options = FlatOptions { single, ..FlatOptions::default() };
        if n > LARGE {
            (options.angles, options.placed) = (3, 1);
            // Graded patches take longer than all else, and are hardly better.
            options.enough = ENOUGH;
            options.thin = true;
        }
        fill_flat(&flat, &vec![4; n], &taken, &options, progress)
    }

    /// True if a patch has an edge across its polygon that exists by now.
    pub(crate) fn repeats(&self, polygon: &[Spot], patch: &FlatFill) -> bool {
        let n = polygon.len();
        patch.triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]).any(|[a, b]| {
            let (i, j) = (a.min(b) as usize, a.max(b) as usize);
            let (Some(p), Some(q)) = (polygon.get(i), polygon.get(j)) else { return false };
            j - i > 1 && j - i < n - 1 && self.edges.contains(&(p.node.min(q.node), p.node.max(q.node)))
        })
    }

    /// Makes vertices and triangles of a patch.
    pub(crate) fn roll_up(
        &mut self,
        polygon: &[Spot],
        patch: &FlatFill,
        inverted: bool,
        progress: Progress<'_>,
    ) -> Result<()> {
        progress.report(1.0)?;
        let n = polygon.len();
        let roll = Roll::new(self.sheet, polygon);
        let base = self.first + self.caps.vertices.len() as u32;
        let name = |v: u32| polygon.get(v as usize).map_or_else(|| base + (v - n as u32), |s| s.node);
        let mut flat = polygon.iter().map(|s| roll.flatten(s.at)).collect::<Vec<_>>();
        flat.extend(&patch.interior);
        let near = sources::nearest_on_rim(n, &flat, &patch.triangles);
        progress.report(1.0)?;
        for (&p, near) in patch.interior.iter().zip(near) {
            let mut node = self.node(roll.unflatten(p));
            let from = self.source(polygon[near as usize].node);
            (node.source, node.weights) = (from.source, from.weights);
            self.caps.vertices.push(node);
        }
        for t in &patch.triangles {
            let mut t = t.map(name);
            if inverted {
                t.swap(1, 2);
            }
            self.push(t, base);
        }
        progress.report(1.0)
    }

    /// The vertex of this number as a combination of old ones.
    pub(crate) fn source(&self, v: u32) -> Node {
        match v.checked_sub(self.first) {
            Some(k) => self.caps.vertices[k as usize],
            None => self.parted.source(self.cutting.vertices, v),
        }
    }

    /// Gives vertices of bridges, and those next to them, the sources of the nearest vertices of the cut.
    pub(crate) fn name_sources(&mut self, polygons: &[Vec<Spot>]) {
        if self.caps.vertices.iter().all(|node| node.source[0] != u32::MAX) {
            return;
        }
        let known = polygons.iter().flatten().filter(|s| s.node < self.first);
        let place = |s: &Spot| {
            let p = self.parted.position(self.cutting.vertices, s.node);
            GeomWithData::new(p.to_array(), s.node)
        };
        let tree = RTree::bulk_load(known.map(place).collect::<Vec<_>>());
        for node in &mut self.caps.vertices {
            if node.source[0] == u32::MAX
                && let Some(near) = tree.nearest_neighbor(node.position.to_array())
            {
                let from = self.parted.source(self.cutting.vertices, near.data);
                (node.source, node.weights) = (from.source, from.weights);
            }
        }
    }

    /// Adds a triangle of a patch whose own vertices begin with `base`; others ask only for edges between vertices
    /// that they know.
    pub fn push(&mut self, t: [u32; 3], base: u32) {
        let edges = (0..3).map(|k| key(t[k], t[(k + 1) % 3]));
        self.edges.extend(edges.filter(|edge| edge.1 < base));
        self.caps.triangles.push(t);
    }

    /// Refuses caps that do not close what they should: each edge has two cap triangles, or one and is of the
    /// cut.
    pub(crate) fn prove(&self) -> Result<()> {
        // Each edge once for each triangle, with its direction last.
        let directed = |a: u32, b: u32| (key(a, b), a < b);
        let triangles = self.caps.triangles.par_iter().with_min_len(4096);
        let edges = triangles.flat_map_iter(|t| (0..3).map(move |k| directed(t[k], t[(k + 1) % 3])));
        let mut edges: Vec<((u32, u32), bool)> = edges.collect();
        edges.par_sort_unstable();
        let is_right = |group: &[((u32, u32), bool)]| {
            let is_cut = self.parted.cut.contains_key(&group[0].0);
            if is_cut || self.seams.contains(&group[0].0) {
                group.len() == 1
            } else {
                group.len() == 2 && group[0].1 != group[1].1
            }
        };
        match edges.chunk_by(|a, b| a.0 == b.0).find(|group| !is_right(group)) {
            None => Ok(()),
            Some(group) => {
                let at = self.source(group[0].0.0).position;
                Err(Error::CutFailed { reason: "cut lines touch each other", at: at.into() })
            }
        }
    }

    pub(crate) fn measure(&self, tally: &mut Tally) {
        let report = &mut tally.report;
        let position = |v: u32| match v.checked_sub(self.first) {
            Some(k) => self.caps.vertices[k as usize].position,
            None => self.parted.position(self.cutting.vertices, v),
        };
        let mut valence = vec![0u32; self.caps.vertices.len()];
        // Sums of equal stretches, added up in their order.
        const STRETCH: usize = 8192;
        let sum = |triangles: &[[u32; 3]]| {
            let shapes = triangles.iter().map(|t| shape(t.map(position)));
            shapes.fold((f64::INFINITY, 0.0), |(least, sum), (angle, ratio)| (angle.min(least), sum + ratio))
        };
        let sums: Vec<(f64, f64)> = self.caps.triangles.par_chunks(STRETCH).map(sum).collect();
        let mut ratios = 0.0;
        for (angle, ratio) in sums {
            report.cap_min_angle = report.cap_min_angle.min(angle);
            ratios += ratio;
        }
        for v in self.caps.triangles.iter().flatten().filter_map(|v| v.checked_sub(self.first)) {
            valence[v as usize] += 1;
        }
        report.cap_triangles = self.caps.triangles.len();
        report.cap_vertices = valence.len();
        report.cap_irregular = valence.iter().filter(|&&v| v != 6).count();
        if !self.caps.triangles.is_empty() {
            report.cap_radius_ratio = ratios / self.caps.triangles.len() as f64;
        }
    }
}

/// Smallest angle of a triangle, and twice its inscribed by its circumscribed radius.
pub(in crate::cut) fn shape([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let angle = |p: DVec3, q: DVec3| p.cross(q).length().atan2(p.dot(q));
    let least = angle(b - a, c - a).min(angle(c - b, a - b)).min(angle(a - c, b - c));
    let [x, y, z] = [b.distance(c), c.distance(a), a.distance(b)];
    let double = (b - a).cross(c - a).length();
    let product = x * y * z * (x + y + z);
    (least, if product > 0.0 { 4.0 * double * double / product } else { 0.0 })
}

/// Polygons with more vertices are tried at fewer lattice angles.
pub(crate) const LARGE: usize = 300;

/// Badness up to which a lattice patch of theirs is taken.
pub(crate) const ENOUGH: f64 = 2.0;
