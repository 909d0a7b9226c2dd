//! Which triangle a point lies in: a uniform grid over the triangles' boxes.

use glam::DVec2;

use crate::drawing::curve::bounds;

/// Triangles sorted into square cells that their boxes meet.
pub struct TriangleGrid {
    origin: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl TriangleGrid {
    /// About one cell for each triangle.
    pub fn new(positions: &[DVec2], triangles: &[[u32; 3]]) -> Self {
        let (low, high) = bounds(positions);
        let size = high - low;
        let n = triangles.len().max(1) as f64;
        let cell = (size.x * size.y / n).sqrt().max(size.max_element() / 4096.0).max(f64::MIN_POSITIVE);
        let (columns, rows) = ((size.x / cell) as usize + 1, (size.y / cell) as usize + 1);
        let mut grid =
            Self { origin: low, cell, columns, rows, starts: vec![0; columns * rows + 1], items: vec![] };
        let mut entries = Vec::with_capacity(4 * triangles.len());
        for (t, corners) in (0u32..).zip(triangles) {
            let [a, b, c] = corners.map(|v| positions[v as usize]);
            let ((left, bottom), (right, top)) =
                (grid.cell_of(a.min(b).min(c)), grid.cell_of(a.max(b).max(c)));
            for row in bottom..=top {
                entries.extend((left..=right).map(|column| ((row * columns + column) as u32, t)));
            }
        }
        entries.sort_unstable();
        for &(cell, _) in &entries {
            grid.starts[cell as usize + 1] += 1;
        }
        for cell in 0..columns * rows {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        grid.items = entries.into_iter().map(|(_, t)| t).collect();
        grid
    }

    fn cell_of(&self, p: DVec2) -> (usize, usize) {
        let d = (p - self.origin) / self.cell;
        ((d.x.max(0.0) as usize).min(self.columns - 1), (d.y.max(0.0) as usize).min(self.rows - 1))
    }

    /// The triangle in which a point lies and its barycentric coordinates there; none outside.
    pub fn locate(&self, x: DVec2, positions: &[DVec2], triangles: &[[u32; 3]]) -> Option<(usize, [f64; 3])> {
        const EDGE: f64 = -1e-12;
        let (column, row) = self.cell_of(x);
        let cell = row * self.columns + column;
        let items = &self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        items.iter().find_map(|&t| {
            let [a, b, c] = triangles[t as usize].map(|v| positions[v as usize]);
            let doubled = (b - a).perp_dot(c - a);
            let weights = [(b - x).perp_dot(c - x), (c - x).perp_dot(a - x), (a - x).perp_dot(b - x)]
                .map(|w| w / doubled);
            weights.iter().all(|&w| w >= EDGE).then_some((t as usize, weights))
        })
    }
}
