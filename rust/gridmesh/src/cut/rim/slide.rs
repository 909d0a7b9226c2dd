//! Vertices of the line moved along it, for better angles beside it.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::strip::Strip;
use crate::cut::divide::node::Node;

/// The line as it was drawn, and where on it its vertices are.
#[derive(Default)]
pub(in crate::cut) struct Course {
    curves: Vec<Curve>,
    /// Curve, and length along it.
    at: FxHashMap<u32, (u32, f64)>,
}

/// A stretch of the line as it was drawn.
pub(in crate::cut) struct Curve {
    pub arc: Vec<f64>,
    pub points: Vec<DVec3>,
    /// Places on the unrolled line.
    pub places: Vec<f64>,
}

impl Curve {
    fn at(&self, s: f64) -> (DVec3, f64) {
        let k = self.arc.partition_point(|&a| a <= s).clamp(1, self.arc.len() - 1);
        let t = (s - self.arc[k - 1]) / (self.arc[k] - self.arc[k - 1]).max(f64::MIN_POSITIVE);
        let t = t.clamp(0.0, 1.0);
        let place = self.places[k - 1] + t * (self.places[k] - self.places[k - 1]);
        (self.points[k - 1].lerp(self.points[k], t), place)
    }
}

impl Course {
    /// Adds a curve, and returns its number.
    pub fn add(&mut self, curve: Curve) -> u32 {
        self.curves.push(curve);
        self.curves.len() as u32 - 1
    }

    pub fn put(&mut self, v: u32, curve: u32, s: f64) {
        self.at.insert(v, (curve, s));
    }

    /// Moves a new vertex of the line along the drawn line, between its neighbours, if that makes the smallest angle there
    /// larger. The line's edges keep lengths of at least `shortest` and at most `longest` if they have them.
    pub fn slide(&mut self, strip: &mut Strip<'_>, v: u32, shortest: f64, longest: f64) -> bool {
        let Some(k) = (v as usize).checked_sub(strip.parted.n_old) else { return false };
        let (&[a, b], Some(&(c, s))) = (strip.on_line(v), self.at.get(&v)) else { return false };
        if strip.is_border(v) {
            return false;
        }
        let curve = &self.curves[c as usize];
        let around = strip.triangles_at(v).to_vec();
        let parts = around.iter().filter_map(|&t| strip.part(t).copied()).collect::<Vec<_>>();
        let least = |strip: &Strip<'_>| {
            parts.iter().map(|p| strip.min_angle(p.corners)).fold(f64::INFINITY, f64::min)
        };
        let (old, before) = (strip.parted.nodes[k], least(strip));
        let (p, q) = (strip.position(a), strip.position(b));
        let lengths = |at: DVec3| [at.distance(p), at.distance(q)];
        let own = lengths(old.position);
        let low = shortest.min(own[0]).min(own[1]);
        let high = longest.max(own[0]).max(own[1]);
        let room = own[0].min(own[1]);
        // Best angles first.
        let mut ways = vec![];
        for share in [-0.6, -0.4, -0.25, -0.12, -0.05, 0.05, 0.12, 0.25, 0.4, 0.6] {
            let to = s + share * room;
            let (at, _) = curve.at(to);
            if to <= 0.0
                || to >= curve.arc[curve.arc.len() - 1]
                || lengths(at).iter().any(|&l| l < low || l > high)
            {
                continue;
            }
            strip.parted.nodes[k].position = at;
            let after = least(strip);
            if after > before * 1.05 {
                ways.push((after, to));
            }
        }
        strip.parted.nodes[k] = old;
        ways.sort_by(|x, y| y.0.total_cmp(&x.0));
        let homes = strip.homes(&strip.neighbours(v));
        for (_, to) in ways {
            let (at, place) = curve.at(to);
            let Some(home) = strip.home_of(at, &homes) else { continue };
            let (_, weights) = home.facet.closest(at);
            strip.parted.nodes[k] = Node { position: at, source: home.corners, weights };
            let moved = parts.iter().map(|part| strip.rehomed(part, part.corners, &homes));
            let Some(moved) = moved.collect::<Option<Vec<_>>>() else {
                strip.parted.nodes[k] = old;
                continue;
            };
            let by = place - curve.at(s).1;
            for w in [a, b] {
                if let Some([x, y]) = strip.parted.cut.get_mut(&(v.min(w), v.max(w))) {
                    *(if v < w { x } else { y }) += by;
                }
            }
            self.at.insert(v, (c, to));
            for (&t, part) in around.iter().zip(moved) {
                strip.replace(t, Some(part));
            }
            return true;
        }
        false
    }
}
