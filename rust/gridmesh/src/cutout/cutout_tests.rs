//! Tests of the search for numbers of cells, and of whole pictures.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::DVec2;

use super::*;
use crate::body::inflate::InflateOptions;
use crate::cutout::lacks::Lacks;
use crate::drawing::combine::Part;

fn ring(n: usize, radius: f64, middle: DVec2) -> Vec<DVec2> {
    (0..n).map(|k| middle + radius * DVec2::from_angle(TAU * k as f64 / n as f64)).collect()
}

fn disk(radius: f64, middle: [f64; 2]) -> Part {
    Part { outline: ring(120, radius, middle.into()), holes: vec![] }
}

/// A star with sharp tips.
fn star() -> Part {
    let corner = |k: usize| {
        let radius = if k.is_multiple_of(2) { 56.0 } else { 24.0 };
        DVec2::splat(200.0) + radius * DVec2::from_angle(TAU * k as f64 / 10.0 + 0.2)
    };
    Part { outline: (0..10).map(corner).collect(), holes: vec![] }
}

fn cells(cutout: &Cutout) -> usize {
    let of = |surface: &Result<Surface>| {
        let surface = surface.as_ref().unwrap();
        surface.triangles.len() + surface.quads.len()
    };
    cutout.surfaces.iter().map(of).sum()
}

/// Numbers that look random, from 0 to 3.
fn worths(seed: u32) -> BTreeMap<Step, f64> {
    let mut state = seed.wrapping_mul(747_796_405).wrapping_add(1);
    let mut step = Step::nearest(40.0);
    let mut all = BTreeMap::new();
    for _ in 0..140 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        all.insert(step, [0.0, 0.3, 1.0, 3.0][(state >> 24) as usize % 4]);
        step = step.next();
    }
    all
}

#[test]
fn the_best_step_only_rises_with_the_number_asked_for() {
    for seed in 0..50 {
        let worths = worths(seed);
        let made = |step: Step, score: f64| {
            let made = Made { surface: Ok(Surface::default()), step, lacks: Lacks::of_area(worths[&step]) };
            Ok((made.score() < score).then_some(made))
        };
        let mut before = Step::nearest(1.0);
        for number in (100..1500).step_by(25) {
            let asked = Step::nearest(f64::from(number));
            let step = best(asked, f64::from(number), 250.0, made).unwrap().unwrap().step;
            assert!(step >= before && step >= asked);
            assert!(worths[&asked] > 0.0 || step == asked);
            before = step;
        }
    }
}

#[test]
fn only_what_is_too_coarse_is_tried_finer() {
    let refused = |error: &Error, most: f64| {
        let tries = std::cell::Cell::new(0);
        let found = best(Step::nearest(500.0), 500.0, most, |step, _| {
            tries.set(tries.get() + 1);
            Ok(Some(Made { surface: Err(error.clone()), step, lacks: Lacks::default() }))
        });
        (found.unwrap().unwrap().surface.unwrap_err(), tries.get())
    };
    let thin = Error::NoPatch { reason: "too thin".into(), at: [0.0, 0.0] };
    assert_eq!(refused(&thin, 1.0), (thin.clone(), 1));
    let (error, tries) = refused(&thin, 250.0);
    assert_eq!(error, thin);
    assert!(tries > 20);
    let wrong = Error::ZeroArea { what: "outline".into() };
    assert_eq!(refused(&wrong, 250.0), (wrong, 1));
}

#[test]
fn parts_share_the_number_and_have_edges_of_one_length() {
    let parts = [disk(40.0, [50.0, 50.0]), disk(20.0, [150.0, 50.0])];
    for cells_ in [CellShape::Triangle, CellShape::Quad] {
        for body in [None, Some(InflateOptions::default())] {
            for rim in [CutoutRim::On, CutoutRim::Across, CutoutRim::Around { margin: 1.0 }] {
                let options = CutoutOptions {
                    number: 800,
                    cells: cells_,
                    rim,
                    body: body.clone(),
                    ..Default::default()
                };
                let cutout = mesh_cutout(&parts, &options, Progress::NONE).unwrap();
                let sides = if body.is_some() { 2.0 } else { 1.0 };
                let given = cells(&cutout) as f64 / sides;
                assert!((given / 800.0 - 1.0).abs() < 0.2, "{given} {options:?}");
                let [large, small] = [0, 1].map(|k| cutout.surfaces[k].as_ref().unwrap().vertices.len());
                assert!((2.5..6.0).contains(&(large as f64 / small as f64)), "{large} {small}");
                for surface in cutout.surfaces.iter().flatten() {
                    assert_eq!(surface.report.watertight, body.is_some());
                }
            }
        }
    }
}

