//! Drawings joined, or cut from each other: the outlines, before anything is meshed.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::overlay::FloatOverlay;

use crate::drawing::curve::bounds;
use crate::drawing::union::{SOLVER, outer_outline};
use crate::error::{Error, Result};
use crate::geometry::polygon::{SIZES, signed_area};

/// What becomes of two drawings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combination {
    /// What is in one or the other.
    Union,
    /// What is in the first but not in the other.
    Difference,
}

/// A part of the result: its outline and its holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Counter-clockwise.
    pub outline: Vec<DVec2>,
    /// Clockwise.
    pub holes: Vec<Vec<DVec2>>,
}

/// Parts and holes smaller than this share of the first drawing's box are slivers along a line that both
/// share: dropped.
const SLIVER: f64 = 1e-5;

/// Joins the drawing of an outline and its holes with another outline, or cuts that from it.
///
/// Of an outline that crosses itself its outer outline counts. Points away from crossings are the
/// drawn ones, to about 1e-15 of the size. The largest part comes first; there is none where a
/// difference leaves nothing. Time grows as n log n for n points and crossings.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::ZeroArea`] and [`Error::Disconnected`], as of an outline that crosses itself;
/// [`Error::ExtremeSize`] if the first outline, or both together, are not between 1e-30 and 1e30 across.
pub fn combine(
    outline: &[DVec2],
    holes: &[Vec<DVec2>],
    other: &[DVec2],
    how: Combination,
) -> Result<Vec<Part>> {
    let mut first = vec![outer_outline(outline, "outline")?.0];
    for (k, hole) in holes.iter().enumerate() {
        first.push(outer_outline(hole, &format!("hole {k}"))?.0);
    }
    let second = outer_outline(other, "other outline")?.0;
    let (low, high) = bounds(outline);
    let size = (high - low).max_element();
    check_size("outline", size)?;
    let (far_low, far_high) = bounds(other);
    check_size("other outline", (high.max(far_high) - low.min(far_low)).max_element())?;
    let unit = |points: &Vec<DVec2>| -> Vec<[f64; 2]> {
        points.iter().map(|&p| ((p - low) / size).to_array()).collect()
    };
    let (first, second): (Vec<_>, _) = (first.iter().map(unit).collect(), unit(&second));
    let rule = match how {
        Combination::Union => OverlayRule::Union,
        Combination::Difference => OverlayRule::Difference,
    };
    let both = FloatOverlay::<[f64; 2], i64>::from_subj_and_clip_custom;
    let shapes = both(&first, &second, Default::default(), SOLVER).overlay(rule, FillRule::EvenOdd);
    let drawn = |contour: Vec<[f64; 2]>| -> Vec<DVec2> {
        contour.into_iter().map(|p| low + size * DVec2::from_array(p)).collect()
    };
    let least = SLIVER * (high - low).x * (high - low).y;
    let mut parts: Vec<Part> = Vec::new();
    for shape in shapes {
        let mut contours = shape.into_iter().map(drawn).filter(|c| signed_area(c).abs() > least);
        if let Some(outline) = contours.next()
            && signed_area(&outline) > 0.0
        {
            parts.push(Part { outline, holes: contours.collect() });
        }
    }
    parts.sort_by(|a, b| signed_area(&b.outline).total_cmp(&signed_area(&a.outline)));
    Ok(parts)
}

/// The boolean works in units of the first drawing, where the other must have finite squares.
fn check_size(what: &str, size: f64) -> Result<()> {
    match SIZES.contains(&size) {
        true => Ok(()),
        false => Err(Error::ExtremeSize { what: what.to_owned(), size }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, side: f64) -> Vec<DVec2> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|p| DVec2::new(x, y) + side * DVec2::from_array(p))
            .to_vec()
    }

    fn areas(parts: &[Part]) -> Vec<(f64, Vec<f64>)> {
        let area = |points: &Vec<DVec2>| (1e9 * signed_area(points)).round() / 1e9;
        parts.iter().map(|part| (area(&part.outline), part.holes.iter().map(area).collect())).collect()
    }

    #[test]
    fn crossing_squares() {
        let (a, b) = (square(0.0, 0.0, 4.0), square(3.0, 1.0, 2.0));
        let both = |how| areas(&combine(&a, &[], &b, how).unwrap());
        assert_eq!(both(Combination::Union), [(18.0, vec![])]);
        assert_eq!(both(Combination::Difference), [(14.0, vec![])]);
    }

    #[test]
    fn a_cut_through_leaves_two_parts_the_larger_first() {
        let (a, b) = (square(0.0, 0.0, 4.0), vec![[1.0, -1.0], [1.5, -1.0], [1.5, 5.0], [1.0, 5.0]]);
        let b: Vec<DVec2> = b.into_iter().map(DVec2::from_array).collect();
        assert_eq!(
            areas(&combine(&a, &[], &b, Combination::Difference).unwrap()),
            [(10.0, vec![]), (4.0, vec![])]
        );
    }

    #[test]
    fn inside_it_is_a_hole_and_holes_stay() {
        let (a, b) = (square(0.0, 0.0, 10.0), square(6.0, 6.0, 2.0));
        let hole = square(1.0, 1.0, 3.0);
        let parts = combine(&a, std::slice::from_ref(&hole), &b, Combination::Difference).unwrap();
        assert_eq!(areas(&parts).len(), 1);
        let mut holes = areas(&parts)[0].1.clone();
        holes.sort_by(f64::total_cmp);
        assert_eq!((areas(&parts)[0].0, holes), (100.0, vec![-9.0, -4.0]));
        // Drawn over the hole, the union closes the part that it covers.
        let over = square(0.5, 0.5, 4.0);
        assert_eq!(areas(&combine(&a, &[hole], &over, Combination::Union).unwrap()), [(100.0, vec![])]);
    }

    #[test]
    fn an_outline_beyond_all_measure_is_refused() {
        let (near, far) = (square(0.0, 0.0, 1.0), square(0.0, 0.0, 1e200));
        for (a, b) in [(&near, &far), (&far, &near), (&near, &square(0.0, 0.0, 1e31))] {
            let refused = combine(a, &[], b, Combination::Union).map_err(|error| error.kind());
            assert_eq!(refused, Err("extreme_size"));
        }
        assert!(combine(&near, &[], &square(0.0, 0.0, 1e29), Combination::Union).is_ok());
    }

    #[test]
    fn nothing_left_is_no_part() {
        let parts =
            combine(&square(1.0, 1.0, 1.0), &[], &square(0.0, 0.0, 3.0), Combination::Difference).unwrap();
        assert!(parts.is_empty());
    }
}
