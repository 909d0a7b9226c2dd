//! The cheapest closed path of exactly so many steps around a lattice of rings.
//!
//! Step k of the path belongs to loop vertex k from the start, as in [`crate::fill::planar`]'s exact search, so that
//! what each vertex wants can be priced. Paths run along a ring, up to the next one or down: once around, and never across
//! themselves.

use super::rings::{Node, Rings};
use crate::error::Result;
use crate::progress::Progress;

/// Cost of a triangle too many or too few at a vertex.
pub(super) const TURN: f64 = 1.0;

pub(super) const NEVER: f64 = 1e18;

/// Steps along a ring and rings that a vertex may be off its target.
const ALONG: i64 = 2;
const ACROSS: i64 = 2;
const WIDTH: usize = 2 * ALONG as usize + 1;
const CELLS: usize = WIDTH * (2 * ACROSS as usize + 1);
const STATES: usize = 3 * CELLS;

/// Which side of its path the patch is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Above,
    Below,
}

/// What a path should follow.
pub(super) struct Wishes<'a> {
    pub rings: &'a Rings,
    pub side: Side,
    /// The rings allowed.
    pub least: i64,
    pub most: i64,
    /// Where each vertex should be: around the axis, rising by less than 1 in all, and the ring.
    pub targets: &'a [Target],
}

/// Where a vertex should be, and what it wants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub around: f64,
    pub ring: f64,
    /// Triangles of the patch at the vertex.
    pub wanted: i64,
    /// Cost of a squared step along the ring, and of a squared ring, off the target.
    pub along: f64,
    pub across: f64,
}

/// How a path came to a vertex.
const LEVEL: usize = 0;
const RISING: usize = 1;
const FALLING: usize = 2;

/// A closed path and its cost.
pub(super) struct Path {
    pub nodes: Vec<Node>,
    pub cost: f64,
}

struct Layers<'a> {
    wishes: &'a Wishes<'a>,
    /// Of each layer, and the first once more a round later: the middle ring, and for each ring the middle vertex.
    rings: Vec<i64>,
    middles: Vec<[i64; 2 * ACROSS as usize + 1]>,
}

/// The ways on from the vertices of a layer, by their cells.
struct Moves {
    /// For each cell and way the cell in the next layer.
    to: [[u8; 3]; CELLS],
    /// Corners in each cell's vertex.
    corners: [i64; CELLS],
    /// Costs off the target, of the next layer's cells.
    off: [f64; CELLS],
    /// What triangles at a vertex without corners cost, by how the path came and how it goes on.
    turns: [[f64; 3]; 3],
}

/// There is no such way.
const NOWHERE: u8 = u8::MAX;

/// The path along ring 0, which is the only one of its length.
pub(super) fn straight(wishes: &Wishes<'_>) -> Path {
    let layers = Layers::new(wishes);
    let nodes = (0..wishes.targets.len() as i64).map(|at| Node { ring: 0, at }).collect::<Vec<_>>();
    let cost = |(layer, &node): (usize, &Node)| {
        let corners = wishes.rings.place(node).corners;
        let turn = layers.turn(layer, corners, LEVEL, LEVEL).unwrap_or(NEVER);
        turn + layers.off(layer, node, wishes.rings.around(node))
    };
    let cost = nodes.iter().enumerate().map(cost).sum();
    Path { nodes, cost }
}

/// The cheapest path, if there is one that costs less than `most`.
///
/// The start is that of the cheapest path a little more than once around which need not close; from there all is exact.
pub(super) fn route(wishes: &Wishes<'_>, most: f64, progress: Progress<'_>) -> Result<Option<Path>> {
    let n = wishes.targets.len();
    let layers = Layers::new(wishes);
    progress.report(0.0)?;
    // Further than once around, for the start.
    let more = (n / 3).clamp(3, 30);
    let moves = (0..n + more).map(|layer| layers.moves(layer)).collect::<Vec<_>>();
    let Some(start) = layers.start(&moves, most) else { return Ok(None) };
    progress.report(0.5)?;
    let mut open = [NEVER; STATES];
    open[start] = 0.0;
    let (last, came) = layers.run(open, &moves[..n], most);
    if last[start] >= NEVER {
        return Ok(None);
    }
    let mut nodes = vec![Node::default(); n];
    let mut state = start;
    for layer in (1..=n).rev() {
        state = came[layer - 1][state] as usize;
        nodes[layer - 1] = layers.node(layer - 1, state);
    }
    Ok(Some(Path { nodes, cost: last[start] }))
}

