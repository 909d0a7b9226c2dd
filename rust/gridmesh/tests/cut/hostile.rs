//! Cuts that once went wrong: thin plates, tunnels in perspective, bulging caps, jitter, strokes that are too short.

use std::sync::Mutex;

use glam::DVec3;
use gridmesh::cut::{CutOptions, Keep, Mirror, Sweep, cut, cut_reach};
use gridmesh::fill::Smooth;
use gridmesh::geometry::metrics::check_mesh;
use gridmesh::progress::Progress;

use crate::models::*;

fn plate(height: f64) -> Mesh {
    let mut mesh = cube();
    mesh.0.iter_mut().for_each(|p| p.z *= height);
    mesh
}

#[test]
fn a_plate_thinner_than_the_edge_length_is_split_in_its_thickness() {
    for (height, length) in [(0.01, 0.05), (0.001, 0.05), (1e-6, 0.05), (0.001, 0.02)] {
        let mesh = plate(height);
        let stroke = [DVec3::new(0.5, -1.0, 0.37 * height), DVec3::new(0.5, 2.0, 0.37 * height)];
        let reports = Mutex::new(0usize);
        let count = |_: f64| reports.lock().map(|mut n| *n += 1).is_ok();
        let options = CutOptions { edge_length: Some(length), ..CutOptions::new(Sweep::Along(DVec3::X)) };
        let done = cut(&mesh.0, mesh.faces(), &stroke, &options, Progress::new(&count)).unwrap();
        assert_closed(&done);
        assert_mirrored(&done);
        assert_volumes(&done, 0.1);
        // Narrow as the wall is, but not narrower without measure.
        let room = 0.37 * height / length;
        assert!(
            done.report.rim_min_angle > 0.003 * room,
            "{height} {length} {}",
            done.report.rim_min_angle / room
        );
        assert!(done.report.defect <= 0.06 * height);
        let faces: usize = done.pieces.iter().map(|p| p.source_face.len()).sum();
        assert!((faces as f64) < 40.0 / (length * length), "{faces}");
        assert!(reports.into_inner().unwrap() > 20);
    }
}

#[test]
fn a_plate_thinner_than_the_edge_length_keeps_its_thickness() {
    for height in [0.1, 0.001, 1e-6] {
        let stroke = line(&[(0.3, -1.0), (0.5, 2.0)]);
        let done = plate(height).cut(&stroke, &CutOptions { edge_length: Some(0.07), ..down() }).unwrap();
        assert_closed(&done);
        assert_mirrored(&done);
        assert_volumes(&done, 0.01);
    }
}

#[test]
fn the_faces_beside_a_cut_grow_with_the_distance_from_it() {
    // With edges half as long, faces all over the sides would be four times as many.
    for height in [1.0, 0.001] {
        let stroke = [DVec3::new(0.5, -1.0, 0.37 * height), DVec3::new(0.5, 2.0, 0.45 * height)];
        let beside = |length: f64| {
            let options = CutOptions { edge_length: Some(length), ..CutOptions::new(Sweep::Along(DVec3::X)) };
            let done = plate(height).cut(&stroke, &options).unwrap();
            let all: usize = done.pieces.iter().map(|p| p.offsets.len() - 1).sum();
            all - 2 * done.report.cap_triangles
        };
        let [coarse, fine] = [0.04, 0.02].map(beside);
        assert!(fine < 3 * coarse, "{height}: {coarse} and {fine}");
    }
}

#[test]
fn a_cut_is_cancelled_wherever_it_is() {
    let (mesh, height) = (plate(0.001), 0.001);
    let stroke = [DVec3::new(0.5, -1.0, 0.37 * height), DVec3::new(0.5, 2.0, 0.37 * height)];
    let options = CutOptions { edge_length: Some(0.05), ..CutOptions::new(Sweep::Along(DVec3::X)) };
    for most in [1, 5, 50, 200] {
        let left = Mutex::new(most);
        let stop = |_: f64| {
            let Ok(mut left) = left.lock() else { return false };
            *left -= 1;
            *left > 0
        };
        let refused = cut(&mesh.0, mesh.faces(), &stroke, &options, Progress::new(&stop));
        assert_eq!(refused.err().map_or("none", |e| e.kind()), "cancelled");
    }
}

