//! Tips finer than a pixel, which no pixel is covered enough to show, put back where lines through both sides meet, if
//! the coverage says that they go so far.

use glam::DVec2;

use crate::error::Result;
use crate::geometry::segments::nearest_on_segment;
use crate::picture::field::Picture;
use crate::picture::heights::Sample;

/// Half the length of contour that is looked at for an end, in pixels, and how near its ends are to each other at a tip: at
/// one of 45 degrees.
const END: f64 = 6.0;
const NEAR: f64 = 5.0;

/// How far from the end sides begin, and how long they are, in pixels.
const GAPS: [f64; 4] = [2.0, 4.0, 7.0, 11.0];
const LENGTHS: [f64; 4] = [28.0, 16.0, 9.0, 5.0];

/// Samples of a side reach over this share of its length at least.
const SPREAD: f64 = 0.6;

/// How far the samples of a side may be from its line, in pixels.
const STRAIGHT: f64 = 0.13;

/// Sides turn at a tip by at least this much, in radians, which leaves 45 degrees between them, and by at most as much as leaves 7
/// degrees. Blunter ones are corners.
const TURN: (f64, f64) = (2.356, 3.02);

/// A tip is at most this far from the end of the contour, in pixels.
const FARTHEST: f64 = 8.0;

/// How far the coverage of a pixel may be from that of the tip: 4 x 4 samples miss a strip of a quarter.
const PIXEL: f64 = 0.27;

/// How far the sum over all pixels of the tip may be from that of the tip, in pixels. The rounded end of a limb a pixel
/// wide lacks more.
const SUM: f64 = 0.5;

/// Pixels beyond a tip and beside it whose coverage is looked at.
const AROUND: f64 = 1.5;

/// A piece that the level leaves of a tip has at most as many crossings.
pub const PIECE: usize = 60;

/// Contours of more samples report in between.
const REPORT: usize = 4096;

/// A tip that was put back: its end, and where its sides begin to be seen.
#[derive(Clone, Copy, Debug)]
pub struct Tip {
    pub at: DVec2,
    pub feet: [DVec2; 2],
}

impl Tip {
    /// Whether all points lie in it, or within a pixel: what the level leaves of a tip beyond a place where it is narrow.
    pub fn holds(&self, points: &[DVec2]) -> bool {
        let corners = [self.at, self.feet[0], self.feet[1]];
        let turn = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).signum();
        let side = |k: usize| (corners[k], corners[(k + 1) % 3]);
        let inside =
            |point: DVec2| (0..3).all(|k| turn * (side(k).1 - side(k).0).perp_dot(point - side(k).0) >= 0.0);
        let near = |point: DVec2| (0..3).any(|k| nearest_on_segment(point, side(k).0, side(k).1).1 <= 1.0);
        points.iter().all(|&point| near(point) || inside(point))
    }
}

/// A tip and the sample that it stands for.
#[derive(Clone, Copy, Debug)]
struct Found {
    tip: Tip,
    /// Samples up to here, ahead and back, in arc length, are replaced.
    reach: [f64; 2],
    /// Mean square of what the coverage is off.
    off: f64,
}

