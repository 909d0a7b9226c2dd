//! A tube between two loops, with every vertex of both.
//!
//! Of triangles, a tube needs no irregular vertex: it is a piece of the lattice on a cylinder or a cone (`rings`). The loops are closed
//! paths on it (`route`), chosen with the cone (`choose`), what lies between them is triangulated (`tube`), placed on a surface
//! that goes on from both sides (`rail`, `loft`; out of holes in sheets by `necks`) and moved within it to where faces are good (`settle`). Of quads it is rings of
//! squares (`squares`), placed in the same way.

pub(in crate::fill) mod align;
mod choose;
mod loft;
mod necks;
mod options;
mod pairs;
mod rail;
mod refit;
mod rings;
mod route;
mod settle;
mod span;
mod squares;
mod tube;

use glam::DVec3;

use crate::error::Result;
use crate::fill::filled::Fill;
use crate::fill::job::Job;
use crate::fill::parallel::steady;
use crate::progress::Progress;

pub(in crate::fill) use self::necks::ALIKE;
pub use self::options::BridgeOptions;
pub(in crate::fill) use self::pairs::apart;
pub use self::pairs::{Pair, bridge_pairs, look_apart};
pub(in crate::fill) use self::rail::{ahead, is_pipe};
pub(in crate::fill) use self::span::{onward_of, tube};

/// Joins two loops of a mesh by a tube.
///
/// Each of `loop_` and `other` is as for [`fill_hole`](super::fill_hole); they must have no vertex in common. The result's boundary is
/// exactly the two loops: no vertex of them is moved and none is added, each of their edges gets one new face, wound against
/// its neighbour. Where the surfaces at the two loops do not agree on the winding the larger number of edges decides and the report counts the
/// others; a loop without faces is taken the way round that does not turn the tube inside out. Between loops that look the same way, as two
/// holes in a wall do, the tube is a handle on the side to which their faces are turned. The tube is an annulus, and
/// no new edge or face repeats one of the mesh. Inside, every vertex has six neighbours wherever the counts allow: the
/// report says how many do not. With [`cells`](BridgeOptions::cells) for quads the new faces are quads, and one triangle if the sum
/// of the counts is odd; every vertex inside has four of them where the counts are equal, and where they are not two poles, of
/// three and five, for as many vertices as two for each row. The loop of the [`Fill`] is `loop_` followed by `other`.
///
/// The same input gives the same output for any number of threads.
///
/// # Errors
/// Those of [`fill_hole`](super::fill_hole); [`Error::Loops`](crate::Error::Loops) for loops that share a vertex or touch,
/// [`Error::InvalidOption`](crate::Error::InvalidOption) for no rows or a twist that is not finite, [`Error::TooLarge`](crate::Error::TooLarge) beyond 20 million triangles.
///
/// Source: lattices on cones as in Thurston, *Shapes of polyhedra and triangulations of the sphere*, 1998; the
/// exact counts as in Nealen et al. 2009, section V.
pub fn bridge(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    loop_: &[u32],
    other: &[u32],
    options: &BridgeOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    steady(progress, |progress| bridged(vertices, triangles, [loop_, other], options, progress))
}

fn bridged(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    given: [&[u32]; 2],
    options: &BridgeOptions,
    progress: Progress<'_>,
) -> Result<Fill> {
    progress.report(0.0)?;
    let rest = options.rest(triangles)?;
    let fill = tube(vertices, triangles, given, options, &rest, progress.part(0.0, 0.8))?;
    let mut fills = [Ok(fill)];
    Job { vertices, triangles, options: &rest }.count_meetings(&mut fills, progress.part(0.8, 1.0))?;
    let [fill] = fills;
    progress.report(1.0)?;
    fill
}
