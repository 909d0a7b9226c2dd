//! The surface of a bridge found again for a mesh that moved, and bent to the curvature around.

use glam::DVec3;

use super::align::Ring;
use super::choose::Bank;
use super::loft::Loft;
use super::rail::{Edge, onward};
use crate::error::{Error, Result};
use crate::fill::filled::{Bridged, Shape};
use crate::fill::options::Smooth;
use crate::fill::surface::faces::good_corner;
use crate::fill::surface::fair::{Bending, Membrane};
use crate::fill::surface::fit::{SEAM_OF_CURVATURE, curvature_target};
use crate::fill::surface::patchwork::Patchwork;
use crate::options::CellShape;
use crate::progress::Progress;

/// Steps towards the wanted curvature.
const CURVED: usize = 2;

/// Shares of these steps that are tried.
const SHARES: [f64; 3] = [1.0, 0.5, 0.25];

/// What has to be left of the least corner, or of a good one if that is less.
const KEPT: f64 = 0.75;

impl Shape {
    /// Positions of a bridge for a mesh with vertices at `mesh`: on the surface between its loops where they were on
    /// the old one.
    ///
    /// # Errors
    /// [`Error::Solver`].
    pub(in crate::fill) fn lofted(
        &self,
        mesh: &[DVec3],
        bridged: Bridged,
        progress: Progress<'_>,
    ) -> Result<Vec<DVec3>> {
        let (work, first) = (&self.work, bridged.first);
        let mut positions = work_positions(work, &self.loop_, mesh);
        let bank = |range: std::ops::Range<usize>| {
            let apex = |v: usize| {
                let next = work.after(v) as u32;
                let mut beyond = work.fan(v).iter().filter(|&&[t, ..]| t as usize >= work.n_patch);
                beyond.find_map(|&[_, p, q]| match next {
                    next if p == next => Some(positions[q as usize]),
                    next if q == next => Some(positions[p as usize]),
                    _ => None,
                })
            };
            let points = positions[range.clone()].to_vec();
            let apexes = range.clone().map(apex).collect::<Vec<_>>();
            let flat = self.smooth == Smooth::Flat;
            let mut onward = if flat { vec![DVec3::ZERO; points.len()] } else { onward(&points, &apexes) };
            let mut around = self.flat[range.clone()].iter().map(|p| p.x).collect::<Vec<_>>();
            let upper = self.flat[range.start].y > 0.5;
            let mut ring = Ring::new(points);
            if upper {
                (around, onward, ring) = (reversed(&around), reversed(&onward), ring.reversed());
            }
            (upper, Bank { ring, around, wanted: vec![] }, onward)
        };
        let mut banks = [bank(0..first), bank(first..work.n)];
        banks.sort_by_key(|bank| bank.0);
        let [(_, lower, below), (_, upper, above)] = &banks;
        let loft = Loft::new(&edge(lower, below), &edge(upper, above), bridged.pull, bridged.leaving);
        for v in work.inner() {
            positions[v] = loft.at(self.flat[v].x, self.flat[v].y).point;
        }
        if self.smooth == Smooth::Curvature {
            positions = self.curved(positions, progress)?;
        }
        if positions.iter().any(|p| !p.is_finite()) {
            return Err(Error::Solver { stage: "bridge", reason: "a vertex is not finite".into() });
        }
        Ok(positions)
    }

    /// [`Shape::curved`] for quads: four triangles around the middle of each bend the same in all directions.
    fn centred_curved(&self, mut start: Vec<DVec3>, progress: Progress<'_>) -> Result<Vec<DVec3>> {
        let (end, quads) = (self.work.end, self.work.quads);
        let middle = |q: [u32; 4]| q.iter().map(|&v| start[v as usize]).sum::<DVec3>() / 4.0;
        let middles = self.work.quads().map(middle).collect::<Vec<_>>();
        start.splice(end..end, middles);
        let mut curved = self.centred()?.curved(start, progress)?;
        curved.drain(end..end + quads);
        Ok(curved)
    }

    /// Moves the vertices of a bridge along their normals towards the curvature of the surroundings, as far as corners stay good:
    /// beside loops that zigzag the curvature is not smooth.
    pub(super) fn curved(&self, start: Vec<DVec3>, progress: Progress<'_>) -> Result<Vec<DVec3>> {
        let work = &self.work;
        if work.inner().is_empty() || !work.closed[..work.n].contains(&true) {
            return Ok(start);
        }
        if work.quads > 0 {
            return self.centred_curved(start, progress);
        }
        let steps = || {
            let (bending, membrane) = (Bending::new(work, progress)?, Membrane::new(work, progress)?);
            let mut positions = start.clone();
            for _ in 0..CURVED {
                let target = curvature_target(work, &membrane, &positions, progress)?;
                bending.normal_step(&mut positions, SEAM_OF_CURVATURE, Some(&target), progress)?;
            }
            Ok(positions)
        };
        let curved = match steps() {
            // Triangles without area spoil the equations.
            Err(Error::Solver { .. }) => return Ok(start),
            other => other?,
        };
        let least = |positions: &[DVec3]| work.corner_range(positions)[0];
        let enough = KEPT * least(&start).min(good_corner(CellShape::Triangle));
        let towards =
            |share: f64| start.iter().zip(&curved).map(|(a, b)| a.lerp(*b, share)).collect::<Vec<_>>();
        let nearer = SHARES.into_iter().map(towards).find(|positions| least(positions) >= enough);
        Ok(nearer.unwrap_or(start))
    }
}

/// The loops' own positions, those of vertices around, and zeros between.
pub(super) fn work_positions(work: &Patchwork, loop_: &[u32], mesh: &[DVec3]) -> Vec<DVec3> {
    let mut positions = vec![DVec3::ZERO; work.len()];
    for (k, &v) in loop_.iter().enumerate() {
        positions[k] = mesh[v as usize];
    }
    for (k, &v) in work.outer.iter().enumerate() {
        positions[work.end + k] = mesh[v as usize];
    }
    positions
}

pub(super) fn edge<'a>(bank: &'a Bank, onward: &'a [DVec3]) -> Edge<'a> {
    Edge { ring: &bank.ring, around: &bank.around, onward }
}

pub(super) fn reversed<T: Clone>(items: &[T]) -> Vec<T> {
    items.iter().rev().cloned().collect()
}
