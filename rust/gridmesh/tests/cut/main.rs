//! Cuts of synthetic meshes keep their promises.
#![allow(clippy::unwrap_used, clippy::panic)]

mod again;
mod hostile;
mod models;
mod quads;
mod random;
mod rims;
mod uncrossed;

use std::f64::consts::TAU;

use glam::DVec3;
use gridmesh::cut::{CutOptions, Keep, Sweep, cut};
use gridmesh::fill::Smooth;
use gridmesh::geometry::metrics::check_mesh;
use gridmesh::progress::Progress;

use crate::models::*;

#[test]
fn both_pieces_are_closed_and_add_up() {
    let wave: Vec<DVec3> = (0..=80)
        .map(|k| {
            let x = -3.5 + 7.0 * f64::from(k) / 80.0;
            DVec3::new(x, 0.6 * (3.0 * x).sin() + 0.2, 5.0)
        })
        .collect();
    let zigzag: Vec<DVec3> = (0..16)
        .map(|k| DVec3::new(-3.1 + 0.43 * f64::from(k), if k % 2 == 0 { -0.7 } else { 0.9 }, 0.0))
        .collect();
    let strokes = [
        line(&[(-4.0, 0.3), (4.0, 0.5)]),
        wave,
        zigzag,
        circle(0.3, 0.1, 1.9, 40),
        circle(0.2, 0.0, 2.1, 5),
        // Through the ring at one place: a tunnel.
        circle(2.0, 0.1, 0.4, 24),
        // The outline's edge.
        line(&[(-4.0, 2.75), (4.0, 2.75)]),
    ];
    let mesh = torus(40, 20);
    for stroke in &strokes {
        let cut = mesh.cut(stroke, &down()).unwrap();
        assert_closed(&cut);
        assert_volumes(&cut, 1e-9);
        assert_mirrored(&cut);
        assert_sources(&mesh, &cut, 1e-12);
        assert_eq!((cut.report.uncapped, cut.report.folded), (0, 0));
        let whole = untouched(&mesh, &cut);
        assert_eq!(whole.len() + cut.report.cut_faces, mesh.faces().len());
    }
}

#[test]
fn exactly_through_vertices_and_along_edges() {
    let mesh = torus(40, 20);
    // The plane y = 0 runs along rows of edges, the plane y = x through corners of quads.
    for stroke in [line(&[(-4.0, 0.0), (4.0, 0.0)]), line(&[(-4.0, -4.0), (4.0, 4.0)])] {
        let cut = mesh.cut(&stroke, &down()).unwrap();
        assert_closed(&cut);
        assert_volumes(&cut, 1e-9);
        assert_mirrored(&cut);
        assert_eq!(cut.report.cut_faces, 0, "edges are there already");
        assert_eq!(cut.report.loops, 2);
    }
    // Over walls seen edge on, and through corners.
    for stroke in [
        line(&[(-1.0, 0.5), (2.0, 0.5)]),
        line(&[(-1.0, -1.0), (2.0, 2.0)]),
        line(&[(0.5, -1.0), (0.5, 0.0), (0.5, 2.0)]),
    ] {
        let cut = cube().cut(&stroke, &down()).unwrap();
        assert_closed(&cut);
        assert_volumes(&cut, 1e-12);
        assert_mirrored(&cut);
        assert!((cut.report.volumes[0] - 0.5).abs() < 1e-12);
    }
}

#[test]
fn a_hole_punched_through_leaves_a_tunnel_and_a_plug() {
    for (mesh, stroke) in [(cube(), circle(0.45, 0.5, 0.3, 32)), (prism(), circle(0.1, 0.0, 0.5, 17))] {
        let height = mesh.0.iter().map(|v| v.z).fold(f64::NEG_INFINITY, f64::max)
            - mesh.0.iter().map(|v| v.z).fold(f64::INFINITY, f64::min);
        let cut = mesh.cut(&stroke, &down()).unwrap();
        assert_closed(&cut);
        assert_volumes(&cut, 1e-12);
        assert_mirrored(&cut);
        assert_eq!((cut.report.caps, cut.report.rings), (1, 1));
        let n = stroke.len() - 1;
        let area = 0.5 * (0..n).map(|k| stroke[k].truncate().perp_dot(stroke[k + 1].truncate())).sum::<f64>();
        // The caps' edges cut the corners of the many-sided tunnel.
        assert!((cut.report.volumes[0] / (area * height) - 1.0).abs() < 0.02, "{:?}", cut.report.volumes);
        // The other way round, the inside is still the left.
        let back = stroke.iter().rev().copied().collect::<Vec<_>>();
        let again = mesh.cut(&back, &down()).unwrap();
        assert!((again.report.volumes[0] - cut.report.volumes[0]).abs() < 1e-12);
    }
}