/// Replaces the samples around the end of each tip by it.
pub fn restore(
    picture: &Picture,
    samples: Vec<Sample>,
    report: impl Fn(f64) -> Result<()>,
) -> Result<(Vec<Sample>, Vec<Tip>)> {
    let n = samples.len();
    let ring = Ring::new(&samples);
    if n < 12 || ring.length < 4.0 * END {
        return Ok((samples, Vec::new()));
    }
    let mut across = Vec::with_capacity(n);
    for i in 0..n {
        if i.is_multiple_of(REPORT) {
            report(0.0)?;
        }
        across.push(ring.place(i, END, true).distance(ring.place(i, END, false)));
    }
    let mut tips: Vec<(usize, Found)> = Vec::new();
    for i in 0..n {
        let beside = |j: &usize| ring.between(i, *j) <= END;
        let least = |j: usize| (across[i], i) <= (across[j], j);
        let ahead = (1..n).map(|k| (i + k) % n).take_while(beside);
        let back = (1..n).map(|k| (i + n - k) % n).take_while(beside);
        if across[i] <= NEAR
            && ahead.chain(back).all(least)
            && let Some(found) = ring.tip(picture, i)
        {
            tips.push((i, found));
        }
    }
    let mut keep = vec![true; n];
    let mut restored = samples.clone();
    for &(i, found) in &tips {
        for (reach, ahead) in found.reach.into_iter().zip([true, false]) {
            let step = |k: usize| if ahead { (i + k) % n } else { (i + n - k) % n };
            let replaced = (1..n).map(step).take_while(|&j| ring.offset(i, j, ahead) < reach);
            replaced.for_each(|j| keep[j] = false);
        }
    }
    for &(i, found) in &tips {
        keep[i] = true;
        restored[i] = Sample { at: found.tip.at, exact: true, corner: true, ..samples[i] };
    }
    let kept = restored.into_iter().zip(keep).filter_map(|(sample, keep)| keep.then_some(sample)).collect();
    Ok((kept, tips.into_iter().map(|(_, found)| found.tip).collect()))
}

/// A closed line of samples by arc length.
struct Ring<'a> {
    samples: &'a [Sample],
    arc: Vec<f64>,
    length: f64,
}

impl<'a> Ring<'a> {
    fn new(samples: &'a [Sample]) -> Self {
        let (mut arc, mut length) = (Vec::with_capacity(samples.len()), 0.0);
        for (i, sample) in samples.iter().enumerate() {
            arc.push(length);
            length += sample.at.distance(samples[(i + 1) % samples.len()].at);
        }
        Self { samples, arc, length }
    }

    /// Arc length from one sample to another, ahead or back.
    fn offset(&self, i: usize, j: usize, ahead: bool) -> f64 {
        let s = if ahead { self.arc[j] - self.arc[i] } else { self.arc[i] - self.arc[j] };
        if s < 0.0 { s + self.length } else { s }
    }

    /// The shorter way.
    fn between(&self, i: usize, j: usize) -> f64 {
        let s = (self.arc[i] - self.arc[j]).abs();
        s.min(self.length - s)
    }

    /// The sample after or before one at `k` steps.
    fn step(&self, i: usize, k: usize, ahead: bool) -> usize {
        let n = self.samples.len();
        let j = if ahead { i + k } else { i + n - k };
        if j < n { j } else { j - n }
    }

    /// The place at an arc length from a sample.
    fn place(&self, i: usize, reach: f64, ahead: bool) -> DVec2 {
        let mut last = (0.0, self.samples[i].at);
        for k in 1..self.samples.len() {
            let j = self.step(i, k, ahead);
            let (s, at) = (self.offset(i, j, ahead), self.samples[j].at);
            if s >= reach {
                return last.1.lerp(at, (reach - last.0) / (s - last.0).max(1e-12));
            }
            last = (s, at);
        }
        last.1
    }

    /// Exact samples to one side, with their arc lengths from it.
    fn side(&self, i: usize, ahead: bool) -> Vec<(f64, DVec2)> {
        let farthest = (GAPS[GAPS.len() - 1] + LENGTHS[0]).min(0.45 * self.length);
        (1..self.samples.len())
            .map(|k| self.step(i, k, ahead))
            .map(|j| (self.offset(i, j, ahead), self.samples[j]))
            .take_while(|&(s, _)| s <= farthest)
            .filter(|(_, sample)| sample.exact)
            .map(|(s, sample)| (s, sample.at))
            .collect()
    }

    /// The tip near a sample that fits the coverage best.
    fn tip(&self, picture: &Picture, i: usize) -> Option<Found> {
        let sides = [self.side(i, true), self.side(i, false)];
        let mut best: Option<Found> = None;
        for gap in GAPS {
            let lines = sides.each_ref().map(|side| {
                LENGTHS.iter().filter_map(|&length| Line::fit(side, gap, length)).collect::<Vec<_>>()
            });
            for after in &lines[0] {
                for before in &lines[1] {
                    if let Some(found) = found(picture, self.samples[i].at, after, before)
                        && best.is_none_or(|best| found.off < best.off)
                    {
                        best = Some(found);
                    }
                }
            }
        }
        best
    }
}

