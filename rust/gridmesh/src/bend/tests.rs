//! Bends of whole drawings.

use std::f64::consts::{FRAC_PI_3, TAU};

use super::conformal::{Operators, keep_area};
use super::tangents::Tangents;
use super::*;
use crate::drawing::contours::read_contours;

fn ground(outline: &[DVec2], holes: &[Vec<DVec2>]) -> Result<Arc<Ground>> {
    ground_of(CellShape::Triangle, outline, holes)
}

fn ground_of(shape: CellShape, outline: &[DVec2], holes: &[Vec<DVec2>]) -> Result<Arc<Ground>> {
    let contours = read_contours(outline, holes)?;
    let frame = Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 };
    let found = Ground::new(&contours, frame, None, false, shape, Progress::NONE)?;
    found.map(Arc::new).ok_or(crate::error::Error::Solver { stage: "test", reason: "no carrier".to_owned() })
}

fn circle(radius: f64, centre: DVec2) -> Vec<DVec2> {
    (0..200).map(|i| centre + radius * DVec2::from_angle(TAU * f64::from(i) / 200.0)).collect()
}

fn bar(angle: f64, length: f64, width: f64) -> Vec<DVec2> {
    let ends = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let size = 0.5 * DVec2::new(length, width);
    ends.map(|e| DVec2::from_angle(angle).rotate(DVec2::from_array(e) * size)).to_vec()
}

/// The first rotation from a start angle, with its turns.
fn rotation(ground: &Ground, start: f64, beta: f64) -> Result<(Vec<f64>, usize)> {
    let tangents: Vec<Tangents> =
        ground.lines.iter().map(|line| Tangents::new(&line.points, &line.arcs)).collect();
    let (carrier, widths) = (&ground.carrier, &ground.widths);
    let operators = Operators::new(carrier, widths, &tangents, ground.shape, Progress::NONE)?;
    let robin = operators.robin(beta, Progress::NONE)?;
    let mut found = operators.rotations(&[start], (beta, &robin), (1.0, 1.0), Progress::NONE)?;
    let found = found.remove(0);
    Ok((found.v, found.turns))
}

#[test]
fn a_map_of_no_rotation_is_the_drawing() -> Result<()> {
    let ground = ground(&circle(12.0, DVec2::ZERO), &[])?;
    let carrier = &ground.carrier;
    let operators = Operators::new(
        carrier,
        &ground.widths,
        &[Tangents::new(&ground.lines[0].points, &ground.lines[0].arcs)],
        ground.shape,
        Progress::NONE,
    )?;
    let solver = operators.solver(Progress::NONE);
    let v = vec![0.4; carrier.vertices.len()];
    let mut u = solver.scale(&v)?;
    keep_area(carrier, &mut u);
    assert!(u.iter().all(|u| u.abs() < 1e-6));
    let image = solver.map(carrier, &u, &v)?;
    let shift = image[0] - DVec2::from_angle(0.4).rotate(carrier.vertices[0]);
    for (p, q) in carrier.vertices.iter().zip(&image) {
        assert!((DVec2::from_angle(0.4).rotate(*p) + shift).distance(*q) < 1e-6);
    }
    Ok(())
}

#[test]
fn a_bar_askew_is_turned_into_a_lattice_direction() -> Result<()> {
    let ground = ground(&bar(0.3, 60.0, 6.0), &[])?;
    let (v, turns) = rotation(&ground, 0.0, 3.0)?;
    assert_eq!(turns, 6);
    let middle = (0..v.len()).filter(|&i| ground.carrier.vertices[i].length() < 15.0);
    for i in middle {
        let off = (0.3 + v[i]) / FRAC_PI_3;
        assert!((off - off.round()).abs() * FRAC_PI_3 < 0.03, "{off}");
    }
    Ok(())
}

