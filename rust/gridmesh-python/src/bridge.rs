//! `bridge`, `bridge_pairs` and `look_apart`.

use gridmesh::fill::BridgeOptions;
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::error::from_core;
use crate::fill::{options, read_loops, shape};
use crate::filled::Fill;
use crate::input::Argument;
use crate::mesh::{Mesh, indices, loop_argument};
use crate::watch::Watch;

/// Join two loops of a mesh by a regular tube, whatever their numbers of vertices.
///
/// Parameters
/// ----------
/// vertices, triangles
///     The mesh, as `fill_hole` takes it; (0, 3) triangles for loops of edges without a mesh.
/// loop, other : (k,) arrays of int, k >= 3
///     The vertices of each loop in order, either way round, each once and in one loop only.
/// smooth : {"flat", "tangent", "curvature"}
///     "flat": straight from loop to loop. "tangent": leaves both loops with the slope of the surface there.
///     "curvature": with its slope and curvature. Out of a hole in a sheet it goes by a neck, around which the surface is rounded; loops
///     that look the same way, as two holes in a wall do, are joined by a handle outside, with "flat", too.
/// rows : int, optional
///     Rows of faces between the loops, at least one. None: as many as the lengths of the edges ask for, more
///     where the loops are further apart.
/// twist : float
///     By how much the other loop is turned on against the best fit, in radians; more than a whole turn
///     winds the tube up.
/// strict : bool
///     True: a tube that meets itself or the mesh is refused. False: this is counted in the report.
/// polygons : (m,) array of int, optional
///     As in `fill_hole`.
/// cells : {"triangles", "quads"}
///     "quads": all new faces are quads if the loops have an even number of edges in sum; if it is odd one is a triangle.
/// progress : callable, optional
///     Called with a fraction from 0 to 1, which never falls; cancels by returning False. What it raises is
///     raised here.
///
/// Returns
/// -------
/// Fill
///     Its `loop` is `loop` followed by `other`. No vertex of them is moved and none is added; each of their edges
///     gets exactly one new face, wound against its neighbour (against most of them where the two sides
///     disagree: report["winding_conflicts"]); the patch is an annulus; no new edge or face repeats one of the
///     mesh. Inside it is a piece of the lattice on a cylinder or a cone, so that every new vertex has six
///     neighbours; report["grid"] is "graded", and report["irregular"] above 0, where the counts allow no such piece. Of quads every new
///     vertex has four where the counts are equal; where they are not there are two poles, of three and five quads, for
///     as many vertices as twice the rows between. The same input gives the same bytes, for any number of threads. Time grows with the size of the tube.
///
/// Raises
/// ------
/// GridMeshError
///     If a loop, the mesh near it or an option is not fit (see `GridMeshError.kind`; "figure_eight" for loops that
///     share a vertex, "loops_touch" for loops that lie on each other, all along or in places), or when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// A tube has Euler characteristic 0: unlike a disk it needs no irregular vertex. Loops of n and m vertices, r rows
/// apart, fit on a cone of (n - m) / r times 60 degrees. The arrays are copied first; other Python threads run
/// meanwhile.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> ring = lambda n, r, z: [(r * np.cos(t), r * np.sin(t), z) for t in np.arange(n) * 2 * np.pi / n]
/// >>> rings = np.array(ring(24, 1, 0) + ring(36, 1.5, 1))
/// >>> tube = gridmesh.bridge(rings, np.zeros((0, 3), int), np.arange(24), np.arange(24, 60))
/// >>> tube.report["irregular"], len(tube.triangles) == 2 * len(tube.vertices) + 60
/// (0, True)
#[pyfunction]
#[pyo3(
    signature = (vertices, triangles, r#loop, other, *, smooth = None, rows = None, twist = None, strict = None, polygons = None, cells = None, progress = None),
    text_signature = "(vertices, triangles, loop, other, *, smooth='tangent', rows=None, twist=0.0, strict=False, polygons=None, cells='triangles', progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "the keyword-only options of the Python function")]
pub fn bridge(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    r#loop: &Bound<'_, PyAny>,
    other: &Bound<'_, PyAny>,
    smooth: Option<&Bound<'_, PyAny>>,
    rows: Option<&Bound<'_, PyAny>>,
    twist: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    polygons: Option<&Bound<'_, PyAny>>,
    cells: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Fill> {
    let mesh = Mesh::read(vertices, triangles)?;
    let one = indices(&loop_argument("loop", r#loop))?;
    let two = indices(&loop_argument("other", other))?;
    let options = bridge_options(smooth, rows, twist, strict, polygons, cells)?;
    let (positions, faces) = (mesh.positions()?.into_owned(), mesh.faces()?.into_owned());
    let fill = Watch::new(progress)?
        .run(py, |progress| gridmesh::fill::bridge(&positions, &faces, &one, &two, &options, progress))?;
    Fill::new(py, fill)
}

/// Join loops of a mesh two by two, each pair by a tube as `bridge` makes it.
///
/// Parameters
/// ----------
/// vertices, triangles
///     The mesh, as `fill_hole` takes it.
/// loops : iterable of (k,) arrays of int
///     Loops as `fill_hole` takes them, with no vertex in common. Those that are nearest and face each other best come first; of an
///     odd number one is left over.
/// smooth, rows, twist, strict, polygons, cells, progress
///     As in `bridge`.
///
/// Returns
/// -------
/// list of (int, int, Fill or GridMeshError)
///     For each pair the places of its two loops and what joins them; a tube that cannot be made gives its error and does not stop
///     the others. What tubes meet is counted among the earlier ones too. The faces of every tube number its new vertices from n on.
///
/// Raises
/// ------
/// GridMeshError
///     If a loop, the mesh near it or an option is not fit, or when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> ring = lambda n, r, z: [(r * np.cos(t), r * np.sin(t), z) for t in np.arange(n) * 2 * np.pi / n]
/// >>> rings = np.array(ring(24, 1, 0) + ring(36, 1, 1) + ring(24, 1, 5) + ring(36, 1, 6))
/// >>> loops = np.split(np.arange(120), [24, 60, 84])
/// >>> [(a, b) for a, b, _ in gridmesh.bridge_pairs(rings, np.zeros((0, 3), int), loops)]
/// [(0, 1), (2, 3)]
#[pyfunction]
#[pyo3(
    signature = (vertices, triangles, loops, *, smooth = None, rows = None, twist = None, strict = None, polygons = None, cells = None, progress = None),
    text_signature = "(vertices, triangles, loops, *, smooth='tangent', rows=None, twist=0.0, strict=False, polygons=None, cells='triangles', progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "the keyword-only options of the Python function")]
pub fn bridge_pairs(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    loops: &Bound<'_, PyAny>,
    smooth: Option<&Bound<'_, PyAny>>,
    rows: Option<&Bound<'_, PyAny>>,
    twist: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    polygons: Option<&Bound<'_, PyAny>>,
    cells: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyList>> {
    let mesh = Mesh::read(vertices, triangles)?;
    let loops = read_loops(loops)?;
    let options = bridge_options(smooth, rows, twist, strict, polygons, cells)?;
    let (positions, faces) = (mesh.positions()?.into_owned(), mesh.faces()?.into_owned());
    let pairs = Watch::new(progress)?
        .run(py, |progress| gridmesh::fill::bridge_pairs(&positions, &faces, &loops, &options, progress))?;
    let items = PyList::empty(py);
    for pair in pairs {
        let [a, b] = pair.loops;
        match pair.tube {
            Ok(tube) => items.append((a, b, Fill::new(py, tube)?))?,
            Err(err) => items.append((a, b, from_core(py, &err).into_value(py)))?,
        }
    }
    Ok(items.unbind())
}

/// Tell whether two of some loops look away from each other, as both ends of a pipe do: one patch between all of them would have to
/// turn round and meet itself, where tubes between pairs of them need not (`bridge_pairs`).
///
/// Parameters
/// ----------
/// vertices, triangles
///     The mesh, as `fill_hole` takes it.
/// loops : iterable of (k,) arrays of int
///     Loops as `fill_hole` takes them, with no vertex in common.
///
/// Returns
/// -------
/// bool
///     Loops without faces and holes in flat sheets look nowhere.
///
/// Raises
/// ------
/// GridMeshError
///     If a loop or the mesh near it is not fit.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> ring = lambda n, r, z: [(r * np.cos(t), r * np.sin(t), z) for t in np.arange(n) * 2 * np.pi / n]
/// >>> k = np.arange(24)
/// >>> wall = np.r_[np.c_[k, (k + 1) % 24, k + 24], np.c_[(k + 1) % 24, (k + 1) % 24 + 24, k + 24]]
/// >>> gridmesh.look_apart(np.array(ring(24, 1, 0) + ring(24, 1, 3)), wall, [k, k + 24])
/// True
#[pyfunction]
pub fn look_apart(
    vertices: &Bound<'_, PyAny>,
    triangles: &Bound<'_, PyAny>,
    loops: &Bound<'_, PyAny>,
) -> PyResult<bool> {
    let mesh = Mesh::read(vertices, triangles)?;
    let loops = read_loops(loops)?;
    let apart = gridmesh::fill::look_apart(&mesh.positions()?, &mesh.faces()?, &loops);
    apart.map_err(|err| from_core(vertices.py(), &err))
}

fn bridge_options(
    smooth: Option<&Bound<'_, PyAny>>,
    rows: Option<&Bound<'_, PyAny>>,
    twist: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    polygons: Option<&Bound<'_, PyAny>>,
    cells: Option<&Bound<'_, PyAny>>,
) -> PyResult<BridgeOptions> {
    let rest = options(smooth, strict, polygons)?;
    let mut options = BridgeOptions {
        smooth: rest.smooth,
        strict: rest.strict,
        cells: shape(cells)?,
        polygons: rest.polygons,
        ..BridgeOptions::default()
    };
    if let Some(value) = rows {
        let it = Argument { name: "rows", value, allowed: "a whole number above 0, or None" };
        options.rows = Some(it.count()?);
    }
    if let Some(value) = twist {
        options.twist = Argument { name: "twist", value, allowed: "a finite angle in radians" }.float()?;
    }
    Ok(options)
}
