//! Reports as dicts of plain numbers.

use gridmesh::body::surface::SurfaceReport;
use gridmesh::options::SketchReport;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The report of `mesh_sketch`.
pub fn sketch(py: Python<'_>, report: &SketchReport) -> PyResult<Py<PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("triangles", report.triangles)?;
    dict.set_item("quads", report.quads)?;
    dict.set_item("poles", report.poles)?;
    dict.set_item("minimum_poles", report.minimum_poles)?;
    dict.set_item("irregular", report.irregular)?;
    dict.set_item("minimum_irregular", report.minimum_irregular)?;
    dict.set_item("turns", report.turns)?;
    dict.set_item("turns_before", report.turns_before)?;
    dict.set_item("turns_bound", report.turns_bound)?;
    dict.set_item("cost", report.cost)?;
    dict.set_item("cost_bound", report.cost_bound)?;
    dict.set_item("optimal", report.optimal)?;
    dict.set_item("max_distance_used", report.max_distance_used)?;
    dict.set_item("max_deviation", report.max_deviation)?;
    dict.set_item("min_angle", report.min_angle)?;
    dict.set_item("corners", report.corners)?;
    dict.set_item("released_corners", report.released_corners)?;
    dict.set_item("bridged_inlets", report.bridged_inlets)?;
    dict.set_item("across", report.across)?;
    dict.set_item("repaired", report.repaired)?;
    dict.set_item("mirror_error", report.mirror_error)?;
    dict.set_item("bend", report.bend)?;
    dict.set_item("scale_range", report.scale_range)?;
    dict.set_item("placements", report.placements)?;
    dict.set_item("search_states", report.search_states)?;
    dict.set_item("seconds", seconds(py, &report.seconds)?)?;
    Ok(dict.unbind())
}

/// The report of a surface.
pub fn surface(py: Python<'_>, report: &SurfaceReport) -> PyResult<Py<PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("triangles", report.triangles)?;
    dict.set_item("quads", report.quads)?;
    dict.set_item("irregular", report.irregular)?;
    dict.set_item("watertight", report.watertight)?;
    dict.set_item("genus", report.genus)?;
    dict.set_item("volume", report.volume)?;
    dict.set_item("min_angle", report.min_angle)?;
    dict.set_item("self_intersections", report.self_intersections)?;
    dict.set_item("embedded", report.embedded)?;
    dict.set_item("shortened", report.shortened)?;
    dict.set_item("repaired", report.repaired)?;
    dict.set_item("seconds", seconds(py, &report.seconds)?)?;
    Ok(dict.unbind())
}

/// Times per stage.
pub fn seconds<'py>(py: Python<'py>, stages: &[(&'static str, f64)]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for &(stage, seconds) in stages {
        dict.set_item(stage, seconds)?;
    }
    Ok(dict)
}

/// A number of things.
pub fn counted(number: usize, what: &str) -> String {
    if number == 1 { format!("1 {what}") } else { format!("{number} {what}s") }
}
