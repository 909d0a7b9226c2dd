//! Divides the faces that the line meets.
//!
//! The line runs through a triangle in chains from edge to edge. With its own boundary they are the constraints of a
//! triangulation, which is flooded from the boundary to tell the sides.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::cross::Crossed;
use super::locate::Met;
use super::parted::Parted;
use crate::cut::divide::divider::Divider;
use crate::cut::divide::node::Tolerance;
use crate::cut::input::Polygons;
use crate::cut::sheet::Sheet;
use crate::error::{Error, Result};

/// Divides all faces that the line meets. With an error, the first, come all triangles that stood in the way.
pub(in crate::cut) fn split(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    sheet: &Sheet,
    met: &Met,
    crossed: Crossed<'_>,
    tolerance: Tolerance,
) -> Result<Parted, (Error, Vec<[u32; 3]>)> {
    let Crossed { triangles, edges, hits, nodes } = crossed;
    let mut divider = Divider {
        vertices,
        sheet,
        met,
        edges: &edges,
        hits: &hits,
        nodes,
        tolerance,
        parts: vec![],
        cut: FxHashMap::default(),
    };
    let mut left: Vec<bool> = (0..faces.len()).map(|f| met.left[faces.face(f)[0] as usize]).collect();
    let mut divided = vec![false; faces.len()];
    let mut cut_faces = 0;
    let mut at = 0;
    let (mut failed, mut in_the_way) = (None, vec![]);
    while at < triangles.len() {
        let face = triangles[at].1;
        let end = at + triangles[at..].iter().take_while(|t| t.1 == face).count();
        let first = divider.parts.len();
        for &(corners, face) in &triangles[at..end] {
            if let Err(error) = divider.triangle(corners, face) {
                failed.get_or_insert(error);
                in_the_way.push(corners);
            }
        }
        at = end;
        if failed.is_some() {
            continue;
        }
        let new = &divider.parts[first..];
        let whole = new.len() + 2 == faces.face(face as usize).len()
            && new.iter().all(|p| p.left == new[0].left)
            && new.iter().flat_map(|p| p.corners).all(|v| (v as usize) < vertices.len());
        if whole {
            left[face as usize] = new[0].left;
            divider.parts.truncate(first);
        } else {
            divided[face as usize] = true;
            cut_faces += 1;
        }
    }
    if let Some(error) = failed {
        return Err((error, in_the_way));
    }
    let Divider { nodes, parts, cut, .. } = divider;
    let parted = Parted {
        n_old: vertices.len(),
        nodes,
        left,
        divided,
        parts,
        cut,
        cut_faces,
        uncut: met.uncut.clone(),
    };
    // Faces that only touch the swept surface, lying in it, are no piece.
    let touches = |f: usize| {
        let corners = faces.face(f).iter().map(|&v| sheet.view.project(vertices[v as usize]));
        sheet.is_along(corners.map(Option::unwrap_or_default))
    };
    let has = |side: bool| {
        parted.parts.iter().any(|p| p.left == side)
            || (0..faces.len()).any(|f| !parted.divided[f] && parted.left[f] == side && !touches(f))
    };
    if !has(true) || !has(false) {
        return Err((Error::StrokeMisses, vec![]));
    }
    Ok(parted)
}
