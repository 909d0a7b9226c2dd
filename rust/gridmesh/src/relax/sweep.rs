//! Gauss-Seidel sweeps: one vertex at a time to a lower energy, on the boundary along the curve.

use glam::DVec2;

use super::band::{Band, Stars};
use super::energy::Energy;
use super::slide::Slide;
use crate::error::Result;
use crate::progress::Progress;

/// What is moved, and how.
#[derive(Debug)]
pub(super) struct Motion<'a, const N: usize> {
    pub band: Band<N>,
    pub slide: Slide<'a>,
    /// Boundary vertices slide (the pinned ones never).
    pub sliding: bool,
    /// Sliding by d edges costs this times d squared.
    pub stiffness: f64,
}

/// Vertices that are worth a visit.
#[derive(Clone)]
pub(super) struct Active(Vec<bool>);

impl Active {
    pub fn all(n: usize) -> Active {
        Active(vec![true; n])
    }

    pub fn none(n: usize) -> Active {
        Active(vec![false; n])
    }

    pub fn mark(&mut self, vertex: u32) {
        if let Some(active) = self.0.get_mut(vertex as usize) {
            *active = true;
        }
    }

    /// The active vertices, ascending.
    pub fn iter(&self) -> impl Iterator<Item = u32> {
        (0..).zip(&self.0).filter(|(_, active)| **active).map(|(v, _)| v)
    }

    pub fn has(&self, vertex: u32) -> bool {
        self.0.get(vertex as usize) == Some(&true)
    }

    /// The vertices of a list and `rings` rings of neighbours around them.
    pub fn near<const N: usize>(
        band: &Band<N>,
        vertices: impl IntoIterator<Item = u32>,
        rings: usize,
    ) -> Active {
        let mut active = Active::none(band.n_free);
        let mut front: Vec<u32> = vertices.into_iter().collect();
        for ring in 0..=rings {
            let mut next = Vec::new();
            for v in front {
                if (v as usize) < band.n_free && !active.0[v as usize] {
                    active.0[v as usize] = true;
                    if ring < rings {
                        next.extend_from_slice(band.around(v as usize));
                    }
                }
            }
            front = next;
        }
        active
    }
}

