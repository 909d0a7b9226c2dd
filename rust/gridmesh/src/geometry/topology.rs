//! Who is next to whom in a flat patch.

/// Marks an edge with no triangle beyond it.
pub(crate) const NONE: u32 = u32::MAX;

/// Neighbours of the vertices and of the triangles of a patch.
pub(crate) struct Topology {
    /// The neighbours of vertex `i` are `near[start[i]..start[i + 1]]`, in ascending order.
    pub start: Vec<u32>,
    /// See `start`.
    pub near: Vec<u32>,
    /// `across[t][k]`: the triangle beyond the edge of triangle `t` that faces its corner `k`, or
    /// [`NONE`].
    pub across: Vec<[u32; 3]>,
    /// The triangles at vertex `i` are `fans[fan_start[i]..fan_start[i + 1]]`, each as the two
    /// vertices that follow `i` in it.
    pub fans: Vec<[u32; 2]>,
    /// See `fans`.
    pub fan_start: Vec<u32>,
}

impl Topology {
    /// Of consistently oriented triangles over `n_vertices` vertices. Linear.
    pub fn new(n_vertices: usize, triangles: &[[u32; 3]]) -> Self {
        // Directed edges in buckets by their first vertex.
        let mut first = vec![0u32; n_vertices + 1];
        for corner in triangles.iter().flatten() {
            first[*corner as usize + 1] += 1;
        }
        for i in 0..n_vertices {
            first[i + 1] += first[i];
        }
        let mut fill = first.clone();
        let mut edges = vec![(0u32, 0u32); 3 * triangles.len()];
        for (t, corners) in triangles.iter().enumerate() {
            for k in 0..3 {
                let slot = &mut fill[corners[k] as usize];
                edges[*slot as usize] = (corners[(k + 1) % 3], t as u32);
                *slot += 1;
            }
        }
        let leaving = |v: u32| &edges[first[v as usize] as usize..first[v as usize + 1] as usize];
        let across = triangles
            .iter()
            .map(|corners| {
                [0, 1, 2].map(|k| {
                    let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                    leaving(b).iter().find(|edge| edge.0 == a).map_or(NONE, |edge| edge.1)
                })
            })
            .collect::<Vec<_>>();

        // A neighbour across a boundary edge may be reached by the incoming edge only.
        let mut count = vec![0u32; n_vertices + 1];
        let mut extra = vec![NONE; n_vertices];
        for (corners, beyond) in triangles.iter().zip(&across) {
            for k in 0..3 {
                if beyond[k] == NONE {
                    extra[corners[(k + 2) % 3] as usize] = corners[(k + 1) % 3];
                }
            }
        }
        for v in 0..n_vertices {
            count[v + 1] = count[v] + (first[v + 1] - first[v]) + u32::from(extra[v] != NONE);
        }
        let mut near = Vec::with_capacity(count[n_vertices] as usize);
        for v in 0..n_vertices {
            near.extend(leaving(v as u32).iter().map(|edge| edge.0));
            if extra[v] != NONE {
                near.push(extra[v]);
            }
            near[count[v] as usize..].sort_unstable();
        }
        let mut fans = vec![[0; 2]; edges.len()];
        let mut fill = first.clone();
        for corners in triangles {
            for k in 0..3 {
                let slot = &mut fill[corners[k] as usize];
                fans[*slot as usize] = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
                *slot += 1;
            }
        }
        Topology { start: count, near, across, fans, fan_start: first }
    }

    /// Where the neighbours of `vertex` lie in `near`.
    pub fn range(&self, vertex: usize) -> std::ops::Range<usize> {
        self.start[vertex] as usize..self.start[vertex + 1] as usize
    }

    /// The triangles at `vertex`, see `fans`.
    pub fn fan(&self, vertex: usize) -> &[[u32; 2]] {
        &self.fans[self.fan_start[vertex] as usize..self.fan_start[vertex + 1] as usize]
    }

    /// Where the neighbour `other` of `vertex` lies in `near`.
    pub fn slot(&self, vertex: u32, other: u32) -> Option<usize> {
        self.range(vertex as usize).find(|&slot| self.near[slot] == other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fan_of_six_knows_its_neighbours() {
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [6, i, (i + 1) % 6]).collect();
        let topology = Topology::new(7, &triangles);
        assert_eq!(&topology.near[topology.range(6)], &[0, 1, 2, 3, 4, 5]);
        assert_eq!(&topology.near[topology.range(0)], &[1, 5, 6]);
        for t in 0..6u32 {
            assert_eq!(topology.across[t as usize], [NONE, (t + 1) % 6, (t + 5) % 6]);
        }
    }
}
