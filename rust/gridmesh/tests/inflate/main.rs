//! Properties of stitched and inflated bodies.

#![allow(clippy::unwrap_used)]

mod curves;
mod shapes;

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use gridmesh::body::inflate::{InflateOptions, Profile, Side, inflate};
use gridmesh::body::stitch::{flat, stitch};
use gridmesh::body::surface::Surface;
use gridmesh::error::Error;
use gridmesh::geometry::embed::count_self_intersections;
use gridmesh::progress::Progress;
use proptest::prelude::*;

use crate::shapes::*;

#[test]
fn a_circle_of_any_resolution_becomes_a_sphere() {
    let regular = [1, 2, 3, 4, 7, 12, 30, 129].map(disk);
    let circle = polar(400, |_| 1.0);
    let drawn = [100, 500, 3000].map(|count| sketched(&circle, count));
    for patch in regular.iter().chain(&drawn) {
        let body = inflated(patch, &InflateOptions::default());
        let error = body.vertices.iter().map(|v| (v.length() - 1.0).abs()).fold(0.0, f64::max);
        assert!(error < 0.001, "{} triangles: off by {error}", patch.triangles.len());
        assert!(body.report.embedded && body.report.watertight && is_mirrored(patch, &body));
        let least = body.report.min_angle.to_degrees();
        assert!(least > 25.0, "{} triangles: angle {least}", patch.triangles.len());
    }
}

#[test]
fn bodies_keep_their_promises() {
    for (name, outline) in drawings() {
        for count in [1000, 2500] {
            let patch = sketched(&outline, count);
            for profile in [Profile::Round, Profile::Even, Profile::Flat, Profile::Peak] {
                let body = inflated(&patch, &InflateOptions { profile, ..InflateOptions::default() });
                check_body(name, &patch, &body);
                assert!(is_mirrored(&patch, &body), "{name}");
            }
        }
    }
}

#[test]
fn smooth_outlines_have_no_crease_at_the_silhouette() {
    for (name, outline) in drawings().into_iter().take(2) {
        for count in [600, 2000] {
            let patch = sketched(&outline, count);
            let body = inflated(&patch, &InflateOptions::default());
            let ratio = seam_ratio(&patch, &body);
            assert!(ratio < 1.25, "{name} at {count}: {ratio}");
            assert!(body.report.min_angle.to_degrees() > 25.0, "{name} at {count}");
        }
    }
    let patch = disk(12);
    assert!(seam_ratio(&patch, &inflated(&patch, &InflateOptions::default())) < 1.1);
}

#[test]
fn a_hole_gives_a_torus() {
    let ring = |r: f64, angle: f64| (0.3 + 0.9 * r) * DVec2::from_angle(angle);
    for (from, radius) in [(1, 3), (4, 10)] {
        let patch = hex_patch(from, radius, ring);
        for profile in [Profile::Round, Profile::Even, Profile::Flat, Profile::Peak] {
            let body = inflated(&patch, &InflateOptions { profile, ..InflateOptions::default() });
            check_body("ring", &patch, &body);
            assert_eq!(body.silhouette.len(), 2);
        }
        assert_eq!(stitch(&patch).report.genus, 1);
    }
}

#[test]
fn stitched_and_flat() {
    let patch = disk(3);
    let pillow = stitch(&patch);
    assert_eq!(pillow.vertices.len(), 2 * patch.vertices.len() - patch.n_boundary());
    assert!(pillow.vertices.iter().all(|v| v.z == 0.0));
    assert!(pillow.report.watertight && pillow.report.embedded && pillow.report.volume == 0.0);
    assert_eq!((pillow.report.genus, pillow.report.irregular), (0, 6));
    assert_eq!(pillow.silhouette, vec![(0..18).collect::<Vec<u32>>()]);
    let sheet = flat(&patch);
    assert_eq!(sheet.triangles, patch.triangles);
    assert!(!sheet.report.watertight && sheet.report.embedded);
    assert_eq!((sheet.report.genus, sheet.report.irregular), (0, 6));
    assert_eq!(sheet.uv.len(), 3 * sheet.triangles.len());
}

/// A spiral ramp: every triangle is positive, yet the patch overlaps itself.
#[test]
fn an_overlapping_sheet_is_reported() {
    let mut patch = hex_patch(6, 9, |r, angle| (r - 0.3) * DVec2::from_angle(angle));
    // Wind the ring around twice as often: the triangles of the closing wedge are turned over.
    for v in &mut patch.vertices {
        *v = v.length() * DVec2::from_angle(1.7 * v.to_angle().rem_euclid(TAU));
    }
    let sheet = flat(&patch);
    assert!(!sheet.report.embedded);
    assert!(sheet.report.self_intersections > 0);
}

