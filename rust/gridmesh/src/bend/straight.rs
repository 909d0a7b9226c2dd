//! Sides of the bent drawing straightened: what a rotation leaves over adds up along a side.
//!
//! Beside a change of direction a rotation fits its directions only gradually, and a carrier's chords say little of what
//! the pen does between them. Both are small angles, but along a side of hundreds of edges they become steps of
//! whole edges, two irregular vertices each. So the drawing is bent, its sides are measured, and it is turned back
//! by what they lack.

use std::ops::Range;

use glam::DVec2;

use super::carrier::Carrier;
use super::conformal::{Solver, keep_area};
use crate::error::Result;
use crate::geometry::laplace::Factor;
use crate::options::CellShape;

/// Rounds of measuring the bent sides and turning them back.
const ROUNDS: usize = 2;
/// Standard deviation of the smoothing along a side, in edges: what wanders faster stays within an edge.
const SIGMA: f64 = 6.0;
/// Sides shorter than the first stay as they are, in edges; so do sides shorter than the second that make up more than a
/// share of their contour: there turning one changes the sizes of the whole drawing, and meshes of 2000 triangles lose one or two
/// degrees of least angle for nothing. With 100 edges for all sides 50,000 triangles in hand-drawn outlines have 16
/// irregular vertices (median), with these limits 12, with an eighth as the share 14.
const SHORTEST: (f64, f64) = (30.0, 100.0);
const SHARE: f64 = 0.2;
/// The same for quads, whose pairs of turns along a side are two poles each on both sheets.
const SHORTEST_OF_QUADS: f64 = 8.0;
/// A side that stays in a strip of this width, in edges, is straight enough: a path on one row follows it.
const ASIDE: f64 = 1.0;
/// So near to the ends of a side the outline turns to the next one, in edges: what is off there does not count.
const ENDS: f64 = 3.0;
/// A chord counts as off by no more than this, in radians: what is off by more is a detail of the drawing.
const MOST: f64 = 0.3;
/// No place of the outline may get coarser than by this factor, as a logarithm; the second where sizes do not matter. With the
/// first 50,000 triangles in hand-drawn outlines have 12 irregular vertices (median), with the second 10.
const COARSER: (f64, f64) = (0.5, 1.0);

impl Solver<'_> {
    /// A rotation under whose map the sides of the contours, stretches that follow one lattice direction, run along
    /// it on the whole. `pull` is the weight of the directions with the factor for it, `price` that of a turn.
    ///
    /// The correction is scaled down where it would make a place of the outline much coarser. Three solves a round.
    pub fn straightened(
        &self,
        carrier: &Carrier,
        rotation: &[f64],
        (beta, robin): (f64, &Factor),
        price: f64,
        (shape, sizes_matter): (CellShape, bool),
    ) -> Result<Vec<f64>> {
        let mut v = rotation.to_vec();
        let mut before = self.scale(&v)?;
        keep_area(carrier, &mut before);
        let mut u = before.clone();
        for _ in 0..ROUNDS {
            let positions = self.map(carrier, &u, &v)?;
            let mut more = vec![0.0; v.len()];
            let found = self.operators.directions(&v, price);
            for ((rim, directions), contour) in carrier.rims.iter().zip(&found).zip(self.operators.contours())
            {
                let at = &positions[rim.start..rim.start + rim.len()];
                let is_short = |side: f64| is_short(shape, side, rim.length);
                for (start, count) in sides(&directions.steps, contour.2) {
                    let heading = self.operators.step() * f64::from(directions.steps[start]);
                    let points: Vec<DVec2> = (0..count).map(|j| at[(start + j) % at.len()]).collect();
                    for (j, off) in off_course(&points, heading, is_short).into_iter().enumerate() {
                        let i = rim.start + (start + j) % at.len();
                        more[i] = -beta * self.operators.pulls()[i] * off;
                    }
                }
            }
            if more.iter().all(|&off| off == 0.0) {
                break;
            }
            robin.solve(&mut more, 1)?;
            v.iter_mut().zip(&more).for_each(|(v, more)| *v += more);
            u = self.scale(&v)?;
            keep_area(carrier, &mut u);
        }
        let n_rim = self.operators.pulls().len();
        let coarser = before[..n_rim].iter().zip(&u).map(|(b, u)| b - u).fold(0.0, f64::max);
        let most = if sizes_matter { COARSER.0 } else { COARSER.1 };
        if coarser > most {
            let share = most / coarser;
            v.iter_mut().zip(rotation).for_each(|(v, r)| *v = r + share * (*v - r));
        }
        Ok(v)
    }
}

