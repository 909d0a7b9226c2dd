//! Triangulations of a loop in space without further vertices.

use glam::DVec3;

/// Vertices of the coarse surface at most: it takes the cube of their number.
const COARSE: usize = 120;

/// A triangulation that spans a loop. By dynamic programming, in the cube of the number of vertices.
pub(in crate::fill) struct Span {
    /// The vertices that it joins.
    pub chosen: Vec<usize>,
    /// For each pair `(i, k)` the apex of the triangle on it if the polygon `chosen[i..=k]` is
    /// triangulated best.
    pub apex: Vec<u32>,
}

impl Span {
    /// The one of least area.
    pub fn least_area(positions: &[DVec3]) -> Span {
        let chosen = coarse(positions);
        let corners = chosen.iter().map(|&k| positions[k]).collect::<Vec<_>>();
        let apex = least_area(&corners);
        Span { chosen, apex }
    }

    /// The one whose largest angle between neighbouring triangles is least, and of those the one of least
    /// area. `outside`: normals of the triangles beyond the loop's edges, of any length.
    pub fn least_bent(positions: &[DVec3], outside: &[Option<DVec3>]) -> Span {
        let n = positions.len();
        let chosen = coarse(positions);
        let m = chosen.len();
        let corners = chosen.iter().map(|&k| positions[k]).collect::<Vec<_>>();
        let beyond = (0..m).map(|c| {
            let end = if c + 1 < m { chosen[c + 1] } else { chosen[0] + n };
            let sum = (chosen[c]..end).filter_map(|k| outside[k % n]).sum::<DVec3>();
            sum.try_normalize()
        });
        let beyond = beyond.collect::<Vec<_>>();
        let apex = least_bent(&corners, &beyond);
        Span { chosen, apex }
    }
}

/// Numbers of at most [`COARSE`] vertices, evenly spread along the loop.
fn coarse(positions: &[DVec3]) -> Vec<usize> {
    let n = positions.len();
    if n <= COARSE {
        return (0..n).collect();
    }
    let mut arc = vec![0.0];
    for k in 0..n {
        arc.push(arc[k] + positions[k].distance(positions[(k + 1) % n]));
    }
    let mut chosen = (0..COARSE)
        .map(|c| arc.partition_point(|&x| x < arc[n] * c as f64 / COARSE as f64).min(n - 1))
        .collect::<Vec<_>>();
    chosen.dedup();
    chosen
}

/// For each pair `(i, k)` the apex of the triangle on it in the triangulation of least area of the
/// polygon `corners[i..=k]`. By dynamic programming, in the cube of their number.
fn least_area(corners: &[DVec3]) -> Vec<u32> {
    let m = corners.len();
    let mut cost = vec![0.0; m * m];
    let mut apex = vec![0u32; m * m];
    for width in 2..m {
        for i in 0..m - width {
            let k = i + width;
            let mut best = f64::INFINITY;
            for j in i + 1..k {
                let area = (corners[j] - corners[i]).cross(corners[k] - corners[i]).length();
                let sum = cost[i * m + j] + cost[j * m + k] + area;
                if sum < best {
                    best = sum;
                    apex[i * m + k] = j as u32;
                }
            }
            cost[i * m + k] = best;
        }
    }
    apex
}

/// As [`least_area`], of the largest angle first.
///
/// Source: Liepa 2003, "Filling holes in meshes", section 3.
fn least_bent(corners: &[DVec3], beyond: &[Option<DVec3>]) -> Vec<u32> {
    /// Angles whose cosines differ by less count as equal.
    const SAME: f64 = 1e-3;
    let m = corners.len();
    // The least cosine, and the area.
    let mut cost = vec![(1.0f64, 0.0f64); m * m];
    let mut apex = vec![0u32; m * m];
    // Of the best triangle on each pair; of what is beyond where there is none.
    let mut normal = vec![None; m * m];
    for c in 0..m - 1 {
        normal[c * m + c + 1] = beyond[c];
    }
    for width in 2..m {
        for i in 0..m - width {
            let k = i + width;
            let mut best = (f64::NEG_INFINITY, f64::INFINITY);
            for j in i + 1..k {
                let cross = (corners[j] - corners[i]).cross(corners[k] - corners[i]);
                let own = cross.try_normalize();
                let across = |other: Option<DVec3>| match (own, other) {
                    (Some(own), Some(other)) => own.dot(other),
                    // A triangle without area lies well nowhere.
                    (None, _) => -1.0,
                    _ => 1.0,
                };
                let (left, right) = (i * m + j, j * m + k);
                let mut least = cost[left].0.min(cost[right].0);
                least = least.min(across(normal[left])).min(across(normal[right]));
                if width == m - 1 {
                    least = least.min(across(beyond[m - 1]));
                }
                let area = cost[left].1 + cost[right].1 + cross.length();
                if least > best.0 + SAME || (least > best.0 - SAME && area < best.1) {
                    best = (least, area);
                    apex[i * m + k] = j as u32;
                    normal[i * m + k] = own;
                }
            }
            cost[i * m + k] = best;
        }
    }
    apex
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rim of a long window around most of a tube, and the normals of the tube beside it.
    fn window() -> (Vec<DVec3>, Vec<Option<DVec3>>) {
        let at = |k: i32| {
            let angle = 5.0 * f64::from(k) / 20.0;
            DVec3::new(angle.cos(), angle.sin(), 0.0)
        };
        let up = |z: f64| DVec3::new(0.0, 0.0, z);
        let mut rim = (0..20).map(at).collect::<Vec<_>>();
        rim.extend((0..20).map(|z| at(20) + up(0.5 * f64::from(z))));
        rim.extend((0..20).map(|k| at(20 - k) + up(10.0)));
        rim.extend((0..20).map(|z| at(0) + up(10.0 - 0.5 * f64::from(z))));
        let n = rim.len();
        let normal = |k: usize| {
            let middle = 0.5 * (rim[k] + rim[(k + 1) % n]);
            Some(DVec3::new(middle.x, middle.y, 0.0))
        };
        let outside = (0..n).map(normal).collect();
        (rim, outside)
    }

    fn triangles(span: &Span) -> Vec<[usize; 3]> {
        let m = span.chosen.len();
        let (mut open, mut found) = (vec![(0, m - 1)], vec![]);
        while let Some((i, k)) = open.pop() {
            if k > i + 1 {
                let j = span.apex[i * m + k] as usize;
                found.push([i, j, k].map(|v| span.chosen[v]));
                open.extend([(i, j), (j, k)]);
            }
        }
        found
    }

    #[test]
    fn a_window_of_a_tube_is_closed_around_it_and_not_through_it() {
        let (rim, outside) = window();
        let through = |span: &Span| {
            let inward = |t: &&[usize; 3]| {
                let [a, b, c] = t.map(|v| rim[v]);
                let middle = (a + b + c) / 3.0;
                DVec3::new(middle.x, middle.y, 0.0).length() < 0.9
            };
            triangles(span).iter().filter(inward).count()
        };
        assert!(through(&Span::least_area(&rim)) > 0);
        let span = Span::least_bent(&rim, &outside);
        assert_eq!(triangles(&span).len(), rim.len() - 2);
        assert_eq!(through(&span), 0);
        // Without a neighbour there is still a triangulation.
        assert_eq!(triangles(&Span::least_bent(&rim, &vec![None; rim.len()])).len(), rim.len() - 2);
    }

    #[test]
    fn points_in_one_place_are_spanned_too() {
        let rim = [DVec3::ZERO; 7];
        assert_eq!(triangles(&Span::least_bent(&rim, &[Some(DVec3::Z); 7])).len(), 5);
    }
}
