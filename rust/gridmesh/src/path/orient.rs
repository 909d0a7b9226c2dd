//! Which way to lay the lattice so that the boundary will turn little.

use crate::drawing::curve::ClosedCurve;
use crate::options::CellShape;

/// Length over which the direction of a curve is taken, in edges.
const WINDOW: f64 = 3.0;
/// Least difference between two candidates.
const SEPARATION: f64 = 0.05;

/// A stretch of curve: its direction modulo that of the lattice's and its length.
#[derive(Clone, Copy)]
struct Stretch {
    direction: f64,
    length: f64,
}

/// The lattice angles, in [0, pi/3) or for squares in [0, pi/2), for which the fewest turns are predicted, best first; at most
/// `count`, and fewer where the curves run in few directions.
///
/// A straight lattice path follows a line only along the lattice. Beside one whose direction is
/// `phi` past a lattice direction it takes two turns in each `a (cot phi + cot(60 - phi))` edges if
/// it may swing by `a`; the prediction adds this up over the curves, with directions taken over
/// three edges. Between the directions that occur the sum is concave, so its minima are among
/// them: the candidates turn with the drawing, to the last digit but rounding. At least 0.05
/// radians lie between two of them. O(n log n) in the number of points.
pub fn predicted_angles(
    curves: &[ClosedCurve],
    edge_length: f64,
    count: usize,
    shape: CellShape,
) -> Vec<f64> {
    let step = shape.step();
    let mut stretches: Vec<Stretch> = Vec::new();
    for curve in curves {
        stretches_of(curve, edge_length, step, &mut stretches);
    }
    stretches.sort_by(|a, b| a.direction.total_cmp(&b.direction));
    let mut candidates: Vec<(f64, f64)> = predictions(&stretches, shape);
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut chosen: Vec<f64> = Vec::new();
    for (_, angle) in candidates {
        let apart = |other: &f64| {
            let d = (angle - other).abs();
            d.min(step - d) >= SEPARATION
        };
        if chosen.len() == count {
            break;
        }
        if chosen.iter().all(apart) {
            chosen.push(angle);
        }
    }
    chosen
}

/// The directions of a curve: of the chord of three edges around the middle of each segment, or of
/// the segment where it is longer.
fn stretches_of(curve: &ClosedCurve, edge_length: f64, step: f64, found: &mut Vec<Stretch>) {
    let half = 0.5 * (WINDOW * edge_length).min(0.25 * curve.length());
    let points = curve.points();
    for (i, ends) in curve.arc().windows(2).enumerate() {
        let (a, b) = (points[i], points[(i + 1) % points.len()]);
        let length = ends[1] - ends[0];
        let chord = if length >= 2.0 * half {
            b - a
        } else {
            let middle = 0.5 * (ends[0] + ends[1]);
            curve.point_at(middle + half) - curve.point_at(middle - half)
        };
        let direction = libm::atan2(chord.y, chord.x).rem_euclid(step);
        found.push(Stretch { direction: if direction < step { direction } else { 0.0 }, length });
    }
}

/// For each direction that occurs the turns predicted for a lattice laid along it, up to a factor,
/// and the direction.
///
/// A stretch at `phi` counts `sin phi sin(60 - phi)`, that is `(cos(2 phi - 60) - cos 60) / 2`, and with 90 for
/// squares:
/// sums of the sine and cosine of twice the directions, up to the angle and beyond, are all it takes.
fn predictions(stretches: &[Stretch], shape: CellShape) -> Vec<(f64, f64)> {
    let step = shape.step();
    let cosine = match shape {
        CellShape::Triangle => 0.5,
        CellShape::Quad => 0.0,
    };
    let mut length = 0.0;
    let mut total = [0.0; 2];
    let mut before = Vec::with_capacity(stretches.len());
    for stretch in stretches {
        before.push(total);
        let (sin, cos) = libm::sincos(2.0 * stretch.direction);
        total[0] += stretch.length * cos;
        total[1] += stretch.length * sin;
        length += stretch.length;
    }
    stretches
        .iter()
        .zip(before)
        .map(|(stretch, below)| {
            let angle = stretch.direction;
            // Directions beyond the angle are past it by their difference, the others by 60 more.
            let sum = |of: [f64; 2], by: f64| of[0] * libm::cos(by) - of[1] * libm::sin(by);
            let beyond = [total[0] - below[0], total[1] - below[1]];
            let cosines = sum(beyond, -2.0 * angle - step) + sum(below, step - 2.0 * angle);
            (0.5 * (cosines - cosine * length), angle)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_3;

    use super::*;
    use crate::drawing::curve::Winding;
    use crate::error::Result;
    use glam::DVec2;

    fn curve(points: &[DVec2]) -> Result<ClosedCurve> {
        ClosedCurve::new(points, Winding::CounterClockwise, "outline")
    }

    fn bean(turned: f64) -> Result<ClosedCurve> {
        let points: Vec<DVec2> = (0..150)
            .map(|i| {
                let t = std::f64::consts::TAU * f64::from(i) / 150.0;
                let radius = 3.0 + (2.0 * t).cos() + 0.5 * (3.0 * t + 1.0).sin();
                DVec2::from_angle(turned).rotate(radius * DVec2::from_angle(t))
            })
            .collect();
        curve(&points)
    }

    #[test]
    fn the_sums_are_the_sum() -> Result<()> {
        for shape in [CellShape::Triangle, CellShape::Quad] {
            sums_are_the_sum(shape)?;
        }
        Ok(())
    }

    fn sums_are_the_sum(shape: CellShape) -> Result<()> {
        let step = shape.step();
        let mut stretches = Vec::new();
        stretches_of(&bean(0.3)?, 0.2, step, &mut stretches);
        stretches.sort_by(|a, b| a.direction.total_cmp(&b.direction));
        for (value, angle) in predictions(&stretches, shape) {
            let direct: f64 = stretches
                .iter()
                .map(|stretch| {
                    let phi = (stretch.direction - angle).rem_euclid(step);
                    stretch.length * phi.sin() * (step - phi).sin()
                })
                .sum();
            assert!((value - direct).abs() < 1e-9, "{value} {direct} at {angle}");
        }
        Ok(())
    }

    #[test]
    fn a_hexagon_wants_its_own_direction() -> Result<()> {
        let turned = 0.37;
        let points: Vec<DVec2> =
            (0..6).map(|i| 5.0 * DVec2::from_angle(turned + FRAC_PI_3 * f64::from(i))).collect();
        let angles = predicted_angles(&[curve(&points)?], 0.3, 4, CellShape::Triangle);
        assert_eq!(angles.len(), 1);
        assert!((angles[0] - turned).abs() < 1e-12);
        Ok(())
    }

    #[test]
    fn candidates_turn_with_the_drawing() -> Result<()> {
        let still = predicted_angles(&[bean(0.0)?], 0.2, 5, CellShape::Triangle);
        assert_eq!(still.len(), 5);
        for turn in [0.1, 0.7, 2.0] {
            let turned = predicted_angles(&[bean(turn)?], 0.2, 5, CellShape::Triangle);
            for (a, b) in still.iter().zip(&turned) {
                let d = (a + turn - b).rem_euclid(FRAC_PI_3);
                assert!(d.min(FRAC_PI_3 - d) < 1e-9, "{still:?} {turned:?}");
            }
        }
        Ok(())
    }
}
