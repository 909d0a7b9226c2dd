//! Laplace operators of a flat patch.

use glam::DVec2;

use super::cholesky;
pub(crate) use super::cholesky::Factor;
use super::topology::Topology;
use crate::error::{Error, Result};
use crate::progress::Progress;

fn failed(reason: impl ToString) -> Error {
    Error::Solver { stage: "inflation", reason: reason.to_string() }
}

/// Cotangent weights of the edges, parallel to `Topology::near`: the linear finite elements'
/// stiffness of the edge.
pub(crate) fn cotangent_weights(
    topology: &Topology,
    vertices: &[DVec2],
    triangles: &[[u32; 3]],
) -> Result<Vec<f64>> {
    let mut weights = vec![0.0; topology.near.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        let doubled = (b - a).perp_dot(c - a);
        // Also refuses NaN.
        if !(doubled > 0.0 && doubled.is_finite()) {
            return Err(failed(format_args!(
                "the triangle of the vertices {corners:?} of the patch is not positive"
            )));
        }
        let dots = [(b - a).dot(c - a), (c - b).dot(a - b), (a - c).dot(b - c)];
        for k in 0..3 {
            let (p, q) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let half_cotangent = 0.5 * dots[k] / doubled;
            for slot in [topology.slot(p, q), topology.slot(q, p)].into_iter().flatten() {
                weights[slot] += half_cotangent;
            }
        }
    }
    Ok(weights)
}

/// A third of the area of the triangles around each vertex.
pub(crate) fn lumped_areas(vertices: &[DVec2], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; vertices.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        for &v in corners {
            areas[v as usize] += (b - a).perp_dot(c - a) / 6.0;
        }
    }
    areas
}

/// The pattern of the equations of the free vertices, `first..n_vertices`, analysed once.
pub(crate) struct Pattern {
    first: usize,
    pattern: cholesky::Pattern,
}

impl Pattern {
    /// Fixes the vertices `0..first`. O(n log n) in practice.
    pub fn new(topology: &Topology, first: usize, progress: Progress<'_>) -> Result<Self> {
        let n_vertices = topology.start.len() - 1;
        let mut col_ptr = vec![0];
        let mut row_idx = Vec::with_capacity(topology.near.len() / 2 + n_vertices);
        for v in first..n_vertices {
            let near = topology.near[topology.range(v)].iter().map(|&u| u as usize);
            row_idx.extend(near.filter(|&u| u >= first && u < v).map(|u| u - first));
            row_idx.push(v - first);
            col_ptr.push(row_idx.len());
        }
        let pattern = cholesky::Pattern::new("inflation", col_ptr, row_idx, progress)?;
        Ok(Pattern { first, pattern })
    }

    /// Number of free vertices.
    pub fn len(&self) -> usize {
        self.pattern.len()
    }

    /// Factors the matrix `diagonal + weighted graph Laplacian` of the free vertices.
    pub fn factor(
        &self,
        topology: &Topology,
        weights: &[f64],
        diagonal: impl Fn(usize) -> f64,
        progress: Progress<'_>,
    ) -> Result<Factor> {
        let mut values = Vec::with_capacity(self.pattern.entries());
        for v in self.first..self.first + self.len() {
            let mut sum = diagonal(v);
            for slot in topology.range(v) {
                sum += weights[slot];
                let u = topology.near[slot] as usize;
                if u >= self.first && u < v {
                    values.push(-weights[slot]);
                }
            }
            values.push(sum);
        }
        self.pattern.factor(values, progress)
    }
}
