//! The parts, one after the other in one numbering, and triangulated.

use glam::DVec3;

use super::overlap::solids;
use super::pieces::{Fault, Surface, volume};
use crate::cut::Polygons;
use crate::cut::input::{check_mesh, triangles};
use crate::error::{Error, Result};
use crate::progress::Progress;

/// Triangles of all parts at most.
const LIMIT: usize = 20_000_000;

/// A closed mesh that is to be joined.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Positions of its vertices.
    pub vertices: &'a [DVec3],
    /// Its faces.
    pub faces: Polygons<'a>,
}

/// What the exact union takes as one: a part, or a piece of a part that overlaps others of it.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// The part.
    pub part: usize,
    /// What it encloses.
    pub volume: f64,
    /// Its triangles, ascending.
    pub triangles: Vec<u32>,
}

/// All parts: vertices, faces and triangles numbered through.
pub(super) struct Parts {
    pub vertices: Vec<DVec3>,
    /// The number of each vertex in its part.
    pub numbers: Vec<u32>,
    /// Faces, all wound counter-clockwise as seen from outside.
    pub corners: Vec<u32>,
    pub offsets: Vec<u32>,
    pub triangles: Vec<[u32; 3]>,
    /// The face of each triangle.
    pub face_of: Vec<u32>,
    /// The first vertex, face and triangle of each part, and the ends.
    pub first: Vec<[u32; 3]>,
    /// All solids, part by part.
    pub solids: Vec<Solid>,
    /// The solid of each face and vertex.
    solid_of_face: Vec<u32>,
    solid_of_vertex: Vec<u32>,
    /// Parts that were given inside out.
    pub turned: usize,
    /// Vertices added where faces meet in a vertex or along an edge alone.
    pub separated: usize,
}

/// A corner of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// The vertices after and before it in the face.
    pub next: u32,
    pub before: u32,
    pub face: u32,
}

/// The corners at each vertex.
pub(super) struct Around {
    vertex: u32,
    start: Vec<u32>,
    corners: Vec<Corner>,
}

impl Around {
    /// Those at one vertex.
    pub fn of(&self, v: u32) -> &[Corner] {
        let k = (v - self.vertex) as usize;
        &self.corners[self.start[k] as usize..self.start[k + 1] as usize]
    }
}

