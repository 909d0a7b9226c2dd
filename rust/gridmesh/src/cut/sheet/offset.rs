//! A stroke beside a stroke, for kerfs.

use glam::{DVec2, DVec3};

use crate::cut::options::Sweep;
use crate::cut::sheet::View;
use crate::error::{Error, Result};

/// The stroke moved to its left, as it is seen, by `by`; corners stay corners. Through an eye, at the mean distance
/// of the stroke. The left of a closed stroke is its inside.
pub(in crate::cut) fn shifted(
    vertices: &[DVec3],
    stroke: &[DVec3],
    sweep: Sweep,
    by: f64,
) -> Result<Vec<DVec3>> {
    const SHARPEST: f64 = 4.0;
    let view = View::new(vertices, stroke, sweep);
    let see = |(point, p): (usize, &DVec3)| {
        view.project(*p).ok_or(Error::BehindEye { what: "stroke", point }).map(|q| (q, view.height(*p)))
    };
    let mut seen = stroke.iter().enumerate().map(see).collect::<Result<Vec<_>>>()?;
    seen.dedup_by(|b, a| a.0 == b.0);
    let depth = stroke.iter().map(|p| view.depth(*p)).sum::<f64>() / stroke.len().max(1) as f64;
    let mut by = by / depth;
    let n = seen.len();
    if n < 2 {
        return Err(Error::StrokeTooShort { distinct: n });
    }
    let closed = n > 3
        && stroke[0].distance(stroke[stroke.len() - 1])
            <= 1e-9 * stroke[0].distance(stroke[stroke.len() / 2]);
    let at = |k: usize| seen[k].0;
    if closed {
        let area: f64 = (0..n - 1).map(|k| at(k).perp_dot(at(k + 1))).sum();
        by *= area.signum();
    }
    let normal = |a: usize, b: usize| (at(b) - at(a)).normalize_or_zero().perp();
    let miter = |m: DVec2, k: usize| {
        let sum: DVec2 = m + if k + 1 < n { normal(k, k + 1) } else { m };
        let length = sum.length_squared();
        if length > 0.0 { 2.0 * sum / length.max(4.0 / (SHARPEST * SHARPEST)) } else { m }
    };
    let moved = (0..n).map(|k| {
        let shift = if closed && (k == 0 || k == n - 1) {
            let (a, b) = (normal(n - 2, n - 1), normal(0, 1));
            2.0 * (a + b) / (a + b).length_squared().max(4.0 / (SHARPEST * SHARPEST))
        } else if k == 0 {
            normal(0, 1)
        } else {
            miter(normal(k - 1, k), k)
        };
        view.lift(at(k) + by * shift, seen[k].1)
    });
    let mut moved = moved.collect::<Vec<_>>();
    if closed {
        moved[n - 1] = moved[0];
    }
    Ok(moved)
}