#[test]
fn texture_islands_are_apart_and_undistorted() {
    let wide = hex_patch(0, 4, |r, a| r * DVec2::new(3.0 * a.cos(), a.sin()));
    let tall = hex_patch(0, 4, |r, a| r * DVec2::new(a.cos(), 3.0 * a.sin()));
    for patch in [wide, tall] {
        let body = inflated(&patch, &InflateOptions::default());
        assert_eq!(body.uv.len(), 3 * body.triangles.len());
        assert!(body.uv.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all()));
        let doubled = |t: &[DVec2]| (t[1] - t[0]).perp_dot(t[2] - t[0]);
        let ratio = doubled(&body.uv[..3]) / {
            let [a, b, c] = patch.triangles[0].map(|v| patch.vertices[v as usize]);
            (b - a).perp_dot(c - a)
        };
        for (corners, t) in body.uv.chunks(3).zip(patch.triangles.iter().chain(&patch.triangles)) {
            let [a, b, c] = t.map(|v| patch.vertices[v as usize]);
            assert!((doubled(corners) / (b - a).perp_dot(c - a) / ratio - 1.0).abs() < 1e-9);
        }
        let (front, back) = body.uv.split_at(3 * patch.triangles.len());
        let high = |p: &[DVec2]| p.iter().copied().reduce(DVec2::max).unwrap();
        let low = |p: &[DVec2]| p.iter().copied().reduce(DVec2::min).unwrap();
        assert!(high(front).x < low(back).x || high(back).y < low(front).y);
        assert!((high(&body.uv) - low(&body.uv)).max_element() > 0.9, "the square is used");
    }
}

fn top(body: &Surface) -> f64 {
    body.vertices.iter().map(|v| v.z).fold(0.0, f64::max)
}

#[test]
fn profiles_have_the_heights_they_promise() {
    let with = |profile| InflateOptions { profile, ..InflateOptions::default() };
    let circle = disk(20);
    let limb = sketched(&stadium(2.0, 0.3), 3000);
    let even = inflated(&circle, &with(Profile::Even));
    assert!(even.vertices.iter().all(|v| (v.length() - 1.0).abs() < 0.01), "even: a circle is a sphere");
    let height = |profile| top(&inflated(&limb, &with(profile))) / 0.3;
    assert!((height(Profile::Round) - 2f64.sqrt()).abs() < 0.03);
    assert!((height(Profile::Even) - 1.0).abs() < 0.05);
    let cone = inflated(&circle, &with(Profile::Peak));
    for v in &cone.vertices[..circle.vertices.len()] {
        let wanted = 1.0 - v.truncate().length();
        assert!((v.z - wanted).abs() < 0.05, "peak: {v}");
    }
    let plateau = inflated(&circle, &with(Profile::Flat));
    assert!((top(&plateau) - 0.35).abs() < 0.01, "flat: {}", top(&plateau));
    let level = |v: &&DVec3| v.truncate().length() < 0.4 && v.z > 0.0;
    assert!(plateau.vertices.iter().filter(level).all(|v| v.z > 0.3));
}

#[test]
fn depth_scales_heights() {
    let patch = disk(10);
    let unit = inflated(&patch, &InflateOptions::default());
    for depth in [0.01, 0.5, 2.0, 10.0] {
        for profile in [Profile::Round, Profile::Flat, Profile::Peak] {
            let body = inflated(&patch, &InflateOptions { depth, profile, ..InflateOptions::default() });
            check_body("disk", &patch, &body);
        }
        let body = inflated(&patch, &InflateOptions { depth, ..InflateOptions::default() });
        // A spheroid, at whatever places its vertices lie.
        for v in &body.vertices {
            let radius = DVec3::new(v.x, v.y, v.z / depth).length();
            assert!((radius - 1.0).abs() < 0.01, "{depth}: {v}");
        }
        let volume = body.report.volume / unit.report.volume / depth;
        assert!((volume - 1.0).abs() < 0.1, "{depth}: {volume}");
    }
}

