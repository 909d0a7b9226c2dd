//! The old surface under a strip: which of its triangles is nearest, and how far.

use glam::DVec3;

use super::nearness::{closest, within};
use super::parted::Part;
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
        let nearest = found?;
        Some(self.walk(p, nearest.1, 0.0).1.unwrap_or(nearest))
    }

    /// Distance of a point from the old triangles around the nearest that is found by going from neighbour to
    /// neighbour: at least its distance from the old surface, and that itself once it is no more than `enough`.
    pub fn distance(&self, p: DVec3, home: [u32; 3], enough: f64) -> f64 {
        self.walk(p, home, enough).0
    }

    /// Goes to nearer and nearer neighbours until the distance is no more than `enough` or the least around; that
    /// distance, and the old triangle if it is another one.
    fn walk(&self, p: DVec3, home: [u32; 3], enough: f64) -> (f64, Option<(u32, [u32; 3])>) {
        let (mut at, mut off, mut found) = (home, closest(p, self.home(home)).0, None);
        loop {
            let before = found;
            for &old in at.iter().filter_map(|v| self.old.get(v)).flatten() {
                if off <= enough {
                    return (off, found);
                }
                if let Some(d) = within(p, self.home(old.1), off).filter(|&d| d < off) {
                    (off, found) = (d, Some(old));
                }
            }
            match found {
                Some((_, nearer)) if found != before => at = nearer,
                _ => return (off, found),
            }
        }
    }

    /// A part with these corners in place of its own, of the face that it lies on now; none if it would lie too far
    /// off the old surface, or upside down.
    pub fn rehomed(&self, part: &Part, corners: [u32; 3], homes: &[(u32, [u32; 3])]) -> Option<Part> {
        let centre = corners.map(|v| self.position(v)).iter().sum::<DVec3>() / 3.0;
        let (face, home) = self.home_of(centre, homes)?;
        (self.is_upright(corners, home) && self.is_near(corners, home, homes)).then_some(Part {
            corners,
            face,
            home,
            ..*part
        })
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
