//! The mirror symmetry of a drawing: its axis, and which point is the image of which.

mod axis;
mod matching;
mod palindromes;

use glam::DVec2;

use crate::drawing::curve::{ClosedCurve, bounds};
use crate::error::{Error, Result};
use crate::options::Mirror;
pub(crate) use axis::Axis;
pub(crate) use matching::Matching;

/// The two sides of a drawing may differ by this much of its size (the diagonal of its box)...
const OF_SIZE: f64 = 0.02;
/// ... and by this many edges.
const OF_EDGE: f64 = 1.5;
/// Drawn points this close to the axis (relative to the size) are on it.
const ON_AXIS: f64 = 1e-13;

/// Contours that are each other's mirror images, or their own.
#[derive(Clone, Debug)]
pub(crate) enum Pairing {
    /// A contour that crosses the axis twice, at `start` to its left and at `end` back.
    Own {
        contour: usize,
        /// Arc length of the crossing to the left of the axis.
        start: f64,
        /// Length from there to the other crossing: the half on the left.
        left: f64,
        /// Length of the other half.
        right: f64,
        /// Fractions of the left half, from `start` on, and of the right one, from `start` back.
        matching: Matching,
    },
    /// Two holes.
    Two {
        /// The one on the left of the axis, and the one on its right.
        contours: [usize; 2],
        /// Arc length on the right one of the image of the left one's first point.
        start: f64,
        /// Fractions of the left one, from its first point on, and of the right one, back.
        matching: Matching,
    },
}

/// A drawing that is its own mirror image, nearly.
#[derive(Clone, Debug)]
pub(crate) struct Symmetry {
    pub(crate) axis: Axis,
    /// The outline first.
    pub(crate) pairings: Vec<Pairing>,
    /// Greatest distance of a point from the image of its partner.
    pub(crate) difference: f64,
}

impl Symmetry {
    /// Finds the axis, if it is not given, and matches the sides.
    ///
    /// # Errors
    /// [`Error::NotSymmetric`] if a point and its partner's image are more than 2 % of the drawing's
    /// size or 1.5 edges apart; [`Error::InvalidOption`] if the axis has no direction.
    pub(crate) fn find(contours: &[ClosedCurve], mirror: Mirror, edge_length: f64) -> Result<Self> {
        let (low, high) = bounds(contours[0].points());
        let size = low.distance(high);
        let axis = match mirror {
            Mirror::Auto => Axis::of(&contours[0]),
            Mirror::Axis { point, direction } => Axis::new(point, direction)?,
        };
        let search = Search { contours, axis, size, allowed: (OF_SIZE * size).min(OF_EDGE * edge_length) };
        let mut pairings = vec![search.own(0)?];
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for (k, contour) in contours.iter().enumerate().skip(1) {
            let sides = contour.points().iter().map(|&p| axis.offset(p));
            let (least, most) =
                sides.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
            if least > 0.0 {
                left.push(k);
            } else if most < 0.0 {
                right.push(k);
            } else {
                pairings.push(search.own(k)?);
            }
        }
        for k in left {
            let wanted = axis.reflected(middle(&contours[k]));
            let far = |j: usize| middle(&contours[j]).distance_squared(wanted);
            let nearest = (0..right.len()).min_by(|&a, &b| far(right[a]).total_cmp(&far(right[b])));
            let Some(nearest) = nearest else {
                return Err(search.refusal(k, f64::INFINITY, contours[k].points()[0]));
            };
            pairings.push(search.two(k, right.swap_remove(nearest))?);
        }
        if let Some(&k) = right.first() {
            return Err(search.refusal(k, f64::INFINITY, contours[k].points()[0]));
        }
        let difference = pairings.iter().map(|pairing| pairing.matching().difference).fold(0.0, f64::max);
        Ok(Self { axis, pairings, difference })
    }

    /// Finer meshes than of this edge length would show that the sides differ.
    pub(crate) fn least_edge_length(&self) -> f64 {
        self.difference / OF_EDGE
    }
}

impl Pairing {
    pub(crate) fn matching(&self) -> &Matching {
        match self {
            Pairing::Own { matching, .. } | Pairing::Two { matching, .. } => matching,
        }
    }
}

struct Search<'a> {
    contours: &'a [ClosedCurve],
    axis: Axis,
    size: f64,
    allowed: f64,
}

