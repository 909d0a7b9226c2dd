//! From a drawing to the closed lattice path that becomes the boundary of its patch.

pub mod band;
pub mod growth;
pub mod inset;
pub mod mapping;
pub mod orient;
pub(crate) mod outline;
pub mod placement;
pub mod raster;
pub mod target;
pub mod trace;
