//! The cheapest mirror-symmetric boundary: symmetric paths, conflicts priced on both sides alike.

use super::conflicts::{Conflict, Finder, Vertex};
use super::dive::{self, Dive, Patience};
use super::graph::{BLOCKED, Graph};
use super::half::{Half, Memory, symmetric};
use super::parameters::parameters;
use super::prices::Prices;
use super::pulse::Pulse;
use super::search::{Potential, Search, Step, Walk};
use super::sides::wrong_sides;
use super::totals::{failure, fewest, over_distances, squared_distances, total, turns};
use crate::lattice::grid::Grid;
use crate::lattice::reflection::Reflection;
use crate::path::band::Band;
use crate::path::placement::{Laid, Lattice};
use crate::path::target::Target;
use crate::path::trace::contour::Contour;
use crate::path::trace::outcome::{Path, Refusal, TraceFailure, TraceOptions, Traced};
use crate::progress::Progress;

/// A part of a mirror-symmetric drawing, in lattice units; the lattice is laid on the axis.
#[derive(Clone, Debug)]
pub enum Part {
    /// A contour that is its own mirror image. Of its `n` samples `n - i` is the mirror image of `i`;
    /// those below `n / 2` are on the positive side, 0 and `n / 2` on the axis.
    Symmetric {
        /// The samples.
        target: Target,
        /// Whether the drawing has a corner at sample 0, and at `n / 2`: the path gets a vertex on the
        /// axis there, not an edge across it, if it can.
        corners: [bool; 2],
    },
    /// A hole and its mirror image on the other side: the one on the positive side.
    Pair(Target),
}

impl Part {
    /// The targets of its contours: a pair's second is the image of the first, run through backwards.
    pub fn targets(&self, axis: Reflection) -> Vec<Target> {
        match self {
            Part::Symmetric { target, .. } => vec![target.clone()],
            Part::Pair(target) => {
                let mut points: Vec<_> = target.points.iter().map(|&p| Lattice::reflected(axis, p)).collect();
                points[1..].reverse();
                vec![target.clone(), Target { points, step: target.step }]
            }
        }
    }
}

/// As [`trace`](super::trace()), among boundaries that are their own mirror images.
///
/// The axis goes through lattice point (0, 0). `parts[0]` is the outline, symmetric. Each symmetric
/// part gives one path, beginning where it passes to the positive side, each pair two: that of
/// its target, then its image. Parameters are symmetric too: those of mirror images add up to the
/// number of samples (for pairs: modulo it). The cost bound is that of symmetric paths regardless of
/// conflicts; `proof_nodes` is not used.
///
/// # Errors
/// As [`trace`](super::trace()).
pub fn trace_mirrored<G: Laid>(
    parts: &[Part],
    axis: Reflection,
    options: &TraceOptions,
    progress: Progress<'_>,
) -> Result<Traced, TraceFailure> {
    over_distances(options.max_distance, progress, |distance, progress| {
        attempt::<G>(parts, axis, options, distance, progress)
    })
}

/// How the path of a part is searched.
enum Unit<G> {
    Half(Box<Half<G>>),
    /// The first contour of a pair, by its number.
    Pair,
}

/// All that a search needs; contours and walks number all contours, units and prices the parts.
struct Job<'a, G> {
    axis: Reflection,
    units: Vec<Unit<G>>,
    /// The first contour of each unit.
    firsts: Vec<usize>,
    contours: Vec<Contour<G>>,
    prices: Vec<Prices>,
    walks: Vec<Walk<G>>,
    search: Search<'a>,
    memory: Memory<'a>,
}

fn attempt<G: Laid>(
    parts: &[Part],
    axis: Reflection,
    options: &TraceOptions,
    max_distance: f64,
    progress: Progress<'_>,
) -> Result<Traced, Refusal> {
    let mut job = Job::<G>::new(parts, axis, options.closeness, max_distance, progress);
    let result = job.attempt(parts, options, max_distance, progress);
    if job.is_stopped() { Err(TraceFailure::Cancelled.into()) } else { result }
}