#[test]
fn sides_have_their_own_depths() {
    let patch = disk(8);
    let with = |front, back| InflateOptions { front, back, ..InflateOptions::default() };
    let relief = inflated(&patch, &with(None, Some(Side::Uniform(0.0))));
    check_body("relief", &patch, &relief);
    assert!(relief.vertices.iter().all(|v| v.z >= 0.0) && top(&relief) > 0.99);
    let deep = inflated(&patch, &with(Some(Side::Uniform(0.5)), Some(Side::Uniform(2.0))));
    check_body("deep", &patch, &deep);
    assert!((top(&deep) - 0.5).abs() < 0.01);
    let low = deep.vertices.iter().map(|v| v.z).fold(0.0, f64::min);
    assert!((low + 2.0).abs() < 0.03, "{low}");

    // Given by the position of the outline's points, the depth is linear inside as well.
    let values = patch.vertices[..patch.n_boundary()].iter().map(|p| 1.0 + 0.5 * p.x).collect::<Vec<_>>();
    let tilted = inflated(&patch, &with(Some(Side::PerPoint(values)), None));
    check_body("tilted", &patch, &tilted);
    for v in &tilted.vertices[patch.n_boundary()..patch.vertices.len()] {
        let sphere = (1.0 - v.truncate().length_squared()).sqrt();
        assert!((v.z / sphere / (1.0 + 0.5 * v.x) - 1.0).abs() < 0.02, "{v}");
    }
}

#[test]
fn data_of_the_outline_reaches_a_hole() {
    let patch = hex_patch(2, 6, |r, angle| r * DVec2::from_angle(angle));
    let front = Some(Side::PerPoint(vec![2.0; 36]));
    let body = inflated(&patch, &InflateOptions { front, ..InflateOptions::default() });
    check_body("ring", &patch, &body);
    let uniform = InflateOptions { front: Some(Side::Uniform(2.0)), ..InflateOptions::default() };
    let uniform = inflated(&patch, &uniform);
    assert!(body.vertices.iter().zip(&uniform.vertices).all(|(a, b)| a.distance(*b) < 1e-9));
}

#[test]
fn bad_options_are_refused() {
    let patch = disk(3);
    let refused = |options: InflateOptions| match inflate(&patch, &options, Progress::NONE) {
        Err(Error::InvalidOption { name, .. }) => name,
        other => panic!("{options:?} gave {other:?}"),
    };
    let plain = InflateOptions::default;
    for depth in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(refused(InflateOptions { depth, ..plain() }), "depth");
    }
    assert_eq!(refused(InflateOptions { corner_angle: f64::NAN, ..plain() }), "corner_angle");
    assert_eq!(refused(InflateOptions { front: Some(Side::Uniform(-1.0)), ..plain() }), "front");
    let nan = Some(Side::PerPoint(vec![f64::NAN; 18]));
    assert_eq!(refused(InflateOptions { back: nan, ..plain() }), "back");
    let short = Some(Side::PerPoint(vec![1.0; 5]));
    assert_eq!(refused(InflateOptions { back: short, ..plain() }), "back");
    let nothing = Some(Side::Uniform(0.0));
    assert_eq!(refused(InflateOptions { front: nothing.clone(), back: nothing, ..plain() }), "back");
}

#[test]
fn broken_patches_are_refused() {
    let mut turned = disk(3);
    let last = turned.vertices.len() - 1;
    turned.vertices[last] = DVec2::new(9.0, 9.0);
    assert!(matches!(
        inflate(&turned, &InflateOptions::default(), Progress::NONE),
        Err(Error::Solver { .. })
    ));
    turned.vertices[last] = DVec2::new(f64::NAN, 0.0);
    assert!(matches!(
        inflate(&turned, &InflateOptions::default(), Progress::NONE),
        Err(Error::Solver { .. })
    ));
    let mut single = disk(1);
    single.vertices = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
    single.triangles = vec![[0, 1, 2]];
    single.loops[0].arc.truncate(3);
    single.loops[0].source.truncate(3);
    single.loops[0].corner.truncate(3);
    assert!(matches!(
        inflate(&single, &InflateOptions::default(), Progress::NONE),
        Err(Error::Solver { .. })
    ));
}

