//! Rust vectors as numpy arrays that cannot be written to.

use glam::{DVec2, DVec3};
use numpy::ndarray::{Array2, Dimension, ShapeError};
use numpy::{Element, PyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::PyTypeInfo;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyList;

/// A two-dimensional array of `COLUMNS` columns.
fn table<T: Element, const COLUMNS: usize>(
    py: Python<'_>,
    rows: Vec<[T; COLUMNS]>,
) -> PyResult<Py<PyArray2<T>>> {
    let shape = (rows.len(), COLUMNS);
    let table = Array2::from_shape_vec(shape, rows.into_flattened())
        .map_err(|err: ShapeError| PyRuntimeError::new_err(err.to_string()))?;
    Ok(frozen(PyArray2::from_owned_array(py, table)))
}

fn frozen<T: Element, D: Dimension>(array: Bound<'_, PyArray<T, D>>) -> Py<PyArray<T, D>> {
    array.readwrite().make_nonwriteable();
    array.unbind()
}

/// A one-dimensional array.
pub fn row<T: Element>(py: Python<'_>, values: Vec<T>) -> Py<PyArray1<T>> {
    frozen(PyArray1::from_vec(py, values))
}

/// (n, 2) float64.
pub fn plane_points(py: Python<'_>, points: &[DVec2]) -> PyResult<Py<PyArray2<f64>>> {
    table(py, points.iter().map(|p| p.to_array()).collect())
}

/// (n, 3) float64.
pub fn space_points(py: Python<'_>, points: &[DVec3]) -> PyResult<Py<PyArray2<f64>>> {
    table(py, points.iter().map(|p| p.to_array()).collect())
}

/// (n, 2) float64 from a whole and a fraction.
pub fn sources(py: Python<'_>, sources: &[(u32, f64)]) -> PyResult<Py<PyArray2<f64>>> {
    table(py, sources.iter().map(|&(segment, parameter)| [f64::from(segment), parameter]).collect())
}

/// (n, 4) float64.
pub fn rows(py: Python<'_>, rows: Vec<[f64; 4]>) -> PyResult<Py<PyArray2<f64>>> {
    table(py, rows)
}

/// (n, 3) int32.
pub fn triangles(py: Python<'_>, triangles: &[[u32; 3]]) -> PyResult<Py<PyArray2<i32>>> {
    table(py, triangles.iter().map(|t| t.map(index)).collect())
}

/// (n, 4) int32.
pub fn quads(py: Python<'_>, quads: &[[u32; 4]]) -> PyResult<Py<PyArray2<i32>>> {
    table(py, quads.iter().map(|q| q.map(index)).collect())
}

/// (n, 2) int32.
pub fn edges(py: Python<'_>, edges: &[[u32; 2]]) -> PyResult<Py<PyArray2<i32>>> {
    table(py, edges.iter().map(|edge| edge.map(index)).collect())
}

/// (n,) int32.
pub fn indices(py: Python<'_>, vertices: impl Iterator<Item = u32>) -> Py<PyArray1<i32>> {
    row(py, vertices.map(index).collect())
}

/// A Python list of what `each` makes of the items.
pub fn list<T, P: PyTypeInfo>(
    py: Python<'_>,
    items: &[T],
    each: impl Fn(&T) -> PyResult<Py<P>>,
) -> PyResult<Py<PyList>> {
    let items = items.iter().map(each).collect::<PyResult<Vec<_>>>()?;
    Ok(PyList::new(py, items)?.unbind())
}

/// The library's limit of 20 million triangles keeps every index far below 2^31.
fn index(vertex: u32) -> i32 {
    vertex as i32
}
