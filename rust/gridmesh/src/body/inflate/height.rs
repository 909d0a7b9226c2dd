//! The height fields of the profiles, on the flat patch.

use glam::DVec2;

use super::field::{triangle_gradient, vertex_gradients};
use crate::body::inflate::options::Profile;
use crate::error::Result;
use crate::geometry::laplace::{Factor, Pattern, cotangent_weights, lumped_areas};
use crate::geometry::topology::Topology;
use crate::patch::Patch;
use crate::progress::Progress;

/// The `k` of [`bends`].
const DRAG: f64 = 2.5;

/// Weights are limited to this from below where all must be positive; that of an equilateral mesh is
/// 0.58.
const LEAST_WEIGHT: f64 = 1e-3;

/// What rounding may add to a value, relative to the most that it may be.
const SLACK: f64 = 1e-9;

/// Operators of one flat patch, shared by all solves.
pub(crate) struct Flat<'a> {
    pub patch: &'a Patch,
    /// Positions relative to the middle of the drawing's box.
    pub vertices: &'a [DVec2],
    pub topology: &'a Topology,
    pub pattern: &'a Pattern,
    pub cotangent: Vec<f64>,
    /// First interior vertex.
    pub first: usize,
    /// Asked before each solve.
    pub progress: Progress<'a>,
}

impl<'a> Flat<'a> {
    pub fn new(
        patch: &'a Patch,
        vertices: &'a [DVec2],
        topology: &'a Topology,
        pattern: &'a Pattern,
        progress: Progress<'a>,
    ) -> Result<Self> {
        let cotangent = cotangent_weights(topology, vertices, &patch.triangles)?;
        Ok(Flat { patch, vertices, topology, pattern, cotangent, first: patch.n_boundary(), progress })
    }

    /// Sum over the neighbours of `v` of weight times `of(v, neighbour)`.
    fn around(&self, weights: &[f64], v: usize, of: impl Fn(usize) -> f64) -> f64 {
        self.topology.range(v).map(|slot| weights[slot] * of(self.topology.near[slot] as usize)).sum()
    }

    /// Four times the circumcentric area of `v`, by cotangent weights: the load for which the exact solution on a circle,
    /// the radius squared minus the distance squared, is met at every vertex of any triangulation. By positive weights
    /// no value of a solution is more than the largest around it plus the square of the distance from there.
    fn load(&self, weights: &[f64], v: usize) -> f64 {
        self.around(weights, v, |u| self.vertices[u].distance_squared(self.vertices[v]))
    }

    /// Factors the equations of the interior vertices.
    fn factor(&self, weights: &[f64], diagonal: impl Fn(usize) -> f64) -> Result<Factor> {
        self.pattern.factor(self.topology, weights, diagonal, self.progress.part(0.5, 0.5))
    }

    fn solve(&self, factor: &Factor, rhs: impl Fn(usize) -> f64) -> Result<Vec<f64>> {
        self.progress.report(0.5)?;
        let mut x = (self.first..self.vertices.len()).map(rhs).collect::<Vec<_>>();
        factor.solve(&mut x, 1)?;
        self.progress.report(0.5)?;
        let mut full = vec![0.0; self.first];
        full.append(&mut x);
        Ok(full)
    }

    /// Extends values at the first vertices (the outer contour) to all others: harmonically, with
    /// positive weights, so that no value leaves the range of the given ones.
    pub fn harmonic(&self, known: &[f64]) -> Result<Vec<f64>> {
        self.progress.report(1.0)?;
        let pattern = Pattern::new(self.topology, known.len(), self.progress.part(1.0, 1.0))?;
        let weights = self.cotangent.iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
        let factor = pattern.factor(self.topology, &weights, |_| 0.0, self.progress.part(1.0, 1.0))?;
        let mut x = (known.len()..self.vertices.len())
            .map(|v| self.around(&weights, v, |u| known.get(u).copied().unwrap_or(0.0)))
            .collect::<Vec<_>>();
        factor.solve(&mut x, 1)?;
        let (low, high) =
            known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
        let mut full = known.to_vec();
        full.extend(x.into_iter().map(|x| x.clamp(low, high)));
        Ok(full)
    }

