//! A rotation that also minds its scale: conjugate gradients around the factored system.

use super::carrier::Carrier;
use super::conformal::{Rotation, Solver};
use super::width::Wish;
use crate::error::Result;
use crate::geometry::laplace::Factor;

/// A quadratic wish for the log scale u on the boundary: the sum of `weights (u - mean - targets)^2 / 2`, where
/// the mean is taken with `shares`.
struct Aim {
    targets: Vec<f64>,
    weights: Vec<f64>,
    /// Of all vertices; their sum is one.
    shares: Vec<f64>,
}

impl Solver<'_> {
    /// The rotation of least `1/2 |grad v|^2 + beta/2 |v - directions|^2 + gamma/2 share |u - wish|^2`, where u is
    /// its log scale on the boundary, up to a constant. `robin` is the factor for `beta`;
    /// `rounds` of conjugate gradients are made.
    pub fn sized(
        &self,
        rotation: &Rotation,
        pull: (f64, &Factor),
        (gamma, rounds): (f64, usize),
        wish: &Wish,
    ) -> Result<Vec<f64>> {
        let weights: Vec<f64> =
            self.operators.lengths().iter().zip(&wish.shares).map(|(l, s)| gamma * l * s).collect();
        let sum: f64 = weights.iter().sum();
        let mut shares: Vec<f64> = weights.iter().map(|w| w / sum).collect();
        let mean = dot(&wish.sizes, &shares);
        shares.resize(rotation.v.len(), 0.0);
        let targets = wish.sizes.iter().map(|size| size - mean).collect();
        let still = self.operators.times(&rotation.v, pull.0);
        let mut v = rotation.v.clone();
        self.descend(&mut v, &still, pull, rounds, &Aim { targets, weights, shares })?;
        Ok(v)
    }

    /// The rotation that also keeps the log scale above `floors` on the boundary, softly: what is below counts
    /// `gamma/2` times its square. The area is kept. A few rounds, each with what is below in the one before.
    pub fn floored(
        &self,
        carrier: &Carrier,
        rotation: &Rotation,
        pull: (f64, &Factor),
        (gamma, rounds, steps): (f64, usize, usize),
        floors: &[f64],
    ) -> Result<Vec<f64>> {
        let still = self.operators.times(&rotation.v, pull.0);
        let areas = carrier.areas();
        let whole: f64 = areas.iter().sum();
        let mut v = rotation.v.clone();
        for _ in 0..rounds {
            let u = self.scale(&v)?;
            let after: Vec<f64> = areas.iter().zip(&u).map(|(area, u)| area * libm::exp(2.0 * u)).collect();
            let sum: f64 = after.iter().sum();
            let shares: Vec<f64> = after.iter().map(|a| a / sum).collect();
            // What u is above its mean where the area is kept.
            let shift = 0.5 * libm::log(sum / whole) - dot(&u, &shares);
            let mean = dot(&u, &shares);
            let targets: Vec<f64> = floors.iter().map(|floor| floor + shift).collect();
            let below = |(i, length): (usize, &f64)| {
                if u[i] - mean < targets[i] { gamma * length } else { 0.0 }
            };
            let weights: Vec<f64> = self.operators.lengths().iter().enumerate().map(below).collect();
            if weights.iter().all(|&w| w == 0.0) {
                break;
            }
            self.descend(&mut v, &still, pull, steps, &Aim { targets, weights, shares })?;
        }
        Ok(v)
    }

    /// Conjugate gradients from `v` on, preconditioned by `robin`. `still` is the matrix of the energy without
    /// the aim times the rotation of its minimum.
    fn descend(
        &self,
        v: &mut [f64],
        still: &[f64],
        (beta, robin): (f64, &Factor),
        steps: usize,
        aim: &Aim,
    ) -> Result<()> {
        let mut residual = self.pull(v, aim, true)?;
        let own = self.operators.times(v, beta);
        for (r, (s, own)) in residual.iter_mut().zip(still.iter().zip(&own)) {
            *r += s - own;
        }
        let mut ahead: Vec<f64> = Vec::new();
        let mut before = 0.0;
        for _ in 0..steps {
            let mut step = residual.clone();
            robin.solve(&mut step, 1)?;
            let now = dot(&residual, &step);
            if now <= 0.0 {
                break;
            }
            if ahead.is_empty() {
                ahead = step;
            } else {
                ahead.iter_mut().zip(&step).for_each(|(a, s)| *a = s + now / before * *a);
            }
            before = now;
            let mut along = self.operators.times(&ahead, beta);
            let pulled = self.pull(&ahead, aim, false)?;
            along.iter_mut().zip(&pulled).for_each(|(a, p)| *a -= p);
            let length = now / dot(&ahead, &along);
            if !length.is_finite() {
                break;
            }
            v.iter_mut().zip(&ahead).for_each(|(v, a)| *v += length * a);
            residual.iter_mut().zip(&along).for_each(|(r, a)| *r -= length * a);
        }
        Ok(())
    }

    /// Minus the gradient of an aim with respect to v, or its linear part alone.
    fn pull(&self, v: &[f64], aim: &Aim, with_targets: bool) -> Result<Vec<f64>> {
        let u = self.scale(v)?;
        let mean = dot(&u, &aim.shares);
        let mut weighted = vec![0.0; v.len()];
        for (i, (weight, target)) in aim.weights.iter().zip(&aim.targets).enumerate() {
            weighted[i] = weight * (u[i] - mean - if with_targets { *target } else { 0.0 });
        }
        let sum: f64 = weighted.iter().sum();
        weighted.iter_mut().zip(&aim.shares).for_each(|(w, share)| *w -= sum * share);
        self.potential(&mut weighted)?;
        // The difference along the contours is antisymmetric.
        Ok(self.operators.along(&weighted))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
