//! Lays a loop of space out in the plane.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::span::Span;
use crate::geometry::segments::{SegmentGrid, segments_meet};

/// A projection is taken if it leaves each edge at least this share of its length.
const FORESHORTENED: f64 = 0.8;

/// How a loop was laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unrolling {
    /// Projected to the plane of its mean normal.
    #[default]
    Projected,
    /// With the triangulation of least area that spans it, developed triangle by triangle: exact on a
    /// developable surface.
    Developed,
    /// As developed, with the turning evened out until the loop did not meet itself any more.
    Evened,
    /// On a circle; of the loop only the lengths of its edges are left.
    Circle,
}

impl Unrolling {
    /// A stable word, for programs.
    pub fn word(self) -> &'static str {
        match self {
            Unrolling::Projected => "projected",
            Unrolling::Developed => "developed",
            Unrolling::Evened => "evened",
            Unrolling::Circle => "circle",
        }
    }
}

/// A loop in the plane.
#[derive(Clone, Debug)]
pub(crate) struct Unrolled {
    /// One point for each vertex: a simple polygon, counter-clockwise.
    pub points: Vec<DVec2>,
    pub method: Unrolling,
    /// Largest relative change of an edge's length.
    pub distortion: f64,
}

/// Lays a loop out as a simple polygon, counter-clockwise.
///
/// Nearly planar loops are projected. Others are spanned by the triangulation of least area over (up
/// to 120 of) their vertices; it has no inner vertex, so it unfolds into the plane without distortion.
/// Should that meet itself, the turning at the vertices is blended with that of a circle. Nothing is
/// left to chance: the inscribed polygon with the loop's edge lengths is simple.
pub(crate) fn unroll(positions: &[DVec3]) -> Unrolled {
    let flat = projected(positions);
    let kept = |points: &[DVec2]| {
        let n = points.len();
        (0..n).all(|k| {
            points[k].distance(points[(k + 1) % n])
                >= FORESHORTENED * positions[k].distance(positions[(k + 1) % n])
        })
    };
    if kept(&flat) && is_simple(&flat) {
        return finish(positions, flat, Unrolling::Projected);
    }
    let developed = developed(positions, &Span::least_area(positions));
    let (points, method) =
        made_simple(positions, developed).unwrap_or_else(|| (inscribed(positions), Unrolling::Circle));
    finish(positions, points, method)
}

/// As [`unroll`] does with loops that are not planar, but on the triangulation that bends least, `outside`
/// included: the normals of the triangles beyond the edges. `None` if that meets itself however its
/// turning is evened out.
pub(crate) fn unroll_least_bent(positions: &[DVec3], outside: &[Option<DVec3>]) -> Option<Unrolled> {
    let developed = developed(positions, &Span::least_bent(positions, outside));
    made_simple(positions, developed).map(|(points, method)| finish(positions, points, method))
}

/// A developed loop, its turning evened out as far as needed.
fn made_simple(positions: &[DVec3], developed: Vec<DVec2>) -> Option<(Vec<DVec2>, Unrolling)> {
    if is_simple(&developed) {
        return Some((developed, Unrolling::Developed));
    }
    let mut evened = [0.25, 0.5, 0.75].into_iter().map(|share| evened(positions, &developed, share));
    evened.find(|points| is_simple(points)).map(|points| (points, Unrolling::Evened))
}

fn finish(positions: &[DVec3], points: Vec<DVec2>, method: Unrolling) -> Unrolled {
    let n = points.len();
    let change = |k: usize| {
        let (flat, true_length) =
            (points[k].distance(points[(k + 1) % n]), positions[k].distance(positions[(k + 1) % n]));
        (flat / true_length - 1.0).abs()
    };
    let distortion = (0..n).map(change).fold(0.0, f64::max);
    Unrolled { points, method, distortion }
}

/// Twice the area vector of a loop.
pub(crate) fn area_vector(positions: &[DVec3]) -> DVec3 {
    let n = positions.len();
    let origin = positions[0];
    (1..n).map(|k| (positions[k] - origin).cross(positions[(k + 1) % n] - origin)).sum()
}

fn projected(positions: &[DVec3]) -> Vec<DVec2> {
    let normal = area_vector(positions).normalize_or(DVec3::Z);
    let (e, f) = normal.any_orthonormal_pair();
    let origin = positions[0];
    positions.iter().map(|&p| DVec2::new((p - origin).dot(e), (p - origin).dot(f))).collect()
}

