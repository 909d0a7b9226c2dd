//! Quads from triangles of twice the size: pairs of triangles cut into four, single ones into three.
//!
//! The triangles have every second vertex of the loops; those between are where the edges at the loops are cut. Loops of an odd
//! number of vertices have one edge that stays whole. From one such edge to another leads a row of faces with whole edges between
//! them (`rows`); an edge that has no other is where the one triangle is. Loops too small to be halved get a row of quads, behind which they have twice as many vertices.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::pairs::{Wishes, pairs};
use super::rows::whole;
use super::tour::Loops;
use crate::error::Result;
use crate::fill::even::local::edge;
use crate::geometry::topology::{NONE, Topology};
use crate::progress::Progress;

/// Loops of fewer vertices are not halved.
const SMALL: usize = 6;

/// What it costs to leave out a vertex that has room for another quad than two, beyond its absence.
const POINTED: f64 = 1.5;

/// Which vertices of the loops the large triangles have.
pub(super) struct Halves {
    /// Their places, loop by loop.
    pub picks: Vec<usize>,
    /// The loops of these.
    pub loops: Loops,
    /// The places of all vertices.
    all: Loops,
    /// For each pick the place between it and the next.
    between: Vec<Between>,
    /// True for each loop that is not halved.
    small: Vec<bool>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Between {
    /// A vertex of the loop.
    Place(u32),
    /// A new vertex, of a loop that is not halved.
    New,
    /// None: the edge stays whole.
    Whole,
}

/// The faces; vertices of the loops come first.
pub(super) struct Quads {
    pub positions: Vec<DVec3>,
    pub quads: Vec<[u32; 4]>,
    pub odd: Option<[u32; 3]>,
}

impl Halves {
    /// `at`: where the vertices of the loops are; `room`: the quads that each should have. The edge that stays whole is the
    /// longest of its loop.
    pub fn new(all: Loops, at: &[DVec3], room: &[f64]) -> Halves {
        let (mut picks, mut between, mut small, mut lengths) = (vec![], vec![], vec![], vec![]);
        for k in 0..all.starts.len() {
            let range = all.range(k);
            let n = range.len();
            let is_small = n < SMALL;
            let length = |k: usize| at[k].distance(at[all.next(k)]);
            let longest = range.clone().max_by(|&a, &b| length(a).total_cmp(&length(b)).then(b.cmp(&a)));
            // What lies between picks has two quads, and should not stand far into the patch.
            let off = |k: usize| (room[k] - 2.0).abs() + POINTED * (room[k] - 2.0).max(0.0);
            let costs = |first: usize| (range.start + first..range.end).step_by(2).map(off).sum::<f64>();
            let first = match longest {
                Some(longest) if n % 2 == 1 => all.next(longest),
                _ => range.start + usize::from(costs(1) > costs(0)),
            };
            let place = |step: usize| range.start + (first - range.start + step) % n;
            let count = if is_small { n } else { n.div_ceil(2) };
            for i in 0..count {
                picks.push(place(if is_small { i } else { 2 * i }));
                between.push(match (n % 2 == 1 && i + 1 == count, is_small) {
                    (true, _) => Between::Whole,
                    (_, true) => Between::New,
                    _ => Between::Place(place(2 * i + 1) as u32),
                });
            }
            small.push(is_small);
            lengths.push(count);
        }
        Halves { loops: Loops::new(lengths.into_iter()), picks, all, between, small }
    }

