//! The cheapest paths on the square lattice of as many steps as a loop has edges, or about as many.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec2;

use super::cells::{Belt, Name, Plan};
use crate::error::Result;
use crate::fill::layout::develop::Loop;
use crate::fill::planar::exact::{Layers, TURN, Wishes, route};
use crate::lattice::grid::Square;
use crate::progress::Progress;

/// Cost of a squared lattice distance from the developed loop, in turns; and of paths behind the whole loop, which
/// only have to be about as it is.
const CLOSENESS: f64 = 0.3;
const CLOSENESS_BEHIND: f64 = 0.06;

/// Lattice steps that a vertex may be off its place in the developed loop.
const REACH: i32 = 2;

/// Lattice angles compared in the range of 90 degrees; fewer where there is much else to compare.
const ANGLES: usize = 6;
const FEW_ANGLES: usize = 3;

/// Of the paths found, how many are placed and measured.
const PLACED: usize = 4;

/// Starts of the exact search tried at most, and times that conflicts are priced.
const STARTS: usize = 24;
const PRICED: usize = 8;

/// Loops with more vertices are tried with fewer candidates.
const LARGE: usize = 300;

/// Edges of an odd loop that are compared for its triangle; with rows along parts of the loop.
const EDGES: usize = 24;
const EDGES_OF_PARTS: usize = 6;

/// Corners of an even and of an odd loop at which rows along a part of it may end.
const CORNERS: usize = 4;
const CORNERS_OF_ODD: usize = 3;

/// What no path should cost: turns that it must not make.
const FORBIDDEN: u32 = 1 << 20;

/// Cost of a turn behind a row of quads: a pole.
const POLE: f64 = 1.5;

/// A path to be found: what its vertices stand for, and what it should follow.
struct Wanted {
    names: Vec<Name>,
    belt: Belt,
    shape: Loop,
    turns: Vec<[u32; 5]>,
    /// Of the loop's vertices that are not on the path.
    fixed: u32,
    closeness: f64,
}

pub(super) struct Search<'a> {
    shape: Loop,
    wanted: &'a [f64],
    taken: &'a dyn Fn(usize, usize) -> bool,
    lengths: Vec<f64>,
}

impl<'a> Search<'a> {
    /// Rounds with ever less of the loop's unevenness developed away.
    pub const ROUNDS: usize = 3;

