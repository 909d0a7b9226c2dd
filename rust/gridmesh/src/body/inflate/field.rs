//! A height field over the flat patch that can be evaluated anywhere in it.

use glam::DVec2;

use super::section::Section;
use crate::geometry::topology::{NONE, Topology};

/// How far a field may be above its linear interpolant, in squared depths by the mean squared distance from the corners of a
/// triangle: twice as far as where it bends in one direction only.
const MOST_BENT: f64 = 4.0;

/// The squared height over the flat patch: values and gradients at its vertices, between them a
/// blend that reproduces every quadratic function.
///
/// Interpolating the square keeps the silhouette smooth: there the height has an infinite slope,
/// its square does not.
pub(crate) struct Field<'a> {
    pub vertices: &'a [DVec2],
    pub triangles: &'a [[u32; 3]],
    pub topology: &'a Topology,
    pub value: Vec<f64>,
    pub gradient: Vec<DVec2>,
    /// The square of the depth: minus a quarter of the sum of its second derivatives.
    pub squared_depth: f64,
    /// What reshapes the heights of this field to those of the body, if anything.
    pub section: Option<Section>,
}

/// A place in the flat patch: a triangle and barycentric coordinates in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub triangle: u32,
    pub weights: [f64; 3],
}

impl Field<'_> {
    /// Walks from `triangle` to the triangle that holds `point`; none if the walk is stopped by
    /// the boundary.
    pub fn locate(&self, point: DVec2, triangle: u32) -> Option<Place> {
        let mut triangle = triangle;
        for _ in 0..self.triangles.len() {
            let [a, b, c] = self.triangles[triangle as usize].map(|v| self.vertices[v as usize] - point);
            let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
            let doubled = areas[0] + areas[1] + areas[2];
            let beyond = self.topology.across[triangle as usize];
            let mut next = None;
            let mut least = -1e-12 * doubled;
            let mut outside = false;
            for k in 0..3 {
                if areas[k] < -1e-12 * doubled {
                    outside = true;
                    if beyond[k] != NONE && areas[k] < least {
                        least = areas[k];
                        next = Some(beyond[k]);
                    }
                }
            }
            if !outside {
                return Some(Place { triangle, weights: areas.map(|area| area / doubled) });
            }
            triangle = next?;
        }
        None
    }

    /// Squared height of the body and its gradient at `point`, which lies at `place`.
    pub fn at(&self, point: DVec2, place: Place) -> (f64, DVec2) {
        let (value, gradient) = self.plain(point, place);
        self.reshaped(value, gradient)
    }

    /// Squared height of the body and its gradient at vertex `v`.
    pub fn at_vertex(&self, v: usize) -> (f64, DVec2) {
        self.reshaped(self.value[v], self.gradient[v])
    }

    fn reshaped(&self, value: f64, gradient: DVec2) -> (f64, DVec2) {
        self.section.as_ref().map_or((value, gradient), |section| section.of(value, gradient))
    }

    /// The largest value, sought between vertices too: a mesh need not have one where the body is highest.
    pub fn highest(&self) -> f64 {
        const STEPS: u32 = 8;
        let n = self.value.len();
        let top = (0..n).fold(0, |best, v| if self.value[v] > self.value[best] { v } else { best });
        let mut highest = self.value[top];
        for (t, corners) in self.triangles.iter().enumerate().filter(|(_, c)| c.contains(&(top as u32))) {
            let [a, b, c] = corners.map(|v| self.vertices[v as usize]);
            for i in 0..=STEPS {
                for j in 0..=STEPS - i {
                    let weights = [i, j, STEPS - i - j].map(|k| f64::from(k) / f64::from(STEPS));
                    let place = Place { triangle: t as u32, weights };
                    let point = a * weights[0] + b * weights[1] + c * weights[2];
                    highest = highest.max(self.plain(point, place).0);
                }
            }
        }
        highest
    }

    /// Value and gradient of the field, before anything reshapes it, at `point`, which lies at `place`.
    ///
    /// The value is kept above a quarter of the linear interpolant, so that it is positive inside
    /// wherever the vertex values are, and no farther above it than a bent field can be: gradients mean little at
    /// triangles that are much longer than wide.
    pub fn plain(&self, point: DVec2, place: Place) -> (f64, DVec2) {
        let corners = self.triangles[place.triangle as usize];
        let [a, b, c] = corners.map(|v| self.vertices[v as usize]);
        let doubled = (b - a).perp_dot(c - a);
        let slopes = [(c - b).perp() / doubled, (a - c).perp() / doubled, (b - a).perp() / doubled];
        let bent = MOST_BENT * self.squared_depth;
        let (mut value, mut linear, mut most) = (0.0, 0.0, 0.0);
        let (mut gradient, mut gradient_of_most) = (DVec2::ZERO, DVec2::ZERO);
        for k in 0..3 {
            let v = corners[k] as usize;
            let (own, weight, away) = (self.value[v], place.weights[k], point - self.vertices[v]);
            let share = own + 0.5 * self.gradient[v].dot(away);
            value += weight * share;
            linear += weight * own;
            gradient += slopes[k] * share + 0.5 * weight * self.gradient[v];
            let share = own + bent * away.length_squared();
            most += weight * share;
            gradient_of_most += slopes[k] * share + 2.0 * bent * weight * away;
        }
        if value > most {
            return (most, gradient_of_most);
        }
        (value.max(0.25 * linear), gradient)
    }

    /// Linear interpolation of any vertex data.
    pub fn linear(&self, data: &[f64], place: Place) -> f64 {
        let corners = self.triangles[place.triangle as usize];
        (0..3).map(|k| place.weights[k] * data[corners[k] as usize]).sum()
    }
}

