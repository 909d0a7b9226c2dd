use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use super::cells::{Belt, Name};
use super::*;
use crate::lattice::axial::Axial;

/// Faces of a fill: quads from their pairs of triangles, then the odd triangle.
fn faces(fill: &FlatFill) -> Vec<Vec<u32>> {
    let (pairs, rest) = fill.patch.triangles.split_at(2 * fill.patch.quads);
    let quad = |pair: &[[u32; 3]]| {
        let ([a, b, c], [first, third, d]) = (pair[0], pair[1]);
        assert_eq!((a, c), (first, third));
        vec![a, b, c, d]
    };
    pairs.chunks_exact(2).map(quad).chain(rest.iter().map(|t| t.to_vec())).collect()
}

fn check(polygon: &[DVec2], fill: &FlatFill) {
    let n = polygon.len();
    let faces = faces(fill);
    let triangles = faces.iter().filter(|f| f.len() == 3).count();
    assert_eq!(triangles, n % 2, "one triangle for an odd loop, none for an even one");
    let mut sides = BTreeMap::new();
    for face in &faces {
        assert_eq!(face.iter().collect::<BTreeSet<_>>().len(), face.len());
        for k in 0..face.len() {
            *sides.entry((face[k], face[(k + 1) % face.len()])).or_insert(0) += 1;
        }
    }
    assert!(sides.values().all(|&count| count == 1), "a side twice in one direction");
    let open: BTreeSet<_> = sides.keys().filter(|(a, b)| !sides.contains_key(&(*b, *a))).copied().collect();
    let rim = (0..n as u32).map(|k| (k, (k + 1) % n as u32)).collect::<BTreeSet<_>>();
    assert_eq!(open, rim);
    let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    assert_eq!(used.len(), n + fill.patch.interior.len());
    let undirected = (sides.len() - n) / 2 + n;
    assert_eq!(used.len() + faces.len(), undirected + 1, "not a disk");
    if !fill.folded {
        let positions = [polygon, &fill.patch.interior].concat();
        let corners = faces
            .iter()
            .filter(|f| f.len() == 4)
            .flat_map(|f| (0..4).map(|k| [f[(k + 3) % 4], f[k], f[(k + 1) % 4]]).collect::<Vec<_>>());
        let centre = polygon.iter().sum::<DVec2>() / n as f64;
        let corners = corners.collect::<Vec<_>>();
        assert_eq!(crate::relax::first_inverted(&positions, &corners, centre), None);
    }
}

fn circle(n: usize) -> Vec<DVec2> {
    (0..n).map(|k| DVec2::from_angle(TAU * k as f64 / n as f64)).collect()
}

fn rectangle(w: i32, h: i32) -> Vec<DVec2> {
    let sides = [(w, [1, 0]), (h, [0, 1]), (w, [-1, 0]), (h, [0, -1])];
    let mut at = DVec2::ZERO;
    let mut points = vec![];
    for (count, [x, y]) in sides {
        for _ in 0..count {
            points.push(at);
            at += DVec2::new(f64::from(x), f64::from(y));
        }
    }
    points
}

fn fill(polygon: &[DVec2], taken: &(dyn Fn(usize, usize) -> bool + Sync), single: bool) -> FlatFill {
    let fill = fill_flat_quads(polygon, &vec![2.0; polygon.len()], taken, single, Progress::NONE).unwrap();
    check(polygon, &fill);
    fill
}

#[test]
fn circles_of_any_number_of_edges_are_filled() {
    for n in (3..60).chain([99, 128, 301]) {
        let fill = fill(&circle(n), &|_, _| false, true);
        assert!(!fill.folded, "{n}");
    }
}

#[test]
fn a_square_with_an_edge_of_the_mesh_across_is_no_single_quad() {
    for across in [(0, 2), (1, 3)] {
        let made = fill(&rectangle(1, 1), &|i, j| (i, j) == across, true);
        assert!(!made.patch.interior.is_empty() && !made.folded);
    }
    assert!(fill(&rectangle(1, 1), &|_, _| false, true).patch.interior.is_empty());
}

