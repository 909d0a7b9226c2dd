//! `cut` and the Python class `Cut`.

use glam::DVec3;
use gridmesh::cut::{Cut as CoreCut, CutOptions, CutReport, Keep, Mirror, Polygons, Sweep};
use gridmesh::fill::Smooth;
use numpy::{PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::fill::shape;
use crate::input::Argument;
use crate::mesh::{as_positions, indices, narrowed, positions_argument, read_positions};
use crate::piece::Piece;
use crate::watch::Watch;
use crate::{arrays, reports};

/// Divide a mesh along the surface that a stroke sweeps, and cap the pieces with grid patches.
///
/// Parameters
/// ----------
/// vertices : (n, 3) array of real numbers
///     Positions of the mesh, in any units. Not modified.
/// faces : (m, 3) or (m, 4) array of int, or a pair (corners, offsets)
///     Triangles, quads, or faces with any number of corners: those of face f are
///     ``corners[offsets[f]:offsets[f + 1]]``.
/// stroke : (s, 3) array of real numbers, s >= 2
///     Points of the stroke. It is closed if its last point repeats its first one; the ends of an open one are
///     continued straight on. Duplicate points are welcome; a stroke that crosses itself is refused.
/// direction : (3,) array of real numbers
///     The stroke is swept along this direction, which points away from the viewer. Either this or `eye`.
/// eye : (3,) array of real numbers
///     The stroke is swept through this point, as a perspective view shows it. The mesh must lie in front.
/// keep : {"left", "right", "both"}
///     Left or right of the stroke's direction, seen along `direction`; a closed stroke's left is its
///     inside, whatever its orientation.
/// cap : bool
///     False leaves the pieces open.
/// edge_length : float, optional
///     Length of the edges along the cut, which are made even, and the faces along it rebuilt: what good
///     caps need. Of the stroke, what is within a hundredth of it counts as straight. None: the cut's edges are as the mesh's edges divide it.
/// gap : float
///     Width of what is taken away between the pieces, half of it on either side of the stroke.
/// smooth : {"flat", "tangent", "curvature"}
///     "flat": caps lie on the swept surface. The others bulge with the model, as fills do; caps with holes
///     lie flat all the same. A cap that would leave the model through its far side, or meet another cap, bulges
///     less ("reduced_caps" in the report).
/// cells : {"triangles", "quads"}
///     What caps are made of. A cap of quads has one triangle if its line, with those of its holes, has an odd number of
///     edges.
/// extend_ends : bool
///     True continues the ends of an open stroke to infinity. False continues them only as far as the part of the mesh
///     that the stroke itself crosses: cut lines that it does not meet stay whole. Parts of the mesh that it does not
///     cross belong to the side of the line, continued, on which they lie; those on both, and all if the line would
///     cross what is cut elsewhere, too, to the larger piece, or to the only one that is kept.
/// mirrors : sequence of k pairs of a point and a normal, (k, 2, 3)
///     Planes at which the mesh is open because its mirror image continues it there: cut lines with both ends on one of
///     them are closed along it and capped.
/// mirror_distance : float
///     Vertices no farther from such a plane lie on it.
/// progress : callable, optional
///     Called with a fraction from 0 to 1; cancels by returning False. What it raises is raised here.
///
/// Returns
/// -------
/// Cut
///     The pieces asked for. Where the mesh is a closed manifold, so are they (with `cap`). Old vertices keep their
///     bits, faces that the cut does not meet come back as they were, and the caps of two pieces are mirror
///     images, vertex for vertex (without `gap`). Cut lines that end at the border of an open mesh get no cap. The same
///     input gives the same bytes, for any number of threads.
///
/// Raises
/// ------
/// GridMeshError
///     If the mesh, the stroke or an option is not fit (see `GridMeshError.kind`), if the stroke misses the mesh
///     ("stroke_misses"), if it ends along the stroke already ("slice_too_thin"), or when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// Nealen, Pett, Alexa, Igarashi: GridMesh, section V. Other Python threads run meanwhile.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
/// >>> quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
/// >>> stroke = [[-1, 0.5, 0.3], [2, 0.5, 0.6]]
/// >>> done = gridmesh.cut(cube, quads, stroke, direction=[0, 1, 0], edge_length=0.2)
/// >>> [piece.side for piece in done.pieces], len(done.pieces[0].cap_loops)
/// (['left', 'right'], 1)
/// >>> round(sum(done.report["volumes"]), 9)
/// 1.0
#[pyfunction]
#[pyo3(
    signature = (vertices, faces, stroke, *, direction = None, eye = None, keep = None, cap = None, edge_length = None, gap = None, smooth = None, cells = None, extend_ends = None, mirrors = None, mirror_distance = None, progress = None),
    text_signature = "(vertices, faces, stroke, *, direction=None, eye=None, keep='both', cap=True, edge_length=None, gap=0.0, smooth='flat', cells='triangles', extend_ends=True, mirrors=(), mirror_distance=0.0, progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "the keyword-only options of the Python function")]
pub fn cut(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    stroke: &Bound<'_, PyAny>,
    direction: Option<&Bound<'_, PyAny>>,
    eye: Option<&Bound<'_, PyAny>>,
    keep: Option<&Bound<'_, PyAny>>,
    cap: Option<&Bound<'_, PyAny>>,
    edge_length: Option<&Bound<'_, PyAny>>,
    gap: Option<&Bound<'_, PyAny>>,
    smooth: Option<&Bound<'_, PyAny>>,
    cells: Option<&Bound<'_, PyAny>>,
    extend_ends: Option<&Bound<'_, PyAny>>,
    mirrors: Option<&Bound<'_, PyAny>>,
    mirror_distance: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Cut> {
    let held = read_positions(&positions_argument(vertices))?;
    let (corners, offsets) = polygons(faces)?;
    let line = Argument { name: "stroke", value: stroke, allowed: "an (s, 3) array of real numbers" };
    let line = read_positions(&line)?;
    let mut options = CutOptions::new(sweep(py, direction, eye)?);
    if let Some(value) = keep {
        let words = [("left", Keep::Left), ("right", Keep::Right), ("both", Keep::Both)];
        options.keep = Argument { name: "keep", value, allowed: "'left', 'right' or 'both'" }.word(&words)?;
    }
    if let Some(value) = cap {
        options.cap = Argument { name: "cap", value, allowed: "True or False" }.bool()?;
    }
    if let Some(value) = edge_length {
        let it = Argument { name: "edge_length", value, allowed: "a number above 0, or None" };
        options.edge_length = it.optional(|it| it.float())?;
    }
    if let Some(value) = gap {
        options.gap = Argument { name: "gap", value, allowed: "a number, 0 or more" }.float()?;
    }
    if let Some(value) = smooth {
        let words = [("flat", Smooth::Flat), ("tangent", Smooth::Tangent), ("curvature", Smooth::Curvature)];
        let it = Argument { name: "smooth", value, allowed: "'flat', 'tangent' or 'curvature'" };
        options.smooth = it.word(&words)?;
    }
    options.cells = shape(cells)?;
    if let Some(value) = extend_ends {
        options.extend_ends = Argument { name: "extend_ends", value, allowed: "True or False" }.bool()?;
    }
    let within = match mirror_distance {
        Some(value) => Argument { name: "mirror_distance", value, allowed: "a number, 0 or more" }.float()?,
        None => 0.0,
    };
    if let Some(value) = mirrors {
        let it = Argument { name: "mirrors", value, allowed: "pairs of a point and a normal, (k, 2, 3)" };
        let planes: Vec<[[f64; 3]; 2]> = value.extract().map_err(|_| it.wrong_type())?;
        let plane = |[point, normal]: [[f64; 3]; 2]| {
            let normal = DVec3::from_array(normal);
            let scaled = normal / normal.abs().max_element();
            // Of a length whose square is none, too; what has no direction stays as it is, and is refused.
            let normal = normal.try_normalize().or(scaled.try_normalize()).unwrap_or(normal);
            Mirror { point: DVec3::from_array(point), normal, within }
        };
        options.mirrors = planes.into_iter().map(plane).collect();
    }
    let (positions, points) = (as_positions(&held)?, as_positions(&line)?);
    let faces = Polygons { corners: &corners, offsets: &offsets };
    let done = Watch::new(progress)?
        .run(py, |progress| gridmesh::cut::cut(&positions, faces, &points, &options, progress))?;
    Cut::new(py, done)
}

/// How far the ends of an open stroke are continued by `cut` with ``extend_ends=False``.
///
/// Parameters
/// ----------
/// vertices, faces, stroke, direction, eye, progress
///     As of `cut`.
///
/// Returns
/// -------
/// (2, 3) float64
///     The points up to which the first and the last end are continued, as far from the viewer as the ends. Takes
///     as long as to find the faces that are cut.
///
/// Raises
/// ------
/// GridMeshError
///     If the mesh or the stroke is not fit, or if the stroke itself crosses nothing ("stroke_misses").
/// TypeError
///     If an argument has a type that is not allowed.
#[pyfunction]
#[pyo3(
    signature = (vertices, faces, stroke, *, direction = None, eye = None, progress = None),
    text_signature = "(vertices, faces, stroke, *, direction=None, eye=None, progress=None)"
)]
pub fn cut_reach(
    py: Python<'_>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    stroke: &Bound<'_, PyAny>,
    direction: Option<&Bound<'_, PyAny>>,
    eye: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Py<PyArray2<f64>>> {
    let held = read_positions(&positions_argument(vertices))?;
    let (corners, offsets) = polygons(faces)?;
    let line = Argument { name: "stroke", value: stroke, allowed: "an (s, 3) array of real numbers" };
    let line = read_positions(&line)?;
    let sweep = sweep(py, direction, eye)?;
    let (positions, points) = (as_positions(&held)?, as_positions(&line)?);
    let faces = Polygons { corners: &corners, offsets: &offsets };
    let ends = Watch::new(progress)?
        .run(py, |progress| gridmesh::cut::cut_reach(&positions, faces, &points, sweep, progress))?;
    arrays::space_points(py, &ends)
}

/// `direction` or `eye`.
fn sweep(
    py: Python<'_>,
    direction: Option<&Bound<'_, PyAny>>,
    eye: Option<&Bound<'_, PyAny>>,
) -> PyResult<Sweep> {
    let vector = |name, value| -> PyResult<DVec3> {
        let it = Argument { name, value, allowed: "three real numbers" };
        match it.numbers()?[..] {
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            ref other => Err(it.wrong_shape(&format!("has {} numbers", other.len()))),
        }
    };
    let given = |value: Option<&Bound<'_, PyAny>>| value.is_some_and(|v| !v.is_none());
    match (direction, eye) {
        (Some(value), other) if given(direction) && !given(other) => {
            Ok(Sweep::Along(vector("direction", value)?))
        }
        (other, Some(value)) if given(eye) && !given(other) => Ok(Sweep::Through(vector("eye", value)?)),
        _ => {
            let found = if given(direction) { "both are given" } else { "neither is given" };
            Err(crate::error::error(
                py,
                "invalid_option",
                format!("direction and eye: {found}; allowed: one of them, it says how the stroke is swept"),
            ))
        }
    }
}

/// Corners and offsets of faces.
pub fn polygons(faces: &Bound<'_, PyAny>) -> PyResult<(Vec<u32>, Vec<u32>)> {
    let allowed = "an (m, 3) or (m, 4) array of whole numbers, or the pair (corners, offsets)";
    let it = Argument { name: "faces", value: faces, allowed };
    let pair = faces.cast::<PyTuple>().is_ok_and(|t| t.len() == 2);
    if pair {
        let [corners, offsets] = [faces.get_item(0)?, faces.get_item(1)?];
        let corners = indices(&Argument { name: "corners", value: &corners, allowed })?;
        let offsets = indices(&Argument { name: "offsets", value: &offsets, allowed })?;
        return Ok((corners, offsets));
    }
    let array = it.array()?;
    if array.len() == 0 {
        return Ok((vec![], vec![0]));
    }
    if array.ndim() != 2 || !(array.shape()[1] == 3 || array.shape()[1] == 4) {
        return Err(it.wrong_shape(&format!("has shape {:?}", array.shape())));
    }
    let (rows, columns) = (array.shape()[0], array.shape()[1]);
    let offsets = (0..=rows).map(|f| (f * columns) as u32).collect();
    let corners = match array.extract::<PyReadonlyArray2<'_, i32>>() {
        Ok(held) if held.is_c_contiguous() => held.as_slice()?.iter().map(|&v| v as u32).collect(),
        _ => narrowed(&it, &array)?,
    };
    Ok((corners, offsets))
}

