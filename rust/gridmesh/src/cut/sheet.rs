//! The surface that a stroke sweeps: seen along the sweep it is a line in the plane.
//!
//! Everything is decided in this plane, on the rounded projections of the vertices, by exact predicates. Where
//! they say "on the line", the stroke counts as moved by (-e^2, e) for an e less than any number: then
//! nothing is on the line, and all answers fit together.

pub(crate) mod offset;
pub(crate) mod reach;
pub(crate) mod roll;
pub(crate) mod sides;
pub(crate) mod simplify;

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

use super::options::Sweep;
use crate::error::{Error, Result};
use crate::geometry::segments::{SegmentGrid, segments_meet};

/// How space is seen along the sweep.
#[derive(Clone, Debug)]
pub(super) struct View {
    /// The eye, or the mean of the mesh.
    pub origin: DVec3,
    /// Right, up and away from the viewer.
    pub axes: [DVec3; 3],
    pub central: bool,
}

impl View {
    pub fn new(vertices: &[DVec3], stroke: &[DVec3], sweep: Sweep) -> Self {
        match sweep {
            Sweep::Along(direction) => {
                let origin = vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64;
                View { origin, axes: axes(direction), central: false }
            }
            Sweep::Through(eye) => {
                let to = |p: &DVec3| (*p - eye).normalize_or_zero();
                View { origin: eye, axes: axes(stroke.iter().map(to).sum()), central: true }
            }
        }
    }

    /// Where a point is seen; `None` if it is not in front of the eye.
    pub fn project(&self, p: DVec3) -> Option<DVec2> {
        let [right, up, away] = self.axes;
        let d = p - self.origin;
        let seen = DVec2::new(d.dot(right), d.dot(up));
        if !self.central {
            return Some(seen);
        }
        let depth = d.dot(away);
        (depth > 1e-9 * d.length()).then(|| seen / depth)
    }

    /// How far away a point is: along the direction, or from the eye.
    pub fn height(&self, p: DVec3) -> f64 {
        let d = p - self.origin;
        if self.central { d.length() } else { d.dot(self.axes[2]) }
    }

    /// Depth before the eye; 1 without an eye. A point between two others is seen between them, nearer to
    /// the one of less depth.
    pub fn depth(&self, p: DVec3) -> f64 {
        if self.central { (p - self.origin).dot(self.axes[2]) } else { 1.0 }
    }

    /// The point seen at `q` at this height.
    pub fn lift(&self, q: DVec2, height: f64) -> DVec3 {
        let [right, up, away] = self.axes;
        let across = q.x * right + q.y * up;
        if self.central {
            self.origin + height * (across + away).normalize_or(away)
        } else {
            self.origin + across + height * away
        }
    }

    /// The direction of the ray seen at `q`.
    pub fn ray(&self, q: DVec2) -> DVec3 {
        let [right, up, away] = self.axes;
        if self.central { (q.x * right + q.y * up + away).normalize_or(away) } else { away }
    }
}

/// Right and up for a view along `direction`: right x up points back to the viewer.
fn axes(direction: DVec3) -> [DVec3; 3] {
    // The squares of the least and greatest lengths vanish or overflow.
    let scaled = || (direction / direction.abs().max_element()).normalize_or(DVec3::Z);
    let away = direction.try_normalize().unwrap_or_else(scaled);
    let (right, up) = (-away).any_orthonormal_pair();
    [right, up, away]
}

/// The line in the plane, and how its surface unrolls.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub view: View,
    /// The line; open ones with their continuations to beyond the mesh, closed ones counter-clockwise.
    pub points: Vec<DVec2>,
    pub closed: bool,
    /// Around what is left of an open line, from its end back to its start, beyond the mesh.
    around: Vec<DVec2>,
    /// Length of the unrolled surface up to each point and, if closed, up to the first one again: length in
    /// the plane, or the angle between rays.
    arc: Vec<f64>,
    /// Extent of mesh and line in the plane.
    size: f64,
    /// Extent of the mesh.
    pub low: DVec2,
    pub high: DVec2,
    /// Where every vertex is seen.
    pub seen: Arc<Vec<DVec2>>,
}

