//! The faces along the cut as a mesh that can be edited: split, collapse, flip.
//!
//! Edges of the cut stay edges of the cut. Every triangle remembers the old triangle that it lies on; no edit is
//! made that leaves the old triangles around by more than the tolerance, or turns a triangle away from its own.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::cap::shape;
use super::cross::Node;
use super::nearness::{closest, samples, within};
use super::parted::{Part, Parted};

pub(super) struct Strip<'a> {
    pub vertices: &'a [DVec3],
    pub parted: &'a mut Parted,
    /// Triangles; those that are gone are `None`.
    pub parts: Vec<Option<Part>>,
    /// Triangles at each vertex.
    around: FxHashMap<u32, Vec<u32>>,
    /// Vertices on the border of the strip: they stay, and so do the edges between them.
    border: FxHashSet<u32>,
    /// Faces whose triangles were changed.
    pub altered: FxHashSet<u32>,
    /// Triangles changed since somebody took the list.
    pub fresh: Vec<u32>,
    /// How far a triangle may be off the old ones.
    pub tolerance: f64,
    /// How far apart that is looked at.
    spacing: f64,
    /// The cut's edges, by vertex.
    line: FxHashMap<u32, Vec<u32>>,
    /// The old triangles at each old vertex.
    pub old: FxHashMap<u32, Vec<(u32, [u32; 3])>>,
    /// Counts changes; and for each vertex, the last one of its triangles.
    clock: u32,
    changed: FxHashMap<u32, u32>,
    /// For each vertex, when each edit was last tried in vain.
    tried: [FxHashMap<u32, u32>; 4],
}

/// An edit that is tried again and again.
#[derive(Clone, Copy, Debug)]
pub(super) enum Trial {
    Thin,
    Clear,
    Centre,
    Slide,
}

/// How far the new faces may be off the old ones, in edge lengths; less than what is promised, for it is
/// measured at points.
const TOLERANCE: f64 = 0.042;

/// How far apart these points are at most, in edge lengths.
const SPACING: f64 = 0.5;

/// How much of a right way up is left to a triangle.
const UPRIGHT: f64 = 0.5;

