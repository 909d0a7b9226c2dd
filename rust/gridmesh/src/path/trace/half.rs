//! Shortest mirror-symmetric closed paths: one half of them, from the axis to the axis.
//!
//! A simple symmetric path meets its axis twice: in a vertex on it, or in the middle of an edge at a
//! right angle to it. Between the two it stays on one side. So the search walks on the nodes of the
//! positive side alone, begins where the mirrored path would arrive and ends where it would go on.
//! Of conflicts between the halves only one kind is left, an edge across the axis inside the
//! patch; ways of passing a node that have it inside are not allowed.

use std::marker::PhantomData;

use crate::geometry::segments::nearest_on_segment;
use crate::lattice::axial::Axial;
use crate::lattice::grid::{Grid, Triangular};
use crate::lattice::reflection::Reflection;
use crate::path::band::{Band, SLACK};
use crate::path::placement::{Laid, Lattice};
use crate::path::target::Target;

use super::graph::{BLOCKED, Graph, State, TURN};
use super::prices::Prices;
use super::pulse::Pulse;
use super::queue::Queue;
use super::search::{Rules, Step, Walk};

const NONE: u32 = u32::MAX;

/// A symmetric contour: what the half of its path on the positive side is searched on.
pub(super) struct Half<G = Triangular> {
    /// Number of nodes on the axis and on the positive side; those after them are their images.
    pub n_half: u32,
    /// On which side each of them lies.
    side: Vec<i32>,
    axis: Reflection,
    starts: Vec<Start>,
    /// Sorted by state.
    ends: Vec<End>,
    /// Least cost from each state to the end.
    bound: Vec<u32>,
    grid: PhantomData<G>,
}

/// A state that the path may begin in, and its cost.
struct Start {
    state: State,
    cost: u32,
    /// The vertex on the axis before, if there is one: node, arriving direction, turn.
    from: Option<(u32, u32, i32)>,
}

/// A way to leave a state for the axis, and its cost.
struct End {
    state: State,
    cost: u32,
    turn: i32,
    /// The vertex on the axis, if there is one: node and turn.
    to: Option<(u32, i32)>,
}

/// Memory for searches, reused.
pub(super) struct Memory<'a> {
    queue: Queue,
    reached: Vec<u32>,
    parent: Vec<State>,
    pub pulse: Pulse<'a>,
}

impl<'a> Memory<'a> {
    pub fn new(pulse: Pulse<'a>) -> Self {
        Self { queue: Queue::new(), reached: Vec::new(), parent: Vec::new(), pulse }
    }
}

impl<G: Laid> Half<G> {
    /// Prepares the search for a contour whose samples 0 and `n / 2` of `n` lie on the axis and whose
    /// sample `n - i` is the mirror image of sample `i`, on the positive side where `i < n / 2`. Where
    /// the two samples on the axis are corners no edge crosses there, unless nothing else is possible.
    pub fn new(
        target: &Target,
        corners: [bool; 2],
        axis: Reflection,
        (max_distance, closeness): (f64, f64),
        memory: &mut Memory<'_>,
    ) -> (Self, Graph<G>) {
        let points = &target.points[..=target.len() / 2];
        let band = Band::<G>::along(points, max_distance);
        let (graph, kept) = Graph::unfolded(&band, axis, closeness);
        let n_half = kept.len() as u32;
        let side = kept.iter().map(|&old| G::side(axis, band.nodes[old as usize].point)).collect();
        let mut half = Self {
            n_half,
            side,
            axis,
            starts: Vec::new(),
            ends: Vec::new(),
            bound: Vec::new(),
            grid: PhantomData,
        };
        let reach = max_distance + SLACK;
        let last = points.len() - 1;
        for (node, &old) in (0..).zip(&kept) {
            let of_band = &band.nodes[old as usize];
            // Symmetric nodes meet if they share a segment, and then the first beyond the axis too.
            let meets = |on_axis: usize, inner: usize| {
                let beyond = Lattice::reflected(axis, points[inner]);
                let p = G::units(of_band.point);
                nearest_on_segment(p, beyond, points[on_axis]).1 <= reach * reach
            };
            if of_band.first == 0 && meets(0, 1) {
                half.begin_at(&graph, node);
            }
            if of_band.last as usize + 1 == last && meets(last, last - 1) {
                half.end_at(&graph, node);
            }
        }
        if corners[0] && half.starts.iter().any(|start| start.from.is_some()) {
            half.starts.retain(|start| start.from.is_some());
        }
        if corners[1] && half.ends.iter().any(|end| end.to.is_some()) {
            half.ends.retain(|end| end.to.is_some());
        }
        half.ends.sort_by_key(|end| end.state);
        half.find_bounds(&graph, memory);
        (half, graph)
    }

    fn side(&self, node: u32) -> i32 {
        self.side[node as usize]
    }

    /// The direction in which the mirrored path arrives where this one leaves by `dir`, and the other
    /// way round.
    fn continued(&self, dir: u32) -> u32 {
        G::turned(G::image_dir(self.axis, dir), G::OPPOSITE as i32)
    }