impl Sheet {
    /// # Errors
    /// [`Error::BehindEye`], [`Error::StrokeTooShort`], [`Error::SelfIntersecting`].
    pub fn new(vertices: &[DVec3], stroke: &[DVec3], sweep: Sweep) -> Result<Self> {
        let view = View::new(vertices, stroke, sweep);
        let see = |what: &'static str, points: &[DVec3]| {
            let one = |(point, p): (usize, &DVec3)| view.project(*p).ok_or(Error::BehindEye { what, point });
            points.iter().enumerate().map(one).collect::<Result<Vec<_>>>()
        };
        let seen = see("mesh", vertices)?;
        let mut points = see("stroke", stroke)?;
        let mut low = DVec2::INFINITY;
        let mut high = DVec2::NEG_INFINITY;
        for p in &seen {
            (low, high) = (low.min(*p), high.max(*p));
        }
        if seen.is_empty() {
            return Err(Error::StrokeMisses);
        }
        let (mut least, mut most) = (low, high);
        for p in &points {
            (least, most) = (least.min(*p), most.max(*p));
        }
        let size = (most - least).length();
        let stroke_size = stroke.iter().map(|p| p.distance(stroke[0])).fold(0.0, f64::max);
        points.dedup_by(|b, a| a.distance(*b) <= 1e-9 * size);
        let mut closed = false;
        if points.len() > 3
            && stroke.len() > 3
            && stroke[0].distance(stroke[stroke.len() - 1]) <= 1e-9 * stroke_size
        {
            points.pop();
            closed = true;
        }
        let needed = if closed { 3 } else { 2 };
        if points.len() < needed {
            return Err(Error::StrokeTooShort { distinct: points.len() });
        }
        let seen = Arc::new(seen);
        let mut sheet = Sheet { view, points, closed, around: vec![], arc: vec![], size, low, high, seen };
        if closed {
            let area: f64 =
                (0..sheet.points.len()).map(|k| sheet.point(k).perp_dot(sheet.point(k + 1))).sum();
            if area < 0.0 {
                sheet.points.reverse();
            }
        } else {
            sheet.continue_ends(0.5 * (least + most));
        }
        sheet.refuse_crossings()?;
        sheet.measure();
        Ok(sheet)
    }

    /// The point of this number, counted on around closed lines.
    pub fn point(&self, k: usize) -> DVec2 {
        self.points[k % self.points.len()]
    }

    /// Number of segments; the k-th runs from point k to the next one.
    pub fn n_segments(&self) -> usize {
        self.points.len() - usize::from(!self.closed)
    }

    pub fn segment(&self, k: usize) -> [DVec2; 2] {
        [self.points[k], self.point(k + 1)]
    }

    /// The same line moved a little, `k` times as far: for where rounding stands in the way.
    pub fn nudged(&self, k: usize) -> Self {
        self.moved(1e-7 * k as f64 * self.size)
    }

    /// The same line moved by about as much, in units of the plane.
    pub fn moved(&self, by: f64) -> Self {
        let mut sheet = self.clone();
        let by = by * DVec2::new(0.6180339887, 0.4142135624);
        for p in sheet.points.iter_mut().chain(&mut sheet.around) {
            *p += by;
        }
        sheet.measure();
        sheet
    }

    /// Straight on at both ends to a circle well around everything, and back along it on the left.
    fn continue_ends(&mut self, centre: DVec2) {
        let radius = 2.0 * self.size.max(f64::MIN_POSITIVE);
        let n = self.points.len();
        let reach = |from: DVec2, to: DVec2| {
            let along = (to - from).normalize_or(DVec2::X);
            let off = to - centre;
            let b = off.dot(along);
            to + along * (-b + (b * b - off.length_squared() + radius * radius).max(0.0).sqrt())
        };
        let first = reach(self.points[1], self.points[0]);
        let last = reach(self.points[n - 2], self.points[n - 1]);
        self.points.insert(0, first);
        self.points.push(last);
        let start = (first - centre).to_angle();
        let from = (last - centre).to_angle();
        let turn = (start - from).rem_euclid(TAU);
        let steps = 16;
        self.around = (1..steps)
            .map(|k| centre + radius * DVec2::from_angle(from + turn * f64::from(k) / f64::from(steps)))
            .collect();
    }

    fn refuse_crossings(&self) -> Result<()> {
        let n = self.n_segments();
        let edges = (0..n).map(|k| self.segment(k)).collect::<Vec<_>>();
        let mut found = None;
        SegmentGrid::new(&edges).pairs(|i, j| {
            let (i, j) = (i.min(j), i.max(j));
            let wraps = self.closed && i == 0 && j == n - 1;
            let meet = if j == i + 1 || wraps {
                // Neighbours meet in a point; more only if they fold back.
                let [[a, b], [_, c]] = if wraps { [edges[j], edges[i]] } else { [edges[i], edges[j]] };
                (b - a).perp_dot(c - b) == 0.0 && (b - a).dot(c - b) < 0.0
            } else {
                segments_meet(edges[i], edges[j])
            };
            if meet && found.is_none_or(|f| (i, j) < f) {
                found = Some((i, j));
            }
            true
        });
        let Some((first, second)) = found else { return Ok(()) };
        let ends = |k: usize| !self.closed && (k == 0 || k == n - 1);
        let what = if ends(first) || ends(second) { "stroke, continued straight on," } else { "stroke" };
        let number = |k: usize| if self.closed { k } else { k.saturating_sub(1).min(n.saturating_sub(3)) };
        let at = edges[first][1].to_array();
        Err(Error::SelfIntersecting { what: what.into(), first: number(first), second: number(second), at })
    }

    fn measure(&mut self) {
        let mut at = 0.0;
        self.arc = vec![0.0];
        for k in 0..self.n_segments() {
            let [a, b] = self.segment(k);
            at += self.view.apart(a, b);
            self.arc.push(at);
        }
    }

    /// Width of the unrolled surface; a closed line comes back to its start after it.
    pub fn width(&self) -> f64 {
        self.arc[self.arc.len() - 1]
    }

    /// From where to where the line was drawn, on the unrolled line.
    pub fn drawn(&self) -> [f64; 2] {
        let n = self.points.len();
        if self.closed { [0.0, self.width()] } else { [self.arc[1], self.arc[n - 2]] }
    }

    /// The place on the unrolled line of the point at the share `s` of segment `k`.
    pub fn place(&self, k: usize, s: f64) -> f64 {
        let [a, b] = self.segment(k);
        (self.arc[k] + self.view.apart(a, a.lerp(b, s))).min(self.arc[k + 1])
    }

    /// The point in the plane at a place on the unrolled line.
    pub fn at(&self, place: f64) -> DVec2 {
        let place = if self.closed { place.rem_euclid(self.width()) } else { place };
        let k = (self.arc.partition_point(|&a| a <= place).max(1) - 1).min(self.n_segments() - 1);
        let [a, b] = self.segment(k);
        let (part, whole) = (place - self.arc[k], self.arc[k + 1] - self.arc[k]);
        if whole <= 0.0 {
            return a;
        }
        let s = if self.view.central {
            // Between two rays at the angle `part` from the first one.
            let (u, v) = (self.view.stretch(a), self.view.stretch(b));
            let (x, y) = (libm::sin(whole - part) / u, libm::sin(part) / v);
            if x + y != 0.0 { y / (x + y) } else { part / whole }
        } else {
            part / whole
        };
        a.lerp(b, s)
    }

    /// The point of the surface at a place of the line, at a height.
    pub fn lift(&self, place: f64, height: f64) -> DVec3 {
        self.view.lift(self.at(place), height)
    }

    /// Side of a vertex at `v` from segment `k`: positive on the left, never zero.
    pub fn side_of_segment(&self, k: usize, v: DVec2) -> f64 {
        let [p, q] = self.segment(k);
        side_moved(p, q, v)
    }

    /// True if all these points of the plane lie on the straight line through one segment.
    pub fn is_along(&self, points: impl Iterator<Item = DVec2> + Clone) -> bool {
        (0..self.n_segments()).any(|k| {
            let [a, b] = self.segment(k);
            points.clone().all(|p| orient(a, b, p) == 0.0)
        })
    }

    /// True if a vertex seen at `v` is on the left of the line.
    pub fn is_left(&self, v: DVec2) -> bool {
        let mut left = false;
        let mut pass = |p: DVec2, q: DVec2| {
            let (from, to) = (p.y >= v.y, q.y >= v.y);
            if from != to && (side_moved(p, q, v) > 0.0) == to {
                left = !left;
            }
        };
        for k in 0..self.n_segments() {
            let [p, q] = self.segment(k);
            pass(p, q);
        }
        if !self.closed {
            let mut at = self.points[self.points.len() - 1];
            for &next in self.around.iter().chain(&self.points[..1]) {
                pass(at, next);
                at = next;
            }
        }
        left
    }
}

