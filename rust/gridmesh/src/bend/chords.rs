//! The chords of a carrier's boundary in one of its two planes, found by where they are.

use std::sync::OnceLock;

use glam::DVec2;

use super::carrier::Carrier;
use crate::geometry::segments::SegmentGrid;

/// The boundary edges of a carrier; sorted by their places when first asked for.
pub(super) struct Chords<'a> {
    carrier: &'a Carrier,
    positions: &'a [DVec2],
    sorted: OnceLock<Sorted>,
}

struct Sorted {
    ends: Vec<[usize; 2]>,
    segments: Vec<[DVec2; 2]>,
    grid: SegmentGrid,
}

impl<'a> Chords<'a> {
    /// With the vertices of the carrier at these positions.
    pub fn new(carrier: &'a Carrier, positions: &'a [DVec2]) -> Self {
        Self { carrier, positions, sorted: OnceLock::new() }
    }

    /// The ends of the chord nearest to a point, and the parameter on it; none without a boundary.
    pub fn nearest(&self, point: DVec2) -> Option<([usize; 2], f64)> {
        let sorted = self.sorted.get_or_init(|| {
            let rims = self.carrier.rims.iter();
            let ends: Vec<[usize; 2]> =
                rims.flat_map(|rim| (0..rim.len()).map(|i| [rim.start + i, rim.next(i)])).collect();
            let segments: Vec<[DVec2; 2]> = ends.iter().map(|ends| ends.map(|e| self.positions[e])).collect();
            let grid = SegmentGrid::new(&segments);
            Sorted { ends, segments, grid }
        });
        if sorted.ends.is_empty() {
            return None;
        }
        let (i, t) = sorted.grid.nearest(&sorted.segments, point);
        Some((sorted.ends[i], t))
    }
}
