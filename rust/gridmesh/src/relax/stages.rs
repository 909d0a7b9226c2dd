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

/// After so many sweeps two rings of vertices around the tangled ones move.
const WIDER: usize = 8;

/// The least regularisation of the energy around tangled triangles, a `det`, at first; after [`WIDER`] sweeps each halves it, down to
/// [`SHARP`]. An energy that stays soft has its minimum where a triangle is hardly inverted, and leaves it there.
const SOFT: f64 = 0.2;
const SHARP: f64 = 0.005;

/// Sweeps of two rings over quads in which neither fewer vertices are tangled nor the worst corner is less so, after which it is
/// given up: they are hardly ever untangled later, and stronger means are at hand.
const STILL: usize = 3;

/// The share of a worst corner's `det` by which it has to grow to be less tangled.
const HARDLY: f64 = 0.05;

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
        let [a, b, c] = triangle;
        let (a, b, c) = if a < b && a < c {
            (a, b, c)
        } else if b < c {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let at = |v: u32| band.positions[v as usize];
        let d = det(at(b) - at(a), at(c) - at(a));
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

    /// Sweeps around the tangled triangles until there is none, or of quads until they do not get fewer; false if some stay
    /// inverted.
    pub fn untangle(&mut self, sweeps: usize, done: &mut usize, progress: Progress<'_>) -> Result<bool> {
        let mut tangled = self.tangled();
        let (mut fewest, mut mildest, mut still) = (usize::MAX, f64::MIN, 0);
        let mut softness = SOFT;
        for sweep in 0..sweeps {
            let Tangled { vertices, least } = tangled;
            if vertices.is_empty() {
                return Ok(true);
            }
            progress.report(sweep as f64 / sweeps as f64)?;
            let is_better = vertices.len() < fewest || least > mildest + HARDLY * mildest.abs();
            still = if is_better || sweep < WIDER { 0 } else { still + 1 };
            (fewest, mildest) = (fewest.min(vertices.len()), mildest.max(least));
            if N == 4 && still == STILL {
                break;
            }
            *done += 1;
            if sweep > WIDER {
                softness = (0.5 * softness).max(SHARP);
            }
            let eps = (softness * softness + least * least).sqrt();
            let rings = if sweep < WIDER { 1 } else { 2 };
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

#[cfg(test)]
mod tests {
    use super::super::{Contour, RelaxOptions, RelaxReport, Relaxation, Rim};
    use super::*;

    /// A square of 4 x 4 quads, its rim mapped to the corners of `outline` and what lies evenly between them.
    fn relaxed(outline: [DVec2; 4]) -> Result<RelaxReport> {
        let ring = (0..4).flat_map(|i| (0..4).map(move |k| (i, k)));
        let place = |(i, k): (usize, usize)| {
            let [x, y] = [[k, 0], [4, k], [4 - k, 4], [0, 4 - k]][i];
            [x, y]
        };
        let inner = (1..4).flat_map(|y| (1..4).map(move |x| [x, y]));
        let grid: Vec<[usize; 2]> = ring.map(place).chain(inner).collect();
        let number =
            |x: usize, y: usize| grid.iter().position(|&p| p == [x, y]).map_or(u32::MAX, |i| i as u32);
        let quad = |x: usize, y: usize| [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| number(x + i, y + j));
        let quads: Vec<[u32; 4]> = (0..16).map(|k| quad(k % 4, k / 4)).collect();
        let positions: Vec<DVec2> = grid.iter().map(|p| DVec2::new(p[0] as f64, p[1] as f64)).collect();
        let mut arc = vec![0.0];
        for (i, p) in outline.iter().enumerate() {
            arc.push(arc[i] + p.distance(outline[(i + 1) % 4]));
        }
        let s = (0..16).map(|i| arc[i / 4] + (arc[i / 4 + 1] - arc[i / 4]) * (i % 4) as f64 / 4.0).collect();
        let pinned = (0..16).map(|i| i % 4 == 0).collect();
        let rim = Rim { start: 0, s, pinned, held: vec![false; 16] };
        let lines = [Contour { points: &outline, arc: &arc }];
        let mut relaxation =
            Relaxation::<4>::new(&quads, &positions, &lines, &[rim], &RelaxOptions::default())?;
        relaxation.run(Progress::NONE)?;
        Ok(relaxation.report())
    }

    #[test]
    fn quads_that_cannot_be_untangled_are_soon_given_up() -> Result<()> {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]].map(DVec2::from_array);
        let report = relaxed(square)?;
        assert_eq!((report.inverted, report.untangling), (None, 0));
        // The other way round every quad is turned over, whatever moves.
        let [a, b, c, d] = square;
        let report = relaxed([a, d, c, b])?;
        assert!(report.inverted.is_some());
        assert!(report.untangling < 100, "{}", report.untangling);
        Ok(())
    }
}
