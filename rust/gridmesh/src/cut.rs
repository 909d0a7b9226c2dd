//! Divides a mesh along a swept stroke and closes both pieces with grid patches.
//!
//! [`cut`] does it all. The stroke and the surface that it sweeps are a `sheet::Sheet`; `locate` finds the
//! faces it meets, `cross` where it meets their edges, `split` divides them, `rim` makes the edges along
//! the cut even, `loops` and `regions` find what is to be capped, `cap` and `bridge` cap it, `pieces` puts the pieces
//! together.

mod bounds;
pub(crate) mod caps;
pub(crate) mod divide;
mod input;
mod options;
mod pieces;
mod report;
mod rim;
mod sheet;

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use glam::DVec3;
use rustc_hash::FxHashSet;

pub use self::input::Polygons;
use self::input::check;
pub use self::options::{CutOptions, Keep, Mirror, Sweep};
pub use self::pieces::{Piece, Side};
pub use self::report::CutReport;
use self::report::Tally;
use self::sheet::Sheet;
use crate::cut::caps::capper::Caps;
use crate::cut::caps::{cap, loops};
use crate::cut::divide::node::Tolerance;
use crate::cut::divide::parted::Parted;
use crate::cut::divide::{cross, locate, split};
use crate::cut::sheet::reach::Alone;
use crate::cut::sheet::{offset, reach, simplify};
use crate::error::{Error, Result};
use crate::progress::Progress;

/// A divided mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// The pieces asked for, the left one first.
    pub pieces: Vec<Piece>,
    /// Numbers about it.
    pub report: CutReport,
}

/// Divides a mesh along the surface that a stroke sweeps, and closes the pieces.
///
/// `stroke` is open, and then continued straight on at both ends, or closed: its last point repeats its first one.
/// It is swept along a direction or through an eye point ([`Sweep`]). Left and right are those of somebody who
/// looks along the direction, or from the eye; a closed stroke's left is its inside.
///
/// Which side a vertex lies on is decided by exact predicates, and where the stroke passes exactly through a
/// vertex or along an edge, as if it were moved by less than any number: each face is divided consistently
/// with its neighbours. Crossings with an edge are computed once and shared by its faces. Where the cut passes a vertex
/// nearer than a thousandth of the edge it crosses, it is drawn through the vertex. Old vertices keep their bits; faces that
/// the cut does not meet come back as they were. Where the input was a closed manifold, so are the pieces
/// (with `cap`); vertices in which a piece would touch itself are doubled.
///
/// With an `edge_length` the edges along the cut get about this length, and the faces along it are rebuilt; of the
/// stroke, what is within a hundredth of it counts as straight.
///
/// Caps lie on the swept surface (with [`Smooth::Flat`](crate::fill::Smooth)), both pieces get the same vertices and
/// triangles, the right one's wound the other way. Cut lines that are not closed, because the mesh is not, get no
/// cap. Linear in the size of the mesh, all but one pass local to the cut; the same input gives the same output
/// for any number of threads.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::IndexOutOfRange`], [`Error::InvalidFace`], [`Error::InvalidOption`];
/// [`Error::StrokeTooShort`] and [`Error::SelfIntersecting`] for strokes that sweep no surface,
/// [`Error::BehindEye`], [`Error::StrokeMisses`] if nothing is divided, [`Error::StillJoined`] if what a stroke crosses
/// without its ends continued does not come apart, [`Error::CutFailed`] where rounding leaves no
/// consistent division, [`Error::TooLarge`] if an `edge_length` would make more than 20,000 edges along the cut or two million
/// triangles of caps, [`Error::Cancelled`]. Nothing is returned half cut.
///
/// Source: Nealen et al. 2009, section V and figure 2. The paper takes the cut itself from FiberMesh.
pub fn cut(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    stroke: &[DVec3],
    options: &CutOptions,
    progress: Progress<'_>,
) -> Result<Cut> {
    // Where a stage is repeated, what is reported does not go back.
    let most = AtomicU64::new(0);
    let onward = |fraction: f64| {
        let most = most.fetch_max(fraction.max(0.0).to_bits(), Ordering::Relaxed);
        progress.report(fraction.max(f64::from_bits(most))).is_ok()
    };
    let progress = Progress::new(&onward);
    progress.report(0.0)?;
    options.check()?;
    check(vertices, faces, stroke)?;
    if let Some(length) = options.edge_length
        && let Some(fewer) = simplify::simplified(vertices, stroke, options.sweep, length)
    {
        match cut_along(vertices, faces, &fewer, options, progress) {
            // Strands that nearly touch may cross when they are simplified.
            Err(Error::SelfIntersecting { .. } | Error::StrokeTooShort { .. }) => {}
            done => return done,
        }
    }
    cut_along(vertices, faces, stroke, options, progress)
}

