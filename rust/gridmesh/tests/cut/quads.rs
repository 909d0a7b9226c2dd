//! Caps of quads.

use std::f64::consts::TAU;

use glam::DVec3;
use gridmesh::cut::{CutOptions, Keep, Mirror, Piece, Polygons, Sweep};
use gridmesh::fill::Smooth;
use gridmesh::options::CellShape;

use crate::models::*;

fn options(edge_length: Option<f64>, smooth: Smooth) -> CutOptions {
    let sweep = Sweep::Along(DVec3::new(0.0, 0.0, -1.0));
    CutOptions { edge_length, smooth, cells: CellShape::Quad, ..CutOptions::new(sweep) }
}

/// Corners of the cap's faces.
fn caps(piece: &Piece) -> Vec<&[u32]> {
    let faces = Polygons { corners: &piece.corners, offsets: &piece.offsets };
    faces.iter().zip(&piece.source_face).filter(|(_, from)| **from < 0).map(|(face, _)| face).collect()
}

#[test]
fn a_cap_is_all_quads_and_has_one_triangle_if_its_line_is_odd() {
    let lines = [vec![DVec3::new(-3.0, 0.1, 0.0), DVec3::new(3.0, -0.2, 0.0)], circle(0.1, 0.2, 0.4, 40)];
    for (stroke, smooth) in lines.iter().flat_map(|s| [(s, Smooth::Flat), (s, Smooth::Tangent)]) {
        for length in [0.11, 0.13, 0.17, 0.2] {
            let cut = ball(16).cut(stroke, &options(Some(length), smooth)).unwrap();
            let [left, right] = &cut.pieces[..] else { panic!() };
            assert_eq!([open_edge(left), open_edge(right)], [None; 2]);
            let edges = left.cap_loops.iter().map(Vec::len).sum::<usize>();
            assert_eq!(cut.report.cap_triangles, edges % 2, "{length} {smooth:?} {:?}", cut.report);
            assert_eq!(caps(left).len(), cut.report.cap_triangles + cut.report.cap_quads);
            assert!(cut.report.cap_min_angle.to_degrees() > 30.0, "{:?}", cut.report);
            let sum: f64 = cut.report.volumes.iter().sum();
            assert!((sum - cut.report.volume).abs() < 0.02 * cut.report.volume);
        }
    }
}

#[test]
fn both_pieces_have_the_same_caps_turned_around() {
    let stroke = [DVec3::new(-3.0, 0.1, 0.0), DVec3::new(3.0, -0.2, 0.0)];
    for smooth in [Smooth::Flat, Smooth::Curvature] {
        let cut = ball(14).cut(&stroke, &options(Some(0.15), smooth)).unwrap();
        let [left, right] = &cut.pieces[..] else { panic!() };
        let at = |piece: &Piece, face: &[u32]| {
            let bits = |v: &u32| piece.vertices[*v as usize].to_array().map(f64::to_bits);
            face.iter().map(bits).collect::<Vec<_>>()
        };
        for (l, r) in caps(left).into_iter().zip(caps(right)) {
            let mut turned = at(right, r);
            turned[1..].reverse();
            assert_eq!(at(left, l), turned);
        }
    }
}

#[test]
fn a_ring_around_a_hole_in_its_middle_is_a_tube_with_hardly_a_pole() {
    let ring = torus(40, 24);
    let turned = Mesh(ring.0.iter().map(|p| DVec3::new(p.x, p.z, p.y)).collect(), ring.1, ring.2);
    for length in [0.15, 0.2, 0.25, 0.3] {
        let stroke = [DVec3::new(-5.0, 0.1, 0.0), DVec3::new(5.0, 0.3, 0.0)];
        let quads = turned.cut(&stroke, &options(Some(length), Smooth::Flat)).unwrap().report;
        assert_eq!(quads.rings, 1);
        assert!(quads.cap_irregular <= 8, "{quads:?}");
        let triangles = CutOptions { cells: CellShape::Triangle, ..options(Some(length), Smooth::Flat) };
        let triangles = turned.cut(&stroke, &triangles).unwrap().report;
        assert!(100 * triangles.cap_irregular <= triangles.cap_vertices, "{triangles:?}");
    }
}

#[test]
fn rings_are_all_quads_where_their_edges_are_even() {
    let mut seen = 0;
    for n in 12..24 {
        let ring = torus(n, 11);
        let stroke = [DVec3::new(-5.0, 0.03, 0.0), DVec3::new(5.0, 0.05, 0.0)];
        // Flat on its side, cut along its equator: a ring as the cap.
        let turned = Mesh(ring.0.iter().map(|p| DVec3::new(p.x, p.z, p.y)).collect(), ring.1, ring.2);
        for length in [0.15, 0.2, 0.25] {
            let cut = turned.cut(&stroke, &options(Some(length), Smooth::Flat)).unwrap();
            assert_eq!(cut.report.rings, 1);
            assert_eq!(cut.pieces.iter().find_map(open_edge), None);
            let edges = cut.pieces[0].cap_loops.iter().map(Vec::len).sum::<usize>();
            assert_eq!(cut.report.cap_triangles, edges % 2);
            seen += 1 - edges % 2;
        }
    }
    assert!(seen > 5);
}

