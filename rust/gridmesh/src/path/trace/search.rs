//! Shortest closed paths over (place, incoming direction).

use std::marker::PhantomData;

use crate::lattice::axial::Axial;
use crate::lattice::grid::{Grid, Triangular};

use super::graph::{BLOCKED, Graph, State, TURN};
use super::prices::Prices;
use super::pulse::Pulse;
use super::queue::Queue;

const NONE: u32 = u32::MAX;

/// A closed path in one band.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Walk<G = Triangular> {
    pub steps: Vec<Step>,
    /// Search cost without prices.
    pub cost: u32,
    grid: PhantomData<G>,
}

/// A vertex of a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Step {
    pub node: u32,
    /// Direction of the step that arrived.
    pub enter: u8,
    /// Turns around the curve made so far: 0 or 1, now and then one more or less.
    pub sheet: i8,
}

/// What a transition costs beyond turns and distance.
pub(super) trait Rules {
    /// For arriving at a node by a direction.
    fn arrive(&mut self, node: u32, dir: u32) -> u32;
    /// For turning by `turn` at a node and leaving by `out`.
    fn inside(&mut self, node: u32, out: u32, turn: i32) -> u32;
}

impl Rules for &Prices {
    #[inline]
    fn arrive(&mut self, node: u32, dir: u32) -> u32 {
        self.of(node).map_or(0, |extra| extra.arrive[dir as usize])
    }

    #[inline]
    fn inside(&mut self, node: u32, out: u32, turn: i32) -> u32 {
        self.of(node).map_or(0, |extra| extra.inside(out, turn))
    }
}

/// Lower bounds on the cost from each state to the end of a closed path.
#[derive(Default)]
pub(super) struct Potential {
    bound: Vec<u32>,
    /// The starts, best first, with their bounds.
    pub starts: Vec<(u32, State)>,
}

/// Memory for searches, reused. Searches that are stopped find nothing: see [`Pulse::is_stopped`].
pub(super) struct Search<'a> {
    queue: Queue,
    reached: Vec<u32>,
    parent: Vec<State>,
    touched: Vec<State>,
    pub pulse: Pulse<'a>,
}

impl<'a> Search<'a> {
    pub fn new(pulse: Pulse<'a>) -> Self {
        Self { queue: Queue::new(), reached: Vec::new(), parent: Vec::new(), touched: Vec::new(), pulse }
    }

    fn make_room(&mut self, states: usize) {
        if self.reached.len() < states {
            self.reached.resize(states, NONE);
            self.parent.resize(states, NONE);
        }
    }

    fn reset(&mut self) {
        for &state in &self.touched {
            self.reached[state as usize] = NONE;
        }
        self.touched.clear();
    }

    /// Distances, without prices, from all states to the nearest start on the second sheet.
    ///
    /// Stops when all starts on the first sheet are known; what is farther counts as that far.
    pub fn potential<G: Grid>(&mut self, graph: &Graph<G>) -> Potential {
        let n = graph.n_nodes() as u32;
        let mut bound = vec![NONE; graph.n_states()];
        let mut starts = graph.starts();
        let mut missing = starts.len();
        let mut is_start = vec![false; G::DIRECTIONS as usize * graph.n_second];
        self.queue.clear(0);
        for &start in &starts {
            bound[(start + G::DIRECTIONS * n) as usize] = 0;
            is_start[start as usize] = true;
            self.queue.push(0, start + G::DIRECTIONS * n);
        }
        let mut farthest = 0;
        while let Some((key, state)) = self.queue.pop() {
            if bound[state as usize] != key {
                continue;
            }
            if self.pulse.beat(1) {
                break;
            }
            farthest = key;
            if is_start.get(state as usize) == Some(&true) {
                is_start[state as usize] = false;
                missing -= 1;
                if missing == 0 {
                    break;
                }
            }
            let (place, dir) = (state / G::DIRECTIONS, state % G::DIRECTIONS);
            let (node, sheet) = if place < n { (place, 0) } else { (place - n, 1) };
            let here = key + graph.cost[node as usize];
            for &link in graph.links(node, G::turned(dir, G::OPPOSITE as i32)) {
                let Some(before) = graph.follow(link, sheet) else {
                    continue;
                };
                for &turn in G::TURNS {
                    let known = &mut bound[(G::DIRECTIONS * before + G::turned(dir, -turn)) as usize];
                    let through = here + turn.unsigned_abs() * TURN;
                    if through < *known {
                        *known = through;
                        self.queue.push(through, G::DIRECTIONS * before + G::turned(dir, -turn));
                    }
                }
            }
        }
        let complete = missing > 0;
        for value in &mut bound {
            // If the queue ran dry the unreached states lead nowhere.
            if !(complete && *value == NONE) {
                *value = (*value).min(farthest);
            }
        }
        starts.retain(|&start| bound[start as usize] != NONE);
        let mut starts: Vec<(u32, State)> =
            starts.into_iter().map(|start| (bound[start as usize], start)).collect();
        starts.sort_unstable();
        Potential { bound, starts }
    }

