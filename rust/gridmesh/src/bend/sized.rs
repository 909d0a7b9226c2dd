//! A rotation that also minds its scale: conjugate gradients around the factored system.

use super::conformal::{Rotation, Solver};
use super::width::Wish;
use crate::error::Result;
use crate::geometry::laplace::Factor;

impl Solver<'_> {
    /// The rotation of least `1/2 |grad v|^2 + beta/2 |v - directions|^2 + gamma/2 share |u - wish|^2`, where u is
    /// its log scale on the boundary, up to a constant. `robin` is the factor for `beta`;
    /// `rounds` of conjugate gradients are made.
    pub fn sized(
        &self,
        rotation: &Rotation,
        (beta, robin): (f64, &Factor<'_>),
        (gamma, rounds): (f64, usize),
        wish: &Wish,
    ) -> Result<Vec<f64>> {
        let mut v = rotation.v.clone();
        let (wish, share) = (self.centred(&wish.sizes, &wish.shares), &wish.shares);
        let mut residual = self.pull(&v, gamma, share, Some(&wish))?;
        let mut ahead: Vec<f64> = Vec::new();
        let mut before = 0.0;
        for _ in 0..rounds {
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
            let pulled = self.pull(&ahead, gamma, share, None)?;
            along.iter_mut().zip(&pulled).for_each(|(a, p)| *a -= p);
            let length = now / dot(&ahead, &along);
            if !length.is_finite() {
                break;
            }
            v.iter_mut().zip(&ahead).for_each(|(v, a)| *v += length * a);
            residual.iter_mut().zip(&along).for_each(|(r, a)| *r -= length * a);
        }
        Ok(v)
    }

    /// Minus the gradient of `gamma/2 |u - wish|^2` with respect to v.
    fn pull(&self, v: &[f64], gamma: f64, share: &[f64], wish: Option<&[f64]>) -> Result<Vec<f64>> {
        let lengths = self.operators.lengths();
        let u = self.scale(v)?;
        let mut off = self.centred(&u[..lengths.len()], share);
        if let Some(wish) = wish {
            off.iter_mut().zip(wish).for_each(|(off, wish)| *off -= wish);
        }
        let mut weighted = vec![0.0; v.len()];
        for (i, off) in off.iter().enumerate() {
            weighted[i] = gamma * share[i] * lengths[i] * off;
        }
        self.potential(&mut weighted)?;
        // The difference along the contours is antisymmetric.
        Ok(self.operators.along(&weighted))
    }

    fn centred(&self, of: &[f64], share: &[f64]) -> Vec<f64> {
        let weights: Vec<f64> = self.operators.lengths().iter().zip(share).map(|(l, s)| l * s).collect();
        let mean = dot(of, &weights) / weights.iter().sum::<f64>();
        of.iter().map(|x| x - mean).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
