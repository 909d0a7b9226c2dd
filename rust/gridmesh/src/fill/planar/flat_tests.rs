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
    let vertices = n + fill.patch.interior.len();
    let mut edges: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for t in &fill.patch.triangles {
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    assert!(edges.values().all(|&count| count == 1), "an edge occurs twice in one direction");
    let open: BTreeSet<(u32, u32)> =
        edges.keys().copied().filter(|&(a, b)| !edges.contains_key(&(b, a))).collect();
    let rim: BTreeSet<(u32, u32)> = (0..n as u32).map(|k| (k, (k + 1) % n as u32)).collect();
    assert_eq!(open, rim);
    let used: BTreeSet<u32> = fill.patch.triangles.iter().flatten().copied().collect();
    assert_eq!(used.len(), vertices);
    let undirected = (edges.len() + n) / 2;
    assert_eq!(vertices + fill.patch.triangles.len(), undirected + 1, "not a disk");
    for &(a, b) in edges.keys().filter(|e| !rim.contains(e) && !rim.contains(&(e.1, e.0))) {
        let (i, j) = (a.min(b) as usize, a.max(b) as usize);
        assert!(j >= n || !taken(i, j), "edge {i} {j} is taken");
    }
    let positions = [polygon, &fill.patch.interior].concat();
    let centre = polygon.iter().sum::<DVec2>() / n as f64;
    let embedded = crate::relax::first_inverted(&positions, &fill.patch.triangles, centre).is_none();
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
        let turns: f64 = Loop::new(&polygon, Progress::NONE).unwrap().turning.iter().sum();
        prop_assume!((turns - std::f64::consts::TAU).abs() < 1e-6);
        let widest = (0..n).map(|k| polygon[k].angle_to(polygon[(k + 1) % n])).fold(0.0, |a: f64, b| a.max(b.abs()));
        prop_assume!(widest < 3.0);
        // About one pair in four has an edge already.
        let taken = |i: usize, j: usize| seed > 0 && n > 3 && (i * 7 + j * 13 + seed).is_multiple_of(4);
        let made = fill(&polygon, &taken);
        check(&polygon, &made, &taken);
        prop_assert!(!made.folded);
    }

    #[test]
    fn any_points_get_a_disk(
        points in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 3..40), all in any::<bool>()
    ) {
        let polygon: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
        let taken = |_: usize, _: usize| all;
        let made = fill(&polygon, &taken);
        check(&polygon, &made, &taken);
    }
}

#[test]
fn even_round_loops_are_regular_inside() {
    for n in (6..60).filter(|&n| n != 7) {
        let polygon: Vec<DVec2> =
            (0..n).map(|k| DVec2::from_angle(std::f64::consts::TAU * k as f64 / n as f64)).collect();
        let made = fill(&polygon, &none);
        check(&polygon, &made, &none);
        assert_eq!((made.folded, made.quality.irregular), (false, 0), "{n}");
        assert!(made.quality.min_angle > 0.35, "{n}: {}", made.quality.min_angle);
    }
}

#[test]
fn loops_on_a_line_and_points_that_coincide_are_filled_folded() {
    let line: Vec<DVec2> = (0..7).map(|k| DVec2::new(f64::from(k), 0.0)).collect();
    let made = fill(&line, &none);
    check(&line, &made, &none);
    assert!(made.folded);
    let point = [DVec2::ZERO; 8];
    check(&point, &fill(&point, &none), &none);
}

#[test]
fn long_edges_beside_short_ones_are_filled() {
    // One edge of a square is split a hundred times.
    let mut polygon: Vec<DVec2> = (0..100).map(|k| DVec2::new(0.01 * f64::from(k), 0.0)).collect();
    polygon.extend([(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from));
    let made = fill(&polygon, &none);
    check(&polygon, &made, &none);
    assert!(!made.folded);
    assert!(made.quality.min_angle > 0.06, "{}", made.quality.min_angle);
    assert!(made.patch.triangles.len() < 2000, "{}", made.patch.triangles.len());
}

#[test]
fn the_same_loop_gives_the_same_bytes() {
    let polygon: Vec<DVec2> = (0..40)
        .map(|k| DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 40.0 + 0.1 * f64::from(k).sin()))
        .collect();
    let (a, b) = (fill(&polygon, &none), fill(&polygon, &none));
    assert_eq!((a.patch.interior, a.patch.triangles), (b.patch.interior, b.patch.triangles));
}

