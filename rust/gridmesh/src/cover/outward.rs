//! Contours moved outward: which way, how far in a smooth course, and holes no farther than they can be.

use glam::DVec2;

use crate::geometry::segments::{SegmentGrid, segments_meet};

/// Times that moves are halved where a contour would cross itself; it stays where it was after them.
const HALVES: usize = 5;

/// Contours moved along the unit vectors `outward` of their points, each point as far as `moved` says.
///
/// Where one would cross itself its points are moved less, within `reach` along it, and `moved` says so then: at corners that turn
/// inward the two sides meet.
pub(super) fn moved_outward(
    fine: &[Vec<DVec2>],
    outward: &[Vec<DVec2>],
    moved: &mut [Vec<f64>],
    reach: f64,
) -> Vec<Vec<DVec2>> {
    let of = |(k, far): (usize, &mut Vec<f64>)| {
        let wider = |far: &[f64]| -> Vec<DVec2> {
            fine[k].iter().zip(far).zip(&outward[k]).map(|((&p, &far), &n)| p + far * n).collect()
        };
        for half in 0..=HALVES {
            let points = wider(far);
            let crossing = crossing(&points);
            if crossing.is_empty() {
                return points;
            }
            let share = if half < HALVES { 0.5 } else { 0.0 };
            for i in near(&fine[k], &crossing, reach) {
                far[i] *= share;
            }
        }
        let points = wider(far);
        if crossing(&points).is_empty() {
            return points;
        }
        far.fill(0.0);
        fine[k].clone()
    };
    moved.iter_mut().enumerate().map(of).collect()
}

/// The segments of a closed contour that meet others than their neighbours.
fn crossing(points: &[DVec2]) -> Vec<usize> {
    let n = points.len();
    let segments: Vec<[DVec2; 2]> = (0..n).map(|i| [points[i], points[(i + 1) % n]]).collect();
    let mut found = Vec::new();
    SegmentGrid::new(&segments).pairs(|i, j| {
        let is_adjacent = j == i + 1 || (i == 0 && j == n - 1);
        if !is_adjacent && segments_meet(segments[i], segments[j]) {
            found.extend([i, j]);
        }
        true
    });
    found
}

/// The points of a contour within `reach` of some of its segments, along it, ascending.
fn near(contour: &[DVec2], segments: &[usize], reach: f64) -> Vec<usize> {
    let n = contour.len();
    let mut is_near = vec![false; n];
    for &segment in segments {
        for (start, step) in [(segment, n - 1), (segment + 1, 1)] {
            let (mut at, mut way) = (start % n, 0.0);
            while way <= reach {
                is_near[at] = true;
                let next = (at + step) % n;
                way += contour[at].distance(contour[next]);
                at = next;
            }
        }
    }
    (0..n).filter(|&i| is_near[i]).collect()
}

/// Unit vectors out of the drawing at the points of a contour that has the drawing on its left.
pub(super) fn normals(contour: &[DVec2]) -> Vec<DVec2> {
    let n = contour.len();
    let along = |k: usize| (contour[(k + 1) % n] - contour[k]).normalize_or_zero();
    (0..n).map(|k| -(along((k + n - 1) % n) + along(k)).normalize_or_zero().perp()).collect()
}

/// A smooth course along a contour that is nowhere below the need: its largest value within `reach`, averaged.
pub(super) fn spread(contour: &[DVec2], need: &[f64], reach: f64) -> Vec<f64> {
    let n = contour.len();
    let length: f64 = (0..n).map(|k| contour[k].distance(contour[(k + 1) % n])).sum();
    let steps = ((reach * n as f64 / length).round().max(1.0) as usize).min((n - 1) / 2);
    let around = |values: &[f64], k: usize, half: usize| -> Vec<f64> {
        (0..=2 * half).map(|at| values[(k + n - half + at) % n]).collect()
    };
    let highest: Vec<f64> = (0..n).map(|k| around(need, k, steps).into_iter().fold(0.0, f64::max)).collect();
    let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    (0..n).map(|k| mean(around(&highest, k, steps / 2))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cover::dense;
    use crate::cover::tests::ring;
    use crate::drawing::contours::read_contours;
    use crate::drawing::curve::{ClosedCurve, Winding};

    #[test]
    fn what_is_spread_is_nowhere_below_the_need() {
        let contour = ring(240, 3.0);
        let need: Vec<f64> = (0..240).map(|k| if k % 37 == 5 { 0.1 * (k % 7) as f64 } else { 0.0 }).collect();
        let course = spread(&contour, &need, 0.4);
        assert!(course.iter().zip(&need).all(|(course, need)| course + 1e-12 >= *need));
        let steps = course.iter().zip(course.iter().cycle().skip(1)).map(|(a, b)| (a - b).abs());
        assert!(steps.fold(0.0, f64::max) < 0.2);
    }

    #[test]
    fn normals_point_out_of_the_drawing() {
        let contour = ring(50, 2.0);
        for (normal, point) in normals(&contour).into_iter().zip(contour) {
            assert!(normal.dot(point) > 1.99);
        }
    }

    #[test]
    fn contours_that_would_cross_themselves_are_moved_less_there() {
        let l = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]].map(DVec2::from);
        let shape = dense(&ClosedCurve::new(&l, Winding::CounterClockwise, "outline").unwrap(), 0.1);
        // Clockwise: one with corners whose sides meet, if they are moved by more than there is between points, and one without.
        let corners =
            [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|c| DVec2::from(c) * 0.2 + 0.5);
        let square = dense(&ClosedCurve::new(&corners, Winding::Clockwise, "hole").unwrap(), 0.01);
        let round: Vec<DVec2> = ring(40, 0.2).into_iter().rev().map(|p| p + DVec2::new(3.0, 0.5)).collect();
        let fine = [shape, square, round];
        let outward: Vec<Vec<DVec2>> = fine.iter().map(|contour| normals(contour)).collect();
        for far in [0.008, 0.05, 0.09] {
            let mut moved: Vec<Vec<f64>> = fine.iter().map(|contour| vec![far; contour.len()]).collect();
            let wider = moved_outward(&fine, &outward, &mut moved, 0.15);
            assert!(read_contours(&wider[0], &wider[1..]).is_ok());
            for (k, points) in wider.iter().enumerate() {
                let by = points.iter().zip(&fine[k]).map(|(a, b)| a.distance(*b));
                assert!(by.zip(&moved[k]).all(|(by, moved)| (by - moved).abs() < 1e-12 && *moved <= far));
            }
            // Away from the corner that turns inward all is moved as it was to be.
            let inward = DVec2::new(1.0, 1.0);
            let is_free = |p: &DVec2| p.distance(inward) > 0.15 + 2.0 * far + 0.1;
            assert!(
                fine[0].iter().zip(&moved[0]).filter(|(p, _)| is_free(p)).all(|(_, &moved)| moved == far)
            );
            assert!(moved[2].iter().all(|&moved| moved == far));
        }
    }
}
