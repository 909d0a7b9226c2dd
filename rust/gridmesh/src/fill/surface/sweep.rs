//! Tangential relaxation: better triangles without leaving the surface.

use glam::{DVec2, DVec3};

use super::patchwork::Patchwork;

/// Sum of the squared sides over twice the area of an equilateral triangle.
const EQUILATERAL: f64 = 3.464_101_615_137_754_4;

/// One sweep over the new vertices, each moved in its tangent plane to where its triangles are best.
///
/// A triangle's badness is the sum of its squared sides over its area (1 if equilateral). One Newton step with a positive definite model is
/// taken, halved until the sum is smaller. Off a curved surface this leads by second-order
/// terms only, which the next normal step removes.
pub(crate) fn sweep(work: &Patchwork, positions: &mut [DVec3]) {
    for v in work.inner() {
        let fan = work.fan(v);
        let here = positions[v];
        let normal = fan
            .iter()
            .map(|&[_, i, j]| (positions[i as usize] - here).cross(positions[j as usize] - here))
            .sum::<DVec3>();
        let Some(normal) = normal.try_normalize() else { continue };
        let (e, f) = normal.any_orthonormal_pair();
        let mut slope = DVec2::ZERO;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let mut reach = f64::INFINITY;
        let mut present = 0.0;
        for &[_, i, j] in fan {
            let (a, b) = (positions[i as usize] - here, positions[j as usize] - here);
            reach = reach.min(a.length());
            let (sides, area, widen) = shape(a, b, normal);
            let ds = -2.0 * (a + b);
            let (ds, da) = (DVec2::new(ds.dot(e), ds.dot(f)), DVec2::new(widen.dot(e), widen.dot(f)));
            let badness = sides / area / EQUILATERAL;
            present += badness;
            let weight = 1.0 / area;
            slope += weight * (ds - da * (sides / area));
            let (m, n) = (1.0 / area, 2.0 * sides / (area * area));
            xx += weight * (4.0 - 2.0 * m * ds.x * da.x + n * da.x * da.x);
            yy += weight * (4.0 - 2.0 * m * ds.y * da.y + n * da.y * da.y);
            xy += weight * (n * da.x * da.y - m * (ds.x * da.y + ds.y * da.x));
        }
        let determinant = xx * yy - xy * xy;
        if determinant.is_nan() || determinant <= 0.0 {
            continue;
        }
        let u = -DVec2::new(yy * slope.x - xy * slope.y, xx * slope.y - xy * slope.x) / determinant;
        let mut step = u.clamp_length_max(reach);
        for _ in 0..4 {
            let there = here + step.x * e + step.y * f;
            let sum = fan.iter().map(|&[_, i, j]| {
                let (sides, area, _) =
                    shape(positions[i as usize] - there, positions[j as usize] - there, normal);
                sides / area / EQUILATERAL
            });
            if sum.sum::<f64>() < present {
                positions[v] = there;
                break;
            }
            step *= 0.5;
        }
    }
}

/// Of the triangle with the sides `a` and `b`: the sum of the squared sides, twice the area, and the
/// gradient of the latter as their common corner moves. Folded triangles are seen in the tangent
/// plane, where they have to unfold; their area counts as small.
pub(crate) fn shape(a: DVec3, b: DVec3, normal: DVec3) -> (f64, f64, DVec3) {
    let sides = a.length_squared() + b.length_squared() + (b - a).length_squared();
    let cross = a.cross(b);
    let mut area = cross.length();
    let mut facing = cross / area;
    if cross.dot(normal) <= 0.0 {
        facing = normal;
        area = cross.dot(normal);
    }
    (sides, area.max(0.02 * sides), (a - b).cross(facing))
}
