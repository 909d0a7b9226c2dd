//! Where the vertices of a patch go: from the lattice, or from another loop, to the loop that it fills.

use glam::DVec2;

use super::mean_value::{spread, step};
use super::settle::{Rings, even_out, extend, untangle};
use crate::error::Result;
use crate::geometry::stars::Stars;
use crate::lattice::assemble::Region;
use crate::lattice::grid::Triangular;
use crate::path::placement::Lattice;
use crate::progress::Progress;

/// Sweeps for what a guess of the harmonic extension leaves.
const SWEEPS: usize = 12;

/// Interior vertices of a patch on the lattice, where `points` is its loop. `None` if it is not a disk.
pub(in crate::fill) fn off_lattice(
    points: &[DVec2],
    patch: &Region,
    progress: Progress<'_>,
) -> Result<Option<Vec<DVec2>>> {
    let n = points.len();
    let mut positions: Vec<DVec2> = patch.points.iter().map(|&p| Lattice::units(p)).collect();
    let fit = Similarity::between(&positions[..n], points);
    positions.iter_mut().for_each(|p| *p = fit.apply(*p));
    progress.report(0.0)?;
    let Some(rings) = Rings::new(&patch.triangles, n, positions.len(), progress)? else { return Ok(None) };
    let mut moved: Vec<DVec2> = points.iter().zip(&positions).map(|(p, q)| *p - *q).collect();
    moved.extend(spread::<Triangular>(&patch.points[..n], &moved, &patch.points[n..], progress)?);
    progress.report(0.0)?;
    extend(&rings, &mut positions, moved, f64::from(step(n)), SWEEPS, progress)?;
    positions[..n].copy_from_slice(points);
    settle(&rings, &mut positions, progress)?;
    Ok(Some(positions.split_off(n)))
}

/// Interior vertices of a patch moved to where its triangles are best.
pub(in crate::fill) fn settled(
    points: &[DVec2],
    interior: Vec<DVec2>,
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Vec<DVec2>> {
    let n = points.len();
    let mut positions = [points, &interior].concat();
    if let Some(rings) = Rings::new(triangles, n, positions.len(), progress)? {
        settle(&rings, &mut positions, progress)?;
    }
    Ok(positions.split_off(n))
}

pub(super) fn settle(rings: &impl Stars, positions: &mut [DVec2], progress: Progress<'_>) -> Result<()> {
    if untangle(rings, positions, 40, progress)? {
        even_out(rings, positions, vec![true; rings.len()], 12, 0.02, progress)?;
    }
    Ok(())
}

/// As `settled`, for a patch already relaxed: starts from vertices opposite a boundary edge.
pub(in crate::fill) fn settled_by_loop(
    points: &[DVec2],
    interior: Vec<DVec2>,
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Vec<DVec2>> {
    let n = points.len();
    let mut positions = [points, &interior].concat();
    if let Some(rings) = Rings::new(triangles, n, positions.len(), progress)?
        && untangle(&rings, &mut positions, 10, progress)?
    {
        let mut active = vec![false; rings.len()];
        for t in triangles {
            let mut inside = t.iter().filter_map(|&v| (v as usize).checked_sub(n));
            if let (Some(v), None) = (inside.next(), inside.next()) {
                active[v] = true;
            }
        }
        even_out(&rings, &mut positions, active, 8, 0.02, progress)?;
    }
    Ok(positions.split_off(n))
}

/// Interior vertices of a patch of another loop, `from`, moved with it to this one.
pub(in crate::fill) fn carried_over(
    from: &[DVec2],
    interior: Vec<DVec2>,
    triangles: &[[u32; 3]],
    points: &[DVec2],
    progress: Progress<'_>,
) -> Result<Vec<DVec2>> {
    let n = points.len();
    let mut positions = [from, &interior].concat();
    if let Some(rings) = Rings::new(triangles, n, positions.len(), progress)? {
        let mut moved: Vec<DVec2> = points.iter().zip(from).map(|(p, q)| *p - *q).collect();
        let mean = moved.iter().sum::<DVec2>() / n as f64;
        moved.resize(positions.len(), mean);
        let across = (rings.len() as f64).sqrt();
        extend(&rings, &mut positions, moved, across, 60, progress)?;
        positions[..n].copy_from_slice(points);
        untangle(&rings, &mut positions, 30, progress)?;
    }
    Ok(positions.split_off(n))
}

/// A convex loop with about the same edge lengths.
pub(in crate::fill) fn round_loop(points: &[DVec2]) -> Vec<DVec2> {
    let n = points.len();
    let lengths: Vec<f64> = (0..n).map(|k| points[k].distance(points[(k + 1) % n]).max(1e-6)).collect();
    let length: f64 = lengths.iter().sum();
    let mut at = 0.0;
    lengths
        .iter()
        .map(|l| {
            let angle = std::f64::consts::TAU * at / length;
            at += l;
            length / std::f64::consts::TAU * DVec2::from_angle(angle)
        })
        .collect()
}

/// Rotation, scale and shift.
pub(super) struct Similarity {
    from: DVec2,
    to: DVec2,
    turn: DVec2,
}

impl Similarity {
    /// The one that fits best, in least squares.
    pub fn between(from: &[DVec2], to: &[DVec2]) -> Similarity {
        let n = from.len() as f64;
        let (a, b) = (from.iter().sum::<DVec2>() / n, to.iter().sum::<DVec2>() / n);
        let (mut sum, mut size) = (DVec2::ZERO, 0.0);
        for (p, q) in from.iter().zip(to) {
            let (p, q) = (*p - a, *q - b);
            sum += DVec2::new(p.dot(q), p.perp_dot(q));
            size += p.length_squared();
        }
        Similarity { from: a, to: b, turn: sum / size }
    }

    pub fn apply(&self, p: DVec2) -> DVec2 {
        self.to + self.turn.rotate(p - self.from)
    }
}
