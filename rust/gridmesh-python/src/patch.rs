//! The Python class `Patch`.

use std::sync::Arc;

use glam::DVec2;
use gridmesh::patch::{Loop, Patch as CorePatch};
use gridmesh::path::placement::Lattice;
use gridmesh::sketch::Kept;
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList};

use crate::arrays;
use crate::error::error;
use crate::reports::counted;

/// The flat mesh of a drawing, of triangles or of quads; made by `mesh_sketch`.
///
/// All arrays are read-only and C-contiguous; copy them to change them. A patch can be pickled.
///
/// Attributes
/// ----------
/// vertices : (v, 2) float64
///     Positions in the units of the outline. Boundary vertices come first, loop by loop, and lie on
///     the drawn contours; no interior edge joins two of them.
/// triangles : (t, 3) int32
///     Vertex numbers, counter-clockwise. Every interior vertex has six triangles; none is inverted,
///     also after rounding to float32 relative to `origin`. (0, 3) in a patch of quads.
/// quads : (q, 4) int32
///     Vertex numbers, counter-clockwise; (0, 4) in a patch of triangles. None is concave or folded, also after rounding
///     to float32 relative to `origin`. Boundary vertices have two, or one on a sharp convex corner of the drawing;
///     interior ones four, or three or five at poles.
/// loops : list of (k,) int32
///     The vertices of each contour in order: the outer one first and counter-clockwise, holes clockwise.
/// arc : list of (k,) float64
///     For each loop the arc length of each vertex along its contour, from the contour's first input
///     point in the loop's direction; cyclically increasing. Units of the outline.
/// source : list of (k, 2) float64
///     For each loop the input segment that each vertex lies on (segment i joins the input points i
///     and i + 1) and the parameter on it, 0 to 1: carries over data given per input point.
/// corner : list of (k,) float64
///     For each loop the turning angle of the drawn corner that a vertex lies on (radians, positive
///     where convex), 0 for all other vertices.
/// belt : Patch
///     What bodies are made of: the patch itself, unless corners of it have a single quad. Then a patch with two quads at every
///     boundary vertex, with vertices and numbers of its own: those of the front of a body. It has the same report.
/// edge_length : float
///     Edge length of the lattice, in the units of the outline.
/// angle : float
///     Angle of the lattice in radians, at least 0 and below pi / 3 (quads: pi / 2).
/// origin : (2,) float64
///     Position of the lattice point (0, 0).
/// report : dict
///     Plain numbers (see `mesh_sketch`); "seconds" is a dict of times per stage.
#[pyclass(frozen, module = "gridmesh")]
pub struct Patch {
    pub inner: Arc<CorePatch>,
    /// Its lattice, to be kept.
    pub kept: Kept,
    report: Py<PyDict>,
    vertices: PyOnceLock<Py<PyArray2<f64>>>,
    triangles: PyOnceLock<Py<PyArray2<i32>>>,
    quads: PyOnceLock<Py<PyArray2<i32>>>,
}

impl Patch {
    pub fn new(inner: CorePatch, report: Py<PyDict>, kept: Kept) -> Self {
        Self::shared(Arc::new(inner), report, kept)
    }

    fn shared(inner: Arc<CorePatch>, report: Py<PyDict>, kept: Kept) -> Self {
        let (vertices, triangles, quads) = (PyOnceLock::new(), PyOnceLock::new(), PyOnceLock::new());
        Self { inner, kept, report, vertices, triangles, quads }
    }
}

#[pymethods]
impl Patch {
    #[getter]
    fn vertices(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        let made = self.vertices.get_or_try_init(py, || arrays::plane_points(py, &self.inner.vertices))?;
        Ok(made.clone_ref(py))
    }

    #[getter]
    fn triangles(&self, py: Python<'_>) -> PyResult<Py<PyArray2<i32>>> {
        let made = self.triangles.get_or_try_init(py, || arrays::triangles(py, &self.inner.triangles))?;
        Ok(made.clone_ref(py))
    }

    #[getter]
    fn quads(&self, py: Python<'_>) -> PyResult<Py<PyArray2<i32>>> {
        let made = self.quads.get_or_try_init(py, || arrays::quads(py, &self.inner.quads))?;
        Ok(made.clone_ref(py))
    }

    #[getter]
    fn loops(&self, py: Python<'_>) -> PyResult<Py<PyList>> {
        arrays::list(py, &self.inner.loops, |contour| Ok(arrays::indices(py, contour.vertices())))
    }

    #[getter]
    fn arc(&self, py: Python<'_>) -> PyResult<Py<PyList>> {
        arrays::list(py, &self.inner.loops, |contour| Ok(arrays::row(py, contour.arc.clone())))
    }

    #[getter]
    fn source(&self, py: Python<'_>) -> PyResult<Py<PyList>> {
        arrays::list(py, &self.inner.loops, |contour| arrays::sources(py, &contour.source))
    }

    #[getter]
    fn corner(&self, py: Python<'_>) -> PyResult<Py<PyList>> {
        arrays::list(py, &self.inner.loops, |contour| Ok(arrays::row(py, contour.corner.clone())))
    }

