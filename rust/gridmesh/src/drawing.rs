//! What was drawn: closed curves cleaned, sorted into outlines and holes, joined, measured.

pub mod combine;
mod compact;
pub mod contours;
pub mod curve;
mod spikes;
pub(crate) mod symmetry;
pub mod thickness;
pub(crate) mod union;
