//! What makes closed lattice paths no boundary of a patch: repeated points and chords.

use rustc_hash::FxHashMap;

use super::search::Walk;
use crate::lattice::axial::Axial;
use crate::lattice::grid::Grid;
use crate::path::trace::contour::Contour;

/// A vertex of one of several paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Vertex {
    pub contour: u32,
    pub index: u32,
}

/// Two vertices that may not both be as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Conflict {
    pub a: Vertex,
    pub b: Vertex,
    /// The direction from `a` to `b` of a chord; `None` if both are the same point.
    pub chord: Option<u32>,
}

/// Finds all conflicts, in the order of their first vertices. O(vertices).
#[derive(Default)]
pub(super) struct Finder {
    at: FxHashMap<Axial, Vertex>,
}

impl Finder {
    pub fn find<G: Grid>(&mut self, contours: &[Contour<G>], walks: &[Walk<G>]) -> Vec<Conflict> {
        let mut found = Vec::new();
        self.at.clear();
        for (contour, (Contour { graph, .. }, walk)) in (0..).zip(contours.iter().zip(walks)) {
            for i in 0..walk.len() {
                let a = Vertex { contour, index: i as u32 };
                let point = graph.points[walk.node(i) as usize];
                let first = *self.at.entry(point).or_insert(a);
                if first != a {
                    found.push(Conflict { a: first, b: a, chord: None });
                }
            }
        }
        if !G::FORBIDS_CHORDS {
            return found;
        }
        for (contour, (Contour { graph, .. }, walk)) in (0..).zip(contours.iter().zip(walks)) {
            for i in 0..walk.len() {
                let a = Vertex { contour, index: i as u32 };
                let point = graph.points[walk.node(i) as usize];
                let count = (2 - walk.turn(i)).max(0) as u32;
                for k in 1..=count {
                    let dir = G::turned(walk.leave(i), k as i32);
                    let Some(&b) = self.at.get(&(point + G::offset(dir))) else {
                        continue;
                    };
                    // Seen from both ends, unless a repeated point hides one of them.
                    if a < b || !sees(walks, b, G::turned(dir, G::OPPOSITE as i32)) {
                        found.push(Conflict { a, b, chord: Some(dir) });
                    }
                }
            }
        }
        found
    }
}

/// True if the edge in a direction from a vertex lies inside the patch, seen from there.
fn sees<G: Grid>(walks: &[Walk<G>], vertex: Vertex, dir: u32) -> bool {
    let walk = &walks[vertex.contour as usize];
    let i = vertex.index as usize;
    let count = (2 - walk.turn(i)).max(0) as u32;
    (1..=count).any(|k| G::turned(walk.leave(i), k as i32) == dir)
}