impl Search<'_> {
    fn refusal(&self, contour: usize, distance: f64, at: DVec2) -> Error {
        let what = if contour == 0 { "outline".to_owned() } else { format!("hole {}", contour - 1) };
        Error::NotSymmetric { what, distance, allowed: self.allowed, at: at.to_array() }
    }

    fn checked(&self, contour: usize, matching: &Matching) -> Result<()> {
        if matching.difference <= self.allowed {
            return Ok(());
        }
        Err(self.refusal(contour, matching.difference, matching.at))
    }

    /// Matches the two halves of a contour: of all pairs of crossings the best.
    fn own(&self, contour: usize) -> Result<Pairing> {
        const MOST: usize = 8;
        const ROUGH: usize = 64;
        const FINE: usize = 512;
        let curve = &self.contours[contour];
        let (ups, downs) = self.crossings(curve);
        let far = |&p: &DVec2| self.axis.offset(p).abs();
        let farthest = curve.points().iter().copied().max_by(|a, b| far(a).total_cmp(&far(b)));
        let farthest = farthest.unwrap_or_default();
        if ups.is_empty() || ups.len() > MOST {
            return Err(self.refusal(contour, far(&farthest), farthest));
        }
        let halves = |up: f64, down: f64| {
            let left = (down - up).rem_euclid(curve.length());
            (left, curve.length() - left)
        };
        let matched = |up: f64, down: f64, samples: usize| {
            let (left, right) = halves(up, down);
            let ahead = |t: f64| curve.point_at(up + t * left);
            let back = |t: f64| self.axis.reflected(curve.point_at(up - t * right));
            Matching::new(ahead, back, samples, 1e-3 * self.size)
        };
        let mut best: Option<(f64, f64, f64)> = None;
        for &up in &ups {
            for &down in &downs {
                let found = matched(up, down, ROUGH).difference;
                if best.is_none_or(|(least, ..)| found < least) {
                    best = Some((found, up, down));
                }
            }
        }
        let Some((_, start, down)) = best else {
            return Err(self.refusal(contour, far(&farthest), farthest));
        };
        let matching = matched(start, down, FINE);
        self.checked(contour, &matching)?;
        let (left, right) = halves(start, down);
        Ok(Pairing::Own { contour, start, left, right, matching })
    }

    /// Matches a hole on the left with one on the right.
    fn two(&self, left: usize, right: usize) -> Result<Pairing> {
        const FINE: usize = 512;
        let (a, b) = (&self.contours[left], &self.contours[right]);
        let start = nearest_arc(b, self.axis.reflected(a.points()[0]));
        let ahead = |t: f64| a.point_at(t * a.length());
        let back = |t: f64| self.axis.reflected(b.point_at(start - t * b.length()));
        let matching = Matching::new(ahead, back, FINE, 1e-3 * self.size);
        self.checked(left, &matching)?;
        Ok(Pairing::Two { contours: [left, right], start, matching })
    }

    /// Arc lengths where a curve passes to the left of the axis, and where back.
    fn crossings(&self, curve: &ClosedCurve) -> (Vec<f64>, Vec<f64>) {
        let points = curve.points();
        let n = points.len();
        let near = ON_AXIS * self.size;
        let offset: Vec<f64> = points.iter().map(|&p| self.axis.offset(p)).collect();
        let (mut ups, mut downs) = (Vec::new(), Vec::new());
        let Some(first) = (0..n).find(|&i| offset[i].abs() > near) else {
            return (ups, downs);
        };
        let mut last = first;
        for k in first + 1..=first + n {
            let i = k % n;
            if offset[i].abs() <= near {
                continue;
            }
            if (offset[i] > 0.0) != (offset[last % n] > 0.0) {
                let between = k - last;
                let at = if between > 1 {
                    // A drawn point on the axis.
                    curve.arc()[(last + between / 2) % n]
                } else {
                    let (a, b) = (offset[last % n], offset[i]);
                    let from = curve.arc()[last % n];
                    from + a / (a - b) * (curve.arc()[last % n + 1] - from)
                };
                if offset[i] > 0.0 { ups.push(at) } else { downs.push(at) }
            }
            last = k;
        }
        (ups, downs)
    }
}

/// The mean of the drawn line.
fn middle(curve: &ClosedCurve) -> DVec2 {
    let mut sum = DVec2::ZERO;
    for ([a, b], s) in curve.segments().into_iter().zip(curve.arc().windows(2)) {
        sum += 0.5 * (s[1] - s[0]) * (a + b);
    }
    sum / curve.length()
}

