//! Outlines moved outward on a grid, where their polygons would touch themselves or cross each other too often: the level
//! line of the distance to them.

use glam::DVec2;

use crate::drawing::combine::Part;
use crate::drawing::curve::bounds;
use crate::error::Result;
use crate::geometry::segments::nearest_on_segment;
use crate::picture::field::Picture;
use crate::picture::heights::Sample;
use crate::picture::{apart, islands, levels, simplify};
use crate::progress::Progress;

/// The spacing of nodes in pixels: a quarter of the distance between these two, and a hundredth of it beyond.
const SPACING: (f64, f64) = (0.25, 0.5);

/// The most nodes of a grid; of larger pictures they are farther apart.
const MAX_NODES: f64 = 64e6;

/// Nodes beyond what is reached, to each side.
const BESIDE: f64 = 3.0;

/// Distances by which a value of the field changes by 1, in nodes.
const RAMP: f64 = 8.0;

/// Neighbours whose nearest segment may be a node's own, in the order of the sweeps: the row before, then the node before.
const BEFORE: [(isize, isize); 4] = [(-1, -1), (0, -1), (1, -1), (-1, 0)];

/// The union of all points within a distance above 0 of the parts, without gaps of less than twice a `slit`; holes of less than the area
/// are filled.
///
/// Every contour is simple and apart from the others. Corners become round. O(nodes + n log n) for n points.
pub fn widen(
    parts: &[Part],
    distance: f64,
    slit: f64,
    min_area: f64,
    progress: Progress<'_>,
) -> Result<Vec<Part>> {
    let (low, high) = extent(parts);
    let fine = (0.25 * distance).clamp(SPACING.0, SPACING.1).max(0.01 * distance);
    let room = high - low + 2.0 * (distance + slit);
    let spacing = fine.max((room.x * room.y / MAX_NODES).sqrt());
    // What chords across the cells of a grid, and distances that are a little too large, take away.
    let reach = distance + 0.5 * spacing * spacing / distance + 0.15 * spacing;
    let slit = slit.max(0.8 * spacing);
    let wide = Grid::around(parts, reach + slit, spacing).level(
        parts,
        reach + slit,
        0.0,
        progress.part(0.0, 0.5),
    )?;
    Grid::around(&wide, 0.0, spacing).level(&wide, -slit, min_area, progress.part(0.5, 1.0))
}

fn extent(parts: &[Part]) -> (DVec2, DVec2) {
    let boxes = parts.iter().map(|part| bounds(&part.outline));
    boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
}

/// Square cells, a node in the middle of each.
struct Grid {
    /// The lower left corner.
    origin: DVec2,
    spacing: f64,
    columns: usize,
    rows: usize,
}

impl Grid {
    fn around(parts: &[Part], reach: f64, spacing: f64) -> Self {
        let (low, high) = extent(parts);
        let room = reach + BESIDE * spacing;
        let size = ((high - low + 2.0 * room) / spacing).ceil();
        Self { origin: low - room, spacing, columns: size.x as usize + 1, rows: size.y as usize + 1 }
    }

    fn place(&self, column: usize, row: usize) -> DVec2 {
        self.origin + self.spacing * (DVec2::new(column as f64, row as f64) + 0.5)
    }

