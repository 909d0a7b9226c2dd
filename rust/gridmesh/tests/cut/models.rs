//! Models and strokes, and what holds for every cut.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use glam::DVec3;
use gridmesh::cut::{Cut, CutOptions, Piece, Polygons, Side, Sweep, cut};
use gridmesh::error::Result;
use gridmesh::geometry::metrics::check_mesh;
use gridmesh::progress::Progress;

/// Vertices, corners, offsets.
pub struct Mesh(pub Vec<DVec3>, pub Vec<u32>, pub Vec<u32>);

impl Mesh {
    pub fn quads(vertices: Vec<DVec3>, quads: &[[u32; 4]]) -> Mesh {
        Mesh(vertices, quads.concat(), (0..=quads.len() as u32).map(|k| 4 * k).collect())
    }

    pub fn faces(&self) -> Polygons<'_> {
        Polygons { corners: &self.1, offsets: &self.2 }
    }

    pub fn cut(&self, stroke: &[DVec3], options: &CutOptions) -> Result<Cut> {
        cut(&self.0, self.faces(), stroke, options, Progress::NONE)
    }
}

/// A torus of quads around z, bumpy so that nothing is on a line.
pub fn torus(n: u32, m: u32) -> Mesh {
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let (mut vertices, mut quads) = (vec![], vec![]);
    for i in 0..n {
        for j in 0..m {
            let (u, v) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m));
            let r = 2.0 + 0.8 * v.cos();
            vertices.push(DVec3::new(r * u.cos(), r * u.sin(), 0.8 * v.sin()));
            quads.push([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    Mesh::quads(vertices, &quads)
}

pub fn cube() -> Mesh {
    let corner = |k: u32| DVec3::new(f64::from(k >> 2), f64::from(k >> 1 & 1), f64::from(k & 1));
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    Mesh::quads((0..8).map(corner).collect(), &quads)
}

/// A prism with ends of twelve corners.
pub fn prism() -> Mesh {
    let n = 12u32;
    let ring = |z: f64| {
        (0..n).map(move |k| {
            let t = TAU * f64::from(k) / f64::from(n);
            DVec3::new(t.cos(), t.sin(), z)
        })
    };
    let mut corners: Vec<u32> = (0..n).rev().chain(n..2 * n).collect();
    let mut offsets = vec![0, n, 2 * n];
    for k in 0..n {
        let next = (k + 1) % n;
        corners.extend([k, next, next + n, k + n]);
        offsets.push(corners.len() as u32);
    }
    Mesh(ring(-1.0).chain(ring(1.0)).collect(), corners, offsets)
}

pub fn triangles(piece: &Piece) -> Vec<[u32; 3]> {
    // Fans: enough for what is connected to what.
    let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
    let fan = |f: usize| {
        let c = faces.face(f);
        (1..c.len() - 1).map(|k| [c[0], c[k], c[k + 1]]).collect::<Vec<_>>()
    };
    (0..faces.len()).flat_map(fan).collect()
}

/// An edge that has other than two faces, which run along it in opposite directions.
pub fn open_edge(piece: &Piece) -> Option<[u32; 2]> {
    let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
    let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for face in faces.iter() {
        for k in 0..face.len() {
            *sides.entry([face[k], face[(k + 1) % face.len()]]).or_default() += 1;
        }
    }
    let mut all = sides.iter();
    all.find(|([a, b], count)| **count != 1 || !sides.contains_key(&[*b, *a])).map(|(side, _)| *side)
}

pub fn assert_closed(cut: &Cut) {
    for piece in &cut.pieces {
        let check = check_mesh(piece.vertices.len(), &triangles(piece));
        assert!(check.watertight, "{:?} {check:?}", piece.side);
        assert_eq!(piece.source_face.len() + 1, piece.offsets.len());
        assert_eq!(piece.source_vertices.len(), piece.vertices.len());
    }
}

pub fn assert_volumes(cut: &Cut, tolerance: f64) {
    let sum: f64 = cut.report.volumes.iter().sum();
    let whole = cut.report.volume;
    assert!((sum - whole).abs() <= tolerance * whole.abs(), "{sum} {whole}");
    assert!(cut.report.volumes.iter().all(|v| *v > 0.0), "{:?}", cut.report.volumes);
}

/// Cap triangles by position, each from its least corner on.
pub fn caps(piece: &Piece, reversed: bool) -> BTreeSet<Vec<[u64; 3]>> {
    let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
    let name = |f: usize| {
        let mut t: Vec<[u64; 3]> =
            faces.face(f).iter().map(|&v| piece.vertices[v as usize].to_array().map(f64::to_bits)).collect();
        if reversed {
            t.reverse();
        }
        let least = (0..t.len()).min_by_key(|&k| t[k]).unwrap();
        t.rotate_left(least);
        t
    };
    (0..faces.len()).filter(|&f| piece.source_face[f] < 0).map(name).collect()
}

pub fn assert_mirrored(cut: &Cut) {
    let [left, right] = &cut.pieces[..] else { panic!("two pieces") };
    assert!(!caps(left, false).is_empty());
    assert_eq!(caps(left, false), caps(right, true));
}

/// Old vertices have their bits, and combinations of old vertices give the new ones outside caps.
pub fn assert_sources(mesh: &Mesh, cut: &Cut, tolerance: f64) {
    for piece in &cut.pieces {
        let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
        let outside: BTreeSet<u32> = (0..faces.len())
            .filter(|&f| piece.source_face[f] >= 0)
            .flat_map(|f| faces.face(f).iter().copied())
            .collect();
        for &v in &outside {
            let (own, from) = (piece.vertices[v as usize], piece.source_vertices[v as usize]);
            let weights = piece.source_weights[v as usize];
            if weights[0] == 1.0 {
                assert_eq!(own, mesh.0[from[0] as usize]);
            }
            let there: DVec3 = (0..3).map(|k| weights[k] * mesh.0[from[k] as usize]).sum();
            assert!(there.distance(own) <= tolerance, "{there} {own}");
        }
    }
}

/// Faces that are returned whole: by their number in the input.
pub fn untouched(mesh: &Mesh, cut: &Cut) -> BTreeMap<i32, Side> {
    let mut found = BTreeMap::new();
    for piece in &cut.pieces {
        let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
        for f in 0..faces.len() {
            let source = piece.source_face[f];
            let old = faces.face(f).iter().map(|&v| piece.source_vertices[v as usize][0]).collect::<Vec<_>>();
            let is_old = |v: &u32| piece.source_weights[*v as usize][0] == 1.0;
            if source >= 0 && mesh.faces().face(source as usize) == old && faces.face(f).iter().all(is_old) {
                found.insert(source, piece.side);
            }
        }
    }
    found
}

pub fn down() -> CutOptions {
    CutOptions::new(Sweep::Along(-DVec3::Z))
}

pub fn line(points: &[(f64, f64)]) -> Vec<DVec3> {
    points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
}

pub fn circle(x: f64, y: f64, r: f64, n: u32) -> Vec<DVec3> {
    (0..=n)
        .map(|k| {
            let t = TAU * f64::from(k % n) / f64::from(n);
            DVec3::new(x + r * t.cos(), y + r * t.sin(), 0.0)
        })
        .collect()
}

/// A ball of rings of triangles, closed by a fan at either pole.
pub fn ball(rings: u32) -> Mesh {
    let around = 2 * rings;
    let mut vertices = vec![DVec3::NEG_Z];
    for r in 1..rings {
        let (low, height) = (std::f64::consts::PI * f64::from(r) / f64::from(rings)).sin_cos();
        vertices.extend((0..around).map(|k| {
            let (y, x) = (TAU * f64::from(k) / f64::from(around)).sin_cos();
            DVec3::new(low * x, low * y, -height)
        }));
    }
    let top = vertices.len() as u32;
    vertices.push(DVec3::Z);
    let at = |r: u32, k: u32| 1 + (r - 1) * around + k % around;
    let mut triangles = vec![];
    for k in 0..around {
        triangles.push([0, at(1, k + 1), at(1, k)]);
        triangles.push([top, at(rings - 1, k), at(rings - 1, k + 1)]);
        for r in 1..rings - 1 {
            let [a, b, c, d] = [at(r, k), at(r, k + 1), at(r + 1, k + 1), at(r + 1, k)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let n = triangles.len() as u32;
    Mesh(vertices, triangles.concat(), (0..=n).map(|k| 3 * k).collect())
}
