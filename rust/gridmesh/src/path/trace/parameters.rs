//! Boundary vertices to parameters of the curve, in order.

use crate::lattice::grid::Grid;

use super::graph::Graph;
use super::search::Walk;

/// Least distance along the curve between neighbours, relative to the mean.
const GAP: f64 = 0.15;

/// The parameter of each vertex in samples: that of its node, or near it where the nodes' own are
/// not in order.
///
/// Strictly increasing, the last less than one turn after the first, the first in `0 .. samples`.
/// Among all sequences with neighbours at least 0.15 of the mean spacing apart it is the one with
/// the least sum of squared changes (isotonic regression). O(vertices).
pub(super) fn parameters<G: Grid>(graph: &Graph<G>, walk: &Walk<G>) -> Vec<f64> {
    let n = walk.len();
    let length = graph.n_samples as f64;
    let gap = GAP * length / n as f64;
    let own: Vec<f64> = walk
        .steps
        .iter()
        .map(|step| graph.parameter[step.node as usize] + f64::from(step.sheet) * length)
        .collect();
    // Three turns, of which the middle one does not feel the ends.
    let mut blocks: Vec<(f64, f64)> = Vec::with_capacity(3 * n);
    for i in 0..3 * n {
        let value = own[i % n] + (i / n) as f64 * length - gap * i as f64;
        blocks.push((value, 1.0));
        while let [.., (before, count_before), (last, count)] = blocks[..] {
            if before <= last {
                break;
            }
            blocks.pop();
            let count_both = count_before + count;
            if let Some(block) = blocks.last_mut() {
                *block = ((before * count_before + last * count) / count_both, count_both);
            }
        }
    }
    let fitted = blocks.iter().flat_map(|&(value, count)| std::iter::repeat_n(value, count as usize));
    let mut found: Vec<f64> =
        (0..).zip(fitted).skip(n).take(n).map(|(i, value)| value + gap * f64::from(i)).collect();
    let turns = found.first().map_or(0.0, |s| (s / length).floor());
    for s in &mut found {
        *s -= turns * length;
    }
    found
}
