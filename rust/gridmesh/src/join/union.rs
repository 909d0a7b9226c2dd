//! The exact union of the parts: what of each is left, and where surfaces meet.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::DVec3;
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{BooleanEngine, MeshGL64, OpType};
use rustc_hash::FxHashMap;

use super::parts::Parts;
use super::pieces::Surface;
use crate::error::{Error, Result};
use crate::fill::parallel::in_parallel;
use crate::fill::surface::meet::Box3;
use crate::geometry::topology::{NONE, Topology};
use crate::progress::Progress;

const BROKE_DOWN: &str = "the Boolean operation on them broke down";

/// A closed mesh of what is in any of the parts.
pub(super) struct Union {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// The triangle of the parts that each lies on.
    pub source: Vec<u32>,
    /// The vertex of the parts that each vertex is, or [`NONE`].
    pub old: Vec<u32>,
    /// Its connections.
    pub topology: Topology,
}

impl Union {
    /// Unites the parts.
    ///
    /// The Boolean operation is that of the crate `manifold-rust`, which promises a closed result for closed input, but not that
    /// it never panics; should it, the panic is caught and becomes an [`Error::JoinFailed`].
    ///
    /// # Errors
    /// [`Error::JoinFailed`], [`Error::Cancelled`].
    pub fn new(parts: &Parts, progress: Progress<'_>) -> Result<Union> {
        let failed = |reason| Error::JoinFailed { reason, at: parts.vertices[0].into() };
        let first_id = Manifold::reserve_ids(parts.solids.len() as u32);
        // Side by side, in pairs, pairs of pairs and so on: the order is the same on any number of threads.
        let solids =
            groups(parts).iter().map(|group| mesh_of_group(parts, group, first_id)).collect::<Vec<_>>();
        let size = |solid: &MeshGL64| solid.tri_verts.len();
        let mut all = in_parallel(&solids, size, progress.part(0.0, 0.2), |solid, progress| {
            progress.report(0.0)?;
            catch_unwind(AssertUnwindSafe(|| Manifold::from_mesh_gl64(solid))).map_err(|_| failed(BROKE_DOWN))
        })?;
        let rounds = f64::from(solids.len().next_power_of_two().ilog2().max(1));
        for round in 0.. {
            if all.len() < 2 {
                break;
            }
            let part = |k: i32| 0.2 + 0.8 * f64::from(k) / rounds;
            let pairs = all.chunks(2).collect::<Vec<_>>();
            let size = |pair: &&[Manifold]| pair.iter().map(Manifold::num_tri).sum();
            let mut united =
                in_parallel(&pairs, size, progress.part(part(round), part(round + 1)), |pair, progress| {
                    progress.report(0.0)?;
                    let [a, b] = pair else { return Ok(pair[0].clone()) };
                    let unite = || a.boolean_with_engine(b, OpType::Add, BooleanEngine::Exact);
                    let both = catch_unwind(AssertUnwindSafe(unite)).map_err(|_| failed(BROKE_DOWN))?;
                    if both.is_empty() {
                        Err(failed("the Boolean operation on them has no result"))
                    } else {
                        Ok(both)
                    }
                })?;
            // What was left over is the first to get a partner.
            united.rotate_right(all.len() % 2);
            all = united;
        }
        let united = all.pop().ok_or(Error::Internal { reason: "no part" })?;
        let mesh =
            catch_unwind(AssertUnwindSafe(|| united.get_mesh_gl64(-1))).map_err(|_| failed(BROKE_DOWN))?;
        progress.report(1.0)?;
        Self::of(parts, &mesh, first_id)
            .ok_or_else(|| failed("the Boolean operation on them has no sound result"))
    }