/// A divided mesh; made by `cut`.
///
/// Attributes
/// ----------
/// pieces : list of Piece
///     Those asked for, the left one first.
/// report : dict
///     Plain numbers: "cut_faces" (faces divided), "loops" (closed cut lines), "open_lines" (cut lines that end at
///     the border of an open mesh), "uncapped" (closed ones that bound no part of the swept surface),
///     "caps" (of one piece), "rings" (caps with holes), "pinched" (vertices doubled because a piece would touch itself there),
///     "cap_triangles", "cap_quads", "cap_vertices" (new ones inside caps), "cap_irregular" (those with a valence other
///     than 6, with quads 4), "cap_min_angle" (radians), "cap_radius_ratio" (mean of twice the inscribed by the
///     circumscribed radius over the triangles), "folded" (caps
///     whose line crosses itself on the swept surface), "rim_min_angle" (smallest angle of a face along the cut, radians), "defect" (largest distance
///     of rebuilt faces from the old surface), "volumes" (of the pieces), "volume" (of the input), "repeated"
///     (divisions and caps that had to be made in another way), "reduced_caps" (caps that bulge less than they should
///     because they would leave the model), "flat_caps" (caps that lie flat whatever `smooth` is), and "seconds", a dict of times per stage.
#[pyclass(frozen, module = "gridmesh")]
pub struct Cut {
    #[pyo3(get)]
    pieces: Py<PyList>,
    #[pyo3(get)]
    report: Py<PyDict>,
}

