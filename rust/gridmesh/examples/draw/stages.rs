//! A panel for each stage from the drawing to the body.

use std::collections::BTreeSet;

use glam::DVec2;
use gridmesh::lattice::axial::Axial;
use gridmesh::lattice::boundary::Boundary;
use gridmesh::options::{BoundaryMethod, SketchOptions};
use gridmesh::path::band::Band;
use gridmesh::path::growth::{clear_chords, grow_inside, straighten};
use gridmesh::path::mapping::{complete, project};
use gridmesh::path::raster::Raster;
use gridmesh::path::target::Target;
use gridmesh::path::trace::{TraceOptions, trace};
use gridmesh::progress::Progress;
use gridmesh::svg::{Ink, Picture};
use rustc_hash::FxHashMap;

use crate::bent::bent_stages;
use crate::scene::{Region, Scene};
use crate::{Anything, Drawing};

/// The paper's growth needs parts this wide (in edges), and this much more room to clear chords: as
/// in `mesh_sketch`, whose patch the stages must lead to.
const NECK_WIDTH: f64 = 2.4;
const CHORD_ROOM: f64 = 1.0;

pub type Stages = Vec<(&'static str, Picture)>;

/// Figure 1 of the paper, by its growth (not round holes), by the optimum, and on a bent lattice where there is one.
pub fn stages(drawing: &Drawing, triangles: usize, size: f64) -> Anything<Stages> {
    let scene = |boundary| Scene::new(drawing, triangles, boundary, size, size / 640.0);
    let mut stages = Stages::new();
    if drawing.holes.is_empty() {
        grown_stages(&scene(BoundaryMethod::Grown)?, &mut stages)?;
    }
    optimal_stages(&scene(BoundaryMethod::Optimal)?, &mut stages)?;
    bent_stages(drawing, triangles, size, &mut stages)?;
    Ok(stages)
}

fn grown_stages(scene: &Scene, stages: &mut Stages) -> Anything<()> {
    let max_distance = SketchOptions::default().max_distance;
    let reach = max_distance + CHORD_ROOM;
    let faired = Target::new(&scene.contours[0], &scene.lattice);
    let mut widened = faired.clone();
    widened.widen(NECK_WIDTH);
    let band = Band::new(&faired, reach);
    let raster = Raster::new(&widened, reach.ceil() as i32 + 2);
    let within = |p: Axial, limit: f64| band.nearest(p).map_or(raster.is_inside(p), |d| d.distance <= limit);

    let seed = raster.seed().ok_or("there is no room for a seed")?;
    let mut picture =
        scene.panel("Growth 1. Drawing, lattice, seed", "the curve is faired, necks are widened");
    picture.polygons(Ink::Seed, [seed.neighbours().map(|p| scene.at(p)).as_slice()]);
    picture.lattice(&scene.lattice);
    scene.drawn(&mut picture);
    scene.target(&mut picture, &widened);
    stages.push(("grown-1-seed", picture));

    let mut boundary = grow_inside(&raster, Progress::NONE)?.ok_or("there is no room for a seed")?;
    let grown = scene.region(vec![boundary.path()]);
    let mut picture = scene.panel("Growth 2. Grown", &grown.count());
    scene.on_lattice(&mut picture, &grown, None);
    picture.lines(Ink::Chord, chords(scene, &boundary));
    stages.push(("grown-2-grown", picture));

    let known = project(&boundary.path(), &band);
    clear_chords(&mut boundary, |p| within(p, reach)).map_err(|p| format!("a chord stays at {p:?}"))?;
    let cleared = scene.region(vec![boundary.path()]);
    let mut picture = scene.panel("Growth 3. Chords cleared", &cleared.count());
    scene.on_lattice(&mut picture, &cleared, Some(&grown));
    stages.push(("grown-3-cleared", picture));

    straighten(&mut boundary, |p| within(p, max_distance), Progress::NONE)?;
    let straight = scene.region(vec![boundary.path()]);
    let mut picture = scene.panel("Growth 4. Valences optimised", &straight.count());
    scene.on_lattice(&mut picture, &straight, Some(&cleared));
    stages.push(("grown-4-optimised", picture));

    let path = &straight.paths[0];
    let known: FxHashMap<Axial, f64> = path.iter().filter_map(|p| Some((*p, *known.get(p)?))).collect();
    let parameters = [complete(path, &known, band.n_samples() as f64)];
    stages.push(("grown-5-mapped", scene.mapped("Growth 5. Mapped", &straight, &parameters, &[faired])));
    agree(scene, &straight)?;
    stages.push(("grown-6-placed", scene.placed("Growth 6. Placed")));
    stages.push(("grown-7-inflated", scene.inflated("Growth 7. Inflated")?));
    Ok(())
}

fn optimal_stages(scene: &Scene, stages: &mut Stages) -> Anything<()> {
    let options = TraceOptions::default();
    let targets: Vec<Target> = scene.contours.iter().map(|c| Target::new(c, &scene.lattice)).collect();

    let bands = targets.iter().flat_map(|target| Band::new(target, options.max_distance).nodes);
    let points: BTreeSet<Axial> = bands.map(|node| node.point).collect();
    let caption = format!("{} lattice points within {} edges", points.len(), options.max_distance);
    let mut picture = scene.panel("Optimum 1. Drawing, lattice, band", &caption);
    picture.lattice(&scene.lattice);
    picture.dots(Ink::Band, points.iter().map(|&p| scene.at(p)));
    scene.drawn(&mut picture);
    for target in &targets {
        scene.target(&mut picture, target);
    }
    stages.push(("optimal-1-band", picture));

    let traced = trace(&targets, &options, Progress::NONE).map_err(|failure| format!("{failure:?}"))?;
    let region = scene.region(traced.paths.iter().map(|path| path.points.clone()).collect());
    let mut picture = scene.panel("Optimum 2. Cheapest path", &region.count());
    scene.on_lattice(&mut picture, &region, None);
    stages.push(("optimal-2-traced", picture));

    let parameters: Vec<Vec<f64>> = traced.paths.into_iter().map(|path| path.parameters).collect();
    stages.push(("optimal-3-mapped", scene.mapped("Optimum 3. Mapped", &region, &parameters, &targets)));
    agree(scene, &region)?;
    stages.push(("optimal-4-placed", scene.placed("Optimum 4. Placed")));
    stages.push(("optimal-5-inflated", scene.inflated("Optimum 5. Inflated")?));
    Ok(())
}

/// The stages must lead to the patch of [`mesh_sketch`], or the pictures would lie.
pub fn agree(scene: &Scene, region: &Region) -> Anything<()> {
    if scene.sketch.patch.triangles == region.triangles {
        return Ok(());
    }
    Err("the stages drawn here do not lead to the patch of mesh_sketch: have its constants changed?".into())
}

/// The edges inside a patch between two boundary vertices, each once.
fn chords(scene: &Scene, boundary: &Boundary) -> Vec<[DVec2; 2]> {
    let mut found = Vec::new();
    for p in boundary.path() {
        let ends = boundary.inner_neighbours(p).filter(|&q| p < q && boundary.is_boundary(q));
        found.extend(ends.map(|q| [scene.at(p), scene.at(q)]));
    }
    found
}
