//! Draws how a sketch becomes a mesh, as SVG files.
//!
//! ```text
//! cargo run -p gridmesh --release --features svg --example draw -- tests/sketches/drawings/frog.json
//! ```
//!
//! writes one file for each stage of figure 1 of the paper, by the paper's growth and by the optimum,
//! to `target/drawings`. Other words draw other pictures: see [`USAGE`]. Only the public API is used.

use std::collections::BTreeSet;
use std::error::Error;
use std::path::PathBuf;

use glam::{DVec2, DVec3};
use gridmesh::assemble::assemble;
use gridmesh::axial::Axial;
use gridmesh::band::Band;
use gridmesh::boundary::Boundary;
use gridmesh::contours::read_contours;
use gridmesh::curve::ClosedCurve;
use gridmesh::growth::{clear_chords, grow_inside, straighten};
use gridmesh::inflate::{InflateOptions, inflate};
use gridmesh::lattice::Lattice;
use gridmesh::mapping::{complete, project};
use gridmesh::options::{BoundaryMethod, SketchOptions};
use gridmesh::progress::Progress;
use gridmesh::raster::Raster;
use gridmesh::sketch::{Sketch, mesh_sketch};
use gridmesh::svg::{Ink, Picture, page};
use gridmesh::target::Target;
use gridmesh::trace::{TraceOptions, trace};
use rustc_hash::FxHashMap;

const USAGE: &str = "usage: draw [stages | strip | compare | gallery] [options] FILE...
  stages       a picture for each stage of each file (if nothing else is said)
  strip        all stages of one file in one picture
  compare      the paper's growth beside the optimum, for each file
  gallery      each file meshed by the optimum
  FILE         a sketch: {\"points\": [[x, y], ...]} and, if it has any, \"holes\": [[[x, y], ...], ...]
  --triangles  triangles of the flat patch, 600 if not given
  --columns    panels in a row
  --output     the picture; for stages the folder, target/drawings if not given";

const LEGEND: [(Ink, &str); 13] = [
    (Ink::Drawing, "drawing"),
    (Ink::Target, "what steers the path"),
    (Ink::Seed, "seed"),
    (Ink::Band, "where the path may go"),
    (Ink::Added, "added"),
    (Ink::Path, "boundary"),
    (Ink::Mapped, "from lattice to drawing"),
    (Ink::Chord, "chord"),
    (Ink::Corner, "corner kept"),
    (Ink::Tip, "patch valence 2"),
    (Ink::Three, "patch valence 3"),
    (Ink::Five, "valence 5"),
    (Ink::Six, "valence 6"),
];

/// The paper's growth needs parts this wide (in edges), and this much more room to clear chords: as
/// in `mesh_sketch`, whose patch the stages must lead to.
const NECK_WIDTH: f64 = 2.4;
const CHORD_ROOM: f64 = 1.0;

type Anything<T> = Result<T, Box<dyn Error>>;
type Stages = Vec<(&'static str, Picture)>;

fn main() -> Anything<()> {
    let Arguments { what, triangles, columns, output, files } = arguments()?;
    let drawings = files.iter().map(read).collect::<Anything<Vec<Drawing>>>()?;
    let mut panels = Vec::new();
    for drawing in &drawings {
        match what.as_str() {
            "gallery" => panels.push(result(drawing, triangles, BoundaryMethod::Optimal, 220.0, 0.5)?),
            "compare" => {
                panels.push(result(drawing, triangles, BoundaryMethod::Grown, 420.0, 0.75)?);
                panels.push(result(drawing, triangles, BoundaryMethod::Optimal, 420.0, 0.75)?);
            }
            "strip" => panels.extend(stages(drawing, triangles, 330.0)?.into_iter().map(|stage| stage.1)),
            _ => {
                for (stage, panel) in stages(drawing, triangles, 640.0)? {
                    write(&output.join(format!("{}-{stage}.svg", drawing.name)), &[panel], 1)?;
                }
            }
        }
    }
    if panels.is_empty() { Ok(()) } else { write(&output, &panels, columns) }
}

fn write(path: &PathBuf, panels: &[Picture], columns: usize) -> Anything<()> {
    let picture = page(panels, columns, &LEGEND);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(path, &picture)?;
    println!("{} ({} kB)", path.display(), picture.len() / 1000);
    Ok(())
}

struct Arguments {
    what: String,
    triangles: usize,
    columns: usize,
    output: PathBuf,
    files: Vec<PathBuf>,
}

fn arguments() -> Anything<Arguments> {
    let mut words = std::env::args().skip(1).peekable();
    let what = words.next_if(|word| ["stages", "strip", "compare", "gallery"].contains(&word.as_str()));
    let what = what.unwrap_or_else(|| "stages".to_owned());
    let columns = match what.as_str() {
        "compare" => 2,
        "strip" => 4,
        _ => 5,
    };
    let output =
        if what == "stages" { "target/drawings".into() } else { format!("target/{what}.svg").into() };
    let mut found = Arguments { what, triangles: 600, columns, output, files: Vec::new() };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--triangles" => found.triangles = value()?.parse()?,
            "--columns" => found.columns = value()?.parse()?,
            "--output" => found.output = value()?.into(),
            word if word.starts_with('-') => return Err(format!("what is {word}?\n{USAGE}").into()),
            _ => found.files.push(word.into()),
        }
    }
    if found.files.is_empty() { Err(USAGE.into()) } else { Ok(found) }
}

