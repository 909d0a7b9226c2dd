//! Rows of faces from one odd loop to another, whose edges between them stay whole.
//!
//! Where an edge stays whole the faces at it have an odd number of sides when all others are cut in two. A row that goes straight
//! through quads keeps two sides of each whole, which is then two quads side by side instead of four: no vertex is
//! irregular for it. Where it turns, or goes through a triangle, some are.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::fill::even::local::edge;

/// Costs of a step through a face: straight, around a corner, through a triangle; and more where a vertex of a loop is left
/// with one flat corner.
const STRAIGHT: u32 = 2;
const TURN: u32 = 12;
const TRIANGLE: u32 = 9;
const FLAT: u32 = 40;

/// Faces of three or four vertices.
pub(super) struct Rows<'a> {
    faces: &'a [Vec<u32>],
    /// The faces at each edge, with its number in each.
    beside: FxHashMap<[u32; 2], Vec<(usize, usize)>>,
    /// Edges that rows may not cross.
    closed: &'a dyn Fn([u32; 2]) -> bool,
    /// Edges that stay whole.
    whole: FxHashSet<[u32; 2]>,
    /// Faces at the ends of rows.
    ends: FxHashSet<usize>,
}

/// The edges that stay whole: `odd`, edges of loops, and those that rows cross which lead from one of these to another; one
/// of an odd number is left over. None if there is no way.
pub(super) fn whole(
    faces: &[Vec<u32>],
    odd: &[[u32; 2]],
    closed: &dyn Fn([u32; 2]) -> bool,
) -> Option<FxHashSet<[u32; 2]>> {
    let mut beside: FxHashMap<[u32; 2], Vec<(usize, usize)>> = FxHashMap::default();
    for (f, face) in faces.iter().enumerate() {
        for k in 0..face.len() {
            beside.entry(side(face, k)).or_default().push((f, k));
        }
    }
    let ends = odd.iter().filter_map(|e| Some(beside.get(e)?.first()?.0)).collect();
    let mut rows = Rows { faces, beside, closed, whole: odd.iter().copied().collect(), ends };
    let mut left = odd.to_vec();
    while left.len() > 1 {
        // The cheapest row of all, so that what is left over is far from the others.
        let found = left.iter().filter_map(|&from| rows.cheapest(from, &left)).min_by_key(|row| row.0)?;
        let (_, from, to, crossed) = found;
        rows.whole.extend(crossed);
        left.retain(|&e| e != from && e != to);
    }
    Some(rows.whole)
}

/// Edge k of a face.
fn side(face: &[u32], k: usize) -> [u32; 2] {
    edge(face[k], face[(k + 1) % face.len()])
}

/// A face, and the side over which a row comes into it.
type Entry = (usize, usize);

/// A row: its cost, its ends, and the edges that it crosses between.
type Row = (u32, [u32; 2], [u32; 2], Vec<[u32; 2]>);

