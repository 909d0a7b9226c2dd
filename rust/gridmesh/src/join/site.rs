//! What is known when a patch is made.

use rustc_hash::FxHashMap;

use super::options::JoinOptions;
use super::parts::Parts;
use super::rims::Outside;
use super::strips::Strip;
use super::union::Union;
use crate::fill::even::untangle::Near;
use crate::fill::surface::meet::Box3;

/// What patches are made for.
pub(super) struct Site<'a> {
    pub parts: &'a Parts,
    pub union: &'a Union,
    pub seams: &'a [([u32; 2], [u32; 2])],
    pub outside: Outside,
    pub options: &'a JoinOptions,
    /// The faces that stay, as triangles, and the face of each.
    pub kept: Vec<[u32; 3]>,
    pub polygons: Vec<u32>,
    /// By how much a patch may change the volume, beside what makes it no blend at all.
    pub allowed: f64,
}

impl Site<'_> {
    /// What stays near a strip. `place`: the numbers of the vertices of its border.
    pub fn near(&self, strip: &Strip, place: &FxHashMap<u32, u32>) -> Near {
        let corners = strip.triangles.iter().flat_map(|&t| self.union.triangles[t as usize]);
        let own = Box3::around(corners.map(|v| self.union.vertices[v as usize]));
        let wide = 0.2 * (own.high - own.low).max_element();
        let around = Box3 { low: own.low - wide, high: own.high + wide };
        Near::new(around, &self.parts.vertices, &self.kept, place)
    }
}
