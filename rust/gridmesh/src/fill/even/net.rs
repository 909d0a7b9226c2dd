//! A mesh with a fixed border whose connections change fast: neighbours by number, no lists at vertices.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::local::{GONE, Local, edge, quality};
use super::remesh::Ground;
use crate::geometry::topology::NONE;

/// Part of the way to the middle of its neighbours that a vertex moves at once.
const PART: f64 = 0.5;

/// A mesh whose vertices have so many triangles more or fewer than wanted.
#[derive(Clone)]
pub(super) struct Net {
    /// The border's vertices first.
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Triangles at each vertex; none if it is gone.
    pub count: Vec<i32>,
    /// So many more than wanted.
    pub off: Vec<i32>,
    /// Wanted edge length at each vertex.
    pub sizes: Vec<f64>,
    pub border: usize,
    /// Vertices whose triangles stay as they are; those that come later are none of them.
    pub held: Vec<bool>,
    /// Vertices of hard lines, which stay where they are.
    pub fixed: Vec<bool>,
    /// Edges of hard lines, lower vertex first.
    hard: FxHashSet<[u32; 2]>,
    taken: FxHashSet<[u32; 2]>,
    /// For each corner of a triangle the triangle beyond the edge that faces it.
    across: Vec<[u32; 3]>,
    /// A triangle of each vertex.
    at: Vec<u32>,
}

/// Two triangles at an edge from `a` to `b`, with the corners that face it.
#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub t: u32,
    pub s: u32,
    pub a: u32,
    pub b: u32,
    /// Of `t`, which is c, a, b.
    pub c: u32,
    /// Of `s`, which is d, b, a.
    pub d: u32,
}

/// As long as twice the area.
pub(super) fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

impl Net {
    pub fn new(local: &Local) -> Net {
        let triangles = local.triangles.iter().copied().filter(|t| *t != GONE).collect::<Vec<_>>();
        let mut beyond: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        for (t, own) in (0..).zip(&triangles) {
            (0..3).for_each(|k| {
                beyond.insert([own[(k + 1) % 3], own[(k + 2) % 3]], t);
            });
        }
        let facing = |own: &[u32; 3]| {
            [0, 1, 2].map(|k| beyond.get(&[own[(k + 2) % 3], own[(k + 1) % 3]]).copied().unwrap_or(NONE))
        };
        let across = triangles.iter().map(facing).collect();
        let n = local.positions.len();
        let (mut count, mut at) = (vec![0; n], vec![NONE; n]);
        for (t, own) in (0..).zip(&triangles) {
            for &v in own {
                count[v as usize] += 1;
                at[v as usize] = t;
            }
        }
        let off = (0..n).map(|v| count[v] - local.wanted_at(v as u32) as i32).collect();
        let mut fixed = vec![false; n];
        local.hard.iter().flatten().for_each(|&v| fixed[v as usize] = true);
        Net {
            positions: local.positions.clone(),
            sizes: local.sizes.clone(),
            taken: local.taken.clone(),
            border: local.border,
            held: vec![false; n],
            fixed,
            hard: local.hard.iter().copied().collect(),
            triangles,
            across,
            count,
            off,
            at,
        }
    }

    /// Puts connections and positions back.
    pub fn write(self, local: &mut Local) {
        let live = self.triangles.into_iter().filter(|t| *t != GONE).collect::<Vec<_>>();
        let sides = vec![0; live.len()];
        let mut made = Local::new(self.positions, live, sides, self.border);
        made.sizes = self.sizes;
        made.wanted = std::mem::take(&mut local.wanted);
        made.taken = self.taken;
        made.hard = self.hard.into_iter().collect();
        *local = made;
        local.compact();
    }

    fn is_border(&self, v: u32) -> bool {
        (v as usize) < self.border
    }

    pub fn corners(&self, t: [u32; 3]) -> [DVec3; 3] {
        t.map(|v| self.positions[v as usize])
    }

    /// The length of an edge, in those wanted at its ends.
    pub fn length(&self, a: u32, b: u32) -> f64 {
        let wanted = 0.5 * (self.sizes[a as usize] + self.sizes[b as usize]);
        self.positions[a as usize].distance(self.positions[b as usize]) / wanted
    }