#[test]
fn a_stroke_within_one_face() {
    // Seen from an oblique eye, the circle lies inside one face at the front.
    let eye = DVec3::new(0.5, 0.5, 6.0);
    let stroke: Vec<DVec3> = circle(0.5, 0.5, 0.2, 12).into_iter().map(|p| p + DVec3::Z).collect();
    let cut = cube().cut(&stroke, &CutOptions::new(Sweep::Through(eye))).unwrap();
    assert_closed(&cut);
    assert_volumes(&cut, 1e-12);
    assert_mirrored(&cut);
}

#[test]
fn shells_and_tubes_are_capped_as_rings() {
    let outer = torus(40, 20);
    let mut mesh = Mesh(outer.0.clone(), outer.1.clone(), outer.2.clone());
    // The same torus, thinner and inside out.
    let n = outer.0.len() as u32;
    mesh.0.extend(outer.0.iter().map(|p| {
        let u = p.y.atan2(p.x);
        let middle = 2.0 * DVec3::new(u.cos(), u.sin(), 0.0);
        middle + 0.6 * (*p - middle)
    }));
    for f in 0..outer.2.len() - 1 {
        let face = outer.faces().face(f);
        mesh.1.extend(face.iter().rev().map(|v| v + n));
        mesh.2.push(mesh.1.len() as u32);
    }
    for length in [None, Some(0.25)] {
        let options = CutOptions { edge_length: length, ..down() };
        let cut = mesh.cut(&line(&[(-4.0, 0.13), (4.0, 0.21)]), &options).unwrap();
        assert_eq!((cut.report.loops, cut.report.caps, cut.report.rings), (4, 2, 2));
        assert_closed(&cut);
        assert_mirrored(&cut);
        assert_volumes(&cut, if length.is_none() { 1e-9 } else { 1e-2 });
    }
}

#[test]
fn an_open_mesh_is_cut_and_not_capped_where_the_line_is_open() {
    let n = 12u32;
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let vertices =
        (0..=n).flat_map(|i| (0..=n).map(move |j| DVec3::new(f64::from(i), f64::from(j), 0.0))).collect();
    let quads = (0..n)
        .flat_map(|i| (0..n).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]))
        .collect::<Vec<_>>();
    let sheet = Mesh::quads(vertices, &quads);
    for (stroke, open, closed) in
        [(line(&[(-1.0, 3.3), (13.0, 7.9)]), 1, 0), (circle(5.9, 6.2, 3.3, 30), 0, 1)]
    {
        for length in [None, Some(1.0)] {
            let cut = sheet.cut(&stroke, &CutOptions { edge_length: length, ..down() }).unwrap();
            assert_eq!((cut.report.open_lines, cut.report.loops), (open, closed));
            assert_eq!((cut.report.uncapped, cut.report.caps), (closed, 0));
            // Half the edge length, and half of that, would not close the line either.
            assert!(cut.report.repeated < 2, "{:?}", cut.report);
            for piece in &cut.pieces {
                let check = check_mesh(piece.vertices.len(), &triangles(piece));
                assert_eq!((check.bad_edges, check.bad_vertices), (0, 0), "{check:?}");
                assert!(piece.source_face.iter().all(|f| *f >= 0));
            }
        }
    }
}

#[test]
fn vertices_where_a_piece_would_touch_itself_are_doubled() {
    // Two tents in a row: the plane touches the ridge between them, a saddle, in a vertex.
    let n = 8u32;
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let height = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) - 4.0, f64::from(j) - 4.0);
        x * x - y * y
    };
    let vertices = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| DVec3::new(f64::from(i), f64::from(j), height(i, j))))
        .collect();
    let quads = (0..n)
        .flat_map(|i| (0..n).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]))
        .collect::<Vec<_>>();
    let saddle = Mesh::quads(vertices, &quads);
    // Seen along x, the level z = 0 is a line through the saddle.
    let stroke = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.0, 9.0, 0.0)];
    let cut = saddle.cut(&stroke, &CutOptions::new(Sweep::Along(DVec3::X))).unwrap();
    assert!(cut.report.pinched > 0);
    for piece in &cut.pieces {
        let check = check_mesh(piece.vertices.len(), &triangles(piece));
        assert_eq!((check.bad_edges, check.bad_vertices), (0, 0), "{check:?}");
    }
}

