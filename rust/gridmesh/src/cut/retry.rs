//! Which ways of dividing are tried, one after the other.
//!
//! Rounding may leave no consistent division: finer tolerances, vertices let go, and the stroke moved by the least bit
//! that matters are tried then, and counted in the report.

use std::time::Instant;

use super::attempt::Attempt;
use super::caps::capper::Caps;
use super::caps::loops::Loops;
use super::caps::{cap, loops};
use super::cutting::Cutting;
use super::divide::locate::Uncut;
use super::divide::node::{THROUGH, Tolerance};
use super::divide::parted::Parted;
use super::report::Tally;
use super::sheet::Sheet;
use super::sheet::sides::Alone;
use super::{Cut, pieces};
use crate::error::{Error, Result};
use crate::progress::Progress;

/// Coarser to finer: where a tolerance leaves no consistent division, the next one may.
const TOLERANCES: [Tolerance; 3] = [
    Tolerance { vertex: 1e-3, node: 1e-6, length: 0.0 },
    Tolerance { vertex: 1e-6, node: 1e-8, length: 0.0 },
    Tolerance { vertex: 1e-9, node: 1e-11, length: 0.0 },
];

/// With an edge length, a line that touches itself in a vertex is moved aside by this part of it.
const ASIDE: f64 = 0.02;

/// So often an edge length is halved that leaves lines without caps; then edges stay as the mesh divides them.
const HALVINGS: usize = 5;

/// Divides and caps. Beside the result: which side of the cut the parts are on that are not cut.
pub(super) fn divide(
    cutting: Cutting<'_>,
    sheet: Sheet,
    alone: &Alone,
    progress: Progress<'_>,
) -> Result<(Cut, Option<Uncut>)> {
    let edge_length = cutting.options.edge_length;
    let coarse = edge_length.map(|length| Tolerance { length: THROUGH * length, ..TOLERANCES[0] });
    // Drawn through vertices near by, lines may touch that were apart; and through a vertex exactly, a line may touch
    // itself there. Then without the one, and moved by the least bit.
    let mut failed = Error::StrokeMisses;
    let depth = cutting.vertices.first().map_or(1.0, |&v| sheet.view.depth(v));
    let away = edge_length.map_or(sheet.nudged(1), |length| sheet.moved(ASIDE * length / depth));
    let ways = [(&sheet, coarse), (&sheet, None), (&away, coarse), (&away, None)];
    for (tries, (sheet, coarse)) in ways.into_iter().enumerate() {
        if tries % 2 == 1 && edge_length.is_none() {
            continue;
        }
        let from = if tries == 0 { 0.0 } else { 0.9 + 0.025 * tries as f64 };
        let to = if tries == 0 { 0.9 } else { from + 0.025 };
        match divide_with(cutting, sheet, coarse, alone, progress.part(from, to)) {
            Ok((mut cut, side)) => {
                cut.report.repeated += tries;
                return progress.report(1.0).map(|()| (cut, side));
            }
            Err(error @ Error::CutFailed { .. }) => failed = error,
            Err(error) => return Err(error),
        }
    }
    Err(failed)
}

/// Divides and caps; first with this tolerance, if there is one.
fn divide_with(
    cutting: Cutting<'_>,
    sheet: &Sheet,
    coarse: Option<Tolerance>,
    alone: &Alone,
    progress: Progress<'_>,
) -> Result<(Cut, Option<Uncut>)> {
    let mut tally = Tally::new();
    let since = Instant::now();
    let (mut sheet, mut parted) = part(cutting, sheet, coarse, alone, &mut tally, progress.part(0.0, 0.4))?;
    progress.report(0.4)?;
    let mut loops = loops::trace(cutting.faces, &parted, &sheet);
    if cutting.options.cap
        && coarse.is_some()
        && cap::uncapped(cutting, &parted, &sheet, &loops) > 0
        && let Some(finer) = finer(cutting, &sheet, alone, &mut tally, progress.part(0.4, 0.4))?
    {
        (sheet, parted, loops) = finer;
    }
    tally.report.open_lines = loops.open.len();
    tally.report.loops = loops.closed.len();
    let caps = if cutting.options.cap {
        let caps = cap::close(cutting, &parted, &sheet, &loops, &mut tally, progress.part(0.4, 0.9))?;
        tally.stage("caps");
        caps
    } else {
        Caps::new(vec![])
    };
    progress.report(0.9)?;
    let pieces = pieces::assemble(cutting, &parted, &loops, &caps, &mut tally);
    tally.stage("pieces");
    tally.report.seconds.push(("total", since.elapsed().as_secs_f64()));
    progress.report(1.0)?;
    Ok((Cut { pieces, report: tally.report }, parted.uncut))
}

/// Divided with the longest shorter edge length that leaves no line without a cap, if there is one: a line of few long edges
/// may run around a closed sheet otherwise than it should, or not at all. Lines that the exact cut leaves without a cap, too, as
/// around a hole in an open mesh, get none with any edge length.
fn finer(
    cutting: Cutting<'_>,
    sheet: &Sheet,
    alone: &Alone,
    tally: &mut Tally,
    progress: Progress<'_>,
) -> Result<Option<(Sheet, Parted, Loops)>> {
    let mut options = cutting.options.clone();
    let mut divided = |edge_length: Option<f64>| {
        options.edge_length = edge_length;
        let coarse = edge_length.map(|length| Tolerance { length: THROUGH * length, ..TOLERANCES[0] });
        let cutting = Cutting { options: &options, ..cutting };
        let (sheet, parted) = match part(cutting, sheet, coarse, alone, tally, progress) {
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            // Too many edges, or no consistent division.
            Err(_) => return Ok(None),
            Ok(done) => done,
        };
        let loops = loops::trace(cutting.faces, &parted, &sheet);
        tally.report.repeated += 1;
        let capped = cap::uncapped(cutting, &parted, &sheet, &loops) == 0;
        Ok(Some((capped, (sheet, parted, loops))))
    };
    let exact = divided(None)?;
    if matches!(exact, Some((false, _))) {
        return Ok(None);
    }
    let mut edge_length = cutting.options.edge_length;
    for _ in 0..HALVINGS {
        edge_length = edge_length.map(|length| 0.5 * length);
        if let Some((true, done)) = divided(edge_length)? {
            return Ok(Some(done));
        }
    }
    Ok(exact.map(|(_, done)| done))
}

/// Divides the faces, evenly along the cut with an edge length.
fn part(
    cutting: Cutting<'_>,
    sheet: &Sheet,
    coarse: Option<Tolerance>,
    alone: &Alone,
    tally: &mut Tally,
    progress: Progress<'_>,
) -> Result<(Sheet, Parted)> {
    let mut failed = Error::StrokeMisses;
    for nudge in 0..3 {
        let sheet = sheet.nudged(nudge);
        let attempt = Attempt::new(cutting, &sheet, alone, progress.part(0.0, 0.2))?;
        tally.stage("search");
        progress.report(0.5)?;
        for tolerance in coarse.into_iter().chain(TOLERANCES) {
            match attempt.part(tolerance, tally, progress)? {
                Ok(parted) => return Ok((sheet, parted)),
                Err(error) => failed = error.unwrap_or(failed),
            }
            tally.report.repeated += 1;
        }
    }
    Err(failed)
}