    /// The line at this distance outside of the parts' contours, or inside if it is negative.
    fn level(&self, parts: &[Part], at: f64, min_area: f64, progress: Progress<'_>) -> Result<Vec<Part>> {
        let picture = self.picture(parts, at, progress.part(0.0, 0.6))?;
        let contours = levels::contours(&picture, 0.5, progress.part(0.6, 0.7))?;
        let least = min_area / (self.spacing * self.spacing);
        let found = islands::sort(contours, least, progress.part(0.7, 0.8))?.islands;
        let mut lines = Vec::new();
        for contour in found.iter().flat_map(|island| &island.contours) {
            progress.report(0.8)?;
            let raw = levels::points(&picture, 0.5, contour);
            let sample = |(crossing, &at)| Sample { crossing, at, exact: true, corner: false };
            let samples = raw.iter().enumerate().map(sample).collect();
            lines.push(apart::Line::new(raw, simplify::simplify(samples)));
        }
        let counts: Vec<usize> = found.iter().map(|island| island.contours.len()).collect();
        apart::separate(&mut lines, &counts, progress.part(0.8, 1.0))?;
        let placed = |line: apart::Line| -> Vec<DVec2> {
            line.into_points().into_iter().map(|point| self.origin + self.spacing * point).collect()
        };
        let mut lines = lines.into_iter().map(placed);
        let part = |island: &islands::Island| Part {
            outline: lines.next().unwrap_or_default(),
            holes: lines.by_ref().take(island.contours.len() - 1).collect(),
        };
        Ok(found.iter().map(part).collect())
    }

    /// Above a half where the distance is less than the one given; distances inside of contours are negative.
    fn picture(&self, parts: &[Part], at: f64, progress: Progress<'_>) -> Result<Picture> {
        let contours = parts.iter().flat_map(|part| std::iter::once(&part.outline).chain(&part.holes));
        let segments: Vec<[DVec2; 2]> = contours
            .flat_map(|contour| (0..contour.len()).map(|i| [contour[i], contour[(i + 1) % contour.len()]]))
            .collect();
        let squared = self.distances(&segments, progress.part(0.0, 0.9))?;
        let crossings = self.crossings(&segments);
        let mut crossings = crossings.iter().peekable();
        let mut values = vec![0.0; squared.len()];
        for row in 0..self.rows {
            progress.report(0.9)?;
            let mut is_inside = false;
            for column in 0..self.columns {
                let x = self.place(column, row).x;
                while crossings.next_if(|&&(r, crossing)| r < row || (r == row && crossing <= x)).is_some() {
                    is_inside = !is_inside;
                }
                let distance = f64::from(squared[row * self.columns + column]).sqrt();
                let signed = if is_inside { -distance } else { distance };
                let value = 0.5 + (at - signed) / (RAMP * self.spacing);
                // Rows of a picture go from the top.
                values[(self.rows - 1 - row) * self.columns + column] = value.clamp(0.0, 1.0) as f32;
            }
            // Beyond the last node of a row nothing is inside.
            while crossings.next_if(|&&(r, _)| r == row).is_some() {}
        }
        Picture::new(self.columns, self.rows, values)
    }

    /// Where segments cross the rows of nodes, row by row from below, from the left.
    fn crossings(&self, segments: &[[DVec2; 2]]) -> Vec<(usize, f64)> {
        let mut found = Vec::new();
        for &[a, b] in segments {
            let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
            // Rows from the lower end, exclusive of the upper one.
            let first = |y: f64| ((y - self.origin.y) / self.spacing - 0.5).ceil().max(0.0) as usize;
            for row in first(low.y)..first(high.y).min(self.rows) {
                let t = ((self.place(0, row).y - low.y) / (high.y - low.y)).clamp(0.0, 1.0);
                found.push((row, low.lerp(high, t).x));
            }
        }
        found.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        found
    }

