//! How thick the parts of a drawing are: its limbs, and how many triangles go across them.
//!
//! The drawing, densely sampled, is triangulated (constrained Delaunay). The chords between opposite walls
//! are then its widths, and the dual graph of the triangles its axis: branches run from the tips inwards. A
//! branch that is shorter than it is wide at its root (a corner, a bump, a trembling pen) is left out, and the
//! branch that it grew on goes on as one. What remains are limbs, and widths along them.
//!
//! Source: Prasad, Morphological analysis of shapes, 1997 (chordal axis transform).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::drawing::compact::is_compact;
use crate::drawing::contours::read_contours;
use crate::drawing::curve::{ClosedCurve, bounds};
use crate::error::{Error, Result};
use crate::options::CellShape;
use crate::path::placement::ROW_HEIGHT;

/// Triangles across a limb that look round, also where it lies askew to the lattice and the body is subdivided.
pub const ACROSS: f64 = 5.0;

/// Samples along a drawing, beside its own points.
const SAMPLES: f64 = 600.0;

/// Samples in a mean width of a drawing, and the most in all: with fewer, chords of long bars lie askew.
const IN_WIDTH: f64 = 4.0;
const MOST_SAMPLES: f64 = 60_000.0;

/// A branch is left out if it is shorter than this times its width at the root.
const SALIENT: f64 = 0.9;

/// The tip of a limb, this part of its length, does not count: it may be as sharp as it likes.
const TIP: f64 = 0.5;

/// A limb is at least this many times as long as it is wide.
const LONG: f64 = 1.25;

/// What is shorter than this part of the drawing's size is no limb: a trembling pen, a rock off the coast.
const SHORTEST: f64 = 0.04;

/// A limb ends where it is this many times as wide.
const WIDENED: f64 = 4.0;

/// A part of a drawing that is longer than it is wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// The middle of its thinnest place.
    pub at: DVec2,
    /// Its width there, the mean over a stretch as long as it is wide.
    pub width: f64,
    /// How long it is.
    pub length: f64,
}

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
    let (low, high) = bounds(contours[0].points());
    let shortest = SHORTEST * low.distance(high);
    let mut limbs = axis.branches().iter().filter_map(Branch::limb).collect::<Vec<_>>();
    limbs.retain(|limb| limb.length >= shortest.max(LONG * limb.width));
    limbs.sort_by(|a, b| a.width.total_cmp(&b.width));
    Ok(limbs)
}

/// A place on a branch.
#[derive(Clone, Copy, Debug)]
struct Chord {
    /// How far along the branch, from its tip or beginning.
    along: f64,
    width: f64,
    middle: DVec2,
}

/// Chords from a tip inwards, or between two places where branches meet.
#[derive(Clone, Debug)]
struct Branch {
    chords: Vec<Chord>,
    has_tip: bool,
    /// How far from the farthest tip behind it its last chord is.
    depth: f64,
}

impl Branch {
    fn from_tip(tip: DVec2, width: f64, middle: DVec2) -> Self {
        let along = tip.distance(middle);
        Branch { chords: vec![Chord { along, width, middle }], has_tip: true, depth: along }
    }

    fn from_fork(depth: f64, width: f64, middle: DVec2) -> Self {
        Branch { chords: vec![Chord { along: 0.0, width, middle }], has_tip: false, depth }
    }

    fn last(&self) -> Chord {
        self.chords[self.chords.len() - 1]
    }

    fn push(&mut self, width: f64, middle: DVec2) {
        let last = self.last();
        let step = last.middle.distance(middle);
        self.chords.push(Chord { along: last.along + step, width, middle });
        self.depth += step;
    }

    /// True for more than a corner or a bump on what lies behind its last chord.
    fn is_salient(&self) -> bool {
        let last = self.last();
        !self.has_tip || last.along >= SALIENT * last.width
    }

    /// The thinnest place that is longer than it is wide.
    fn limb(&self) -> Option<Limb> {
        let chords = &self.chords;
        if !self.is_salient() {
            return None;
        }
        // Integral of the width along the branch.
        let mut sums = vec![0.0; chords.len()];
        for (k, pair) in chords.windows(2).enumerate() {
            sums[k + 1] = sums[k] + 0.5 * (pair[0].width + pair[1].width) * (pair[1].along - pair[0].along);
        }
        let at = |along: f64| -> f64 {
            let k = chords.partition_point(|chord| chord.along < along).clamp(1, chords.len().max(2) - 1);
            let Some(b) = chords.get(k) else { return 0.0 };
            let a = chords[k - 1];
            let step = b.along - a.along;
            let t = if step > 0.0 { ((along - a.along) / step).clamp(0.0, 1.0) } else { 0.0 };
            sums[k - 1] + t * (sums[k] - sums[k - 1])
        };
        let (first, last) = (chords[0].along, self.last().along);
        let ends = self.widened();
        let mut best: Option<Limb> = None;
        for (chord, &end) in chords.iter().zip(&ends) {
            if self.has_tip && chord.along < TIP * end {
                continue;
            }
            let (low, high) = (chord.along - 0.5 * chord.width, chord.along + 0.5 * chord.width);
            if low < first || high > last {
                continue;
            }
            let width = (at(high) - at(low)) / chord.width;
            if best.is_none_or(|best| width < best.width) {
                let begin = if self.has_tip { 0.0 } else { first };
                best = Some(Limb { at: chord.middle, width, length: end - begin });
            }
        }
        best
    }

