//! `trace_image`: outlines of pictures.

use gridmesh::drawing::combine::Part;
use gridmesh::error::Result;
use gridmesh::picture::{Picture, Threshold, TraceOptions, paper, trace_image as core_trace};
use numpy::ndarray::{ArrayViewD, Axis, Ix3, ShapeError};
use numpy::{
    AllowTypeChange, PyArrayDescrMethods, PyArrayLikeDyn, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyList, PyString, PyTuple};

use crate::input::Argument;
use crate::watch::Watch;
use crate::{arrays, error};

const IMAGE: &str = "an (h, w) array of coverage or an (h, w, 4) array whose last channel is alpha, of uint8, \
                     uint16, bool or float from 0 to 1";
const PAPER: &str = "an (h, w) array of brightness or an (h, w, 3) or (h, w, 4) array of colours, of uint8, uint16, \
                     bool or float from 0 to 1";

/// Trace the outlines, with holes, of what a picture shows.
///
/// Parameters
/// ----------
/// image : (h, w) or (h, w, 4) array of uint8, uint16, bool or float
///     Coverage, or colours with their alpha last; rows from the top. 255 (uint8), 65535 (uint16), True and
///     1.0 cover a pixel in full; floats are limited to 0 to 1. At most 100 million pixels.
/// threshold : float or "auto", optional
///     The outline runs where coverage passes this value, above 0 and below 1. "auto": the value that parts
///     the pixels best into two groups.
/// smooth : float, optional
///     0 to 10. 1 removes what pixels and a few steps of coverage put in, larger values look farther along
///     the outline; 0 leaves the level line between the pixels' centres as it is.
/// min_area : float, optional
///     Islands and holes of fewer square pixels are left out, and counted.
/// margin : float, optional
///     How far outlines are moved outward, in pixels, 0 to 1000; parts that come nearer to
///     each other than 0.8 pixels become one, and narrower gaps are closed. From 1 on
///     every pixel of at least the threshold lies inside with its whole square: the outline is moved a little
///     more where that needs it.
/// background : {"transparent", "paper"}, optional
///     "paper": what is drawn on paper and scanned or photographed, under uneven light too. The image is then
///     (h, w) brightness or (h, w, 3) or (h, w, 4) colours, and what is darker or more colourful than the
///     paper around it is covered.
/// progress : callable, optional
///     Called with fractions of the work done; cancels by returning False.
///
/// Returns
/// -------
/// Traced, a list of (outline, holes)
///     Largest first: an (n, 2) float64 array, counter-clockwise, and a list of clockwise ones, in pixels, x to the
///     right, y up, the origin at the lower left corner of the picture. `mesh_sketch` takes each pair: no contour
///     meets itself or another one. Points lie within half a pixel of the level line, corners where the sides
///     meet that lead to them, and so do tips finer than a pixel, as far as the coverage says that they go. An anti-aliased edge is found where it was drawn. Empty
///     where nothing is covered. Attributes: `dropped` (islands left out), `filled` (holes left out),
///     `threshold` (the one used).
///
/// Raises
/// ------
/// GridMeshError
///     "invalid_shape", "picture_size" (no pixel, or too many), "not_finite", "invalid_option", "cancelled".
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// In O(pixels + n log n); about ten bytes a pixel. Lorensen and Cline: Marching cubes, 1987 (in the plane); Cummins,
/// Francois and Kothe: Estimating curvature from volume fractions, 2005; Savitzky and Golay 1964; Otsu 1979.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> import numpy as np
/// >>> y, x = np.mgrid[:100, :100]
/// >>> disk = np.clip(40.5 - np.hypot(x - 49.5, y - 49.5), 0, 1)
/// >>> [(outline, holes)] = gridmesh.trace_image(disk)
/// >>> bool(np.abs(np.hypot(*(outline - 50).T) - 40).max() < 0.1)
/// True
/// >>> gridmesh.mesh_sketch(outline, holes, triangles=500).report["triangles"] > 450
/// True
#[pyfunction]
#[pyo3(
    signature = (image, *, threshold = None, smooth = None, min_area = None, margin = None, background = None,
                 progress = None),
    text_signature = "(image, *, threshold=0.5, smooth=1.0, min_area=16, margin=0.0, background='transparent', progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "the Python signature")]
