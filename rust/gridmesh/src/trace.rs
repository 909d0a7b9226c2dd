//! The optimal boundary: the cheapest closed lattice paths near the drawn contours.
//!
//! Where the paper grows a boundary greedily (section IV-B) and then mends it (IV-D), this takes the
//! best there is: among all closed paths in the [band](crate::band) around each contour the one of
//! least cost, turns plus a little squared distance. It is a shortest path over band nodes and
//! directions. Since nodes belong to stretches of curve, not to places, walls of a narrow part stay
//! apart and no part of the drawing can be lost; but paths of different stretches, or different
//! contours, may get in each other's way. Then [`trace`] prices what conflicts until nothing does.

mod conflicts;
mod dive;
mod graph;
mod half;
mod mirrored;
mod parameters;
mod prices;
mod proof;
mod pulse;
mod queue;
mod search;
mod sides;
mod straightest;

#[cfg(test)]
mod oracle;

use std::fmt;

use crate::axial::Axial;
use crate::band::Band;
use crate::error::Error;
use crate::lattice::Lattice;
use crate::progress::Progress;
use crate::target::Target;

use conflicts::Vertex;
use dive::{Contour, Dive};
use graph::{Graph, TURN};
pub use mirrored::{Part, trace_mirrored};
use prices::Prices;
use proof::Proof;
use pulse::Pulse;
use search::{Search, Walk};

/// Where the distance goes when no boundary is found within the one asked for.
const SECOND_DISTANCE: f64 = 2.0;
/// Greatest distance that is looked at.
const MOST_DISTANCE: f64 = 4.0;

/// With more conflicts left than one for so many vertices no greater distance is tried.
const HOPELESS: usize = 4;
/// A proof is tried unasked if there was at first at most one conflict for so many vertices.
const QUICK_SHARE: usize = 10;

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

/// The cheapest closed lattice paths along the targets that bound a chord-free patch together.
///
/// `targets[0]` is the outline and runs counter-clockwise, the others are holes and run clockwise.
/// First each contour gets its cheapest path: a shortest path over (band node, direction), found
/// with a lower bound from every state to the end. If the paths conflict, by a repeated point or an
/// edge inside the patch between two vertices, the conflicts are priced and the paths searched
/// again, at most 100 rounds and a bounded number of states; then Lagrange prices, and as far as `proof_nodes` allows branch and
/// bound, improve the result and the lower bound. If no boundary is found within `max_distance` a
/// distance of 2 is tried.
///
/// The paths are simple and disjoint, their turns add up to 6 (the outline) and -6 (holes), all
/// edges have the patch on their left, and no edge inside joins two vertices. Equal input gives
/// equal output. O(n log n) in the total length in edges if there are no conflicts.
///
/// # Errors
/// [`TraceFailure`] says what stood in the way last, and where: usually the lattice is too coarse
/// for the drawing there (a chord-free patch has at least `2 b - 6` triangles for `b` boundary
/// vertices).
pub fn trace(
    targets: &[Target],
    options: &TraceOptions,
    progress: Progress<'_>,
) -> Result<Traced, TraceFailure> {
    over_distances(options.max_distance, progress, |distance, progress| {
        attempt(targets, options, distance, progress)
    })
}