    /// The cheapest closed path once around that costs less than `limit`, prices included; and its
    /// priced cost.
    pub fn closed<G: Grid>(
        &mut self,
        graph: &Graph<G>,
        potential: &Potential,
        prices: &Prices,
        limit: u32,
    ) -> Option<(Walk<G>, u32)> {
        let mut best = limit;
        let mut walk = None;
        for &(bound, start) in &potential.starts {
            if bound >= best {
                break;
            }
            if let Some((found, cost)) = self.once_round(graph, potential, prices, start, best) {
                best = cost;
                walk = Some(found);
            }
        }
        walk.map(|walk| (walk, best))
    }

    /// A* from a start on the first sheet to the same state on the second.
    fn once_round<G: Grid>(
        &mut self,
        graph: &Graph<G>,
        potential: &Potential,
        prices: &Prices,
        start: State,
        limit: u32,
    ) -> Option<(Walk<G>, u32)> {
        let goal = start + G::DIRECTIONS * graph.n_nodes() as u32;
        let bound = &potential.bound;
        self.make_room(graph.n_states());
        let found = self.run(
            graph,
            prices,
            |state| bound[state as usize],
            |link, sheet| graph.follow(link, sheet),
            (start, goal),
            limit,
        );
        let walk = found.map(|cost| {
            let mut walk = Walk::new(self.steps(graph, start, goal));
            walk.cost = walk.base_cost(graph);
            (walk, cost)
        });
        self.reset();
        walk
    }

    /// The cheapest way from one vertex of a walk to a later one; the steps after the first, and
    /// their cost. Indices beyond the walk's length go round once more.
    pub fn between<G: Grid>(
        &mut self,
        graph: &Graph<G>,
        potential: &Potential,
        rules: impl Rules,
        (walk, from, to): (&Walk<G>, usize, usize),
        limit: u32,
    ) -> Option<(Vec<Step>, u32)> {
        let n = graph.n_nodes() as u32;
        let turn = |i: usize| walk.step(i).sheet + i8::from(i >= walk.len());
        let state = |i: usize, sheet: u32| {
            let step = walk.step(i);
            G::DIRECTIONS * (step.node + sheet * n) + u32::from(step.enter)
        };
        let flat = (from..=to).all(|i| turn(i) == 0);
        let (found, start, goal, base) = if flat {
            // The potential is a difference: what it says of the way to the goal is a lower bound.
            let (start, goal) = (state(from, 0), state(to, 0));
            let bound = &potential.bound;
            self.make_room((G::DIRECTIONS * n) as usize);
            let found = self.run(
                graph,
                rules,
                |state| bound[state as usize],
                |link, _| (link & 3 == 1).then_some(link >> 2),
                (start, goal),
                limit.saturating_add(bound[goal as usize]),
            );
            (found, start, goal, 0)
        } else {
            let ahead = u32::try_from(turn(to) - turn(from) + 1).ok().filter(|&k| k < 3)?;
            let (start, goal) = (state(from, 1), state(to, ahead));
            self.make_room((3 * G::DIRECTIONS * n) as usize);
            let found = self.run(
                graph,
                rules,
                |_| 0,
                |link, sheet| {
                    let sheet = (sheet + (link & 3)).wrapping_sub(1);
                    (sheet < 3).then(|| (link >> 2) + sheet * n)
                },
                (start, goal),
                limit,
            );
            (found, start, goal, turn(from) - 1)
        };
        let steps = found.map(|cost| {
            let mut steps = self.steps(graph, start, goal);
            for step in &mut steps {
                step.sheet += base;
            }
            (steps, cost)
        });
        self.reset();
        steps
    }