/// A line through a side, running away from the tip, and where its samples begin.
#[derive(Clone, Copy, Debug)]
struct Line {
    mean: DVec2,
    along: DVec2,
    first: (f64, DVec2),
}

impl Line {
    /// That of least squares through the samples of a side, if they are straight.
    fn fit(side: &[(f64, DVec2)], gap: f64, length: f64) -> Option<Self> {
        let points: Vec<(f64, DVec2)> =
            side.iter().copied().filter(|&(s, _)| s >= gap && s <= gap + length).collect();
        let (first, last) = (*points.first()?, *points.last()?);
        if points.len() < 4 || last.0 - first.0 < SPREAD * length {
            return None;
        }
        let mean = points.iter().map(|&(_, point)| point).sum::<DVec2>() / points.len() as f64;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for &(_, point) in &points {
            let d = point - mean;
            xx += d.x * d.x;
            xy += d.x * d.y;
            yy += d.y * d.y;
        }
        let along = DVec2::from_angle(0.5 * libm::atan2(2.0 * xy, xx - yy));
        let along = if along.dot(last.1 - first.1) < 0.0 { -along } else { along };
        let straight = points.iter().all(|&(_, point)| along.perp_dot(point - mean).abs() <= STRAIGHT);
        straight.then_some(Self { mean, along, first })
    }
}

/// The tip in which two lines meet, if it is one and covers what the picture does.
fn found(picture: &Picture, end: DVec2, after: &Line, before: &Line) -> Option<Found> {
    let turn = libm::atan2((-before.along).perp_dot(after.along), (-before.along).dot(after.along));
    if turn.abs() < TURN.0 || turn.abs() > TURN.1 {
        return None;
    }
    let s = (after.mean - before.mean).perp_dot(after.along) / before.along.perp_dot(after.along);
    let at = before.mean + s * before.along;
    let feet = [after, before].map(|line| (line.first.1 - at).dot(line.along));
    if feet[0] <= 0.0 || feet[1] <= 0.0 || at.distance(end) > FARTHEST {
        return None;
    }
    let wedge = Wedge { at, sides: [after.along, before.along], is_convex: turn > 0.0 };
    let off = wedge.off(picture, feet[0].min(feet[1]));
    if off.most > PIXEL || off.sum.abs() > SUM {
        return None;
    }
    let foot = |k: usize, line: &Line| at + feet[k] * line.along;
    let tip = Tip { at, feet: [foot(0, after), foot(1, before)] };
    Some(Found { tip, reach: [after.first.0, before.first.0], off: off.mean_square })
}

/// What lies between two rays, or around.
pub(super) struct Wedge {
    pub at: DVec2,
    /// Unit vectors.
    pub sides: [DVec2; 2],
    pub is_convex: bool,
}

/// How far the coverage is from that of a wedge.
struct Off {
    /// Of a pixel, at most.
    most: f64,
    sum: f64,
    mean_square: f64,
}

impl Wedge {
    /// Whether the picture covers as much as the wedge does, as far as `length` from its end: blurred or not.
    pub fn is_covered(&self, picture: &Picture, length: f64) -> bool {
        self.off(picture, length).sum.abs() <= SUM
    }

    /// How much of the pixel whose lower left corner this is is covered.
    fn coverage(&self, corner: DVec2) -> f64 {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let mut polygon: Vec<DVec2> = square.map(|at| corner + DVec2::from(at)).to_vec();
        for k in 0..2 {
            let (side, other) = (self.sides[k], self.sides[1 - k]);
            let turn = side.perp_dot(other).signum();
            polygon = clipped(&polygon, |point| turn * side.perp_dot(point - self.at));
        }
        let fan = (1..polygon.len().max(2) - 1).map(|k| [polygon[k], polygon[k + 1]]);
        let area = 0.5 * fan.map(|[a, b]| (a - polygon[0]).perp_dot(b - polygon[0])).sum::<f64>();
        if self.is_convex { area } else { 1.0 - area }
    }

