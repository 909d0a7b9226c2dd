//! Placement of a lattice patch on the drawn curve.
//!
//! The boundary vertices go onto the curve, the rings behind them follow, and the deep interior
//! stays equilateral to the last bit. Smoothing alone inverts triangles on a quarter of real
//! drawings; here an energy that is infinite at area zero is minimised one vertex at a time, by
//! Newton steps with exact derivatives, and the boundary vertices slide along the curve.
//!
//! Stages: even spacing along the curve; harmonic extension of the boundary's displacement;
//! a regularised energy around inverted triangles until there is none; a barrier energy to the
//! fourth power, in which the worse triangles count; its sixteenth power around the worst; corners
//! that starve a triangle let go; exact check. Where triangles stay inverted, boundary vertices are
//! spaced evenly around them, more rings may move, and corners next to them are released.
//! Everything is in lattice units and visits vertices in the order of their numbers: the same input
//! gives the same bits.
//!
//! The regularised energy is that of Garanzha, Kaporin, Kudryavtseva, Protais, Ray and Sokolov,
//! Foldover-free maps in 50 lines of code, 2021. The paper (section IV-C) only smooths.

mod band;
pub mod check;
mod contour;
mod corners;
mod energy;
mod quads;
mod slide;
mod stages;
mod sweep;

use glam::DVec2;

pub use check::first_inverted;
pub use contour::{Contour, Rim};
pub use corners::settle_corners;

use crate::error::{Error, Result};
use crate::progress::Progress;
pub use band::{Band, Stars};
use slide::Slide;
use sweep::Motion;

/// How to place a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxOptions {
    /// Rings of interior vertices behind the boundary that may move; more do if triangles would
    /// stay inverted otherwise.
    pub rings: usize,
    /// Whether boundary vertices slide along their contours.
    pub slide: bool,
    /// Whether they are drawn towards the middle of their neighbours before anything else.
    pub even_out: bool,
    /// Sliding by d edges costs this times d squared; the energy of a triangle is one or more.
    pub stiffness: f64,
    /// Vertices that move by less than this (edges) in a sweep are done.
    pub tolerance: f64,
    /// Pinned vertices are let go where a triangle has less than this angle, in radians, even if the corner that
    /// they are pinned to is so sharp that no triangulation has a larger one. None: then they stay.
    pub blunt: Option<f64>,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions { rings: 3, slide: true, even_out: true, stiffness: 0.25, tolerance: 0.03, blunt: None }
    }
}

/// What the placement did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RelaxReport {
    /// A triangle that is still inverted; `None` if the placement is valid.
    pub inverted: Option<usize>,
    /// Pinned vertices that were let go, in order.
    pub released: Vec<u32>,
    /// Least angle of a triangle, in radians.
    pub min_angle: f64,
    /// Rings that were allowed to move in the end.
    pub rings: usize,
    /// Sweeps spent on inverted triangles.
    pub untangling: usize,
    /// Sweeps spent on the shape of the triangles.
    pub sweeps: usize,
}

