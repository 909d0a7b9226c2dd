//! Whether a mesh meets itself: counted in space, or disproved in projection.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec2Swizzles};
use robust::{Coord, Coord3D, orient2d, orient3d};
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};

type Boxed<const N: usize> = GeomWithData<Rectangle<[f64; N]>, u32>;

/// Number of pairs of triangles that meet elsewhere than in a shared vertex or along a shared edge,
/// touching included.
///
/// Exact (adaptive predicates) for the given coordinates, apart from triangles without area, whose
/// pairs may be counted or not. Near-linear in the number of triangles for evenly meshed bodies.
pub fn count_self_intersections(vertices: &[DVec3], triangles: &[[u32; 3]]) -> usize {
    let corners = |t: [u32; 3]| t.map(|v| vertices[v as usize]);
    let boxes = triangles.iter().enumerate().map(|(index, &t)| {
        let [a, b, c] = corners(t);
        let rectangle = Rectangle::from_corners(a.min(b).min(c).into(), a.max(b).max(c).into());
        Boxed::<3>::new(rectangle, index as u32)
    });
    let tree = RTree::bulk_load(boxes.collect());
    tree.intersection_candidates_with_other_tree(&tree)
        .filter(|(a, b)| a.data < b.data)
        .filter(|(a, b)| triangles_meet(vertices, triangles[a.data as usize], triangles[b.data as usize]))
        .count()
}

/// Whether two triangles meet outside the vertices and edges that they share.
pub(crate) fn triangles_meet(vertices: &[DVec3], t: [u32; 3], u: [u32; 3]) -> bool {
    let shared = t.iter().filter(|v| u.contains(v)).count();
    let at = |v: u32| vertices[v as usize];
    let (p, q) = (t.map(at), u.map(at));
    // Turned so that the shared corners come first.
    let own = |a: [u32; 3], b: [u32; 3]| a.iter().position(|v| !b.contains(v)).unwrap_or(0);
    let common = |a: [u32; 3], b: [u32; 3]| a.iter().position(|v| b.contains(v)).unwrap_or(0);
    match shared {
        0 => (0..3).any(|k| segment_meets(p[k], p[(k + 1) % 3], q) || segment_meets(q[k], q[(k + 1) % 3], p)),
        1 => {
            let (i, j) = (common(t, u), common(u, t));
            segment_meets(p[(i + 1) % 3], p[(i + 2) % 3], q)
                || segment_meets(q[(j + 1) % 3], q[(j + 2) % 3], p)
        }
        2 => {
            let (i, j) = (own(t, u), own(u, t));
            let (a, b) = (p[(i + 1) % 3], p[(i + 2) % 3]);
            if side3(a, b, p[i], q[j]) != 0.0 {
                return false;
            }
            let drop = flattened(p);
            side2(drop(a), drop(b), drop(p[i])) * side2(drop(a), drop(b), drop(q[j])) > 0.0
        }
        _ => true,
    }
}

/// Whether an edge of one of two triangles goes through the inside of the other, from one side to the other.
pub(crate) fn triangles_cross(vertices: &[DVec3], t: [u32; 3], u: [u32; 3]) -> bool {
    let at = |v: u32| vertices[v as usize];
    let (p, q) = (t.map(at), u.map(at));
    let through = |a: DVec3, b: DVec3, [c, d, e]: [DVec3; 3]| {
        side3(c, d, e, a) * side3(c, d, e, b) < 0.0 && {
            let sides = [side3(a, b, c, d), side3(a, b, d, e), side3(a, b, e, c)];
            sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)
        }
    };
    (0..3).any(|k| through(p[k], p[(k + 1) % 3], q) || through(q[k], q[(k + 1) % 3], p))
}

fn side3(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    sign(orient3d(a, b, c, d))
}