/// Arc length of the point of a curve that is nearest to a position.
fn nearest_arc(curve: &ClosedCurve, p: DVec2) -> f64 {
    let mut best = (f64::INFINITY, 0.0);
    for ([a, b], s) in curve.segments().into_iter().zip(curve.arc().windows(2)) {
        let (t, squared) = crate::geometry::segments::nearest_on_segment(p, a, b);
        if squared < best.0 {
            best = (squared, s[0] + t * (s[1] - s[0]));
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::contours::read_contours;

    /// A closed line that is its own image in the vertical axis, turned and moved.
    fn leaf(turn: f64, shift: DVec2) -> Vec<DVec2> {
        let right: Vec<DVec2> = (0..40)
            .map(|i| {
                let t = std::f64::consts::PI * (f64::from(i) + 0.5) / 40.0;
                (2.0 + 0.7 * (3.0 * t).cos() + 0.3 * (2.0 * t).cos()) * DVec2::new(t.sin(), -t.cos())
            })
            .collect();
        let left = right.iter().rev().map(|p| DVec2::new(-p.x, p.y));
        let points: Vec<DVec2> = right.iter().copied().chain(left).collect();
        points.into_iter().map(|p| DVec2::from_angle(turn).rotate(p) + shift).collect()
    }

    #[test]
    fn the_axis_is_found_wherever_the_drawing_lies() -> Result<()> {
        for (turn, shift) in [(0.0, DVec2::ZERO), (0.4, DVec2::new(3.0, -2.0)), (2.9, DVec2::new(-70.0, 9.0))]
        {
            let contours = read_contours(&leaf(turn, shift), &[])?;
            let found = Symmetry::find(&contours, Mirror::Auto, 0.3)?;
            let expected = DVec2::from_angle(turn).rotate(DVec2::Y);
            assert!(found.axis.direction.perp_dot(expected).abs() < 1e-13, "{turn}: {:?}", found.axis);
            assert!(found.axis.offset(shift).abs() < 1e-12 * (1.0 + shift.length()));
            assert!(found.difference < 1e-11, "{}", found.difference);
        }
        Ok(())
    }

    #[test]
    fn an_upright_axis_is_preferred() -> Result<()> {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].map(DVec2::from_array);
        let contours = read_contours(&square, &[])?;
        let found = Symmetry::find(&contours, Mirror::Auto, 0.3)?;
        assert!(
            found.axis.direction.x.abs() < 1e-15 && found.axis.offset(DVec2::new(2.0, 7.0)).abs() < 1e-14
        );
        Ok(())
    }

    #[test]
    fn other_axes_and_drawings_are_refused() -> Result<()> {
        let kind = |points: &[DVec2], mirror: Mirror| -> Result<Option<&'static str>> {
            let contours = read_contours(points, &[])?;
            Ok(Symmetry::find(&contours, mirror, 0.3).err().map(|error| error.kind()))
        };
        let axis = |x: f64, y: f64, dx: f64, dy: f64| Mirror::Axis {
            point: DVec2::new(x, y),
            direction: DVec2::new(dx, dy),
        };
        let points = leaf(0.0, DVec2::ZERO);
        assert_eq!(kind(&points, axis(0.0, 5.0, 0.0, -2.0))?, None);
        assert_eq!(kind(&points, axis(0.3, 0.0, 0.0, 1.0))?, Some("not_symmetric"));
        assert_eq!(kind(&points, axis(30.0, 0.0, 0.0, 1.0))?, Some("not_symmetric"));
        assert_eq!(kind(&points, axis(0.0, 0.0, 1.0, 0.0))?, Some("not_symmetric"));
        assert_eq!(kind(&points, axis(0.0, 0.0, 0.0, 0.0))?, Some("invalid_option"));
        let crooked = [[0.0, 0.0], [4.0, 0.0], [5.0, 3.0], [1.0, 2.0]].map(DVec2::from_array);
        assert_eq!(kind(&crooked, Mirror::Auto)?, Some("not_symmetric"));
        Ok(())
    }

    #[test]
    fn holes_are_matched_in_pairs() -> Result<()> {
        let square = |x: f64, y: f64, half: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|c| DVec2::new(x, y) + half * DVec2::from_array(c))
                .to_vec()
        };
        let mut outline = square(0.0, 0.0, 10.0);
        outline[2].y = 12.0;
        outline[3].y = 12.0;
        let pair = [square(4.0, 1.0, 2.0), square(0.0, -7.0, 1.0), square(-4.0, 1.0, 2.0)];
        let contours = read_contours(&outline, &pair)?;
        let found = Symmetry::find(&contours, Mirror::Auto, 0.3)?;
        assert_eq!(found.pairings.len(), 3);
        assert!(found.difference < 1e-12);
        let contours = read_contours(&outline, &pair[..2])?;
        assert_eq!(
            Symmetry::find(&contours, Mirror::Auto, 0.3).err().map(|e| e.kind()),
            Some("not_symmetric")
        );
        Ok(())
    }
}
