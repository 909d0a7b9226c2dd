//! The Python module `gridmesh._native`: conversions only, no algorithm.
//!
//! `input` and `options` read what Python hands over, `watch` carries progress and signals, `arrays`
//! and `reports` hand results back, `patch`, `surface`, `fill` and `cut` are the classes, `batch` is the parallel map,
//! `combine` unites drawings.
#![forbid(unsafe_code)]

mod arrays;
mod batch;
mod combine;
mod cut;
mod error;
mod fill;
mod input;
mod mesh;
mod options;
mod patch;
mod regrid;
mod reports;
mod surface;
mod watch;

use std::sync::Arc;

use glam::DVec2;
use gridmesh::inflate::InflateOptions;
use gridmesh::options::SketchOptions;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::batch::{Drawing, Job};
use crate::error::{GridMeshError, error};
use crate::input::Argument;
use crate::patch::Patch;
use crate::surface::Surface;
use crate::watch::Watch;

/// Mesh the inside of a closed planar drawing with a semi-regular triangle mesh.
///
/// Parameters
/// ----------
/// outline : (n, 2) array of real numbers, n >= 3
///     Points of the outline in any units, closed implicitly, either orientation; duplicate and
///     collinear points are welcome. Not modified.
/// holes : sequence of (k, 2) arrays, optional
///     Contours inside the outline, in the same way.
/// edge_length : float, optional
///     Edge length of the mesh, in the units of the outline; positive. Not together with `triangles`.
/// triangles : int, optional
///     Number of triangles of the flat patch, from 6 to 20 million, reached within 10 %. 2000 if
///     neither is given.
/// boundary : {"optimal", "grown"}
///     "optimal": the boundary of least cost for this lattice and `max_distance`, where cost = turns +
///     `closeness` x squared distance in edge lengths. "grown": the growth of the paper's sections
///     IV-B to IV-D.
/// max_distance : float
///     Largest distance of the lattice boundary from the outline before it is moved onto it, in edge
///     lengths; 0.5 to 4.
/// closeness : float
///     Price of a squared distance of one edge length against a turn of 60 degrees; at least 0.
/// angle : float, optional
///     Angle of the lattice in radians, in [0, pi / 3). None: the best of several.
/// origin : (2,) array, optional
///     A point of the lattice, in the units of the outline. With `edge_length` and `angle` it keeps the lattice
///     where it was while an outline is being changed. None: the best of a few places. Not together with `mirror`.
/// corner_angle : float
///     A vertex is placed on points where the outline turns by more than this (radians).
/// mirror : "auto" or (point, direction), optional
///     An axis, two pairs of numbers, for a mesh that is its own mirror image: the lattice is laid on
///     the axis and the boundary of least cost taken among the symmetric ones. "auto" finds the axis of
///     the outline, the most upright one if there are several. The sides may differ by 2 % of the
///     drawing's size and by 1.5 edge lengths; then the topology is symmetric, and each side keeps its
///     own line. Only with boundary="optimal"; `angle`, if given, must fit the axis.
/// self_crossing : {"error", "union"}
///     "error": an outline that crosses itself is refused. "union": its outer outline is taken.
/// proof_nodes : int
///     Bounds the search that proves optimality where the first solution had conflicts; 0 beside `mirror`.
/// relax : bool
///     False leaves the interior vertices where the lattice has them; triangles may then be inverted,
///     and such a patch is refused.
/// progress : callable, optional
///     Called with a fraction from 0 to 1; cancels by returning False. What it raises is raised here.
///
/// Returns
/// -------
/// Patch
///     Every boundary vertex lies on its contour, no interior edge joins two boundary vertices, every
///     interior vertex has six triangles, no triangle is inverted (also in float32), and the topology
///     is that of the outline minus its holes. The same input gives the same bytes, for any number of
///     threads. `report` has "triangles", "irregular" (irregular vertices after stitching),
///     "minimum_irregular" (the least that any such body has), "turns", "turns_before" (a grown
///     boundary's, before it is straightened), "turns_bound", "cost", "cost_bound" (None where none
///     was computed), "optimal", "max_distance_used", "max_deviation" (of the boundary's edges from the outline, in edge lengths), "min_angle"
///     (radians), "corners" (drawn ones), "released_corners" (those without a vertex of their own), "bridged_inlets" (with mesh vertices in them: 0, unless `relax` is off),
///     "repaired" (repeated points dropped), "mirror_error" (greatest distance of a vertex from the
///     image of its partner, in edge lengths; None without `mirror`), "placements" (of the lattice, tried) and "seconds" (per
///     stage).
///
/// Raises
/// ------
/// GridMeshError
///     If the drawing or an option is not allowed (see `GridMeshError.kind`), or when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// Nealen, Pett, Alexa, Igarashi: GridMesh, sections II to IV. Other Python threads run meanwhile.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
/// >>> patch = gridmesh.mesh_sketch(np.c_[np.cos(t), np.sin(t)], triangles=500)
/// >>> bool(np.allclose(np.hypot(*patch.vertices[patch.loops[0]].T), 1, atol=1e-3))
/// True
#[pyfunction]
#[pyo3(
    signature = (outline, holes = None, *, progress = None, **options),
    text_signature = "(outline, holes=(), *, edge_length=None, triangles=None, boundary='optimal', max_distance=1.5, closeness=0.3, angle=None, origin=None, corner_angle=0.6981317007977318, mirror=None, self_crossing='error', proof_nodes=0, relax=True, progress=None)"
)]
fn mesh_sketch(
    py: Python<'_>,
    outline: &Bound<'_, PyAny>,
    holes: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Patch> {
    let drawing = drawing(outline, holes)?;
    let mut chosen = SketchOptions::default();
    options::read("mesh_sketch", options, |name, value| options::set_sketch(&mut chosen, name, value))?;
    let sketch = Watch::new(progress)?.run(py, |progress| {
        gridmesh::sketch::mesh_sketch(&drawing.outline, &drawing.holes, &chosen, progress)
    })?;
    let report = reports::sketch(py, &sketch.report)?;
    Ok(Patch::new(sketch.patch, report))
}

/// Glue two copies of a patch along all contours: a closed body without volume, a "pillow".
///
/// Parameters
/// ----------
/// patch : Patch
///
/// Returns
/// -------
/// Surface
///     Watertight; all z are 0. The front is numbered as the patch, the interior vertices of the back follow.
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
fn stitch(py: Python<'_>, patch: &Bound<'_, PyAny>) -> PyResult<Surface> {
    let core = core_patch(patch)?;
    let surface = error::detached(py, || Ok(gridmesh::stitch::stitch(&core)));
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
fn flat(py: Python<'_>, patch: &Bound<'_, PyAny>) -> PyResult<Surface> {
    let core = core_patch(patch)?;
    let surface = error::detached(py, || Ok(gridmesh::stitch::flat(&core)));
    Surface::new(py, &surface.map_err(|failure| failure.into_py(py))?)
}

/// Inflate a patch to a smooth, watertight body.
///
/// Parameters
/// ----------
/// patch : Patch
/// depth : float
///     Scales z; at 1 a circle becomes a sphere.
/// profile : {"round", "even", "flat", "peak"}
///     Cross section of the body. "round": a circle becomes a sphere, a long limb of half width w is about
///     1.41 w high; "even": the limb is about w high; "flat": a plateau with a rounded rim; "peak": a tent.
/// curve : (k,) array, optional
///     Reshapes the profile, k >= 2: values at evenly spaced arguments from 0 to 1 of a smooth curve c. Where the
///     profile has the height h, and `top` is its largest height, the body has top c(h / top). The first value
///     is 0, the others positive, from 1e-6 to 1e6; falling ones make rings and dents. Between values that rise
///     the curve rises. None, or evenly rising to 1: the profile as it is.
/// front, back : float or (n,) array, optional
///     Depth of each side, one number or one per point of the outline; None: `depth`.
/// corner_angle : float
///     Drawn corners that turn by more than this (radians) stay sharp.
/// progress : callable, optional
///     Called with a fraction from 0 to 1; cancels by returning False. What it raises is raised here.
///
/// Returns
/// -------
/// Surface
///     Watertight; the silhouette has the patch's positions bit for bit, at z = 0. Where front and back have
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
    text_signature = "(patch, *, depth=1.0, profile='round', curve=None, front=None, back=None, corner_angle=0.6981317007977318, progress=None)"
)]
fn inflate(
    py: Python<'_>,
    patch: &Bound<'_, PyAny>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Surface> {
    let core = core_patch(patch)?;
    let mut chosen = InflateOptions::default();
    options::read("inflate", options, |name, value| options::set_inflate(&mut chosen, name, value))?;
    let surface =
        Watch::new(progress)?.run(py, |progress| gridmesh::inflate::inflate(&core, &chosen, progress))?;
    Surface::new(py, &surface)
}

