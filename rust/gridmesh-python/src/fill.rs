//! `fill_hole`, `fill_holes` and the Python class `Fill`.

use glam::{DVec2, DVec3};
use gridmesh::fill::{Bridged, Fill as CoreFill, FillOptions, FillParts, FillReport, Smooth};
use gridmesh::options::CellShape;
use numpy::{
    AllowTypeChange, PyArray1, PyArray2, PyArrayLike1, PyArrayLike2, PyArrayMethods, PyReadonlyArray1,
    PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::error::{error, from_core};
use crate::input::Argument;
use crate::mesh::{Mesh, as_positions, indices, loop_argument, pairs, positions_argument, read_positions};
use crate::watch::Watch;
use crate::{arrays, reports};

/// Fill a hole with a grid patch whose boundary is the hole's, vertex for vertex.
///
/// Parameters
/// ----------
/// vertices : (n, 3) array of real numbers
///     Positions of the mesh, in any units. Not modified.
/// triangles : (m, 3) array of int
///     Its triangles; (0, 3) for a loop of edges without a mesh. Only those near the loop matter: coordinates
///     further away than two rings of triangles need not even be finite.
/// loop : (k,) array of int, k >= 3, or a list of such arrays
///     The vertices of the hole's boundary in order, either way round, each once. A list: the loops of one hole that has
///     several; the patch has them all as its boundary. Two are joined by a tube, as `bridge` does; between three or more the triangles are even, but no
///     grid. Several loops with triangles only, and without `sharp`.
/// smooth : {"flat", "tangent", "curvature"}
///     "flat": a soap film in the loop. "tangent": continues the slope of the surface around. "curvature":
///     its slope and curvature.
/// strict : bool
///     True: a fill that meets itself or the mesh is refused. False: this is counted in the report.
/// polygons : (m,) array of int, optional
///     The polygon that each triangle is a part of, the triangles of one following each other: the loop's
///     vertices then get the edges that quads want, whichever diagonals cut them.
/// sharp : float, optional
///     Hard edges go on: edges of the mesh that run into the loop with more than this angle (in radians) between
///     their triangles are continued in the patch, if they meet in one line or one point and the surface
///     between them is planar, as at a cut-off corner of a cube. Otherwise the patch is smooth; the report has
///     "creases" and "creases_kept". None: always smooth.
/// creases : (e, 2) array of int, optional
///     With `sharp`: edges that are hard whatever their angle is.
/// cells : {"triangles", "quads"}
///     "quads": all new faces are quads if the loop has an even number of edges; if it is odd one is a triangle.
///     Quads of the mesh go on through the loop where counts allow: tell them by `polygons`.
/// progress : callable, optional
///     Called with a fraction from 0 to 1, which never falls; cancels by returning False. What it raises is
///     raised here.
///
/// Returns
/// -------
/// Fill
///     The loop's vertices are neither moved nor added to; each loop edge gets exactly one new face,
///     wound against its neighbour (against most of them where the neighbours disagree); the patch is a
///     disk; no new edge or face repeats one of the mesh. The same input gives the same bytes, for any
///     number of threads.
///
/// Raises
/// ------
/// GridMeshError
///     If the loop, the mesh near it or an option is not fit (see `GridMeshError.kind`), or when
///     cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// Nealen, Pett, Alexa, Igarashi: GridMesh, section V. The arrays are copied first; other Python
/// threads run meanwhile.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> t = np.linspace(0, 2 * np.pi, 24, endpoint=False)
/// >>> ring = np.c_[np.cos(t), np.sin(t), 0 * t]
/// >>> fill = gridmesh.fill_hole(ring, np.zeros((0, 3), int), np.arange(24))
/// >>> mesh = np.vstack([ring, fill.vertices])[fill.triangles]
/// >>> bool((np.cross(mesh[:, 1] - mesh[:, 0], mesh[:, 2] - mesh[:, 0])[:, 2] > 0).all())
/// True
#[pyfunction]
#[pyo3(
    signature = (vertices, triangles, r#loop, *, smooth = None, strict = None, polygons = None, sharp = None, creases = None, cells = None, progress = None),
    text_signature = "(vertices, triangles, loop, *, smooth='tangent', strict=False, polygons=None, sharp=None, creases=None, cells='triangles', progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "the keyword-only options of the Python function")]
pub fn fill_hole(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    r#loop: &Bound<'_, PyAny>,
    smooth: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    polygons: Option<&Bound<'_, PyAny>>,
    sharp: Option<&Bound<'_, PyAny>>,
    creases: Option<&Bound<'_, PyAny>>,
    cells: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Fill> {
    let mesh = Mesh::read(vertices, triangles)?;
    let loops = loops_of(r#loop)?;
    let mut options = hard(options(smooth, strict, polygons)?, sharp, creases)?;
    options.cells = shape(cells)?;
    let (positions, faces) = (mesh.positions()?.into_owned(), mesh.faces()?.into_owned());
    let fill = Watch::new(progress)?
        .run(py, |progress| gridmesh::fill::fill_loops(&positions, &faces, &loops, &options, progress))?;
    Fill::new(py, fill)
}

/// Reads one loop, or a list or tuple of several of one hole.
fn loops_of(value: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<u32>>> {
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    if !is_list || !value.get_item(0).is_ok_and(|first| first.len().is_ok()) {
        return Ok(vec![indices(&loop_argument("loop", value))?]);
    }
    let mut loops = Vec::new();
    for (k, item) in value.try_iter()?.enumerate() {
        loops.push(indices(&loop_argument(&format!("loop {k}"), &item?))?);
    }
    Ok(loops)
}

/// Fill every hole of a mesh, or the given ones, in parallel.
///
/// Parameters
/// ----------
/// vertices, triangles
///     The mesh, as `fill_hole` takes it.
/// loops : iterable of (k,) arrays of int, optional
///     Loops as `fill_hole` takes them; None: all boundary loops of the mesh.
/// max_edges : int, optional
///     Without `loops`: holes with more edges are left open (an open sheet's own border, say).
/// smooth, strict, polygons, sharp, creases, cells, progress
///     As in `fill_hole`.
///
/// Returns
/// -------
/// list of Fill or GridMeshError
///     In the order of the loops (found ones: of their least vertices). A loop that cannot be filled gives
///     its error as its item and does not stop the others. The triangles of every item number the new
///     vertices of that item from n on. No new edge or face repeats one of another fill.
///
/// Raises
/// ------
/// GridMeshError
///     If the mesh or an option is not fit, or when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> a, b = np.meshgrid(np.arange(9), np.arange(9), indexing="ij")
/// >>> grid = np.c_[a.ravel(), b.ravel(), 0 * a.ravel()].astype(float)
/// >>> quad = np.array([[9 * i + j for j in range(8)] for i in range(8) if not 2 < i < 5]).ravel()
/// >>> faces = np.r_[np.c_[quad, quad + 9, quad + 1], np.c_[quad + 9, quad + 10, quad + 1]]
/// >>> [len(fill.loop) for fill in gridmesh.fill_holes(grid, faces, max_edges=30)]
/// [22, 22]
#[pyfunction]
#[pyo3(
    signature = (vertices, triangles, loops = None, *, max_edges = None, smooth = None, strict = None, polygons = None, sharp = None, creases = None, cells = None, progress = None),
    text_signature = "(vertices, triangles, loops=None, *, max_edges=None, smooth='tangent', strict=False, polygons=None, sharp=None, creases=None, cells='triangles', progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "the keyword-only options of the Python function")]
pub fn fill_holes(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    loops: Option<&Bound<'_, PyAny>>,
    max_edges: Option<&Bound<'_, PyAny>>,
    smooth: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    polygons: Option<&Bound<'_, PyAny>>,
    sharp: Option<&Bound<'_, PyAny>>,
    creases: Option<&Bound<'_, PyAny>>,
    cells: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyList>> {
    let mesh = Mesh::read(vertices, triangles)?;
    let mut options = hard(options(smooth, strict, polygons)?, sharp, creases)?;
    options.cells = shape(cells)?;
    if let Some(value) = max_edges {
        let it = Argument { name: "max_edges", value, allowed: "a whole number not below 0, or None" };
        options.max_edges = Some(it.count()?);
    }
    let loops = match loops {
        None => None,
        Some(value) => {
            let allowed = "a sequence of (k,) arrays of whole numbers, or None";
            let all = Argument { name: "loops", value, allowed };
            let mut read = vec![];
            for item in value.try_iter().map_err(|_| all.wrong_type())? {
                let name = format!("loop {}", read.len());
                read.push(indices(&loop_argument(&name, &item?))?);
            }
            Some(read)
        }
    };
    let (positions, faces) = (mesh.positions()?.into_owned(), mesh.faces()?.into_owned());
    let fills = Watch::new(progress)?.run(py, |progress| {
        gridmesh::fill::fill_holes(&positions, &faces, loops.as_deref(), &options, progress)
    })?;
    let items = PyList::empty(py);
    for fill in fills {
        match fill {
            Ok(fill) => items.append(Fill::new(py, fill)?)?,
            Err(err) => items.append(from_core(py, &err).into_value(py))?,
        }
    }
    Ok(items.unbind())
}

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
            0 => format!("{triangles} triangles"),
            quads if triangles > 0 => format!("{quads} quads and a triangle"),
            quads => format!("{quads} quads"),
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
            parts.bridged.iter().map(|later| (later.first, later.reversed)).collect::<Vec<_>>(),
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
    later: Vec<(usize, bool)>,
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
        bridged: later.into_iter().map(|(first, reversed)| Bridged { first, reversed }).collect(),
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

/// The words for `smooth`.
const WORDS: [(&str, Smooth); 3] =
    [("flat", Smooth::Flat), ("tangent", Smooth::Tangent), ("curvature", Smooth::Curvature)];

pub(crate) fn options(
    smooth: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    polygons: Option<&Bound<'_, PyAny>>,
) -> PyResult<FillOptions> {
    let mut options = FillOptions::default();
    if let Some(value) = smooth {
        let it = Argument { name: "smooth", value, allowed: "'flat', 'tangent' or 'curvature'" };
        options.smooth = it.word(&WORDS)?;
    }
    if let Some(value) = strict {
        options.strict = Argument { name: "strict", value, allowed: "True or False" }.bool()?;
    }
    if let Some(value) = polygons {
        let allowed = "an (m,) array of whole numbers, or None";
        options.polygons = indices(&Argument { name: "polygons", value, allowed })?;
    }
    Ok(options)
}

/// What the new faces are to be.
pub(crate) fn shape(cells: Option<&Bound<'_, PyAny>>) -> PyResult<CellShape> {
    let words = [("triangles", CellShape::Triangle), ("quads", CellShape::Quad)];
    let read = |value| Argument { name: "cells", value, allowed: "'triangles' or 'quads'" }.word(&words);
    cells.map_or(Ok(CellShape::Triangle), read)
}

/// Adds what is said about hard edges.
fn hard(
    mut options: FillOptions,
    sharp: Option<&Bound<'_, PyAny>>,
    creases: Option<&Bound<'_, PyAny>>,
) -> PyResult<FillOptions> {
    if let Some(value) = sharp {
        let allowed = "an angle from 0 to pi, in radians, or None";
        options.sharp = Some(Argument { name: "sharp", value, allowed }.float()?);
    }
    if let Some(value) = creases {
        options.creases =
            pairs(&Argument { name: "creases", value, allowed: "an (e, 2) array of whole numbers" })?;
    }
    Ok(options)
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
