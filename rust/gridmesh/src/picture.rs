//! From pictures to outlines: the level line of a coverage, as exact as the pixels tell.
//!
//! [`trace_image`] conducts: crossings of the level between neighbouring pixels form closed chains
//! (`levels`, marching squares), each crossing is moved to where the coverage of its column puts the edge
//! (`heights`), tips finer than a pixel (`tips`) and corners are where lines through both sides meet (`corners`), the rest is smoothed within
//! what pixels can tell apart (`smooth`), and moved a little where the centre of a pixel came to lie on the wrong side (`sides`), points that add nothing are dropped (`simplify`), and lines that
//! came to cross go back to their crossings (`apart`). `margin` moves outlines outward, [`paper`] reads
//! drawings on paper, [`decode`] files.

mod apart;
mod corners;
pub mod decode;
mod field;
mod heights;
mod islands;
mod levels;
mod margin;
pub mod paper;
mod sides;
mod simplify;
mod smooth;
mod threshold;
mod tips;
mod widened;

use rayon::prelude::*;

pub use crate::drawing::combine::Part;
use crate::error::{Error, Result, told};
pub use crate::picture::field::{MAX_PIXELS, Picture};
use crate::picture::islands::Island;
use crate::picture::levels::Crossing;
use crate::picture::tips::Tip;
use crate::progress::{Progress, Rising};

/// Where the outline runs between nothing (0) and full coverage (1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Threshold {
    /// At this value, between 0 and 1.
    At(f64),
    /// At the value that parts the pixels best into two groups (Otsu 1979).
    Auto,
}

/// Thresholds this near to a half follow the edges that were drawn.
const HALF: f64 = 0.05;

/// Options of [`trace_image`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// The level that outlines follow.
    pub threshold: Threshold,
    /// Smoothing, 0 to 10: 1 removes what pixels put in, larger values look farther along the outline, 0
    /// leaves the level line of the pixels' centres as it is.
    pub smooth: f64,
    /// Islands and holes of a smaller area, in square pixels, are left out.
    pub min_area: f64,
    /// How far outlines are moved outward, in pixels, 0 to 1000.
    pub margin: f64,
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self { threshold: Threshold::At(0.5), smooth: 1.0, min_area: 16.0, margin: 0.0 }
    }
}

/// What a picture shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Traced {
    /// Outlines, counter-clockwise, with their holes, clockwise: the largest first.
    pub parts: Vec<Part>,
    /// Islands that were smaller than `min_area`.
    pub dropped_islands: usize,
    /// Holes that were smaller than `min_area`, and filled.
    pub dropped_holes: usize,
    /// The threshold used.
    pub threshold: f64,
}

/// Traces the outlines, with holes, of what a picture covers at least to a threshold.
///
/// Coordinates are pixels, x to the right, y up, the origin at the lower left corner of the picture; outside it
/// nothing is covered. Points lie within half a pixel of the level line of the pixels' centres, corners where
/// the two sides meet that lead to them, and so do tips finer than a pixel, as far as the coverage says that they go. An edge that was drawn with
/// anti-aliasing is found where it was drawn. Centres of pixels lie inside where these reach the threshold, and else outside,
/// but for those that would move the line by more than a sixth of a pixel or bend a corner. No contour meets itself or another one, so each part can be
/// meshed. With a margin of 1 or more every pixel of the parts (each whole square of at least the threshold)
/// lies inside; the outline is moved a little more where that needs it. Gaps that a margin leaves narrower than
/// 0.8 pixels are closed. Where so many outlines meet that polygons would touch themselves, as in noise, they are moved on a
/// grid: then corners become round, and the margin is exact to about a tenth of a pixel, or of a hundredth of it if that is more.
///
/// Takes O(pixels + n log n) for n points, and about five bytes a pixel beside the picture, with a margin on a grid up to a
/// gigabyte. The same for any number of threads.
///
/// # Errors
/// [`Error::InvalidOption`], and [`Error::Cancelled`].
///
/// Sources: Lorensen and Cline, Marching cubes, 1987, in the plane, ambiguous cells by their mean; Cummins,
/// Francois and Kothe, Estimating curvature from volume fractions, 2005 (height functions); Savitzky and Golay
/// 1964, over windows as long as the fit allows; Ramer 1972; Otsu 1979.
pub fn trace_image(picture: &Picture, options: &TraceOptions, progress: Progress<'_>) -> Result<Traced> {
    check(options)?;
    progress.report(0.0)?;
    let threshold = match options.threshold {
        Threshold::At(value) => value,
        Threshold::Auto => threshold::otsu(picture),
    };
    let contours = levels::contours(picture, threshold, progress.part(0.0, 0.3))?;
    let sorted = islands::sort(contours, options.min_area, progress.part(0.3, 0.4))?;
    let refined = progress.part(0.4, 0.9);
    let parts = refine(picture, threshold, &sorted.islands, options.smooth, refined)?;
    let mut parts = match options.margin {
        0.0 => parts,
        margin => {
            let cover = margin::corners_to_cover(&sorted.islands);
            margin::expand(parts, margin, &cover, options.min_area, progress.part(0.9, 1.0))?
        }
    };
    // Smoothing, and what is filled, change the order that pixels have.
    parts.sort_by(|a, b| margin::area(b).total_cmp(&margin::area(a)));
    progress.report(1.0)?;
    let (dropped_islands, dropped_holes) = (sorted.dropped_islands, sorted.dropped_holes);
    Ok(Traced { parts, dropped_islands, dropped_holes, threshold })
}