pub fn trace_image(
    py: Python<'_>,
    image: &Bound<'_, PyAny>,
    threshold: Option<&Bound<'_, PyAny>>,
    smooth: Option<&Bound<'_, PyAny>>,
    min_area: Option<&Bound<'_, PyAny>>,
    margin: Option<&Bound<'_, PyAny>>,
    background: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    let mut options = TraceOptions::default();
    let number = "a number";
    if let Some(value) = threshold {
        let it = Argument { name: "threshold", value, allowed: "a number above 0 and below 1, or 'auto'" };
        options.threshold = if value.is_instance_of::<PyString>() {
            it.word(&[("auto", Threshold::Auto)])?
        } else {
            Threshold::At(it.float()?)
        };
    }
    for (name, value, option) in [
        ("smooth", smooth, &mut options.smooth),
        ("min_area", min_area, &mut options.min_area),
        ("margin", margin, &mut options.margin),
    ] {
        if let Some(value) = value {
            *option = Argument { name, value, allowed: number }.float()?;
        }
    }
    let on_paper = background.map_or(Ok(false), |value| {
        let words = [("transparent", false), ("paper", true)];
        Argument { name: "background", value, allowed: "'transparent' or 'paper'" }.word(&words)
    })?;
    let watch = Watch::new(progress)?;
    let allowed = if on_paper { PAPER } else { IMAGE };
    let pixels = Pixels::read(&Argument { name: "image", value: image, allowed }, on_paper)?;
    let traced = watch.run(py, move |progress| core_trace(&pixels.picture()?, &options, progress))?;
    let parts = arrays::list(py, &traced.parts, |part: &Part| {
        let holes: Py<PyList> = arrays::list(py, &part.holes, |hole| arrays::plane_points(py, hole))?;
        let outline = arrays::plane_points(py, &part.outline)?;
        Ok(PyTuple::new(py, [outline.into_any(), holes.into_any()])?.unbind())
    })?;
    let class = py.import("gridmesh._traced")?.getattr("Traced")?;
    let counts = (parts, traced.dropped_islands, traced.dropped_holes, traced.threshold);
    Ok(class.call1(counts)?.unbind())
}

/// What was read of an array.
enum Pixels {
    Coverage { width: usize, height: usize, values: Vec<f32> },
    Colours { width: usize, height: usize, values: Vec<[f32; 3]> },
}

impl Pixels {
    fn read(it: &Argument<'_, '_>, on_paper: bool) -> PyResult<Self> {
        let array = as_array(it)?;
        let wrong = || it.wrong_shape(&format!("has shape {:?}", array.shape()));
        match array.shape() {
            [_, _] | [_, _, 4] => {}
            [_, _, 3] if on_paper => {}
            _ => return Err(wrong()),
        }
        let (height, width) = (array.shape()[0], array.shape()[1]);
        Picture::check_size(width, height).map_err(|err| error::from_core(it.value.py(), &err))?;
        let bits = array.dtype().itemsize();
        let read = match (array.dtype().kind(), bits) {
            (b'b', _) => {
                let array = array.extract::<PyReadonlyArrayDyn<'_, bool>>()?;
                Self::of(array.as_array(), on_paper, |value| f32::from(u8::from(value)))
            }
            (b'u', 1) => {
                let array = array.extract::<PyReadonlyArrayDyn<'_, u8>>()?;
                Self::of(array.as_array(), on_paper, |value| f32::from(value) / 255.0)
            }
            (b'u', 2) => {
                let array = array.extract::<PyArrayLikeDyn<'_, u16, AllowTypeChange>>()?;
                Self::of(array.as_array(), on_paper, |value| f32::from(value) / 65535.0)
            }
            (b'f', _) => {
                let array = array.extract::<PyArrayLikeDyn<'_, f32, AllowTypeChange>>()?;
                Self::of(array.as_array(), on_paper, |value| value)
            }
            _ => return Err(it.wrong_type()),
        };
        read.map_err(|_| wrong())
    }

    /// Row by row: pictures that were turned over come as views whose rows run backward in memory.
    fn of<T: Copy>(
        array: ArrayViewD<'_, T>,
        on_paper: bool,
        value: impl Fn(T) -> f32,
    ) -> std::result::Result<Self, ShapeError> {
        let array = if array.ndim() == 2 { array.insert_axis(Axis(2)) } else { array };
        let array = array.into_dimensionality::<Ix3>()?;
        let (height, width, channels) = array.dim();
        if !on_paper {
            let mut values = Vec::with_capacity(width * height);
            for row in array.outer_iter() {
                values.extend(row.column(channels - 1).iter().map(|&item| value(item)));
            }
            return Ok(Self::Coverage { width, height, values });
        }
        let mut values = Vec::with_capacity(width * height);
        for row in array.outer_iter() {
            values.extend(row.outer_iter().map(|pixel| match channels {
                1 => [value(pixel[0]); 3],
                3 => [0, 1, 2].map(|k| value(pixel[k])),
                // Over white paper.
                _ => [0, 1, 2].map(|k| value(pixel[k]) * value(pixel[3]) + 1.0 - value(pixel[3])),
            }));
        }
        Ok(Self::Colours { width, height, values })
    }

    fn picture(self) -> Result<Picture> {
        match self {
            Self::Coverage { width, height, values } => Picture::new(width, height, values),
            Self::Colours { width, height, values } => paper::coverage(width, height, &values),
        }
    }
}

/// `numpy.asarray` of the value; its type is looked at later.
fn as_array<'py>(it: &Argument<'_, 'py>) -> PyResult<Bound<'py, PyUntypedArray>> {
    static AS_ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = it.value.py();
    it.refuse_masked()?;
    let array = AS_ARRAY.import(py, "numpy", "asarray")?.call1((it.value,)).map_err(|err| {
        if err.is_instance_of::<pyo3::exceptions::PyValueError>(py) {
            it.wrong_shape(&format!("is not an array ({})", err.value(py)))
        } else {
            err
        }
    })?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}
