//! How thick the parts of a drawing are: its limbs, and how many triangles go across them.
//!
//! The drawing, densely sampled, is triangulated (constrained Delaunay). The chords between opposite walls
//! are then its widths, and the dual graph of the triangles its axis: branches run from the tips inwards. A
//! branch that is shorter than it is wide at its root, or than a tenth of the drawing (a corner, a bump, a trembling
//! pen), is left out, and the branch that it grew on goes on as one. What remains are limbs; their width is the area of
//! a stretch divided by its length, so that a ragged line has the width of the smooth one that it trembles about.
//!
//! Source: Prasad, Morphological analysis of shapes, 1997 (chordal axis transform).

mod branch;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;
use rustc_hash::FxHashMap;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::drawing::compact::is_compact;
use crate::drawing::contours::{centroid, read_contours};
use crate::drawing::curve::{ClosedCurve, bounds};
use crate::error::{Error, Result};
use crate::options::CellShape;
use crate::path::placement::ROW_HEIGHT;

use branch::Branch;
pub use branch::Limb;

/// Triangles across a limb that look round, also where it lies askew to the lattice and the body is subdivided.
pub const ACROSS: f64 = 5.0;

/// Samples along a drawing, beside its own points.
const SAMPLES: f64 = 600.0;

/// Samples in a mean width of a drawing, and the most in all: with fewer, chords of long bars lie askew.
const IN_WIDTH: f64 = 4.0;
const MOST_SAMPLES: f64 = 60_000.0;

/// What is shorter than this part of the drawing's size is no limb: what a trembling pen leaves, a rock off the coast.
const SHORTEST: f64 = 0.1;

/// A line is ragged that gets less than this part of its length straight on, over half of the shortest limb. Hand-drawn
/// outlines get .93 and more, those that tremble by a hundredth of their size .86, by two .75.
const STRAIGHT: f64 = 0.92;

/// Stretches of the line whose straightness tells how ragged it is.
const STRETCHES: f64 = 2000.0;

/// The limbs of a drawing, thinnest first; none if nothing of it is longer than it is wide.
///
/// In O(n log n) for `n` points.
///
/// # Errors
/// Those of [`mesh_sketch`](crate::sketch::mesh_sketch) for drawings that are not allowed; [`Error::Solver`] if
/// rounding leaves no triangulation.
pub fn limbs(outline: &[DVec2], holes: &[Vec<DVec2>]) -> Result<Vec<Limb>> {
    limbs_of(&read_contours(outline, holes)?)
}

/// Cells of this edge length across a width.
pub(crate) fn across(width: f64, edge_length: f64, shape: CellShape) -> f64 {
    match shape {
        CellShape::Triangle => width / (ROW_HEIGHT * edge_length),
        CellShape::Quad => width / edge_length,
    }
}

/// The number of triangles, of an area, of which so many go across a width.
pub(crate) fn cells_for(area: f64, width: f64, across: f64, shape: CellShape) -> f64 {
    let height = match shape {
        CellShape::Triangle => ROW_HEIGHT,
        CellShape::Quad => 1.0,
    };
    let edge_length = width / (height * across);
    area / (shape.area() * edge_length * edge_length)
}

/// The limbs of cleaned contours: an outline, and holes that run the other way.
pub(crate) fn limbs_of(contours: &[ClosedCurve]) -> Result<Vec<Limb>> {
    if let [outline] = contours
        && is_compact(outline)
    {
        return Ok(Vec::new());
    }
    let axis = Axis::new(contours)?;
    let mut limbs = axis.branches().iter().filter_map(Branch::limb).collect::<Vec<_>>();
    limbs.sort_by(|a, b| a.width.total_cmp(&b.width));
    Ok(limbs)
}

/// The triangles of a drawing, and what lies beside them.
struct Axis {
    points: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    /// For each triangle the one across the edge from each corner to the next; `NONE` across the drawing's line.
    beside: Vec<[u32; 3]>,
    /// The length of the shortest limb.
    shortest: f64,
}