    /// The difference of the picture to the wedge as far as `length` from its end.
    fn off(&self, picture: &Picture, length: f64) -> Off {
        let axis = (self.sides[0] + self.sides[1]).normalize();
        let slope = axis.perp_dot(self.sides[0]).abs() / axis.dot(self.sides[0]);
        let reach = length * (1.0 + slope) + AROUND + 1.0;
        let (low, high) = ((self.at - reach).floor(), (self.at + reach).ceil());
        let (mut off, mut count) = (Off { most: 0.0, sum: 0.0, mean_square: 0.0 }, 0_usize);
        for y in low.y as i32..high.y as i32 {
            for x in low.x as i32..high.x as i32 {
                let corner = DVec2::new(f64::from(x), f64::from(y));
                let d = corner + 0.5 - self.at;
                let (along, beside) = (axis.dot(d), axis.perp_dot(d).abs());
                if along < -AROUND || along > length || beside > along.max(0.0) * slope + AROUND {
                    continue;
                }
                let here = picture.at(x, y) - self.coverage(corner);
                off.most = off.most.max(here.abs());
                off.sum += here;
                off.mean_square += here * here;
                count += 1;
            }
        }
        off.mean_square /= count.max(1) as f64;
        off
    }
}

/// The part of a convex polygon where a linear function is not negative.
fn clipped(polygon: &[DVec2], value: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (of_a, of_b) = (value(a), value(b));
        if of_a >= 0.0 {
            kept.push(a);
        }
        if (of_a < 0.0) != (of_b < 0.0) {
            kept.push(a.lerp(b, of_a / (of_a - of_b)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter plane, or what is around it.
    fn quarter(is_convex: bool) -> Wedge {
        Wedge { at: DVec2::new(0.5, 0.25), sides: [DVec2::X, DVec2::Y], is_convex }
    }

    #[test]
    fn a_wedge_covers_parts_of_pixels() {
        for (corner, share) in [((0.0, 0.0), 0.375), ((1.0, 0.0), 0.75), ((0.0, 3.0), 0.5), ((4.0, 4.0), 1.0)]
        {
            let corner = DVec2::from(corner);
            assert!((quarter(true).coverage(corner) - share).abs() < 1e-12);
            assert!((quarter(false).coverage(corner) - 1.0 + share).abs() < 1e-12);
        }
        assert_eq!(quarter(true).coverage(DVec2::new(-1.0, 2.0)), 0.0);
    }

    #[test]
    fn a_picture_covers_the_wedge_that_it_shows_and_no_other() {
        let at = DVec2::new(30.3, 10.4);
        let shown = |slope: f64| Wedge {
            at,
            sides: [DVec2::new(slope, 1.0).normalize(), DVec2::new(-slope, 1.0).normalize()],
            is_convex: true,
        };
        let wedge = shown(0.15);
        let value = |k: usize| wedge.coverage(DVec2::new((k % 60) as f64, 59.0 - (k / 60) as f64)) as f32;
        let picture = Picture::new(60, 60, (0..3600).map(value).collect()).unwrap();
        assert!(wedge.off(&picture, 12.0).most < 1e-6);
        assert!(wedge.is_covered(&picture, 12.0));
        for other in [shown(0.3), shown(0.05), Wedge { at: at - DVec2::Y * 4.0, ..shown(0.15) }] {
            assert!(!other.is_covered(&picture, 12.0));
        }
    }

    #[test]
    fn a_tip_holds_its_pieces() {
        let tip = Tip { at: DVec2::ZERO, feet: [DVec2::new(10.0, 1.0), DVec2::new(10.0, -1.0)] };
        assert!(tip.holds(&[DVec2::new(5.0, 0.2), DVec2::new(6.0, 1.4), DVec2::new(-0.9, 0.0)]));
        assert!(!tip.holds(&[DVec2::new(5.0, 0.2), DVec2::new(5.0, 2.0)]));
    }
}
