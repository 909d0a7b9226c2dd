//! One way to divide: the sheet at one place, with one tolerance after the other.

use rustc_hash::FxHashSet;

use super::cutting::Cutting;
use super::divide::cross::{self, Edges};
use super::divide::ended;
use super::divide::locate::{Locator, Met};
use super::divide::node::Tolerance;
use super::divide::parted::Parted;
use super::divide::split;
use super::report::Tally;
use super::sheet::Sheet;
use super::sheet::reach;
use super::sheet::sides::{Alone, retell};
use super::{bounds, rim};
use crate::error::{Error, Result};
use crate::progress::Progress;

/// So often the cut is drawn anew, through vertices that stood in the way of good triangles.
const REDRAWN: usize = 4;

/// Once it was drawn anew, that is done again for one new vertex in the way among this many on the line: of long lines
/// each time takes long, and a few thin triangles more or less do not show.
const FEW: usize = 300;

/// Vertices that are let go one after the other, until the faces around them can be divided.
const RELEASES: usize = 200;

/// A sheet, and what it meets.
pub(super) struct Attempt<'a> {
    cutting: Cutting<'a>,
    sheet: &'a Sheet,
    locator: Locator<'a>,
    met: Met,
    edges: Edges,
}

/// Old vertices that the cut is drawn through, and those that it is not though they are near.
#[derive(Default)]
struct Snaps {
    wanted: FxHashSet<u32>,
    released: FxHashSet<u32>,
    redrawn: usize,
}

impl<'a> Attempt<'a> {
    pub fn new(
        cutting: Cutting<'a>,
        sheet: &'a Sheet,
        alone: &Alone,
        progress: Progress<'_>,
    ) -> Result<Attempt<'a>> {
        let Cutting { vertices, faces, options } = cutting;
        let locator = Locator::new(vertices, sheet)?;
        let mut met = locator.find(vertices, faces)?;
        let mut edges = cross::cross(vertices, faces, sheet, &locator, &met);
        if !options.extend_ends && !sheet.closed {
            let reach = reach::reach(vertices, sheet, &met, &edges, progress)?;
            retell(&reach.cut, (vertices, faces), &mut met, &mut edges, alone, |_| false)?;
        }
        // A closed line may punch a hole that is small beside the edge length.
        if !sheet.closed
            && let Some(found) = ended::find(cutting, &locator, &met, &edges)?
        {
            let near = |v: usize| found.near[v];
            retell(&found.cut, (vertices, faces), &mut met, &mut edges, alone, near)?;
        }
        Ok(Attempt { cutting, sheet, locator, met, edges })
    }

    /// The faces divided with this tolerance, or, if there is no consistent division, what stood in the way where
    /// that is known.
    pub fn part(
        &self,
        tolerance: Tolerance,
        tally: &mut Tally,
        progress: Progress<'_>,
    ) -> Result<Result<Parted, Option<Error>>> {
        let Cutting { vertices, faces, .. } = self.cutting;
        let mut snaps = Snaps::default();
        let mut failed = None;
        for _ in 0..RELEASES {
            progress.report(0.5)?;
            let crossed = self.edges.named(vertices, tolerance, &snaps.wanted, &snaps.released);
            let names = crossed.names();
            match split::split(vertices, faces, self.sheet, &self.met, crossed, tolerance) {
                Ok(mut parted) => {
                    if self.settle(&mut parted, tolerance, (&mut snaps, &names), tally, progress)? {
                        return Ok(Ok(parted));
                    }
                }
                Err((Error::StrokeMisses, _)) if tolerance.length == 0.0 => return Err(Error::StrokeMisses),
                Err((error, at)) => {
                    failed = Some(error);
                    let before = snaps.released.len();
                    snaps.released.extend(at.into_iter().flatten());
                    tally.report.repeated += snaps.released.len() - before;
                    if tolerance.length == 0.0 || snaps.released.len() == before {
                        break;
                    }
                }
            }
        }
        Ok(Err(failed))
    }

    /// Makes the edges along the cut even where that is asked for. Returns false if the cut, with crossings of these names,
    /// must be drawn anew with these snaps.
    fn settle(
        &self,
        parted: &mut Parted,
        tolerance: Tolerance,
        (snaps, names): (&mut Snaps, &[u32]),
        tally: &mut Tally,
        progress: Progress<'_>,
    ) -> Result<bool> {
        let vertices = self.cutting.vertices;
        if tolerance.length > 0.0 {
            let before = snaps.released.len();
            snaps.released.extend(parted.touching());
            tally.report.repeated += snaps.released.len() - before;
            snaps.released.extend(parted.far(vertices, &self.locator, tolerance.length));
            if snaps.released.len() > before {
                return Ok(false);
            }
        }
        tally.stage("faces");
        tally.report.cut_faces = parted.cut_faces;
        let Some(length) = self.cutting.options.edge_length else { return Ok(true) };
        if snaps.redrawn == 0 {
            bounds::check(vertices, self.cutting.faces, parted, self.sheet, length)?;
        }
        let Snaps { wanted, released, redrawn } = snaps;
        *redrawn += 1;
        let on_line = parted.cut.len();
        let again = |in_the_way: Vec<u32>| {
            let before = wanted.len();
            wanted.extend(in_the_way.into_iter().filter(|v| !released.contains(v)));
            let is_other = |wanted: &FxHashSet<u32>| {
                self.edges.named(vertices, tolerance, wanted, released).names() != names
            };
            let enough = if *redrawn == 1 { 0 } else { on_line / FEW };
            *redrawn <= REDRAWN && wanted.len() > before + enough && is_other(wanted)
        };
        let off = |v: u32| match released.contains(&v) {
            true => f64::INFINITY,
            false => self.locator.off(vertices[v as usize], v, tolerance.length),
        };
        let through = rim::Through { length, reach: tolerance.length, off: &off };
        let done = rim::even_out(self.cutting, parted, &through, tally, again, progress.part(0.5, 1.0))?;
        tally.stage("rim");
        Ok(done)
    }
}
