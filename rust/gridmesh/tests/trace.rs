//! Traced boundaries are boundaries of patches, whatever the drawing.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use gridmesh::drawing::curve::{ClosedCurve, Winding};
use gridmesh::lattice::axial::Axial;
use gridmesh::path::band::{Band, SLACK};
use gridmesh::path::placement::Lattice;
use gridmesh::path::target::Target;
use gridmesh::path::trace::{Path, TraceFailure, TraceOptions, Traced, fewest_turns, trace};
use gridmesh::progress::Progress;
use proptest::prelude::*;

struct Drawing {
    name: &'static str,
    outline: Vec<DVec2>,
    holes: Vec<Vec<DVec2>>,
}

fn points(coords: &[[f64; 2]]) -> Vec<DVec2> {
    coords.iter().map(|&c| DVec2::from_array(c)).collect()
}

fn polar(n: usize, centre: DVec2, radius: impl Fn(f64) -> f64) -> Vec<DVec2> {
    (0..n)
        .map(|i| {
            let t = std::f64::consts::TAU * i as f64 / n as f64;
            centre + radius(t) * DVec2::from_angle(t)
        })
        .collect()
}

fn drawings() -> Vec<Drawing> {
    let drawing = |name, outline, holes| Drawing { name, outline, holes };
    let o = DVec2::ZERO;
    let dumbbell = |half: f64| {
        points(&[
            [-9.0, -4.0],
            [-3.0, -4.0],
            [-3.0, -half],
            [3.0, -half],
            [3.0, -4.0],
            [9.0, -4.0],
            [9.0, 4.0],
            [3.0, 4.0],
            [3.0, half],
            [-3.0, half],
            [-3.0, 4.0],
            [-9.0, 4.0],
        ])
    };
    let inlet = points(&[
        [0.0, 0.0],
        [8.0, 0.0],
        [8.0, 3.0],
        [1.0, 3.05],
        [1.0, 3.1],
        [8.0, 3.15],
        [8.0, 6.0],
        [0.0, 6.0],
    ]);
    let spiral: Vec<DVec2> = {
        let arm = |t: f64, r: f64| (0.4 * t + r) * DVec2::from_angle(t);
        let out = (0..160).map(|i| arm(3.0 + 0.1 * f64::from(i), 0.0));
        let back = (0..160).map(|i| arm(3.0 + 0.1 * f64::from(159 - i), 0.9));
        out.chain(back).collect()
    };
    vec![
        drawing("disc", polar(90, o, |_| 3.0), vec![]),
        drawing("flower", polar(300, o, |t| 3.0 + 1.9 * (5.0 * t).cos()), vec![]),
        drawing(
            "star",
            polar(24, o, |t| if (t * 3.8197).round() as i32 % 2 == 0 { 6.0 } else { 1.5 }),
            vec![],
        ),
        drawing("dumbbell", dumbbell(0.5), vec![]),
        drawing("thin dumbbell", dumbbell(0.04), vec![]),
        drawing("inlet", inlet, vec![]),
        drawing("spiral", spiral, vec![]),
        drawing("ring", polar(80, o, |_| 4.0), vec![polar(50, o, |_| 1.6)]),
        drawing(
            "eight",
            polar(80, o, |_| 4.0),
            vec![polar(40, DVec2::new(-1.35, 0.0), |_| 1.2), polar(40, DVec2::new(1.35, 0.0), |_| 1.2)],
        ),
        drawing(
            "slit",
            polar(80, o, |_| 4.0),
            vec![points(&[[-2.0, -0.3], [2.0, 0.25], [2.0, 0.3], [-2.0, -0.2]])],
        ),
    ]
}

