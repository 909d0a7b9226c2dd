//! Fills holes with grid patches whose boundary is the hole's, vertex for vertex.
//!
//! [`fill_hole`] fills one loop, [`fill_holes`] many; [`holes`] finds loops.

pub mod bridge;
pub(crate) mod even;
mod filled;
mod job;
pub(crate) mod layout;
pub mod loops;
mod meetings;
mod one;
pub(crate) mod options;
pub(crate) mod parallel;
mod parts;
pub(crate) mod planar;
mod regrid;
mod report;
mod several;
pub(crate) mod surface;

use glam::DVec3;

pub use self::options::{FillOptions, Smooth};
use self::parallel::steady;
pub use self::parts::FillParts;
pub use self::regrid::{Regrid, regrid};
pub use self::report::{FillReport, Grid};
use self::several::fill_several;
use crate::error::{Error, Result};
pub use crate::fill::bridge::{BridgeOptions, Pair, bridge, bridge_pairs, look_apart};
use crate::fill::filled::NO_ITEM;
pub use crate::fill::filled::{Bridged, Fill, Leaving};
use crate::fill::job::Job;
pub use crate::fill::layout::unroll::Unrolling;
use crate::fill::loops::holes;
use crate::progress::Progress;

/// Fills one hole of a mesh, or a loop of edges without a mesh.
///
/// `loop_` holds the vertices of the hole's boundary in order, either way round, each once, at least three.
/// The result's boundary is exactly this loop: no vertex of it is moved and none is added, each of its
/// edges gets one new triangle, wound against its neighbour (against most of the neighbours, where they
/// disagree). The patch is a disk, and no new edge or face repeats one of the mesh. It may meet itself or
/// the mesh, as any filling of a knotted loop has to; the report counts this and `strict` refuses it.
///
/// With `sharp`, hard edges of the surroundings that run into the loop go on in the patch, if they meet in one line
/// or one point and the surface between them is planar; the report says how many do.
///
/// Work is local but for passes over the mesh that find the triangles near the loop. The same input
/// gives the same output for any number of threads.
///
/// # Errors
/// A loop that is not fit has its own variant for each reason: [`Error::IndexOutOfRange`],
/// [`Error::Loops`], [`Error::RepeatedVertex`], [`Error::FigureEight`], [`Error::NotFinite`],
/// [`Error::ExtremeSize`], [`Error::ZeroLengthEdge`], [`Error::SelfTouching`], [`Error::FacesOnBothSides`],
/// [`Error::NonManifold`]. [`Error::InvalidOption`]; [`Error::FillIntersects`] if `strict`; [`Error::Cancelled`].
/// Vertices within two rings of triangles around the loop have to be finite, wherever else they need not.
///
/// Source: Nealen et al. 2009, section V, for the patch. The paper leaves the positions of the inner
/// vertices to its surroundings (FiberMesh); here they come from [`Smooth`].
pub fn fill_hole(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loop_: &[u32],
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    let job = Job { vertices, triangles, options };
    let mut fills = steady(progress, |progress| job.run(&[Ok(loop_.to_vec())], progress))?;
    fills.pop().unwrap_or(Err(NO_ITEM))
}

/// Fills one hole that has several loops: a patch whose boundary they all are.
///
/// One loop is filled as by [`fill_hole`], two are joined by a tube as by [`bridge()`]. Between three or more a tube leaves each loop
/// where there is room; where these come together, or between the loops themselves, the faces are even, but no grid. The patch is a
/// sphere with as many holes, every loop is exact and untouched, each of its edges gets one new face, no edge of the mesh is
/// repeated, and the surface goes on from what is around all loops. Loops without faces are taken the way round that suits the
/// nearest others. Quads are pairs of triangles of twice the size, each cut into four; if the loops have an odd number of edges in sum
/// one face is a triangle. The loop of the [`Fill`] is the loops one after the other.
///
/// # Errors
/// Those of [`fill_hole`] and [`bridge()`]; [`Error::InvalidOption`] without a loop, and for `sharp` with two loops or more;
/// [`Error::NoPatch`] if the loops have too few vertices to be joined; [`Error::Loops`] for loops that share a vertex or touch, and for three
/// or more of which two look away from each other (see [`look_apart`]) where the patch would meet itself.
pub fn fill_loops(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loops: &[Vec<u32>],
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    if loops.len() > 1 && options.sharp.is_some() {
        let value = format!("given, with {} loops", loops.len());
        return Err(Error::InvalidOption { name: "sharp", value, allowed: "none, with several loops" });
    }
    match loops {
        [] => {
            let allowed = "one loop or more";
            Err(Error::InvalidOption { name: "loops", value: "none".into(), allowed })
        }
        [single] => fill_hole(vertices, triangles, single, options, progress),
        [one, other] => {
            let options = BridgeOptions {
                cells: options.cells,
                smooth: options.smooth,
                strict: options.strict,
                polygons: options.polygons.clone(),
                ..BridgeOptions::default()
            };
            bridge(vertices, triangles, one, other, &options, progress)
        }
        _ => steady(progress, |progress| fill_several(vertices, triangles, loops, options, progress)),
    }
}

/// Fills the given loops, or all holes, as [`fill_hole`] does, in parallel.
///
/// Items come in the order of the loops. New vertices are numbered from the mesh's number of vertices
/// on in every item. A loop that cannot be filled does not stop the others. No new edge repeats one of
/// another fill.
///
/// # Errors
/// [`Error::IndexOutOfRange`] if a triangle of the mesh names a vertex that does not exist,
/// [`Error::Cancelled`]. Of an item: those of [`fill_hole`], and [`Error::SharedEdge`] if an earlier loop has
/// used one of its edges.
pub fn fill_holes(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loops: Option<&[Vec<u32>]>,
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Vec<Result<Fill>>> {
    let loops = match loops {
        Some(loops) => loops.iter().map(|l| Ok(l.clone())).collect(),
        None => {
            let mut found = holes::boundary_loops(vertices.len(), triangles)?;
            if let Some(most) = options.max_edges {
                found.retain(|l| l.as_ref().map_or(true, |l| l.len() <= most));
            }
            found
        }
    };
    steady(progress, |progress| Job { vertices, triangles, options }.run(&loops, progress))
}
