//! The placement on analytic outlines: valid, on the curve, deterministic, and good.
#![allow(clippy::unwrap_used)]

mod relax_shapes;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec2;
use gridmesh::error::Error;
use gridmesh::progress::Progress;
use gridmesh::relax::{RelaxOptions, RelaxReport, Rim, first_inverted, relax, settle_corners};
use proptest::prelude::*;
use relax_shapes::{Shape, outline, shape};

const OUTLINES: [&str; 7] = ["circle", "trefoil", "ellipse", "star", "dumbbell", "crescent", "square"];

fn place(shape: &Shape, options: &RelaxOptions) -> (Vec<DVec2>, Rim, RelaxReport) {
    let mut positions = shape.positions.clone();
    let mut rims = [shape.rim.clone()];
    let report =
        relax(&shape.triangles, &mut positions, &[shape.contour()], &mut rims, options, Progress::NONE)
            .unwrap();
    let [rim] = rims;
    (positions, rim, report)
}

fn least_angle(p: [DVec2; 3]) -> f64 {
    (0..3)
        .map(|i| (p[(i + 1) % 3] - p[i]).angle_to(p[(i + 2) % 3] - p[i]).to_degrees())
        .fold(f64::INFINITY, f64::min)
}

/// Everything that the documentation of `relax` promises for a valid placement.
fn check_placed(shape: &Shape, positions: &[DVec2], rim: &Rim, report: &RelaxReport) {
    assert_eq!(report.inverted, None);
    assert_eq!(first_inverted(positions, &shape.triangles, DVec2::ZERO), None);
    let contour = shape.contour();
    for (i, &s) in rim.s.iter().enumerate() {
        assert_eq!(positions[i], contour.point_at(s), "vertex {i} is off the curve");
    }
    assert!(rim.s.windows(2).all(|w| w[0] < w[1]));
    assert!(rim.s[rim.s.len() - 1] < rim.s[0] + contour.length());
    for (i, &pinned) in rim.pinned.iter().enumerate() {
        assert_eq!(pinned, shape.rim.pinned[i] && !report.released.contains(&(i as u32)));
        if pinned {
            assert!(shape.curve.contains(&positions[i]), "vertex {i} has left its corner");
        }
    }
    let angles = shape.triangles.iter().map(|t| least_angle(t.map(|v| positions[v as usize])));
    let least = angles.fold(60.0, f64::min);
    assert!((least - report.min_angle.to_degrees()).abs() < 1e-6);
}

/// Distance from the boundary in edges, for every vertex.
fn depths(shape: &Shape) -> Vec<usize> {
    let n = shape.positions.len();
    let mut depth = vec![usize::MAX; n];
    depth[..shape.rim.s.len()].fill(0);
    for d in 0.. {
        let mut grew = false;
        for t in &shape.triangles {
            if t.iter().any(|&v| depth[v as usize] == d) {
                for &v in t {
                    if depth[v as usize] == usize::MAX {
                        depth[v as usize] = d + 1;
                        grew = true;
                    }
                }
            }
        }
        if !grew {
            return depth;
        }
    }
    depth
}

#[test]
fn every_outline_is_placed_at_every_size() {
    for name in OUTLINES {
        for triangles in [150, 500, 2000] {
            for corners in [false, true] {
                let Some(shape) = shape(&outline(name), triangles, 0.1, corners) else {
                    assert!(name == "dumbbell" || name == "crescent", "{name} {triangles} has no path");
                    continue;
                };
                let (positions, rim, report) = place(&shape, &RelaxOptions::default());
                check_placed(&shape, &positions, &rim, &report);
            }
        }
    }
}

#[test]
fn angles_are_good_at_two_thousand_triangles() {
    for (name, least) in [("circle", 38.0), ("trefoil", 36.0), ("ellipse", 31.0), ("square", 33.0)] {
        for angle in [0.0, 0.1, 0.3, 0.5] {
            let shape = shape(&outline(name), 2000, angle, false).unwrap();
            let (positions, ..) = place(&shape, &RelaxOptions::default());
            let angles = shape.triangles.iter().map(|t| least_angle(t.map(|v| positions[v as usize])));
            let worst = angles.fold(60.0, f64::min);
            assert!(worst > least, "{name} at {angle}: {worst}");
        }
    }
}

