//! Quads between loops, by way of triangles of twice the size.

use glam::DVec3;

use super::border::{Border, Several};
use super::halves::{Halves, Quads};
use crate::error::{Error, Result};
use crate::fill::even::fair::fair;
use crate::fill::even::local::Local;
use crate::fill::even::regular::regularize;
use crate::fill::even::remesh::{Ground, remesh};
use crate::fill::even::untangle::untangle;
use crate::fill::filled::Shape;
use crate::fill::loops::check::Checked;
use crate::fill::loops::reserve::room;
use crate::fill::options::Smooth;
use crate::fill::surface::faces::cut;
use crate::fill::surface::sweep::sweep;
use crate::progress::{Clock, Progress};

/// Sweeps over the vertices of quads.
const SWEEPS: usize = 20;

impl Several<'_> {
    /// Quads: triangles of twice the size, cut.
    pub(super) fn quads(&self, border: &Border, clock: &mut Clock, progress: Progress<'_>) -> Result<Shape> {
        let of = |c: &Checked| room(&c.vertices, self.rim, &self.options.polygons);
        let room = self.checked.iter().flat_map(of).collect::<Vec<_>>();
        let halves = Halves::new(border.loops.clone(), &border.at, &room);
        let coarse = border.picked(halves.loops.clone(), &halves.picks);
        let local = self.coarse(border, &coarse, &halves, clock, progress.part(0.0, 0.6))?;
        let Quads { positions, quads, odd } = halves
            .cut(
                &border.at,
                &room,
                &local.positions,
                &local.triangles,
                &border.taken,
                progress.part(0.6, 0.7),
            )?
            .ok_or_else(|| Error::NoPatch {
                reason: "every patch of quads repeats an edge of the mesh".into(),
                at: border.at[0].truncate().to_array(),
            })?;
        clock.stage("quads");
        // A vertex in the middle of each quad: bent, it is the same in all directions.
        let n = positions.len();
        let middle = |q: &[u32; 4]| q.iter().map(|&v| positions[v as usize]).sum::<DVec3>() / 4.0;
        let all = positions.iter().copied().chain(quads.iter().map(middle)).collect();
        let four = |(k, q): (usize, &[u32; 4])| [0, 1, 2, 3].map(|i| [q[i], q[(i + 1) % 4], (n + k) as u32]);
        let centred = quads.iter().enumerate().flat_map(four).chain(odd).collect();
        let mut fine = border.local(all, centred);
        let even = fine.positions.clone();
        if self.options.smooth != Smooth::Flat {
            fine.positions = fair(&fine, &border.beyond, progress.part(0.7, 0.8))?;
            let near = self.near(border, &fine);
            untangle(&mut fine, &even, &near, |_| {}, progress.part(0.8, 0.85))?;
        }
        let at = |v: u32| fine.positions[v as usize];
        let halved = quads.iter().flat_map(|&quad| cut(quad, at)).chain(odd).collect::<Vec<_>>();
        let work = self.patchwork(border, n, &halved)?.of_quads(quads.len());
        let mut shape = self.shape(border, work);
        let around = shape.work.outer.iter().map(|&v| self.vertices[v as usize]);
        let mut swept = fine.positions[..n].iter().copied().chain(around).collect::<Vec<_>>();
        for _ in 0..SWEEPS {
            progress.report(0.85)?;
            sweep(&shape.work, &mut swept);
        }
        shape.positions = self.placed(&shape, &even[..n], &swept[..n], progress.part(0.85, 1.0))?;
        Ok(shape)
    }

    /// Even triangles of twice the size, on the surface of those of the loops' own.
    fn coarse(
        &self,
        border: &Border,
        coarse: &Border,
        halves: &Halves,
        clock: &mut Clock,
        progress: Progress<'_>,
    ) -> Result<Local> {
        let (fine, _) = self.even(border, clock, progress.part(0.0, 0.6))?;
        let Some((positions, triangles)) = halves.coarse(&fine.positions, &fine.triangles) else {
            // Too few triangles between the loops.
            return Ok(self.even(coarse, clock, progress.part(0.6, 1.0))?.0);
        };
        let ground = Ground::of(&fine);
        let mut local = coarse.local(positions, triangles);
        remesh(&mut local, &ground, progress.part(0.6, 0.8))?;
        regularize(&mut local, Some(&ground), progress.part(0.8, 1.0))?;
        Ok(local)
    }
}
