//! The Python class `Surface`.

use gridmesh::body::surface::Surface as CoreSurface;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::reports::counted;
use crate::{arrays, reports};

/// A mesh in space, of triangles or of quads; made by `stitch`, `inflate`, `flat` and `map_sketches`.
///
/// All arrays are read-only and C-contiguous; copy them to change them. A surface can be pickled.
///
/// Attributes
/// ----------
/// vertices : (v, 3) float64
///     Positions; x and y in the plane of the drawing, z its normal. Units of the outline.
/// triangles : (t, 3) int32
///     Vertex numbers, counter-clockwise seen from outside (`flat`: from above). (0, 3) if made of quads.
/// quads : (q, 4) int32
///     The same of quads; (0, 4) if made of triangles. Every vertex has four, or three or five at poles; in
///     projection to the drawing all are convex.
/// silhouette : list of (k,) int32
///     The vertices of the drawn contours, loop by loop, in the order of the patch's loops. Their x
///     and y are those of the patch, of a body of quads those of its `belt`, bit for bit; their z is 0.
/// corner : list of (k,) float64
///     For each of them the turning angle of the drawn corner that it lies on (radians, positive where convex), 0 elsewhere.
/// uv : (3 t, 2) or (4 q, 2) float64
///     Texture coordinates in 0 to 1 of each face's corners, in the order of `triangles` or `quads`: the
///     front as drawn, the back beside it as seen from behind.
/// report : dict
///     Plain numbers: "triangles", "quads", "irregular" (vertices whose valence is not 6, or 4 of quads), "watertight", "genus",
///     "volume", "min_angle" (radians), "self_intersections" (pairs of triangles), "embedded" (True if
///     their absence is proved), "shortened" and "repaired" (fallbacks taken), and "seconds", a dict of
///     times per stage.
#[pyclass(frozen, module = "gridmesh")]
pub struct Surface {
    #[pyo3(get)]
    vertices: Py<PyArray2<f64>>,
    #[pyo3(get)]
    triangles: Py<PyArray2<i32>>,
    #[pyo3(get)]
    quads: Py<PyArray2<i32>>,
    #[pyo3(get)]
    silhouette: Py<PyList>,
    #[pyo3(get)]
    corner: Py<PyList>,
    #[pyo3(get)]
    uv: Py<PyArray2<f64>>,
    #[pyo3(get)]
    report: Py<PyDict>,
}

impl Surface {
    pub fn new(py: Python<'_>, core: &CoreSurface) -> PyResult<Self> {
        Ok(Self {
            vertices: arrays::space_points(py, &core.vertices)?,
            triangles: arrays::triangles(py, &core.triangles)?,
            quads: arrays::quads(py, &core.quads)?,
            silhouette: arrays::list(py, &core.silhouette, |contour| {
                Ok(arrays::indices(py, contour.iter().copied()))
            })?,
            corner: arrays::list(py, &core.corner, |contour| Ok(arrays::row(py, contour.clone())))?,
            uv: arrays::plane_points(py, &core.uv)?,
            report: reports::surface(py, &core.report)?,
        })
    }
}

#[pymethods]
impl Surface {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (triangles, quads) = (self.triangles.bind(py).len()?, self.quads.bind(py).len()?);
        let cells = if quads > 0 { counted(quads, "quad") } else { counted(triangles, "triangle") };
        Ok(format!("<gridmesh.Surface: {cells}, {} vertices>", self.vertices.bind(py).len()?))
    }

    // A surface cannot change: a copy is the surface itself.
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
            &this.vertices,
            &this.triangles,
            &this.silhouette,
            &this.uv,
            &this.report,
            &this.quads,
            &this.corner,
        );
        Ok((py.import("gridmesh._native")?.getattr("_surface")?, fields.into_pyobject(py)?.into_any()))
    }
}

/// Makes a surface from what `Surface.__reduce__` returned.
#[pyfunction]
pub fn _surface(
    vertices: Py<PyArray2<f64>>,
    triangles: Py<PyArray2<i32>>,
    silhouette: Py<PyList>,
    uv: Py<PyArray2<f64>>,
    report: Py<PyDict>,
    quads: Py<PyArray2<i32>>,
    corner: Py<PyList>,
) -> Surface {
    Surface { vertices, triangles, quads, silhouette, corner, uv, report }
}
