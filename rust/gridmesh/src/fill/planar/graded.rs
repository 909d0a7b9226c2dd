//! Patches for loops that no single lattice fits: points of nested lattices, as fine as the loop is
//! near by, joined by a constrained Delaunay triangulation. Works for every simple polygon.

use glam::DVec2;
use rayon::prelude::*;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

use super::flips::improve_valences;
use super::settle::{Rings, even_out, untangle};
use super::walls::Walls;
use crate::error::{Error, Result};
use crate::geometry::stars::Stars;
use crate::lattice::axial::Axial;
use crate::path::placement::Lattice;
use crate::progress::Progress;

/// How much the size of the triangles grows per length, away from the loop.
const GROWTH: f64 = 0.35;

/// Interior vertices and triangles of a simple counter-clockwise polygon.
pub(in crate::fill) fn graded(
    polygon: &[DVec2],
    wanted: &[i32],
    taken: &dyn Fn(usize, usize) -> bool,
    progress: Progress<'_>,
) -> Result<(Vec<DVec2>, Vec<[u32; 3]>)> {
    let n = polygon.len();
    let field = SizeField::new(polygon);
    let mut positions = polygon.to_vec();
    positions.extend(field.points(polygon, progress)?);
    let mut triangles = triangulate(&positions, n, progress)?;
    // An edge that the mesh has already is split, and whatever edges that brings.
    for _ in 0..16 {
        let repeated = repeated_edges(&triangles, n, taken);
        if repeated.is_empty() {
            break;
        }
        for (i, j) in repeated {
            positions.push(0.5 * (positions[i] + positions[j]));
        }
        triangles = triangulate(&positions, n, progress)?;
    }
    drop_unused(&mut positions, n, &mut triangles);
    let mut settled = positions.clone();
    for _ in 0..3 {
        improve_valences(&settled, &mut triangles, wanted, taken, progress)?;
        if let Some(rings) = Rings::new(&triangles, n, settled.len(), progress)? {
            if !untangle(&rings, &mut settled, 4, progress)? {
                break;
            }
            even_out(&rings, &mut settled, vec![true; rings.len()], 8, 0.02, progress)?;
        }
    }
    Ok((settled.split_off(n), triangles))
}

/// Takes away vertices behind the first `n` that no triangle has: in a polygon that is hardly wider than the precision
/// of its numbers, points of the lattice or midpoints may lie outside or upon others.
fn drop_unused(positions: &mut Vec<DVec2>, n: usize, triangles: &mut [[u32; 3]]) {
    let mut is_used = vec![false; positions.len()];
    is_used[..n].fill(true);
    for &v in triangles.iter().flatten() {
        is_used[v as usize] = true;
    }
    let mut number = Vec::with_capacity(positions.len());
    let mut next = 0;
    for &used in &is_used {
        number.push(next);
        next += u32::from(used);
    }
    for v in triangles.iter_mut().flatten() {
        *v = number[*v as usize];
    }
    let mut used = is_used.into_iter();
    positions.retain(|_| used.next() == Some(true));
}

/// Edges across the patch between loop vertices that are taken, each once, in order.
pub(in crate::fill) fn repeated_edges(
    triangles: &[[u32; 3]],
    n: usize,
    taken: &dyn Fn(usize, usize) -> bool,
) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for t in triangles {
        for k in 0..3 {
            let (i, j) = (t[k] as usize, t[(k + 1) % 3] as usize);
            if i < j && j < n && j - i > 1 && j - i < n - 1 && taken(i, j) {
                found.push((i, j));
            }
        }
    }
    found.sort_unstable();
    found
}