#[test]
fn tips_take_more_cells_and_fewer_asked_for_never_give_more() {
    let parts = [star()];
    for body in [None, Some(InflateOptions::default())] {
        let mut before = 0;
        for number in [100, 200, 300, 500] {
            let rim = CutoutRim::Around { margin: 1.0 };
            let options = CutoutOptions { number, rim, body: body.clone(), ..Default::default() };
            let cutout = mesh_cutout(&parts, &options, Progress::NONE).unwrap();
            let given = cells(&cutout);
            // One size of a mesh varies by some faces with the place of the lattice.
            assert!(given * 21 > before * 20, "{number}: {given} after {before}");
            before = given;
            let sides = if body.is_some() { 2 } else { 1 };
            assert_eq!(cutout.finer.is_some(), given as f64 > 1.2 * (sides * number) as f64);
        }
    }
}

#[test]
fn a_part_that_cannot_be_meshed_does_not_stop_the_others() {
    let crossed = [[120.0, 0.0], [180.0, 60.0], [180.0, 0.0], [120.0, 70.0]].map(DVec2::from).to_vec();
    let parts = [disk(40.0, [50.0, 50.0]), Part { outline: crossed, holes: vec![] }];
    let cutout = mesh_cutout(&parts, &CutoutOptions::default(), Progress::NONE).unwrap();
    assert!(cutout.surfaces[0].is_ok());
    assert!(matches!(cutout.surfaces[1], Err(Error::SelfIntersecting { .. })));
    let nowhere = Part { outline: ring(20, 10.0, DVec2::NAN), holes: vec![] };
    let cutout = mesh_cutout(&[disk(40.0, [50.0, 50.0]), nowhere], &CutoutOptions::default(), Progress::NONE);
    let surfaces = cutout.unwrap().surfaces;
    assert!(surfaces[0].is_ok());
    assert!(matches!(surfaces[1], Err(Error::NotFinite { .. })));
}

#[test]
fn what_cannot_be_meshed_takes_no_cells_from_the_others() {
    let good = disk(40.0, [50.0, 50.0]);
    let alone = mesh_cutout(std::slice::from_ref(&good), &CutoutOptions::default(), Progress::NONE).unwrap();
    let larger_hole = Part { holes: vec![ring(40, 80.0, DVec2::splat(50.0))], ..good.clone() };
    let vast = Part { outline: ring(20, 1e100, DVec2::ZERO), holes: vec![] };
    let crossed = [[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]].map(DVec2::from).to_vec();
    let crossed = Part { outline: crossed, holes: vec![] };
    for (bad, kind) in [
        (larger_hole, "hole_misplaced"),
        (vast, "extreme_size"),
        (crossed, "self_intersecting"),
        (Part::default(), "too_few_points"),
    ] {
        let refused = |cutout: &Cutout| cutout.surfaces[0].as_ref().map(|_| ()).map_err(Error::kind);
        let both = [bad.clone(), good.clone()];
        let both = mesh_cutout(&both, &CutoutOptions::default(), Progress::NONE).unwrap();
        let faces = both.surfaces[1].as_ref().unwrap().triangles.len();
        assert_eq!((refused(&both), faces), (Err(kind), cells(&alone)));
        let one = mesh_cutout(&[bad], &CutoutOptions::default(), Progress::NONE).unwrap();
        assert_eq!(refused(&one), Err(kind));
    }
}

#[test]
fn options_that_are_not_allowed_are_refused() {
    let parts = [disk(40.0, [50.0, 50.0])];
    let around = |margin| CutoutRim::Around { margin };
    let base = CutoutOptions::default;
    for (options, wrong) in [
        (CutoutOptions { number: 0, ..base() }, "triangles"),
        (CutoutOptions { number: 0, cells: CellShape::Quad, ..base() }, "quads"),
        (CutoutOptions { faint: f64::NAN, ..base() }, "faint"),
        (CutoutOptions { most: 0.5, ..base() }, "most"),
        (CutoutOptions { rim: around(0.0), ..base() }, "margin"),
        (CutoutOptions { rim: around(f64::INFINITY), ..base() }, "margin"),
        (
            CutoutOptions { body: Some(InflateOptions { depth: 1e300, ..Default::default() }), ..base() },
            "depth",
        ),
    ] {
        let made = mesh_cutout(&parts, &options, Progress::NONE);
        assert!(matches!(made, Err(Error::InvalidOption { name, .. }) if name == wrong), "{wrong}");
    }
    assert!(mesh_cutout(&[], &base(), Progress::NONE).unwrap().surfaces.is_empty());
    let stop = |_: f64| false;
    assert!(matches!(mesh_cutout(&parts, &base(), Progress::new(&stop)), Err(Error::Cancelled)));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let parts = [star(), disk(30.0, [50.0, 50.0]), disk(4.0, [100.0, 50.0])];
    let options = CutoutOptions { number: 300, rim: CutoutRim::Around { margin: 1.0 }, ..Default::default() };
    let [one, many] = [1, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut cutout = pool.install(|| mesh_cutout(&parts, &options, Progress::NONE)).unwrap();
        for surface in cutout.surfaces.iter_mut().flatten() {
            surface.report.seconds.clear();
        }
        (cutout.surfaces, cutout.finer)
    });
    assert_eq!(one, many);
}