    fn of(parts: &Parts, mesh: &MeshGL64, first_id: u32) -> Option<Union> {
        let stride = mesh.num_prop as usize;
        let vertices = mesh.vert_properties.chunks_exact(stride).map(|p| DVec3::new(p[0], p[1], p[2]));
        let vertices = vertices.collect::<Vec<_>>();
        let triangles = mesh.tri_verts.chunks_exact(3).map(|t| [t[0] as u32, t[1] as u32, t[2] as u32]);
        let triangles = triangles.collect::<Vec<_>>();
        let mut source = vec![NONE; triangles.len()];
        for (run, id) in mesh.run_original_id.iter().enumerate() {
            let own = &parts.solids.get(id.checked_sub(first_id)? as usize)?.triangles;
            let span = |k: usize| mesh.run_index.get(k).map_or(triangles.len(), |&i| i as usize / 3);
            for (t, source) in source.iter_mut().enumerate().take(span(run + 1)).skip(span(run)) {
                *source = *own.get(usize::try_from(*mesh.face_id.get(t)?).ok()?)?;
            }
        }
        if source.contains(&NONE) {
            return None;
        }
        let mut old = vec![NONE; vertices.len()];
        let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
        for (t, &s) in triangles.iter().zip(&source) {
            for &v in t {
                let here = key(vertices[v as usize]);
                let corner =
                    parts.triangles[s as usize].iter().find(|&&c| key(parts.vertices[c as usize]) == here);
                if let Some(&corner) = corner {
                    // Where vertices of two parts coincide, one name.
                    old[v as usize] = old[v as usize].min(corner);
                }
            }
        }
        let topology = Topology::new(vertices.len(), &triangles);
        let open = topology.across.iter().flatten().any(|&t| t == NONE);
        (!open).then_some(Union { vertices, triangles, source, old, topology })
    }

    /// The solid that a triangle lies on.
    pub fn solid(&self, parts: &Parts, triangle: usize) -> usize {
        parts.solid_of_triangle(self.source[triangle])
    }

    /// Edges between triangles of different solids: their vertices, and the two triangles.
    pub fn seams(&self, parts: &Parts) -> Vec<([u32; 2], [u32; 2])> {
        let solid = (0..self.triangles.len()).map(|t| self.solid(parts, t)).collect::<Vec<_>>();
        let mut seams = vec![];
        for (t, beyond) in self.topology.across.iter().enumerate() {
            for (k, &other) in beyond.iter().enumerate() {
                if other as usize > t && solid[other as usize] != solid[t] {
                    let [a, b] = [self.triangles[t][(k + 1) % 3], self.triangles[t][(k + 2) % 3]];
                    seams.push(([a, b], [t as u32, other]));
                }
            }
        }
        seams
    }

    /// Vertices minus edges plus triangles.
    pub fn euler(&self) -> i64 {
        let mut used = vec![false; self.vertices.len()];
        self.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        used.iter().filter(|&&u| u).count() as i64 - self.triangles.len() as i64 / 2
    }

    /// For each source triangle the triangles of the union on it.
    pub fn by_source(&self) -> FxHashMap<u32, Vec<u32>> {
        let mut found: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for (t, &s) in self.source.iter().enumerate() {
            found.entry(s).or_default().push(t as u32);
        }
        found
    }
}

/// Solids whose boxes are apart in groups that need no Boolean operation among themselves: often all limbs of a body.
fn groups(parts: &Parts) -> Vec<Vec<usize>> {
    let bounds = parts.solids.iter().map(|solid| {
        let corners = solid.triangles.iter().flat_map(|&t| parts.triangles[t as usize]);
        Box3::around(corners.map(|v| parts.vertices[v as usize]))
    });
    let bounds = bounds.collect::<Vec<_>>();
    let mut groups: Vec<Vec<usize>> = vec![];
    for solid in 0..parts.solids.len() {
        match groups.iter_mut().find(|group| group.iter().all(|&o| !bounds[solid].meets(&bounds[o]))) {
            Some(group) => group.push(solid),
            None => groups.push(vec![solid]),
        }
    }
    groups
}

/// Solids as the Boolean operation takes them.
fn mesh_of_group(parts: &Parts, group: &[usize], first_id: u32) -> MeshGL64 {
    let mut mesh = MeshGL64 { num_prop: 3, run_index: vec![0], ..MeshGL64::default() };
    for &solid in group {
        let own = &parts.solids[solid];
        let all = Surface { vertices: &parts.vertices, first: 0, triangles: &parts.triangles };
        all.add_run(&mut mesh, &own.triangles, first_id + solid as u32);
    }
    mesh
}
