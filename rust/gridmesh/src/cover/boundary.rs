//! Edges of a boundary that must not meet while vertices are moved.

use glam::DVec2;

use crate::cover::outside::loop_of;
use crate::geometry::embed::is_turned_over;
use crate::geometry::segments::{SegmentGrid, segments_meet};
use crate::patch::Patch;

/// The edges of all loops of a patch.
pub(super) struct Boundary {
    edges: Vec<[usize; 2]>,
    /// For each boundary vertex the vertices before and after it.
    beside: Vec<[usize; 2]>,
    /// Of the edges where they were at first.
    grid: SegmentGrid,
    /// How far each vertex was moved since, and the largest of it.
    far: Vec<f64>,
    farthest: f64,
}

impl Boundary {
    pub(super) fn new(patch: &Patch) -> Self {
        let (mut edges, mut beside) = (Vec::new(), Vec::new());
        for contour in &patch.loops {
            let (start, n) = (contour.start as usize, contour.len());
            for i in 0..n {
                edges.push([start + i, start + (i + 1) % n]);
                beside.push([start + (i + n - 1) % n, start + (i + 1) % n]);
            }
        }
        let places: Vec<[DVec2; 2]> = edges.iter().map(|edge| edge.map(|v| patch.vertices[v])).collect();
        let far = vec![0.0; edges.len()];
        Self { edges, beside, grid: SegmentGrid::new(&places), far, farthest: 0.0 }
    }

    /// Whether the two edges at a vertex meet no others, and a loop of three is not turned over. Near-constant time.
    pub(super) fn stays_simple(&self, patch: &Patch, vertex: usize) -> bool {
        let place = |v: usize| patch.vertices[v];
        let mut is_simple = keeps_side(patch, vertex);
        for other in self.beside[vertex] {
            let [low, high] = [place(vertex).min(place(other)), place(vertex).max(place(other))];
            self.grid.near(low - self.farthest, high + self.farthest, |i| {
                let ends = self.edges[i];
                let is_beside = ends.contains(&vertex) || ends.contains(&other);
                is_simple &= is_beside || !segments_meet([place(vertex), place(other)], ends.map(place));
            });
        }
        is_simple
    }

    /// Notes that a vertex was moved from where it was before.
    pub(super) fn moved(&mut self, patch: &Patch, vertex: usize, before: DVec2) {
        self.far[vertex] += before.distance(patch.vertices[vertex]);
        self.farthest = self.farthest.max(self.far[vertex]);
    }
}

/// Whether the loop of a vertex, if it has three, encloses what it is to: no two of its edges could be seen to cross.
pub(super) fn keeps_side(patch: &Patch, vertex: usize) -> bool {
    let k = patch.loops.iter().rposition(|contour| contour.start as usize <= vertex).unwrap_or(0);
    let points = loop_of(patch, k);
    points.len() > 3 || !is_turned_over(points, k > 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SketchOptions;
    use crate::progress::Progress;
    use crate::sketch::mesh_sketch;

    #[test]
    fn edges_that_come_to_meet_others_are_found_also_after_moves() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].map(DVec2::from);
        let options = SketchOptions { triangles: Some(200), ..SketchOptions::default() };
        let mut patch = mesh_sketch(&square, &[], &options, Progress::NONE).unwrap().patch;
        let mut boundary = Boundary::new(&patch);
        let n = patch.n_boundary();
        assert!((0..n).all(|v| boundary.stays_simple(&patch, v)));
        let nearest = |patch: &Patch, to: DVec2| {
            let away = |v: &usize| patch.vertices[*v].distance(to);
            (0..n).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap()
        };
        let low = nearest(&patch, DVec2::new(2.0, 0.0));
        let x = patch.vertices[low].x;
        let high = nearest(&patch, DVec2::new(x, 4.0));
        let before = patch.vertices[low];
        patch.vertices[low].y = 5.0;
        assert!(!boundary.stays_simple(&patch, low));
        patch.vertices[low].y = 3.0;
        assert!(boundary.stays_simple(&patch, low));
        boundary.moved(&patch, low, before);
        patch.vertices[high] = DVec2::new(x, 1.0);
        assert!(!boundary.stays_simple(&patch, high));
    }

    #[test]
    fn a_hole_of_three_vertices_is_not_turned_over() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].map(DVec2::from);
        let hole = [[1.8, 1.8], [2.0, 2.2], [2.2, 1.8]].map(DVec2::from).to_vec();
        let options = SketchOptions { triangles: Some(160), ..SketchOptions::default() };
        let mut patch = mesh_sketch(&square, &[hole], &options, Progress::NONE).unwrap().patch;
        assert_eq!(patch.loops[1].len(), 3);
        let boundary = Boundary::new(&patch);
        let range = patch.loops[1].vertices();
        let (first, second, third) =
            (range.start as usize, range.start as usize + 1, range.start as usize + 2);
        assert!(boundary.stays_simple(&patch, first));
        let beyond = patch.vertices[second] + patch.vertices[third] - patch.vertices[first];
        patch.vertices[first] = beyond;
        assert!(!boundary.stays_simple(&patch, first));
    }
}
