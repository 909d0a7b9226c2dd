//! Edge lengths of patches.

use super::Patch;

/// Share of the edges that are called the longest, and of those that are called long.
const LONGEST: f64 = 1.0 / 150.0;
const LONG: f64 = 0.01;

/// Mean length of the longest edges, and the length above which one in a hundred is, over the median of all; 1
/// without any. Linear.
pub(crate) fn longest_over_median(patch: &Patch) -> (f64, f64) {
    let length = |[a, b]: [u32; 2]| patch.vertices[a as usize].distance_squared(patch.vertices[b as usize]);
    // Each edge once, but for those that close a contour: the boundary's vertices are numbered in a row.
    let mut squared: Vec<f64> = patch.sides().filter(|[a, b]| a < b).map(length).collect();
    let n = squared.len();
    let longest = ((n as f64 * LONGEST) as usize).max(1);
    if n < 2 * longest {
        return (1.0, 1.0);
    }
    let (_, &mut median, _) = squared.select_nth_unstable_by(n / 2, f64::total_cmp);
    let (_, _, beyond) = squared.select_nth_unstable_by(n - longest - 1, f64::total_cmp);
    let mean = beyond.iter().map(|l| l.sqrt()).sum::<f64>() / beyond.len() as f64;
    let (_, &mut long, _) =
        squared.select_nth_unstable_by(n - 1 - (n as f64 * LONG) as usize, f64::total_cmp);
    (mean / median.sqrt(), (long / median).sqrt())
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::path::placement::Lattice;

    fn patch(vertices: Vec<DVec2>, triangles: Vec<[u32; 3]>, quads: Vec<[u32; 4]>) -> Patch {
        let lattice = Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 };
        Patch { vertices, triangles, quads, loops: vec![], inlets: vec![], lattice, belt: None }
    }

    /// A strip of triangles with edges of one, but for the two at the last vertex, which are `far` longer or so.
    fn strip(far: f64) -> Patch {
        let n = 600;
        let height = 0.75f64.sqrt();
        let mut vertices: Vec<DVec2> =
            (0..n).map(|k| DVec2::new(0.5 * f64::from(k), f64::from(k % 2) * height)).collect();
        if let Some(last) = vertices.last_mut() {
            last.x += far;
        }
        let turned = |k: u32| if k.is_multiple_of(2) { [k, k + 2, k + 1] } else { [k, k + 1, k + 2] };
        patch(vertices, (0..n - 2).map(|k| turned(k as u32)).collect(), vec![])
    }

    /// A square of as many squares a side, the last row so many times as high.
    fn squares(n: u32, stretch: f64) -> Patch {
        let row = |j: u32| f64::from(j) + if j == n { stretch - 1.0 } else { 0.0 };
        let vertices = (0..=n).flat_map(|j| (0..=n).map(move |i| DVec2::new(f64::from(i), row(j)))).collect();
        let at = |i: u32, j: u32| j * (n + 1) + i;
        let cell = |i, j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        patch(vertices, vec![], (0..n).flat_map(|j| (0..n).map(move |i| cell(i, j))).collect())
    }

    #[test]
    fn a_few_long_edges_show() {
        assert!((longest_over_median(&strip(0.0)).0 - 1.0).abs() < 1e-9);
        assert!(longest_over_median(&strip(20.0)).0 > 2.0);
        assert!((longest_over_median(&squares(20, 1.0)).0 - 1.0).abs() < 1e-9);
        assert!((longest_over_median(&squares(20, 3.0)).0 - 3.0).abs() < 1e-9);
        // The last row of squares has one side in forty, a single far vertex fewer than one in a hundred.
        assert!((longest_over_median(&squares(20, 3.0)).1 - 3.0).abs() < 1e-9);
        assert!((longest_over_median(&strip(20.0)).1 - 1.0).abs() < 1e-9);
        assert_eq!(longest_over_median(&patch(vec![], vec![], vec![])), (1.0, 1.0));
    }
}