/// Mesh many drawings in parallel.
///
/// Parameters
/// ----------
/// outlines : iterable
///     Each item an outline, (n, 2), or a tuple (outline, holes), as `mesh_sketch` takes them.
/// inflate : bool
///     True: inflated bodies. False: only stitched, as by `stitch`.
/// threads : int, optional
///     Number of threads; None: one per processor, or with an executor one per task. Results do not depend on it.
/// executor : concurrent.futures.Executor, optional
///     Does the work elsewhere: processes, or the machines of a cluster (`distributed.Client.get_executor()`), which
///     need this module too. Results are the same bytes on processors of the same kind.
/// progress : callable, optional
///     Called from this thread with the fraction of drawings done; cancels by returning False.
/// **options
///     Those of `mesh_sketch` and `inflate`; `corner_angle` goes to both.
///
/// Returns
/// -------
/// list of Surface or GridMeshError
///     In the order of the drawings. A drawing that cannot be meshed gives its error as its item and
///     does not stop the others.
///
/// Raises
/// ------
/// GridMeshError
///     If the value of `threads` or of a word among the options is not allowed, or when cancelled.
/// TypeError
///     If an option is unknown or has a type that is not allowed.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
/// >>> bodies = gridmesh.map_sketches([square, [[0, 0], [1, 1]]], triangles=300)
/// >>> bodies[0].report["watertight"], bodies[1].kind
/// (True, 'too_few_points')
#[pyfunction]
#[pyo3(
    signature = (outlines, *, inflate = None, threads = None, executor = None, progress = None, **options),
    text_signature = "(outlines, *, inflate=True, threads=None, executor=None, progress=None, **options)"
)]
fn map_sketches(
    py: Python<'_>,
    outlines: &Bound<'_, PyAny>,
    inflate: Option<&Bound<'_, PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
    executor: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Py<PyList>> {
    if let Some(executor) = executor {
        let others = options.map_or_else(|| Ok(PyDict::new(py)), |options| options.copy())?;
        if let Some(inflate) = inflate {
            others.set_item("inflate", inflate)?;
        }
        let spread = py.import("gridmesh._spread")?.getattr("spread")?;
        return Ok(spread
            .call1((executor, outlines, threads, progress, others))?
            .cast_into::<PyList>()?
            .unbind());
    }
    let job = job(inflate, threads, options)?;
    let watch = Watch::new(progress)?;
    let mut drawings = Vec::new();
    let mut unreadable = Vec::new();
    for item in outlines.try_iter()? {
        match map_item(&item?) {
            Ok(drawing) => drawings.push(Some(drawing)),
            Err(err) => {
                drawings.push(None);
                unreadable.push(as_item_error(py, err)?);
            }
        }
    }
    let results = watch.finish(py, error::detached(py, || job.run(&drawings, &watch)))?;
    let mut unreadable = unreadable.into_iter();
    let items = PyList::empty(py);
    for result in results {
        match result {
            Some(Ok(surface)) => items.append(Surface::new(py, &surface)?)?,
            Some(Err(failure)) => items.append(failure.into_py(py).into_value(py))?,
            None => items.append(unreadable.next())?,
        }
    }
    Ok(items.unbind())
}

fn job(
    inflate: Option<&Bound<'_, PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Job> {
    let mut job =
        Job { sketch: SketchOptions::default(), inflate: Some(InflateOptions::default()), threads: None };
    let mut shape = InflateOptions::default();
    options::read("map_sketches", options, |name, value| {
        let in_sketch = options::set_sketch(&mut job.sketch, name, value)?;
        let in_shape = options::set_inflate(&mut shape, name, value)?;
        Ok(in_sketch || in_shape)
    })?;
    let wanted = inflate
        .map_or(Ok(true), |value| Argument { name: "inflate", value, allowed: "True or False" }.bool())?;
    job.inflate = wanted.then_some(shape);
    if let Some(value) = threads {
        let threads = Argument { name: "threads", value, allowed: "a positive whole number, or None" };
        match threads.count()? {
            0 => return Err(threads.wrong_value()),
            count => job.threads = Some(count),
        }
    }
    Ok(job)
}

pub(crate) fn drawing(outline: &Bound<'_, PyAny>, holes: Option<&Bound<'_, PyAny>>) -> PyResult<Drawing> {
    let allowed = "an (n, 2) array of real numbers";
    let outline = Argument { name: "outline", value: outline, allowed }.points()?;
    let mut rings: Vec<Vec<DVec2>> = Vec::new();
    if let Some(value) = holes {
        let all = Argument { name: "holes", value, allowed: "a sequence of (k, 2) arrays of real numbers" };
        for ring in value.try_iter().map_err(|_| all.wrong_type())? {
            let name = format!("hole {}", rings.len());
            rings.push(Argument { name: &name, value: &ring?, allowed }.points()?);
        }
    }
    Ok(Drawing { outline, holes: rings })
}

fn map_item(item: &Bound<'_, PyAny>) -> PyResult<Drawing> {
    // A tuple of two points is no drawing, so a tuple of two is always an outline with its holes.
    match item.cast::<PyTuple>() {
        Ok(pair) if pair.len() == 2 => drawing(&pair.get_item(0)?, Some(&pair.get_item(1)?)),
        _ => drawing(item, None),
    }
}

/// The error of one item as a value for the list; anything that is not about the item is raised.
fn as_item_error(py: Python<'_>, err: PyErr) -> PyResult<Py<PyAny>> {
    if err.is_instance_of::<GridMeshError>(py) {
        Ok(err.into_value(py).into_any())
    } else if err.is_instance_of::<PyTypeError>(py) {
        Ok(error(py, "invalid_type", err.value(py).to_string()).into_value(py).into_any())
    } else {
        Err(err)
    }
}

fn core_patch(patch: &Bound<'_, PyAny>) -> PyResult<Arc<gridmesh::patch::Patch>> {
    let argument = Argument { name: "patch", value: patch, allowed: "a Patch, as mesh_sketch returns it" };
    Ok(patch.cast::<Patch>().map_err(|_| argument.wrong_type())?.get().inner.clone())
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let exception = py.get_type::<GridMeshError>();
    // For errors that others raise with this class; gridmesh always sets the attribute itself.
    exception.setattr("kind", "error")?;
    module.add("GridMeshError", exception)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<Patch>()?;
    module.add_class::<Surface>()?;
    module.add_function(wrap_pyfunction!(mesh_sketch, module)?)?;
    module.add_function(wrap_pyfunction!(stitch, module)?)?;
    module.add_function(wrap_pyfunction!(flat, module)?)?;
    module.add_function(wrap_pyfunction!(inflate, module)?)?;
    module.add_function(wrap_pyfunction!(map_sketches, module)?)?;
    module.add_function(wrap_pyfunction!(combine::combine, module)?)?;
    module.add_class::<fill::Fill>()?;
    module.add_function(wrap_pyfunction!(fill::fill_hole, module)?)?;
    module.add_function(wrap_pyfunction!(fill::fill_holes, module)?)?;
    module.add_class::<regrid::Regrid>()?;
    module.add_function(wrap_pyfunction!(regrid::regrid, module)?)?;
    module.add_class::<cut::Cut>()?;
    module.add_class::<cut::Piece>()?;
    module.add_function(wrap_pyfunction!(cut::cut, module)?)?;
    module.add_function(wrap_pyfunction!(patch::_patch, module)?)?;
    module.add_function(wrap_pyfunction!(surface::_surface, module)?)?;
    module.add_function(wrap_pyfunction!(fill::_fill, module)?)?;
    module.add_function(wrap_pyfunction!(regrid::_regrid, module)?)?;
    Ok(())
}
