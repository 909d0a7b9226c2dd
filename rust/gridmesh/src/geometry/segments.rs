//! A uniform grid over line segments: who is near whom, in time proportional to their number.

use glam::DVec2;

/// Line segments sorted into the square cells that they touch.
pub(crate) struct SegmentGrid {
    origin: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    /// First item of each cell in `items`, row by row, and the end.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl SegmentGrid {
    /// Sorts segments into cells; about two cells for each segment.
    ///
    /// The cells are at least an eighth of the mean segment long, so that the number of entries
    /// stays proportional to the number of segments.
    pub(crate) fn new(segments: &[[DVec2; 2]]) -> Self {
        let mut low = DVec2::INFINITY;
        let mut high = DVec2::NEG_INFINITY;
        let mut length = 0.0;
        for [a, b] in segments {
            low = low.min(*a).min(*b);
            high = high.max(*a).max(*b);
            length += a.distance(*b);
        }
        let n = segments.len().max(1) as f64;
        let size = high - low;
        let cell = (size.x * size.y / (2.0 * n))
            .sqrt()
            .max(length / (8.0 * n))
            .max(size.max_element() / 4096.0)
            .max(f64::MIN_POSITIVE);
        let columns = (size.x / cell) as usize + 1;
        let rows = (size.y / cell) as usize + 1;
        let mut grid =
            Self { origin: low, cell, columns, rows, starts: vec![0; columns * rows + 1], items: Vec::new() };
        let mut entries: Vec<(u32, u32)> = Vec::with_capacity(3 * segments.len());
        for (i, segment) in segments.iter().enumerate() {
            grid.walk(segment, |cell| entries.push((cell as u32, i as u32)));
        }
        // Counting sort: first where the items of each cell end, then, filled from the back, where they begin.
        for &(cell, _) in &entries {
            grid.starts[cell as usize] += 1;
        }
        let mut end = 0;
        for start in &mut grid.starts {
            end += *start;
            *start = end;
        }
        grid.items = vec![0; entries.len()];
        for &(cell, item) in entries.iter().rev() {
            let start = &mut grid.starts[cell as usize];
            *start -= 1;
            grid.items[*start as usize] = item;
        }
        grid
    }

    fn column(&self, x: f64) -> usize {
        (((x - self.origin.x) / self.cell).max(0.0) as usize).min(self.columns - 1)
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.origin.y) / self.cell).max(0.0) as usize).min(self.rows - 1)
    }

    /// Calls `visit` for each cell that a segment touches (and now and then one beside it).
    fn walk(&self, [a, b]: &[DVec2; 2], mut visit: impl FnMut(usize)) {
        let (a, b) = if a.y <= b.y { (*a, *b) } else { (*b, *a) };
        let pad = 1e-9 * self.cell;
        let (rows, left, right) = (self.row(a.y - pad)..=self.row(b.y + pad), a.x.min(b.x), a.x.max(b.x));
        if rows.start() == rows.end() {
            let first = rows.start() * self.columns;
            (self.column(left - pad)..=self.column(right + pad)).for_each(|column| visit(first + column));
            return;
        }
        let slope = if b.y > a.y { (b.x - a.x) / (b.y - a.y) } else { 0.0 };
        for row in rows {
            let low = (self.origin.y + row as f64 * self.cell - pad).max(a.y);
            let high = (self.origin.y + (row + 1) as f64 * self.cell + pad).min(b.y);
            let (x0, x1) = if b.y > a.y {
                let at = |y: f64| (a.x + (y - a.y) * slope).clamp(left, right);
                (at(low), at(high))
            } else {
                (a.x, b.x)
            };
            for column in self.column(x0.min(x1) - pad)..=self.column(x0.max(x1) + pad) {
                visit(row * self.columns + column);
            }
        }
    }

    /// Calls `visit` with each segment in the cells that meet the box, possibly several times.
    pub(crate) fn near(&self, low: DVec2, high: DVec2, mut visit: impl FnMut(usize)) {
        for row in self.row(low.y)..=self.row(high.y) {
            let cells = row * self.columns + self.column(low.x)..=row * self.columns + self.column(high.x);
            let items = self.starts[*cells.start()] as usize..self.starts[cells.end() + 1] as usize;
            for &item in &self.items[items] {
                visit(item as usize);
            }
        }
    }

    /// The segment nearest to a point, the first of those equally near, and the parameter on it, of the segments that the grid was
    /// made of. Near-constant time for points near them.
    pub(crate) fn nearest(&self, segments: &[[DVec2; 2]], point: DVec2) -> (usize, f64) {
        let mut reach = self.cell;
        loop {
            let mut best = (f64::INFINITY, 0, 0.0);
            self.near(point - reach, point + reach, |i| {
                let (t, squared) = nearest_on_segment(point, segments[i][0], segments[i][1]);
                if squared < best.0 || (squared == best.0 && i < best.1) {
                    best = (squared, i, t);
                }
            });
            let (low, high) = (self.origin, self.origin + self.cell * self.size());
            let is_all = (point - reach).cmple(low).all() && (point + reach).cmpge(high).all();
            if best.0 <= reach * reach || is_all || !reach.is_finite() {
                return (best.1, best.2);
            }
            reach *= 2.0;
        }
    }

    /// In cells.
    fn size(&self) -> DVec2 {
        DVec2::new(self.columns as f64, self.rows as f64)
    }

    /// Calls `visit` with the pairs `(i, j)`, `i < j`, of segments that share a cell; stops when it
    /// returns false. A pair may come several times.
    pub(crate) fn pairs(&self, mut visit: impl FnMut(usize, usize) -> bool) {
        for cell in self.starts.windows(2) {
            let items = &self.items[cell[0] as usize..cell[1] as usize];
            for (k, &i) in items.iter().enumerate() {
                for &j in &items[k + 1..] {
                    if !visit(i as usize, j as usize) {
                        return;
                    }
                }
            }
        }
    }
}

