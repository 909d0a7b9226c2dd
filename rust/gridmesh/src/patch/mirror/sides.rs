//! How the sides of a symmetric drawing lie on the lattice.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::{Pairing, Symmetry};
use crate::lattice::reflection::Reflection;
use crate::patch::judge::CORNER_WINDOW;
use crate::path::placement::Lattice;
use crate::path::target::{SPACING, Target};
use crate::path::trace::Part;

/// How the axis lies in a lattice that was laid on it.
pub(crate) fn reflection(symmetry: &Symmetry, lattice: &Lattice) -> Reflection {
    let across = symmetry.axis.direction.perp_dot(DVec2::from_angle(lattice.angle)).abs();
    if across < 0.5 { Reflection::Along } else { Reflection::Across }
}

/// The contours of a pairing: the one on the left first.
pub(crate) fn contours_of(pairing: &Pairing) -> Vec<usize> {
    match pairing {
        Pairing::Own { contour, .. } => vec![*contour],
        Pairing::Two { contours, .. } => contours.to_vec(),
    }
}

/// Arc length on a contour of a pairing at a number of turns along its symmetric target.
pub(crate) fn arc_at(contours: &[ClosedCurve], pairing: &Pairing, side: usize, turns: f64) -> f64 {
    let (lap, part) = (turns.floor(), turns - turns.floor());
    match pairing {
        Pairing::Own { contour, start, left, right, matching } => {
            let length = contours[*contour].length();
            start
                + lap * length
                + if part <= 0.5 {
                    matching.pair(2.0 * part)[0] * left
                } else {
                    length - matching.pair(2.0 - 2.0 * part)[1] * right
                }
        }
        Pairing::Two { contours: [a, _], matching, .. } if side == 0 => {
            (lap + matching.pair(part)[0]) * contours[*a].length()
        }
        Pairing::Two { contours: [_, b], start, matching } => {
            start + (lap + 1.0 - matching.pair(1.0 - part)[1]) * contours[*b].length()
        }
    }
}

/// The mean of both sides of a drawing, in lattice units.
pub(crate) struct Sides<'a> {
    pub(crate) contours: &'a [ClosedCurve],
    pub(crate) lattice: &'a Lattice,
    pub(crate) axis: Reflection,
    pub(crate) corner_angle: f64,
}

impl Sides<'_> {
    pub(crate) fn part(&self, pairing: &Pairing) -> Part {
        match pairing {
            Pairing::Own { contour, start, left, .. } => {
                let length = self.contours[*contour].length() / self.lattice.edge_length;
                let n = ((0.5 * length / SPACING).ceil() as usize).max(6);
                let mut samples: Vec<DVec2> =
                    (0..=n).map(|i| self.mean(pairing, 0.5 * i as f64 / n as f64)).collect();
                for on_axis in [0, n] {
                    samples[on_axis] =
                        0.5 * (samples[on_axis] + Lattice::reflected(self.axis, samples[on_axis]));
                }
                let images: Vec<DVec2> =
                    samples[1..n].iter().rev().map(|&p| Lattice::reflected(self.axis, p)).collect();
                samples.extend(images);
                Part::Symmetric {
                    target: Target::faired(&samples, 0.5 * length / n as f64),
                    corners: [*start, start + left].map(|s| self.is_corner(&self.contours[*contour], s)),
                }
            }
            Pairing::Two { contours, .. } => {
                let length = self.contours[contours[0]].length() / self.lattice.edge_length;
                let n = ((length / SPACING).ceil() as usize).max(12);
                let samples: Vec<DVec2> = (0..n).map(|i| self.mean(pairing, i as f64 / n as f64)).collect();
                Part::Pair(Target::faired(&samples, length / n as f64))
            }
        }
    }

    /// True if a contour turns sharply at an arc length.
    pub(crate) fn is_corner(&self, contour: &ClosedCurve, s: f64) -> bool {
        let window = CORNER_WINDOW * self.lattice.edge_length;
        let p = contour.point_at(s);
        let (before, after) = (p - contour.point_at(s - window), contour.point_at(s + window) - p);
        libm::atan2(before.perp_dot(after), before.dot(after)).abs() > self.corner_angle
    }

    /// The point on the left and the image of its partner, halfway between.
    pub(crate) fn mean(&self, pairing: &Pairing, turns: f64) -> DVec2 {
        let on = |contour: usize, side: usize, turns: f64| {
            self.lattice.to_units(self.contours[contour].point_at(arc_at(
                self.contours,
                pairing,
                side,
                turns,
            )))
        };
        let (p, q) = match pairing {
            Pairing::Own { contour, .. } => (on(*contour, 0, turns), on(*contour, 0, 1.0 - turns)),
            Pairing::Two { contours: [a, b], .. } => (on(*a, 0, turns), on(*b, 1, 1.0 - turns)),
        };
        0.5 * (p + Lattice::reflected(self.axis, q))
    }
}