impl Cut {
    fn new(py: Python<'_>, inner: CoreCut) -> PyResult<Self> {
        let report = report(py, &inner.report)?;
        let pieces = PyList::empty(py);
        for piece in inner.pieces {
            pieces.append(Piece::new(py, piece)?)?;
        }
        Ok(Self { pieces: pieces.unbind(), report })
    }
}

#[pymethods]
impl Cut {
    fn __repr__(&self, py: Python<'_>) -> String {
        format!("<gridmesh.Cut: {} pieces>", self.pieces.bind(py).len())
    }

    // It cannot change: a copy is the thing itself.
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let py = slf.py();
        let fields = (slf.get().pieces.clone_ref(py), slf.get().report.clone_ref(py));
        Ok((py.import("gridmesh._native")?.getattr("_cut")?, fields.into_pyobject(py)?.into_any()))
    }
}

/// Makes a divided mesh from what `Cut.__reduce__` returned.
#[pyfunction]
pub fn _cut(pieces: Py<PyList>, report: Py<PyDict>) -> Cut {
    Cut { pieces, report }
}

fn report(py: Python<'_>, report: &CutReport) -> PyResult<Py<PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("cut_faces", report.cut_faces)?;
    dict.set_item("loops", report.loops)?;
    dict.set_item("open_lines", report.open_lines)?;
    dict.set_item("uncapped", report.uncapped)?;
    dict.set_item("caps", report.caps)?;
    dict.set_item("rings", report.rings)?;
    dict.set_item("pinched", report.pinched)?;
    dict.set_item("cap_triangles", report.cap_triangles)?;
    dict.set_item("cap_quads", report.cap_quads)?;
    dict.set_item("cap_vertices", report.cap_vertices)?;
    dict.set_item("cap_irregular", report.cap_irregular)?;
    dict.set_item("cap_min_angle", report.cap_min_angle)?;
    dict.set_item("cap_radius_ratio", report.cap_radius_ratio)?;
    dict.set_item("reduced_caps", report.reduced_caps)?;
    dict.set_item("flat_caps", report.flat_caps)?;
    dict.set_item("folded", report.folded)?;
    dict.set_item("rim_min_angle", report.rim_min_angle)?;
    dict.set_item("defect", report.defect)?;
    dict.set_item("volumes", report.volumes.clone())?;
    dict.set_item("volume", report.volume)?;
    dict.set_item("repeated", report.repeated)?;
    dict.set_item("seconds", reports::seconds(py, &report.seconds)?)?;
    Ok(dict.unbind())
}