const NONE: u32 = u32::MAX;

impl Axis {
    fn new(contours: &[ClosedCurve]) -> Result<Self> {
        let (points, edges) = samples(contours);
        let (low, high) = bounds(contours[0].points());
        let scale = (high - low).max_element();
        // About the size of 1, whatever the drawing's units are.
        let near = |point: DVec2| (point - low) / scale + 1.0;
        let (points, near, edges) = different(points, near, edges);
        // Walls nearer to each other than rounding may cross here: then one of them is missing, no more.
        let mesh: ConstrainedDelaunayTriangulation<Point2<f64>> =
            ConstrainedDelaunayTriangulation::try_bulk_load_cdt(near, edges.clone(), |_| ()).map_err(
                |error| Error::Solver { stage: "triangulation of the drawing", reason: error.to_string() },
            )?;
        // Flooded from the left sides of the line.
        let mut number = vec![NONE; mesh.num_all_faces()];
        let mut stack = Vec::new();
        for &[a, b] in edges.iter().rev() {
            let [a, b] = [a, b].map(FixedVertexHandle::from_index);
            if let Some(edge) = mesh.get_edge_from_neighbors(a, b).filter(|edge| edge.is_constraint_edge()) {
                stack.push(edge.face().fix());
            }
        }
        let mut faces = Vec::new();
        while let Some(face) = stack.pop() {
            if number[face.index()] != NONE || mesh.face(face).as_inner().is_none() {
                continue;
            }
            number[face.index()] = faces.len() as u32;
            faces.push(face);
            if let Some(face) = mesh.face(face).as_inner() {
                let across = face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge());
                stack.extend(across.map(|edge| edge.rev().face().fix()));
            }
        }
        let inner = || faces.iter().filter_map(|&face| mesh.face(face).as_inner());
        let triangles = inner().map(|face| face.vertices().map(|v| v.index() as u32)).collect();
        let across = |edge: spade::handles::DirectedEdgeHandle<'_, _, _, _, _>| {
            if edge.is_constraint_edge() { NONE } else { number[edge.rev().face().index()] }
        };
        let beside = inner().map(|face| face.adjacent_edges().map(across)).collect();
        Ok(Axis { points, triangles, beside, shortest: shortest(contours) })
    }

    /// Width and middle of the chord across which triangle `t` meets `other`.
    fn chord(&self, t: usize, other: u32) -> (f64, DVec2) {
        let side = self.beside[t].iter().position(|&beside| beside == other).unwrap_or(0);
        let corner = |k: usize| self.points[self.triangles[t][k % 3] as usize];
        let (a, b) = (corner(side), corner(side + 1));
        (a.distance(b), 0.5 * (a + b))
    }

    /// The middle of a triangle's edges on the line, or its corner between two of them.
    fn tip(&self, t: usize, other: u32) -> DVec2 {
        let side = self.beside[t].iter().position(|&beside| beside == other).unwrap_or(0);
        self.points[self.triangles[t][(side + 2) % 3] as usize]
    }

    fn area(&self, t: usize) -> f64 {
        let [a, b, c] = self.triangles[t].map(|v| self.points[v as usize]);
        0.5 * (b - a).perp_dot(c - a).abs()
    }

    /// Branches from the tips, the shortest first, until they meet; then those around holes.
    fn branches(&self) -> Vec<Branch> {
        let n = self.triangles.len();
        let mut open: Vec<Vec<u32>> = self
            .beside
            .iter()
            .map(|beside| beside.iter().copied().filter(|&other| other != NONE).collect())
            .collect();
        let is_fork: Vec<bool> = open.iter().map(|open| open.len() == 3).collect();
        let mut arrived: Vec<Vec<(u32, Branch)>> = vec![Vec::new(); n];
        let mut done = Vec::new();
        let mut queue = BinaryHeap::new();
        let mut leaving: Vec<Option<Branch>> = vec![None; n];
        let rank = |branch: &Branch| branch.depth.to_bits();
        for t in 0..n {
            if let [other] = open[t][..] {
                let (width, middle) = self.chord(t, other);
                let branch = Branch::from_tip(self.tip(t, other), width, middle, self.area(t), self.shortest);
                queue.push(Reverse((rank(&branch), t)));
                leaving[t] = Some(branch);
            }
        }
        while let Some(Reverse((_, t))) = queue.pop() {
            let (Some(mut branch), Some(&next)) = (leaving[t].take(), open[t].first()) else {
                continue;
            };
            let u = next as usize;
            open[t].clear();
            if let Some(met) = leaving[u].take() {
                // They meet on the chord between them.
                open[u].clear();
                branch.meet(&met, 0.0);
                done.push(branch);
                continue;
            }
            open[u].retain(|&other| other as usize != t);
            arrived[u].push((t as u32, branch));
            match open[u][..] {
                [] => met(std::mem::take(&mut arrived[u]), self.area(u), &mut done),
                [other] => {
                    let from = std::mem::take(&mut arrived[u]);
                    let branch = self.joined(from, is_fork[u], (u, other), &mut done);
                    queue.push(Reverse((rank(&branch), u)));
                    leaving[u] = Some(branch);
                }
                _ => {}
            }
        }
        done.extend(arrived.iter_mut().flat_map(|arrived| arrived.drain(..)).map(|(_, branch)| branch));
        self.rings(&mut open, &mut done);
        done
    }

    /// What leaves triangle `t` through its last side, to `other`, of what has arrived at the others.
    fn joined(
        &self,
        mut from: Vec<(u32, Branch)>,
        is_fork: bool,
        (t, other): (usize, u32),
        done: &mut Vec<Branch>,
    ) -> Branch {
        let (width, middle) = self.chord(t, other);
        if is_fork && from.iter().all(|(_, branch)| branch.is_salient()) && from.len() > 1 {
            let reach = |branch: &Branch| branch.depth + branch.middle().distance(middle);
            let depth = from.iter().map(|(_, branch)| reach(branch)).fold(0.0, f64::max);
            done.extend(from.into_iter().map(|(_, branch)| branch));
            return Branch::from_fork(depth, width, middle, self.shortest);
        }
        // The salient one goes on, or else the longest; the other is a bump on it.
        sort(&mut from);
        let bumps = from.iter().skip(1).map(|(_, bump)| bump.area()).sum::<f64>();
        match from.into_iter().next() {
            Some((_, mut branch)) => {
                branch.push(width, middle, self.area(t) + bumps);
                branch
            }
            None => Branch::from_fork(0.0, width, middle, self.shortest),
        }
    }

    /// Branches that lie around holes: triangles with two open sides between those with three.
    fn rings(&self, open: &mut [Vec<u32>], done: &mut Vec<Branch>) {
        let n = self.triangles.len();
        let forks = (0..n).filter(|&t| open[t].len() == 3).collect::<Vec<_>>();
        for &fork in &forks {
            for first in open[fork].clone() {
                if open[fork].contains(&first) {
                    self.walk(open, fork, first, done);
                }
            }
        }
        for t in 0..n {
            if let [_, first] = open[t][..] {
                self.walk(open, t, first, done);
            }
        }
    }

    /// Follows triangles with two open sides from `t` through its side to `next`, and closes them behind.
    fn walk(&self, open: &mut [Vec<u32>], mut t: usize, mut next: u32, done: &mut Vec<Branch>) {
        let begin = t;
        let (width, middle) = self.chord(t, next);
        let mut branch = Branch::from_fork(0.0, width, middle, self.shortest);
        loop {
            let u = next as usize;
            open[t].retain(|&other| other != next);
            open[u].retain(|&other| other as usize != t);
            let &[onward] = &open[u][..] else { break };
            if u == begin {
                break;
            }
            let (width, middle) = self.chord(u, onward);
            branch.push(width, middle, self.area(u));
            (t, next) = (u, onward);
        }
        done.push(branch);
    }
}

