//! Symmetric bends: a rotation made antisymmetric under the mirror, a map made symmetric.

use glam::DVec2;

use super::carrier::Carrier;
use super::grid::TriangleGrid;

/// A rotation is only made symmetric if its mean is this near to what the axis allows, in radians.
const NEAR: f64 = 0.1;

/// The image of each vertex of a carrier under the mirror whose axis is the first coordinate axis, as
/// weights of other vertices.
pub struct Mirrored {
    images: Vec<([usize; 3], [f64; 3])>,
}

impl Mirrored {
    pub fn new(carrier: &Carrier) -> Self {
        let grid = TriangleGrid::new(&carrier.vertices, &carrier.triangles);
        let image = |p: &DVec2| {
            let image = DVec2::new(p.x, -p.y);
            match grid.locate(image, &carrier.vertices, &carrier.triangles) {
                Some((t, weights)) => (carrier.triangles[t].map(|v| v as usize), weights),
                None => {
                    // Nearly symmetric drawings: the nearest vertex stands for a place outside.
                    let away = |i: &usize| carrier.vertices[*i].distance_squared(image);
                    let nearest = (0..carrier.vertices.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
                    ([nearest.unwrap_or(0); 3], [1.0, 0.0, 0.0])
                }
            }
        };
        Self { images: carrier.vertices.iter().map(image).collect() }
    }

    /// The angle by which the axis is turned, a multiple of `step`, half the angle between
    /// lattice directions, if a rotation is near to it.
    pub fn turn(v: &[f64], step: f64) -> Option<f64> {
        let mean = v.iter().sum::<f64>() / v.len() as f64;
        let turn = (mean / step).round() * step;
        ((mean - turn).abs() <= NEAR).then_some(turn)
    }

    fn at(&self, vertex: usize, of: impl Fn(usize) -> DVec2) -> DVec2 {
        let (corners, weights) = &self.images[vertex];
        corners.iter().zip(weights).fold(DVec2::ZERO, |sum, (&c, &w)| sum + w * of(c))
    }

    /// The rotation whose difference from `turn` changes sign under the mirror.
    pub fn antisymmetric(&self, v: &[f64], turn: f64) -> Vec<f64> {
        let image = |i: usize| self.at(i, |c| DVec2::new(v[c], 0.0)).x;
        (0..v.len()).map(|i| turn + 0.5 * (v[i] - image(i))).collect()
    }

    /// The map that commutes with the mirror; the axis of its image passes through the origin at `turn`.
    pub fn symmetric(&self, positions: &[DVec2], turn: f64) -> Vec<DVec2> {
        let n = positions.len() as f64;
        let direction = DVec2::from_angle(turn);
        let middle = positions.iter().sum::<DVec2>() / n;
        // In axes along and across.
        let local: Vec<DVec2> = positions
            .iter()
            .map(|p| DVec2::new(direction.dot(*p - middle), direction.perp_dot(*p - middle)))
            .collect();
        let across =
            (0..local.len()).map(|i| local[i].y + self.at(i, |c| local[c]).y).sum::<f64>() / (2.0 * n);
        let centred = |p: DVec2| DVec2::new(p.x, p.y - across);
        (0..local.len())
            .map(|i| {
                let image = self.at(i, |c| centred(local[c]));
                let own = centred(local[i]);
                let mean = 0.5 * (own + DVec2::new(image.x, -image.y));
                mean.x * direction + mean.y * direction.perp()
            })
            .collect()
    }
}
