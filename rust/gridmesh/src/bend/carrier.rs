//! A coarse triangulation of the drawing that carries the map: boundary samples joined and refined.

use glam::DVec2;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};

use crate::error::Result;
use crate::geometry::segments::{SegmentGrid, nearest_on_segment, orientation, segments_meet};
use crate::options::CellShape;
use crate::progress::{Progress, aside};

/// Least and greatest spacing of the samples along the contours, in edges, and how many of them there are
/// between the two.
const SPACING: (f64, f64) = (1.0, 2.0);
const SAMPLES: f64 = 150.0;
/// A drawn point farther than this from the chord beside it becomes a sample, in edges.
const OFF: f64 = 0.3;
/// Greatest area of a triangle, in squared spacings.
const AREA: f64 = 6.0;
const QUAD_AREA: f64 = 8.0;
/// Rounds of adding samples where chords cross.
const ROUNDS: usize = 12;
/// More boundary vertices are triangulated aside: spade does not ask whether to go on.
const LARGE: usize = 2048;

/// A drawn contour in edges.
pub struct Line {
    pub points: Vec<DVec2>,
    /// Arc length at each point, then the whole length.
    pub arcs: Vec<f64>,
}

impl Line {
    /// Of a closed polyline.
    pub fn new(points: Vec<DVec2>) -> Self {
        let mut arcs = vec![0.0];
        for i in 0..points.len() {
            arcs.push(arcs[i] + points[i].distance(points[(i + 1) % points.len()]));
        }
        Self { points, arcs }
    }

    pub fn length(&self) -> f64 {
        self.arcs[self.points.len()]
    }

    /// The point at an arc length from zero to the whole length.
    pub fn at(&self, s: f64) -> DVec2 {
        let (i, t) = self.place(s);
        self.points[i].lerp(self.points[(i + 1) % self.points.len()], t)
    }

