//! From closed paths on the square lattice to quads: the squares between them, and a belt around.

use std::sync::Arc;

use crate::lattice::axial::Axial;
use crate::lattice::cells::{Cells, Layout};

/// The quads of a patch: the squares that closed lattice paths enclose, and one more row, the belt,
/// along each path.
///
/// Vertices `0..n_rim` are the outer vertices of the belt, one for each vertex of the paths in their
/// order: each has two quads. They are followed by the vertices of `points`: first those of the paths, so that
/// outer vertex `i` lies beside vertex `n_rim + i`. A vertex of a path that turns has three or five quads, all
/// other vertices behind the rim have four.
#[derive(Clone, Debug, PartialEq)]
pub struct Belted {
    /// The lattice points: path after path in order, then those inside row by row.
    pub points: Vec<Axial>,
    /// Vertex numbers, counter-clockwise: the belt's quads first.
    pub quads: Vec<[u32; 4]>,
    /// Number of outer vertices.
    pub n_rim: usize,
}

/// Collects the quads of closed paths that are simple, disjoint and have the patch on their left.
///
/// O(number of quads + rows of the layout).
pub fn assemble_squares(paths: &[Vec<Axial>]) -> Belted {
    let n_rim = paths.iter().map(Vec::len).sum::<usize>();
    let mut quads = Vec::new();
    let mut start = 0;
    for path in paths {
        let n = path.len();
        for i in 0..n {
            let (here, next) = ((start + i) as u32, (start + (i + 1) % n) as u32);
            quads.push([here, next, n_rim as u32 + next, n_rim as u32 + here]);
        }
        start += n;
    }
    let (points, squares) = squares_within(paths);
    quads.extend(squares.into_iter().map(|quad| quad.map(|v| v + n_rim as u32)));
    Belted { points, quads, n_rim }
}

/// The lattice points of such paths, then those inside row by row; and the squares between them, counter-clockwise.
pub fn squares_within(paths: &[Vec<Axial>]) -> (Vec<Axial>, Vec<[u32; 4]>) {
    const NONE: u32 = u32::MAX;
    let mut points: Vec<Axial> = paths.concat();
    let layout = Arc::new(Layout::around(points.iter().copied(), 0));
    let mut number = Cells::new(layout, NONE);
    for (i, &p) in points.iter().enumerate() {
        number.set(p, i as u32);
    }
    // Steps across the strip above row r, each by its column.
    let mut walls: Vec<(i32, i32)> = Vec::new();
    for path in paths {
        let n = path.len();
        for (i, &from) in path.iter().enumerate() {
            let to = path[(i + 1) % n];
            if from.r != to.r {
                walls.push((from.r.min(to.r), from.q));
            }
        }
    }
    walls.sort_unstable();
    let mut quads = Vec::new();
    for wall in walls.chunks_exact(2) {
        let (r, from, to) = (wall[0].0, wall[0].1, wall[1].1);
        for q in from..to {
            let corners = [[q, r], [q + 1, r], [q + 1, r + 1], [q, r + 1]].map(|[q, r]| Axial::new(q, r));
            quads.push(corners.map(|p| match number.get(p) {
                NONE => {
                    let new = points.len() as u32;
                    number.set(p, new);
                    points.push(p);
                    new
                }
                known => known,
            }));
        }
    }
    (points, quads)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::grid::{Grid, Square};

    fn ring(corner: Axial, size: i32, outer: bool) -> Vec<Axial> {
        let mut at = corner;
        let mut path = Vec::new();
        for side in 0..4 {
            for _ in 0..size {
                path.push(at);
                at = at + Square::offset(side);
            }
        }
        if !outer {
            path.reverse();
        }
        path
    }

    /// How many quads each vertex has.
    fn valences(region: &Belted) -> Vec<usize> {
        let mut found = vec![0; region.n_rim + region.points.len()];
        region.quads.iter().flatten().for_each(|&v| found[v as usize] += 1);
        found
    }

    #[test]
    fn one_square_becomes_five_quads() {
        let region = assemble_squares(&[ring(Axial::new(0, 0), 1, true)]);
        assert_eq!((region.quads.len(), region.n_rim, region.points.len()), (5, 4, 4));
        assert_eq!(valences(&region), [2, 2, 2, 2, 3, 3, 3, 3]);
    }

    #[test]
    fn outer_vertices_have_two_quads_and_turns_are_poles() {
        let paths = [ring(Axial::new(-3, 2), 7, true), ring(Axial::new(-1, 4), 2, false)];
        let region = assemble_squares(&paths);
        assert_eq!(region.quads.len(), 28 + 8 + 49 - 4);
        let turns: Vec<i32> = paths.iter().flat_map(|path| Square::turns(path).collect::<Vec<_>>()).collect();
        assert_eq!(turns.iter().sum::<i32>(), 0);
        let valences = valences(&region);
        let n = region.n_rim;
        assert!(valences[..n].iter().all(|&v| v == 2));
        for (i, &turn) in turns.iter().enumerate() {
            assert_eq!(valences[n + i] as i32, 4 - turn);
        }
        assert!(valences[2 * n..].iter().all(|&v| v == 4));
        // Each edge is run through once in a direction.
        let mut edges: Vec<[u32; 2]> =
            region.quads.iter().flat_map(|q| (0..4).map(|k| [q[k], q[(k + 1) % 4]])).collect();
        let all = edges.len();
        edges.sort_unstable();
        edges.dedup();
        assert_eq!(edges.len(), all);
    }
}
