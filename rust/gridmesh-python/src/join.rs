//! `join` and the Python class `Joined`.

use glam::DVec3;
use gridmesh::cut::Polygons;
use gridmesh::join::{Border, JoinOptions, JoinReport, Joined as CoreJoined, Part};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyList};

use crate::cut::polygons;
use crate::input::Argument;
use crate::mesh::{as_positions, positions_argument, read_positions};
use crate::watch::Watch;
use crate::{arrays, reports};

/// Join closed meshes that overlap to one, blended where their surfaces meet.
///
/// Parameters
/// ----------
/// parts : sequence of pairs (vertices, faces), or of Surface or Joined
///     Closed meshes, in any units: positions (n, 3), and triangles (m, 3), quads (m, 4), or a pair (corners, offsets) for faces
///     with any number of corners, as in `cut`. Not modified. One given inside out is turned.
///     Pieces of one part that overlap each other are joined as parts of their own; cavities stay with the piece around them.
/// blend : float
///     So many edge lengths to each side of the lines where surfaces meet, along the surface, are taken away and closed
///     by one patch, smooth to both sides. 0 keeps the lines as creases, with even edges along them. 0 to 1000. Fewer
///     where that would meet something or take most of a part away; see "creased" and "exact" in the report.
/// edge_length : float, optional
///     The edge length that `blend` counts in. None: of each part its own mean near the line.
/// strict : bool
///     Refuse joints that meet themselves or the parts; otherwise the report counts that.
/// border : bool or sequence of int
///     Let the lines where surfaces of two parts meet run along edges of the collars, for borders of colours without teeth. `near_part` then
///     tells of new triangles, too, to which part they belong. Vertices next to a line are moved onto it, by half an edge at most; where there
///     are none it gets some of its own. True: between all parts; numbers, one for each part: between parts with different ones.
/// progress : callable, optional
///     Called with a fraction from 0 to 1; cancels by returning False. What it raises is raised here.
///
/// Returns
/// -------
/// Joined
///     One closed, manifold mesh of what is in any of the parts, with the topology of their exact union. Outside the collars
///     vertices and faces are the parts', bit for bit. Parts that meet no other stay pieces of their own. The same input
///     gives the same bytes, for any number of threads.
///
/// Raises
/// ------
/// GridMeshError
///     If a part is no mesh, or not closed, or a piece of it encloses nothing or is inside out, or cavities of it cross ("not_closed"), if parts
///     meet in a way that leaves no room for a patch ("join_failed", the message says where), if joints meet something and `strict` is set ("join_intersects"), or
///     when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// The exact union is that of Manifold, in its port to Rust. Other Python threads run meanwhile.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
/// >>> disk = np.c_[np.cos(t), np.sin(t)]
/// >>> body = gridmesh.inflate(gridmesh.mesh_sketch(disk, edge_length=0.1))
/// >>> head = gridmesh.inflate(gridmesh.mesh_sketch(0.6 * disk + [0, 1.2], edge_length=0.1))
/// >>> joined = gridmesh.join([body, head])
/// >>> joined.report["watertight"], joined.report["components"], joined.report["collars"]
/// (True, 1, 1)
#[pyfunction]
#[pyo3(
    signature = (parts, *, blend = None, edge_length = None, strict = None, border = None, progress = None),
    text_signature = "(parts, *, blend=2.0, edge_length=None, strict=False, border=False, progress=None)"
)]
pub fn join(
    py: Python<'_>,
    parts: &Bound<'_, PyAny>,
    blend: Option<&Bound<'_, PyAny>>,
    edge_length: Option<&Bound<'_, PyAny>>,
    strict: Option<&Bound<'_, PyAny>>,
    border: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Joined> {
    let mut options = JoinOptions::default();
    if let Some(value) = blend {
        options.blend = Argument { name: "blend", value, allowed: "a number from 0 to 1000" }.float()?;
    }
    if let Some(value) = edge_length {
        let it = Argument { name: "edge_length", value, allowed: "a number above 0, or None" };
        options.edge_length = it.optional(|it| it.float())?;
    }
    if let Some(value) = strict {
        options.strict = Argument { name: "strict", value, allowed: "True or False" }.bool()?;
    }
    if let Some(value) = border {
        options.border = border_of(value)?;
    }
    let all = Argument {
        name: "parts",
        value: parts,
        allowed: "a sequence of pairs (vertices, faces), or of bodies",
    };
    let each = parts.try_iter().map_err(|_| all.wrong_type())?.enumerate();
    let given = each.map(|(k, part)| read(k, &part?)).collect::<PyResult<Vec<_>>>()?;
    let parts = given
        .iter()
        .map(|(vertices, corners, offsets)| Part { vertices, faces: Polygons { corners, offsets } })
        .collect::<Vec<_>>();
    let done = Watch::new(progress)?.run(py, |progress| gridmesh::join::join(&parts, &options, progress))?;
    Joined::new(py, &done)
}

/// Yes, no, or a number for each part.
fn border_of(value: &Bound<'_, PyAny>) -> PyResult<Border> {
    let it = Argument {
        name: "border",
        value,
        allowed: "True, False, or a whole number from 0 to 4294967295 for each part",
    };
    if let Ok(yes) = it.bool() {
        return Ok(if yes { Border::Parts } else { Border::None });
    }
    let is_whole = |item: PyResult<Bound<'_, PyAny>>| item.is_ok_and(|item| item.is_instance_of::<PyInt>());
    value.extract::<Vec<u32>>().map(Border::Colors).map_err(|_| {
        let is_whole = value.try_iter().is_ok_and(|mut items| items.all(is_whole));
        if is_whole { it.wrong_value() } else { it.wrong_type() }
    })
}

/// Positions, corners and offsets of a part.
fn read(k: usize, part: &Bound<'_, PyAny>) -> PyResult<(Vec<DVec3>, Vec<u32>, Vec<u32>)> {
    if let (Ok(vertices), Ok(triangles), Ok(quads)) =
        (part.getattr("vertices"), part.getattr("triangles"), part.getattr("quads"))
    {
        let held = read_positions(&positions_argument(&vertices))?;
        let (mut corners, mut offsets) = polygons(&triangles)?;
        if let (Ok(all), Ok(starts)) = (part.getattr("corners"), part.getattr("offsets")) {
            (corners, offsets) = polygons((all, starts).into_pyobject(part.py())?.as_any())?;
        } else {
            let (more, starts) = polygons(&quads)?;
            let first = corners.len() as u32;
            offsets.extend(starts.iter().skip(1).map(|o| o + first));
            corners.extend(more);
        }
        return Ok((as_positions(&held)?.into_owned(), corners, offsets));
    }
    let allowed = "a pair (vertices, faces), or a body";
    let wrong = || Argument { name: &format!("part {k}"), value: part, allowed }.wrong_type();
    let (vertices, faces): (Bound<'_, PyAny>, Bound<'_, PyAny>) = part.extract().map_err(|_| wrong())?;
    let held = read_positions(&positions_argument(&vertices))?;
    let (corners, offsets) = polygons(&faces)?;
    Ok((as_positions(&held)?.into_owned(), corners, offsets))
}

/// A joined mesh; made by `join`.
///
/// All arrays are read-only and C-contiguous; copy them to change them. Faces are numbered through: first the triangles, then the
/// quads, then those with more corners.
///
/// Attributes
/// ----------
/// vertices : (v, 3) float64
///     Those of the parts that are still in use, in their order, then the new ones.
/// triangles : (t, 3) int32
///     Triangles of the parts, then the new ones of the collars.
/// quads : (q, 4) int32
///     Quads of the parts.
/// corners, offsets : (c,) int32, (f + 1,) int32
///     All faces: the corners of face f are ``corners[offsets[f]:offsets[f + 1]]``.
/// source_part : (f,) int32
///     The part that each face comes from; -1 for those of collars.
/// source_face : (f,) int32
///     Its number in that part; -1 for those of collars.
/// near_part : (f,) int32
///     The part that each face belongs to; with `border` for those of collars that on whose side of the line between parts they
///     lie, else -1 for these.
/// vertex_part : (v,) int32
///     The part that each vertex comes from; -1 for new ones.
/// source_vertex : (v,) int32
///     Its number in that part; -1 for new ones.
/// collars : list of lists of (k,) int32
///     For each patch its rims: closed loops of old vertices, as the old faces along them run.
/// report : dict
///     Plain numbers: "watertight", "components", "genus", "alone" (parts that meet no other), "swallowed" (parts within
///     others, and pieces that overlap others of the same part), "overlapping" (pieces that overlap others of the same part), "turned" (parts given inside out), "separated" (vertices added where
///     faces of a part meet in a vertex or along an edge alone: each side has its own), "curves" (closed lines in which surfaces meet), "collars" (patches), "tubes" and
///     "fills" (of those, lattices between two rims and in one), "creased" (of those, with the line as a crease, where any blend
///     would meet something or take most of a part away), "exact" (of those, triangles of the exact union as they are, where that did
///     not help either), "collar_triangles", "collar_vertices" and "collar_irregular" (new
///     ones, and those with a valence other than six), "irregular" (of all vertices; corners of quads count one and a half
///     triangles), "min_angle" (of new triangles, radians), "self_intersections" (pairs of triangles, at least one of them new and not of the exact union),
///     "volume", "exact_volume" (of the exact union), and "seconds", a dict of times per stage.
#[pyclass(frozen, module = "gridmesh")]
pub struct Joined {
    #[pyo3(get)]
    vertices: Py<PyArray2<f64>>,
    #[pyo3(get)]
    triangles: Py<PyArray2<i32>>,
    #[pyo3(get)]
    quads: Py<PyArray2<i32>>,
    #[pyo3(get)]
    corners: Py<PyArray1<i32>>,
    #[pyo3(get)]
    offsets: Py<PyArray1<i32>>,
    #[pyo3(get)]
    source_part: Py<PyArray1<i32>>,
    #[pyo3(get)]
    source_face: Py<PyArray1<i32>>,
    #[pyo3(get)]
    near_part: Py<PyArray1<i32>>,
    #[pyo3(get)]
    vertex_part: Py<PyArray1<i32>>,
    #[pyo3(get)]
    source_vertex: Py<PyArray1<i32>>,
    #[pyo3(get)]
    collars: Py<PyList>,
    #[pyo3(get)]
    report: Py<PyDict>,
}

impl Joined {
    fn new(py: Python<'_>, inner: &CoreJoined) -> PyResult<Self> {
        let sides = |f: &usize| inner.offsets[f + 1] - inner.offsets[*f];
        let all = 0..inner.source_part.len();
        let triangles = all.clone().take_while(|f| sides(f) == 3);
        let triangles = triangles.map(|f| [0, 1, 2].map(|k| inner.face(f)[k])).collect::<Vec<_>>();
        let quads = all.skip(triangles.len()).take_while(|f| sides(f) == 4);
        let quads = quads.map(|f| [0, 1, 2, 3].map(|k| inner.face(f)[k])).collect::<Vec<_>>();
        let collars = PyList::empty(py);
        for rims in &inner.collars {
            collars.append(arrays::list(py, rims, |rim| Ok(arrays::indices(py, rim.iter().copied())))?)?;
        }
        Ok(Self {
            vertices: arrays::space_points(py, &inner.vertices)?,
            triangles: arrays::triangles(py, &triangles)?,
            quads: arrays::quads(py, &quads)?,
            corners: arrays::indices(py, inner.corners.iter().copied()),
            offsets: arrays::indices(py, inner.offsets.iter().copied()),
            source_part: arrays::row(py, inner.source_part.clone()),
            source_face: arrays::row(py, inner.source_face.clone()),
            near_part: arrays::row(py, inner.near_part.clone()),
            vertex_part: arrays::row(py, inner.vertex_part.clone()),
            source_vertex: arrays::row(py, inner.source_vertex.clone()),
            collars: collars.unbind(),
            report: report(py, &inner.report)?,
        })
    }
}

#[pymethods]
impl Joined {
    fn __repr__(&self, py: Python<'_>) -> String {
        let (vertices, collars) = (self.vertices.bind(py).shape()[0], self.collars.bind(py).len());
        format!("<gridmesh.Joined: {vertices} vertices, {collars} collars>")
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
        let this = slf.get();
        let faces = (
            this.triangles.clone_ref(py),
            this.quads.clone_ref(py),
            this.corners.clone_ref(py),
            this.offsets.clone_ref(py),
        );
        let sources = (
            this.source_part.clone_ref(py),
            this.source_face.clone_ref(py),
            this.near_part.clone_ref(py),
            this.vertex_part.clone_ref(py),
            this.source_vertex.clone_ref(py),
        );
        let fields = (
            this.vertices.clone_ref(py),
            faces,
            sources,
            this.collars.clone_ref(py),
            this.report.clone_ref(py),
        );
        Ok((py.import("gridmesh._native")?.getattr("_joined")?, fields.into_pyobject(py)?.into_any()))
    }
}

/// One of the arrays of numbers that `Joined.__reduce__` returned.
type Row<'py> = PyReadonlyArray1<'py, i32>;

/// Makes a joined mesh from what `Joined.__reduce__` returned.
#[pyfunction]
pub fn _joined(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    faces: (PyReadonlyArray2<'_, i32>, PyReadonlyArray2<'_, i32>, Row<'_>, Row<'_>),
    sources: (Row<'_>, Row<'_>, Row<'_>, Row<'_>, Row<'_>),
    collars: Vec<Vec<Row<'_>>>,
    report: Py<PyDict>,
) -> PyResult<Joined> {
    let broken = || crate::error::error(py, "invalid_shape", "the pickled mesh is damaged".to_owned());
    let rows = |array: &PyReadonlyArray2<'_, f64>| -> PyResult<Vec<DVec3>> {
        let of = |row: &[f64]| <[f64; 3]>::try_from(row).ok().map(DVec3::from_array);
        array.as_array().rows().into_iter().map(|r| r.as_slice().and_then(of).ok_or_else(broken)).collect()
    };
    let row = |array: &Row<'_>| arrays::row(py, array.as_array().to_vec());
    fn wide<const N: usize>(array: &PyReadonlyArray2<'_, i32>) -> Option<Vec<[u32; N]>> {
        let of = |row: &[i32]| <[i32; N]>::try_from(row).ok().map(|row| row.map(|v| v as u32));
        array.as_array().rows().into_iter().map(|r| r.as_slice().and_then(of)).collect()
    }
    let loops = PyList::empty(py);
    for rims in &collars {
        loops.append(arrays::list(py, rims, |rim| Ok(row(rim)))?)?;
    }
    Ok(Joined {
        vertices: arrays::space_points(py, &rows(&vertices)?)?,
        triangles: arrays::triangles(py, &wide(&faces.0).ok_or_else(broken)?)?,
        quads: arrays::quads(py, &wide(&faces.1).ok_or_else(broken)?)?,
        corners: row(&faces.2),
        offsets: row(&faces.3),
        source_part: row(&sources.0),
        source_face: row(&sources.1),
        near_part: row(&sources.2),
        vertex_part: row(&sources.3),
        source_vertex: row(&sources.4),
        collars: loops.unbind(),
        report,
    })
}

fn report(py: Python<'_>, report: &JoinReport) -> PyResult<Py<PyDict>> {
    let dict = PyDict::new(py);
    // Proved of every result.
    dict.set_item("watertight", true)?;
    dict.set_item("components", report.components)?;
    dict.set_item("genus", report.genus)?;
    dict.set_item("alone", report.alone)?;
    dict.set_item("swallowed", report.swallowed)?;
    dict.set_item("overlapping", report.overlapping)?;
    dict.set_item("turned", report.turned)?;
    dict.set_item("separated", report.separated)?;
    dict.set_item("curves", report.curves)?;
    dict.set_item("collars", report.collars)?;
    dict.set_item("tubes", report.tubes)?;
    dict.set_item("fills", report.fills)?;
    dict.set_item("creased", report.creased)?;
    dict.set_item("exact", report.exact)?;
    dict.set_item("collar_triangles", report.collar_triangles)?;
    dict.set_item("collar_vertices", report.collar_vertices)?;
    dict.set_item("collar_irregular", report.collar_irregular)?;
    dict.set_item("irregular", report.irregular)?;
    dict.set_item("min_angle", report.min_angle)?;
    dict.set_item("self_intersections", report.self_intersections)?;
    dict.set_item("volume", report.volume)?;
    dict.set_item("exact_volume", report.exact_volume)?;
    dict.set_item("seconds", reports::seconds(py, &report.seconds)?)?;
    Ok(dict.unbind())
}
