//! The new edges along the line of a cut.

use glam::DVec3;
use gridmesh::cut::{CutOptions, Sweep};

use crate::models::*;

#[test]
fn an_edge_length_makes_the_rim_even() {
    let mesh = torus(60, 30);
    for stroke in [line(&[(-4.0, 0.3), (4.0, 0.9)]), circle(2.0, 0.1, 0.5, 60)] {
        let length = 0.17;
        let cut = mesh.cut(&stroke, &CutOptions { edge_length: Some(length), ..down() }).unwrap();
        assert_closed(&cut);
        assert_mirrored(&cut);
        assert_volumes(&cut, 0.005);
        assert!(cut.report.defect <= 0.05 * length, "{}", cut.report.defect);
        assert!(cut.report.cap_radius_ratio > 0.9, "{}", cut.report.cap_radius_ratio);
        let piece = &cut.pieces[0];
        for cap_loop in &piece.cap_loops {
            let n = cap_loop.len();
            let at = |k: usize| piece.vertices[cap_loop[k % n] as usize];
            let mean = (0..n).map(|k| at(k).distance(at(k + 1))).sum::<f64>() / n as f64;
            assert!((mean / length - 1.0).abs() < 0.25, "{mean}");
        }
        let exact = mesh.cut(&stroke, &down()).unwrap();
        assert!(cut.report.rim_min_angle > exact.report.rim_min_angle);
        // What is not near the cut stays.
        assert!(untouched(&mesh, &cut).len() > mesh.faces().len() / 2);
    }
}

#[test]
fn ten_times_across() {
    let mut points = vec![];
    for k in 0..10 {
        let y = -2.4 + 0.51 * f64::from(k);
        let x = if k % 2 == 0 { 4.0 } else { -4.0 };
        points.extend([(-x, y), (x, y)]);
    }
    for edge_length in [None, Some(0.2)] {
        let cut = torus(40, 20).cut(&line(&points), &CutOptions { edge_length, ..down() }).unwrap();
        assert_closed(&cut);
        assert_mirrored(&cut);
        assert!(cut.report.caps >= 10);
        assert_volumes(&cut, if edge_length.is_none() { 1e-9 } else { 0.02 });
    }
}

#[test]
fn the_rim_has_no_thin_triangles_and_stays_where_it_was_drawn() {
    let mesh = torus(60, 30);
    let length = 0.17;
    for (slope, shift) in [(0.0, 0.31), (0.15, 0.9), (0.4, -0.2), (-0.7, 1.7), (1.3, 0.05)] {
        let y = |x: f64| slope * x + shift;
        let stroke = line(&[(-5.0, y(-5.0)), (5.0, y(5.0))]);
        let cut = mesh.cut(&stroke, &CutOptions { edge_length: Some(length), ..down() }).unwrap();
        assert_closed(&cut);
        assert_mirrored(&cut);
        assert!(cut.report.rim_min_angle.to_degrees() > 8.0, "{}", cut.report.rim_min_angle.to_degrees());
        assert!(cut.report.defect <= 0.05 * length);
        let piece = &cut.pieces[0];
        let rim = piece.cap_loops.iter().flatten().map(|&v| piece.vertices[v as usize]);
        let mut off: Vec<f64> = rim.map(|p| (p.y - y(p.x)).abs() / (1.0 + slope * slope).sqrt()).collect();
        off.sort_by(f64::total_cmp);
        // Drawn through a vertex beside it here and there, else where it was drawn.
        assert!(off[off.len() - 1] <= 0.3 * length, "{off:?}");
        assert!(off[off.len() * 3 / 4] <= 0.01 * length, "{off:?}");
    }
}

#[test]
fn small_rims_stay_where_they_were_drawn_too() {
    // A corner of the cube is near the line, measured in edges, but not in diameters of what is cut off there.
    let (along, across) = (DVec3::new(-0.857, 0.514, 0.0), DVec3::new(0.514, 0.857, 0.0));
    let eye = DVec3::new(0.5, 0.5, -2.5);
    let mut made = 0;
    for n in 5..30 {
        let stroke: Vec<DVec3> = (0..n)
            .map(|k| {
                let side = if k % 2 == 0 { 0.137 } else { -0.137 };
                let far = 0.778 * (2.0 * f64::from(k) / f64::from(n - 1) - 1.0);
                DVec3::splat(0.5) + far * along + side * across
            })
            .collect();
        let options = CutOptions { edge_length: Some(0.075), ..CutOptions::new(Sweep::Through(eye)) };
        let Ok(cut) = cube().cut(&stroke, &options) else { continue };
        made += 1;
        assert_closed(&cut);
        assert_mirrored(&cut);
        let off = |p: DVec3| {
            let seen = eye + (p - eye) * ((0.5 - eye.z) / (p.z - eye.z));
            let near = stroke.windows(2).enumerate().map(|(k, e)| {
                let along = e[1] - e[0];
                // The ends go straight on.
                let low = if k == 0 { -9.0 } else { 0.0 };
                let high = if k + 2 == stroke.len() { 9.0 } else { 1.0 };
                let t = ((seen - e[0]).dot(along) / along.length_squared()).clamp(low, high);
                seen.distance(e[0] + t * along)
            });
            near.fold(f64::INFINITY, f64::min)
        };
        let piece = &cut.pieces[0];
        for rim in &piece.cap_loops {
            let rim: Vec<DVec3> = rim.iter().map(|&v| piece.vertices[v as usize]).collect();
            let (low, high) = rim.iter().fold((rim[0], rim[0]), |(low, high), &p| (low.min(p), high.max(p)));
            let most = rim.iter().map(|&p| off(p)).fold(0.0, f64::max);
            assert!(most <= 0.02 * low.distance(high), "{n}: {most}");
        }
    }
    assert!(made > 12, "{made}");
}

#[test]
fn exact_cuts_of_fine_models_have_caps_no_finer_than_they_are() {
    // Rims with hundreds of edges of every length.
    let mesh = torus(300, 300);
    let waves = |k: i32| (f64::from(k) / 20.0, 0.5 + 0.3 * (f64::from(k) / 10.0).sin());
    let wave = line(&(-80..=80).map(waves).collect::<Vec<_>>());
    for stroke in [line(&[(-4.0, 0.31), (4.0, 0.93)]), wave] {
        let cut = mesh.cut(&stroke, &down()).unwrap();
        assert_closed(&cut);
        assert_mirrored(&cut);
        assert_volumes(&cut, 1e-9);
        let report = &cut.report;
        assert_eq!((report.folded, report.repeated, report.defect), (0, 0, 0.0));
        let rim: usize = cut.pieces[0].cap_loops.iter().map(Vec::len).sum();
        assert!(rim > 600, "{rim}");
        assert!(report.cap_radius_ratio > 0.9, "{}", report.cap_radius_ratio);
        assert!(10 * report.cap_irregular < report.cap_vertices, "{report:?}");
        // As many as triangles of the model's size, or a few times so many where its quads are narrow.
        assert!(report.cap_triangles < mesh.faces().len(), "{}", report.cap_triangles);
    }
}
