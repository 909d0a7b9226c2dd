//! The band of one contour, cut open: what the shortest-path search walks on.

use std::marker::PhantomData;

use crate::lattice::axial::Axial;
use crate::lattice::grid::{Grid, Triangular};
use crate::lattice::reflection::Reflection;
use crate::path::band::Band;

/// Search cost of one turn of 60 degrees. Powers of two keep sums readable in reports.
pub(super) const TURN: u32 = 1024;
/// Transitions that cost this much or more are forbidden.
pub(super) const BLOCKED: u32 = 1 << 26;
/// How far past the cut and the runs across it a path may go before it comes back, in samples.
const OVERHANG: u32 = 24;

/// A node on one sheet of the band, which is unrolled at the cut: `node + sheet * n_nodes`.
pub(super) type Place = u32;
/// A place and the direction of the step that arrived there: the place times the number of directions plus
/// the direction.
pub(super) type State = u32;

/// A band cut open where few runs lie, its nodes renumbered from there.
pub(super) struct Graph<G = Triangular> {
    pub points: Vec<Axial>,
    /// Search cost of passing a node: its squared distance.
    pub cost: Vec<u32>,
    /// Squared distance to the curve.
    pub squared: Vec<f64>,
    /// Nearest parameter, counted from the band's first sample, at least the cut's.
    pub parameter: Vec<f64>,
    /// Links of node `i` in direction `d` are `starts[D i + d]..starts[D i + d + 1]`, where D is the number
    /// of directions.
    starts: Vec<u32>,
    /// Neighbour and wrap, packed: `4 * node + wrap + 1`.
    links: Vec<u32>,
    /// Nodes that exist on the second sheet too: the first so many.
    pub n_second: usize,
    pub n_samples: usize,
    grid: PhantomData<G>,
}

impl<G: Grid> Graph<G> {
    /// Cuts a band open. Costs are `closeness` times the squared distance.
    ///
    /// Squared distances always count for a little, so that of two paths that cost the same the
    /// closer one is taken.
    pub fn new(band: &Band<G>, closeness: f64) -> Self {
        let n = band.nodes.len();
        let n_samples = band.n_samples() as u32;
        let cut = cut(band);
        let shift = band.nodes.partition_point(|node| node.first < cut);
        let number = |old: usize| (old + n - shift) % n;
        let old = |new: usize| (new + shift) % n;
        // Runs across the cut end this far behind it.
        let behind = band.nodes.iter().map(|node| {
            let first = (node.first + n_samples - cut) % n_samples;
            (first + node.last - node.first).saturating_sub(n_samples)
        });
        let overhang = OVERHANG + behind.max().unwrap_or(0);
        let turned = |old: usize| i32::from(old < shift);
        let mut graph = Self {
            points: Vec::with_capacity(n),
            cost: Vec::with_capacity(n),
            squared: Vec::with_capacity(n),
            parameter: Vec::with_capacity(n),
            starts: Vec::with_capacity(G::DIRECTIONS as usize * n + 1),
            links: Vec::with_capacity(G::DIRECTIONS as usize * n),
            n_second: 0,
            n_samples: n_samples as usize,
            grid: PhantomData,
        };
        for i in 0..n {
            let o = old(i);
            let node = &band.nodes[o];
            let squared = node.distance * node.distance;
            graph.points.push(node.point);
            graph.cost.push(cost(squared, closeness, n));
            graph.squared.push(squared);
            graph.parameter.push(node.parameter + f64::from(turned(o)) * f64::from(n_samples));
            if (node.first + n_samples - cut) % n_samples < overhang {
                graph.n_second = i + 1;
            }
            for dir in 0..G::DIRECTIONS {
                graph.starts.push(graph.links.len() as u32);
                for link in band.links_in(o, dir) {
                    let to = link.node as usize;
                    let wrap = i32::from(link.wrap) + turned(o) - turned(to);
                    // Two turns apart: runs longer than the curve, around a shape of no size.
                    if (-1..=1).contains(&wrap) {
                        graph.links.push(4 * number(to) as u32 + (wrap + 1) as u32);
                    }
                }
            }
        }
        graph.starts.push(graph.links.len() as u32);
        graph
    }

    pub fn n_nodes(&self) -> usize {
        self.points.len()
    }

    /// Number of states on both sheets.
    pub fn n_states(&self) -> usize {
        G::DIRECTIONS as usize * (self.n_nodes() + self.n_second)
    }

    pub fn links(&self, node: u32, dir: u32) -> &[u32] {
        let entry = (G::DIRECTIONS * node + dir) as usize;
        &self.links[self.starts[entry] as usize..self.starts[entry + 1] as usize]
    }

    /// The place that a link leads to from a sheet, if that sheet exists there.
    ///
    /// Links go both ways: listed at its end with the wrap that leads to its start, a step is
    /// followed back likewise.
    #[inline]
    pub fn follow(&self, link: u32, sheet: u32) -> Option<Place> {
        let node = link >> 2;
        // Sheet plus wrap plus one: 1 on the first sheet, 2 on the second.
        match sheet + (link & 3) {
            1 => Some(node),
            2 if (node as usize) < self.n_second => Some(node + self.n_nodes() as u32),
            _ => None,
        }
    }

