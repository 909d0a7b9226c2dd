//! A small mesh with a fixed border, whose edges are split, collapsed and flipped one at a time.

use std::collections::BTreeSet;

use glam::DVec3;
use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use crate::geometry::topology::NONE;
use crate::path::placement::ROW_HEIGHT;

/// What a triangle that is gone consists of.
pub(super) const GONE: [u32; 3] = [NONE; 3];

/// Triangles rounder than this have a normal worth keeping.
const ROUND: f64 = 0.05;

/// Quality that a collapse or a flip may not go below, unless it was worse before.
const THIN: f64 = 0.1;

/// Cosine of the angle by which a triangle may turn.
const TURN: f64 = 0.3;

/// Knots nearer to each other than this, in wanted lengths, may become one.
const CLOSE: f64 = 0.3;

/// The same for lines: what lies between them would be triangles with hardly an angle.
const SAME: f64 = 0.1;

/// A mesh whose connections change.
#[derive(Clone, Debug)]
pub(crate) struct Local {
    /// The border's vertices first; they stay.
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// The part that each triangle lies on.
    pub sides: Vec<u32>,
    /// Wanted edge length at each vertex.
    pub sizes: Vec<f64>,
    /// Wanted number of triangles at each vertex of the border.
    pub wanted: Vec<usize>,
    /// Vertices of the border.
    pub border: usize,
    /// Edges beyond the border between vertices of it, lower one first: none may be repeated.
    pub taken: FxHashSet<[u32; 2]>,
    /// Edges that stay, but for being split and collapsed along their line; lower vertex first.
    pub hard: BTreeSet<[u32; 2]>,
    /// Vertices that stay where they are, unless one takes up another.
    pub knots: BTreeSet<u32>,
    /// Whether knots and lines that are close to each other may become one.
    pub merges: bool,
    at: Vec<Fan>,
}

/// Triangles or vertices at a vertex, hardly ever more than eight.
type Fan = SmallVec<[u32; 8]>;

/// Lower one first.
pub(crate) fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The shape of a triangle: 1 if it is equilateral, near 0 if it is thin.
pub(crate) fn quality([a, b, c]: [DVec3; 3]) -> f64 {
    let area = (b - a).cross(c - a).length();
    let squares = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
    if squares > 0.0 { 2.0 * 3f64.sqrt() * area / squares } else { 0.0 }
}

