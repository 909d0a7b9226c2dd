//! Panels of a finished sketch and of what lies on its lattice.

use glam::{DVec2, DVec3};
use gridmesh::body::inflate::{InflateOptions, inflate};
use gridmesh::drawing::contours::read_contours;
use gridmesh::drawing::curve::ClosedCurve;
use gridmesh::lattice::assemble::assemble;
use gridmesh::lattice::axial::Axial;
use gridmesh::options::{BoundaryMethod, SketchOptions};
use gridmesh::path::placement::Lattice;
use gridmesh::path::target::Target;
use gridmesh::progress::Progress;
use gridmesh::sketch::{Sketch, mesh_sketch};
use gridmesh::svg::{Ink, Picture};

use crate::{Anything, Drawing};

/// A finished sketch, and the panel that shows it.
pub struct Scene {
    pub contours: Vec<ClosedCurve>,
    pub sketch: Sketch,
    pub lattice: Lattice,
    low: DVec2,
    high: DVec2,
    size: f64,
    weight: f64,
}

/// The inside of closed lattice paths, where it lies on the lattice.
pub struct Region {
    pub paths: Vec<Vec<Axial>>,
    positions: Vec<DVec2>,
    pub triangles: Vec<[u32; 3]>,
}

impl Scene {
    pub fn new(
        drawing: &Drawing,
        triangles: usize,
        boundary: BoundaryMethod,
        size: f64,
        weight: f64,
    ) -> Anything<Self> {
        let options =
            SketchOptions { triangles: Some(triangles), boundary, bend: 0.0, ..SketchOptions::default() };
        Self::with(drawing, &options, size, weight)
    }

    pub fn with(drawing: &Drawing, options: &SketchOptions, size: f64, weight: f64) -> Anything<Self> {
        let sketch = mesh_sketch(&drawing.outline, &drawing.holes, options, Progress::NONE)
            .map_err(|error| format!("{}: {error}", drawing.name))?;
        let lattice = sketch.patch.lattice;
        let points = || drawing.outline.iter().copied();
        let margin = if size > 300.0 { 2.2 * lattice.edge_length } else { 0.5 * lattice.edge_length };
        let low = points().fold(DVec2::INFINITY, DVec2::min) - margin;
        let high = points().fold(DVec2::NEG_INFINITY, DVec2::max) + margin;
        let contours = read_contours(&drawing.outline, &drawing.holes)?;
        Ok(Self { contours, sketch, lattice, low, high, size, weight })
    }

    pub fn panel(&self, title: &str, caption: &str) -> Picture {
        Picture::new(self.low, self.high, self.size, self.size, self.weight).titled(title, caption)
    }

    pub fn at(&self, point: Axial) -> DVec2 {
        self.lattice.from_units(Lattice::units(point))
    }

    pub fn region(&self, paths: Vec<Vec<Axial>>) -> Region {
        Region::new(paths, &self.lattice)
    }

    pub fn drawn(&self, picture: &mut Picture) {
        picture.polygons(Ink::Drawing, self.contours.iter().map(|contour| contour.points()));
    }

    pub fn target(&self, picture: &mut Picture, target: &Target) {
        let points: Vec<DVec2> = target.points.iter().map(|&p| self.lattice.from_units(p)).collect();
        picture.polygons(Ink::Target, [points.as_slice()]);
    }

    /// The patch on the lattice; what is not in `before` was added.
    pub fn on_lattice(&self, picture: &mut Picture, region: &Region, before: Option<&Region>) {
        region.fill(picture, if before.is_some() { Ink::Added } else { Ink::Fill });
        if let Some(before) = before {
            before.fill(picture, Ink::Fill);
        }
        region.draw_edges(picture, |picture| self.drawn(picture));
    }

    /// The patch on the drawing.
    pub fn placed(&self, title: &str) -> Picture {
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
    pub fn mapped(
        &self,
        title: &str,
        region: &Region,
        parameters: &[Vec<f64>],
        targets: &[Target],
    ) -> Picture {
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
    pub fn inflated(&self, title: &str) -> Anything<Picture> {
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
    pub fn new(paths: Vec<Vec<Axial>>, lattice: &Lattice) -> Self {
        let region = assemble(&paths);
        let positions = region.points.iter().map(|&p| lattice.from_units(Lattice::units(p))).collect();
        Self { paths, positions, triangles: region.triangles }
    }

    /// The paths, as a face or as lines.
    pub fn fill(&self, picture: &mut Picture, ink: Ink) {
        let mut start = 0;
        let outlines = self.paths.iter().map(|path| {
            start += path.len();
            &self.positions[start - path.len()..start]
        });
        picture.polygons(ink, outlines);
    }

    /// Its edges, boundary and turns over what else is drawn.
    pub fn draw_edges(&self, picture: &mut Picture, beneath: impl Fn(&mut Picture)) {
        picture.wire(&self.positions, &self.triangles);
        beneath(picture);
        self.fill(picture, Ink::Path);
        marks(picture, &self.turns(), &self.positions);
    }

    /// The turn at each boundary vertex.
    pub fn turns(&self) -> Vec<i32> {
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
    pub fn count(&self) -> String {
        let turns = self.turns();
        let irregular = turns.iter().filter(|turn| **turn != 0).count();
        let bend: u32 = turns.iter().map(|turn| turn.unsigned_abs()).sum();
        format!("{irregular} of {} boundary vertices irregular, turns {bend}", turns.len())
    }
}

/// Dots on the vertices that turn.
pub fn marks(picture: &mut Picture, turns: &[i32], positions: &[DVec2]) {
    for ink in [Ink::Three, Ink::Five, Ink::Six, Ink::Tip] {
        let dots = turns.iter().zip(positions).filter(|(turn, _)| Ink::of_turn(**turn) == Some(ink));
        picture.dots(ink, dots.map(|(_, &p)| p));
    }
}
