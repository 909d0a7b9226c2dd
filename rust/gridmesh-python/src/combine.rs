//! `combine`: outlines united, or cut from each other.

use gridmesh::drawing::combine::{Combination, Part, combine as core_combine};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::input::Argument;
use crate::{arrays, error};

/// Unite a drawing with another outline, or cut that from it.
///
/// Parameters
/// ----------
/// outline : (n, 2) array of real numbers, n >= 3
///     The drawing's outline, closed implicitly, either orientation.
/// other : (m, 2) array of real numbers, m >= 3
///     The other outline, in the same way. Of outlines that cross themselves the outer outline counts.
/// holes : sequence of (k, 2) arrays, optional
///     The drawing's holes.
/// how : {"union", "difference"}
///     "union": what is in either. "difference": what is in the drawing but not in `other`.
///
/// Returns
/// -------
/// list of (outline, holes)
///     The parts, largest first: an (a, 2) float64 array, counter-clockwise, and a list of clockwise ones.
///     Drawn points away from crossings stay where they are. Empty where a difference leaves nothing.
///
/// Raises
/// ------
/// GridMeshError
///     If an outline encloses nothing, or parts that meet in single points only, or outlines are not between 1e-30 and 1e30 across.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> square = [[0, 0], [4, 0], [4, 4], [0, 4]]
/// >>> parts = gridmesh.combine(square, [[1, -1], [2, -1], [2, 5], [1, 5]], how="difference")
/// >>> [len(outline) for outline, holes in parts]
/// [4, 4]
#[pyfunction]
#[pyo3(
    signature = (outline, other, holes = None, *, how = None),
    text_signature = "(outline, other, holes=(), *, how='union')"
)]
pub fn combine(
    py: Python<'_>,
    outline: &Bound<'_, PyAny>,
    other: &Bound<'_, PyAny>,
    holes: Option<&Bound<'_, PyAny>>,
    how: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyList>> {
    let drawing = crate::sketch::drawing(outline, holes)?;
    let allowed = "an (m, 2) array of real numbers";
    let other = Argument { name: "other", value: other, allowed }.points()?;
    let words = [("union", Combination::Union), ("difference", Combination::Difference)];
    let how = how.map_or(Ok(Combination::Union), |value| {
        Argument { name: "how", value, allowed: "'union' or 'difference'" }.word(&words)
    })?;
    let parts = error::detached(py, || core_combine(&drawing.outline, &drawing.holes, &other, how));
    let parts = parts.map_err(|failure| failure.into_py(py))?;
    arrays::list(py, &parts, |part: &Part| {
        let holes: Py<PyList> = arrays::list(py, &part.holes, |hole| arrays::plane_points(py, hole))?;
        let outline = arrays::plane_points(py, &part.outline)?;
        Ok(PyTuple::new(py, [outline.into_any(), holes.into_any()])?.unbind())
    })
}
