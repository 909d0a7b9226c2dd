//! `regrid` and the Python class `Regrid`.

use glam::DVec3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays;
use crate::fill::{options, shape};
use crate::filled::Fill;
use crate::input::Argument;
use crate::mesh::{Mesh, indices};
use crate::watch::Watch;

/// Replace a region of a mesh by a grid patch on the same boundary.
///
/// Parameters
/// ----------
/// vertices, triangles
///     The mesh, as `fill_hole` takes it.
/// faces : (f,) array of int
///     The triangles of the region, which must be a disk: connected, one border, not touching itself.
/// keep_shape : bool
///     True: the new vertices are laid on the old surface. False: the hole is filled as by `fill_hole`.
/// smooth, strict, polygons, cells, progress
///     As in `fill_hole`; `smooth` matters without `keep_shape` only.
///
/// Returns
/// -------
/// Regrid
///     A fill of the hole that the region leaves, with all guarantees of `fill_hole`.
///
/// Raises
/// ------
/// GridMeshError
///     If the faces are no disk, or as `fill_hole`.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// Nealen, Pett, Alexa, Igarashi: GridMesh, section VII, names the task.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> a, b = np.meshgrid(np.arange(9), np.arange(9), indexing="ij")
/// >>> sheet = np.c_[a.ravel(), b.ravel(), np.sin(a).ravel()]
/// >>> quad = np.array([[9 * i + j for j in range(8)] for i in range(8)]).ravel()
/// >>> faces = np.r_[np.c_[quad, quad + 9, quad + 1], np.c_[quad + 9, quad + 10, quad + 1]]
/// >>> done = gridmesh.regrid(sheet, faces, np.arange(128))
/// >>> len(done.fill.loop), done.off < 1e-9
/// (32, True)
#[pyfunction]
#[pyo3(
    signature = (vertices, triangles, faces, *, keep_shape = None, smooth = None, strict = None, polygons = None, cells = None, progress = None),
    text_signature = "(vertices, triangles, faces, *, keep_shape=True, smooth='tangent', strict=False, polygons=None, cells='triangles', progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "the keyword-only options of the Python function")]
pub fn regrid(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    keep_shape: Option<&Bound<'_, PyAny>>,
    smooth: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    polygons: Option<&Bound<'_, PyAny>>,
    cells: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Regrid> {
    let mesh = Mesh::read(vertices, triangles)?;
    let allowed = "an (f,) array of whole numbers";
    let region = indices(&Argument { name: "faces", value: faces, allowed })?;
    let mut options = options(smooth, strict, polygons)?;
    options.cells = shape(cells)?;
    let keep = keep_shape
        .map_or(Ok(true), |value| Argument { name: "keep_shape", value, allowed: "True or False" }.bool())?;
    let (positions, all) = (mesh.positions()?.into_owned(), mesh.faces()?.into_owned());
    let done = Watch::new(progress)?
        .run(py, |progress| gridmesh::fill::regrid(&positions, &all, &region, keep, &options, progress))?;
    let (numbers, weights) = done
        .sources
        .into_iter()
        .map(|(face, w)| (face, DVec3::from_array(w)))
        .unzip::<_, _, Vec<_>, Vec<_>>();
    Ok(Regrid {
        source_faces: arrays::indices(py, numbers.into_iter()),
        source_weights: arrays::space_points(py, &weights)?,
        unused: arrays::indices(py, done.unused.into_iter()),
        off: done.off,
        lost: done.lost,
        fill: Py::new(py, Fill::new(py, done.fill)?)?,
    })
}

/// A region that was replaced; made by `regrid`.
///
/// Attributes
/// ----------
/// fill : Fill
///     The patch; its faces take the place of the region's.
/// source_faces : (j,) int32
///     For each new vertex the old triangle that it lies on, or that is nearest.
/// source_weights : (j, 3) float64
///     Weights of that triangle's corners: carries over data of any kind.
/// unused : (u,) int32
///     Vertices of the mesh that only the region used.
/// off : float
///     Largest distance of a new vertex from the old surface.
/// lost : float
///     Largest distance of an unused vertex from the new surface: shape for which the patch has no vertices.
#[pyclass(frozen, module = "gridmesh")]
pub struct Regrid {
    #[pyo3(get)]
    fill: Py<Fill>,
    #[pyo3(get)]
    source_faces: Py<PyArray1<i32>>,
    #[pyo3(get)]
    source_weights: Py<PyArray2<f64>>,
    #[pyo3(get)]
    unused: Py<PyArray1<i32>>,
    #[pyo3(get)]
    off: f64,
    #[pyo3(get)]
    lost: f64,
}

#[pymethods]
impl Regrid {
    // It cannot change: a copy is the thing itself.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = slf.py();
        let this = slf.get();
        let fields =
            (&this.fill, &this.source_faces, &this.source_weights, &this.unused, this.off, this.lost);
        Ok((py.import("gridmesh._native")?.getattr("_regrid")?, fields.into_pyobject(py)?.into_any()))
    }
}

/// Makes a region from what `Regrid.__reduce__` returned.
#[pyfunction]
pub fn _regrid(
    fill: Py<Fill>,
    source_faces: Py<PyArray1<i32>>,
    source_weights: Py<PyArray2<f64>>,
    unused: Py<PyArray1<i32>>,
    off: f64,
    lost: f64,
) -> Regrid {
    Regrid { fill, source_faces, source_weights, unused, off, lost }
}
