//! The height fields of the profiles, on the flat patch.

use glam::DVec2;

use super::Profile;
use super::field::{triangle_gradient, vertex_gradients};
use super::laplace::{Factor, Pattern, cotangent_weights, lumped_areas};
use super::topology::Topology;
use crate::error::Result;
use crate::patch::Patch;

/// Weights are limited to this from below where all must be positive; that of an equilateral mesh is
/// 0.58.
const LEAST_WEIGHT: f64 = 1e-3;

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
}

impl<'a> Flat<'a> {
    pub fn new(
        patch: &'a Patch,
        vertices: &'a [DVec2],
        topology: &'a Topology,
        pattern: &'a Pattern,
    ) -> Result<Self> {
        let cotangent = cotangent_weights(topology, vertices, &patch.triangles)?;
        Ok(Flat { patch, vertices, topology, pattern, cotangent, first: patch.n_boundary() })
    }

    /// Sum over the neighbours of `v` of weight times `of(v, neighbour)`.
    fn around(&self, weights: &[f64], v: usize, of: impl Fn(usize) -> f64) -> f64 {
        self.topology.range(v).map(|slot| weights[slot] * of(self.topology.near[slot] as usize)).sum()
    }

    /// Four times the circumcentric area of `v`: the load for which the exact solution on a circle,
    /// the radius squared minus the distance squared, is met at every vertex of any triangulation.
    fn load(&self, v: usize) -> f64 {
        self.around(&self.cotangent, v, |u| (self.vertices[u] - self.vertices[v]).length_squared())
    }

    fn solve(&self, factor: &Factor<'_>, rhs: impl Fn(usize) -> f64) -> Result<Vec<f64>> {
        let mut x = (self.first..self.vertices.len()).map(rhs).collect::<Vec<_>>();
        factor.solve(&mut x, 1)?;
        let mut full = vec![0.0; self.first];
        full.append(&mut x);
        Ok(full)
    }

