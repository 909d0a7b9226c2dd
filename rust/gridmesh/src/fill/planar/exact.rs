//! The closed lattice path of exactly n steps that follows n target points at least cost.
//!
//! Step k of the path belongs to loop vertex k from the start, so that what a vertex wants of the
//! patch (its valence, its angle) can be priced vertex by vertex. The search is a shortest path
//! through n layers: layer k holds the lattice points near target k, each with the direction in
//! which it is entered. A sweep backwards bounds the cost to go from every state; then each start
//! that can still win is tried forwards, pruned by that bound. Costs are integers.
//!
//! Paths that meet themselves, and edges across the patch that the mesh already has, are priced
//! away: both ends become dearer and the search runs again.

use std::marker::PhantomData;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::steps::Steps;
use crate::error::Result;
use crate::lattice::axial::Axial;
use crate::progress::Progress;

/// Directions of a grid, at most.
const DIRECTIONS: usize = 6;

/// Integer cost of one turn.
pub(in crate::fill) const TURN: u32 = 64;

/// Starts tried when the search runs again with prices.
const REPAIR_STARTS: usize = 2;

/// Conflicts left after some rounds that end the search.
const HOPELESS: usize = 8;

const NEVER: u32 = 1 << 30;

/// What a path should follow, and at what price.
pub(in crate::fill) struct Wishes<'a> {
    /// Position of each vertex, in lattice units.
    pub target: &'a [DVec2],
    /// Cost of turning by -2 to 2 at each vertex.
    pub turns: &'a [[u32; 5]],
    /// Cost of a squared distance of one from the target.
    pub closeness: f64,
    /// Lattice steps from the target's nearest lattice point that a vertex may be off.
    pub reach: i32,
}

/// The layers with the bounds and prices on them.
///
/// A *cell* is a lattice point of a layer; a *state* is a cell with the direction in which the path
/// enters it. The number of a cell beyond the last stands for all points outside the layer.
pub(in crate::fill) struct Layers<'a, G> {
    wishes: &'a Wishes<'a>,
    /// Offsets of the cells of a layer from its centre.
    stencil: Vec<Axial>,
    centres: Vec<Axial>,
    /// For each layer, which of `tables` leads to the next one.
    table: Vec<u16>,
    /// For each cell and direction the cell of the next layer that it leads to, by the shift
    /// between the two centres.
    tables: Vec<(Axial, Vec<[u16; DIRECTIONS]>)>,
    /// Cost of each cell of each layer, prices included.
    nodes: Vec<u32>,
    /// Least cost from a state of a layer to any state of the last.
    to_go: Vec<[u32; DIRECTIONS]>,
    grid: PhantomData<G>,
}

impl<'a, G: Steps> Layers<'a, G> {
    pub fn new(wishes: &'a Wishes<'a>) -> Self {
        let reach = wishes.reach;
        let stencil: Vec<Axial> = (-reach..=reach)
            .flat_map(|r| (-reach..=reach).map(move |q| Axial::new(q, r)))
            .filter(|&o| G::cell(o, reach).is_some())
            .collect();
        let n = wishes.target.len();
        let centres: Vec<Axial> = wishes.target.iter().map(|&t| G::nearest(t)).collect();
        let mut nodes = Vec::with_capacity(n * (stencil.len() + 1));
        let places: Vec<DVec2> = stencil.iter().map(|&o| G::units(o)).collect();
        for (&centre, &target) in centres.iter().zip(wishes.target) {
            let off = G::units(centre) - target;
            let price = |p: &DVec2| (f64::from(TURN) * wishes.closeness * (*p + off).length_squared()) as u32;
            nodes.extend(places.iter().map(price));
            nodes.push(NEVER);
        }
        let to_go = vec![[0; DIRECTIONS]; (n + 1) * stencil.len()];
        let mut layers = Layers {
            wishes,
            stencil,
            centres,
            table: Vec::with_capacity(n),
            tables: Vec::new(),
            nodes,
            to_go,
            grid: PhantomData,
        };
        for layer in 0..n {
            let shift = layers.centres[layer] - layers.centres[(layer + 1) % n];
            let known = layers.tables.iter().position(|t| t.0 == shift);
            let table = known.unwrap_or_else(|| {
                let outside = layers.stencil.len() as u16;
                let way = |o: Axial, d: usize| {
                    if d < Self::D { layers.cell(o + shift + G::offset(d as u32)) } else { outside }
                };
                let ways = layers.stencil.iter().map(|&o| std::array::from_fn(|d| way(o, d))).collect();
                layers.tables.push((shift, ways));
                layers.tables.len() - 1
            });
            layers.table.push(table as u16);
        }
        layers.bound();
        layers
    }

