//! The paper's way to a boundary of exactly n vertices (section V): growth by distance.
//!
//! Lattice points join in the order of their depth in the loop, the deepest first and those outside
//! last, until the boundary has n edges. Then all that shortens it within reach of the loop joins,
//! and growth goes on until nothing shortens it any more.

use std::collections::BinaryHeap;
use std::sync::Arc;

use glam::DVec2;

use super::walls::Walls;
use crate::lattice::axial::Axial;
use crate::lattice::boundary::Boundary;
use crate::lattice::cells::Layout;
use crate::path::placement::Lattice;

/// How far outside the loop points may join that shorten the boundary, in edges (the paper's value).
const OUTSIDE: f64 = 2.0;

/// A point that may join, with its depth in millionths of an edge; the first of equal ones by place.
type Candidate = (i64, std::cmp::Reverse<Axial>);

struct Growth<'a> {
    boundary: Boundary,
    walls: Walls<'a>,
    queue: BinaryHeap<Candidate>,
}

impl Growth<'_> {
    fn enqueue_around(&mut self, vertex: Axial) {
        let (walls, queue) = (&self.walls, &mut self.queue);
        self.boundary.outside_around(vertex, |point, _| {
            let depth = (1e6 * walls.depth(Lattice::units(point))) as i64;
            queue.push((depth, std::cmp::Reverse(point)));
        });
    }

    /// Adds a point if it covers at least `edges` boundary edges.
    fn add(&mut self, point: Axial, edges: i32) -> bool {
        let Some(expansion) = self.boundary.expansion(point).filter(|e| e.edges >= edges) else {
            return false;
        };
        self.boundary.expand(&expansion);
        self.enqueue_around(point);
        true
    }

    /// Grows until the boundary has `length` edges; false if no point is left.
    fn reach(&mut self, length: usize) -> bool {
        while self.boundary.length() < length {
            let Some((_, std::cmp::Reverse(point))) = self.queue.pop() else { return false };
            self.add(point, 1);
        }
        true
    }

    /// Adds what shortens the boundary; true if anything did.
    fn shorten(&mut self) -> bool {
        let mut shortened = false;
        let mut beside: Vec<Axial> = self.boundary.path();
        while let Some(vertex) = beside.pop() {
            let mut around = Vec::new();
            self.boundary.outside_around(vertex, |point, _| around.push(point));
            for point in around {
                if self.walls.depth(Lattice::units(point)) > -OUTSIDE && self.add(point, 3) {
                    shortened = true;
                    beside.push(point);
                }
            }
        }
        shortened
    }
}

/// A closed path of as many steps as `target` has points, counter-clockwise, vertex k for point k.
///
/// `target` is a counter-clockwise polygon in lattice units with edges about one step long. `None`
/// if it has no room for a seed, or growth got stuck. The path is simple; it may have chords.
pub(in crate::fill) fn grown(target: &[DVec2]) -> Option<Vec<Axial>> {
    let n = target.len();
    let walls = Walls::new(target);
    let around = target.iter().map(|&t| Lattice::nearest(t));
    let layout = Arc::new(Layout::around(around, 4));
    let depth = |p: &Axial| (1e6 * walls.depth(Lattice::units(*p))) as i64;
    let seed = layout.points().filter(|&p| layout.neighbours(p).is_some()).max_by_key(|p| (depth(p), *p))?;
    let boundary = Boundary::hexagon(layout, seed)?;
    let mut growth = Growth { boundary, walls, queue: BinaryHeap::new() };
    for vertex in growth.boundary.path() {
        growth.enqueue_around(vertex);
    }
    while growth.reach(n) && growth.boundary.length() == n {
        if !growth.shorten() {
            let path = growth.boundary.path();
            return Some(aligned(path, target));
        }
    }
    None
}

/// The path begun where it lies nearest to the target, in the square sum.
fn aligned(mut path: Vec<Axial>, target: &[DVec2]) -> Vec<Axial> {
    let n = path.len();
    let places: Vec<DVec2> = path.iter().map(|&p| Lattice::units(p)).collect();
    let centre = places.iter().sum::<DVec2>() / n as f64;
    let middle = target.iter().sum::<DVec2>() / n as f64;
    let off = |shift: usize| -> f64 {
        let pairs = places.iter().cycle().skip(shift).zip(target);
        pairs.map(|(p, t)| (*p - centre).distance_squared(*t - middle)).sum()
    };
    let offs: Vec<f64> = (0..n).map(off).collect();
    let best = (0..n).min_by(|&a, &b| offs[a].total_cmp(&offs[b])).unwrap_or(0);
    path.rotate_left(best);
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::layout::develop::Loop;
    use crate::fill::planar::exact::turning;
    use crate::lattice::grid::Triangular;
    use crate::progress::Progress;

    #[test]
    fn round_loops_get_as_many_vertices_as_they_have() {
        for n in 12..80 {
            let circle: Vec<DVec2> =
                (0..n).map(|k| DVec2::from_angle(std::f64::consts::TAU * k as f64 / n as f64)).collect();
            let target = Loop::new(&circle, Progress::NONE).unwrap().developed::<Triangular>(1.0, 0.3);
            let Some(path) = grown(&target) else { panic!("no path of {n}") };
            assert_eq!(path.len(), n);
            assert_eq!(turning::<Triangular>(&path), 6);
            // Vertex k stays by point k.
            for (p, t) in path.iter().zip(&target) {
                assert!(Lattice::units(*p).distance(*t) < 0.2 * n as f64);
            }
        }
    }
}