#[test]
fn a_rectangle_is_a_grid() {
    for (w, h) in [(1, 1), (3, 1), (5, 4), (9, 2)] {
        let polygon = rectangle(w, h);
        let mut wanted = vec![2.0; polygon.len()];
        for corner in [0, w, w + h, 2 * w + h] {
            wanted[corner as usize] = 1.0;
        }
        let fill = fill_flat_quads(&polygon, &wanted, &|_, _| false, true, Progress::NONE).unwrap();
        check(&polygon, &fill);
        assert_eq!((fill.patch.quads as i32, fill.quality.irregular), (w * h, 0));
        assert!((fill.quality.min_angle.to_degrees() - 90.0).abs() < 1.0);
    }
}

#[test]
fn edges_that_the_mesh_has_are_not_repeated() {
    for n in 3..30 {
        for polygon in [circle(n), circle(n).iter().map(|p| *p * DVec2::new(3.0, 0.4)).collect()] {
            let fill = fill(&polygon, &|_, _| true, false);
            assert_eq!(fill.quality.repeated, 0);
            assert!(fill.quality.chords == 0, "{n}");
        }
    }
}

#[test]
fn loops_that_no_lattice_fits_are_filled() {
    // A comb, a spiral, a needle, noise that meets itself.
    let comb: Vec<DVec2> = (0..31)
        .map(|k| DVec2::new(f64::from(k), if k % 2 == 0 { 0.0 } else { 9.0 }))
        .chain([DVec2::new(30.0, -1.0), DVec2::new(0.0, -1.0)])
        .collect();
    let mut comb = comb;
    comb.reverse();
    let needle: Vec<DVec2> =
        (0..40).map(|k| DVec2::from_angle(TAU * f64::from(k) / 40.0) * DVec2::new(1.0, 1e-4)).collect();
    let uneven: Vec<DVec2> =
        (0..51).map(|k| DVec2::from_angle(TAU * (f64::from(k) / 51.0).powi(4))).collect();
    let noise: Vec<DVec2> =
        (0..37u32).map(|k| DVec2::new(f64::from(k * 7919 % 101), f64::from(k * 104_729 % 103))).collect();
    for polygon in [comb, needle, uneven, noise] {
        fill(&polygon, &|_, _| false, true);
    }
}

#[test]
fn a_plan_whose_corner_has_two_quads_is_none() {
    let path = [[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1]].map(|[q, r]| Axial::new(q, r)).to_vec();
    for (apex, sound) in [(0, true), (1, false), (2, true)] {
        let name = |k: usize| if k == apex { Name::Apex } else { Name::Loop(k - usize::from(k > apex)) };
        let plan = Plan { path: path.clone(), names: (0..6).map(name).collect(), belt: Belt::None, n: 5 };
        assert_eq!(Cells::of(&plan).is_some(), sound, "{apex}");
    }
}

#[test]
fn a_row_along_a_part_ends_at_corners_of_one_quad() {
    // A square of three by three, its lowest row between two corners.
    let path: Vec<Axial> = [[0, 0], [1, 0], [2, 0], [3, 0], [3, 1], [3, 2], [2, 2], [1, 2], [0, 2], [0, 1]]
        .map(|[q, r]| Axial::new(q, r))
        .to_vec();
    // The loop begins at the left end of the row.
    let names = [11, 1, 2, 4, 5, 6, 7, 8, 9, 10];
    let name = |k: usize| if k == 1 || k == 2 { Name::Behind(k) } else { Name::Loop(k) };
    let plan = Plan { path, names: names.map(name).to_vec(), belt: Belt::Part { from: 0, to: 3 }, n: 12 };
    let cells = Cells::of(&plan).unwrap();
    assert_eq!((cells.quads.len(), cells.start.len()), (9, 16));
    for (k, p) in rectangle(3, 3).into_iter().enumerate() {
        assert_eq!(cells.start[k], p - DVec2::Y);
    }
}
