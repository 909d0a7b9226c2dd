//! Which faces the line may meet, in one pass over the mesh: a grid over the plane knows where the line runs, and
//! on which side of it every other cell is.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::cut::input::Polygons;
use crate::cut::sheet::Sheet;
use crate::error::{Error, Result};

/// Of every vertex: on the left or not, if the part of the mesh that it is on is not cut.
pub(in crate::cut) type Uncut = Vec<Option<bool>>;

/// The line, sorted into the cells of a grid over the mesh.
pub(in crate::cut) struct Locator<'a> {
    sheet: &'a Sheet,
    low: DVec2,
    scale: DVec2,
    columns: usize,
    rows: usize,
    /// Segments of each cell.
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Cells with segments in the rectangle below and left of each corner.
    sums: Vec<u32>,
    /// Of cells without segments: on the left.
    left: Vec<bool>,
}

/// What the line may meet.
pub(in crate::cut) struct Met {
    /// Faces near the line, ascending.
    pub faces: Vec<u32>,
    /// For every vertex: on the left.
    pub left: Vec<bool>,
    /// Sides of the parts that are not cut, if these were told one by one.
    pub uncut: Option<Uncut>,
}

impl<'a> Locator<'a> {
    pub fn new(n_vertices: &[DVec3], sheet: &'a Sheet) -> Result<Self> {
        let size = sheet.high - sheet.low;
        let across = size.max_element();
        if across.is_nan() || across <= 0.0 {
            return Err(Error::StrokeMisses);
        }
        let most = ((n_vertices.len() as f64).sqrt() * 1.5).clamp(16.0, 1500.0);
        let cell = across / most;
        // A mesh that is seen as hardly a point: the line has no finite place in its cells.
        let far = sheet.points.iter().map(|&p| (p - sheet.low).abs().max_element()).fold(across, f64::max);
        if !(far / cell).is_finite() {
            return Err(Error::StrokeMisses);
        }
        let columns = (size.x / cell) as usize + 1;
        let rows = (size.y / cell) as usize + 1;
        let mut locator = Locator {
            sheet,
            low: sheet.low,
            scale: DVec2::splat(1.0 / cell),
            columns,
            rows,
            starts: vec![0; columns * rows + 1],
            items: vec![],
            sums: vec![],
            left: vec![],
        };
        let mut found = vec![];
        for k in 0..sheet.n_segments() {
            locator.walk(k, &mut found);
        }
        found.sort_unstable();
        for &(cell, _) in &found {
            locator.starts[cell as usize + 1] += 1;
        }
        for i in 1..locator.starts.len() {
            locator.starts[i] += locator.starts[i - 1];
        }
        locator.items = found.into_iter().map(|(_, k)| k).collect();
        locator.sum();
        locator.colour();
        Ok(locator)
    }

    /// The cells that segment `k` touches.
    fn walk(&self, k: usize, found: &mut Vec<(u32, u32)>) {
        const PAD: f64 = 1e-6;
        let [p, q] = self.sheet.segment(k).map(|p| (p - self.low) * self.scale);
        let (low, high) = if p.y <= q.y { (p, q) } else { (q, p) };
        if high.y < -PAD || low.y > self.rows as f64 + PAD {
            return;
        }
        let first = (low.y - PAD).max(0.0) as usize;
        let last = ((high.y + PAD).max(0.0) as usize).min(self.rows - 1);
        let slope = (high.x - low.x) / (high.y - low.y);
        for row in first..=last.max(first).min(self.rows - 1) {
            let x = |y: f64| {
                let t = y.clamp(low.y, high.y);
                if slope.is_finite() { low.x + (t - low.y) * slope } else { f64::NAN }
            };
            let (a, b) = (x(row as f64 - PAD), x((row + 1) as f64 + PAD));
            let (a, b) = if a.is_nan() || b.is_nan() { (low.x, high.x) } else { (a, b) };
            let (a, b) = (a.min(b).max(p.x.min(q.x)) - PAD, a.max(b).min(p.x.max(q.x)) + PAD);
            if b < 0.0 || a > self.columns as f64 {
                continue;
            }
            let from = a.max(0.0) as usize;
            let to = (b.max(0.0) as usize).min(self.columns - 1);
            found.extend((from..=to).map(|column| ((row * self.columns + column) as u32, k as u32)));
        }
    }

    fn is_met(&self, cell: usize) -> bool {
        self.starts[cell + 1] > self.starts[cell]
    }

