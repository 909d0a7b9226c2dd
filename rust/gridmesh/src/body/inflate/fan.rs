//! The triangles around a vertex of a front, and how good they are.

use glam::DVec3;

use crate::geometry::corner::Ideal;
use crate::geometry::stars::{CornerStars, Stars};
use crate::geometry::topology::Topology;
use crate::patch::Patch;

/// What [`Fan::sharpest`] is at least where a corner of a quad is reflex: more than any cotangent that is let be.
pub(super) const REFLEX: f64 = 1e6;

/// Cosine up to which moves may not turn the triangles around a vertex further from the surface.
pub(super) const LEVEL: f64 = 0.7;

/// What is around each interior vertex.
pub(super) enum Around<'a> {
    Triangles(&'a Topology),
    Quads(CornerStars),
}

impl<'a> Around<'a> {
    /// Of a patch; `topology` is that of its triangles, or of its quads cut in two.
    pub fn new(patch: &Patch, topology: &'a Topology) -> Self {
        if patch.quads.is_empty() {
            return Around::Triangles(topology);
        }
        Around::Quads(CornerStars::new(&patch.quads, None, patch.n_boundary(), patch.vertices.len()))
    }

    /// The vertices that share an edge with an interior one.
    pub fn near(&self, v: usize) -> &[u32] {
        match self {
            Around::Triangles(topology) => &topology.near[topology.range(v)],
            Around::Quads(stars) => stars.near(v - stars.n_loop()),
        }
    }

    /// The triangles around an interior vertex.
    pub fn fan(&self, v: usize) -> Fan<'_> {
        match self {
            Around::Triangles(topology) => Fan { triangles: topology.fan(v), corners: &[] },
            Around::Quads(stars) => Fan { triangles: &[], corners: stars.corners(v - stars.n_loop()) },
        }
    }
}

/// The triangles around a vertex, each by the two others of its vertices: equilateral ones, or those at the corners of
/// quads. To the measures `at` tells where vertices lie.
#[derive(Clone, Copy)]
pub(super) struct Fan<'a> {
    triangles: &'a [[u32; 2]],
    corners: &'a [(u32, u32, Ideal)],
}

impl<'a> Fan<'a> {
    /// The triangles, and what each should look like.
    pub fn iter(self) -> impl Iterator<Item = (u32, u32, Ideal)> + 'a {
        let triangles = self.triangles.iter().map(|&[a, b]| (a, b, Ideal::Equilateral));
        triangles.chain(self.corners.iter().copied())
    }

    /// Mean length of the edges at a vertex at `point`.
    pub fn mean_edge(self, at: impl Fn(u32) -> DVec3, point: DVec3) -> f64 {
        let edges = self.iter().filter(|(.., ideal)| ideal.is_own());
        let (sum, count) =
            edges.fold((0.0, 0.0), |(sum, count), (a, ..)| (sum + point.distance(at(a)), count + 1.0));
        sum / f64::max(count, 1.0)
    }

    /// Least cosine between the surface's normal at a vertex at `point` and the triangles around it: how
    /// well they stand for the surface. A vertex that leaves a narrow ridge cuts it off.
    pub fn facing(self, at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3) -> f64 {
        let cosine = |(a, b, _): (u32, u32, Ideal)| {
            let (a, b) = (at(a) - point, at(b) - point);
            a.cross(b).normalize_or_zero().dot(normal)
        };
        self.iter().map(cosine).fold(f64::INFINITY, f64::min)
    }

    /// Largest cotangent of the angles of the triangles around a vertex at `point`. Of quads the cotangent of the corner
    /// that is furthest from a right angle; where one is reflex, seen along the surface's normal, [`REFLEX`] or more, the
    /// more the nearer it is to three right angles.
    pub fn sharpest(self, at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3) -> f64 {
        self.iter().map(sharpness(at, point, normal)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether [`Self::sharpest`] is `limit` or more: known at the first triangle that is so sharp.
    pub fn is_sharp(self, at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3, limit: f64) -> bool {
        self.iter().map(sharpness(at, point, normal)).any(|sharpness| sharpness >= limit)
    }

    /// Whether [`Self::sharpest`] is more than `limit`: known at the first triangle that is sharper.
    pub fn is_sharper(self, at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3, limit: f64) -> bool {
        self.iter().map(sharpness(at, point, normal)).any(|sharpness| sharpness > limit)
    }

    /// The two others of the vertices of the triangle that [`Self::sharpest`] speaks of.
    pub fn ends_of_sharpest(
        self,
        at: impl Fn(u32) -> DVec3,
        point: DVec3,
        normal: DVec3,
    ) -> Option<[u32; 2]> {
        let of = sharpness(at, point, normal);
        let sharpest = self.iter().map(|triangle| (of(triangle), triangle));
        let sharpest = sharpest.reduce(|best, other| if other.0 > best.0 { other } else { best });
        sharpest.map(|(_, (i, j, _))| [i, j])
    }

    /// How good the triangles around a vertex at `point` are, and how well they stand for the surface.
    pub fn shape(self, at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3) -> Shape {
        let mut shape = Shape::BEST;
        for (i, j, ideal) in self.iter() {
            let (a, b) = (at(i) - point, at(j) - point);
            let sides = ideal.sides([a.length_squared(), b.length_squared(), (b - a).length_squared()]);
            shape.with(ideal, a.cross(b), sides, normal);
        }
        shape
    }
}

/// What the worst of some triangles is like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// Least ratio of area to squared sides: one if all are ideal.
    pub worst: f64,
    /// See [`Fan::facing`].
    pub facing: f64,
}

impl Shape {
    /// That of no triangles.
    pub const BEST: Self = Self { worst: f64::INFINITY, facing: f64::INFINITY };

    /// Takes a triangle in: the product of its two sides at the vertex, and the sum of squared sides that its ideal compares.
    #[inline]
    pub fn with(&mut self, ideal: Ideal, cross: DVec3, sides: f64, normal: DVec3) {
        let length = cross.length();
        self.worst = self.worst.min(length * ideal.best() / sides);
        let inverse = length.recip();
        let facing = if inverse.is_finite() && inverse > 0.0 { cross * inverse } else { DVec3::ZERO };
        self.facing = self.facing.min(facing.dot(normal));
    }
}

/// What [`Fan::sharpest`] is the largest of.
#[inline]
fn sharpness(at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3) -> impl Fn((u32, u32, Ideal)) -> f64 {
    move |(i, j, ideal)| {
        let (a, b) = (at(i) - point, at(j) - point);
        let c = b - a;
        let cosine = match ideal {
            Ideal::Equilateral => a.dot(b).max(b.dot(c)).max(-a.dot(c)),
            Ideal::Own => a.dot(b).abs(),
            Ideal::Next => a.dot(c).abs(),
            Ideal::Last => b.dot(c).abs(),
        };
        let area = a.cross(b);
        let facing = area.dot(normal);
        if ideal != Ideal::Equilateral && facing <= 0.0 {
            return REFLEX * (2.0 - facing / libm::hypot(cosine, facing).max(f64::MIN_POSITIVE));
        }
        cosine / area.length()
    }
}
