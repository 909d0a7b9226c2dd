//! Corners, which coverage rounds off, are put back where lines through both sides meet.

use glam::DVec2;

use crate::error::Result;
use crate::geometry::segments::nearest_on_segment;
use crate::picture::field::Picture;
use crate::picture::heights::Sample;
use crate::picture::smooth::Parabola;
use crate::picture::tips::Wedge;

/// Half the gap between the sides, and their lengths, in pixels: the longest that is straight counts.
const SIDES: [(f64, f64); 8] =
    [(1.6, 8.0), (2.4, 8.0), (3.5, 8.0), (1.6, 5.0), (2.4, 5.0), (3.5, 5.0), (1.2, 3.5), (1.0, 2.5)];

/// Lines turn at a corner by at least this much, in radians.
const TURN: f64 = 0.5;

/// and by at most this much, which leaves 11 degrees between the sides.
const SHARPEST: f64 = 2.95;

/// Corners that turn by more than this are sharp.
const SHARP: f64 = 1.6;

/// How far the samples of a side may be from its line, in pixels.
const STRAIGHT: f64 = 0.12;

/// Coverage cuts a corner off at about a quarter pixel over the tangent of half its angle; a corner may be this far
/// from the line that it replaces, so much for the angle, and so much for where samples happen to be, in pixels.
const CUT_OFF: (f64, f64) = (0.4, 0.45);

/// Likewise how far from a corner samples may be beside its sides, and how far beside them others may be.
const ROUNDED: (f64, f64) = (0.9, 0.6);
const BESIDE: f64 = 0.15;

/// What a parabola follows this nearly is a curve, in pixels.
const CURVED: f64 = 0.2;

/// A corner is at most this far from the line that it replaces, in pixels.
const FARTHEST: f64 = 3.5;

/// Contours of more samples report in between.
const REPORT: usize = 4096;

/// Sides of this length are long, in pixels.
const LONG: f64 = 5.0;

/// A closed line of samples.
#[derive(Clone, Copy)]
struct Line<'a> {
    samples: &'a [Sample],
    /// Arc length at each, and of all.
    arc: &'a [f64],
    noise: f64,
    /// What sharp corners are to be covered by.
    evidence: Option<&'a Picture>,
}

#[derive(Clone, Copy, Debug)]
struct Corner {
    at: DVec2,
    turn: f64,
    gap: f64,
}

/// Replaces the samples around each corner by the corner; where samples are noisy,
/// what is straight to the pixel, and long sides. Corners that there are stay.
///
/// Sharp corners have to be covered in `evidence`, if there is one: the round end of a thin limb has none.
pub fn restore(
    samples: Vec<Sample>,
    noise: f64,
    evidence: Option<&Picture>,
    report: impl Fn(f64) -> Result<()>,
) -> Result<Vec<Sample>> {
    let n = samples.len();
    if n < 8 {
        return Ok(samples);
    }
    let arc = arcs(&samples);
    let line = Line { samples: &samples, arc: &arc, noise, evidence };
    let mut sides: Vec<(f64, (f64, f64))> = SIDES.map(|side| (1.0, side)).to_vec();
    if noise > 1.0 {
        sides.extend(SIDES.into_iter().filter(|&(_, length)| length >= LONG).map(|side| (noise, side)));
    }
    let mut found: Vec<Option<Corner>> = Vec::with_capacity(n);
    for i in 0..n {
        if i.is_multiple_of(REPORT) {
            report(0.3 * i as f64 / n as f64)?;
        }
        found.push(sides.iter().find_map(|&(noise, side)| corner(&Line { noise, ..line }, i, side)));
    }
    let away = |i: usize, j: usize| {
        let apart = (arc[i] - arc[j]).abs();
        apart.min(arc[n] - apart)
    };
    let mut keep = vec![true; n];
    let mut restored = samples.clone();
    for i in 0..n {
        let Some(corner) = found[i] else { continue };
        let near = around(n, i, |j| away(i, j) <= 2.0 * corner.gap);
        let better = |j: usize| {
            let other = found[j].map_or(0.0, |other| other.turn.abs());
            // Among equals the sample nearest to its corner, then the first.
            let nearness = |k: usize| found[k].map_or(f64::MAX, |c| c.at.distance(samples[k].at));
            other > corner.turn.abs() + 0.05
                || (other > corner.turn.abs() - 0.05 && (nearness(j), j) < (nearness(i), i))
        };
        if near.iter().any(|&j| better(j)) {
            continue;
        }
        restored[i] = Sample { at: corner.at, exact: true, corner: true, ..samples[i] };
        keep[i] = true;
        for j in around(n, i, |j| away(i, j) < corner.gap) {
            keep[j] = restored[j].corner;
        }
    }
    Ok(restored.into_iter().zip(keep).filter_map(|(sample, keep)| keep.then_some(sample)).collect())
}

/// Arc length at each sample of the closed line, and of all of it.
fn arcs(samples: &[Sample]) -> Vec<f64> {
    let n = samples.len();
    let mut arc = Vec::with_capacity(n + 1);
    let mut length = 0.0;
    for i in 0..n {
        arc.push(length);
        length += samples[i].at.distance(samples[(i + 1) % n].at);
    }
    arc.push(length);
    arc
}

