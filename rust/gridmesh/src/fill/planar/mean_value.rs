//! A first guess of the harmonic extension into a lattice polygon, from its loop to all inside at once.
//!
//! Sweeps over the vertices carry a value by one edge each; from a loop of a thousand edges they would need
//! hundreds to meet in the middle. Mean value coordinates (Floater, Mean value coordinates, 2003; for any polygon
//! Hormann and Floater, 2006) are smooth and near enough to it, and so are computed at the points of a lattice many
//! times coarser only; what is left are waves shorter than that, which few sweeps smooth out.

use glam::DVec2;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::error::Result;
use crate::lattice::axial::Axial;
use crate::path::placement::Laid;
use crate::progress::Progress;

/// Steps of the loop to one step of the coarse lattice.
const COARSER: usize = 96;

/// Coarse points, and others, between two questions whether to go on.
const ASK_EVERY: (usize, usize) = (1 << 7, 1 << 14);

/// Steps between coarse points for a loop of `n`.
pub(in crate::fill) fn step(n: usize) -> i32 {
    (n / COARSER).max(2) as i32
}

/// Values at `inner` points from those at the vertices of the polygon `outline`.
pub(in crate::fill) fn spread<G: Laid>(
    outline: &[Axial],
    values: &[DVec2],
    inner: &[Axial],
    progress: Progress<'_>,
) -> Result<Vec<DVec2>> {
    let step = step(outline.len());
    let cell = |p: Axial| {
        (Axial::new(p.q.div_euclid(step), p.r.div_euclid(step)), p.q.rem_euclid(step), p.r.rem_euclid(step))
    };
    let mut cells: Vec<Axial> = vec![];
    for part in inner.chunks(ASK_EVERY.1) {
        progress.report(0.0)?;
        cells.extend(part.iter().map(|&p| cell(p).0));
        // They come row by row.
        cells.dedup();
    }
    cells.sort_unstable();
    cells.dedup();
    let around = [Axial::new(0, 0), Axial::new(1, 0), Axial::new(0, 1), Axial::new(1, 1)];
    let mut coarse: Vec<Axial> = cells.iter().flat_map(|&c| around.map(|d| c + d)).collect();
    coarse.sort_unstable();
    coarse.dedup();
    let polygon: Vec<DVec2> = outline.iter().map(|&p| G::units(p)).collect();
    let at = |c: &Axial| (*c, mean_value(&polygon, values, G::units(Axial::new(c.q * step, c.r * step))));
    let mut known: FxHashMap<Axial, DVec2> = FxHashMap::default();
    for part in coarse.chunks(ASK_EVERY.0) {
        progress.report(0.0)?;
        known.par_extend(part.par_iter().map(at));
    }
    let corners: FxHashMap<Axial, [DVec2; 4]> =
        cells.into_iter().map(|c| (c, around.map(|d| known[&(c + d)]))).collect();
    let value = |&p: &Axial| {
        let (c, q, r) = cell(p);
        let [a, b, c, d] = corners[&c];
        let (u, v) = (f64::from(q) / f64::from(step), f64::from(r) / f64::from(step));
        if u + v <= 1.0 {
            a + (b - a) * u + (c - a) * v
        } else {
            d + (c - d) * (1.0 - u) + (b - d) * (1.0 - v)
        }
    };
    let mut found = Vec::with_capacity(inner.len());
    for part in inner.chunks(ASK_EVERY.1) {
        progress.report(0.0)?;
        found.extend(part.iter().map(value));
    }
    Ok(found)
}

fn mean_value(polygon: &[DVec2], values: &[DVec2], x: DVec2) -> DVec2 {
    let n = polygon.len();
    let (mut sum, mut whole) = (DVec2::ZERO, 0.0);
    let mut a = polygon[n - 1] - x;
    let mut length = a.length();
    let mut last = n - 1;
    for k in 0..n {
        let b = polygon[k] - x;
        let far = b.length();
        if far < 1e-9 {
            return values[k];
        }
        let half = a.perp_dot(b) / (length * far + a.dot(b));
        if half.is_finite() {
            let (before, after) = (half / length, half / far);
            sum += values[last] * before + values[k] * after;
            whole += before + after;
        }
        (a, length, last) = (b, far, k);
    }
    sum / whole
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::error::Error;
    use crate::lattice::assemble::assemble;
    use crate::lattice::dir::Dir;
    use crate::lattice::grid::Triangular;
    use crate::path::placement::Lattice;

    /// An L of this size; its coarse points lie inside and outside.
    fn bent(size: usize) -> Vec<Axial> {
        let mut at = Axial::default();
        let mut path = vec![];
        for (dir, steps) in [(0, 3), (2, 1), (3, 2), (2, 2), (3, 1), (5, 3)] {
            for _ in 0..steps * size {
                path.push(at);
                at = at + Dir::ALL[dir];
            }
        }
        assert_eq!(at, Axial::default());
        path
    }

    #[test]
    fn linear_functions_are_kept() {
        let path = bent(40);
        let patch = assemble(std::slice::from_ref(&path));
        let (outline, inner) = patch.points.split_at(path.len());
        let linear = |p: Axial| {
            let x = Lattice::units(p);
            DVec2::new(2.0 * x.x - x.y + 3.0, 0.5 * x.y)
        };
        let values: Vec<DVec2> = outline.iter().map(|&p| linear(p)).collect();
        for (&p, value) in
            inner.iter().zip(spread::<Triangular>(outline, &values, inner, Progress::NONE).unwrap())
        {
            assert!(value.distance(linear(p)) < 1e-7, "{p:?}: {value} is not {}", linear(p));
        }
    }

    #[test]
    fn large_patches_ask_whether_to_go_on() {
        let path = bent(120);
        let patch = assemble(std::slice::from_ref(&path));
        let (outline, inner) = patch.points.split_at(path.len());
        let values = vec![DVec2::ZERO; outline.len()];
        let asked = AtomicUsize::new(0);
        let most = AtomicUsize::new(usize::MAX);
        let go_on = |_: f64| asked.fetch_add(1, Ordering::Relaxed) < most.load(Ordering::Relaxed);
        spread::<Triangular>(outline, &values, inner, Progress::new(&go_on)).unwrap();
        let all = asked.swap(0, Ordering::Relaxed);
        assert!(all > 2 * inner.len() / ASK_EVERY.1, "{all}");
        // Wherever the answer is no, it ends there.
        for k in 0..all {
            asked.store(0, Ordering::Relaxed);
            most.store(k, Ordering::Relaxed);
            assert_eq!(
                spread::<Triangular>(outline, &values, inner, Progress::new(&go_on)),
                Err(Error::Cancelled)
            );
            assert_eq!(asked.load(Ordering::Relaxed), k + 1);
        }
    }

    #[test]
    fn what_has_no_short_waves_is_nearly_harmonic() {
        let path = bent(40);
        let patch = assemble(std::slice::from_ref(&path));
        let (outline, inner) = patch.points.split_at(path.len());
        // The real part of the square of a complex number.
        let harmonic = |p: Axial| {
            let x = Lattice::units(p) / 40.0;
            DVec2::new(x.x * x.x - x.y * x.y, 0.0)
        };
        let values: Vec<DVec2> = outline.iter().map(|&p| harmonic(p)).collect();
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v.x), b.max(v.x)));
        for (&p, value) in
            inner.iter().zip(spread::<Triangular>(outline, &values, inner, Progress::NONE).unwrap())
        {
            assert!((value.x - harmonic(p).x).abs() < 0.1 * (high - low), "{p:?}: {value}");
        }
    }
}
