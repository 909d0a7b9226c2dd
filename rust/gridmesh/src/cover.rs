//! Patches that cover what was drawn: outlines moved outward where the edges of a mesh cut them off.
//!
//! [`cover_sketch`] meshes an outline and places the mesh a few times more, each time on an outline moved outward where it was left outside (`outside`, `outward`), as far as there is room (`room`), then
//! moves ends of short edges apart (`short`), single vertices to tips (`tips`), splits edges there if that is asked for (`split`), and others back into inlets (`tight`), until the boundary is as near around as it can be (`across`). Patches that are to
//! lie [`Rim::Across`] their outline are meshed once, and their boundary vertices are moved until they do (`across`).

mod across;
mod boundary;
mod outside;
mod outward;
mod room;
mod short;
mod split;
mod tight;
mod tips;

use glam::DVec2;

use crate::cover::boundary::keeps_side;
use crate::cover::outside::{Followers, LoopEdges, loop_of};
use crate::cover::outward::{moved_outward, normals, spread};
use crate::drawing::contours::read_contours;
use crate::drawing::curve::ClosedCurve;
use crate::drawing::union::{nearest_sources, outer_outline};
use crate::error::{Error, Result, told};
use crate::options::{CellShape, SelfCrossing, SketchOptions};
use crate::patch::Patch;
use crate::patch::angles::min_angle;
use crate::progress::Progress;
use crate::sketch::again::placed_again;
use crate::sketch::{Sketch, mesh_sketch};

/// Patches made at most after the first, each of a wider outline.
const ROUNDS: usize = 3;

/// What may stay outside, in edge lengths, when no wider outline is tried any more: at 500 triangles a few hundredths of a
/// pixel of a picture 64 pixels wide.
const ENOUGH: f64 = 0.01;

/// How far an outline is moved at most, in edge lengths: tips that the mesh cannot follow are left to single vertices.
const MOST: f64 = 0.25;

/// Where a wider outline would cross itself it is moved less so far to each side, in edge lengths.
const FOLDS: f64 = 0.5;

/// How far beyond the drawing the edges of quads that lie across it may come to lie when they are made longer, in edge lengths.
const EMPTY: f64 = 0.1;

/// Points of a contour for each edge of the mesh: where it is compared with the mesh.
const POINTS_OF_EDGE: f64 = 5.0;

/// A patch that covers its drawing.
#[derive(Clone, Debug)]
pub struct Covering {
    /// The patch. Its boundary lies on outlines that were moved outward; `source` tells the nearest points of the given
    /// contours, `arc` lengths along the moved ones.
    pub sketch: Sketch,
    /// How far the drawing still reaches beyond the patch and the slack, in the units of the outline.
    pub outside: f64,
    /// The area between the boundary and the contours, of that of the drawing.
    pub between: f64,
}

/// How the boundary lies to the contours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rim {
    /// Nothing of the drawing is outside, but for a rim of this width.
    Around(f64),
    /// The same, and edges of triangles are split where more than `beyond` of the drawing would still be outside, besides the slack: inner
    /// vertices there have a valence of seven or more.
    Whole {
        /// The width of the rim.
        slack: f64,
        /// How far outside, in the units of the outline.
        beyond: f64,
    },
    /// Edges lie across the contours, so that the area between is least: about as much of the drawing is outside as there is more.
    Across,
}