    /// Triangles between all places, and new vertices, without the places that are left out: each goes into one beside it. None
    /// if that would make an edge twice.
    pub fn coarse(&self, positions: &[DVec3], triangles: &[[u32; 3]]) -> Option<(Vec<DVec3>, Vec<[u32; 3]>)> {
        let mut triangles = triangles.to_vec();
        let mut fans = vec![vec![]; positions.len()];
        for (t, corners) in triangles.iter().enumerate() {
            corners.iter().for_each(|&v| fans[v as usize].push(t));
        }
        for between in &self.between {
            let Between::Place(place) = *between else { continue };
            let near = |v: u32, triangles: &[[u32; 3]], fans: &[Vec<usize>]| {
                let all = fans[v as usize].iter().flat_map(|&t| triangles[t]);
                all.filter(|&u| u != v).collect::<FxHashSet<u32>>()
            };
            let own = near(place, &triangles, &fans);
            let beside = [self.all.before(place as usize), self.all.next(place as usize)].map(|v| v as u32);
            // An ear is left out.
            let ear = fans[place as usize].len() == 1 && fans[beside[0] as usize].len() > 1;
            let into = beside
                .into_iter()
                .find(|&v| ear || near(v, &triangles, &fans).intersection(&own).count() == 1)?;
            for t in std::mem::take(&mut fans[place as usize]) {
                if ear || triangles[t].contains(&into) {
                    triangles[t].iter().for_each(|&v| fans[v as usize].retain(|&it| it != t));
                    triangles[t] = [NONE; 3];
                } else {
                    triangles[t].iter_mut().filter(|v| **v == place).for_each(|v| *v = into);
                    fans[into as usize].push(t);
                }
            }
        }
        let places = self.all_places();
        let kept = self.picks.iter().copied().chain(places..positions.len()).collect::<Vec<_>>();
        let mut names = vec![NONE; positions.len()];
        kept.iter().zip(0..).for_each(|(&v, name)| names[v] = name);
        triangles.retain(|t| t[0] != NONE);
        triangles.iter_mut().flatten().for_each(|v| *v = names[*v as usize]);
        Some((kept.into_iter().map(|v| positions[v]).collect(), triangles))
    }

    /// How many vertices the loops have.
    fn all_places(&self) -> usize {
        self.all.range(self.all.starts.len() - 1).end
    }

    /// The faces that the triangles between the picks, then new vertices, are cut into. `taken`: edges of the mesh between
    /// places. None if no row of triangles leads from one edge that stays whole to another.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled).
    pub fn cut(
        &self,
        at: &[DVec3],
        room: &[f64],
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        taken: &FxHashSet<[u32; 2]>,
        progress: Progress<'_>,
    ) -> Result<Option<Quads>> {
        let across = Topology::new(positions.len(), triangles).across;
        let wishes = Wishes {
            positions,
            triangles,
            faces: &self.wanted(room, positions.len()),
            border: self.picks.len(),
            order: &inward(&across),
        };
        let mates = pairs(&wishes, progress)?;
        let mut faces = vec![];
        for (t, corners) in triangles.iter().enumerate() {
            match mates[t] {
                NONE => faces.push(corners.to_vec()),
                mate if mate as usize > t => {
                    let other = triangles[mate as usize];
                    let k = (0..3).find(|&k| across[t][k] == mate).unwrap_or(0);
                    let far = other.into_iter().find(|v| !corners.contains(v)).unwrap_or(corners[k]);
                    faces.push(vec![corners[k], corners[(k + 1) % 3], far, corners[(k + 2) % 3]]);
                }
                _ => {}
            }
        }
        let picks = 0..self.picks.len();
        let odd =
            picks.filter(|&k| self.between[k] == Between::Whole).map(|k| self.side(k)).collect::<Vec<_>>();
        let closed = |e: [u32; 2]| self.repeats(e, taken);
        let Some(whole) = whole(&faces, &odd, &closed) else { return Ok(None) };
        let mut cutter = Cutter::new(self, at, positions);
        faces.iter().for_each(|face| cutter.face(face, &whole));
        cutter.rows();
        Ok(Some(Quads { positions: cutter.positions, quads: cutter.quads, odd: cutter.odd }))
    }

    /// The edge from a pick to the next.
    fn side(&self, pick: usize) -> [u32; 2] {
        edge(pick as u32, self.loops.next(pick) as u32)
    }

    /// Whether an edge between two vertices of the triangles, left whole, would be one that the mesh has.
    fn repeats(&self, e: [u32; 2], taken: &FxHashSet<[u32; 2]>) -> bool {
        // Behind small loops vertices are new.
        let place = |v: u32| {
            let pick = *self.picks.get(v as usize)?;
            (!self.small[self.loops.of(v as usize)]).then_some(pick)
        };
        let follows = |a: usize, b: usize| self.all.next(a) == b || self.all.next(b) == a;
        let [a, b] = e.map(place);
        a.zip(b).is_some_and(|(a, b)| follows(a, b) || taken.contains(&edge(a as u32, b as u32)))
    }

