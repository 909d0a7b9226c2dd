//! A patch of a tube from each loop to a circle, and a patch in one between the circles.

use std::iter;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::border::Several;
use super::hub::Circle;
use super::tour::spanning;
use crate::error::{Error, Result};
use crate::fill::bridge::{BridgeOptions, tube};
use crate::fill::filled::Shape;
use crate::fill::loops::check::check_loops;
use crate::fill::loops::mesh::Rim;
use crate::fill::options::{FillOptions, Smooth};
use crate::progress::{Clock, Progress};

/// Rows of faces that the mesh goes on by beyond a circle, so that the tube comes to it as its way is. With
/// [`Smooth::Curvature`] two are looked at.
const ROWS: usize = 2;

impl Several<'_> {
    /// Such a patch, in its place, and the least corner between the circles, in radians.
    ///
    /// # Errors
    /// Those of [`tube`], and of a patch between the circles.
    pub(super) fn arms(
        &self,
        circles: &[Circle],
        clock: &mut Clock,
        progress: Progress<'_>,
    ) -> Result<(Shape, f64)> {
        let mut mesh = Mesh::around(self);
        let loops = circles.iter().map(|circle| mesh.points(&circle.points)).collect::<Vec<_>>();
        let mut faces = Faces::default();
        for (k, (circle, loop_)) in circles.iter().zip(&loops).enumerate() {
            let part = |k: usize| 0.5 * k as f64 / circles.len() as f64;
            let (tube, quads) = self.arm(&mut mesh, k, circle, loop_, progress.part(part(k), part(k + 1)))?;
            mesh.add(&tube, quads);
            faces.add(tube, quads);
        }
        clock.stage("tubes");
        let options = FillOptions {
            // A film between circles that are far apart is thin.
            smooth: if self.options.smooth == Smooth::Flat { Smooth::Tangent } else { self.options.smooth },
            polygons: mesh.polygons.clone(),
            ..self.options.clone()
        };
        let rim =
            Rim::new(mesh.vertices.len(), &mesh.triangles, &loops.concat(), super::rings(options.smooth))?;
        let checked = check_loops(&loops, &mesh.vertices, &rim)?;
        let between = Several {
            vertices: &mesh.vertices,
            triangles: &mesh.triangles,
            rim: &rim,
            options: &options,
            checked: &checked,
            spanning: &spanning(&checked, &mesh.vertices),
            apart: None,
        };
        let (middle, _) = between.in_one(clock, progress.part(0.5, 1.0))?;
        let [least, _] = middle.work.corner_range(&middle.positions);
        faces.add(middle.facets(), middle.work.quads);
        mesh.points(&middle.positions[middle.work.inner()]);
        Ok((self.whole(&mesh.vertices[self.vertices.len()..], faces)?, least))
    }

    /// The tube from a loop to its circle, quads cut in two and before the triangles, and how many quads there are. Its vertices are
    /// added to the mesh.
    fn arm(
        &self,
        mesh: &mut Mesh,
        k: usize,
        circle: &Circle,
        loop_: &[u32],
        progress: Progress<'_>,
    ) -> Result<(Vec<[u32; 3]>, usize)> {
        let before = [mesh.vertices.len(), mesh.triangles.len()];
        mesh.go_on(circle, loop_);
        let options = BridgeOptions {
            cells: self.options.cells,
            smooth: self.options.smooth,
            ..BridgeOptions::default()
        };
        let rest = FillOptions { polygons: mesh.polygons.clone(), ..self.options.clone() };
        let loops = [self.checked[k].vertices.as_slice(), loop_];
        let made = tube(&mesh.vertices, &mesh.triangles, loops, &options, &rest, progress)?;
        let beyond = (mesh.vertices.len() - before[0]) as u32;
        mesh.vertices.truncate(before[0]);
        mesh.triangles.truncate(before[1]);
        mesh.polygons.truncate(before[1]);
        let named = |v: u32| if (v as usize) < before[0] { v } else { v - beyond };
        mesh.points(&made.vertices);
        Ok((made.facets().into_iter().map(|t| t.map(named)).collect(), made.quads.len()))
    }

    /// All faces as one patch with these new vertices.
    fn whole(&self, new: &[DVec3], faces: Faces) -> Result<Shape> {
        let border = self.border();
        let (n, old) = (border.vertices.len() as u32, self.vertices.len() as u32);
        let named = |v: u32| match border.place.get(&v) {
            Some(&place) => Ok(place),
            None => v
                .checked_sub(old)
                .map(|k| k + n)
                .ok_or(Error::Internal { reason: "a new face has a vertex of the mesh that is of no loop" }),
        };
        let renamed = |[a, b, c]: [u32; 3]| Ok([named(a)?, named(b)?, named(c)?]);
        let Faces { halves, single } = faces;
        let quads = halves.len() / 2;
        let triangles = halves.into_iter().chain(single).map(renamed).collect::<Result<Vec<_>>>()?;
        let work = self.patchwork(&border, border.vertices.len() + new.len(), &triangles)?.of_quads(quads);
        let mut shape = self.shape(&border, work);
        let outer = shape.work.outer.iter().map(|&v| self.vertices[v as usize]);
        shape.positions = border.at.iter().copied().chain(new.iter().copied()).chain(outer).collect();
        Ok(shape)
    }
}

