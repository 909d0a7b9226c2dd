//! Nearest points on triangles and on lines.

use glam::DVec3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

use crate::geometry::facet::Facet;

/// Triangles at most that are asked which way they face.
const LOOKED_AT: usize = 64;

/// Triangles to lay points on.
pub(crate) struct Facets(RTree<Face>);

struct Face(Facet);

/// Line segments to lay points on, each with a number.
pub(crate) struct Lines(RTree<Line>);

struct Line {
    ends: [DVec3; 2],
    number: u32,
}

impl Facets {
    pub fn new(corners: Vec<[DVec3; 3]>) -> Facets {
        Facets(RTree::bulk_load(corners.into_iter().map(|t| Face(Facet::new(t))).collect()))
    }

    /// The nearest point of those that face the same way as a normal, among the nearest ones, or else of all: the other side of
    /// something thin, or of a narrow gap, may be nearer.
    pub fn nearest(&self, p: DVec3, normal: DVec3) -> DVec3 {
        let alike = |face: &&Face| face.0.normal().dot(normal) >= 0.0;
        let mut near = self.0.nearest_neighbor_iter(p.to_array()).take(LOOKED_AT);
        let found = near.find(alike).or_else(|| self.0.nearest_neighbor(p.to_array()));
        found.map_or(p, |face| face.0.place(p))
    }

    /// The distance of the nearest one.
    pub fn distance(&self, p: DVec3) -> f64 {
        let found = self.0.nearest_neighbor(p.to_array());
        found.map_or(f64::INFINITY, |face| face.0.closest(p).0)
    }
}

impl Lines {
    pub fn new(ends: Vec<[DVec3; 2]>) -> Lines {
        Self::numbered(ends.into_iter().map(|ends| (ends, 0)).collect())
    }

    pub fn numbered(lines: Vec<([DVec3; 2], u32)>) -> Lines {
        Lines(RTree::bulk_load(lines.into_iter().map(|(ends, number)| Line { ends, number }).collect()))
    }

    /// The nearest point of them all.
    pub fn nearest(&self, p: DVec3) -> DVec3 {
        self.0.nearest_neighbor(p.to_array()).map_or(p, |line| line.closest(p))
    }

    /// The number of the nearest line, and its distance.
    pub fn find(&self, p: DVec3) -> Option<(u32, f64)> {
        self.0.nearest_neighbor(p.to_array()).map(|line| (line.number, line.closest(p).distance(p)))
    }
}

impl Line {
    fn closest(&self, p: DVec3) -> DVec3 {
        closest(self.ends, p)
    }
}

/// The point of a segment that is nearest to another.
fn closest([a, b]: [DVec3; 2], p: DVec3) -> DVec3 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    a + t * along
}

fn envelope(points: &[DVec3]) -> AABB<[f64; 3]> {
    let (low, high) =
        points.iter().fold((points[0], points[0]), |(low, high), p| (low.min(*p), high.max(*p)));
    AABB::from_corners(low.to_array(), high.to_array())
}

impl RTreeObject for Face {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.0.bounds()
    }
}

impl RTreeObject for Line {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        envelope(&self.ends)
    }
}

impl PointDistance for Face {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        self.0.closest(DVec3::from_array(*point)).0.powi(2)
    }
}

impl PointDistance for Line {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let p = DVec3::from_array(*point);
        self.closest(p).distance_squared(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_points_lie_inside_on_sides_and_in_corners() {
        let facets = Facets::new(vec![[DVec3::ZERO, DVec3::X, DVec3::Y], [DVec3::Z * 9.0; 3]]);
        let near = |x: f64, y: f64, z: f64| facets.nearest(DVec3::new(x, y, z), DVec3::Z);
        assert!(near(0.2, 0.3, 0.7).distance(DVec3::new(0.2, 0.3, 0.0)) < 1e-15);
        assert!(near(0.5, -1.0, 0.1).distance(DVec3::new(0.5, 0.0, 0.0)) < 1e-15);
        assert!(near(2.0, -1.0, 0.1).distance(DVec3::X) < 1e-15);
        assert!(near(0.0, 0.0, 8.0).distance(DVec3::Z * 9.0) < 1e-15);
        // The lower side of a thin plate, from a point nearer to the upper one.
        let [up, down] = [[DVec3::ZERO, DVec3::X, DVec3::Y], [DVec3::ZERO, DVec3::Y, DVec3::X]];
        let plate = Facets::new(vec![up, down.map(|p| p - 0.1 * DVec3::Z)]);
        let p = DVec3::new(0.2, 0.2, -0.01);
        assert!(plate.nearest(p, DVec3::Z).z.abs() < 1e-15);
        assert!((plate.nearest(p, -DVec3::Z).z + 0.1).abs() < 1e-15);
        let lines = Lines::numbered(vec![([DVec3::ZERO, DVec3::X], 3), ([DVec3::Y, DVec3::ONE], 5)]);
        assert_eq!(lines.find(DVec3::new(0.5, 0.2, 0.0)), Some((3, 0.2)));
        assert_eq!(lines.find(DVec3::new(0.0, 2.0, 0.0)), Some((5, 1.0)));
        assert_eq!(lines.nearest(DVec3::new(7.0, 0.0, 0.0)), DVec3::X);
    }
}