impl<'a> Layers<'a> {
    fn new(wishes: &'a Wishes<'a>) -> Self {
        let (mut rings, mut middles) = (vec![], vec![]);
        for target in wishes.targets {
            let ring = (target.ring.round() as i64).clamp(wishes.least, wishes.most);
            rings.push(ring);
            middles.push(std::array::from_fn(|row| {
                let ring = (ring + row as i64 - ACROSS).clamp(wishes.least, wishes.most);
                wishes.rings.nearest(ring, target.around)
            }));
        }
        Layers { wishes, rings, middles }
    }

    fn len(&self) -> usize {
        self.rings.len()
    }

    /// The vertex of a state of a layer; layers go on beyond the last.
    fn node(&self, layer: usize, state: usize) -> Node {
        let cell = state / 3;
        let (row, column) = (cell / WIDTH, cell % WIDTH);
        let (round, layer) = (layer / self.len(), layer % self.len());
        let ring = self.rings[layer] + row as i64 - ACROSS;
        let at = self.middles[layer][row] + column as i64 - ALONG;
        Node { ring, at: at + round as i64 * self.wishes.rings.len(ring) }
    }

    /// The cell of a vertex in a layer.
    fn cell(&self, layer: usize, node: Node) -> Option<usize> {
        let (round, layer) = (layer / self.len(), layer % self.len());
        let row = node.ring - self.rings[layer] + ACROSS;
        if !(0..=2 * ACROSS).contains(&row) || !(self.wishes.least..=self.wishes.most).contains(&node.ring) {
            return None;
        }
        let at = node.at - round as i64 * self.wishes.rings.len(node.ring);
        let column = at - self.middles[layer][row as usize] + ALONG;
        (0..WIDTH as i64).contains(&column).then(|| row as usize * WIDTH + column as usize)
    }

    /// Cost of a vertex off its target.
    fn off(&self, layer: usize, node: Node, around: f64) -> f64 {
        let target = &self.wishes.targets[layer % self.len()];
        let round = (layer / self.len()) as f64;
        let along = (around - round - target.around) * self.wishes.rings.len(node.ring) as f64;
        let across = node.ring as f64 - target.ring;
        target.along * along * along + target.across * across * across
    }

    /// The ways on from all vertices of a layer.
    fn moves(&self, layer: usize) -> Moves {
        let Wishes { rings, least, most, .. } = *self.wishes;
        let mut moves = Moves {
            to: [[NOWHERE; 3]; CELLS],
            corners: [0; CELLS],
            off: [NEVER; CELLS],
            turns: [[NEVER; 3]; 3],
        };
        for entered in [LEVEL, RISING, FALLING] {
            for left in [LEVEL, RISING, FALLING] {
                moves.turns[entered][left] = self.turn(layer, 0, entered, left).unwrap_or(NEVER);
            }
        }
        let next = (layer + 1) % self.len();
        for cell in 0..CELLS {
            let row = (cell / WIDTH) as i64 - ACROSS;
            if (least..=most).contains(&(self.rings[next] + row)) {
                let node = self.node(layer + 1, 3 * cell);
                moves.off[cell] = self.off(layer + 1, node, rings.around(node));
            }
            if !(least..=most).contains(&(self.rings[layer % self.len()] + row)) {
                continue;
            }
            let node = self.node(layer, 3 * cell);
            let place = rings.place(node);
            moves.corners[cell] = place.corners;
            let mut go = |way: usize, next: Node| {
                moves.to[cell][way] = self.cell(layer + 1, next).map_or(NOWHERE, |to| to as u8);
            };
            go(LEVEL, Node { at: node.at + 1, ..node });
            go(RISING, place.up(node)[1]);
            // From a corner down is the ray itself, which would be entered from no side.
            if node.ring > rings.first && place.corners == 0 {
                go(FALLING, place.down(node));
            }
        }
        moves
    }