    /// The faces that each vertex of the triangles is to have.
    fn wanted(&self, room: &[f64], vertices: usize) -> Vec<f64> {
        let mut wanted = vec![4.0; vertices];
        for (pick, &place) in self.picks.iter().enumerate() {
            let k = self.loops.of(pick);
            wanted[pick] = if !self.small[k] {
                room[place].round()
            } else if self.is_corner(pick) {
                3.0
            } else {
                2.0
            };
        }
        wanted
    }

    /// Whether a vertex of a loop that is not halved has a corner of the row of quads behind it.
    fn is_corner(&self, pick: usize) -> bool {
        let range = self.loops.range(self.loops.of(pick));
        let step = pick - range.start;
        step.is_multiple_of(2) && step + 1 < range.len()
    }
}

/// All triangles, from those at the border inward.
fn inward(across: &[[u32; 3]]) -> Vec<u32> {
    let mut order =
        (0..across.len() as u32).filter(|&t| across[t as usize].contains(&NONE)).collect::<Vec<_>>();
    let mut seen = vec![false; across.len()];
    order.iter().for_each(|&t| seen[t as usize] = true);
    let mut next = 0;
    while next < order.len() {
        for s in across[order[next] as usize] {
            if s != NONE && !std::mem::replace(&mut seen[s as usize], true) {
                order.push(s);
            }
        }
        next += 1;
    }
    order
}

/// Makes the faces.
struct Cutter<'a> {
    halves: &'a Halves,
    positions: Vec<DVec3>,
    /// What the vertices of the triangles are called.
    names: Vec<u32>,
    /// What lies in the middle of each edge.
    middles: FxHashMap<[u32; 2], u32>,
    quads: Vec<[u32; 4]>,
    odd: Option<[u32; 3]>,
}