/// Places the vertices of a lattice patch: the boundary on its contours, the interior so that no
/// triangle is inverted.
///
/// * `triangles`: counter-clockwise; interior vertices are surrounded by one fan of triangles,
///   boundary vertices have one open fan, and no interior edge joins two boundary vertices.
/// * `positions`: lattice units; in: the lattice positions; out: the placed ones. Boundary
///   vertices come first, rim by rim.
/// * `rims`: where each contour's vertices are mapped to; out: where they are. A vertex whose
///   `pinned` is false in the end has been released (see [`RelaxReport::released`]).
///
/// If [`RelaxReport::inverted`] is `None`, every triangle is counter-clockwise by the exact
/// predicate, as it stands and rounded to `f32` around the lattice origin; each boundary vertex is
/// at `contour.point_at(s)`, bit for bit the drawn corner for pinned ones; vertices beyond
/// `rings` rings have not moved. Otherwise nothing is guaranteed: the caller must choose another
/// boundary. Time: about half a microsecond per triangle at 2000 triangles, less beyond.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::InvalidOption`] if `rims` or `triangles` are not as described.
/// Nothing is changed then.
pub fn relax(
    triangles: &[[u32; 3]],
    positions: &mut [DVec2],
    contours: &[Contour<'_>],
    rims: &mut [Rim],
    options: &RelaxOptions,
    progress: Progress<'_>,
) -> Result<RelaxReport> {
    let mut relaxation = Relaxation::<3>::new(triangles, positions, contours, rims, options)?;
    relaxation.run(progress)?;
    positions.copy_from_slice(&relaxation.positions);
    relaxation.store(rims);
    Ok(relaxation.report())
}

/// A placement that can be continued: see [`relax`], which makes one and runs it.
#[derive(Debug)]
pub struct Relaxation<'a, const N: usize = 3> {
    cells: &'a [[u32; N]],
    options: RelaxOptions,
    motion: Motion<'a, N>,
    rings: usize,
    /// What was done so far, not judged.
    done: RelaxReport,
    /// Where the vertices are, in lattice units.
    pub positions: Vec<DVec2>,
}