impl<'a, G: Laid> Job<'a, G> {
    fn attempt(
        &mut self,
        parts: &[Part],
        options: &TraceOptions,
        max_distance: f64,
        progress: Progress<'_>,
    ) -> Result<Traced, Refusal> {
        let (axis, job) = (self.axis, self);
        for (unit, part) in parts.iter().enumerate() {
            if !job.solve(unit) {
                let (Part::Symmetric { target, .. } | Part::Pair(target)) = part;
                let some = target.points.first().copied().unwrap_or_default();
                return Err(TraceFailure::NoPath { contour: job.firsts[unit], at: G::nearest(some) }.into());
            }
        }
        let states = job.contours.iter().map(|contour| contour.graph.n_states()).sum();
        job.search.pulse.limit(states);
        job.memory.pulse.limit(states);
        let root = total(&job.walks);
        let mut found = job.dive(progress.part(0.3, 0.6))?;
        if failure(&found, &job.contours, &job.walks).is_some() {
            job.keep_apart();
            let rounds = found.rounds;
            found = job.dive(progress.part(0.6, 1.0))?;
            found.rounds += rounds;
        }
        if let Some(failure) = failure(&found, &job.contours, &job.walks) {
            return Err(Refusal::new(failure, &found, &job.walks).or_final(job.is_spent()));
        }
        let targets: Vec<Target> = parts.iter().flat_map(|part| part.targets(axis)).collect();
        let turns = turns(&job.walks);
        let cost = turns as f64 + options.closeness * squared_distances(&job.contours, &job.walks);
        let optimal = total(&job.walks) == root;
        let bound = f64::from(root) / f64::from(super::graph::TURN);
        Ok(Traced {
            cost,
            cost_bound: if optimal { cost } else { bound.min(cost) },
            turns,
            // Symmetric paths are paths beside the targets like others.
            turns_bound: fewest::<G>(&targets, max_distance, &mut job.search.pulse).unwrap_or(0),
            optimal,
            max_distance_used: max_distance,
            rounds: found.rounds,
            paths: job.paths(),
        })
    }

    /// True once more work was done than is allowed.
    fn is_spent(&self) -> bool {
        self.search.pulse.is_spent() || self.memory.pulse.is_spent()
    }

    /// True once the caller has asked to stop.
    fn is_stopped(&self) -> bool {
        self.search.pulse.is_stopped() || self.memory.pulse.is_stopped()
    }

    fn new(
        parts: &[Part],
        axis: Reflection,
        closeness: f64,
        max_distance: f64,
        progress: Progress<'a>,
    ) -> Self {
        let (mut search, mut memory) = (Search::new(Pulse::new(progress)), Memory::new(Pulse::new(progress)));
        let (mut units, mut firsts, mut prices) = (Vec::new(), Vec::new(), Vec::new());
        let mut contours: Vec<Contour<G>> = Vec::new();
        for part in parts {
            firsts.push(contours.len());
            match part {
                Part::Symmetric { target, corners } => {
                    let (half, graph) =
                        Half::<G>::new(target, *corners, axis, (max_distance, closeness), &mut memory);
                    prices.push(Prices::none(graph.n_nodes()));
                    contours.push(Contour { graph, potential: Potential::default() });
                    units.push(Unit::Half(Box::new(half)));
                }
                Part::Pair(target) => {
                    let graph = Graph::new(&Band::<G>::beside(target, max_distance), closeness);
                    let image = graph.image(axis);
                    prices.push(fenced(&graph, axis));
                    let potential = search.potential(&graph);
                    contours.push(Contour { graph, potential });
                    contours.push(Contour { graph: image, potential: Potential::default() });
                    units.push(Unit::Pair);
                }
            }
        }
        let walks = contours.iter().map(|_| Walk::new(Vec::new())).collect();
        Self { axis, units, firsts, contours, prices, walks, search, memory }
    }

    /// Searches the path of a unit; false if there is none.
    fn solve(&mut self, unit: usize) -> bool {
        let (first, prices) = (self.firsts[unit], &self.prices[unit]);
        match &self.units[unit] {
            Unit::Half(half) => {
                let graph = &self.contours[first].graph;
                let Some(walk) = half.cheapest(graph, prices, &mut self.memory) else { return false };
                self.walks[first] = walk;
            }
            Unit::Pair => {
                let Contour { graph, potential } = &self.contours[first];
                let Some((walk, _)) = self.search.closed(graph, potential, prices, u32::MAX) else {
                    return false;
                };
                self.walks[first + 1] = image(&walk, self.axis);
                self.walks[first] = walk;
            }
        }
        true
    }

    /// As the other [`dive`](dive::dive): prices conflicts and searches again until none is left.
    fn dive(&mut self, progress: Progress<'_>) -> Result<Dive, TraceFailure> {
        let mut finder = Finder::default();
        let mut rounds = 0;
        let mut patience = Patience::new(&self.walks, self.search.pulse.is_hasty());
        loop {
            let conflicts = finder.find(&self.contours, &self.walks);
            let repeated = conflicts.iter().any(|conflict| conflict.chord.is_none());
            let wrong = if repeated || self.walks.len() > 1 || !self.turned_once() {
                wrong_sides(&self.contours, &self.walks)
            } else {
                Vec::new()
            };
            let left = conflicts.len() + wrong.len();
            if patience.ends(rounds, left) || left == 0 || rounds == dive::ROUNDS || self.is_spent() {
                return Ok(Dive { rounds, first: patience.first, conflicts, wrong });
            }
            rounds += 1;
            progress.report(rounds as f64 / dive::ROUNDS as f64)?;
            let mut hot = vec![false; self.units.len()];
            for &Conflict { a, b, chord } in &conflicts {
                hot[self.raise(a, chord)] = true;
                hot[self.raise(b, chord.map(|dir| G::turned(dir, G::OPPOSITE as i32)))] = true;
            }
            for vertex in wrong {
                hot[self.raise(vertex, None)] = true;
            }
            for (unit, _) in hot.into_iter().enumerate().filter(|&(_, is_hot)| is_hot) {
                // Prices are never so high that there is no path left.
                self.solve(unit);
            }
        }
    }