/// How far the ends of an open stroke are continued without [`CutOptions::extend_ends`]: the points in front of, and
/// behind, which nothing is cut, as far away from the viewer as the ends themselves.
///
/// # Errors
/// As of [`cut`].
pub fn cut_reach(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    stroke: &[DVec3],
    sweep: Sweep,
    progress: Progress<'_>,
) -> Result<[DVec3; 2]> {
    CutOptions::new(sweep).check()?;
    check(vertices, faces, stroke)?;
    let sheet = Sheet::new(vertices, stroke, sweep)?;
    let locator = locate::Locator::new(vertices, &sheet)?;
    let met = locator.find(vertices, faces)?;
    let edges = cross::cross(vertices, faces, &sheet, &locator, &met);
    let reach = reach::reach(vertices, &sheet, &met, &edges, progress)?;
    let ends = [(reach.from, stroke[0]), (reach.to, stroke[stroke.len() - 1])];
    let [from, to] = sheet.drawn();
    Ok(ends.map(
        |(place, end)| {
            if place == from || place == to { end } else { sheet.lift(place, sheet.view.height(end)) }
        },
    ))
}

fn cut_along(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    stroke: &[DVec3],
    options: &CutOptions,
    progress: Progress<'_>,
) -> Result<Cut> {
    if options.gap == 0.0 {
        let sheet = Sheet::new(vertices, stroke, options.sweep)?;
        return divide(vertices, faces, sheet, options, Alone::Kept(options.keep), progress)
            .map(|done| done.0);
    }
    // A kerf is two cuts: one to either side of the stroke.
    let mut both: Option<Cut> = None;
    // What is not crossed goes to the same side in both.
    let mut alone = Alone::Kept(options.keep);
    let sides = [(Keep::Left, 0.5 * options.gap), (Keep::Right, -0.5 * options.gap)];
    for (k, (keep, shift)) in sides.into_iter().filter(|(k, _)| options.keep.has(*k)).enumerate() {
        let half = CutOptions { keep, ..options.clone() };
        let sheet =
            Sheet::new(vertices, &offset::shifted(vertices, stroke, options.sweep, shift)?, options.sweep)?;
        let here = progress.part(0.5 * k as f64, 0.5 * (k + 1) as f64);
        let (one, side) = divide(vertices, faces, sheet, &half, alone, here)?;
        alone = side.map_or(alone, Alone::On);
        both = Some(match both {
            None => one,
            Some(mut first) => {
                first.pieces.extend(one.pieces);
                first.report.add(&one.report);
                first
            }
        });
    }
    both.ok_or(Error::Cancelled)
}

/// Coarser to finer: where a tolerance leaves no consistent division, the next one may.
const TOLERANCES: [Tolerance; 3] = [
    Tolerance { vertex: 1e-3, node: 1e-6, length: 0.0 },
    Tolerance { vertex: 1e-6, node: 1e-8, length: 0.0 },
    Tolerance { vertex: 1e-9, node: 1e-11, length: 0.0 },
];

/// With an edge length, the cut may be drawn through vertices that are nearer than this part of it, where triangles
/// beside it would be thin otherwise.
const THROUGH: f64 = 0.3;

/// So often the cut is drawn anew, through vertices that stood in the way of good triangles.
const REDRAWN: usize = 4;

/// With an edge length, a line that touches itself in a vertex is moved aside by this part of it.
const ASIDE: f64 = 0.02;

/// Vertices that are let go one after the other, until the faces around them can be divided.
const RELEASES: usize = 200;