#[test]
fn inflation_can_be_cancelled_at_every_report() {
    let patch = disk(5);
    let count = std::sync::atomic::AtomicUsize::new(0);
    let order = std::sync::atomic::Ordering::SeqCst;
    let all = |_| {
        count.fetch_add(1, order);
        true
    };
    inflate(&patch, &InflateOptions::default(), Progress::new(&all)).unwrap();
    let reports = count.load(order);
    assert!(reports > 5);
    for stop in 1..=reports {
        count.store(0, order);
        let until = |_| count.fetch_add(1, order) + 1 < stop;
        let result = inflate(&patch, &InflateOptions::default(), Progress::new(&until));
        assert_eq!(result, Err(Error::Cancelled), "at report {stop}");
    }
}

#[test]
fn the_same_patch_gives_the_same_bytes() {
    let patch = sketched(&drawings()[2].1, 800);
    let bits = || {
        let body = inflated(&patch, &InflateOptions::default());
        body.vertices.iter().flat_map(|v| v.to_array()).map(f64::to_bits).collect::<Vec<_>>()
    };
    assert_eq!(bits(), bits());
}

/// Moving or scaling the drawing moves or scales the body.
#[test]
fn position_and_size_do_not_matter() {
    let patch = sketched(&drawings()[1].1, 600);
    let body = inflated(&patch, &InflateOptions::default());
    for (scale, shift) in [(1e-6, DVec2::ZERO), (1e5, DVec2::new(3e5, -2e6)), (1.0, DVec2::splat(1e4))] {
        let mut moved = patch.clone();
        moved.vertices.iter_mut().for_each(|v| *v = *v * scale + shift);
        moved.lattice.origin = moved.lattice.origin * scale + shift;
        moved.lattice.edge_length *= scale;
        let other = inflated(&moved, &InflateOptions::default());
        assert!(other.report.embedded);
        for (a, b) in body.vertices.iter().zip(&other.vertices) {
            let back = (*b - shift.extend(0.0)) / scale;
            assert!(a.distance(back) < 1e-3 * patch.lattice.edge_length, "{a} {back}");
        }
    }
}

/// What the proof claims, the count must be able to refute.
#[test]
fn a_spoiled_body_meets_itself() {
    let patch = disk(6);
    let mut body = inflated(&patch, &InflateOptions::default());
    assert_eq!(count_self_intersections(&body.vertices, &body.triangles), 0);
    let middle = (0..patch.vertices.len()).max_by(|&a, &b| body.vertices[a].z.total_cmp(&body.vertices[b].z));
    body.vertices[middle.unwrap()].z = -1.5;
    assert!(count_self_intersections(&body.vertices, &body.triangles) >= 6);
}

/// Necks of anisotropic triangles: obtuse ones defeat the cotangent weights.
#[test]
fn squeezed_patches_survive() {
    for squeeze in [0.1, 0.01, 1e-3] {
        let patch = hex_patch(0, 6, |r, a| r * DVec2::new(a.cos(), squeeze * a.sin()));
        for profile in [Profile::Round, Profile::Even, Profile::Flat, Profile::Peak] {
            let body = inflated(&patch, &InflateOptions { profile, ..InflateOptions::default() });
            assert!(body.vertices.iter().all(|v| v.is_finite()) && body.report.watertight);
            assert!(is_mirrored(&patch, &body));
            assert_eq!(count_self_intersections(&body.vertices, &body.triangles), 0, "{squeeze} {profile:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Random star-shaped outlines, random shears of the interior: whatever triangulation it is,
    /// if its triangles are positive the body is embedded and finite.
    #[test]
    fn any_positive_patch_gives_an_embedded_body(
        waves in prop::collection::vec((-0.25f64..0.25, 0.0..TAU), 4),
        radius in 1i32..7,
        bias in 0.5f64..2.0,
        depth in 0.05f64..5.0,
        profile in 0..4usize,
        curve in prop::option::of(prop::collection::vec(0.01f64..2.0, 1..10)),
    ) {
        let outline = |a: f64| -> f64 {
            let sum: f64 = waves.iter().enumerate().map(|(k, w)| w.0 * ((k + 2) as f64 * a + w.1).cos()).sum();
            (1.0 + sum).max(0.15)
        };
        let patch = hex_patch(0, radius, |r, a| r.powf(bias) * outline(a) * DVec2::from_angle(a));
        prop_assume!(flat(&patch).report.embedded);
        let profile = [Profile::Round, Profile::Even, Profile::Flat, Profile::Peak][profile];
        let curve = curve.map(|values| [vec![0.0], values].concat());
        let body = inflated(&patch, &InflateOptions { depth, profile, curve, ..InflateOptions::default() });
        check_body("random", &patch, &body);
    }
}