/// The mesh around the loops, and what is added to it.
struct Mesh {
    /// All of the mesh's, and new ones.
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The face that each triangle is of.
    polygons: Vec<u32>,
}

impl Mesh {
    fn around(several: &Several<'_>) -> Mesh {
        let mut faces = FxHashMap::default();
        let mut polygon = |t: u32| {
            let (given, next) = (several.options.polygons.get(t as usize), faces.len() as u32);
            *faces.entry(given.copied().unwrap_or(t)).or_insert(next)
        };
        let numbers = &several.rim.numbers;
        Mesh {
            vertices: several.vertices.to_vec(),
            triangles: numbers.iter().map(|&t| several.triangles[t as usize]).collect(),
            polygons: numbers.iter().map(|&t| polygon(t)).collect(),
        }
    }

    /// Adds vertices.
    fn points(&mut self, points: &[DVec3]) -> Vec<u32> {
        let first = self.vertices.len() as u32;
        self.vertices.extend(points);
        (first..self.vertices.len() as u32).collect()
    }

    /// Adds faces: `quads` cut in two, then triangles.
    fn add(&mut self, triangles: &[[u32; 3]], quads: usize) {
        let first = self.polygons.iter().max().map_or(0, |most| most + 1);
        let halves = (0..quads as u32).flat_map(|k| iter::repeat_n(k, 2));
        self.triangles.extend(triangles);
        self.polygons.extend(halves.chain(quads as u32..).take(triangles.len()).map(|k| first + k));
    }

    /// Adds rows of quads beyond a circle, whose vertices are a loop.
    fn go_on(&mut self, circle: &Circle, loop_: &[u32]) {
        let step = circle.points[0].distance(circle.points[1]);
        let mut before = loop_.to_vec();
        for row in 1..=ROWS {
            let points = circle.points.iter().map(|&p| p + row as f64 * step * circle.way);
            let after = self.points(&points.collect::<Vec<_>>());
            let next = |k: usize| (k + 1) % loop_.len();
            let halves = (0..loop_.len()).flat_map(|k| {
                let [a, b, c, d] = [before[k], before[next(k)], after[next(k)], after[k]];
                [[a, b, c], [a, c, d]]
            });
            self.add(&halves.collect::<Vec<_>>(), loop_.len());
            before = after;
        }
    }
}

/// Halves of quads, two by two, and triangles.
#[derive(Default)]
struct Faces {
    halves: Vec<[u32; 3]>,
    single: Vec<[u32; 3]>,
}

impl Faces {
    fn add(&mut self, mut triangles: Vec<[u32; 3]>, quads: usize) {
        self.single.extend(triangles.drain(2 * quads..));
        self.halves.extend(triangles);
    }
}
