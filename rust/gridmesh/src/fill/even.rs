//! Meshes with a fixed border whose triangles are made even: for patches that no grid can make.
//!
//! `local` is the mesh whose edges are split, collapsed and flipped, `remesh` does so until all are about as long as wanted, on the
//! surface as it was (`nearest`), `regular` takes irregular vertices out (`net`), `fair` makes the surface smooth to what lies beyond the
//! border, `polish` makes thin triangles rounder, `untangle` takes back what of it meets something, `slivers` what thin triangles
//! that has left.

pub(crate) mod fair;
pub(crate) mod local;
pub(crate) mod nearest;
mod net;
pub(crate) mod polish;
pub(crate) mod regular;
pub(crate) mod remesh;
pub(crate) mod slivers;
pub(crate) mod untangle;