    #[getter]
    fn belt(slf: Py<Self>, py: Python<'_>) -> PyResult<Py<Self>> {
        let this = slf.get();
        match &this.inner.belt {
            Some(belt) => {
                Py::new(py, Self::shared(belt.clone(), this.report.clone_ref(py), this.kept.clone()))
            }
            None => Ok(slf),
        }
    }

    #[getter]
    fn edge_length(&self) -> f64 {
        self.inner.lattice.edge_length
    }

    #[getter]
    fn angle(&self) -> f64 {
        self.inner.lattice.angle
    }

    #[getter]
    fn origin(&self, py: Python<'_>) -> Py<numpy::PyArray1<f64>> {
        arrays::row(py, self.inner.lattice.origin.to_array().to_vec())
    }

    #[getter]
    fn report(&self, py: Python<'_>) -> Py<PyDict> {
        self.report.clone_ref(py)
    }

    fn __repr__(&self) -> String {
        let (triangles, quads, loops) =
            (self.inner.triangles.len(), self.inner.quads.len(), self.inner.loops.len());
        let cells = if quads > 0 { counted(quads, "quad") } else { counted(triangles, "triangle") };
        format!("<gridmesh.Patch: {cells}, {} vertices, {loops} loops>", self.inner.vertices.len())
    }

    // A patch cannot change: a copy is the patch itself.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = slf.py();
        let this = slf.get();
        let lengths: Vec<f64> = this.inner.loops.iter().map(|contour| contour.length).collect();
        let inlet = |inlet: &Vec<DVec2>| inlet.iter().map(DVec2::to_array).collect();
        let inlets: Vec<Vec<[f64; 2]>> = this.inner.inlets.iter().map(inlet).collect();
        let fields = (
            this.vertices(py)?,
            this.triangles(py)?,
            (this.arc(py)?, this.source(py)?, this.corner(py)?, lengths),
            inlets,
            (this.inner.lattice.origin.to_array(), this.angle(), this.edge_length()),
            this.report(py),
            this.quads(py)?,
            this.inner.belt.is_some().then(|| Self::belt(slf.clone().unbind(), py)).transpose()?,
        );
        Ok((py.import("gridmesh._native")?.getattr("_patch")?, fields.into_pyobject(py)?.into_any()))
    }
}

type Contours<'py> = (
    Vec<PyReadonlyArray1<'py, f64>>,
    Vec<PyReadonlyArray2<'py, f64>>,
    Vec<PyReadonlyArray1<'py, f64>>,
    Vec<f64>,
);

/// Makes a patch from what `Patch.__reduce__` returned.
#[pyfunction]
#[pyo3(signature = (vertices, triangles, contours, inlets, lattice, report, quads, belt = None))]
#[expect(clippy::too_many_arguments, reason = "the fields of the class")]
pub fn _patch(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, i32>,
    contours: Contours<'_>,
    inlets: Vec<Vec<[f64; 2]>>,
    lattice: ([f64; 2], f64, f64),
    report: Py<PyDict>,
    quads: PyReadonlyArray2<'_, i32>,
    belt: Option<Py<Patch>>,
) -> PyResult<Patch> {
    let broken = || error(py, "invalid_shape", "the pickled patch is damaged");
    let vertices: Vec<DVec2> = vertices
        .as_array()
        .rows()
        .into_iter()
        .filter(|row| row.len() == 2)
        .map(|row| DVec2::new(row[0], row[1]))
        .collect();
    let index = |i: i32| u32::try_from(i).ok().filter(|&i| (i as usize) < vertices.len()).ok_or_else(broken);
    let mut corners = Vec::new();
    for row in triangles.as_array().rows() {
        match row.to_slice() {
            Some(&[a, b, c]) => corners.push([index(a)?, index(b)?, index(c)?]),
            _ => return Err(broken()),
        }
    }
    let mut fours = Vec::new();
    for row in quads.as_array().rows() {
        match row.to_slice() {
            Some(&[a, b, c, d]) => fours.push([index(a)?, index(b)?, index(c)?, index(d)?]),
            _ => return Err(broken()),
        }
    }
    let (arcs, sources, turns, lengths) = contours;
    let mut loops: Vec<Loop> = Vec::new();
    for (((arc, source), corner), length) in arcs.iter().zip(&sources).zip(&turns).zip(lengths) {
        let arc = arc.as_array().to_vec();
        let start = loops.last().map_or(0, |last| last.vertices().end);
        let source: Vec<_> =
            source.as_array().rows().into_iter().map(|row| (row[0] as u32, row[1])).collect();
        let corner = corner.as_array().to_vec();
        let end = start as usize + arc.len();
        if source.len() != arc.len() || corner.len() != arc.len() || end > vertices.len() {
            return Err(broken());
        }
        loops.push(Loop { start, arc, source, corner, length });
    }
    let ([x, y], angle, edge_length) = lattice;
    let lattice = Lattice { origin: DVec2::new(x, y), angle, edge_length };
    let inlets = inlets.into_iter().map(|inlet| inlet.into_iter().map(DVec2::from_array).collect()).collect();
    let belt = belt.map(|belt| belt.get().inner.clone());
    let inner = CorePatch { vertices, triangles: corners, quads: fours, loops, inlets, lattice, belt };
    Ok(Patch::new(inner, report, Kept::straight(lattice)))
}
