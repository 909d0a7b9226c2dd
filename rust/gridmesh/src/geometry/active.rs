//! Vertices visited round by round, as long as they or their neighbours move.

use crate::error::Result;
use crate::geometry::topology::Topology;
use crate::progress::Progress;

/// Vertices between two questions whether to go on.
pub(crate) const ASK_EVERY: usize = 1 << 11;

/// What became of a vertex.
pub(crate) enum Visit {
    /// It is left alone until a neighbour moves.
    Done,
    /// It has no better place yet, and is visited again.
    Stuck,
    /// It was moved: it and its neighbours are visited again.
    Moved,
}

/// Visits the vertices from `first` on in the order of their numbers, then those of them that are to be visited again, for
/// `rounds` at most. `visit` takes the vertex and the round.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(crate) fn visit_active(
    topology: &Topology,
    first: usize,
    rounds: usize,
    progress: Progress<'_>,
    mut visit: impl FnMut(usize, usize) -> Visit,
) -> Result<()> {
    let mut active: Vec<u32> = (first as u32..topology.start.len() as u32 - 1).collect();
    for round in 0..rounds {
        let mut next = vec![];
        for (k, &v) in active.iter().enumerate() {
            if k % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
            match visit(v as usize, round) {
                Visit::Done => {}
                Visit::Stuck => next.push(v),
                Visit::Moved => {
                    let near = &topology.near[topology.range(v as usize)];
                    next.extend(near.iter().copied().filter(|&u| u as usize >= first));
                    next.push(v);
                }
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

/// How far the directions that are tried are turned in a round, in radians.
pub(crate) fn turn(round: usize) -> f64 {
    0.3 * round as f64
}