    /// The segment on which an arc length lies, and the parameter on it.
    pub fn place(&self, s: f64) -> (usize, f64) {
        let n = self.points.len();
        let i = self.arcs.partition_point(|&a| a <= s).clamp(1, n) - 1;
        let (from, to) = (self.arcs[i], self.arcs[i + 1]);
        let t = if to > from { ((s - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        (i, t)
    }

    /// The drawn points strictly between two arc lengths.
    fn between(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let arcs = &self.arcs[..self.points.len()];
        arcs.partition_point(|&a| a <= from)..arcs.partition_point(|&a| a < to)
    }
}

/// The boundary vertices of one contour: they are numbered in a row.
pub struct Rim {
    pub start: usize,
    /// Arc lengths, strictly increasing from zero, below the length of the contour.
    pub arcs: Vec<f64>,
    /// Length of the contour.
    pub length: f64,
}

impl Rim {
    pub fn len(&self) -> usize {
        self.arcs.len()
    }

    /// The vertex after the `i`-th.
    pub fn next(&self, i: usize) -> usize {
        self.start + (i + 1) % self.len()
    }

    /// The arc length at which the chord from the `i`-th vertex ends.
    pub fn end(&self, i: usize) -> f64 {
        self.arcs.get(i + 1).copied().unwrap_or(self.length)
    }
}

/// A triangulation of the drawing: boundary vertices first, contour by contour.
pub struct Carrier {
    pub vertices: Vec<DVec2>,
    /// Counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    pub rims: Vec<Rim>,
}

impl Carrier {
    /// None where the contours are so near to each other that no coarse triangulation is found.
    /// `shape` is that of the lattice: squares want turns of the tangents more finely.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled).
    pub fn new(lines: &[Line], shape: CellShape, progress: Progress<'_>) -> Result<Option<Self>> {
        let whole: f64 = lines.iter().map(Line::length).sum();
        let (spacing, largest) = match shape {
            CellShape::Triangle => {
                let spacing = (whole / SAMPLES).clamp(SPACING.0, SPACING.1);
                (spacing, AREA * spacing * spacing)
            }
            CellShape::Quad => (SPACING.0, QUAD_AREA),
        };
        let Some(rims) = samples(lines, spacing, progress)? else { return Ok(None) };
        let mut points: Vec<Point2<f64>> = Vec::new();
        let mut edges = Vec::new();
        for (rim, line) in rims.iter().zip(lines) {
            points.extend(rim.arcs.iter().map(|&s| line.at(s)).map(|p| Point2::new(p.x, p.y)));
            edges.extend((0..rim.len()).map(|i| [rim.start + i, rim.next(i)]));
        }
        let area: f64 = lines.iter().map(|line| 0.5 * doubled_area(&line.points)).sum();
        let made = if points.len() > LARGE {
            aside(progress, move || triangulated(points, edges, largest, area))?
        } else {
            triangulated(points, edges, largest, area)
        };
        Ok(made.map(|(vertices, triangles)| Self { vertices, triangles, rims }))
    }

    /// A third of the area of the triangles at each vertex.
    pub fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.vertices.len()];
        for t in &self.triangles {
            let third = self.doubled_area(t) / 6.0;
            t.iter().for_each(|&v| areas[v as usize] += third);
        }
        areas
    }

    /// Twice the area of a triangle.
    pub fn doubled_area(&self, triangle: &[u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|i| self.vertices[i as usize]);
        (b - a).perp_dot(c - a)
    }

    /// Length of contour that each boundary vertex stands for.
    pub fn lengths(&self) -> Vec<f64> {
        let of = |rim: &Rim| {
            let gap = |i: usize| rim.end(i) - rim.arcs[i];
            let n = rim.len();
            (0..n).map(|i| 0.5 * (gap(i) + gap((i + n - 1) % n))).collect::<Vec<f64>>()
        };
        self.rims.iter().flat_map(of).collect()
    }
}

/// Vertices and triangles of a refined triangulation: those of the boundary first, in their order. None where the
/// boundary meets itself. `largest` is the greatest area of a triangle, `area` that of the whole.
fn triangulated(
    points: Vec<Point2<f64>>,
    edges: Vec<[usize; 2]>,
    largest: f64,
    area: f64,
) -> Option<(Vec<DVec2>, Vec<[u32; 3]>)> {
    let n_rim = points.len();
    let mut is_sound = true;
    let mut delaunay: ConstrainedDelaunayTriangulation<Point2<f64>> =
        ConstrainedDelaunayTriangulation::try_bulk_load_cdt(points, edges, |_| is_sound = false).ok()?;
    if !is_sound || delaunay.num_vertices() != n_rim {
        return None;
    }
    let parameters = RefinementParameters::<f64>::new()
        .exclude_outer_faces(true)
        .keep_constraint_edges()
        .with_angle_limit(AngleLimit::from_deg(25.0))
        .with_max_allowed_area(largest)
        .with_max_additional_vertices(8 * n_rim + (2.0 * area / largest) as usize);
    let outer = delaunay.refine(parameters).excluded_faces;
    let mut is_outer = vec![false; delaunay.num_all_faces()];
    outer.iter().for_each(|face| is_outer[face.index()] = true);
    // The vertices of the drawing alone, in their order.
    let mut number = vec![u32::MAX; delaunay.num_vertices()];
    let faces = || delaunay.inner_faces().filter(|face| !is_outer[face.fix().index()]);
    for face in faces() {
        face.vertices().iter().for_each(|v| number[v.fix().index()] = 0);
    }
    let mut vertices = Vec::new();
    for (vertex, number) in delaunay.vertices().zip(&mut number) {
        if *number == 0 {
            *number = vertices.len() as u32;
            vertices.push(DVec2::new(vertex.position().x, vertex.position().y));
        }
    }
    if number[..n_rim].iter().enumerate().any(|(i, &v)| v as usize != i) {
        return None;
    }
    let triangles = faces().map(|face| face.vertices().map(|v| number[v.fix().index()])).collect();
    Some((vertices, triangles))
}

fn doubled_area(points: &[DVec2]) -> f64 {
    (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum()
}

/// Samples whose chords are near the drawing and do not meet.
fn samples(lines: &[Line], spacing: f64, progress: Progress<'_>) -> Result<Option<Vec<Rim>>> {
    let mut arcs: Vec<Vec<f64>> = lines.iter().map(|line| followed(line, spacing)).collect();
    for _ in 0..ROUNDS {
        progress.report(0.0)?;
        let mut owner = Vec::new();
        let mut chords = Vec::new();
        for (k, (line, arcs)) in lines.iter().zip(&arcs).enumerate() {
            let points: Vec<DVec2> = arcs.iter().map(|&s| line.at(s)).collect();
            let n = points.len();
            owner.extend((0..n).map(|i| (k, i)));
            chords.extend((0..n).map(|i| [points[i], points[(i + 1) % n]]));
        }
        let mut meeting = vec![false; chords.len()];
        SegmentGrid::new(&chords).pairs(|i, j| {
            let ((k, a), (l, b)) = (owner[i], owner[j]);
            let n = arcs[k].len();
            let meet = if k == l && (b == a + 1 || (a == 0 && b == n - 1)) {
                let (p, q) = if b == a + 1 { (chords[i], chords[j]) } else { (chords[j], chords[i]) };
                orientation(p[0], p[1], q[1]) == 0.0 && (p[1] - p[0]).dot(q[1] - q[0]) <= 0.0
            } else {
                segments_meet(chords[i], chords[j])
            };
            meeting[i] |= meet;
            meeting[j] |= meet;
            true
        });
        if !meeting.contains(&true) {
            let mut start = 0;
            let rims = arcs.into_iter().zip(lines).map(|(arcs, line)| {
                let rim = Rim { start, arcs, length: line.length() };
                start += rim.len();
                rim
            });
            return Ok(Some(rims.collect()));
        }
        let chord = |&(k, i): &(usize, usize)| {
            let end = arcs[k].get(i + 1).copied().unwrap_or(lines[k].length());
            farthest(&lines[k], arcs[k][i], end, 0.0).map(|s| (k, s))
        };
        let added: Vec<(usize, f64)> =
            owner.iter().zip(&meeting).filter(|(_, meet)| **meet).filter_map(|(of, _)| chord(of)).collect();
        if added.is_empty() {
            return Ok(None);
        }
        for (k, s) in added {
            arcs[k].push(s);
        }
        arcs.iter_mut().for_each(|arcs| arcs.sort_by(f64::total_cmp));
    }
    Ok(None)
}

/// Even samples, and drawn points that stray from the chords.
fn followed(line: &Line, spacing: f64) -> Vec<f64> {
    let length = line.length();
    let n = ((length / spacing).ceil() as usize).max(8);
    let mut arcs = Vec::with_capacity(n);
    for i in 0..n {
        let (from, to) = (length * i as f64 / n as f64, length * (i + 1) as f64 / n as f64);
        arcs.push(from);
        follow(line, from, to, &mut arcs);
    }
    arcs
}

fn follow(line: &Line, from: f64, to: f64, arcs: &mut Vec<f64>) {
    if let Some(s) = farthest(line, from, to, OFF) {
        follow(line, from, s, arcs);
        arcs.push(s);
        follow(line, s, to, arcs);
    }
}

/// Arc length of the drawn point between two others that is farthest from their chord.
fn farthest(line: &Line, from: f64, to: f64, least: f64) -> Option<f64> {
    let (a, b) = (line.at(from), line.at(to));
    line.between(from, to)
        .filter(|&i| line.arcs[i] > from && line.arcs[i] < to)
        .map(|i| (nearest_on_segment(line.points[i], a, b).1, i))
        .filter(|&(squared, _)| squared > least * least)
        .max_by(|x, y| x.0.total_cmp(&y.0).then(y.1.cmp(&x.1)))
        .map(|(_, i)| line.arcs[i])
}
