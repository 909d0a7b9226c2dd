//! A patch together with the triangles of the mesh around it.

use glam::DVec3;

use crate::error::{Error, Result};
use crate::fill::loops::mesh::{Rim, place};
use crate::geometry::stars::CornerStars;

/// Patch and surroundings as one mesh: first the loop's vertices in the direction of the patch, then
/// the new ones, then those of the mesh around.
#[derive(Clone, Debug)]
pub(crate) struct Patchwork {
    /// Vertices of the loop, or of all loops.
    pub n: usize,
    /// Where the loops after the first begin.
    pub later: Vec<usize>,
    /// Loop and new vertices.
    pub end: usize,
    /// The mesh's numbers of the vertices from `end` on.
    pub outer: Vec<u32>,
    /// The patch's triangles, then those around, wound as they come.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles of the patch.
    pub n_patch: usize,
    /// How many pairs of them, from the first on, are quads; see [`Patchwork::of_quads`].
    pub quads: usize,
    /// The corners around the new vertices of a patch of quads.
    pub corners: Option<CornerStars>,
    /// The neighbours of vertex `v` are `near[start[v]..start[v + 1]]`, ascending.
    pub start: Vec<u32>,
    pub near: Vec<u32>,
    /// For each triangle and each of its corners: where in `near` the edge that faces it is, from either end.
    slots: Vec<[[u32; 2]; 3]>,
    /// The triangles at vertex `v` are `fans[fan_start[v]..fan_start[v + 1]]`, each as its number and
    /// the two vertices that follow `v` in it.
    pub fan_start: Vec<u32>,
    pub fans: Vec<[u32; 3]>,
    /// True where the triangles here close around the vertex (of the loop and the patch: of all) so that
    /// a curvature can be read there.
    pub closed: Vec<bool>,
}

impl Patchwork {
    /// `patch` over `0..n + inner`; `rim` has at least `rings` rings around the loop.
    ///
    /// # Errors
    /// [`Error::Internal`].
    pub fn new(loop_: &[u32], inner: usize, patch: &[[u32; 3]], rim: &Rim, rings: usize) -> Result<Self> {
        let n = loop_.len();
        let end = n + inner;
        let mut around = vec![];
        let mut seeds = loop_.iter().filter_map(|&v| rim.local(v)).collect::<Vec<_>>();
        for _ in 0..rings {
            around = seeds.iter().flat_map(|&v| rim.around(v)).copied().collect::<Vec<_>>();
            around.sort_unstable();
            around.dedup();
            seeds = around.iter().flat_map(|&t| rim.triangles[t as usize]).collect();
            seeds.sort_unstable();
            seeds.dedup();
        }
        let mut places = loop_.iter().enumerate().map(|(k, &v)| (v, k as u32)).collect::<Vec<_>>();
        places.sort_unstable();
        let on_loop = |v: u32| places.binary_search_by_key(&v, |p| p.0).ok().map(|k| places[k].1);
        // `seeds` is ascending, and so are the mesh's numbers in it.
        let outer =
            seeds.iter().map(|&v| rim.ids[v as usize]).filter(|&v| on_loop(v).is_none()).collect::<Vec<_>>();
        let mut triangles = patch.to_vec();
        for t in around {
            let mut corners = rim.triangles[t as usize].map(|v| rim.ids[v as usize]);
            for v in &mut corners {
                *v = match on_loop(*v) {
                    Some(k) => k,
                    None => (end + place(&outer, *v)?) as u32,
                };
            }
            triangles.push(corners);
        }
        Patchwork::of(n, end, outer, triangles, patch.len())
    }

    /// Of triangles over `n` loop vertices, new ones up to `end` and `outer`, those of the patch first.
    ///
    /// # Errors
    /// [`Error::Internal`].
    pub fn of(
        n: usize,
        end: usize,
        outer: Vec<u32>,
        triangles: Vec<[u32; 3]>,
        n_patch: usize,
    ) -> Result<Self> {
        let count = end + outer.len();
        let mut it = Patchwork {
            n,
            later: vec![],
            end,
            outer,
            n_patch,
            quads: 0,
            corners: None,
            start: vec![0],
            near: vec![],
            slots: vec![],
            fan_start: vec![0; count + 1],
            fans: vec![[0; 3]; 3 * triangles.len()],
            closed: vec![],
            triangles,
        };
        it.connect(count)?;
        Ok(it)
    }

