//! The Python class `Piece`, one side of a divided mesh.

use glam::DVec3;
use gridmesh::cut::{Piece as CorePiece, Side};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arrays;

/// One side of a divided mesh; made by `cut`.
///
/// All arrays are read-only and C-contiguous; copy them to change them.
///
/// Attributes
/// ----------
/// side : str
///     "left" or "right".
/// vertices : (v, 3) float64
///     Old vertices in their order, then those of the cut, of the caps, and doubled ones.
/// corners : (c,) int32
///     Corners of the faces: untouched ones in their order, parts of divided ones, caps.
/// offsets : (f + 1,) int32
///     Where each face begins in `corners`, and the end.
/// source_face : (f,) int32
///     The face of the input that each face is or was a part of; -1 for cap faces.
/// source_vertices : (v, 3) int32
///     Vertices of the input, of which each vertex is a combination.
/// source_weights : (v, 3) float64
///     Their weights. An old vertex is one times itself; a vertex inside a cap has the combination of
///     a vertex of the cut near it, for data.
/// cap_loops : list of (k,) int32
///     The closed cut lines, as the faces along them run.
#[pyclass(frozen, module = "gridmesh")]
pub struct Piece {
    #[pyo3(get)]
    side: &'static str,
    #[pyo3(get)]
    vertices: Py<PyArray2<f64>>,
    #[pyo3(get)]
    corners: Py<PyArray1<i32>>,
    #[pyo3(get)]
    offsets: Py<PyArray1<i32>>,
    #[pyo3(get)]
    source_face: Py<PyArray1<i32>>,
    #[pyo3(get)]
    source_vertices: Py<PyArray2<i32>>,
    #[pyo3(get)]
    source_weights: Py<PyArray2<f64>>,
    #[pyo3(get)]
    cap_loops: Py<PyList>,
}

impl Piece {
    pub fn new(py: Python<'_>, inner: CorePiece) -> PyResult<Self> {
        let weights = inner.source_weights.iter().map(|&w| DVec3::from_array(w)).collect::<Vec<_>>();
        let loops = PyList::empty(py);
        for l in inner.cap_loops {
            loops.append(arrays::indices(py, l.into_iter()))?;
        }
        Ok(Self {
            side: inner.side.word(),
            vertices: arrays::space_points(py, &inner.vertices)?,
            corners: arrays::indices(py, inner.corners.into_iter()),
            offsets: arrays::indices(py, inner.offsets.into_iter()),
            source_face: arrays::row(py, inner.source_face),
            source_vertices: arrays::triangles(py, &inner.source_vertices)?,
            source_weights: arrays::space_points(py, &weights)?,
            cap_loops: loops.unbind(),
        })
    }
}

#[pymethods]
impl Piece {
    fn __repr__(&self, py: Python<'_>) -> String {
        let faces = self.source_face.bind(py).len();
        format!("<gridmesh.Piece: {faces} faces on the {}>", self.side)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = slf.py();
        let this = slf.get();
        let fields = (
            this.side == Side::Left.word(),
            (
                this.vertices.clone_ref(py),
                this.source_vertices.clone_ref(py),
                this.source_weights.clone_ref(py),
            ),
            (this.corners.clone_ref(py), this.offsets.clone_ref(py), this.source_face.clone_ref(py)),
            this.cap_loops.clone_ref(py),
        );
        Ok((py.import("gridmesh._native")?.getattr("_piece")?, fields.into_pyobject(py)?.into_any()))
    }
}

/// Makes a piece from what `Piece.__reduce__` returned.
#[pyfunction]
pub fn _piece(
    py: Python<'_>,
    left: bool,
    positions: (PyReadonlyArray2<'_, f64>, PyReadonlyArray2<'_, i32>, PyReadonlyArray2<'_, f64>),
    faces: (PyReadonlyArray1<'_, i32>, PyReadonlyArray1<'_, i32>, PyReadonlyArray1<'_, i32>),
    cap_loops: Vec<PyReadonlyArray1<'_, i32>>,
) -> PyResult<Piece> {
    let broken = || crate::error::error(py, "invalid_shape", "the pickled piece is damaged".to_owned());
    let points = |array: &PyReadonlyArray2<'_, f64>| -> PyResult<Py<PyArray2<f64>>> {
        let rows = array.as_array();
        let rows = rows.rows().into_iter().map(|row| match row.as_slice() {
            Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
            _ => Err(broken()),
        });
        arrays::space_points(py, &rows.collect::<PyResult<Vec<_>>>()?)
    };
    let row = |array: &PyReadonlyArray1<'_, i32>| arrays::row(py, array.as_array().to_vec());
    let sources = positions.1.as_array();
    let sources = sources.rows().into_iter().map(|row| match row.as_slice() {
        Some(&[a, b, c]) => Ok([a, b, c].map(|v| v as u32)),
        _ => Err(broken()),
    });
    Ok(Piece {
        side: if left { Side::Left.word() } else { Side::Right.word() },
        vertices: points(&positions.0)?,
        corners: row(&faces.0),
        offsets: row(&faces.1),
        source_face: row(&faces.2),
        source_vertices: arrays::triangles(py, &sources.collect::<PyResult<Vec<_>>>()?)?,
        source_weights: points(&positions.2)?,
        cap_loops: arrays::list(py, &cap_loops, |l| Ok(row(l)))?,
    })
}
