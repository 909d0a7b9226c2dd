//! The fewest turns that any closed path near a curve makes.

use crate::lattice::grid::Grid;

use super::graph::{Graph, State};
use super::pulse::Pulse;

const NONE: u32 = u32::MAX;

/// States by number of turns; keys may be smaller than the last one taken only by mistake.
#[derive(Default)]
struct Levels {
    stacks: Vec<Vec<State>>,
    least: usize,
}

impl Levels {
    fn clear(&mut self) {
        self.stacks.iter_mut().for_each(Vec::clear);
        self.least = 0;
    }

    #[inline]
    fn push(&mut self, level: u32, state: State) {
        if self.stacks.len() <= level as usize {
            self.stacks.resize_with(level as usize + 1, Vec::new);
        }
        self.stacks[level as usize].push(state);
    }

    #[inline]
    fn pop(&mut self) -> Option<(u32, State)> {
        while let Some(stack) = self.stacks.get_mut(self.least) {
            if let Some(state) = stack.pop() {
                return Some((self.least as u32, state));
            }
            self.least += 1;
        }
        None
    }
}

/// The fewest turns of the closed paths once round a band, conflicts and distances disregarded, or
/// `known` if none makes fewer.
///
/// Like the search for the cheapest path (a lower bound from every state, then the starts one by
/// one), but turns are few and small numbers: sorting them takes no time. And they are even, since a
/// closed path ends in the direction it began with.
pub(super) fn fewest_turns<G: Grid>(graph: &Graph<G>, known: u32, pulse: &mut Pulse<'_>) -> u32 {
    // A closed path turns by a full circle in all.
    if known <= G::DIRECTIONS {
        return known;
    }
    let limit = known - u32::from(known < NONE);
    let n = graph.n_nodes() as u32;
    let starts = graph.starts();
    let mut levels = Levels::default();
    let bound = bounds(graph, &starts, limit, &mut levels, pulse);
    let mut starts: Vec<(u32, State)> =
        starts.into_iter().map(|start| (bound[start as usize], start)).filter(|s| s.0 < limit).collect();
    starts.sort_unstable();
    let mut fewest = known;
    let mut reached = vec![NONE; if starts.is_empty() { 0 } else { graph.n_states() }];
    let mut touched: Vec<State> = Vec::new();
    for (least, start) in starts {
        if least + 1 >= fewest {
            break;
        }
        levels.clear();
        for state in touched.drain(..) {
            reached[state as usize] = NONE;
        }
        reached[start as usize] = 0;
        touched.push(start);
        levels.push(least, start);
        while let Some((key, state)) = levels.pop() {
            let so_far = reached[state as usize];
            if so_far + bound[state as usize] != key {
                continue;
            }
            if pulse.beat(1) {
                return fewest;
            }
            if state == start + G::DIRECTIONS * n {
                fewest = so_far;
                break;
            }
            let (place, dir) = (state / G::DIRECTIONS, state % G::DIRECTIONS);
            let (node, sheet) = if place < n { (place, 0) } else { (place - n, 1) };
            for &turn in G::TURNS {
                let out = G::turned(dir, turn);
                let turns = so_far + turn.unsigned_abs();
                for next in graph.links(node, out).iter().filter_map(|&link| graph.follow(link, sheet)) {
                    let next = G::DIRECTIONS * next + out;
                    let key = turns.saturating_add(bound[next as usize]);
                    if turns < reached[next as usize] && key < fewest {
                        if reached[next as usize] == NONE {
                            touched.push(next);
                        }
                        reached[next as usize] = turns;
                        levels.push(key, next);
                    }
                }
            }
        }
    }
    fewest
}

/// Turns from each state to the nearest start on the second sheet, as far as they are below a limit.
fn bounds<G: Grid>(
    graph: &Graph<G>,
    starts: &[State],
    limit: u32,
    levels: &mut Levels,
    pulse: &mut Pulse<'_>,
) -> Vec<u32> {
    let n = graph.n_nodes() as u32;
    let mut bound = vec![NONE; graph.n_states()];
    for &start in starts {
        bound[(start + G::DIRECTIONS * n) as usize] = 0;
        levels.push(0, start + G::DIRECTIONS * n);
    }
    while let Some((turns, state)) = levels.pop() {
        if bound[state as usize] != turns {
            continue;
        }
        if pulse.beat(1) {
            break;
        }
        let (place, dir) = (state / G::DIRECTIONS, state % G::DIRECTIONS);
        let (node, sheet) = if place < n { (place, 0) } else { (place - n, 1) };
        for before in graph
            .links(node, G::turned(dir, G::OPPOSITE as i32))
            .iter()
            .filter_map(|&link| graph.follow(link, sheet))
        {
            for &turn in G::TURNS {
                let before = G::DIRECTIONS * before + G::turned(dir, -turn);
                let through = turns + turn.unsigned_abs();
                if through < bound[before as usize] && through < limit {
                    bound[before as usize] = through;
                    levels.push(through, before);
                }
            }
        }
    }
    bound
}