/// The sign of the area of the triangle `a b c`, exactly: positive if counter-clockwise.
pub(crate) fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// True if two closed segments have a point in common (exact).
pub(crate) fn segments_meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    if a.x.max(b.x) < c.x.min(d.x)
        || c.x.max(d.x) < a.x.min(b.x)
        || a.y.max(b.y) < c.y.min(d.y)
        || c.y.max(d.y) < a.y.min(b.y)
    {
        return false;
    }
    let (oc, od) = (orientation(a, b, c), orientation(a, b, d));
    if (oc > 0.0 && od > 0.0) || (oc < 0.0 && od < 0.0) {
        return false;
    }
    let (oa, ob) = (orientation(c, d, a), orientation(c, d, b));
    !((oa > 0.0 && ob > 0.0) || (oa < 0.0 && ob < 0.0))
}

/// The point of the segment nearest to `p`, as a parameter from 0 to 1, and its squared distance.
pub(crate) fn nearest_on_segment(p: DVec2, a: DVec2, b: DVec2) -> (f64, f64) {
    let ab = b - a;
    let squared = ab.length_squared();
    let t = if squared > 0.0 { ((p - a).dot(ab) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (t, (a + t * ab).distance_squared(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(n: usize, seed: u64) -> Vec<[DVec2; 2]> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        (0..n)
            .map(|_| {
                let a = DVec2::new(next(), next());
                [a, a + 0.3 * (DVec2::new(next(), next()) - 0.5)]
            })
            .collect()
    }

    #[test]
    fn every_meeting_pair_shares_a_cell() {
        for seed in 1..20 {
            let segments = random(60, seed);
            let mut found = std::collections::BTreeSet::new();
            SegmentGrid::new(&segments).pairs(|i, j| {
                if segments_meet(segments[i], segments[j]) {
                    found.insert((i, j));
                }
                true
            });
            for i in 0..segments.len() {
                for j in i + 1..segments.len() {
                    assert_eq!(
                        segments_meet(segments[i], segments[j]),
                        found.contains(&(i, j)),
                        "{seed} {i} {j}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_nearest_is_that_of_looking_at_all() {
        for seed in 1..20 {
            let segments = random(60, seed);
            let grid = SegmentGrid::new(&segments);
            for point in random(40, seed + 99).into_iter().flatten().map(|p| 6.0 * p - 3.0) {
                let all = segments.iter().map(|&[a, b]| nearest_on_segment(point, a, b)).enumerate();
                let (i, (t, _)) = all.min_by(|(_, a), (_, b)| a.1.total_cmp(&b.1)).unwrap();
                assert_eq!(grid.nearest(&segments, point), (i, t));
            }
        }
    }

    #[test]
    fn touching_and_collinear_segments_meet() {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        assert!(segments_meet([p(0.0, 0.0), p(2.0, 0.0)], [p(1.0, 0.0), p(1.0, 1.0)]));
        assert!(segments_meet([p(0.0, 0.0), p(2.0, 0.0)], [p(1.0, 0.0), p(3.0, 0.0)]));
        assert!(!segments_meet([p(0.0, 0.0), p(1.0, 0.0)], [p(1.5, 0.0), p(3.0, 0.0)]));
        assert!(!segments_meet([p(0.0, 0.0), p(1.0, 0.0)], [p(0.0, 1e-300), p(1.0, 1e-300)]));
    }
}
