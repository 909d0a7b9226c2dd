//! Heat that flows over a flat mesh until it is in equilibrium with what is held at each vertex.

use glam::DVec2;

use crate::error::Result;
use crate::geometry::cholesky::Pattern;
use crate::progress::Progress;

/// The equations `(L + T M) w = T M wanted`, `L` with cotangents that are not negative, so that weights stay between 0 and 1
/// and sum to 1.
pub(super) struct Heat {
    /// What each vertex is held by.
    held: Vec<f64>,
    /// Pairs of vertices that heat flows between, the larger first; sorted.
    edges: Vec<(u32, u32)>,
    /// By edge, where its parts begin.
    starts: Vec<usize>,
    /// Triangles at the edges, and half their cotangents.
    parts: Vec<(u32, f64)>,
    pattern: Pattern,
}

impl Heat {
    /// `transfer` says by vertex how fast heat comes from what is held.
    pub fn new(vertices: &[DVec2], triangles: &[[u32; 3]], transfer: &[f64]) -> Result<Self> {
        let n = vertices.len();
        let mut mass = vec![0.0; n];
        let mut all: Vec<(u32, u32, u32, f64)> = Vec::with_capacity(3 * triangles.len());
        for (t, corners) in triangles.iter().enumerate() {
            let points = corners.map(|v| vertices[v as usize]);
            let doubled = (points[1] - points[0]).perp_dot(points[2] - points[0]).abs();
            corners.iter().for_each(|&v| mass[v as usize] += doubled / 6.0);
            for k in 0..3 {
                let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                let (u, v) = (points[(k + 1) % 3] - points[k], points[(k + 2) % 3] - points[k]);
                let least = 1e-9 * (u.length_squared() + v.length_squared());
                if doubled.max(least) > 0.0 {
                    all.push((a.max(b), a.min(b), t as u32, 0.5 * u.dot(v) / doubled.max(least)));
                }
            }
        }
        // Stable, so that the parts of an edge are added in the order of its triangles.
        all.sort_by_key(|&(i, j, ..)| (i, j));
        let (mut edges, mut starts, mut parts) = (Vec::new(), vec![0], Vec::with_capacity(all.len()));
        for same in all.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let weight = same.iter().map(|part| part.3).sum::<f64>();
            if same[0].0 != same[0].1 && weight > 0.0 {
                edges.push((same[0].0, same[0].1));
                parts.extend(same.iter().map(|&(_, _, t, half)| (t, half)));
                starts.push(parts.len());
            }
        }
        // Vertices that belong to no area keep what is wanted.
        let held = (0..n).map(|v| if mass[v] > 0.0 { mass[v] * transfer[v] } else { 1.0 }).collect();
        let (mut col_ptr, mut row_idx) = (vec![0], Vec::with_capacity(edges.len() + n));
        let mut rest = edges.as_slice();
        for v in 0..n {
            let (column, after) = rest.split_at(rest.partition_point(|edge| edge.0 as usize <= v));
            rest = after;
            row_idx.extend(column.iter().map(|edge| edge.1 as usize));
            row_idx.push(v);
            col_ptr.push(row_idx.len());
        }
        let pattern = Pattern::new("bone weights", col_ptr, row_idx, Progress::NONE)?;
        Ok(Self { held, edges, starts, parts, pattern })
    }

    /// The equilibrium with what is wanted, a column for each bone, where heat flows through each triangle as many times as easily as
    /// `eased` says.
    pub fn settled(&self, eased: &[f64], wanted: &[f64], bones: usize) -> Result<Vec<f64>> {
        let n = self.held.len();
        let flow = |parts: &[(u32, f64)]| parts.iter().map(|&(t, half)| eased[t as usize] * half).sum();
        let flows: Vec<f64> = self
            .starts
            .windows(2)
            .map(|range| f64::max(flow(&self.parts[range[0]..range[1]]), 0.0))
            .collect();
        let mut diagonal = self.held.clone();
        for (&(i, j), flow) in self.edges.iter().zip(&flows) {
            diagonal[i as usize] += flow;
            diagonal[j as usize] += flow;
        }
        let mut entries = Vec::with_capacity(flows.len() + n);
        let mut at = 0;
        for (v, &sum) in diagonal.iter().enumerate() {
            while at < flows.len() && self.edges[at].0 as usize == v {
                entries.push(-flows[at]);
                at += 1;
            }
            entries.push(sum);
        }
        let held = self.held.iter().cycle();
        let mut weights: Vec<f64> = wanted.iter().zip(held).map(|(wanted, held)| wanted * held).collect();
        self.pattern.factor(entries, Progress::NONE)?.solve(&mut weights, bones)?;
        Ok(weights)
    }
}