#[test]
fn bad_input_is_refused() {
    let call = |p: &[DVec2]| fill_flat(p, &vec![4; p.len()], &none, &FlatOptions::default(), Progress::NONE);
    assert!(matches!(call(&[DVec2::ZERO, DVec2::X]), Err(Error::TooFewPoints { .. })));
    assert!(matches!(call(&[DVec2::ZERO, DVec2::X, DVec2::NAN]), Err(Error::NotFinite { point: 2, .. })));
}

/// A curved outline as a cut through a mesh leaves it: edges of every length up to one, in any order.
fn crossed(n: usize, waves: f64, seed: u64) -> Vec<DVec2> {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let steps: Vec<f64> = (0..n).map(|_| 0.002 + random()).collect();
    let sum: f64 = steps.iter().sum();
    let mut angle = 0.0;
    let point = |step: &f64| {
        angle += std::f64::consts::TAU * step / sum;
        DVec2::from_angle(angle) * (1.0 + 0.1 * (waves * angle).sin())
    };
    steps.iter().map(point).collect()
}

#[test]
fn a_loop_as_a_cut_leaves_it_gets_a_patch_as_coarse_as_its_long_edges() {
    for (n, waves, seed) in [(301, 0.0, 1), (400, 3.0, 2), (640, 5.0, 3)] {
        let polygon = crossed(n, waves, seed);
        // Some edges across exist already.
        let taken = |i: usize, j: usize| (i + j).is_multiple_of(5);
        let fill = |thin| {
            let options = FlatOptions { thin, enough: 2.0, angles: 3, placed: 1, ..FlatOptions::default() };
            match fill_flat(&polygon, &vec![4; n], &taken, &options, Progress::NONE) {
                Ok(fill) => fill,
                Err(error) => panic!("{error}"),
            }
        };
        let (thin, whole) = (fill(true), fill(false));
        check(&polygon, &thin, &taken);
        assert!(!thin.folded);
        assert!(
            2 * thin.patch.triangles.len() < whole.patch.triangles.len(),
            "{n}: {}",
            thin.patch.triangles.len()
        );
        assert!(thin.quality.mean_ratio > 0.92, "{n}: {}", thin.quality.mean_ratio);
        assert!(10 * thin.quality.irregular < thin.quality.interior, "{n}: {:?}", thin.quality);
    }
}

#[test]
fn a_loop_that_crosses_itself_is_folded_there_alone() {
    for n in [60, 200, 500] {
        let mut polygon = crossed(n, 4.0, 6);
        polygon.swap(n / 4, n / 4 + 3);
        polygon.swap(n / 2, n / 2 + 2);
        for thin in [false, true] {
            let options = FlatOptions { thin, ..FlatOptions::default() };
            let fill = match fill_flat(&polygon, &vec![4; n], &none, &options, Progress::NONE) {
                Ok(fill) => fill,
                Err(error) => panic!("{error}"),
            };
            check(&polygon, &fill, &none);
            let positions = [polygon.as_slice(), &fill.patch.interior].concat();
            let is_inverted = |t: &&[u32; 3]| {
                let [a, b, c] = t.map(|v| positions[v as usize]);
                (b - a).perp_dot(c - a) <= 0.0
            };
            let inverted = fill.patch.triangles.iter().filter(is_inverted).count();
            assert!(fill.folded && inverted <= 16, "{n}: {inverted} of {}", fill.patch.triangles.len());
        }
    }
}

#[test]
fn a_large_uneven_loop_gets_a_lattice() {
    let polygon = crossed(900, 3.0, 4);
    let options = FlatOptions { angles: 3, placed: 1, ..FlatOptions::default() };
    let fill = match fill_flat(&polygon, &[4; 900], &none, &options, Progress::NONE) {
        Ok(fill) => fill,
        Err(error) => panic!("{error}"),
    };
    check(&polygon, &fill, &none);
    assert_eq!((fill.method, fill.quality.irregular, fill.folded), (Method::Optimal, 0, false));
}
