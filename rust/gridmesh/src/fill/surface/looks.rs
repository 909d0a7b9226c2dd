//! How good a patch of quads is in space.

use glam::DVec3;

use super::fit::{Faults, Solved, seam_angle};
use super::patchwork::Patchwork;
use crate::fill::planar::quads::measure::Looks;

/// What a fault costs, against what else is bad about a patch: that it meets something, is a film, or folds.
const FAULT: f64 = 10.0;

/// What a radian costs, the root mean square of the angles across the loop's edges.
const ROUGH: f64 = 5.0;

/// How bad a patch of quads is in space; less is better.
#[derive(Clone, Copy, Debug)]
pub(in crate::fill) struct Worth {
    /// The shape of its faces.
    pub misshape: f64,
    /// With what is wrong at the loop and elsewhere.
    pub badness: f64,
    /// New vertices of another number of faces than four.
    pub poles: usize,
}

impl Worth {
    /// Of a solved patch for one loop with room for so many right angles at each of its vertices.
    pub fn of(work: &Patchwork, solved: &Solved, room: &[f64]) -> Worth {
        let looks = work.looks(&solved.positions, room);
        let Faults { meetings, film, folds } = solved.faults;
        let faults = [meetings > 0, film, folds > 0].into_iter().filter(|&is| is).count();
        let rough = ROUGH * seam_angle(work, &solved.positions);
        let badness = looks.badness() + rough + FAULT * faults as f64;
        Worth { misshape: looks.misshape(), badness, poles: looks.poles }
    }
}

impl Patchwork {
    fn looks(&self, positions: &[DVec3], room: &[f64]) -> Looks {
        let at = |v: u32| positions[v as usize];
        let faces = self.faces_at();
        let [least, most] = self.corner_range(positions);
        let (mut off, mut corners) = (0.0, 0.0);
        let (mut coarse, mut edges) = (0.0, 0.0);
        for quad in self.quads() {
            let p = quad.map(at);
            let area = 0.5 * (p[2] - p[0]).cross(p[3] - p[1]).length();
            for k in 0..4 {
                let (back, ahead) = (p[(k + 3) % 4] - p[k], p[(k + 1) % 4] - p[k]);
                let angle = libm::atan2(ahead.cross(back).length(), ahead.dot(back));
                off += (angle - std::f64::consts::FRAC_PI_2).abs();
                corners += 1.0;
                let (a, b) = (quad[k] as usize, quad[(k + 1) % 4] as usize);
                let squared = ahead.length_squared();
                if a < self.n && b == self.after(a) && squared > 0.0 && area > 0.0 {
                    coarse += libm::log(area / squared);
                    edges += 1.0;
                }
            }
        }
        let excess = room.iter().zip(&faces).map(|(room, &f)| (f as f64 - room).abs()).sum::<f64>();
        Looks {
            least,
            most,
            off: off / f64::max(corners, 1.0),
            poles: self.inner().filter(|&v| faces[v] != 4).count(),
            excess: excess / room.len().max(1) as f64,
            coarse: coarse / f64::max(edges, 1.0),
        }
    }
}
