//! Conflict pricing: from the cheapest paths to ones without conflicts.

use rustc_hash::FxHashMap;

use super::conflicts::{Conflict, Finder, Vertex};
use super::graph::TURN;
use super::prices::Prices;
use super::search::{Search, Walk};
use super::sides::wrong_sides;
use crate::error::Result;
use crate::lattice::axial::Axial;
use crate::lattice::grid::Grid;
use crate::path::trace::contour::Contour;
use crate::progress::Progress;

/// What both sides of a conflict are charged in each round.
pub(super) const STEP: u32 = TURN / 4;
/// Greatest number of rounds.
pub(super) const ROUNDS: usize = 100;
/// Price, in the second pass, of a lattice point that is nearer to another stretch of contour than to its own.
pub(super) const APART: u32 = 2 * TURN;
/// Pricing stops after this many rounds without a new minimum of conflicts.
const PATIENCE: usize = 25;
/// Pricing stops after this many rounds unless conflicts have halved or are below one per `CROWDED` vertices.
const TRIAL: usize = 12;
/// The same in haste.
const SHORT_TRIAL: usize = 8;
/// See `TRIAL`: vertices per conflict that are few enough to go on.
const CROWDED: usize = 20;
/// Vertices on each side of a conflict that are free to move when it is priced; and those where conflicts are so dense
/// that with as many nearly all would be free. On 3816 outlines of icons at 500 triangles the fewer save a fifth of the
/// time, and 88 instead of 115 take over 20 times the median; irregular vertices and angles stay the same.
const REACHES: [usize; 2] = [16, 5];

/// Where a dive ended.
pub(super) struct Dive {
    pub rounds: usize,
    /// The number of conflicts that it began with.
    pub first: usize,
    /// The conflicts that are left.
    pub conflicts: Vec<Conflict>,
    /// The vertices left that have the patch on their wrong side.
    pub wrong: Vec<Vertex>,
}

/// Prices conflicts and searches again near them until none is left.
///
/// In each round both vertices of each conflict become dearer: of a repeated point the visit, of a
/// chord its lying inside. Where a path has the patch on its wrong side every vertex does. Only
/// windows around the vertices are searched again, all else stays.
pub(super) fn dive<G: Grid>(
    contours: &[Contour<G>],
    walks: &mut [Walk<G>],
    prices: &mut [Prices],
    search: &mut Search<'_>,
    progress: Progress<'_>,
) -> Result<Dive> {
    dive_from(contours, walks, prices, search, ROUNDS, progress)
}

/// Likewise, with some prices to begin with and a limit to the rounds.
pub(super) fn dive_from<G: Grid>(
    contours: &[Contour<G>],
    walks: &mut [Walk<G>],
    prices: &mut [Prices],
    search: &mut Search<'_>,
    limit: usize,
    progress: Progress<'_>,
) -> Result<Dive> {
    let mut finder = Finder::default();
    let mut rounds = 0;
    let mut patience = Patience::new(walks, search.pulse.is_hasty());
    loop {
        let conflicts = finder.find(contours, walks);
        let repeated = conflicts.iter().any(|conflict| conflict.chord.is_none());
        let wrong = if repeated || walks.len() > 1 || !turned_once(walks) {
            wrong_sides(contours, walks)
        } else {
            Vec::new()
        };
        let left = conflicts.len() + wrong.len();
        if patience.ends(rounds, left) || left == 0 || rounds == limit || search.pulse.is_spent() {
            return Ok(Dive { rounds, first: patience.first, conflicts, wrong });
        }
        rounds += 1;
        progress.report(rounds as f64 / limit as f64)?;
        let mut hot: Vec<Vertex> = Vec::new();
        for conflict in &conflicts {
            raise(walks, prices, conflict, STEP);
            hot.extend([conflict.a, conflict.b]);
        }
        for vertex in wrong {
            let node = walks[vertex.contour as usize].node(vertex.index as usize);
            prices[vertex.contour as usize].raise_visit(node, STEP);
            hot.push(vertex);
        }
        hot.sort_unstable();
        hot.dedup();
        for (c, walk) in (0..).zip(walks.iter_mut()) {
            let of_contour = hot.iter().filter(|vertex| vertex.contour == c);
            let at: Vec<usize> = of_contour.map(|vertex| vertex.index as usize).collect();
            let (contour, prices) = (&contours[c as usize], &prices[c as usize]);
            resolve(contour, walk, prices, search, &at);
        }
    }
}

