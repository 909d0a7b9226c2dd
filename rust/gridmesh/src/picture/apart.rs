//! Contours that do not meet: where refined lines cross, or a hole is no longer inside, they go back to their crossings, which never do.

use glam::DVec2;

use crate::drawing::curve::bounds;
use crate::error::Result;
use crate::geometry::polygon::signed_area;
use crate::geometry::segments::{SegmentGrid, orientation, segments_meet};
use crate::picture::heights::Sample;
use crate::progress::Progress;

/// How many crossings to each side of a conflict go back at first; each further round takes twice as many.
const AROUND: usize = 3;

/// A refined contour and the crossings that it came from.
#[derive(Clone, Debug)]
pub struct Line {
    raw: Vec<DVec2>,
    /// By crossing, in order.
    kept: Vec<(usize, DVec2)>,
    /// Crossings that count instead of what was kept.
    back: Vec<bool>,
    /// The points now, each with its crossing.
    points: Vec<(usize, DVec2)>,
}

impl Line {
    /// A contour that stays as it is.
    pub fn raw(raw: Vec<DVec2>) -> Self {
        let points = raw.iter().copied().enumerate().collect();
        Self { back: vec![true; raw.len()], raw, kept: Vec::new(), points }
    }

    /// A contour with refined samples, in the order of their crossings.
    pub fn new(raw: Vec<DVec2>, samples: Vec<Sample>) -> Self {
        let kept: Vec<_> = samples.into_iter().map(|sample| (sample.crossing, sample.at)).collect();
        if kept.len() < 3 {
            return Self::raw(raw);
        }
        Self { back: vec![false; raw.len()], raw, points: kept.clone(), kept }
    }

    /// Its crossings.
    pub fn crossings(&self) -> &[DVec2] {
        &self.raw
    }

    /// The points.
    pub fn into_points(self) -> Vec<DVec2> {
        self.points.into_iter().map(|(_, point)| point).collect()
    }

    fn segment(&self, i: usize) -> [DVec2; 2] {
        [self.points[i].1, self.points[(i + 1) % self.points.len()].1]
    }

    fn places(&self) -> Vec<DVec2> {
        self.points.iter().map(|&(_, point)| point).collect()
    }

    /// Marks the crossings around a segment; whether any was not yet marked.
    fn mark(&mut self, segment: usize, around: usize) -> bool {
        let n = self.raw.len();
        let first = self.points[segment].0;
        let last = self.points[(segment + 1) % self.points.len()].0;
        self.mark_from(first, (last + n - first) % n, around)
    }

    /// Marks a crossing, so many after it, and so many around these; whether any was not yet marked.
    fn mark_from(&mut self, first: usize, more: usize, around: usize) -> bool {
        let n = self.raw.len();
        let length = (more + 2 * around).min(n - 1);
        let mut changed = false;
        for k in 0..=length {
            let at = (first + 2 * n - around.min(n) + k) % n;
            changed |= !std::mem::replace(&mut self.back[at], true);
        }
        changed
    }