#[test]
fn progress_never_runs_backwards() {
    for (smooth, gap) in [(Smooth::Flat, 0.0), (Smooth::Tangent, 0.0), (Smooth::Flat, 0.1)] {
        let seen = Mutex::new(vec![]);
        let note = |f: f64| seen.lock().map(|mut seen| seen.push(f)).is_ok();
        let mesh = torus(40, 20);
        let options = CutOptions { smooth, gap, edge_length: Some(0.2), ..down() };
        cut(&mesh.0, mesh.faces(), &line(&[(-4.0, 0.3), (4.0, 0.5)]), &options, Progress::new(&note))
            .unwrap();
        let seen = seen.into_inner().unwrap();
        assert!(seen.len() > 10 && seen.windows(2).all(|w| w[0] <= w[1]), "{seen:?}");
    }
}

#[test]
fn holes_are_punched_in_perspective() {
    for (mesh, r) in [(ball(24), 0.5), (ball(8), 0.5), (cube(), 0.3)] {
        for n in [12, 40] {
            for k in (0..15).step_by(if mesh.0.len() > 500 { 1 } else { 5 }) {
                for edge_length in [None, Some(0.1), Some(0.3)] {
                    let shift = 0.03 * f64::from(k);
                    let middle = if r < 0.4 { DVec3::new(0.5, 0.5, 1.0) } else { DVec3::ZERO };
                    let by = middle + 0.3 * DVec3::new(shift, shift / 3.0, 0.0) / (1.0 - r);
                    let stroke: Vec<DVec3> = circle(0.0, 0.0, r, n).into_iter().map(|p| p + by).collect();
                    let eye = DVec3::new(shift, 0.0, 5.0);
                    let options = CutOptions { edge_length, ..CutOptions::new(Sweep::Through(eye)) };
                    let done = mesh.cut(&stroke, &options).unwrap();
                    assert_closed(&done);
                    assert_mirrored(&done);
                    assert_eq!(done.report.loops, 2);
                }
            }
        }
    }
}

#[test]
fn small_holes_are_punched_in_perspective() {
    // Angles between rays came from their cosines: of a hundredth of a degree only a few digits are left.
    let mesh = ball(24);
    for (eye, r) in [(4.0, 0.01), (4.0, 0.001), (40.0, 0.01), (40.0, 0.001)] {
        let eye = DVec3::new(0.1, 0.05, eye);
        for edge_length in [None, Some(0.5), Some(0.05)] {
            let options = CutOptions { edge_length, ..CutOptions::new(Sweep::Through(eye)) };
            let done = mesh.cut(&circle(0.0, 0.0, r, 40), &options).unwrap();
            assert_closed(&done);
            assert_eq!(done.report.loops, 2, "eye {eye} radius {r} {edge_length:?}");
        }
    }
}

#[test]
fn a_face_that_lies_in_the_cut_is_no_piece() {
    for y in [0.0, 1.0] {
        let along = cube().cut(&line(&[(-1.0, y), (2.0, y)]), &down());
        let kind = along.err().map_or("none", |error| error.kind());
        assert!(["slice_too_thin", "stroke_misses"].contains(&kind), "{y} {kind}");
        let beside = line(&[(-1.0, y), (2.0, y + 0.2 - 0.4 * y)]);
        assert_closed(&cube().cut(&beside, &down()).unwrap());
    }
}

#[test]
fn directions_are_of_any_length() {
    // The squares of these vanish or overflow; the second was taken for that of z.
    let stroke: Vec<DVec3> = vec![DVec3::new(0.5, -1.0, 0.4), DVec3::new(0.5, 2.0, 0.4)];
    let pieces = |length: f64| {
        let done = cube().cut(&stroke, &CutOptions::new(Sweep::Along(length * DVec3::X))).unwrap();
        assert_closed(&done);
        let above = |p: &DVec3| p.z > 0.4 - 1e-9;
        assert!(done.pieces.iter().any(|piece| piece.vertices.iter().all(above)), "{length}");
    };
    for length in [1e-300, 1e-200, 1e-100, 1.0, 1e100, 1e200, 1e300] {
        pieces(length);
    }
}

#[test]
fn bulging_caps_stay_inside_the_piece() {
    for smooth in [Smooth::Tangent, Smooth::Curvature] {
        for y in [0.5, 0.9, 0.98] {
            // To the right of it is a slab, into which the cap of the left bulges.
            let stroke = line(&[(2.0, y), (-1.0, y)]);
            let options = CutOptions { smooth, edge_length: Some(0.25), ..down() };
            let done = cube().cut(&stroke, &options).unwrap();
            assert_closed(&done);
            assert_mirrored(&done);
            assert_volumes(&done, 1e-6);
            assert_eq!(done.report.reduced_caps > 0, y > 0.8, "{y} {:?}", done.report.volumes);
            // Alone it may bulge as it likes.
            let alone = cube().cut(&stroke, &CutOptions { keep: Keep::Left, ..options }).unwrap();
            assert_eq!(alone.report.reduced_caps, 0);
        }
    }
}