impl Parts {
    /// Checks and collects.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::ExtremeSize`], [`Error::InvalidFace`], [`Error::IndexOutOfRange`],
    /// [`Error::NotClosed`], [`Error::TooLarge`], [`Error::JoinFailed`], [`Error::Cancelled`].
    pub fn new(given: &[Part<'_>], progress: Progress<'_>) -> Result<Parts> {
        let mut all = Parts {
            vertices: vec![],
            numbers: vec![],
            corners: vec![],
            offsets: vec![0],
            triangles: vec![],
            face_of: vec![],
            first: vec![[0; 3]],
            solids: vec![],
            solid_of_face: vec![],
            solid_of_vertex: vec![],
            turned: 0,
            separated: 0,
        };
        for (number, part) in given.iter().enumerate() {
            check_part(number, part)?;
            all.add(number, part)?;
            let at = |k: usize| k as f64 / given.len() as f64;
            all.divide(number, progress.part(at(number), at(number + 1)))?;
        }
        Ok(all)
    }

    fn add(&mut self, number: usize, part: &Part<'_>) -> Result<()> {
        let [vertex, face, triangle] = self.first[number];
        let most = self.triangles.len() + part.faces.corners.len();
        if most > LIMIT || self.vertices.len() + part.vertices.len() > LIMIT {
            return Err(Error::TooLarge { triangles: most as f64, limit: LIMIT as f64 });
        }
        self.vertices.extend_from_slice(part.vertices);
        self.numbers.extend(0..part.vertices.len() as u32);
        for f in 0..part.faces.len() {
            let of = face + f as u32;
            let own = part.faces.face(f);
            triangles(part.vertices, own, |t| {
                self.triangles.push(t.map(|v| v + vertex));
                self.face_of.push(of);
            });
            self.corners.extend(own.iter().map(|v| v + vertex));
            self.offsets.push(self.corners.len() as u32);
        }
        let own = triangle as usize..self.triangles.len();
        let enclosed = volume(&self.vertices, &self.triangles[own.clone()]);
        if enclosed < 0.0 {
            self.turned += 1;
            self.triangles[own].iter_mut().for_each(|t| t.swap(1, 2));
            for f in face as usize..self.offsets.len() - 1 {
                self.corners[self.offsets[f] as usize..self.offsets[f + 1] as usize].reverse();
            }
        }
        self.separate(number)?;
        self.first.push([
            self.vertices.len() as u32,
            self.offsets.len() as u32 - 1,
            self.triangles.len() as u32,
        ]);
        Ok(())
    }

    /// Finds the solids of the last part.
    fn divide(&mut self, part: usize, progress: Progress<'_>) -> Result<()> {
        let [first, _, start] = self.first[part];
        let triangles = &self.triangles[start as usize..];
        let surface = Surface { vertices: &self.vertices, first, triangles };
        let refuse = |(v, reason): Fault| self.not_closed(part, reason, v);
        let found = solids(&surface, refuse, progress)?;
        self.solid_of_face.resize(self.n_faces(), 0);
        self.solid_of_vertex.resize(self.vertices.len(), 0);
        for own in found {
            let corners = own.iter().map(|&t| triangles[t as usize]).collect::<Vec<_>>();
            let volume = volume(&self.vertices, &corners).abs();
            let number = self.solids.len() as u32;
            let own = own.into_iter().map(|t| t + start).collect::<Vec<_>>();
            for &t in &own {
                self.solid_of_face[self.face_of[t as usize] as usize] = number;
                self.triangles[t as usize].iter().for_each(|&v| self.solid_of_vertex[v as usize] = number);
            }
            self.solids.push(Solid { part, volume, triangles: own });
        }
        Ok(())
    }

    pub(super) fn not_closed(&self, part: usize, reason: &'static str, v: u32) -> Error {
        let at = self.vertices[v as usize].into();
        Error::NotClosed { part, reason, vertex: self.numbers[v as usize], at }
    }

    /// The corners of faces at each vertex, of the faces and vertices from these on.
    pub fn around(&self, vertex: u32, face: u32) -> Around {
        let n = self.vertices.len() - vertex as usize;
        let mut start = vec![0u32; n + 1];
        let from = self.offsets[face as usize] as usize;
        for &v in &self.corners[from..] {
            start[(v - vertex) as usize + 1] += 1;
        }
        for i in 0..n {
            start[i + 1] += start[i];
        }
        let mut fill = start.clone();
        let none = Corner { next: 0, before: 0, face: 0 };
        let mut corners = vec![none; self.corners.len() - from];
        for f in face..self.n_faces() as u32 {
            let own = self.face(f);
            let m = own.len();
            for k in 0..m {
                let slot = &mut fill[(own[k] - vertex) as usize];
                corners[*slot as usize] =
                    Corner { next: own[(k + 1) % m], before: own[(k + m - 1) % m], face: f };
                *slot += 1;
            }
        }
        Around { vertex, start, corners }
    }

    /// The corners of a face.
    pub fn face(&self, f: u32) -> &[u32] {
        &self.corners[self.offsets[f as usize] as usize..self.offsets[f as usize + 1] as usize]
    }

    /// The number of faces.
    pub fn n_faces(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The number of parts.
    pub fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// The solid of a triangle.
    pub fn solid_of_triangle(&self, triangle: u32) -> usize {
        self.solid_of_face(self.face_of[triangle as usize])
    }

    /// The solid of a face.
    pub fn solid_of_face(&self, face: u32) -> usize {
        self.solid_of_face[face as usize] as usize
    }

    /// The solid of a vertex that is a corner of a face.
    pub fn solid_of_vertex(&self, vertex: u32) -> usize {
        self.solid_of_vertex[vertex as usize] as usize
    }

    /// How many pieces of parts overlap others of the same part.
    pub fn overlapping(&self) -> usize {
        let count = |own: &[Solid]| if own.len() > 1 { own.len() } else { 0 };
        self.solids.chunk_by(|a, b| a.part == b.part).map(count).sum()
    }
}

fn check_part(number: usize, part: &Part<'_>) -> Result<()> {
    let named = |error| match error {
        Error::InvalidFace { face, reason } => {
            Error::InvalidFace { face, reason: format!("in part {number} {reason}") }
        }
        Error::IndexOutOfRange { what, index, vertices } => {
            Error::IndexOutOfRange { what: format!("{what} of part {number}"), index, vertices }
        }
        other => other,
    };
    check_mesh(&format!("part {number}"), part.vertices, part.faces).map_err(named)?;
    if part.faces.is_empty() {
        return Err(Error::TooFewPoints { what: format!("part {number}"), distinct: 0 });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: [[u32; 4]; 6] =
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];

    fn cube() -> Vec<DVec3> {
        let at = |k: u32| DVec3::new(f64::from(k >> 2 & 1), f64::from(k >> 1 & 1), f64::from(k & 1));
        (0..8).map(at).collect()
    }

    fn made(vertices: &[DVec3], faces: &[Vec<u32>]) -> Result<Parts> {
        let corners = faces.concat();
        let mut offsets = vec![0];
        faces.iter().for_each(|f| offsets.push(offsets[offsets.len() - 1] + f.len() as u32));
        let part = Part { vertices, faces: Polygons { corners: &corners, offsets: &offsets } };
        Parts::new(&[part], Progress::NONE)
    }

    fn quads() -> Vec<Vec<u32>> {
        CUBE.iter().map(|q| q.to_vec()).collect()
    }

    #[test]
    fn closed_parts_are_taken_and_turned() {
        let parts = made(&cube(), &quads()).unwrap();
        assert_eq!((parts.n_faces(), parts.triangles.len(), parts.turned), (6, 12, 0));
        assert!((volume(&parts.vertices, &parts.triangles) - 1.0).abs() < 1e-15);
        let inside_out = quads().into_iter().map(|q| q.into_iter().rev().collect()).collect::<Vec<_>>();
        let parts = made(&cube(), &inside_out).unwrap();
        assert_eq!(parts.turned, 1);
        assert!((volume(&parts.vertices, &parts.triangles) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_closed_is_refused() {
        let reason = |faces: &[Vec<u32>], vertices: &[DVec3]| match made(vertices, faces) {
            Err(Error::NotClosed { reason, .. }) => reason,
            other => panic!("{:?}", other.err()),
        };
        let one_side = "an edge has a face on one side only";
        assert_eq!(reason(&quads()[..5], &cube()), one_side);
        let twice = [quads(), quads()].concat();
        assert_eq!(reason(&twice, &cube()), "an edge joins more than two faces");
        let mut turned = quads();
        turned[3].reverse();
        assert_eq!(reason(&turned, &cube()), "two faces at an edge are wound against each other");
    }
}
