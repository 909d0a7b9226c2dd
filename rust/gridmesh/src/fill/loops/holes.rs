//! Finds the boundary loops of a mesh, and puts loose edges in order.

use rustc_hash::FxHashMap;

use super::mesh::repeats;
use crate::error::{Error, Result};
use crate::geometry::disjoint::Disjoint;

/// The boundary loops of a mesh, each as vertices in order, wound as a patch that fills it.
///
/// Edges of one triangle are walked from the least vertex on. Where borders touch in a vertex the
/// walk is split there, so that no loop visits a vertex twice; a chain that ends at an edge of more
/// than two triangles is an error item. Half-edges are paired after all triangles are known, so
/// their order does not matter. Linear, with about 12 bytes for each half-edge.
///
/// # Errors
/// [`Error::IndexOutOfRange`] if a triangle names a vertex that does not exist.
pub fn boundary_loops(n_vertices: usize, triangles: &[[u32; 3]]) -> Result<Vec<Result<Vec<u32>>>> {
    let mut start = vec![0u32; n_vertices + 1];
    for (t, corners) in triangles.iter().enumerate() {
        if let Some(&v) = corners.iter().find(|&&v| v as usize >= n_vertices) {
            return Err(Error::IndexOutOfRange {
                what: format!("triangle {t}"),
                index: v as i32,
                vertices: n_vertices,
            });
        }
        if !repeats(corners) {
            for k in 0..3 {
                start[corners[k].min(corners[(k + 1) % 3]) as usize + 1] += 1;
            }
        }
    }
    for v in 0..n_vertices {
        start[v + 1] += start[v];
    }
    // In each bucket of a lower vertex: the upper one, and whether the half-edge goes up.
    let mut next = start.clone();
    let mut sides = vec![(0u32, false); start[n_vertices] as usize];
    for corners in triangles.iter().filter(|t| !repeats(t)) {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let slot = &mut next[a.min(b) as usize];
            sides[*slot as usize] = (a.max(b), a < b);
            *slot += 1;
        }
    }
    let mut border = vec![];
    for low in 0..n_vertices {
        let bucket = &mut sides[start[low] as usize..start[low + 1] as usize];
        bucket.sort_unstable();
        for same in bucket.chunk_by(|a, b| a.0 == b.0) {
            if let [(high, up)] = *same {
                // Against the triangle: the direction of a patch.
                border.push(if up { [high, low as u32] } else { [low as u32, high] });
            }
        }
    }
    Ok(walk(&border, |end, edge| Error::NonManifold { edge: border[edge], vertex: end }))
}

/// Puts loose edges, such as selected ones, in order: one item for each closed loop.
///
/// Items come in the order of their least edge. Directions are of no importance.
///
/// # Errors
/// Of an item: [`Error::Branching`] if more than two of the edges meet in a vertex,
/// [`Error::FigureEight`] if exactly four do, [`Error::OpenChain`] if the chain has ends,
/// [`Error::TooFewPoints`] if an edge joins a vertex to itself.
pub fn edge_loops(edges: &[[u32; 2]]) -> Vec<Result<Vec<u32>>> {
    let mut edges = edges.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect::<Vec<_>>();
    edges.sort_unstable();
    edges.dedup();
    let mut ends = edges.iter().flatten().copied().collect::<Vec<_>>();
    ends.sort_unstable();
    let counts = ends.chunk_by(|a, b| a == b).map(|same| (same[0], same.len())).collect::<FxHashMap<_, _>>();
    // Connected pieces, so that one bad piece spoils no other.
    ends.dedup();
    let rank = |v: u32| ends.partition_point(|&end| end < v) as u32;
    let mut sets = Disjoint::new(ends.len());
    edges.iter().for_each(|&[a, b]| sets.join(rank(a), rank(b)));
    let mut pieces: Vec<(u32, [u32; 2])> = edges.iter().map(|&e| (sets.root(rank(e[0])), e)).collect();
    pieces.sort_unstable();
    pieces
        .chunk_by(|a, b| a.0 == b.0)
        .map(|part| {
            let part = part.iter().map(|&(_, edge)| edge).collect::<Vec<_>>();
            if let Some(&[v, _]) = part.iter().find(|[a, b]| a == b) {
                return Err(Error::RepeatedVertex { vertex: v, first: 0, second: 1 });
            }
            let mut vertices = part.iter().flatten().copied().collect::<Vec<_>>();
            vertices.sort_unstable();
            vertices.dedup();
            let of_degree = |test: &dyn Fn(usize) -> bool| {
                vertices.iter().copied().filter(|v| test(counts[v])).collect::<Vec<_>>()
            };
            let crossings = of_degree(&|k| k == 4);
            let odd = of_degree(&|k| k % 2 == 1);
            if let Some(&vertex) = of_degree(&|k| k > 2).first() {
                return Err(if odd.is_empty() && !crossings.is_empty() {
                    Error::FigureEight { vertex: crossings[0] }
                } else {
                    Error::Branching { vertex, edges: counts[&vertex] }
                });
            }
            if let [a, b, ..] = odd[..] {
                return Err(Error::OpenChain { ends: [a, b] });
            }
            walk(&part, |end, edge| Error::NonManifold { edge: part[edge], vertex: end })
                .pop()
                .unwrap_or(Ok(vec![]))
        })
        .collect()
}