impl<'a> Strip<'a> {
    pub fn new(vertices: &'a [DVec3], parted: &'a mut Parted, parts: Vec<Part>, length: f64) -> Self {
        let mut around: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        let mut sides: FxHashMap<(u32, u32), i32> = FxHashMap::default();
        for (i, part) in parts.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (part.corners[k], part.corners[(k + 1) % 3]);
                around.entry(a).or_default().push(i as u32);
                *sides.entry((a.min(b), a.max(b))).or_default() += 1;
            }
        }
        let open = sides.iter().filter(|(_, count)| **count != 2);
        let border = open.flat_map(|(&(a, b), _)| [a, b]).collect();
        let mut line: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        let mut cut = parted.cut.keys().copied().collect::<Vec<_>>();
        cut.sort_unstable();
        for (a, b) in cut {
            line.entry(a).or_default().push(b);
            line.entry(b).or_default().push(a);
        }
        let mut old: FxHashMap<u32, Vec<(u32, [u32; 3])>> = FxHashMap::default();
        let mut homes = parts.iter().map(|p| (p.face, p.home)).collect::<Vec<_>>();
        homes.sort_unstable();
        homes.dedup();
        for (face, home) in homes {
            home.iter().for_each(|&v| old.entry(v).or_default().push((face, home)));
        }
        let parts = parts.into_iter().map(Some).collect();
        Strip {
            vertices,
            parted,
            parts,
            around,
            border,
            altered: FxHashSet::default(),
            fresh: vec![],
            tolerance: TOLERANCE * length,
            spacing: SPACING * length,
            line,
            old,
            clock: 0,
            changed: FxHashMap::default(),
            tried: Default::default(),
        }
    }

    /// True if an edit of `v` failed before, and nothing that it depends on has changed since.
    pub fn is_hopeless(&self, v: u32, trial: Trial) -> bool {
        let Some(&when) = self.tried[trial as usize].get(&v) else { return false };
        let same = |w: u32| self.changed.get(&w).is_none_or(|&at| at <= when);
        let near = self.triangles_at(v).iter().filter_map(|&t| self.part(t)).flat_map(|p| p.corners);
        same(v) && near.into_iter().all(same)
    }

    /// Notes that an edit of `v` failed.
    pub fn give_up(&mut self, v: u32, trial: Trial) {
        self.tried[trial as usize].insert(v, self.clock);
    }

    pub fn touch(&mut self, corners: [u32; 3]) {
        self.clock += 1;
        for v in corners {
            self.changed.insert(v, self.clock);
        }
    }

    pub fn position(&self, v: u32) -> DVec3 {
        self.parted.position(self.vertices, v)
    }

    /// Neighbours along the cut.
    pub fn on_line(&self, v: u32) -> &[u32] {
        self.line.get(&v).map_or(&[], Vec::as_slice)
    }

    pub fn is_border(&self, v: u32) -> bool {
        self.border.contains(&v)
    }

    pub fn is_cut(&self, a: u32, b: u32) -> bool {
        self.parted.cut.contains_key(&(a.min(b), a.max(b)))
    }

    pub fn triangles_at(&self, v: u32) -> &[u32] {
        self.around.get(&v).map_or(&[], Vec::as_slice)
    }

    pub fn part(&self, t: u32) -> Option<&Part> {
        self.parts[t as usize].as_ref()
    }

    pub fn min_angle(&self, corners: [u32; 3]) -> f64 {
        shape(corners.map(|v| self.position(v))).0
    }

    /// The old surface's normal at a vertex: the mean over the triangles there.
    pub fn normal(&self, v: u32) -> DVec3 {
        let own = self.triangles_at(v).iter().filter_map(|&t| self.part(t)).map(|part| {
            let [a, b, c] = self.home(part.home);
            (b - a).cross(c - a).normalize_or_zero()
        });
        own.sum::<DVec3>().normalize_or_zero()
    }

    pub fn neighbours(&self, v: u32) -> Vec<u32> {
        let mut found = vec![];
        for part in self.triangles_at(v).iter().filter_map(|&t| self.part(t)) {
            found.extend(part.corners.into_iter().filter(|&w| w != v));
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    pub fn with_edge(&self, a: u32, b: u32) -> Vec<u32> {
        let has = |t: &&u32| self.part(**t).is_some_and(|p| p.corners.contains(&b));
        self.triangles_at(a).iter().filter(has).copied().collect()
    }

    pub fn home(&self, home: [u32; 3]) -> [DVec3; 3] {
        home.map(|v| self.vertices[v as usize])
    }

    /// True if a triangle has an area and faces as its old one does.
    pub fn is_upright(&self, corners: [u32; 3], home: [u32; 3]) -> bool {
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let p = corners.map(|v| self.position(v));
        let (own, old) = (normal(p), normal(self.home(home)));
        let longest =
            p[0].distance_squared(p[1]).max(p[1].distance_squared(p[2])).max(p[2].distance_squared(p[0]));
        own.length() > 1e-6 * longest && own.dot(old) > UPRIGHT * own.length() * old.length()
    }

    /// Points of a triangle where its distance from the old ones is taken.
    pub fn samples(&self, corners: [u32; 3]) -> impl Iterator<Item = DVec3> {
        samples(corners.map(|v| self.position(v)), self.spacing)
    }

    pub fn replace(&mut self, t: u32, part: Option<Part>) {
        if let Some(old) = self.parts[t as usize].take() {
            self.altered.insert(old.face);
            self.touch(old.corners);
            for v in old.corners {
                if let Some(list) = self.around.get_mut(&v) {
                    list.retain(|&x| x != t);
                }
            }
        }
        if let Some(part) = part {
            for v in part.corners {
                self.around.entry(v).or_default().push(t);
            }
            self.parts[t as usize] = Some(part);
            self.fresh.push(t);
            self.touch(part.corners);
        }
    }

    fn add(&mut self, part: Part) {
        self.parts.push(None);
        self.replace(self.parts.len() as u32 - 1, Some(part));
    }

    /// Puts a vertex on the edge from `a` to `b`, at the share `t`. `None` where the strip ends.
    pub fn split(&mut self, a: u32, b: u32, t: f64) -> Option<u32> {
        let both = self.with_edge(a, b);
        let first = *self.part(*both.first()?)?;
        let cut = self.parted.cut.get(&(a.min(b), a.max(b))).copied();
        if both.len() != 2 {
            return None;
        }
        let position = self.position(a).lerp(self.position(b), t);
        let homes = self.homes(&[a, b]);
        let (_, home) = self.home_of(position, &homes).unwrap_or((first.face, first.home));
        let (_, weights) = closest(position, self.home(home));
        let m = (self.parted.n_old + self.parted.nodes.len()) as u32;
        self.parted.nodes.push(Node { position, source: home, weights });
        for t in both {
            let Some(part) = self.part(t).copied() else { continue };
            let with = |from: u32| part.corners.map(|v| if v == from { m } else { v });
            let halves = [with(b), with(a)];
            self.replace(t, Some(Part { corners: halves[0], ..part }));
            self.add(Part { corners: halves[1], ..part });
        }
        if let Some([x, y]) = cut {
            let (low, high) = (a.min(b), a.max(b));
            let place = if a < b { x + t * (y - x) } else { y + t * (x - y) };
            self.parted.cut.remove(&(low, high));
            self.parted.cut.insert((low, m), [x, place]);
            self.parted.cut.insert((high, m), [y, place]);
            for (v, old) in [(a, b), (b, a)] {
                if let Some(list) = self.line.get_mut(&v) {
                    list.iter_mut().filter(|x| **x == old).for_each(|x| *x = m);
                }
            }
            self.line.insert(m, vec![a, b]);
        }
        Some(m)
    }

    /// True if the line's edge stays shorter than `longest` when `u` moves into `v`.
    pub fn may_go(&self, u: u32, v: u32, longest: f64) -> bool {
        match *self.on_line(u) {
            [a, b] if a == v || b == v => self.position(a).distance(self.position(b)) < longest,
            _ => false,
        }
    }

    /// Moves `u` into its neighbour `v`, if the triangles around allow it; they must then have angles of `least`.
    pub fn collapse(&mut self, u: u32, v: u32, least: f64) -> bool {
        let line = self.on_line(u).to_vec();
        if !line.is_empty() && (line.len() != 2 || !self.is_cut(u, v)) {
            return false;
        }
        let other = line.iter().copied().find(|&w| w != v);
        if other.is_some_and(|w| self.neighbours(v).contains(&w)) || !self.merge(u, v, least) {
            return false;
        }
        if let Some(w) = other {
            let ([at_w, to_u], [from_u, to_v]) = (self.place(w, u), self.place(u, v));
            let at_v = to_u + (to_v - from_u);
            self.unlink(u, v);
            self.unlink(u, w);
            self.link(w, v, [at_w, at_v]);
        }
        true
    }

    /// Draws the line through `v`, which is beside it, instead of its neighbour `u` on it.
    pub fn draw_through(&mut self, u: u32, v: u32, least: f64) -> bool {
        let &[a, b] = self.on_line(u) else { return false };
        if !self.on_line(v).is_empty() {
            return false;
        }
        let ([at_a, to_u], [from_u, at_b]) = (self.place(a, u), self.place(u, b));
        let [p, q, r] = [a, u, b].map(|w| self.position(w));
        // How far along the line `v` is from `u`.
        let along = |to: DVec3| (self.position(v) - q).dot(to - q) / (to - q).length_squared();
        let (back, ahead) = (along(p), along(r));
        let by = if ahead > back { ahead * (at_b - from_u) } else { -back * (to_u - at_a) };
        // Beside `u`, and not beside the next one.
        if !((0.0..0.6).contains(&ahead.max(back)) && self.merge(u, v, least)) {
            return false;
        }
        self.unlink(u, a);
        self.unlink(u, b);
        self.link(a, v, [at_a, to_u + by]);
        self.link(v, b, [from_u + by, at_b]);
        true
    }

    /// Diameter of the box around the line that a vertex lies on.
    pub fn line_size(&self, v: u32) -> f64 {
        let mut low = self.position(v);
        let mut high = low;
        for &first in self.on_line(v) {
            let (mut last, mut at) = (v, first);
            while at != v {
                let p = self.position(at);
                (low, high) = (low.min(p), high.max(p));
                let Some(&next) = self.on_line(at).iter().find(|&&w| w != last) else { break };
                (last, at) = (at, next);
            }
            if at == v {
                break;
            }
        }
        low.distance(high)
    }

    /// Where an edge of the line begins and ends on the unrolled line.
    fn place(&self, from: u32, to: u32) -> [f64; 2] {
        let [x, y] = self.parted.cut.get(&(from.min(to), from.max(to))).copied().unwrap_or_default();
        if from < to { [x, y] } else { [y, x] }
    }

    fn unlink(&mut self, a: u32, b: u32) {
        self.parted.cut.remove(&(a.min(b), a.max(b)));
        for (v, old) in [(a, b), (b, a)] {
            if let Some(list) = self.line.get_mut(&v) {
                list.retain(|&w| w != old);
                if list.is_empty() {
                    self.line.remove(&v);
                }
            }
        }
    }

    fn link(&mut self, a: u32, b: u32, [x, y]: [f64; 2]) {
        self.parted.cut.insert((a.min(b), a.max(b)), if a < b { [x, y] } else { [y, x] });
        for (v, new) in [(a, b), (b, a)] {
            self.line.entry(v).or_default().push(new);
        }
    }

    /// The triangles of `u` given to its neighbour `v`, if they stay near the old ones and upright.
    fn merge(&mut self, u: u32, v: u32, least: f64) -> bool {
        let shared = self.with_edge(u, v);
        if self.is_border(u) || shared.len() != 2 {
            return false;
        }
        let (near_u, near_v) = (self.neighbours(u), self.neighbours(v));
        let common = near_u.iter().filter(|w| near_v.contains(w)).count();
        let joins = |w: &u32| *w != v && !near_v.contains(w) && self.is_border(*w) && self.is_border(v);
        if common != 2 || near_u.iter().any(joins) {
            return false;
        }
        let all = self.triangles_at(u).to_vec();
        let with_v = |corners: [u32; 3]| corners.map(|w| if w == u { v } else { w });
        let stay = || all.iter().filter(|t| !shared.contains(t)).filter_map(|&t| self.part(t));
        if least > 0.0 && stay().any(|part| self.min_angle(with_v(part.corners)) < least) {
            return false;
        }
        let p = self.position(u);
        let covers =
            |part: &Part| within(p, with_v(part.corners).map(|w| self.position(w)), self.tolerance).is_some();
        if !stay().any(covers) {
            return false;
        }
        let homes = self.homes(&near_u);
        let mut new = vec![];
        for &t in all.iter().filter(|t| !shared.contains(t)) {
            let Some(part) = self.part(t) else { return false };
            let Some(part) = self.rehomed(part, with_v(part.corners), &homes) else { return false };
            new.push((t, part));
        }
        for t in shared {
            self.replace(t, None);
        }
        for (t, part) in new {
            self.replace(t, Some(part));
        }
        self.around.remove(&u);
        true
    }
}
