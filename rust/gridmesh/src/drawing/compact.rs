//! Outlines that are about as long as wide, without anything that sticks out.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::geometry::segments::orientation;

/// A convex outline with less than this many squares of its least width is compact: it has no limbs. Its hull may be larger by
/// this share.
const COMPACT: f64 = 1.5;
const CONVEX: f64 = 1e-3;

/// Whether an outline is all but convex and about as long as it is wide.
pub(super) fn is_compact(outline: &ClosedCurve) -> bool {
    let mut hull = hull(outline.points());
    let Some(&first) = hull.first() else { return false };
    let area = outline.area().abs();
    let around: f64 = hull.windows(2).map(|w| 0.5 * (w[0] - first).perp_dot(w[1] - first)).sum();
    if around > (1.0 + CONVEX) * area {
        return false;
    }
    hull.push(first);
    // The least width of a convex polygon is across one of its sides.
    let across = |side: &[DVec2]| {
        let along = (side[1] - side[0]).normalize_or_zero();
        hull.iter().map(|&p| along.perp_dot(p - side[0])).fold(0.0, f64::max)
    };
    let least = hull.windows(2).map(across).fold(f64::INFINITY, f64::min);
    area < COMPACT * least * least
}

/// The corners of the convex hull, counter-clockwise. Source: Andrew 1979.
fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut kept: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = kept[..]
                && orientation(a, b, point) <= 0.0
            {
                kept.pop();
            }
            kept.push(point);
        }
        kept.pop();
        kept
    };
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    hull
}
