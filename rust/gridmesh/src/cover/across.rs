//! Boundary vertices moved until the boundary lies across the contours, as much of its edges outside as inside, or as near around
//! them as it can.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::cover::boundary::Boundary;
use crate::cover::outside::{Followers, loop_of};
use crate::cover::short::Lengths;
use crate::cover::{ENOUGH, Rim};
use crate::error::Result;
use crate::geometry::lengthen::THIN;
use crate::patch::Patch;
use crate::progress::Progress;

/// Rounds over the boundary.
const ROUNDS: usize = 6;

/// The longest move of the first round, in edge lengths, and what those of each further round are of those before.
const FIRST: f64 = 0.12;
const LATER: f64 = 0.8;

/// Moves tried: parts of the longest, and directions.
const PARTS: [f64; 2] = [1.0, 0.4];
const DIRECTIONS: usize = 8;

/// What the area between boundary and contours near a vertex must become less by to move it.
const BETTER: f64 = 0.995;

/// Vertices to each side whose moves may change what is best for one.
const BESIDE: usize = 3;

/// How deep a contour is inside a boundary around it, in edge lengths, for which a vertex is moved.
const WORTH: f64 = 0.1;

/// Part of a move by which inner vertices go along where faces would become thin otherwise. Not in patches of bodies, whose faces
/// lie steep at the rim.
const ALONG: f64 = 0.5;

/// Moves boundary vertices so that less area lies between the boundary and the contours, where no face becomes thin, no edge short
/// and no edges meet by that. Of a boundary around them, no more of the contours comes to lie outside.
pub(super) fn settled(
    patch: &mut Patch,
    fine: &[Vec<DVec2>],
    followers: &[Followers],
    rim: Rim,
    progress: Progress<'_>,
) -> Result<()> {
    let lengths = Lengths::new(patch);
    let edge_length = patch.lattice.edge_length;
    let mut boundary = Boundary::new(patch);
    for (k, (contour, follow)) in fine.iter().zip(followers).enumerate() {
        let (start, n) = (patch.loops[k].start as usize, patch.loops[k].len());
        let weights = weights(contour);
        let mut moved = vec![true; n];
        for round in 0..ROUNDS {
            let reach = FIRST * LATER.powi(round as i32) * edge_length;
            let before = std::mem::replace(&mut moved, vec![false; n]);
            for i in 0..n {
                if i.is_multiple_of(1 << 10) {
                    progress.report(0.0)?;
                }
                let around = || (i + n - BESIDE.min(n)..=i + n + BESIDE).map(|j| j % n);
                if !around().any(|j| before[j] || moved[j]) {
                    continue;
                }
                let near: Vec<usize> = follow.points_near(i).collect();
                let fit = Fit { contour, weights: &weights, follow, near: &near, vertex: i, rim };
                let now = fit.now(loop_of(patch, k));
                if rim != Rim::Across && now.deepest <= WORTH * edge_length {
                    continue;
                }
                let most = now.farthest.max(ENOUGH * edge_length);
                let (vertex, here) = (start + i, patch.vertices[start + i]);
                let own = Limits::new(patch, &lengths, std::iter::once(vertex));
                // Of the inner vertices beside it, asked for where faces would become thin.
                let mut beside: Option<Limits> = None;
                let mut best = (BETTER * now.between, DVec2::ZERO, false);
                for (part, turn) in
                    PARTS.into_iter().flat_map(|part| (0..DIRECTIONS).map(move |turn| (part, turn)))
                {
                    let way = part * reach * DVec2::from_angle(TAU * turn as f64 / DIRECTIONS as f64);
                    patch.vertices[vertex] = here + way;
                    let Some(between) = fit.between(loop_of(patch, k), best.0, most) else { continue };
                    let mut along = false;
                    if !own.allow(patch, &lengths) {
                        if rim == Rim::Across {
                            continue;
                        }
                        patch.vertices[vertex] = here;
                        let beside = beside
                            .get_or_insert_with(|| Limits::new(patch, &lengths, lengths.inner_near(vertex)));
                        patch.vertices[vertex] = here + way;
                        beside.carry(patch, way);
                        along = own.allow(patch, &lengths) && beside.allow(patch, &lengths);
                        beside.restore(patch);
                        if !along {
                            continue;
                        }
                    }
                    if boundary.stays_simple(patch, vertex) {
                        best = (between, way, along);
                    }
                }
                let (_, way, along) = best;
                patch.vertices[vertex] = here + way;
                if let Some(beside) = beside.filter(|_| along) {
                    beside.carry(patch, way);
                }
                if way != DVec2::ZERO {
                    moved[i] = true;
                    boundary.moved(patch, vertex, here);
                }
            }
        }
    }
    Ok(())
}