    /// Whether [`Net::pair`] has any irregular corner: at most edges there is none.
    pub fn is_irregular_at(&self, t: u32, k: usize) -> bool {
        let off = |v: u32| self.off[v as usize];
        let (own, s) = (self.triangles[t as usize], self.across[t as usize][k]);
        if s == NONE || s < t || own == GONE {
            return false;
        }
        let [p, q, r] = self.triangles[s as usize];
        off(own[0]) | off(own[1]) | off(own[2]) | off(p ^ q ^ r ^ own[(k + 1) % 3] ^ own[(k + 2) % 3]) != 0
    }

    /// The triangles at the edge that faces a corner, each edge once; none at hard ones.
    pub fn pair(&self, t: u32, k: usize) -> Option<Pair> {
        let s = self.across[t as usize][k];
        if s == NONE || s < t {
            return None;
        }
        let [c, a, b] = [0, 1, 2].map(|i| self.triangles[t as usize][(k + i) % 3]);
        if c == NONE || !self.hard.is_empty() && self.hard.contains(&edge(a, b)) {
            return None;
        }
        let [p, q, r] = self.triangles[s as usize];
        Some(Pair { t, s, a, b, c, d: p ^ q ^ r ^ a ^ b })
    }

    /// Calls `visit` with the triangles at a vertex, each with the place of the vertex in it, until that is true; whether it was.
    fn any_around(&self, v: u32, mut visit: impl FnMut(u32, usize) -> bool) -> bool {
        let first = self.at[v as usize];
        if first == NONE {
            return false;
        }
        let mut t = first;
        // Counter-clockwise to the end, or around; then the other way from the start.
        for way in [1, 2] {
            while t != NONE {
                let Some(k) = self.triangles[t as usize].iter().position(|&u| u == v) else { return false };
                if visit(t, k) {
                    return true;
                }
                t = self.across[t as usize][(k + way) % 3];
                if t == first {
                    return false;
                }
            }
            let Some(k) = self.triangles[first as usize].iter().position(|&u| u == v) else { return false };
            t = self.across[first as usize][(k + 2) % 3];
        }
        false
    }

    fn is_edge(&self, a: u32, b: u32) -> bool {
        self.any_around(a, |t, _| self.triangles[t as usize].contains(&b))
    }

    /// Whether an edge would repeat one, here or beyond the border.
    fn repeats(&self, a: u32, b: u32) -> bool {
        let both = self.is_border(a) && self.is_border(b);
        both && self.taken.contains(&edge(a, b)) || self.is_edge(a, b)
    }

    /// The neighbours of a vertex inside, counter-clockwise, and the triangles from each to the next; none of one that is gone.
    pub fn ring(&self, v: u32, ring: &mut Vec<[u32; 2]>) {
        ring.clear();
        self.any_around(v, |t, k| {
            ring.push([self.triangles[t as usize][(k + 1) % 3], t]);
            false
        });
    }

    /// Whether an edge may be flipped without harm to the mesh.
    pub fn may_flip(&self, it: Pair) -> bool {
        let enough = |v: u32| self.count[v as usize] >= if self.is_border(v) { 2 } else { 5 };
        enough(it.a) && enough(it.b) && it.c != it.d && !self.repeats(it.c, it.d)
    }

    fn relink(&mut self, t: u32, from: u32, to: u32) {
        if t != NONE {
            self.across[t as usize].iter_mut().filter(|s| **s == from).for_each(|s| *s = to);
        }
    }

    fn add(&mut self, v: u32, more: i32) {
        self.count[v as usize] += more;
        self.off[v as usize] += more;
    }

    pub fn flip(&mut self, it: Pair) {
        let Pair { t, s, a, b, c, d } = it;
        let facing = |t: u32, v: u32| {
            let k = self.triangles[t as usize].iter().position(|&u| u == v).unwrap_or(0);
            self.across[t as usize][k]
        };
        let [bc, ca, ad, db] = [facing(t, a), facing(t, b), facing(s, b), facing(s, a)];
        (self.triangles[t as usize], self.across[t as usize]) = ([c, a, d], [ad, s, ca]);
        (self.triangles[s as usize], self.across[s as usize]) = ([d, b, c], [bc, t, db]);
        self.relink(ad, s, t);
        self.relink(bc, t, s);
        [(a, -1), (b, -1), (c, 1), (d, 1)].into_iter().for_each(|(v, more)| self.add(v, more));
        for (v, t) in [(a, t), (c, t), (b, s), (d, s)] {
            self.at[v as usize] = t;
        }
    }