fn targets(drawing: &Drawing, triangles: f64, angle: f64) -> Vec<Target> {
    let outline = ClosedCurve::new(&drawing.outline, Winding::CounterClockwise, "outline");
    let mut curves = vec![outline.unwrap()];
    for hole in &drawing.holes {
        curves.push(ClosedCurve::new(hole, Winding::Clockwise, "hole").unwrap());
    }
    let area = curves[0].area() - curves[1..].iter().map(ClosedCurve::area).sum::<f64>();
    let lattice = Lattice {
        origin: curves[0].points()[0],
        angle,
        edge_length: Lattice::edge_length_for(area, triangles),
    };
    curves.iter().map(|curve| Target::new(curve, &lattice)).collect()
}

/// The triangles that an odd number of path edges separates from the west, found edge by edge.
fn enclosed(paths: &[Path]) -> BTreeSet<[Axial; 3]> {
    let mut walls: BTreeMap<i32, Vec<i32>> = BTreeMap::new();
    for path in paths {
        for (i, &a) in path.points.iter().enumerate() {
            let b = path.points[(i + 1) % path.points.len()];
            if a.r != b.r {
                walls.entry(a.r.min(b.r)).or_default().push(a.q + b.q);
            }
        }
    }
    let mut triangles = BTreeSet::new();
    for (r, mut places) in walls {
        places.sort_unstable();
        for pair in places.chunks_exact(2) {
            for k in pair[0]..pair[1] {
                let q = k.div_euclid(2);
                let (east, north) = (Axial::new(q + 1, r), Axial::new(q, r + 1));
                triangles.insert(if k.rem_euclid(2) == 0 {
                    [Axial::new(q, r), east, north]
                } else {
                    [east, Axial::new(q + 1, r + 1), north]
                });
            }
        }
    }
    triangles
}

/// Proves that paths bound a chord-free patch of the right genus. Returns its triangles.
fn check(paths: &[Path]) -> usize {
    let mut on_path = BTreeMap::new();
    for (contour, path) in paths.iter().enumerate() {
        let n = path.points.len();
        assert!(n >= 6 || contour > 0);
        for (i, &p) in path.points.iter().enumerate() {
            assert_eq!(p.distance(path.points[(i + 1) % n]), 1);
            assert_eq!(on_path.insert(p, (contour, i)), None, "{p:?} is repeated");
        }
    }
    let triangles = enclosed(paths);
    let mut edges = BTreeSet::new();
    for t in &triangles {
        for k in 0..3 {
            assert!(edges.insert((t[k], t[(k + 1) % 3])));
        }
    }
    let mut n_boundary = 0;
    for &(a, b) in &edges {
        if edges.contains(&(b, a)) {
            let chord = on_path.contains_key(&a) && on_path.contains_key(&b);
            assert!(!chord, "the edge {a:?} {b:?} is a chord");
        } else {
            n_boundary += 1;
            let ((c, i), (d, j)) = (on_path[&a], on_path[&b]);
            assert_eq!((c, (i + 1) % paths[c].points.len()), (d, j));
        }
    }
    assert_eq!(n_boundary, on_path.len());
    let vertices: BTreeSet<Axial> = triangles.iter().flatten().copied().collect();
    let n_edges = (edges.len() + n_boundary) / 2;
    let euler = (vertices.len() + triangles.len()) as i64 - n_edges as i64;
    assert_eq!(euler, 2 - paths.len() as i64);
    triangles.len()
}