    /// The squared distance of each node to the segments, to a tenth of the spacing.
    ///
    /// Source: Danielsson, Euclidean distance mapping, 1980 (the nearest segment goes from neighbour to neighbour).
    fn distances(&self, segments: &[[DVec2; 2]], progress: Progress<'_>) -> Result<Vec<f32>> {
        const NONE: u32 = u32::MAX;
        let count = self.columns * self.rows;
        let (mut nearest, mut squared) = (vec![NONE; count], vec![f32::INFINITY; count]);
        let mut offer = |nearest: &mut [u32], column: usize, row: usize, segment: u32| {
            let [a, b] = segments[segment as usize];
            let found = nearest_on_segment(self.place(column, row), a, b).1 as f32;
            let node = row * self.columns + column;
            if found < squared[node] {
                (nearest[node], squared[node]) = (segment, found);
            }
        };
        for (k, &[a, b]) in segments.iter().enumerate() {
            if k.is_multiple_of(4096) {
                progress.report(0.1 * k as f64 / segments.len() as f64)?;
            }
            let steps = (2.0 * a.distance(b) / self.spacing).ceil().max(1.0);
            for step in 0..=steps as usize {
                let at = (a.lerp(b, step as f64 / steps) - self.origin) / self.spacing - 0.5;
                let (column, row) = (at.x.max(0.0) as usize, at.y.max(0.0) as usize);
                for (c, r) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    if column + c < self.columns && row + r < self.rows {
                        offer(&mut nearest, column + c, row + r, k as u32);
                    }
                }
            }
        }
        // Upward and downward; in each row forth and back.
        for (pass, sign) in [1, -1].into_iter().enumerate() {
            for k in 0..self.rows {
                progress.report(0.1 + 0.45 * (pass as f64 + k as f64 / self.rows as f64))?;
                let row = if sign > 0 { k } else { self.rows - 1 - k };
                for (back, neighbours) in [(sign, &BEFORE[..]), (-sign, &BEFORE[3..])] {
                    for c in 0..self.columns {
                        let column = if back > 0 { c } else { self.columns - 1 - c };
                        for &(dx, dy) in neighbours {
                            let beside = column.checked_add_signed(back * dx).filter(|&c| c < self.columns);
                            let below = row.checked_add_signed(sign * dy).filter(|&r| r < self.rows);
                            let (Some(beside), Some(below)) = (beside, below) else { continue };
                            let segment = nearest[below * self.columns + beside];
                            if segment != NONE && segment != nearest[row * self.columns + column] {
                                offer(&mut nearest, column, row, segment);
                            }
                        }
                    }
                }
            }
        }
        Ok(squared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::contours::read_contours;
    use crate::geometry::polygon::signed_area;

    fn square(x: f64, y: f64, side: f64) -> Vec<DVec2> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
            .map(|(dx, dy)| DVec2::new(x + dx, y + dy))
            .to_vec()
    }

    #[test]
    fn a_square_grows_by_the_distance_and_its_corners_become_round() {
        let part = Part { outline: square(0.0, 0.0, 20.0), holes: Vec::new() };
        for distance in [0.5, 1.0, 3.0, 40.0, 700.0] {
            let wide = widen(std::slice::from_ref(&part), distance, 0.4, 0.0, Progress::NONE).unwrap();
            assert_eq!(wide.len(), 1);
            let area = 400.0 + 80.0 * distance + std::f64::consts::PI * distance * distance;
            let off = (signed_area(&wide[0].outline) - area) / (80.0 + 6.3 * distance);
            assert!((0.0..0.15 + 0.004 * distance).contains(&off), "{distance}: {off}");
        }
    }

    #[test]
    fn holes_shrink_and_go_and_neighbours_merge() {
        let mut hole = square(10.0, 10.0, 10.0);
        hole.reverse();
        let parts = [
            Part { outline: square(0.0, 0.0, 30.0), holes: vec![hole] },
            Part { outline: square(34.0, 0.0, 10.0), holes: Vec::new() },
        ];
        let counts = |distance: f64, min_area: f64| {
            let wide = widen(&parts, distance, 0.4, min_area, Progress::NONE).unwrap();
            for part in &wide {
                assert!(read_contours(&part.outline, &part.holes).is_ok());
            }
            wide.iter().map(|part| part.holes.len()).collect::<Vec<_>>()
        };
        assert_eq!(counts(1.0, 0.0), [1, 0]);
        assert_eq!(counts(1.0, 80.0), [0, 0]);
        assert_eq!(counts(3.0, 0.0), [1]);
        assert_eq!(counts(6.0, 0.0), [0]);
    }
}
