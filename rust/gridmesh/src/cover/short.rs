//! Ends of short edges moved apart.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::error::Result;
use crate::geometry::active::{Visit, turn, visit_active};
use crate::geometry::lengthen::{ROUNDS, THIN, lack};
use crate::geometry::topology::Topology;
use crate::patch::Patch;
use crate::progress::Progress;

/// Edges shorter than this, in mean lengths of the patch's edges, are made longer: a third shows in a texture.
const SHORT: f64 = 0.37;

/// The same for edges of the boundary, whose length a body keeps, while its other edges become longer: the mean of a
/// sphere's is that of its silhouette's disk times the square root of two.
const SHORT_OF_BOUNDARY: f64 = 0.37 * std::f64::consts::SQRT_2;

/// Stages of [`THIN`] that are gone through.
const STAGES: usize = 3;

/// Lengths of moves tried, in lengths wanted.
const REACHES: [f64; 3] = [0.5, 0.2, 0.07];

/// Directions of moves tried.
const DIRECTIONS: usize = 12;

/// The lengths that the edges of a patch should have at least.
pub(super) struct Lengths {
    topology: Topology,
    n_boundary: usize,
    inner: f64,
    rim: f64,
}

impl Lengths {
    pub fn new(patch: &Patch) -> Self {
        let topology = Topology::new(patch.vertices.len(), &patch.corners());
        let mean = mean_side(patch);
        let n_boundary = patch.n_boundary();
        Self { topology, n_boundary, inner: SHORT * mean, rim: SHORT_OF_BOUNDARY * mean }
    }

    fn near(&self, vertex: usize) -> &[u32] {
        &self.topology.near[self.topology.range(vertex)]
    }

    /// The vertices beside one that are not on the boundary.
    pub fn inner_near(&self, vertex: usize) -> impl Iterator<Item = usize> + '_ {
        self.near(vertex).iter().map(|&v| v as usize).filter(|&v| v >= self.n_boundary)
    }

    fn wanted(&self, a: usize, b: usize) -> f64 {
        if a < self.n_boundary && b < self.n_boundary { self.rim } else { self.inner }
    }

    /// What the edges at a vertex lack.
    pub fn lacking(&self, patch: &Patch, vertex: usize) -> f64 {
        let here = patch.vertices[vertex];
        let lack = |&other: &u32| {
            let other = other as usize;
            lack(here.distance(patch.vertices[other]), self.wanted(vertex, other))
        };
        self.near(vertex).iter().map(lack).sum()
    }

    /// Cotangent of the least angle of the triangles at a vertex; infinite if one of them is inverted.
    pub fn sharpest(&self, patch: &Patch, vertex: usize) -> f64 {
        let here = patch.vertices[vertex];
        let largest = |&[i, j]: &[u32; 2]| {
            let (a, b) = (patch.vertices[i as usize] - here, patch.vertices[j as usize] - here);
            let (c, doubled) = (b - a, a.perp_dot(b));
            if doubled > 0.0 { a.dot(b).max(b.dot(c)).max(-a.dot(c)) / doubled } else { f64::INFINITY }
        };
        self.topology.fan(vertex).iter().map(largest).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Moves vertices until the edges at them are as long as they should be, as far as the corners of faces allow, in stages
/// that are ever more lenient.
///
/// `may` decides about moves of boundary vertices, after they were made.
pub(super) fn lengthened(
    patch: &mut Patch,
    mut may: impl FnMut(&Patch, usize) -> bool,
    progress: Progress<'_>,
) -> Result<()> {
    let lengths = Lengths::new(patch);
    let near = |v: usize| lengths.near(v).iter().copied();
    for thin in &THIN[..STAGES] {
        visit_active(0..patch.vertices.len(), near, ROUNDS, progress, |v, round| {
            if lengths.lacking(patch, v) == 0.0 {
                Visit::Done
            } else if moved(patch, &lengths, v, (*thin, turn(round)), &mut may) {
                Visit::Moved
            } else {
                Visit::Stuck
            }
        })?;
    }
    Ok(())
}

/// Moves a vertex to the best of a few places around it; false if none is better.
fn moved(
    patch: &mut Patch,
    lengths: &Lengths,
    v: usize,
    (thin, turn): (f64, f64),
    may: &mut impl FnMut(&Patch, usize) -> bool,
) -> bool {
    let start = patch.vertices[v];
    let present = lengths.lacking(patch, v);
    let thin = lengths.sharpest(patch, v).max(thin);
    let mut places = vec![];
    for reach in REACHES {
        for k in 0..DIRECTIONS {
            let way = DVec2::from_angle(TAU * k as f64 / DIRECTIONS as f64 + turn);
            let place = start + reach * lengths.inner * way;
            patch.vertices[v] = place;
            let lack = lengths.lacking(patch, v);
            if lack < 0.999 * present && lengths.sharpest(patch, v) <= thin {
                places.push((lack, place));
            }
        }
    }
    places.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    for (_, place) in places {
        patch.vertices[v] = place;
        if v >= lengths.n_boundary || may(patch, v) {
            return true;
        }
    }
    patch.vertices[v] = start;
    false
}

/// Mean length of the sides of all faces.
fn mean_side(patch: &Patch) -> f64 {
    let (mut sum, mut count) = (0.0, 0usize);
    for [a, b] in patch.sides() {
        sum += patch.vertices[a as usize].distance(patch.vertices[b as usize]);
        count += 1;
    }
    sum / count.max(1) as f64
}