fn check_traced(traced: &Traced, targets: &[Target], name: &str) {
    assert!(traced.cost_bound <= traced.cost, "{name}");
    let fewest = fewest_turns(targets, traced.max_distance_used).unwrap();
    assert!(fewest <= traced.turns && fewest >= 6 * targets.len(), "{name}");
    assert!(!traced.optimal || traced.cost_bound == traced.cost, "{name}");
    let mut turns = 0;
    for (contour, (path, target)) in traced.paths.iter().zip(targets).enumerate() {
        let n = path.points.len();
        let step = |i: usize| path.points[i % n].step_to(path.points[(i + 1) % n]).unwrap();
        let sum: i32 = (0..n).map(|i| step(i).turn_to(step(i + 1))).sum();
        assert_eq!(sum, if contour == 0 { 6 } else { -6 }, "{name}");
        turns += (0..n).map(|i| step(i).turn_to(step(i + 1)).unsigned_abs() as usize).sum::<usize>();
        let samples = target.len() as f64;
        assert!(path.parameters.windows(2).all(|s| s[0] < s[1]), "{name}");
        assert!((0.0..samples).contains(&path.parameters[0]), "{name}");
        assert!(path.parameters[n - 1] < path.parameters[0] + samples, "{name}");
        // Near the target, and the target near it.
        let band = Band::new(target, traced.max_distance_used);
        let mut covered = vec![false; target.len()];
        for &p in &path.points {
            assert!(band.nearest(p).is_some(), "{name}: {p:?} is far");
            for node in band.nodes_at(p).map(|i| band.nodes[i]) {
                (node.first..=node.last).for_each(|s| covered[s as usize % target.len()] = true);
            }
        }
        assert!(covered.iter().all(|&c| c), "{name}: a part is {SLACK} too far");
    }
    assert_eq!(turns, traced.turns, "{name}");
}

#[test]
fn every_drawing_gets_a_boundary() {
    for drawing in drawings() {
        for (triangles, angle) in [(700.0, 0.0), (700.0, 0.5), (2500.0, 0.2), (9000.0, 0.9)] {
            let targets = targets(&drawing, triangles, angle);
            let options = TraceOptions::default();
            let name = format!("{} of {triangles} at {angle}", drawing.name);
            let traced = trace(&targets, &options, Progress::NONE)
                .unwrap_or_else(|failure| panic!("{name}: {failure:?}"));
            check_traced(&traced, &targets, &name);
            let found = check(&traced.paths) as f64;
            // Parts narrower than two rows of triangles become that wide.
            let widest = if triangles < 1000.0 { 0.5 } else { 0.15 };
            assert!((found / triangles - 1.0).abs() < widest, "{name}: {found}");
            assert_eq!(trace(&targets, &options, Progress::NONE), Ok(traced));
        }
    }
}

#[test]
fn a_proof_only_makes_it_better() {
    for drawing in drawings() {
        let targets = targets(&drawing, 1200.0, 0.3);
        let quick = TraceOptions::default();
        let long = TraceOptions { proof_nodes: 12, ..TraceOptions::default() };
        let a = trace(&targets, &quick, Progress::NONE).unwrap();
        let b = trace(&targets, &long, Progress::NONE).unwrap();
        check_traced(&b, &targets, drawing.name);
        check(&b.paths);
        assert!(b.cost <= a.cost + 1e-9 && b.cost_bound >= a.cost_bound - 0.2);
        assert!(b.optimal >= a.optimal);
    }
}

#[test]
fn a_hexagon_on_the_lattice_is_itself() {
    let corners: Vec<DVec2> =
        (0..6).map(|i| 8.0 * DVec2::from_angle(std::f64::consts::FRAC_PI_3 * f64::from(i))).collect();
    let curve = ClosedCurve::new(&corners, Winding::CounterClockwise, "outline").unwrap();
    let lattice = Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 };
    let targets = [Target::new(&curve, &lattice)];
    let traced = trace(&targets, &TraceOptions::default(), Progress::NONE).unwrap();
    assert!(traced.optimal);
    assert_eq!((traced.turns, check(&traced.paths)), (6, 6 * 64));
}

