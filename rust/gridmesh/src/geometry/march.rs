//! Distances within a flat mesh: along ways that do not leave it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

/// Triangles around each vertex.
pub(crate) struct Around {
    start: Vec<usize>,
    triangles: Vec<u32>,
}

impl Around {
    /// Of `n` vertices. Linear.
    pub fn new(n: usize, triangles: &[[u32; 3]]) -> Self {
        let mut start = vec![0; n + 1];
        triangles.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
        for v in 0..n {
            start[v + 1] += start[v];
        }
        let (mut next, mut around) = (start.clone(), vec![0; start[n]]);
        for (t, corners) in triangles.iter().enumerate() {
            for &v in corners {
                around[next[v as usize]] = t as u32;
                next[v as usize] += 1;
            }
        }
        Around { start, triangles: around }
    }

    fn of(&self, v: usize) -> &[u32] {
        &self.triangles[self.start[v]..self.start[v + 1]]
    }
}

/// The shortest way from any of the seeds to each vertex, without leaving the mesh; infinite where there is none.
///
/// `seeds` are vertices and their own distances. A straight way over the triangles from a point is exact, one from a line
/// nearly so; at concave corners ways bend around vertices. O(n log n).
///
/// Source: Kimmel and Sethian, *Computing geodesic paths on manifolds*, 1998, with the update by unfolding of Mitchell, Mount and Papadimitriou, 1987.
pub(crate) fn march(
    vertices: &[DVec2],
    triangles: &[[u32; 3]],
    around: &Around,
    seeds: impl IntoIterator<Item = (u32, f64)>,
) -> Vec<f64> {
    let mut distance = vec![f64::INFINITY; vertices.len()];
    // Distances are not negative, so that their bits are ordered as they are.
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
    for (v, value) in seeds {
        if value < distance[v as usize] {
            distance[v as usize] = value;
            queue.push(Reverse((value.to_bits(), v)));
        }
    }
    let mut is_done = vec![false; vertices.len()];
    while let Some(Reverse((_, v))) = queue.pop() {
        if std::mem::replace(&mut is_done[v as usize], true) {
            continue;
        }
        for &t in around.of(v as usize) {
            let corners = triangles[t as usize];
            for k in 0..3 {
                let [c, a, b] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]].map(|v| v as usize);
                if is_done[c] {
                    continue;
                }
                let [p, q, r] = [vertices[a], vertices[b], vertices[c]];
                let found = through(p, distance[a], q, distance[b], r);
                if found < distance[c] {
                    distance[c] = found;
                    queue.push(Reverse((found.to_bits(), c as u32)));
                }
            }
        }
    }
    distance
}

/// Distance of `r` from the point that is `a` from `p` and `b` from `q`, on the other side of the line between them, if the
/// straight way crosses it; otherwise along an edge.
fn through(p: DVec2, a: f64, q: DVec2, b: f64, r: DVec2) -> f64 {
    let along_edge = (a + p.distance(r)).min(b + q.distance(r));
    let length = p.distance(q);
    if !(a.is_finite() && b.is_finite() && length > 0.0) {
        return along_edge;
    }
    // In the frame of the edge: the source below it, `r` above.
    let x = (a * a - b * b + length * length) / (2.0 * length);
    let below = a * a - x * x;
    if below < 0.0 {
        return along_edge;
    }
    let along = (q - p) / length;
    let at = DVec2::new((r - p).dot(along), (r - p).perp_dot(along).abs());
    let source = DVec2::new(x, -below.sqrt());
    let crossing = source.x + (at.x - source.x) * -source.y / (at.y - source.y);
    if (0.0..=length).contains(&crossing) { source.distance(at).min(along_edge) } else { along_edge }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice of right triangles over the cells that are kept.
    fn cells(n: u32, kept: impl Fn(u32, u32) -> bool) -> (Vec<DVec2>, Vec<[u32; 3]>) {
        let vertices = (0..n * n).map(|i| DVec2::new(f64::from(i % n), f64::from(i / n))).collect();
        let mut triangles = Vec::new();
        for y in 0..n - 1 {
            for x in (0..n - 1).filter(|&x| kept(x, y)) {
                let [a, b, c, d] = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| y * n + x);
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        (vertices, triangles)
    }

    #[test]
    fn straight_ways_are_exact() {
        let (vertices, triangles) = cells(12, |_, _| true);
        let around = Around::new(vertices.len(), &triangles);
        let found = march(&vertices, &triangles, &around, [(0, 0.0)]);
        for (p, d) in vertices.iter().zip(found) {
            assert!((d - p.length()).abs() < 0.05 * p.length() + 1e-12, "{p} {d}");
        }
    }

    #[test]
    fn ways_go_around_a_wall() {
        let (vertices, triangles) = cells(12, |x, y| x != 5 || y > 9);
        let around = Around::new(vertices.len(), &triangles);
        let found = march(&vertices, &triangles, &around, [(4, 0.0)]);
        assert!(found[7] > 20.0 && found[7] < 22.0, "{}", found[7]);
        let alone = march(&vertices, &triangles, &around, []);
        assert!(alone.iter().all(|d| d.is_infinite()));
    }
}