    /// Whether the vertex inside with this ring may go into its i-th neighbour; no edge gets longer than `longest`, and no triangle
    /// worse than `least`.
    pub fn may_collapse(&self, ring: &[[u32; 2]], i: usize, longest: f64, least: f64) -> bool {
        let k = ring.len();
        let stays = ring[i][0];
        let apexes = [ring[(i + 1) % k][0], ring[(i + k - 1) % k][0]];
        let spare = |v: u32| self.count[v as usize] > if self.is_border(v) { 1 } else { 4 };
        if k < 4 || !apexes.into_iter().all(spare) {
            return false;
        }
        (1..k - 1).all(|j| {
            let [v, t] = ring[(i + j) % k];
            let next = ring[(i + j + 1) % k][0];
            let old = self.triangles[t as usize];
            let gone = old[0] ^ old[1] ^ old[2] ^ v ^ next;
            let new = self.corners([stays, v, next]);
            let far = j == 1 || !self.repeats(v, stays) && self.length(v, stays) <= longest;
            far && quality(new) > least && normal(new).dot(normal(self.corners([gone, v, next]))) > 0.0
        })
    }

    pub fn collapse(&mut self, gone: u32, ring: &[[u32; 2]], i: usize) {
        let k = ring.len();
        let stays = ring[i][0];
        let [after, t] = [ring[(i + 1) % k][0], ring[i][1]];
        let [before, s] = ring[(i + k - 1) % k];
        let beyond = |t: u32, v: u32| {
            let own = self.triangles[t as usize].iter().position(|&u| u == v).unwrap_or(0);
            self.across[t as usize][own]
        };
        // Beyond both triangles that go, on the side of the vertex that stays and on the other one.
        let [x, y] = [beyond(t, gone), beyond(s, gone)];
        let [p, q] = [ring[(i + 1) % k][1], ring[(i + k - 2) % k][1]];
        self.relink(p, t, x);
        self.relink(x, t, p);
        self.relink(q, s, y);
        self.relink(y, s, q);
        for j in 1..k - 1 {
            let t = ring[(i + j) % k][1] as usize;
            self.triangles[t].iter_mut().filter(|v| **v == gone).for_each(|v| *v = stays);
        }
        for t in [t, s] {
            (self.triangles[t as usize], self.across[t as usize]) = (GONE, [NONE; 3]);
        }
        (self.at[stays as usize], self.at[after as usize], self.at[before as usize]) = (p, p, q);
        self.at[gone as usize] = NONE;
        (self.count[gone as usize], self.off[gone as usize]) = (0, 0);
        self.add(stays, k as i32 - 4);
        self.add(after, -1);
        self.add(before, -1);
    }

    /// Puts a second vertex beside one inside that takes over m triangles from the i-th on, if none gets worse than `least`.
    pub fn divide(&mut self, v: u32, ring: &[[u32; 2]], [i, m]: [usize; 2], least: f64) -> bool {
        let k = ring.len();
        let name = |j: usize| ring[(i + j) % k][0];
        let own = |j: usize| ring[(i + j) % k][1];
        let p = self.positions[v as usize];
        let middle = |from: usize, to: usize| {
            let sum =
                (from..to).map(|j| self.positions[name(j) as usize] + self.positions[name(j + 1) as usize]);
            p.midpoint(sum.sum::<DVec3>() / (2 * (to - from)) as f64)
        };
        let (there, here) = (middle(0, m), middle(m, k));
        let at = |j: usize| self.positions[name(j) as usize];
        let way = (0..k).map(|j| normal([p, at(j), at(j + 1)])).sum::<DVec3>();
        let good = |t: [DVec3; 3]| quality(t) > least && normal(t).dot(way) > 0.0;
        let all = (0..k).all(|j| good([if j < m { there } else { here }, at(j), at(j + 1)]));
        if !all || !good([here, at(0), there]) || !good([here, there, at(m)]) {
            return false;
        }
        let (w, t) = (self.positions.len() as u32, self.triangles.len() as u32);
        let s = t + 1;
        for j in 0..m {
            self.triangles[own(j) as usize].iter_mut().filter(|u| **u == v).for_each(|u| *u = w);
        }
        let [first, last, before, after] = [own(0), own(m - 1), own(k - 1), own(m)];
        self.triangles.extend([[v, name(0), w], [v, w, name(m)]]);
        self.across.extend([[first, s, before], [last, after, t]]);
        self.relink(first, before, t);
        self.relink(before, first, t);
        self.relink(last, after, s);
        self.relink(after, last, s);
        self.positions[v as usize] = here;
        self.positions.push(there);
        self.sizes.push(self.sizes[v as usize]);
        self.held.push(false);
        self.fixed.push(false);
        self.at.push(first);
        self.at[v as usize] = after;
        self.count.push(m as i32 + 2);
        self.off.push(m as i32 + 2 - 6);
        self.add(v, 2 - m as i32);
        self.add(name(0), 1);
        self.add(name(m), 1);
        true
    }