/// Follows `edges`, preferably in their direction, to closed loops without repeated vertices.
fn walk(edges: &[[u32; 2]], dead_end: impl Fn(u32, usize) -> Error) -> Vec<Result<Vec<u32>>> {
    // (vertex, arriving?, edge): at each vertex the edges that leave it come first.
    let mut ends = Vec::with_capacity(2 * edges.len());
    for (e, &[a, b]) in edges.iter().enumerate() {
        ends.push((a, false, e as u32));
        ends.push((b, true, e as u32));
    }
    ends.sort_unstable();
    let at = |v: u32| {
        let first = ends.partition_point(|end| end.0 < v);
        ends[first..].iter().take_while(move |end| end.0 == v)
    };
    let mut used = vec![false; edges.len()];
    let mut loops = vec![];
    let mut order = (0..edges.len()).collect::<Vec<_>>();
    order.sort_unstable_by_key(|&e| edges[e]);
    for first in order {
        if used[first] {
            continue;
        }
        used[first] = true;
        let mut path = vec![edges[first][0]];
        let mut place: FxHashMap<u32, usize> = FxHashMap::default();
        place.insert(path[0], 0);
        let mut here = edges[first][1];
        let mut last = first;
        loop {
            if let Some(&from) = place.get(&here) {
                let mut part = path.split_off(from);
                part.iter().for_each(|v| {
                    place.remove(v);
                });
                let least = part.iter().enumerate().min_by_key(|(_, v)| **v).map_or(0, |(k, _)| k);
                part.rotate_left(least);
                loops.push(Ok(part));
            }
            place.insert(here, path.len());
            let Some(&(_, arriving, e)) = at(here).find(|end| !used[end.2 as usize]) else {
                // All edges at `here` are used: either the walk is back at its start or it is stuck.
                if !path.is_empty() {
                    loops.push(Err(dead_end(here, last)));
                }
                break;
            };
            path.push(here);
            last = e as usize;
            used[last] = true;
            here = edges[last][usize::from(!arriving)];
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of n x n quads, each two triangles; `without` are left out.
    fn grid(n: u32, without: &[[u32; 2]]) -> Vec<[u32; 3]> {
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let mut triangles = vec![];
        for i in 0..n {
            for j in 0..n {
                if !without.contains(&[i, j]) {
                    triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        triangles
    }

    fn sound(loops: Vec<Result<Vec<u32>>>) -> Vec<Vec<u32>> {
        let mut loops = loops.into_iter().map(|l| l.unwrap()).collect::<Vec<_>>();
        loops.sort();
        loops
    }

    #[test]
    fn loops_run_against_the_triangles() {
        let triangles = grid(4, &[[1, 1]]);
        let loops = sound(boundary_loops(25, &triangles).unwrap());
        assert_eq!(loops.len(), 2);
        assert_eq!(loops[0].len(), 16);
        assert_eq!(loops[1].len(), 4);
        for l in &loops {
            for k in 0..l.len() {
                let (a, b) = (l[k], l[(k + 1) % l.len()]);
                assert!(triangles.iter().any(|t| (0..3).any(|k| t[k] == b && t[(k + 1) % 3] == a)));
            }
        }
        let mut reversed = triangles.clone();
        reversed.reverse();
        assert_eq!(sound(boundary_loops(25, &reversed).unwrap()), loops);
    }

    #[test]
    fn holes_that_touch_are_split() {
        let loops = sound(boundary_loops(36, &grid(5, &[[1, 1], [2, 2]])).unwrap());
        assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [20, 4, 4]);
    }

    #[test]
    fn a_fin_is_refused_and_the_rest_found() {
        let mut triangles = grid(4, &[[1, 1]]);
        triangles.push([13, 18, 25]);
        let loops = boundary_loops(26, &triangles).unwrap();
        let (fine, bad): (Vec<_>, Vec<_>) = loops.into_iter().partition(Result::is_ok);
        assert_eq!(sound(fine).iter().map(Vec::len).collect::<Vec<_>>(), [16, 4]);
        assert!(matches!(bad[..], [Err(Error::NonManifold { .. })]), "{bad:?}");
    }

    #[test]
    fn loose_edges_are_ordered_or_refused() {
        let loops = edge_loops(&[[3, 4], [5, 3], [4, 5], [10, 11], [12, 11], [12, 10]]);
        assert_eq!(sound(loops), [vec![3, 4, 5], vec![10, 11, 12]]);
        let kind = |edges: &[[u32; 2]]| edge_loops(edges)[0].as_ref().unwrap_err().kind();
        assert_eq!(kind(&[[0, 1], [1, 2]]), "open_chain");
        assert_eq!(kind(&[[0, 1], [1, 2], [2, 0], [2, 3]]), "branching");
        assert_eq!(kind(&[[0, 1], [1, 2], [2, 0], [2, 3], [3, 4], [4, 2]]), "figure_eight");
        assert_eq!(kind(&[[7, 7]]), "repeated_vertex");
    }
}
