//! What is known when a patch is made.

use super::options::JoinOptions;
use super::parts::Parts;
use super::rims::Outside;
use super::union::Union;

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
}