/// True if no two edges meet but neighbours in their common vertex, and the polygon is
/// counter-clockwise.
pub(crate) fn is_simple(points: &[DVec2]) -> bool {
    let n = points.len();
    let area: f64 = (0..n).map(|k| (points[k] - points[0]).perp_dot(points[(k + 1) % n] - points[0])).sum();
    if area.is_nan() || area <= 0.0 {
        return false;
    }
    let edges = (0..n).map(|k| [points[k], points[(k + 1) % n]]).collect::<Vec<_>>();
    let clash = |i: usize, j: usize| {
        if (i + 1) % n == j || (j + 1) % n == i {
            // Neighbours meet in one vertex; more only if they fold back.
            let [a, b, c] = if (i + 1) % n == j {
                [edges[i][0], edges[i][1], edges[j][1]]
            } else {
                [edges[j][0], edges[j][1], edges[i][1]]
            };
            return a == b || b == c || ((b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) < 0.0);
        }
        segments_meet(edges[i], edges[j])
    };
    if n <= 32 {
        return (0..n).all(|i| (i + 1..n).all(|j| !clash(i, j)));
    }
    let mut simple = true;
    SegmentGrid::new(&edges).pairs(|i, j| {
        simple &= !clash(i, j);
        simple
    });
    simple
}

/// Unfolds a triangulation; vertices that it leaves out are laid beside its border as they lie beside it in
/// the plane of the triangle there.
fn developed(positions: &[DVec3], span: &Span) -> Vec<DVec2> {
    let n = positions.len();
    let Span { chosen, apex } = span;
    let m = chosen.len();
    let corners = chosen.iter().map(|&k| positions[k]).collect::<Vec<_>>();
    let mut flat = vec![DVec2::ZERO; m];
    flat[0] = DVec2::new(corners[0].distance(corners[m - 1]), 0.0);
    let mut points = vec![DVec2::ZERO; n];
    // Each item: an edge whose ends are laid out, with what is still to be laid out on its right; and the
    // apex on its left.
    let mut open = vec![(0, m - 1, None)];
    while let Some((i, k, beyond)) = open.pop() {
        if k == i + 1 {
            lay_chain(positions, [chosen[i], chosen[k]], [flat[i], flat[k]], beyond, &mut points);
            continue;
        }
        let j = apex[i * m + k] as usize;
        let (a, b, c) = (
            corners[j].distance(corners[i]),
            corners[j].distance(corners[k]),
            corners[k].distance(corners[i]),
        );
        let along = (flat[k] - flat[i]).normalize_or(DVec2::X);
        let x = if c > 0.0 { 0.5 * (a * a + c * c - b * b) / c } else { a };
        let x = x.clamp(-a, a);
        flat[j] = flat[i] + x * along - (a * a - x * x).max(0.0).sqrt() * along.perp();
        if (i, k) == (0, m - 1) {
            let ends = [chosen[m - 1], chosen[0] + n];
            lay_chain(positions, ends, [flat[m - 1], flat[0]], Some(corners[j]), &mut points);
        }
        open.push((i, j, Some(corners[k])));
        open.push((j, k, Some(corners[i])));
    }
    points
}

/// Lays out the vertices from `ends[0]` to `ends[1]` (counted on past the end of the loop).
fn lay_chain(
    positions: &[DVec3],
    ends: [usize; 2],
    flat: [DVec2; 2],
    apex: Option<DVec3>,
    points: &mut [DVec2],
) {
    let n = positions.len();
    let (p, q) = (positions[ends[0] % n], positions[ends[1] % n]);
    let u = (q - p).normalize_or(DVec3::X);
    let side = apex.map_or(DVec3::ZERO, |apex| apex - p);
    let w = (side - side.dot(u) * u).normalize_or_zero();
    let along = (flat[1] - flat[0]).normalize_or(DVec2::X);
    for k in ends[0]..ends[1] {
        let d = positions[k % n] - p;
        points[k % n] = flat[0] + d.dot(u) * along + d.dot(w) * along.perp();
    }
}

/// The loop's edge lengths with its turning in `flat`, a share of it replaced by that of a circle.
fn evened(positions: &[DVec3], flat: &[DVec2], share: f64) -> Vec<DVec2> {
    let n = positions.len();
    let length = |k: usize| positions[k % n].distance(positions[(k + 1) % n]);
    let total: f64 = (0..n).map(length).sum();
    let edge = |k: usize| flat[(k + 1) % n] - flat[k % n];
    let turn = |k: usize| edge(k + n - 1).angle_to(edge(k));
    let sum: f64 = (0..n).map(turn).sum();
    let mut heading = 0.0f64;
    let mut points = Vec::with_capacity(n);
    let mut at = DVec2::ZERO;
    let mut arc = vec![];
    let mut walked = 0.0;
    for k in 0..n {
        let (before, after) = (length(k + n - 1), length(k));
        let even = TAU * (before + after) / (2.0 * total);
        let own = turn(k) + (TAU - sum) * (before + after) / (2.0 * total);
        heading += (1.0 - share) * own + share * even;
        points.push(at);
        arc.push(walked);
        at += after * DVec2::from_angle(heading);
        walked += after;
    }
    // What is missing to close it, spread in proportion to length.
    for (point, arc) in points.iter_mut().zip(arc) {
        *point -= at * (arc / total);
    }
    points
}

