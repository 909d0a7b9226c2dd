//! Placement of a lattice patch on the drawn curve.
//!
//! The boundary vertices go onto the curve, the rings behind them follow, and the deep interior
//! stays equilateral to the last bit. Smoothing alone inverts triangles on a quarter of real
//! drawings; here an energy that is infinite at area zero is minimised one vertex at a time, by
//! Newton steps with exact derivatives, and the boundary vertices slide along the curve.
//!
//! Stages: even spacing along the curve; harmonic extension of the boundary's displacement;
//! a regularised energy around inverted triangles until there is none; the barrier energy; its
//! fourth power, in which the worse triangles count; its sixteenth power around the worst; corners
//! that starve a triangle let go; exact check. Where triangles stay inverted, boundary vertices are spaced evenly around them, more
//! rings may move, and corners next to them are released. Everything is in lattice units and
//! visits vertices in the order of their numbers: the same input gives the same bits.
//!
//! The regularised energy is that of Garanzha, Kaporin, Kudryavtseva, Protais, Ray and Sokolov,
//! Foldover-free maps in 50 lines of code, 2021. The paper (section IV-C) only smooths.

mod band;
pub mod check;
mod contour;
mod corners;
mod energy;
mod slide;
mod stages;
mod sweep;

use glam::DVec2;

pub use check::first_inverted;
pub use contour::{Contour, Rim};
pub use corners::settle_corners;

use crate::error::{Error, Result};
use crate::progress::Progress;
use band::Band;
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
    /// Sliding by d edges costs this times d squared; the energy of a triangle is 3 or more.
    pub stiffness: f64,
    /// Vertices that move by less than this (edges) in a sweep are done.
    pub tolerance: f64,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions { rings: 3, slide: true, stiffness: 0.25, tolerance: 0.015 }
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
    check_rims(positions.len(), contours, rims)?;
    let mut slide = Slide::new(contours, rims);
    if options.slide {
        slide.even_out();
    }
    let band = movable(triangles, positions, slide.len(), options.rings)?;
    let mut motion = Motion { band, slide, sliding: options.slide, stiffness: options.stiffness };
    motion.place_boundary(3);
    let mut report = RelaxReport { rings: options.rings, ..RelaxReport::default() };
    let valid = ladder(triangles, positions, &mut motion, &mut report, progress.part(0.0, 0.4))?;
    if valid {
        report.sweeps += motion.improve(options.tolerance, progress.part(0.4, 0.8))?;
        report.sweeps += motion.sharpen(options.tolerance, progress.part(0.8, 0.9))?;
        report.released.extend(motion.release_starved(options.tolerance, progress.part(0.9, 1.0))?);
        report.released.sort_unstable();
    }
    report.min_angle = motion.least_angle();
    // The rest of the patch is the lattice itself, whose triangles are as they should be.
    let inverted = first_inverted(&motion.band.positions, &motion.band.triangles, DVec2::ZERO);
    store(&motion, positions);
    motion.slide.store(rims);
    if inverted.is_some() {
        report.inverted = first_inverted(positions, triangles, DVec2::ZERO);
    }
    Ok(report)
}

/// Untangles with ever stronger means; false if triangles stay inverted.
fn ladder(
    triangles: &[[u32; 3]],
    positions: &mut [DVec2],
    motion: &mut Motion<'_>,
    report: &mut RelaxReport,
    progress: Progress<'_>,
) -> Result<bool> {
    struct Step {
        spread: usize,
        release: bool,
        rings: usize,
        sweeps: usize,
    }
    let first = report.rings;
    let steps = [
        Step { spread: 0, release: false, rings: first, sweeps: 25 },
        Step { spread: 3, release: false, rings: first, sweeps: 25 },
        Step { spread: 2, release: true, rings: 2 * first, sweeps: 40 },
        Step { spread: 5, release: true, rings: 4 * first, sweeps: 40 },
        Step { spread: 8, release: true, rings: usize::MAX, sweeps: 80 },
    ];
    let n = steps.len() as f64;
    for (i, step) in steps.iter().enumerate() {
        if step.rings > report.rings {
            store(motion, positions);
            motion.band = movable(triangles, positions, motion.band.n_rim, step.rings)?;
            report.rings = step.rings;
        }
        if motion.sliding && step.spread > 0 {
            report.released.extend(motion.spread_tangled(step.spread, step.release));
        }
        let part = progress.part(i as f64 / n, (i + 1) as f64 / n);
        if motion.untangle(step.sweeps, &mut report.untangling, part)? {
            return Ok(true);
        }
    }
    Ok(false)
}

fn movable(triangles: &[[u32; 3]], positions: &[DVec2], n_rim: usize, rings: usize) -> Result<Band> {
    Band::new(triangles, positions, n_rim, rings).map_err(|vertex| Error::InvalidOption {
        name: "triangles",
        value: format!("not a patch at vertex {vertex}"),
        allowed: "one counter-clockwise fan of triangles around each vertex",
    })
}

fn store(motion: &Motion<'_>, positions: &mut [DVec2]) {
    for (&v, &x) in motion.band.global.iter().zip(&motion.band.positions) {
        positions[v as usize] = x;
    }
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