/// Gradient of piecewise linear data on each triangle.
pub(crate) fn triangle_gradient(vertices: &[DVec2], corners: [u32; 3], data: &[f64]) -> DVec2 {
    let [a, b, c] = corners.map(|v| vertices[v as usize]);
    let [p, q, r] = corners.map(|v| data[v as usize]);
    ((c - b).perp() * p + (a - c).perp() * q + (b - a).perp() * r) / (b - a).perp_dot(c - a)
}

/// Gradient at each vertex: the mean over its triangles, weighted by area.
pub(crate) fn vertex_gradients(vertices: &[DVec2], triangles: &[[u32; 3]], data: &[f64]) -> Vec<DVec2> {
    let mut sum = vec![(DVec2::ZERO, 0.0); vertices.len()];
    for &corners in triangles {
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        let doubled = (b - a).perp_dot(c - a);
        let gradient = triangle_gradient(vertices, corners, data);
        for v in corners {
            sum[v as usize].0 += doubled * gradient;
            sum[v as usize].1 += doubled;
        }
    }
    sum.into_iter().map(|(gradient, area)| gradient / area).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadratics_are_reproduced() {
        let vertices = [(0.0, 0.0), (2.0, 0.3), (0.4, 1.7), (2.5, 2.0)].map(|(x, y)| DVec2::new(x, y));
        let triangles = [[0, 1, 2], [1, 3, 2]];
        let topology = Topology::new(4, &triangles);
        let f = |p: DVec2| 20.0 + p.x - 2.0 * p.y + 0.7 * p.x * p.x - 0.2 * p.x * p.y + 0.4 * p.y * p.y;
        let slope = |p: DVec2| DVec2::new(1.0 + 1.4 * p.x - 0.2 * p.y, -2.0 - 0.2 * p.x + 0.8 * p.y);
        let field = Field {
            vertices: &vertices,
            triangles: &triangles,
            topology: &topology,
            value: vertices.map(f).to_vec(),
            gradient: vertices.map(slope).to_vec(),
            squared_depth: 1.0,
            section: None,
        };
        let point = DVec2::new(1.9, 1.5);
        let place = field.locate(point, 0).unwrap();
        assert_eq!(place.triangle, 1);
        let (value, gradient) = field.at(point, place);
        assert!((value - f(point)).abs() < 1e-12);
        assert!(gradient.distance(slope(point)) < 1e-12);
        assert!(field.locate(DVec2::new(-1.0, 0.0), 1).is_none());
    }

    #[test]
    fn steep_gradients_do_not_lift_the_field() {
        let vertices = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y));
        let triangles = [[0, 1, 2]];
        let topology = Topology::new(3, &triangles);
        let field = Field {
            vertices: &vertices,
            triangles: &triangles,
            topology: &topology,
            value: vec![1.0; 3],
            gradient: vertices.map(|p| 1e3 * (DVec2::ONE / 3.0 - p)).to_vec(),
            squared_depth: 1.0,
            section: None,
        };
        let at = |p: DVec2| field.at(p, field.locate(p, 0).unwrap());
        let (point, step) = (DVec2::new(0.4, 0.3), 1e-6);
        let (value, gradient) = at(point);
        assert!(value < 1.0 + MOST_BENT);
        let slope = |way: DVec2| (at(point + step * way).0 - at(point - step * way).0) / (2.0 * step);
        assert!(gradient.distance(DVec2::new(slope(DVec2::X), slope(DVec2::Y))) < 1e-6);
    }
}
