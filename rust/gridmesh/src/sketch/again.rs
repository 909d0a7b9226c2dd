//! The patch of a drawing placed once more, on contours that were moved a little.

use glam::DVec2;

use crate::drawing::contours::read_contours;
use crate::drawing::curve::ClosedCurve;
use crate::error::Result;
use crate::options::SketchOptions;
use crate::path::outline::Outline;
use crate::progress::Progress;
use crate::sketch::found::Found;
use crate::sketch::job::{Job, Sketch};
use crate::sketch::kept::Kept;

/// The patch of a sketch with its vertices on contours that were moved, point for point: the same paths, each vertex placed from
/// where it belonged before; none where they cannot be placed there.
///
/// `drawn` are the contours of the sketch, as they were read, with more points on them or not.
///
/// # Errors
/// Those of [`read_contours`] for `moved`; [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn placed_again(
    kept: &Kept,
    drawn: &[Vec<DVec2>],
    moved: &[Vec<DVec2>],
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Option<Sketch>> {
    let Some(paths) = &kept.paths else { return Ok(None) };
    let contours = read_contours(&moved[0], &moved[1..])?;
    let h = kept.lattice.edge_length;
    let arcs: Option<Vec<Vec<f64>>> = (0..contours.len())
        .map(|k| moved_arcs(&paths.outline.arcs[k], h, &drawn[k], (&moved[k], &contours[k])))
        .collect();
    let Some(arcs) = arcs else { return Ok(None) };
    let outline = Outline { arcs, ..paths.outline.clone() };
    let mut job = Job { placements: 1, ..Job::new(contours, None, options) };
    let bent = kept.bent.as_ref().map(|(bent, _)| bent.as_ref());
    let placed = job.place(bent, &paths.lattice, &outline, progress)?;
    let Ok((placed, mirror_error)) = placed else { return Ok(None) };
    if placed.fault(options).is_some() {
        return Ok(None);
    }
    let found = Found::new(kept.bent.clone(), outline, placed, mirror_error);
    job.report(found, progress).map(Some)
}

/// Arc lengths, in edges of length `h`, of the points of `moved` that correspond to those at `arcs` on `drawn`; `moved` as it was given
/// and as it was read. None if points of it were dropped, or the order is not kept.
fn moved_arcs(
    arcs: &[f64],
    h: f64,
    drawn: &[DVec2],
    (moved, read): (&[DVec2], &ClosedCurve),
) -> Option<Vec<f64>> {
    let n = drawn.len();
    if read.points().len() != n {
        return None;
    }
    // It may have been read from another point on.
    let first = moved.iter().position(|point| *point == read.points()[0])?;
    let mut along = vec![0.0; n + 1];
    for i in 0..n {
        along[i + 1] = along[i] + drawn[i].distance(drawn[(i + 1) % n]);
    }
    let mut last = f64::NEG_INFINITY;
    let of = |s: &f64| {
        let s = (s * h).rem_euclid(along[n]);
        let i = along.partition_point(|&a| a <= s).clamp(1, n) - 1;
        let share = (s - along[i]) / (along[i + 1] - along[i]);
        let segment = (i + n - first) % n;
        let (from, to) = (read.arc()[segment], read.arc()[segment + 1]);
        let mut there = from + share * (to - from);
        if there <= last {
            there += read.length();
        }
        let is_next = there > last;
        last = there;
        is_next.then_some(there / h)
    };
    let arcs: Vec<f64> = arcs.iter().map(of).collect::<Option<_>>()?;
    let (start, end) = (arcs.first()?, arcs.last()?);
    (end - start < read.length() / h).then_some(arcs)
}
