//! From the flat patch to a round body.

mod crease;
mod fan;
mod field;
mod front;
mod height;
mod inlets;
mod lengthen;
mod limit;
mod options;
mod pairs;
mod polish;
mod section;
mod side;
mod spread;
mod twins;

use glam::DVec2;

use crate::body::inflate::front::{Front, Guide};
pub use crate::body::inflate::options::{InflateOptions, Profile, Side};
use crate::body::stitch::projects_well;
use crate::body::surface::Surface;
use crate::error::{Error, Result};
use crate::geometry::embed::count_self_intersections;
use crate::geometry::laplace::Pattern;
use crate::geometry::topology::Topology;
use crate::options::CellShape;
use crate::patch::Patch;
use crate::progress::{Clock, Progress, Rising};
use field::Field;
use height::{Flat, bends, squared_height};
use inlets::Inlets;
use section::Section;
use spread::spread;
use twins::Twins;

/// Inflates a patch to a closed body: two copies of it ([`Patch::belted`]) glued along its contours, the front at
/// z > 0, the back at z < 0.
///
/// The height of the front is the square root of a smooth field over the drawing, zero on the
/// silhouette ([`Profile`] names it; for `Round` the solution of a Poisson equation, softened where
/// the outline is hollow). The surface `z^2 = f(x, y)` runs smoothly across the silhouette. Then the
/// vertices slide along it until its triangles are even and nearly isotropic.
///
/// Guaranteed:
/// * the silhouette's x and y are those of [`Patch::belted`] bit for bit (unless [`InflateOptions::subdivided`] moves it), its
///   z is zero;
/// * front and back have the same x and y, and if their depths agree are exact mirror images;
/// * the body of a patch that is its own mirror image is one too, up to rounding;
/// * all vertices lie inside the drawing; every triangle is positive in projection, so that the
///   body is embedded. Exact predicates check this in the end, also after rounding to `f32`; should
///   it fail (a patch that breaks its own promises), intersections are counted and reported;
/// * at depth 1 the vertices of a circle's `Round` body lie on a sphere, whatever the resolution.
///
/// Not guaranteed: the least angle, which narrow and re-entrant corners limit.
///
/// Depths scale heights only. Near-linear time: about 20 ms for a smooth body of 5000 vertices, two sparse
/// factorisations included.
///
/// # Errors
/// [`Error::InvalidOption`] for a depth out of range, a side's depth that is negative, above 1e9 or zero on
/// both sides, or too few values per point; [`Error::Solver`] if the patch has no interior vertex or a
/// triangle that is not positive; [`Error::Cancelled`].
///
/// Source: the job is that of Nealen et al., FiberMesh, SIGGRAPH 2007, which diffuses curvature and
/// refits positions in rounds. We differ: its rounds start from an even mesh and lose height on an
/// uneven one, and they prove nothing. Here the surface itself is fair (it solves an elliptic
/// equation), and only its sampling is optimised, under an invariant that excludes
/// self-intersections.
pub fn inflate(patch: &Patch, options: &InflateOptions, progress: Progress<'_>) -> Result<Surface> {
    let mut clock = Clock::new();
    options.check()?;
    let patch = patch.belted();
    let rising = Rising::new(progress);
    let callback = |fraction: f64| rising.report(fraction);
    let progress = Progress::new(&callback);
    let first = patch.n_boundary();
    if first >= patch.vertices.len() {
        return Err(Error::Solver { stage: "inflation", reason: "the patch has no interior vertex".into() });
    }
    progress.report(0.0)?;
    let sheet = patch.of_triangles();
    let topology = Topology::new(patch.vertices.len(), &sheet.triangles);
    progress.report(0.05)?;
    let pattern = Pattern::new(&topology, first, progress.part(0.05, 0.05))?;
    progress.report(0.1)?;
    let (low, high) = patch
        .vertices
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let middle = 0.5 * (low + high);
    let vertices = patch.vertices.iter().map(|&p| p - middle).collect::<Vec<_>>();
    let flat = Flat::new(&sheet, &vertices, &topology, &pattern, progress.part(0.2, 0.4))?;
    clock.stage("analyse");
    progress.report(0.2)?;

    let height = squared_height(&flat, options.profile, options.corner_angle)?;
    let scales = side::scales(&flat, options)?;
    let depth = scales.largest_mean();
    let squared = depth * depth;
    let mut field = Field {
        vertices: &vertices,
        triangles: &sheet.triangles,
        topology: &topology,
        value: height.value.iter().map(|f| f * squared).collect(),
        gradient: height.gradient.iter().map(|g| *g * squared).collect(),
        squared_depth: squared,
        section: None,
    };
    field.section = Section::new(options.curve.as_deref(), field.highest());
    clock.stage("height");
    progress.report(0.4)?;

    let mut front = Front::new(&field, first);
    progress.report(0.4)?;
    let twins = Twins::find(patch, &vertices);
    progress.report(0.4)?;
    let corners = patch.corners();
    if options.profile != Profile::Peak {
        // Far above what rounding to f32 can turn over.
        let extent = (high - low).max_element();
        let least_area = 4.0 * f64::from(f32::EPSILON) * extent * patch.lattice.edge_length;
        let bends = bends(&flat, &field.value, &field.gradient, depth);
        let guide =
            Guide::new(&field, patch, |v| bends[v].limb, Inlets::new(patch, middle), depth, least_area);
        spread(&mut front, &guide, progress.part(0.4, 0.8))?;
        if let Some(twins) = &twins {
            progress.report(0.8)?;
            twins.even(&mut front, &field, (&corners, least_area), |p| guide.inlets.hold(p));
        }
    } else if let Some(twins) = &twins {
        twins.even(&mut front, &field, (&corners, 0.0), |_| false);
    }
    clock.stage("spread");

    let positions = in_plane(patch, &front, middle, options);
    let lift = |data: &[f64], sign: f64, v: usize| {
        let scale = field.linear(data, front.place[v - first]);
        positions[v].extend(sign * scale / depth * front.height[v])
    };
    let top = (0..positions.len())
        .map(|v| if v < first { positions[v].extend(0.0) } else { lift(&scales.front, 1.0, v) })
        .collect::<Vec<_>>();
    let bottom = (first..positions.len()).map(|v| lift(&scales.back, -1.0, v)).collect::<Vec<_>>();
    if !top.iter().chain(&bottom).all(|p| p.is_finite()) {
        return Err(Error::Solver { stage: "inflation", reason: "a height is not a number".into() });
    }
    progress.report(0.85)?;
    let apart = top[first..].iter().zip(&bottom).all(|(a, b)| a.z >= 0.0 && b.z <= 0.0 && a.z > b.z);
    let mut surface = Surface::assemble(patch, top, Some(bottom), options.uv, || progress.report(0.85))?;
    surface.report.shortened = front.shortened;
    surface.report.repaired = height.lifted + usize::from(height.limited);
    clock.stage("assemble");
    progress.report(0.9)?;

    surface.report.embedded = apart && projects_well(patch, &positions);
    if !surface.report.embedded {
        let triangles = surface.triangulated();
        surface.report.self_intersections = count_self_intersections(&surface.vertices, &triangles);
    }
    clock.stage("check");
    surface.report.seconds = clock.seconds;
    progress.report(1.0)?;
    Ok(surface)
}

/// Where the vertices of the front lie in the plane.
fn in_plane(patch: &Patch, front: &Front, middle: DVec2, options: &InflateOptions) -> Vec<DVec2> {
    let place = |v: usize| if v < front.first { patch.vertices[v] } else { front.flat[v] + middle };
    let mut positions: Vec<DVec2> = (0..patch.vertices.len()).map(place).collect();
    if options.subdivided && patch.cells() == CellShape::Quad {
        limit::fit_rim(patch, &mut positions, options.profile == Profile::Peak);
    }
    positions
}
