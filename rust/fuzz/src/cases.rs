//! Cases read from bytes: any bytes give one, small coordinates and coincidences are common.

use std::f64::consts::TAU;

use arbitrary::Unstructured;
use glam::{DVec2, DVec3};
use gridmesh::cut::{CutOptions, Keep, Sweep};
use gridmesh::fill::Smooth;
use gridmesh::options::{BoundaryMethod, Mirror, SelfCrossing, SketchOptions};

/// Bytes being read. Beyond their end all is zero.
pub struct Case<'a> {
    bytes: Unstructured<'a>,
}

impl<'a> Case<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        Self { bytes: Unstructured::new(data) }
    }

    fn byte(&mut self) -> u8 {
        self.bytes.arbitrary().unwrap_or(0)
    }

    pub fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n.max(1)
    }

    /// From 0 to 1.
    pub fn share(&mut self) -> f64 {
        f64::from(self.byte()) / 255.0
    }

    pub fn chance(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// Mostly an integer from -8 to 7, sometimes with a fraction, seldom any number.
    fn coordinate(&mut self) -> f64 {
        let byte = self.byte();
        let whole = f64::from(byte >> 4) - 8.0;
        match byte & 15 {
            0 => self.bytes.arbitrary().unwrap_or(0.0),
            1 => whole * 1e-9,
            2 => whole * 1e9,
            3..8 => whole + f64::from(self.byte()) / 256.0,
            _ => whole,
        }
    }

    fn points(&mut self, most: usize) -> Vec<DVec2> {
        let n = self.below(most + 1);
        (0..n).map(|_| DVec2::new(self.coordinate(), self.coordinate())).collect()
    }

    /// Any points, or a star around the origin, which seldom crosses itself.
    pub fn polygon(&mut self) -> Vec<DVec2> {
        if self.byte() < 64 {
            return self.points(24);
        }
        let n = 3 + self.below(60);
        let ray = |k: usize, radius: f64| radius * DVec2::from_angle(TAU * k as f64 / n as f64);
        (0..n).map(|k| ray(k, 1.0 + f64::from(self.byte()) / 64.0)).collect()
    }

    pub fn holes(&mut self) -> Vec<Vec<DVec2>> {
        let n = self.byte().saturating_sub(200) as usize / 20;
        (0..n)
            .map(|_| {
                let centre = 0.1 * DVec2::new(self.coordinate(), self.coordinate());
                let radius = f64::from(self.byte()) / 400.0;
                let sides = 3 + self.below(12);
                (0..sides)
                    .map(|k| centre + radius * DVec2::from_angle(TAU * k as f64 / sides as f64))
                    .collect()
            })
            .collect()
    }

    pub fn sketch_options(&mut self) -> SketchOptions {
        let mut options = SketchOptions { triangles: Some(2 + 3 * self.below(256)), ..Default::default() };
        let byte = self.byte();
        if byte & 3 == 1 {
            options.boundary = BoundaryMethod::Grown;
        }
        if byte & 12 == 4 {
            options.mirror = Some(Mirror::Auto);
        }
        if byte & 48 == 16 {
            options.self_crossing = SelfCrossing::Union;
        }
        if byte & 192 == 64 {
            options.angle = Some(self.coordinate());
        }
        options
    }

    /// Pieces of a grid with faces missing, turned or bent over; seldom any triangles.
    pub fn mesh(&mut self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        if self.byte() < 40 {
            let n = self.below(24) + 1;
            let vertices =
                (0..n).map(|_| DVec3::new(self.coordinate(), self.coordinate(), self.coordinate())).collect();
            let m = self.below(40);
            let triangles = (0..m).map(|_| [0; 3].map(|_: u32| self.below(n + 1) as u32)).collect();
            return (vertices, triangles);
        }
        let (rows, columns) = (3 + self.below(8), 3 + self.below(8));
        let (is_ring, is_torus) = (self.chance(), self.chance());
        let rough = if self.chance() { 0.2 } else { 0.0 };
        let mut vertices = Vec::new();
        for i in 0..rows {
            for j in 0..columns {
                let (u, v) = (TAU * i as f64 / rows as f64, TAU * j as f64 / columns as f64);
                let point = match (is_ring, is_torus) {
                    (false, _) => DVec3::new(i as f64, j as f64, 0.0),
                    (true, false) => DVec3::new(i as f64, v.cos(), v.sin()),
                    (true, true) => DVec3::new((2.0 + v.cos()) * u.cos(), (2.0 + v.cos()) * u.sin(), v.sin()),
                };
                let noise = DVec3::new(self.coordinate(), self.coordinate(), self.coordinate());
                let noise = if noise.is_finite() { noise.clamp_length_max(2.0) } else { DVec3::ZERO };
                vertices.push(point + rough * noise);
            }
        }
        let mut triangles = Vec::new();
        let (last_row, last_column) =
            (if is_ring && is_torus { rows } else { rows - 1 }, if is_ring { columns } else { columns - 1 });
        let missing = self.below(4);
        for i in 0..last_row {
            for j in 0..last_column {
                let at = |i: usize, j: usize| ((i % rows) * columns + j % columns) as u32;
                let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                if missing > 0 && self.byte() < 20 * missing as u8 {
                    continue;
                }
                triangles.push([quad[0], quad[1], quad[2]]);
                triangles.push([quad[0], quad[2], quad[3]]);
            }
        }
        (vertices, triangles)
    }

    /// A closed mesh that others of its kind often meet: a ball or a torus, sometimes rough.
    pub fn closed(&mut self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (rows, columns) = (3 + self.below(8), 3 + self.below(8));
        let is_torus = self.chance();
        let shift = 0.25 * DVec3::new(self.coordinate(), self.coordinate(), self.coordinate());
        let rough = if self.chance() { 0.2 * self.share() } else { 0.0 };
        let mut vertices = Vec::new();
        let mut add = |case: &mut Self, point: DVec3| {
            vertices.push(shift + point * (1.0 + rough * case.share()));
        };
        let at = |i: usize, j: usize| ((i % rows) * columns + j % columns) as u32;
        for i in 0..rows {
            for j in 0..columns {
                let v = TAU * j as f64 / columns as f64;
                let point = if is_torus {
                    let u = TAU * i as f64 / rows as f64;
                    let radius = 1.0 + 0.4 * v.cos();
                    DVec3::new(radius * u.cos(), radius * u.sin(), 0.4 * v.sin())
                } else {
                    let u = 0.5 * TAU * (i + 1) as f64 / (rows + 1) as f64;
                    DVec3::new(u.sin() * v.cos(), u.sin() * v.sin(), u.cos())
                };
                add(self, point);
            }
        }
        let mut triangles = Vec::new();
        for i in 0..if is_torus { rows } else { rows - 1 } {
            for j in 0..columns {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        if !is_torus {
            add(self, DVec3::Z);
            add(self, -DVec3::Z);
            let north = (rows * columns) as u32;
            for j in 0..columns {
                triangles.push([north, at(0, j), at(0, j + 1)]);
                triangles.push([north + 1, at(rows - 1, j + 1), at(rows - 1, j)]);
            }
        }
        (vertices, triangles)
    }

    pub fn numbers(&mut self, below: usize) -> Vec<u32> {
        let n = self.below(40);
        let first = self.below(below + 1);
        let in_a_row = self.chance();
        (0..n).map(|k| if in_a_row { (first + k) as u32 } else { self.below(below + 1) as u32 }).collect()
    }

    pub fn smooth(&mut self) -> Smooth {
        [Smooth::Flat, Smooth::Tangent, Smooth::Curvature][self.below(3)]
    }

    pub fn stroke(&mut self) -> Vec<DVec3> {
        let n = self.below(12);
        (0..n).map(|_| DVec3::new(self.coordinate(), self.coordinate(), self.coordinate())).collect()
    }

    pub fn cut_options(&mut self) -> CutOptions {
        let sweep = match self.below(4) {
            0 => Sweep::Through(DVec3::new(self.coordinate(), self.coordinate(), 20.0)),
            1 => Sweep::Along(DVec3::new(self.coordinate(), self.coordinate(), self.coordinate())),
            _ => Sweep::Along(DVec3::Z),
        };
        let mut options = CutOptions::new(sweep);
        options.keep = [Keep::Left, Keep::Right, Keep::Both][self.below(3)];
        options.cap = self.below(4) > 0;
        options.edge_length = (self.below(3) == 0).then(|| 0.2 + f64::from(self.byte()) / 64.0);
        options.gap = if self.below(5) == 0 { f64::from(self.byte()) / 256.0 } else { 0.0 };
        options.smooth = self.smooth();
        options.extend_ends = self.chance();
        options
    }
}
