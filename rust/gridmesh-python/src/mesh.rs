//! Meshes as numpy holds them.

use std::borrow::Cow;

use glam::DVec3;
use numpy::{
    AllowTypeChange, PyArrayDescrMethods, PyArrayLike2, PyArrayLikeDyn, PyReadonlyArray2, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::error::error;
use crate::input::Argument;

/// The arrays of a mesh, held while they are read in place.
pub struct Mesh<'py> {
    positions: PyArrayLike2<'py, f64, AllowTypeChange>,
    faces: Faces<'py>,
}

/// Triangles as numpy holds them, or copied.
enum Faces<'py> {
    Held(PyReadonlyArray2<'py, i32>),
    Copied(Vec<[u32; 3]>),
}

impl<'py> Mesh<'py> {
    /// Reads `vertices` and `triangles`; how far the numbers reach is for the library to check.
    pub fn read(vertices: &Bound<'py, PyAny>, triangles: &Bound<'py, PyAny>) -> PyResult<Self> {
        let positions = read_positions(&positions_argument(vertices))?;
        let faces = read_faces(triangles)?;
        Ok(Mesh { positions, faces })
    }

    /// Its vertices.
    pub fn positions(&self) -> PyResult<Cow<'_, [DVec3]>> {
        as_positions(&self.positions)
    }

    /// Its triangles. Negative numbers become large ones, which no mesh has.
    pub fn faces(&self) -> PyResult<Cow<'_, [[u32; 3]]>> {
        match &self.faces {
            Faces::Held(held) => Ok(Cow::Borrowed(bytemuck::cast_slice(held.as_slice()?))),
            Faces::Copied(faces) => Ok(Cow::Borrowed(faces)),
        }
    }
}

fn read_faces<'py>(triangles: &Bound<'py, PyAny>) -> PyResult<Faces<'py>> {
    let it = Argument { name: "triangles", value: triangles, allowed: "an (m, 3) array of whole numbers" };
    let array = it.array()?;
    if array.len() > 0 && (array.ndim() != 2 || array.shape()[1] != 3) {
        return Err(it.wrong_shape(&format!("has shape {:?}", array.shape())));
    }
    if array.len() == 0 {
        Ok(Faces::Copied(vec![]))
    } else {
        match array.extract::<PyReadonlyArray2<'py, i32>>() {
            Ok(held) if held.is_c_contiguous() => Ok(Faces::Held(held)),
            _ => Ok(Faces::Copied(narrowed(&it, &array)?.as_chunks().0.to_vec())),
        }
    }
}

/// The argument `triangles`, copied.
pub fn triangles(value: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    match read_faces(value)? {
        Faces::Held(held) => Ok(bytemuck::cast_slice(held.as_slice()?).to_vec()),
        Faces::Copied(faces) => Ok(faces),
    }
}

/// The argument `vertices`.
pub fn positions_argument<'a, 'py>(value: &'a Bound<'py, PyAny>) -> Argument<'a, 'py> {
    Argument { name: "vertices", value, allowed: "an (n, 3) array of real numbers" }
}

/// An (n, 3) array, read in place if it holds float64.
pub fn read_positions<'py>(it: &Argument<'_, 'py>) -> PyResult<PyArrayLike2<'py, f64, AllowTypeChange>> {
    let array = it.array()?;
    if array.ndim() != 2 || array.shape()[1] != 3 {
        return Err(it.wrong_shape(&format!("has shape {:?}", array.shape())));
    }
    array.extract()
}

/// In place if the memory is laid out in rows.
pub fn as_positions<'a>(held: &'a PyArrayLike2<'_, f64, AllowTypeChange>) -> PyResult<Cow<'a, [DVec3]>> {
    if held.is_c_contiguous() {
        return Ok(Cow::Borrowed(bytemuck::cast_slice(held.as_slice()?)));
    }
    let rows = held.as_array();
    Ok(Cow::Owned(rows.rows().into_iter().map(|row| DVec3::new(row[0], row[1], row[2])).collect()))
}

/// The argument `loop`, or one of `loops`.
pub fn loop_argument<'a, 'py>(name: &'a str, value: &'a Bound<'py, PyAny>) -> Argument<'a, 'py> {
    Argument { name, value, allowed: "a (k,) array of whole numbers" }
}

/// Whole numbers.
pub fn indices(it: &Argument<'_, '_>) -> PyResult<Vec<u32>> {
    let array = it.array()?;
    if array.ndim() != 1 {
        return Err(it.wrong_shape(&format!("has shape {:?}", array.shape())));
    }
    if array.len() == 0 {
        return Ok(vec![]);
    }
    narrowed(it, &array)
}

/// Rows of two whole numbers.
pub fn pairs(it: &Argument<'_, '_>) -> PyResult<Vec<[u32; 2]>> {
    let array = it.array()?;
    if array.len() == 0 {
        return Ok(vec![]);
    }
    if array.ndim() != 2 || array.shape()[1] != 2 {
        return Err(it.wrong_shape(&format!("has shape {:?}", array.shape())));
    }
    Ok(narrowed(it, &array)?.as_chunks().0.to_vec())
}

/// Whole numbers row by row, as the library numbers vertices: negative ones become large ones, which no mesh has.
pub fn narrowed(it: &Argument<'_, '_>, array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<u32>> {
    let number = |value: i128| {
        i32::try_from(value).map(|v| v as u32).map_err(|_| {
            let message = format!("{} holds {value}; allowed: 0 to {}", it.name, i32::MAX);
            error(it.value.py(), "index_out_of_range", message)
        })
    };
    match (array.dtype().kind(), array.dtype().itemsize()) {
        (b'f', _) => Err(it.wrong_dtype(array, "; convert it with .astype(int)")),
        // As signed integers the greatest would be negative.
        (b'u', 8) => {
            let wide = array.extract::<PyArrayLikeDyn<'_, u64, AllowTypeChange>>()?;
            wide.as_array().iter().map(|&v| number(v.into())).collect()
        }
        _ => {
            let wide = array.extract::<PyArrayLikeDyn<'_, i64, AllowTypeChange>>()?;
            wide.as_array().iter().map(|&v| number(v.into())).collect()
        }
    }
}
