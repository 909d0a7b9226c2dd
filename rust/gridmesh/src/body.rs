//! From a flat patch to a surface in space.

pub mod inflate;
pub mod stitch;
pub mod surface;
