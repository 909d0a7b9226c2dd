//! What a search of boundaries shares: totals of walks, distances tried.

use crate::lattice::grid::Grid;
use crate::path::band::Band;
use crate::path::placement::Laid;
use crate::path::target::Target;
use crate::path::trace::conflicts::Vertex;
use crate::path::trace::contour::Contour;
use crate::path::trace::dive::Dive;
use crate::path::trace::graph::Graph;
use crate::path::trace::outcome::{Refusal, TraceFailure, Traced};
use crate::path::trace::pulse::Pulse;
use crate::path::trace::search::Walk;
use crate::path::trace::straightest;
use crate::progress::Progress;

/// Tries the distance asked for, then a greater one.
pub(super) fn over_distances(
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

pub(super) fn fewest<G: Laid>(targets: &[Target], max_distance: f64, pulse: &mut Pulse<'_>) -> Option<usize> {
    let mut fewest = |target| {
        let graph = Graph::new(&Band::<G>::beside(target, max_distance), 0.0);
        straightest::fewest_turns(&graph, u32::MAX, pulse)
    };
    targets
        .iter()
        .map(|target| Some(fewest(target)).filter(|&turns| turns < u32::MAX).map(|turns| turns as usize))
        .sum()
}

/// The first thing that a dive left.
pub(super) fn failure<G: Grid>(
    dive: &Dive,
    contours: &[Contour<G>],
    walks: &[Walk<G>],
) -> Option<TraceFailure> {
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

pub(super) fn total<G: Grid>(walks: &[Walk<G>]) -> u32 {
    walks.iter().map(|walk| walk.cost).sum()
}

pub(super) fn turns<G: Grid>(walks: &[Walk<G>]) -> usize {
    walks.iter().map(|walk| walk.turns() as usize).sum()
}

pub(super) fn squared_distances<G: Grid>(contours: &[Contour<G>], walks: &[Walk<G>]) -> f64 {
    let squared = |(contour, walk): (&Contour<G>, &Walk<G>)| -> f64 {
        let of = |i| contour.graph.squared[walk.node(i) as usize];
        (0..walk.len()).map(of).sum()
    };
    contours.iter().zip(walks).map(squared).sum()
}

/// Where the distance goes when no boundary is found within the one asked for.
pub(super) const SECOND_DISTANCE: f64 = 2.0;

/// Greatest distance that is looked at.
pub(super) const MOST_DISTANCE: f64 = 4.0;