/// The polygon with the loop's edge lengths whose vertices lie on a circle.
fn inscribed(positions: &[DVec3]) -> Vec<DVec2> {
    let n = positions.len();
    let lengths = (0..n).map(|k| positions[k].distance(positions[(k + 1) % n])).collect::<Vec<_>>();
    let (longest, &most) = lengths.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap_or((0, &1.0));
    let total: f64 = lengths.iter().sum();
    // The angles at the centre as a function of the curvature; at the largest one the longest edge is
    // a diameter. If the others then fall short of the other half, the centre lies beyond that edge.
    let angle = |length: f64, curvature: f64| 2.0 * libm::asin((0.5 * length * curvature).min(1.0));
    let others = |c: f64| (0..n).filter(|&k| k != longest).map(|k| angle(lengths[k], c)).sum::<f64>();
    let inside = others(2.0 / most) >= TAU / 2.0;
    let (mut low, mut high) = (0.0, 2.0 / most);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        let excess = if inside {
            others(middle) + angle(most, middle) - TAU
        } else {
            angle(most, middle) - others(middle)
        };
        // The long edge's angle catches up with the others' from below as the curvature grows.
        if excess < 0.0 { low = middle } else { high = middle }
    }
    let curvature = (0.5 * (low + high)).max(f64::EPSILON / total);
    let mut heading = 0.0;
    (0..n)
        .map(|k| {
            let point = DVec2::from_angle(heading) / curvature;
            let step = angle(lengths[k], curvature);
            heading += if k == longest && !inside { -step } else { step };
            point
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lengths_kept(positions: &[DVec3], points: &[DVec2]) -> f64 {
        let n = points.len();
        let change = |k: usize| {
            points[k].distance(points[(k + 1) % n]) / positions[k].distance(positions[(k + 1) % n]) - 1.0
        };
        (0..n).map(|k| change(k).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_bent_strip_develops() {
        // A band around 300 degrees of a cylinder: its projection covers itself.
        let arc = |k: i32| f64::from(k) * 5.0 / 20.0;
        let mut positions = (0..=20).map(|k| DVec3::new(arc(k).cos(), arc(k).sin(), 0.0)).collect::<Vec<_>>();
        positions.extend((0..=20).rev().map(|k| DVec3::new(arc(k).cos(), arc(k).sin(), 0.4)));
        let unrolled = unroll(&positions);
        assert_eq!(unrolled.method, Unrolling::Developed);
        assert!(unrolled.distortion < 1e-9, "{}", unrolled.distortion);
        assert!(is_simple(&unrolled.points));
        let size = unrolled.points[0].distance(unrolled.points[20]);
        assert!((size - 20.0 * 2.0 * (0.125f64).sin()).abs() < 1e-9, "{size}");
    }

    #[test]
    fn large_loops_are_developed_on_fewer_vertices() {
        // The rim of a saddle.
        let positions = (0..500)
            .map(|k| {
                let t = TAU * f64::from(k) / 500.0;
                DVec3::new(t.cos(), t.sin(), 0.9 * (2.0 * t).cos())
            })
            .collect::<Vec<_>>();
        let unrolled = unroll(&positions);
        assert_eq!(unrolled.method, Unrolling::Developed);
        assert!(unrolled.distortion < 0.05, "{}", unrolled.distortion);
    }

    #[test]
    fn what_winds_twice_becomes_a_circle() {
        // Twice around, then back through the middle: no disk of this turning is simple.
        let positions = (0..60)
            .map(|k| {
                let t = 2.0 * TAU * f64::from(k) / 60.0;
                let r = 1.0 + 0.3 * (t / 2.0).cos();
                DVec3::new(r * t.cos(), r * t.sin(), 0.3 * (t / 2.0).sin())
            })
            .collect::<Vec<_>>();
        assert!(is_simple(&unroll(&positions).points));
        for longest in [0.5, 4.0, 9.9] {
            // A long edge and ten short ones.
            let mut line = (0..10).map(|k| DVec3::new(f64::from(k), 0.0, 0.0)).collect::<Vec<_>>();
            line.push(DVec3::new(longest, 0.2, 0.0));
            let points = inscribed(&line);
            assert!(is_simple(&points), "{longest}");
            assert!(lengths_kept(&line, &points) < 1e-6, "{longest}");
        }
        let points = evened(&positions, &inscribed(&positions), 1.0);
        assert!(lengths_kept(&positions, &points) < 0.05);
    }

    #[test]
    fn planar_loops_are_projected() {
        let plane = |x: f64, y: f64| DVec3::new(x + 2.0, x - y, 2.0 * x + y) * 0.7;
        let l_shape = [(0., 0.), (2., 0.), (2., 1.), (1., 1.), (1., 2.), (0., 2.)].map(|(x, y)| plane(x, y));
        let unrolled = unroll(&l_shape);
        assert_eq!(unrolled.method, Unrolling::Projected);
        assert!(unrolled.distortion < 1e-12);
    }
}