    /// Goes back to the crossings around the one that is nearest to a place; whether it was not there.
    fn go_back_near(&mut self, place: DVec2, around: usize) -> bool {
        let away = |k: &usize| self.raw[*k].distance_squared(place);
        let nearest = (0..self.raw.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
        let changed = nearest.is_some_and(|nearest| self.mark_from(nearest, 0, around));
        if changed {
            self.rebuild();
        }
        changed
    }

    /// Goes back to all of its crossings; whether it was not there.
    fn go_back(&mut self) -> bool {
        if self.back.iter().all(|&back| back) {
            return false;
        }
        self.back.fill(true);
        self.rebuild();
        true
    }

    /// Whether it runs around what it surrounds the other way than its crossings.
    fn is_turned(&self) -> bool {
        (signed_area(&self.places()) > 0.0) != (signed_area(&self.raw) > 0.0)
    }

    fn rebuild(&mut self) {
        let mut kept = self.kept.iter().peekable();
        self.points.clear();
        for (crossing, (&point, &back)) in self.raw.iter().zip(&self.back).enumerate() {
            let refined = kept.next_if(|(index, _)| *index == crossing);
            if back {
                self.points.push((crossing, point));
            } else {
                self.points.extend(refined.copied());
            }
        }
    }
}

/// Changes lines until none meets itself or another, and holes lie inside their outlines, beside each other.
///
/// counts : how many of them, in turn, are an outline and its holes.
pub fn separate(lines: &mut [Line], counts: &[usize], progress: Progress<'_>) -> Result<()> {
    let longest = lines.iter().map(|line| line.raw.len()).max().unwrap_or(0);
    let mut around = AROUND;
    let done = |round: i32| 1.0 - 0.25f64.powi(round);
    for round in 0.. {
        untangle(lines, progress.part(done(round), done(round + 1)))?;
        // Two lines can pass each other as a whole, as where a ring is a pixel wide and pixels touch at corners alone.
        let mut changed = false;
        for line in lines.iter_mut().filter(|line| line.is_turned()) {
            changed |= line.go_back();
        }
        let misplaced = misplaced(lines, counts);
        for &[around_it, hole] in &misplaced {
            changed |= lines[hole].go_back();
            let place = lines[hole].raw[0];
            changed |= lines[around_it].go_back_near(place, around);
        }
        if !changed && (misplaced.is_empty() || around > longest) {
            break;
        }
        around *= 2;
    }
    Ok(())
}

/// Outlines, with each hole that does not lie inside, and holes, with each that does.
fn misplaced(lines: &[Line], counts: &[usize]) -> Vec<[usize; 2]> {
    let place = |line: usize| lines[line].points[0].1;
    let mut found = Vec::new();
    let mut first = 0;
    for &count in counts.iter().filter(|&&count| count > 0) {
        let holes = first + 1..first + count;
        let mut by_height: Vec<usize> = holes.clone().collect();
        by_height.sort_by(|&a, &b| place(a).y.total_cmp(&place(b).y));
        if count > 1 {
            let rows = Rows::new(&lines[first]);
            found.extend(holes.clone().filter(|&hole| !rows.surround(place(hole))).map(|hole| [first, hole]));
        }
        for hole in holes {
            let (low, high) = bounds(&lines[hole].places());
            let from = by_height.partition_point(|&other| place(other).y < low.y);
            let is_beside = |other: usize| (low.x..=high.x).contains(&place(other).x);
            let others = by_height[from..].iter().copied().take_while(|&other| place(other).y <= high.y);
            let others: Vec<usize> = others.filter(|&other| other != hole && is_beside(other)).collect();
            if !others.is_empty() {
                let rows = Rows::new(&lines[hole]);
                found.extend(
                    others
                        .into_iter()
                        .filter(|&other| rows.surround(place(other)))
                        .map(|other| [hole, other]),
                );
            }
        }
        first += count;
    }
    found
}

/// The segments of a line by the rows of pixels that they pass.
struct Rows<'a> {
    line: &'a Line,
    first: f64,
    rows: Vec<Vec<usize>>,
}

impl<'a> Rows<'a> {
    fn new(line: &'a Line) -> Self {
        let (first, last) = bounds(&line.places());
        let (first, last) = (first.y.floor(), last.y.floor());
        let mut rows = vec![Vec::new(); (last - first) as usize + 1];
        for i in 0..line.points.len() {
            let [a, b] = line.segment(i).map(|point| (point.y.floor() - first) as usize);
            rows[a.min(b)..=a.max(b)].iter_mut().for_each(|row| row.push(i));
        }
        Self { line, first, rows }
    }

    /// Whether a point lies inside the line.
    fn surround(&self, point: DVec2) -> bool {
        let row = point.y.floor() - self.first;
        let Some(row) = (row >= 0.0).then(|| self.rows.get(row as usize)).flatten() else { return false };
        let is_crossed = |&&i: &&usize| {
            let [a, b] = self.line.segment(i);
            let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
            low.y <= point.y && point.y < high.y && orientation(low, high, point) > 0.0
        };
        row.iter().filter(is_crossed).count() % 2 == 1
    }
}

/// Changes lines until none meets itself or another.
fn untangle(lines: &mut [Line], progress: Progress<'_>) -> Result<()> {
    let mut around = AROUND;
    for round in 0.. {
        progress.report(1.0 - 1.0 / f64::from(round + 1))?;
        let conflicts = conflicts(lines, progress, 1.0 - 1.0 / f64::from(round + 1))?;
        let mut touched = Vec::new();
        for (line, segment) in conflicts {
            if lines[line].mark(segment, around) {
                touched.push(line);
            }
        }
        if touched.is_empty() {
            break;
        }
        touched.sort_unstable();
        touched.dedup();
        for line in touched {
            lines[line].rebuild();
        }
        around *= 2;
    }
    Ok(())
}

