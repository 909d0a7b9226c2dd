//! The joined mesh: what stays of the parts, and the patches.

use glam::DVec3;

use super::options::JoinReport;
use super::parts::Parts;
use super::pieces::volume;
use super::rims::Outside;
use super::site::Site;
use super::tries::{Kind, Patch};
use crate::error::{Error, Result};
use crate::fill::surface::meet::{Box3, MOST, count_meetings, near_boxes};
use crate::geometry::metrics::{check_mesh, min_angle};
use crate::geometry::topology::NONE;
use crate::progress::Progress;

/// A joined mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// Those of the parts in their order, as far as they are still used, then those of the patches.
    pub vertices: Vec<DVec3>,
    /// Corners of the faces: first all triangles, then the quads, then those with more. Among faces with as many corners, those of
    /// the parts come first, in their order.
    pub corners: Vec<u32>,
    /// Where each face begins, and the end.
    pub offsets: Vec<u32>,
    /// The part that each face comes from, -1 for new ones.
    pub source_part: Vec<i32>,
    /// Its number there, -1 for new ones.
    pub source_face: Vec<i32>,
    /// The part that each face belongs to; for new ones that on whose side of the line between parts it lies if
    /// [`JoinOptions::border`](super::JoinOptions::border) is set, else -1.
    pub near_part: Vec<i32>,
    /// The part that each vertex comes from, -1 for new ones.
    pub vertex_part: Vec<i32>,
    /// Its number there, -1 for new ones.
    pub source_vertex: Vec<i32>,
    /// The closed rims between what was kept and the patches, for each patch, as the kept faces run.
    pub collars: Vec<Vec<Vec<u32>>>,
    /// Numbers about it.
    pub report: JoinReport,
}

