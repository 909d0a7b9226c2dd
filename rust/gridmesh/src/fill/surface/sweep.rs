//! Tangential relaxation: better faces without leaving the surface.

use glam::DVec3;

use super::patchwork::Patchwork;
use crate::geometry::corner::{Corner, Ideal};
use crate::geometry::quadratic::Quadratic;

/// One sweep over the new vertices, each moved in its tangent plane to where its faces are best.
///
/// A triangle's badness is the sum of its squared sides over its area (1 if equilateral), that of a quad the sum over its
/// corners of the two squared sides there over their cross product (1 if square). One Newton step with a positive definite
/// model is taken, halved until the sum is smaller. Off a curved surface this leads by second-order
/// terms only, which the next normal step removes.
pub(crate) fn sweep(work: &Patchwork, positions: &mut [DVec3]) {
    let mut star: Vec<(u32, u32, Ideal)> = vec![];
    for v in work.inner() {
        work.star(v, &mut star);
        let here = positions[v];
        let own = star.iter().filter(|(.., ideal)| ideal.is_own());
        let normal = own
            .map(|&(i, j, _)| (positions[i as usize] - here).cross(positions[j as usize] - here))
            .sum::<DVec3>();
        let Some(normal) = normal.try_normalize() else { continue };
        let (e, f) = normal.any_orthonormal_pair();
        let seen = |(i, j, ideal): (u32, u32, Ideal), from: DVec3, positions: &[DVec3]| {
            Corner::new(ideal, positions[i as usize] - from, positions[j as usize] - from, normal)
        };
        let mut model = Quadratic::default();
        let mut reach = f64::INFINITY;
        let mut present = 0.0;
        for &at in &star {
            reach = reach.min(here.distance(positions[at.0 as usize]));
            let corner = seen(at, here, positions);
            present += corner.badness();
            model += corner.model(1.0, [e, f]);
        }
        let Some(step) = model.minimum() else { continue };
        let mut step = step.clamp_length_max(reach);
        for _ in 0..4 {
            let there = here + step.x * e + step.y * f;
            let sum = star.iter().map(|&at| seen(at, there, positions).badness());
            if sum.sum::<f64>() < present {
                positions[v] = there;
                break;
            }
            step *= 0.5;
        }
    }
}
