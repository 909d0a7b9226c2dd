//! Outlines moved outward, so that the rim of a drawing lies inside.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec2;
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};

use crate::drawing::combine::Part;
use crate::drawing::contours::read_contours;
use crate::drawing::curve::bounds;
use crate::error::Result;
use crate::geometry::polygon::signed_area;
use crate::geometry::segments::{SegmentGrid, nearest_on_segment, orientation};
use crate::picture::islands::Island;
use crate::picture::levels::Crossing;
use crate::picture::simplify::needed;
use crate::picture::widened::widen;
use crate::progress::{Progress, aside};

/// From this margin on, whole pixels lie inside.
const WHOLE: f64 = 1.0;

/// Corners sharper than this are cut off, so that they do not grow without end.
const SHARPEST: f64 = PI / 4.0;

/// How much more than needed, in pixels.
const SPARE: f64 = 0.02;

/// Gaps of less than twice this, in pixels, are closed.
const SLIT: f64 = 0.4;

/// How far contours are looked for around a corner of a pixel, in pixels: nearly all of them pass within the first.
const REACHES: [f64; 2] = [1.0, 3.0];

/// How far points that are dropped may be from the line, in pixels: offsets leave a stair of tiny steps, which point anywhere.
/// Less than what is spare.
const TOLERANCE: f64 = 0.01;

/// Offsets tried where contours come to touch themselves, and points of all tries together.
const TRIES: i32 = 6;
const TRIED: usize = 60_000;

/// The most crossings of moved lines, on average over all directions, that are resolved as polygons.
const CROSSINGS: f64 = 1e5;

/// The corners on the outside of all pixels at the rim of islands.
pub fn corners_to_cover(islands: &[Island]) -> Vec<DVec2> {
    let corners = |crossing: &Crossing| {
        let (side, along) = (crossing.point(0.5), crossing.point(0.5) - crossing.centre());
        [side + along.perp(), side - along.perp()]
    };
    let mut corners: Vec<DVec2> =
        islands.iter().flat_map(|island| &island.contours).flatten().flat_map(corners).collect();
    corners.sort_unstable_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)));
    corners.dedup();
    corners
}

/// Moves contours outward; parts that come nearer than 0.8 pixels become one, holes of less than the area are filled.
///
/// From a margin of 1 on all points of `cover` lie inside. Where the polygons of the moved contours touch themselves, or cross
/// too often, they are moved on a grid instead, and corners become round.
pub fn expand(
    parts: Vec<Part>,
    margin: f64,
    cover: &[DVec2],
    min_area: f64,
    progress: Progress<'_>,
) -> Result<Vec<Part>> {
    if parts.is_empty() {
        return Ok(parts);
    }
    let least =
        if margin >= WHOLE { farthest_outside(&parts, cover, progress.part(0.0, 0.3))? + SPARE } else { 0.0 };
    let shapes: Vec<Vec<Vec<[f64; 2]>>> = parts
        .iter()
        .map(|part| {
            let contour = |points: &Vec<DVec2>| points.iter().map(DVec2::to_array).collect();
            std::iter::once(&part.outline).chain(&part.holes).map(contour).collect()
        })
        .collect();
    let (shapes, points) = (Arc::new(shapes), contours(&parts).map(Vec::len).sum::<usize>());
    let distance = margin.max(least);
    let tries = if crossings(&parts, distance) > CROSSINGS { 0 } else { TRIES };
    for attempt in 0..tries {
        if attempt > 0 && points * attempt as usize > TRIED {
            break;
        }
        let here = progress.part(0.3 + 0.05 * f64::from(attempt), 0.3 + 0.05 * f64::from(attempt + 1));
        here.report(0.0)?;
        // A little more parts what just touches.
        let offset = distance + 0.01 * f64::from(attempt);
        let shapes = Arc::clone(&shapes);
        let work = move || {
            let style = |offset: f64| OutlineStyle::new(offset).line_join(LineJoin::Miter(SHARPEST));
            // Farther, and back again: what is left of gaps that the margin all but closes would be slits.
            let wide = shapes.outline_as::<i64>(&style(offset + SLIT));
            let parts = read(wide.outline_as::<i64>(&style(-SLIT)), min_area);
            let check = |part: &Part| read_contours(&part.outline, &part.holes).map(|_| ());
            parts.iter().try_for_each(check).is_ok().then_some(parts)
        };
        if let Some(parts) = aside(here, work)? {
            return Ok(parts);
        }
    }
    widen(&parts, distance, SLIT, min_area, progress.part(0.6, 1.0))
}

fn contours(parts: &[Part]) -> impl Iterator<Item = &Vec<DVec2>> {
    parts.iter().flat_map(|part| std::iter::once(&part.outline).chain(&part.holes))
}

/// How often the lines of contours cross once each is moved by itself: as often as lines of their length do that lie
/// anywhere in their box, in any direction.
fn crossings(parts: &[Part], distance: f64) -> f64 {
    let mut length = 0.0;
    for contour in contours(parts) {
        let n = contour.len();
        for k in 0..n {
            let (before, after) = (contour[k] - contour[(k + n - 1) % n], contour[(k + 1) % n] - contour[k]);
            length += after.length() + distance * before.angle_to(after).abs();
        }
    }
    let boxes = parts.iter().map(|part| bounds(&part.outline));
    let (low, high) = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default();
    let room = high - low + 2.0 * distance;
    length * length / (PI * room.x * room.y)
}

