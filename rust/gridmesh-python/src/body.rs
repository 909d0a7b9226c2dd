//! Patches to surfaces.

use std::sync::Arc;

use gridmesh::body::inflate::InflateOptions;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::input::Argument;
use crate::patch::Patch;
use crate::surface::Surface;
use crate::watch::Watch;
use crate::{error, options};

/// Glue two copies of a patch along all contours: a closed body without volume, a "pillow".
///
/// Parameters
/// ----------
/// patch : Patch
///
/// Returns
/// -------
/// Surface
///     Watertight; all z are 0. The front is numbered as the patch, or its `belt`, the interior vertices of the back follow.
///
/// Raises
/// ------
/// TypeError
///     If `patch` is not a Patch.
///
/// Notes
/// -----
/// Nealen, Pett, Alexa, Igarashi: GridMesh, section IV.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> patch = gridmesh.mesh_sketch([[0, 0], [4, 0], [4, 3], [0, 3]], triangles=300)
/// >>> pillow = gridmesh.stitch(patch)
/// >>> len(pillow.triangles) == 2 * len(patch.triangles), pillow.report["watertight"]
/// (True, True)
#[pyfunction]
#[pyo3(text_signature = "(patch)")]
pub fn stitch(py: Python<'_>, patch: &Bound<'_, PyAny>) -> PyResult<Surface> {
    let core = core_patch(patch)?;
    let surface = error::detached(py, || Ok(gridmesh::body::stitch::stitch(&core)));
    Surface::new(py, &surface.map_err(|failure| failure.into_py(py))?)
}

/// One copy of a patch in the plane z = 0.
///
/// Parameters
/// ----------
/// patch : Patch
///
/// Returns
/// -------
/// Surface
///     Vertices numbered as in the patch, triangles facing +z; "watertight" in its report is False.
///
/// Raises
/// ------
/// TypeError
///     If `patch` is not a Patch.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> patch = gridmesh.mesh_sketch([[0, 0], [4, 0], [4, 3], [0, 3]], triangles=300)
/// >>> sheet = gridmesh.flat(patch)
/// >>> bool((sheet.vertices[:, :2] == patch.vertices).all()), float(abs(sheet.vertices[:, 2]).max())
/// (True, 0.0)
#[pyfunction]
#[pyo3(text_signature = "(patch)")]
pub fn flat(py: Python<'_>, patch: &Bound<'_, PyAny>) -> PyResult<Surface> {
    let core = core_patch(patch)?;
    let surface = error::detached(py, || Ok(gridmesh::body::stitch::flat(&core)));
    Surface::new(py, &surface.map_err(|failure| failure.into_py(py))?)
}

/// Inflate a patch to a smooth, watertight body.
///
/// Parameters
/// ----------
/// patch : Patch
/// depth : float
///     Scales z, from 1e-9 to 1e9; at 1 a circle becomes a sphere.
/// profile : {"round", "even", "flat", "peak"}
///     Cross section of the body. "round": a circle becomes a sphere, a long limb of half width w is about
///     1.41 w high; "even": the limb is about w high; "flat": a plateau with a rounded rim; "peak": a tent.
/// curve : (k,) array, optional
///     Reshapes the profile, k >= 2: values at evenly spaced arguments from 0 to 1 of a smooth curve c. Where the
///     profile has the height h, and `top` is its largest height, the body has top c(h / top). The first value
///     is 0, the others positive, from 1e-6 to 1e6; falling ones make rings and dents. Between values that rise
///     the curve rises. None, or evenly rising to 1: the profile as it is.
/// front, back : float or (n,) array, optional
///     Depth of each side, one number or one per point of the outline: 0, or up to 1e9; None: `depth`.
/// corner_angle : float
///     Drawn corners that turn by more than this (radians) stay sharp.
/// uv : {"apart", "shared"}
///     Where the back lies in the texture: beside the front, as seen from behind, or where the front is.
/// subdivided : bool
///     For quads that a subdivision surface (Catmull-Clark) will smooth: the rim lies a little outside the drawing, so
///     that the smoothed surface's rim lies on it. Vertices at corners of the drawing (`Surface.corner`) stay and are to
///     be creased, with `profile="peak"` the whole rim. Nothing else changes.
/// progress : callable, optional
///     Called with a fraction from 0 to 1; cancels by returning False. What it raises is raised here.
///
/// Returns
/// -------
/// Surface
///     Watertight; the silhouette has the positions of the patch, or of its `belt`, bit for bit, at z = 0, unless `subdivided`. Where front and back have
///     equal depths they are exact mirror images. Self-intersections are possible and are counted in
///     its report. The same input gives the same bytes.
///
/// Raises
/// ------
/// GridMeshError
///     If an option is not allowed (see `GridMeshError.kind`), or when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// Nealen, Igarashi, Sorkine, Alexa: FiberMesh, 2007, section 5. Other Python threads run meanwhile.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
/// >>> patch = gridmesh.mesh_sketch(np.c_[np.cos(t), np.sin(t)], triangles=500)
/// >>> ball = gridmesh.inflate(patch)
/// >>> bool(np.allclose(np.linalg.norm(ball.vertices, axis=1), 1, atol=0.01))
/// True
#[pyfunction]
#[pyo3(
    signature = (patch, *, progress = None, **options),
    text_signature = "(patch, *, depth=1.0, profile='round', curve=None, front=None, back=None, corner_angle=0.6981317007977318, uv='apart', subdivided=False, progress=None)"
)]
pub fn inflate(
    py: Python<'_>,
    patch: &Bound<'_, PyAny>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Surface> {
    let core = core_patch(patch)?;
    let mut chosen = InflateOptions::default();
    options::read("inflate", options, |name, value| options::set_inflate(&mut chosen, name, value))?;
    let surface = Watch::new(progress)?
        .run(py, |progress| gridmesh::body::inflate::inflate(&core, &chosen, progress))?;
    Surface::new(py, &surface)
}

fn core_patch(patch: &Bound<'_, PyAny>) -> PyResult<Arc<gridmesh::patch::Patch>> {
    let argument = Argument { name: "patch", value: patch, allowed: "a Patch, as mesh_sketch returns it" };
    Ok(patch.cast::<Patch>().map_err(|_| argument.wrong_type())?.get().inner.clone())
}
