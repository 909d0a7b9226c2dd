//! The direction of a drawn contour, smoothed, as a continuous angle along it.

use glam::DVec2;

/// Spacing of the samples and standard deviation of the smoothing, in edges.
const SPACING: f64 = 0.25;
const SIGMA: f64 = 0.7;

/// Tangent angles of a closed polyline in edges, unwrapped, smoothed by a Gaussian of 0.7 edges.
pub struct Tangents {
    /// Angles at the middles of equal parts of the contour.
    angles: Vec<f64>,
    step: f64,
    /// What the angle gains in one turn: a full circle, one way or the other.
    gain: f64,
}

impl Tangents {
    /// `points` closed implicitly, simple; `arcs` their arc lengths and the whole length. Linear.
    pub fn new(points: &[DVec2], arcs: &[f64]) -> Self {
        let n = points.len();
        let length = arcs[n];
        let edge = |i: usize| points[(i + 1) % n] - points[i % n];
        let turn = |i: usize| edge(i).angle_to(edge(i + 1));
        let mut headings = vec![edge(0).to_angle()];
        for i in 0..n {
            headings.push(headings[i] + turn(i));
        }
        // The turning number of a simple line is one or minus one.
        let gain = std::f64::consts::TAU.copysign(headings[n] - headings[0]);
        let count = ((length / SPACING).ceil() as usize).max(24);
        let step = length / count as f64;
        let mut segment = 0;
        let angles = (0..count)
            .map(|k| {
                let s = (k as f64 + 0.5) * step;
                while segment + 1 < n && arcs[segment + 1] <= s {
                    segment += 1;
                }
                headings[segment]
            })
            .collect();
        Self { angles, step, gain }
    }

    /// Lattice directions `step` apart that the tangent turns through in one round: a full circle, one way or
    /// the other.
    pub fn total(&self, step: f64) -> i32 {
        (self.gain / step).round() as i32
    }

    /// The smoothed angle at an arc length from zero to the length of the contour.
    pub fn at(&self, s: f64) -> f64 {
        let count = self.angles.len() as i64;
        let middle = s / self.step - 0.5;
        let reach = (3.0 * SIGMA / self.step).ceil().min(0.5 * count as f64);
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in (middle - reach).ceil() as i64..=(middle + reach).floor() as i64 {
            let lap = k.div_euclid(count);
            let angle = self.angles[k.rem_euclid(count) as usize] + lap as f64 * self.gain;
            let weight = libm::exp(-0.5 * ((k as f64 - middle) * self.step / SIGMA).powi(2));
            sum += weight * angle;
            weights += weight;
        }
        sum / weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_turns_evenly_either_way() {
        for sign in [1.0, -1.0] {
            let points: Vec<DVec2> = (0..400)
                .map(|i| 20.0 * DVec2::from_angle(sign * std::f64::consts::TAU * f64::from(i) / 400.0))
                .collect();
            let mut arcs = vec![0.0];
            for i in 0..400 {
                arcs.push(arcs[i] + points[i].distance(points[(i + 1) % 400]));
            }
            let tangents = Tangents::new(&points, &arcs);
            let step = std::f64::consts::FRAC_PI_3;
            assert_eq!(tangents.total(step), if sign > 0.0 { 6 } else { -6 });
            assert_eq!(tangents.total(1.5 * step), if sign > 0.0 { 4 } else { -4 });
            let at = |t: f64| tangents.at(t * arcs[400]);
            for k in 0..10 {
                let t = 0.1 * f64::from(k);
                assert!((at(t) - at(0.0) - sign * std::f64::consts::TAU * t).abs() < 1e-2);
            }
        }
    }
}
