//! Fills of synthetic meshes keep their promises.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::DVec3;
use gridmesh::error::Result;
use gridmesh::fill::{Fill, FillOptions, Smooth, fill_hole, fill_holes};
use gridmesh::geometry::metrics::check_mesh;
use gridmesh::progress::Progress;

/// A torus of `n` by `m` quads, each two triangles, without those of the quads for which `gone`.
fn torus(n: u32, m: u32, gone: impl Fn(u32, u32) -> bool) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let (mut vertices, mut triangles) = (vec![], vec![]);
    for i in 0..n {
        for j in 0..m {
            let (u, v) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m));
            let r = 2.0 + 0.8 * v.cos();
            vertices.push(DVec3::new(r * u.cos(), r * u.sin(), 0.8 * v.sin()));
            if !gone(i, j) {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    (vertices, triangles)
}

/// The mesh with all fills.
fn closed(vertices: &[DVec3], triangles: &[[u32; 3]], fills: &[Fill]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, mut faces) = (vertices.to_vec(), triangles.to_vec());
    for fill in fills {
        let shift = (points.len() - vertices.len()) as u32;
        let name = |v: u32| if (v as usize) < vertices.len() { v } else { v + shift };
        faces.extend(fill.triangles.iter().map(|t| t.map(name)));
        points.extend(&fill.vertices);
    }
    (points, faces)
}

fn sound(fills: Vec<Result<Fill>>) -> Result<Vec<Fill>> {
    fills.into_iter().collect()
}

#[test]
fn holes_of_a_torus_are_closed() {
    let (vertices, triangles) =
        torus(48, 24, |i, j| (i / 6) % 2 == 0 && (j / 6) % 2 == 0 && (i % 6 + j % 6) > 2);
    for smooth in [Smooth::Flat, Smooth::Tangent, Smooth::Curvature] {
        let options = FillOptions { smooth, ..FillOptions::default() };
        let fills =
            fill_holes(&vertices, &triangles, None, &options, Progress::NONE).and_then(sound).unwrap();
        assert_eq!(fills.len(), 8);
        let (points, faces) = closed(&vertices, &triangles, &fills);
        let check = check_mesh(points.len(), &faces);
        // Vertices in the middle of the holes are left over, unused.
        assert!(check.watertight, "{smooth:?} {check:?}");
        assert_eq!(check.genus, 1);
        assert!(fills.iter().all(|fill| fill.report.self_intersections == 0));
    }
}

#[test]
fn loops_that_share_corners_do_not_share_new_edges() {
    // Wire: many quadrilaterals over the same diagonal.
    let mut vertices = vec![DVec3::ZERO, DVec3::X];
    let mut loops = vec![];
    for k in 0..12 {
        let a = DVec3::new(0.5, (0.5 * f64::from(k)).cos(), (0.5 * f64::from(k)).sin());
        let n = vertices.len() as u32;
        vertices.extend([a, DVec3::new(0.5, -a.y, -a.z - 0.1)]);
        loops.push(vec![0, n, 1, n + 1]);
    }
    let fills = fill_holes(&vertices, &[], Some(&loops), &FillOptions::default(), Progress::NONE);
    let (_, faces) = closed(&vertices, &[], &fills.and_then(sound).unwrap());
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for t in &faces {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    assert!(edges.values().all(|&count| count <= 2));
}

#[test]
fn threads_change_nothing() {
    let (vertices, triangles) = torus(60, 24, |i, j| (i / 5) % 2 == 0 && j % 12 < 6);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = FillOptions::default();
        pool.install(|| {
            fill_holes(&vertices, &triangles, None, &options, Progress::NONE).and_then(sound).unwrap()
        })
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.len(), 12);
    assert!(one.iter().zip(&three).all(|(a, b)| a == b));
}

#[test]
fn neighbours_that_disagree_are_counted() {
    let (vertices, mut triangles) = torus(24, 16, |i, j| i < 4 && j < 4);
    let plain = fill_holes(&vertices, &triangles, None, &FillOptions::default(), Progress::NONE).unwrap();
    let fill = plain[0].as_ref().unwrap();
    assert_eq!(fill.report.winding_conflicts, 0);
    let [a, b] = [fill.loop_[0], fill.loop_[1]];
    for t in &mut triangles {
        if t.contains(&a) && t.contains(&b) {
            t.swap(0, 1);
        }
    }
    let again =
        fill_hole(&vertices, &triangles, &fill.loop_, &FillOptions::default(), Progress::NONE).unwrap();
    assert_eq!(again.report.winding_conflicts, 1);
    assert_eq!(again.triangles, fill.triangles);
}
