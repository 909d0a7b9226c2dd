//! The closed curve that was drawn: cleaned, oriented, measured by arc length.

use glam::DVec2;

use crate::drawing::spikes::{SAME, drop_spikes};
use crate::error::{Error, Result};
use crate::geometry::polygon::SIZES;
use crate::geometry::segments::{SegmentGrid, orientation, segments_meet};

/// On which side of a contour the patch lies: always on its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winding {
    /// An outer contour.
    CounterClockwise,
    /// A hole.
    Clockwise,
}

/// A simple closed polyline, closed implicitly, with its arc length.
///
/// The same drawing gives the same curve, bit for bit, whichever point it starts at and in
/// whichever direction it runs: the first point is the one farthest from the line's centroid, also of
/// a drawing that has been moved, turned or scaled, and the direction follows from the winding.
/// [`ClosedCurve::source`] leads back to the input.
#[derive(Clone, Debug)]
pub struct ClosedCurve {
    points: Vec<DVec2>,
    /// Arc length at each point, and the whole length at the end.
    arc: Vec<f64>,
    /// Input segment under each segment: where repetitions were dropped, the longest of them.
    input_segment: Vec<u32>,
    n_input: usize,
    reversed: bool,
    /// Arc length at the input's first point.
    first: f64,
    area: f64,
}

impl ClosedCurve {
    /// Cleans, orients and checks a drawn contour. `what` names it in errors (`outline`, `hole 2`).
    ///
    /// Points that repeat their predecessor (to 1e-12 of the drawing's size) and tips at which the line runs back
    /// over itself (for at most a hundredth of that size) are dropped and counted by [`ClosedCurve::repaired`];
    /// nothing else is changed. O(n) for ordinary drawings.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::ExtremeSize`], [`Error::TooFewPoints`], [`Error::ZeroArea`], and
    /// [`Error::SelfIntersecting`] if two segments cross, touch or overlap.
    pub fn new(input: &[DVec2], winding: Winding, what: &str) -> Result<Self> {
        if let Some(point) = input.iter().position(|p| !p.is_finite()) {
            return Err(Error::NotFinite { what: what.to_owned(), point });
        }
        let n_input = input.len();
        let mut order: Vec<usize> =
            (0..n_input).filter(|&i| input[i] != input[(i + n_input - 1) % n_input]).collect();
        let few = |distinct: usize| Error::TooFewPoints { what: what.to_owned(), distinct };
        // Sums come out the same, bit for bit, if they begin at the same point.
        let Some(start) = (0..order.len()).min_by(|&i, &j| {
            let (a, b) = (input[order[i]], input[order[j]]);
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
        }) else {
            return Err(few(n_input.min(1)));
        };
        order.rotate_left(start);
        let size = {
            let (low, high) = bounds(input);
            (high - low).max_element()
        };
        if size > 0.0 && !SIZES.contains(&size) {
            return Err(Error::ExtremeSize { what: what.to_owned(), size });
        }
        let reversed = (doubled_area(&order, input) < 0.0) != (winding == Winding::Clockwise);
        if reversed {
            order[1..].reverse();
        }
        let mut kept: Vec<usize> = Vec::with_capacity(order.len());
        for i in order {
            if kept.last().is_none_or(|&last| input[last].distance(input[i]) > SAME * size) {
                kept.push(i);
            }
        }
        while kept.len() > 1 && input[kept[0]].distance(input[kept[kept.len() - 1]]) <= SAME * size {
            kept.pop();
        }
        if kept.len() < 3 {
            return Err(few(kept.len()));
        }
        drop_spikes(&mut kept, input, size);
        if kept.len() < 3 {
            return Err(Error::ZeroArea { what: what.to_owned() });
        }
        let area = 0.5 * doubled_area(&kept, input).abs();
        let start = farthest_from_centroid(&kept, input);
        kept.rotate_left(start);
        let points: Vec<DVec2> = kept.iter().map(|&i| input[i]).collect();
        let mut arc = Vec::with_capacity(points.len() + 1);
        let mut s = 0.0;
        for (i, p) in points.iter().enumerate() {
            arc.push(s);
            s += p.distance(points[(i + 1) % points.len()]);
        }
        arc.push(s);
        // The first input point itself, or the kept one that it repeats.
        let first = (0..points.len())
            .min_by(|&i, &j| {
                points[i].distance_squared(input[0]).total_cmp(&points[j].distance_squared(input[0]))
            })
            .map_or(0.0, |i| arc[i]);
        let curve = Self {
            points,
            arc,
            input_segment: input_segments(&kept, reversed, input),
            n_input,
            reversed,
            first,
            area,
        };
        curve.check_width(what)?;
        curve.check_simple(what)?;
        curve.check_area(what)?;
        Ok(curve)
    }