    /// The states on the first sheet that a step across the cut arrives in.
    pub fn starts(&self) -> Vec<State> {
        let mut found = Vec::new();
        for node in 0..self.n_nodes() as u32 {
            for dir in 0..G::DIRECTIONS {
                // The step came from the neighbour behind, one turn earlier.
                let behind = self.links(node, G::turned(dir, G::OPPOSITE as i32));
                if (node as usize) < self.n_second && behind.iter().any(|link| link & 3 == 0) {
                    found.push(G::DIRECTIONS * node + dir);
                }
            }
        }
        found
    }
}

impl<G: Grid> Graph<G> {
    /// Both sides of an axis, from the band beside the half of a symmetric curve that begins and ends
    /// on it: the nodes on the axis and on its positive side, then the mirror images of all of them.
    ///
    /// Only the first have links, and to each other only. Also returns their number, and for each
    /// the node of the band.
    pub fn unfolded(band: &Band<G>, axis: Reflection, closeness: f64) -> (Self, Vec<u32>) {
        let kept: Vec<u32> = (0..band.nodes.len() as u32)
            .filter(|&i| G::side(axis, band.nodes[i as usize].point) >= 0)
            .collect();
        let n = kept.len();
        let mut number = vec![u32::MAX; band.nodes.len()];
        for (new, &old) in (0..).zip(&kept) {
            number[old as usize] = new;
        }
        let whole = 2.0 * band.n_samples() as f64;
        let nodes = || kept.iter().map(|&i| &band.nodes[i as usize]);
        let squared: Vec<f64> = nodes().map(|node| node.distance * node.distance).collect();
        let parameter = |image: bool| {
            nodes().map(move |node| match (G::side(axis, node.point) == 0, image) {
                (true, _) if node.first == 0 => 0.0,
                (true, _) => 0.5 * whole,
                (false, true) => whole - node.parameter,
                (false, false) => node.parameter,
            })
        };
        let mut graph = Self {
            points: nodes()
                .map(|node| node.point)
                .chain(nodes().map(|node| G::image(axis, node.point)))
                .collect(),
            cost: squared.iter().chain(&squared).map(|&d| cost(d, closeness, 2 * n)).collect(),
            parameter: parameter(false).chain(parameter(true)).collect(),
            squared: squared.repeat(2),
            starts: Vec::with_capacity(2 * G::DIRECTIONS as usize * n + 1),
            links: Vec::with_capacity(G::DIRECTIONS as usize * n),
            n_second: 0,
            n_samples: 2 * band.n_samples(),
            grid: PhantomData,
        };
        for &old in &kept {
            for dir in 0..G::DIRECTIONS {
                graph.starts.push(graph.links.len() as u32);
                let known = band.links_in(old as usize, dir).iter().map(|link| number[link.node as usize]);
                graph.links.extend(known.filter(|&to| to != u32::MAX).map(|to| 4 * to + 1));
            }
        }
        graph.starts.resize(2 * G::DIRECTIONS as usize * n + 1, graph.links.len() as u32);
        (graph, kept)
    }

    /// The mirror image, without links.
    pub fn image(&self, axis: Reflection) -> Self {
        let whole = self.n_samples as f64;
        Self {
            points: self.points.iter().map(|&p| G::image(axis, p)).collect(),
            cost: self.cost.clone(),
            squared: self.squared.clone(),
            parameter: self.parameter.iter().map(|s| whole - s).collect(),
            starts: vec![0; G::DIRECTIONS as usize * self.n_nodes() + 1],
            links: Vec::new(),
            n_second: 0,
            n_samples: self.n_samples,
            grid: PhantomData,
        }
    }
}

/// What it costs to pass one of `n` nodes at a squared distance from the curve.
fn cost(squared: f64, closeness: f64, n: usize) -> u32 {
    const LEAST: f64 = 1.0 / 256.0;
    // So that no sum overflows.
    let most = f64::from(BLOCKED / 64).min(1e9 / (n as f64 + 1.0));
    (closeness.clamp(LEAST, 100.0) * squared * f64::from(TURN)).round().min(most) as u32
}

/// The segment before which the fewest runs continue.
fn cut<G: Grid>(band: &Band<G>) -> u32 {
    let n = band.n_samples();
    // Runs that contain both a segment and the one before it.
    let mut change = vec![0i32; n + 1];
    for node in &band.nodes {
        let (first, last) = (node.first as usize + 1, node.last as usize);
        if last >= n {
            change[first.min(n)] += 1;
            change[0] += 1;
            change[(last - n + 1).min(n)] -= 1;
        } else if first <= last {
            change[first] += 1;
            change[last + 1] -= 1;
        }
    }
    let mut count = 0;
    let mut best = (i32::MAX, 0);
    for (segment, step) in change[..n].iter().enumerate() {
        count += step;
        best = best.min((count, segment as u32));
    }
    best.1
}
