//! The faces along the cut as a mesh that can be edited: split, collapse, flip.
//!
//! Edges of the cut stay edges of the cut. Every triangle remembers the old triangle that it lies on; no edit is
//! made that leaves the old triangles around by more than the tolerance, or turns a triangle away from its own.

use std::collections::BTreeSet;

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::nearness::{Facet, closest, samples, within};
use super::thin;
use crate::cut::divide::node::Node;
use crate::cut::divide::parted::{Part, Parted};
use crate::cut::rim::nearness::Home;

pub(in crate::cut) struct Strip<'a> {
    pub vertices: &'a [DVec3],
    pub parted: &'a mut Parted,
    /// Triangles; those that are gone are `None`.
    pub parts: Vec<Option<Part>>,
    /// Triangles at each vertex.
    around: FxHashMap<u32, Vec<u32>>,
    /// Vertices on the border of the strip: they stay, and so do the edges between them.
    border: FxHashSet<u32>,
    /// Faces whose triangles were changed, and those on which changed ones came to lie.
    pub altered: FxHashSet<u32>,
    /// Triangles changed since somebody took the list.
    pub fresh: Vec<u32>,
    /// How far a triangle may be off the old ones, where the model is not thin.
    pub tolerance: f64,
    /// The same for old triangles where the model is thin.
    pub thin: FxHashMap<[u32; 3], f64>,
    /// How far apart that is looked at.
    spacing: f64,
    /// The cut's edges, by vertex.
    pub line: FxHashMap<u32, Vec<u32>>,
    /// The old triangles at each old vertex.
    pub old: FxHashMap<u32, Vec<Home>>,
    /// Counts changes; and for each vertex, the last one of its triangles.
    clock: u32,
    changed: FxHashMap<u32, u32>,
    /// For each vertex, when each edit was last tried in vain.
    tried: [FxHashMap<u32, u32>; 4],
}

/// An edit that is tried again and again.
#[derive(Clone, Copy, Debug)]
pub(in crate::cut) enum Trial {
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

/// Vertices with more triangles stay: to look at all of them again and again would take long.
const HUB: usize = 96;

/// Triangles have at least this part of the square over their longest edge as their area, twice.
const SLIVER: f64 = 1e-9;

/// Least cosine between a triangle's normal and that of the old triangle below it (60 degrees).
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
        let mut old: FxHashMap<u32, Vec<Home>> = FxHashMap::default();
        let mut homes = parts.iter().map(|p| (p.face, p.home)).collect::<Vec<_>>();
        homes.sort_unstable();
        homes.dedup();
        let thin = thin::tolerances(vertices, &homes, TOLERANCE * length);
        for (face, corners) in homes {
            let facet = Facet::new(corners.map(|v| vertices[v as usize]));
            corners.iter().for_each(|&v| old.entry(v).or_default().push(Home { face, corners, facet }));
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
            thin,
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
        let [a, b, c] = corners.map(|v| self.position(v));
        // It lies opposite the shortest edge.
        let [x, y, z] = [b.distance_squared(c), c.distance_squared(a), a.distance_squared(b)];
        let (p, q) = match x.min(y).min(z) {
            least if least == x => (b - a, c - a),
            least if least == y => (c - b, a - b),
            _ => (a - c, b - c),
        };
        libm::atan2(p.cross(q).length(), p.dot(q))
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

    /// The triangles at an edge, looked for where there are fewer.
    pub fn with_edge(&self, a: u32, b: u32) -> Vec<u32> {
        let (few, other) =
            if self.triangles_at(a).len() <= self.triangles_at(b).len() { (a, b) } else { (b, a) };
        let has = |t: &&u32| self.part(**t).is_some_and(|p| p.corners.contains(&other));
        self.triangles_at(few).iter().filter(has).copied().collect()
    }

    /// The triangles changed since there were so many `fresh` ones, and those beside them.
    pub fn changed_since(&self, from: usize) -> BTreeSet<u32> {
        let mut found = BTreeSet::new();
        for part in self.fresh[from..].iter().filter_map(|&t| self.part(t)) {
            let [a, b, c] = part.corners;
            found.extend([(a, b), (b, c), (c, a)].into_iter().flat_map(|(a, b)| self.with_edge(a, b)));
        }
        found
    }

    pub fn has_edge(&self, a: u32, b: u32) -> bool {
        let (few, other) =
            if self.triangles_at(a).len() <= self.triangles_at(b).len() { (a, b) } else { (b, a) };
        let mut own = self.triangles_at(few).iter().filter_map(|&t| self.part(t));
        own.any(|p| p.corners.contains(&other))
    }

    /// How far triangles may be off these old ones.
    pub fn tolerance_at(&self, homes: &[Home]) -> f64 {
        if self.thin.is_empty() {
            return self.tolerance;
        }
        let own = homes.iter().filter_map(|h| self.thin.get(&h.corners).copied());
        own.fold(self.tolerance, f64::min)
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
        own.length() > SLIVER * longest && own.dot(old) > UPRIGHT * own.length() * old.length()
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
            self.altered.insert(part.face);
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
        let home = self.home_of(position, &homes).map_or(first.home, |home| home.corners);
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
            let [x, y] = if a < b { [x, y] } else { [y, x] };
            let place = x + t * (y - x);
            self.unlink(a, b);
            self.link(a, m, [x, place]);
            self.link(m, b, [place, y]);
        }
        Some(m)
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

    /// The triangles of `u` given to its neighbour `v`, if they stay near the old ones and upright.
    pub fn merge(&mut self, u: u32, v: u32, least: f64) -> bool {
        if self.is_border(u) || self.triangles_at(u).len() > HUB {
            return false;
        }
        let shared = self.with_edge(u, v);
        if shared.len() != 2 {
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
        let covers = |part: &Part, reach: f64| {
            within(p, with_v(part.corners).map(|w| self.position(w)), reach).is_some()
        };
        if !stay().any(|part| covers(part, self.tolerance)) {
            return false;
        }
        let homes = self.homes(&near_u);
        let reach = self.tolerance_at(&homes);
        if reach < self.tolerance && !stay().any(|part| covers(part, reach)) {
            return false;
        }
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
