//! From closed lattice paths to the triangles between them.

use std::convert::Infallible;
use std::sync::Arc;

use crate::lattice::axial::Axial;
use crate::lattice::cells::{Cells, Layout};
use crate::lattice::dir::Dir;

/// The lattice points and triangles that closed lattice paths enclose.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The lattice points: path after path in order, then the interior ones row by row.
    pub points: Vec<Axial>,
    /// Vertex numbers, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Number of vertices on the paths.
    pub n_boundary: usize,
}

/// Triangles between two questions whether to go on.
const ASK_EVERY: usize = 1 << 15;

/// Collects the triangles with the paths on their right or left by parity: those that an odd
/// number of path edges separates from the outside.
///
/// The paths must be simple and disjoint. O(number of triangles + rows of the layout).
pub fn assemble(paths: &[Vec<Axial>]) -> Region {
    let Ok(region) = assemble_asking(paths, || Ok::<(), Infallible>(()));
    region
}

/// As [`assemble`], and asks again and again whether to go on.
pub(crate) fn assemble_asking<E>(
    paths: &[Vec<Axial>],
    mut go_on: impl FnMut() -> Result<(), E>,
) -> Result<Region, E> {
    const NONE: u32 = u32::MAX;
    let mut points: Vec<Axial> = paths.concat();
    let n_boundary = points.len();
    let layout = Arc::new(Layout::around(points.iter().copied(), 0));
    let mut number = Cells::new(layout, NONE);
    for (i, &p) in points.iter().enumerate() {
        number.set(p, i as u32);
    }
    // In the strip above row r the triangles alternate: number 2q points up from (q, r), 2q + 1
    // points down to (q + 1, r). A path edge across the strip stands before one of them.
    let mut walls: Vec<(i32, i32)> = Vec::new();
    for path in paths {
        for (i, &from) in path.iter().enumerate() {
            let to = path[(i + 1) % path.len()];
            let Some(dir) = from.step_to(to) else {
                continue;
            };
            match dir.index() {
                1 => walls.push((from.r, 2 * from.q)),
                4 => walls.push((to.r, 2 * to.q)),
                2 => walls.push((from.r, 2 * from.q - 1)),
                5 => walls.push((to.r, 2 * to.q - 1)),
                _ => {}
            }
        }
    }
    walls.sort_unstable();
    let n_triangles = walls.chunks_exact(2).map(|wall| (wall[1].1 - wall[0].1).max(0) as usize).sum();
    let mut triangles = Vec::with_capacity(n_triangles);
    // Euler, for a disk; holes take less.
    points.reserve(n_triangles.saturating_sub(n_boundary) / 2 + 1);
    let mut asked = 0;
    for wall in walls.chunks_exact(2) {
        if triangles.len() - asked >= ASK_EVERY {
            asked = triangles.len();
            go_on()?;
        }
        let (r, from, to) = (wall[0].0, wall[0].1, wall[1].1);
        for k in from..to {
            let q = k.div_euclid(2);
            let corner = Axial::new(q, r);
            let (east, north) = (corner + Dir::new(0), corner + Dir::new(1));
            let corners =
                if k.rem_euclid(2) == 0 { [corner, east, north] } else { [east, east + Dir::new(1), north] };
            triangles.push(corners.map(|p| match number.get(p) {
                NONE => {
                    number.set(p, points.len() as u32);
                    points.push(p);
                    points.len() as u32 - 1
                }
                known => known,
            }));
        }
    }
    Ok(Region { points, triangles, n_boundary })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::placement::Lattice;

    fn ring(radius: i32, outer: bool) -> Vec<Axial> {
        let mut at = Axial::new(radius, 0);
        let mut path = Vec::new();
        for side in 0..6 {
            for _ in 0..radius {
                path.push(at);
                at = at + Dir::new(side + 2);
            }
        }
        if !outer {
            path.reverse();
        }
        path
    }

    #[test]
    fn a_hexagon_is_full() {
        for radius in 1..8 {
            let region = assemble(&[ring(radius, true)]);
            assert_eq!(region.triangles.len() as i32, 6 * radius * radius);
            assert_eq!(region.points.len() as i32, 3 * radius * (radius + 1) + 1);
            assert_eq!(region.n_boundary as i32, 6 * radius);
            for t in &region.triangles {
                let [a, b, c] = t.map(|v| Lattice::units(region.points[v as usize]));
                assert!(((b - a).perp_dot(c - a) - crate::path::placement::ROW_HEIGHT).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn large_regions_ask_whether_to_go_on() {
        let path = [ring(300, true)];
        let mut asked = 0;
        let mut go_on = |most: usize| {
            asked = 0;
            assemble_asking(&path, || {
                asked += 1;
                if asked > most { Err("no") } else { Ok(()) }
            })
        };
        let region = go_on(usize::MAX).unwrap();
        assert_eq!(region, assemble(&path));
        assert_eq!(go_on(1), Err("no"));
        let _ = go_on(usize::MAX);
        // A row of triangles more at most.
        assert!(asked + 1 >= region.triangles.len() / (ASK_EVERY + 4 * 300), "{asked}");
    }

    #[test]
    fn a_hole_is_empty() {
        let region = assemble(&[ring(6, true), ring(2, false)]);
        assert_eq!(region.triangles.len(), 6 * 36 - 6 * 4);
        assert_eq!(region.points.len(), 3 * 6 * 7 + 1 - 7);
    }
}
