//! Contours moved outward: which way, how far in a smooth course, and holes no farther than they can be.

use glam::DVec2;

use crate::drawing::curve::{ClosedCurve, Winding};

/// Times that the moves of a hole that would cross itself are halved.
const HALVES: usize = 2;

/// Contours moved along the unit vectors `outward` of their points, each point as far as `moved` says.
///
/// Holes that would cross themselves are moved half as far, or a quarter, or not at all, and `moved` says so then: unlike those of an
/// outline, no pieces of them can be left out.
pub(super) fn moved_outward(
    fine: &[Vec<DVec2>],
    outward: &[Vec<DVec2>],
    moved: &mut [Vec<f64>],
) -> Vec<Vec<DVec2>> {
    let of = |(k, far): (usize, &mut Vec<f64>)| {
        for _ in 0..=HALVES {
            let points = fine[k].iter().zip(&*far).zip(&outward[k]);
            let points: Vec<DVec2> = points.map(|((&p, &far), &n)| p + far * n).collect();
            if k == 0 || ClosedCurve::new(&points, Winding::Clockwise, "hole").is_ok() {
                return points;
            }
            far.iter_mut().for_each(|far| *far *= 0.5);
        }
        far.fill(0.0);
        fine[k].clone()
    };
    moved.iter_mut().enumerate().map(of).collect()
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
    fn holes_that_would_cross_themselves_are_moved_less() {
        let drawn = ring(120, 6.0);
        // Clockwise: one with corners whose sides meet, if they are moved by more than there is between points, and one without.
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(DVec2::from);
        let square = dense(&ClosedCurve::new(&corners, Winding::Clockwise, "hole").unwrap(), 0.1);
        let round: Vec<DVec2> = ring(40, 0.8).into_iter().rev().map(|p| p + DVec2::new(3.0, 0.0)).collect();
        let fine = [drawn, square, round];
        let outward: Vec<Vec<DVec2>> = fine.iter().map(|contour| normals(contour)).collect();
        for (far, share) in [(0.08, 1.0), (0.15, 0.5), (0.3, 0.25), (0.9, 0.0)] {
            let mut moved: Vec<Vec<f64>> = fine.iter().map(|contour| vec![far; contour.len()]).collect();
            moved[2].fill(0.2);
            let wider = moved_outward(&fine, &outward, &mut moved);
            assert!(read_contours(&wider[0], &wider[1..]).is_ok());
            let by = [far, share * far, 0.2];
            for (k, by) in by.into_iter().enumerate() {
                assert!(moved[k].iter().all(|&moved| moved == by), "{far} {k}");
                let points = wider[k].iter().zip(&fine[k]);
                assert!(points.into_iter().all(|(a, b)| (a.distance(*b) - by).abs() < 1e-12), "{far} {k}");
            }
        }
    }
}