impl Joined {
    /// The corners of a face.
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.offsets[f] as usize..self.offsets[f + 1] as usize]
    }

    /// Puts the mesh together and proves it closed, with the topology of the exact union. `sides`: the part of each new
    /// triangle, or nothing.
    ///
    /// # Errors
    /// [`Error::JoinFailed`], [`Error::Cancelled`]; [`Error::JoinIntersects`] if `strict`.
    pub(super) fn new(
        site: &Site<'_>,
        patches: &[(Vec<usize>, Patch)],
        sides: &[i32],
        mut report: JoinReport,
        progress: Progress<'_>,
    ) -> Result<Joined> {
        let Site { parts, union, ref outside, options, .. } = *site;
        let n = parts.vertices.len();
        let mut name = vec![NONE; n];
        let kept = || (0..parts.n_faces() as u32).filter(|&f| outside.faces[f as usize]);
        kept().flat_map(|f| parts.face(f)).for_each(|&v| name[v as usize] = 0);
        let mut made = Joined {
            vertices: vec![],
            corners: vec![],
            offsets: vec![0],
            source_part: vec![],
            source_face: vec![],
            near_part: vec![],
            vertex_part: vec![],
            source_vertex: vec![],
            collars: vec![],
            report: JoinReport::default(),
        };
        for part in 0..parts.len() {
            for v in parts.first[part][0]..parts.first[part + 1][0] {
                if name[v as usize] != NONE {
                    name[v as usize] = made.vertices.len() as u32;
                    made.vertices.push(parts.vertices[v as usize]);
                    made.vertex_part.push(part as i32);
                    made.source_vertex.push(parts.numbers[v as usize] as i32);
                }
            }
        }
        let first_new = made.vertices.len();
        let new = made.add_patches(&name, outside, patches);
        let mut triangles = vec![];
        for (&t, &f) in parts.triangles.iter().zip(&parts.face_of) {
            if outside.faces[f as usize] {
                triangles.push(t.map(|v| name[v as usize]));
            }
        }
        let old = triangles.len();
        triangles.extend(&new);
        let check = check_mesh(made.vertices.len(), &triangles);
        if !check.watertight || check.euler != union.euler() {
            let at = patches.first().and_then(|p| p.1.vertices.first()).copied().unwrap_or(parts.vertices[0]);
            return Err(Error::JoinFailed { reason: "the patches do not fit together", at: at.into() });
        }
        made.add_faces(parts, &name, kept(), &new);
        made.near_part = made.source_part.clone();
        // New triangles come one after the other.
        if let (false, Some(first)) = (sides.is_empty(), made.source_part.iter().position(|&part| part < 0)) {
            made.near_part[first..first + sides.len()].copy_from_slice(sides);
        }
        let at = |v: u32| made.vertices[v as usize];
        // The union's own triangles meet what the parts' did, and each other by what rounding does to the lines.
        let (mut boxes, mut fresh, mut exact, mut start) = (vec![], vec![], vec![], 0);
        for (_, patch) in patches {
            let own = &new[start..start + patch.triangles.len()];
            start += own.len();
            if patch.kind == Kind::Exact {
                exact.extend_from_slice(own);
            } else {
                boxes.push(Box3::around(own.iter().flatten().map(|&v| at(v))));
                fresh.extend_from_slice(own);
            }
        }
        let mut near = near_boxes(&boxes, &made.vertices, &triangles[..old]).concat();
        near.sort_unstable();
        near.dedup();
        let near = near.into_iter().map(|t| triangles[t as usize]).chain(exact).collect::<Vec<_>>();
        let (pairs, place) = count_meetings(at, &fresh, &near, false, MOST, progress)?;
        if let (true, Some(at)) = (options.strict, place) {
            return Err(Error::JoinIntersects { pairs, at: at.into() });
        }
        let of = |kind: Kind| patches.iter().filter(|p| p.1.kind == kind).count();
        report.components = check.components;
        report.genus = check.genus;
        report.collars = patches.len();
        report.tubes = of(Kind::Tube);
        report.fills = of(Kind::Fill);
        report.creased = of(Kind::Crease);
        report.exact = of(Kind::Exact);
        report.collar_triangles = new.len();
        report.collar_vertices = made.vertices.len() - first_new;
        report.min_angle = min_angle(&made.vertices, &new);
        report.self_intersections = pairs;
        report.volume = volume(&made.vertices, &triangles);
        report.exact_volume = volume(&union.vertices, &union.triangles);
        let (irregular, own) = made.irregular(first_new);
        report.irregular = irregular;
        report.collar_irregular = own;
        made.report = report;
        Ok(made)
    }

    /// The patches' vertices, rims and, as the result, triangles.
    fn add_patches(
        &mut self,
        name: &[u32],
        outside: &Outside,
        patches: &[(Vec<usize>, Patch)],
    ) -> Vec<[u32; 3]> {
        let n = name.len() as u32;
        let mut new = vec![];
        for (rims, patch) in patches {
            let first = self.vertices.len() as u32;
            let named = |v: u32| if v < n { name[v as usize] } else { first + v - n };
            new.extend(patch.triangles.iter().map(|t| t.map(named)));
            self.vertices.extend(&patch.vertices);
            let rim = |&k: &usize| outside.rims[k].iter().map(|&v| name[v as usize]).collect();
            self.collars.push(rims.iter().map(rim).collect());
        }
        self.vertex_part.resize(self.vertices.len(), -1);
        self.source_vertex.resize(self.vertices.len(), -1);
        new
    }

    fn add_faces(
        &mut self,
        parts: &Parts,
        name: &[u32],
        kept: impl Iterator<Item = u32> + Clone,
        new: &[[u32; 3]],
    ) {
        let mut push = |corners: &[u32], part: i32, face: i32| {
            self.corners.extend_from_slice(corners);
            self.offsets.push(self.corners.len() as u32);
            self.source_part.push(part);
            self.source_face.push(face);
        };
        for sides in [3..=3, 4..=4, 5..=usize::MAX] {
            let triangles = *sides.start() == 3;
            for f in kept.clone().filter(|&f| sides.contains(&parts.face(f).len())) {
                let part = parts.solids[parts.solid_of_face(f)].part;
                let corners = parts.face(f).iter().map(|&v| name[v as usize]).collect::<Vec<_>>();
                push(&corners, part as i32, (f - parts.first[part][1]) as i32);
            }
            if triangles {
                new.iter().for_each(|t| push(t, -1, -1));
            }
        }
    }

    /// Irregular vertices, all and those of the patches.
    fn irregular(&self, first_new: usize) -> (usize, usize) {
        let mut sixths = vec![0.0; self.vertices.len()];
        for f in 0..self.source_part.len() {
            let own = self.face(f);
            let share = 3.0 * (own.len() - 2) as f64 / own.len() as f64;
            own.iter().for_each(|&v| sixths[v as usize] += share);
        }
        let off = |t: &f64| (t - 6.0).abs() > 0.75;
        let all = sixths.iter().filter(|t| off(t)).count();
        (all, sixths[first_new..].iter().filter(|t| off(t)).count())
    }
}
