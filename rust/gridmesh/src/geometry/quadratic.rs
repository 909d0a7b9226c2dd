//! The second-order model of a function of a point in the plane, and Newton's step down it.

use std::ops::AddAssign;

use glam::DVec2;

/// Gradient and Hessian.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quadratic {
    pub gradient: DVec2,
    pub xx: f64,
    pub xy: f64,
    pub yy: f64,
}

impl Quadratic {
    /// From the point to the model's minimum; none if it has none.
    pub fn minimum(&self) -> Option<DVec2> {
        let determinant = self.xx * self.yy - self.xy * self.xy;
        let step = self.solve(self.xx, self.yy);
        (determinant > 0.0 && self.xx > 0.0 && step.is_finite()).then_some(step)
    }

    /// The same with the Hessian shifted to be positive where it is not: always downwards.
    pub fn descent(&self) -> DVec2 {
        let (mut xx, mut yy) = (self.xx, self.yy);
        let half = 0.5 * (xx + yy);
        let radius = (0.25 * (xx - yy) * (xx - yy) + self.xy * self.xy).sqrt();
        let floor = 1e-3 * (half.abs() + radius);
        if half - radius < floor {
            let shift = floor - (half - radius);
            xx += shift;
            yy += shift;
        }
        self.solve(xx, yy)
    }

    fn solve(&self, xx: f64, yy: f64) -> DVec2 {
        let inverse = 1.0 / (xx * yy - self.xy * self.xy);
        let g = self.gradient;
        DVec2::new(self.xy * g.y - yy * g.x, self.xy * g.x - xx * g.y) * inverse
    }

    /// This many times the model.
    pub fn scaled(self, by: f64) -> Self {
        Self { gradient: self.gradient * by, xx: self.xx * by, xy: self.xy * by, yy: self.yy * by }
    }

    /// Second derivative along `t`.
    pub fn along(&self, t: DVec2) -> f64 {
        t.x * t.x * self.xx + 2.0 * t.x * t.y * self.xy + t.y * t.y * self.yy
    }
}

impl AddAssign for Quadratic {
    fn add_assign(&mut self, other: Self) {
        self.gradient += other.gradient;
        self.xx += other.xx;
        self.xy += other.xy;
        self.yy += other.yy;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_a_bowl_is_found_and_a_saddle_is_descended() {
        let to = DVec2::new(0.3, -2.0);
        let (xx, xy, yy) = (3.0, -1.0, 0.7);
        let gradient = -DVec2::new(xx * to.x + xy * to.y, xy * to.x + yy * to.y);
        let bowl = Quadratic { gradient, xx, xy, yy };
        let found = bowl.minimum().unwrap_or_default();
        assert!(found.distance(to) < 1e-12);
        assert!(bowl.descent().distance(to) < 1e-12);
        for (xx, yy) in [(1.0, -1.0), (-1.0, 1.0), (-1.0, -2.0), (0.0, 0.0)] {
            let saddle = Quadratic { gradient, xx, xy: 0.1, yy };
            assert_eq!(saddle.minimum(), None);
            assert!(saddle.descent().dot(gradient) < 0.0, "{xx} {yy}");
        }
        assert_eq!(Quadratic { gradient: DVec2::NAN, ..bowl }.minimum(), None);
    }
}
