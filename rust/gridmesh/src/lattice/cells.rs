//! Dense storage for the lattice points of a region, row by row.

use std::sync::Arc;

use crate::lattice::axial::Axial;

/// Which lattice points have a cell: in each row, one run of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    first_row: i32,
    rows: Vec<Row>,
    len: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Row {
    start: i32,
    end: i32,
    /// Cell number of the point with q = 0, which may lie before the first cell.
    base: i64,
}

impl Layout {
    /// The layout whose row `r` reaches from the least to the greatest `q` among `points`, widened
    /// by `margin` steps in all directions. Empty if there are no points.
    pub fn around(points: impl Iterator<Item = Axial> + Clone, margin: i32) -> Self {
        let low = points.clone().map(|p| p.r).min().unwrap_or(0);
        let high = points.clone().map(|p| p.r).max().unwrap_or(-1);
        let mut spans = vec![(i32::MAX, i32::MIN); (high - low + 1) as usize];
        for p in points {
            let span = &mut spans[(p.r - low) as usize];
            *span = (span.0.min(p.q), span.1.max(p.q));
        }
        let (first_row, n_rows) =
            if spans.is_empty() { (0, 0) } else { (low - margin, spans.len() + 2 * margin as usize) };
        let mut rows = Vec::with_capacity(n_rows);
        let mut len = 0i64;
        for i in 0..n_rows as i32 {
            // A step between rows shifts q by up to one.
            let near = (i - 2 * margin).max(0) as usize..=(i as usize).min(spans.len() - 1);
            let start = spans[near.clone()].iter().map(|s| s.0).min().unwrap_or(0) - margin;
            let end = spans[near].iter().map(|s| s.1).max().unwrap_or(-1) + margin + 1;
            rows.push(Row { start, end, base: len - i64::from(start) });
            len += i64::from(end - start);
        }
        Self { first_row, rows, len: len as usize }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if there are no cells.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The cell number of a point, if it has one. Constant time.
    #[inline]
    pub fn index(&self, point: Axial) -> Option<usize> {
        let row = self.rows.get((point.r - self.first_row) as usize)?;
        (row.start <= point.q && point.q < row.end).then(|| (row.base + i64::from(point.q)) as usize)
    }

    /// The cell numbers of the six neighbours of a point, counter-clockwise from the eastern one, if
    /// it and they all have cells. Constant time.
    #[inline]
    pub fn neighbours(&self, point: Axial) -> Option<[usize; 6]> {
        let row = (point.r - self.first_row) as usize;
        let rows = self.rows.get(row.wrapping_sub(1)..=row + 1)?;
        let (below, here, above) = (rows[0], rows[1], rows[2]);
        let q = point.q;
        let complete = here.start < q
            && q + 1 < here.end
            && above.start < q
            && q < above.end
            && below.start <= q
            && q + 1 < below.end;
        let at = |row: Row, q: i32| (row.base + i64::from(q)) as usize;
        complete.then(|| {
            [at(here, q + 1), at(above, q), at(above, q - 1), at(here, q - 1), at(below, q), at(below, q + 1)]
        })
    }

    /// The first point of each row, and the cell numbers of the row.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = (Axial, std::ops::Range<usize>)> {
        let ranges = self.rows.iter().map(|row| (row, (row.base + i64::from(row.start)) as usize));
        ranges.enumerate().map(|(i, (row, from))| {
            let first = Axial::new(row.start, self.first_row + i as i32);
            (first, from..from + (row.end - row.start) as usize)
        })
    }

    /// All points that have a cell, in the order of their numbers.
    pub fn points(&self) -> impl Iterator<Item = Axial> {
        self.rows
            .iter()
            .zip(self.first_row..)
            .flat_map(|(row, r)| (row.start..row.end).map(move |q| Axial::new(q, r)))
    }
}

/// One value for each point of a [`Layout`]; a default elsewhere.
#[derive(Clone, Debug)]
pub struct Cells<T> {
    layout: Arc<Layout>,
    values: Vec<T>,
    elsewhere: T,
}

impl<T: Copy> Cells<T> {
    /// All cells hold `value`.
    pub fn new(layout: Arc<Layout>, value: T) -> Self {
        Self { values: vec![value; layout.len()], layout, elsewhere: value }
    }

    /// The value of a point; the one that all cells began with where there is no cell.
    #[inline]
    pub fn get(&self, point: Axial) -> T {
        self.layout.index(point).map_or(self.elsewhere, |i| self.values[i])
    }

    /// The cell of a point, if it has one.
    pub fn get_mut(&mut self, point: Axial) -> Option<&mut T> {
        self.layout.index(point).map(|i| &mut self.values[i])
    }

    /// Puts a value into the cell of a point; false if it has none.
    pub fn set(&mut self, point: Axial, value: T) -> bool {
        self.get_mut(point).map(|cell| *cell = value).is_some()
    }

    /// The values by cell number.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The values by cell number, to change.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The layout.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_within_the_margin_has_a_cell_of_its_own() {
        let points = [Axial::new(0, 0), Axial::new(9, -3), Axial::new(-2, 4), Axial::new(5, 2)];
        let layout = Layout::around(points.into_iter(), 2);
        for p in points {
            for q in -2i32..=2 {
                for r in -2..=2 {
                    if (q + r).abs() <= 2 {
                        assert!(layout.index(p + Axial::new(q, r)).is_some());
                    }
                }
            }
        }
        for (i, p) in layout.points().enumerate() {
            assert_eq!(layout.index(p), Some(i));
            let each: Option<Vec<usize>> = p.neighbours().into_iter().map(|n| layout.index(n)).collect();
            assert_eq!(layout.neighbours(p).map(|n| n.to_vec()), each);
        }
        for (first, cells) in layout.rows() {
            assert_eq!(layout.index(first), Some(cells.start));
        }
        assert_eq!(layout.points().count(), layout.len());
        assert!(Layout::around([].into_iter(), 2).is_empty());
    }
}
