//! From the flat patch to a round body.

mod field;
mod height;
mod laplace;
mod side;
mod spread;
mod topology;

use std::time::Instant;

use glam::DVec2;

use crate::embed::count_self_intersections;
use crate::error::{Error, Result};
use crate::patch::Patch;
use crate::progress::Progress;
use crate::stitch::projects_well;
use crate::surface::Surface;
use field::Field;
use height::{Flat, limbness, squared_height};
use laplace::Pattern;
pub use side::Side;
use spread::Front;
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
    /// Scales the height of both sides; positive.
    pub depth: f64,
    /// Shape of the cross-section.
    pub profile: Profile,
    /// Depth of the front, in place of `depth`.
    pub front: Option<Side>,
    /// Depth of the back, in place of `depth`.
    pub back: Option<Side>,
    /// Turning angle in radians from which on a drawn corner stays a corner; below it the stroke
    /// is taken for a coarsely drawn smooth one and the body is rounded there.
    pub corner_angle: f64,
}

impl Default for InflateOptions {
    fn default() -> Self {
        InflateOptions {
            depth: 1.0,
            profile: Profile::Round,
            front: None,
            back: None,
            corner_angle: 40f64.to_radians(),
        }
    }
}

/// Rounds of sliding at most.
const STEPS: usize = 6;

pub fn inflate(patch: &Patch, options: &InflateOptions, progress: Progress<'_>) -> Result<Surface> {
    let mut clock = Stages::new();
    options.check()?;
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
    let flat = Flat::new(patch, &vertices, &topology, &pattern)?;
    clock.stage("analyse");
    progress.report(0.2)?;

    let height = squared_height(&flat, options.profile, options.corner_angle)?;
    let scales = side::scales(&flat, options)?;
    let depth = scales.largest_mean();
    let squared = depth * depth;
    let field = Field {
        vertices: &vertices,
        triangles: &patch.triangles,
        topology: &topology,
        value: height.value.iter().map(|f| f * squared).collect(),
        gradient: height.gradient.iter().map(|g| *g * squared).collect(),
    };
    clock.stage("height");
    progress.report(0.4)?;

    let mut front = Front::new(&field, first);
    if options.profile != Profile::Peak {
        // Far above what rounding to f32 can turn over.
        let extent = (high - low).max_element();
        let least_area = 4.0 * f64::from(f32::EPSILON) * extent * patch.lattice.edge_length;
        let limb = limbness(&flat, &field.gradient, depth);
        let goal = spread::unrolled_heights(&field, &limb);
        let crease = spread::creases(&field, &patch.loops, first);
        let legs: usize = spread::tune().legs;
        let between: usize = spread::tune().between;
        for leg in 0..legs {
            spread::slide(&mut front, &field, &goal, &crease, 1.0 / (legs - leg) as f64, depth, least_area);
            for _ in 0..between {
                spread::sweep(&mut front, &field, &crease, least_area);
            }
        }
        for _ in 0..spread::tune().sweeps {
            spread::sweep(&mut front, &field, &crease, least_area);
        }
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
    let apart = top[first..].iter().zip(&bottom).all(|(a, b)| a.z >= 0.0 && b.z <= 0.0 && a.z > b.z);
    let mut surface = Surface::assemble(patch, top, Some(bottom));
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