/// The points of a contour near a vertex of its loop.
struct Fit<'a> {
    contour: &'a [DVec2],
    weights: &'a [f64],
    follow: &'a Followers,
    near: &'a [usize],
    vertex: usize,
    rim: Rim,
}

/// How a loop lies to some points of its contour.
struct Lie {
    /// The area between them; of a boundary around, what is inside.
    between: f64,
    deepest: f64,
    /// How far a point lies outside, beyond the slack; nothing counts for a boundary across.
    farthest: f64,
}

impl Fit<'_> {
    fn now(&self, loop_: &[DVec2]) -> Lie {
        let mut lie = Lie { between: 0.0, deepest: 0.0, farthest: self.dents(loop_) };
        for &at in self.near {
            let beyond = self.follow.beyond(loop_, at, self.contour[at]);
            let (between, farthest) = self.counted(at, beyond);
            lie.deepest = lie.deepest.max(-beyond);
            lie.between += between;
            lie.farthest = lie.farthest.max(farthest);
        }
        lie
    }

    /// The area between, if it is below `least` and no point is farther outside than `most`.
    fn between(&self, loop_: &[DVec2], least: f64, most: f64) -> Option<f64> {
        let mut sum = 0.0;
        for &at in self.near {
            let (between, farthest) = self.counted(at, self.follow.beyond(loop_, at, self.contour[at]));
            sum += between;
            if sum >= least || farthest > most {
                return None;
            }
        }
        (self.dents(loop_) <= most).then_some(sum)
    }

    fn counted(&self, at: usize, beyond: f64) -> (f64, f64) {
        match self.rim {
            Rim::Across => (self.weights[at] * beyond.abs(), f64::NEG_INFINITY),
            Rim::Around(slack) | Rim::Whole { slack, .. } => {
                (self.weights[at] * (-beyond).max(0.0), beyond - slack)
            }
        }
    }

    fn dents(&self, loop_: &[DVec2]) -> f64 {
        match self.rim {
            Rim::Across => f64::NEG_INFINITY,
            Rim::Around(slack) | Rim::Whole { slack, .. } => {
                self.follow.beyond_dents(loop_, self.vertex, self.contour) - slack
            }
        }
    }
}

/// What the faces and edges at some vertices may become.
struct Limits {
    /// Which, where it was, the cotangent of the least angle, and what edges lack.
    of: Vec<(usize, DVec2, f64, f64)>,
}

impl Limits {
    fn new(patch: &Patch, lengths: &Lengths, vertices: impl Iterator<Item = usize>) -> Self {
        let limit = |v: usize| {
            let thin = lengths.sharpest(patch, v).max(THIN[0]);
            (v, patch.vertices[v], thin, lengths.lacking(patch, v))
        };
        Self { of: vertices.map(limit).collect() }
    }

    /// Whether no face is thinner and no edge shorter.
    fn allow(&self, patch: &Patch, lengths: &Lengths) -> bool {
        self.of.iter().all(|&(v, _, thin, lacked)| {
            lengths.sharpest(patch, v) <= thin && lengths.lacking(patch, v) <= lacked
        })
    }

