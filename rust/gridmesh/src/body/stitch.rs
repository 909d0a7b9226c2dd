//! Flat surfaces: a patch as a sheet, or two copies of it as a pillow.

use std::convert::Infallible;
use std::time::Instant;

use glam::{DVec2, DVec3};

use crate::body::surface::{Surface, UvLayout, contours};
use crate::geometry::embed::is_planar_embedding;
use crate::patch::Patch;

/// Two copies of the patch glued along all contours, flat in the plane z = 0.
///
/// The front is the patch, facing +z; the back is its mirror image, facing -z. A patch has no
/// chords, so the result is a closed manifold: a sphere, or with `g` holes a body of genus `g`. Its
/// boundary vertices of patch valence `v` get valence `2 v - 2`; of a patch of quads, which is its
/// [belted](Patch::belted) one, four. Linear.
///
/// Source: Nealen et al. 2009, section II.
pub fn stitch(patch: &Patch) -> Surface {
    let patch = patch.belted();
    let back = patch.vertices[patch.n_boundary()..].iter().map(|p| p.extend(0.0)).collect();
    build(patch, Some(back))
}

/// The patch as one sheet in the plane z = 0, facing +z. Linear.
pub fn flat(patch: &Patch) -> Surface {
    build(patch, None)
}

fn build(patch: &Patch, back: Option<Vec<DVec3>>) -> Surface {
    let clock = Instant::now();
    let front = patch.vertices.iter().map(|p| p.extend(0.0)).collect();
    let go_on = || Ok::<(), Infallible>(());
    let Ok(mut surface) = Surface::assemble(patch, front, back, UvLayout::Apart, go_on);
    surface.report.embedded = projects_well(patch, &patch.vertices);
    if !surface.report.embedded {
        surface.report.self_intersections = crate::geometry::embed::count_self_intersections(
            &surface.vertices[..patch.vertices.len()],
            &patch.triangulated(),
        );
    }
    surface.report.seconds.push(("stitch", clock.elapsed().as_secs_f64()));
    surface
}

/// Whether `positions` of the patch's vertices are a planar mesh of its cells, quads convex, also after rounding to `f32`.
pub(crate) fn projects_well(patch: &Patch, positions: &[DVec2]) -> bool {
    let contours = contours(patch);
    let rounded =
        positions.iter().map(|&p| (p - patch.lattice.origin).as_vec2().as_dvec2()).collect::<Vec<_>>();
    let corners = patch.corners();
    is_planar_embedding(positions, &corners, &contours) && is_planar_embedding(&rounded, &corners, &contours)
}
