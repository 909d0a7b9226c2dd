//! Loops joined to one closed walk.

use glam::{DVec2, DVec3};

use crate::drawing::contours::encloses;
use crate::fill::bridge::align::Ring;
use crate::fill::loops::check::Checked;

/// Places of vertices of several loops, one loop after the other.
#[derive(Clone, Debug)]
pub(super) struct Loops {
    /// The place at which each begins.
    pub starts: Vec<usize>,
    len: usize,
}

impl Loops {
    pub fn new(lengths: impl Iterator<Item = usize>) -> Loops {
        let mut loops = Loops { starts: vec![], len: 0 };
        for length in lengths {
            loops.starts.push(loops.len);
            loops.len += length;
        }
        loops
    }

    /// The loop of a place.
    pub fn of(&self, place: usize) -> usize {
        self.starts.partition_point(|&start| start <= place) - 1
    }

    /// The places of a loop.
    pub fn range(&self, loop_: usize) -> std::ops::Range<usize> {
        self.starts[loop_]..self.starts.get(loop_ + 1).copied().unwrap_or(self.len)
    }

    pub fn next(&self, place: usize) -> usize {
        let range = self.range(self.of(place));
        if place + 1 == range.end { range.start } else { place + 1 }
    }

    pub fn before(&self, place: usize) -> usize {
        let range = self.range(self.of(place));
        if place == range.start { range.end - 1 } else { place - 1 }
    }
}

/// Which loops are joined, the nearest ones: pairs of one that is joined already, beginning with the first, and a new one.
pub(super) fn spanning(checked: &[Checked], vertices: &[DVec3]) -> Vec<[usize; 2]> {
    let points = |k: usize| checked[k].vertices.iter().map(|&v| vertices[v as usize]);
    let distance = |a: usize, b: usize| {
        points(a).flat_map(|p| points(b).map(move |q| p.distance_squared(q))).fold(f64::INFINITY, f64::min)
    };
    // The nearest loop joined already, of each other one.
    let mut nearest = (0..checked.len()).map(|k| (distance(0, k), 0)).collect::<Vec<_>>();
    let mut left = (1..checked.len()).collect::<Vec<_>>();
    let mut pairs = vec![];
    while let Some(at) = (0..left.len()).min_by(|&i, &j| nearest[left[i]].0.total_cmp(&nearest[left[j]].0)) {
        let new = left.remove(at);
        pairs.push([nearest[new].1, new]);
        for &k in &left {
            let own = distance(new, k);
            if own < nearest[k].0 {
                nearest[k] = (own, new);
            }
        }
    }
    pairs
}

/// Turns loops without faces the way round that suits those that they are joined to.
pub(super) fn turned(checked: &mut [Checked], spanning: &[[usize; 2]], vertices: &[DVec3]) {
    let ring = |c: &Checked| Ring::new(c.vertices.iter().map(|&v| vertices[v as usize]).collect());
    for &[from, to] in spanning {
        let free = checked[to].wire == checked[to].vertices.len();
        if free && !suits(&ring(&checked[from]), &ring(&checked[to])) {
            checked[to].vertices.reverse();
            checked[to].reversed ^= true;
        }
    }
}

/// Whether two loops run as boundaries of one surface: round one tube against each other, one in the other too; side by side
/// alike.
fn suits(one: &Ring, other: &Ring) -> bool {
    /// Sine of the angle up to which loops lie in one plane.
    const PLANE: f64 = 0.15;
    let way = (other.centre - one.centre).normalize_or_zero();
    let (a, b) = (one.axis.dot(way), other.axis.dot(way));
    let alike = one.axis.dot(other.axis);
    if a.abs().min(b.abs()) > PLANE {
        a * b < 0.0
    } else if holds(one, other.centre) || holds(other, one.centre) {
        alike <= 0.0
    } else {
        alike >= 0.0
    }
}

/// Whether a point lies inside a loop, seen along its axis.
fn holds(ring: &Ring, point: DVec3) -> bool {
    let (u, v) = ring.axis.normalize_or(DVec3::Z).any_orthonormal_pair();
    let flat = |p: DVec3| DVec2::new((p - ring.centre).dot(u), (p - ring.centre).dot(v));
    encloses(&ring.points.iter().map(|&p| flat(p)).collect::<Vec<_>>(), flat(point))
}

/// A closed walk along all loops and, there and back, along a link for each pair: places; the ends of links come twice.
///
/// `links`: the places at the ends, of the loop that is there already and of the new one; no place is in two.
pub(super) fn walk(loops: &Loops, links: &[[usize; 2]]) -> Vec<usize> {
    let mut out = vec![];
    let mut taken = vec![false; links.len()];
    // What is left to be done, the next thing last: a stretch of a loop from a place, so many vertices long.
    let mut stack = vec![(0, loops.range(0).len())];
    while let Some((at, length)) = stack.pop() {
        if length == 0 {
            continue;
        }
        out.push(at);
        stack.push((loops.next(at), length - 1));
        let link = links.iter().position(|link| link[0] == at).filter(|&k| !taken[k]);
        if let Some(k) = link {
            let entry = links[k][1];
            taken[k] = true;
            // All around the new loop, its first vertex and this one once more.
            stack.push((at, 1));
            stack.push((entry, 1));
            stack.push((entry, loops.range(loops.of(entry)).len()));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_takes_every_edge_once_and_every_link_twice() {
        let loops = Loops::new([5, 4, 3].into_iter());
        let links = [[2, 6], [7, 10]];
        let walk = walk(&loops, &links);
        assert_eq!(walk, [0, 1, 2, 6, 7, 10, 11, 9, 10, 7, 8, 5, 6, 2, 3, 4]);
        assert_eq!(walk.len(), 12 + 2 * links.len());
        for k in 0..walk.len() {
            let (a, b) = (walk[k], walk[(k + 1) % walk.len()]);
            let linked = links.iter().any(|&[p, q]| [a, b] == [p, q] || [a, b] == [q, p]);
            assert!(linked || loops.next(a) == b, "{a} {b}");
        }
    }
}