    /// True if every value is above zero and no larger than the values around and the load allow (see [`Self::load`]), as all are
    /// where no weight is negative.
    fn is_bounded(&self, data: &[f64]) -> bool {
        (self.first..data.len()).all(|v| {
            let near = self.topology.range(v).map(|slot| self.topology.near[slot] as usize);
            let most = |u: usize| data[u] + self.vertices[u].distance_squared(self.vertices[v]);
            data[v] > 0.0 && data[v] <= (1.0 + SLACK) * near.map(most).fold(0.0, f64::max)
        })
    }
}

/// What [`squared_height`] found.
pub(crate) struct Height {
    /// Squared height at depth one, per vertex; zero on the boundary, positive inside.
    pub value: Vec<f64>,
    /// Its gradient.
    pub gradient: Vec<DVec2>,
    /// True if obtuse triangles made the cotangent solution negative or much too large somewhere, and a solve with
    /// weights limited to positive values replaced it.
    pub limited: bool,
    /// Vertices whose height was lifted to a least positive value.
    pub lifted: usize,
}

/// Solves for the squared height of `profile`.
///
/// `Round`: `-Lap f = 4`, zero on the silhouette; a second solve softens hollows, see [`bends`].
/// `Even`: the second solve also halves the load in limbs, where the first solution bends in one
/// direction only and is twice the square of the half width.
/// `Flat`: `v` of `v - r^2 Lap v = 1` falls off from the plateau like `exp(-d / r)` with the distance
/// `d` from the outline, and `f = r^2 v (2 - v)` ends in a rim of radius `r`.
/// `Peak`: the distance from the outline by the heat method (Crane, Weischedel, Wardetzky 2013): the
/// unit gradient field of such a `v` is integrated by a Poisson solve; the square is returned.
pub(crate) fn squared_height(flat: &Flat<'_>, profile: Profile, corner_angle: f64) -> Result<Height> {
    let triangles = &flat.patch.triangles;
    let (mut value, mut limited) = torsion(flat, None)?;
    let mut lifted = 0;
    let gradient = match profile {
        Profile::Round | Profile::Even => {
            flat.progress.report(0.5)?;
            let slope = gradients(flat, &value, &|_| 1.0, corner_angle);
            let bends = bends(flat, &value, &slope, 1.0);
            let share = |v: usize| if profile == Profile::Even { 1.0 / (1.0 + bends[v].limb) } else { 1.0 };
            if profile == Profile::Even || bends.iter().any(|bend| bend.drag > 0.0) {
                (value, limited) = torsion(flat, Some((&share, &|v| bends[v].drag)))?;
                gradients(flat, &value, &share, corner_angle)
            } else {
                slope
            }
        }
        Profile::Flat => {
            let radius = (0.35 * inradius(flat, &value)).max(1.5 * rim_edge(flat));
            let v = screened(flat, radius)?;
            value = v.iter().map(|v| radius * radius * v * (2.0 - v)).collect();
            vertex_gradients(flat.vertices, triangles, &value)
        }
        Profile::Peak => {
            (value, lifted) = distance(flat, &value)?;
            vertex_gradients(flat.vertices, triangles, &value)
        }
    };
    Ok(Height { value, gradient, limited, lifted })
}

/// Load relative to 4, and drag.
type Terms<'a> = (&'a dyn Fn(usize) -> f64, &'a dyn Fn(usize) -> f64);

