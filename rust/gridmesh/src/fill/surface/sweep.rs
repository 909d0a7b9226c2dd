//! Tangential relaxation: better faces without leaving the surface.

use glam::{DVec2, DVec3};

use super::patchwork::Patchwork;
use crate::fill::planar::stars::{Ideal, Stars};

/// Sum of the squared sides over twice the area of an equilateral triangle.
const EQUILATERAL: f64 = 3.464_101_615_137_754_4;

/// One sweep over the new vertices, each moved in its tangent plane to where its faces are best.
///
/// A triangle's badness is the sum of its squared sides over its area (1 if equilateral), that of a quad the sum over its
/// corners of the two squared sides there over their cross product (1 if square). One Newton step with a positive definite
/// model is taken, halved until the sum is smaller. Off a curved surface this leads by second-order
/// terms only, which the next normal step removes.
pub(crate) fn sweep(work: &Patchwork, positions: &mut [DVec3]) {
    let mut star: Vec<(u32, u32, Ideal)> = vec![];
    for v in work.inner() {
        star.clear();
        match &work.corners {
            Some(corners) => star.extend(corners.triangles(v - work.n)),
            None => star.extend(work.fan(v).iter().map(|&[_, i, j]| (i, j, Ideal::Equilateral))),
        }
        let here = positions[v];
        let own = star.iter().filter(|&&(.., ideal)| matches!(ideal, Ideal::Own | Ideal::Equilateral));
        let normal = own
            .map(|&(i, j, _)| (positions[i as usize] - here).cross(positions[j as usize] - here))
            .sum::<DVec3>();
        let Some(normal) = normal.try_normalize() else { continue };
        let (e, f) = normal.any_orthonormal_pair();
        let mut slope = DVec2::ZERO;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        let mut reach = f64::INFINITY;
        let mut present = 0.0;
        for &(i, j, ideal) in &star {
            let (a, b) = (positions[i as usize] - here, positions[j as usize] - here);
            reach = reach.min(a.length());
            let (sides, area, widen) = corner(ideal, a, b, normal);
            let (ds, curved) = slant(ideal, a, b);
            let (ds, da) = (DVec2::new(ds.dot(e), ds.dot(f)), DVec2::new(widen.dot(e), widen.dot(f)));
            let badness = sides / area / best(ideal);
            present += badness;
            let weight = 1.0 / area;
            slope += weight * (ds - da * (sides / area));
            let (m, n) = (1.0 / area, 2.0 * sides / (area * area));
            xx += weight * (curved - 2.0 * m * ds.x * da.x + n * da.x * da.x);
            yy += weight * (curved - 2.0 * m * ds.y * da.y + n * da.y * da.y);
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
            let sum = star.iter().map(|&(i, j, ideal)| {
                let (a, b) = (positions[i as usize] - there, positions[j as usize] - there);
                let (sides, area, _) = corner(ideal, a, b, normal);
                sides / area / best(ideal)
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
    corner(Ideal::Equilateral, a, b, normal)
}

/// The same with the sides that count for an ideal: all, or those at the right angle.
fn corner(ideal: Ideal, a: DVec3, b: DVec3, normal: DVec3) -> (f64, f64, DVec3) {
    let across = || (b - a).length_squared();
    let sides = match ideal {
        Ideal::Equilateral => a.length_squared() + b.length_squared() + across(),
        Ideal::Own => a.length_squared() + b.length_squared(),
        Ideal::Next => a.length_squared() + across(),
        Ideal::Last => b.length_squared() + across(),
    };
    let cross = a.cross(b);
    let mut area = cross.length();
    let mut facing = cross / area;
    if cross.dot(normal) <= 0.0 {
        facing = normal;
        area = cross.dot(normal);
    }
    (sides, area.max(0.02 * sides), (a - b).cross(facing))
}

/// Gradient of the squared sides as the common corner moves, and their second derivative, times the identity.
fn slant(ideal: Ideal, a: DVec3, b: DVec3) -> (DVec3, f64) {
    match ideal {
        Ideal::Equilateral | Ideal::Own => (-2.0 * (a + b), 4.0),
        Ideal::Next => (-2.0 * a, 2.0),
        Ideal::Last => (-2.0 * b, 2.0),
    }
}

/// Squared sides over twice the area where both are as they should be.
fn best(ideal: Ideal) -> f64 {
    if ideal == Ideal::Equilateral { EQUILATERAL } else { 2.0 }
}
