//! The Python module `gridmesh._native`: conversions only, no algorithm.
//!
//! `input` and `options` read what Python hands over, `watch` carries progress and signals, `process` finds threads after a fork, `arrays`
//! and `reports` hand results back, `patch`, `surface`, `filled`, `cut`, `piece` and `join` are the classes, `bridge`, `sketch`, `body` and `map` make them
//! of drawings, `batch` is the parallel map, `combine` unites drawings, `thickness` measures them, `picture`
//! traces them, `decode` reads their files, `harmonic` carries values on, `bones` weighs bones.
#![forbid(unsafe_code)]
#![deny(clippy::disallowed_methods)]

mod arrays;
mod batch;
mod body;
mod bones;
mod bridge;
mod combine;
mod cut;
mod cutout;
mod decode;
mod error;
mod fill;
mod filled;
mod harmonic;
mod input;
mod join;
mod map;
mod mesh;
mod options;
mod patch;
mod picture;
mod piece;
mod process;
mod regrid;
mod reports;
mod sketch;
mod surface;
mod thickness;
mod watch;

use pyo3::prelude::*;

use crate::error::GridMeshError;
use crate::patch::Patch;
use crate::surface::Surface;

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let exception = py.get_type::<GridMeshError>();
    // For errors that others raise with this class; gridmesh always sets the attribute itself.
    exception.setattr("kind", "error")?;
    module.add("GridMeshError", exception)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<Patch>()?;
    module.add_class::<Surface>()?;
    module.add_function(wrap_pyfunction!(sketch::mesh_sketch, module)?)?;
    module.add_function(wrap_pyfunction!(sketch::cover_sketch, module)?)?;
    module.add_function(wrap_pyfunction!(cutout::mesh_cutout, module)?)?;
    module.add_function(wrap_pyfunction!(body::stitch, module)?)?;
    module.add_function(wrap_pyfunction!(body::flat, module)?)?;
    module.add_function(wrap_pyfunction!(body::inflate, module)?)?;
    module.add_function(wrap_pyfunction!(map::map_sketches, module)?)?;
    module.add_function(wrap_pyfunction!(combine::combine, module)?)?;
    module.add_function(wrap_pyfunction!(thickness::thickness, module)?)?;
    module.add_function(wrap_pyfunction!(harmonic::harmonic, module)?)?;
    module.add_function(wrap_pyfunction!(picture::trace_image, module)?)?;
    module.add_function(wrap_pyfunction!(decode::decode_image, module)?)?;
    module.add_function(wrap_pyfunction!(bones::bone_weights, module)?)?;
    module.add_class::<filled::Fill>()?;
    module.add_function(wrap_pyfunction!(fill::fill_hole, module)?)?;
    module.add_function(wrap_pyfunction!(fill::fill_holes, module)?)?;
    module.add_function(wrap_pyfunction!(fill::is_outer_border, module)?)?;
    module.add_function(wrap_pyfunction!(bridge::bridge, module)?)?;
    module.add_function(wrap_pyfunction!(bridge::bridge_pairs, module)?)?;
    module.add_function(wrap_pyfunction!(bridge::look_apart, module)?)?;
    module.add_class::<regrid::Regrid>()?;
    module.add_function(wrap_pyfunction!(regrid::regrid, module)?)?;
    module.add_class::<cut::Cut>()?;
    module.add_class::<piece::Piece>()?;
    module.add_function(wrap_pyfunction!(cut::cut, module)?)?;
    module.add_function(wrap_pyfunction!(cut::cut_reach, module)?)?;
    module.add_class::<join::Joined>()?;
    module.add_function(wrap_pyfunction!(join::join, module)?)?;
    module.add_function(wrap_pyfunction!(join::_joined, module)?)?;
    module.add_function(wrap_pyfunction!(patch::_patch, module)?)?;
    module.add_function(wrap_pyfunction!(surface::_surface, module)?)?;
    module.add_function(wrap_pyfunction!(filled::_fill, module)?)?;
    module.add_function(wrap_pyfunction!(regrid::_regrid, module)?)?;
    module.add_function(wrap_pyfunction!(cut::_cut, module)?)?;
    module.add_function(wrap_pyfunction!(piece::_piece, module)?)?;
    Ok(())
}