/// Solves `-Lap f + drag f = 4 share`, zero on the boundary; positive inside. True if that took
/// weights limited to positive values, since obtuse triangles spoiled the cotangent solution.
fn torsion(flat: &Flat<'_>, terms: Option<Terms<'_>>) -> Result<(Vec<f64>, bool)> {
    let (share, drag) = terms.unwrap_or((&|_| 1.0, &|_| 0.0));
    let areas = lumped_areas(flat.vertices, &flat.patch.triangles);
    flat.progress.report(0.5)?;
    let solved = |weights: &[f64]| {
        let factor = flat.factor(weights, |v| drag(v) * areas[v])?;
        flat.solve(&factor, |v| flat.load(weights, v) * share(v))
    };
    let value = solved(&flat.cotangent)?;
    if flat.is_bounded(&value) {
        return Ok((value, false));
    }
    let weights = flat.cotangent.iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
    Ok((solved(&weights)?, true))
}

/// How a squared height bends at a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bend {
    /// 0 where it bends alike in all directions (the middle of a disk), 1 where it bends in one
    /// only (a limb) or has a saddle.
    pub limb: f64,
    /// The drag that softens hollows.
    pub drag: f64,
}

/// The bends of a squared height `value` of the given depth.
///
/// At a re-entrant corner of interior angle `w` the Poisson solution rises like `r^a`, `a = pi / w`:
/// an ever steeper wall, for which a mesh has no vertices. A drag of `(1 - a^2) / r^2` turns that
/// into `r`, as at a smooth outline. Such a drag is `k` times the bend of `f` along its level line,
/// divided by `f`, with `k` from 2 to 3; so it is computed, wherever level lines are hollow.
pub(crate) fn bends(flat: &Flat<'_>, value: &[f64], gradient: &[DVec2], depth: f64) -> Vec<Bend> {
    let triangles = &flat.patch.triangles;
    let (x, y): (Vec<f64>, Vec<f64>) = gradient.iter().map(|g| (g.x, g.y)).unzip();
    let xx = vertex_gradients(flat.vertices, triangles, &x);
    let yy = vertex_gradients(flat.vertices, triangles, &y);
    let bend = |v: usize| {
        let (dx, dy) = (xx[v], yy[v]);
        let mixed = 0.5 * (dx.y + dy.x);
        // The sum of the second derivatives is -4 at depth 1.
        let difference = libm::hypot(0.5 * (dx.x - dy.y), mixed);
        let limb = (0.5 * difference / (depth * depth)).min(1.0);
        let level = gradient[v].perp().normalize_or_zero();
        let hollow = level.x * level.x * dx.x + 2.0 * level.x * level.y * mixed + level.y * level.y * dy.y;
        // Not at ridges and passes, where level lines mean nothing.
        let half = 0.25 * gradient[v].length_squared();
        let steep = half / (half + value[v]);
        let drag = if hollow > 0.0 && value[v] > 0.0 { DRAG * steep * hollow / value[v] } else { 0.0 };
        Bend { limb, drag }
    };
    (0..value.len()).map(bend).collect()
}

/// Gradients at the vertices: inside the mean over the triangles, of the value plus the square of
/// the distance, which varies less; on the boundary along the normal of the drawn curve, by the
/// flux that the finite elements leave there.
fn gradients(flat: &Flat<'_>, value: &[f64], share: &dyn Fn(usize) -> f64, corner_angle: f64) -> Vec<DVec2> {
    let vertices = flat.vertices;
    let rest = value.iter().zip(vertices).map(|(f, p)| f + p.length_squared()).collect::<Vec<_>>();
    let mut gradient = vertex_gradients(vertices, &flat.patch.triangles, &rest);
    for (g, p) in gradient.iter_mut().zip(vertices) {
        *g -= 2.0 * *p;
    }
    for contour in &flat.patch.loops {
        let (start, n) = (contour.start as usize, contour.len());
        for k in 0..n {
            let v = start + k;
            let (a, b) = (vertices[start + (k + n - 1) % n], vertices[start + (k + 1) % n]);
            if contour.corner[k].abs() > corner_angle {
                continue;
            }
            let Some(outward) = circle_normal(a, vertices[v], b) else { continue };
            let flux = flat.around(&flat.cotangent, v, |u| value[v] - value[u])
                - flat.load(&flat.cotangent, v) * share(v);
            let width = outward.dot(-0.5 * (b - a).perp());
            if width > 0.0 && flux < 0.0 {
                gradient[v] = outward * (flux / width);
            }
        }
    }
    gradient
}

