//! The connected pieces of a closed part, and what they enclose.

use std::f64::consts::PI;

use glam::DVec3;
use manifold_rust::types::MeshGL64;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::fill::surface::meet::Box3;
use crate::geometry::disjoint::Disjoint;

/// A piece with less volume than this, relative to its area, encloses nothing.
const FLAT: f64 = 1e-12;

/// What a piece is that winds inward beside the others, or within a cavity.
pub(super) const INSIDE_OUT: &str = "a piece of it is inside out, and its normals are to be flipped,";

/// What keeps a part from being joined, and a vertex there.
pub(super) type Fault = (u32, &'static str);

/// The triangles of a part.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    /// All vertices; those of the part begin at `first`.
    pub vertices: &'a [DVec3],
    pub first: u32,
    pub triangles: &'a [[u32; 3]],
}

/// A connected piece of a part.
pub(super) struct Piece {
    /// The numbers of its triangles in the part, ascending.
    pub triangles: Vec<u32>,
    pub bounds: Box3,
    /// Negative where it is a cavity.
    pub volume: f64,
}

impl Piece {
    pub fn is_cavity(&self) -> bool {
        self.volume < 0.0
    }
}

impl Surface<'_> {
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }

    /// Its pieces, in the order of their first triangles.
    pub fn pieces(&self) -> Vec<Piece> {
        let n = self.vertices.len() - self.first as usize;
        let mut sets = Disjoint::new(n);
        let first = self.first;
        for &[a, b, c] in self.triangles {
            sets.join(a - first, b - first);
            sets.join(b - first, c - first);
        }
        let mut number = vec![usize::MAX; n];
        let mut pieces: Vec<Piece> = vec![];
        for (t, corners) in (0..).zip(self.triangles) {
            let slot = &mut number[sets.root(corners[0] - first) as usize];
            if *slot == usize::MAX {
                *slot = pieces.len();
                pieces.push(Piece { triangles: vec![], bounds: Box3::around([]), volume: 0.0 });
            }
            pieces[*slot].triangles.push(t);
        }
        for piece in &mut pieces {
            piece.bounds = Box3::around(piece.triangles.iter().flat_map(|&t| self.corners(t)));
            piece.volume = self.volume(piece);
        }
        pieces
    }

    fn volume(&self, piece: &Piece) -> f64 {
        let own = piece.triangles.iter().map(|&t| self.triangles[t as usize]).collect::<Vec<_>>();
        volume(self.vertices, &own)
    }

    /// Adds some of its triangles to what the Boolean operation takes as a run, each a face of its own.
    pub fn add_run(&self, mesh: &mut MeshGL64, triangles: &[u32], id: u32) {
        // Vertices of no face would count as points of the solid's box.
        let mut used: FxHashMap<u32, u64> = FxHashMap::default();
        for corner in triangles.iter().flat_map(|&t| self.triangles[t as usize]) {
            let next = (mesh.vert_properties.len() / 3) as u64;
            let number = *used.entry(corner).or_insert(next);
            if number == next {
                mesh.vert_properties.extend(self.vertices[corner as usize].to_array());
            }
            mesh.tri_verts.push(number);
        }
        mesh.run_original_id.push(id);
        mesh.run_index.push(mesh.tri_verts.len() as u64);
        mesh.face_id.extend(0..triangles.len() as u64);
    }

    /// A vertex of a piece.
    pub fn vertex(&self, piece: &Piece) -> u32 {
        self.triangles[piece.triangles[0] as usize][0]
    }

    /// How often a piece winds around a point; 0 outside its box.
    ///
    /// Source: van Oosterom and Strackee, *The solid angle of a plane triangle*, 1983.
    pub fn turns(&self, piece: &Piece, at: DVec3) -> f64 {
        if !piece.bounds.meets(&Box3 { low: at, high: at }) {
            return 0.0;
        }
        let angle = |&t: &u32| {
            let [a, b, c] = self.corners(t).map(|p| p - at);
            let [x, y, z] = [a, b, c].map(DVec3::length);
            libm::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
        };
        piece.triangles.iter().map(angle).sum::<f64>() / (2.0 * PI)
    }

    /// A piece that encloses nothing.
    pub fn flat(&self, pieces: &[Piece]) -> Option<Fault> {
        let is_flat = |piece: &&Piece| {
            let area = piece.triangles.iter().map(|&t| {
                let [a, b, c] = self.corners(t);
                0.5 * (b - a).cross(c - a).length()
            });
            let area = area.sum::<f64>();
            piece.volume.abs() <= FLAT * area * area.sqrt()
        };
        let reason = match pieces {
            [_] => "its faces lie on each other and enclose nothing",
            _ => "the faces of a piece of it lie on each other and enclose nothing",
        };
        pieces.iter().find(is_flat).map(|piece| (self.vertex(piece), reason))
    }

    /// For each piece the one whose volume it belongs to: for a cavity the smallest one around it, else itself.
    pub fn owners(&self, pieces: &[Piece]) -> Result<Vec<usize>, Fault> {
        let owner = |(k, piece): (usize, &Piece)| {
            if !piece.is_cavity() {
                return Ok(k);
            }
            let v = self.vertex(piece);
            let at = self.vertices[v as usize];
            let others = pieces.iter().enumerate().filter(|&(other, _)| other != k);
            let around = others.filter(|(_, other)| self.turns(other, at) > 0.5);
            let smallest = around.min_by(|a, b| a.1.volume.total_cmp(&b.1.volume));
            smallest.map(|(other, _)| other).ok_or((v, INSIDE_OUT))
        };
        // The first fault, on any number of threads.
        pieces.par_iter().enumerate().map(owner).collect::<Vec<_>>().into_iter().collect()
    }
}

/// The volume that triangles enclose.
pub(super) fn volume(vertices: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let Some(&[first, ..]) = triangles.first() else { return 0.0 };
    // Near the mesh, whose place in space is not to cost digits.
    let origin = vertices[first as usize];
    let six = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| vertices[v as usize] - origin);
        a.dot(b.cross(c))
    };
    triangles.iter().map(six).sum::<f64>() / 6.0
}