/// How long the shortest limb is: a part of the drawing's size, more where the line is ragged.
fn shortest(contours: &[ClosedCurve]) -> f64 {
    let outline = contours[0].points();
    let centre = centroid(outline);
    let size = 2.0 * outline.iter().map(|point| point.distance(centre)).fold(0.0, f64::max);
    let length = contours.iter().map(ClosedCurve::length).sum::<f64>();
    let step = length / STRETCHES;
    // How far the line gets on stretches of this length; 1 if it is straight.
    let (mut straight, mut count) = (0.0, 0.0);
    for contour in contours {
        let stretch = (0.5 * SHORTEST * size).min(0.125 * contour.length());
        let stretches = (contour.length() / step).ceil();
        for k in 0..stretches as usize {
            let along = contour.length() * k as f64 / stretches;
            straight += contour.point_at(along).distance(contour.point_at(along + stretch)) / stretch;
        }
        count += stretches;
    }
    let straight = straight / count;
    SHORTEST * size * (STRAIGHT / straight).max(1.0).powi(3)
}

/// Points along the contours and the edges between them; the drawing is on their left.
fn samples(contours: &[ClosedCurve]) -> (Vec<DVec2>, Vec<[usize; 2]>) {
    let length = contours.iter().map(ClosedCurve::length).sum::<f64>();
    let area = contours.iter().map(ClosedCurve::area).sum::<f64>().abs();
    let width = 2.0 * area / length;
    let step = (length / SAMPLES).min((width / IN_WIDTH).max(length / MOST_SAMPLES));
    let mut points = Vec::new();
    let mut edges = Vec::new();
    for contour in contours {
        let first = points.len();
        let own = contour.points();
        for (&a, &b) in own.iter().zip(own.iter().cycle().skip(1)) {
            let parts = (a.distance(b) / step).ceil().max(1.0);
            points.extend((0..parts as usize).map(|k| a.lerp(b, k as f64 / parts)));
        }
        edges.extend((first..points.len()).map(|i| [i, if i + 1 < points.len() { i + 1 } else { first }]));
    }
    (points, edges)
}

