//! The immersed band: the lattice points near a curve, once for each stretch of it they are near.

use std::iter;

use rustc_hash::FxHashMap;

use crate::axial::Axial;
use crate::lattice::{Lattice, ROW_HEIGHT};
use crate::segments::nearest_on_segment;
use crate::target::Target;

/// How much farther than the path's greatest distance a stretch of curve may be from its point.
pub const SLACK: f64 = 0.3;

/// A lattice point and one stretch of the curve beside it.
///
/// The stretch is a maximal run of target segments within reach of the point. Both walls of a
/// narrow part, and both sides of an inlet, give nodes of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// The lattice point.
    pub point: Axial,
    /// First segment of the run, from 0 to the number of samples.
    pub first: u32,
    /// Last segment of the run, at least `first`; past the number of samples where the run goes
    /// round the end.
    pub last: u32,
    /// Parameter of the nearest point of the run, in samples; from `first` to `last + 1`.
    pub parameter: f64,
    /// Distance to the nearest point of the run, in edges.
    pub distance: f64,
}

/// All nodes within a distance of a target, in time and space proportional to its length.
#[derive(Clone, Debug)]
pub struct Band {
    /// Nodes in order of their run's first segment; ties in scan order.
    pub nodes: Vec<Node>,
    /// The latest node of each point; the earlier ones follow by `earlier`.
    latest: FxHashMap<Axial, u32>,
    earlier: Vec<u32>,
    n_samples: usize,
}

const NONE: u32 = u32::MAX;

impl Band {
    /// Collects the nodes whose nearest distance is at most `max_distance`; runs reach out to
    /// `max_distance + SLACK`.
    pub fn new(target: &Target, max_distance: f64) -> Self {
        let reach = max_distance + SLACK;
        let n = target.len();
        let mut nodes: Vec<Node> = Vec::with_capacity(4 * n);
        let mut latest: FxHashMap<Axial, u32> = FxHashMap::default();
        let mut earlier: Vec<u32> = Vec::with_capacity(4 * n);
        for segment in 0..n {
            let (a, b) = target.segment(segment);
            for point in points_near(a.min(b) - reach, a.max(b) + reach) {
                let (t, squared) = nearest_on_segment(Lattice::units(point), a, b);
                if squared > reach * reach {
                    continue;
                }
                let parameter = segment as f64 + t;
                let known = latest.get(&point).copied().unwrap_or(NONE);
                if known != NONE && nodes[known as usize].last + 1 >= segment as u32 {
                    let node = &mut nodes[known as usize];
                    node.last = segment as u32;
                    if squared < node.distance {
                        node.distance = squared;
                        node.parameter = parameter;
                    }
                    continue;
                }
                latest.insert(point, nodes.len() as u32);
                earlier.push(known);
                let segment = segment as u32;
                nodes.push(Node { point, first: segment, last: segment, parameter, distance: squared });
            }
        }
        let mut band = Self { nodes, latest, earlier, n_samples: n };
        band.join_ends();
        band.keep_near(max_distance);
        band
    }

    /// Joins a run that ends with the last segment to one of the same point that starts with the
    /// first.
    fn join_ends(&mut self) {
        let n = self.n_samples as u32;
        for start in 0..self.nodes.len() {
            let head = self.nodes[start];
            if head.first != 0 {
                break;
            }
            let end = self.latest[&head.point] as usize;
            let tail = self.nodes[end];
            if tail.last + 1 != n || end == start {
                continue;
            }
            let joined = &mut self.nodes[end];
            joined.last = n + head.last;
            if head.distance < tail.distance {
                joined.distance = head.distance;
                joined.parameter = head.parameter + f64::from(n);
            }
            self.nodes[start].distance = f64::INFINITY;
        }
    }