struct Drawing {
    name: String,
    outline: Vec<DVec2>,
    holes: Vec<Vec<DVec2>>,
}

fn read(path: &PathBuf) -> Anything<Drawing> {
    let data: serde_json::Value = serde_json::from_slice(&std::fs::read(path)?)?;
    let points = |value: &serde_json::Value| -> Anything<Vec<DVec2>> {
        let pairs: Vec<[f64; 2]> = serde_json::from_value(value.clone())?;
        Ok(pairs.into_iter().map(DVec2::from_array).collect())
    };
    let holes = data["holes"].as_array().into_iter().flatten().map(points).collect::<Anything<_>>()?;
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Drawing { name, outline: points(&data["points"])?, holes })
}

/// A finished sketch, and the panel that shows it.
struct Scene {
    contours: Vec<ClosedCurve>,
    sketch: Sketch,
    lattice: Lattice,
    low: DVec2,
    high: DVec2,
    size: f64,
    weight: f64,
}

/// The inside of closed lattice paths, where it lies on the lattice.
struct Region {
    paths: Vec<Vec<Axial>>,
    positions: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
}

impl Scene {
    fn new(
        drawing: &Drawing,
        triangles: usize,
        boundary: BoundaryMethod,
        size: f64,
        weight: f64,
    ) -> Anything<Self> {
        let options = SketchOptions { triangles: Some(triangles), boundary, ..SketchOptions::default() };
        let sketch = mesh_sketch(&drawing.outline, &drawing.holes, &options, Progress::NONE)
            .map_err(|error| format!("{}: {error}", drawing.name))?;
        let lattice = sketch.patch.lattice;
        let points = || drawing.outline.iter().copied();
        let margin = if size > 300.0 { 2.2 * lattice.edge_length } else { 0.5 * lattice.edge_length };
        let low = points().fold(DVec2::INFINITY, DVec2::min) - margin;
        let high = points().fold(DVec2::NEG_INFINITY, DVec2::max) + margin;
        let contours = read_contours(&drawing.outline, &drawing.holes)?;
        Ok(Self { contours, sketch, lattice, low, high, size, weight })
    }

    fn panel(&self, title: &str, caption: &str) -> Picture {
        Picture::new(self.low, self.high, self.size, self.size, self.weight).titled(title, caption)
    }

    fn at(&self, point: Axial) -> DVec2 {
        self.lattice.from_units(Lattice::units(point))
    }

    fn region(&self, paths: Vec<Vec<Axial>>) -> Region {
        let region = assemble(&paths);
        let positions = region.points.iter().map(|&p| self.at(p)).collect();
        Region { paths, positions, triangles: region.triangles }
    }

    fn drawn(&self, picture: &mut Picture) {
        picture.polygons(Ink::Drawing, self.contours.iter().map(|contour| contour.points()));
    }

    fn target(&self, picture: &mut Picture, target: &Target) {
        let points: Vec<DVec2> = target.points.iter().map(|&p| self.lattice.from_units(p)).collect();
        picture.polygons(Ink::Target, [points.as_slice()]);
    }

    /// The patch on the lattice; what is not in `before` was added.
    fn on_lattice(&self, picture: &mut Picture, region: &Region, before: Option<&Region>) {
        region.fill(picture, if before.is_some() { Ink::Added } else { Ink::Fill });
        if let Some(before) = before {
            before.fill(picture, Ink::Fill);
        }
        picture.wire(&region.positions, &region.triangles);
        self.drawn(picture);
        region.fill(picture, Ink::Path);
        marks(picture, &region.turns(), &region.positions);
    }

    /// The patch on the drawing.
    fn placed(&self, title: &str) -> Picture {
        let (patch, report) = (&self.sketch.patch, &self.sketch.report);
        let numbers = format!("{} triangles, {} irregular", report.triangles, report.irregular);
        let corners = report.corners - report.released_corners;
        let caption = match self.size {
            small if small < 400.0 => numbers,
            _ => format!(
                "{numbers}, turns {}, corners {corners} of {}, least angle {:.0}°",
                report.turns,
                report.corners,
                report.min_angle.to_degrees()
            ),
        };
        let mut picture = self.panel(title, &caption);
        let ends = patch.loops.iter().map(|contour| contour.vertices());
        let paths: Vec<&[DVec2]> =
            ends.map(|ends| &patch.vertices[ends.start as usize..ends.end as usize]).collect();
        picture.polygons(Ink::Fill, paths.iter().copied());
        picture.wire(&patch.vertices, &patch.triangles);
        self.drawn(&mut picture);
        picture.polygons(Ink::Path, paths);
        let corners = patch.loops.iter().flat_map(|contour| contour.corner.iter());
        let kept = corners.zip(&patch.vertices).filter(|(turn, _)| **turn != 0.0);
        picture.dots(Ink::Corner, kept.map(|(_, &p)| p));
        // A boundary vertex with one triangle more or less than three has turned on the lattice.
        let mut turns = vec![3; patch.n_boundary()];
        for &v in patch.triangles.iter().flatten() {
            if let Some(turn) = turns.get_mut(v as usize) {
                *turn -= 1;
            }
        }
        marks(&mut picture, &turns, &patch.vertices);
        picture
    }