    /// Extends values at the first vertices (the outer contour) to all others: harmonically, with
    /// positive weights, so that no value leaves the range of the given ones.
    pub fn harmonic(&self, known: &[f64]) -> Result<Vec<f64>> {
        let pattern = Pattern::new(self.topology, known.len())?;
        let weights = self.cotangent.iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
        let factor = pattern.factor(self.topology, &weights, |_| 0.0)?;
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

    fn is_positive(&self, data: &[f64]) -> bool {
        data[self.first..].iter().all(|&x| x > 0.0)
    }
}

/// What [`squared_height`] found.
pub(crate) struct Height {
    /// Squared height at depth one, per vertex; zero on the boundary, positive inside.
    pub value: Vec<f64>,
    /// Its gradient.
    pub gradient: Vec<DVec2>,
    /// True if obtuse triangles made the cotangent solution negative somewhere and a solve with
    /// weights limited to positive values replaced it.
    pub limited: bool,
    /// Vertices whose height was lifted to a least positive value.
    pub lifted: usize,
}

/// Solves for the squared height of `profile`.
///
/// `Round`: `-Lap f = 4`, zero on the silhouette. `Even` solves twice: where the first solution
/// bends in one direction only (a limb) it is twice the square of the half width, so the load is
/// halved there. `Flat`: `v` of `v - r^2 Lap v = 1` falls off from the plateau like `exp(-d / r)`
/// with the distance `d` from the outline, and `f = r^2 v (2 - v)` ends in a rim of radius `r`.
/// `Peak`: the distance from the outline by the heat method (Crane, Weischedel, Wardetzky 2013):
/// the unit gradient field of such a `v` is integrated by a Poisson solve; the square is returned.
pub(crate) fn squared_height(flat: &Flat<'_>, profile: Profile, corner_angle: f64) -> Result<Height> {
    let factor = flat.pattern.factor(flat.topology, &flat.cotangent, |_| 0.0)?;
    let mut value = flat.solve(&factor, |v| flat.load(v))?;
    let mut limited = None;
    if !flat.is_positive(&value) {
        // A matrix of positive weights has a positive inverse.
        let areas = lumped_areas(flat.vertices, &flat.patch.triangles);
        let weights = flat.cotangent.iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
        let factor = flat.pattern.factor(flat.topology, &weights, |_| 0.0)?;
        value = flat.solve(&factor, |v| 4.0 * areas[v])?;
        limited = Some((weights, areas));
    }
    let mut load: Box<dyn Fn(usize) -> f64> = Box::new(|v| flat.load(v));
    match profile {
        Profile::Round => {}
        Profile::Even => {
            let gradient = vertex_gradients(flat.vertices, &flat.patch.triangles, &value);
            let share = limbness(flat, &gradient, 1.0).iter().map(|a| 1.0 / (1.0 + a)).collect::<Vec<_>>();
            let even = match &limited {
                None => flat.solve(&factor, |v| flat.load(v) * share[v])?,
                Some((weights, areas)) => {
                    let factor = flat.pattern.factor(flat.topology, weights, |_| 0.0)?;
                    flat.solve(&factor, |v| 4.0 * areas[v] * share[v])?
                }
            };
            if flat.is_positive(&even) {
                value = even;
                load = Box::new(move |v| flat.load(v) * share[v]);
            } else {
                limited.get_or_insert_default();
            }
        }
        Profile::Flat => {}
        Profile::Peak => {}
    }
    let (value, gradient, lifted) = match profile {
        Profile::Round | Profile::Even => {
            let gradient = gradients(flat, &value, load.as_ref(), corner_angle);
            (value, gradient, 0)
        }
        Profile::Flat => {
            let radius = (0.35 * inradius(flat, &value)).max(1.5 * rim_edge(flat));
            let v = screened(flat, radius)?;
            let value = v.iter().map(|v| radius * radius * v * (2.0 - v)).collect::<Vec<_>>();
            let gradient = vertex_gradients(flat.vertices, &flat.patch.triangles, &value);
            (value, gradient, 0)
        }
        Profile::Peak => {
            let (value, lifted) = distance(flat, &factor, &value)?;
            let gradient = vertex_gradients(flat.vertices, &flat.patch.triangles, &value);
            (value, gradient, lifted)
        }
    };
    Ok(Height { value, gradient, limited: limited.is_some(), lifted })
}

/// 0 where a squared height bends alike in all directions (the middle of a disk), 1 where it bends
/// in one only (a limb) or has a saddle.
pub(crate) fn limbness(flat: &Flat<'_>, gradient: &[DVec2], depth: f64) -> Vec<f64> {
    let triangles = &flat.patch.triangles;
    let (x, y): (Vec<f64>, Vec<f64>) = gradient.iter().map(|g| (g.x, g.y)).unzip();
    let xx = vertex_gradients(flat.vertices, triangles, &x);
    let yy = vertex_gradients(flat.vertices, triangles, &y);
    // Half the difference of the principal second derivatives; their sum is -4 at depth 1.
    let difference = |dx: &DVec2, dy: &DVec2| (0.5 * (dx.x - dy.y)).hypot(0.5 * (dx.y + dy.x));
    xx.iter().zip(&yy).map(|(dx, dy)| (0.5 * difference(dx, dy) / (depth * depth)).min(1.0)).collect()
}

/// Gradients at the vertices: inside the mean over the triangles, of the value plus the square of
/// the distance, which varies less; on the boundary along the normal of the drawn curve, by the
/// flux that the finite elements leave there.
fn gradients(flat: &Flat<'_>, value: &[f64], load: &dyn Fn(usize) -> f64, corner_angle: f64) -> Vec<DVec2> {
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
            let flux = flat.around(&flat.cotangent, v, |u| value[v] - value[u]) - load(v);
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
    let factor = flat.pattern.factor(flat.topology, &weights, |v| areas[v])?;
    let mut v = flat.solve(&factor, |v| areas[v])?;
    for x in &mut v[flat.first..] {
        *x = x.clamp(f64::MIN_POSITIVE, 1.0);
    }
    Ok(v)
}

/// Squared distance from the outline, smoothed at the ridges, and how often it was not positive.
fn distance(flat: &Flat<'_>, factor: &Factor<'_>, value: &[f64]) -> Result<(Vec<f64>, usize)> {
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
    let mut distance = flat.solve(factor, |v| divergence[v])?;
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
