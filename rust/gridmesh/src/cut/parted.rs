//! A mesh that is divided, its sides still together.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::cross::Node;
use super::locate::Locator;

/// How far vertices that the cut is drawn through may be off the swept surface, in diameters of their line.
pub(super) const SEAM: f64 = 0.018;

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
    /// Where the parts are that are not cut, on the left or not, if that was chosen.
    pub alone: Option<bool>,
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
        let mut own = edges
            .iter()
            .flat_map(|&(a, b)| [a, b])
            .filter(|&v| (v as usize) < self.n_old)
            .collect::<Vec<_>>();
        own.sort_unstable();
        own.dedup();
        own.retain(|&v| {
            let [low, high] = boxes.get(&root(&mut line_of, v)).copied().unwrap_or_default();
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