impl View {
    /// Distance of two points of the plane on the unrolled surface: with an eye the angle between their rays, to all digits
    /// however small it is.
    fn apart(&self, a: DVec2, b: DVec2) -> f64 {
        if !self.central {
            return a.distance(b);
        }
        let step = b - a;
        let across = step.length_squared() + a.perp_dot(step).powi(2);
        libm::atan2(across.sqrt(), 1.0 + a.dot(b))
    }

    /// Length of the ray to the point of the plane at `q`, at depth 1.
    fn stretch(&self, q: DVec2) -> f64 {
        (1.0 + q.length_squared()).sqrt()
    }
}

pub(super) fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Side of the vertex `v` from the stroke's segment from `p` to `q`.
fn side_moved(p: DVec2, q: DVec2, v: DVec2) -> f64 {
    let side = orient(p, q, v);
    // The line moves to the left of segments that run forward.
    if side != 0.0 {
        side
    } else if is_forward(p, q) {
        -1.0
    } else {
        1.0
    }
}

/// Side of the stroke's point `p` from the mesh's edge from `a` to `b`, which differ: positive on the left,
/// never zero.
pub(super) fn side_of_edge(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let side = orient(a, b, p);
    if side != 0.0 {
        side
    } else if is_forward(a, b) {
        1.0
    } else {
        -1.0
    }
}

fn is_forward(a: DVec2, b: DVec2) -> bool {
    a.x < b.x || (a.x == b.x && a.y < b.y)
}
