//! `harmonic`: values carried on over a mesh.

use gridmesh::geometry::harmonic::harmonic as core_harmonic;
use numpy::{AllowTypeChange, PyArray1, PyArrayLike2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error;
use crate::input::Argument;
use crate::mesh::{self, Mesh};

/// Carry values on to the free vertices of a mesh, as smoothly as possible.
///
/// Parameters
/// ----------
/// vertices : (n, 3) array of real numbers
/// triangles : (m, 3) array of integers
/// free : (f,) array of integers
///     Vertices whose values are wanted.
/// values : (n, c) array of real numbers
///     Data of the vertices: texture coordinates, weights, colours, displacements. What it holds for free vertices that
///     are wanted is not read.
///
/// Returns
/// -------
/// (n, c) float64
///     The same with harmonic values at the free vertices, within the range of each column at the others: on a flat mesh
///     what is linear around is linear inside. Free vertices without a way along edges to a fixed one keep theirs.
///
/// Raises
/// ------
/// GridMeshError
///     If a number of a vertex is out of range, the shapes do not fit, or a value or position is not finite.
///
/// Notes
/// -----
/// Cotangent weights: Pinkall and Polthier, Computing Discrete Minimal Surfaces and Their Conjugates, 1993. One sparse Cholesky
/// factorisation, in O(f log f) in practice.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> corners = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 0]]
/// >>> fan = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
/// >>> gridmesh.harmonic(corners, fan, [4], [[0], [4], [4], [0], [0]])[4].round(9)
/// array([2.])
#[pyfunction]
pub fn harmonic<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    triangles: &Bound<'py, PyAny>,
    free: &Bound<'py, PyAny>,
    values: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let mesh = Mesh::read(vertices, triangles)?;
    let free = mesh::indices(&Argument { name: "free", value: free, allowed: "an (f,) array of integers" })?;
    let allowed = "an (n, c) array of finite real numbers, a row for each vertex";
    let it = Argument { name: "values", value: values, allowed };
    let array = it.array()?;
    let (positions, faces) = (mesh.positions()?, mesh.faces()?);
    let shape = array.shape().to_vec();
    if array.ndim() != 2 || shape[0] != positions.len() {
        return Err(it.wrong_shape(&format!("has shape {shape:?}")));
    }
    let columns = shape[1];
    let held = array.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>()?;
    let mut flat: Vec<f64> = held.as_array().iter().copied().collect();
    let found =
        error::detached(py, || core_harmonic(&positions, &faces, &free, &mut flat, columns).map(|()| flat));
    let found = found.map_err(|failure| failure.into_py(py))?;
    Ok(PyArray1::from_vec(py, found).reshape([shape[0], columns])?.into_any())
}