#[test]
fn jitter_of_the_pen_does_not_defeat_the_edge_length() {
    let mesh = ball(12);
    let triangles = |jitter: f64| {
        let at = |k: u32| {
            let x = -1.5 + 3.0 * f64::from(k) / 4999.0;
            let noise = jitter * (f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5);
            DVec3::new(x, 0.3 * (5.0 * x).sin() + noise, 0.0)
        };
        let stroke = (0..5000).map(at).collect::<Vec<_>>();
        let done = mesh.cut(&stroke, &CutOptions { edge_length: Some(0.2), ..down() }).unwrap();
        assert_closed(&done);
        done.report.cap_triangles
    };
    let smooth = triangles(0.0);
    assert!((100..400).contains(&smooth), "{smooth}");
    assert!(triangles(4e-4) < 2 * smooth, "{smooth} {}", triangles(4e-4));
}

/// A body with two arms: a wide box and two narrow ones to its sides, all one mesh along x.
fn figure() -> Mesh {
    let mut mesh = cube();
    let outline = [
        (-1.0, -1.0),
        (1.0, -1.0),
        (1.0, 0.0),
        (3.0, 0.0),
        (3.0, 0.5),
        (1.0, 0.5),
        (1.0, 1.0),
        (-1.0, 1.0),
        (-1.0, 0.5),
        (-3.0, 0.5),
        (-3.0, 0.0),
        (-1.0, 0.0),
    ];
    let n = outline.len() as u32;
    mesh.0 = [-0.3, 0.3].iter().flat_map(|&z| outline.map(|(x, y)| DVec3::new(x, y, z))).collect();
    mesh.1 = (0..n).flat_map(|k| [k, (k + 1) % n, (k + 1) % n + n, k + n]).collect();
    mesh.1.extend((0..n).rev());
    mesh.1.extend(n..2 * n);
    mesh.2 = (0..=n).map(|k| 4 * k).chain([5 * n, 6 * n]).collect();
    mesh
}

#[test]
fn a_short_stroke_cuts_only_what_it_crosses() {
    let mesh = figure();
    // Across the right arm; continued it would cut the left one, too, or the body.
    for stroke in
        [line(&[(2.0, -0.2), (2.0, 0.7)]), line(&[(2.0, 0.1), (2.1, 0.3)]), line(&[(2.6, 0.2), (2.4, 0.21)])]
    {
        for edge_length in [None, Some(0.2)] {
            let options = CutOptions { extend_ends: false, edge_length, ..down() };
            let done = mesh.cut(&stroke, &options);
            let all = mesh.cut(&stroke, &CutOptions { extend_ends: true, ..options.clone() }).unwrap();
            if stroke[0].x == 2.6 {
                // Along the arm: what it crosses is one with the body and the other arm.
                assert!(done.is_ok_and(|done| done.report.volumes.len() == 2));
                continue;
            }
            let done = done.unwrap();
            assert_closed(&done);
            assert_mirrored(&done);
            assert_volumes(&done, 1e-2);
            assert_eq!((done.report.loops, done.report.caps), (1, 1));
            let least = done.report.volumes.iter().copied().fold(f64::INFINITY, f64::min);
            assert!((0.2..0.4).contains(&least), "{least}");
            assert!(all.report.loops >= done.report.loops);
        }
    }
    // Through the right arm only, where continued it runs through the body as well.
    let stroke = line(&[(1.5, 0.6), (2.4, -0.1)]);
    let all = mesh.cut(&stroke, &down()).unwrap();
    let done = mesh.cut(&stroke, &CutOptions { extend_ends: false, ..down() }).unwrap();
    assert_eq!((all.report.loops, done.report.loops), (2, 1));
    let tilted = line(&[(1.2, 0.6), (1.4, -0.1)]);
    let ends = cut_reach(&mesh.0, mesh.faces(), &tilted, Sweep::Along(-DVec3::Z), Progress::NONE).unwrap();
    assert_eq!(ends, [tilted[0], tilted[1]]);
    let inside = line(&[(2.0, 0.1), (2.0, 0.3)]);
    let ends = cut_reach(&mesh.0, mesh.faces(), &inside, Sweep::Along(-DVec3::Z), Progress::NONE).unwrap();
    assert!(ends[0].y.abs() < 1e-12 && (ends[1].y - 0.5).abs() < 1e-12, "{ends:?}");
    // Both arms and the body on one line; the stroke is across the right arm's end alone.
    let beside = line(&[(2.5, 0.25), (3.5, 0.25)]);
    let one = mesh.cut(&beside, &CutOptions { extend_ends: false, ..down() }).unwrap();
    assert_closed(&one);
    let none = mesh.cut(&line(&[(3.5, 0.2), (4.0, 0.2)]), &CutOptions { extend_ends: false, ..down() });
    assert_eq!(none.err().map_or("none", |e| e.kind()), "stroke_misses");
}