    /// Moves the vertices along.
    fn carry(&self, patch: &mut Patch, way: DVec2) {
        self.of.iter().for_each(|&(v, at, ..)| patch.vertices[v] = at + ALONG * way);
    }

    fn restore(&self, patch: &mut Patch) {
        self.of.iter().for_each(|&(v, at, ..)| patch.vertices[v] = at);
    }
}

/// The area between the boundary and the contours.
pub(super) fn between(patch: &Patch, fine: &[Vec<DVec2>], followers: &[Followers]) -> f64 {
    let of = |k: usize| -> f64 {
        let (contour, follow, loop_) = (&fine[k], &followers[k], loop_of(patch, k));
        let n = contour.len();
        let strip = |at: usize| {
            let edge = follow.edge(at)?;
            let along = (loop_[(edge + 1) % loop_.len()] - loop_[edge]).normalize_or_zero();
            // Walls of an inlet that an edge passes over go back and forth, but not along it.
            let width = 0.5 * (contour[(at + 1) % n] - contour[(at + n - 1) % n]).dot(along);
            Some(width * follow.beyond(loop_, at, contour[at]).abs())
        };
        (0..n).filter_map(strip).sum::<f64>().max(0.0)
    };
    (0..fine.len()).map(of).sum()
}

/// The length of a contour that each of its points stands for.
fn weights(contour: &[DVec2]) -> Vec<f64> {
    let n = contour.len();
    let length = |k: usize| contour[k % n].distance(contour[(k + 1) % n]);
    (0..n).map(|k| 0.5 * (length(k) + length(k + n - 1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SketchOptions;
    use crate::sketch::mesh_sketch;

    /// A star of five arms, points a fortieth apart.
    fn star() -> Vec<DVec2> {
        let corner =
            |k: usize| if k.is_multiple_of(2) { 1.0 } else { 0.45 } * DVec2::from_angle(TAU * k as f64 / 10.0);
        (0..10).flat_map(|k| (0..40).map(move |i| corner(k).lerp(corner(k + 1), i as f64 / 40.0))).collect()
    }

    #[test]
    fn a_boundary_around_leaves_less_empty_and_no_more_outside() {
        let contour = star();
        let mut gave_way = false;
        for triangles in [90, 140, 200] {
            let options = SketchOptions { triangles: Some(triangles), ..SketchOptions::default() };
            let mut patch = mesh_sketch(&contour, &[], &options, Progress::NONE).unwrap().patch;
            let followers = [Followers::new(&patch, 0, &contour)];
            let n = patch.n_boundary();
            // A boundary that stays away from the star everywhere.
            patch.vertices.iter_mut().for_each(|vertex| *vertex *= 1.12);
            let before = patch.clone();
            let rim = Rim::Around(0.0);
            settled(&mut patch, std::slice::from_ref(&contour), &followers, rim, Progress::NONE).unwrap();
            let near: Vec<usize> = (0..contour.len()).collect();
            let (contour, weights) = (contour.as_slice(), weights(&contour));
            let fit = Fit { contour, weights: &weights, follow: &followers[0], near: &near, vertex: 0, rim };
            let (then, now) = (fit.now(loop_of(&before, 0)), fit.now(loop_of(&patch, 0)));
            assert!(now.between < 0.9 * then.between, "{} {}", now.between, then.between);
            assert!(now.farthest <= then.farthest.max(ENOUGH * patch.lattice.edge_length));
            let lengths = Lengths::new(&before);
            let all = patch.vertices.len();
            let thin = |patch: &Patch| (0..all).map(|v| lengths.sharpest(patch, v)).fold(THIN[0], f64::max);
            assert!(thin(&patch) <= thin(&before));
            gave_way |= (n..all).any(|v| patch.vertices[v] != before.vertices[v]);
        }
        assert!(gave_way, "inner vertices stayed");
    }
}
