//! Semi-regular triangle meshes from closed curves.
#![forbid(unsafe_code)]

pub mod assemble;
pub mod axial;
pub mod band;
pub mod boundary;
pub mod cells;
pub mod curve;
pub mod dir;
pub mod error;
pub mod growth;
pub mod lattice;
pub mod mapping;
pub mod patch;
pub mod progress;
pub mod raster;
mod segments;
pub mod target;