    /// For each chord, how far along the branch has become [`WIDENED`] times as wide, or ends.
    fn widened(&self) -> Vec<f64> {
        let last = self.last().along;
        let mut ends = vec![last; self.chords.len()];
        // Chords that still wait for a wider one, widest first: each new one serves the thinnest of them.
        let mut waiting: Vec<usize> = Vec::new();
        for (k, chord) in self.chords.iter().enumerate() {
            while let Some(&j) = waiting.last()
                && chord.width > WIDENED * self.chords[j].width
            {
                ends[j] = chord.along;
                waiting.pop();
            }
            // What is wider than this chord and before it ends no later than this one widens enough.
            let place = waiting.partition_point(|&j| self.chords[j].width > chord.width);
            waiting.insert(place, k);
        }
        ends
    }
}

/// The triangles of a drawing, and what lies beside them.
struct Axis {
    points: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    /// For each triangle the one across the edge from each corner to the next; `NONE` across the drawing's line.
    beside: Vec<[u32; 3]>,
}

const NONE: u32 = u32::MAX;

impl Axis {
    fn new(contours: &[ClosedCurve]) -> Result<Self> {
        let (points, edges) = samples(contours);
        let (low, high) = bounds(contours[0].points());
        let scale = (high - low).max_element();
        // About the size of 1, whatever the drawing's units are.
        let near = |point: &DVec2| (*point - low) / scale + 1.0;
        let near = points.iter().map(near).map(|p| Point2::new(p.x, p.y)).collect();
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
        Ok(Axis { points, triangles, beside })
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
                let branch = Branch::from_tip(self.tip(t, other), width, middle);
                queue.push(Reverse((rank(&branch), t)));
                leaving[t] = Some(branch);
            }
        }
        while let Some(Reverse((_, t))) = queue.pop() {
            let (Some(branch), Some(&next)) = (leaving[t].take(), open[t].first()) else {
                continue;
            };
            let u = next as usize;
            open[t].clear();
            if let Some(met) = leaving[u].take() {
                // They meet on the chord between them.
                open[u].clear();
                done.extend([branch, met]);
                continue;
            }
            open[u].retain(|&other| other as usize != t);
            arrived[u].push((t as u32, branch));
            match open[u][..] {
                [] => done.extend(arrived[u].drain(..).map(|(_, branch)| branch)),
                [other] => {
                    let (width, middle) = self.chord(u, other);
                    let from = std::mem::take(&mut arrived[u]);
                    let branch = joined(from, is_fork[u], width, middle, &mut done);
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
        let mut branch = Branch::from_fork(0.0, width, middle);
        loop {
            let u = next as usize;
            open[t].retain(|&other| other != next);
            open[u].retain(|&other| other as usize != t);
            let &[onward] = &open[u][..] else { break };
            if u == begin {
                break;
            }
            let (width, middle) = self.chord(u, onward);
            branch.push(width, middle);
            (t, next) = (u, onward);
        }
        done.push(branch);
    }
}

/// Points along the contours, all different, and the edges between them; the drawing is on their left.
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

/// What leaves a triangle through its last side, of what has arrived at the others.
fn joined(
    mut from: Vec<(u32, Branch)>,
    is_fork: bool,
    width: f64,
    middle: DVec2,
    done: &mut Vec<Branch>,
) -> Branch {
    if is_fork && from.iter().all(|(_, branch)| branch.is_salient()) && from.len() > 1 {
        let reach = |branch: &Branch| branch.depth + branch.last().middle.distance(middle);
        let depth = from.iter().map(|(_, branch)| reach(branch)).fold(0.0, f64::max);
        done.extend(from.into_iter().map(|(_, branch)| branch));
        return Branch::from_fork(depth, width, middle);
    }
    // The salient one goes on, or else the longest; the other is a bump on it.
    from.sort_by(|(i, a), (j, b)| {
        let key = |branch: &Branch| (branch.is_salient(), branch.last().along);
        let (a, b) = (key(a), key(b));
        b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)).then(i.cmp(j))
    });
    let mut from = from.into_iter().map(|(_, branch)| branch);
    match from.next() {
        Some(mut branch) => {
            branch.push(width, middle);
            branch
        }
        None => Branch::from_fork(0.0, width, middle),
    }
}