#[test]
fn dear_changes_at_first_leave_fewer_in_the_end() -> Result<()> {
    let mut fewer = 0;
    for phase in [0.0, 0.7, 1.4, 2.1] {
        // Lobes with re-entrant curves between them: each may be followed, or bent flat.
        let lobed: Vec<DVec2> = (0..400)
            .map(|i| {
                let t = TAU * f64::from(i) / 400.0;
                (20.0 + 3.0 * (3.0 * t + phase).sin() + 2.0 * (5.0 * t).sin()) * DVec2::from_angle(t)
            })
            .collect();
        let ground = ground(&lobed, &[])?;
        let tangents = [Tangents::new(&ground.lines[0].points, &ground.lines[0].arcs)];
        let operators =
            Operators::new(&ground.carrier, &ground.widths, &tangents, ground.shape, Progress::NONE)?;
        let robin = operators.robin(3.0, Progress::NONE)?;
        let turns = |first: f64| -> Result<usize> {
            let found = operators.rotations(&[0.0, 0.5], (3.0, &robin), (1.0, first), Progress::NONE)?;
            Ok(found.iter().map(|rotation| rotation.turns).sum())
        };
        let (plain, dear) = (turns(1.0)?, turns(3.0)?);
        assert!(dear <= plain, "{plain} {dear}");
        fewer += usize::from(dear < plain);
    }
    assert!(fewer > 0);
    Ok(())
}

#[test]
fn candidates_come_the_best_first_and_no_more_than_asked_for() -> Result<()> {
    for shape in [CellShape::Triangle, CellShape::Quad] {
        let ground = ground_of(shape, &bar(0.3, 60.0, 14.0), &[])?;
        let operators = ground.operators(Progress::NONE)?;
        for count in [1, 3] {
            let found = choose::candidates((&ground, &operators), 1.0, count, Progress::NONE)?;
            assert!(!found.is_empty() && found.len() <= count);
            assert!(found.windows(2).all(|two| two[0].1 <= two[1].1));
        }
    }
    Ok(())
}

#[test]
fn the_best_bend_of_quads_is_found_without_bending_all_rotations() -> Result<()> {
    let wavy = |lobes: f64| -> Vec<DVec2> {
        let at = |t: f64| (14.0 + 4.0 * libm::sin(lobes * t)) * DVec2::from_angle(t);
        (0..300).map(|i| at(TAU * f64::from(i) / 300.0)).collect()
    };
    for outline in [wavy(3.0), wavy(5.0), bar(0.3, 60.0, 14.0)] {
        let ground = ground_of(CellShape::Quad, &outline, &[])?;
        let operators = ground.operators(Progress::NONE)?;
        let costs = |count: usize| -> Result<Vec<f64>> {
            let found = choose::candidates((&ground, &operators), 1.0, count, Progress::NONE)?;
            Ok(found.into_iter().map(|(_, cost)| cost).collect())
        };
        let (few, all) = (costs(2)?, costs(usize::MAX)?);
        assert!((few[0] - all[0]).abs() < 0.5, "{few:?} {all:?}");
    }
    Ok(())
}

#[test]
fn turns_add_up_to_six_for_an_outline_and_for_a_hole() -> Result<()> {
    let hole: Vec<DVec2> = circle(5.0, DVec2::new(2.0, 1.0));
    let ground = ground(&circle(16.0, DVec2::ZERO), &[hole])?;
    for start in [0.0, 0.3, 0.8] {
        assert_eq!(rotation(&ground, start, 1.0)?.1, 12);
    }
    Ok(())
}

#[test]
fn the_way_back_leads_to_the_drawing() -> Result<()> {
    let wavy: Vec<DVec2> = (0..300)
        .map(|i| {
            let t = TAU * f64::from(i) / 300.0;
            (14.0 + 4.0 * (3.0 * t).cos() + 2.0 * (2.0 * t + 1.0).sin()) * DVec2::from_angle(t)
        })
        .collect();
    let ground = ground(&wavy, &[])?;
    let operators = ground.operators(Progress::NONE)?;
    let bends = choose::candidates((&ground, &operators), 1.0, 2, Progress::NONE)?;
    assert!(!bends.is_empty());
    for (bent, _) in bends {
        let carrier = &ground.carrier;
        let way = WayBack::new(carrier, &bent.image);
        for (p, q) in carrier.vertices.iter().zip(&bent.image.positions) {
            assert!(way.at(*q).distance(*p) < 1e-9);
        }
        // Arc lengths lead to points whose images they came from.
        let (contour, line) = (&bent.contours()[0], &ground.lines[0]);
        for k in 0..200 {
            let s = contour.length() * f64::from(k) / 200.0;
            let drawn = bent.drawing.drawn_arc(0, s).rem_euclid(line.length());
            assert!(way.at(contour.point_at(s)).distance(line.at(drawn)) < 0.3);
        }
        assert!(bent.scale_range() > 1.0 && bent.scale_range() < 20.0);
    }
    Ok(())
}
