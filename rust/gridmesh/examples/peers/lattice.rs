//! The obvious way to a semi-regular mesh: the points of a triangular lattice that lie inside the
//! contours, and the constrained Delaunay triangulation of them and the contours.

use spade::Point2;

use crate::delaunay::{input, triangulated};
use crate::{Mesh, Outcome};

/// Lattice points nearer to a contour than this many edges are left out. Between 0.4 and 0.8 this
/// gives the best angles with about the fewest irregular vertices.
const GAP: f64 = 0.6;

pub(crate) fn mesh(contours: &[Vec<[f64; 2]>], size: f64) -> Outcome<Mesh> {
    let mut input = input(contours);
    let mut lattice = Lattice::around(contours, size).ok_or("the contours have no extent")?;
    for segment in segments(contours) {
        lattice.cross(segment);
    }
    lattice.fill();
    for segment in segments(contours) {
        lattice.clear_near(segment, GAP * size);
    }
    input.points.extend(lattice.points());
    triangulated(input)
}

type Segment = [[f64; 2]; 2];

fn segments(contours: &[Vec<[f64; 2]>]) -> impl Iterator<Item = Segment> {
    contours
        .iter()
        .flat_map(|contour| (0..contour.len()).map(move |i| [contour[i], contour[(i + 1) % contour.len()]]))
}

/// Lattice points by row and column, every other row shifted by half an edge.
struct Lattice {
    origin: [f64; 2],
    size: f64,
    height: f64,
    columns: usize,
    crossings: Vec<Vec<f64>>,
    inside: Vec<bool>,
}

impl Lattice {
    fn around(contours: &[Vec<[f64; 2]>], size: f64) -> Option<Self> {
        let points = || contours.iter().flatten();
        let least = |k: usize| points().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let most = |k: usize| points().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
        let height = 0.5 * 3f64.sqrt() * size;
        let columns = ((most(0) - least(0)) / size).ceil() + 2.0;
        let rows = ((most(1) - least(1)) / height).ceil() + 2.0;
        if !(columns.is_finite() && rows.is_finite() && columns * rows < 1e9) {
            return None;
        }
        let (columns, rows) = (columns as usize, rows as usize);
        Some(Self {
            // Half a cell off, so that no row runs along the bottom of a drawing.
            origin: [least(0) - 0.5 * size, least(1) - 0.5 * height],
            size,
            height,
            columns,
            crossings: vec![Vec::new(); rows],
            inside: vec![false; columns * rows],
        })
    }

    fn y(&self, row: usize) -> f64 {
        self.origin[1] + row as f64 * self.height
    }

    fn x(&self, row: usize, column: usize) -> f64 {
        self.origin[0] + (column as f64 + 0.5 * (row % 2) as f64) * self.size
    }

    /// Rows between two heights.
    fn rows(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let row = |y: f64| ((y - self.origin[1]) / self.height).ceil().max(0.0) as usize;
        row(low)..row(high).min(self.crossings.len())
    }

    /// Columns of a row between two abscissae.
    fn columns(&self, row: usize, left: f64, right: f64) -> std::ops::Range<usize> {
        let start = self.x(row, 0);
        let column = |x: f64| ((x - start) / self.size).ceil().max(0.0) as usize;
        column(left)..column(right).min(self.columns)
    }

    fn cross(&mut self, [a, b]: Segment) {
        for row in self.rows(a[1].min(b[1]), a[1].max(b[1])) {
            let t = (self.y(row) - a[1]) / (b[1] - a[1]);
            self.crossings[row].push(a[0] + t * (b[0] - a[0]));
        }
    }

    fn fill(&mut self) {
        for row in 0..self.crossings.len() {
            let mut crossings = std::mem::take(&mut self.crossings[row]);
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let columns = self.columns(row, pair[0], pair[1]);
                let start = row * self.columns;
                self.inside[start + columns.start.min(columns.end)..start + columns.end].fill(true);
            }
        }
    }

    fn clear_near(&mut self, [a, b]: Segment, gap: f64) {
        for row in self.rows(a[1].min(b[1]) - gap, a[1].max(b[1]) + gap) {
            for column in self.columns(row, a[0].min(b[0]) - gap, a[0].max(b[0]) + gap) {
                let (x, y) = (self.x(row, column) - a[0], self.y(row) - a[1]);
                let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
                let t = ((x * dx + y * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
                if (x - t * dx).hypot(y - t * dy) < gap {
                    self.inside[row * self.columns + column] = false;
                }
            }
        }
    }

    fn points(&self) -> impl Iterator<Item = Point2<f64>> {
        let chosen = (0..self.inside.len()).filter(|&i| self.inside[i]);
        chosen.map(|i| Point2::new(self.x(i / self.columns, i % self.columns), self.y(i / self.columns)))
    }
}
