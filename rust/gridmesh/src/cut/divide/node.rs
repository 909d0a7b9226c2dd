//! Vertices of the divided mesh: each a combination of old ones.

use glam::DVec3;

/// A new vertex, as a combination of old ones.
#[derive(Clone, Copy, Debug)]
pub(in crate::cut) struct Node {
    pub position: DVec3,
    pub source: [u32; 3],
    pub weights: [f64; 3],
}

impl Node {
    pub fn between(vertices: &[DVec3], a: u32, b: u32, t: f64) -> Self {
        let (p, q) = (vertices[a as usize], vertices[b as usize]);
        Node { position: p + t * (q - p), source: [a, b, a], weights: [1.0 - t, t, 0.0] }
    }

    pub fn within(vertices: &[DVec3], source: [u32; 3], weights: [f64; 3]) -> Self {
        let position = (0..3).map(|k| weights[k] * vertices[source[k] as usize]).sum();
        Node { position, source, weights }
    }
}

/// With an edge length, the cut may be drawn through vertices that are nearer than this part of it, where triangles
/// beside it would be thin otherwise.
pub(in crate::cut) const THROUGH: f64 = 0.3;

/// What counts as one point, in edges.
#[derive(Clone, Copy, Debug)]
pub(in crate::cut) struct Tolerance {
    /// Between the cut and a vertex.
    pub vertex: f64,
    /// Between crossings, and between the stroke's points and crossings.
    pub node: f64,
    /// Between the cut and a vertex, in units of the mesh.
    pub length: f64,
}
