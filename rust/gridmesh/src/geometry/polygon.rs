//! Measures of closed lines in the plane.

use std::ops::RangeInclusive;

use glam::DVec2;

/// Sizes of drawings that are meshed: results are proved as rounded to `f32` too, whose numbers end at 1e-38 and 1e38.
pub(crate) const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

/// The area that a closed line encloses: positive if it runs counter-clockwise.
pub(crate) fn signed_area(points: &[DVec2]) -> f64 {
    let Some(&origin) = points.first() else { return 0.0 };
    0.5 * points.windows(2).map(|w| (w[0] - origin).perp_dot(w[1] - origin)).sum::<f64>()
}

/// Its length, back to the first point.
pub(crate) fn perimeter(points: &[DVec2]) -> f64 {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return 0.0 };
    last.distance(*first) + points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_has_its_area_and_perimeter_wherever_it_lies() {
        let mut points = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]].map(|p| DVec2::from(p) + 100.0);
        assert_eq!((signed_area(&points), perimeter(&points)), (12.0, 14.0));
        points.reverse();
        assert_eq!((signed_area(&points), perimeter(&points)), (-12.0, 14.0));
        assert_eq!((signed_area(&[]), perimeter(&[])), (0.0, 0.0));
    }
}
