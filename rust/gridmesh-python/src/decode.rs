//! `decode_image`: pixels of a file.

use gridmesh::picture::decode::{Decoded, decode_image as core_decode};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

use crate::error;
use crate::input::Argument;

/// Decode the contents of a PNG, JPEG or WebP file.
///
/// Parameters
/// ----------
/// data : bytes or bytearray
///     The whole file.
///
/// Returns
/// -------
/// (h, w, 4) uint8
///     Red, green, blue and alpha, rows from the top: what `trace_image` takes. Depths above 8 bits are rounded, palettes and
///     grey become colours, CMYK is converted. Colour profiles, and the orientation that a camera noted, are not applied.
///
/// Raises
/// ------
/// GridMeshError
///     "picture_size" (more than 100 million pixels; asked for before memory is taken for them), "picture_format" (another format,
///     damaged, cut off, or an animation).
/// TypeError
///     If `data` is no bytes.
///
/// Notes
/// -----
/// In O(pixels); up to twelve bytes a pixel while it decodes.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> import zlib, struct
/// >>> chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
/// >>> head = struct.pack(">IIBBBBB", 1, 1, 8, 6, 0, 0, 0)
/// >>> body = zlib.compress(bytes([0, 10, 20, 30, 40]))
/// >>> png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
/// >>> gridmesh.decode_image(png)
/// array([[[10, 20, 30, 40]]], dtype=uint8)
#[pyfunction]
pub fn decode_image<'py>(py: Python<'py>, data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let it = Argument { name: "data", value: data, allowed: "bytes, the contents of a file" };
    let bytes = data.extract::<PyBackedBytes>().map_err(|_| it.wrong_type())?;
    let found = error::detached(py, || core_decode(&bytes));
    let Decoded { width, height, pixels } = found.map_err(|failure| failure.into_py(py))?;
    Ok(PyArray1::from_vec(py, pixels).reshape([height, width, 4])?.into_any())
}
