//! The Python class `Fill`.

use glam::{DVec2, DVec3};
use gridmesh::fill::{Bridged, Fill as CoreFill, FillParts, FillReport, Leaving, Smooth};
use numpy::{
    AllowTypeChange, PyArray1, PyArray2, PyArrayLike1, PyArrayLike2, PyArrayMethods, PyReadonlyArray1,
    PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::error;
use crate::input::Argument;
use crate::mesh::{as_positions, positions_argument, read_positions};
use crate::reports::counted;
use crate::watch::Watch;
use crate::{arrays, reports};

/// The words for `smooth`.
pub(crate) const WORDS: [(&str, Smooth); 3] =
    [("flat", Smooth::Flat), ("tangent", Smooth::Tangent), ("curvature", Smooth::Curvature)];

/// In pickles by their numbers.
const WAYS: [Leaving; 3] = [Leaving::Direct, Leaving::Outwards, Leaving::Inwards];

/// A filled hole, or a tube between two; made by `fill_hole`, `fill_holes` and `bridge`.
///
/// All arrays are read-only and C-contiguous; copy them to change them. A fill can be pickled.
///
/// Attributes
/// ----------
/// loop : (k,) int32
///     The loop, as it was given; for a tube the first loop, then the second.
/// vertices : (j, 3) float64
///     The new vertices only.
/// triangles : (t, 3) int32
///     The new triangles only. Numbers below n are those of the mesh; n + i is the new vertex i.
/// quads : (q, 4) int32
///     The new quads, numbered as `triangles`, wound as they are; (0, 4) unless asked for. Together they are the
///     new faces: of quads there is one triangle if the loop is odd, none if it is even.
/// creases : (e, 2) int32
///     Edges of the patch along which hard edges of the mesh go on, numbered as `triangles` are.
/// report : dict
///     Plain numbers: "triangles", "quads", "vertices", "irregular" (new vertices whose valence is not 6, or 4 with
///     quads), "irregular_loop" (loop vertices whose valence is not 6 now; with quads those whose number of new faces
///     is not what the mesh leaves room for), "grid" ("lattice", "grown", "graded", "refined", "even",
///     "centre" or "no_interior": how the patch was made), "rows" (of triangles between two loops; 0 for one), "folded" (True if it could not be laid out in the
///     plane), "rim_angle" (mean angle between the surface and a film in the loop, radians: near zero where
///     the surface goes on, about pi / 2 at the end of a tube), "unrolling" ("projected", "developed",
///     "evened" or "circle": how the loop was laid out in the plane), "distortion" (largest relative change
///     of a loop edge thereby), "winding_conflicts" (loop edges whose neighbour is wound against most
///     others), "wire_edges" (loop edges without a neighbour), "min_angle" and "max_angle" (of all corners of new faces, radians; above pi where a quad is concave), "folds" (edges with
///     more than 120 degrees between new triangles, and concave corners of quads), "self_intersections" (pairs of triangles that meet, at
///     least one of them new), "creases" (hard edges that run into the loop, counted with `sharp`) and
///     "creases_kept" (those that go on: all or none), "repaired" (fallbacks taken), and "seconds", a dict of times per stage.
#[pyclass(frozen, module = "gridmesh")]
pub struct Fill {
    inner: CoreFill,
    #[pyo3(get)]
    r#loop: Py<PyArray1<i32>>,
    #[pyo3(get)]
    vertices: Py<PyArray2<f64>>,
    #[pyo3(get)]
    triangles: Py<PyArray2<i32>>,
    #[pyo3(get)]
    quads: Py<PyArray2<i32>>,
    #[pyo3(get)]
    creases: Py<PyArray2<i32>>,
    #[pyo3(get)]
    report: Py<PyDict>,
}

impl Fill {
    pub(crate) fn new(py: Python<'_>, inner: CoreFill) -> PyResult<Self> {
        let report = report(py, &inner.report)?;
        Self::made(py, inner, report)
    }

    fn made(py: Python<'_>, inner: CoreFill, report: Py<PyDict>) -> PyResult<Self> {
        Ok(Self {
            r#loop: arrays::indices(py, inner.loop_.iter().copied()),
            vertices: arrays::space_points(py, &inner.vertices)?,
            triangles: arrays::triangles(py, &inner.triangles)?,
            quads: arrays::quads(py, &inner.quads)?,
            creases: arrays::edges(py, &inner.creases)?,
            report,
            inner,
        })
    }
}

#[pymethods]
impl Fill {
    fn __repr__(&self) -> String {
        let (triangles, edges) = (self.inner.triangles.len(), self.inner.loop_.len());
        let faces = match self.inner.quads.len() {
            0 => counted(triangles, "triangle"),
            quads if triangles > 0 => format!("{} and a triangle", counted(quads, "quad")),
            quads => counted(quads, "quad"),
        };
        format!("<gridmesh.Fill: {faces} in a loop of {edges} edges>")
    }

    /// Extend data at the loop into the patch.
    ///
    /// Parameters
    /// ----------
    /// values : (k, c) or (k,) array of real numbers
    ///     Data of the loop's vertices, in the order of `loop`: texture coordinates, weights, colours.
    /// progress : callable, optional
    ///     As in `fill_hole`.
    ///
    /// Returns
    /// -------
    /// (j, c) or (j,) float64
    ///     Data of the new vertices: harmonic, and within the range of each column.
    ///
    /// Raises
    /// ------
    /// GridMeshError
    ///     If there is not one row for each vertex of the loop, a value is not finite, or when cancelled.
    #[pyo3(signature = (values, *, progress = None), text_signature = "($self, values, *, progress=None)")]
    fn extend<'py>(
        &self,
        py: Python<'py>,
        values: &Bound<'py, PyAny>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let allowed = "a (k, c) or (k,) array of real numbers, a row for each vertex of the loop";
        let it = Argument { name: "values", value: values, allowed };
        let array = it.array()?;
        let shape = array.shape().to_vec();
        if array.ndim() > 2 || array.ndim() == 0 || shape[0] != self.inner.loop_.len() {
            return Err(it.wrong_shape(&format!("has shape {shape:?}")));
        }
        let columns = shape.get(1).copied().unwrap_or(1);
        let flat: Vec<f64> = if array.ndim() == 1 {
            array.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>()?.as_array().iter().copied().collect()
        } else {
            array.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>()?.as_array().iter().copied().collect()
        };
        let found = Watch::new(progress)?.run(py, |progress| self.inner.extend(&flat, columns, progress))?;
        let found = PyArray1::from_vec(py, found);
        if array.ndim() == 1 {
            return Ok(found.into_any());
        }
        Ok(found.reshape([self.inner.vertices.len(), columns])?.into_any())
    }

    /// The new vertices for other positions of the mesh's vertices, such as a shape key.
    ///
    /// Parameters
    /// ----------
    /// vertices : (n, 3) array of real numbers
    ///     As many as the filled mesh has, in the same order.
    /// progress : callable, optional
    ///     As in `fill_hole`.
    ///
    /// Returns
    /// -------
    /// (j, 3) float64
    ///     Positions for the same triangles, solved like the first. Where the mesh around the loop is the
    ///     same, they are the same.
    ///
    /// Raises
    /// ------
    /// GridMeshError
    ///     If the number of vertices differs, one near the loop is not finite, or when cancelled.
    #[pyo3(signature = (vertices, *, progress = None), text_signature = "($self, vertices, *, progress=None)")]
    fn refit(
        &self,
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyArray2<f64>>> {
        let held = read_positions(&positions_argument(vertices))?;
        let positions = as_positions(&held)?.into_owned();
        let found = Watch::new(progress)?.run(py, |progress| self.inner.refit(&positions, progress))?;
        arrays::space_points(py, &found)
    }

    // A fill cannot change: a copy is the fill itself.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = slf.py();
        let parts = slf.get().inner.parts();
        let smooth = WORDS.iter().find(|(_, smooth)| *smooth == parts.smooth).map(|(word, _)| *word);
        let fields = (
            arrays::indices(py, parts.loop_.into_iter()),
            parts.reversed,
            (parts.bridged.iter())
                .map(|b| (b.first, b.reversed, b.pull, WAYS.iter().position(|&way| way == b.leaving)))
                .collect::<Vec<_>>(),
            smooth,
            parts.vertices,
            arrays::plane_points(py, &parts.flat)?,
            arrays::space_points(py, &parts.positions)?,
            arrays::indices(py, parts.outer.into_iter()),
            arrays::triangles(py, &parts.triangles)?,
            (parts.patch, parts.quads),
            arrays::edges(py, &parts.creases)?,
            slf.get().report.clone_ref(py),
        );
        Ok((py.import("gridmesh._native")?.getattr("_fill")?, fields.into_pyobject(py)?.into_any()))
    }
}

