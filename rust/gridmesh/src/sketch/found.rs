//! A patch on one lattice, and what speaks against it.

use std::cell::OnceCell;
use std::sync::Arc;

use crate::bend::Bent;
use crate::options::CellShape;
use crate::patch::angles::{min_angle, min_angle_off_corners};
use crate::patch::placed::Placed;
use crate::patch::sizes::longest_over_median;
use crate::path::outline::Outline;
use crate::path::placement::Lattice;

/// Faults of a patch on a bent lattice up to which no straight one is tried.
const SLIGHT: f64 = 0.1;

/// What a fault of one costs, in turns, where a bent lattice is compared with a straight one.
const TURNS_OF_FAULT: f64 = 12.0;

/// Where a patch on a bent lattice has corners below this angle, 20 degrees, others are placed too.
const GOOD_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// So many turns it outweighs that an angle is zero.
const TURNS_OF_ANGLE: f64 = 16.0;

/// A corner of the drawing that the mesh cuts off is worth so many turns: more than the lattices differ by.
const TURNS_OF_CORNER: f64 = 12.0;

/// The same of quads, of which a straight lattice has a dozen turns more and spoils the flow of all edges for it.
const TURNS_OF_CORNER_OF_QUADS: f64 = 4.0;

/// So many of them; the others together no more than as many again. A rugged coast has dozens of corners finer than its mesh, and
/// which of them are lost on a lattice is chance; counted each they would decide on it alone.
const FEW_CORNERS: usize = 4;

/// The longest edges may be so many times the median. Chosen looking at outlines of icons whose longest edges were 2.5 to
/// 3.5 medians: parts of some had lost their shape.
const LONG: f64 = 2.4;

/// So many turns each median beyond it costs.
const TURNS_OF_LENGTH: f64 = 20.0;

/// The same for quads, whose sizes vary more, and each turn of which is two poles on either side: tips of a few large quads are worth
/// one or two turns.
const LONG_OF_QUADS: (f64, f64) = (3.0, 8.0);

/// Where one edge in a hundred is longer than so many medians, each median beyond costs so many turns more: with
/// triangles no drawing shall have 2.5.
const MANY_LONG: (f64, f64) = (2.4, 150.0);

/// What corners that the mesh cuts off cost, in turns.
fn price_of_corners(worn: usize, cells: CellShape) -> f64 {
    let turns = match cells {
        CellShape::Triangle => TURNS_OF_CORNER,
        CellShape::Quad => TURNS_OF_CORNER_OF_QUADS,
    };
    let few = worn.min(FEW_CORNERS);
    let (most, more) = (FEW_CORNERS as f64, (worn - few) as f64);
    turns * (few as f64 + most * more / (most + more))
}

/// A patch on one lattice, and how far it is from being good enough.
pub(crate) struct Found {
    pub(crate) faults: f64,
    /// The map and the straight lattice of the bent plane; none on a straight lattice.
    pub(crate) bent: Option<(Arc<Bent>, Lattice)>,
    pub(crate) outline: Outline,
    pub(crate) placed: Placed,
    pub(crate) mirror_error: Option<f64>,
    starved: OnceCell<f64>,
    overlong: OnceCell<f64>,
}

impl Found {
    pub(crate) fn new(
        bent: Option<(Arc<Bent>, Lattice)>,
        outline: Outline,
        placed: Placed,
        mirror_error: Option<f64>,
    ) -> Self {
        let (starved, overlong) = (OnceCell::new(), OnceCell::new());
        Self { faults: faults(&placed), bent, outline, placed, mirror_error, starved, overlong }
    }

    /// How far the least angle is from a good one: 0 to 1.
    fn starved(&self) -> f64 {
        *self.starved.get_or_init(|| self.measured_starved())
    }

    /// What the longest edges of a bent lattice cost in turns, see [`LONG`]; those of a straight one nothing.
    fn overlong(&self) -> f64 {
        *self.overlong.get_or_init(|| self.measured_overlong())
    }

    fn measured_starved(&self) -> f64 {
        let patch = &self.placed.patch;
        // At a corner of the drawing two quads share its angle on any lattice.
        let least = match patch.cells() {
            CellShape::Triangle => min_angle(patch),
            CellShape::Quad => min_angle_off_corners(patch),
        };
        (1.0 - least / GOOD_ANGLE).max(0.0)
    }

    fn measured_overlong(&self) -> f64 {
        let patch = &self.placed.patch;
        match &self.bent {
            Some((bent, _)) if !bent.is_sized() => {
                let (longest, long) = longest_over_median(patch);
                match patch.cells() {
                    CellShape::Triangle => {
                        let (most, turns) = MANY_LONG;
                        let few = TURNS_OF_LENGTH * (longest - LONG).max(0.0);
                        few + turns * (long - most).max(0.0)
                    }
                    CellShape::Quad => {
                        let (most, turns) = LONG_OF_QUADS;
                        turns * (longest - most).max(0.0)
                    }
                }
            }
            _ => 0.0,
        }
    }

    /// True if more than one edge in a hundred is too long for a bend of triangles, see [`MANY_LONG`].
    pub(crate) fn is_uneven(&self) -> bool {
        self.overlong() > 0.0 && longest_over_median(&self.placed.patch).1 > MANY_LONG.0
    }

    /// Cost, faults, starved triangles, long edges and lost corners in turns.
    pub(crate) fn score(&self) -> f64 {
        let price = self.bent.as_ref().map_or(0.0, |(bent, _)| bent.price);
        let corners = price_of_corners(self.placed.worn.len(), self.placed.patch.cells());
        let shape = TURNS_OF_FAULT * self.faults + TURNS_OF_ANGLE * self.starved();
        self.outline.cost + price + shape + self.overlong() + corners
    }

    /// The same beside other bends, where coarse limbs count too.
    pub(crate) fn score_of_bent(&self) -> f64 {
        self.score() + self.bent.as_ref().map_or(0.0, |(bent, _)| bent.price_of_limbs)
    }

    /// True if neither another bend nor, where it turns little, a straight lattice needs to be tried.
    pub(crate) fn is_good(&self) -> bool {
        self.faults <= SLIGHT
            && self.starved() == 0.0
            && self.overlong() == 0.0
            && self.placed.worn.is_empty()
    }

    /// True if a part of the drawing is lost in the mesh.
    pub(crate) fn lost(&self) -> bool {
        self.placed.lost() > 0
    }
}

/// How far a placement is from being good enough: zero if it is.
fn faults(placed: &Placed) -> f64 {
    let (angle, distance) = ENOUGH;
    let starved = (1.0 - min_angle_off_corners(&placed.patch) / angle).max(0.0);
    // A patch that has lost a part of the drawing serves only to say where.
    let lost = 100.0 * placed.lost() as f64;
    lost + 4.0 * starved + (placed.strayed - distance).max(0.0)
}

/// A placement whose triangles have this angle, 14 degrees, away from drawn corners, and which lies
/// this close to the drawing, in edges, is good enough not to try another lattice angle.
const ENOUGH: (f64, f64) = (14.0 * std::f64::consts::PI / 180.0, 1.0);
