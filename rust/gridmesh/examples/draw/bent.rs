//! Panels of a lattice that bends with the drawing: directions, rotation, scale, the bent plane with its path, the patch.

use std::f64::consts::FRAC_PI_3;

use glam::DVec2;
use gridmesh::bend::shown::Shown;
use gridmesh::options::SketchOptions;
use gridmesh::path::target::Target;
use gridmesh::path::trace::{TraceOptions, trace};
use gridmesh::progress::Progress;
use gridmesh::svg::{Ink, Picture};

use crate::scene::{Region, Scene};
use crate::stages::{Stages, agree};
use crate::{Anything, Drawing};

/// Hexagons in the panels are so many edges apart.
const APART: f64 = 2.2;

/// A panel for each stage of the bent lattice; none where the lattice stays straight.
pub fn bent_stages(drawing: &Drawing, triangles: usize, size: f64, stages: &mut Stages) -> Anything<()> {
    let options = SketchOptions { triangles: Some(triangles), ..SketchOptions::default() };
    let scene = Scene::with(drawing, &options, size, size / 640.0)?;
    let Some(shown) = scene.sketch.kept.shown(&options, Progress::NONE)? else { return Ok(()) };
    stages.push(("bent-1-directions", directions(&scene, &shown)));
    let title = "Bent 2. Rotation";
    let even = vec![scene.lattice.edge_length; shown.lengths.len()];
    stages.push(("bent-2-rotation", hexagons(&scene, &shown, &even, title, "directions of the lattice")));
    let longest = shown.lengths.iter().copied().fold(0.0, f64::max);
    let shortest = shown.lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let caption = format!("edges are up to {:.1} times as long as others", longest / shortest);
    stages.push(("bent-3-scale", hexagons(&scene, &shown, &shown.lengths, "Bent 3. Scale", &caption)));
    stages.push(("bent-4-path", path(&scene, &shown, size)?));
    stages.push(("bent-5-placed", scene.placed("Bent 5. Placed")));
    stages.push(("bent-6-inflated", scene.inflated("Bent 6. Inflated")?));
    Ok(())
}

/// The lattice direction that each part of the outline shall follow, and where it changes.
fn directions(scene: &Scene, shown: &Shown) -> Picture {
    let changed = shown.changes.iter().filter(|change| **change != 0).count();
    let caption =
        format!("{changed} changes of direction on a carrier of {} triangles", shown.triangles.len());
    let mut picture = scene.panel("Bent 1. Directions", &caption);
    picture.wire(&shown.vertices, &shown.triangles);
    scene.drawn(&mut picture);
    let along = |(i, step): (usize, &i32)| {
        let ahead = DVec2::from_angle(shown.axes[i] + FRAC_PI_3 * f64::from(*step));
        let half = 0.5 * scene.lattice.edge_length * ahead;
        [shown.vertices[i] - half, shown.vertices[i] + half]
    };
    picture.lines(Ink::Chord, shown.steps.iter().enumerate().map(along));
    crate::scene::marks(&mut picture, &shown.changes, &shown.vertices);
    picture
}

/// The neighbourhood of a lattice vertex at some vertices of the carrier.
fn hexagons(scene: &Scene, shown: &Shown, lengths: &[f64], title: &str, caption: &str) -> Picture {
    let mut picture = scene.panel(title, caption);
    scene.drawn(&mut picture);
    let mut drawn: Vec<(DVec2, f64)> = Vec::new();
    let rim: usize = shown.contours.iter().map(ExactSizeIterator::len).sum();
    for (i, &at) in shown.vertices.iter().enumerate().skip(rim) {
        let reach = 0.5 * APART * lengths[i];
        if drawn.iter().any(|(p, other)| p.distance(at) < reach + other) {
            continue;
        }
        drawn.push((at, reach));
        let corner = |k: u32| {
            at + lengths[i]
                * DVec2::from_angle(shown.axes[i] + shown.lattice.angle + FRAC_PI_3 * f64::from(k))
        };
        let corners: Vec<DVec2> = (0..6).map(corner).collect();
        picture.polygons(Ink::Seed, [corners.as_slice()]);
        picture.lines(Ink::Wire, (0..3).map(|k| [corners[k], corners[k + 3]]));
    }
    picture
}

/// The bent drawing with its path on the lattice, which is straight here.
fn path(scene: &Scene, shown: &Shown, size: f64) -> Anything<Picture> {
    let lattice = shown.lattice;
    let points = || shown.bent.iter().flat_map(|contour| contour.points().iter().copied());
    let margin = 2.2 * lattice.edge_length;
    let low = points().fold(DVec2::INFINITY, DVec2::min) - margin;
    let high = points().fold(DVec2::NEG_INFINITY, DVec2::max) + margin;
    let targets: Vec<Target> = shown.bent.iter().map(|contour| Target::new(contour, &lattice)).collect();
    let options = TraceOptions {
        closeness: shown.closeness,
        proof_nodes: SketchOptions::default().proof_nodes,
        ..TraceOptions::default()
    };
    let traced = trace(&targets, &options, Progress::NONE).map_err(|failure| format!("{failure:?}"))?;
    let region = Region::new(traced.paths.into_iter().map(|path| path.points).collect(), &lattice);
    agree(scene, &region)?;
    let mut picture = Picture::new(low, high, size, size, size / 640.0)
        .titled("Bent 4. Bent drawing, path", &region.count());
    region.fill(&mut picture, Ink::Fill);
    region.draw_edges(&mut picture, |picture| {
        picture.polygons(Ink::Drawing, shown.bent.iter().map(|contour| contour.points()));
    });
    Ok(picture)
}