impl Rows<'_> {
    /// The cheapest row from one edge of a loop to another one that is `left`.
    fn cheapest(&self, from: [u32; 2], left: &[[u32; 2]]) -> Option<Row> {
        let &(first, entry) = self.beside.get(&from)?.first()?;
        // Steps into a face over one of its sides: what they cost, and the step before.
        let mut best: FxHashMap<Entry, (u32, Option<Entry>)> = FxHashMap::default();
        best.insert((first, entry), (0, None));
        let mut queue = BinaryHeap::from([Reverse((0, first, entry))]);
        let mut found: Option<(u32, [u32; 2], Entry)> = None;
        while let Some(Reverse((cost, f, k))) = queue.pop() {
            if found.is_some_and(|found| found.0 <= cost) {
                break;
            }
            if best[&(f, k)].0 < cost {
                continue;
            }
            let face = &self.faces[f];
            for out in (0..face.len()).filter(|&out| out != k) {
                let over = side(face, out);
                let to = left.contains(&over) && over != from;
                if !to && (self.whole.contains(&over) || (self.closed)(over)) {
                    continue;
                }
                // Rows end in the faces of other ends only where these are theirs.
                let Some(step) = self.step(f, k, out, from, to.then_some(over)) else { continue };
                let sum = cost + step;
                if to {
                    if found.is_none_or(|found| sum < found.0) {
                        found = Some((sum, over, (f, k)));
                    }
                    continue;
                }
                let Some(&(g, into)) = self.beside[&over].iter().find(|it| it.0 != f) else { continue };
                if best.get(&(g, into)).is_none_or(|known| sum < known.0) {
                    best.insert((g, into), (sum, Some((f, k))));
                    queue.push(Reverse((sum, g, into)));
                }
            }
        }
        let (cost, to, mut at) = found?;
        let mut crossed = vec![];
        while let Some(before) = best[&at].1 {
            crossed.push(side(&self.faces[at.0], at.1));
            at = before;
        }
        // A row that comes back to a face would cross it twice.
        let mut seen = FxHashSet::default();
        crossed.iter().all(|e| seen.insert(*e)).then_some((cost, from, to, crossed))
    }

    /// The cost of going through a face.
    fn step(&self, f: usize, k: usize, out: usize, from: [u32; 2], to: Option<[u32; 2]>) -> Option<u32> {
        let face = &self.faces[f];
        let n = face.len();
        let own = |i: usize| Some(side(face, i)) == to || side(face, i) == from;
        let used =
            (0..n).filter(|&i| i != k && i != out && self.whole.contains(&side(face, i)) && !own(i)).count();
        let opposite = n == 4 && (k + 2) % 4 == out;
        let is_end = self.ends.contains(&f)
            && (0..n).any(|i| {
                self.beside[&side(face, i)].len() == 1 && self.whole.contains(&side(face, i)) && !own(i)
            });
        if is_end || used > 0 && !(opposite && used == 2) {
            return None;
        }
        let rim = |i: usize| self.beside[&side(face, i)].len() == 1 && !self.whole.contains(&side(face, i));
        let flat = if opposite { 0 } else { (0..n).filter(|&i| i != k && i != out && rim(i)).count() as u32 };
        Some(
            FLAT * flat
                + if opposite {
                    STRAIGHT
                } else if n == 4 {
                    TURN
                } else {
                    TRIANGLE
                },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quads of a grid.
    fn grid(n: u32, m: u32) -> Vec<Vec<u32>> {
        let at = |i: u32, j: u32| i * (m + 1) + j;
        let one = |i: u32, j: u32| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        (0..n).flat_map(|i| (0..m).map(move |j| one(i, j))).collect()
    }

    #[test]
    fn a_row_goes_straight_and_another_crosses_it() {
        let faces = grid(5, 4);
        let at = |i: u32, j: u32| i * 5 + j;
        let (left, right) = (edge(at(0, 1), at(0, 2)), edge(at(5, 1), at(5, 2)));
        let (low, high) = (edge(at(3, 0), at(4, 0)), edge(at(3, 4), at(4, 4)));
        let made = whole(&faces, &[left, right], &|_| false).unwrap();
        assert_eq!(made, (0..=5).map(|i| edge(at(i, 1), at(i, 2))).collect());
        let made = whole(&faces, &[left, low, right, high], &|_| false).unwrap();
        let across = (0..=4).map(|j| edge(at(3, j), at(4, j)));
        assert_eq!(made, (0..=5).map(|i| edge(at(i, 1), at(i, 2))).chain(across).collect());
    }

    #[test]
    fn one_of_three_is_left_over_and_closed_edges_are_not_crossed() {
        let faces = grid(5, 4);
        let at = |i: u32, j: u32| i * 5 + j;
        let ends = [edge(at(0, 1), at(0, 2)), edge(at(5, 1), at(5, 2)), edge(at(3, 0), at(4, 0))];
        let made = whole(&faces, &ends, &|_| false).unwrap();
        let at_rim = |e: &[u32; 2]| ends.contains(e);
        assert_eq!(made.iter().filter(|e| at_rim(e)).count(), 3);
        // Each face has two whole sides or none, but for one.
        let count = |face: &Vec<u32>| (0..4).filter(|&k| made.contains(&side(face, k))).count();
        assert_eq!(faces.iter().filter(|face| count(face) % 2 == 1).count(), 1);
        assert!(whole(&faces, &ends[..2], &|e| !ends.contains(&e)).is_none());
    }
}
