//! The stages of the placement: untangle, even out, help the worst, release corners.

use glam::DVec2;

use super::band::{Band, Stars};
use super::check::first_inverted;
use super::energy::{Energy, Power, Regularised, det};
use super::sweep::{Active, Motion};
use crate::error::Result;
use crate::progress::Progress;

/// Triangles of less than this share of the equilateral triangle's area count as tangled.
const TANGLED: f64 = 1e-3;

/// Triangles that are inverted or nearly so.
#[derive(Default)]
struct Tangled {
    /// Their corners.
    vertices: Vec<u32>,
    /// The least `det` of a triangle, at most 0.
    least: f64,
}

impl Tangled {
    fn look_at<const N: usize>(&mut self, band: &Band<N>, triangle: [u32; 3]) {
        // Seen from its first vertex, so that it is the same from whichever it is looked at.
        let first = (0..3).min_by_key(|&k| triangle[k]).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| band.positions[triangle[(first + k) % 3] as usize]);
        let d = det(b - a, c - a);
        // A NaN is tangled too.
        if !matches!(d.partial_cmp(&TANGLED), Some(std::cmp::Ordering::Greater)) {
            self.vertices.extend(triangle);
        }
        self.least = self.least.min(d);
    }
}

impl<const N: usize> Motion<'_, N>
where
    Band<N>: Stars,
{
    /// The tangled ones of all triangles.
    fn tangled(&self) -> Tangled {
        let mut found = Tangled::default();
        for &t in &self.band.triangles {
            found.look_at(&self.band, t);
        }
        found
    }

    /// The tangled triangles at some vertices.
    fn tangled_at(&self, vertices: &Active) -> Tangled {
        let mut found = Tangled::default();
        for v in vertices.iter() {
            self.band.each_corner(v as usize, |triangle| {
                // Once, from the first of its vertices that is among them.
                if !triangle[1..].iter().any(|&w| w < v && vertices.has(w)) {
                    found.look_at(&self.band, triangle);
                }
            });
        }
        found
    }

    /// Sweeps around the tangled triangles until there is none; false if some stay inverted.
    pub fn untangle(&mut self, sweeps: usize, done: &mut usize, progress: Progress<'_>) -> Result<bool> {
        let mut tangled = self.tangled();
        for sweep in 0..sweeps {
            let Tangled { vertices, least } = tangled;
            if vertices.is_empty() {
                return Ok(true);
            }
            progress.report(sweep as f64 / sweeps as f64)?;
            *done += 1;
            let eps = (0.04 + least * least).sqrt();
            let rings = if sweep < 8 { 1 } else { 2 };
            let moved = Active::near(&self.band, vertices, rings);
            self.sweep(&Regularised { eps }, &mut moved.clone(), f64::INFINITY, progress)?;
            // Nothing else has changed, and the tangled triangles are among these.
            tangled = self.tangled_at(&moved);
        }
        // Where the drawing is thinner than a thousandth of an edge, thin triangles are right.
        Ok(first_inverted(&self.band.positions, &self.band.triangles, DVec2::ZERO).is_none())
    }

    /// Spaces boundary vertices evenly around those of tangled triangles, which is where projected
    /// vertices bunch; with `release`, those that are pinned become free first. Returns the
    /// vertices released.
    pub fn spread_tangled(&mut self, reach: usize, release: bool) -> Vec<u32> {
        let Tangled { vertices, .. } = self.tangled();
        let n_rim = self.band.n_rim as u32;
        let mut rim: Vec<u32> = vertices
            .into_iter()
            .flat_map(|v| {
                let around: &[u32] =
                    if (v as usize) < self.band.n_free { self.band.around(v as usize) } else { &[] };
                around.iter().copied().chain([v]).collect::<Vec<_>>()
            })
            .filter(|&v| v < n_rim)
            .collect();
        rim.sort_unstable();
        rim.dedup();
        let mut released = Vec::new();
        if release {
            for &v in &rim {
                if std::mem::take(&mut self.slide.pinned[v as usize]) {
                    released.push(v);
                }
            }
        }
        for v in rim {
            for moved in self.slide.spread(v as usize, reach) {
                let s = self.slide.s[moved];
                self.band.positions[moved] = self.slide.point(moved, s);
            }
        }
        released
    }

    /// Sweeps with a barrier energy until nothing moves by more than `tolerance`.
    pub fn settle<E: Energy>(
        &mut self,
        energy: &E,
        active: &mut Active,
        sweeps: usize,
        tolerance: f64,
        progress: Progress<'_>,
    ) -> Result<usize> {
        for sweep in 0..sweeps {
            progress.report(sweep as f64 / sweeps as f64)?;
            if self.sweep(energy, active, tolerance, progress)? == 0 {
                return Ok(sweep + 1);
            }
        }
        Ok(sweeps)
    }

    /// Moves every vertex to where its triangles are best, the worse ones counting more.
    pub fn improve(&mut self, tolerance: f64, progress: Progress<'_>) -> Result<usize> {
        let all = &mut Active::all(self.band.n_free);
        self.settle(&Power::<2>, all, 8, tolerance, progress)
    }

    /// Lets the surroundings of some boundary vertices settle.
    pub fn mend(&mut self, vertices: &[u32], tolerance: f64, progress: Progress<'_>) -> Result<usize> {
        let active = &mut Active::near(&self.band, vertices.iter().copied(), 2);
        self.settle(&Power::<2>, active, 12, tolerance, progress)
    }

    /// Gives the worst triangles and their neighbours the say: of all, or of those around some
    /// vertices. What is worst is measured away from pinned vertices, at which the drawing rules.
    pub fn sharpen(&mut self, around: &[u32], tolerance: f64, progress: Progress<'_>) -> Result<usize> {
        const MARGIN: f64 = 6.0;
        const RINGS: usize = 4;
        let (most, cornered) = (cotangent(45.0), cotangent(30.0));
        let near = Active::near(&self.band, around.iter().copied(), RINGS);
        let counts = |t: &&[u32; 3]| around.is_empty() || t.iter().any(|&v| near.has(v));
        let sharpness: Vec<(&[u32; 3], f64, bool)> = self
            .band
            .triangles
            .iter()
            .filter(counts)
            .map(|t| {
                let at_corner = t.iter().any(|&v| self.slide.pinned.get(v as usize) == Some(&true));
                (t, sharpness(t.map(|v| self.band.positions[v as usize])), at_corner)
            })
            .collect();
        let sharpest = sharpness.iter().filter(|s| !s.2).map(|s| s.1).fold(most, f64::max);
        let limit = most.max(cotangent(libm::atan(1.0 / sharpest).to_degrees() + MARGIN));
        let worst: Vec<u32> = sharpness
            .into_iter()
            .filter(|&(_, sharpness, at_corner)| sharpness > if at_corner { cornered } else { limit })
            .flat_map(|(t, ..)| *t)
            .collect();
        let mut active = Active::near(&self.band, worst, 1);
        self.settle(&Power::<4>, &mut active, 6, tolerance, progress)
    }

    /// Frees the pinned vertices at which a triangle starves, and lets their surroundings settle.
    /// Returns the vertices released.
    ///
    /// With interior angle a of the boundary at the vertex, no triangulation there has a least
    /// angle above a / 2, so a triangle starves below .45 a, where 14 degrees are always enough.
    /// With `blunt` it starves below that angle where the corner is sharper than twice that.
    pub fn release_starved(
        &mut self,
        blunt: Option<f64>,
        tolerance: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<u32>> {
        let mut released = Vec::new();
        for _ in 0..4 {
            let starved: Vec<u32> = (0..self.band.n_rim)
                .filter(|&v| self.slide.pinned[v] && !self.slide.held[v] && self.starves(v, blunt))
                .map(|v| v as u32)
                .collect();
            if starved.is_empty() || !self.sliding {
                break;
            }
            for &v in &starved {
                self.slide.pinned[v as usize] = false;
                self.slide.home[v as usize] = self.slide.s[v as usize];
            }
            let mut active = Active::near(&self.band, starved.iter().copied(), 2);
            self.settle(&Power::<2>, &mut active, 10, tolerance, progress)?;
            released.extend(starved);
        }
        released.sort_unstable();
        Ok(released)
    }

    fn starves(&self, v: usize, blunt: Option<f64>) -> bool {
        let x = self.band.positions[v];
        let mut interior = 0.0;
        let mut sharpest = 0.0f64;
        for pair in self.band.own_corners(v) {
            let [a, b] = pair.map(|w| self.band.positions[w as usize]);
            interior += (a - x).angle_to(b - x);
            sharpest = sharpest.max(sharpness([x, a, b]));
        }
        let own = f64::min(14.0, 0.45 * interior.to_degrees());
        // Two triangles at least share a corner of the drawing.
        let least = match blunt {
            Some(blunt) if interior < 2.0 * blunt => own.max(blunt.to_degrees()),
            _ => own,
        };
        sharpest > cotangent(least)
    }

    /// Least angle of the triangles of the band, in radians.
    pub fn least_angle(&self) -> f64 {
        let all = self.band.triangles.iter().map(|t| sharpness(t.map(|v| self.band.positions[v as usize])));
        let equilateral = cotangent(60.0);
        libm::atan2(1.0, all.fold(equilateral, f64::max))
    }
}

/// Cotangent of an angle in degrees.
fn cotangent(degrees: f64) -> f64 {
    1.0 / libm::tan(degrees.to_radians())
}

/// Cotangent of the least angle of a triangle: the greatest of the three.
fn sharpness(p: [DVec2; 3]) -> f64 {
    let [a, b, c] = [p[2] - p[1], p[0] - p[2], p[1] - p[0]];
    let dot = (-a.dot(b)).max(-b.dot(c)).max(-c.dot(a));
    dot / a.perp_dot(b).abs()
}
