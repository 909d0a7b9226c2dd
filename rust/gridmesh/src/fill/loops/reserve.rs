//! Which edges a patch should and must not have, and which loops must wait for each other.

use rustc_hash::{FxHashMap, FxHashSet};

use super::check::Checked;
use super::mesh::Rim;
use crate::error::{Error, Result};
use crate::geometry::disjoint::Disjoint;

/// The edges of a triangle, lower vertex first.
pub(in crate::fill) fn edges(t: &[u32; 3]) -> [[u32; 2]; 3] {
    [0, 1, 2].map(|k| [t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])])
}

/// The patch valence that makes each loop vertex regular: 8 less the edges outside, or what the sides of
/// its faces leave where those are no triangles.
///
/// `polygons`: the polygon that each triangle of the mesh is a part of, or nothing.
pub(in crate::fill) fn wanted(loop_: &[u32], rim: &Rim, polygons: &[u32]) -> Vec<i32> {
    let n = loop_.len();
    let outside = |k: usize| {
        let Some(v) = rim.local(loop_[k]) else { return 4 };
        let near = rim.neighbours(v);
        // Loop edges that the mesh has not got count as well.
        let missing = [loop_[(k + n - 1) % n], loop_[(k + 1) % n]]
            .into_iter()
            .filter(|&u| rim.local(u).is_none_or(|u| near.binary_search(&u).is_err()));
        let edges = 8 - (near.len() + missing.count()) as i32;
        (f64::from(edges) + surplus(rim, v, polygons)).round() as i32
    };
    (0..n).map(outside).collect()
}

/// How many right angles the mesh leaves each loop vertex: the number of quads that make it regular. What counts are
/// the corners of faces, as they are in regular polygons; without faces there is room for two.
pub(in crate::fill) fn room(loop_: &[u32], rim: &Rim, polygons: &[u32]) -> Vec<f64> {
    // A triangle takes two thirds, a corner of a polygon of t triangles 2 t / (t + 2).
    let corner = |cut: f64| 2.0 * cut / (cut + 2.0);
    let left = |v: &u32| {
        let Some(v) = rim.local(*v) else { return 2.0 };
        let taken = match polygons {
            [] => rim.around(v).len() as f64 * corner(1.0),
            _ => sizes(rim, v, polygons).into_iter().map(corner).sum(),
        };
        (4.0 - taken).clamp(0.5, 4.0)
    };
    loop_.iter().map(left).collect()
}

/// Corners of polygons of more triangles count as straight, for all this matters.
const MANY: usize = 100;

/// By how many more triangles the polygons at a vertex are cut than their corners there are worth: a
/// corner of a quad takes the room of one and a half, whichever of its diagonals is in use.
fn surplus(rim: &Rim, v: u32, polygons: &[u32]) -> f64 {
    if polygons.is_empty() {
        return 0.0;
    }
    let worth = sizes(rim, v, polygons).into_iter().map(|cut| 3.0 * cut / (cut + 2.0));
    rim.around(v).len() as f64 - worth.sum::<f64>()
}

/// Of how many triangles each polygon at a vertex is.
fn sizes(rim: &Rim, v: u32, polygons: &[u32]) -> Vec<f64> {
    let number = |&t: &u32| rim.numbers[t as usize] as usize;
    let mut around = rim.around(v).iter().map(number).collect::<Vec<_>>();
    let own = |t: usize| polygons[t];
    around.sort_unstable_by_key(|&t| (own(t), t));
    let size = |same: &[usize]| {
        // The triangles of a polygon follow each other.
        let (t, polygon) = (same[0], own(same[0]));
        let after = polygons[t..].iter().take(MANY).take_while(|&&p| p == polygon).count();
        let before = polygons[..t].iter().rev().take(MANY).take_while(|&&p| p == polygon).count();
        (before + after) as f64
    };
    around.chunk_by(|&a, &b| own(a) == own(b)).map(size).collect()
}

/// Edges between vertices of one loop that exist already.
pub(in crate::fill) struct Taken {
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
        for [a, b] in reserved.iter().chain(&rim.loose) {
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
pub(in crate::fill) fn refuse_shared_edges(checked: &mut [Result<Checked>]) {
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
pub(in crate::fill) fn groups(checked: &[Result<Checked>]) -> Vec<Vec<usize>> {
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
    let mut sets = Disjoint::new(checked.len());
    for same in pairs.chunk_by(|a, b| a == b).filter(|same| same.len() > 1) {
        sets.join(same[0].0 as u32, same[0].1 as u32);
    }
    let mut members = (0..checked.len()).map(|k| (sets.root(k as u32), k)).collect::<Vec<_>>();
    members.sort_unstable();
    members.chunk_by(|a, b| a.0 == b.0).map(|part| part.iter().map(|m| m.1).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonals_of_quads_do_not_count() {
        // The middle of a row of vertices with two quads below it; each may be cut along either diagonal.
        let cuts = |left: bool, right: bool| {
            let one = if left { [[0, 1, 4], [0, 4, 3]] } else { [[0, 1, 3], [1, 4, 3]] };
            let two = if right { [[1, 2, 5], [1, 5, 4]] } else { [[1, 2, 4], [2, 5, 4]] };
            [one, two].concat()
        };
        let row = [3, 4, 5, 6, 7, 8];
        let at = |triangles: &[[u32; 3]], polygons: &[u32]| {
            wanted(&row, &Rim::new(9, triangles, &row, 1).unwrap(), polygons)[1]
        };
        for (left, right) in [(true, true), (true, false), (false, true), (false, false)] {
            let triangles = cuts(left, right);
            assert_eq!(at(&triangles, &[7, 7, 2, 2]), 4);
            assert_eq!(at(&triangles, &[0, 1, 2, 3]), at(&triangles, &[]));
        }
        assert_ne!(at(&cuts(true, true), &[]), at(&cuts(false, true), &[]));
        let triangles = cuts(true, false);
        let rim = Rim::new(9, &triangles, &row, 1).unwrap();
        assert_eq!(room(&row, &rim, &[7, 7, 2, 2]), [3.0, 2.0, 3.0, 2.0, 2.0, 2.0]);
        assert_eq!(room(&row, &Rim::default(), &[]), [2.0; 6]);
    }
}