/// Tries the distance asked for, then a greater one.
fn over_distances(
    max_distance: f64,
    progress: Progress<'_>,
    mut attempt: impl FnMut(f64, Progress<'_>) -> Result<Traced, Refusal>,
) -> Result<Traced, TraceFailure> {
    let first = max_distance.min(MOST_DISTANCE);
    let result = match attempt(first, progress.part(0.0, 0.5)) {
        Err(refusal) if !refusal.is_final && first < SECOND_DISTANCE => {
            attempt(SECOND_DISTANCE, progress.part(0.5, 1.0))
        }
        result => result,
    };
    result.map_err(|refusal| refusal.failure)
}

/// Why there is no boundary at one distance, and whether there is no use in trying a greater one.
struct Refusal {
    failure: TraceFailure,
    is_final: bool,
}

impl Refusal {
    /// Many conflicts at one distance are not solved at a greater one.
    fn new(failure: TraceFailure, dive: &Dive, walks: &[Walk]) -> Self {
        let vertices: usize = walks.iter().map(Walk::len).sum();
        let is_final = HOPELESS * (dive.conflicts.len() + dive.wrong.len()) > vertices;
        Self { failure, is_final }
    }

    /// Final also if the search has been at it for too long.
    fn or_final(self, is_spent: bool) -> Self {
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

/// No closed lattice paths near the targets turn less often than this: the fewest turns regardless of
/// distances and conflicts. `None` if there are no paths.
///
/// `max_distance` is the one that was used. O(n) in the total length in edges.
pub fn fewest_turns(targets: &[Target], max_distance: f64) -> Option<usize> {
    fewest(targets, max_distance, &mut Pulse::new(Progress::NONE))
}

fn fewest(targets: &[Target], max_distance: f64, pulse: &mut Pulse<'_>) -> Option<usize> {
    let mut fewest = |target| {
        let graph = Graph::new(&Band::new(target, max_distance), 0.0);
        straightest::fewest_turns(&graph, u32::MAX, pulse)
    };
    targets
        .iter()
        .map(|target| Some(fewest(target)).filter(|&turns| turns < u32::MAX).map(|turns| turns as usize))
        .sum()
}

fn attempt(
    targets: &[Target],
    options: &TraceOptions,
    max_distance: f64,
    progress: Progress<'_>,
) -> Result<Traced, Refusal> {
    let mut search = Search::new(Pulse::new(progress));
    let result = attempt_with(&mut search, targets, options, max_distance, progress);
    if search.pulse.is_stopped() { Err(TraceFailure::Cancelled.into()) } else { result }
}

fn attempt_with(
    search: &mut Search<'_>,
    targets: &[Target],
    options: &TraceOptions,
    max_distance: f64,
    progress: Progress<'_>,
) -> Result<Traced, Refusal> {
    let (contours, roots) = relaxed(targets, options, max_distance, search, progress)?;
    search.pulse.limit(contours.iter().map(|contour| contour.graph.n_states()).sum());
    let none = |contour: &Contour| Prices::none(contour.graph.n_nodes());
    let mut prices: Vec<Prices> = contours.iter().map(none).collect();
    let mut walks = roots.clone();
    let share = progress.part(0.3, 0.7);
    let mut dive = dive::dive(&contours, &mut walks, &mut prices, search, share)?;
    let first_conflicts = dive.first;
    if failure(&dive, &contours, &walks).is_some() {
        dive::keep_apart(&contours, &mut walks, &mut prices, search);
        let rounds = dive.rounds;
        dive = dive::dive(&contours, &mut walks, &mut prices, search, share)?;
        dive.rounds += rounds;
    }
    if let Some(failure) = failure(&dive, &contours, &walks) {
        let refusal = Refusal::new(failure, &dive, &walks);
        return Err(refusal.or_final(search.pulse.is_spent()));
    }
    let best = total(&walks);
    let root = total(&roots);
    let mut proof = Proof { bound: root, walks: None, optimal: root == best };
    // Unasked only where it is not far.
    let is_near = first_conflicts * QUICK_SHARE <= walks.iter().map(Walk::len).sum();
    search.pulse.unlimit();
    if dive.rounds > 0 && (options.proof_nodes > 0 || is_near) {
        let share = progress.part(0.7, 1.0);
        let nodes = options.proof_nodes;
        proof = proof::prove(&contours, &roots, best, nodes, search, share)?;
    }
    if let Some(better) = proof.walks {
        walks = better;
    }
    progress.report(1.0)?;
    let turns_bound = contours
        .iter()
        .zip(&roots)
        .map(|(contour, root)| {
            straightest::fewest_turns(&contour.graph, root.turns(), &mut search.pulse) as usize
        })
        .sum();
    let turns = turns(&walks);
    let cost = turns as f64 + options.closeness * squared_distances(&contours, &walks);
    let bound = f64::from(proof.bound) / f64::from(TURN);
    Ok(Traced {
        cost,
        cost_bound: if proof.optimal { cost } else { bound.min(cost) },
        turns,
        turns_bound,
        optimal: proof.optimal,
        max_distance_used: max_distance,
        rounds: dive.rounds,
        paths: contours
            .iter()
            .zip(&walks)
            .map(|(Contour { graph, .. }, walk)| Path {
                points: walk.points(graph).collect(),
                parameters: parameters::parameters(graph, walk),
            })
            .collect(),
    })
}

/// What each contour is searched on, and its cheapest path regardless of conflicts.
fn relaxed(
    targets: &[Target],
    options: &TraceOptions,
    max_distance: f64,
    search: &mut Search<'_>,
    progress: Progress<'_>,
) -> Result<(Vec<Contour>, Vec<Walk>), TraceFailure> {
    let mut contours = Vec::with_capacity(targets.len());
    let mut walks = Vec::with_capacity(targets.len());
    for (i, target) in targets.iter().enumerate() {
        progress.report(0.3 * i as f64 / targets.len() as f64)?;
        let graph = Graph::new(&Band::new(target, max_distance), options.closeness);
        let potential = search.potential(&graph);
        let prices = Prices::none(graph.n_nodes());
        let Some((walk, _)) = search.closed(&graph, &potential, &prices, u32::MAX) else {
            let some = target.points.first().copied().unwrap_or_default();
            return Err(TraceFailure::NoPath { contour: i, at: Lattice::nearest(some) });
        };
        contours.push(Contour { graph, potential });
        walks.push(walk);
    }
    Ok((contours, walks))
}

/// The first thing that a dive left.
fn failure(dive: &Dive, contours: &[Contour], walks: &[Walk]) -> Option<TraceFailure> {
    let point = |v: Vertex| {
        let node = walks[v.contour as usize].node(v.index as usize);
        contours[v.contour as usize].graph.points[node as usize]
    };
    if let Some(conflict) = dive.conflicts.first() {
        let contours = [conflict.a, conflict.b].map(|v| v.contour as usize);
        return Some(match conflict.chord {
            Some(_) => TraceFailure::Chord { contours, between: [conflict.a, conflict.b].map(point) },
            None => TraceFailure::Repeated { contours, at: point(conflict.a) },
        });
    }
    dive.wrong
        .first()
        .map(|&vertex| TraceFailure::WrongSide { contour: vertex.contour as usize, at: point(vertex) })
}

fn total(walks: &[Walk]) -> u32 {
    walks.iter().map(|walk| walk.cost).sum()
}

fn turns(walks: &[Walk]) -> usize {
    walks.iter().map(|walk| walk.turns() as usize).sum()
}

fn squared_distances(contours: &[Contour], walks: &[Walk]) -> f64 {
    let squared = |(contour, walk): (&Contour, &Walk)| -> f64 {
        let of = |i| contour.graph.squared[walk.node(i) as usize];
        (0..walk.len()).map(of).sum()
    };
    contours.iter().zip(walks).map(squared).sum()
}