    /// Drops the nodes that are too far, takes square roots, and renumbers.
    fn keep_near(&mut self, max_distance: f64) {
        let mut number = vec![NONE; self.nodes.len()];
        let mut kept = 0;
        for (i, node) in self.nodes.iter().enumerate() {
            if node.distance <= max_distance * max_distance {
                number[i] = kept;
                kept += 1;
            }
        }
        let next_kept = |earlier: &[u32], mut i: u32| {
            while i != NONE && number[i as usize] == NONE {
                i = earlier[i as usize];
            }
            if i == NONE { NONE } else { number[i as usize] }
        };
        let earlier: Vec<u32> = (0..self.nodes.len())
            .filter(|&i| number[i] != NONE)
            .map(|i| next_kept(&self.earlier, self.earlier[i]))
            .collect();
        self.latest.retain(|_, i| {
            *i = next_kept(&self.earlier, *i);
            *i != NONE
        });
        self.earlier = earlier;
        self.nodes.retain(|node| node.distance <= max_distance * max_distance);
        for node in &mut self.nodes {
            node.distance = node.distance.sqrt();
        }
    }

    /// Number of samples of the target: parameters are taken modulo this.
    pub fn n_samples(&self) -> usize {
        self.n_samples
    }

    /// Numbers of the nodes of a lattice point, latest run first.
    pub fn nodes_at(&self, point: Axial) -> impl Iterator<Item = usize> {
        let some = |i: u32| (i != NONE).then_some(i as usize);
        iter::successors(self.latest.get(&point).map(|&i| i as usize), move |&i| some(self.earlier[i]))
    }

    /// The node of a lattice point that is nearest to the curve.
    pub fn nearest(&self, point: Axial) -> Option<&Node> {
        self.nodes_at(point)
            .map(|i| &self.nodes[i])
            .min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.first.cmp(&b.first)))
    }
}

/// The lattice points in a box, row by row.
fn points_near(low: glam::DVec2, high: glam::DVec2) -> impl Iterator<Item = Axial> {
    let rows = (low.y / ROW_HEIGHT).ceil() as i32..=(high.y / ROW_HEIGHT).floor() as i32;
    rows.flat_map(move |r| {
        let shift = 0.5 * f64::from(r);
        let columns = (low.x - shift).ceil() as i32..=(high.x - shift).floor() as i32;
        columns.map(move |q| Axial::new(q, r))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// Every node of a brute-force band over a box, as (point, first, last).
    fn brute_force(target: &Target, max_distance: f64) -> Vec<(Axial, u32, u32)> {
        let n = target.len();
        let mut found = Vec::new();
        for q in -40..40 {
            for r in -40..40 {
                let p = Axial::new(q, r);
                let d: Vec<f64> = (0..n)
                    .map(|i| {
                        let (a, b) = target.segment(i);
                        nearest_on_segment(Lattice::units(p), a, b).1.sqrt()
                    })
                    .collect();
                let within = |i: usize| d[i % n] <= max_distance + SLACK;
                for first in (0..n).filter(|&i| within(i) && !within(i + n - 1)) {
                    let last = (first..).find(|&i| !within(i + 1)).unwrap();
                    if (first..=last).any(|i| d[i % n] <= max_distance) {
                        found.push((p, first as u32, last as u32));
                    }
                }
            }
        }
        found.sort_unstable();
        found
    }

    #[test]
    fn nodes_are_the_maximal_runs() {
        let points: Vec<DVec2> = (0..300)
            .map(|i| {
                let t = f64::from(i) / 300.0 * std::f64::consts::TAU;
                (7.0 + 5.0 * (5.0 * t).cos()) * DVec2::from_angle(t)
            })
            .collect();
        for shift in [0, 10, 77, 150, 299] {
            let mut points = points.clone();
            points.rotate_left(shift);
            let target = Target { points, step: 0.4 };
            for max_distance in [0.7, 1.5] {
                let band = Band::new(&target, max_distance);
                let mut found: Vec<_> = band.nodes.iter().map(|n| (n.point, n.first, n.last)).collect();
                found.sort_unstable();
                assert_eq!(found, brute_force(&target, max_distance));
                let mut listed: Vec<usize> = band
                    .nodes
                    .iter()
                    .flat_map(|node| band.nodes_at(node.point).collect::<Vec<_>>())
                    .collect();
                listed.sort_unstable();
                listed.dedup();
                assert_eq!(listed.len(), band.nodes.len());
            }
        }
    }
}
