//! `fill_hole` and `fill_holes`.

use std::collections::BTreeMap;

use gridmesh::error::Error;
use gridmesh::fill::FillOptions;
use gridmesh::options::CellShape;
use pyo3::prelude::*;
use pyo3::types::{PyInt, PyList, PyTuple};

use crate::error::{from_core, is_of_kind};
use crate::filled::{Fill, WORDS};
use crate::input::Argument;
use crate::mesh::{Mesh, as_positions, indices, loop_argument, pairs, read_positions};
use crate::watch::Watch;

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
///     several; the patch has them all as its boundary. Two are joined by a tube, as `bridge` does; between three or more a tube leaves each loop where
///     there is room, and where these come together, or between the loops, the faces are even, but no grid. Several loops without `sharp`.
/// smooth : {"flat", "tangent", "curvature"}
///     "flat": a soap film in the loop. "tangent": continues the slope of the surface around. "curvature":
///     its slope and curvature. A patch that would meet something then is a film, if that meets nothing ("repaired" in
///     the report).
/// strict : bool
///     True: a fill that meets itself or the mesh is refused. False: this is counted in the report; but one patch between several loops
///     that look away from each other (see `look_apart`), as both ends of a pipe do, is always refused where it would meet something.
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
///     "quads": all new faces are quads if the loop has, or several loops have in sum, an even number of edges; if it is
///     odd one is a triangle.
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
    let mut options = hard(options(smooth, strict, polygons)?, sharp, creases, mesh.positions()?.len())?;
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
        let allowed = "a (k,) array of whole numbers, or a list of several";
        return Ok(vec![indices(&Argument { name: "loop", value, allowed })?]);
    }
    read_loops(value)
}

/// Reads several loops.
pub(crate) fn read_loops(value: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<u32>>> {
    let allowed = "a sequence of (k,) arrays of whole numbers, one for each loop";
    let items = each(&Argument { name: "loops", value, allowed })?;
    let read = |(k, item)| indices(&loop_argument(&format!("loop {k}"), item));
    items.iter().enumerate().map(read).collect()
}

/// The items of a sequence of loops; one loop is none.
fn each<'py>(loops: &Argument<'_, 'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let items = loops.value.try_iter().map_err(|_| loops.wrong_type())?.collect::<PyResult<Vec<_>>>()?;
    let number =
        items.iter().position(|item| item.is_instance_of::<PyInt>() || item.extract::<f64>().is_ok());
    match number {
        Some(k) => Err(loops.wrong_shape(&format!("has a single number at place {k}"))),
        None => Ok(items),
    }
}

/// Tell whether a loop is the outer border of a sheet that is flat there, and no hole in one and no end of a pipe: a patch would
/// lie on the sheet.
///
/// Parameters
/// ----------
/// points : (n, 3) array of real numbers
///     The loop's vertices in order, in the direction in which a patch is wound.
/// into : (n, 3) array of real numbers
///     From the edge between each vertex and the next one into its face, such as to the middle of that; of any length, zero where
///     there is no face.
///
/// Returns
/// -------
/// bool
///     True if the faces lead into what the loop encloses, at less than 26 degrees on average. False for what is not finite.
///
/// Raises
/// ------
/// GridMeshError
///     If the arrays differ in length or have other shapes.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
/// >>> inside = np.array([0.5, 0.5, 0]) - square
/// >>> gridmesh.is_outer_border(square, inside), gridmesh.is_outer_border(square, -inside)
/// (True, False)
#[pyfunction]
pub fn is_outer_border(points: &Bound<'_, PyAny>, into: &Bound<'_, PyAny>) -> PyResult<bool> {
    let allowed = "an (n, 3) array of real numbers, as long as the other one";
    let points = Argument { name: "points", value: points, allowed };
    let into = Argument { name: "into", value: into, allowed };
    let (at, ways) = (read_positions(&points)?, read_positions(&into)?);
    let (at, ways) = (as_positions(&at)?, as_positions(&ways)?);
    if at.len() != ways.len() {
        return Err(into.wrong_shape(&format!("has {} rows, points has {}", ways.len(), at.len())));
    }
    Ok(gridmesh::fill::loops::outer::is_outer_border(&at, &ways))
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
    let mut options = hard(options(smooth, strict, polygons)?, sharp, creases, mesh.positions()?.len())?;
    options.cells = shape(cells)?;
    if let Some(value) = max_edges {
        let it = Argument { name: "max_edges", value, allowed: "a whole number not below 0, or None" };
        options.max_edges = Some(it.count()?);
    }
    let mut unread = BTreeMap::new();
    let loops = match loops {
        None => None,
        Some(value) => {
            let allowed = "a sequence of (k,) arrays of whole numbers, or None";
            let all = Argument { name: "loops", value, allowed };
            let mut read = vec![];
            for item in each(&all)? {
                let name = format!("loop {}", read.len());
                match indices(&loop_argument(&name, &item)) {
                    Ok(vertices) => read.push(vertices),
                    // Its own error takes the place of that of the empty loop.
                    Err(err) if is_of_kind(py, &err, "index_out_of_range") => {
                        unread.insert(read.len(), err);
                        read.push(vec![]);
                    }
                    Err(err) => return Err(err),
                }
            }
            Some(read)
        }
    };
    let (positions, faces) = (mesh.positions()?.into_owned(), mesh.faces()?.into_owned());
    let fills = Watch::new(progress)?.run(py, |progress| {
        gridmesh::fill::fill_holes(&positions, &faces, loops.as_deref(), &options, progress)
    })?;
    let items = PyList::empty(py);
    for (k, fill) in fills.into_iter().enumerate() {
        match (unread.remove(&k), fill) {
            (Some(err), _) => items.append(err.into_value(py))?,
            (None, Ok(fill)) => items.append(Fill::new(py, fill)?)?,
            (None, Err(err)) => items.append(from_core(py, &err).into_value(py))?,
        }
    }
    Ok(items.unbind())
}

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
    vertices: usize,
) -> PyResult<FillOptions> {
    if let Some(value) = sharp {
        let allowed = "an angle from 0 to pi, in radians, or None";
        options.sharp = Some(Argument { name: "sharp", value, allowed }.float()?);
    }
    if let Some(value) = creases {
        options.creases =
            pairs(&Argument { name: "creases", value, allowed: "an (e, 2) array of whole numbers" })?;
        if let Some(&v) = options.creases.iter().flatten().find(|&&v| v as usize >= vertices) {
            let what = "list of creases".into();
            let found = Error::IndexOutOfRange { what, index: v as i32, vertices };
            return Err(from_core(value.py(), &found));
        }
    }
    Ok(options)
}
