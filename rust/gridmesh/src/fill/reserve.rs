//! Which edges a patch should and must not have, and which loops must wait for each other.

use rustc_hash::{FxHashMap, FxHashSet};

use super::check::Checked;
use super::mesh::Rim;
use crate::error::{Error, Result};

/// The edges of a triangle, lower vertex first.
pub(super) fn edges(t: &[u32; 3]) -> [[u32; 2]; 3] {
    [0, 1, 2].map(|k| [t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])])
}

/// The patch valence that makes each loop vertex regular.
pub(super) fn wanted(loop_: &[u32], rim: &Rim) -> Vec<i32> {
    let n = loop_.len();
    let outside = |k: usize| {
        let Some(v) = rim.local(loop_[k]) else { return 4 };
        let near = rim.neighbours(v);
        // Loop edges that the mesh has not got count as well.
        let missing = [loop_[(k + n - 1) % n], loop_[(k + 1) % n]]
            .into_iter()
            .filter(|&u| rim.local(u).is_none_or(|u| near.binary_search(&u).is_err()));
        8 - (near.len() + missing.count()) as i32
    };
    (0..n).map(outside).collect()
}

/// Edges between vertices of one loop that exist already.
pub(super) struct Taken {
    pairs: FxHashSet<[u32; 2]>,
    /// True if a triangle of the mesh joins three vertices of the loop.
    pub face: bool,
}

impl Taken {
    pub fn new(checked: &Checked, rim: &Rim, reserved: &FxHashSet<[u32; 2]>) -> Self {
        let loop_ = &checked.vertices;
        let places: FxHashMap<u32, u32> = loop_.iter().enumerate().map(|(k, &v)| (v, k as u32)).collect();
        let mut pairs = FxHashSet::default();
        let mut face = false;
        for v in loop_.iter().filter_map(|&v| rim.local(v)) {
            for &t in rim.around(v) {
                let t = rim.triangles[t as usize].map(|v| rim.ids[v as usize]);
                for [a, b] in edges(&t) {
                    if let (Some(&a), Some(&b)) = (places.get(&a), places.get(&b)) {
                        pairs.insert([a.min(b), a.max(b)]);
                    }
                }
                face |= t.iter().all(|v| places.contains_key(v));
            }
        }
        for [a, b] in reserved {
            if let (Some(&a), Some(&b)) = (places.get(a), places.get(b)) {
                pairs.insert([a.min(b), a.max(b)]);
            }
        }
        Taken { pairs, face }
    }

    pub fn has(&self, i: usize, j: usize) -> bool {
        self.pairs.contains(&[i.min(j) as u32, i.max(j) as u32])
    }
}

/// Turns loops that use an edge of an earlier loop into errors.
pub(super) fn refuse_shared_edges(checked: &mut [Result<Checked>]) {
    let mut used = vec![];
    for (k, item) in checked.iter().enumerate() {
        if let Ok(item) = item {
            let n = item.vertices.len();
            for i in 0..n {
                let (a, b) = (item.vertices[i], item.vertices[(i + 1) % n]);
                used.push(([a.min(b), a.max(b)], k));
            }
        }
    }
    used.sort_unstable();
    for same in used.chunk_by(|a, b| a.0 == b.0) {
        for &(edge, second) in &same[1..] {
            checked[second] = Err(Error::SharedEdge { edge, first: same[0].1, second });
        }
    }
}

/// Numbers of the loops, ascending, those together that share two vertices or more.
pub(super) fn groups(checked: &[Result<Checked>]) -> Vec<Vec<usize>> {
    let mut at = vec![];
    for (k, item) in checked.iter().enumerate() {
        at.extend(item.iter().flat_map(|item| item.vertices.iter().map(move |&v| (v, k))));
    }
    at.sort_unstable();
    let mut pairs = vec![];
    for same in at.chunk_by(|a, b| a.0 == b.0) {
        for (i, a) in same.iter().enumerate() {
            pairs.extend(same[i + 1..].iter().map(|b| (a.1, b.1)));
        }
    }
    pairs.sort_unstable();
    let mut root = (0..checked.len()).collect::<Vec<_>>();
    fn find(root: &mut [usize], mut k: usize) -> usize {
        while root[k] != k {
            root[k] = root[root[k]];
            k = root[k];
        }
        k
    }
    for same in pairs.chunk_by(|a, b| a == b).filter(|same| same.len() > 1) {
        let (a, b) = (find(&mut root, same[0].0), find(&mut root, same[0].1));
        root[a.max(b)] = a.min(b);
    }
    let mut members = (0..checked.len()).map(|k| (find(&mut root, k), k)).collect::<Vec<_>>();
    members.sort_unstable();
    members.chunk_by(|a, b| a.0 == b.0).map(|part| part.iter().map(|m| m.1).collect()).collect()
}