    /// Moves vertices inside part of the way to the middle of their neighbours, within the planes of these, and on `ground` back to it.
    pub fn relax(&mut self, ground: Option<&Ground>) {
        let n = self.positions.len();
        let mut sums = vec![(DVec3::ZERO, DVec3::ZERO); n];
        for own in self.triangles.iter().filter(|t| **t != GONE) {
            let [a, b, c] = self.corners(*own);
            let up = normal([a, b, c]);
            for (&v, both) in own.iter().zip([b + c, c + a, a + b]) {
                let sum = &mut sums[v as usize];
                *sum = (sum.0 + both, sum.1 + up);
            }
        }
        for (v, (sum, normals)) in sums.into_iter().enumerate().skip(self.border) {
            let moves = self.count[v] > 0 && !self.held[v] && !self.fixed[v];
            let (true, Some(up)) = (moves, normals.try_normalize()) else {
                continue;
            };
            let p = self.positions[v];
            let mean = sum / f64::from(2 * self.count[v]);
            let there = p + PART * (mean - p).reject_from_normalized(up);
            self.positions[v] = ground.map_or(there, |ground| ground.nearest(0, there, up));
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::fill::even::local::tests::sheet;
    use crate::geometry::metrics::check_mesh;

    proptest! {
        #[test]
        fn moves_keep_a_disk_with_the_border_it_had(moves in prop::collection::vec(any::<[u32; 3]>(), 1..300)) {
            let mut local = sheet(7);
            local.sizes.fill(1.0);
            let border = local.border;
            let mut net = Net::new(&local);
            let sum = net.off.iter().sum::<i32>();
            let mut ring = vec![];
            for [kind, a, b] in moves {
                let v = a % net.positions.len() as u32;
                net.ring(v, &mut ring);
                let inside = v as usize >= border && ring.len() > 3;
                match kind % 4 {
                    0 if inside => {
                        let i = b as usize % ring.len();
                        if net.may_collapse(&ring, i, 3.0, 0.05) {
                            net.collapse(v, &ring, i);
                        }
                    }
                    1 if inside && ring.len() > 5 => {
                        net.divide(v, &ring, [b as usize % ring.len(), 3], 0.05);
                    }
                    2 => net.relax(None),
                    _ => {
                        let t = a % net.triangles.len() as u32;
                        if let Some(pair) = net.pair(t, b as usize % 3).filter(|pair| net.may_flip(*pair)) {
                            net.flip(pair);
                        }
                    }
                }
            }
            prop_assert_eq!(net.off.iter().sum::<i32>(), sum);
            let counts = net.count.clone();
            net.write(&mut local);
            let check = check_mesh(local.positions.len(), &local.triangles);
            prop_assert_eq!((check.bad_edges, check.bad_vertices, check.euler, check.boundaries), (0, 0, 1, 1));
            let live = counts.into_iter().enumerate().filter(|&(v, count)| v < border || count > 0);
            let told = live.map(|(_, count)| count as usize).collect::<Vec<_>>();
            let found = (0..local.positions.len() as u32).map(|v| local.fan(v).len()).collect::<Vec<_>>();
            prop_assert_eq!(told, found);
        }
    }
}