fn read(shapes: Vec<Vec<Vec<[f64; 2]>>>, min_area: f64) -> Vec<Part> {
    let contour = |points: Vec<[f64; 2]>| {
        let points: Vec<DVec2> = points.into_iter().map(DVec2::from_array).collect();
        let keep = needed(&points, Vec::new(), TOLERANCE);
        points.into_iter().zip(keep).filter_map(|(point, keep)| keep.then_some(point)).collect::<Vec<_>>()
    };
    let mut parts = Vec::new();
    for shape in shapes {
        let mut contours = shape.into_iter().map(contour);
        if let Some(outline) = contours.next() {
            let holes = contours.filter(|hole| -signed_area(hole) >= min_area.max(1e-6)).collect();
            parts.push(Part { outline, holes });
        }
    }
    parts.sort_by(|a, b| signed_area(&b.outline).total_cmp(&signed_area(&a.outline)));
    parts
}

/// What an outline encloses.
pub fn area(part: &Part) -> f64 {
    signed_area(&part.outline)
}

/// The largest distance of a point outside the parts from their contours, as far as a few pixels.
fn farthest_outside(parts: &[Part], points: &[DVec2], progress: Progress<'_>) -> Result<f64> {
    let mut segments = Vec::new();
    for contour in contours(parts) {
        segments.extend((0..contour.len()).map(|i| [contour[i], contour[(i + 1) % contour.len()]]));
    }
    let grid = SegmentGrid::new(&segments);
    let mut farthest: f64 = 0.0;
    for (k, &point) in points.iter().enumerate() {
        if k.is_multiple_of(4096) {
            progress.report(k as f64 / points.len() as f64)?;
        }
        let mut nearest = (f64::INFINITY, false);
        for reach in REACHES {
            nearest = (f64::INFINITY, false);
            grid.near(point - reach, point + reach, |i| {
                let [a, b] = segments[i];
                let squared = nearest_on_segment(point, a, b).1;
                if squared >= nearest.0 + 1e-12 {
                    return;
                }
                let outside = orientation(a, b, point) < 0.0;
                // Nearest to a vertex: outside of either segment counts.
                if squared < nearest.0 - 1e-12 {
                    nearest = (squared, outside);
                } else {
                    nearest.1 |= outside;
                }
            });
            if nearest.0 < reach * reach - 1e-9 {
                break;
            }
        }
        if nearest.1 && nearest.0.is_finite() {
            farthest = farthest.max(nearest.0.sqrt());
        }
    }
    Ok(farthest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, side: f64) -> Vec<DVec2> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(dx, dy)| DVec2::new(x + dx, dy)).to_vec()
    }

    #[test]
    fn corners_stay_and_neighbours_merge() {
        let two = vec![
            Part { outline: square(0.0, 10.0), holes: Vec::new() },
            Part { outline: square(13.0, 6.0), holes: Vec::new() },
        ];
        let areas = |margin: f64| -> Vec<f64> {
            let parts = expand(two.clone(), margin, &[], 0.0, Progress::NONE).unwrap();
            parts.iter().map(|part| (1e6 * signed_area(&part.outline)).round() / 1e6).collect()
        };
        assert_eq!(areas(1.0), [144.0, 64.0]);
        assert_eq!(areas(1.2).len(), 1);
    }

    #[test]
    fn slits_close_and_corners_inside_stay() {
        // A square with a slit that is 2.5 wide, in whose bottom there are corners.
        let slit =
            [(0., 0.), (20., 0.), (20., 20.), (11.25, 20.), (11.25, 8.), (8.75, 8.), (8.75, 20.), (0., 20.)];
        let outline: Vec<DVec2> = slit.map(DVec2::from).to_vec();
        let area = |margin: f64| {
            let part = vec![Part { outline: outline.clone(), holes: Vec::new() }];
            let parts = expand(part, margin, &[], 0.0, Progress::NONE).unwrap();
            assert!(parts[0].holes.is_empty());
            signed_area(&parts[0].outline)
        };
        assert!((area(0.5) - (21.0 * 21.0 - 1.5 * 12.0)).abs() < 1e-6, "{}", area(0.5));
        assert!((area(1.0) - 22.0 * 22.0).abs() < 1e-6, "{}", area(1.0));
    }

    #[test]
    fn no_tiny_steps_are_left_in_what_was_moved() {
        let ring = |radius: f64, sign: f64| -> Vec<DVec2> {
            let at = |k: i32| radius * DVec2::from_angle(sign * std::f64::consts::TAU * f64::from(k) / 90.0);
            (0..90).map(at).collect()
        };
        let part = vec![Part { outline: ring(20.0, 1.0), holes: vec![ring(9.0, -1.0)] }];
        let parts = expand(part, 1.0, &[], 0.0, Progress::NONE).unwrap();
        assert_eq!(parts[0].holes.len(), 1);
        for (contour, radius) in [(&parts[0].outline, 21.0), (&parts[0].holes[0], 8.0)] {
            for (k, &point) in contour.iter().enumerate() {
                let (before, after) =
                    (contour[(k + contour.len() - 1) % contour.len()], contour[(k + 1) % contour.len()]);
                assert!(point.distance(after) > 0.1, "{point} {after}");
                assert!((point - before).angle_to(after - point).abs() < 0.5, "{point}");
                assert!((point.length() - radius).abs() < 0.05, "{point}");
            }
        }
    }

    #[test]
    fn what_is_to_be_covered_lies_inside() {
        let part = vec![Part { outline: square(0.0, 10.0), holes: Vec::new() }];
        let parts = expand(part, 1.0, &[DVec2::new(5.0, -1.4)], 0.0, Progress::NONE).unwrap();
        let lowest = parts[0].outline.iter().map(|p| p.y).fold(f64::MAX, f64::min);
        assert!((-1.43..-1.4).contains(&lowest), "{lowest}");
    }
}