#[test]
fn a_ring_that_is_crossed_once_still_hangs_together() {
    let mesh = torus(40, 20);
    let short = line(&[(0.9, 0.1), (3.1, 0.13)]);
    let refused = mesh.cut(&short, &CutOptions { extend_ends: false, ..down() });
    assert_eq!(refused.err().map_or("none", |e| e.kind()), "still_joined");
    let long = line(&[(-3.1, 0.1), (3.1, 0.13)]);
    let done = mesh.cut(&long, &CutOptions { extend_ends: false, ..down() }).unwrap();
    assert_eq!(done, {
        let mut all = mesh.cut(&long, &down()).unwrap();
        all.report.seconds = done.report.seconds.clone();
        all
    });
}

#[test]
fn parts_that_are_not_crossed_stay_whole() {
    // Three balls in a row along the line.
    let mut mesh = ball(10);
    let (n, own) = (mesh.0.len() as u32, Mesh(mesh.0.clone(), mesh.1.clone(), mesh.2.clone()));
    for k in 1..3u32 {
        let from = mesh.1.len() as u32;
        mesh.0.extend(own.0.iter().map(|p| *p + 3.0 * f64::from(k) * DVec3::X));
        mesh.1.extend(own.1.iter().map(|v| v + k * n));
        mesh.2.extend(own.2[1..].iter().map(|o| o + from));
    }
    let stroke = line(&[(1.9, 0.3), (4.1, 0.33)]);
    for (keep, gap) in [(Keep::Both, 0.0), (Keep::Left, 0.0), (Keep::Right, 0.0), (Keep::Both, 0.05)] {
        let options = CutOptions { keep, gap, extend_ends: false, ..down() };
        let done = mesh.cut(&stroke, &options).unwrap();
        assert_closed(&done);
        assert!(done.report.cut_faces > 0);
        let faces = mesh.2.len() as i32 - 1;
        let outer = |piece: &gridmesh::cut::Piece| {
            piece.source_face.iter().filter(|&&f| (0..faces / 3).contains(&f) || f >= 2 * faces / 3).count()
                as i32
        };
        let counts = done.pieces.iter().map(outer).collect::<Vec<_>>();
        assert_eq!(counts.iter().sum::<i32>(), 2 * faces / 3, "{keep:?} {counts:?}");
        assert!(counts.iter().all(|&c| c == 0 || c == 2 * faces / 3), "{keep:?} {counts:?}");
    }
}

#[test]
fn half_a_mesh_is_capped_up_to_its_plane_of_symmetry() {
    // A ball without its half at x < 0, open there.
    let whole = ball(16);
    let mirror = Mirror { point: DVec3::ZERO, normal: DVec3::X, within: 1e-9 };
    let faces = whole.faces();
    let mut half = Mesh(whole.0.clone(), vec![], vec![0]);
    half.0.iter_mut().for_each(|p| p.x = if p.x.abs() < 1e-9 { 0.0 } else { p.x });
    for f in 0..faces.len() {
        if faces.face(f).iter().all(|&v| half.0[v as usize].x >= 0.0) {
            half.1.extend(faces.face(f));
            half.2.push(half.1.len() as u32);
        }
    }
    for stroke in [line(&[(-2.0, 0.3), (2.0, 0.4)]), line(&[(-2.0, -0.2), (0.4, 0.1), (2.0, 0.5)])] {
        for edge_length in [None, Some(0.2)] {
            for sweep in [Sweep::Along(-DVec3::Z), Sweep::Through(DVec3::new(0.2, 0.1, 6.0))] {
                let options = CutOptions { edge_length, mirrors: vec![mirror], ..CutOptions::new(sweep) };
                let done = half.cut(&stroke, &options).unwrap();
                assert_eq!((done.report.open_lines, done.report.caps), (0, 1));
                for piece in &done.pieces {
                    // With its mirror image, joined at the plane, it is closed.
                    let n = piece.vertices.len() as u32;
                    let on = |v: u32| piece.vertices[v as usize].x.abs() < 1e-9;
                    let mut all = triangles(piece);
                    let image = |v: u32| if on(v) { v } else { v + n };
                    all.extend(triangles(piece).iter().map(|&[a, b, c]| [image(a), image(c), image(b)]));
                    let check = check_mesh(2 * n as usize, &all);
                    assert_eq!((check.boundary_edges, check.bad_edges), (0, 0), "{check:?}");
                }
            }
        }
    }
    let open = half.cut(&line(&[(-2.0, 0.3), (2.0, 0.4)]), &down()).unwrap();
    assert_eq!((open.report.open_lines, open.report.caps), (1, 0));
}

