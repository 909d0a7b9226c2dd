//! Positions and data of the new vertices.

use glam::{DVec2, DVec3};

use super::fair::{Bending, Membrane};
use super::patchwork::Patchwork;
use super::sweep::sweep;
use super::{Shape, Smooth};
use crate::error::{Error, Result};

pub(super) fn env(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|x| x.parse().ok()).unwrap_or(default)
}

impl Shape {
    /// Positions of all vertices of the patchwork for a mesh with vertices at `mesh`, and the number of
    /// fallbacks.
    pub(super) fn solve(&self, mesh: &[DVec3]) -> Result<(Vec<DVec3>, usize)> {
        let work = &self.work;
        let mut positions = vec![DVec3::ZERO; work.len()];
        for (k, &v) in self.loop_.iter().enumerate() {
            positions[k] = mesh[v as usize];
        }
        for (k, &v) in work.outer.iter().enumerate() {
            positions[work.end + k] = mesh[v as usize];
        }
        if work.inner().is_empty() {
            return Ok((positions, 0));
        }
        let weights = work.cotangents(&self.laid_out());
        let membrane = Membrane::new(work)?;
        let film = membrane.harmonic(&weights, |v| positions[v].to_array())?;
        for (v, p) in work.inner().zip(film) {
            positions[v] = p.into();
        }
        if self.smooth == Smooth::Flat {
            return Ok((positions, 0));
        }
        let bending = Bending::new(work)?;
        let method = env("M", 0.0) as i32;
        if method == 0 {
            let uniform = vec![1.0; work.near.len()];
            let masses = (0..work.len()).map(|_| 1.0).collect::<Vec<_>>();
            bending.positions(&mut positions, &uniform, &masses)?;
        } else {
            let rounds = env("INIT", 1.0) as i32;
            for _ in 0..rounds {
                let weights = work.cotangents(&positions);
                let masses = work.areas(&positions);
                bending.positions(&mut positions, &weights, &masses)?;
            }
        }
        for _ in 0..env("ROUNDS", 0.0) as i32 {
            for _ in 0..env("SWEEPS", 2.0) as i32 {
                sweep(work, &mut positions);
            }
            let tgt = env("TGT", 0.0) as i32;
            let target = if tgt > 0 { Some(target(work, &membrane, &positions, tgt)?) } else { None };
            let e = bending.normal_step(&mut positions, env("WS", 0.0), target.as_deref())?;
            if std::env::var("DBG").is_ok() { eprintln!("{e:?} folds {}", folds(work, &positions)); }
        }
        for _ in 0..env("END", 0.0) as i32 { sweep(work, &mut positions); }
        Ok((positions, 0))
    }

    /// The patch as it lies in the plane; vertices around it at the origin.
    fn laid_out(&self) -> Vec<DVec3> {
        let mut flat = self.flat.iter().map(|p: &DVec2| p.extend(0.0)).collect::<Vec<_>>();
        flat.resize(self.work.len(), DVec3::ZERO);
        flat
    }

    /// See [`super::Fill::extend`].
    pub(super) fn extend(&self, values: &[f64], columns: usize) -> Result<Vec<f64>> {
        const TOGETHER: usize = 8;
        /// Weights are limited to this from below: all positive, no value leaves the range of the loop's.
        const LEAST_WEIGHT: f64 = 1e-3;
        let work = &self.work;
        if values.len() != work.n * columns {
            return Err(Error::InvalidOption {
                name: "values",
                value: format!("of length {}", values.len()),
                allowed: "one row for each vertex of the loop",
            });
        }
        if let Some(k) = values.iter().position(|x| !x.is_finite()) {
            return Err(Error::NotFinite { what: "values".into(), point: k / columns });
        }
        let row = |v: usize| if self.reversed { work.n - 1 - v } else { v };
        let inner = work.inner().len();
        let mut all = vec![0.0; inner * columns];
        if all.is_empty() {
            return Ok(all);
        }
        let weights = work.cotangents(&self.positions).into_iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
        let membrane = Membrane::new(work)?;
        for first in (0..columns).step_by(TOGETHER) {
            let part = first..columns.min(first + TOGETHER);
            let found = membrane.harmonic::<TOGETHER>(&weights, |v| {
                std::array::from_fn(|c| {
                    if first + c < part.end { values[row(v) * columns + first + c] } else { 0.0 }
                })
            })?;
            for column in part {
                let own = values.iter().skip(column).step_by(columns);
                let (low, high) =
                    own.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
                for (k, x) in found.iter().enumerate() {
                    all[k * columns + column] = x[column - first].clamp(low, high);
                }
            }
        }
        Ok(all)
    }
}

fn target(work: &Patchwork, membrane: &Membrane<'_>, positions: &[DVec3], kind: i32) -> Result<Vec<f64>> {
    let weights = work.cotangents(positions);
    let areas = work.areas(positions);
    let normals = work.normals(positions);
    let mut h = (0..work.len()).map(|v| {
        let l: DVec3 = work.range(v).map(|s| weights[s] * (positions[work.near[s] as usize] - positions[v])).sum();
        if work.closed[v] { normals[v].dot(l) / areas[v] } else { 0.0 }
    }).collect::<Vec<_>>();
    if kind >= 2 {
        let old = h.clone();
        for v in 0..work.n {
            let near = work.near[work.range(v)].iter().filter(|&&u| u as usize >= work.end && work.closed[u as usize]);
            let (mut s, mut c) = (0.0, 0.0);
            for &u in near { s += old[u as usize] * areas[u as usize]; c += areas[u as usize]; }
            if c > 0.0 { h[v] = s / c; }
        }
    }
    for _ in 0..env("AVG", 2.0) as i32 {
        let old = h.clone();
        for v in 0..work.n { h[v] = 0.5 * old[v] + 0.25 * (old[(v + 1) % work.n] + old[(v + work.n - 1) % work.n]); }
    }
    let damp = env("HD", 1.0);
    let w = weights.iter().map(|w| w.max(1e-3)).collect::<Vec<_>>();
    let x = membrane.harmonic(&w, |v| [h[v]])?;
    for (v, [x]) in work.inner().zip(x) { h[v] = x; }
    for x in &mut h { *x *= damp; }
    Ok(h)
}

/// Inner edges of a patch whose triangles are more than 120 degrees apart.
pub(super) fn folds(work: &Patchwork, positions: &[DVec3]) -> usize {
    let own = &work.triangles[..work.n_patch];
    let angles = crate::metrics::face_angles(positions, own);
    angles.iter().filter(|(_, angle)| *angle > 120f64.to_radians()).count()
}
