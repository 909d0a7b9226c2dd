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
    use crate::path::placement::Lattice;

    /// A strip of triangles with edges of one; those of the last ones are `far` longer.
    fn strip(far: f64) -> Patch {
        let n = 600;
        let mut vertices: Vec<DVec2> =
            (0..n).map(|k| DVec2::new(0.5 * f64::from(k), f64::from(k % 2) * 0.75f64.sqrt())).collect();
        let last = vertices.len() - 1;
        vertices[last].x += far;
        let triangles =
            (0..n as u32 - 2).map(|k| if k % 2 == 0 { [k, k + 2, k + 1] } else { [k, k + 1, k + 2] });
        Patch {
            vertices,
            triangles: triangles.collect(),
            quads: vec![],
            loops: vec![],
            inlets: vec![],
            lattice: Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 },
        }
    }

    #[test]
    fn a_few_long_edges_show() {
        assert!((longest_over_median(&strip(0.0)) - 1.0).abs() < 1e-9);
        assert!(longest_over_median(&strip(20.0)) > 2.0);
    }
}