/// Where there are many conflicts, begins with walls that are kept apart if that leaves fewer; says whether there are.
pub(super) fn begin_crowded<G: Grid>(
    contours: &[Contour<G>],
    walks: &mut [Walk<G>],
    prices: &mut [Prices],
    search: &mut Search<'_>,
    progress: Progress<'_>,
) -> Result<bool> {
    let first = dive_from(contours, walks, prices, search, 0, progress)?.first;
    let vertices: usize = walks.iter().map(Walk::len).sum();
    if first <= vertices / CROWDED {
        return Ok(false);
    }
    let cheapest = walks.to_vec();
    keep_apart(contours, walks, prices, search);
    if dive_from(contours, walks, prices, search, 0, progress)?.first >= first {
        walks.clone_from_slice(&cheapest);
        prices.iter_mut().for_each(Prices::clear);
    }
    Ok(true)
}

/// Whether more rounds of pricing are worth their time.
pub(super) struct Patience {
    /// Conflicts that are not too many.
    few: usize,
    trial: usize,
    pub first: usize,
    fewest: usize,
    since: usize,
}

impl Patience {
    pub fn new<G: Grid>(walks: &[Walk<G>], is_hasty: bool) -> Self {
        let vertices: usize = walks.iter().map(Walk::len).sum();
        let trial = if is_hasty { SHORT_TRIAL } else { TRIAL };
        Self { few: vertices / CROWDED, trial, first: usize::MAX, fewest: usize::MAX, since: 0 }
    }

    /// True once there is little hope, seeing how many conflicts are left after a round.
    pub fn ends(&mut self, round: usize, left: usize) -> bool {
        if round == 0 {
            self.first = left;
        }
        if left < self.fewest {
            (self.fewest, self.since) = (left, round);
        }
        let is_stuck = round >= self.trial && self.fewest > self.few && 2 * self.fewest > self.first;
        is_stuck || round - self.since >= PATIENCE
    }
}

/// Charges every node for whose point another stretch of curve, or another contour, is nearer; and
/// searches all walks again.
///
/// From there walls that have changed sides in a narrow part find back: each has its own half.
pub(super) fn keep_apart<G: Grid>(
    contours: &[Contour<G>],
    walks: &mut [Walk<G>],
    prices: &mut [Prices],
    search: &mut Search<'_>,
) {
    let nearest = nearest_squared(contours);
    for ((contour, prices), walk) in contours.iter().zip(prices).zip(walks) {
        let Contour { graph, potential } = contour;
        prices.clear();
        for node in 0..graph.n_nodes() as u32 {
            let (point, squared) = (graph.points[node as usize], graph.squared[node as usize]);
            if nearest.get(&point).is_some_and(|&least| least < squared) {
                prices.raise_visit(node, APART);
            }
        }
        if let Some((found, _)) = search.closed(graph, potential, prices, u32::MAX) {
            *walk = found;
        }
    }
}

/// The squared distance of each point to the nearest of all stretches.
pub(super) fn nearest_squared<G>(contours: &[Contour<G>]) -> FxHashMap<Axial, f64> {
    let mut nearest: FxHashMap<Axial, f64> = FxHashMap::default();
    for Contour { graph, .. } in contours {
        for (&point, &squared) in graph.points.iter().zip(&graph.squared) {
            let least = nearest.entry(point).or_insert(squared);
            *least = least.min(squared);
        }
    }
    nearest
}