/// Meshes the inside of a drawing as [`mesh_sketch`] does, but so that the patch covers the drawing, except a rim of
/// the width of [`Rim::Around`]: where boundary edges would cut off what is drawn the outline is moved outward, by a quarter of an
/// edge at most, and single vertices are moved to tips. For pictures on meshes, whose opaque pixels must not be cut off.
///
/// With [`Rim::Across`] single vertices are moved to tips and the boundary then to where the area between it and the contours is
/// least, as far as faces and edges stay as they should be. For bodies, whose silhouettes are those of pictures.
///
/// [`Rim::Whole`] splits boundary edges besides, where tips would be left outside. Otherwise topology, valences and orientation are as of [`mesh_sketch`]; boundary vertices lie near the contours, not on them.
/// Takes the time of a mesh, and of placing it up to three times more.
///
/// # Errors
/// Those of [`mesh_sketch`]; [`Error::InvalidOption`] if the slack is negative or not finite, or what may be beyond it no length.
pub fn cover_sketch(
    outline: &[DVec2],
    holes: &[Vec<DVec2>],
    rim: Rim,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Covering> {
    let (rim, slack, beyond) = match rim {
        Rim::Around(slack) => (rim, slack, f64::INFINITY),
        Rim::Whole { slack, beyond } => (Rim::Around(slack), slack, beyond),
        Rim::Across => (rim, 0.0, f64::INFINITY),
    };
    if !(slack.is_finite() && slack >= 0.0) {
        let allowed = "a finite length, at least 0";
        return Err(Error::InvalidOption { name: "slack", value: told(slack), allowed });
    }
    if beyond.is_nan() || beyond < 0.0 {
        let allowed = "a finite length, at least 0";
        return Err(Error::InvalidOption { name: "beyond", value: told(beyond), allowed });
    }
    let part = |k: usize| progress.part(k as f64 / (ROUNDS + 1) as f64, (k + 1) as f64 / (ROUNDS + 1) as f64);
    let first = mesh_sketch(outline, holes, options, part(0))?;
    let edge_length = first.patch.lattice.edge_length;
    let contours = match options.self_crossing {
        SelfCrossing::Error => read_contours(outline, holes)?,
        SelfCrossing::Union => read_contours(&outer_outline(outline, "outline")?.0, holes)?,
    };
    let fine: Vec<Vec<DVec2>> =
        contours.iter().map(|contour| dense(contour, edge_length / POINTS_OF_EDGE)).collect();
    let rounds = if rim == Rim::Across { 0 } else { ROUNDS };
    let Followed { sketch: mut best, meshed, .. } = widened(first, &fine, slack, options, rounds, &part)?;
    let drawn = contours[0].area() - contours[1..].iter().map(ClosedCurve::area).sum::<f64>();
    let mut measures = Vec::new();
    // The patch first, then the one for bodies.
    best.patch.both(|patch| {
        let mut followers = followers_of(patch, &meshed);
        let least = finished(patch, &fine, &mut followers, (rim, slack, beyond), progress)?;
        let between = across::between(patch, &fine, &followers) / drawn;
        measures.push((least, between));
        for (contour, own) in
            patch.loops.iter_mut().zip(std::iter::once(outline).chain(holes.iter().map(Vec::as_slice)))
        {
            let vertices = &patch.vertices[contour.start as usize..];
            contour.source = nearest_sources(own, &vertices[..contour.source.len()]);
        }
        Ok(())
    })?;
    let (outside, between) = measures[0];
    best.report.min_angle = min_angle(&best.patch);
    best.report.triangles = best.patch.triangles.len();
    progress.report(1.0)?;
    Ok(Covering { sketch: best, outside, between })
}

/// Moves single vertices of a patch; returns how far the drawing reaches beyond it then.
fn finished(
    patch: &mut Patch,
    fine: &[Vec<DVec2>],
    followers: &mut [Followers],
    (rim, slack, beyond): (Rim, f64, f64),
    progress: Progress<'_>,
) -> Result<f64> {
    let enough = ENOUGH * patch.lattice.edge_length;
    let left = needs(fine, patch, followers, slack);
    // Quads are small in tips; those of bodies would crumple there to be longer.
    let (deep, far) = match (rim, patch.cells()) {
        (Rim::Across, CellShape::Quad) => (depths(fine, patch, followers), EMPTY * patch.lattice.edge_length),
        _ => (Vec::new(), f64::INFINITY),
    };
    // Boundary vertices may move where no more is cut off by that than is outside there as it is, nor more is left empty.
    let may = |patch: &Patch, vertex: usize| {
        let k = patch.loops.iter().rposition(|contour| contour.start as usize <= vertex).unwrap_or(0);
        let edges = loop_of(patch, k);
        let near = || followers[k].points_near(vertex - patch.loops[k].start as usize);
        if !keeps_side(patch, vertex) {
            return false;
        }
        let most = near().map(|at| left[k][at]).fold(enough, f64::max);
        if followers[k].beyond_dents(edges, vertex - patch.loops[k].start as usize, &fine[k]) - slack > most {
            return false;
        }
        near().all(|at| {
            let beyond = followers[k].beyond(edges, at, fine[k][at]);
            let empty = deep.get(k).map_or(far, |deep| far.max(deep[at]));
            beyond - slack <= most && -beyond <= empty
        })
    };
    short::lengthened(patch, may, progress.part(1.0, 1.0))?;
    let mut least = largest(&needs(fine, patch, followers, slack));
    if least > enough {
        least = tips::moved(patch, fine, followers, slack);
    }
    if least > beyond {
        split::taken_in(patch, fine, followers, (slack, beyond));
        least = largest(&needs(fine, patch, followers, slack));
    }
    tight::pulled(patch, fine, followers, slack, progress.part(1.0, 1.0))?;
    across::settled(patch, fine, followers, rim, progress.part(1.0, 1.0))?;
    if rim == Rim::Across {
        least = largest(&needs(fine, patch, followers, slack));
    }
    Ok(least)
}

/// A patch with the contours that it was made of, which have the points of those of the drawing, moved.
struct Followed {
    sketch: Sketch,
    meshed: Vec<Vec<DVec2>>,
    /// What of the drawing is outside as a whole; see [`squares`].
    outside: f64,
}

/// What follows the points of each contour that a patch was made of.
fn followers_of(patch: &Patch, meshed: &[Vec<DVec2>]) -> Vec<Followers> {
    meshed.iter().enumerate().map(|(k, contour)| Followers::new(patch, k, contour)).collect()
}

/// The best of a few patches of wider and wider outlines.
fn widened<'p>(
    first: Sketch,
    fine: &[Vec<DVec2>],
    slack: f64,
    options: &SketchOptions,
    rounds: usize,
    part: &impl Fn(usize) -> Progress<'p>,
) -> Result<Followed> {
    let reach = first.patch.lattice.edge_length;
    let kept = first.kept.clone();
    let mut moved: Vec<Vec<f64>> = fine.iter().map(|contour| vec![0.0; contour.len()]).collect();
    let followers = followers_of(&first.patch, fine);
    let mut needs = needs(fine, &first.patch, &followers, slack);
    let mut best = Followed { sketch: first, meshed: fine.to_vec(), outside: squares(&needs) };
    let outward: Vec<Vec<DVec2>> = fine.iter().map(|contour| normals(contour)).collect();
    let mut room = None;
    for round in 1..=rounds {
        if largest(&needs) <= ENOUGH * reach {
            break;
        }
        let room = room.get_or_insert_with(|| room::outward(fine, &outward, MOST * reach, reach));
        for (k, (contour, far)) in fine.iter().zip(&mut moved).enumerate() {
            for ((far, more), room) in far.iter_mut().zip(spread(contour, &needs[k], reach)).zip(&room[k]) {
                *far = (*far + more).min(*room);
            }
        }
        let wider = moved_outward(fine, &outward, &mut moved, FOLDS * reach);
        let sketch = match placed_again(&kept, fine, &wider, options, part(round)) {
            Ok(Some(sketch)) => sketch,
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            // Wider, it meets itself or is too thin elsewhere: the best so far serves.
            Ok(None) | Err(_) => break,
        };
        needs = self::needs(fine, &sketch.patch, &followers_of(&sketch.patch, &wider), slack);
        let outside = squares(&needs);
        if outside < best.outside {
            best = Followed { sketch, meshed: wider, outside };
        }
    }
    Ok(best)
}

