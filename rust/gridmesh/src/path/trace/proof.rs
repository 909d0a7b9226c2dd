//! From the cheapest paths that may conflict to the optimum: Lagrange prices, branch and bound.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::rc::Rc;

use rustc_hash::FxHashMap;

use super::conflicts::{Conflict, Finder, Vertex};
use super::dive::{dive_from, turned_once};
use super::graph::BLOCKED;
use super::prices::Prices;
use super::search::{Search, Walk};
use super::sides::wrong_sides;
use crate::error::{Error, Result};
use crate::lattice::grid::Grid;
use crate::path::trace::contour::Contour;
use crate::progress::Progress;

/// Searches for better prices in the first part of the search space, and in each later one.
const ROOT_STEPS: usize = 40;
const STEPS: usize = 6;
/// Likewise, when no proof was asked for.
const QUICK_STEPS: usize = 8;
/// Rounds of conflict pricing from the prices of a proof on.
const DIVE: usize = 20;

/// States that a part may take from the queue on average, for each state there is: what follows from
/// crowded conflicts would take hundreds.
const EFFORT: u64 = 5;

/// States that a proof that was asked for may take in all: a second or two, however many parts are allowed. There
/// is one for each of four lattice angles.
const MOST: u64 = 6_000_000;

/// What is known after a proof was tried.
pub(super) struct Proof<G> {
    /// No valid walks cost less than this.
    pub bound: u32,
    /// Better walks than those given, if some were found.
    pub walks: Option<Vec<Walk<G>>>,
    /// The cost of the best walks known equals the bound.
    pub optimal: bool,
}

/// A way of passing a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Use {
    contour: u32,
    node: u32,
    how: How,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum How {
    Visit,
    /// Arriving by this direction.
    Arrive(u32),
    /// Having the edge in this direction inside the patch.
    Inside(u32),
}

impl Use {
    fn charge(&self, prices: &mut [Prices], price: u32) {
        let prices = &mut prices[self.contour as usize];
        match self.how {
            How::Visit => prices.raise_visit(self.node, price),
            How::Arrive(dir) => prices.raise_arrive(self.node, dir, price),
            How::Inside(dir) => prices.raise_inside(self.node, dir, price),
        }
    }
}

/// The two uses of a conflict: every valid boundary makes at most one of them.
fn uses<G: Grid>(walks: &[Walk<G>], conflict: &Conflict) -> [Use; 2] {
    let of = |v: Vertex| {
        let step = walks[v.contour as usize].step(v.index as usize);
        (v.contour, step.node, u32::from(step.enter))
    };
    let (a, b) = (of(conflict.a), of(conflict.b));
    let same = (a.0, a.1) == (b.0, b.1);
    let how = |enter: u32, chord: Option<u32>| match chord {
        Some(dir) => How::Inside(dir),
        None if same => How::Arrive(enter),
        None => How::Visit,
    };
    let make = |(contour, node, enter): (u32, u32, u32), chord| Use { contour, node, how: how(enter, chord) };
    [make(a, conflict.chord), make(b, conflict.chord.map(|dir| G::turned(dir, G::OPPOSITE as i32)))]
}

/// A part of the search space: the uses it forbids, and the best prices known for it.
struct Part {
    bans: Option<Rc<Ban>>,
    multipliers: Vec<u32>,
    branch: [Use; 2],
}

/// A forbidden use, and those forbidden before it.
struct Ban {
    what: Use,
    earlier: Option<Rc<Ban>>,
}

/// Tries to prove that valid walks of cost `best` are the cheapest, or to find cheaper ones.
///
/// `roots` are the cheapest walks regardless of conflicts. Of a conflict's two uses every valid
/// boundary leaves out at least one. So a price on both, taken off once from the sum, still gives a
/// lower bound (Lagrange); and the search space splits into the part without the one and the part
/// without the other (branch and bound), best bound first, until no part is left, `nodes` parts
/// were looked at, or the search has taken as many states as that many parts should need, or [`MOST`].
pub(super) fn prove<G: Grid>(
    contours: &[Contour<G>],
    roots: &[Walk<G>],
    best: u32,
    nodes: usize,
    search: &mut Search<'_>,
    progress: Progress<'_>,
) -> Result<Proof<G>> {
    let states: usize = contours.iter().map(|contour| contour.graph.n_states()).sum();
    let each = EFFORT * states as u64;
    let most_taken = search.pulse.taken + 2 * each + each.saturating_mul(nodes as u64).min(MOST);
    let mut tree = Tree {
        most_taken,
        contours,
        roots,
        search,
        finder: Finder::default(),
        prices: contours.iter().map(|contour| Prices::none(contour.graph.n_nodes())).collect(),
        used: contours.iter().map(|contour| vec![0; contour.graph.n_nodes()]).collect(),
        pairs: Vec::new(),
        known: FxHashMap::default(),
        best,
        found: None,
        stuck: u32::MAX,
        parts: Vec::new(),
        open: BinaryHeap::new(),
    };
    let mut looked_at = 1;
    let steps = if nodes > 0 { ROOT_STEPS } else { QUICK_STEPS };
    tree.look(None, Vec::new(), steps, progress)?;
    while let Some(&Reverse((bound, at))) = tree.open.peek() {
        if bound >= tree.best || looked_at + 2 > nodes || tree.is_spent() {
            break;
        }
        tree.open.pop();
        let Part { bans, multipliers, branch } = &tree.parts[at];
        let (bans, multipliers) = (bans.clone(), multipliers.clone());
        for what in *branch {
            progress.report(looked_at as f64 / nodes as f64)?;
            looked_at += 1;
            let ban = Rc::new(Ban { what, earlier: bans.clone() });
            tree.look(Some(ban), multipliers.clone(), STEPS, progress)?;
        }
    }
    let open = tree.open.peek().map_or(u32::MAX, |Reverse((bound, _))| *bound);
    let bound = open.min(tree.stuck).min(tree.best);
    Ok(Proof { bound, optimal: bound == tree.best, walks: tree.found })
}

