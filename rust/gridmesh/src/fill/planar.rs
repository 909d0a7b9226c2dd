//! A patch in the plane for a closed polygon, vertex for vertex.

pub(crate) mod exact;
pub(crate) mod flat;
pub(crate) mod flat_patch;
pub(crate) mod flips;
pub(crate) mod graded;
pub(crate) mod grown;
pub(crate) mod mean_value;
pub(crate) mod place;
pub(crate) mod quads;
pub(crate) mod quality;
mod scaled;
pub(crate) mod settle;
pub(crate) mod small;
pub(crate) mod steps;
pub(crate) mod walls;
