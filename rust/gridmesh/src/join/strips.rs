//! The pieces of the union between the rims, each to be replaced by a patch.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::parts::Parts;
use super::rims::Outside;
use super::union::Union;
use crate::error::{Error, Result};
use crate::geometry::topology::NONE;

/// A connected piece of the union's surface between rims.
#[derive(Clone, Debug)]
pub(super) struct Strip {
    /// Its rims, by their numbers.
    pub rims: Vec<usize>,
    /// Its triangles in the union.
    pub triangles: Vec<u32>,
    /// Vertices minus edges plus triangles.
    pub euler: i64,
    /// Whether its edges at the rims are those of the rims.
    pub sound: bool,
    /// A place in it.
    pub at: DVec3,
    /// The curves within it, ascending.
    pub curves: Vec<usize>,
}

impl Strip {
    /// The parts' vertices of its rims, one rim after the other.
    pub fn border(&self, outside: &Outside) -> Vec<u32> {
        self.rims.iter().flat_map(|&k| outside.rims[k].iter().copied()).collect()
    }
}

/// Finds the strips.
///
/// # Errors
/// [`Error::JoinFailed`] if a rim has no strip.
pub(super) fn strips(parts: &Parts, union: &Union, outside: &Outside) -> Result<Vec<Strip>> {
    let goes = |t: usize| !outside.faces[parts.face_of[union.source[t] as usize] as usize];
    let mut rim_of: FxHashMap<u32, usize> = FxHashMap::default();
    let mut edges: FxHashSet<[u32; 2]> = FxHashSet::default();
    for (k, rim) in outside.rims.iter().enumerate() {
        for (i, &v) in rim.iter().enumerate() {
            rim_of.insert(v, k);
            edges.insert([v, rim[(i + 1) % rim.len()]]);
        }
    }
    let mut seen = vec![false; union.triangles.len()];
    let mut found = vec![];
    let mut met = vec![false; outside.rims.len()];
    for start in 0..union.triangles.len() {
        if seen[start] || !goes(start) {
            continue;
        }
        seen[start] = true;
        let (mut own, mut next) = (vec![start as u32], 0);
        let mut vertices = FxHashSet::default();
        let mut rims: Vec<usize> = vec![];
        let (mut border, mut sound) = (0, true);
        while let Some(&t) = own.get(next) {
            next += 1;
            let corners = union.triangles[t as usize];
            vertices.extend(corners);
            for k in 0..3 {
                let beyond = union.topology.across[t as usize][k] as usize;
                if goes(beyond) {
                    if !std::mem::replace(&mut seen[beyond], true) {
                        own.push(beyond as u32);
                    }
                    continue;
                }
                border += 1;
                // Against the direction of the face beyond, as the rim runs.
                let [b, a] = [corners[(k + 1) % 3], corners[(k + 2) % 3]].map(|v| union.old[v as usize]);
                sound &= a != NONE && b != NONE && edges.contains(&[a, b]);
                rims.extend(rim_of.get(&a));
            }
        }
        rims.sort_unstable();
        rims.dedup();
        sound &= border == rims.iter().map(|&k| outside.rims[k].len()).sum::<usize>();
        rims.iter().for_each(|&k| met[k] = true);
        let sides = (3 * own.len() + border) / 2;
        let euler = vertices.len() as i64 - sides as i64 + own.len() as i64;
        let at = union.vertices[union.triangles[own[own.len() / 2] as usize][0] as usize];
        found.push(Strip { rims, triangles: own, euler, sound, at, curves: vec![] });
    }
    if let Some(k) = met.iter().position(|&m| !m) {
        let at = parts.vertices[outside.rims[k][0] as usize].into();
        return Err(Error::JoinFailed { reason: "a rim borders nothing that was taken away", at });
    }
    Ok(found)
}
