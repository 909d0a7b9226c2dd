//! Patches of few faces, bent as finer ones: their vertices lie on the surface that many would show.
//!
//! Curvatures read at a handful of vertices mean little. Where a wall goes on around a corner of 90 degrees, one vertex in
//! the middle would be twice as high as the middle of a fine patch in the same rim.

use glam::DVec3;

use super::fit::bend;
use super::patchwork::Patchwork;
use crate::error::{Error, Result};
use crate::fill::filled::Shape;
use crate::geometry::topology::NONE;
use crate::progress::Progress;

/// A coarse rim is divided once, and again until it has as many edges as this. With twice as many the patches lie the same, and take
/// four times as long.
const EDGES: usize = 16;

/// Patches of rims with fewer edges than this are coarse.
const FEW: usize = 20;

/// Below this mean angle between the film and its surroundings, in radians, few faces do.
const STEEP: f64 = 0.3;

impl Shape {
    /// Whether a patch has to be bent as a finer one; `rim_angle`: see [`Solved`](super::fit::Solved).
    pub(super) fn is_coarse(&self, rim_angle: f64) -> bool {
        self.work.n < FEW && rim_angle > STEEP
    }

    /// Bends the film with each face divided by the middles of its edges, again and again, and takes from the result what the
    /// patch has.
    pub(super) fn bend_finer(&self, positions: &mut [DVec3], progress: Progress<'_>) -> Result<()> {
        let mut all = positions.to_vec();
        let mut finer = Finer::of(&self.work, &mut all)?;
        let mut own = finer.own;
        while finer.work.n < EDGES {
            progress.report(0.0)?;
            finer = Finer::of(&finer.work, &mut all)?;
            own.iter_mut().for_each(|v| *v = finer.own[*v as usize]);
        }
        bend(&finer.work, self.smooth, &mut all, None, &mut vec![], progress)?;
        for v in self.work.inner() {
            positions[v] = all[own[v] as usize];
        }
        Ok(())
    }
}

/// A patch and its surroundings with four triangles for each.
struct Finer {
    work: Patchwork,
    /// The place of each vertex of before.
    own: Vec<u32>,
}

impl Finer {
    /// `positions` get the new vertices.
    fn of(work: &Patchwork, positions: &mut Vec<DVec3>) -> Result<Finer> {
        let (n, end, n_patch) = (work.n, work.end, work.n_patch);
        let mut own = vec![0; work.len()];
        // For each edge, at either end, and for the patch and its surroundings: whether it is one of them, and the vertex in its middle.
        // Both may have an edge between the same vertices of the loop, as where that of two triangles of a quad is.
        let mut has = [vec![false; work.near.len()], vec![false; work.near.len()]];
        for t in 0..work.triangles.len() {
            let has = &mut has[usize::from(t >= n_patch)];
            work.slots(t).into_iter().flatten().for_each(|slot| has[slot as usize] = true);
        }
        let mut middle = [vec![NONE; work.near.len()], vec![NONE; work.near.len()]];
        let mut all = Vec::with_capacity(4 * positions.len());
        for v in 0..n {
            let after = work.after(v);
            let slots = [[v, after], [after, v]].map(|[a, b]| work.slot(a, b));
            let [Some(first), Some(second)] = slots else {
                return Err(Error::Internal { reason: "an edge has no slot" });
            };
            own[v] = all.len() as u32;
            all.push(positions[v]);
            for middle in &mut middle {
                (middle[first], middle[second]) = (all.len() as u32, all.len() as u32);
            }
            all.push(positions[v].midpoint(positions[after]));
        }
        let mut ends = [0; 2];
        for (part, vertices) in [n..end, end..work.len()].into_iter().enumerate() {
            for v in vertices {
                own[v] = all.len() as u32;
                all.push(positions[v]);
            }
            // In an order that does not depend on how the triangles are named.
            for v in 0..work.len() {
                for slot in work.range(v) {
                    let u = work.near[slot] as usize;
                    if middle[part][slot] == NONE && u > v && has[part][slot] {
                        middle[part][slot] = all.len() as u32;
                        if let Some(other) = work.slot(u, v) {
                            middle[part][other] = all.len() as u32;
                        }
                        all.push(positions[v].midpoint(positions[u]));
                    }
                }
            }
            ends[part] = all.len();
        }
        let mut triangles = Vec::with_capacity(4 * work.triangles.len());
        for (t, corners) in work.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| own[v as usize]);
            let middle = &middle[usize::from(t >= n_patch)];
            let [bc, ca, ab] = work.slots(t).map(|[slot, _]| middle[slot as usize]);
            triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        // The mesh has no names for vertices in the middle of its edges.
        let outer = vec![NONE; ends[1] - ends[0]];
        let mut finer = Patchwork::of(2 * n, ends[0], outer, triangles, 4 * n_patch)?;
        finer.later = work.later.iter().map(|first| 2 * first).collect();
        *positions = all;
        Ok(Finer { work: finer, own })
    }
}
