//! Properties of flat fills.

use super::*;
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

fn none(_: usize, _: usize) -> bool {
    false
}

fn fill(polygon: &[DVec2], taken: &(dyn Fn(usize, usize) -> bool + Sync)) -> FlatFill {
    let wanted = vec![4; polygon.len()];
    match fill_flat(polygon, &wanted, taken, &FlatOptions::default(), Progress::NONE) {
        Ok(fill) => fill,
        Err(error) => panic!("{error}: {polygon:?}"),
    }
}

/// A disk whose boundary is the loop, counter-clockwise, without an edge that is taken.
fn check(polygon: &[DVec2], fill: &FlatFill, taken: &dyn Fn(usize, usize) -> bool) {
    let n = polygon.len();
    let vertices = n + fill.interior.len();
    let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for t in &fill.triangles {
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    assert!(edges.values().all(|&count| count == 1), "an edge occurs twice in one direction");
    let open: BTreeSet<(u32, u32)> =
        edges.keys().copied().filter(|&(a, b)| !edges.contains_key(&(b, a))).collect();
    let rim: BTreeSet<(u32, u32)> = (0..n as u32).map(|k| (k, (k + 1) % n as u32)).collect();
    assert_eq!(open, rim);
    let used: BTreeSet<u32> = fill.triangles.iter().flatten().copied().collect();
    assert_eq!(used.len(), vertices);
    let undirected = (edges.len() + n) / 2;
    assert_eq!(vertices + fill.triangles.len(), undirected + 1, "not a disk");
    for &(a, b) in edges.keys().filter(|e| !rim.contains(e) && !rim.contains(&(e.1, e.0))) {
        let (i, j) = (a.min(b) as usize, a.max(b) as usize);
        assert!(j >= n || !taken(i, j), "edge {i} {j} is taken");
    }
    let positions = [polygon, &fill.interior].concat();
    let centre = polygon.iter().sum::<DVec2>() / n as f64;
    let embedded = crate::relax::first_inverted(&positions, &fill.triangles, centre).is_none();
    assert_eq!(embedded, !fill.folded);
}

/// Loops that wind once around the origin, with edges of very different lengths.
fn star_shaped() -> impl Strategy<Value = Vec<DVec2>> {
    prop::collection::vec((0.05..1.0f64, 0.4..1.6f64), 3..70).prop_map(|parts| {
        let sum: f64 = parts.iter().map(|p| p.0).sum();
        let mut angle = 0.0;
        let point = |(step, radius): &(f64, f64)| {
            angle += std::f64::consts::TAU * step / sum;
            DVec2::from_angle(angle) * *radius
        };
        parts.iter().map(point).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn simple_loops_get_disks_that_are_not_folded(polygon in star_shaped(), seed in 0usize..5) {
        let n = polygon.len();
        let turns: f64 = Loop::new(&polygon).turning.iter().sum();
        prop_assume!((turns - std::f64::consts::TAU).abs() < 1e-6);
        let widest = (0..n).map(|k| polygon[k].angle_to(polygon[(k + 1) % n])).fold(0.0, |a: f64, b| a.max(b.abs()));
        prop_assume!(widest < 3.0);
        // About one pair in four has an edge already.
        let taken = |i: usize, j: usize| seed > 0 && n > 3 && (i * 7 + j * 13 + seed).is_multiple_of(4);
        let patch = fill(&polygon, &taken);
        check(&polygon, &patch, &taken);
        prop_assert!(!patch.folded);
    }

    #[test]
    fn any_points_get_a_disk(
        points in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 3..40), all in any::<bool>()
    ) {
        let polygon: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
        let taken = |_: usize, _: usize| all;
        let patch = fill(&polygon, &taken);
        check(&polygon, &patch, &taken);
    }
}

#[test]
fn even_round_loops_are_regular_inside() {
    for n in (6..60).filter(|&n| n != 7) {
        let polygon: Vec<DVec2> =
            (0..n).map(|k| DVec2::from_angle(std::f64::consts::TAU * k as f64 / n as f64)).collect();
        let patch = fill(&polygon, &none);
        check(&polygon, &patch, &none);
        assert_eq!((patch.folded, patch.quality.irregular), (false, 0), "{n}");
        assert!(patch.quality.min_angle > 0.35, "{n}: {}", patch.quality.min_angle);
    }
}

#[test]
fn loops_on_a_line_and_points_that_coincide_are_filled_folded() {
    let line: Vec<DVec2> = (0..7).map(|k| DVec2::new(f64::from(k), 0.0)).collect();
    let patch = fill(&line, &none);
    check(&line, &patch, &none);
    assert!(patch.folded);
    let point = [DVec2::ZERO; 8];
    check(&point, &fill(&point, &none), &none);
}

#[test]
fn long_edges_beside_short_ones_are_filled() {
    // One edge of a square is split a hundred times.
    let mut polygon: Vec<DVec2> = (0..100).map(|k| DVec2::new(0.01 * f64::from(k), 0.0)).collect();
    polygon.extend([(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from));
    let patch = fill(&polygon, &none);
    check(&polygon, &patch, &none);
    assert!(!patch.folded);
    assert!(patch.quality.min_angle > 0.06, "{}", patch.quality.min_angle);
    assert!(patch.triangles.len() < 2000, "{}", patch.triangles.len());
}

#[test]
fn the_same_loop_gives_the_same_bytes() {
    let polygon: Vec<DVec2> = (0..40)
        .map(|k| DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 40.0 + 0.1 * f64::from(k).sin()))
        .collect();
    let (a, b) = (fill(&polygon, &none), fill(&polygon, &none));
    assert_eq!((a.interior, a.triangles), (b.interior, b.triangles));
}

#[test]
fn bad_input_is_refused() {
    let call = |p: &[DVec2]| fill_flat(p, &vec![4; p.len()], &none, &FlatOptions::default(), Progress::NONE);
    assert!(matches!(call(&[DVec2::ZERO, DVec2::X]), Err(Error::TooFewPoints { .. })));
    assert!(matches!(call(&[DVec2::ZERO, DVec2::X, DVec2::NAN]), Err(Error::NotFinite { point: 2, .. })));
}
