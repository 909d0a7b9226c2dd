//! The outer outline of a drawing that crosses itself.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::solver::{Precision, Solver};
use i_overlay::float::simplify::SimplifyShape;

use crate::drawing::curve::bounds;
use crate::error::{Error, Result};
use crate::geometry::polygon::signed_area;
use crate::geometry::segments::SegmentGrid;

/// Parts smaller than this share of the largest one are slivers of a shaky crossing: dropped.
const SLIVER: f64 = 1e-3;

/// Crossings are rounded, which makes lines cross anew. In each round ends attract what is within four times the distance of the
/// round before; with the library's factor of 1.4, 23 points of sizes from 1e-9 to 1e10 fell into 790 parts, in
/// 120 times the time.
pub(super) const SOLVER: Solver =
    Solver { precision: Precision { start: 0, progression: 4 }, ..Solver::AUTO };

/// The outline of everything that a closed stroke goes round, whichever way round (non-zero
/// winding), without inner holes.
///
/// Where the stroke does not cross itself the points are the drawn ones, to about 1e-15 of the
/// drawing's size. Returns the number of slivers left out, too.
///
/// # Errors
/// [`Error::NotFinite`]; [`Error::ZeroArea`] if nothing is enclosed; [`Error::Disconnected`] if
/// the stroke encloses parts that meet in single points only, like a figure eight.
pub(crate) fn outer_outline(input: &[DVec2], what: &str) -> Result<(Vec<DVec2>, usize)> {
    if let Some(point) = input.iter().position(|p| !p.is_finite()) {
        return Err(Error::NotFinite { what: what.to_owned(), point });
    }
    // In the unit box: the boolean works on a grid of integers.
    let (low, high) = bounds(input);
    let size = (high - low).max_element();
    if input.len() < 3 || size <= 0.0 || !size.is_finite() {
        return Err(Error::ZeroArea { what: what.to_owned() });
    }
    let points: Vec<[f64; 2]> = input.iter().map(|&p| ((p - low) / size).to_array()).collect();
    let shapes =
        points.as_slice().simplify_shape_custom_as::<i64>(FillRule::NonZero, Default::default(), SOLVER);
    let mut parts: Vec<Vec<DVec2>> = shapes
        .into_iter()
        .filter_map(|shape| shape.into_iter().next())
        .map(|contour| contour.into_iter().map(|p| low + size * DVec2::from_array(p)).collect())
        .collect();
    parts.sort_by(|a, b| area(b).total_cmp(&area(a)));
    let Some(largest) = parts.first().map(|part| area(part)) else {
        return Err(Error::ZeroArea { what: what.to_owned() });
    };
    let large = parts.iter().filter(|part| area(part) > SLIVER * largest).count();
    if large > 1 {
        return Err(Error::Disconnected { what: what.to_owned(), parts: large });
    }
    let slivers = parts.len() - 1;
    Ok((parts.swap_remove(0), slivers))
}

/// The input segment nearest to each point, and the parameter on it. Near-linear.
pub(crate) fn nearest_sources(input: &[DVec2], points: &[DVec2]) -> Vec<(u32, f64)> {
    let segments: Vec<[DVec2; 2]> =
        (0..input.len()).map(|i| [input[i], input[(i + 1) % input.len()]]).collect();
    let grid = SegmentGrid::new(&segments);
    let nearest = |&point: &DVec2| {
        let (segment, t) = grid.nearest(&segments, point);
        (segment as u32, t)
    };
    points.iter().map(nearest).collect()
}

fn area(points: &[DVec2]) -> f64 {
    signed_area(points).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(coords: &[[f64; 2]]) -> Vec<DVec2> {
        coords.iter().map(|&c| DVec2::from_array(c)).collect()
    }

    #[test]
    fn a_loop_in_the_stroke_is_taken_in() {
        // A square whose stroke crosses itself on the way.
        let drawn = points(&[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 5.0],
            [3.0, 5.0],
            [3.0, 2.0],
            [5.0, 2.0],
            [5.0, 4.0],
            [0.0, 4.0],
        ]);
        let (outline, slivers) = outer_outline(&drawn, "outline").unwrap();
        assert!((area(&outline) - 19.0).abs() < 1e-9, "{}", area(&outline));
        assert_eq!(slivers, 0);
        for p in outline {
            let (segment, t) = nearest_sources(&drawn, &[p])[0];
            let (a, b) = (drawn[segment as usize], drawn[(segment as usize + 1) % drawn.len()]);
            assert!(a.lerp(b, t).distance(p) < 1e-12);
        }
    }

    #[test]
    fn nearly_parallel_lines_of_very_different_lengths_do_not_fall_into_hundreds_of_slivers() {
        let drawn = points(&[
            [-1.0, -5e9],
            [7e-9, 7.0],
            [7.0, 7.0],
            [-6.0, -8e9],
            [-5.0, -3.0],
            [-1.0, -5e9],
            [7e-9, -7.8046875],
            [-6.0, -5.0],
            [-8e9, 0.0],
            [4.0, 4.0],
            [-4.0, 3.0],
            [4.23828125, -1.9453125],
            [2e-9, -3.0],
            [-1.0, -5e9],
            [7e-9, -6e-9],
            [-5.0, -8e9],
            [0.0, 4.0],
            [4.0, -4.0],
            [3.0, 4.23828125],
            [-1.9453125, 2e-9],
            [5e-9, -8e-9],
            [-8.0, 5e-9],
            [-8e-9, -8.0],
        ]);
        let found = outer_outline(&drawn, "outline");
        assert!(found.as_ref().is_ok_and(|(_, slivers)| *slivers < 400), "{found:?}");
    }

    #[test]
    fn a_figure_eight_is_refused() {
        let drawn = points(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]]);
        assert_eq!(outer_outline(&drawn, "outline").map_err(|e| e.kind()), Err("disconnected"));
    }
}
