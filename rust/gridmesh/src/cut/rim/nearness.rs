//! Distances from triangles.

use glam::DVec3;

pub(in crate::cut) use crate::geometry::facet::{Facet, closest, within};

/// Points of a triangle where its distance from others is taken: a lattice with at least six steps to an edge, and
/// steps no longer than `spacing` while that makes no more than 24. The middles of the edges come first, corners
/// not at all.
pub(in crate::cut) fn samples([a, b, c]: [DVec3; 3], spacing: f64) -> impl Iterator<Item = DVec3> {
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a)).sqrt();
    let n = (longest / spacing).ceil().clamp(6.0, 24.0) as u32;
    let at = move |i: u32, j: u32| {
        let [u, v, w] = [i, j, n - i - j].map(|k| f64::from(k) / f64::from(n));
        (i.max(j).max(n - i - j) < n).then(|| u * a + v * b + w * c)
    };
    let middles = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
    middles.into_iter().chain((0..=n).flat_map(move |i| (0..=n - i).filter_map(move |j| at(i, j))))
}

/// An old triangle.
#[derive(Clone, Copy, Debug)]
pub(in crate::cut) struct Home {
    pub face: u32,
    pub corners: [u32; 3],
    pub facet: Facet,
}
