//! How good a patch of quads in the plane is.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::cells::Cells;
use crate::fill::planar::quality::Quality;
use crate::relax::first_inverted;

/// Corners beyond these, in degrees, weigh on a patch.
const LEAST: f64 = 45.0;
const MOST: f64 = 135.0;

/// What a pole costs.
const POLE: f64 = 0.22;

/// What a quad costs that has an edge of the mesh from corner to corner: it lies on a face, and cut in two it may repeat that edge.
const LYING: f64 = 2.0;

/// What a quad too much or too few at each loop vertex costs.
const EXCESS: f64 = 0.6;

/// What it costs that quads are large, see [`Looks::coarse`], beyond what is usual and up to some more: then the
/// patch follows a curved surface less well, and turns more sharply at the loop, than triangles there would.
const COARSE: f64 = 6.0;
const USUAL: f64 = 0.15;
const MOST_COARSE: f64 = 0.3;

/// What makes a patch of quads good or bad, in the plane or in space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Looks {
    /// The least corner of a face, and the greatest of a quad, in radians.
    pub least: f64,
    pub most: f64,
    /// How far corners of quads are from right angles, in the mean.
    pub off: f64,
    /// New vertices of another number of faces than four.
    pub poles: usize,
    /// Faces too many or too few at a loop vertex, in the mean.
    pub excess: f64,
    /// The mean logarithm of the areas of the quads at the loop over the squares on its edges; 0 where it is not known.
    pub coarse: f64,
}

impl Looks {
    /// Less is better.
    pub fn badness(&self) -> f64 {
        EXCESS * self.excess + POLE * self.poles as f64 + self.misshape()
    }

    /// What of it is the shape of the faces.
    pub fn misshape(&self) -> f64 {
        let beyond = |degrees: f64, width: f64| (degrees / width).clamp(0.0, 2.0).powi(2);
        COARSE * (self.coarse - USUAL).clamp(0.0, MOST_COARSE)
            + self.off.to_degrees() / 30.0
            + beyond(LEAST - self.least.to_degrees(), 20.0)
            + beyond(self.most.to_degrees() - MOST, 25.0)
    }
}

pub(super) struct Measured {
    pub quality: Quality,
    /// Less is better; infinite for patches that must not be used.
    pub badness: f64,
}

/// Measures a patch; see [`super::fill_flat_quads`] for `wanted` and `taken`.
pub(super) fn measure(
    positions: &[DVec2],
    cells: &Cells,
    wanted: &[f64],
    taken: &dyn Fn(usize, usize) -> bool,
) -> Measured {
    let n = wanted.len();
    let mut faces = vec![0usize; positions.len()];
    let (mut chords, mut repeated) = (0, 0);
    let mut side = |a: u32, b: u32| {
        let (i, j) = (a as usize, b as usize);
        // Each chord is seen twice, once from either end.
        if i < j && j < n && j - i > 1 && j - i < n - 1 {
            chords += 1;
            repeated += usize::from(taken(i, j));
        }
    };
    let spans = |a: u32, b: u32| {
        let (i, j) = (a.min(b) as usize, a.max(b) as usize);
        j < n && taken(i, j)
    };
    let lying = cells.quads.iter().filter(|q| spans(q[0], q[2]) || spans(q[1], q[3])).count();
    for quad in &cells.quads {
        (0..4).for_each(|k| side(quad[k], quad[(k + 1) % 4]));
        quad.iter().for_each(|&v| faces[v as usize] += 1);
    }
    if let Some(triangle) = &cells.odd {
        (0..3).for_each(|k| side(triangle[k], triangle[(k + 1) % 3]));
        triangle.iter().for_each(|&v| faces[v as usize] += 1);
    }
    let all: Vec<[u32; 3]> = cells.quads.iter().flat_map(corners).chain(cells.odd).collect();
    let centre = positions[..n].iter().sum::<DVec2>() / n as f64;
    let embedded = first_inverted(positions, &all, centre).is_none();
    let Corners { least, most, off, ratio } = Corners::of(positions, cells);
    let count = (4 * cells.quads.len()).max(1) as f64;
    let poles = faces[n..].iter().filter(|&&f| f != 4).count();
    let excess: f64 = wanted.iter().zip(&faces).map(|(w, &f)| (f as f64 - w).abs()).sum();
    let looks = Looks { least, most, off: off / count, poles, excess: excess / n as f64, coarse: 0.0 };
    let badness = if repeated > 0 {
        f64::INFINITY
    } else {
        let folded = if embedded { 0.0 } else { 100.0 };
        folded + LYING * lying as f64 + looks.badness()
    };
    let quality = Quality {
        irregular: poles,
        interior: positions.len() - n,
        excess: excess.round() as usize,
        min_angle: least,
        mean_ratio: ratio / count,
        embedded,
        chords,
        repeated,
    };
    Measured { quality, badness }
}

/// The corners of the faces, in radians.
struct Corners {
    least: f64,
    /// Of quads.
    most: f64,
    /// Sum of how far those of quads are from right angles.
    off: f64,
    /// Sum of the sines of those of quads that are less than straight.
    ratio: f64,
}

impl Corners {
    fn of(positions: &[DVec2], cells: &Cells) -> Corners {
        let (mut least, mut most, mut off, mut ratio) = (PI, 0.0f64, 0.0, 0.0);
        for [a, b, c] in cells.quads.iter().flat_map(corners).map(|c| c.map(|v| positions[v as usize])) {
            let (back, ahead) = (a - b, c - b);
            let angle = libm::atan2(ahead.perp_dot(back), ahead.dot(back));
            // Beyond a straight angle a corner is concave, or its quad inverted.
            let angle = if angle.is_finite() { angle.rem_euclid(2.0 * PI) } else { 2.0 * PI };
            least = least.min(angle);
            most = most.max(angle);
            off += (angle - FRAC_PI_2).abs();
            ratio += libm::sin(angle).max(0.0);
        }
        for [a, b, c] in cells.odd.iter().map(|t| t.map(|v| positions[v as usize])) {
            for (u, v) in [(b - a, c - a), (c - b, a - b), (a - c, b - c)] {
                let angle = libm::atan2(u.perp_dot(v), u.dot(v));
                least = least.min(if angle.is_finite() { angle } else { -1.0 });
            }
        }
        Corners { least, most, off, ratio }
    }
}

/// Each corner of a quad with those beside it.
fn corners(quad: &[u32; 4]) -> impl Iterator<Item = [u32; 3]> {
    let quad = *quad;
    (0..4).map(move |k| [quad[(k + 3) % 4], quad[k], quad[(k + 1) % 4]])
}