    /// Points on one line overlap without end; they are told apart from crossings.
    fn check_width(&self, what: &str) -> Result<()> {
        let origin = self.points[0];
        let far = self
            .points
            .iter()
            .map(|&p| p - origin)
            .fold(DVec2::ZERO, |far, d| if d.length_squared() > far.length_squared() { d } else { far });
        let width = self.points.iter().map(|&p| far.perp_dot(p - origin).abs()).fold(0.0, f64::max);
        if width <= 1e-12 * far.length_squared() {
            return Err(Error::ZeroArea { what: what.to_owned() });
        }
        Ok(())
    }

    fn check_area(&self, what: &str) -> Result<()> {
        // The width of the drawing, area over length, against its length.
        if self.area <= 1e-14 * self.length() * self.length() {
            return Err(Error::ZeroArea { what: what.to_owned() });
        }
        Ok(())
    }

    fn check_simple(&self, what: &str) -> Result<()> {
        let n = self.points.len();
        let segments = self.segments();
        let mut crossing: Option<(usize, usize)> = None;
        SegmentGrid::new(&segments).pairs(|i, j| {
            let adjacent = j == i + 1 || (i == 0 && j == n - 1);
            let meet = if adjacent {
                let (a, b) = if j == i + 1 { (i, j) } else { (j, i) };
                folds_back(segments[a][0], segments[a][1], segments[b][1])
            } else {
                segments_meet(segments[i], segments[j])
            };
            if meet && crossing.is_none_or(|found| (i, j) < found) {
                crossing = Some((i, j));
            }
            true
        });
        let Some((i, j)) = crossing else {
            return Ok(());
        };
        let at = meeting_point(segments[i], segments[j]);
        let (first, second) = (self.input_segment[i] as usize, self.input_segment[j] as usize);
        Err(Error::SelfIntersecting {
            what: what.to_owned(),
            first: first.min(second),
            second: first.max(second),
            at: at.to_array(),
        })
    }

    /// The cleaned points.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Arc length at each point, then the length of the whole curve.
    pub fn arc(&self) -> &[f64] {
        &self.arc
    }

    /// Length of the curve.
    pub fn length(&self) -> f64 {
        self.arc[self.points.len()]
    }

    /// Enclosed area, positive.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Number of input points that were dropped as repetitions.
    pub fn repaired(&self) -> usize {
        self.n_input - self.points.len()
    }

    /// The segments, each from a point to the next.
    pub(crate) fn segments(&self) -> Vec<[DVec2; 2]> {
        (0..self.points.len()).map(|i| [self.points[i], self.points[(i + 1) % self.points.len()]]).collect()
    }

    /// `s` reduced to one turn, from 0 to the length.
    pub fn wrap(&self, s: f64) -> f64 {
        let length = self.length();
        // The remainder is a slow library call.
        let s = if s >= 0.0 && s < length { s } else { s.rem_euclid(length) };
        if s < length { s } else { 0.0 }
    }

    /// The segment on which arc length `s` (of any turn) lies, and the parameter on it, 0 to 1.
    pub fn locate(&self, s: f64) -> (usize, f64) {
        let s = self.wrap(s);
        let segment = self.arc.partition_point(|&a| a <= s).clamp(1, self.points.len()) - 1;
        let t = (s - self.arc[segment]) / (self.arc[segment + 1] - self.arc[segment]);
        (segment, t.clamp(0.0, 1.0))
    }

    /// The point at a parameter of a segment. At 0 and 1 it is a drawn point, bit for bit.
    pub fn point_on(&self, segment: usize, t: f64) -> DVec2 {
        let (a, b) = (self.points[segment], self.points[(segment + 1) % self.points.len()]);
        if t >= 1.0 { b } else { a + t * (b - a) }
    }

