//! The edges of a polygon, to ask how deep inside a point lies.

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Line};

use crate::geometry::segments::{nearest_on_segment, orientation};

pub(in crate::fill) struct Walls<'a> {
    polygon: &'a [DVec2],
    tree: RTree<GeomWithData<Line<[f64; 2]>, usize>>,
}

impl<'a> Walls<'a> {
    /// Of a counter-clockwise polygon.
    pub fn new(polygon: &'a [DVec2]) -> Walls<'a> {
        let n = polygon.len();
        let line = |k: usize| Line::new(polygon[k].to_array(), polygon[(k + 1) % n].to_array());
        Walls { polygon, tree: RTree::bulk_load((0..n).map(|k| GeomWithData::new(line(k), k)).collect()) }
    }

    /// Distance to the nearest edge, negative outside. Logarithmic.
    pub fn depth(&self, x: DVec2) -> f64 {
        let Some(k) = self.tree.nearest_neighbor(x.to_array()).map(|line| line.data) else {
            return f64::NEG_INFINITY;
        };
        let n = self.polygon.len();
        let corner = |k: usize| self.polygon[k % n];
        let (a, b) = (corner(k), corner(k + 1));
        let (t, squared) = nearest_on_segment(x, a, b);
        let convex = |k: usize| orientation(corner(k + n - 1), corner(k), corner(k + 1)) > 0.0;
        // Next to a corner, a point lies inside if the corner is reflex.
        let inside = if t <= 0.0 {
            !convex(k)
        } else if t >= 1.0 {
            !convex(k + 1)
        } else {
            orientation(a, b, x) > 0.0
        };
        if inside { squared.sqrt() } else { -squared.sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_negative_outside_also_at_corners() {
        // An L, whose reflex corner is (1, 1).
        let l = [(0., 0.), (2., 0.), (2., 1.), (1., 1.), (1., 2.), (0., 2.)].map(DVec2::from);
        let walls = Walls::new(&l);
        let depth = |x: f64, y: f64| walls.depth(DVec2::new(x, y));
        assert_eq!(depth(0.5, 0.25), 0.25);
        assert!((depth(0.9, 0.9) - 0.1 * 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(depth(3.0, 2.0), -(2f64.sqrt()));
        assert_eq!(depth(1.5, 1.5), -0.5);
    }
}
