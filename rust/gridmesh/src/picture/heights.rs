//! Where an anti-aliased edge was: heights from the coverage of columns of pixels.
//!
//! The pixels of a column across an edge sum up to the height at which the edge crosses it, on average over the
//! column's width. That is exact for straight edges, where interpolation between two pixels is off by up to a tenth.

use glam::DVec2;

use crate::picture::field::Picture;
use crate::picture::levels::Crossing;

/// Coverage this near to 0 or 1 ends a column.
const FULL: f64 = 0.06;

/// Pixels to each side that an edge may be spread over.
const REACH: i32 = 4;

/// Columns may lean this much against the normal of the edge: the tangent's part along them over that across.
const LEAN: f64 = 1.4;

/// See [`noise`].
const MASK: f64 = 3.5;

/// An exact place is at most this far from the crossing, in pixels.
const NEAR: f64 = 0.5;

/// A place on a contour.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The crossing that it comes from.
    pub crossing: usize,
    /// Where.
    pub at: DVec2,
    /// From a column of pixels, not from two.
    pub exact: bool,
    /// A corner: not to be smoothed.
    pub corner: bool,
}

/// Samples of a contour: crossings, exact where a column tells, without those that lie between exact ones.
pub fn samples(picture: &Picture, threshold: f64, contour: &[Crossing], raw: &[DVec2]) -> Vec<Sample> {
    let n = contour.len();
    let heights: Vec<Option<f64>> =
        (0..n).map(|i| column(picture, contour[i]).filter(|_| lean(contour, raw, i) <= LEAN)).collect();
    let place = |i: usize| {
        let height = heights[i]?;
        let height = height - bulge(contour, &heights, i, height) + shift(threshold, lean(contour, raw, i));
        let linear = (raw[i] - contour[i].centre()).length();
        Some(contour[i].point(height.clamp(linear - NEAR, linear + NEAR)))
    };
    let places: Vec<Option<DVec2>> = (0..n).map(place).collect();
    let exact = |i: usize| places[i].is_some();
    // Between columns of one kind a crossing tells nothing more; where the kind changes there may be a corner.
    let between = |i: usize| {
        let (before, after) = ((i + n - 1) % n, (i + 1) % n);
        exact(before) && exact(after) && contour[before].side == contour[after].side
    };
    (0..n)
        .filter(|&i| exact(i) || !between(i))
        .map(|i| Sample { crossing: i, at: places[i].unwrap_or(raw[i]), exact: exact(i), corner: false })
        .collect()
}

/// By how much farther than with anti-aliasing samples of a contour may be from what was drawn: 1, or more where there
/// is none, as in masks.
pub fn noise(picture: &Picture, contour: &[Crossing]) -> f64 {
    let partial = |value: f64| value > FULL && value < 1.0 - FULL;
    let anti_aliased = |crossing: &&Crossing| {
        let (dx, dy) = crossing.step();
        partial(picture.at(crossing.x, crossing.y)) || partial(picture.at(crossing.x + dx, crossing.y + dy))
    };
    let partial = contour.iter().filter(anti_aliased).count();
    if partial * 10 > contour.len() { 1.0 } else { MASK }
}

/// How much the contour leans against the normal that a crossing's column stands for.
fn lean(contour: &[Crossing], raw: &[DVec2], i: usize) -> f64 {
    let n = raw.len();
    let along = raw[(i + 2) % n] - raw[(i + n - 2) % n];
    let (of_column, across) =
        if contour[i].side.is_multiple_of(2) { (along.x, along.y) } else { (along.y, along.x) };
    of_column.abs() / across.abs().max(1e-9)
}

/// The height of the edge, from the centre of the pixel inside towards the one outside, averaged over the
/// column; none if it does not run from a covered pixel straight to an empty one.
fn column(picture: &Picture, crossing: Crossing) -> Option<f64> {
    let (dx, dy) = crossing.step();
    let value = |k: i32| picture.at(crossing.x + k * dx, crossing.y + k * dy);
    let full = |k: &i32| value(*k) >= 1.0 - FULL;
    let empty = |k: &i32| value(*k) <= FULL;
    let first = (0..=REACH).map(|k| -k).find(full)?;
    let last = (1..=REACH).find(empty)?;
    // What is nearly full or empty counts as it is, where the column goes on so.
    let (first, last) = (first - i32::from(full(&(first - 1))), last + i32::from(empty(&(last + 1))));
    let falls = (first..last).all(|k| value(k) >= value(k + 1) - FULL);
    let between: f64 = (first + 1..last).map(value).sum();
    falls.then(|| f64::from(first) + 0.5 + between)
}