    fn turn_between(enter: u32, leave: u32) -> Option<i32> {
        let turn = G::turn(enter, leave);
        G::TURNS.contains(&turn).then_some(turn)
    }

    fn crossing(&self, node: u32) -> Option<u32> {
        G::crossing(self.axis).filter(|_| self.side(node) == 1)
    }

    /// Neighbours on the positive side.
    fn beside(&self, graph: &Graph<G>, node: u32, dir: u32) -> impl Iterator<Item = u32> {
        graph.links(node, dir).iter().map(|link| link >> 2).filter(|&to| self.side(to) > 0)
    }

    fn begin_at(&mut self, graph: &Graph<G>, node: u32) {
        let cost = &graph.cost;
        let mut found = Vec::new();
        if let Some(dir) = self.crossing(node) {
            let state = G::DIRECTIONS * node + G::turned(dir, G::OPPOSITE as i32);
            found.push(Start { state, cost: 2 * cost[node as usize], from: None });
        } else if self.side(node) == 0 {
            for leave in 0..G::DIRECTIONS {
                let enter = self.continued(leave);
                let Some(turn) = Self::turn_between(enter, leave) else { continue };
                found.extend(self.beside(graph, node, leave).map(|to| Start {
                    state: G::DIRECTIONS * to + leave,
                    cost: cost[node as usize] + turn.unsigned_abs() * TURN + 2 * cost[to as usize],
                    from: Some((node, enter, turn)),
                }));
            }
        }
        self.starts.extend(found);
    }

    fn end_at(&mut self, graph: &Graph<G>, node: u32) {
        let mut found = Vec::new();
        if let Some(leave) = self.crossing(node) {
            for &turn in G::TURNS {
                let state = G::DIRECTIONS * node + G::turned(leave, -turn);
                found.push(End { state, cost: 2 * turn.unsigned_abs() * TURN, turn, to: None });
            }
        } else if self.side(node) == 0 {
            for enter in 0..G::DIRECTIONS {
                let Some(last) = Self::turn_between(enter, self.continued(enter)) else { continue };
                let here = graph.cost[node as usize] + last.unsigned_abs() * TURN;
                for from in self.beside(graph, node, G::turned(enter, G::OPPOSITE as i32)) {
                    for &turn in G::TURNS.iter().filter(|&&turn| self.is_allowed(from, enter, turn)) {
                        let state = G::DIRECTIONS * from + G::turned(enter, -turn);
                        let cost = here + 2 * turn.unsigned_abs() * TURN;
                        found.push(End { state, cost, turn, to: Some((node, last)) });
                    }
                }
            }
        }
        self.ends.extend(found);
    }

    /// False if the edge across the axis would lie inside the patch.
    fn is_allowed(&self, node: u32, leave: u32, turn: i32) -> bool {
        self.crossing(node).is_none_or(|dir| (1..=2 - turn).all(|k| G::turned(leave, k) != dir))
    }

    /// Distances from all states to the end, without prices.
    fn find_bounds(&mut self, graph: &Graph<G>, memory: &mut Memory<'_>) {
        let Memory { queue, pulse, .. } = memory;
        let mut bound = vec![NONE; (G::DIRECTIONS * self.n_half) as usize];
        queue.clear(0);
        for end in &self.ends {
            let known = &mut bound[end.state as usize];
            if end.cost < *known {
                *known = end.cost;
                queue.push(end.cost, end.state);
            }
        }
        while let Some((key, state)) = queue.pop() {
            if bound[state as usize] != key {
                continue;
            }
            if pulse.beat(1) {
                break;
            }
            let (node, dir) = (state / G::DIRECTIONS, state % G::DIRECTIONS);
            let here = key + 2 * graph.cost[node as usize];
            for before in self.beside(graph, node, G::turned(dir, G::OPPOSITE as i32)) {
                for &turn in G::TURNS.iter().filter(|&&turn| self.is_allowed(before, dir, turn)) {
                    let state = G::DIRECTIONS * before + G::turned(dir, -turn);
                    let through = here + 2 * turn.unsigned_abs() * TURN;
                    if through < bound[state as usize] {
                        bound[state as usize] = through;
                        queue.push(through, state);
                    }
                }
            }
        }
        self.bound = bound;
    }