struct Tree<'a, 'b, G> {
    /// The search may take so many states in all.
    most_taken: u64,
    contours: &'a [Contour<G>],
    roots: &'a [Walk<G>],
    search: &'a mut Search<'b>,
    finder: Finder,
    /// Free of prices between uses.
    prices: Vec<Prices>,
    /// For each node, how the walks at hand use it: a bit for each direction of arrival, and six
    /// more for the edges inside. Zero between uses.
    used: Vec<Vec<u16>>,
    /// The conflicts met so far.
    pairs: Vec<[Use; 2]>,
    known: FxHashMap<[Use; 2], u32>,
    best: u32,
    found: Option<Vec<Walk<G>>>,
    /// Least bound of the parts that could not be split.
    stuck: u32,
    parts: Vec<Part>,
    open: BinaryHeap<Reverse<(u32, usize)>>,
}

impl<G: Grid> Tree<'_, '_, G> {
    fn is_spent(&self) -> bool {
        self.search.pulse.taken > self.most_taken
    }

    /// Finds good prices for a part, and files it unless its bound rules it out.
    fn look(
        &mut self,
        bans: Option<Rc<Ban>>,
        mut multipliers: Vec<u32>,
        steps: usize,
        progress: Progress<'_>,
    ) -> Result<()> {
        let mut best_bound = 0;
        let mut best_part: Option<(Vec<u32>, Vec<[Use; 2]>)> = None;
        let (mut scale, mut stale) = (1.0, 0);
        for step in 0..=steps {
            multipliers.resize(self.pairs.len(), 0);
            // Going through pairs and walks is work too.
            let more: usize = self.pairs.len() + self.roots.iter().map(Walk::len).sum::<usize>();
            if self.search.pulse.beat(more as u64) {
                return Err(Error::Cancelled);
            }
            let Some((bound, walks)) = self.evaluate(bans.as_ref(), &multipliers) else {
                return Ok(());
            };
            let conflicts = self.finder.find(self.contours, &walks);
            if conflicts.is_empty() {
                self.offer(&walks);
            } else if step % 8 == 4 {
                // Prices that nearly suffice are a good place to look for valid walks from.
                self.dive(&walks, progress)?;
            }
            if bound >= self.best {
                return Ok(());
            }
            let uses: Vec<[Use; 2]> = conflicts.iter().map(|c| uses(&walks, c)).collect();
            if bound > best_bound || best_part.is_none() {
                (best_bound, stale) = (bound, 0);
                best_part = Some((multipliers.clone(), uses.clone()));
            } else {
                stale += 1;
                if stale == 3 {
                    (scale, stale) = (0.5 * scale, 0);
                }
            }
            if step == steps
                || self.is_spent()
                || !self.improve(&mut multipliers, &uses, &walks, bound, scale)
            {
                break;
            }
        }
        let Some((multipliers, conflicts)) = best_part else {
            return Ok(());
        };
        // Split where the prices are highest: that is where both sides are wanted most.
        let price = |pair: &[Use; 2]| {
            let known = self.known.get(pair).map(|&i| i as usize);
            known.and_then(|i| multipliers.get(i)).copied().unwrap_or(0)
        };
        let first = |pairs: &[[Use; 2]]| {
            let best = pairs.iter().enumerate().max_by_key(|(i, pair)| (price(pair), Reverse(*i)));
            best.map(|(_, pair)| *pair)
        };
        let branch = first(&conflicts).or_else(|| first(&self.pairs).filter(|pair| price(pair) > 0));
        match branch {
            Some(branch) => {
                self.open.push(Reverse((best_bound, self.parts.len())));
                self.parts.push(Part { bans, multipliers, branch });
            }
            None => self.stuck = self.stuck.min(best_bound),
        }
        Ok(())
    }