impl<'a, const N: usize> Relaxation<'a, N>
where
    Band<N>: Stars,
{
    /// Prepares the placement of a patch; nothing is moved yet.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if `rims` or `triangles` are not as described at [`relax`].
    pub fn new(
        cells: &'a [[u32; N]],
        lattice_positions: &[DVec2],
        contours: &'a [Contour<'a>],
        rims: &[Rim],
        options: &RelaxOptions,
    ) -> Result<Self> {
        check_rims(lattice_positions.len(), contours, rims)?;
        let mut slide = Slide::new(contours, rims);
        if options.slide && options.even_out {
            slide.even_out();
        }
        let band = movable(cells, lattice_positions, slide.len(), options.rings)?;
        let motion = Motion { band, slide, sliding: options.slide, stiffness: options.stiffness };
        let positions = lattice_positions.to_vec();
        let done = RelaxReport::default();
        Ok(Relaxation { cells, options: options.clone(), motion, rings: options.rings, done, positions })
    }

    /// Places all vertices, from the lattice on.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn run(&mut self, progress: Progress<'_>) -> Result<()> {
        self.motion.place_boundary(3);
        let tolerance = self.options.tolerance;
        if self.ladder(progress.part(0.0, 0.4))? {
            self.done.sweeps += self.motion.improve(tolerance, progress.part(0.4, 0.8))?;
            self.finish(&[], progress.part(0.8, 1.0))?;
        }
        self.write();
        Ok(())
    }

    /// Holds boundary vertices, given by number and arc position between their neighbours', and
    /// places what lies around them anew; the rest stays.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn hold(&mut self, vertices: &[(usize, f64)], progress: Progress<'_>) -> Result<()> {
        const REACH: usize = 3;
        for &(v, s) in vertices {
            self.motion.slide.hold(v, s);
        }
        if self.motion.sliding {
            for &(v, _) in vertices {
                self.motion.slide.spread(v, REACH);
            }
        }
        self.motion.place_boundary(3);
        let around: Vec<u32> = vertices.iter().map(|&(v, _)| v as u32).collect();
        self.settle_around(&around, progress)
    }

    /// Places what lies around some vertices of the boundary, which are where they are to begin; the rest stays.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn settle_around(&mut self, around: &[u32], progress: Progress<'_>) -> Result<()> {
        if self.ladder(progress.part(0.0, 0.4))? {
            self.done.sweeps += self.motion.mend(around, self.options.tolerance, progress.part(0.4, 0.8))?;
            self.finish(around, progress.part(0.8, 1.0))?;
        }
        self.write();
        Ok(())
    }

    /// Copies arc positions and pins back.
    pub fn store(&self, rims: &mut [Rim]) {
        self.motion.slide.store(rims);
    }

    /// What was done, and whether the placement is valid. Linear.
    pub fn report(&self) -> RelaxReport {
        let mut report = self.done.clone();
        report.released.sort_unstable();
        report.rings = self.rings;
        report.min_angle = self.motion.least_angle();
        // The rest of the patch is the lattice itself, whose triangles are as they should be.
        let inverted = first_inverted(&self.motion.band.positions, &self.motion.band.triangles, DVec2::ZERO);
        if inverted.is_some() {
            report.inverted = first_inverted(&self.positions, &Band::<N>::corners(self.cells), DVec2::ZERO);
        }
        report
    }

    /// `around` is empty for the whole patch.
    fn finish(&mut self, around: &[u32], progress: Progress<'_>) -> Result<()> {
        let tolerance = self.options.tolerance;
        self.done.sweeps += self.motion.sharpen(around, tolerance, progress.part(0.0, 0.5))?;
        self.done.released.extend(self.motion.release_starved(
            self.options.blunt,
            tolerance,
            progress.part(0.5, 1.0),
        )?);
        Ok(())
    }

    /// Untangles with ever stronger means; false if triangles stay inverted.
    fn ladder(&mut self, progress: Progress<'_>) -> Result<bool> {
        struct Step {
            spread: usize,
            release: bool,
            rings: usize,
            sweeps: usize,
        }
        let first = self.options.rings;
        let steps = [
            Step { spread: 0, release: false, rings: first, sweeps: 25 },
            Step { spread: 3, release: false, rings: first, sweeps: 25 },
            Step { spread: 2, release: true, rings: 2 * first, sweeps: 40 },
            Step { spread: 5, release: true, rings: 4 * first, sweeps: 40 },
            Step { spread: 8, release: true, rings: usize::MAX, sweeps: 80 },
        ];
        let n = steps.len() as f64;
        for (i, step) in steps.iter().enumerate() {
            if step.rings > self.rings {
                self.write();
                self.motion.band = movable(self.cells, &self.positions, self.motion.band.n_rim, step.rings)?;
                self.rings = step.rings;
            }
            if self.motion.sliding && step.spread > 0 {
                self.done.released.extend(self.motion.spread_tangled(step.spread, step.release));
            }
            let part = progress.part(i as f64 / n, (i + 1) as f64 / n);
            if self.motion.untangle(step.sweeps, &mut self.done.untangling, part)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn write(&mut self) {
        for (&v, &x) in self.motion.band.global.iter().zip(&self.motion.band.positions) {
            self.positions[v as usize] = x;
        }
    }
}

fn movable<const N: usize>(
    cells: &[[u32; N]],
    positions: &[DVec2],
    n_rim: usize,
    rings: usize,
) -> Result<Band<N>>
where
    Band<N>: Stars,
{
    Band::new(cells, positions, n_rim, rings).map_err(|vertex| Error::InvalidOption {
        name: "triangles",
        value: format!("not a patch at vertex {vertex}"),
        allowed: "one counter-clockwise fan of triangles around each vertex",
    })
}

fn check_rims(n_vertices: usize, contours: &[Contour<'_>], rims: &[Rim]) -> Result<()> {
    let mut start = 0;
    let mut fit = contours.len() == rims.len();
    for (rim, contour) in rims.iter().zip(contours) {
        let n = rim.s.len();
        fit &= rim.start == start && rim.pinned.len() == n && rim.held.len() == n && n >= 3;
        fit &= contour.points.len() >= 3 && contour.arc.len() == contour.points.len() + 1;
        fit &= rim.s.windows(2).all(|s| s[0] < s[1]);
        fit &= n > 0 && rim.s[n - 1] < rim.s[0] + contour.length();
        start += n;
    }
    if fit && start <= n_vertices {
        return Ok(());
    }
    Err(Error::InvalidOption {
        name: "rims",
        value: format!("{} rims with {start} vertices", rims.len()),
        allowed: "one rim for each contour, numbered in a row, with increasing arc positions",
    })
}