#[test]
fn deep_interior_does_not_move() {
    let shape = shape(&outline("trefoil"), 2000, 0.1, false).unwrap();
    let depth = depths(&shape);
    for rings in [1, 3] {
        let options = RelaxOptions { rings, ..RelaxOptions::default() };
        let (positions, _, report) = place(&shape, &options);
        assert_eq!(report.rings, rings);
        assert!(depth.iter().any(|&d| d > rings + 1));
        for (v, &d) in depth.iter().enumerate() {
            if d > rings {
                assert_eq!(positions[v], shape.positions[v]);
            }
        }
    }
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let points = outline("star");
    let larger: Vec<DVec2> = points.iter().map(|&p| 64.0 * p).collect();
    let (a, b) = (shape(&points, 1000, 0.2, true).unwrap(), shape(&larger, 1000, 0.2, true).unwrap());
    let (placed_a, placed_b) = (place(&a, &RelaxOptions::default()), place(&b, &RelaxOptions::default()));
    assert!(placed_a == placed_b);
}

#[test]
fn without_sliding_the_mapping_is_kept() {
    let shape = shape(&outline("circle"), 2000, 0.1, false).unwrap();
    let options = RelaxOptions { slide: false, ..RelaxOptions::default() };
    let (positions, rim, report) = place(&shape, &options);
    assert_eq!(rim, shape.rim);
    check_placed(&shape, &positions, &rim, &report);
}

#[test]
fn sharp_corners_settle_on_vertices_with_two_triangles_and_hold() {
    let mut shape = shape(&outline("star"), 2000, 0.1, true).unwrap();
    let mut turning = [shape.corner.iter().map(|c| c.map_or(0.0, |a| std::f64::consts::PI - a)).collect()];
    let mut rims = [shape.rim.clone()];
    settle_corners(&shape.triangles, &[shape.contour()], &mut rims, &mut turning);
    let [rim] = rims;
    shape.rim = rim;
    assert_eq!(shape.rim.pinned.iter().filter(|&&p| p).count(), 10);
    let (positions, rim, report) = place(&shape, &RelaxOptions::default());
    check_placed(&shape, &positions, &rim, &report);
    assert!(report.released.is_empty(), "{:?}", report.released);
    for (i, turn) in turning[0].iter().enumerate() {
        if *turn > 0.0 {
            let fan = shape.triangles.iter().filter(|t| t.contains(&(i as u32)));
            let worst = fan.map(|t| least_angle(t.map(|v| positions[v as usize]))).fold(60.0, f64::min);
            let interior = 180.0 - turn.to_degrees();
            assert!(worst > 0.45 * interior, "{worst} at a corner of {interior}");
        }
    }
}

#[test]
fn a_corner_that_starves_its_triangles_is_released() {
    // A spike of 18 degrees whose tip is given to a vertex with three triangles or more.
    let mut points = outline("circle");
    points[0] = DVec2::new(1.25, 0.0);
    let base = (0.25 * 9f64.to_radians().tan()).atan2(1.0);
    points.retain(|p| p.x > 1.1 || p.y.atan2(p.x).abs() >= base);
    let mut shape = shape(&points, 1200, 0.1, false).unwrap();
    let tip = (0..shape.curve.len()).find(|&i| shape.curve[i] == shape.curve[0]).unwrap();
    let n = shape.rim.s.len();
    let mut fan = vec![0; shape.positions.len()];
    shape.triangles.iter().flatten().for_each(|&v| fan[v as usize] += 1);
    let (s, length) = (shape.arc[tip], shape.contour().length());
    let away = |x: f64| ((x - s + 0.5 * length).rem_euclid(length) - 0.5 * length).abs();
    let k = (0..n)
        .filter(|&k| fan[k] >= 4)
        .min_by(|&a, &b| away(shape.rim.s[a]).total_cmp(&away(shape.rim.s[b])))
        .unwrap();
    // Even spacing, with vertex k on the tip.
    let laps = s + length * ((shape.rim.s[k] - s) / length).round();
    for i in 0..n {
        shape.rim.s[i] = laps + length * (i as f64 - k as f64) / n as f64;
    }
    shape.rim.pinned[k] = true;
    let (positions, rim, report) = place(&shape, &RelaxOptions::default());
    check_placed(&shape, &positions, &rim, &report);
    assert_eq!(report.released, vec![k as u32]);
}