/// The constrained Delaunay triangles inside the polygon of the first `n` positions.
pub(in crate::fill) fn triangulate(
    positions: &[DVec2],
    n: usize,
    progress: Progress<'_>,
) -> Result<Vec<[u32; 3]>> {
    const ASK_EVERY: usize = 1 << 12;
    let failed = |reason: String| Error::Solver { stage: "triangulation of the hole", reason };
    let mut mesh: ConstrainedDelaunayTriangulation<Point2<f64>> = ConstrainedDelaunayTriangulation::new();
    let mut number = Vec::with_capacity(positions.len());
    let mut vertex = Vec::with_capacity(n);
    for (i, p) in positions.iter().enumerate() {
        if i % ASK_EVERY == 0 {
            progress.report(0.0)?;
        }
        let place = mitigate_underflow(Point2::new(p.x, p.y));
        let handle = mesh.insert(place).map_err(|e| failed(e.to_string()))?;
        if handle.index() == number.len() {
            number.push(i as u32);
        } else if i < n {
            return Err(failed(format!("vertices {} and {i} of the loop coincide", number[handle.index()])));
        }
        if i < n {
            vertex.push(handle);
        }
    }
    for i in 0..n {
        if mesh.try_add_constraint(vertex[i], vertex[(i + 1) % n]).is_empty() {
            return Err(failed(format!("the loop meets itself at edge {i}")));
        }
    }
    // A triangle is inside if the loop winds around it: its faces are found by flooding from the
    // left sides of the loop's edges.
    let mut inside = vec![false; mesh.num_all_faces()];
    let mut stack = Vec::new();
    for i in 0..n {
        match mesh.get_edge_from_neighbors(vertex[i], vertex[(i + 1) % n]) {
            Some(edge) => stack.push(edge.face().fix()),
            None => return Err(failed(format!("edge {i} of the loop passes through another vertex"))),
        }
    }
    let mut triangles = Vec::new();
    while let Some(face) = stack.pop() {
        if std::mem::replace(&mut inside[face.index()], true) {
            continue;
        }
        let Some(face) = mesh.face(face).as_inner() else {
            return Err(failed("the loop is not counter-clockwise".into()));
        };
        triangles.push(face.vertices().map(|v| number[v.index()]));
        for edge in face.adjacent_edges() {
            if !edge.is_constraint_edge() {
                stack.push(edge.rev().face().fix());
            }
        }
    }
    Ok(triangles)
}

/// How long edges should be: as the loop's edges near by, growing with the distance from them.
struct SizeField {
    /// Middle and length of each edge.
    edges: Vec<(DVec2, f64)>,
}

impl SizeField {
    fn new(polygon: &[DVec2]) -> SizeField {
        let n = polygon.len();
        let edge = |k: usize| {
            let (a, b) = (polygon[k], polygon[(k + 1) % n]);
            (0.5 * (a + b), a.distance(b))
        };
        SizeField { edges: (0..n).map(edge).collect() }
    }

    /// The size that an edge asks for at a point. Within half its length of its middle, its own.
    fn asked(&self, edge: u32, x: DVec2) -> f64 {
        let (middle, length) = self.edges[edge as usize];
        length + GROWTH * (x.distance(middle) - 0.5 * length).max(0.0)
    }

    /// Vertices of a triangular lattice that is halved until it is as fine as wished, inside the
    /// polygon and not too near its edges; in a fixed order.
    fn points(&self, polygon: &[DVec2], progress: Progress<'_>) -> Result<Vec<DVec2>> {
        let low = polygon.iter().fold(DVec2::INFINITY, |a, &b| a.min(b));
        let high = polygon.iter().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b));
        let across = (high - low).max_element();
        let least = self.edges.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
        // The finest lattice has edges of the least size; one coarse triangle covers all.
        let fine = least.max(across * 1e-5).max(f64::MIN_POSITIVE);
        let levels = libm::log2(4.0 * across / fine).ceil().clamp(1.0, 24.0) as u32;
        let origin = low - DVec2::new(across, 0.5 * across);
        let descent = Descent { field: self, low, high, origin, fine, progress };
        let all: Vec<u32> = (0..polygon.len() as u32).collect();
        let mut found = Vec::new();
        descent.visit(Axial::default(), 1 << levels, 1, &all, &mut found)?;
        found.sort_unstable_by_key(|f| f.0);
        found.dedup_by_key(|f| f.0);
        let walls = Walls::new(polygon);
        let place = |p: Axial| origin + fine * Lattice::units(p);
        let clear = |(p, size): (Axial, f64)| (walls.depth(place(p)) > CLEARANCE * size).then(|| place(p));
        let mut points = Vec::new();
        for some in found.chunks(ASK_EVERY) {
            progress.report(0.0)?;
            let clear: Vec<DVec2> = some.par_iter().with_min_len(256).copied().filter_map(clear).collect();
            points.extend(clear);
        }
        Ok(outside_lenses(points, polygon))
    }
}