    fn len(&self) -> usize {
        self.centres.len()
    }

    /// Directions of the grid.
    const D: usize = G::DIRECTIONS as usize;

    fn ways(&self, layer: usize) -> &[[u16; DIRECTIONS]] {
        &self.tables[usize::from(self.table[layer])].1
    }

    /// Costs of the cells of a layer; the last one is that of the points outside.
    fn costs(&self, layer: usize) -> &[u32] {
        let row = self.stencil.len() + 1;
        &self.nodes[layer * row..(layer + 1) * row]
    }

    /// Number of the cell at an offset from the centre.
    fn cell(&self, offset: Axial) -> u16 {
        G::cell(offset, self.wishes.reach).unwrap_or(self.stencil.len()) as u16
    }

    /// The sweep backwards.
    fn bound(&mut self) {
        let cells = self.stencil.len();
        let n = self.len();
        for layer in (0..n).rev() {
            let (before, after) = self.to_go.split_at_mut((layer + 1) * cells);
            let here = &mut before[layer * cells..];
            let row = cells + 1;
            let next = (layer + 1) % n;
            let nodes = &self.nodes[next * row..(next + 1) * row];
            let ways = &self.tables[usize::from(self.table[layer])].1;
            let turns = &self.wishes.turns[layer];
            for (ways, here) in ways.iter().zip(here) {
                // Round more than once, so that a turn needs no modulo.
                let mut ahead = [NEVER; DIRECTIONS + 4];
                for (d, &to) in ways[..Self::D].iter().enumerate() {
                    let to = usize::from(to);
                    if to < cells {
                        ahead[d + 2] = nodes[to] + after[to][d];
                    }
                }
                (ahead[0], ahead[1]) = (ahead[Self::D], ahead[Self::D + 1]);
                (ahead[Self::D + 2], ahead[Self::D + 3]) = (ahead[2], ahead[3]);
                let mut least = [NEVER; DIRECTIONS];
                for (t, &cost) in turns.iter().enumerate() {
                    for d in 0..Self::D {
                        least[d] = least[d].min(ahead[d + t] + cost);
                    }
                }
                *here = least.map(|cost| cost.min(NEVER));
            }
        }
    }

    /// No closed path costs less.
    pub fn least(&self) -> u32 {
        self.to_go[..self.stencil.len()].iter().flatten().copied().min().unwrap_or(NEVER)
    }

    /// The cheapest closed path, if there is one; with `starts` the number of starts tried at most.
    pub fn solve(&self, starts: usize, progress: Progress<'_>) -> Result<Option<(Vec<Axial>, u32)>> {
        let states = self.stencil.len() * Self::D;
        let bound = |s: usize| self.to_go[s / Self::D][s % Self::D];
        let mut order: Vec<usize> = (0..states).filter(|&s| bound(s) < NEVER).collect();
        order.sort_by_key(|&s| (bound(s), s));
        let mut came = vec![0; (self.len() + 1) * states];
        let Some(&first) = order.first() else { return Ok(None) };
        let least = bound(first);
        // The optimum costs little more than the bound, as a rule: look there first.
        for slack in [2 * TURN, 8 * TURN, 32 * TURN] {
            let mut best: Option<(Vec<Axial>, u32)> = None;
            let mut limit = least + slack;
            for &start in order.iter().take(starts) {
                if bound(start) >= limit {
                    break;
                }
                progress.report(0.0)?;
                if let Some((points, cost)) = self.closed_from(start, limit, &mut came) {
                    limit = cost;
                    best = Some((points, cost));
                }
            }
            if best.is_some() {
                return Ok(best);
            }
        }
        Ok(None)
    }