/// The stretches of equal directions of a closed contour, where these gain `total` in one round: first vertices and
/// how many there are.
fn sides(steps: &[i32], total: i32) -> Vec<(usize, usize)> {
    let n = steps.len();
    let before = |i: usize| if i == 0 { steps[n - 1] - total } else { steps[i - 1] };
    let starts: Vec<usize> = (0..n).filter(|&i| steps[i] != before(i)).collect();
    let next = |k: usize| starts.get(k + 1).copied().unwrap_or(starts[0] + n);
    (0..starts.len()).map(|k| (starts[k], next(k) - starts[k])).collect()
}

/// Whether a side stays as it is because it is short, in a contour of some length.
fn is_short(shape: CellShape, side: f64, contour: f64) -> bool {
    match shape {
        CellShape::Triangle => side < SHORTEST.0 || side < SHORTEST.1 && side > SHARE * contour,
        CellShape::Quad => side < SHORTEST_OF_QUADS,
    }
}

/// By how much the chords of a side are off its heading, smoothed, at its vertices; nothing for a side that is
/// straight enough, or short.
///
/// Near the ends the chords are mirrored, so that smoothing keeps what they add up to.
fn off_course(points: &[DVec2], heading: f64, is_short: impl Fn(f64) -> bool) -> Vec<f64> {
    let mut arcs = vec![0.0];
    for (k, ends) in points.windows(2).enumerate() {
        arcs.push(arcs[k] + ends[0].distance(ends[1]));
    }
    let whole = arcs[points.len() - 1];
    let direction = DVec2::from_angle(heading);
    let is_end = |s: f64| s < ENDS || whole - s < ENDS;
    let inner =
        || points.iter().zip(&arcs).filter(|&(_, &s)| !is_end(s)).map(|(p, _)| direction.perp_dot(*p));
    let (low, high) =
        inner().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if is_short(whole) || high - low < ASIDE {
        return vec![0.0; points.len()];
    }
    // Middle, length and how far off.
    let chords: Vec<[f64; 3]> = (1..points.len())
        .map(|k| {
            let middle = 0.5 * (arcs[k - 1] + arcs[k]);
            let off = direction.angle_to(points[k] - points[k - 1]);
            [middle, arcs[k] - arcs[k - 1], if is_end(middle) { 0.0 } else { off.clamp(-MOST, MOST) }]
        })
        .collect();
    let within = |range: Range<f64>| {
        let first = chords.partition_point(|c| c[0] < range.start);
        let last = chords.partition_point(|c| c[0] < range.end);
        &chords[first..last.max(first)]
    };
    let smoothed = |&s: &f64| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (sign, shift) in [(1.0, 0.0), (-1.0, 0.0), (-1.0, 2.0 * whole)] {
            // Places at which a chord, or its mirror image, is near.
            let centre = sign * (s - shift);
            for [middle, length, off] in within(centre - 3.0 * SIGMA..centre + 3.0 * SIGMA) {
                let weight = length * libm::exp(-0.5 * ((middle - centre) / SIGMA).powi(2));
                sum += weight * off;
                weights += weight;
            }
        }
        if weights > 0.0 { sum / weights } else { 0.0 }
    };
    arcs.iter().map(smoothed).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn sides_go_once_around() {
        assert_eq!(
            sides(&[0, 0, 1, 1, 1, 2, 3, 4, 5, 6], 6),
            vec![(2, 3), (5, 1), (6, 1), (7, 1), (8, 1), (9, 3)]
        );
        let found = sides(&[1, 2, 3, 4, 5, 6], 6);
        assert_eq!(found.iter().map(|side| side.1).sum::<usize>(), 6);
    }

    #[test]
    fn a_side_askew_is_off_by_its_angle_and_a_jittering_one_is_not() {
        let line = |angle: f64, jitter: f64| -> Vec<DVec2> {
            let beside = |k: i32| jitter * f64::from(k % 2);
            (0..80)
                .map(|k| DVec2::from_angle(angle).rotate(DVec2::new(1.5 * f64::from(k), beside(k))))
                .collect()
        };
        let is_short = |side: f64| is_short(CellShape::Triangle, side, 400.0);
        let askew = off_course(&line(TAU / 6.0 + 0.05, 0.0), TAU / 6.0, is_short);
        assert!(askew[30..50].iter().all(|off| (off - 0.05).abs() < 1e-9));
        let jittering = off_course(&line(0.0, 0.2), 0.0, is_short);
        assert!(jittering.iter().all(|off| off.abs() < 0.01), "{jittering:?}");
        assert!(off_course(&line(0.1, 0.0)[..6], 0.0, is_short).iter().all(|&off| off == 0.0));
        let within_a_row = off_course(&line(0.008, 0.0), 0.0, is_short);
        assert!(within_a_row.iter().all(|&off| off == 0.0), "{within_a_row:?}");
    }
}