impl<'a> Cutter<'a> {
    fn new(halves: &'a Halves, at: &[DVec3], given: &[DVec3]) -> Cutter<'a> {
        let mut positions = at.to_vec();
        let mut new = |p: DVec3| {
            positions.push(p);
            positions.len() as u32 - 1
        };
        let name = |(v, &p): (usize, &DVec3)| match halves.picks.get(v) {
            Some(&place) if !halves.small[halves.loops.of(v)] => place as u32,
            _ => new(p),
        };
        let names = given.iter().enumerate().map(name).collect::<Vec<_>>();
        let mut middles = FxHashMap::default();
        for (pick, between) in halves.between.iter().enumerate() {
            if let Between::Place(place) = *between {
                middles.insert(halves.side(pick), place);
            }
        }
        Cutter { halves, positions, names, middles, quads: vec![], odd: None }
    }

    fn add(&mut self, of: &[u32]) -> u32 {
        let sum = of.iter().map(|&v| self.positions[v as usize]).sum::<DVec3>();
        self.positions.push(sum / of.len() as f64);
        self.positions.len() as u32 - 1
    }

    fn middle(&mut self, a: u32, b: u32) -> u32 {
        if let Some(&middle) = self.middles.get(&edge(a, b)) {
            return middle;
        }
        let new = self.add(&[self.names[a as usize], self.names[b as usize]]);
        self.middles.insert(edge(a, b), new);
        new
    }

    /// The faces that a face is cut into: around its middle, or fewer where sides stay whole.
    fn face(&mut self, corners: &[u32], whole: &FxHashSet<[u32; 2]>) {
        let n = corners.len();
        let at = |k: usize| corners[k % n];
        let is_whole = |k: usize| whole.contains(&edge(at(k), at(k + 1)));
        let sides = (0..n).filter(|&k| is_whole(k)).collect::<Vec<_>>();
        let name = |it: &Self, k: usize| it.names[at(k) as usize];
        match (n, sides.as_slice()) {
            (_, []) => {
                let middles = (0..n).map(|k| self.middle(at(k), at(k + 1))).collect::<Vec<_>>();
                let names = (0..n).map(|k| name(self, k)).collect::<Vec<_>>();
                let centre = self.add(&names);
                self.quads.extend((0..n).map(|k| [names[k], middles[k], centre, middles[(k + n - 1) % n]]));
            }
            (3, &[k]) => {
                let (right, left) = (self.middle(at(k + 1), at(k + 2)), self.middle(at(k + 2), at(k)));
                self.quads.push([name(self, k), name(self, k + 1), right, left]);
                self.odd = Some([left, right, name(self, k + 2)]);
            }
            (3, &[_, _]) => {
                let k = (0..3).find(|&k| !is_whole(k)).unwrap_or(0);
                let middle = self.middle(at(k), at(k + 1));
                self.quads.push([name(self, k), middle, name(self, k + 1), name(self, k + 2)]);
            }
            (3, _) => self.odd = Some([0, 1, 2].map(|k| name(self, k))),
            (_, &[k]) => {
                let names = (0..n).map(|i| name(self, k + i)).collect::<Vec<_>>();
                let [right, far, left] = [1, 2, 3].map(|i| self.middle(at(k + i), at(k + i + 1)));
                let centre = self.add(&names);
                self.quads.push([names[0], names[1], right, centre]);
                self.quads.push([centre, right, names[2], far]);
                self.quads.push([centre, far, names[3], left]);
                self.odd = Some([left, names[0], centre]);
            }
            (_, &[k, other]) if other == k + 2 => {
                let (right, left) = (self.middle(at(k + 1), at(k + 2)), self.middle(at(k + 3), at(k)));
                self.quads.push([name(self, k), name(self, k + 1), right, left]);
                self.quads.push([left, right, name(self, k + 2), name(self, k + 3)]);
            }
            (_, &[one, other]) => {
                // Around a corner: from the vertex between the whole sides to the one across.
                let k = if other == one + 1 { one } else { other };
                let (right, left) = (self.middle(at(k + 2), at(k + 3)), self.middle(at(k + 3), at(k)));
                self.quads.push([name(self, k + 1), name(self, k + 2), right, name(self, k + 3)]);
                self.quads.push([name(self, k), name(self, k + 1), name(self, k + 3), left]);
            }
            _ => self.quads.push([0, 1, 2, 3].map(|k| name(self, k))),
        }
    }

    /// The rows behind loops that are not halved: every second vertex has two edges into them, and the corner of one more quad.
    fn rows(&mut self) {
        for k in (0..self.halves.small.len()).filter(|&k| self.halves.small[k]) {
            let picks = self.halves.loops.range(k);
            // What lies behind, all around.
            let mut behind = vec![];
            for pick in picks.clone() {
                behind.push(self.names[pick]);
                if self.halves.between[pick] == Between::New {
                    let next = self.halves.loops.next(pick);
                    behind.push(self.middle(pick as u32, next as u32));
                }
            }
            self.drawn_in(&behind);
            let at = |step: usize| behind[step % behind.len()];
            // For each vertex the first and the last of its edges.
            let mut ends = vec![];
            let mut next = 0;
            for pick in picks.clone() {
                let first = if ends.is_empty() { behind.len() - 1 } else { next };
                let last = if self.halves.is_corner(pick) { first + 2 } else { first };
                ends.push((first, last));
                next = (last + 1) % behind.len();
            }
            let place = |step: usize| self.halves.picks[picks.start + step % ends.len()] as u32;
            for (step, &(first, last)) in ends.iter().enumerate() {
                if last > first {
                    self.quads.push([place(step), at(last), at(first + 1), at(first)]);
                }
                let (after, _) = ends[(step + 1) % ends.len()];
                self.quads.push([place(step), place(step + 1), at(after), at(last)]);
            }
        }
    }

    /// Moves the vertices behind a small loop away from it, half way to their neighbours.
    fn drawn_in(&mut self, behind: &[u32]) {
        let own = behind.iter().copied().collect::<FxHashSet<_>>();
        let mut sums: FxHashMap<u32, (DVec3, f64)> = FxHashMap::default();
        for quad in &self.quads {
            for k in 0..4 {
                for near in [quad[(k + 1) % 4], quad[(k + 3) % 4]] {
                    if own.contains(&quad[k]) && !own.contains(&near) {
                        let sum = sums.entry(quad[k]).or_default();
                        *sum = (sum.0 + self.positions[near as usize], sum.1 + 1.0);
                    }
                }
            }
        }
        for &v in behind {
            if let Some((sum, count)) = sums.get(&v) {
                self.positions[v as usize] = self.positions[v as usize].midpoint(*sum / *count);
            }
        }
    }
}

#[cfg(test)]
#[path = "halves_tests.rs"]
mod tests;
