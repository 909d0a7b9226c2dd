//! Edge lengths of patches.

use super::Patch;

/// Share of the edges that are called the longest.
const LONGEST: f64 = 1.0 / 150.0;

/// Mean length of the longest edges over the median of all, 1 without any. Linear.
pub(crate) fn longest_over_median(patch: &Patch) -> f64 {
    let n_boundary = patch.n_boundary();
    let mut squared: Vec<f64> = Vec::with_capacity(3 * patch.triangles.len() + 4 * patch.quads.len());
    let mut add = |a: u32, b: u32| {
        // Inner edges once.
        if a < b || (a.max(b) as usize) < n_boundary {
            squared.push(patch.vertices[a as usize].distance_squared(patch.vertices[b as usize]));
        }
    };
    for face in &patch.triangles {
        (0..3).for_each(|k| add(face[k], face[(k + 1) % 3]));
    }
    for face in &patch.quads {
        (0..4).for_each(|k| add(face[k], face[(k + 1) % 4]));
    }
    let n = squared.len();
    let longest = ((n as f64 * LONGEST) as usize).max(1);
    if n < 2 * longest {
        return 1.0;
    }
    let (_, &mut median, _) = squared.select_nth_unstable_by(n / 2, f64::total_cmp);
    let (_, _, beyond) = squared.select_nth_unstable_by(n - longest - 1, f64::total_cmp);
    let mean = beyond.iter().map(|l| l.sqrt()).sum::<f64>() / beyond.len() as f64;
    mean / median.sqrt()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::patch::Loop;
    use crate::path::placement::Lattice;

    fn patch(vertices: Vec<DVec2>, triangles: Vec<[u32; 3]>, quads: Vec<[u32; 4]>) -> Patch {
        let lattice = Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 };
        Patch { vertices, triangles, quads, loops: vec![], inlets: vec![], lattice }
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
        assert!((longest_over_median(&strip(0.0)) - 1.0).abs() < 1e-9);
        assert!(longest_over_median(&strip(20.0)) > 2.0);
        assert!((longest_over_median(&squares(20, 1.0)) - 1.0).abs() < 1e-9);
        assert!((longest_over_median(&squares(20, 3.0)) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn edges_of_the_boundary_count_whatever_their_numbers() {
        // The last edge of a ring leads from its last vertex to its first.
        let mut ring = patch(vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y], vec![], vec![[0, 1, 2, 3]]);
        ring.vertices[3].y = 9.0;
        ring.loops = vec![Loop { arc: vec![0.0; 4], ..Loop::default() }];
        assert!((longest_over_median(&ring) - 9.0 / 65f64.sqrt()).abs() < 1e-12);
    }
}
