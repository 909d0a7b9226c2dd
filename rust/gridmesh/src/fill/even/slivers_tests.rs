use rustc_hash::FxHashMap;

use super::*;
use crate::fill::even::local::tests::sheet;
use crate::fill::even::untangle::tangled;
use crate::fill::surface::meet::Box3;
use crate::geometry::metrics::check_mesh;

fn worst(local: &Local) -> f64 {
    (0..local.triangles.len() as u32).map(|t| quality(local.corners(t))).fold(1.0, f64::min)
}

fn shortest(local: &Local) -> f64 {
    local.edges().into_iter().map(|e| local.length(e)).fold(f64::INFINITY, f64::min)
}

/// A sheet of which two vertices inside are nearly one.
fn pinched() -> Local {
    let mut local = sheet(8);
    let at = |local: &Local, p: DVec3| local.positions.iter().position(|&q| q == p).unwrap();
    let moved = at(&local, DVec3::new(3.0, 4.0, 0.0));
    local.positions[moved] = DVec3::new(3.96, 4.02, 0.0);
    local
}

#[test]
fn a_short_edge_goes_and_the_triangles_around_become_round() {
    let mut local = pinched();
    assert!(worst(&local) < 0.1);
    mend_slivers(&mut local, &Near::default(), Progress::NONE).unwrap();
    assert!(worst(&local) > THIN && shortest(&local) > SHORT, "{} {}", worst(&local), shortest(&local));
    let check = check_mesh(local.positions.len(), &local.triangles);
    assert_eq!((check.bad_edges, check.bad_vertices, check.euler, check.boundaries), (0, 0, 1, 1));
}

#[test]
fn nothing_meets_what_is_near() {
    let mut local = pinched();
    // Nails through the middles of triangles of the sheet as it should be, just above it and just below.
    let mut nails = vec![];
    for (x, y, z) in [(3.4, 4.6, 0.01), (4.6, 4.4, -0.01), (2.6, 3.4, 0.01), (3.4, 3.6, -0.02)] {
        let tip = DVec3::new(x, y, z);
        let base = z.signum() * 3.0;
        nails.extend([tip, DVec3::new(x + 0.1, y, base), DVec3::new(x, y + 0.1, base)]);
    }
    let triangles = (0..4u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect::<Vec<_>>();
    let around = Box3::around(nails.iter().copied());
    let border = (0..local.border as u32).map(|v| (100 + v, v)).collect::<FxHashMap<u32, u32>>();
    let near = Near::new(around, &nails, &triangles, &border);
    assert!(tangled(&local, &near, Progress::NONE).unwrap().is_empty());
    mend_slivers(&mut local, &near, Progress::NONE).unwrap();
    assert!(tangled(&local, &near, Progress::NONE).unwrap().is_empty());
    assert!(worst(&local) > THIN);
}

#[test]
fn a_tunnel_three_edges_wide_is_made_wider() {
    // Rings of a tube of three, the ends of which stay; in the middle it is as thin as a thread.
    let radius = [1.0, 0.5, 0.02, 0.5, 1.0];
    let point = |row: usize, k: usize| {
        let t = std::f64::consts::TAU * (k as f64 + 0.5 * row as f64) / 3.0;
        DVec3::new(radius[row] * t.cos(), radius[row] * t.sin(), 0.8 * row as f64)
    };
    let order = [0, 4, 1, 2, 3];
    let number = |row: usize, k: usize| (3 * order.iter().position(|&r| r == row).unwrap() + k % 3) as u32;
    let mut triangles = vec![];
    for (row, k) in (0..4).flat_map(|row| (0..3).map(move |k| (row, k))) {
        let [a, b] = [number(row, k), number(row, k + 1)];
        let [c, d] = [number(row + 1, k), number(row + 1, k + 1)];
        triangles.extend([[a, b, c], [b, d, c]]);
    }
    let positions = order.iter().flat_map(|&row| (0..3).map(move |k| point(row, k))).collect();
    let mut local = Local::new(positions, triangles, vec![0; 24], 6);
    local.sizes.fill(1.0);
    assert!(shortest(&local) < 0.05);
    mend_slivers(&mut local, &Near::default(), Progress::NONE).unwrap();
    assert!(shortest(&local) > SHORT, "{}", shortest(&local));
    let check = check_mesh(local.positions.len(), &local.triangles);
    assert_eq!((check.bad_edges, check.bad_vertices, check.euler, check.boundaries), (0, 0, 0, 2));
}