/// Unit normal at `p` of the circle through three points of a curve, to the right of `a` to `b`.
fn circle_normal(a: DVec2, p: DVec2, b: DVec2) -> Option<DVec2> {
    let (u, v) = (p - a, b - p);
    let (k, l) = (u.length_squared(), v.length_squared());
    // The tangent of the parabola, and of the circle, through the points.
    let tangent = u / k + v / l;
    (-tangent.perp()).try_normalize()
}

/// Distance from the outline of the vertex where `value` is largest.
fn inradius(flat: &Flat<'_>, value: &[f64]) -> f64 {
    let deepest = (0..value.len()).fold(0, |best, v| if value[v] > value[best] { v } else { best });
    let point = flat.vertices[deepest];
    let mut least = f64::INFINITY;
    for contour in &flat.patch.loops {
        let (start, n) = (contour.start as usize, contour.len());
        for k in 0..n {
            let (a, b) = (flat.vertices[start + k], flat.vertices[start + (k + 1) % n]);
            let t = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            least = least.min(point.distance(a.lerp(b, t)));
        }
    }
    least
}

/// Mean length of the boundary edges.
fn rim_edge(flat: &Flat<'_>) -> f64 {
    let mut sum = 0.0;
    for contour in &flat.patch.loops {
        let (start, n) = (contour.start as usize, contour.len());
        sum += (0..n)
            .map(|k| flat.vertices[start + k].distance(flat.vertices[start + (k + 1) % n]))
            .sum::<f64>();
    }
    sum / flat.first as f64
}

/// Solves `v - length^2 Lap v = 1`, zero on the boundary; `0 < v <= 1` inside.
fn screened(flat: &Flat<'_>, length: f64) -> Result<Vec<f64>> {
    let areas = lumped_areas(flat.vertices, &flat.patch.triangles);
    let scale = length * length;
    let weights = flat.cotangent.iter().map(|w| scale * w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
    flat.progress.report(0.5)?;
    let factor = flat.factor(&weights, |v| areas[v])?;
    let mut v = flat.solve(&factor, |v| areas[v])?;
    for x in &mut v[flat.first..] {
        *x = x.clamp(f64::MIN_POSITIVE, 1.0);
    }
    Ok(v)
}

/// Squared distance from the outline, smoothed at the ridges, and how often it was not positive.
fn distance(flat: &Flat<'_>, value: &[f64]) -> Result<(Vec<f64>, usize)> {
    let edge = rim_edge(flat);
    let v = screened(flat, edge.max(0.08 * inradius(flat, value)))?;
    let mut divergence = vec![0.0; v.len()];
    for &corners in &flat.patch.triangles {
        let direction = triangle_gradient(flat.vertices, corners, &v).normalize_or_zero();
        let [a, b, c] = corners.map(|v| flat.vertices[v as usize]);
        for (vertex, side) in corners.into_iter().zip([c - b, a - c, b - a]) {
            divergence[vertex as usize] += 0.5 * side.perp().dot(direction);
        }
    }
    let factor = flat.factor(&flat.cotangent, |_| 0.0)?;
    let mut distance = flat.solve(&factor, |v| divergence[v])?;
    let mut lifted = 0;
    for d in &mut distance[flat.first..] {
        if *d < 0.05 * edge {
            *d = 0.05 * edge;
            lifted += 1;
        }
        *d *= *d;
    }
    Ok((distance, lifted))
}
