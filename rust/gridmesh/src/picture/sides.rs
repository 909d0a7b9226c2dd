//! Centres of pixels kept on their sides of the line: inside of it what is covered at least to the threshold, outside what is not.

use glam::DVec2;

use crate::geometry::segments::nearest_on_segment;
use crate::picture::heights::Sample;
use crate::picture::levels::Crossing;

/// How far inside or outside a centre is kept, in pixels: more than dropping points changes the line by.
const KEEP: f64 = 0.035;

/// Centres that are nearer to the line than this are taken to be on the wrong side, in pixels.
const CLOSE: f64 = 0.01;

/// Centres that are farther on the wrong side than this, in pixels, stay there: the line knows better, as at tips and corners.
const WRONG: f64 = 0.15;

/// No sample is moved farther than this in all, in pixels.
const FARTHEST: f64 = 0.2;

/// The line is moved within so much to each side of a centre, in pixels, less and less: it shall not turn by much.
const REACH: f64 = 2.0;

/// Towards corners likewise, from so far away; where less than this share of a move were left no centre is kept.
const CORNER: f64 = 1.5;
const LEAST: f64 = 0.3;

/// Crossings to each side of one among whose samples the nearest segment is looked for.
const AROUND: usize = 3;

/// Rounds over the line: moves for one centre may undo those for another.
const ROUNDS: usize = 3;

/// Moves samples of a smooth closed line so that the centres of the pixels beside it lie on the sides where their coverage
/// puts them, where that takes less than a sixth of a pixel. Corners stay.
///
/// Smoothing and heights find an edge to a few hundredths of a pixel; coverage near the threshold tells the side more exactly.
pub fn keep(contour: &[Crossing], mut samples: Vec<Sample>) -> Vec<Sample> {
    let n = samples.len();
    if n < 4 {
        return samples;
    }
    let start: Vec<DVec2> = samples.iter().map(|sample| sample.at).collect();
    for _ in 0..ROUNDS {
        let (mut first, mut changed) = (0, false);
        for (k, crossing) in contour.iter().enumerate() {
            // The last sample before the crossings looked at.
            while first + 1 < n && samples[first + 1].crossing + AROUND < k {
                first += 1;
            }
            let count = samples[first..].iter().take_while(|s| s.crossing <= k + AROUND).count() + 1;
            let (dx, dy) = crossing.step();
            let inside = crossing.centre();
            let outside = inside + DVec2::new(f64::from(dx), f64::from(dy));
            for (centre, side) in [(inside, -1.0), (outside, 1.0)] {
                changed |= keep_one(&mut samples, &start, (first, count), centre, side);
            }
        }
        if !changed {
            break;
        }
    }
    samples
}

/// Keeps one centre on its side, 1 outside, of the nearest of some segments; whether that moved a sample.
fn keep_one(
    samples: &mut [Sample],
    start: &[DVec2],
    (first, count): (usize, usize),
    centre: DVec2,
    side: f64,
) -> bool {
    let n = samples.len();
    let at = |i: usize| samples[i % n].at;
    let mut nearest = (f64::INFINITY, 0, 0.0);
    // One more before the first: the line is closed.
    for i in (first + n - 1)..(first + n + count) {
        let (share, squared) = nearest_on_segment(centre, at(i), at(i + 1));
        if squared < nearest.0 {
            nearest = (squared, i, share);
        }
    }
    let (squared, i, share) = nearest;
    if squared > (WRONG + KEEP).powi(2) {
        return false;
    }
    let right = |i: usize| -(at(i + 1) - at(i)).normalize_or_zero().perp();
    let beside = match share {
        share if share <= 0.0 => right(i + n - 1),
        share if share >= 1.0 => right(i + 1),
        _ => right(i),
    };
    let normal = (right(i) + beside).normalize_or_zero();
    let off = side * (centre - at(i).lerp(at(i + 1), share)).dot(normal);
    if !(-WRONG..CLOSE).contains(&off) {
        return false;
    }
    let (here, after) = (at(i).lerp(at(i + 1), share), (i + 1) % n);
    let mut around = walk(samples, here, i % n, false);
    around.extend(walk(samples, here, after, true));
    let weight = |k: usize| around.iter().find(|(other, _)| *other == k).map_or(0.0, |(_, weight)| *weight);
    let part = (1.0 - share) * weight(i % n) + share * weight(after);
    if part < LEAST {
        return false;
    }
    for (k, weight) in around {
        let moved = samples[k].at - side * (KEEP - off) * weight / part * normal;
        samples[k].at = start[k] + (moved - start[k]).clamp_length_max(FARTHEST);
    }
    true
}

/// Samples from one on, ahead or back, as far as a move of a place beside it goes, each with its part of the move.
fn walk(samples: &[Sample], from: DVec2, first: usize, ahead: bool) -> Vec<(usize, f64)> {
    let n = samples.len();
    let (mut found, mut corner) = (Vec::new(), None);
    let (mut at, mut before, mut arc) = (first, from, 0.0);
    for _ in 0..n / 3 {
        arc += before.distance(samples[at].at);
        if samples[at].corner {
            corner = Some(arc);
            break;
        }
        // No farther than a move goes.
        if arc > REACH {
            break;
        }
        found.push((at, arc));
        before = samples[at].at;
        at = if ahead { (at + 1) % n } else { (at + n - 1) % n };
    }
    let of = |arc: f64| {
        let fallen = (1.0 - (arc / REACH).powi(2)).max(0.0).powi(2);
        fallen * corner.map_or(1.0, |corner: f64| ((corner - arc) / CORNER).clamp(0.0, 1.0))
    };
    found.into_iter().map(|(k, arc)| (k, of(arc))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of crossings upward along a vertical edge: columns below 4 are covered.
    fn wall(height: i32) -> Vec<Crossing> {
        (0..height).map(|y| Crossing { x: 3, y, side: 0 }).collect()
    }

    fn line(x: impl Fn(usize) -> f64, n: usize) -> Vec<Sample> {
        let sample = |k: usize| Sample {
            crossing: k,
            at: DVec2::new(x(k), k as f64 + 0.5),
            exact: true,
            corner: false,
        };
        (0..n).map(sample).collect()
    }

    #[test]
    fn centres_on_the_wrong_side_come_to_lie_on_theirs() {
        let contour = wall(40);
        // Off by a tenth of a pixel beyond the centres of what is covered, in one place and along a stretch.
        let off = |k: usize| if k == 10 || (20..25).contains(&k) { 3.4 } else { 3.8 };
        let kept = keep(&contour, line(off, 40));
        let turn = |k: usize| (kept[k + 1].at - kept[k].at).angle_to(kept[k].at - kept[k - 1].at).abs();
        assert!((27..38).all(|k| turn(k) < 0.2));
        for (k, sample) in kept.iter().enumerate().take(36).skip(4) {
            assert!(sample.at.x > 3.51, "{k}: {}", sample.at.x);
            assert!((sample.at.x - off(k)).abs() <= FARTHEST);
            if k > 28 {
                assert_eq!(sample.at.x, 3.8);
            }
        }
    }

    #[test]
    fn corners_and_what_is_far_off_stay() {
        let contour = wall(40);
        let mut samples = line(|k| if k == 10 { 3.1 } else { 3.8 }, 40);
        samples[20].at.x = 3.45;
        samples[20].corner = true;
        let kept = keep(&contour, samples);
        assert_eq!(kept[10].at.x, 3.1);
        assert_eq!(kept[20].at.x, 3.45);
    }
}
