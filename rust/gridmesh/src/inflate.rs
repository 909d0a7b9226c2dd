//! From the flat patch to a round body.

mod crease;
mod field;
mod height;
mod inlets;
pub(crate) mod laplace;
mod polish;
mod section;
mod side;
mod spread;
pub(crate) mod topology;

use std::time::Instant;

use glam::DVec2;

use crate::embed::count_self_intersections;
use crate::error::{Error, Result};
use crate::patch::Patch;
use crate::progress::{Progress, Rising};
use crate::stitch::projects_well;
use crate::surface::{Surface, UvLayout};
use field::Field;
use height::{Flat, bends, squared_height};
use inlets::Inlets;
use laplace::Pattern;
use section::Section;
pub use side::Side;
use spread::{Front, Guide, spread};
use topology::Topology;

/// Shape of the body's cross-section.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Profile {
    /// A circle becomes a sphere, a long limb of half width `w` a bulge of height `1.41 w`.
    #[default]
    Round,
    /// A circle becomes a sphere, and a long limb a round tube: height about the half width.
    Even,
    /// A plateau with a rounded rim; the rim's radius, and so the height at depth one, is about a
    /// third of the radius of the largest circle that fits into the drawing.
    Flat,
    /// A tent: the height is the distance from the outline, slightly smoothed at the ridges. A
    /// circle becomes a cone as high as its radius. The silhouette is an edge.
    Peak,
}

/// How [`inflate`] works.
#[derive(Clone, Debug, PartialEq)]
pub struct InflateOptions {
    /// Scales the height of both sides: 1e-9 to 1e9.
    pub depth: f64,
    /// Shape of the cross-section.
    pub profile: Profile,
    /// Depth of the front, in place of `depth`.
    pub front: Option<Side>,
    /// Depth of the back, in place of `depth`.
    pub back: Option<Side>,
    /// Reshapes the profile: values at evenly spaced arguments from 0 to 1 of a curve `c`. With `h` the
    /// height that the profile gives somewhere and `top` the largest of the body it becomes
    /// `top c(h / top)`. The first value is 0, the others positive; they may fall, for rings and dents.
    pub curve: Option<Vec<f64>>,
    /// Turning angle in radians from which on a drawn corner stays a corner; below it the stroke
    /// is taken for a coarsely drawn smooth one and the body is rounded there.
    pub corner_angle: f64,
    /// Where the back lies in the texture.
    pub uv: UvLayout,
}

impl Default for InflateOptions {
    fn default() -> Self {
        InflateOptions {
            depth: 1.0,
            profile: Profile::Round,
            front: None,
            back: None,
            curve: None,
            corner_angle: 40f64.to_radians(),
            uv: UvLayout::Apart,
        }
    }
}

/// Inflates a patch to a closed body: two copies of it glued along its contours, the front at
/// z > 0, the back at z < 0.
///
/// The height of the front is the square root of a smooth field over the drawing, zero on the
/// silhouette ([`Profile`] names it; for `Round` the solution of a Poisson equation, softened where
/// the outline is hollow). The surface `z^2 = f(x, y)` runs smoothly across the silhouette. Then the
/// vertices slide along it until its triangles are even and nearly isotropic.
///
/// Guaranteed:
/// * the silhouette's x and y are the patch's bit for bit, its z is zero;
/// * front and back have the same x and y, and if their depths agree are exact mirror images;
/// * all vertices lie inside the drawing; every triangle is positive in projection, so that the
///   body is embedded. Exact predicates check this in the end, also after rounding to `f32`; should
///   it fail (a patch that breaks its own promises), intersections are counted and reported;
/// * at depth 1 the vertices of a circle's `Round` body lie on a sphere, whatever the resolution.
///
/// Not guaranteed: the least angle, which narrow and re-entrant corners limit.
///
/// Depths scale heights only. Near-linear time: about 13 ms for a body of 5000 vertices, two sparse
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
    let mut clock = Stages::new();
    options.check()?;
    let rising = Rising::new(progress);
    let callback = |fraction: f64| rising.report(fraction);
    let progress = Progress::new(&callback);
    let first = patch.n_boundary();
    if first >= patch.vertices.len() {
        return Err(Error::Solver { stage: "inflation", reason: "the patch has no interior vertex".into() });
    }
    progress.report(0.0)?;
    let topology = Topology::new(patch.vertices.len(), &patch.triangles);
    let pattern = Pattern::new(&topology, first)?;
    let (low, high) = patch
        .vertices
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let middle = 0.5 * (low + high);
    let vertices = patch.vertices.iter().map(|&p| p - middle).collect::<Vec<_>>();
    let flat = Flat::new(patch, &vertices, &topology, &pattern, progress.part(0.2, 0.4))?;
    clock.stage("analyse");
    progress.report(0.2)?;

    let height = squared_height(&flat, options.profile, options.corner_angle)?;
    let scales = side::scales(&flat, options)?;
    let depth = scales.largest_mean();
    let squared = depth * depth;
    let mut field = Field {
        vertices: &vertices,
        triangles: &patch.triangles,
        topology: &topology,
        value: height.value.iter().map(|f| f * squared).collect(),
        gradient: height.gradient.iter().map(|g| *g * squared).collect(),
        section: None,
    };
    field.section = Section::new(options.curve.as_deref(), field.highest());
    clock.stage("height");
    progress.report(0.4)?;

    let mut front = Front::new(&field, first);
    if options.profile != Profile::Peak {
        // Far above what rounding to f32 can turn over.
        let extent = (high - low).max_element();
        let least_area = 4.0 * f64::from(f32::EPSILON) * extent * patch.lattice.edge_length;
        let bends = bends(&flat, &field.value, &field.gradient, depth);
        let guide = Guide::new(
            &field,
            |v| bends[v].limb,
            &patch.loops,
            Inlets::new(patch, middle),
            depth,
            least_area,
        );
        spread(&mut front, &guide, progress.part(0.4, 0.8))?;
    }
    clock.stage("spread");

    let positions = (0..patch.vertices.len())
        .map(|v| if v < first { patch.vertices[v] } else { front.flat[v] + middle })
        .collect::<Vec<_>>();
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
    let apart = top[first..].iter().zip(&bottom).all(|(a, b)| a.z >= 0.0 && b.z <= 0.0 && a.z > b.z);
    let mut surface = Surface::assemble(patch, top, Some(bottom), options.uv);
    let report = &mut surface.report;
    report.shortened = front.shortened;
    report.repaired = height.lifted + usize::from(height.limited);
    clock.stage("assemble");
    progress.report(0.9)?;

    report.embedded = apart && projects_well(patch, &positions);
    if !report.embedded {
        report.self_intersections = count_self_intersections(&surface.vertices, &surface.triangles);
    }
    clock.stage("check");
    report.seconds = clock.seconds;
    progress.report(1.0)?;
    Ok(surface)
}

/// Seconds per stage.
struct Stages {
    since: Instant,
    seconds: Vec<(&'static str, f64)>,
}

impl Stages {
    fn new() -> Self {
        Stages { since: Instant::now(), seconds: vec![] }
    }

    fn stage(&mut self, name: &'static str) {
        self.seconds.push((name, self.since.elapsed().as_secs_f64()));
        self.since = Instant::now();
    }
}
