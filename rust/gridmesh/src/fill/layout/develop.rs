//! The loop as it would look if all its edges had the length of one lattice step.
//!
//! A lattice path gives every loop edge the same length, the loop does not. Between the two lies a
//! conformal map: its scale on the loop is known (the edge lengths), and extends harmonically into
//! the hole; the loop turns the less at a vertex the faster the scale grows outwards there. So the
//! turning of the image follows from the flux of that harmonic function, which the kernel
//! (u(x) - u(y)) / (pi |x - y|^2) gives on a disk exactly, and on other loops well enough to steer
//! by. (Sawhney and Crane, Boundary First Flattening, 2018, solve for it on a mesh.)

use glam::DVec2;

use crate::error::Result;
use crate::fill::planar::steps::Steps;
use crate::progress::Progress;

/// Pairs of vertices between two questions whether to go on.
const ASK_EVERY: usize = 1 << 20;

/// The loop's edges and angles.
pub(in crate::fill) struct Loop {
    /// Turning at each vertex, positive to the left; the sum is 2 pi for a simple loop.
    pub turning: Vec<f64>,
    /// Direction of the first edge.
    pub heading: f64,
    /// What the conformal map to even edges takes off each turning.
    pub flux: Vec<f64>,
}

impl Loop {
    /// O(n^2) where the edges are uneven, by a few operations.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled).
    pub fn new(points: &[DVec2], progress: Progress<'_>) -> Result<Loop> {
        let n = points.len();
        let edges: Vec<DVec2> = (0..n).map(|k| points[(k + 1) % n] - points[k]).collect();
        let turning: Vec<f64> = (0..n).map(|k| edges[(k + n - 1) % n].angle_to(edges[k])).collect();
        let lengths: Vec<f64> = edges.iter().map(|e| e.length()).collect();
        let heading = edges.first().map_or(0.0, |e| e.to_angle());
        let flux = flux(points, &lengths, progress)?;
        Ok(Loop { turning, heading, flux })
    }

    /// Positions of the vertices when every edge is one step of the grid long
    /// and `strength` (0 to 1) of the flux is taken off the turning, turned clockwise by `angle`;
    /// centred at the origin.
    pub fn developed<G: Steps>(&self, strength: f64, angle: f64) -> Vec<DVec2> {
        let n = self.turning.len();
        let mut heading = self.heading - angle;
        let mut steps: Vec<DVec2> = Vec::with_capacity(n);
        for k in 0..n {
            if k > 0 {
                heading += self.turning[k] - strength * self.flux[k];
            }
            let unit = DVec2::from_angle(heading);
            steps.push(unit / G::along(unit));
        }
        // What does not close is spread over the steps. (Turning them instead was no better.)
        let gap = steps.iter().sum::<DVec2>() / n as f64;
        let mut at = DVec2::ZERO;
        let mut places = Vec::with_capacity(n);
        for step in steps {
            places.push(at);
            at += step - gap;
        }
        let centre = places.iter().sum::<DVec2>() / n as f64;
        places.iter_mut().for_each(|p| *p -= centre);
        places
    }
}

fn flux(points: &[DVec2], lengths: &[f64], progress: Progress<'_>) -> Result<Vec<f64>> {
    let n = points.len();
    let before = |k: usize| lengths[(k + n - 1) % n];
    let scale: Vec<f64> =
        (0..n).map(|k| 0.5 * libm::log(before(k).max(1e-300) * lengths[k].max(1e-300))).collect();
    let share: Vec<f64> = (0..n).map(|k| 0.5 * (before(k) + lengths[k])).collect();
    let mut flux = vec![0.0; n];
    let rows = ASK_EVERY / n.max(1) + 1;
    for i in 0..n {
        if i % rows == 0 {
            progress.report(0.0)?;
        }
        for j in i + 1..n {
            // Not nearer than the edges are long: across a slit the kernel would explode.
            let apart =
                points[i].distance_squared(points[j]).max(0.5 * (share[i] * share[i] + share[j] * share[j]));
            if apart > 0.0 {
                let f = (scale[i] - scale[j]) * share[i] * share[j] / (std::f64::consts::PI * apart);
                flux[i] += f;
                flux[j] -= f;
            }
        }
    }
    Ok(flux)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::lattice::grid::{Square, Triangular};

    #[test]
    fn a_strip_between_short_and_long_edges_becomes_a_ring_segment() {
        // A rectangle 20 x 5: below 10 edges, above 20 of half the length.
        let mut points: Vec<DVec2> = (0..10).map(|i| DVec2::new(2.0 * f64::from(i), 0.0)).collect();
        points.extend((0..5).map(|i| DVec2::new(20.0, f64::from(i))));
        points.extend((0..20).map(|i| DVec2::new(20.0 - f64::from(i), 5.0)));
        points.extend((0..5).map(|i| DVec2::new(0.0, 5.0 - f64::from(i))));
        let developed = Loop::new(&points, Progress::NONE).unwrap();
        let below: f64 = developed.flux[2..9].iter().sum();
        let above: f64 = developed.flux[17..34].iter().sum();
        assert!(below > 0.5 && above < -0.5, "{below} {above}");
        assert!(developed.flux.iter().sum::<f64>().abs() < 1e-12);
    }

    #[test]
    fn long_loops_ask_whether_to_go_on() {
        let points: Vec<DVec2> =
            (0..4000).map(|k| DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 4000.0)).collect();
        let asked = AtomicUsize::new(0);
        let go_on = |_: f64| asked.fetch_add(1, Ordering::Relaxed) < 3;
        assert!(Loop::new(&points, Progress::new(&go_on)).is_err());
        assert_eq!(asked.into_inner(), 4);
    }

    #[test]
    fn even_loops_keep_their_shape() {
        let points: Vec<DVec2> =
            (0..24).map(|k| DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 24.0)).collect();
        fn even<G: Steps>(points: &[DVec2]) {
            let places = Loop::new(points, Progress::NONE).unwrap().developed::<G>(1.0, 0.0);
            for k in 0..24 {
                let step = places[(k + 1) % 24] - places[k];
                assert!((G::along(step) - 1.0).abs() < 1e-9);
            }
        }
        even::<Triangular>(&points);
        even::<Square>(&points);
    }
}