    /// From lattice vertices to their places on the drawing.
    fn mapped(&self, title: &str, region: &Region, parameters: &[Vec<f64>], targets: &[Target]) -> Picture {
        let mut places = Vec::with_capacity(region.positions.len());
        for ((contour, parameters), target) in self.contours.iter().zip(parameters).zip(targets) {
            let unit = target.step * self.lattice.edge_length;
            places.extend(parameters.iter().map(|parameter| contour.point_at(parameter * unit)));
        }
        let lines: Vec<[DVec2; 2]> = region.positions.iter().zip(places).map(|(&a, b)| [a, b]).collect();
        let farthest = lines.iter().map(|[a, b]| a.distance(*b)).fold(0.0, f64::max);
        let caption = format!("up to {:.2} edges apart", farthest / self.lattice.edge_length);
        let mut picture = self.panel(title, &caption);
        region.fill(&mut picture, Ink::Fill);
        picture.wire(&region.positions, &region.triangles);
        self.drawn(&mut picture);
        picture.lines(Ink::Mapped, lines);
        picture
    }

    /// The body, seen from above its lower end.
    fn inflated(&self, title: &str) -> Anything<Picture> {
        let tilt = 55f64.to_radians();
        let body = inflate(&self.sketch.patch, &InflateOptions::default(), Progress::NONE)?;
        let report = &body.report;
        let caption = format!("{} triangles, {} irregular vertices", report.triangles, report.irregular);
        let (sin, cos) = tilt.sin_cos();
        let seen = |p: &DVec3| DVec2::new(p.x, sin * p.y + cos * p.z);
        let low = body.vertices.iter().map(seen).fold(DVec2::INFINITY, DVec2::min);
        let high = body.vertices.iter().map(seen).fold(DVec2::NEG_INFINITY, DVec2::max);
        let mut picture = Picture::new(low, high, self.size, self.size, self.weight).titled(title, &caption);
        picture.body(&body, tilt);
        Ok(picture)
    }
}

impl Region {
    /// The paths, as a face or as lines.
    fn fill(&self, picture: &mut Picture, ink: Ink) {
        let mut start = 0;
        let outlines = self.paths.iter().map(|path| {
            start += path.len();
            &self.positions[start - path.len()..start]
        });
        picture.polygons(ink, outlines);
    }

    /// The turn at each boundary vertex.
    fn turns(&self) -> Vec<i32> {
        let of_path = |path: &Vec<Axial>| {
            let n = path.len();
            let step = |i: usize| path[i % n].step_to(path[(i + 1) % n]);
            let turn =
                |i: usize| step(i + n - 1).zip(step(i)).map_or(0, |(enter, leave)| enter.turn_to(leave));
            (0..n).map(turn).collect::<Vec<i32>>()
        };
        self.paths.iter().flat_map(of_path).collect()
    }

    /// How many boundary vertices are irregular, and the paper's measure of it.
    fn count(&self) -> String {
        let turns = self.turns();
        let irregular = turns.iter().filter(|turn| **turn != 0).count();
        let bend: u32 = turns.iter().map(|turn| turn.unsigned_abs()).sum();
        format!("{irregular} of {} boundary vertices irregular, turns {bend}", turns.len())
    }
}

/// Dots on the vertices that turn.
fn marks(picture: &mut Picture, turns: &[i32], positions: &[DVec2]) {
    for ink in [Ink::Three, Ink::Five, Ink::Six, Ink::Tip] {
        let dots = turns.iter().zip(positions).filter(|(turn, _)| Ink::of_turn(**turn) == Some(ink));
        picture.dots(ink, dots.map(|(_, &p)| p));
    }
}

fn result(
    drawing: &Drawing,
    triangles: usize,
    boundary: BoundaryMethod,
    size: f64,
    weight: f64,
) -> Anything<Picture> {
    let scene = Scene::new(drawing, triangles, boundary, size, weight)?;
    Ok(match boundary {
        _ if size < 300.0 => scene.placed(&drawing.name),
        BoundaryMethod::Grown => scene.placed("The paper's growth"),
        BoundaryMethod::Optimal => scene.placed("The optimum"),
    })
}

/// Figure 1 of the paper, by its growth (not round holes) and by the optimum.
fn stages(drawing: &Drawing, triangles: usize, size: f64) -> Anything<Stages> {
    let scene = |boundary| Scene::new(drawing, triangles, boundary, size, size / 640.0);
    let mut stages = Stages::new();
    if drawing.holes.is_empty() {
        grown_stages(&scene(BoundaryMethod::Grown)?, &mut stages)?;
    }
    optimal_stages(&scene(BoundaryMethod::Optimal)?, &mut stages)?;
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
fn agree(scene: &Scene, region: &Region) -> Anything<()> {
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
