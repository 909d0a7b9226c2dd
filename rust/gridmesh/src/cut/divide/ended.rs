//! Parts of the mesh that end along the line already, as at the cap of the same cut made before: they are not cut again.

use glam::DVec3;

use super::cross::Edges;
use super::locate::{Locator, Met};
use super::node::THROUGH;
use crate::cut::cutting::Cutting;
use crate::error::{Error, Result};
use crate::geometry::disjoint::Disjoint;

/// The vertices of a slice are nearer to the swept surface than `THIN`, in edge lengths as asked for, but for one in `FEW`, which may be
/// as far away as old vertices that a cut goes through.
const THIN: f64 = 0.05;
const FEW: usize = 10;

/// The same without a length asked for, in lengths of the edges that are crossed.
const THIN_UNASKED: f64 = 1e-3;

/// Edges that are crossed count as no longer than this share of the mesh's size.
const LONGEST: f64 = 0.05;

/// What is cut and what is not.
pub(in crate::cut) struct Ended {
    /// For each crossing, counted along all edges: whether it is cut.
    pub cut: Vec<bool>,
    /// For each vertex: whether it is as near to the line as those of slices may be.
    pub near: Vec<bool>,
}

/// Where the vertices of a part are; by side, on the right of the line first.
#[derive(Clone, Default)]
struct Sides {
    /// Vertices nearer than `THIN`, on both sides.
    thin: usize,
    /// Those up to `THROUGH` away.
    stray: [usize; 2],
    /// Whether there are any farther away.
    beyond: [bool; 2],
}

impl Sides {
    fn is_one_but_for_slices(&self) -> bool {
        match self.beyond {
            [true, false] => FEW * self.stray[1] <= self.thin,
            [false, true] => FEW * self.stray[0] <= self.thin,
            _ => false,
        }
    }
}

/// Finds the parts, connected by faces, that lie on one side of an open line but for slices; `None` if there is none.
///
/// A slice has no vertex that is not near the line, and no edge is crossed whose ends are both farther away: that would be a
/// notch. A part all of whose vertices are near is thin itself, and cut. O(faces + crossings).
///
/// # Errors
/// [`Error::SliceTooThin`] if nothing but slices would come off.
pub(in crate::cut) fn find(
    cutting: Cutting<'_>,
    locator: &Locator<'_>,
    met: &Met,
    edges: &Edges,
) -> Result<Option<Ended>> {
    let Cutting { vertices, faces, options } = cutting;
    let (thin, stray) = match options.edge_length {
        Some(length) => (THIN * length, THROUGH * length),
        None => [THIN_UNASKED * typical(vertices, edges); 2].into(),
    };
    let off = locator.all_off(vertices, stray);
    let near = off.iter().map(|&off| off <= stray).collect::<Vec<_>>();
    let mut parts = Disjoint::new(vertices.len());
    for corners in faces.iter() {
        corners.iter().for_each(|&v| parts.join(corners[0], v));
    }
    let mut sides = vec![Sides::default(); vertices.len()];
    for (v, &off) in off.iter().enumerate() {
        let part = &mut sides[parts.root(v as u32) as usize];
        let side = usize::from(met.left[v]);
        part.thin += usize::from(off <= thin);
        part.stray[side] += usize::from(off > thin && off <= stray);
        part.beyond[side] |= off > stray;
    }
    let mut whole = sides.iter().map(Sides::is_one_but_for_slices).collect::<Vec<_>>();
    for &(a, b) in &edges.keys {
        if !near[a as usize] && !near[b as usize] {
            whole[parts.root(a) as usize] = false;
        }
    }
    let mut cut = vec![];
    for (&(a, _), hits) in edges.keys.iter().zip(&edges.hits) {
        cut.extend(std::iter::repeat_n(!whole[parts.root(a) as usize], hits.len()));
    }
    match (cut.contains(&false), cut.contains(&true)) {
        (false, _) => Ok(None),
        (true, true) => Ok(Some(Ended { cut, near })),
        (true, false) => Err(Error::SliceTooThin { least: thin }),
    }
}

/// The mean length of the edges that are crossed.
fn typical(vertices: &[DVec3], edges: &Edges) -> f64 {
    let length = |&(a, b): &(u32, u32)| vertices[a as usize].distance(vertices[b as usize]);
    let mean = edges.keys.iter().map(length).sum::<f64>() / edges.keys.len().max(1) as f64;
    let low = vertices.iter().fold(DVec3::INFINITY, |a, &b| a.min(b));
    let high = vertices.iter().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b));
    mean.min(LONGEST * low.distance(high))
}