    pub fn new(
        points: &[DVec2],
        wanted: &'a [f64],
        taken: &'a dyn Fn(usize, usize) -> bool,
        progress: Progress<'_>,
    ) -> Result<Search<'a>> {
        let n = points.len();
        let lengths = (0..n).map(|k| points[k].distance(points[(k + 1) % n])).collect();
        Ok(Search { shape: Loop::new(points, progress)?, wanted, taken, lengths })
    }

    fn len(&self) -> usize {
        self.lengths.len()
    }

    fn is_large(&self) -> bool {
        self.len() > LARGE
    }

    /// Whether less of the unevenness could make a difference.
    pub fn is_uneven(&self) -> bool {
        !self.is_large() && self.shape.flux.iter().map(|f| f.abs()).sum::<f64>() > 1.0
    }

    /// The cheapest paths of a round, along the loop or, with `belts`, behind rows of quads along it or along parts of
    /// it; none for those that come to nothing.
    pub fn paths(&self, belts: bool, round: usize, progress: Progress<'_>) -> Result<Vec<Option<Plan>>> {
        let strength = [1.0, 0.6, 0.2][round.min(2)];
        let all = self.candidates(belts);
        let angles = if all.len() > 4 { FEW_ANGLES } else { ANGLES };
        let mut found = vec![];
        for (k, it) in all.iter().enumerate() {
            for a in 0..angles {
                progress.report(0.5 * k as f64 / all.len() as f64)?;
                let angle = FRAC_PI_2 * a as f64 / angles as f64;
                let target = it.shape.developed::<Square>(strength, angle);
                let least = Layers::<Square>::new(&it.wishes(&target)).least();
                found.push((least.saturating_add(it.fixed), target, it));
            }
        }
        found.sort_by_key(|f| f.0);
        let rounds = if self.is_large() { PRICED / 2 } else { PRICED };
        let placed = found.into_iter().take(PLACED).enumerate().map(|(k, (_, target, it))| {
            let here = progress.part(0.5 + 0.5 * k as f64 / PLACED as f64, 1.0);
            let taken = |i: usize, j: usize| match (it.names[i], it.names[j]) {
                (Name::Loop(a), Name::Loop(b)) => (self.taken)(a.min(b), a.max(b)),
                _ => false,
            };
            let path = route::<Square>(&it.wishes(&target), &taken, STARTS, rounds, here)?;
            Ok(path.map(|path| Plan { path, names: it.names.clone(), belt: it.belt, n: self.len() }))
        });
        placed.collect()
    }

    fn candidates(&self, belts: bool) -> Vec<Wanted> {
        let n = self.len();
        let odd = !n.is_multiple_of(2);
        let edges = |most: usize| -> Vec<Option<usize>> {
            if odd { self.longest(most).into_iter().map(Some).collect() } else { vec![None] }
        };
        let most = if n > LARGE {
            EDGES / 6
        } else if n > 60 {
            EDGES / 2
        } else {
            EDGES
        };
        if !belts {
            return edges(most).into_iter().map(|edge| self.along(Belt::None, edge)).collect();
        }
        let mut all: Vec<Wanted> =
            edges(most / 2).into_iter().map(|edge| self.along(Belt::Whole, edge)).collect();
        if !(8..=LARGE).contains(&n) {
            return all;
        }
        let corners = self.corners(if odd { CORNERS_OF_ODD } else { CORNERS });
        for &from in &corners {
            for &to in &corners {
                let steps = (to + n - from) % n;
                if steps > 1 && n - steps > 3 {
                    let parts = edges(EDGES_OF_PARTS).into_iter();
                    all.extend(parts.map(|edge| self.along(Belt::Part { from, to }, edge)));
                }
            }
        }
        all
    }

    /// Loop vertices that one quad suits best, against two.
    fn corners(&self, most: usize) -> Vec<usize> {
        let gain = |k: &usize| self.cost(*k, 1) - self.cost(*k, 2);
        let mut found: Vec<usize> = (0..self.len()).filter(|k| gain(k) < 0.0).collect();
        found.sort_by(|a, b| gain(a).total_cmp(&gain(b)).then(a.cmp(b)));
        found.truncate(most);
        found
    }

    /// Edges of an odd loop to try for its triangle: all, or the longest of each of some stretches.
    fn longest(&self, most: usize) -> Vec<usize> {
        let n = self.len();
        let parts = most.min(n);
        let by_length = |a: &usize, b: &usize| self.lengths[*a].total_cmp(&self.lengths[*b]).then(b.cmp(a));
        (0..parts).filter_map(|part| (part * n / parts..(part + 1) * n / parts).max_by(by_length)).collect()
    }

    /// What a number of quads at a loop vertex costs, in turns: how far it is from the wanted one, and how far their
    /// corners are from right ones.
    fn cost(&self, k: usize, quads: i32) -> f64 {
        let angle = (PI - self.shape.turning[k]).clamp(0.05, 6.2);
        (f64::from(quads) - self.wanted[k]).abs() + skew(angle / f64::from(quads))
    }

    /// The path along the loop or behind rows of quads, with a corner outside an `edge` or without.
    fn along(&self, belt: Belt, edge: Option<usize>) -> Wanted {
        let n = self.len();
        let mut it = Wanted {
            names: vec![],
            belt,
            shape: Loop { turning: vec![], heading: self.shape.heading, flux: vec![] },
            turns: vec![],
            fixed: 0,
            closeness: if belt == Belt::Whole { CLOSENESS_BEHIND } else { CLOSENESS },
        };
        let mut fixed = 0.0;
        // Counted from a vertex on, so that the ends of a row are neighbours of what they belong to.
        for k in 0..n {
            let (mut turning, mut flux) = (self.shape.turning[k], self.shape.flux[k]);
            let mut beside = 0;
            if let Belt::Part { from, to } = belt {
                if k == from || k == to {
                    fixed += self.cost(k, 1);
                    continue;
                }
                // The corner at the end of a row comes on top of the turn of its neighbour.
                for (end, neighbour) in [(from, (from + n - 1) % n), (to, (to + 1) % n)] {
                    if k == neighbour {
                        turning += self.shape.turning[end];
                        flux += self.shape.flux[end];
                        beside = 1;
                    }
                }
            }
            let behind = belt.covers(k, n);
            if behind {
                fixed += self.cost(k, 2);
            }
            let at_apex = edge.is_some_and(|edge| k == edge || k == (edge + 1) % n);
            if at_apex && !behind {
                turning -= FRAC_PI_4;
            }
            it.names.push(if behind { Name::Behind(k) } else { Name::Loop(k) });
            it.shape.turning.push(turning);
            it.shape.flux.push(flux);
            it.turns.push(std::array::from_fn(|t| {
                let turn = t as i32 - 2;
                if turn.abs() > 1 {
                    return FORBIDDEN;
                }
                let cost = if behind {
                    POLE * f64::from(turn.abs())
                } else {
                    self.turned(k, 2 - turn + beside, at_apex)
                };
                (f64::from(TURN) * cost).round() as u32
            }));
            if edge == Some(k) {
                it.names.push(Name::Apex);
                it.shape.turning.push(if behind { 0.0 } else { FRAC_PI_2 });
                it.shape.flux.push(0.0);
                it.turns.push([FORBIDDEN, FORBIDDEN, FORBIDDEN, 0, FORBIDDEN]);
            }
        }
        it.fixed = (f64::from(TURN) * fixed).round() as u32;
        it
    }

    fn turned(&self, k: usize, quads: i32, at_apex: bool) -> f64 {
        if !at_apex {
            return self.cost(k, quads);
        }
        // One of them is the triangle, which needs less room.
        let angle = (PI - self.shape.turning[k]).clamp(0.05, 6.2) + FRAC_PI_4 / 2.0;
        (f64::from(quads) - self.wanted[k]).abs() + skew(angle / f64::from(quads))
    }
}

impl Wanted {
    fn wishes<'a>(&'a self, target: &'a [DVec2]) -> Wishes<'a> {
        Wishes { target, turns: &self.turns, closeness: self.closeness, reach: REACH }
    }
}

/// What corners of an angle cost: nothing if right, much where they become straight.
fn skew(corner: f64) -> f64 {
    const MOST: f64 = 20.0;
    if corner >= PI { MOST } else { (2.0 * (1.0 / libm::sin(corner) - 1.0)).min(MOST) }
}
