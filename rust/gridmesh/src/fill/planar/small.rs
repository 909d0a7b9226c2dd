//! Patches for loops of a few vertices: triangles alone, or one vertex in the middle.

use glam::DVec2;

use super::flips::shape;

/// Loops up to this size are tried without interior vertices.
pub(in crate::fill) const SMALL: usize = 9;

/// The triangulation without interior vertices whose triangles and valences are best together.
/// `None` if every one needs an edge that is taken.
///
/// The optimum over all triangulations of the polygon but for the valences, which are judged
/// triangle by triangle. O(n^3).
pub(in crate::fill) fn without_interior(
    polygon: &[DVec2],
    taken: &dyn Fn(usize, usize) -> bool,
) -> Option<Vec<[u32; 3]>> {
    let n = polygon.len();
    let mut best = vec![vec![(0.0, usize::MAX); n]; n];
    let open = |i: usize, j: usize| j - i == 1 || j - i == n - 1 || !taken(i, j);
    for span in 2..n {
        for i in 0..n - span {
            let k = i + span;
            best[i][k].0 = f64::INFINITY;
            if !open(i, k) {
                continue;
            }
            for j in i + 1..k {
                let own = 1.0 / shape(polygon[i], polygon[j], polygon[k]).max(1e-6);
                let sum = best[i][j].0 + best[j][k].0 + own * own;
                if sum < best[i][k].0 {
                    best[i][k] = (sum, j);
                }
            }
        }
    }
    best[0][n - 1].0.is_finite().then(|| {
        let mut triangles = Vec::with_capacity(n - 2);
        let mut stack = vec![(0, n - 1)];
        while let Some((i, k)) = stack.pop() {
            if k - i < 2 {
                continue;
            }
            let j = best[i][k].1;
            triangles.push([i as u32, j as u32, k as u32]);
            stack.push((j, k));
            stack.push((i, j));
        }
        triangles
    })
}

/// All loop edges joined to one new vertex, which the caller settles.
pub(in crate::fill) fn around_centre(polygon: &[DVec2]) -> (DVec2, Vec<[u32; 3]>) {
    let n = polygon.len();
    let area: f64 = (0..n).map(|k| polygon[k].perp_dot(polygon[(k + 1) % n])).sum();
    let weighted: DVec2 = (0..n)
        .map(|k| {
            let (a, b) = (polygon[k], polygon[(k + 1) % n]);
            (a + b) * a.perp_dot(b)
        })
        .sum();
    let mean = polygon.iter().sum::<DVec2>() / n as f64;
    let centre = weighted / (3.0 * area);
    let centre = if centre.is_finite() { centre } else { mean };
    (centre, (0..n).map(|k| [k as u32, ((k + 1) % n) as u32, n as u32]).collect())
}
