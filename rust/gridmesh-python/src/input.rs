//! Python values as Rust values, with messages that say what is allowed.

use glam::DVec2;
use numpy::{
    AllowTypeChange, PyArrayDescrMethods, PyArrayLike1, PyArrayLike2, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyList, PyString, PyTuple};

use crate::error::error;
use crate::reports::counted;

/// A named argument, for messages.
#[derive(Clone, Copy)]
pub struct Argument<'a, 'py> {
    /// The name that the caller knows it by, such as `edge_length` or `hole 2`.
    pub name: &'a str,
    /// What was given.
    pub value: &'a Bound<'py, PyAny>,
    /// What is allowed.
    pub allowed: &'static str,
}

impl<'py> Argument<'_, 'py> {
    /// A `TypeError` that names the type found and what is allowed.
    pub fn wrong_type(&self) -> PyErr {
        let found = self.value.get_type().name().map_or_else(|_| "unknown".into(), |name| name.to_string());
        PyTypeError::new_err(format!("{} is of type {found}; allowed: {}", self.name, self.allowed))
    }

    /// A `TypeError` that names what numpy makes of a value; `advice` says what to do.
    pub fn wrong_dtype(&self, array: &Bound<'_, PyUntypedArray>, advice: &str) -> PyErr {
        let value = self.value;
        let read = if value.is_instance_of::<PyUntypedArray>() {
            format!(", of dtype {}", array.dtype())
        } else if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
            format!(", which numpy reads as {}", array.dtype())
        } else {
            return self.wrong_type();
        };
        let found = value.get_type().name().map_or_else(|_| "unknown".into(), |name| name.to_string());
        PyTypeError::new_err(format!(
            "{} is of type {found}{read}; allowed: {}{advice}",
            self.name, self.allowed
        ))
    }

    /// A `GridMeshError` of kind `invalid_option` that shows the value and what is allowed.
    pub fn wrong_value(&self) -> PyErr {
        let shown = self.value.repr().map_or_else(|_| "not allowed".into(), |text| text.to_string());
        error(
            self.value.py(),
            "invalid_option",
            format!("{} is {shown}; allowed: {}", self.name, self.allowed),
        )
    }

    /// A `GridMeshError` of kind `invalid_shape`; `found` says what the value is like.
    pub fn wrong_shape(&self, found: &str) -> PyErr {
        error(self.value.py(), "invalid_shape", format!("{} {found}; allowed: {}", self.name, self.allowed))
    }

    /// A number; whether it is in range is for the library to say.
    pub fn float(&self) -> PyResult<f64> {
        if self.value.is_instance_of::<PyBool>() || self.value.is_instance_of::<PyString>() {
            return Err(self.wrong_type());
        }
        self.refuse_masked()?;
        match self.value.extract::<f64>() {
            Ok(number) => Ok(number),
            Err(err) if err.is_instance_of::<PyOverflowError>(self.value.py()) => Err(self.wrong_value()),
            Err(_) => Err(self.wrong_type()),
        }
    }

    /// A whole number, not negative.
    pub fn count(&self) -> PyResult<usize> {
        if self.value.is_instance_of::<PyBool>() {
            return Err(self.wrong_type());
        }
        match self.value.extract::<usize>() {
            Ok(number) => Ok(number),
            Err(err) if err.is_instance_of::<PyOverflowError>(self.value.py()) => Err(self.wrong_value()),
            Err(_) => Err(self.wrong_type()),
        }
    }

    /// True or False.
    pub fn bool(&self) -> PyResult<bool> {
        self.value.extract().map_err(|_| self.wrong_type())
    }

    /// One of a few words.
    pub fn word<T: Copy>(&self, words: &[(&str, T)]) -> PyResult<T> {
        let text = self.value.cast::<PyString>().map_err(|_| self.wrong_type())?.to_string();
        words
            .iter()
            .find(|(word, _)| *word == text)
            .map(|(_, meaning)| *meaning)
            .ok_or_else(|| self.wrong_value())
    }

    /// `None`, or what `read` makes of the value.
    pub fn optional<T>(self, read: impl FnOnce(Self) -> PyResult<T>) -> PyResult<Option<T>> {
        if self.value.is_none() { Ok(None) } else { read(self).map(Some) }
    }

    /// Anything that numpy can read as an (n, 2) array of real numbers. The points are copied.
    pub fn points(&self) -> PyResult<Vec<DVec2>> {
        let array = self.array()?;
        // An empty list has one dimension; the library says that points are missing.
        if array.len() == 0 {
            return Ok(Vec::new());
        }
        if array.ndim() != 2 || array.shape()[1] != 2 {
            return Err(self.wrong_shape(&format!("has shape {:?}", array.shape())));
        }
        let points = array.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>()?;
        Ok(points.as_array().rows().into_iter().map(|row| DVec2::new(row[0], row[1])).collect())
    }

    /// Anything that numpy can read as a pair of real numbers.
    pub fn pair(&self) -> PyResult<DVec2> {
        let numbers = self.numbers()?;
        match numbers[..] {
            [x, y] => Ok(DVec2::new(x, y)),
            _ => Err(self.wrong_shape(&format!("has {} numbers", numbers.len()))),
        }
    }

    /// Anything that numpy can read as a one-dimensional array of real numbers.
    pub fn numbers(&self) -> PyResult<Vec<f64>> {
        let array = self.array()?;
        if array.ndim() != 1 {
            return Err(self.wrong_shape(&format!("has shape {:?}", array.shape())));
        }
        let numbers = array.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>()?;
        Ok(numbers.as_array().to_vec())
    }

    /// `numpy.asarray` of the value, if it holds real numbers.
    pub fn array(&self) -> PyResult<Bound<'py, PyUntypedArray>> {
        static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let py = self.value.py();
        self.refuse_masked()?;
        let as_array = AS_ARRAY.import(py, "numpy", "asarray")?;
        let array = as_array.call1((self.value,)).map_err(|err| {
            if !err.is_instance_of::<pyo3::exceptions::PyValueError>(py) {
                return err;
            }
            let reason = err.value(py).to_string();
            if reason.contains("inhomogeneous") {
                self.wrong_shape("has rows of different lengths")
            } else {
                self.wrong_shape(&format!("is not an array ({reason})"))
            }
        })?;
        let array = array.cast_into::<PyUntypedArray>()?;
        match array.dtype().kind() {
            b'f' | b'i' | b'u' => Ok(array),
            _ => Err(self.wrong_dtype(&array, "")),
        }
    }

    /// Refuses an array, or a list of arrays, with masked values: numpy would go on with what lies under the mask.
    pub fn refuse_masked(&self) -> PyResult<()> {
        if self.value.is_instance_of::<PyList>() || self.value.is_instance_of::<PyTuple>() {
            for (k, row) in self.value.try_iter()?.enumerate() {
                self.refuse_masked_in(&row?, &format!(", row {k},"))?;
            }
            return Ok(());
        }
        self.refuse_masked_in(self.value, "")
    }

    fn refuse_masked_in(&self, value: &Bound<'py, PyAny>, place: &str) -> PyResult<()> {
        static MASKED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        static COUNT: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let py = value.py();
        if !value.is_instance(MASKED.import(py, "numpy.ma", "MaskedArray")?)? {
            return Ok(());
        }
        let masked = COUNT.import(py, "numpy.ma", "count_masked")?.call1((value,))?.extract::<usize>()?;
        if masked == 0 {
            return Ok(());
        }
        let values = counted(masked, "masked value");
        Err(PyTypeError::new_err(format!(
            "{}{place} has {values}; allowed: {}; leave out what is masked, or fill it in with numpy.ma.filled",
            self.name, self.allowed
        )))
    }
}
