//! The optimal boundary: the cheapest closed lattice paths near the drawn contours.
//!
//! Where the paper grows a boundary greedily (section IV-B) and then mends it (IV-D), this takes the
//! best there is: among all closed paths in the [band](crate::path::band) around each contour the one of
//! least cost, turns plus a little squared distance. It is a shortest path over band nodes and
//! directions. Since nodes belong to stretches of curve, not to places, walls of a narrow part stay
//! apart and no part of the drawing can be lost; but paths of different stretches, or different
//! contours, may get in each other's way. Then [`trace`] prices what conflicts until nothing does.

mod conflicts;
mod contour;
mod dive;
mod graph;
mod half;
mod mirrored;
#[cfg(test)]
mod oracle;
pub(crate) mod outcome;
mod parameters;
mod prices;
mod proof;
mod pulse;
mod queue;
mod search;
mod sides;
mod straightest;
mod totals;

use crate::lattice::grid::Triangular;
use crate::path::band::Band;
use crate::path::placement::Laid;
use crate::path::target::Target;
use crate::path::trace::contour::Contour;
use crate::path::trace::outcome::Refusal;
pub use crate::path::trace::outcome::{Path, TraceFailure, TraceOptions, Traced};
use crate::path::trace::totals::{failure, fewest, over_distances, squared_distances, total, turns};
use crate::progress::Progress;
use graph::{Graph, TURN};
pub use mirrored::{Part, trace_mirrored};
use prices::Prices;
use proof::Proof;
use pulse::Pulse;
use search::{Search, Walk};

/// Even with `proof_nodes` 0 a proof is tried if the first solution has at most one conflict per this many vertices.
const QUICK_SHARE: usize = 10;

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
    trace_on::<Triangular>(targets, options, progress)
}

/// As [`trace`](trace()), on either kind of grid: on squares the paths are simple, disjoint and turn by
/// 90 degrees at most, and edges inside may join two of their vertices.
///
/// # Errors
/// As [`trace`](trace()).
pub fn trace_on<G: Laid>(
    targets: &[Target],
    options: &TraceOptions,
    progress: Progress<'_>,
) -> Result<Traced, TraceFailure> {
    over_distances(options.max_distance, progress, |distance, progress| {
        attempt::<G>(targets, options, distance, progress)
    })
}

/// No closed lattice paths near the targets turn less often than this: the fewest turns regardless of
/// distances and conflicts. `None` if there are no paths.
///
/// `max_distance` is the one that was used. O(n) in the total length in edges.
pub fn fewest_turns(targets: &[Target], max_distance: f64) -> Option<usize> {
    fewest::<Triangular>(targets, max_distance, &mut Pulse::new(Progress::NONE))
}

fn attempt<G: Laid>(
    targets: &[Target],
    options: &TraceOptions,
    max_distance: f64,
    progress: Progress<'_>,
) -> Result<Traced, Refusal> {
    let mut search = Search::new(Pulse::new(progress));
    let result = attempt_with::<G>(&mut search, targets, options, max_distance, progress);
    if search.pulse.is_stopped() { Err(TraceFailure::Cancelled.into()) } else { result }
}

fn attempt_with<G: Laid>(
    search: &mut Search<'_>,
    targets: &[Target],
    options: &TraceOptions,
    max_distance: f64,
    progress: Progress<'_>,
) -> Result<Traced, Refusal> {
    let (contours, roots) = relaxed::<G>(targets, options, max_distance, search, progress)?;
    search.pulse.limit(contours.iter().map(|contour| contour.graph.n_states()).sum());
    let none = |contour: &Contour<G>| Prices::none(contour.graph.n_nodes());
    let mut prices: Vec<Prices> = contours.iter().map(none).collect();
    let mut walks = roots.clone();
    let share = progress.part(0.3, 0.7);
    let is_hasty = search.pulse.is_hasty();
    // In haste only what begins with fewer conflicts is tried where there are many.
    let is_settled = is_hasty && dive::begin_crowded(&contours, &mut walks, &mut prices, search, share)?;
    let mut dive = dive::dive(&contours, &mut walks, &mut prices, search, share)?;
    let first_conflicts = dive.first;
    if !is_settled && failure(&dive, &contours, &walks).is_some() {
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
    // Unasked only where it is not far, and not in haste.
    let is_near = first_conflicts * QUICK_SHARE <= walks.iter().map(Walk::len).sum();
    search.pulse.unlimit();
    if !is_hasty && dive.rounds > 0 && (options.proof_nodes > 0 || is_near) {
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

/// Contours, and a path for each.
type Walks<G> = (Vec<Contour<G>>, Vec<Walk<G>>);

/// What each contour is searched on, and its cheapest path regardless of conflicts.
fn relaxed<G: Laid>(
    targets: &[Target],
    options: &TraceOptions,
    max_distance: f64,
    search: &mut Search<'_>,
    progress: Progress<'_>,
) -> Result<Walks<G>, TraceFailure> {
    let mut contours = Vec::with_capacity(targets.len());
    let mut walks = Vec::with_capacity(targets.len());
    for (i, target) in targets.iter().enumerate() {
        progress.report(0.3 * i as f64 / targets.len() as f64)?;
        let graph = Graph::new(&Band::<G>::beside(target, max_distance), options.closeness);
        let potential = search.potential(&graph);
        let prices = Prices::none(graph.n_nodes());
        let Some((walk, _)) = search.closed(&graph, &potential, &prices, u32::MAX) else {
            let some = target.points.first().copied().unwrap_or_default();
            return Err(TraceFailure::NoPath { contour: i, at: G::nearest(some) });
        };
        contours.push(Contour { graph, potential });
        walks.push(walk);
    }
    Ok((contours, walks))
}
