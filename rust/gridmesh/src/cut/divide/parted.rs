//! A mesh that is divided, its sides still together.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::locate::{Locator, Uncut};
use crate::cut::divide::node::Node;
use crate::geometry::disjoint::Disjoint;

/// Snapping tolerance: distance from the swept surface over the diagonal of the cut loop's bounding box.
pub(in crate::cut) const SEAM: f64 = 0.018;

/// A part of a face.
#[derive(Clone, Copy, Debug)]
pub(in crate::cut) struct Part {
    pub corners: [u32; 3],
    pub face: u32,
    /// The old triangle that it is a part of.
    pub home: [u32; 3],
    pub left: bool,
}

/// A mesh with its faces divided along the cut, both sides still together.
pub(in crate::cut) struct Parted {
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
    /// Sides of the parts that are not cut, if these were told one by one.
    pub uncut: Option<Uncut>,
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
    pub fn far(&self, vertices: &[DVec3], locator: &Locator<'_>, reach: f64) -> Vec<u32> {
        let mut edges = self.cut.keys().copied().collect::<Vec<_>>();
        edges.sort_unstable();
        let mut ends = edges.iter().flat_map(|&(a, b)| [a, b]).collect::<Vec<_>>();
        ends.sort_unstable();
        ends.dedup();
        let rank = |v: u32| ends.partition_point(|&end| end < v) as u32;
        let mut lines = Disjoint::new(ends.len());
        edges.iter().for_each(|&(a, b)| lines.join(rank(a), rank(b)));
        let mut boxes: FxHashMap<u32, [DVec3; 2]> = FxHashMap::default();
        for v in edges.iter().flat_map(|&(a, b)| [a, b]) {
            let p = self.position(vertices, v);
            let around = boxes.entry(lines.root(rank(v))).or_insert([p, p]);
            *around = [around[0].min(p), around[1].max(p)];
        }
        let mut own = edges
            .iter()
            .flat_map(|&(a, b)| [a, b])
            .filter(|&v| (v as usize) < self.n_old)
            .collect::<Vec<_>>();
        own.sort_unstable();
        own.dedup();
        own.retain(|&v| {
            let [low, high] = boxes.get(&lines.root(rank(v))).copied().unwrap_or_default();
            let allowed = SEAM * low.distance(high);
            allowed < reach && locator.off(vertices[v as usize], v, reach) > allowed
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