/// The first goes on where they meet: the salient one, or else the longest.
fn sort(from: &mut [(u32, Branch)]) {
    from.sort_by(|(i, a), (j, b)| {
        let (a, b) = (a.rank(), b.rank());
        b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)).then(i.cmp(j))
    });
}

/// Three branches that meet in a triangle of this area: limbs of their own, or one on which the third is a bump.
fn met(mut from: Vec<(u32, Branch)>, area: f64, done: &mut Vec<Branch>) {
    sort(&mut from);
    match &mut from[..] {
        [(_, one), (_, other), (_, bump)] if !bump.is_salient() => {
            one.meet(other, area + bump.area());
            done.push(from.swap_remove(0).1);
        }
        _ => done.extend(from.into_iter().map(|(_, branch)| branch)),
    }
}

/// Places that are the same once they are brought near count once, and edges between them not at all.
fn different(
    points: Vec<DVec2>,
    near: impl Fn(DVec2) -> DVec2,
    edges: Vec<[usize; 2]>,
) -> (Vec<DVec2>, Vec<Point2<f64>>, Vec<[usize; 2]>) {
    let mut known = FxHashMap::default();
    let (mut kept, mut places) = (Vec::new(), Vec::new());
    let mut number = Vec::with_capacity(points.len());
    for point in points {
        let place = near(point);
        let k = *known.entry(place.to_array().map(f64::to_bits)).or_insert(kept.len());
        if k == kept.len() {
            kept.push(point);
            places.push(Point2::new(place.x, place.y));
        }
        number.push(k);
    }
    let edges = edges.into_iter().map(|edge| edge.map(|v| number[v])).filter(|[a, b]| a != b).collect();
    (kept, places, edges)
}