/// Segments that meet another one that is not their neighbour, or fold back onto it.
fn conflicts(lines: &[Line], progress: Progress<'_>, fraction: f64) -> Result<Vec<(usize, usize)>> {
    let mut owner = Vec::new();
    let mut segments = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        for i in 0..line.points.len() {
            owner.push((k, i));
            segments.push(line.segment(i));
        }
    }
    let mut found = Vec::new();
    let (mut count, mut stopped) = (0_usize, Ok(()));
    SegmentGrid::new(&segments).pairs(|i, j| {
        count += 1;
        if count.is_multiple_of(1 << 16) {
            stopped = progress.report(fraction);
        }
        let ((line, first), (other, second)) = (owner[i], owner[j]);
        let n = lines[line].points.len();
        let meet = if line == other && second == first + 1 {
            folds(segments[i], segments[j])
        } else if line == other && first == 0 && second == n - 1 {
            folds(segments[j], segments[i])
        } else {
            segments_meet(segments[i], segments[j])
        };
        if meet {
            found.extend([owner[i], owner[j]]);
        }
        stopped.is_ok()
    });
    stopped?;
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

/// True if a segment turns back onto the one before it.
fn folds([a, b]: [DVec2; 2], [_, c]: [DVec2; 2]) -> bool {
    orientation(a, b, c) == 0.0 && (b - a).dot(c - b) <= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_cross_go_back() {
        let square = |x: f64| -> Vec<DVec2> {
            [(0.0, 0.0), (2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (4.0, 4.0), (2.0, 4.0), (0.0, 4.0), (0.0, 2.0)]
                .map(|(dx, dy)| DVec2::new(x + dx, dy))
                .to_vec()
        };
        let moved = |points: &[DVec2], which: usize, by: f64| -> Line {
            let sample = |(crossing, &at): (usize, &DVec2)| {
                let at = if crossing == which { at + DVec2::new(by, 0.0) } else { at };
                Sample { crossing, at, exact: true, corner: false }
            };
            Line::new(points.to_vec(), points.iter().enumerate().map(sample).collect())
        };
        let (left, right) = (square(0.0), square(4.1));
        let mut lines = vec![moved(&left, 3, 0.4), moved(&right, 1, 0.3)];
        separate(&mut lines, &[1, 1], Progress::NONE).unwrap();
        assert!(conflicts(&lines, Progress::NONE, 0.0).unwrap().is_empty());
        assert_eq!(lines[0].points[3].1, left[3]);
        // What is far from the conflict stays refined.
        let mut one = vec![moved(&left, 3, 0.05)];
        separate(&mut one, &[1], Progress::NONE).unwrap();
        assert_ne!(one[0].points[3].1, left[3]);
    }

    #[test]
    fn a_hole_that_is_left_outside_goes_back_with_its_outline() {
        let square =
            |from: f64, to: f64| [(from, from), (to, from), (to, to), (from, to)].map(DVec2::from).to_vec();
        let (outer, mut inner) = (square(0.0, 4.0), square(1.0, 3.0));
        inner.reverse();
        // The outline became a sliver beside the hole.
        let moved = [(0.0, 0.0), (0.9, 0.0), (0.9, 0.5), (0.0, 4.0)].map(DVec2::from);
        let line = |raw: &[DVec2], moved: &[DVec2]| {
            let sample = |(crossing, &at)| Sample { crossing, at, exact: true, corner: false };
            Line::new(raw.to_vec(), moved.iter().enumerate().map(sample).collect())
        };
        let mut lines = vec![line(&outer, &moved), line(&inner, &inner)];
        separate(&mut lines, &[2], Progress::NONE).unwrap();
        assert_eq!(lines.into_iter().map(Line::into_points).collect::<Vec<_>>(), [outer, inner]);
    }

    #[test]
    fn a_hole_that_comes_to_lie_within_another_goes_back() {
        let square = |from: f64, to: f64, dx: f64| {
            [(from, from), (from, to), (to, to), (to, from)].map(|(x, y)| DVec2::new(x + dx, y)).to_vec()
        };
        let mut outer = square(-9.0, 19.0, 0.0);
        outer.reverse();
        let (large, small) = (square(0.0, 8.0, 0.0), square(3.0, 5.0, 6.0));
        let sample = |(crossing, &at): (usize, &DVec2)| Sample { crossing, at, exact: true, corner: false };
        let moved: Vec<Sample> = square(3.0, 5.0, 0.0).iter().enumerate().map(sample).collect();
        let mut lines = vec![Line::raw(outer), Line::raw(large), Line::new(small.clone(), moved)];
        separate(&mut lines, &[3], Progress::NONE).unwrap();
        assert_eq!(lines[2].clone().into_points(), small);
    }
}
