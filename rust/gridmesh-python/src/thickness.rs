//! `thickness`: the limbs of a drawing.

use gridmesh::drawing::thickness::limbs;
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::{arrays, error};

/// Measure how thick the limbs of a drawing are: its parts that are longer than they are wide.
///
/// Parameters
/// ----------
/// outline : (n, 2) array of real numbers, n >= 3
///     The drawing's outline, closed implicitly, either orientation.
/// holes : sequence of (k, 2) arrays, optional
///     Contours inside the outline, in the same way.
///
/// Returns
/// -------
/// (l, 4) float64 array, read-only
///     A row for each limb, thinnest first: the middle of its thinnest place (x, y), its width there (the mean over a
///     stretch as long as it is wide) and the limb's length, in the units of the outline. The outer half of a limb
///     does not count, so that tips may be sharp. What is shorter than a tenth of the drawing's size is no limb, more
///     where the line is ragged: corners, a trembling line and slips of the pen are none. A compact shape has none.
///     In O(n log n).
///
/// Raises
/// ------
/// GridMeshError
///     If the drawing is not allowed; see `mesh_sketch`.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// Prasad: Morphological analysis of shapes (chordal axis transform), 1997.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> bar = [[0, 0], [10, 0], [10, 1], [0, 1]]
/// >>> round(float(gridmesh.thickness(bar)[0, 2]), 2)
/// 1.0
#[pyfunction]
#[pyo3(signature = (outline, holes = None), text_signature = "(outline, holes=())")]
pub fn thickness(
    py: Python<'_>,
    outline: &Bound<'_, PyAny>,
    holes: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyArray2<f64>>> {
    let drawing = crate::sketch::drawing(outline, holes)?;
    let found = error::detached(py, || limbs(&drawing.outline, &drawing.holes));
    let found = found.map_err(|failure| failure.into_py(py))?;
    let row = |limb: &gridmesh::drawing::thickness::Limb| [limb.at.x, limb.at.y, limb.width, limb.length];
    arrays::rows(py, found.iter().map(row).collect())
}
