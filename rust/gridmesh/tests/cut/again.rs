//! Cuts of what has been cut.

use gridmesh::cut::{CutOptions, Keep};

use crate::models::*;

/// The pieces as one mesh, with positions as Blender keeps them.
fn together(cut: &gridmesh::cut::Cut) -> Mesh {
    let mut mesh = Mesh(vec![], vec![], vec![0]);
    for piece in &cut.pieces {
        let (n, from) = (mesh.0.len() as u32, mesh.1.len() as u32);
        mesh.0.extend(piece.vertices.iter().map(|p| p.as_vec3().as_dvec3()));
        mesh.1.extend(piece.corners.iter().map(|v| v + n));
        mesh.2.extend(piece.offsets[1..].iter().map(|o| o + from));
    }
    mesh
}

#[test]
fn the_same_cut_is_not_made_twice() {
    let wave = |shift: f64| {
        let at = |k: i32| (0.2 * f64::from(k), shift + 0.1 + 0.1 * (0.7 * f64::from(k)).sin());
        line(&(-20..=20).map(at).collect::<Vec<_>>())
    };
    for mesh in [ball(12), ball(24), torus(24, 12)] {
        for edge_length in [Some(0.1), None] {
            for keep in [Keep::Both, Keep::Left, Keep::Right] {
                let options = CutOptions { edge_length, keep, ..down() };
                let once = together(&mesh.cut(&wave(0.0), &options).unwrap());
                let options = CutOptions { keep: Keep::Both, ..options };
                for shift in [0.0, 1e-6, -1e-6] {
                    let again = once.cut(&wave(shift), &options).map_err(|e| e.kind());
                    let kind = again.err().unwrap_or("none");
                    assert!(
                        ["slice_too_thin", "stroke_misses"].contains(&kind),
                        "{edge_length:?} {keep:?} {shift} {kind}"
                    );
                }
                // A slice a fifth as thick as an edge is cut off.
                let inside = if keep == Keep::Left { 0.02 } else { -0.02 };
                assert_closed(&once.cut(&wave(inside), &options).unwrap());
            }
        }
    }
}

#[test]
fn what_ends_along_the_line_stays_whole_beside_what_is_cut() {
    let own = ball(12);
    let stroke = line(&[(-3.0, 0.1), (9.0, 0.13)]);
    for edge_length in [Some(0.1), None] {
        let options = CutOptions { edge_length, keep: Keep::Left, ..down() };
        let mut both = together(&own.cut(&stroke, &options).unwrap());
        let (half, faces) = (both.0.len() as u32, both.1.len() as u32);
        let n = both.2.len() as i32 - 1;
        both.0.extend(own.0.iter().map(|p| *p + glam::DVec3::new(5.0, 0.0, 0.0)));
        both.1.extend(own.1.iter().map(|v| v + half));
        both.2.extend(own.2[1..].iter().map(|o| o + faces));
        let done = both.cut(&stroke, &down()).unwrap();
        assert_closed(&done);
        let of_half = |piece: &gridmesh::cut::Piece| {
            piece.source_face.iter().filter(|f| (0..n).contains(f)).count() as i32
        };
        assert_eq!(done.pieces.iter().map(of_half).collect::<Vec<_>>(), [n, 0], "{edge_length:?}");
    }
}

#[test]
fn a_notch_without_vertices_and_a_thin_plate_are_cut() {
    // The line dips into a cube between its corners.
    let dip = line(&[(0.1, 2.0), (0.4, 0.4), (0.6, 0.4), (0.9, 2.0)]);
    for edge_length in [Some(0.2), None] {
        let options = CutOptions { edge_length, ..down() };
        assert_eq!(cube().cut(&dip, &options).unwrap().pieces.len(), 2);
        let mut plate = cube();
        plate.0.iter_mut().for_each(|p| p.y *= 0.004);
        let along = line(&[(-1.0, 0.002), (2.0, 0.0021)]);
        assert_eq!(plate.cut(&along, &options).unwrap().pieces.len(), 2);
    }
}