fn side2(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p.x, y: p.y });
    sign(orient2d(a, b, c))
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Drops the coordinate along which a triangle extends least.
fn flattened([a, b, c]: [DVec3; 3]) -> impl Fn(DVec3) -> DVec2 {
    let normal = (b - a).cross(c - a).abs();
    let axis =
        if normal.z >= normal.x && normal.z >= normal.y { 2 } else { usize::from(normal.y > normal.x) };
    move |p| match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

/// Whether a segment meets a triangle, borders included.
fn segment_meets(p: DVec3, q: DVec3, triangle: [DVec3; 3]) -> bool {
    let [a, b, c] = triangle;
    let (s, t) = (side3(a, b, c, p), side3(a, b, c, q));
    if s * t > 0.0 {
        return false;
    }
    if s == 0.0 && t == 0.0 {
        let drop = flattened(triangle);
        let (p, q) = (drop(p), drop(q));
        let [a, b, c] = triangle.map(&drop);
        let inside = |x: DVec2| {
            let sides = [side2(a, b, x), side2(b, c, x), side2(c, a, x)];
            sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
        };
        return inside(p)
            || inside(q)
            || [(a, b), (b, c), (c, a)].into_iter().any(|(a, b)| segments_meet(p, q, a, b));
    }
    let sides = [side3(p, q, a, b), side3(p, q, b, c), side3(p, q, c, a)];
    sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
}

/// Whether two segments of the plane meet, ends included.
fn segments_meet(p: DVec2, q: DVec2, a: DVec2, b: DVec2) -> bool {
    let (s, t) = (side2(p, q, a), side2(p, q, b));
    let (u, v) = (side2(a, b, p), side2(a, b, q));
    if s == 0.0 && t == 0.0 && u == 0.0 && v == 0.0 {
        return p.min(q).cmple(a.max(b)).all() && a.min(b).cmple(p.max(q)).all();
    }
    s * t <= 0.0 && u * v <= 0.0
}

/// Proves that triangles in the plane overlap nowhere: each is positive (exact predicate) and the
/// boundary `loops` are simple and apart, the first counter-clockwise, the others clockwise.
///
/// The number of triangles over a point is then its winding number, which is 0 or 1. A surface that
/// is a graph over such triangles cannot meet itself.
pub(crate) fn is_planar_embedding(positions: &[DVec2], triangles: &[[u32; 3]], loops: &[Range<u32>]) -> bool {
    let at = |v: u32| positions[v as usize];
    triangles.iter().all(|t| side2(at(t[0]), at(t[1]), at(t[2])) > 0.0)
        && crossing_edges(positions, loops).is_empty()
        && turned_over(positions, loops).next().is_none()
}

/// Which of closed `loops` that are simple are turned over: the first is the outline, the others are holes.
pub(crate) fn turned_over(positions: &[DVec2], loops: &[Range<u32>]) -> impl Iterator<Item = usize> {
    (0..loops.len())
        .filter(move |&k| is_turned_over(&positions[loops[k].start as usize..loops[k].end as usize], k > 0))
}

/// True if a simple polygon does not run counter-clockwise; as a hole, clockwise (exact).
///
/// A hole may do so without its edges meeting: three vertices on a bulge into it enclose nothing of it.
pub(crate) fn is_turned_over(points: &[DVec2], is_hole: bool) -> bool {
    let n = points.len();
    let lowest = (0..n).min_by(|&i, &j| {
        let (a, b) = (points[i], points[j]);
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    });
    lowest.is_none_or(|i| {
        let turn = side2(points[(i + n - 1) % n], points[i], points[(i + 1) % n]);
        if is_hole { turn >= 0.0 } else { turn <= 0.0 }
    })
}

/// The edges of closed `loops` that meet another one elsewhere than in a shared end (exact), in order,
/// each by its first vertex.
pub(crate) fn crossing_edges(positions: &[DVec2], loops: &[Range<u32>]) -> Vec<u32> {
    let at = |v: u32| positions[v as usize];
    let mut edges = vec![];
    for contour in loops {
        let n = contour.len() as u32;
        edges.extend((0..n).map(|k| [contour.start + k, contour.start + (k + 1) % n]));
    }
    let meet = |[i, j]: [u32; 2], [k, l]: [u32; 2]| {
        let (a, b, c, d) = (at(i), at(j), at(k), at(l));
        if j == k || i == l {
            // Neighbours along a loop: they must not fold onto each other.
            let (tip, p, q) = if j == k { (b, a, d) } else { (a, b, c) };
            return side2(p, tip, q) == 0.0 && (p - tip).dot(q - tip) >= 0.0;
        }
        segments_meet(a, b, c, d)
    };
    // A sweep along the longer side of the drawing: few edges stand over one place.
    let (low, high) = positions
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let is_wide = high.x - low.x >= high.y - low.y;
    let turned = |p: DVec2| if is_wide { p } else { p.yx() };
    let mut spans: Vec<(DVec2, DVec2, u32)> = (0u32..)
        .zip(&edges)
        .map(|(index, edge)| {
            let [a, b] = edge.map(|v| turned(at(v)));
            (a.min(b), a.max(b), index)
        })
        .collect();
    spans.sort_by(|p, q| p.0.x.total_cmp(&q.0.x).then(p.2.cmp(&q.2)));
    let mut found = vec![];
    for (k, &(low, high, i)) in spans.iter().enumerate() {
        for &(other_low, other_high, j) in spans[k + 1..].iter().take_while(|other| other.0.x <= high.x) {
            if other_low.y <= high.y && low.y <= other_high.y {
                let (one, other) = (edges[i as usize], edges[j as usize]);
                if meet(one, other) {
                    found.extend([one[0], other[0]]);
                }
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> usize {
        let points = points.iter().map(|&p| DVec3::from(p)).collect::<Vec<_>>();
        count_self_intersections(&points, triangles)
    }

    #[test]
    fn pairs_in_space_are_told_apart() {
        let base = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let with = |other: [[f64; 3]; 3]| {
            let points = [base, other].concat();
            count(&points, &[[0, 1, 2], [3, 4, 5]])
        };
        assert_eq!(with([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 0.5]]), 1, "pierced");
        assert_eq!(with([[3.0, 3.0, -1.0], [3.0, 3.0, 1.0], [9.0, 9.0, 0.5]]), 0, "passes by");
        assert_eq!(with([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 2.0, 1.0]]), 1, "touched");
        assert_eq!(with([[1.0, 1.0, 1e-300], [1.0, 1.0, 1.0], [1.0, 2.0, 1.0]]), 0, "barely apart");
        assert_eq!(with([[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]]), 1, "lies within");
        assert_eq!(with([[5.0, 1.0, 0.0], [6.0, 1.0, 0.0], [5.0, 2.0, 0.0]]), 0, "beside in the plane");
    }

    #[test]
    fn neighbours_meet_only_when_folded() {
        let points = [
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [0.0, 4.0, 0.0],
            [4.0, 4.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 1.0, 3.0],
        ];
        assert_eq!(count(&points, &[[0, 1, 2], [2, 1, 3]]), 0, "edge shared, flat");
        assert_eq!(count(&points, &[[0, 1, 2], [2, 1, 4]]), 1, "edge shared, folded onto it");
        assert_eq!(count(&points, &[[0, 1, 2], [2, 1, 5]]), 0, "edge shared, raised");
        assert_eq!(count(&points, &[[0, 1, 2], [0, 4, 5]]), 1, "vertex shared, crosses");
        assert_eq!(count(&points, &[[0, 1, 2], [0, 2, 1]]), 1, "the same corners");
    }

    #[test]
    fn a_figure_eight_is_no_embedding() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let triangles = [[0, 1, 2], [0, 2, 3]];
        assert!(is_planar_embedding(&square, &triangles, std::slice::from_ref(&(0..4))));
        let mut turned = square;
        turned.swap(1, 2);
        assert!(!is_planar_embedding(&turned, &triangles, std::slice::from_ref(&(0..4))));
    }

    #[test]
    fn a_hole_that_is_turned_over_is_no_embedding() {
        let at = |k: u32, radius: f64| DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 3.0) * radius;
        let ring: Vec<DVec2> = (0..3).map(|k| at(k, 4.0)).chain((0..3).map(|k| at(3 - k, 1.0))).collect();
        let loops = [0..3, 3..6];
        assert_eq!(turned_over(&ring, &loops).count(), 0);
        let mut turned = ring.clone();
        turned.swap(4, 5);
        assert_eq!(turned_over(&turned, &loops).collect::<Vec<_>>(), [1]);
        assert!(crossing_edges(&turned, &loops).is_empty());
        assert!(!is_planar_embedding(&turned, &[], &loops));
        let mut clockwise = ring;
        clockwise.swap(0, 1);
        assert_eq!(turned_over(&clockwise, &loops).collect::<Vec<_>>(), [0]);
    }

    /// A fan that winds twice around its centre: every triangle positive, yet overlapping.
    #[test]
    fn a_double_winding_is_no_embedding() {
        let mut points = vec![];
        for k in 0..10u32 {
            let angle = f64::from(k) * 2.0 * std::f64::consts::TAU / 10.0;
            points.push(DVec2::from_angle(angle) * (1.0 + 0.05 * f64::from(k)));
        }
        points.push(DVec2::ZERO);
        let triangles = (0..10).map(|k| [10, k, (k + 1) % 10]).collect::<Vec<_>>();
        assert!(!is_planar_embedding(&points, &triangles, std::slice::from_ref(&(0..10))));
    }
}
