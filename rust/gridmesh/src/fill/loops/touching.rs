//! Loops that lie on each other: no face fits between them there.

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::error::{Error, LoopError, Result};

/// Loops as near as this to each other touch: as 32-bit floats round their coordinates, with these parts of the shorter edge there as
/// the least and the most.
const ROUNDING: f64 = 1.0 / 4_194_304.0;
const LEAST: f64 = 1e-6;
const MOST: f64 = 1e-3;

/// Refuses loops that touch each other, at a vertex, across an edge, or all along; edges have a length.
///
/// # Errors
/// [`LoopError::Touching`].
pub(crate) fn check_apart<L: AsRef<[u32]>>(given: &[L], positions: &[DVec3]) -> Result<()> {
    let mut edges = vec![];
    for (number, loop_) in given.iter().enumerate() {
        let loop_ = loop_.as_ref();
        let next = loop_.iter().cycle().skip(1);
        edges.extend(loop_.iter().zip(next).map(|(&a, &b)| (number, [a, b])));
    }
    let ends = |[a, b]: [u32; 2]| (positions[a as usize], positions[b as usize]);
    let boxed = |(k, &(_, edge)): (usize, &(usize, [u32; 2]))| {
        let (p, q) = ends(edge);
        GeomWithData::new(Rectangle::from_corners(p.min(q).to_array(), p.max(q).to_array()), k)
    };
    let nearer = |edge: [u32; 2], at: DVec3| {
        let (p, q) = ends(edge);
        if at.distance(p) <= at.distance(q) { edge[0] } else { edge[1] }
    };
    let tree = RTree::bulk_load(edges.iter().enumerate().map(boxed).collect());
    for &(number, edge) in &edges {
        let (p, q) = ends(edge);
        let margin = DVec3::splat(MOST * p.distance(q));
        let around = AABB::from_corners((p.min(q) - margin).to_array(), (p.max(q) + margin).to_array());
        let hits = tree.locate_in_envelope_intersecting(around).map(|hit| edges[hit.data]);
        let touching = hits.filter(|(other, _)| *other > number).filter_map(|(other, beside)| {
            let (a, b) = ends(beside);
            let (x, y) = closest(p, q, a, b);
            let scale = [p, q, a, b].iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
            let shorter = p.distance(q).min(a.distance(b));
            let allowed = (ROUNDING * scale).clamp(LEAST * shorter, MOST * shorter);
            (x.distance(y) <= allowed).then_some((
                other,
                [(edge, x), (beside, y)].map(|(e, at)| nearer(e, at)),
                x,
            ))
        });
        if let Some((other, vertices, at)) = touching.min_by_key(|&(other, vertices, _)| (other, vertices)) {
            let loops = [number, other];
            return Err(Error::Loops(LoopError::Touching { loops, vertices, at: at.into() }));
        }
    }
    Ok(())
}

/// The points of two segments that are nearest to each other.
pub(super) fn closest(p: DVec3, q: DVec3, a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let (u, v, w) = (q - p, b - a, p - a);
    let (uu, uv, vv, uw, vw) = (u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w));
    let determinant = uu * vv - uv * uv;
    let mut s =
        if determinant > 1e-14 * uu * vv { ((uv * vw - vv * uw) / determinant).clamp(0.0, 1.0) } else { 0.0 };
    let t = ((uv * s + vw) / vv).clamp(0.0, 1.0);
    s = ((uv * t - uw) / uu).clamp(0.0, 1.0);
    (p + s * u, a + t * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rings of so many vertices, the second moved.
    fn rings(n: usize, m: usize, place: impl Fn(DVec3) -> DVec3) -> (Vec<DVec3>, [Vec<u32>; 2]) {
        let ring = |n: usize| {
            (0..n).map(move |k| {
                let turn = std::f64::consts::TAU * k as f64 / n as f64;
                DVec3::new(turn.cos(), turn.sin(), 0.0)
            })
        };
        let (n32, all) = (n as u32, (n + m) as u32);
        (ring(n).chain(ring(m).map(place)).collect(), [(0..n32).collect(), (n32..all).collect()])
    }

    fn touching(n: usize, m: usize, scale: f64, place: impl Fn(DVec3) -> DVec3) -> bool {
        let (mut positions, loops) = rings(n, m, place);
        positions.iter_mut().for_each(|p| *p *= scale);
        check_apart(&loops, &positions).is_err()
    }

    #[test]
    fn loops_on_each_other_touch_at_any_scale_also_if_rounded() {
        let rounded = |p: DVec3| p.as_vec3().as_dvec3();
        for scale in [1e-30, 1e-3, 1.0, 1e5, 1e30] {
            assert!(touching(24, 24, scale, |p| p));
            assert!(touching(24, 24, scale, rounded));
            assert!(touching(24, 48, scale, |p| p), "every second vertex");
            assert!(touching(24, 24, scale, |p| p + DVec3::X * 2.0), "one vertex");
            assert!(touching(24, 24, scale, |p| DVec3::new(p.x, p.z, p.y) + DVec3::X * 2.0), "one vertex");
            assert!(touching(24, 24, scale, |p| p + DVec3::X * 0.3), "edges that cross");
        }
    }

    #[test]
    fn loops_near_each_other_do_not() {
        for scale in [1e-30, 1e-3, 1.0, 1e5, 1e30] {
            assert!(!touching(24, 24, scale, |p| p + DVec3::Z * 1e-3));
            assert!(!touching(24, 24, scale, |p| p * 1.001));
            assert!(!touching(24, 24, scale, |p| p + DVec3::X * 2.001));
            assert!(!touching(24, 31, scale, |p| p + DVec3::Z));
        }
    }

    #[test]
    fn the_vertices_that_touch_are_named() {
        let (positions, loops) = rings(24, 24, |p| p + DVec3::X * 2.0);
        let Err(Error::Loops(LoopError::Touching { loops, vertices, at })) = check_apart(&loops, &positions)
        else {
            panic!("they touch");
        };
        assert_eq!((loops, vertices), ([0, 1], [0, 36]));
        assert!(DVec3::from(at).distance(DVec3::X) < 1e-12);
    }
}
