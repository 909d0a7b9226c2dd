//! The curve that reshapes a body's heights.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use crate::error::{Error, Result, told};

/// Values that a curve may take after its first, which is 0.
const RANGE: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// The derivative at 0 is at least this part of the first slope, so that the silhouette stays smooth.
const LEAST_START: f64 = 0.5;

/// A smooth function on 0 to 1 through evenly spaced values, the first of them 0, the others positive.
///
/// Piecewise cubic with the derivatives of Fritsch and Butland (1984): it has a continuous derivative,
/// rises where the values rise, falls where they fall, and so is positive beyond 0.
#[derive(Clone, Debug)]
struct Curve {
    values: Vec<f64>,
    /// Derivatives times the distance between arguments.
    slopes: Vec<f64>,
}

impl Curve {
    fn new(values: &[f64]) -> Self {
        let n = values.len();
        let rises = values.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>();
        let last = n - 2;
        let mut slopes = vec![rises[0]; n];
        slopes[n - 1] = rises[last];
        for k in 1..n - 1 {
            let (a, b) = (rises[k - 1], rises[k]);
            slopes[k] = if a * b > 0.0 { 2.0 * a * (b / (a + b)) } else { 0.0 };
        }
        if n > 2 {
            let end = |near: f64, far: f64, least: f64| {
                let (low, high) = (least * near, 3.0 * near);
                (0.5 * (3.0 * near - far)).clamp(low.min(high), low.max(high))
            };
            slopes[0] = end(rises[0], rises[1], LEAST_START);
            slopes[n - 1] = end(rises[last], rises[last - 1], 0.0);
        }
        Curve { values: values.to_vec(), slopes }
    }

    /// Value over argument and derivative at `t` in 0 to 1; the first has a limit at 0.
    fn at(&self, t: f64) -> (f64, f64) {
        let spans = (self.values.len() - 1) as f64;
        let k = ((t * spans) as usize).min(self.values.len() - 2);
        let x = t * spans - k as f64;
        let (p, q) = (self.slopes[k], self.slopes[k + 1]);
        let rise = self.values[k + 1] - self.values[k];
        let (square, cube) = (3.0 * rise - 2.0 * p - q, p + q - 2.0 * rise);
        let growth = p + x * (square + x * cube);
        let slope = p + x * (2.0 * square + 3.0 * x * cube);
        let ratio = if k == 0 { growth * spans } else { (self.values[k] + x * growth) / t };
        (ratio, slope * spans)
    }
}

/// Replaces every height `h` of a body by `top c(h / top)`, `top` the body's largest height.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    curve: Curve,
    top: f64,
}

impl Section {
    /// None if the curve through `values` changes nothing. `highest` is the largest squared height.
    pub fn new(values: Option<&[f64]>, highest: f64) -> Option<Self> {
        let values = values?;
        let spans = (values.len() - 1) as f64;
        let straight = |(k, v): (usize, &f64)| (v - k as f64 / spans).abs() < 1e-12;
        if values.iter().enumerate().all(straight) {
            return None;
        }
        Some(Section { curve: Curve::new(values), top: highest.sqrt() })
    }

    /// The squared height that replaces `value`, and its gradient.
    ///
    /// With `q = c(t) / t` and `t = h / top` the squared height `f` becomes `f q^2`, and its derivative
    /// is `q c'(t)`: both are as smooth at the silhouette as `f`.
    pub fn of(&self, value: f64, gradient: DVec2) -> (f64, DVec2) {
        let t = (value.sqrt() / self.top).min(1.0);
        let (ratio, slope) = self.curve.at(t);
        (value * ratio * ratio, gradient * (ratio * slope))
    }