#[test]
fn what_is_kept_alone_has_the_cap_of_both() {
    let stroke = (0..30)
        .map(|k| DVec3::new(-2.0 + 4.0 * f64::from(k) / 29.0, 0.3 * (TAU * f64::from(k) / 15.0).sin(), 0.0))
        .collect::<Vec<_>>();
    let both = ball(12).cut(&stroke, &options(Some(0.2), Smooth::Flat)).unwrap();
    let left = CutOptions { keep: Keep::Left, ..options(Some(0.2), Smooth::Flat) };
    let left = ball(12).cut(&stroke, &left).unwrap();
    assert_eq!(left.pieces[0].corners, both.pieces[0].corners);
    assert!(left.report.cap_quads > 20);
}

/// A ball with small balls cut out of it at these places, as (x, y, radius).
fn hollow(cavities: &[[f64; 3]]) -> Mesh {
    let mut whole = ball(16);
    for &[x, y, radius] in cavities {
        let small = ball(8);
        let n = whole.0.len() as u32;
        whole.0.extend(small.0.iter().map(|p| radius * *p + DVec3::new(x, 0.0, y)));
        for face in small.faces().iter() {
            whole.1.extend(face.iter().rev().map(|v| v + n));
            whole.2.push(whole.1.len() as u32);
        }
    }
    whole
}

#[test]
fn caps_with_several_holes_or_one_aside_have_one_triangle_at_most() {
    let stroke = [DVec3::new(-3.0, 0.01, 0.0), DVec3::new(3.0, 0.02, 0.0)];
    let aside = [0.55, 0.1, 0.2];
    for cavities in
        [vec![aside], vec![aside, [-0.4, 0.0, 0.3]], vec![aside, [-0.4, 0.3, 0.25], [-0.3, -0.4, 0.2]]]
    {
        for length in [0.06, 0.08, 0.1, 0.12] {
            let cut = hollow(&cavities).cut(&stroke, &options(Some(length), Smooth::Flat)).unwrap();
            assert_eq!((cut.report.caps, cut.report.rings), (1, 1));
            assert_eq!(cut.pieces.iter().find_map(open_edge), None);
            let edges = cut.pieces[0].cap_loops.iter().map(Vec::len).sum::<usize>();
            assert_eq!(cut.report.cap_triangles, edges % 2, "{cavities:?} {length}");
        }
    }
}

#[test]
fn a_ring_closed_along_a_plane_of_symmetry_has_sources_in_the_mesh() {
    let whole = hollow(&[]);
    let half = CutOptions { keep: Keep::Right, cap: false, ..options(None, Smooth::Flat) };
    let across = [DVec3::new(0.0, -3.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
    let half = whole.cut(&across, &half).unwrap().pieces.remove(0);
    let n = half.vertices.len() as u32;
    let small = ball(8);
    let mut mesh = Mesh(half.vertices, half.corners, half.offsets);
    let side = mesh.0.iter().map(|p| p.x).sum::<f64>().signum();
    mesh.0.extend(small.0.iter().map(|p| 0.15 * *p + DVec3::new(0.4 * side, 0.0, 0.0)));
    for face in small.faces().iter() {
        mesh.1.extend(face.iter().rev().map(|v| v + n));
        mesh.2.push(mesh.1.len() as u32);
    }
    let mirrors = vec![Mirror { point: DVec3::ZERO, normal: DVec3::X, within: 1e-9 }];
    let stroke = [DVec3::new(-3.0, 0.01, 0.0), DVec3::new(3.0, 0.02, 0.0)];
    for cells in [CellShape::Triangle, CellShape::Quad] {
        let options = CutOptions { cells, mirrors: mirrors.clone(), ..options(Some(0.08), Smooth::Flat) };
        let cut = mesh.cut(&stroke, &options).unwrap();
        assert_eq!(cut.report.rings, 1);
        for piece in &cut.pieces {
            let sources = piece.source_vertices.iter().flatten();
            assert!(sources.max().is_some_and(|&v| (v as usize) < mesh.0.len()), "{cells:?}");
        }
    }
}

#[test]
fn a_gap_between_caps_of_quads_leaves_their_ratio_at_one() {
    let stroke = [DVec3::new(-3.0, 0.1, 0.0), DVec3::new(3.0, 0.1, 0.0)];
    let options = CutOptions { gap: 0.2, ..options(Some(0.2), Smooth::Flat) };
    let report = ball(16).cut(&stroke, &options).unwrap().report;
    assert!(report.cap_quads > 0);
    assert!(report.cap_triangles > 0 || report.cap_radius_ratio == 1.0, "{report:?}");
}