/// Leaves out points from which an edge of the loop is seen under more than 110 degrees: its
/// triangle would be flat. Such points lie beside long edges that have short ones near by.
fn outside_lenses(points: Vec<DVec2>, polygon: &[DVec2]) -> Vec<DVec2> {
    const FLAT: f64 = -0.342_020_143_325_668_7; // cos 110
    const HEIGHT: f64 = 0.36;
    let place = |(i, p): (usize, &DVec2)| GeomWithData::new(p.to_array(), i);
    let tree = RTree::bulk_load(points.iter().enumerate().map(place).collect());
    let mut keep = vec![true; points.len()];
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let pad = DVec2::splat(HEIGHT * a.distance(b));
        let near = AABB::from_corners((a.min(b) - pad).to_array(), (a.max(b) + pad).to_array());
        for found in tree.locate_in_envelope(near) {
            let (u, v) = (a - points[found.data], b - points[found.data]);
            keep[found.data] &= u.dot(v) > FLAT * u.length() * v.length();
        }
    }
    points.into_iter().zip(keep).filter_map(|(p, keep)| keep.then_some(p)).collect()
}

/// Distance of a vertex from the loop, in sizes, at least.
const CLEARANCE: f64 = 0.6;

/// Halves triangles down to the wished size.
struct Descent<'a> {
    field: &'a SizeField,
    low: DVec2,
    high: DVec2,
    origin: DVec2,
    fine: f64,
    progress: Progress<'a>,
}

/// Points between two questions whether to go on.
const ASK_EVERY: usize = 1 << 14;

/// With more edges near by, the quarters of a triangle are worth a thread each.
const MANY: usize = 64;

impl Descent<'_> {
    /// The triangle with a corner and edges of `edge` steps of the finest lattice, pointing up or
    /// down (`up` = -1); `near` are the edges of the loop that may ask for the least size in it. Found are
    /// corners of the triangles that are small enough, with the size wished there.
    fn visit(
        &self,
        corner: Axial,
        edge: i32,
        up: i32,
        near: &[u32],
        found: &mut Vec<(Axial, f64)>,
    ) -> Result<()> {
        let place = |p: Axial| self.origin + self.fine * Lattice::units(p);
        let (a, b) = (Axial::new(edge * up, 0), Axial::new(0, edge * up));
        let corners = [corner, corner + a, corner + b];
        let centre = corners.iter().map(|&p| place(p)).sum::<DVec2>() / 3.0;
        let length = f64::from(edge) * self.fine;
        let reach = 0.6 * length;
        if (centre.clamp(self.low, self.high) - centre).length() > reach {
            return Ok(());
        }
        let asked: Vec<f64> = near.iter().map(|&e| self.field.asked(e, centre)).collect();
        let wished = asked.iter().copied().fold(f64::INFINITY, f64::min);
        let most = wished + 2.0 * GROWTH * reach;
        let near: Vec<u32> = near.iter().zip(asked).filter(|&(_, size)| size <= most).map(|n| *n.0).collect();
        if edge == 1 || length <= 1.3 * wished {
            let size = |p| near.iter().map(|&e| self.field.asked(e, p)).fold(f64::INFINITY, f64::min);
            let sized = corners.map(|p| (p, size(place(p))));
            found.extend(sized);
            return Ok(());
        }
        let half = edge / 2;
        let (a, b) = (Axial::new(half * up, 0), Axial::new(0, half * up));
        let quarters = [(corner, up), (corner + a, up), (corner + b, up), (corner + a + b, -up)];
        if near.len() > MANY {
            self.progress.report(0.0)?;
            let visited = quarters.into_par_iter().map(|(corner, up)| {
                let mut own = Vec::new();
                self.visit(corner, half, up, &near, &mut own).map(|()| own)
            });
            for own in visited.collect::<Vec<Result<_>>>() {
                found.extend(own?);
            }
            return Ok(());
        }
        quarters.into_iter().try_for_each(|(corner, up)| self.visit(corner, half, up, &near, found))
    }
}
