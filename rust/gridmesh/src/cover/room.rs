//! How far contours may be moved outward before they meet: an inlet that a wider outline closes would be filled.

use glam::DVec2;

use crate::cover::outward::spread;
use crate::geometry::segments::SegmentGrid;

/// Part of the way to what lies opposite that a point may go: both sides may.
const PART: f64 = 0.45;

/// Limits change along contours over this, in edge lengths.
const AROUND: f64 = 0.4;

/// For each point of the contours how far it may move along its unit vector `outward`, at most `most`, without meeting what lies
/// opposite and moves too. The drawing is on the left of each contour.
pub(super) fn outward(
    fine: &[Vec<DVec2>],
    outward: &[Vec<DVec2>],
    most: f64,
    edge_length: f64,
) -> Vec<Vec<f64>> {
    let mut segments = Vec::new();
    let mut starts = Vec::with_capacity(fine.len());
    for contour in fine {
        starts.push(segments.len());
        let n = contour.len();
        segments.extend((0..n).map(|i| [contour[i], contour[(i + 1) % n]]));
    }
    let grid = SegmentGrid::new(&segments);
    let far = most / PART;
    let of = |k: usize| {
        let n = fine[k].len();
        let lacks = |i: usize| {
            let (from, to) = (fine[k][i], fine[k][i] + far * outward[k][i]);
            let beside = [starts[k] + i, starts[k] + (i + n - 1) % n];
            let mut nearest = 1.0f64;
            grid.near(from.min(to), from.max(to), |at| {
                if !beside.contains(&at) {
                    nearest = nearest.min(crossing([from, to], segments[at]).unwrap_or(1.0));
                }
            });
            most - PART * far * nearest
        };
        let lacking = spread(&fine[k], &(0..n).map(lacks).collect::<Vec<f64>>(), AROUND * edge_length);
        lacking.into_iter().map(|lacking| most - lacking).collect()
    };
    (0..fine.len()).map(of).collect()
}

/// Where along the first segment the second one crosses it.
fn crossing([from, to]: [DVec2; 2], [a, b]: [DVec2; 2]) -> Option<f64> {
    let (way, side) = (to - from, b - a);
    let turn = way.perp_dot(side);
    let (along, across) = ((a - from).perp_dot(side) / turn, (a - from).perp_dot(way) / turn);
    (turn != 0.0 && (0.0..=1.0).contains(&along) && (0.0..=1.0).contains(&across)).then_some(along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cover::outward::normals;

    #[test]
    fn walls_of_an_inlet_leave_each_other_room() {
        let corners = [(0., 0.), (10., 0.), (10., 8.), (5.5, 8.), (5.5, 3.), (4.5, 3.), (4.5, 8.), (0., 8.)];
        let mut contour = Vec::new();
        for (k, &a) in corners.iter().enumerate() {
            let (a, b) = (DVec2::from(a), DVec2::from(corners[(k + 1) % corners.len()]));
            let count = (4.0 * a.distance(b)).ceil();
            contour.extend((0..count as usize).map(|i| a.lerp(b, i as f64 / count)));
        }
        let room = outward(&[contour.clone()], &[normals(&contour)], 2.0, 1.0).remove(0);
        for (point, room) in contour.iter().zip(room) {
            if point.y > 3.6 && point.y < 7.4 && (point.x - 5.0).abs() < 0.6 {
                assert!((room - 0.45).abs() < 1e-9, "{point} {room}");
            }
            if point.y == 0.0 {
                assert_eq!(room, 2.0);
            }
        }
    }
}