    fn connect(&mut self, count: usize) -> Result<()> {
        for &v in self.triangles.iter().flatten() {
            self.fan_start[v as usize + 1] += 1;
        }
        for v in 0..count {
            self.fan_start[v + 1] += self.fan_start[v];
        }
        let mut next = self.fan_start.clone();
        for (t, corners) in self.triangles.iter().enumerate() {
            for k in 0..3 {
                let slot = &mut next[corners[k] as usize];
                self.fans[*slot as usize] = [t as u32, corners[(k + 1) % 3], corners[(k + 2) % 3]];
                *slot += 1;
            }
        }
        let mut ends: Vec<u32> = vec![];
        for v in 0..count {
            ends.clear();
            ends.extend(self.fan(v).iter().flat_map(|&[_, a, b]| [a, b]));
            ends.sort_unstable();
            let closed = !ends.is_empty() && ends.chunk_by(|a, b| a == b).all(|same| same.len() == 2);
            self.closed.push(closed);
            ends.dedup();
            self.near.extend_from_slice(&ends);
            self.start.push(self.near.len() as u32);
        }
        let slot = |p: u32, q: u32| {
            let slot = self.slot(p as usize, q as usize).map(|slot| slot as u32);
            slot.ok_or(Error::Internal { reason: "an edge has no slot" })
        };
        let facing = |t: &[u32; 3]| {
            let one = |k: usize| {
                let (p, q) = (t[(k + 1) % 3], t[(k + 2) % 3]);
                Ok([slot(p, q)?, slot(q, p)?])
            };
            Ok([one(0)?, one(1)?, one(2)?])
        };
        self.slots = self.triangles.iter().map(facing).collect::<Result<_>>()?;
        Ok(())
    }

    /// The vertices of the loop that a vertex is on.
    pub fn loop_of(&self, v: usize) -> std::ops::Range<usize> {
        let k = self.later.partition_point(|&start| start <= v);
        let start = if k == 0 { 0 } else { self.later[k - 1] };
        start..self.later.get(k).copied().unwrap_or(self.n)
    }

    /// The vertex that follows another on its loop.
    pub fn after(&self, v: usize) -> usize {
        let next = v + 1;
        if next == self.n || self.later.contains(&next) { self.loop_of(v).start } else { next }
    }

    /// The number of all vertices.
    pub fn len(&self) -> usize {
        self.closed.len()
    }

    /// Where the neighbours of a vertex are in `near`.
    pub fn range(&self, v: usize) -> std::ops::Range<usize> {
        self.start[v] as usize..self.start[v + 1] as usize
    }

    /// Where in `near` an edge is, from its first end.
    pub fn slot(&self, p: usize, q: usize) -> Option<usize> {
        let range = self.range(p);
        let at = self.near[range.clone()].iter().position(|&u| u as usize == q);
        at.map(|at| range.start + at)
    }

    /// For each corner of a triangle where in `near` the edge that faces it is, from either end.
    pub fn slots(&self, t: usize) -> [[u32; 2]; 3] {
        self.slots[t]
    }

    /// See `fans`.
    pub fn fan(&self, v: usize) -> &[[u32; 3]] {
        &self.fans[self.fan_start[v] as usize..self.fan_start[v + 1] as usize]
    }

    /// The new vertices.
    pub fn inner(&self) -> std::ops::Range<usize> {
        self.n..self.end
    }

    /// The unknown that a vertex is.
    pub fn unknown(&self, v: usize) -> Option<u32> {
        self.inner().contains(&v).then(|| (v - self.n) as u32)
    }

    /// A number below the length of `near` for each edge of a triangle, the same for all triangles there.
    pub fn edge_slots(&self, t: usize) -> [u32; 3] {
        self.slots[t].map(|[a, b]| a.min(b))
    }

    /// Half the sum of the cotangents that face each edge, parallel to `near`. Thin triangles count as if
    /// they were thicker: all three cotangents alike, so that each triangle's share stays semidefinite.
    pub fn cotangents(&self, positions: &[DVec3]) -> Vec<f64> {
        const THIN: f64 = 0.05;
        let mut weights = vec![0.0; self.near.len()];
        for (corners, slots) in self.triangles.iter().zip(&self.slots) {
            let [a, b, c] = corners.map(|v| positions[v as usize]);
            let longest =
                (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            let doubled = (b - a).cross(c - a).length().max(THIN * longest).max(f64::MIN_POSITIVE);
            let dots = [(b - a).dot(c - a), (c - b).dot(a - b), (a - c).dot(b - c)];
            for k in 0..3 {
                let half = 0.5 * dots[k] / doubled;
                for slot in slots[k] {
                    weights[slot as usize] += half;
                }
            }
        }
        weights
    }

    /// A third of the area of the triangles at each vertex.
    pub fn areas(&self, positions: &[DVec3]) -> Vec<f64> {
        let mut areas = vec![0.0; self.len()];
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|v| positions[v as usize]);
            let third = (b - a).cross(c - a).length() / 6.0;
            corners.iter().for_each(|&v| areas[v as usize] += third);
        }
        areas
    }

    /// Unit normals at all vertices: of the triangles there, weighted by angle, each turned to agree with
    /// its own winding.
    pub fn normals(&self, positions: &[DVec3]) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; self.len()];
        for corners in &self.triangles {
            let p = corners.map(|v| positions[v as usize]);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            for k in 0..3 {
                let (u, w) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                normals[corners[k] as usize] += normal * libm::atan2(u.cross(w).length(), u.dot(w));
            }
        }
        normals.into_iter().map(|normal| normal.normalize_or(DVec3::Z)).collect()
    }
}
