//! Shortest closed paths over (place, incoming direction).

use super::graph::{BLOCKED, Graph, State, TURN};
use super::prices::Prices;
use super::queue::Queue;

/// Turns of a patch boundary. Two steps left make a tip with an edge across; three turn back.
pub(super) const TURNS: [i32; 4] = [0, 1, -1, -2];
const NONE: u32 = u32::MAX;

/// A closed path in one band: for each vertex its node, the direction of the step that arrived,
/// and the sheet (0, or 1 where it runs ahead past the cut).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Walk {
    pub states: Vec<State>,
    /// Search cost without prices.
    pub cost: u32,
}

/// Lower bounds on the cost from each state to the end of a closed path.
pub(super) struct Potential {
    bound: Vec<u32>,
    /// The starts, best first, with their bounds.
    pub starts: Vec<(u32, State)>,
}

/// Memory for searches, reused.
pub(super) struct Search {
    queue: Queue,
    reached: Vec<u32>,
    parent: Vec<State>,
    touched: Vec<State>,
    /// States taken from the queue so far, for measuring.
    pub taken: u64,
}

#[inline]
fn turned(dir: u32, turn: i32) -> u32 {
    let d = dir as i32 + turn + 6;
    (if d >= 12 {
        d - 12
    } else if d >= 6 {
        d - 6
    } else {
        d
    }) as u32
}

impl Search {
    pub fn new() -> Self {
        Self {
            queue: Queue::new(),
            reached: Vec::new(),
            parent: Vec::new(),
            touched: Vec::new(),
            taken: 0,
        }
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
    pub fn potential(&mut self, graph: &Graph) -> Potential {
        let n = graph.n_nodes() as u32;
        let mut bound = vec![NONE; graph.n_states()];
        let mut starts = graph.starts();
        let mut missing = starts.len();
        let mut is_start = vec![false; 6 * graph.n_second];
        self.queue.clear(0);
        for &start in &starts {
            bound[(start + 6 * n) as usize] = 0;
            is_start[start as usize] = true;
            self.queue.push(0, start + 6 * n);
        }
        let mut farthest = 0;
        while let Some((key, state)) = self.queue.pop() {
            if bound[state as usize] != key {
                continue;
            }
            self.taken += 1;
            farthest = key;
            if is_start.get(state as usize) == Some(&true) {
                is_start[state as usize] = false;
                missing -= 1;
                if missing == 0 {
                    break;
                }
            }
            let (place, dir) = (state / 6, state % 6);
            let (node, sheet) = if place < n {
                (place, 0)
            } else {
                (place - n, 1)
            };
            let here = key + graph.cost[node as usize];
            for &link in graph.links(node, turned(dir, 3)) {
                let Some(before) = graph.follow_back(link, sheet) else {
                    continue;
                };
                for turn in TURNS {
                    let known = &mut bound[(6 * before + turned(dir, -turn)) as usize];
                    let through = here + turn.unsigned_abs() * TURN;
                    if through < *known {
                        *known = through;
                        self.queue.push(through, 6 * before + turned(dir, -turn));
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
        let mut starts: Vec<(u32, State)> = starts
            .into_iter()
            .map(|start| (bound[start as usize], start))
            .collect();
        starts.sort_unstable();
        Potential { bound, starts }
    }

    /// The cheapest closed path once around that costs less than `limit`, prices included; and its
    /// priced cost.
    pub fn closed(
        &mut self,
        graph: &Graph,
        potential: &Potential,
        prices: &Prices,
        limit: u32,
    ) -> Option<(Walk, u32)> {
        let mut best = limit;
        let mut walk = None;
        for &(bound, start) in &potential.starts {
            if bound >= best {
                break;
            }
            if let Some((found, cost)) = self.from_start(graph, potential, prices, start, best) {
                best = cost;
                walk = Some(found);
            }
        }
        walk.map(|walk| (walk, best))
    }

    /// A* from a start on the first sheet to the same state on the second.
    fn from_start(
        &mut self,
        graph: &Graph,
        potential: &Potential,
        prices: &Prices,
        start: State,
        limit: u32,
    ) -> Option<(Walk, u32)> {
        let n = graph.n_nodes() as u32;
        let goal = start + 6 * n;
        let bound = &potential.bound;
        self.make_room(graph.n_states());
        self.queue.clear(bound[start as usize]);
        self.reached[start as usize] = 0;
        self.parent[start as usize] = NONE;
        self.touched.push(start);
        self.queue.push(bound[start as usize], start);
        let mut found = None;
        while let Some((key, state)) = self.queue.pop() {
            let so_far = self.reached[state as usize];
            if so_far + bound[state as usize] != key {
                continue;
            }
            self.taken += 1;
            if state == goal {
                found = Some(so_far);
                break;
            }
            let (place, dir) = (state / 6, state % 6);
            let (node, sheet) = if place < n {
                (place, 0)
            } else {
                (place - n, 1)
            };
            let extra = prices.of(node);
            for turn in TURNS {
                let out = turned(dir, turn);
                let mut cost = so_far + turn.unsigned_abs() * TURN;
                if let Some(extra) = extra {
                    cost += extra.inside(out, turn);
                }
                for &link in graph.links(node, out) {
                    let Some(next) = graph.follow(link, sheet) else {
                        continue;
                    };
                    let to = link >> 2;
                    let mut cost = cost + graph.cost[to as usize];
                    if let Some(extra) = prices.of(to) {
                        cost += extra.arrive[out as usize];
                    }
                    let next = 6 * next + out;
                    let known = self.reached[next as usize];
                    if cost >= known || cost >= limit {
                        continue;
                    }
                    let key = cost.saturating_add(bound[next as usize]);
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
        let walk = found.map(|cost| {
            let mut states = Vec::new();
            let mut at = goal;
            while at != start {
                states.push(at);
                at = self.parent[at as usize];
            }
            states.reverse();
            let mut walk = Walk { states, cost: 0 };
            walk.cost = walk.price(graph, None);
            (walk, cost)
        });
        self.reset();
        walk
    }
}

impl Walk {
    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Node of the vertex `i`.
    pub fn node(&self, graph: &Graph, i: usize) -> u32 {
        graph.node(self.states[i] / 6)
    }

    /// Direction of the step that arrives at vertex `i`.
    pub fn enter(&self, i: usize) -> u32 {
        self.states[i] % 6
    }

    /// Direction of the step that leaves vertex `i`.
    pub fn leave(&self, i: usize) -> u32 {
        self.states[if i + 1 < self.states.len() { i + 1 } else { 0 }] % 6
    }

    /// The turn at vertex `i`.
    pub fn turn(&self, i: usize) -> i32 {
        let turn = (self.leave(i) + 6 - self.enter(i)) % 6;
        if turn > 3 {
            turn as i32 - 6
        } else {
            turn as i32
        }
    }

    /// Search cost, with prices if there are any.
    pub fn price(&self, graph: &Graph, prices: Option<&Prices>) -> u32 {
        (0..self.len())
            .map(|i| {
                let node = self.node(graph, i);
                let turn = self.turn(i);
                let extra = prices.and_then(|prices| prices.of(node));
                graph.cost[node as usize]
                    + turn.unsigned_abs() * TURN
                    + extra.map_or(0, |extra| {
                        extra.inside(self.leave(i), turn) + extra.arrive[self.enter(i) as usize]
                    })
            })
            .fold(0, |sum, cost| sum.saturating_add(cost).min(BLOCKED))
    }
}
