//! The mesh to be cut, as it is handed over.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::error::{Error, Result};

/// Faces with any number of corners: those of face `f` are `corners[offsets[f]..offsets[f + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct Polygons<'a> {
    /// Vertex numbers.
    pub corners: &'a [u32],
    /// Where each face begins, and the end.
    pub offsets: &'a [u32],
}

impl<'a> Polygons<'a> {
    /// Number of faces.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The corners of a face.
    pub fn face(&self, f: usize) -> &'a [u32] {
        &self.corners[self.offsets[f] as usize..self.offsets[f + 1] as usize]
    }
}

/// Refuses what is no mesh or no stroke.
pub(super) fn check(vertices: &[DVec3], faces: Polygons<'_>, stroke: &[DVec3]) -> Result<()> {
    for (what, points) in [("stroke", stroke), ("mesh", vertices)] {
        if let Some(point) = points.par_iter().position_first(|p| !p.is_finite()) {
            return Err(Error::NotFinite { what: what.into(), point });
        }
    }
    let least = vertices.iter().fold(DVec3::INFINITY, |a, &b| a.min(b));
    let most = vertices.iter().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b));
    let size = (most - least).max_element();
    if size > 1e60 || (size > 0.0 && size < 1e-60) {
        return Err(Error::ExtremeSize { what: "mesh".into(), size });
    }
    let bad = |face: usize, reason: &str| Err(Error::InvalidFace { face, reason: reason.into() });
    if faces.offsets.first().is_some_and(|&o| o != 0)
        || faces.offsets.last().map_or(0, |&o| o as usize) != faces.corners.len()
    {
        return bad(0, "offsets must begin with 0 and end with the number of corners");
    }
    if let Some(face) = faces.offsets.windows(2).position(|w| w[1] < w[0] || w[1] - w[0] < 3) {
        return bad(face, "it has fewer than 3 corners");
    }
    let n = vertices.len();
    if let Some(corner) = faces.corners.par_iter().position_first(|&v| v as usize >= n) {
        let face = faces.offsets.partition_point(|&o| o as usize <= corner) - 1;
        let index = faces.corners[corner] as i32;
        return Err(Error::IndexOutOfRange { what: format!("face {face}"), index, vertices: n });
    }
    let repeats = |f: &usize| {
        let corners = faces.face(*f);
        corners.iter().enumerate().any(|(k, v)| corners[..k].contains(v))
    };
    if let Some(face) = (0..faces.len()).into_par_iter().find_first(repeats) {
        return bad(face, "it names a vertex twice");
    }
    Ok(())
}

/// Calls `emit` with the triangles of a face: ears cut off in the plane of its mean normal, the roundest first.
/// Depends on the face alone, so that it is divided alike wherever it is looked at.
pub(super) fn triangles(vertices: &[DVec3], corners: &[u32], mut emit: impl FnMut([u32; 3])) {
    let n = corners.len();
    if n == 3 {
        return emit([corners[0], corners[1], corners[2]]);
    }
    let origin = vertices[corners[0] as usize];
    let at = |k: usize| vertices[corners[k % n] as usize] - origin;
    let normal: DVec3 = (1..n - 1).map(|k| at(k).cross(at(k + 1))).sum();
    let (e, f) = normal.normalize_or(DVec3::Z).any_orthonormal_pair();
    let flat = (0..n).map(|k| DVec2::new(at(k).dot(e), at(k).dot(f))).collect::<Vec<_>>();
    let mut left = (0..n).collect::<Vec<_>>();
    let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
    while left.len() > 3 {
        let m = left.len();
        let mut best = (f64::NEG_INFINITY, 0);
        for k in 0..m {
            let [i, j, l] = [left[(k + m - 1) % m], left[k], left[(k + 1) % m]];
            let (a, b, c) = (flat[i], flat[j], flat[l]);
            let double = area(a, b, c);
            let edges = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
            let mut shape = double / edges.max(f64::MIN_POSITIVE);
            let inside = |&o: &usize| {
                o != i
                    && o != j
                    && o != l
                    && area(a, b, flat[o]) >= 0.0
                    && area(b, c, flat[o]) >= 0.0
                    && area(c, a, flat[o]) >= 0.0
            };
            if double > 0.0 && left.iter().any(inside) {
                shape = -1.0;
            }
            if shape > best.0 {
                best = (shape, k);
            }
        }
        let k = best.1;
        emit([left[(k + m - 1) % m], left[k], left[(k + 1) % m]].map(|i| corners[i]));
        left.remove(k);
    }
    emit([left[0], left[1], left[2]].map(|i| corners[i]));
}

/// Six times the signed volume under the face, seen from `origin`.
pub(super) fn volume(vertices: &[DVec3], origin: DVec3, corners: &[u32]) -> f64 {
    let mut sum = 0.0;
    triangles(vertices, corners, |t| {
        let [a, b, c] = t.map(|v| vertices[v as usize] - origin);
        sum += a.dot(b.cross(c));
    });
    sum
}
