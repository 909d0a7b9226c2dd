//! Rust errors as the one Python exception.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use gridmesh::error::{Error, Needed, Result};
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::process;
use crate::watch::SIGNALS_EVERY;

create_exception!(
    gridmesh,
    GridMeshError,
    PyValueError,
    "Why a call was refused; nothing was changed or returned half done.\n\
     \n\
     The message says what is wrong, where, what is allowed and what to do.\n\
     \n\
     Attributes\n\
     ----------\n\
     kind : str\n    \
         A stable word for programs: \"not_finite\", \"extreme_size\", \"too_few_points\", \"zero_area\",\n    \
         \"self_intersecting\", \"disconnected\", \"hole_misplaced\", \"not_symmetric\", \"invalid_option\", \"invalid_shape\",\n    \
         \"invalid_type\" (only inside the list of `map_sketches`; elsewhere a TypeError is raised),\n    \
         \"too_coarse\", \"too_large\", \"no_patch\", \"inverted\", \"solver\", \"cancelled\"; of fills\n    \
         \"index_out_of_range\", \"repeated_vertex\", \"figure_eight\", \"branching\", \"open_chain\", \"zero_length_edge\",\n    \
         \"self_touching\", \"loops_touch\", \"faces_on_both_sides\", \"non_manifold\", \"shared_edge\",\n    \
         \"fill_intersects\", \"not_a_disk\"; of cuts\n    \
         \"invalid_face\", \"stroke_too_short\", \"stroke_misses\", \"slice_too_thin\", \"behind_eye\",\n    \
         \"cut_failed\", \"still_joined\"; of joins \"not_closed\", \"join_failed\", \"join_intersects\";\n    \
         of pictures \"picture_size\", \"picture_format\"; or \"internal\" (a bug in gridmesh: please report it).\n\
     least : int or None\n    \
         Of \"too_coarse\": the least number of triangles, or of quads, that works, where it is known."
);

/// A [`GridMeshError`] with its `kind`; `least` is not known.
pub fn error(py: Python<'_>, kind: &str, message: impl Into<String>) -> PyErr {
    let err = GridMeshError::new_err(message.into());
    with(py, with(py, err, "kind", kind), "least", None::<usize>)
}

/// An exception with one more attribute.
fn with<'py>(py: Python<'py>, err: PyErr, name: &str, value: impl IntoPyObject<'py>) -> PyErr {
    match err.value(py).setattr(name, value) {
        Ok(()) => err,
        Err(other) => other,
    }
}

/// Whether this is a [`GridMeshError`] of this kind.
pub fn is_of_kind(py: Python<'_>, err: &PyErr, kind: &str) -> bool {
    let value = err.value(py);
    value.is_instance_of::<GridMeshError>()
        && value.getattr("kind").and_then(|found| found.eq(kind)).unwrap_or_default()
}

/// An error of the library as a [`GridMeshError`].
pub fn from_core(py: Python<'_>, err: &Error) -> PyErr {
    let refused = error(py, err.kind(), err.to_string());
    match err {
        Error::TooCoarse { needed: Needed::Least(least), .. } => with(py, refused, "least", *least),
        _ => refused,
    }
}

/// Runs `work` without the interpreter lock; a panic, always a bug, becomes an error of kind `internal`.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T> + Send) -> Result<T, Failure> {
    py.detach(|| guarded(|| process::run(work, SIGNALS_EVERY, || {})))
}

/// Runs `work`; a panic becomes [`Failure::Panic`].
pub fn guarded<T>(work: impl FnOnce() -> Result<T>) -> Result<T, Failure> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(result) => result.map_err(Failure::Refused),
        Err(payload) => Err(Failure::Panic(text_of(payload.as_ref()))),
    }
}

/// Why there is no result.
pub enum Failure {
    /// The library said why.
    Refused(Error),
    /// The library broke; the text of the panic.
    Panic(String),
}

impl Failure {
    /// As a Python exception.
    pub fn into_py(self, py: Python<'_>) -> PyErr {
        match self {
            Failure::Refused(err) => from_core(py, &err),
            Failure::Panic(text) => {
                error(py, "internal", format!("a bug in gridmesh, please report it with this input: {text}"))
            }
        }
    }
}

fn text_of(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no message").to_owned()
}