fn divide(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    sheet: Sheet,
    options: &CutOptions,
    alone: Alone,
    progress: Progress<'_>,
) -> Result<(Cut, Option<bool>)> {
    let coarse = options.edge_length.map(|length| Tolerance { length: THROUGH * length, ..TOLERANCES[0] });
    // Drawn through vertices near by, lines may touch that were apart; and through a vertex exactly, a line may touch
    // itself there. Then without the one, and moved by the least bit.
    let mut failed = Error::StrokeMisses;
    let depth = vertices.first().map_or(1.0, |&v| sheet.view.depth(v));
    let away = options.edge_length.map_or(sheet.nudged(1), |length| sheet.moved(ASIDE * length / depth));
    let ways = [(&sheet, coarse), (&sheet, None), (&away, coarse), (&away, None)];
    for (tries, (sheet, coarse)) in ways.into_iter().enumerate() {
        if tries % 2 == 1 && options.edge_length.is_none() {
            continue;
        }
        let from = if tries == 0 { 0.0 } else { 0.9 + 0.025 * tries as f64 };
        let to = if tries == 0 { 0.9 } else { from + 0.025 };
        let ends = (alone, progress.part(from, to));
        match divide_with(vertices, faces, sheet.clone(), options, coarse, ends) {
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
    vertices: &[DVec3],
    faces: Polygons<'_>,
    sheet: Sheet,
    options: &CutOptions,
    coarse: Option<Tolerance>,
    (alone, progress): (Alone, Progress<'_>),
) -> Result<(Cut, Option<bool>)> {
    let mut tally = Tally::new();
    let since = Instant::now();
    let (sheet, parted) =
        part(vertices, faces, sheet, options, alone, coarse, &mut tally, progress.part(0.0, 0.4))?;
    progress.report(0.4)?;
    let loops = loops::trace(faces, &parted, &sheet);
    tally.report.open_lines = loops.open.len();
    tally.report.loops = loops.closed.len();
    let caps = if options.cap {
        let caps = cap::close(
            vertices,
            faces,
            &parted,
            &sheet,
            &loops,
            options,
            &mut tally,
            progress.part(0.4, 0.9),
        )?;
        tally.stage("caps");
        caps
    } else {
        Caps::default()
    };
    progress.report(0.9)?;
    let pieces = pieces::assemble(vertices, faces, &parted, &loops, &caps, options.keep, &mut tally);
    tally.stage("pieces");
    tally.report.seconds.push(("total", since.elapsed().as_secs_f64()));
    progress.report(1.0)?;
    Ok((Cut { pieces, report: tally.report }, parted.alone))
}

/// Divides the faces, evenly along the cut with an edge length; if rounding stands in the way, with finer tolerances
/// and with the stroke moved by the least bit that matters, which is counted.
#[expect(clippy::too_many_arguments, reason = "a stage of the whole")]
fn part(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    sheet: Sheet,
    options: &CutOptions,
    alone: Alone,
    coarse: Option<Tolerance>,
    tally: &mut Tally,
    progress: Progress<'_>,
) -> Result<(Sheet, Parted)> {
    let mut failed = Error::StrokeMisses;
    for nudge in 0..3 {
        let sheet = sheet.nudged(nudge);
        let locator = locate::Locator::new(vertices, &sheet)?;
        let mut met = locator.find(vertices, faces)?;
        let mut edges = cross::cross(vertices, faces, &sheet, &locator, &met);
        if !options.extend_ends && !sheet.closed {
            let reach = reach::reach(vertices, &sheet, &met, &edges, progress.part(0.0, 0.2))?;
            reach.restrict(vertices, faces, &mut met, &mut edges, alone)?;
        }
        tally.stage("search");
        progress.report(0.5)?;
        for tolerance in coarse.into_iter().chain(TOLERANCES) {
            let (mut wanted, mut released) = (FxHashSet::default(), FxHashSet::default());
            let mut redrawn = 0;
            for _ in 0..RELEASES {
                progress.report(0.5)?;
                let crossed = edges.named(vertices, tolerance, &wanted, &released);
                match split::split(vertices, faces, &sheet, &met, crossed, tolerance) {
                    Ok(mut parted) => {
                        if tolerance.length > 0.0 {
                            let before = released.len();
                            released.extend(parted.touching());
                            tally.report.repeated += released.len() - before;
                            released.extend(parted.far(vertices, &locator, tolerance.length));
                            if released.len() > before {
                                continue;
                            }
                        }
                        tally.stage("faces");
                        tally.report.cut_faces = parted.cut_faces;
                        if let Some(length) = options.edge_length {
                            if redrawn == 0 {
                                bounds::check(vertices, faces, &parted, &sheet, length)?;
                            }
                            redrawn += 1;
                            let again = |in_the_way: Vec<u32>| {
                                let before = wanted.len();
                                wanted.extend(in_the_way.into_iter().filter(|v| !released.contains(v)));
                                redrawn <= REDRAWN && wanted.len() > before
                            };
                            let off = |v: u32| match released.contains(&v) {
                                true => f64::INFINITY,
                                false => locator.off(vertices[v as usize], v, tolerance.length),
                            };
                            let through = rim::Through { reach: tolerance.length, off: &off };
                            let done = rim::even_out(
                                vertices,
                                faces,
                                &mut parted,
                                length,
                                &through,
                                tally,
                                again,
                                progress.part(0.5, 1.0),
                            )?;
                            tally.stage("rim");
                            if !done {
                                continue;
                            }
                        }
                        return Ok((sheet, parted));
                    }
                    Err((Error::StrokeMisses, _)) if tolerance.length == 0.0 => {
                        return Err(Error::StrokeMisses);
                    }
                    Err((error, at)) => {
                        failed = error;
                        let before = released.len();
                        released.extend(at.into_iter().flatten());
                        tally.report.repeated += released.len() - before;
                        if tolerance.length == 0.0 || released.len() == before {
                            break;
                        }
                    }
                }
            }
            tally.report.repeated += 1;
        }
    }
    Err(failed)
}