    /// The cheapest path from a state of layer 0 back to it that costs less than `limit`.
    fn closed_from(&self, start: usize, limit: u32, came: &mut [u8]) -> Option<(Vec<Axial>, u32)> {
        let cells = self.stencil.len();
        let states = cells * Self::D;
        let n = self.len();
        let mut here = vec![NEVER; states];
        let mut there = vec![NEVER; states];
        let mut active = vec![start];
        let mut reached = Vec::new();
        here[start] = 0;
        for layer in 0..n {
            let nodes = self.costs((layer + 1) % n);
            let to_go = &self.to_go[(layer + 1) * cells..(layer + 2) * cells];
            let ways = self.ways(layer);
            for &state in &active {
                let (cell, d) = (state / Self::D, state % Self::D);
                let so_far = std::mem::replace(&mut here[state], NEVER);
                for (t, &turn) in self.wishes.turns[layer].iter().enumerate() {
                    let out = (d + Self::D - 2 + t) % Self::D;
                    let to = usize::from(ways[cell][out]);
                    if to == cells {
                        continue;
                    }
                    let cost = so_far + turn + nodes[to];
                    let known = &mut there[to * Self::D + out];
                    if cost < *known && cost + to_go[to][out] < limit {
                        if *known == NEVER {
                            reached.push(to * Self::D + out);
                        }
                        *known = cost;
                        came[(layer + 1) * states + to * Self::D + out] = d as u8;
                    }
                }
            }
            std::mem::swap(&mut here, &mut there);
            std::mem::swap(&mut active, &mut reached);
            reached.clear();
        }
        let cost = here[start];
        if cost >= limit {
            return None;
        }
        let mut points = vec![Axial::default(); n];
        let (mut at, mut d) = (self.centres[0] + self.stencil[start / Self::D], start % Self::D);
        for layer in (1..=n).rev() {
            let cell = self.cell(at - self.centres[layer % n]);
            let before = came[layer * states + usize::from(cell) * Self::D + d];
            at = at - G::offset(d as u32);
            points[layer - 1] = at;
            d = usize::from(before);
        }
        Some((points, cost))
    }

    fn raise(&mut self, layer: usize, point: Axial, price: u32) {
        let cell = usize::from(self.cell(point - self.centres[layer]));
        if cell < self.stencil.len() {
            let node = &mut self.nodes[layer * (self.stencil.len() + 1) + cell];
            *node = (*node + price).min(1 << 24);
        }
    }
}

/// The cheapest closed path, vertex k for target k, that does not meet itself, and across whose
/// inside no edge runs that the mesh has already (`taken`). `None` if prices did not lead to one within `rounds`.
pub(in crate::fill) fn route<G: Steps>(
    wishes: &Wishes<'_>,
    taken: &dyn Fn(usize, usize) -> bool,
    starts: usize,
    rounds: usize,
    progress: Progress<'_>,
) -> Result<Option<Vec<Axial>>> {
    let mut layers = Layers::<G>::new(wishes);
    for round in 0..=rounds {
        progress.report(0.0)?;
        let starts = if round == 0 { starts } else { REPAIR_STARTS };
        let Some((points, _)) = layers.solve(starts, progress)? else { return Ok(None) };
        let conflicts = conflicts::<G>(&points, taken);
        if conflicts.is_empty() && turning::<G>(&points) == G::DIRECTIONS as i32 {
            return Ok(Some(points));
        }
        for &(i, j) in &conflicts {
            // Ever dearer, so that stubborn conflicts do not come round and round.
            let price = TURN / 2 * (1 + round as u32 / 2);
            layers.raise(i, points[i], price);
            layers.raise(j, points[j], price);
        }
        // Where a loop is thinner than the lattice in many places, prices do not help.
        if conflicts.is_empty() || (round >= 2 && conflicts.len() > HOPELESS) {
            return Ok(None);
        }
        layers.bound();
    }
    Ok(None)
}

/// The sum of turns of a closed path; 100 stands for a step that is none.
pub(in crate::fill) fn turning<G: Steps>(points: &[Axial]) -> i32 {
    let n = points.len();
    (0..n)
        .map(|k| {
            let enter = G::step(points[(k + n - 1) % n], points[k]);
            let leave = G::step(points[k], points[(k + 1) % n]);
            enter.zip(leave).map_or(100, |(enter, leave)| G::turn(enter, leave))
        })
        .sum()
}

