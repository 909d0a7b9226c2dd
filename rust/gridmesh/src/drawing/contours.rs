//! The contours of a drawing, checked against each other.

use glam::DVec2;

use crate::drawing::curve::{ClosedCurve, Winding};
use crate::error::{Error, Result};
use crate::geometry::segments::{SegmentGrid, orientation, segments_meet};

/// Cleans and checks an outline and its holes: the outline first, counter-clockwise, then the
/// holes, clockwise.
///
/// # Errors
/// Those of [`ClosedCurve::new`] for each contour, and [`Error::HoleMisplaced`] if a hole lies
/// outside the outline or inside another hole, or meets another contour.
pub fn read_contours(outline: &[DVec2], holes: &[Vec<DVec2>]) -> Result<Vec<ClosedCurve>> {
    let mut contours = vec![ClosedCurve::new(outline, Winding::CounterClockwise, "outline")?];
    for (i, hole) in holes.iter().enumerate() {
        contours.push(ClosedCurve::new(hole, Winding::Clockwise, &format!("hole {i}"))?);
    }
    if contours.len() > 1 {
        check_apart(&contours)?;
        check_nesting(&contours)?;
    }
    Ok(contours)
}

fn check_apart(contours: &[ClosedCurve]) -> Result<()> {
    let mut segments = Vec::new();
    let mut owner = Vec::new();
    for (k, contour) in contours.iter().enumerate() {
        let own = contour.segments();
        owner.extend(std::iter::repeat_n(k, own.len()));
        segments.extend(own);
    }
    let mut meeting: Option<(usize, usize)> = None;
    SegmentGrid::new(&segments).pairs(|i, j| {
        let pair = (owner[i].min(owner[j]), owner[i].max(owner[j]));
        if pair.0 != pair.1
            && meeting.is_none_or(|found| pair < found)
            && segments_meet(segments[i], segments[j])
        {
            meeting = Some(pair);
        }
        true
    });
    let Some((first, second)) = meeting else {
        return Ok(());
    };
    let reason =
        if first == 0 { "meets the outline".to_owned() } else { format!("meets hole {}", first - 1) };
    Err(Error::HoleMisplaced { hole: second - 1, reason })
}

fn check_nesting(contours: &[ClosedCurve]) -> Result<()> {
    for (k, hole) in contours.iter().enumerate().skip(1) {
        let point = hole.points()[0];
        let misplaced = |reason: String| Err(Error::HoleMisplaced { hole: k - 1, reason });
        if !encloses(contours[0].points(), point) {
            return misplaced("lies outside the outline".to_owned());
        }
        let around = (1..contours.len()).find(|&j| j != k && encloses(contours[j].points(), point));
        if let Some(j) = around {
            return misplaced(format!("lies inside hole {}", j - 1));
        }
    }
    Ok(())
}

/// True if a point that is not on the polygon lies inside it (exact).
pub fn encloses(polygon: &[DVec2], point: DVec2) -> bool {
    let mut inside = false;
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let upward = a.y <= point.y && b.y > point.y;
        let downward = b.y <= point.y && a.y > point.y;
        if (upward && orientation(a, b, point) > 0.0) || (downward && orientation(a, b, point) < 0.0) {
            inside = !inside;
        }
    }
    inside
}

/// The centroid of the area that a polygon encloses, which is closed implicitly.
pub(crate) fn centroid(points: &[DVec2]) -> DVec2 {
    let origin = points[0];
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for pair in points.windows(2) {
        let (a, b) = (pair[0] - origin, pair[1] - origin);
        let cross = a.perp_dot(b);
        area += cross;
        sum += cross * (a + b);
    }
    origin + sum / (3.0 * area)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, half: f64) -> Vec<DVec2> {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|c| DVec2::new(x, y) + half * DVec2::from_array(c))
            .to_vec()
    }

    #[test]
    fn holes_must_lie_inside_and_apart() {
        let outline = square(0.0, 0.0, 10.0);
        let reason = |holes: &[Vec<DVec2>]| match read_contours(&outline, holes) {
            Err(Error::HoleMisplaced { hole, reason }) => format!("{hole} {reason}"),
            other => format!("{:?}", other.map(|contours| contours.len())),
        };
        assert_eq!(reason(&[square(-4.0, 0.0, 2.0), square(4.0, 0.0, 2.0)]), "Ok(3)");
        assert_eq!(reason(&[square(-4.0, 0.0, 2.0), square(20.0, 0.0, 2.0)]), "1 lies outside the outline");
        assert_eq!(reason(&[square(9.0, 0.0, 2.0)]), "0 meets the outline");
        assert_eq!(reason(&[square(8.0, 0.0, 2.0)]), "0 meets the outline");
        assert_eq!(reason(&[square(0.0, 0.0, 3.0), square(2.0, 2.0, 3.0)]), "1 meets hole 0");
        assert_eq!(reason(&[square(0.0, 0.0, 3.0), square(0.0, 0.0, 1.0)]), "1 lies inside hole 0");
        assert_eq!(reason(&[square(0.0, 0.0, 20.0)]), "0 lies outside the outline");
    }
}
