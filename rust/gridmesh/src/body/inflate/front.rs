//! The surface being evened out: vertices in the plane and in space, and what guides them.

use glam::{DVec2, DVec3};

use crate::body::inflate::crease::{Crease, creases};
use crate::body::inflate::fan::Around;
use crate::body::inflate::field::{Field, Place};
use crate::body::inflate::inlets::Inlets;
use crate::patch::{Loop, Patch};

/// The front of a body: a graph over the flat patch.
pub(crate) struct Front {
    /// Positions in the plane; the boundary's are the patch's.
    pub flat: Vec<DVec2>,
    /// Heights, zero on the boundary, positive inside.
    pub height: Vec<f64>,
    /// Where each interior vertex lies in the flat patch, from `first` on.
    pub place: Vec<Place>,
    /// First interior vertex.
    pub first: usize,
    /// Moves that were shortened so that no triangle of the projection turned over.
    pub shortened: usize,
}

impl Front {
    /// The lifted patch, no vertex moved sideways.
    pub fn new(field: &Field<'_>, first: usize) -> Self {
        let mut place = vec![Place { triangle: 0, weights: [0.0; 3] }; field.vertices.len() - first];
        for (t, corners) in field.triangles.iter().enumerate() {
            for (k, &v) in corners.iter().enumerate() {
                if let Some(slot) = (v as usize).checked_sub(first) {
                    let mut weights = [0.0; 3];
                    weights[k] = 1.0;
                    place[slot] = Place { triangle: t as u32, weights };
                }
            }
        }
        let height = (0..field.value.len()).map(|v| field.at_vertex(v).0.sqrt()).collect();
        Front { flat: field.vertices.to_vec(), height, place, first, shortened: 0 }
    }

    /// Whether `v`, which was at `start`, may go to `point`: all its triangles stay positive in
    /// projection, it does not leave its crease, and it does not enter an inlet of the drawing.
    pub fn may_move(&self, guide: &Guide<'_>, v: usize, start: DVec2, point: DVec2) -> bool {
        if guide.inlets.hold(point) && !guide.inlets.hold(start) {
            return false;
        }
        let stays = guide.crease[v].as_ref().is_none_or(|crease| crease.holds(point) || !crease.holds(start));
        stays
            && guide.around.fan(v).iter().all(|(a, b, _)| {
                (self.flat[a as usize] - point).perp_dot(self.flat[b as usize] - point) >= guide.least_area
            })
    }

    /// Where vertex `v` lies in space.
    pub fn position(&self, v: usize) -> DVec3 {
        self.flat[v].extend(self.height[v])
    }

    /// Where vertices lie in space.
    pub fn positions(&self) -> impl Fn(u32) -> DVec3 {
        |v| self.position(v as usize)
    }

    /// Unit normal of the surface at interior vertex `v`.
    pub fn normal(&self, guide: &Guide<'_>, v: usize) -> DVec3 {
        let (_, gradient) = guide.field.at(self.flat[v], self.place[v - self.first]);
        surface_normal(gradient, self.height[v])
    }

    /// Largest cotangent of the angles around interior vertex `v`, see [`Fan::sharpest`](super::fan::Fan::sharpest).
    pub fn sharpest(&self, guide: &Guide<'_>, v: usize) -> f64 {
        guide.around.fan(v).sharpest(self.positions(), self.position(v), self.normal(guide, v))
    }

    /// The place of the surface nearest to `target`, if `v`, which was at `start`, may go there.
    pub fn trial(&self, guide: &Guide<'_>, v: usize, start: DVec2, target: DVec3) -> Option<Trial> {
        let (point, place) = project(guide.field, target, self.place[v - self.first].triangle)?;
        self.may_move(guide, v, start, point).then(|| Trial::new(guide.field, point, place))
    }

    /// Moves `v` to a place.
    pub fn put(&mut self, v: usize, there: &Trial) {
        self.put_at(v, &there.spot());
    }

    /// Where interior vertex `v` is.
    pub fn spot(&self, v: usize) -> Spot {
        Spot { position: self.position(v), place: self.place[v - self.first] }
    }

    /// Moves `v` to where it, or another, may be.
    pub fn put_at(&mut self, v: usize, spot: &Spot) {
        self.flat[v] = spot.position.truncate();
        self.height[v] = spot.position.z;
        self.place[v - self.first] = spot.place;
    }
}

/// A point of the surface, and what it lies above.
#[derive(Clone, Copy)]
pub(crate) struct Spot {
    pub position: DVec3,
    pub place: Place,
}

/// A place on the surface that a vertex may be put at.
pub(crate) struct Trial {
    pub position: DVec3,
    /// Unit normal of the surface.
    pub normal: DVec3,
    place: Place,
}

impl Trial {
    /// Above a point of the plane, which lies at `place`.
    pub fn new(field: &Field<'_>, point: DVec2, place: Place) -> Trial {
        let (value, gradient) = field.at(point, place);
        let height = value.sqrt();
        Trial { position: point.extend(height), normal: surface_normal(gradient, height), place }
    }