/// For each contour how far its points lie outside the patch, less the slack; 0 inside.
fn needs(fine: &[Vec<DVec2>], patch: &Patch, followers: &[Followers], slack: f64) -> Vec<Vec<f64>> {
    (0..fine.len()).map(|k| needs_of(patch, k, &fine[k], &followers[k], slack)).collect()
}

/// How far the points of one contour lie outside, less the slack; 0 inside. Dents between two points count as the nearer one.
fn needs_of(patch: &Patch, k: usize, contour: &[DVec2], follow: &Followers, slack: f64) -> Vec<f64> {
    let (edges, loop_) = (LoopEdges::new(patch, k, follow), loop_of(patch, k));
    let mut needs: Vec<f64> =
        contour.iter().enumerate().map(|(at, &point)| edges.outside(at, point, slack)).collect();
    for i in 0..loop_.len() {
        if let Some(deep) = follow.beyond_dent(loop_, i, contour) {
            let need = &mut needs[follow.point_at(i)];
            *need = need.max(deep - slack);
        }
    }
    needs
}

/// For each contour how far its points lie inside the patch; 0 or less outside.
fn depths(fine: &[Vec<DVec2>], patch: &Patch, followers: &[Followers]) -> Vec<Vec<f64>> {
    let of = |k: usize| {
        let edges = loop_of(patch, k);
        fine[k].iter().enumerate().map(|(at, &point)| -followers[k].beyond(edges, at, point)).collect()
    };
    (0..fine.len()).map(of).collect()
}