#[test]
fn malformed_rims_and_triangles_are_refused() {
    let good = shape(&outline("circle"), 150, 0.1, false).unwrap();
    type Spoil = fn(&mut Shape);
    let spoilt: [(&str, Spoil); 5] = [
        ("order", |s| s.rim.s.swap(2, 3)),
        ("lap", |s| *s.rim.s.last_mut().unwrap() += 1000.0),
        ("NaN", |s| s.rim.s[4] = f64::NAN),
        ("pins", |s| s.rim.pinned.truncate(3)),
        ("fan", |s| s.triangles.truncate(20)),
    ];
    for (what, spoil) in spoilt {
        let mut bad = good.clone();
        spoil(&mut bad);
        let (mut positions, mut rims) = (bad.positions.clone(), [bad.rim.clone()]);
        let options = RelaxOptions::default();
        let contours = [bad.contour()];
        let result = relax(&bad.triangles, &mut positions, &contours, &mut rims, &options, Progress::NONE);
        assert!(matches!(result, Err(Error::InvalidOption { .. })), "{what}");
    }
}

#[test]
fn cancelling_changes_nothing() {
    let shape = shape(&outline("star"), 500, 0.1, true).unwrap();
    let calls = AtomicUsize::new(0);
    let callback = |_: f64| calls.fetch_add(1, Ordering::Relaxed) < 3;
    let (mut positions, mut rims) = (shape.positions.clone(), [shape.rim.clone()]);
    let options = RelaxOptions::default();
    let contours = [shape.contour()];
    let result =
        relax(&shape.triangles, &mut positions, &contours, &mut rims, &options, Progress::new(&callback));
    assert_eq!(result, Err(Error::Cancelled));
    assert!(positions == shape.positions && rims[0] == shape.rim);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// However badly the vertices are mapped, the placement is valid or says that it is not.
    #[test]
    fn bad_mappings_are_mended_or_reported(
        waves in prop::collection::vec((-0.12f64..0.12, 0.0f64..6.3), 6),
        triangles in 60usize..900,
        angle in 0.0f64..1.0,
        bunch in 0.02f64..1.0,
        pin in 1usize..9,
    ) {
        let points: Vec<DVec2> = (0..400)
            .map(|i| std::f64::consts::TAU * f64::from(i) / 400.0)
            .map(|t| {
                let r: f64 = waves.iter().zip(2..).map(|(&(a, p), k)| a * (f64::from(k) * t + p).cos()).sum();
                (1.0 + r) * DVec2::from_angle(t)
            })
            .collect();
        if let Some(mut shape) = shape(&points, triangles, angle, false) {
            // All vertices on a part of the curve; or well mapped, and some of them pinned.
            let pinning = bunch > 0.8;
            let share = if pinning { 1.0 } else { bunch };
            let first = shape.rim.s[0];
            for (i, s) in shape.rim.s.iter_mut().enumerate() {
                *s = first + share * (*s - first);
                shape.rim.pinned[i] = pinning && i % 9 == pin;
            }
            let (positions, rim, report) = place(&shape, &RelaxOptions::default());
            let found = first_inverted(&positions, &shape.triangles, DVec2::ZERO);
            prop_assert_eq!(found, report.inverted);
            prop_assert!(rim.s.windows(2).all(|w| w[0] < w[1]));
            if pinning {
                prop_assert_eq!(found, None);
            }
        }
    }
}