    pub fn spot(&self) -> Spot {
        Spot { position: self.position, place: self.place }
    }
}

/// Unit normal of the surface `z^2 = f` where it has this height, from the gradient of `f`.
fn surface_normal(gradient: DVec2, height: f64) -> DVec3 {
    (-gradient).extend(2.0 * height).normalize_or(DVec3::Z)
}

/// What guides the vertices of a front.
pub(crate) struct Guide<'a> {
    pub field: &'a Field<'a>,
    /// The flat patch.
    pub patch: &'a Patch,
    /// The triangles around each interior vertex, which stay positive in projection: the field's own, or those at the corners of quads.
    pub around: Around<'a>,
    /// Height of the surface above the middle of a circle of radius one.
    pub depth: f64,
    /// Where each vertex is to slide: a height.
    pub goal: Vec<f64>,
    /// The crease that each vertex is to follow.
    pub crease: Vec<Option<Crease>>,
    /// See [`rim_flatness`].
    pub flatness: Vec<f64>,
    /// Where vertices may not go.
    pub inlets: Inlets,
    /// Twice the area that each triangle keeps in projection at least.
    pub least_area: f64,
}

impl<'a> Guide<'a> {
    /// `limb` is 0 where the surface is round and 1 in a limb.
    pub fn new(
        field: &'a Field<'a>,
        patch: &'a Patch,
        limb: impl Fn(usize) -> f64,
        inlets: Inlets,
        depth: f64,
        least_area: f64,
    ) -> Self {
        let (first, loops) = (patch.n_boundary(), &patch.loops);
        let goal = |v: usize| if v < first { 0.0 } else { unrolled(field, v, limb(v), depth) };
        Guide {
            field,
            patch,
            around: Around::new(patch, field.topology),
            depth,
            goal: (0..field.value.len()).map(goal).collect(),
            crease: creases(field, loops, first),
            flatness: rim_flatness(field, loops, first),
            inlets,
            least_area,
        }
    }
}

/// The point of the plane below the foot of `point` on the surface `z^2 = field`.
pub(crate) fn project(field: &Field<'_>, point: DVec3, triangle: u32) -> Option<(DVec2, Place)> {
    let mut point = point;
    let mut triangle = triangle;
    for _ in 0..2 {
        let place = field.locate(point.truncate(), triangle)?;
        triangle = place.triangle;
        let (value, gradient) = field.at(point.truncate(), place);
        let slope = (-gradient).extend(2.0 * point.z);
        point -= (point.z * point.z - value) / slope.length_squared().max(f64::MIN_POSITIVE) * slope;
    }
    field.locate(point.truncate(), triangle).map(|place| (point.truncate(), place))
}

/// How much flatter than equilateral the triangles at each boundary vertex are to be.
///
/// The face angle across the silhouette is that of the curvature across it over the height of these
/// triangles; beside it edges lie in all directions and see the curvature along it as well. Flatter
/// triangles even this out, the more so where the body bends much more across than along.
pub(crate) fn rim_flatness(field: &Field<'_>, loops: &[Loop], first: usize) -> Vec<f64> {
    let mut flatness = vec![0.0; first];
    for contour in loops {
        let (start, n) = (contour.start as usize, contour.len());
        for k in 0..n {
            let v = start + k;
            let (a, p, b) = (
                field.vertices[start + (k + n - 1) % n],
                field.vertices[v],
                field.vertices[start + (k + 1) % n],
            );
            let along = 2.0 * (p - a).angle_to(b - p).abs() / (p.distance(a) + p.distance(b));
            let across_radius = 0.5 * field.at_vertex(v).1.length();
            flatness[v] = 1.25 + 1.5 * (1.0 - along * across_radius).max(0.0);
        }
    }
    flatness
}

/// The height to which a vertex slides: one at which the lifted surface nearly keeps the angles of
/// the flat patch.
///
/// Stereographic projection sends the squared height `f` of a sphere of radius `R` to
/// `f (1 - t) / (1 + t)^2`, where `t = 1 - f / R^2` is also `s^2 / (f + s^2)` with `s` half the slope
/// of `f`: so read it needs no circle, and at the silhouette of any drawing the height becomes the
/// distance from it. A limb is stretched across only; there vertices move less.
///
/// A body deeper than a sphere has the heights of the sphere, scaled. Heights are those before a curve
/// reshapes them; where it makes walls, vertices come from all over the section.
pub(crate) fn unrolled(field: &Field<'_>, v: usize, limb: f64, depth: f64) -> f64 {
    let value = field.value[v];
    let half = 0.25 * field.gradient[v].length_squared() / depth.max(1.0).powi(2);
    let t = half / (value + half);
    let k = 2.0 - 1.7 * limb;
    let height = (value * (1.0 - t) / (1.0 + k * t + (3.0 - k) * t * t)).sqrt();
    field.section.as_ref().map_or(height, |section| section.even(height, (value + half).sqrt()))
}
