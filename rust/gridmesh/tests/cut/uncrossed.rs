//! Parts that a line does not cross.

use glam::DVec3;
use gridmesh::cut::{CutOptions, Keep, Side};

use crate::models::*;

#[test]
fn parts_that_are_not_crossed_are_on_the_side_where_they_lie() {
    // A ball at the origin that is cut, one above the line, one below, and one that the line would cross if it went on.
    let own = ball(10);
    let mut mesh = Mesh(own.0.clone(), own.1.clone(), own.2.clone());
    for (k, place) in [(1, (4.0, 3.0)), (2, (4.0, -3.0)), (3, (8.0, 0.0))] {
        let (n, from) = (k * own.0.len() as u32, mesh.1.len() as u32);
        mesh.0.extend(own.0.iter().map(|p| *p + DVec3::new(place.0, place.1, 0.0)));
        mesh.1.extend(own.1.iter().map(|v| v + n));
        mesh.2.extend(own.2[1..].iter().map(|o| o + from));
    }
    let faces = own.2.len() as i32 - 1;
    let stroke = line(&[(-0.5, 0.1), (0.5, 0.12)]);
    for (keep, gap) in [(Keep::Both, 0.0), (Keep::Left, 0.0), (Keep::Right, 0.0), (Keep::Both, 0.05)] {
        for edge_length in [None, Some(0.2)] {
            let options = CutOptions { keep, gap, edge_length, extend_ends: false, ..down() };
            let done = mesh.cut(&stroke, &options).unwrap();
            assert_closed(&done);
            let mut both = vec![];
            for piece in &done.pieces {
                let of = |k: i32| {
                    let own = k * faces..(k + 1) * faces;
                    piece.source_face.iter().filter(|f| own.contains(f)).count() as i32
                };
                let left = piece.side == Side::Left;
                assert_eq!(of(1), if left { faces } else { 0 }, "{keep:?}");
                assert_eq!(of(2), if left { 0 } else { faces }, "{keep:?}");
                both.push(of(3));
            }
            assert_eq!(both.iter().sum::<i32>(), faces, "{keep:?} {both:?}");
        }
    }
}