/// Pairs of vertices that share a point, or are joined by an edge inside the patch that is taken.
pub(in crate::fill) fn conflicts<G: Steps>(
    points: &[Axial],
    taken: &dyn Fn(usize, usize) -> bool,
) -> Vec<(usize, usize)> {
    let n = points.len();
    let mut at: FxHashMap<Axial, usize> = FxHashMap::default();
    let mut found = Vec::new();
    for (i, &p) in points.iter().enumerate() {
        if let Some(j) = at.insert(p, i) {
            found.push((j, i));
        }
    }
    for (i, &p) in points.iter().enumerate() {
        let (Some(enter), Some(leave)) =
            (G::step(points[(i + n - 1) % n], p), G::step(p, points[(i + 1) % n]))
        else {
            continue;
        };
        for inner in 1..G::OPPOSITE as i32 - G::turn(enter, leave) {
            match at.get(&(p + G::offset(G::turned(leave, inner)))) {
                Some(&j) if i < j && taken(i, j) => found.push((i, j)),
                _ => {}
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::layout::develop::Loop;
    use crate::lattice::grid::{Square, Triangular};

    fn plain(n: usize) -> Vec<[u32; 5]> {
        vec![[2 * TURN, TURN, 0, TURN, 4 * TURN]; n]
    }

    fn circle(n: usize) -> Vec<DVec2> {
        let circle: Vec<DVec2> =
            (0..n).map(|k| DVec2::from_angle(std::f64::consts::TAU * k as f64 / n as f64)).collect();
        Loop::new(&circle, Progress::NONE).unwrap().developed::<Triangular>(1.0, 0.2)
    }

    #[test]
    fn cells_are_numbered_as_in_the_stencil() {
        for reach in 1..5 {
            let target = [DVec2::ZERO];
            let turns = plain(1);
            let wishes = Wishes { target: &target, turns: &turns, closeness: 1.0, reach };
            let layers = Layers::<Triangular>::new(&wishes);
            for (i, &o) in layers.stencil.iter().enumerate() {
                assert_eq!(layers.cell(o) as usize, i);
            }
            assert_eq!(usize::from(layers.cell(Axial::new(reach, 1))), layers.stencil.len());
        }
    }

    #[test]
    fn a_circle_of_any_length_has_a_path_of_that_length() {
        for n in (8..120).chain([6, 300]) {
            let (target, turns) = (circle(n), plain(n));
            let wishes = Wishes { target: &target, turns: &turns, closeness: 0.1, reach: 2 };
            let path = route::<Triangular>(&wishes, &|_, _| true, 1000, 60, Progress::NONE).unwrap();
            let Some(path) = path else { panic!("no path for {n}") };
            assert_eq!(path.len(), n);
            assert_eq!(turning::<Triangular>(&path), 6);
            for k in 0..n {
                assert_eq!(path[k].distance(path[(k + 1) % n]), 1);
            }
            // All pairs count as taken: no edge joins two vertices of the path.
            assert!(conflicts::<Triangular>(&path, &|_, _| true).is_empty());
        }
    }

    #[test]
    fn a_square_path_of_any_even_length_closes() {
        for n in (6..80).step_by(2).chain([300]) {
            let circle: Vec<DVec2> =
                (0..n).map(|k| DVec2::from_angle(std::f64::consts::TAU * k as f64 / n as f64)).collect();
            let target = Loop::new(&circle, Progress::NONE).unwrap().developed::<Square>(1.0, 0.2);
            let turns = vec![[1 << 20, TURN, 0, TURN, 1 << 20]; n];
            let wishes = Wishes { target: &target, turns: &turns, closeness: 0.1, reach: 2 };
            let path = route::<Square>(&wishes, &|_, _| false, 1000, 60, Progress::NONE).unwrap();
            let Some(path) = path else { panic!("no path for {n}") };
            assert_eq!((path.len(), turning::<Square>(&path)), (n, 4));
            assert!(conflicts::<Square>(&path, &|_, _| false).is_empty());
        }
    }
}