impl<const N: usize> Motion<'_, N>
where
    Band<N>: Stars,
{
    /// Moves every active vertex once. Returns the number of vertices that moved by more than
    /// `tolerance`; they and their neighbours are active afterwards.
    ///
    /// # Errors
    /// Only if cancelled: asked every few thousand vertices.
    pub fn sweep<E: Energy>(
        &mut self,
        energy: &E,
        active: &mut Active,
        tolerance: f64,
        progress: Progress<'_>,
    ) -> Result<usize> {
        const EVERY: usize = 1 << 12;
        let mut moved = 0;
        for v in 0..self.band.n_free {
            if v % EVERY == EVERY - 1 {
                progress.report(0.0)?;
            }
            if !std::mem::take(&mut active.0[v]) {
                continue;
            }
            let step = if v >= self.band.n_rim {
                self.move_inside(energy, v)
            } else if !self.sliding || self.slide.pinned[v] {
                0.0
            } else if E::BARRIER {
                self.move_along(energy, v)
            } else {
                self.search_along(energy, v)
            };
            if step > tolerance {
                moved += 1;
                active.mark(v as u32);
                self.band.around(v).iter().for_each(|&w| active.mark(w));
            }
        }
        Ok(moved)
    }

    /// One damped Newton step of an interior vertex; returns its length.
    fn move_inside<E: Energy>(&mut self, energy: &E, v: usize) -> f64 {
        let band = &mut self.band;
        let x = band.positions[v];
        let here = band.local(energy, v, x);
        let mut step = here.model.descent();
        let mut length = step.length();
        if !length.is_finite() || length < 1e-9 {
            return 0.0;
        }
        if length > 0.5 {
            step *= 0.5 / length;
            length = 0.5;
        }
        // A barrier energy is convex in one vertex: far from the barrier and with little to gain
        // the full step is safe. Everywhere else the energy must fall.
        let gain = -here.model.gradient.dot(step);
        let far = length * here.edge.sqrt() < 0.4 * here.det;
        if !(E::BARRIER && far && gain < 0.02 * here.value) {
            let mut tries = 0;
            while band.value(energy, v, x + step) >= here.value {
                tries += 1;
                if tries == 5 {
                    return 0.0;
                }
                step *= 0.4;
                length *= 0.4;
            }
        }
        band.positions[v] = x + step;
        length
    }

    /// One damped Newton step of a boundary vertex along the curve; returns its length.
    fn move_along<E: Energy>(&mut self, energy: &E, v: usize) -> f64 {
        // The direction is taken over a stretch of the curve, since a drawn line trembles.
        const STRETCH: f64 = 0.1;
        let (back, ahead) = self.slide.room(v);
        let (s, home) = (self.slide.s[v], self.slide.home[v]);
        let (band, slide) = (&mut self.band, &mut self.slide);
        let here = band.local(energy, v, band.positions[v]);
        let tangent = (slide.point(v, s + STRETCH) - slide.point(v, s - STRETCH)) * (0.5 / STRETCH);
        let gradient = here.model.gradient.dot(tangent) + 2.0 * self.stiffness * (s - home);
        let curvature = here.model.along(tangent) + 2.0 * self.stiffness;
        let newton = -gradient / curvature;
        let newton = if newton.is_finite() { newton } else { -gradient.signum() };
        let mut step = newton.clamp(-0.3, 0.3).clamp(-back, ahead);
        let now = here.value + self.stiffness * (s - home) * (s - home);
        for _ in 0..4 {
            if step.abs() < 1e-6 {
                return 0.0;
            }
            let moved = s + step;
            let x = slide.point(v, moved);
            let then = band.value(energy, v, x) + self.stiffness * (moved - home) * (moved - home);
            if then < now {
                band.positions[v] = x;
                slide.s[v] = moved;
                return step.abs();
            }
            step *= 0.4;
        }
        0.0
    }

    /// The best of some places of a boundary vertex between its neighbours; returns the distance.
    ///
    /// Along a winding curve the energy has many minima, and the one next to a bunch of vertices
    /// is often inverted.
    fn search_along<E: Energy>(&mut self, energy: &E, v: usize) -> f64 {
        const SAMPLES: u32 = 12;
        let (back, ahead) = self.slide.room(v);
        let (low, high) = (back.min(1.5), ahead.min(1.5));
        let (s, home) = (self.slide.s[v], self.slide.home[v]);
        let (band, slide) = (&mut self.band, &mut self.slide);
        let x = band.positions[v];
        let cost = |x: DVec2, s: f64| band.value(energy, v, x) + self.stiffness * (s - home) * (s - home);
        let mut best = (cost(x, s), x, s);
        for i in 0..=SAMPLES {
            let s = s - low + (low + high) * f64::from(i) / f64::from(SAMPLES);
            let x = slide.point(v, s);
            let c = cost(x, s);
            if c < best.0 {
                best = (c, x, s);
            }
        }
        band.positions[v] = best.1;
        slide.s[v] = best.2;
        (best.2 - s).abs()
    }

    /// Puts the boundary vertices on their contours and moves the rings behind them along, by the
    /// harmonic extension of the displacement (a few sweeps of it).
    pub fn place_boundary(&mut self, sweeps: usize) {
        let (band, slide) = (&mut self.band, &mut self.slide);
        let mut moved: Vec<DVec2> = (0..band.n_rim)
            .map(|v| {
                let s = slide.s[v];
                slide.point(v, s) - band.positions[v]
            })
            .collect();
        moved.resize(band.positions.len(), DVec2::ZERO);
        for _ in 0..sweeps {
            for v in band.n_rim..band.n_free {
                let around = &band.around(v)[1..];
                let sum = around.iter().fold(DVec2::ZERO, |sum, &w| sum + moved[w as usize]);
                moved[v] = sum / around.len() as f64;
            }
        }
        for (v, (x, d)) in band.positions.iter_mut().zip(&moved).enumerate() {
            *x = if v < band.n_rim { slide.point(v, slide.s[v]) } else { *x + *d };
        }
    }
}
