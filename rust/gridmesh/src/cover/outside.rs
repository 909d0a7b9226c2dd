//! How far points of a contour lie outside the loop of a patch that follows it.

use glam::DVec2;

use crate::geometry::segments::{SegmentGrid, nearest_on_segment};
use crate::patch::Patch;

/// The edges of one loop of a patch.
pub(super) struct LoopEdges {
    edges: Vec<[DVec2; 2]>,
    /// For distances.
    grid: SegmentGrid,
    /// Edges by the rows of equal height that they reach into.
    rows: Vec<Vec<u32>>,
    low: f64,
    height: f64,
    /// A length to begin the search of the nearest edge with.
    step: f64,
    is_hole: bool,
}

impl LoopEdges {
    /// Those of the loop `k`.
    pub(super) fn new(patch: &Patch, k: usize) -> Self {
        let loop_ = &patch.loops[k];
        let points = &patch.vertices[loop_.start as usize..][..loop_.len()];
        let n = points.len();
        let edges: Vec<[DVec2; 2]> = (0..n).map(|i| [points[i], points[(i + 1) % n]]).collect();
        let low = points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.y).fold(-f64::INFINITY, f64::max);
        let height = ((high - low) / n as f64).max(f64::MIN_POSITIVE);
        let mut rows = vec![Vec::new(); n + 1];
        for (i, [a, b]) in edges.iter().enumerate() {
            let row = |y: f64| (((y - low) / height) as usize).min(n);
            for row in &mut rows[row(a.y.min(b.y))..=row(a.y.max(b.y))] {
                row.push(i as u32);
            }
        }
        let grid = SegmentGrid::new(&edges);
        Self { edges, grid, rows, low, height, step: patch.lattice.edge_length, is_hole: k > 0 }
    }

    /// The distance of a point from the patch less the slack; 0 inside. Beyond four edge lengths only that it is that far.
    pub(super) fn outside(&self, point: DVec2, slack: f64) -> f64 {
        // The loop of a hole has the mesh around it.
        if self.encloses(point) != self.is_hole {
            return 0.0;
        }
        (self.distance(point) - slack).max(0.0)
    }

    /// Even-odd.
    fn encloses(&self, point: DVec2) -> bool {
        let row = (point.y - self.low) / self.height;
        if row < 0.0 || row >= self.rows.len() as f64 {
            return false;
        }
        let crossed = self.rows[row as usize].iter().filter(|&&i| {
            let [a, b] = self.edges[i as usize];
            (a.y <= point.y) != (b.y <= point.y)
                && a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x) > point.x
        });
        crossed.count() % 2 == 1
    }

    fn distance(&self, point: DVec2) -> f64 {
        let mut reach = 0.25 * self.step;
        loop {
            let mut least = f64::INFINITY;
            self.grid.near(point - reach, point + reach, |i| {
                let [a, b] = self.edges[i];
                least = least.min(nearest_on_segment(point, a, b).1);
            });
            let distance = least.sqrt();
            if distance <= reach {
                return distance;
            }
            if reach >= 4.0 * self.step {
                return reach;
            }
            reach *= 2.0;
        }
    }
}
