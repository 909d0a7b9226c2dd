//! Divides a mesh along a swept stroke and closes both pieces with grid patches.
//!
//! [`cut`] does it all. The stroke and the surface that it sweeps are a `sheet::Sheet`; `locate` finds the
//! faces it meets, `cross` where it meets their edges, `split` divides them, `rim` makes the edges along
//! the cut even, `loops` and `regions` find what is to be capped, `cap`, `ring` and `bridge` cap it, `pieces` puts the pieces
//! together; `attempt` is one way through these stages, `retry` says which ways are tried.

mod attempt;
mod bounds;
pub(crate) mod caps;
mod cutting;
pub(crate) mod divide;
pub(crate) mod input;
mod options;
mod pieces;
mod report;
mod retry;
mod rim;
mod sheet;

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;

pub use self::input::Polygons;
use self::input::check;
pub use self::options::{CutOptions, Keep, Mirror, Sweep};
pub use self::pieces::{Piece, Side};
pub use self::report::CutReport;
use self::sheet::Sheet;
use crate::cut::cutting::Cutting;
use crate::cut::divide::{cross, locate};
use crate::cut::sheet::sides::Alone;
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
/// stroke, what is within a hundredth of it counts as straight. Where edges of this length leave a line without a cap, they become
/// half as long, again and again, until they do not.
///
/// Parts that end along an open stroke already, as at the cap of the same cut made before, are not cut again: those that lie on
/// one side of it but for slices thinner than a twentieth of the `edge_length`, or without one than a thousandth of the edges
/// that it crosses.
///
/// Caps lie on the swept surface (with [`Smooth::Flat`](crate::fill::Smooth)), both pieces get the same vertices and
/// faces, the right one's wound the other way. Cut lines that are not closed, because the mesh is not, get no
/// cap. Linear in the size of the mesh, all but one pass local to the cut; the same input gives the same output
/// for any number of threads.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::IndexOutOfRange`], [`Error::InvalidFace`], [`Error::InvalidOption`];
/// [`Error::StrokeTooShort`] and [`Error::SelfIntersecting`] for strokes that sweep no surface,
/// [`Error::BehindEye`], [`Error::StrokeMisses`] if nothing is divided, [`Error::SliceTooThin`] if nothing but slices
/// would come off, [`Error::StillJoined`] if what a stroke crosses without its ends continued does not come apart,
/// [`Error::CutFailed`] where rounding leaves no consistent division, [`Error::CutTooLarge`] if an `edge_length` would make
/// more than 20,000 edges along the cut or two million triangles of caps, [`Error::Cancelled`]. Nothing is returned half cut.
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
    let cutting = Cutting { vertices, faces, options };
    if let Some(length) = options.edge_length
        && let Some(fewer) = simplify::simplified(vertices, stroke, options.sweep, length)
    {
        match cut_along(cutting, &fewer, progress) {
            // Strands that nearly touch may cross when they are simplified.
            Err(Error::SelfIntersecting { .. } | Error::StrokeTooShort { .. }) => {}
            done => return done,
        }
    }
    cut_along(cutting, stroke, progress)
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

fn cut_along(cutting: Cutting<'_>, stroke: &[DVec3], progress: Progress<'_>) -> Result<Cut> {
    let Cutting { vertices, options, .. } = cutting;
    if options.gap == 0.0 {
        let sheet = Sheet::new(vertices, stroke, options.sweep)?;
        return retry::divide(cutting, sheet, &Alone::Kept(options.keep), progress).map(|done| done.0);
    }
    // A kerf is two cuts: one to either side of the stroke.
    let mut both: Option<Cut> = None;
    // What is not cut goes to the same side in both.
    let mut alone = Alone::Kept(options.keep);
    let sides = [(Keep::Left, 0.5 * options.gap), (Keep::Right, -0.5 * options.gap)];
    for (k, (keep, shift)) in sides.into_iter().filter(|(k, _)| options.keep.has(*k)).enumerate() {
        let half = CutOptions { keep, ..options.clone() };
        let sheet =
            Sheet::new(vertices, &offset::shifted(vertices, stroke, options.sweep, shift)?, options.sweep)?;
        let here = progress.part(0.5 * k as f64, 0.5 * (k + 1) as f64);
        let (one, side) = retry::divide(Cutting { options: &half, ..cutting }, sheet, &alone, here)?;
        alone = side.map_or(alone, Alone::As);
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
