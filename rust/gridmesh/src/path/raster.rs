//! The lattice as a closed curve cuts it: which edges it crosses, which points it encloses.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use crate::lattice::axial::Axial;
use crate::lattice::cells::{Cells, Layout};
use crate::lattice::dir::Dir;
use crate::path::placement::Lattice;
use crate::path::target::Target;

const INSIDE: u8 = 1 << 6;

/// The lattice points inside a target and the lattice edges that it crosses.
///
/// A curve that runs exactly through a lattice point counts as passing a hair's breadth beside it,
/// the same for all edges, so that inside and outside always fit the crossings.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Bit `d` is set if the edge in direction `d` is crossed; bit 6 if the point is inside.
    cells: Cells<u8>,
}

impl Raster {
    /// Cuts the lattice by a target. The cells reach `margin` edges beyond the curve.
    ///
    /// O(number of cells): the rows are as long as the region is wide.
    pub fn new(target: &Target, margin: i32) -> Self {
        let points = target.points.iter().map(|&p| Lattice::nearest(p));
        let layout = Arc::new(Layout::around(points, margin + 1));
        let mut raster = Self { cells: Cells::new(layout, 0) };
        let mut crossings: Vec<(i32, i32, i32)> = Vec::new();
        for i in 0..target.len() {
            let (a, b) = target.segment(i);
            raster.cross(Lattice::axial_of(a), Lattice::axial_of(b), &mut crossings);
        }
        crossings.sort_unstable();
        // Along a row the winding number changes at each crossing.
        let mut winding = 0;
        for pair in crossings.windows(2) {
            let ((row, column, sign), (next_row, next_column, _)) = (pair[0], pair[1]);
            winding += sign;
            if row == next_row && winding > 0 {
                for q in column + 1..=next_column {
                    raster.mark(Axial::new(q, row), INSIDE);
                }
            }
        }
        raster
    }

    fn mark(&mut self, point: Axial, bits: u8) {
        if let Some(cell) = self.cells.get_mut(point) {
            *cell |= bits;
        }
    }

    fn block(&mut self, point: Axial, dir: Dir) {
        self.mark(point, 1 << dir.index());
        self.mark(point + dir, 1 << dir.opposite().index());
    }

    /// Marks the lattice edges that the segment from `a` to `b` (real axial coordinates) crosses.
    fn cross(&mut self, a: DVec2, b: DVec2, crossings: &mut Vec<(i32, i32, i32)>) {
        let lines = |from: f64, to: f64| {
            let (low, high) = (from.min(to), from.max(to));
            low.floor() as i32 + 1..=high.floor() as i32
        };
        for r in lines(a.y, b.y) {
            let q = at(a.x, b.x, a.y, b.y, f64::from(r));
            self.block(Axial::new(q, r), Dir::new(0));
            // Rows are scanned from the left: a crossing downwards enters, the inside being left of it.
            crossings.push((r, q, if b.y < a.y { 1 } else { -1 }));
        }
        for q in lines(a.x, b.x) {
            let r = at(a.y, b.y, a.x, b.x, f64::from(q));
            self.block(Axial::new(q, r), Dir::new(1));
        }
        for s in lines(a.x + a.y, b.x + b.y) {
            let q = at(a.x, b.x, a.x + a.y, b.x + b.y, f64::from(s));
            self.block(Axial::new(q, s - q), Dir::new(5));
        }
    }

    /// True if the point is inside and the curve crosses none of its edges in the directions whose
    /// bits are set.
    pub fn is_free(&self, point: Axial, directions: u8) -> bool {
        self.cells.get(point) & (directions | INSIDE) == INSIDE
    }

    /// The storage layout, to share.
    pub fn layout(&self) -> &Arc<Layout> {
        self.cells.layout()
    }

    /// True for a lattice point inside the curve.
    pub fn is_inside(&self, point: Axial) -> bool {
        self.cells.get(point) & INSIDE != 0
    }

    /// True if the curve crosses the edge from a point in a direction.
    pub fn is_crossed(&self, point: Axial, dir: Dir) -> bool {
        self.cells.get(point) & (1 << dir.index()) != 0
    }

    /// The lattice point deepest inside (in lattice steps) whose six triangles the curve does not
    /// meet; of equally deep ones the first in scan order. `None` if there is no such point.
    ///
    /// The paper leaves the choice to the user's stroke; any seed in the same chamber grows to the
    /// same patch, and the deepest lies in the widest chamber.
    pub fn seed(&self) -> Option<Axial> {
        let depth = self.depths();
        let free = |p: Axial| {
            Dir::ALL.into_iter().all(|dir| {
                self.is_inside(p + dir)
                    && !self.is_crossed(p, dir)
                    && !self.is_crossed(p + dir, dir.rotate(2))
            })
        };
        let mut best: Option<(u16, Axial)> = None;
        for (first, cells) in self.layout().rows() {
            for (&d, q) in depth[cells].iter().zip(first.q..) {
                let p = Axial::new(q, first.r);
                if d > best.map_or(1, |(deepest, _)| deepest) && free(p) {
                    best = Some((d, p));
                }
            }
        }
        best.map(|(_, p)| p)
    }

    /// Lattice steps from each cell to the nearest outside one: two sweeps, which suffice for a
    /// norm whose unit disk is the lattice's hexagon.
    fn depths(&self) -> Vec<u16> {
        let inside = self.cells.values();
        let mut depth = vec![0u16; inside.len()];
        let step = |depth: &[u16], near: [usize; 3]| {
            near.into_iter().map(|i| depth[i]).min().unwrap_or(0).saturating_add(1)
        };
        for (first, cells) in self.layout().rows() {
            let Some(shift) = self.shifts(first, &cells) else { continue };
            for i in cells.filter(|&i| inside[i] & INSIDE != 0) {
                depth[i] = step(&depth, [3, 4, 5].map(|d| i.wrapping_add_signed(shift[d])));
            }
        }
        for (first, cells) in self.layout().rows().rev() {
            let Some(shift) = self.shifts(first, &cells) else { continue };
            for i in cells.rev().filter(|&i| inside[i] & INSIDE != 0) {
                depth[i] = depth[i].min(step(&depth, [0, 1, 2].map(|d| i.wrapping_add_signed(shift[d]))));
            }
        }
        depth
    }

    /// How far the cells of the six neighbours lie from a point's own: the same all along a row.
    /// `None` for a row without inner points.
    fn shifts(&self, first: Axial, cells: &Range<usize>) -> Option<[isize; 6]> {
        let inside = self.cells.values()[cells.clone()].iter().position(|&bits| bits & INSIDE != 0)?;
        let around = self.layout().neighbours(Axial::new(first.q + inside as i32, first.r))?;
        Some(around.map(|i| i as isize - (cells.start + inside) as isize))
    }
}

/// The whole part of the value, between `from` and `to`, that belongs to `key` between its ends.
fn at(from: f64, to: f64, key_from: f64, key_to: f64, key: f64) -> i32 {
    (from + (to - from) * ((key - key_from) / (key_to - key_from))).floor() as i32
}