/// By how much the average over the column is above the height in its middle, from the columns beside it.
fn bulge(contour: &[Crossing], heights: &[Option<f64>], i: usize, height: f64) -> f64 {
    let n = contour.len();
    let here = contour[i];
    let (dx, dy) = here.step();
    // The neighbouring columns are two crossings away at most: the height may change by a pixel between.
    let beside = |j: usize| {
        let there = contour[j];
        let (x, y) = (there.x - here.x, there.y - here.y);
        let next = there.side == here.side && (x * dy - y * dx).abs() == 1;
        heights[j].filter(|_| next).map(|height| height + f64::from(x * dx + y * dy))
    };
    let before = beside((i + n - 1) % n).or_else(|| beside((i + n - 2) % n));
    let after = beside((i + 1) % n).or_else(|| beside((i + 2) % n));
    match (before, after) {
        (Some(before), Some(after)) => ((before + after - 2.0 * height) / 24.0).clamp(-0.1, 0.1),
        _ => 0.0,
    }
}

/// How far outside of a straight edge, along the column, the level of a threshold lies, for a lean.
fn shift(threshold: f64, lean: f64) -> f64 {
    let level = threshold.min(1.0 - threshold);
    // Coverage by a box falls linearly in the middle, as a parabola at the ends.
    let tail = 0.5 * lean.min(1.0 / lean.max(1e-9));
    let distance = if level >= tail {
        (0.5 - level) * lean.max(1.0)
    } else {
        0.5 * (1.0 + lean) - (2.0 * lean * level).sqrt()
    };
    if threshold < 0.5 { distance } else { -distance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::levels;
    use crate::progress::Progress;

    /// Coverage of the half plane below a line, by 16 x 16 samples a pixel.
    fn below(slope: f64, height: f64) -> Picture {
        let value = |row: usize, column: usize| {
            let hit = |k: usize| {
                let x = column as f64 + ((k % 16) as f64 + 0.5) / 16.0;
                let y = (31 - row) as f64 + ((k / 16) as f64 + 0.5) / 16.0;
                y < height + slope * x
            };
            (0..256).filter(|&k| hit(k)).count() as f32 / 256.0
        };
        let values = (0..1024).map(|k| value(k / 32, k % 32)).collect();
        Picture::new(32, 32, values).unwrap()
    }

    #[test]
    fn straight_edges_are_found_where_they_are() {
        for (slope, height) in [(0.0, 15.3), (0.2, 11.7), (-0.45, 20.1), (0.9, 3.3)] {
            let picture = below(slope, height);
            for threshold in [0.5, 0.2, 0.9] {
                let contour = &levels::contours(&picture, threshold, Progress::NONE).unwrap()[0];
                let raw = levels::points(&picture, threshold, contour);
                let samples = samples(&picture, threshold, contour, &raw);
                let inner = |p: DVec2| p.x > 4.0 && p.x < 28.0 && p.y > 3.0 && p.y < 29.0;
                let off: Vec<f64> = samples
                    .iter()
                    .filter(|sample| sample.exact && inner(sample.at))
                    .map(|sample| sample.at.y - height - slope * sample.at.x)
                    .collect();
                assert!(off.len() > 15);
                let spread = off.iter().copied().fold(f64::MIN, f64::max)
                    - off.iter().copied().fold(f64::MAX, f64::min);
                // Sixteen steps a pixel, and a lean that is measured.
                assert!(spread < 0.15, "{slope} {threshold}: {spread}");
                if threshold == 0.5 {
                    assert!(off.iter().all(|off| off.abs() < 0.05), "{slope}: {off:?}");
                } else {
                    assert!(off.iter().all(|off| (off > &0.0) == (threshold < 0.5)));
                }
            }
        }
    }
}
