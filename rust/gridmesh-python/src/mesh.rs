//! Meshes as numpy holds them.

use std::borrow::Cow;

use glam::DVec3;
use numpy::{
    AllowTypeChange, PyArrayDescrMethods, PyArrayLike1, PyArrayLike2, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

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
    } else if array.dtype().kind() == b'f' {
        Err(it.wrong_type())
    } else {
        match array.extract::<PyReadonlyArray2<'py, i32>>() {
            Ok(held) if held.is_c_contiguous() => Ok(Faces::Held(held)),
            _ => {
                let wide = array.extract::<PyArrayLike2<'_, i64, AllowTypeChange>>()?;
                let table = wide.as_array();
                let rows = table.rows().into_iter().map(|row| [0, 1, 2].map(|k| narrow(row[k])));
                Ok(Faces::Copied(rows.collect()))
            }
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
    if array.dtype().kind() == b'f' {
        return Err(it.wrong_type());
    }
    let wide = array.extract::<PyArrayLike1<'_, i64, AllowTypeChange>>()?;
    Ok(wide.as_array().iter().map(|&v| narrow(v)).collect())
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
    if array.dtype().kind() == b'f' {
        return Err(it.wrong_type());
    }
    let wide = array.extract::<PyArrayLike2<'_, i64, AllowTypeChange>>()?;
    Ok(wide.as_array().rows().into_iter().map(|row| [narrow(row[0]), narrow(row[1])]).collect())
}

/// As the library numbers vertices; what no mesh can have stays out of range.
fn narrow(v: i64) -> u32 {
    i32::try_from(v).unwrap_or(-1) as u32
}