/// Makes a fill from what `Fill.__reduce__` returned.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the fields of the class")]
pub fn _fill(
    py: Python<'_>,
    r#loop: PyReadonlyArray1<'_, i32>,
    backwards: bool,
    later: Vec<(usize, bool, f64, usize)>,
    smooth: &str,
    vertices: usize,
    flat: PyReadonlyArray2<'_, f64>,
    positions: PyReadonlyArray2<'_, f64>,
    outer: PyReadonlyArray1<'_, i32>,
    triangles: PyReadonlyArray2<'_, i32>,
    patch: (usize, usize),
    creases: PyReadonlyArray2<'_, i32>,
    report: Py<PyDict>,
) -> PyResult<Fill> {
    let broken = || error(py, "invalid_shape", "the pickled fill is damaged");
    let smooth = WORDS.iter().find(|(word, _)| *word == smooth).ok_or_else(broken)?.1;
    // Negative numbers become large ones, which are refused.
    let numbers = |array: &PyReadonlyArray1<'_, i32>| array.as_array().iter().map(|&v| v as u32).collect();
    let columns = |array: &PyReadonlyArray2<'_, f64>, n| array.as_array().ncols() == n;
    if !columns(&flat, 2)
        || !columns(&positions, 3)
        || triangles.as_array().ncols() != 3
        || creases.as_array().ncols() != 2
    {
        return Err(broken());
    }
    let parts = FillParts {
        loop_: numbers(&r#loop),
        reversed: backwards,
        bridged: (later.into_iter())
            .map(|(first, reversed, pull, way)| {
                Some(Bridged { first, reversed, pull, leaving: *WAYS.get(way)? })
            })
            .collect::<Option<_>>()
            .ok_or_else(broken)?,
        smooth,
        vertices,
        flat: flat.as_array().rows().into_iter().map(|p| DVec2::new(p[0], p[1])).collect(),
        positions: positions.as_array().rows().into_iter().map(|p| DVec3::new(p[0], p[1], p[2])).collect(),
        outer: numbers(&outer),
        triangles: triangles.as_array().rows().into_iter().map(|t| [0, 1, 2].map(|k| t[k] as u32)).collect(),
        patch: patch.0,
        quads: patch.1,
        creases: creases.as_array().rows().into_iter().map(|e| [0, 1].map(|k| e[k] as u32)).collect(),
    };
    let inner = CoreFill::from_parts(parts, FillReport::default()).map_err(|_| broken())?;
    Fill::made(py, inner, report)
}

fn report(py: Python<'_>, report: &FillReport) -> PyResult<Py<PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("triangles", report.triangles)?;
    dict.set_item("quads", report.quads)?;
    dict.set_item("vertices", report.vertices)?;
    dict.set_item("irregular", report.irregular)?;
    dict.set_item("irregular_loop", report.irregular_loop)?;
    dict.set_item("grid", report.grid.word())?;
    dict.set_item("rows", report.rows)?;
    dict.set_item("folded", report.folded)?;
    dict.set_item("rim_angle", report.rim_angle)?;
    dict.set_item("unrolling", report.unrolling.word())?;
    dict.set_item("distortion", report.distortion)?;
    dict.set_item("winding_conflicts", report.winding_conflicts)?;
    dict.set_item("wire_edges", report.wire_edges)?;
    dict.set_item("min_angle", report.min_angle)?;
    dict.set_item("max_angle", report.max_angle)?;
    dict.set_item("folds", report.folds)?;
    dict.set_item("self_intersections", report.self_intersections)?;
    dict.set_item("creases", report.creases)?;
    dict.set_item("creases_kept", report.creases_kept)?;
    dict.set_item("repaired", report.repaired)?;
    dict.set_item("seconds", reports::seconds(py, &report.seconds)?)?;
    Ok(dict.unbind())
}