/// True if the outer walk turns by one full circle and each hole's by one back.
pub(super) fn turned_once<G: Grid>(walks: &[Walk<G>]) -> bool {
    walks.iter().enumerate().all(|(c, walk)| {
        let sum: i32 = (0..walk.len()).map(|i| walk.turn(i)).sum();
        let circle = G::DIRECTIONS as i32;
        sum == if c == 0 { circle } else { -circle }
    })
}

/// Charges both sides of a conflict.
pub(super) fn raise<G: Grid>(walks: &[Walk<G>], prices: &mut [Prices], conflict: &Conflict, amount: u32) {
    let mut charge = |vertex: Vertex, chord: Option<u32>| {
        let walk = &walks[vertex.contour as usize];
        let node = walk.node(vertex.index as usize);
        let prices = &mut prices[vertex.contour as usize];
        match chord {
            Some(dir) => prices.raise_inside(node, dir, amount),
            None => prices.raise_visit(node, amount),
        }
    };
    charge(conflict.a, conflict.chord);
    charge(conflict.b, conflict.chord.map(|dir| G::turned(dir, G::OPPOSITE as i32)));
}

/// Searches a walk again near its vertices in `at` (ascending).
fn resolve<G: Grid>(
    contour: &Contour<G>,
    walk: &mut Walk<G>,
    prices: &Prices,
    search: &mut Search<'_>,
    at: &[usize],
) {
    if at.is_empty() {
        return;
    }
    let Contour { graph, potential } = contour;
    match free_windows(at, walk.len()) {
        Some(windows) => {
            let mut shift = 0;
            for (from, to) in windows {
                let (from, to) = (from - shift, to - shift);
                let n = walk.len();
                let found = search.between(graph, potential, prices, (walk, from, to), u32::MAX);
                if let Some((steps, _)) = found {
                    walk.splice(from, to, &steps);
                    shift += (to + 1).saturating_sub(n);
                }
            }
            walk.cost = walk.base_cost(graph);
        }
        None => {
            if let Some((found, _)) = search.closed(graph, potential, prices, u32::MAX) {
                *walk = found;
            }
        }
    }
}

/// What is searched again around some indices: disjoint ranges, the last first, of which the first may go past the end;
/// or all but the vertex that is farthest from them. `None` if every vertex is one of them.
fn free_windows(at: &[usize], n: usize) -> Option<Vec<(usize, usize)>> {
    let (gap, k) = widest_gap(at, n)?;
    let middle = (at[k] + gap / 2) % n;
    REACHES
        .iter()
        .find(|&&reach| gap > 2 * reach + 2)
        .map(|&reach| windows(at, k, reach, n))
        .or_else(|| (gap > 1).then(|| vec![(middle, middle + n)]))
}

/// The most steps from one of some indices (ascending) of a cycle to the next, and which one it is.
fn widest_gap(at: &[usize], n: usize) -> Option<(usize, usize)> {
    let next = |k: usize| if k + 1 < at.len() { at[k + 1] } else { at[0] + n };
    (0..at.len()).map(|k| (next(k) - at[k], k)).max()
}

/// Disjoint ranges of so many indices to both sides of some; after the one at `k` is the widest gap, so that no range but
/// the last goes round the end.
fn windows(at: &[usize], k: usize, reach: usize, n: usize) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    let turned = at[k + 1..].iter().copied().chain(at[..=k].iter().map(|i| i + n));
    for i in turned {
        let (from, to) = (i + n - reach, i + n + reach);
        match found.last_mut() {
            Some(last) if last.1 + 1 >= from => last.1 = to,
            _ => found.push((from, to)),
        }
    }
    for window in &mut found {
        let turns = window.0 / n * n;
        window.0 -= turns;
        window.1 -= turns;
    }
    found.sort_unstable_by(|a, b| b.cmp(a));
    found
}