    /// Costs of all states after so many layers, and for each layer and state the one before.
    fn run(&self, open: [f64; STATES], moves: &[Moves], most: f64) -> ([f64; STATES], Vec<[u8; STATES]>) {
        let (mut here, mut came) = (open, Vec::with_capacity(moves.len()));
        for (layer, moves) in moves.iter().enumerate() {
            let mut there = [NEVER; STATES];
            let mut from = [0u8; STATES];
            for cell in 0..CELLS {
                for way in [LEVEL, RISING, FALLING] {
                    let to = moves.to[cell][way];
                    if to == NOWHERE {
                        continue;
                    }
                    let (off, slot) = (moves.off[to as usize], 3 * to as usize + way);
                    for entered in [LEVEL, RISING, FALLING] {
                        let so_far = here[3 * cell + entered];
                        if so_far >= most {
                            continue;
                        }
                        let turn = match moves.corners[cell] {
                            0 => moves.turns[entered][way],
                            corners => self.turn(layer, corners, entered, way).unwrap_or(NEVER),
                        };
                        if turn >= NEVER {
                            continue;
                        }
                        let cost = so_far + turn + off;
                        if cost < there[slot] {
                            there[slot] = cost;
                            from[slot] = (3 * cell + entered) as u8;
                        }
                    }
                }
            }
            here = there;
            came.push(from);
        }
        (here, came)
    }

    /// The cost of the triangles at a vertex.
    fn turn(&self, layer: usize, corners: i64, entered: usize, left: usize) -> Option<f64> {
        // Edges up, and in all; sides are counted counter-clockwise from the step along the ring.
        let up = 2 + corners;
        let came = match entered {
            LEVEL => up + 1,
            RISING => up + 2,
            _ => up,
        };
        let goes = match left {
            LEVEL => 0,
            RISING => 1,
            _ => -1,
        };
        let triangles = match self.wishes.side {
            Side::Above => came - goes,
            Side::Below => 6 + goes - came,
        };
        let off = triangles - self.wishes.targets[layer % self.len()].wanted;
        (triangles >= 2).then(|| TURN * turn_cost(off))
    }

    /// The state in which a path that need not close is after a round.
    fn start(&self, moves: &[Moves], most: f64) -> Option<usize> {
        let mut open = [NEVER; STATES];
        for cell in 0..CELLS {
            let node = self.node(0, 3 * cell);
            if self.cell(0, node).is_some() {
                open[3 * cell] = self.off(0, node, self.wishes.rings.around(node));
            }
        }
        let (last, came) = self.run(open, moves, 2.0 * most.min(0.4 * NEVER));
        let best = (0..STATES).min_by(|&a, &b| last[a].total_cmp(&last[b]))?;
        if last[best] >= NEVER {
            return None;
        }
        let mut state = best;
        for layer in (self.len() + 1..=moves.len()).rev() {
            state = came[layer - 1][state] as usize;
        }
        Some(state)
    }
}

/// Too few triangles are worse than too many: their angles have no upper bound.
fn turn_cost(off: i64) -> f64 {
    match off {
        0.. => off as f64,
        -1 => 1.0,
        _ => -2.0 * off as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets(n: usize, ring: impl Fn(f64) -> f64) -> Vec<Target> {
        let target = |k: usize| {
            let around = k as f64 / n as f64;
            Target { around, ring: ring(around), wanted: 3, along: 0.1, across: 0.3 }
        };
        (0..n).map(target).collect()
    }

    fn path(rings: &Rings, n: usize, ring: impl Fn(f64) -> f64, least: i64) -> Option<Path> {
        let targets = targets(n, ring);
        let wishes = Wishes { rings, side: Side::Below, least, most: 30, targets: &targets };
        route(&wishes, NEVER, Progress::NONE).unwrap()
    }

    #[test]
    fn paths_have_the_length_of_their_loop_and_close() {
        let cylinder = Rings::new(40, vec![], vec![]);
        let straight = path(&cylinder, 40, |_| 5.0, 1).unwrap();
        assert!(straight.nodes.iter().all(|node| node.ring == 5));
        for more in 1..8 {
            let path = path(&cylinder, 40 + more, |s| 5.0 + (6.3 * s).cos(), 1).unwrap();
            let n = path.nodes.len();
            let rises = (0..n).filter(|&k| path.nodes[(k + 1) % n].ring > path.nodes[k].ring).count();
            assert_eq!((n, rises), (40 + more, more));
        }
        let cone =
            Rings::new(12, (0..6).map(|a| 2 * a).collect(), (0..6).map(|a| f64::from(a) / 6.0).collect());
        let corners = path(&cone, 36, |_| 4.0, 1).unwrap();
        assert!(corners.nodes.iter().all(|node| node.ring == 4));
    }

    #[test]
    fn what_cannot_close_is_none() {
        let cylinder = Rings::new(40, vec![], vec![]);
        assert!(path(&cylinder, 39, |_| 5.0, 1).is_none());
    }
}
