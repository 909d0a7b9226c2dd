//! Parts of a drawn line that have no width: there and back again.

use glam::DVec2;

/// Points are the same, and lines run over each other, to this part of the drawing's size.
pub(super) const SAME: f64 = 1e-12;

/// A line that runs back over itself for more than this part of the drawing's size was meant, and is refused as one that meets itself.
const SHORT: f64 = 0.01;

/// Drops points at which a closed line turns and runs back over itself for a short way, as corners of letters in fonts do, and those
/// that then repeat their predecessor. `size`: that of the drawing.
pub(super) fn drop_spikes(kept: &mut Vec<usize>, input: &[DVec2], size: f64) {
    let (tolerance, short) = (SAME * size, SHORT * size);
    let is_tip = |a: usize, b: usize, c: usize| {
        let (there, back) = (input[b] - input[a], input[c] - input[b]);
        let (there_length, back_length) = (there.length(), back.length());
        let is_short = there_length.min(back_length) <= short;
        is_short
            && there.dot(back) < 0.0
            && there.perp_dot(back).abs() <= tolerance * there_length.max(back_length)
    };
    let repeats = |a: usize, b: usize| input[a].distance(input[b]) <= tolerance;
    let mut clean: Vec<usize> = Vec::with_capacity(kept.len());
    for &i in kept.iter() {
        while let [.., a, b] = clean[..]
            && is_tip(a, b, i)
        {
            clean.pop();
        }
        if clean.last().is_none_or(|&last| !repeats(last, i)) {
            clean.push(i);
        }
    }
    // Where the line closes.
    let mut range = 0..clean.len();
    while range.len() > 2 {
        let own = &clean[range.clone()];
        let (first, second, before, last) = (own[0], own[1], own[own.len() - 2], own[own.len() - 1]);
        if is_tip(before, last, first) || repeats(last, first) {
            range.end -= 1;
        } else if is_tip(last, first, second) {
            range.start += 1;
        } else {
            break;
        }
    }
    *kept = clean[range].to_vec();
}