    /// The point at arc length `s`.
    pub fn point_at(&self, s: f64) -> DVec2 {
        let (segment, t) = self.locate(s);
        self.point_on(segment, t)
    }

    /// Likewise, searching ahead from a segment, which is updated.
    fn point_from(&self, s: f64, segment: &mut usize) -> DVec2 {
        let s = self.wrap(s);
        if s < self.arc[*segment] {
            *segment = 0;
        }
        while self.arc[*segment + 1] <= s {
            *segment += 1;
        }
        let (from, to) = (self.arc[*segment], self.arc[*segment + 1]);
        self.point_on(*segment, ((s - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// Arc length of `s` measured from the input's first point, in the curve's direction.
    pub fn input_arc(&self, s: f64) -> f64 {
        self.wrap(s - self.first)
    }

    /// The input segment (`i` runs from input point `i` to the next) on which arc length `s` lies,
    /// and the parameter on it.
    pub fn source(&self, s: f64) -> (u32, f64) {
        let (segment, t) = self.locate(s);
        (self.input_segment[segment], if self.reversed { 1.0 - t } else { t })
    }

    /// The turning angle at each point, from the chord of length `window` before to the one after.
    ///
    /// Positive where the curve turns left. Measuring over a window makes the angle a property of
    /// the shape at that scale, not of how densely it was sampled (the pointwise curvature of
    /// section IV-C, integrated).
    pub fn turning(&self, window: f64) -> Vec<f64> {
        let (mut back, mut ahead) = (self.locate(self.arc[0] - window).0, 0);
        (0..self.points.len())
            .map(|i| {
                let p = self.points[i];
                let before = p - self.point_from(self.arc[i] - window, &mut back);
                let after = self.point_from(self.arc[i] + window, &mut ahead) - p;
                libm::atan2(before.perp_dot(after), before.dot(after))
            })
            .collect()
    }
}

/// Least and greatest coordinates.
pub(crate) fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    points.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
}

fn doubled_area(order: &[usize], input: &[DVec2]) -> f64 {
    let Some(&first) = order.first() else {
        return 0.0;
    };
    let origin = input[first];
    (1..order.len()).map(|k| (input[order[k - 1]] - origin).perp_dot(input[order[k]] - origin)).sum()
}

/// Which point is farthest from the centroid of the closed line.
fn farthest_from_centroid(order: &[usize], input: &[DVec2]) -> usize {
    let origin = input[order[0]];
    let from_origin = |k: usize| input[order[k % order.len()]] - origin;
    let (mut sum, mut length) = (DVec2::ZERO, 0.0);
    for k in 0..order.len() {
        let (a, b) = (from_origin(k), from_origin(k + 1));
        sum += a.distance(b) * 0.5 * (a + b);
        length += a.distance(b);
    }
    let centroid = sum / length;
    let away = |k: &usize| from_origin(*k).distance_squared(centroid);
    (0..order.len()).rev().max_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
}

fn input_segments(kept: &[usize], reversed: bool, input: &[DVec2]) -> Vec<u32> {
    let n = input.len();
    let length = |i: usize| input[i].distance_squared(input[(i + 1) % n]);
    (0..kept.len())
        .map(|k| {
            let (from, to) = (kept[k], kept[(k + 1) % kept.len()]);
            let (from, to) = if reversed { (to, from) } else { (from, to) };
            let mut longest = from;
            let mut i = (from + 1) % n;
            while i != to {
                if length(i) > length(longest) {
                    longest = i;
                }
                i = (i + 1) % n;
            }
            longest as u32
        })
        .collect()
}

/// True if the path `a b c` turns back on itself at `b`.
fn folds_back(a: DVec2, b: DVec2, c: DVec2) -> bool {
    orientation(a, b, c) == 0.0 && (b - a).dot(c - b) < 0.0
}

/// A common point of two segments that meet, for messages.
fn meeting_point([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> DVec2 {
    let (ab, cd) = (b - a, d - c);
    let cross = ab.perp_dot(cd);
    let t = (c - a).perp_dot(cd) / cross;
    if t.is_finite() { a + t.clamp(0.0, 1.0) * ab } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(coords: &[[f64; 2]]) -> Vec<DVec2> {
        coords.iter().map(|&c| DVec2::from_array(c)).collect()
    }

    fn outline(coords: &[[f64; 2]]) -> Result<ClosedCurve> {
        ClosedCurve::new(&points(coords), Winding::CounterClockwise, "outline")
    }

    const L: [[f64; 2]; 6] = [[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [2.0, 2.0], [2.0, 4.0], [1.0, 4.0]];

    #[test]
    fn start_and_direction_do_not_matter() -> Result<()> {
        let first = outline(&L)?;
        assert_eq!(first.area(), 4.0);
        for shift in 0..6 {
            let mut drawn = L;
            drawn.rotate_left(shift);
            for _ in 0..2 {
                let curve = outline(&drawn)?;
                assert_eq!(curve.points(), first.points());
                assert_eq!(curve.arc(), first.arc());
                drawn.reverse();
            }
        }
        Ok(())
    }

    #[test]
    fn source_and_arc_lead_back_to_the_input() -> Result<()> {
        let mut drawn = points(&L);
        drawn.insert(2, drawn[1]);
        drawn.push(drawn[0]);
        for _ in 0..2 {
            for winding in [Winding::CounterClockwise, Winding::Clockwise] {
                let curve = ClosedCurve::new(&drawn, winding, "outline")?;
                assert_eq!(curve.repaired(), 2);
                for k in 0..100 {
                    let s = curve.length() * f64::from(k) / 100.0;
                    let (segment, t) = curve.source(s);
                    let a = drawn[segment as usize];
                    let b = drawn[(segment as usize + 1) % drawn.len()];
                    assert!((a + t * (b - a)).distance(curve.point_at(s)) < 1e-12);
                }
                let at_first = (0..6).find(|&i| curve.points()[i] == drawn[0]).map(|i| curve.arc()[i]);
                assert_eq!(at_first.map(|s| curve.input_arc(s)), Some(0.0));
            }
            drawn.reverse();
        }
        Ok(())
    }

    #[test]
    fn bad_outlines_are_refused_by_name() {
        let kind = |coords: &[[f64; 2]]| outline(coords).err().map(|e| e.kind());
        assert_eq!(kind(&[]), Some("too_few_points"));
        assert_eq!(kind(&[[0.0, 0.0]; 5]), Some("too_few_points"));
        assert_eq!(kind(&[[0.0, 0.0], [1.0, 0.0]]), Some("too_few_points"));
        assert_eq!(kind(&[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]]), Some("not_finite"));
        assert_eq!(kind(&[[-1e308, 0.0], [1e308, 0.0], [0.0, 1e308]]), Some("extreme_size"));
        assert_eq!(kind(&[[0.0, 0.0], [1e-99, 0.0], [0.0, 1e-99]]), Some("extreme_size"));
        assert_eq!(kind(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), Some("zero_area"));
        assert_eq!(kind(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), Some("self_intersecting"));
        assert_eq!(kind(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 2.0]]), Some("self_intersecting"));
        let spike = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(kind(&spike), Some("self_intersecting"));
        // The letter Q of a font ends a thousandth beyond where it began, and goes back.
        let short = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.001], [2.0, 1.999], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(kind(&short), None);
        let touch = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
        assert_eq!(kind(&touch), Some("self_intersecting"));
    }

    #[test]
    fn turning_is_measured_at_the_scale_of_the_window() -> Result<()> {
        // A square whose corners are rounded by a radius of 0.01, densely sampled.
        let mut drawn = Vec::new();
        for corner in 0..4 {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(corner);
            let centre = DVec2::from_angle(angle + std::f64::consts::FRAC_PI_4) * 2f64.sqrt();
            for k in 0..=16 {
                let a = angle + std::f64::consts::FRAC_PI_2 * f64::from(k) / 16.0;
                drawn.push(centre + 0.01 * DVec2::from_angle(a));
            }
        }
        let curve = ClosedCurve::new(&drawn, Winding::CounterClockwise, "outline")?;
        let fine = curve.turning(1e-4).into_iter().fold(0.0, f64::max);
        let coarse = curve.turning(0.2).into_iter().fold(0.0, f64::max);
        assert!(fine < 0.2 && coarse > 1.3, "{fine} {coarse}");
        Ok(())
    }
}
