//! A patch brought to space: smooth to its surroundings, free of intersections.

pub(crate) mod around;
mod coarse;
mod diagonals;
pub(crate) mod faces;
pub(crate) mod fair;
pub(crate) mod fit;
pub(crate) mod looks;
pub(crate) mod meet;
pub(crate) mod patchwork;
pub(crate) mod sharp;
pub(crate) mod solver;
pub(crate) mod sweep;