#[test]
fn sides_are_those_of_the_viewer() {
    // Looking down, x to the right, y up; the stroke goes right: its left is what has greater y.
    let stroke = line(&[(-1.0, 0.75), (2.0, 0.75)]);
    for keep in [Keep::Left, Keep::Right] {
        let cut = cube().cut(&stroke, &CutOptions { keep, ..down() }).unwrap();
        assert_eq!(cut.pieces.len(), 1);
        let expected = if keep == Keep::Left { 0.25 } else { 0.75 };
        assert!((cut.report.volumes[0] - expected).abs() < 1e-12);
        assert_closed(&cut);
    }
    let eye = CutOptions { keep: Keep::Left, ..CutOptions::new(Sweep::Through(DVec3::new(0.5, 0.5, 9.0))) };
    let cut = cube().cut(&stroke, &eye).unwrap();
    assert!(cut.pieces[0].vertices.iter().any(|v| v.y == 1.0) && cut.report.volumes[0] < 0.4);
}

#[test]
fn a_gap_is_left_out() {
    for edge_length in [None, Some(0.2)] {
        let options = CutOptions { gap: 0.1, edge_length, ..down() };
        let cut = cube().cut(&line(&[(-1.0, 0.4), (2.0, 0.4)]), &options).unwrap();
        assert_closed(&cut);
        assert!((cut.report.volumes[0] - 0.55).abs() < 1e-9, "{:?}", cut.report.volumes);
        assert!((cut.report.volumes[1] - 0.35).abs() < 1e-9, "{:?}", cut.report.volumes);
    }
    let options = CutOptions { gap: 0.1, ..down() };
    let cut = cube().cut(&circle(0.5, 0.5, 0.3, 64), &options).unwrap();
    assert_closed(&cut);
    assert!(cut.report.volumes[0] < TAU / 2.0 * 0.26 * 0.26 && cut.report.volumes[0] > 3.0 * 0.24 * 0.24);
}

#[test]
fn smooth_caps_bulge_and_still_fit() {
    let mesh = torus(40, 20);
    for smooth in [Smooth::Tangent, Smooth::Curvature] {
        let options = CutOptions { smooth, edge_length: Some(0.25), ..down() };
        let cut = mesh.cut(&line(&[(-4.0, 0.3), (4.0, 0.5)]), &options).unwrap();
        assert_closed(&cut);
        assert_mirrored(&cut);
    }
}

#[test]
fn without_caps_the_pieces_are_open_at_the_cut_alone() {
    let cut =
        torus(40, 20).cut(&line(&[(-4.0, 0.3), (4.0, 0.5)]), &CutOptions { cap: false, ..down() }).unwrap();
    for piece in &cut.pieces {
        let check = check_mesh(piece.vertices.len(), &triangles(piece));
        assert_eq!((check.boundaries, check.bad_edges, check.bad_vertices), (2, 0, 0));
        let edges: usize = piece.cap_loops.iter().map(Vec::len).sum();
        assert_eq!(check.boundary_edges, edges);
    }
}

/// A landscape of whole heights over a flat ground, closed.
fn landscape(heights: &[[i32; 6]; 6]) -> Mesh {
    let n = 5u32;
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let all = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
    let mut vertices: Vec<DVec3> = all
        .map(|(i, j)| DVec3::new(f64::from(i), f64::from(j), f64::from(heights[i as usize][j as usize])))
        .collect();
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let mut faces: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let border: Vec<u32> = (0..n)
        .map(|i| at(i, 0))
        .chain((0..n).map(|j| at(n, j)))
        .chain((0..n).map(|i| at(n - i, n)))
        .chain((0..n).map(|j| at(0, n - j)))
        .collect();
    let ground = vertices.len() as u32;
    let below = border.iter().map(|&v| vertices[v as usize].with_z(-2.0)).collect::<Vec<_>>();
    vertices.extend(below);
    let count = border.len() as u32;
    vertices.push(DVec3::new(2.5, 2.5, -2.0));
    for k in 0..count {
        let next = (k + 1) % count;
        let (a, b, x, y) = (border[k as usize], border[next as usize], ground + k, ground + next);
        faces.extend([[b, a, x], [b, x, y], [y, x, ground + count]]);
    }
    let offsets = (0..=faces.len() as u32).map(|f| 3 * f).collect();
    Mesh(vertices, faces.into_iter().flatten().collect(), offsets)
}

#[test]
fn a_line_that_touches_itself_in_vertices_is_moved_aside_or_refused() {
    // The level 0 runs through saddles, in which more lines meet than can be told apart.
    let mesh = landscape(&[
        [-1, -1, -1, -1, -1, -1],
        [-1, 1, 1, 1, -1, -1],
        [-1, 1, -1, -1, 1, -1],
        [-1, 1, 1, 0, 1, -1],
        [-1, -1, -1, -1, -1, -1],
        [-1, -1, -1, -1, -1, -1],
    ]);
    let stroke = [DVec3::new(0.0, -3.0, 0.0), DVec3::new(0.0, 8.0, 0.0)];
    let along = CutOptions::new(Sweep::Along(DVec3::X));
    for length in [0.3, 1.0] {
        let cut = mesh.cut(&stroke, &CutOptions { edge_length: Some(length), ..along.clone() }).unwrap();
        assert!(cut.report.repeated >= 2, "{:?}", cut.report);
        assert_closed(&cut);
        assert_mirrored(&cut);
        let piece = &cut.pieces[0];
        for &v in piece.cap_loops.iter().flatten() {
            let off = piece.vertices[v as usize].z.abs();
            assert!(off > 0.0 && off < 0.03 * length, "{off}");
        }
    }
    // Exactly where it was drawn there is no cut with caps, and none is made half.
    let refused = mesh.cut(&stroke, &along);
    assert_eq!(refused.err().map_or("none", |e| e.kind()), "cut_failed");
}

