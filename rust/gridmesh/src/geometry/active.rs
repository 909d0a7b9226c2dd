//! Vertices visited round by round, as long as they or their neighbours move.

use std::f64::consts::FRAC_PI_4;
use std::ops::Range;

use crate::error::Result;
use crate::progress::Progress;

/// Vertices between two questions whether to go on.
pub(crate) const ASK_EVERY: usize = 1 << 11;

/// What became of a vertex.
pub(crate) enum Visit {
    /// It is left alone until a neighbour says that it was moved.
    Done,
    /// It has no better place yet: it is visited again, until it has had none for some rounds.
    Stuck,
    /// It was moved, or a neighbour for its sake: it and its neighbours are visited again.
    Moved,
}

/// How long to go on.
pub(crate) struct Rounds {
    /// Rounds in all.
    pub most: usize,
    /// Rounds in which a vertex is stuck, since it or a neighbour last moved.
    pub stuck: u8,
}

/// Visits vertices in the order of their numbers, then those of them that are to be visited again. `near`: their
/// neighbours, each as often as it likes. `visit` takes the vertex and the round.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(crate) fn visit_active<I: Iterator<Item = u32>>(
    vertices: Range<usize>,
    near: impl Fn(usize) -> I,
    rounds: Rounds,
    progress: Progress<'_>,
    mut visit: impl FnMut(usize, usize) -> Visit,
) -> Result<()> {
    let mut active: Vec<u32> = (vertices.start as u32..vertices.end as u32).collect();
    let mut left = vec![rounds.stuck; vertices.len()];
    for round in 0..rounds.most {
        let mut next = vec![];
        for (k, &v) in active.iter().enumerate() {
            if k % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
            match visit(v as usize, round) {
                Visit::Done => {}
                Visit::Stuck => {
                    let left = &mut left[v as usize - vertices.start];
                    *left = left.saturating_sub(1);
                    if *left > 0 {
                        next.push(v);
                    }
                }
                Visit::Moved => {
                    for u in near(v as usize).chain([v]).filter(|&u| vertices.contains(&(u as usize))) {
                        left[u as usize - vertices.start] = rounds.stuck;
                        next.push(u);
                    }
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

/// The eight directions that are tried in a round, as sine and cosine; those of the round asked for last are kept.
pub(crate) struct Directions {
    round: usize,
    of_round: [(f64, f64); 8],
}

impl Directions {
    pub fn new() -> Self {
        Self { round: 0, of_round: Self::made(0) }
    }

    pub fn of(&mut self, round: usize) -> &[(f64, f64); 8] {
        if round != self.round {
            *self = Self { round, of_round: Self::made(round) };
        }
        &self.of_round
    }

    fn made(round: usize) -> [(f64, f64); 8] {
        std::array::from_fn(|k| libm::sincos(k as f64 * FRAC_PI_4 + turn(round)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_those_of_the_round_asked_for() {
        let mut directions = Directions::new();
        for round in [0, 3, 3, 1, 0] {
            assert_eq!(*directions.of(round), Directions::made(round));
        }
    }
}