    /// True if the outline turns by +6 and each hole by -6.
    fn turned_once(&self) -> bool {
        dive::turned_once(&self.walks)
    }

    /// Raises the price of a vertex (in the mirrored half: of its preimage) for one chord direction, or for any visit if
    /// `None`; returns the number of its unit.
    fn raise(&mut self, vertex: Vertex, chord: Option<u32>) -> usize {
        let contour = vertex.contour as usize;
        let unit = self.firsts.partition_point(|&first| first <= contour) - 1;
        let node = self.walks[contour].node(vertex.index as usize);
        let reflected = |dir: u32| G::image_dir(self.axis, dir);
        let is_image = match &self.units[unit] {
            Unit::Half(half) => node >= half.n_half,
            Unit::Pair => contour > self.firsts[unit],
        };
        let node = match &self.units[unit] {
            Unit::Half(half) => node % half.n_half,
            Unit::Pair => node,
        };
        let prices = &mut self.prices[unit];
        match chord {
            Some(dir) => {
                let dir = if is_image { reflected(dir) } else { dir };
                prices.raise_inside(node, dir, dive::STEP);
            }
            None => prices.raise_visit(node, dive::STEP),
        }
        unit
    }

    /// As [`dive::keep_apart`].
    fn keep_apart(&mut self) {
        let nearest = dive::nearest_squared(&self.contours);
        for unit in 0..self.units.len() {
            let graph = &self.contours[self.firsts[unit]].graph;
            let n = match &self.units[unit] {
                Unit::Half(half) => half.n_half,
                Unit::Pair => graph.n_nodes() as u32,
            };
            self.prices[unit] = match self.units[unit] {
                Unit::Half(_) => Prices::none(graph.n_nodes()),
                Unit::Pair => fenced(graph, self.axis),
            };
            for node in 0..n {
                let (point, squared) = (graph.points[node as usize], graph.squared[node as usize]);
                if nearest.get(&point).is_some_and(|&least| least < squared) {
                    self.prices[unit].raise_visit(node, dive::APART);
                }
            }
            self.solve(unit);
        }
    }

    fn paths(&self) -> Vec<Path> {
        let mut paths = Vec::new();
        for (unit, &first) in self.units.iter().zip(&self.firsts) {
            let (graph, walk) = (&self.contours[first].graph, &self.walks[first]);
            let points: Vec<_> = walk.points(graph).collect();
            let mut parameters = parameters(graph, walk);
            let whole = graph.n_samples as f64;
            match unit {
                Unit::Half(_) => {
                    symmetric::<G>(&points, self.axis, &mut parameters, whole);
                    paths.push(Path { points, parameters });
                }
                Unit::Pair => {
                    let turns = parameters.last().map_or(0.0, |last| (last / whole).ceil());
                    let image = Path {
                        points: points.iter().rev().map(|&p| G::image(self.axis, p)).collect(),
                        parameters: parameters.iter().rev().map(|s| turns * whole - s).collect(),
                    };
                    paths.push(Path { points, parameters });
                    paths.push(image);
                }
            }
        }
        paths
    }
}

/// Prices that keep a path on the positive side, and no edge across the axis inside the patch.
fn fenced<G: Grid>(graph: &Graph<G>, axis: Reflection) -> Prices {
    let mut prices = Prices::none(graph.n_nodes());
    for (node, &point) in (0..).zip(&graph.points) {
        match (G::side(axis, point), G::crossing(axis)) {
            (1, Some(dir)) => prices.raise_inside(node, dir, BLOCKED),
            (1.., _) => {}
            _ => prices.raise_visit(node, BLOCKED),
        }
    }
    prices
}

/// The mirror image of a walk, run through backwards so that the patch stays on its left.
fn image<G: Grid>(walk: &Walk<G>, axis: Reflection) -> Walk<G> {
    let back = |dir: u32| G::turned(G::image_dir(axis, dir), G::OPPOSITE as i32);
    let steps = (0..walk.len()).rev().map(|i| {
        let Step { node, sheet, .. } = walk.step(i);
        Step { node, enter: back(walk.leave(i)) as u8, sheet: -sheet }
    });
    let mut image = Walk::new(steps.collect());
    image.cost = walk.cost;
    image
}
