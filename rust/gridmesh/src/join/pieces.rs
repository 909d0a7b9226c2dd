//! What the pieces of a closed part enclose.

use std::f64::consts::PI;

use glam::DVec3;

use crate::geometry::disjoint::Disjoint;

/// A part with less volume than this, relative to its area, encloses nothing.
const FLAT: f64 = 1e-12;

/// A connected piece of a part.
struct Piece {
    triangles: Vec<[u32; 3]>,
    /// Corners of its box.
    low: DVec3,
    high: DVec3,
    volume: f64,
}

/// Whether the boxes of two pieces overlap that enclose a volume each: the pieces themselves may do so too.
pub(super) fn overlap(vertices: &[DVec3], triangles: &[[u32; 3]], first: u32) -> bool {
    let mut outer = pieces(vertices, triangles, first);
    outer.retain(|piece| piece.volume > 0.0);
    outer
        .iter()
        .enumerate()
        .any(|(k, a)| outer[k + 1..].iter().any(|b| a.low.cmple(b.high).all() && b.low.cmple(a.high).all()))
}

/// What keeps a closed part that encloses a volume above 0 in all from being joined, and a vertex there. Vertices of the part begin at `first`.
pub(super) fn fault(vertices: &[DVec3], triangles: &[[u32; 3]], first: u32) -> Option<(u32, &'static str)> {
    let pieces = pieces(vertices, triangles, first);
    for (k, piece) in pieces.iter().enumerate().filter(|(_, piece)| piece.volume < 0.0) {
        let v = piece.triangles[0][0];
        let at = vertices[v as usize];
        let around = |other: &Piece| {
            let is_near = other.low.cmple(at).all() && other.high.cmpge(at).all();
            if is_near { other.volume.signum() * turns(vertices, &other.triangles, at) } else { 0.0 }
        };
        let others = pieces.iter().enumerate().filter(|&(other, _)| other != k);
        // Within another one it is a cavity.
        if others.map(|(_, other)| around(other)).sum::<f64>() < 0.5 {
            return Some((v, "a piece of it is inside out, and its normals are to be flipped,"));
        }
    }
    let area = triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| vertices[v as usize]);
        0.5 * (b - a).cross(c - a).length()
    });
    let area = area.sum::<f64>();
    let enclosed = pieces.iter().map(|piece| piece.volume.abs()).sum::<f64>();
    (enclosed <= FLAT * area * area.sqrt())
        .then(|| (triangles[0][0], "its faces lie on each other and enclose nothing"))
}

fn pieces(vertices: &[DVec3], triangles: &[[u32; 3]], first: u32) -> Vec<Piece> {
    let n = vertices.len() - first as usize;
    let mut sets = Disjoint::new(n);
    for &[a, b, c] in triangles {
        sets.join(a - first, b - first);
        sets.join(b - first, c - first);
    }
    let mut number = vec![usize::MAX; n];
    let mut pieces: Vec<Piece> = vec![];
    for t in triangles {
        let slot = &mut number[sets.root(t[0] - first) as usize];
        if *slot == usize::MAX {
            *slot = pieces.len();
            let (low, high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            pieces.push(Piece { triangles: vec![], low, high, volume: 0.0 });
        }
        let piece = &mut pieces[*slot];
        piece.triangles.push(*t);
        for v in t {
            let p = vertices[*v as usize];
            (piece.low, piece.high) = (piece.low.min(p), piece.high.max(p));
        }
    }
    for piece in &mut pieces {
        piece.volume = volume(vertices, &piece.triangles);
    }
    pieces
}

/// How often a closed surface winds around a point.
///
/// Source: van Oosterom and Strackee, *The solid angle of a plane triangle*, 1983.
fn turns(vertices: &[DVec3], triangles: &[[u32; 3]], at: DVec3) -> f64 {
    let angle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| vertices[v as usize] - at);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        libm::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    triangles.iter().map(angle).sum::<f64>() / (2.0 * PI)
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