/// Necks of all widths at all angles: the two walls must not end up on each other's side.
#[test]
fn walls_of_a_neck_do_not_stay_exchanged() {
    let mut drawings = drawings();
    let drawing = &mut drawings[4];
    assert_eq!(drawing.name, "thin dumbbell");
    for half in [0.02, 0.04] {
        for p in &mut drawing.outline {
            if p.y.abs() < 1.0 {
                p.y = half * p.y.signum();
            }
        }
        for triangles in [700.0, 1000.0, 2000.0, 4000.0] {
            for k in 0..7 {
                let targets = targets(drawing, triangles, 0.15 * f64::from(k));
                let traced = trace(&targets, &TraceOptions::default(), Progress::NONE).unwrap();
                check(&traced.paths);
            }
        }
    }
}

/// Two walls of a hole on one line of the lattice cost the same as their exchange.
#[test]
fn a_slit_does_not_turn_inside_out() {
    let drawing = &drawings()[9];
    assert_eq!(drawing.name, "slit");
    for k in 0..20 {
        let targets = targets(drawing, 900.0, 0.05 * f64::from(k));
        let traced = trace(&targets, &TraceOptions::default(), Progress::NONE).unwrap();
        check(&traced.paths);
    }
}

#[test]
fn too_coarse_a_lattice_is_refused_and_the_place_named() {
    let mut comb = vec![DVec2::new(0.0, 0.0), DVec2::new(20.0, 0.0)];
    for tooth in (0..40).rev() {
        let x = 0.5 * f64::from(tooth);
        comb.extend([[x + 0.3, 1.0], [x + 0.3, 9.0], [x + 0.1, 9.0], [x + 0.1, 1.0]].map(DVec2::from));
    }
    let drawing = Drawing { name: "comb", outline: comb, holes: vec![] };
    let targets = targets(&drawing, 200.0, 0.2);
    let failure = trace(&targets, &TraceOptions::default(), Progress::NONE).unwrap_err();
    assert!(failure.at().is_some(), "{failure}");
}

#[test]
fn cancelling_stops_it() {
    let drawing = &drawings()[4];
    let targets = targets(drawing, 2000.0, 0.2);
    let refuse = |_: f64| false;
    let traced = trace(&targets, &TraceOptions::default(), Progress::new(&refuse));
    assert_eq!(traced, Err(TraceFailure::Cancelled));
}

#[test]
fn absurd_options_and_targets_do_no_harm() {
    let empty = Target { points: vec![], step: 0.25 };
    let point = Target { points: vec![DVec2::ONE; 12], step: 0.25 };
    for target in [empty, point] {
        let _ = trace(&[target], &TraceOptions::default(), Progress::NONE);
    }
    let targets = targets(&drawings()[0], 300.0, 0.0);
    for max_distance in [f64::NAN, -1.0, 0.0, 0.1, 1e300] {
        for closeness in [f64::NAN, -1.0, 0.0, 1e300] {
            let options = TraceOptions { max_distance, closeness, proof_nodes: 3 };
            if let Ok(traced) = trace(&targets, &options, Progress::NONE) {
                check(&traced.paths);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Blobs with random lobes, some of them deep.
    #[test]
    fn random_blobs_get_boundaries(
        waves in prop::collection::vec((0.0..0.35f64, 0.0..6.3f64), 1..6),
        angle in 0.0..1.05f64,
        triangles in 200.0..3000.0f64,
        hole in prop::bool::ANY,
    ) {
        let radius = |t: f64| {
            let sum: f64 = (2..).zip(&waves).map(|(k, (a, p))| a * (f64::from(k) * t + p).cos()).sum();
            (5.0 * (1.0 + sum)).max(1.2)
        };
        let drawing = Drawing {
            name: "blob",
            outline: polar(200, DVec2::ZERO, radius),
            holes: if hole { vec![polar(30, DVec2::ZERO, |_| 0.8)] } else { vec![] },
        };
        let targets = targets(&drawing, triangles, angle);
        match trace(&targets, &TraceOptions::default(), Progress::NONE) {
            Ok(traced) => {
                check_traced(&traced, &targets, "blob");
                check(&traced.paths);
            }
            Err(failure) => prop_assert!(hole, "{failure:?}"),
        }
    }
}
