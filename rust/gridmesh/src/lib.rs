//! Semi-regular triangle meshes from closed curves, smooth bodies of them, and grid patches for holes and cuts.
//!
//! ```
//! use glam::DVec2;
//! use gridmesh::{InflateOptions, Progress, SketchOptions, inflate, mesh_sketch};
//!
//! # fn main() -> Result<(), gridmesh::Error> {
//! let outline: Vec<DVec2> = (0..100)
//!     .map(|k| f64::from(k) / 100.0 * std::f64::consts::TAU)
//!     .map(|t| (2.0 + (3.0 * t).cos()) * DVec2::from_angle(t))
//!     .collect();
//! let options = SketchOptions { triangles: Some(2000), ..SketchOptions::default() };
//! let sketch = mesh_sketch(&outline, &[], &options, Progress::NONE)?;
//! let body = inflate(&sketch.patch, &InflateOptions::default(), Progress::NONE)?;
//!
//! assert!(body.report.watertight && body.report.genus == 0);
//! assert!(sketch.report.irregular < 60);
//! # Ok(())
//! # }
//! ```
//!
//! # What it does
//!
//! * [`mesh_sketch`]: a flat patch for an outline with holes. Boundary vertices lie on the drawing, interior vertices have
//!   six neighbours, no triangle is inverted, and no interior edge joins two boundary vertices, so that two copies glued
//!   along the boundary are a closed manifold.
//! * [`inflate`], [`stitch`], [`flat`]: the patch as a round body, a pillow, a sheet.
//! * [`trace_image`](picture::trace_image), [`mesh_cutout`](cutout::mesh_cutout): the outlines in a picture, and meshes of all of them.
//! * [`fill_hole`], [`fill_holes`], [`regrid`]: patches whose boundary is that of a hole, vertex for vertex, smooth to
//!   the surface around it.
//! * [`bridge()`], [`bridge_pairs`]: a tube between two loops, with every vertex of both; more loops joined two by two.
//! * [`cut()`]: a mesh divided along a swept stroke, the pieces closed by such patches.
//! * [`join()`]: closed meshes united, blended by such patches where they meet.
//!
//! # What holds everywhere
//!
//! Everything returned keeps its promises, or an [`Error`] says what is wrong, where, what is allowed and what to do; no input makes
//! it panic. The same input gives the same bytes for any number of threads, on every system and processor. Whatever takes long reports
//! progress, and stops where that returns false. Positions are `f64`, angles are in radians.
//!
//! Source: Nealen, Pett, Alexa, Igarashi: *GridMesh: Fast and High Quality 2D Mesh Generation for Interactive 3D Shape
//! Modeling*, 2009. What is done beyond it, and why, is told in `docs/algorithm.md`, where things are in `docs/architecture.md`.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod bend;
pub mod body;
pub mod cover;
pub mod cut;
pub mod cutout;
pub mod drawing;
pub mod error;
pub mod fill;
pub mod geometry;
pub mod join;
pub mod lattice;
pub mod options;
pub mod patch;
pub mod path;
pub mod picture;
pub mod progress;
pub mod relax;
pub mod sketch;
#[cfg(feature = "svg")]
pub mod svg;

pub use body::inflate::{InflateOptions, inflate};
pub use body::stitch::{flat, stitch};
pub use body::surface::Surface;
pub use cut::{Cut, CutOptions, cut};
pub use error::{Error, LoopError};
pub use fill::{
    BridgeOptions, Fill, FillOptions, Smooth, bridge, bridge_pairs, fill_hole, fill_holes, regrid,
};
pub use join::{JoinOptions, Joined, join};
pub use options::SketchOptions;
pub use patch::Patch;
pub use progress::Progress;
pub use sketch::{Sketch, mesh_sketch};

#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
