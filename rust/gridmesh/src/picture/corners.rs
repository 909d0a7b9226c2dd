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
    reaches: &'a [Reach],
    /// Whether samples are corners as it is.
    has_corners: bool,
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
    let reaches = SIDES.map(|side| Reach::new(&samples, &arc, side));
    let has_corners = samples.iter().any(|sample| sample.corner);
    let line = Line { reaches: &reaches, has_corners, samples: &samples, arc: &arc, noise, evidence };
    let mut sides: Vec<(f64, usize)> = (0..SIDES.len()).map(|k| (1.0, k)).collect();
    if noise > 1.0 {
        sides.extend((0..SIDES.len()).filter(|&k| SIDES[k].1 >= LONG).map(|k| (noise, k)));
    }
    let mut found: Vec<Option<Corner>> = Vec::with_capacity(n);
    for i in 0..n {
        if i.is_multiple_of(REPORT) {
            report(0.3 * i as f64 / n as f64)?;
        }
        found.push(sides.iter().find_map(|&(noise, k)| corner(&Line { noise, ..line }, i, k)));
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

/// How many samples ahead of each one, and back, are nearer than a side begins, and no farther than it ends.
struct Reach {
    ahead: Vec<[u32; 2]>,
    back: Vec<[u32; 2]>,
}

impl Reach {
    fn new(samples: &[Sample], arc: &[f64], (gap, length): (f64, f64)) -> Self {
        let n = samples.len();
        let counts = |ahead: bool| {
            let mut counts = vec![[0_u32; 2]; n];
            // Ahead of the next sample one less lies as near, then maybe more.
            let mut now = [0_usize; 2];
            for step in 0..n {
                let i = if ahead { step } else { n - 1 - step };
                let away = |k: usize| {
                    let j = if ahead { i + k } else { i + n - k };
                    offset(arc, i, if j < n { j } else { j - n }, ahead)
                };
                now = now.map(|count| count.saturating_sub(1));
                while now[0] + 1 < n && away(now[0] + 1) < gap {
                    now[0] += 1;
                }
                while now[1] + 1 < n && away(now[1] + 1) <= gap + length {
                    now[1] += 1;
                }
                counts[i] = now.map(|count| count as u32);
            }
            counts
        };
        Self { ahead: counts(true), back: counts(false) }
    }
}

/// Arc length from one sample to another, ahead or back.
fn offset(arc: &[f64], i: usize, j: usize, ahead: bool) -> f64 {
    let s = if ahead { arc[j] - arc[i] } else { arc[i] - arc[j] };
    if s < 0.0 { s + arc[arc.len() - 1] } else { s }
}

/// Whether lines through both sides may turn enough, and both may be straight: told from their ends and middles. A line that
/// is near to all samples of a side leans against its ends by twice that at most, over their distance.
fn may_turn(line: &Line<'_>, i: usize, k: usize) -> bool {
    let n = line.samples.len();
    let (back, ahead) = (line.reaches[k].back[i], line.reaches[k].ahead[i]);
    let at = |steps: u32, ahead: bool| {
        let j = if ahead { i + steps as usize } else { i + n - steps as usize };
        line.samples[if j < n { j } else { j - n }]
    };
    // Sides end at corners that there are.
    let is_cut = |end: u32, ahead: bool| line.has_corners && (0..=end).any(|steps| at(steps, ahead).corner);
    if is_cut(back[1], false) || is_cut(ahead[1], true) {
        return true;
    }
    let most = 2.0 * STRAIGHT * line.noise;
    let side = |[gap, end]: [u32; 2], ahead: bool| {
        let places = [gap + 1, (gap + 1 + end) / 2, end].map(|steps| at(steps, ahead).at);
        let (way, middle) = (places[2] - places[0], places[1] - places[0]);
        // Ends that are far apart tell which way the line runs.
        let is_far = way.length() > 2.0 * most && (0.0..=way.length_squared()).contains(&way.dot(middle));
        let is_bent = is_far && way.perp_dot(middle).abs() > 2.0 * most * way.length();
        (end >= gap + 3 && !is_bent).then_some(way)
    };
    let (Some(before), Some(after)) = (side(back, false), side(ahead, true)) else { return false };
    let lean = 1.06 * most * (1.0 / before.length() + 1.0 / after.length());
    // The tangent of an angle is more than the angle.
    let (cross, dot) = ((-before).perp_dot(after), (-before).dot(after));
    lean >= 0.5 * TURN || dot <= 0.0 || cross.abs() >= (TURN - lean - 1e-9) * dot
}

/// The corner near a sample, if lines fit both sides and it is not rounded.
fn corner(line: &Line<'_>, i: usize, k: usize) -> Option<Corner> {
    let (&Line { samples, arc, noise, evidence, .. }, (gap, length)) = (line, SIDES[k]);
    let n = samples.len();
    if samples[i].corner || arc[n] < 3.0 * (gap + length) || !may_turn(line, i, k) {
        return None;
    }
    let offset = |j: usize, ahead: bool| offset(arc, i, j, ahead);
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
