//! `bridge`.

use gridmesh::fill::BridgeOptions;
use pyo3::prelude::*;

use crate::fill::{options, shape};
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
///     "curvature": with its slope and curvature.
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
///     share a vertex), or when cancelled.
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
    let (positions, faces) = (mesh.positions()?.into_owned(), mesh.faces()?.into_owned());
    let fill = Watch::new(progress)?
        .run(py, |progress| gridmesh::fill::bridge(&positions, &faces, &one, &two, &options, progress))?;
    Fill::new(py, fill)
}
