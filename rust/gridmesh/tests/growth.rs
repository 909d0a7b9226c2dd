//! The boundary and its one move: identities that hold after every expansion.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use gridmesh::lattice::assemble::assemble;
use gridmesh::lattice::axial::Axial;
use gridmesh::lattice::boundary::{Boundary, Cell};
use gridmesh::lattice::cells::Layout;
use gridmesh::path::growth::{Watch, clear_chords, grow, straighten};
use gridmesh::progress::Progress;
use proptest::prelude::*;

const RADIUS: i32 = 9;

fn disk() -> Arc<Layout> {
    let corners =
        [Axial::new(-RADIUS, 0), Axial::new(RADIUS, 0), Axial::new(0, RADIUS), Axial::new(0, -RADIUS)];
    Arc::new(Layout::around(corners.into_iter(), RADIUS + 2))
}

fn within(p: Axial) -> bool {
    p.distance(Axial::default()) <= RADIUS
}

/// Adds points of a random set in a random order wherever they are valid.
fn random_boundary(seed: &[u16]) -> Boundary {
    let mut boundary = Boundary::hexagon(disk(), Axial::default()).unwrap();
    for &pick in seed {
        let path = boundary.path();
        let outer: Vec<Axial> = path.iter().flat_map(|&p| boundary.outer_neighbours(p)).collect();
        let point = outer[pick as usize % outer.len()];
        if let Some(expansion) = boundary.expansion(point).filter(|_| within(point)) {
            let (length, triangles, bend) = (boundary.length(), boundary.triangles(), boundary.bend());
            let change = boundary.bend_change(&expansion);
            boundary.expand(&expansion);
            assert_eq!(boundary.length() as i64, length as i64 + 2 - i64::from(expansion.edges));
            assert_eq!(boundary.triangles(), triangles + expansion.edges as usize);
            assert_eq!(boundary.bend(), bend + change);
            assert_eq!(boundary.turn(point), Some(3 - expansion.edges));
        }
    }
    boundary
}

fn chords(boundary: &Boundary) -> usize {
    boundary.path().iter().filter(|&&p| boundary.chord(p).is_some()).count()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_expansion_keeps_the_boundary_simple_and_closed(seed in prop::collection::vec(any::<u16>(), 0..300)) {
        let boundary = random_boundary(&seed);
        prop_assert_eq!(boundary.check(), Ok(()));
        let region = assemble(&[boundary.path()]);
        prop_assert_eq!(region.triangles.len(), boundary.triangles());
        for &p in &region.points {
            prop_assert!(boundary.cell(p) != Cell::Outside);
        }
    }

    #[test]
    fn chords_go_and_the_rest_stays(seed in prop::collection::vec(any::<u16>(), 0..300)) {
        let mut boundary = random_boundary(&seed);
        let before: Vec<Axial> = assemble(&[boundary.path()]).points;
        let cleared = clear_chords(&mut boundary, within);
        prop_assert_eq!(boundary.check(), Ok(()));
        prop_assert_eq!(cleared.is_ok(), chords(&boundary) == 0);
        for p in before {
            prop_assert!(!boundary.is_outside(p));
        }
    }

    #[test]
    fn straightening_lowers_the_bend_and_makes_no_chord(seed in prop::collection::vec(any::<u16>(), 0..300)) {
        let mut boundary = random_boundary(&seed);
        prop_assume!(clear_chords(&mut boundary, within).is_ok());
        let bend = boundary.bend();
        let added = straighten(&mut boundary, within, Progress::NONE).unwrap();
        prop_assert_eq!(boundary.check(), Ok(()));
        prop_assert_eq!(chords(&boundary), 0);
        prop_assert!(boundary.bend() < bend || added == 0);
        prop_assert!(boundary.bend() >= 6);
    }

    #[test]
    fn free_growth_fills_the_region_whatever_the_start(seed in prop::collection::vec(any::<u16>(), 0..60)) {
        let mut boundary = random_boundary(&seed);
        grow(&mut boundary, Watch::Point, |_, expansion| within(expansion.point), Progress::NONE).unwrap();
        prop_assert_eq!(boundary.check(), Ok(()));
        prop_assert_eq!(boundary.length() as i32, 6 * RADIUS);
        prop_assert_eq!(boundary.triangles() as i32, 6 * RADIUS * RADIUS);
    }
}

#[test]
fn the_step_of_figure_13_is_filled() {
    // A hexagon with a step on its eastern side, three by four.
    let within_step = |p: Axial| {
        p.distance(Axial::default()) <= 5 || (p.q > 0 && p.q + p.r <= 5 && p.r <= 0 && p.q <= 8 && p.r >= -4)
    };
    let mut boundary = Boundary::hexagon(disk(), Axial::default()).unwrap();
    grow(&mut boundary, Watch::Point, |_, e| within_step(e.point), Progress::NONE).unwrap();
    clear_chords(&mut boundary, within).unwrap();
    let bend = boundary.bend();
    straighten(&mut boundary, within, Progress::NONE).unwrap();
    assert_eq!(boundary.check(), Ok(()));
    assert!(boundary.bend() == 6 && bend >= 6, "{bend} {}", boundary.bend());
}

#[test]
fn a_fill_that_is_refused_midway_is_taken_back() {
    // The same step, but one lattice point of the parallelogram may not be used: no change, and no
    // endless loop.
    let blocked = Axial::new(6, -2);
    let step = |p: Axial| p.distance(Axial::default()) <= 4 || (p.r < 0 && p.r >= -4 && p.q >= 0 && p.q <= 8);
    let mut boundary = Boundary::hexagon(disk(), Axial::default()).unwrap();
    grow(&mut boundary, Watch::Point, |_, e| step(e.point) && within(e.point), Progress::NONE).unwrap();
    clear_chords(&mut boundary, within).unwrap();
    let was_outside = boundary.is_outside(blocked);
    straighten(&mut boundary, |p| within(p) && p != blocked, Progress::NONE).unwrap();
    assert_eq!(boundary.check(), Ok(()));
    assert!(!was_outside || boundary.is_outside(blocked));
}
