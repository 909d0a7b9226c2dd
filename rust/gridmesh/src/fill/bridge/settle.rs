//! The vertices of a bridge moved within its surface to where their triangles are good.

use glam::{DVec2, DVec3};

use super::loft::Loft;
use crate::error::Result;
use crate::fill::surface::patchwork::Patchwork;
use crate::fill::surface::sweep::shape;
use crate::progress::Progress;

/// Sum of the squared sides over twice the area of an equilateral triangle.
const EQUILATERAL: f64 = 3.464_101_615_137_754_4;

/// Steps are halved this often before a vertex stays where it is.
const HALVINGS: usize = 4;

/// Sweeps end when a mean vertex gains less than this share of a good triangle.
const SETTLED: f64 = 1e-3;

/// The badness of a triangle counts to this power, and one: the worst ones most.
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
    for _ in 0..sweeps {
        progress.report(0.0)?;
        let mut gain = 0.0;
        for v in work.inner() {
            gain += moved(work, loft, flat, positions, v);
        }
        if gain < SETTLED * work.inner().len() as f64 {
            break;
        }
    }
    Ok(())
}

/// Moves one vertex; how much less bad its triangles are then.
fn moved(work: &Patchwork, loft: &Loft, flat: &mut [DVec2], positions: &mut [DVec3], v: usize) -> f64 {
    let fan = work.fan(v);
    let here = positions[v];
    let spot = loft.at(flat[v].x, flat[v].y);
    let own = |fan: &&[u32; 3]| (fan[0] as usize) < work.n_patch;
    let normals = fan
        .iter()
        .filter(own)
        .map(|&[_, i, j]| (positions[i as usize] - here).cross(positions[j as usize] - here));
    let mut normal = spot.along.cross(spot.across).normalize_or_zero();
    if normal.dot(normals.sum::<DVec3>()) < 0.0 {
        normal = -normal;
    }
    if normal == DVec3::ZERO {
        return 0.0;
    }
    let e = spot.along.normalize();
    let f = normal.cross(e);
    let mut slope = DVec2::ZERO;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut reach = f64::INFINITY;
    let mut present = 0.0;
    for &[_, i, j] in fan.iter().filter(own) {
        let (a, b) = (positions[i as usize] - here, positions[j as usize] - here);
        reach = reach.min(a.length());
        let (sides, area, widen) = shape(a, b, normal);
        let ds = -2.0 * (a + b);
        let (ds, da) = (DVec2::new(ds.dot(e), ds.dot(f)), DVec2::new(widen.dot(e), widen.dot(f)));
        let badness = sides / area / EQUILATERAL;
        present += badness.powi(POWER + 1);
        let weight = badness.powi(POWER) / area;
        slope += weight * (ds - da * (sides / area));
        let (m, n) = (1.0 / area, 2.0 * sides / (area * area));
        xx += weight * (4.0 - 2.0 * m * ds.x * da.x + n * da.x * da.x);
        yy += weight * (4.0 - 2.0 * m * ds.y * da.y + n * da.y * da.y);
        xy += weight * (n * da.x * da.y - m * (ds.x * da.y + ds.y * da.x));
    }
    let determinant = xx * yy - xy * xy;
    // The loft's derivatives in the same frame.
    let (p, q) = (spot.along.dot(e), DVec2::new(spot.across.dot(e), spot.across.dot(f)));
    let area = p * q.y;
    if determinant.is_nan() || determinant <= 0.0 || area.is_nan() || area.abs() < 1e-12 * p * p {
        return 0.0;
    }
    let u = -DVec2::new(yy * slope.x - xy * slope.y, xx * slope.y - xy * slope.x) / determinant;
    let mut step = u.clamp_length_max(reach);
    for _ in 0..HALVINGS {
        let height = step.y / q.y;
        let there = flat[v] + DVec2::new((step.x - height * q.x) / p, height);
        if (0.001..0.999).contains(&there.y) {
            let point = loft.at(there.x, there.y).point;
            let sum = fan.iter().filter(own).map(|&[_, i, j]| {
                let (sides, area, _) =
                    shape(positions[i as usize] - point, positions[j as usize] - point, normal);
                (sides / area / EQUILATERAL).powi(POWER + 1)
            });
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
