//! Semi-regular triangle meshes from closed curves.
#![forbid(unsafe_code)]

pub mod axial;
pub mod dir;
pub mod error;
pub mod lattice;
pub mod patch;
pub mod progress;
pub mod relax;