fn check(options: &TraceOptions) -> Result<()> {
    let invalid = |name, value: f64, allowed| Err(Error::InvalidOption { name, value: told(value), allowed });
    if let Threshold::At(value) = options.threshold
        && !(value > 0.0 && value < 1.0)
    {
        return invalid("threshold", value, "a number above 0 and below 1, or automatic");
    }
    if !(0.0..=10.0).contains(&options.smooth) {
        return invalid("smooth", options.smooth, "a number from 0 to 10");
    }
    if !(options.min_area >= 0.0 && options.min_area.is_finite()) {
        return invalid("min_area", options.min_area, "a number of square pixels, 0 or more");
    }
    if !(0.0..=1000.0).contains(&options.margin) {
        return invalid("margin", options.margin, "a number of pixels from 0 to 1000");
    }
    Ok(())
}

/// Exact, smooth outlines of the islands: contour by contour, side by side.
fn refine(
    picture: &Picture,
    threshold: f64,
    islands: &[Island],
    smoothing: f64,
    progress: Progress<'_>,
) -> Result<Vec<Part>> {
    let contours: Vec<_> = islands.iter().flat_map(|island| &island.contours).collect();
    let total = contours.iter().map(|contour| contour.len()).sum::<usize>().max(1) as f64;
    let (rising, done) = (Rising::new(progress.part(0.0, 0.7)), std::sync::atomic::AtomicUsize::new(0));
    let refined = contours
        .par_iter()
        .map(|contour| {
            let before = done.fetch_add(contour.len(), std::sync::atomic::Ordering::Relaxed);
            let report = |fraction: f64| {
                let so_far = before as f64 + fraction * contour.len() as f64;
                if rising.report(so_far / total) { Ok(()) } else { Err(Error::Cancelled) }
            };
            report(0.0)?;
            line(picture, threshold, contour, smoothing, report)
        })
        .collect::<Result<Vec<_>>>()?;
    let (lines, tips): (Vec<_>, Vec<_>) = refined.into_iter().unzip();
    let tips = tips.concat();
    // Pieces of a tip beyond a narrow place are in it.
    let is_piece = |island: &Island, k: usize, line: &apart::Line| {
        let is_bare = k > 0 || island.contours.len() == 1;
        is_bare
            && island.contours[k].len() <= tips::PIECE
            && tips.iter().any(|tip| tip.holds(line.crossings()))
    };
    let mut counts = vec![0; islands.len()];
    let mut lines: Vec<apart::Line> = islands
        .iter()
        .enumerate()
        .flat_map(|(at, island)| (0..island.contours.len()).map(move |k| (at, island, k)))
        .zip(lines)
        .filter(|((_, island, k), line)| !is_piece(island, *k, line))
        .map(|((at, _, _), line)| {
            counts[at] += 1;
            line
        })
        .collect();
    apart::separate(&mut lines, &counts, progress.part(0.7, 1.0))?;
    let mut points = lines.into_iter().map(apart::Line::into_points);
    let part = |count: usize| Part {
        outline: points.next().unwrap_or_default(),
        holes: points.by_ref().take(count - 1).collect(),
    };
    Ok(counts.into_iter().filter(|&count| count > 0).map(part).collect())
}

/// The exact, smooth line of a contour, and the tips that it has.
fn line(
    picture: &Picture,
    threshold: f64,
    contour: &[Crossing],
    smoothing: f64,
    report: impl Fn(f64) -> Result<()> + Copy,
) -> Result<(apart::Line, Vec<Tip>)> {
    let raw = levels::points(picture, threshold, contour);
    if smoothing == 0.0 {
        return Ok((apart::Line::raw(raw), Vec::new()));
    }
    let samples = heights::samples(picture, threshold, contour, &raw);
    let noise = heights::noise(picture, contour);
    // Pixels that are covered or not tell nothing of what is finer, and another level none of how much is covered.
    let evidence = (noise <= 1.0 && (threshold - 0.5).abs() <= HALF).then_some(picture);
    let (samples, tips) = match evidence {
        Some(picture) => tips::restore(picture, samples, report)?,
        None => (samples, Vec::new()),
    };
    let samples = corners::restore(samples, noise, evidence, report)?;
    let samples = smooth::smooth(samples, smoothing, noise, report)?;
    let samples = sides::keep(contour, samples);
    Ok((apart::Line::new(raw, simplify::simplify(samples)), tips))
}