/// What is outside as a whole: a tip that no outline brings in says nothing about the rest.
fn squares(needs: &[Vec<f64>]) -> f64 {
    needs.iter().flatten().map(|need| need * need).sum()
}

fn largest(needs: &[Vec<f64>]) -> f64 {
    needs.iter().flatten().copied().fold(0.0, f64::max)
}

/// Points along a contour at most `step` apart, its own among them.
fn dense(contour: &ClosedCurve, step: f64) -> Vec<DVec2> {
    let mut points = Vec::new();
    for [a, b] in contour.segments() {
        let count = (a.distance(b) / step).ceil().max(1.0) as usize;
        points.extend((0..count).map(|k| a.lerp(b, k as f64 / count as f64)));
    }
    points
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    pub(super) fn ring(n: usize, radius: f64) -> Vec<DVec2> {
        (0..n).map(|k| radius * DVec2::from_angle(TAU * k as f64 / n as f64)).collect()
    }

    #[test]
    fn dense_points_lie_on_the_contour() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]].map(DVec2::from);
        let contour = read_contours(&square, &[]).unwrap().remove(0);
        let points = dense(&contour, 0.7);
        assert!(square.iter().all(|corner| points.contains(corner)));
        for (k, point) in points.iter().enumerate() {
            assert!(point.distance(points[(k + 1) % points.len()]) <= 0.7);
            let (x, y) = (point.x, point.y);
            assert!(x == 0.0 || x == 4.0 || y == 0.0 || y == 3.0);
        }
    }

    #[test]
    fn a_disk_is_covered_with_and_without_a_hole() {
        let options = SketchOptions { triangles: Some(300), ..SketchOptions::default() };
        for holes in [vec![], vec![ring(90, 0.8)]] {
            let plain = mesh_sketch(&ring(200, 2.0), &holes, &options, Progress::NONE).unwrap();
            let covering =
                cover_sketch(&ring(200, 2.0), &holes, Rim::Around(0.0), &options, Progress::NONE).unwrap();
            let (patch, h) = (&covering.sketch.patch, plain.patch.lattice.edge_length);
            assert!(covering.outside <= ENOUGH * h, "{}", covering.outside / h);
            let area = patch.area() / plain.patch.area();
            assert!(area > 1.0 && area < 1.05, "{area}");
            assert_eq!(patch.loops.len(), 1 + holes.len());
        }
    }

    #[test]
    fn a_rim_across_is_nearer_to_the_drawing_than_one_around_it_or_on_it() {
        let options = SketchOptions { triangles: Some(150), ..SketchOptions::default() };
        for holes in [vec![], vec![ring(90, 0.8)]] {
            let made =
                |rim: Rim| cover_sketch(&ring(200, 2.0), &holes, rim, &options, Progress::NONE).unwrap();
            let (across, around) = (made(Rim::Across), made(Rim::Around(0.0)));
            assert!(across.between < 0.5 * around.between, "{} {}", across.between, around.between);
            let drawn = |k: usize, radius: f64| 0.5 * (TAU / k as f64).sin() * k as f64 * radius * radius;
            let area = drawn(200, 2.0) - if holes.is_empty() { 0.0 } else { drawn(90, 0.8) };
            let lost = |sketch: &Sketch| 1.0 - sketch.patch.area() / area;
            let plain = mesh_sketch(&ring(200, 2.0), &holes, &options, Progress::NONE).unwrap();
            // The edges of vertices on it are chords.
            assert!(lost(&across.sketch).abs() < 0.4 * lost(&plain).abs());
            assert!(across.sketch.report.min_angle > 25f64.to_radians());
        }
    }

    #[test]
    fn slack_that_is_no_length_is_refused() {
        for slack in [-1.0, f64::NAN, f64::INFINITY] {
            let made = cover_sketch(
                &ring(20, 1.0),
                &[],
                Rim::Around(slack),
                &SketchOptions::default(),
                Progress::NONE,
            );
            assert!(matches!(made, Err(Error::InvalidOption { name: "slack", .. })));
        }
    }
}
