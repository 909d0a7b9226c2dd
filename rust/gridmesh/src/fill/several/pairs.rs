//! Triangles joined to pairs, such that the vertices have four faces each, as far as can be.
//!
//! A matching of neighbours is improved along alternating paths, as matchings are: a triangle takes another partner, whose
//! partner takes another one, and so on, for a few steps; the best of these changes is kept if it is one for the better.

use glam::DVec3;

use crate::error::Result;
use crate::geometry::topology::{NONE, Topology};
use crate::progress::Progress;

/// Steps of a change after the first.
const DEPTH: usize = 5;

/// Passes over all triangles at most.
const PASSES: usize = 16;

/// Cost of a triangle left alone: in its middle is a vertex with three neighbours.
const ALONE: f64 = 1.0;

/// Cost of a vertex inside of which two faces would share two edges.
const DOUBLET: f64 = 100.0;

/// Corners of a pair, in radians, beyond which it costs, and how much for each radian more.
const OBTUSE: f64 = 2.4;
const SKEW: f64 = 4.0;

/// Triangles, and what is wanted of them.
pub(super) struct Wishes<'a> {
    pub positions: &'a [DVec3],
    pub triangles: &'a [[u32; 3]],
    /// How many faces each vertex is to have.
    pub faces: &'a [f64],
    /// The first so many vertices are of loops, where any number of faces is sound.
    pub border: usize,
    /// Triangles by which the first changes are tried.
    pub order: &'a [u32],
}

/// The partner of each triangle, or [`NONE`].
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(super) fn pairs(wishes: &Wishes<'_>, progress: Progress<'_>) -> Result<Vec<u32>> {
    let mut pairing = Pairing::new(wishes);
    for pass in 0..PASSES {
        progress.report(pass as f64 / PASSES as f64)?;
        let mut changed = false;
        for &t in wishes.order {
            changed |= pairing.improve(t);
        }
        if !changed {
            break;
        }
    }
    Ok(pairing.mate)
}

/// A triangle and its new partner.
type Step = (u32, u32);

struct Pairing<'a> {
    wishes: &'a Wishes<'a>,
    /// See [`Topology`].
    across: Vec<[u32; 3]>,
    mate: Vec<u32>,
    /// Faces at each vertex, pairs counted once.
    faces: Vec<i32>,
}

impl<'a> Pairing<'a> {
    fn new(wishes: &'a Wishes<'a>) -> Pairing<'a> {
        let across = Topology::new(wishes.positions.len(), wishes.triangles).across;
        let mut faces = vec![0; wishes.positions.len()];
        wishes.triangles.iter().flatten().for_each(|&v| faces[v as usize] += 1);
        Pairing { wishes, across, mate: vec![NONE; wishes.triangles.len()], faces }
    }

    /// Makes the best change that begins with a triangle, if one is for the better.
    fn improve(&mut self, t: u32) -> bool {
        let before = self.mate[t as usize];
        let mut cost = 0.0;
        if before != NONE {
            cost += self.part(t, before);
        }
        let mut best = (-1e-9, vec![]);
        let mut path = vec![];
        self.search(t, DEPTH, cost, &mut path, &mut best);
        if before != NONE {
            self.join(t, before);
        }
        for &(t, s) in &best.1 {
            for one in [t, s] {
                let mate = self.mate[one as usize];
                if mate != NONE {
                    self.part(one, mate);
                }
            }
            self.join(t, s);
        }
        !best.1.is_empty()
    }

    /// Tries all partners of a triangle that has none.
    fn search(&mut self, t: u32, depth: usize, cost: f64, path: &mut Vec<Step>, best: &mut (f64, Vec<Step>)) {
        for s in self.across[t as usize] {
            if s == NONE || path.iter().any(|&(a, b)| a == s || b == s) {
                continue;
            }
            let other = self.mate[s as usize];
            let mut sum = cost;
            if other != NONE {
                sum += self.part(s, other);
            }
            sum += self.join(t, s);
            path.push((t, s));
            if sum < best.0 {
                *best = (sum, path.clone());
            }
            if other != NONE && depth > 0 {
                self.search(other, depth - 1, sum, path, best);
            }
            path.pop();
            self.part(t, s);
            if other != NONE {
                self.join(s, other);
            }
        }
    }

    /// Makes two triangles a pair; what that costs.
    fn join(&mut self, t: u32, s: u32) -> f64 {
        (self.mate[t as usize], self.mate[s as usize]) = (s, t);
        self.changed(t, s, -1) + self.skew(t, s) - 2.0 * ALONE
    }

    /// Parts two triangles; what that costs.
    fn part(&mut self, t: u32, s: u32) -> f64 {
        (self.mate[t as usize], self.mate[s as usize]) = (NONE, NONE);
        self.changed(t, s, 1) - self.skew(t, s) + 2.0 * ALONE
    }

    /// The ends of the edge between two triangles get faces more or less.
    fn changed(&mut self, t: u32, s: u32, by: i32) -> f64 {
        let [a, b, ..] = self.around(t, s);
        let mut cost = 0.0;
        for v in [a as usize, b as usize] {
            cost -= self.cost(v);
            self.faces[v] += by;
            cost += self.cost(v);
        }
        cost
    }

    fn cost(&self, v: usize) -> f64 {
        let off = f64::from(self.faces[v]) - self.wishes.faces[v];
        let doublet = v >= self.wishes.border && self.faces[v] < 3;
        off * off + if doublet { DOUBLET } else { 0.0 }
    }

    /// The ends of the edge between two triangles, and their third corners.
    fn around(&self, t: u32, s: u32) -> [u32; 4] {
        let k = self.across[t as usize].iter().position(|&it| it == s).unwrap_or(0);
        let own = self.wishes.triangles[t as usize];
        let [c, a, b] = [own[k], own[(k + 1) % 3], own[(k + 2) % 3]];
        let other = self.wishes.triangles[s as usize];
        let d = other.into_iter().find(|&v| v != a && v != b).unwrap_or(c);
        [a, b, c, d]
    }

    /// What the shape of a pair costs.
    fn skew(&self, t: u32, s: u32) -> f64 {
        let [a, b, c, d] = self.around(t, s).map(|v| self.wishes.positions[v as usize]);
        let corner = |at: DVec3, from: DVec3, to: DVec3| {
            let angle = (from - at).angle_between(to - at);
            if angle.is_finite() { angle } else { 0.0 }
        };
        let most = [
            corner(a, b, c) + corner(a, b, d),
            corner(b, a, c) + corner(b, a, d),
            corner(c, a, b),
            corner(d, a, b),
        ];
        SKEW * most.into_iter().map(|angle| (angle - OBTUSE).max(0.0)).sum::<f64>()
    }
}