    /// A* between two states; `key` gives a consistent lower bound up to a constant.
    fn run<G: Grid>(
        &mut self,
        graph: &Graph<G>,
        mut rules: impl Rules,
        bound: impl Fn(State) -> u32,
        follow: impl Fn(u32, u32) -> Option<u32>,
        (start, goal): (State, State),
        limit: u32,
    ) -> Option<u32> {
        let n = graph.n_nodes() as u32;
        self.queue.clear(bound(start));
        self.reached[start as usize] = 0;
        self.parent[start as usize] = NONE;
        self.touched.push(start);
        self.queue.push(bound(start), start);
        while let Some((key, state)) = self.queue.pop() {
            let so_far = self.reached[state as usize];
            if so_far + bound(state) != key {
                continue;
            }
            if self.pulse.beat(1) {
                return None;
            }
            if state == goal {
                return Some(so_far);
            }
            let (place, dir) = (state / G::DIRECTIONS, state % G::DIRECTIONS);
            let (mut node, mut sheet) = (place, 0);
            while node >= n {
                node -= n;
                sheet += 1;
            }
            for &turn in G::TURNS {
                let out = G::turned(dir, turn);
                let links = graph.links(node, out);
                if links.is_empty() {
                    continue;
                }
                let inside = rules.inside(node, out, turn);
                if inside >= BLOCKED {
                    continue;
                }
                let cost = so_far + turn.unsigned_abs() * TURN + inside;
                for &link in links {
                    let Some(next) = follow(link, sheet) else {
                        continue;
                    };
                    let to = link >> 2;
                    let arrive = rules.arrive(to, out);
                    if arrive >= BLOCKED {
                        continue;
                    }
                    let cost = cost + graph.cost[to as usize] + arrive;
                    let next = G::DIRECTIONS * next + out;
                    let known = self.reached[next as usize];
                    if cost >= known {
                        continue;
                    }
                    let key = cost.saturating_add(bound(next));
                    if key >= limit {
                        continue;
                    }
                    if known == NONE {
                        self.touched.push(next);
                    }
                    self.reached[next as usize] = cost;
                    self.parent[next as usize] = state;
                    self.queue.push(key, next);
                }
            }
        }
        None
    }

    /// The steps after `start` on the way found to `goal`.
    fn steps<G: Grid>(&self, graph: &Graph<G>, start: State, goal: State) -> Vec<Step> {
        let n = graph.n_nodes() as u32;
        let mut steps = Vec::new();
        let mut at = goal;
        while at != start {
            let place = at / G::DIRECTIONS;
            steps.push(Step { node: place % n, enter: (at % G::DIRECTIONS) as u8, sheet: (place / n) as i8 });
            at = self.parent[at as usize];
        }
        steps.reverse();
        steps
    }
}

impl<G: Grid> Walk<G> {
    /// Of some steps, its cost still unknown.
    pub fn new(steps: Vec<Step>) -> Self {
        Self { steps, cost: 0, grid: PhantomData }
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Vertex `i`, of any turn below two.
    pub fn step(&self, i: usize) -> Step {
        let n = self.steps.len();
        self.steps[if i < n { i } else { i - n }]
    }

    /// Node of the vertex `i`.
    pub fn node(&self, i: usize) -> u32 {
        self.step(i).node
    }

    /// The lattice points in order.
    pub fn points(&self, graph: &Graph<G>) -> impl Iterator<Item = Axial> {
        self.steps.iter().map(|step| graph.points[step.node as usize])
    }

    /// Direction of the step that leaves vertex `i`.
    pub fn leave(&self, i: usize) -> u32 {
        u32::from(self.step(i + 1).enter)
    }

    /// The turn at vertex `i`.
    pub fn turn(&self, i: usize) -> i32 {
        G::turn(u32::from(self.step(i).enter), self.leave(i))
    }

    /// The sum of absolute turns.
    pub fn turns(&self) -> u32 {
        (0..self.len()).map(|i| self.turn(i).unsigned_abs()).sum()
    }

    /// Search cost without prices.
    pub fn base_cost(&self, graph: &Graph<G>) -> u32 {
        (0..self.len()).map(|i| graph.cost[self.node(i) as usize] + self.turn(i).unsigned_abs() * TURN).sum()
    }

    /// Replaces the vertices after `from` up to `to` (below one turn later) by others.
    ///
    /// `cost` is left to the caller.
    pub fn splice(&mut self, from: usize, to: usize, steps: &[Step]) {
        let n = self.len();
        if to < n {
            self.steps.splice(from + 1..=to, steps.iter().copied());
        } else {
            let kept = self.steps[to - n + 1..=from].to_vec();
            self.steps = kept;
            self.steps.extend_from_slice(steps);
        }
    }
}
