//! Semi-regular triangle meshes from closed curves.
#![forbid(unsafe_code)]

pub mod axial;
pub mod band;
pub mod curve;
pub mod dir;
pub mod error;
pub mod lattice;
pub mod orient;
pub mod patch;
pub mod progress;
mod segments;
pub mod target;
pub mod trace;
