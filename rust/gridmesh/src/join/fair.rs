//! A patch smooth to its surroundings: a thin plate through its border that goes on from what lies beyond.

use glam::DVec3;

use super::local::Local;
use crate::error::Result;
use crate::progress::Progress;

/// Sweeps over all vertices at most.
const SWEEPS: usize = 400;

/// Sweeps end where no vertex moves further, in edge lengths.
const STILL: f64 = 1e-4;

/// Vertices beyond the border, by the border's vertex: the sum of their positions, and how many.
pub(super) type Beyond = Vec<(DVec3, usize)>;

/// Moves the vertices inside to where the sum of the squared Laplacians is least, those of the border included.
///
/// Gauss and Seidel's method: each vertex in turn to its own least. Source: Kobbelt et al., *Interactive multi-resolution modeling
/// on arbitrary meshes*, 1998, for the umbrella operator applied twice.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(super) fn fair(local: &Local, beyond: &Beyond, progress: Progress<'_>) -> Result<Vec<DVec3>> {
    let n = local.positions.len();
    let near = (0..n as u32).map(|v| local.neighbours(v)).collect::<Vec<_>>();
    let mut positions = local.positions.clone();
    let share = |v: usize| {
        let more = beyond.get(v).map_or(0, |b| b.1);
        1.0 / (near[v].len() + more).max(1) as f64
    };
    let shares = (0..n).map(share).collect::<Vec<_>>();
    let offset = |v: usize, positions: &[DVec3]| {
        let outer = beyond.get(v).map_or(DVec3::ZERO, |b| b.0);
        positions[v] - shares[v] * (outer + near[v].iter().map(|&u| positions[u as usize]).sum::<DVec3>())
    };
    let mut offsets = (0..n).map(|v| offset(v, &positions)).collect::<Vec<_>>();
    for sweep in 0..SWEEPS {
        if sweep % 16 == 0 {
            progress.report(sweep as f64 / SWEEPS as f64)?;
        }
        let mut most = 0.0f64;
        for v in local.border..n {
            let (mut down, mut squares) = (offsets[v], 1.0);
            for &u in &near[v] {
                down -= shares[u as usize] * offsets[u as usize];
                squares += shares[u as usize].powi(2);
            }
            let step = -down / squares;
            positions[v] += step;
            offsets[v] += step;
            for &u in &near[v] {
                offsets[u as usize] -= shares[u as usize] * step;
            }
            most = most.max(step.length() / local.sizes[v]);
        }
        if most < STILL {
            break;
        }
    }
    Ok(positions)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tube of `rows` rows of `n` vertices, both ends fixed, on a cone.
    fn tube(n: u32, rows: u32, radius: impl Fn(f64) -> f64) -> (Local, Beyond) {
        let point = |k: u32, row: f64| {
            let t = std::f64::consts::TAU * (f64::from(k) + 0.5 * row) / f64::from(n);
            (radius(row) * DVec3::new(t.cos(), t.sin(), 0.0)).with_z(0.1 * row)
        };
        let mut order = (0..n).map(|k| (k, 0)).chain((0..n).map(|k| (k, rows))).collect::<Vec<_>>();
        order.extend((1..rows).flat_map(|row| (0..n).map(move |k| (k, row))));
        let number = |k: u32, row: u32| order.iter().position(|&p| p == (k % n, row)).unwrap() as u32;
        let mut triangles = vec![];
        for (k, row) in (0..n).flat_map(|k| (0..rows).map(move |row| (k, row))) {
            let [a, b] = [number(k, row), number(k + 1, row)];
            let [c, d] = [number(k, row + 1), number(k + 1, row + 1)];
            triangles.extend([[a, b, c], [b, d, c]]);
        }
        let positions = order.iter().map(|&(k, row)| point(k, f64::from(row))).collect::<Vec<_>>();
        let outer = |k: u32, row: f64, next: u32| point(k, row) + point(next, row);
        let beyond = order[..2 * n as usize].iter().map(|&(k, row)| {
            // Of the rings before the first and after the last the two vertices beside.
            let row = f64::from(row);
            let sum = if row == 0.0 { outer(k, -1.0, k + 1) } else { outer(k, row + 1.0, k + n - 1) };
            (sum, 2)
        });
        let beyond = beyond.collect();
        let sides = vec![0; triangles.len()];
        let mut local = Local::new(positions, triangles, sides, 2 * n as usize);
        local.sizes.fill(0.1);
        (local, beyond)
    }

    #[test]
    fn a_cylinder_goes_on_between_cylinders() {
        let (mut local, beyond) = tube(24, 6, |_| 1.0);
        let wanted = local.positions.clone();
        for p in &mut local.positions[48..] {
            *p *= DVec3::new(0.7, 0.7, 1.0);
        }
        let found = fair(&local, &beyond, Progress::NONE).unwrap();
        let off = found.iter().zip(&wanted).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
        assert!(off < 0.02, "{off}");
        assert_eq!(found[..48], wanted[..48]);
    }
}