    fn sum(&mut self) {
        let wide = self.columns + 1;
        let mut sums = vec![0u32; wide * (self.rows + 1)];
        for row in 0..self.rows {
            let mut sum = 0;
            for column in 0..self.columns {
                sum += u32::from(self.is_met(row * self.columns + column));
                sums[(row + 1) * wide + column + 1] = sums[row * wide + column + 1] + sum;
            }
        }
        self.sums = sums;
    }

    /// Sides of the cells without segments, each from a neighbour where there is one.
    fn colour(&mut self) {
        let mut left = vec![false; self.columns * self.rows];
        for row in 0..self.rows {
            for column in 0..self.columns {
                let cell = row * self.columns + column;
                if self.is_met(cell) {
                    continue;
                }
                left[cell] = if column > 0 && !self.is_met(cell - 1) {
                    left[cell - 1]
                } else if row > 0 && !self.is_met(cell - self.columns) {
                    left[cell - self.columns]
                } else {
                    let middle = DVec2::new(column as f64 + 0.5, row as f64 + 0.5) / self.scale;
                    self.sheet.is_left(self.low + middle)
                };
            }
        }
        self.left = left;
    }

    fn cell(&self, p: DVec2) -> (usize, usize) {
        let at = (p - self.low) * self.scale;
        ((at.x.max(0.0) as usize).min(self.columns - 1), (at.y.max(0.0) as usize).min(self.rows - 1))
    }

    /// True if a cell that the box touches has a segment.
    fn is_near(&self, low: DVec2, high: DVec2) -> bool {
        let ((a, b), (c, d)) = (self.cell(low), self.cell(high));
        let wide = self.columns + 1;
        let sum = |column: usize, row: usize| self.sums[row * wide + column];
        sum(c + 1, d + 1) + sum(a, b) > sum(a, d + 1) + sum(c + 1, b)
    }

    /// Segments near the box, ascending.
    pub fn near(&self, low: DVec2, high: DVec2, found: &mut Vec<u32>) {
        found.clear();
        let ((a, b), (c, d)) = (self.cell(low), self.cell(high));
        for row in b..=d {
            let of = |column: usize| self.starts[row * self.columns + column] as usize;
            found.extend(&self.items[of(a)..of(c + 1)]);
        }
        found.sort_unstable();
        found.dedup();
    }

    /// Distance of a point of the plane from the line, if it is less than `reach`; else more than that.
    pub fn distance(&self, p: DVec2, reach: f64) -> f64 {
        let mut near = vec![];
        self.near(p - reach, p + reach, &mut near);
        let off = near.into_iter().map(|k| {
            let [from, to] = self.sheet.segment(k as usize);
            let along = to - from;
            let t = (p - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
            p.distance(from + t.clamp(0.0, 1.0) * along)
        });
        off.fold(f64::INFINITY, f64::min)
    }

    /// Distance of a vertex at `p` from the swept surface, if it is less than `reach`; else more than that.
    pub fn off(&self, p: DVec3, v: u32, reach: f64) -> f64 {
        let depth = self.sheet.view.depth(p);
        depth * self.distance(self.sheet.seen[v as usize], reach / depth)
    }

    /// The distance of every vertex from the swept surface, if it is less than `reach`; else more than that.
    pub fn all_off(&self, vertices: &[DVec3], reach: f64) -> Vec<f64> {
        let off = |v: usize| self.off(vertices[v], v as u32, reach);
        (0..vertices.len()).into_par_iter().with_min_len(4096).map(off).collect()
    }

    /// Faces near the line, and the sides of all vertices.
    pub fn find(&self, vertices: &[DVec3], faces: Polygons<'_>) -> Result<Met> {
        let seen = &self.sheet.seen;
        let left = (0..vertices.len())
            .into_par_iter()
            .with_min_len(4096)
            .map(|v| {
                let (column, row) = self.cell(seen[v]);
                let cell = row * self.columns + column;
                if self.is_met(cell) { self.sheet.is_left(seen[v]) } else { self.left[cell] }
            })
            .collect::<Vec<_>>();
        let near = (0..faces.len())
            .into_par_iter()
            .with_min_len(4096)
            .filter(|&f| {
                let corners = faces.face(f);
                let first = seen[corners[0] as usize];
                let (mut low, mut high) = (first, first);
                for &v in &corners[1..] {
                    (low, high) = (low.min(seen[v as usize]), high.max(seen[v as usize]));
                }
                self.is_near(low, high)
            })
            .map(|f| f as u32)
            .collect::<Vec<_>>();
        if near.is_empty() {
            return Err(Error::StrokeMisses);
        }
        Ok(Met { faces: near, left, uncut: None })
    }
}
