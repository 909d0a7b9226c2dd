//! The old surface under a strip: which of its triangles is nearest, and how far.

use glam::DVec3;

use super::nearness::Facet;
use super::strip::Strip;
use crate::cut::divide::parted::Part;
use crate::cut::rim::nearness::Home;

impl Strip<'_> {
    /// The old triangle with these corners.
    pub fn facet(&self, home: [u32; 3]) -> Facet {
        Facet::new(self.home(home))
    }

    /// The old triangles around some vertices, each once.
    pub fn homes(&self, around: &[u32]) -> Vec<Home> {
        let parts = around.iter().flat_map(|&v| self.triangles_at(v)).filter_map(|&t| self.part(t));
        let mut homes = parts.map(|p| (p.face, p.home)).collect::<Vec<_>>();
        homes.sort_unstable();
        homes.dedup();
        let home = |(face, corners)| Home { face, corners, facet: self.facet(corners) };
        homes.into_iter().map(home).collect()
    }

    /// The old triangle nearest to a point, going from the nearest of these to its neighbours.
    pub fn home_of(&self, p: DVec3, homes: &[Home]) -> Option<Home> {
        let (mut off, mut found) = (f64::INFINITY, None);
        for home in homes {
            if let Some(d) = home.facet.within(p, off).filter(|&d| d < off || found.is_none()) {
                (off, found) = (d, Some(home));
            }
        }
        let nearest = found?;
        Some(self.walk(p, nearest.corners, off, 0.0).1.unwrap_or(*nearest))
    }

    /// Distance of a point from the old triangles around the nearest that is found by going from neighbour to
    /// neighbour: at least its distance from the old surface, and that itself once it is no more than `enough`.
    pub fn distance(&self, p: DVec3, home: [u32; 3], enough: f64) -> f64 {
        self.walk(p, home, self.facet(home).closest(p).0, enough).0
    }

    /// Goes from `home`, which is `off`, to nearer and nearer neighbours until the distance is no more than `enough` or
    /// the least around; that distance, and the old triangle if it is another one.
    fn walk(&self, p: DVec3, home: [u32; 3], off: f64, enough: f64) -> (f64, Option<Home>) {
        let (mut at, mut off, mut found) = (home, off, None);
        loop {
            let mut nearer = None;
            for old in at.iter().filter_map(|v| self.old.get(v)).flatten() {
                if off <= enough {
                    return (off, nearer.or(found));
                }
                if let Some(d) = old.facet.within(p, off).filter(|&d| d < off) {
                    (off, nearer) = (d, Some(*old));
                }
            }
            match nearer {
                Some(old) => (at, found) = (old.corners, nearer),
                None => return (off, found),
            }
        }
    }

    /// A part with these corners in place of its own, of the face that it lies on now; none if it would lie too far
    /// off the old surface, or upside down.
    pub fn rehomed(&self, part: &Part, corners: [u32; 3], homes: &[Home]) -> Option<Part> {
        let centre = corners.map(|v| self.position(v)).iter().sum::<DVec3>() / 3.0;
        let home = self.home_of(centre, homes)?;
        (self.is_upright(corners, home.corners) && self.is_near(corners, &home.facet, home.corners, homes))
            .then_some(Part { corners, face: home.face, home: home.corners, ..*part })
    }

    /// True if the triangle stays near the old ones, of which `own`, with the corners `home`, is the likeliest.
    pub fn is_near(&self, corners: [u32; 3], own: &Facet, home: [u32; 3], homes: &[Home]) -> bool {
        let tolerance = self.tolerance_at(homes);
        let near = |p: DVec3, old: &Facet| old.within(p, tolerance).is_some();
        // The distance from something convex is no greater between the corners than at them.
        if corners.iter().all(|&v| near(self.position(v), own)) {
            return true;
        }
        let mut last = own;
        self.samples(corners).all(|p| {
            if near(p, last) || near(p, own) {
                return true;
            }
            if let Some(old) = homes.iter().map(|h| &h.facet).find(|old| near(p, old)) {
                last = old;
                return true;
            }
            self.distance(p, home, tolerance) <= tolerance
        })
    }
}
