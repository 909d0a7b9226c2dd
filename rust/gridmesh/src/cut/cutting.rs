//! What every stage of a cut reads.

use glam::DVec3;

use super::input::Polygons;
use super::options::CutOptions;

/// The mesh that is cut, and how.
#[derive(Clone, Copy)]
pub(in crate::cut) struct Cutting<'a> {
    pub vertices: &'a [DVec3],
    pub faces: Polygons<'a>,
    pub options: &'a CutOptions,
}
