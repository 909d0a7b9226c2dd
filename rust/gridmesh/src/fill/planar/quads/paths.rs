//! The cheapest paths on the square lattice of as many steps as a loop has edges, or one more.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec2;

use super::cells::Plan;
use crate::error::Result;
use crate::fill::layout::develop::Loop;
use crate::fill::planar::exact::{Layers, TURN, Wishes, route};
use crate::lattice::grid::Square;
use crate::progress::Progress;

/// Cost of a squared lattice distance from the developed loop, in turns.
const CLOSENESS: f64 = 0.3;

/// Lattice steps that a vertex may be off its place in the developed loop.
const REACH: i32 = 2;

/// Lattice angles compared in the range of 90 degrees.
const ANGLES: usize = 6;

/// Of the paths found, how many are placed and measured.
const PLACED: usize = 3;

/// Starts of the exact search tried at most, and times that conflicts are priced.
const STARTS: usize = 24;
const PRICED: usize = 8;

/// Loops with more vertices are tried with fewer candidates.
const LARGE: usize = 300;

/// Edges of an odd loop that are compared for its triangle.
const EDGES: usize = 24;

/// What no path should cost: turns that it must not make.
const FORBIDDEN: u32 = 1 << 20;

/// A loop with the vertex that makes it even, if it is odd.
struct Even {
    shape: Loop,
    turns: Vec<[u32; 5]>,
    apex: Option<usize>,
}

pub(super) struct Search<'a> {
    loops: Vec<Even>,
    taken: &'a dyn Fn(usize, usize) -> bool,
    belt: bool,
    large: bool,
}

impl<'a> Search<'a> {
    /// Rounds with ever less of the loop's unevenness developed away.
    pub const ROUNDS: usize = 3;

    pub fn new(
        points: &[DVec2],
        wanted: &[f64],
        taken: &'a dyn Fn(usize, usize) -> bool,
        belt: bool,
    ) -> Search<'a> {
        let n = points.len();
        let even = |edge: Option<usize>| {
            let mut all = points.to_vec();
            let apex = edge.map(|edge| edge + 1);
            if let Some(edge) = edge {
                let (a, b) = (points[edge], points[(edge + 1) % n]);
                // A right angle outside the edge.
                all.insert(edge + 1, 0.5 * (a + b) - 0.5 * (b - a).perp());
            }
            let shape = Loop::new(&all);
            let turns = if belt { turns_behind(all.len(), apex) } else { turns(&shape, wanted, apex) };
            Even { shape, turns, apex }
        };
        let loops =
            if n.is_multiple_of(2) { vec![even(None)] } else { edges(points).into_iter().map(|e| even(Some(e))).collect() };
        Search { loops, taken, belt, large: n > LARGE }
    }

    /// Whether less of the unevenness could make a difference.
    pub fn is_uneven(&self) -> bool {
        !self.large && self.loops.iter().any(|it| it.shape.flux.iter().map(|f| f.abs()).sum::<f64>() > 1.0)
    }

    /// The cheapest paths of a round; none for those that come to nothing.
    pub fn paths(&self, round: usize, progress: Progress<'_>) -> Result<Vec<Option<Plan>>> {
        let strength = [1.0, 0.6, 0.2][round.min(2)];
        let angles = if self.loops.len() > 4 { ANGLES / 2 } else { ANGLES };
        let mut found = vec![];
        for (k, it) in self.loops.iter().enumerate() {
            for a in 0..angles {
                progress.report(0.5 * k as f64 / self.loops.len() as f64)?;
                let angle = FRAC_PI_2 * a as f64 / angles as f64;
                let target = it.shape.developed::<Square>(strength, angle);
                let least = Layers::<Square>::new(&it.wishes(&target)).least();
                found.push((least, target, it));
            }
        }
        found.sort_by_key(|f| f.0);
        let rounds = if self.large { PRICED / 2 } else { PRICED };
        let placed = found.into_iter().take(PLACED).enumerate().map(|(k, (_, target, it))| {
            let here = progress.part(0.5 + 0.5 * k as f64 / PLACED as f64, 1.0);
            // Inside a row of quads edges join new vertices only.
            let name = |v: usize| v - usize::from(it.apex.is_some_and(|apex| v > apex));
            let taken = |i: usize, j: usize| {
                !self.belt && it.apex != Some(i) && it.apex != Some(j) && (self.taken)(name(i), name(j))
            };
            let path = route::<Square>(&it.wishes(&target), &taken, STARTS, rounds, here)?;
            Ok(path.map(|path| Plan { path, apex: it.apex, belt: self.belt }))
        });
        placed.collect()
    }
}

impl Even {
    fn wishes<'a>(&'a self, target: &'a [DVec2]) -> Wishes<'a> {
        Wishes { target, turns: &self.turns, closeness: CLOSENESS, reach: REACH }
    }
}

/// Edges of an odd loop to try for its triangle: all, or the longest of each of some stretches.
fn edges(points: &[DVec2]) -> Vec<usize> {
    let n = points.len();
    let most = if n > LARGE { EDGES / 6 } else if n > 60 { EDGES / 2 } else { EDGES };
    let length = |k: &usize| points[*k].distance(points[(k + 1) % n]);
    let parts = most.min(n);
    let longest = |part: usize| {
        (part * n / parts..(part + 1) * n / parts).max_by(|a, b| length(a).total_cmp(&length(b)).then(b.cmp(a)))
    };
    (0..parts).filter_map(longest).collect()
}

/// What each turn costs at each vertex: how far the number of quads is from the wanted one, and how far their
/// corners are from right ones.
fn turns(shape: &Loop, wanted: &[f64], apex: Option<usize>) -> Vec<[u32; 5]> {
    let n = shape.turning.len();
    let of = |k: usize| {
        if apex == Some(k) {
            return [FORBIDDEN, FORBIDDEN, FORBIDDEN, 0, FORBIDDEN];
        }
        let loop_vertex = k - usize::from(apex.is_some_and(|apex| k > apex));
        let beside = apex.is_some_and(|apex| k + 1 == apex || k == (apex + 1) % n);
        std::array::from_fn(|t| {
            let quads = 4 - t as i32;
            if !(1..=3).contains(&quads) {
                return FORBIDDEN;
            }
            let angle = (PI - shape.turning[k]).clamp(0.05, 6.2);
            // A triangle needs less room than the quad that it stands for.
            let room = if beside { angle - FRAC_PI_4 / 2.0 } else { angle };
            let corner = room / f64::from(quads);
            let cost = (f64::from(quads) - wanted[loop_vertex]).abs() + skew(corner);
            (f64::from(TURN) * cost).round() as u32
        })
    };
    (0..n).map(of).collect()
}

/// What corners of an angle cost: nothing if right, much where they become straight.
fn skew(corner: f64) -> f64 {
    const MOST: f64 = 20.0;
    if corner >= PI { MOST } else { (2.0 * (1.0 / corner.sin() - 1.0)).min(MOST) }
}

/// The same for paths a row behind the loop, whose turns are poles.
fn turns_behind(n: usize, apex: Option<usize>) -> Vec<[u32; 5]> {
    let of = |k| {
        if apex == Some(k) {
            [FORBIDDEN, FORBIDDEN, FORBIDDEN, 0, FORBIDDEN]
        } else {
            [FORBIDDEN, TURN, 0, TURN, FORBIDDEN]
        }
    };
    (0..n).map(of).collect()
}