    /// The height, of a sphere of this radius, that lies as far along the reshaped section, of all its length
    /// from the silhouette to the top, as `height` lies along the sphere's.
    pub fn even(&self, height: f64, radius: f64) -> f64 {
        const STEPS: usize = 48;
        if radius.is_nan() || radius <= 0.0 {
            return height;
        }
        let step = FRAC_PI_2 / STEPS as f64;
        let length = |k: usize| {
            let (sin, cos) = libm::sincos((k as f64 + 0.5) * step);
            let (_, slope) = self.curve.at((sin * radius / self.top).min(1.0));
            libm::hypot(sin, slope * cos)
        };
        let mut along = [0.0; STEPS + 1];
        for k in 0..STEPS {
            along[k + 1] = along[k] + length(k);
        }
        let wanted = libm::asin((height / radius).min(1.0)) / FRAC_PI_2 * along[STEPS];
        let k = along.partition_point(|&a| a < wanted).clamp(1, STEPS) - 1;
        let angle = step * (k as f64 + (wanted - along[k]) / (along[k + 1] - along[k]));
        radius * libm::sin(angle)
    }
}

/// Refuses a curve that is none.
pub(crate) fn check(values: &[f64]) -> Result<()> {
    let refuse = |value: String, allowed| Err(Error::InvalidOption { name: "curve", value, allowed });
    if values.len() < 2 {
        return refuse(format!("{} values", values.len()), "two values or more, the first of them 0");
    }
    if values[0] != 0.0 {
        return refuse(format!("{} at first", told(values[0])), "0 at first, for the body is closed there");
    }
    match values[1..].iter().find(|value| !RANGE.contains(value)) {
        Some(value) => refuse(told(*value), "numbers from 0.000001 to 1000000 after the first"),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(curve: &Curve, t: f64) -> f64 {
        t * curve.at(t).0
    }

    #[test]
    fn a_straight_line_changes_nothing() {
        for n in [2, 3, 7, 100] {
            let line = (0..n).map(|k| f64::from(k) / f64::from(n - 1)).collect::<Vec<_>>();
            assert!(Section::new(Some(&line), 4.0).is_none());
            let curve = Curve::new(&line);
            for k in 0..=50 {
                let (ratio, slope) = curve.at(f64::from(k) / 50.0);
                assert!((ratio - 1.0).abs() < 1e-12 && (slope - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_squared_height() {
        let section = Section::new(Some(&[0.0, 0.8, 0.3, 0.9, 1.2]), 4.0).unwrap();
        for k in 0..400 {
            let f = 0.01 * (f64::from(k) + 0.5);
            let step = 1e-6;
            let rise =
                (section.of(f + step, DVec2::ZERO).0 - section.of(f - step, DVec2::ZERO).0) / (2.0 * step);
            let (_, gradient) = section.of(f, DVec2::X);
            assert!((gradient.x - rise).abs() < 1e-3 * (1.0 + rise.abs()), "{f}: {} {rise}", gradient.x);
        }
        let (value, gradient) = section.of(0.0, DVec2::X);
        assert_eq!(value, 0.0);
        assert!(gradient.x.is_finite() && gradient.x > 0.0);
    }

    proptest! {
        #[test]
        fn curves_keep_to_their_values(values in prop::collection::vec(1e-6..10f64, 1..12)) {
            let mut all = vec![0.0];
            all.extend(values);
            check(&all).unwrap();
            let curve = Curve::new(&all);
            let spans = all.len() - 1;
            prop_assert!(curve.at(0.0).1 > 0.0);
            for (k, pair) in all.windows(2).enumerate() {
                let (low, high) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
                let mut before = pair[0];
                for j in 0..=20 {
                    let now = value(&curve, (k as f64 + f64::from(j) / 20.0) / spans as f64);
                    prop_assert!(now >= low - 1e-9 && now <= high + 1e-9);
                    prop_assert!((now - before) * (pair[1] - pair[0]) >= -1e-9);
                    before = now;
                }
                // The derivative agrees from both sides of every value.
                let joint = (k + 1) as f64 / spans as f64;
                if k + 1 < spans {
                    let (left, right) = (curve.at(joint * (1.0 - 1e-9)).1, curve.at(joint * (1.0 + 1e-9)).1);
                    prop_assert!((left - right).abs() < 1e-4 * (1.0 + left.abs()) * spans as f64);
                }
            }
        }
    }
}