    /// The cheapest walks of a part at some prices, and the lower bound that they give; none if
    /// it is not below the best cost known.
    fn evaluate(&mut self, bans: Option<&Rc<Ban>>, multipliers: &[u32]) -> Option<(u32, Vec<Walk<G>>)> {
        for prices in &mut self.prices {
            prices.clear();
        }
        let mut entry = bans;
        while let Some(ban) = entry {
            ban.what.charge(&mut self.prices, BLOCKED);
            entry = ban.earlier.as_ref();
        }
        let mut refund = 0;
        for (pair, &price) in self.pairs.iter().zip(multipliers) {
            if price > 0 {
                pair[0].charge(&mut self.prices, price);
                pair[1].charge(&mut self.prices, price);
                refund += price;
            }
        }
        let mut walks = Vec::with_capacity(self.contours.len());
        let mut left = self.best + refund;
        for ((contour, prices), root) in self.contours.iter().zip(&self.prices).zip(self.roots) {
            let (walk, cost) = if prices.priced().is_empty() {
                (root.clone(), root.cost)
            } else {
                let Contour { graph, potential } = contour;
                self.search.closed(graph, potential, prices, left)?
            };
            left = left.checked_sub(cost)?;
            walks.push(walk);
        }
        // What is left of the best cost known is the gap.
        (left > 0).then(|| (self.best - left.min(self.best), walks))
    }

    /// Moves the multipliers along the subgradient; false if it is zero.
    fn improve(
        &mut self,
        multipliers: &mut Vec<u32>,
        conflicts: &[[Use; 2]],
        walks: &[Walk<G>],
        bound: u32,
        scale: f64,
    ) -> bool {
        for pair in conflicts {
            if !self.known.contains_key(pair) {
                self.known.insert(*pair, self.pairs.len() as u32);
                self.pairs.push(*pair);
            }
        }
        multipliers.resize(self.pairs.len(), 0);
        self.mark(walks, true);
        let slope: Vec<i32> = self
            .pairs
            .iter()
            .zip(&*multipliers)
            .map(|(pair, &price)| {
                let count = pair.iter().map(|u| i32::from(self.is_used(u))).sum::<i32>();
                if count == 0 && price == 0 { 0 } else { count - 1 }
            })
            .collect();
        self.mark(walks, false);
        let squared: i32 = slope.iter().map(|g| g * g).sum();
        if squared == 0 {
            return false;
        }
        let step = (scale * f64::from(self.best - bound) / f64::from(squared)).ceil() as i32;
        for (price, g) in multipliers.iter_mut().zip(slope) {
            *price = (*price as i32 + g * step.max(1)).clamp(0, BLOCKED as i32 / 64) as u32;
        }
        true
    }

    /// Notes how walks use their nodes, or forgets it.
    fn mark(&mut self, walks: &[Walk<G>], note: bool) {
        for (walk, used) in walks.iter().zip(&mut self.used) {
            for i in 0..walk.len() {
                let step = walk.step(i);
                let bits = &mut used[step.node as usize];
                if note {
                    *bits |= 1 << step.enter;
                    for k in 1..=(2 - walk.turn(i)).max(0) as u32 {
                        *bits |= 1 << (6 + G::turned(walk.leave(i), k as i32));
                    }
                } else {
                    *bits = 0;
                }
            }
        }
    }

    fn is_used(&self, what: &Use) -> bool {
        let bits = self.used[what.contour as usize][what.node as usize];
        let mask = match what.how {
            How::Visit => 63,
            How::Arrive(dir) => 1 << dir,
            How::Inside(dir) => 1 << (6 + dir),
        };
        bits & mask != 0
    }

    /// Takes walks without conflicts if they are the best known.
    fn offer(&mut self, walks: &[Walk<G>]) {
        let cost: u32 = walks.iter().map(|walk| walk.cost).sum();
        if cost < self.best && turned_once(walks) && wrong_sides(self.contours, walks).is_empty() {
            self.best = cost;
            self.found = Some(walks.to_vec());
        }
    }

    /// Looks for valid walks from the prices at hand on.
    fn dive(&mut self, walks: &[Walk<G>], progress: Progress<'_>) -> Result<()> {
        let mut walks = walks.to_vec();
        let mut prices = self.prices.clone();
        let (contours, search) = (self.contours, &mut *self.search);
        let dive = dive_from(contours, &mut walks, &mut prices, search, DIVE, progress)?;
        if dive.conflicts.is_empty() && dive.wrong.is_empty() {
            self.offer(&walks);
        }
        Ok(())
    }
}