#[test]
fn faces_without_area_repeat_no_edge() {
    // A box with a belt of faces of no width.
    let mut mesh = cube();
    mesh.0.extend([
        DVec3::new(0.0, 0.5, 1.0),
        DVec3::new(1.0, 0.5, 1.0),
        DVec3::new(0.0, 0.5, 1.0),
        DVec3::new(1.0, 0.5, 1.0),
    ]);
    // The top [1, 5, 7, 3] in three, the one in the middle without width.
    let top = mesh.2.len() - 2;
    let (from, to) = (mesh.2[top] as usize, mesh.2[top + 1] as usize);
    assert_eq!(&mesh.1[from..to], [1, 5, 7, 3]);
    mesh.1.truncate(from);
    mesh.2.truncate(top + 1);
    for face in [vec![1, 5, 9, 8], vec![8, 9, 11, 10], vec![10, 11, 7, 3]] {
        mesh.1.extend(face);
        mesh.2.push(mesh.1.len() as u32);
    }
    // The sides at x = 0 and x = 1 get the new corners.
    let mut other = Mesh(mesh.0.clone(), vec![], vec![0]);
    for f in 0..mesh.2.len() - 1 {
        let mut face = mesh.faces().face(f).to_vec();
        for (pair, between) in [([1, 3], [8, 10]), ([3, 1], [10, 8]), ([5, 7], [9, 11]), ([7, 5], [11, 9])] {
            let is_old = face.len() == 4 && face.iter().all(|&v| v < 8);
            let at = (0..4).find(|&k| is_old && [face[k], face[(k + 1) % 4]] == pair);
            if let Some(k) = at {
                face.splice(k + 1..k + 1, between);
            }
        }
        other.1.extend(face);
        other.2.push(other.1.len() as u32);
    }
    for stroke in
        [line(&[(-1.0, 0.4), (2.0, 0.6)]), line(&[(-1.0, 0.5), (2.0, 0.5)]), line(&[(0.3, -1.0), (0.6, 2.0)])]
    {
        for edge_length in [None, Some(0.3)] {
            match other.cut(&stroke, &CutOptions { edge_length, ..down() }) {
                Ok(done) => {
                    assert_closed(&done);
                    assert_mirrored(&done);
                }
                Err(error) => assert_eq!(error.kind(), "cut_failed"),
            }
        }
    }
}

#[test]
fn edge_lengths_that_ask_for_too_much_are_refused_before_the_work() {
    let stroke = line(&[(-1.0, 0.4), (2.0, 0.6)]);
    for (mesh, y) in [(cube(), 0.0), (ball(12), -0.5)] {
        let stroke = stroke.iter().map(|p| *p + y * DVec3::Y).collect::<Vec<_>>();
        for length in [1e-300, 1e-12, 1e-9, 1e-6, 1e-4] {
            for sweep in [Sweep::Along(-DVec3::Z), Sweep::Through(DVec3::new(0.3, 0.2, 9.0))] {
                for smooth in [Smooth::Flat, Smooth::Tangent] {
                    for gap in [0.0, 0.01] {
                        let edge_length = Some(length);
                        let options = CutOptions { edge_length, smooth, gap, ..CutOptions::new(sweep) };
                        let refused = mesh.cut(&stroke, &options).err();
                        assert_eq!(refused.map_or("none", |e| e.kind()), "too_large", "{length}");
                    }
                }
            }
        }
        let options = CutOptions { edge_length: Some(0.02), ..down() };
        assert_closed(&mesh.cut(&stroke, &options).unwrap());
    }
    // The limits themselves: a cap of two million triangles, and 20,000 edges along a cut.
    for (length, number, what) in [
        (1e-3, "23", "triangles in its caps; at most 2000000"),
        (1e-4, "4", "edges along its lines; at most 20000"),
    ] {
        let told = cube().cut(&stroke, &CutOptions { edge_length: Some(length), ..down() }).err();
        let told = told.map(|e| e.to_string()).unwrap_or_default();
        assert!(
            told.starts_with(&format!("the cut would get about {number}")) && told.contains(what),
            "{told}"
        );
    }
}
