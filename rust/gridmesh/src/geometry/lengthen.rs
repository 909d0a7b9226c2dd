//! Short edges made longer by moving vertices apart: what flat patches and bodies have in common.

use crate::error::Result;
use crate::geometry::topology::Topology;
use crate::progress::Progress;

/// Cotangents of the angles, 28, 20, 14 and 9 degrees, below which corners do not fall for longer edges: one for each
/// stage, in which what the one before left is tried.
pub(crate) const THIN: [f64; 4] =
    [1.880_726_465_346_332, 2.747_477_419_454_622, 4.010_780_933_535_845, 6.313_751_514_675_043];

/// Rounds of a stage over all vertices with short edges, at most.
const ROUNDS: usize = 24;

/// How far the directions of moves are turned from round to round, in radians.
const TURN: f64 = 0.3;

/// Vertices between two questions whether to go on.
const ASK_EVERY: usize = 1 << 11;

/// What became of a vertex.
pub(crate) enum Visit {
    /// No edge at it is short.
    Long,
    /// Edges at it are short, and it has no better place.
    Stuck,
    /// It was moved, and may be moved again; its neighbours may have to give way.
    Moved,
}

/// What an edge of this length lacks: the square of its share of the length wanted. So that where edges are crowded
/// all of them give way.
pub(crate) fn lack(length: f64, wanted: f64) -> f64 {
    (1.0 - length / wanted).max(0.0).powi(2)
}

/// Visits the vertices from `first` on, in the order of their numbers, then those that are stuck or were moved and
/// their neighbours, until none is left. `visit` takes the vertex and the turn of the directions to try.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(crate) fn visit_crowded(
    topology: &Topology,
    first: usize,
    progress: Progress<'_>,
    mut visit: impl FnMut(usize, f64) -> Visit,
) -> Result<()> {
    let mut active: Vec<u32> = (first as u32..topology.start.len() as u32 - 1).collect();
    for round in 0..ROUNDS {
        let mut next = vec![];
        for (k, &v) in active.iter().enumerate() {
            if k % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
            let visited = visit(v as usize, TURN * round as f64);
            if matches!(visited, Visit::Moved) {
                let near = &topology.near[topology.range(v as usize)];
                next.extend(near.iter().copied().filter(|&u| u as usize >= first));
            }
            if !matches!(visited, Visit::Long) {
                next.push(v);
            }
        }
        next.sort_unstable();
        next.dedup();
        if next.is_empty() {
            break;
        }
        active = next;
    }
    Ok(())
}
