//! Many drawings at once.

use gridmesh::body::inflate::InflateOptions;
use gridmesh::options::SketchOptions;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::batch::{Drawing, Job};
use crate::error::{GridMeshError, error};
use crate::input::Argument;
use crate::options::Shape;
use crate::sketch::drawing;
use crate::surface::Surface;
use crate::watch::Watch;
use crate::{error, options};

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
///     need this module too. Results are the same bytes wherever they are made.
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
pub fn map_sketches(
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
    let job = job(py, inflate, threads, options)?;
    let watch = Watch::new(progress)?;
    let mut drawings = Vec::new();
    let mut unreadable = Vec::new();
    let allowed = "a sequence of outlines, or of pairs (outline, holes)";
    let all = Argument { name: "outlines", value: outlines, allowed };
    for item in outlines.try_iter().map_err(|_| all.wrong_type())? {
        match map_item(&item?) {
            Ok(drawing) => drawings.push(Some(drawing)),
            Err(err) => {
                drawings.push(None);
                unreadable.push(as_item_error(py, err)?);
            }
        }
    }
    let results = watch.finish(py, py.detach(|| error::guarded(|| job.run(&drawings, &watch))))?;
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
    py: Python<'_>,
    inflate: Option<&Bound<'_, PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Job> {
    let mut job =
        Job { sketch: SketchOptions::default(), inflate: Some(InflateOptions::default()), threads: None };
    let mut shape = InflateOptions::default();
    let mut cells = Shape::default();
    options::read("map_sketches", options, |name, value| {
        let in_sketch = cells.set(&mut job.sketch, name, value)?;
        let in_shape = options::set_inflate(&mut shape, name, value)?;
        Ok(in_sketch || in_shape)
    })?;
    cells.settle(py, &mut job.sketch)?;
    // All become bodies.
    job.sketch.open_corners = false;
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
