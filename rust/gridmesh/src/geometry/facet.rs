//! Distances from triangles in space.

use glam::DVec3;
use rstar::AABB;

/// A triangle that distances are taken from many times.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    corners: [DVec3; 3],
    normal: DVec3,
    /// Of the normal's length.
    squared: f64,
    /// Of the lengths of the edges, each from the corner of its number.
    edges: [f64; 3],
}

impl Facet {
    pub fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let edges = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        Facet { corners, normal, squared: normal.length_squared(), edges }
    }

    /// For each edge, on which side of it a point is, seen along the normal; all positive inside.
    fn sides(&self, p: DVec3) -> [f64; 3] {
        let [a, b, c] = self.corners;
        [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).cross(p - from).dot(self.normal))
    }

    /// Distance of a point, if that is at most `reach`.
    pub fn within(&self, p: DVec3, reach: f64) -> Option<f64> {
        // Neither the plane nor an edge's line that the point is beyond is farther than the triangle.
        let off = (p - self.corners[0]).dot(self.normal);
        let most = reach * reach * self.squared;
        if off * off > most {
            return None;
        }
        let sides = self.sides(p);
        if sides.iter().zip(self.edges).any(|(&side, edge)| side < 0.0 && side * side > most * edge) {
            return None;
        }
        Some(self.nearest(p, sides).0).filter(|&off| off <= reach)
    }

    /// Distance of a point, and the weights of the corners at the place nearest to it.
    pub fn closest(&self, p: DVec3) -> (f64, [f64; 3]) {
        self.nearest(p, self.sides(p))
    }

    /// The place nearest to a point.
    pub fn place(&self, p: DVec3) -> DVec3 {
        let (_, weights) = self.closest(p);
        (0..3).map(|k| weights[k] * self.corners[k]).sum()
    }

    /// Its normal, not of length one.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Its bounding box.
    pub fn bounds(&self) -> AABB<[f64; 3]> {
        let [a, b, c] = self.corners;
        AABB::from_corners(a.min(b).min(c).to_array(), a.max(b).max(c).to_array())
    }

    fn nearest(&self, p: DVec3, sides: [f64; 3]) -> (f64, [f64; 3]) {
        let is_flat = self.squared == 0.0;
        if !is_flat && sides.iter().all(|&side| side >= 0.0) {
            let off = (p - self.corners[0]).dot(self.normal).abs() / self.squared.sqrt();
            let [c, a, b] = sides.map(|side| side / self.squared);
            return (off, [a, b, c]);
        }
        let mut found = (f64::INFINITY, 0, 0.0);
        for (k, side) in sides.into_iter().enumerate() {
            // The nearest place is on an edge that the point is beyond.
            if side >= 0.0 && !is_flat {
                continue;
            }
            let (from, to) = (self.corners[k], self.corners[(k + 1) % 3]);
            let along = to - from;
            let t = ((p - from).dot(along) / self.edges[k].max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let off = (from + t * along).distance_squared(p);
            if off < found.0 {
                found = (off, k, t);
            }
        }
        let (squared, k, t) = found;
        let mut weights = [0.0; 3];
        (weights[k], weights[(k + 1) % 3]) = (1.0 - t, t);
        (squared.sqrt(), weights)
    }
}

/// Distance of a point from a triangle, if that is at most `reach`.
pub(crate) fn within(p: DVec3, triangle: [DVec3; 3], reach: f64) -> Option<f64> {
    Facet::new(triangle).within(p, reach)
}

/// Distance of a point from a triangle, and the weights of its corners there.
pub(crate) fn closest(p: DVec3, triangle: [DVec3; 3]) -> (f64, [f64; 3]) {
    Facet::new(triangle).closest(p)
}
