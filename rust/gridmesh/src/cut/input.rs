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

    /// The corners of each face.
    pub fn iter(self) -> impl Iterator<Item = &'a [u32]> {
        let Polygons { corners, offsets } = self;
        offsets.windows(2).map(move |w| &corners[w[0] as usize..w[1] as usize])
    }

    /// The corners of a face.
    pub fn face(&self, f: usize) -> &'a [u32] {
        &self.corners[self.offsets[f] as usize..self.offsets[f + 1] as usize]
    }
}

/// Refuses what is no mesh or no stroke.
pub(super) fn check(vertices: &[DVec3], faces: Polygons<'_>, stroke: &[DVec3]) -> Result<()> {
    check_finite("stroke", stroke)?;
    check_mesh("mesh", vertices, faces)
}

fn check_finite(what: &str, points: &[DVec3]) -> Result<()> {
    match points.par_iter().position_first(|p| !p.is_finite()) {
        Some(point) => Err(Error::NotFinite { what: what.into(), point }),
        None => Ok(()),
    }
}

/// Refuses what is no mesh; `what` it is called.
pub(crate) fn check_mesh(what: &str, vertices: &[DVec3], faces: Polygons<'_>) -> Result<()> {
    check_finite(what, vertices)?;
    let least = vertices.iter().fold(DVec3::INFINITY, |a, &b| a.min(b));
    let most = vertices.iter().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b));
    let size = (most - least).max_element();
    if size > 1e60 || (size > 0.0 && size < 1e-60) {
        return Err(Error::ExtremeSize { what: what.into(), size });
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

/// Corners this near to a triangle may be on its border, but for rounding: twice an area, as a part of the square over the face.
const ROUNDING: f64 = 1e-12;

/// Ears with such corners come after all others.
const LAST: f64 = 1e-6;

/// Calls `emit` with the triangles of a face: ears cut off in the plane of its mean normal, the roundest first.
/// Depends on the face alone, so that it is divided alike wherever it is looked at.
pub(crate) fn triangles(vertices: &[DVec3], corners: &[u32], mut emit: impl FnMut([u32; 3])) {
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
    let size = flat.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let rounding = ROUNDING * size * size;
    while left.len() > 3 {
        let m = left.len();
        let mut best = (f64::NEG_INFINITY, 0);
        for k in 0..m {
            let [i, j, l] = [left[(k + m - 1) % m], left[k], left[(k + 1) % m]];
            let (a, b, c) = (flat[i], flat[j], flat[l]);
            let double = area(a, b, c);
            let edges = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
            let mut shape = double / edges.max(f64::MIN_POSITIVE);
            // How far inside the triangle another corner is, or outside if it is negative.
            let inside = |&o: &usize| {
                let p = flat[o];
                area(a, b, p).min(area(b, c, p)).min(area(c, a, p))
            };
            let others = left.iter().filter(|&&o| o != i && o != j && o != l);
            let deepest = others.map(inside).fold(f64::NEG_INFINITY, f64::max);
            if double > 0.0 && deepest >= 0.0 {
                shape = -1.0;
            } else if double > 0.0 && deepest >= -rounding {
                // A corner on the side that is cut would be left with a triangle of no area.
                shape *= LAST;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_with_corners_in_one_line_are_divided_into_triangles_with_areas() {
        // A comb.
        for n in 2..12u32 {
            let mut outline = vec![DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, -1.0, 0.0)];
            for k in (0..n).rev() {
                let at = |t: f64| -1.0 + 2.0 * (f64::from(k) + t) / f64::from(n);
                let high = if k == n - 1 { 1.0 } else { at(0.6) };
                outline.extend([DVec3::new(high, 0.4, 0.0), DVec3::new(at(0.0), 0.4, 0.0)]);
                if k > 0 {
                    outline.extend([DVec3::new(at(0.0), -0.5, 0.0), DVec3::new(at(-0.4), -0.5, 0.0)]);
                }
            }
            for turn in 0..40 {
                let turn = glam::DMat3::from_rotation_z(0.37 * f64::from(turn))
                    * glam::DMat3::from_rotation_x(0.71 * f64::from(turn));
                let vertices = outline.iter().map(|&p| turn * p).collect::<Vec<_>>();
                let corners = (0..vertices.len() as u32).collect::<Vec<_>>();
                let (mut sum, mut least) = (0.0, f64::INFINITY);
                triangles(&vertices, &corners, |t| {
                    let [a, b, c] = t.map(|v| outline[v as usize]);
                    let area = 0.5 * (b - a).cross(c - a).z;
                    sum += area;
                    least = least.min(area);
                });
                let next = outline.iter().cycle().skip(1);
                let whole: f64 = outline.iter().zip(next).map(|(p, q)| 0.5 * p.cross(*q).z).sum();
                assert!((sum - whole).abs() < 1e-12 && least > 1e-4, "{n} {least} {sum} {whole}");
            }
        }
    }
}