/// The samples before and after one, as long as they are near.
fn around(n: usize, i: usize, near: impl Fn(usize) -> bool) -> Vec<usize> {
    let ahead = (1..n / 2).map(|k| (i + k) % n).take_while(|&j| near(j));
    let back = (1..n / 2).map(|k| (i + n - k) % n).take_while(|&j| near(j));
    back.chain(ahead).collect()
}

/// The corner near a sample, if lines fit both sides and it is not rounded.
fn corner(line: &Line<'_>, i: usize, (gap, length): (f64, f64)) -> Option<Corner> {
    let &Line { samples, arc, noise, evidence } = line;
    let n = samples.len();
    if samples[i].corner || arc[n] < 3.0 * (gap + length) {
        return None;
    }
    let offset = |j: usize, ahead: bool| {
        let s = if ahead { arc[j] - arc[i] } else { arc[i] - arc[j] };
        if s < 0.0 { s + arc[n] } else { s }
    };
    let side = |ahead: bool| -> Vec<DVec2> {
        (1..n)
            .map(|k| if ahead { (i + k) % n } else { (i + n - k) % n })
            .take_while(|&j| offset(j, ahead) <= gap + length && !samples[j].corner)
            .filter(|&j| offset(j, ahead) >= gap)
            .map(|j| samples[j].at)
            .collect()
    };
    let (before, after) = (straight(&side(false), noise)?, straight(&side(true), noise)?);
    // Both run away from the corner.
    let turn = libm::atan2((-before.1).perp_dot(after.1), (-before.1).dot(after.1));
    if turn.abs() < TURN || turn.abs() > SHARPEST {
        return None;
    }
    let cross = before.1.perp_dot(after.1);
    let s = (after.0 - before.0).perp_dot(after.1) / cross;
    let at = before.0 + s * before.1;
    // The corner lies before both sides begin.
    let ahead = (at - before.0).dot(before.1) < 0.0 && (at - after.0).dot(after.1) < 0.0;
    let half_tangent = libm::tan(0.5 * (std::f64::consts::PI - turn.abs()));
    let allowed = (CUT_OFF.0 / half_tangent + CUT_OFF.1).min(FARTHEST);
    let to_segment = |j: usize| nearest_on_segment(at, samples[i].at, samples[j].at).1.sqrt();
    if !ahead || to_segment((i + 1) % n).min(to_segment((i + n - 1) % n)) > allowed {
        return None;
    }
    // What the corner replaces must follow its sides up to where coverage rounds it off.
    let rounded = ROUNDED.0 / half_tangent + ROUNDED.1;
    let follows = |ahead: bool, direction: DVec2| {
        (0..n)
            .map(|k| if ahead { (i + k) % n } else { (i + n - k) % n })
            .take_while(|&j| offset(j, ahead) < gap)
            .filter(|&j| samples[j].at.distance(at) > rounded || samples[j].corner)
            .all(|j| !samples[j].corner && direction.perp_dot(samples[j].at - at).abs() <= BESIDE * noise)
    };
    let corner = follows(true, after.1) && follows(false, before.1);
    // A tight curve: a parabola follows it, too.
    let stretch: Vec<(f64, DVec2)> = [true, false]
        .into_iter()
        .flat_map(|ahead| {
            let sign = if ahead { 1.0 } else { -1.0 };
            (0..n)
                .map(move |k| if ahead { (i + k) % n } else { (i + n - k) % n })
                .map(move |j| (offset(j, ahead), j))
                .take_while(|&(s, _)| s <= gap + length)
                .map(move |(s, j)| (sign * s, samples[j].at - at))
        })
        .collect();
    let curved = Parabola::fit(stretch.iter().copied())
        .is_some_and(|parabola| stretch.iter().all(|&(s, point)| parabola.off(s, point) <= CURVED * noise));
    if !corner || curved {
        return None;
    }
    if let Some(picture) = evidence
        && turn.abs() >= SHARP
    {
        let wedge = Wedge { at, sides: [before.1, after.1], is_convex: turn > 0.0 };
        if !wedge.is_covered(picture, samples[i].at.distance(at) + gap) {
            return None;
        }
    }
    Some(Corner { at, turn, gap })
}

/// The line of least squares through points, if they are straight: their mean, and the direction from first to last.
fn straight(points: &[DVec2], noise: f64) -> Option<(DVec2, DVec2)> {
    if points.len() < 3 {
        return None;
    }
    let mean = points.iter().sum::<DVec2>() / points.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &point in points {
        let d = point - mean;
        xx += d.x * d.x;
        xy += d.x * d.y;
        yy += d.y * d.y;
    }
    let direction = DVec2::from_angle(0.5 * libm::atan2(2.0 * xy, xx - yy));
    let direction =
        if direction.dot(points[points.len() - 1] - points[0]) < 0.0 { -direction } else { direction };
    let straight = points.iter().all(|&point| direction.perp_dot(point - mean).abs() <= STRAIGHT * noise);
    straight.then_some((mean, direction))
}
