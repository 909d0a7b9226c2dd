//! Distances from triangles.

use glam::DVec3;

/// Points of a triangle where its distance from others is taken: a lattice with at least six steps to an edge, and
/// steps no longer than `spacing` while that makes no more than 24. The middles of the edges come first, corners
/// not at all.
pub(super) fn samples([a, b, c]: [DVec3; 3], spacing: f64) -> impl Iterator<Item = DVec3> {
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a)).sqrt();
    let n = (longest / spacing).ceil().clamp(6.0, 24.0) as u32;
    let at = move |i: u32, j: u32| {
        let [u, v, w] = [i, j, n - i - j].map(|k| f64::from(k) / f64::from(n));
        (i.max(j).max(n - i - j) < n).then(|| u * a + v * b + w * c)
    };
    let middles = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
    middles.into_iter().chain((0..=n).flat_map(move |i| (0..=n - i).filter_map(move |j| at(i, j))))
}

/// Distance of a point from a triangle, if that is at most `reach`.
pub(super) fn within(p: DVec3, triangle: [DVec3; 3], reach: f64) -> Option<f64> {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(c - a);
    // The plane is no farther than the triangle.
    let off = (p - a).dot(normal);
    if off * off > reach * reach * normal.length_squared() {
        return None;
    }
    Some(closest(p, triangle).0).filter(|&off| off <= reach)
}

/// Distance of a point from a triangle, and the weights of its corners there.
pub(super) fn closest(p: DVec3, [a, b, c]: [DVec3; 3]) -> (f64, [f64; 3]) {
    let normal = (b - a).cross(c - a);
    let squared = normal.length_squared();
    if squared > 0.0 {
        let inside = [
            (c - b).cross(p - b).dot(normal),
            (a - c).cross(p - c).dot(normal),
            (b - a).cross(p - a).dot(normal),
        ];
        if inside.iter().all(|&x| x >= 0.0) {
            return ((p - a).dot(normal).abs() / squared.sqrt(), inside.map(|x| x / squared));
        }
    }
    let corners = [a, b, c];
    let side = |k: usize| {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let along = to - from;
        let t = ((p - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let mut weights = [0.0; 3];
        (weights[k], weights[(k + 1) % 3]) = (1.0 - t, t);
        ((from + t * along).distance(p), weights)
    };
    let sides = [side(0), side(1), side(2)];
    sides.into_iter().min_by(|x, y| x.0.total_cmp(&y.0)).unwrap_or((f64::INFINITY, [1.0, 0.0, 0.0]))
}
