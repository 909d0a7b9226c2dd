//! The old surface under a strip: which of its triangles is nearest, and how far.

use glam::DVec3;

use super::nearness::{closest, within};
use super::strip::Strip;

impl Strip<'_> {
    /// The old triangles around some vertices, each once.
    pub fn homes(&self, around: &[u32]) -> Vec<(u32, [u32; 3])> {
        let parts = around.iter().flat_map(|&v| self.triangles_at(v)).filter_map(|&t| self.part(t));
        let mut homes = parts.map(|p| (p.face, p.home)).collect::<Vec<_>>();
        homes.sort_unstable();
        homes.dedup();
        homes
    }

    /// The old triangle nearest to a point, going from the nearest of these to its neighbours.
    pub fn home_of(&self, p: DVec3, homes: &[(u32, [u32; 3])]) -> Option<(u32, [u32; 3])> {
        let (mut off, mut found) = (f64::INFINITY, None);
        for &home in homes {
            if let Some(d) = within(p, self.home(home.1), off).filter(|&d| d < off || found.is_none()) {
                (off, found) = (d, Some(home));
            }
        }
        let mut at = found?;
        loop {
            let before = at;
            for &old in before.1.iter().filter_map(|v| self.old.get(v)).flatten() {
                if let Some(d) = within(p, self.home(old.1), off).filter(|&d| d < off) {
                    (off, at) = (d, old);
                }
            }
            if at == before {
                return Some(at);
            }
        }
    }

    /// Distance of a point from the old triangles around the nearest that is found by going from neighbour to
    /// neighbour: at least its distance from the old surface, and that itself once it is no more than `enough`.
    pub fn distance(&self, p: DVec3, home: [u32; 3], enough: f64) -> f64 {
        let (mut at, mut off) = (home, closest(p, self.home(home)).0);
        loop {
            let mut nearer = None;
            for &(_, old) in at.iter().filter_map(|v| self.old.get(v)).flatten() {
                if off <= enough {
                    return off;
                }
                if let Some(d) = within(p, self.home(old), off).filter(|&d| d < off) {
                    (off, nearer) = (d, Some(old));
                }
            }
            match nearer {
                Some(old) => at = old,
                None => return off,
            }
        }
    }

    /// True if the triangle stays near the old ones, of which `home` is the likeliest.
    pub fn is_near(&self, corners: [u32; 3], home: [u32; 3], homes: &[(u32, [u32; 3])]) -> bool {
        let near = |p: DVec3, old: [DVec3; 3]| within(p, old, self.tolerance).is_some();
        // The distance from something convex is no greater between the corners than at them.
        let own = self.home(home);
        if corners.iter().all(|&v| near(self.position(v), own)) {
            return true;
        }
        let mut last = own;
        self.samples(corners).all(|p| {
            if near(p, last) || near(p, own) {
                return true;
            }
            if let Some(old) = homes.iter().map(|h| self.home(h.1)).find(|&old| near(p, old)) {
                last = old;
                return true;
            }
            self.distance(p, home, self.tolerance) <= self.tolerance
        })
    }
}
