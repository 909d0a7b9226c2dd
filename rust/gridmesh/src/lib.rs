//! Semi-regular triangle meshes from closed curves.
#![forbid(unsafe_code)]

pub mod assemble;
pub mod axial;
pub mod band;
pub mod bend;
pub mod boundary;
pub mod cells;
pub mod combine;
pub mod contours;
pub mod curve;
pub mod cut;
mod deviation;
pub mod dir;
pub mod embed;
pub mod error;
mod expel;
pub mod fill;
pub mod growth;
pub mod inflate;
pub mod lattice;
pub mod mapping;
pub mod metrics;
mod mirror;
pub mod options;
pub mod orient;
mod outline;
pub mod patch;
mod place;
mod pockets;
pub mod progress;
pub mod raster;
pub mod reflection;
pub mod relax;
mod segments;
pub mod sketch;
pub mod stitch;
pub mod surface;
#[cfg(feature = "svg")]
pub mod svg;
mod symmetry;
pub mod target;
pub mod thickness;
pub mod trace;
mod union;