    /// The cheapest symmetric closed path, prices on the nodes of the positive side and of the axis
    /// included.
    pub fn cheapest(&self, graph: &Graph<G>, prices: &Prices, memory: &mut Memory<'_>) -> Option<Walk<G>> {
        let Memory { queue, reached, parent, pulse } = memory;
        let n_states = G::DIRECTIONS * self.n_half;
        reached.clear();
        reached.resize(n_states as usize + self.ends.len(), NONE);
        parent.clear();
        parent.resize(reached.len(), NONE);
        let mut rules = prices;
        let mut first: Vec<(u32, State, u32)> = Vec::new();
        for (i, start) in (0..).zip(&self.starts) {
            let (node, enter) = (start.state / G::DIRECTIONS, start.state % G::DIRECTIONS);
            let mut cost = start.cost + rules.arrive(node, enter);
            if let Some((node, arrive, turn)) = start.from {
                cost += rules.arrive(node, arrive) + rules.inside(node, enter, turn);
            }
            let bound = self.bound[start.state as usize];
            if cost < BLOCKED && bound != NONE && cost < reached[start.state as usize] {
                reached[start.state as usize] = cost;
                // States number their starts from the far end.
                parent[start.state as usize] = NONE - 1 - i;
                first.push((cost + bound, start.state, cost));
            }
        }
        queue.clear(first.iter().map(|&(key, ..)| key).min()?);
        for (key, state, cost) in first {
            if reached[state as usize] == cost {
                queue.push(key, state);
            }
        }
        while let Some((key, state)) = queue.pop() {
            if state >= n_states {
                if reached[state as usize] != key {
                    continue;
                }
                return Some(self.unfold(graph, state, parent));
            }
            let so_far = reached[state as usize];
            if so_far + self.bound[state as usize] != key {
                continue;
            }
            if pulse.beat(1) {
                return None;
            }
            let (node, dir) = (state / G::DIRECTIONS, state % G::DIRECTIONS);
            let from = self.ends.partition_point(|end| end.state < state);
            for (k, end) in (from as u32..).zip(&self.ends[from..]).take_while(|(_, end)| end.state == state)
            {
                let leave = G::turned(dir, end.turn);
                let mut cost = so_far + end.cost + rules.inside(node, leave, end.turn);
                if let Some((last, turn)) = end.to {
                    cost += rules.arrive(last, leave) + rules.inside(last, self.continued(leave), turn);
                }
                let item = n_states + k;
                if cost - so_far < BLOCKED && cost < reached[item as usize] {
                    reached[item as usize] = cost;
                    parent[item as usize] = state;
                    queue.push(cost, item);
                }
            }
            for &turn in G::TURNS {
                let leave = G::turned(dir, turn);
                if !self.is_allowed(node, leave, turn) {
                    continue;
                }
                let inside = rules.inside(node, leave, turn);
                let cost = so_far + 2 * turn.unsigned_abs() * TURN + inside;
                for to in self.beside(graph, node, leave) {
                    let next = G::DIRECTIONS * to + leave;
                    let arrive = rules.arrive(to, leave);
                    let bound = self.bound[next as usize];
                    if inside.max(arrive) >= BLOCKED || bound == NONE {
                        continue;
                    }
                    let cost = cost + 2 * graph.cost[to as usize] + arrive;
                    if cost < reached[next as usize] {
                        reached[next as usize] = cost;
                        parent[next as usize] = state;
                        queue.push(cost + bound, next);
                    }
                }
            }
        }
        None
    }

    /// The whole path: the half that was found, then its mirror image on the way back.
    fn unfold(&self, graph: &Graph<G>, finish: State, parent: &[State]) -> Walk<G> {
        let n_states = G::DIRECTIONS * self.n_half;
        let end = &self.ends[(finish - n_states) as usize];
        let step = |node: u32, enter: u32| Step { node, enter: enter as u8, sheet: 0 };
        let mut half = Vec::new();
        let mut at = parent[finish as usize];
        while at < n_states {
            half.push(step(at / G::DIRECTIONS, at % G::DIRECTIONS));
            at = parent[at as usize];
        }
        half.reverse();
        let from = self.starts[(NONE - 1 - at) as usize].from;
        let leave_last = G::turned(end.state % G::DIRECTIONS, end.turn);
        let mut steps: Vec<Step> = from.iter().map(|&(node, enter, _)| step(node, enter)).collect();
        steps.extend(&half);
        steps.extend(end.to.map(|(node, _)| step(node, leave_last)));
        for (i, before) in half.iter().enumerate().rev() {
            let leave = half.get(i + 1).map_or(leave_last, |next| u32::from(next.enter));
            steps.push(step(before.node + self.n_half, self.continued(leave)));
        }
        let mut walk = Walk::new(steps);
        walk.cost = walk.base_cost(graph);
        walk
    }
}

/// Makes the parameters of a symmetric path symmetric: those of mirror images add up to `whole`.
pub(super) fn symmetric<G: Grid>(points: &[Axial], axis: Reflection, parameters: &mut [f64], whole: f64) {
    let n = points.len();
    // On the axis the first vertex is its own image; otherwise the last is.
    let on_axis = points.first().is_some_and(|&p| G::side(axis, p) == 0);
    let image = |i: usize| if on_axis { (n - i) % n } else { n - 1 - i };
    let own = parameters.to_vec();
    for (i, s) in parameters.iter_mut().enumerate() {
        *s = 0.5 * (whole + own[i] - own[image(i)]);
    }
    if on_axis {
        parameters[0] = 0.0;
    }
}