impl Local {
    /// `border`: so many vertices come first that stay.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>, sides: Vec<u32>, border: usize) -> Local {
        let mut at = vec![Fan::new(); positions.len()];
        for (t, corners) in triangles.iter().enumerate() {
            corners.iter().for_each(|&v| at[v as usize].push(t as u32));
        }
        Local {
            sizes: vec![0.0; positions.len()],
            wanted: vec![6; border],
            taken: FxHashSet::default(),
            hard: BTreeSet::new(),
            knots: BTreeSet::new(),
            merges: true,
            positions,
            triangles,
            sides,
            border,
            at,
        }
    }

    /// The triangles at a vertex.
    pub fn fan(&self, v: u32) -> &[u32] {
        &self.at[v as usize]
    }

    /// The neighbours of a vertex, ascending.
    pub fn neighbours(&self, v: u32) -> SmallVec<[u32; 16]> {
        let corners = self.fan(v).iter().flat_map(|&t| self.triangles[t as usize]);
        let mut near = corners.filter(|&u| u != v).collect::<SmallVec<_>>();
        near.sort_unstable();
        near.dedup();
        near
    }

    /// The triangles at an edge.
    pub fn beside(&self, [a, b]: [u32; 2]) -> SmallVec<[u32; 2]> {
        self.fan(a).iter().copied().filter(|&t| self.triangles[t as usize].contains(&b)).collect()
    }

    /// All edges, ascending.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let from = |v: u32| self.neighbours(v).into_iter().filter(move |&u| u > v).map(move |u| [v, u]);
        (0..self.positions.len() as u32).flat_map(from).collect()
    }

    /// The length of an edge, in those wanted at its ends.
    pub fn length(&self, [a, b]: [u32; 2]) -> f64 {
        let wanted = 0.5 * (self.sizes[a as usize] + self.sizes[b as usize]);
        self.positions[a as usize].distance(self.positions[b as usize]) / wanted
    }

    /// About how many triangles with edges as wanted have the same area.
    pub fn even_triangles(&self) -> f64 {
        let share = |(t, own): (u32, &[u32; 3])| {
            let [a, b, c] = self.corners(t);
            let wanted = own.iter().map(|&v| self.sizes[v as usize]).sum::<f64>() / 3.0;
            (b - a).cross(c - a).length() / (ROW_HEIGHT * wanted.powi(2))
        };
        (0..).zip(&self.triangles).map(share).sum()
    }

    /// The positions of a triangle's corners.
    pub fn corners(&self, t: u32) -> [DVec3; 3] {
        self.triangles[t as usize].map(|v| self.positions[v as usize])
    }

    /// Whether both ends of an edge are on the border and the edge is one of it.
    pub fn is_border(&self, e: [u32; 2]) -> bool {
        (e[1] as usize) < self.border && self.beside(e).len() < 2
    }

    /// How many triangles a vertex should have.
    pub fn wanted_at(&self, v: u32) -> i64 {
        self.wanted.get(v as usize).map_or(6, |&w| w as i64)
    }

    fn detach(&mut self, t: u32) {
        for v in self.triangles[t as usize] {
            self.at[v as usize].retain(|u| *u != t);
        }
    }

    fn attach(&mut self, t: u32, corners: [u32; 3]) {
        self.triangles[t as usize] = corners;
        corners.iter().for_each(|&v| self.at[v as usize].push(t));
    }

    /// Puts a vertex in the middle of an edge inside.
    pub fn split(&mut self, e: [u32; 2]) {
        let [a, b] = e;
        let m = self.positions.len() as u32;
        self.positions.push(0.5 * (self.positions[a as usize] + self.positions[b as usize]));
        self.sizes.push(0.5 * (self.sizes[a as usize] + self.sizes[b as usize]));
        self.at.push(Fan::new());
        for t in self.beside(e) {
            let own = self.triangles[t as usize];
            let with = |from: u32| own.map(|v| if v == from { m } else { v });
            self.detach(t);
            self.attach(t, with(b));
            self.triangles.push(GONE);
            self.sides.push(self.sides[t as usize]);
            self.attach(self.triangles.len() as u32 - 1, with(a));
        }
        if self.hard.remove(&e) {
            self.hard.extend([edge(a, m), edge(m, b)]);
        }
    }

    /// Whether a vertex may be moved into another one: it is inside, and on a hard line only along that, or into a line that is
    /// as good as the same. A knot may only be moved into one that is close, or, where it is the end of a line, into any line
    /// that is.
    fn may_move(&self, a: u32, b: u32) -> bool {
        let e = edge(a, b);
        if (a as usize) < self.border {
            return false;
        }
        if self.merges && self.length(e) < SAME && self.lines_at(b) > 0 {
            return true;
        }
        if self.knots.contains(&a) {
            let along = self.hard.contains(&e) && self.knots.contains(&b);
            let close = self.merges && self.length(e) < CLOSE;
            return close && (along || self.lines_at(a) == 1 && self.lines_at(b) > 0);
        }
        self.is_soft(a) || self.hard.contains(&e)
    }

    /// How many hard edges end at a vertex.
    fn lines_at(&self, v: u32) -> usize {
        self.neighbours(v).into_iter().filter(|&u| self.hard.contains(&edge(u, v))).count()
    }

    /// Whether no hard edge ends at a vertex.
    pub fn is_soft(&self, v: u32) -> bool {
        self.hard.is_empty() || self.neighbours(v).into_iter().all(|u| !self.hard.contains(&edge(u, v)))
    }

    /// Moves vertex `a` into its neighbour `b`, if the mesh stays one and no triangle gets bad.
    pub fn collapse(&mut self, a: u32, b: u32, longest: f64) -> bool {
        if !self.may_move(a, b) {
            return false;
        }
        let beside = self.beside([a, b]);
        if beside.len() != 2 {
            return false;
        }
        let (is_knot, is_same) = (self.knots.contains(&a), self.merges && self.length([a, b]) < SAME);
        let (near, other) = (self.neighbours(a), self.neighbours(b));
        let common = near.iter().filter(|v| other.contains(v)).count();
        if common != 2 || near.len() < 4 && self.fan(a).len() != 3 {
            return false;
        }
        // A vertex of the border keeps a triangle; two vertices of it get no edge that is there beyond.
        for &v in near.iter().filter(|&&v| v != b) {
            if (v as usize) < self.border
                && (b as usize) < self.border
                && self.taken.contains(&edge(v, b))
                && !other.contains(&v)
            {
                return false;
            }
            if !other.contains(&v) && self.length(edge(b, v)) > longest && !is_same {
                return false;
            }
            // Two lines do not become one, but for one that ends there, or is as good as the same.
            let is_line = other.contains(&v) && self.hard.contains(&edge(a, v));
            let are_two = !is_knot || self.hard.contains(&edge(b, v)) && self.lines_at(a) > 1;
            let is_thin = || self.merges && quality([a, b, v].map(|v| self.positions[v as usize])) < THIN;
            if is_line && are_two && !is_same && !is_thin() {
                return false;
            }
        }
        let apexes = beside.iter().map(|&t| self.apex(t, [a, b])).collect::<Vec<_>>();
        if apexes.iter().any(|&v| self.fan(v).len() <= if (v as usize) < self.border { 1 } else { 3 }) {
            return false;
        }
        let at = self.positions[b as usize];
        let good = |&t: &u32| {
            let own = self.triangles[t as usize];
            let moved = own.map(|v| if v == a { at } else { self.positions[v as usize] });
            self.is_better(self.corners(t), moved)
        };
        if !self.fan(a).iter().filter(|t| !beside.contains(t)).all(good) {
            return false;
        }
        for &t in &beside {
            self.detach(t);
            self.triangles[t as usize] = GONE;
        }
        for t in self.at[a as usize].clone() {
            let own = self.triangles[t as usize].map(|v| if v == a { b } else { v });
            self.detach(t);
            self.attach(t, own);
        }
        for v in near {
            if self.hard.remove(&edge(a, v)) && v != b {
                self.hard.insert(edge(b, v));
            }
        }
        if self.knots.remove(&a) {
            self.knots.insert(b);
        }
        true
    }

    /// Whether a triangle may become another one: it does not get thin, and hardly turns.
    pub fn is_better(&self, before: [DVec3; 3], after: [DVec3; 3]) -> bool {
        let (old, new) = (quality(before), quality(after));
        if new < THIN.min(old) {
            return false;
        }
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
        old < ROUND || normal(before).dot(normal(after)) > TURN
    }

    /// The third corner of a triangle.
    pub fn apex(&self, t: u32, e: [u32; 2]) -> u32 {
        let own = self.triangles[t as usize];
        own.into_iter().find(|v| !e.contains(v)).unwrap_or(own[0])
    }

    /// The triangles that flipping an edge would make, if it may be: in place of its two.
    pub fn flipped(&self, e: [u32; 2]) -> Option<([u32; 2], [[u32; 3]; 2])> {
        if self.hard.contains(&e) {
            return None;
        }
        let &[s, t] = self.beside(e).as_slice() else { return None };
        // Of the first triangle in its order: a, b, c; of the second b, a, d.
        let own = self.triangles[s as usize];
        let k = own.iter().position(|v| !e.contains(v))?;
        let (c, a, b) = (own[k], own[(k + 1) % 3], own[(k + 2) % 3]);
        let d = self.apex(t, e);
        let both = (c as usize) < self.border && (d as usize) < self.border;
        if c == d || both && self.taken.contains(&edge(c, d)) || self.neighbours(c).contains(&d) {
            return None;
        }
        for v in e {
            let least = if (v as usize) < self.border { 2 } else { 4 };
            if self.fan(v).len() < least {
                return None;
            }
        }
        Some(([s, t], [[c, a, d], [d, b, c]]))
    }

    /// Flips an edge if what `worth` says of the new triangles is better than of the old ones.
    pub fn flip(&mut self, [s, t]: [u32; 2], new: [[u32; 3]; 2]) {
        self.detach(s);
        self.detach(t);
        self.attach(s, new[0]);
        self.attach(t, new[1]);
    }

    /// Drops what is gone: vertices and triangles, in their order.
    pub fn compact(&mut self) {
        let live = (0..self.triangles.len()).filter(|&t| self.triangles[t] != GONE).collect::<Vec<_>>();
        let mut name = vec![NONE; self.positions.len()];
        let mut count = 0;
        for (v, name) in name.iter_mut().enumerate() {
            if v < self.border || !self.at[v].is_empty() {
                *name = count;
                self.positions[count as usize] = self.positions[v];
                self.sizes[count as usize] = self.sizes[v];
                count += 1;
            }
        }
        self.positions.truncate(count as usize);
        self.sizes.truncate(count as usize);
        let sides = live.iter().map(|&t| self.sides[t]).collect();
        let triangles = live.iter().map(|&t| self.triangles[t].map(|v| name[v as usize])).collect::<Vec<_>>();
        let named = |e: &[u32; 2]| e.map(|v| name[v as usize]);
        let hard = self.hard.iter().map(named).collect();
        let knots = self.knots.iter().map(|&v| name[v as usize]).collect();
        let (positions, sizes) = (std::mem::take(&mut self.positions), std::mem::take(&mut self.sizes));
        let (wanted, taken) = (std::mem::take(&mut self.wanted), std::mem::take(&mut self.taken));
        let (border, merges) = (self.border, self.merges);
        let bare = Local::new(positions, triangles, sides, border);
        *self = Local { sizes, wanted, taken, hard, knots, merges, ..bare };
    }
}

#[cfg(test)]
#[path = "local_tests.rs"]
pub(super) mod tests;
