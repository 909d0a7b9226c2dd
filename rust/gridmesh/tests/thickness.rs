//! How thick the parts of drawings are.
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use glam::DVec2;
use gridmesh::drawing::thickness::{Limb, limbs};
use gridmesh::options::SketchOptions;
use gridmesh::progress::Progress;
use gridmesh::sketch::mesh_sketch;

/// A bar with round ends around the origin, counter-clockwise.
fn bar(length: f64, width: f64) -> Vec<DVec2> {
    let (r, half) = (0.5 * width, 0.5 * (length - width));
    let cap = |k: usize| PI * (k as f64 / 29.0 - 0.5);
    let right = (0..30).map(|k| DVec2::from_angle(cap(k)) * r + DVec2::new(half, 0.0));
    let left = (0..30).map(|k| DVec2::from_angle(cap(k) + PI) * r - DVec2::new(half, 0.0));
    right.chain(left).collect()
}

/// A round palm with fingers of these widths, between 30 and 150 degrees.
fn hand(widths: &[f64]) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = (0..60)
        .map(|k| DVec2::from_angle(PI * 5.0 / 6.0 + 0.25 + (PI * 4.0 / 3.0 - 0.5) * k as f64 / 59.0))
        .collect();
    for (k, &width) in widths.iter().enumerate() {
        let along = DVec2::from_angle(PI * (1.0 + 4.0 * k as f64 / (widths.len() - 1) as f64) / 6.0);
        let (across, r) = (along.perp(), 0.5 * width);
        let tip = 2.2 * along;
        points.push(0.95 * along - r * across);
        points.extend(
            (0..=20).map(|k| tip + r * DVec2::from_angle(PI * (k as f64 / 20.0 - 0.5)).rotate(along)),
        );
        points.push(0.95 * along + r * across);
    }
    points
}

fn widths(points: &[DVec2]) -> Vec<f64> {
    limbs(points, &[]).unwrap().iter().map(|limb| limb.width).collect()
}

fn assert_near(found: f64, wanted: f64, part: f64) {
    assert!((found / wanted - 1.0).abs() < part, "{found} is not about {wanted}");
}

#[test]
fn a_bar_has_its_width_and_length() {
    for width in [0.15, 0.3, 1.0, 3.0] {
        let found = limbs(&bar(10.0, width), &[]).unwrap();
        assert_near(found[0].width, width, 0.05);
        assert!(found[0].length > 4.0 && found[0].length < 11.5, "{found:?}");
        assert!(found[0].at.y.abs() < 0.1 * width, "{found:?}");
    }
}

#[test]
fn fingers_have_their_widths_thinnest_first() {
    let wanted = [0.1, 0.14, 0.18, 0.22, 0.26];
    let shuffled = [0.22, 0.1, 0.26, 0.14, 0.18];
    let found: Vec<f64> = widths(&hand(&shuffled)).into_iter().filter(|&width| width < 0.5).collect();
    assert_eq!(found.len(), 5, "{found:?}");
    for (found, wanted) in found.iter().zip(wanted) {
        assert_near(*found, wanted, 0.06);
    }
}

#[test]
fn a_disc_has_no_limb() {
    let circle: Vec<DVec2> = (0..90).map(|k| DVec2::from_angle(PI * k as f64 / 45.0)).collect();
    assert_eq!(limbs(&circle, &[]).unwrap(), Vec::<Limb>::new());
}

#[test]
fn the_wall_around_a_hole_is_a_limb() {
    let ring = |r: f64| (0..120).map(|k| r * DVec2::from_angle(PI * k as f64 / 60.0)).collect::<Vec<_>>();
    let found = limbs(&ring(1.0), &[ring(0.85)]).unwrap();
    assert_near(found[0].width, 0.15, 0.04);
}

#[test]
fn widths_turn_and_scale_with_the_drawing() {
    let points = hand(&[0.2, 0.12, 0.16, 0.12, 0.2]);
    let wanted = widths(&points);
    for scale in [1e-9, 0.3, 7.0, 1e9] {
        for turn in [0.0, 0.7, 2.0] {
            let shift = DVec2::new(3.0, -8.0) * scale;
            let moved: Vec<DVec2> =
                points.iter().map(|p| scale * DVec2::from_angle(turn).rotate(*p) + shift).collect();
            let found = widths(&moved);
            assert_eq!(found.len(), wanted.len());
            for (found, wanted) in found.iter().zip(&wanted) {
                assert_near(*found, scale * wanted, 0.02);
            }
        }
    }
}

#[test]
fn widths_do_not_depend_on_where_and_which_way_the_drawing_begins() {
    let points = hand(&[0.2, 0.12, 0.16, 0.1, 0.24]);
    let wanted = widths(&points);
    for begin in [1, 40, 101] {
        let mut other = points.clone();
        other.rotate_left(begin);
        for other in [other.clone(), other.into_iter().rev().collect()] {
            let found = widths(&other);
            assert_eq!(found.len(), wanted.len());
            for (found, wanted) in found.iter().zip(&wanted) {
                assert_near(*found, *wanted, 0.02);
            }
        }
    }
}

#[test]
fn the_automatic_number_puts_five_triangles_across_the_thinnest_limb() {
    let points = hand(&[0.2, 0.16, 0.2]);
    let options = SketchOptions { automatic: true, ..SketchOptions::default() };
    let report = mesh_sketch(&points, &[], &options, Progress::NONE).unwrap().report;
    let across = report.across.unwrap();
    assert!((4.5..5.6).contains(&across), "{across}");
    let given = SketchOptions { triangles: Some(2000), ..SketchOptions::default() };
    assert_eq!(mesh_sketch(&points, &[], &given, Progress::NONE).unwrap().report.across, None);
}

#[test]
fn a_slip_of_the_pen_is_no_limb() {
    // A thin spike a tenth as long as the drawing.
    let mut points = bar(10.0, 3.0);
    points.splice(30..30, [DVec2::new(0.05, 1.5), DVec2::new(0.04, 2.2), DVec2::new(-0.05, 1.5)]);
    assert_near(widths(&points)[0], 3.0, 0.05);
}