#[test]
fn what_cannot_be_cut_is_refused_by_name() {
    let kind = |stroke: &[DVec3], options: &CutOptions| {
        cube().cut(stroke, options).err().map_or("none", |e| e.kind())
    };
    assert_eq!(kind(&line(&[(-1.0, 1.5), (2.0, 1.5)]), &down()), "stroke_misses");
    assert_eq!(kind(&circle(5.0, 5.0, 1.0, 12), &down()), "stroke_misses");
    // All around.
    assert_eq!(kind(&circle(0.5, 0.5, 3.0, 12), &down()), "stroke_misses");
    assert_eq!(kind(&[DVec3::ZERO, DVec3::Z], &down()), "stroke_too_short");
    assert_eq!(kind(&[], &down()), "stroke_too_short");
    let crossed = line(&[(-1.0, 0.2), (2.0, 0.8), (2.0, 0.2), (-1.0, 0.8)]);
    assert_eq!(kind(&crossed, &down()), "self_intersecting");
    let hook = line(&[(-1.0, 0.5), (0.5, 0.5), (0.5, 0.8), (0.3, 0.8), (0.3, 0.6)]);
    assert_eq!(kind(&hook, &down()), "self_intersecting");
    let inside = CutOptions::new(Sweep::Through(DVec3::splat(0.5)));
    assert_eq!(kind(&line(&[(-1.0, 0.2), (2.0, 0.8)]), &inside), "behind_eye");
    let across = line(&[(-1.0, 0.3), (2.0, 0.3)]);
    assert_eq!(kind(&across, &CutOptions::new(Sweep::Along(DVec3::ZERO))), "invalid_option");
    assert_eq!(kind(&across, &CutOptions { gap: -1.0, ..down() }), "invalid_option");
    assert_eq!(kind(&across, &CutOptions { edge_length: Some(0.0), ..down() }), "invalid_option");
    assert_eq!(kind(&[DVec3::ZERO, DVec3::NAN], &down()), "not_finite");
    let bad = |corners: Vec<u32>, offsets: Vec<u32>| {
        Mesh(cube().0, corners, offsets).cut(&across, &down()).err().map_or("none", |e| e.kind())
    };
    assert_eq!(bad(vec![0, 1, 9], vec![0, 3]), "index_out_of_range");
    assert_eq!(bad(vec![0, 1], vec![0, 2]), "invalid_face");
    assert_eq!(bad(vec![0, 1, 1], vec![0, 3]), "invalid_face");
    assert_eq!(bad(vec![0, 1, 2], vec![1, 3]), "invalid_face");
    assert_eq!(bad(vec![], vec![0]), "stroke_misses");
}

#[test]
fn equal_input_gives_equal_output_for_any_number_of_threads() {
    let stroke = circle(0.3, 0.1, 1.9, 40);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| torus(40, 20).cut(&stroke, &CutOptions { edge_length: Some(0.2), ..down() }).unwrap())
    };
    assert_eq!(run(1).pieces, run(3).pieces);
}

#[test]
fn progress_rises_and_false_stops() {
    let seen = std::sync::Mutex::new(vec![]);
    let note = |f: f64| {
        seen.lock().unwrap().push(f);
        true
    };
    let mesh = torus(40, 20);
    let stroke = line(&[(-4.0, 0.3), (4.0, 0.5)]);
    // With more threads it is asked as often as the time they take allows.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let run = |progress: &(dyn Fn(f64) -> bool + Sync)| {
        pool.install(|| cut(&mesh.0, mesh.faces(), &stroke, &down(), Progress::new(progress)))
    };
    run(&note).unwrap();
    let seen = seen.into_inner().unwrap();
    assert!(seen.windows(2).all(|w| w[0] <= w[1]), "{seen:?}");
    assert_eq!(seen.last(), Some(&1.0));
    for stop in 0..seen.len() {
        let count = std::sync::atomic::AtomicUsize::new(0);
        let until = |_: f64| count.fetch_add(1, std::sync::atomic::Ordering::Relaxed) < stop;
        assert_eq!(run(&until).err().map_or("none", |e| e.kind()), "cancelled");
    }
}
