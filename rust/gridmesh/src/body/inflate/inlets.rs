//! Where no vertex of a body may go: inlets of the drawing that the silhouette bridges.

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::drawing::contours::encloses;
use crate::patch::Patch;
use crate::patch::pockets::distance_to;

/// A vertex may lie this far outside the drawing, in edges of the patch.
const TOLERANCE: f64 = 0.08;

/// The inlets of a patch, found by the square cells that they touch.
pub(crate) struct Inlets {
    polygons: Vec<Vec<DVec2>>,
    cells: FxHashMap<(i32, i32), Vec<u32>>,
    cell: f64,
    tolerance: f64,
}

impl Inlets {
    /// The inlets of a patch, moved so that `middle` is the origin.
    pub fn new(patch: &Patch, middle: DVec2) -> Self {
        let cell = patch.lattice.edge_length;
        let polygons: Vec<Vec<DVec2>> =
            patch.inlets.iter().map(|inlet| inlet.iter().map(|&p| p - middle).collect()).collect();
        let mut inlets = Inlets { polygons, cells: FxHashMap::default(), cell, tolerance: TOLERANCE * cell };
        for (i, polygon) in inlets.polygons.iter().enumerate() {
            let (low, high) = crate::drawing::curve::bounds(polygon);
            let ((x0, y0), (x1, y1)) = (key(low, cell), key(high, cell));
            for x in x0..=x1 {
                for y in y0..=y1 {
                    inlets.cells.entry((x, y)).or_default().push(i as u32);
                }
            }
        }
        inlets
    }

    /// Whether a point lies in an inlet, farther than the tolerance from the drawing.
    pub fn hold(&self, point: DVec2) -> bool {
        let near = self.cells.get(&key(point, self.cell));
        near.into_iter().flatten().any(|&i| {
            let polygon = &self.polygons[i as usize];
            encloses(polygon, point) && distance_to(polygon, point) > self.tolerance
        })
    }
}

fn key(point: DVec2, cell: f64) -> (i32, i32) {
    ((point.x / cell).floor() as i32, (point.y / cell).floor() as i32)
}
