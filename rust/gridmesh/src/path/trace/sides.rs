//! Which parts of closed lattice paths have the patch on the wrong side.

use super::conflicts::Vertex;
use super::search::Walk;
use crate::lattice::axial::Axial;
use crate::lattice::grid::Grid;
use crate::path::trace::contour::Contour;

/// The steps that do not have winding number one on their left and zero on their right, each by
/// the vertex that it leaves. O(n log n).
///
/// Of a boundary there are none. Where two walls of a narrow part have changed sides, or a loop
/// runs the wrong way round, there are.
pub(super) fn wrong_sides<G: Grid>(contours: &[Contour<G>], walks: &[Walk<G>]) -> Vec<Vertex> {
    let mut found = Vec::new();
    // Steps within a row are seen in a second sweep, of the lattice turned by one direction.
    for turned in [false, true] {
        let mut walls: Vec<Wall> = Vec::new();
        for (contour, (Contour { graph, .. }, walk)) in (0..).zip(contours.iter().zip(walks)) {
            for i in 0..walk.len() {
                let vertex = Vertex { contour, index: i as u32 };
                let from = graph.points[walk.node(i) as usize];
                let dir = walk.leave(i);
                let (from, dir, seen) = if turned {
                    (G::rotated(from), G::turned(dir, 1), dir.is_multiple_of(G::OPPOSITE))
                } else {
                    (from, dir, true)
                };
                walls.extend(Wall::new(from, from + G::offset(dir), vertex, seen));
            }
        }
        walls.sort_unstable_by_key(|wall| (wall.row, wall.place, wall.up));
        let mut winding = 0;
        for wall in &walls {
            // From west to east: a step down has the inside in the east.
            let (west, east) = (winding, winding + if wall.up { -1 } else { 1 });
            winding = east;
            let right = if wall.up { (1, 0) } else { (0, 1) };
            if wall.seen && (west, east) != right {
                found.push(wall.vertex);
            }
        }
    }
    found.sort_unstable();
    found
}

/// A step across a strip between two rows.
struct Wall {
    row: i32,
    place: i32,
    up: bool,
    vertex: Vertex,
    seen: bool,
}

impl Wall {
    fn new(from: Axial, to: Axial, vertex: Vertex, seen: bool) -> Option<Self> {
        (from.r != to.r).then(|| Self {
            row: from.r.min(to.r),
            place: from.q + to.q,
            up: to.r > from.r,
            vertex,
            seen,
        })
    }
}
