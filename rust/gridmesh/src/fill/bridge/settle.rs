//! The vertices of a bridge moved within its surface to where their faces are good.

use glam::{DVec2, DVec3};

use super::loft::Loft;
use crate::error::Result;
use crate::fill::surface::patchwork::Patchwork;
use crate::geometry::corner::{Corner, Ideal};
use crate::geometry::quadratic::Quadratic;
use crate::progress::Progress;

/// Steps are halved this often before a vertex stays where it is.
const HALVINGS: usize = 4;

/// Sweeps end when a mean vertex gains less than this share of a good corner.
const SETTLED: f64 = 1e-3;

/// The badness of a corner counts to this power, and one: the worst ones most.
const POWER: i32 = 6;

/// Moves the vertices between the loops. `flat`: where all vertices are on the loft; those of the loops stay.
pub(super) fn settle(
    work: &Patchwork,
    loft: &Loft,
    flat: &mut [DVec2],
    positions: &mut [DVec3],
    sweeps: usize,
    progress: Progress<'_>,
) -> Result<()> {
    let mut star = vec![];
    for _ in 0..sweeps {
        progress.report(0.0)?;
        let mut gain = 0.0;
        for v in work.inner() {
            work.star(v, &mut star);
            gain += moved(loft, flat, positions, &star, v);
        }
        if gain < SETTLED * work.inner().len() as f64 {
            break;
        }
    }
    Ok(())
}

/// Moves one vertex; how much less bad its faces are then.
fn moved(
    loft: &Loft,
    flat: &mut [DVec2],
    positions: &mut [DVec3],
    star: &[(u32, u32, Ideal)],
    v: usize,
) -> f64 {
    let here = positions[v];
    let spot = loft.at(flat[v].x, flat[v].y);
    let own = star.iter().filter(|(.., ideal)| ideal.is_own());
    let normals = own.map(|&(i, j, _)| (positions[i as usize] - here).cross(positions[j as usize] - here));
    let mut normal = spot.along.cross(spot.across).normalize_or_zero();
    if normal.dot(normals.sum::<DVec3>()) < 0.0 {
        normal = -normal;
    }
    if normal == DVec3::ZERO {
        return 0.0;
    }
    let e = spot.along.normalize();
    let f = normal.cross(e);
    let seen = |(i, j, ideal): (u32, u32, Ideal), from: DVec3, positions: &[DVec3]| {
        Corner::new(ideal, positions[i as usize] - from, positions[j as usize] - from, normal)
    };
    let mut model = Quadratic::default();
    let mut reach = f64::INFINITY;
    let mut present = 0.0;
    for &at in star {
        reach = reach.min(here.distance(positions[at.0 as usize]));
        let corner = seen(at, here, positions);
        let weight = corner.badness().powi(POWER);
        present += weight * corner.badness();
        model += corner.model(weight, [e, f]);
    }
    // The loft's derivatives in the same frame.
    let (p, q) = (spot.along.dot(e), DVec2::new(spot.across.dot(e), spot.across.dot(f)));
    let area = p * q.y;
    if area.is_nan() || area.abs() < 1e-12 * p * p {
        return 0.0;
    }
    let Some(step) = model.minimum() else { return 0.0 };
    let mut step = step.clamp_length_max(reach);
    for _ in 0..HALVINGS {
        let height = step.y / q.y;
        let there = flat[v] + DVec2::new((step.x - height * q.x) / p, height);
        if (0.001..0.999).contains(&there.y) {
            let point = loft.at(there.x, there.y).point;
            let sum = star.iter().map(|&at| seen(at, point, positions).badness().powi(POWER + 1));
            let sum = sum.sum::<f64>();
            if sum < present {
                flat[v] = there;
                positions[v] = point;
                return present - sum;
            }
        }
        step *= 0.5;
    }
    0.0
}
