//! What a path can be asked for, what comes of it, and why there may be none.

use std::fmt;

use crate::error::Error;
use crate::lattice::axial::Axial;
use crate::lattice::grid::Grid;
use crate::path::trace::dive::Dive;
use crate::path::trace::search::Walk;

/// What a boundary should be like.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceOptions {
    /// Greatest distance of a lattice path from its contour's target, in edges; the target is
    /// within 0.3 more of the path. Below about 1.25 narrow parts have no boundary; more than 4
    /// counts as 4.
    pub max_distance: f64,
    /// Price of a squared distance of one edge, in turns; 0.05 gives the straightest boundaries,
    /// 1 the closest ones. At most 100.
    pub closeness: f64,
    /// Greatest number of parts of the search space that a proof of optimality looks at; 0 for a
    /// quick try only.
    pub proof_nodes: usize,
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self { max_distance: 1.5, closeness: 0.3, proof_nodes: 0 }
    }
}

/// The lattice path of one contour.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The vertices, closed, with the patch on the left: counter-clockwise for the outline,
    /// clockwise for holes.
    pub points: Vec<Axial>,
    /// For each vertex where it belongs on its target, in samples: strictly increasing, the last
    /// less than one turn after the first.
    pub parameters: Vec<f64>,
}

/// Lattice paths that bound a patch, and how good they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// One path for each contour, in their order.
    pub paths: Vec<Path>,
    /// Turns plus closeness times squared distances, in turns.
    pub cost: f64,
    /// No boundary at this distance costs less (to 1/2048 of a turn per vertex, the precision of the
    /// search).
    pub cost_bound: f64,
    /// Number of turns by 60 degrees; turns by 120 count twice. The paper's `err_dc`.
    pub turns: usize,
    /// No boundary at this distance turns less often: the fewest turns regardless of distances and
    /// conflicts.
    pub turns_bound: usize,
    /// The paths are proved to be the cheapest.
    pub optimal: bool,
    /// The distance that was allowed: `max_distance`, or 2 if there was no boundary within it.
    pub max_distance_used: f64,
    /// Number of rounds of conflict pricing.
    pub rounds: usize,
}

/// Why there is no boundary. The places are lattice points.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TraceFailure {
    /// The caller asked to stop.
    Cancelled,
    /// No closed lattice path goes round a contour.
    NoPath {
        /// The contour.
        contour: usize,
        /// A point near it.
        at: Axial,
    },
    /// Two walls want the same lattice point.
    Repeated {
        /// The contours of the walls.
        contours: [usize; 2],
        /// The point.
        at: Axial,
    },
    /// An edge across the inside joins two walls.
    Chord {
        /// The contours of the walls.
        contours: [usize; 2],
        /// The ends of the edge.
        between: [Axial; 2],
    },
    /// A path has the patch on its wrong side.
    WrongSide {
        /// The contour.
        contour: usize,
        /// A vertex where it does.
        at: Axial,
    },
}

impl TraceFailure {
    /// The lattice point where it fails.
    pub fn at(&self) -> Option<Axial> {
        match self {
            TraceFailure::Cancelled => None,
            TraceFailure::NoPath { at, .. }
            | TraceFailure::Repeated { at, .. }
            | TraceFailure::WrongSide { at, .. }
            | TraceFailure::Chord { between: [at, _], .. } => Some(*at),
        }
    }
}

impl fmt::Display for TraceFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TraceFailure::Cancelled => write!(f, "cancelled"),
            TraceFailure::NoPath { .. } => {
                write!(f, "no lattice path goes round a contour this small")
            }
            TraceFailure::Repeated { .. } => {
                write!(f, "two walls are too close together to pass each other")
            }
            TraceFailure::Chord { .. } => {
                write!(f, "a part is too narrow for two rows of triangles")
            }
            TraceFailure::WrongSide { .. } => write!(f, "a contour is too thin to have an inside"),
        }
    }
}

impl std::error::Error for TraceFailure {}

impl From<Error> for TraceFailure {
    /// Progress reports fail for one reason only.
    fn from(_: Error) -> Self {
        TraceFailure::Cancelled
    }
}

/// Why there is no boundary at one distance, and whether there is no use in trying a greater one.
pub(crate) struct Refusal {
    pub(crate) failure: TraceFailure,
    pub(crate) is_final: bool,
}

impl Refusal {
    /// Many conflicts at one distance are not solved at a greater one.
    pub(super) fn new<G: Grid>(failure: TraceFailure, dive: &Dive, walks: &[Walk<G>]) -> Self {
        let vertices: usize = walks.iter().map(Walk::len).sum();
        let is_final = HOPELESS * (dive.conflicts.len() + dive.wrong.len()) > vertices;
        Self { failure, is_final }
    }

    /// Final also if the search has been at it for too long.
    pub(crate) fn or_final(self, is_spent: bool) -> Self {
        Self { is_final: self.is_final || is_spent, ..self }
    }
}

impl From<TraceFailure> for Refusal {
    fn from(failure: TraceFailure) -> Self {
        let is_final = failure == TraceFailure::Cancelled;
        Self { failure, is_final }
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        TraceFailure::from(error).into()
    }
}

/// With more conflicts left than one for so many vertices no greater distance is tried.
pub(crate) const HOPELESS: usize = 4;
