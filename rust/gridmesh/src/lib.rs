//! Semi-regular triangle meshes from closed curves.
#![forbid(unsafe_code)]

pub mod axial;
pub mod dir;
pub mod embed;
pub mod error;
pub mod inflate;
pub mod lattice;
pub mod metrics;
pub mod patch;
pub mod progress;
pub mod stitch;
pub mod surface;
