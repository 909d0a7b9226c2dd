//! Drawings to patches.

use glam::DVec2;
use gridmesh::cover::Rim;
use gridmesh::options::SketchOptions;
use gridmesh::sketch::Kept;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::batch::Drawing;
use crate::input::Argument;
use crate::options::Shape;
use crate::patch::Patch;
use crate::watch::Watch;
use crate::{options, reports};

/// Mesh the inside of a closed planar drawing with a semi-regular mesh of triangles or quads.
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
/// triangles : int or "auto", optional
///     Number of triangles of the flat patch, from 6 to 20 million; 2000 if neither is given. Reached within
///     10 %, below 60 within 6 triangles (a handful comes in few sizes): `report["triangles"]` says how many.
///     "auto": five across the thinnest limb (see `thickness`), but at least 1000 and at most `max_triangles`;
///     where those cannot follow the outline, the least number that can.
/// cells : {"triangles", "quads"}, optional
///     What the mesh is made of; None: triangles, unless `quads` is given. Quads keep a row along the whole
///     boundary, whose vertices have two; interior vertices have four, but for one pole of three or
///     five for each turn of the lattice. A vertex on a sharp convex corner of the outline has one quad, in the plane; bodies
///     have a patch of their own, with two (`Patch.belt`). Not with boundary="grown".
/// quads : int or "auto", optional
///     Number of quads of the flat patch, but for one more at each of its sharp corners, in place of `triangles`; 1000 if none is given with cells="quads".
/// max_triangles : int
///     The largest number, of either, that "auto" chooses.
/// boundary : {"optimal", "grown"}
///     "optimal": the boundary of least cost for this lattice and `max_distance`, where cost = turns +
///     `closeness` x squared distance in edge lengths. "grown": the growth of the paper's sections
///     IV-B to IV-D.
/// max_distance : float
///     Largest distance of the lattice boundary from the outline before it is moved onto it, in edge
///     lengths; 0.5 to 4; with quads first a third farther, from the outline drawn in by a row.
/// closeness : float
///     Price of a squared distance of one edge length against a turn of 60 degrees (a tenth of it against a
///     turn of 90 degrees, with quads); at least 0.
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
///     Bounds the search that proves optimality where the first solution had conflicts: so many parts of the search
///     space at most, and for each lattice angle tried 6 million states of it, under a second; 0 beside `mirror`.
/// bend : float, optional
///     How far the lattice may bend with the outline, from 0 (straight) to 1; None: 1. A conformal map takes the
///     outline to where it runs along lattice directions, which leaves far fewer irregular vertices and lets the
///     size of the triangles vary a little. Several bends are tried, and straight lattices where they do not serve. Thin parts
///     are about as fine as on a straight lattice; tips sharper than 35 degrees may be blunted, by two edge lengths at most.
///     Without effect beside `angle` or `origin` and with boundary="grown".
/// density : "width", float, (n,) array of positive numbers, or a sequence of such arrays, optional
///     Where there should be more triangles. "width": in narrow parts; one number from 0 to 1: so much of that ("width" is 1;
///     at 0 they are about as fine as on a straight lattice, so that the ends of limbs look round, for some more irregular
///     vertices: None leaves a fifth less of them at 2000 triangles, and some limbs coarse). An array: at each point of the
///     outline so many times the triangles of elsewhere, as a sequence for the outline and its holes. It is a wish:
///     the map stays conformal, so that neighbouring triangles differ little in size. But for 0 only with `bend` above 0.
///     Arrays not together with self_crossing="union".
/// keep : Patch, optional
///     A patch whose lattice stays where it is, with its bend, for outlines that change step by step: then nothing is searched but the
///     boundary, in a part of the time, and vertices stay where they can. Exclusive with `edge_length`, `triangles`, `quads`,
///     `angle`, `origin` and `mirror`. A patch that was pickled has lost its bend: its lattice is straight.
/// relax : bool
///     False leaves the interior vertices where the lattice has them; triangles may then be inverted,
///     and such a patch is refused (kind "inverted").
/// open_corners : bool
///     True: sharp convex corners of quads get a single quad. False: two, as in `Patch.belt`, in a little less time; for patches
///     of which only bodies are made. Without effect on triangles.
/// least : bool
///     True: the refusal of a drawing too thin for its mesh (kind "too_coarse") names the least number of triangles
///     that works, in steps of a tenth, up to 40 times the number asked for or that the length of the outline alone asks for, or 20,000;
///     the search may take some seconds. False: it is refused at once.
/// progress : callable, optional
///     Called with a fraction from 0 to 1; cancels by returning False. What it raises is raised here.
///
/// Returns
/// -------
/// Patch
///     Every boundary vertex lies on its contour, no interior edge joins two boundary vertices, every
///     interior vertex has six triangles, no triangle is inverted (also in float32), and the topology
///     is that of the outline minus its holes. The same input gives the same bytes, for any number of
///     threads. Of quads none is concave or folded (also in float32), and interior edges may join two vertices of a
///     row beside the boundary, but not of the boundary. `report` has "triangles", "quads", "poles" (vertices of
///     three or five quads of its bodies) and "minimum_poles" (the least that any such body has), both 0 for triangles, "irregular" (irregular vertices after stitching),
///     "minimum_irregular" (the least that any such body has), "turns", "turns_before" (a grown
///     boundary's, before it is straightened), "turns_bound", "cost", "cost_bound" (None where none
///     was computed), "optimal" (all three about the lattice that was taken, bent or straight), "bend" (how far it is bent, 0 if it is straight), "scale_range" (largest over smallest edge length of the bent lattice), "max_distance_used", "max_deviation" (of the boundary's edges from the outline, in edge lengths), "min_angle"
///     (radians), "corners" (drawn ones), "released_corners" (those without a vertex of their own), "bridged_inlets" (with mesh vertices in them: 0, unless `relax` is off),
///     "across" (triangles across the thinnest limb; None unless `triangles` is "auto", and where no part is
///     longer than it is wide),
///     "repaired" (repeated points dropped), "mirror_error" (greatest distance of a vertex from the
///     image of its partner, in edge lengths; None without `mirror`), "placements" (of the lattice, tried),
///     "search_states" (of the searches for boundaries, on all lattices: many where walls are in each other's way, which is what
///     takes longest) and "seconds" (per stage).
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
    signature = (outline, holes = None, *, keep = None, progress = None, **options),
    text_signature = "(outline, holes=(), *, edge_length=None, triangles=None, cells=None, quads=None, max_triangles=20000, boundary='optimal', max_distance=1.5, closeness=0.3, angle=None, origin=None, corner_angle=0.6981317007977318, mirror=None, self_crossing='error', proof_nodes=0, bend=None, density=None, keep=None, relax=True, open_corners=True, least=True, progress=None)"
)]
pub fn mesh_sketch(
    py: Python<'_>,
    outline: &Bound<'_, PyAny>,
    holes: Option<&Bound<'_, PyAny>>,
    keep: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Patch> {
    let drawing = drawing(outline, holes)?;
    let chosen = chosen(py, "mesh_sketch", options)?;
    let kept = keep.filter(|keep| !keep.is_none()).map(kept).transpose()?;
    let sketch = Watch::new(progress)?.run(py, |progress| {
        let (outline, holes) = (&drawing.outline, &drawing.holes);
        match &kept {
            Some(kept) => gridmesh::sketch::mesh_sketch_on(kept, outline, holes, &chosen, progress),
            None => gridmesh::sketch::mesh_sketch(outline, holes, &chosen, progress),
        }
    })?;
    let report = reports::sketch(py, &sketch.report)?;
    Ok(Patch::new(sketch.patch, report, sketch.kept))
}

/// Mesh the inside of a drawing so that the mesh covers it: for pictures on meshes, whose opaque pixels must not be cut off.
///
/// Where boundary edges would cut off what is drawn the outline is moved outward, by a quarter of an edge length at
/// most, and single vertices are moved to tips.
///
/// Parameters
/// ----------
/// outline, holes, progress
///     As of `mesh_sketch`.
/// slack : float
///     So much of the drawing's rim may stay outside, in the units of the outline; at least 0.
/// across : bool
///     Instead of around the drawing the boundary lies across its contours: single vertices are moved until the area between
///     is least, about as much of it outside as inside. `slack` is not used then.
/// beyond : float, optional
///     Where the drawing would still reach farther beyond the mesh and the slack, as with a tip between two vertices, boundary edges of triangles are
///     split there: a few more triangles, and inner vertices of valence seven. Not used with `across`, and for quads.
/// **options
///     All others of `mesh_sketch` but `keep`.
///
/// Returns
/// -------
/// Patch
///     As of `mesh_sketch`, but its boundary vertices lie near the contours, not on them: `source` tells the nearest
///     points of the given contours, `arc` lengths along those moved outward. `report` has "outside" besides: how far the
///     drawing still reaches beyond the mesh and the slack, in the units of the outline; and "between": the area between the
///     boundary and the contours, as a share of the drawing's.
///
/// Raises
/// ------
/// GridMeshError
///     As of `mesh_sketch`, and if the slack is negative or not finite, or `beyond` negative.
///
/// Notes
/// -----
/// Takes the time of up to five meshes, four of them on a known lattice. Other Python threads run meanwhile.
///
/// Examples
/// --------
/// >>> import numpy as np, gridmesh
/// >>> t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
/// >>> patch = gridmesh.cover_sketch(np.c_[np.cos(t), np.sin(t)], triangles=100)
/// >>> patch.report["outside"] < 0.01 * patch.edge_length
/// True
#[expect(clippy::too_many_arguments, reason = "the keyword-only options of the Python function")]
#[pyfunction]
#[pyo3(
    signature = (outline, holes = None, *, slack = None, across = None, beyond = None, progress = None, **options),
    text_signature = "(outline, holes=(), *, slack=0.0, across=False, beyond=None, progress=None, **options)"
)]
pub fn cover_sketch(
    py: Python<'_>,
    outline: &Bound<'_, PyAny>,
    holes: Option<&Bound<'_, PyAny>>,
    slack: Option<&Bound<'_, PyAny>>,
    across: Option<&Bound<'_, PyAny>>,
    beyond: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Patch> {
    let drawing = drawing(outline, holes)?;
    let chosen = chosen(py, "cover_sketch", options)?;
    let length = |name, value| Argument { name, value, allowed: "a finite length, at least 0" }.float();
    let slack = slack.map_or(Ok(0.0), |value| length("slack", value))?;
    let beyond = beyond.filter(|value| !value.is_none()).map(|value| length("beyond", value)).transpose()?;
    let across = across
        .map_or(Ok(false), |value| Argument { name: "across", value, allowed: "True or False" }.bool())?;
    let rim = match beyond {
        _ if across => Rim::Across,
        Some(beyond) => Rim::Whole { slack, beyond },
        None => Rim::Around(slack),
    };
    let covering = Watch::new(progress)?.run(py, |progress| {
        gridmesh::cover::cover_sketch(&drawing.outline, &drawing.holes, rim, &chosen, progress)
    })?;
    let report = reports::sketch(py, &covering.sketch.report)?;
    report.bind(py).set_item("outside", covering.outside)?;
    report.bind(py).set_item("between", covering.between)?;
    Ok(Patch::new(covering.sketch.patch, report, covering.sketch.kept))
}

/// The options of a function that meshes drawings.
fn chosen(py: Python<'_>, function: &str, options: Option<&Bound<'_, PyDict>>) -> PyResult<SketchOptions> {
    let mut chosen = SketchOptions::default();
    let mut shape = Shape::default();
    options::read(function, options, |name, value| shape.set(&mut chosen, name, value))?;
    shape.settle(py, &mut chosen)?;
    Ok(chosen)
}

/// The lattice of a patch.
fn kept(value: &Bound<'_, PyAny>) -> PyResult<Kept> {
    let argument = Argument { name: "keep", value, allowed: "a Patch whose lattice stays, or None" };
    value.cast::<Patch>().map(|patch| patch.get().kept.clone()).map_err(|_| argument.wrong_type())
}

/// Reads an outline and its holes.
pub fn drawing(outline: &Bound<'_, PyAny>, holes: Option<&Bound<'_, PyAny>>) -> PyResult<Drawing> {
    drawing_named("", outline, holes)
}

/// The same; `of` follows the names in messages, as " of part 3".
pub fn drawing_named(
    of: &str,
    outline: &Bound<'_, PyAny>,
    holes: Option<&Bound<'_, PyAny>>,
) -> PyResult<Drawing> {
    let allowed = "an (n, 2) array of real numbers";
    let outline = Argument { name: &format!("outline{of}"), value: outline, allowed }.points()?;
    let mut rings: Vec<Vec<DVec2>> = Vec::new();
    if let Some(value) = holes {
        let allowed_all = "a sequence of (k, 2) arrays of real numbers";
        let all = Argument { name: &format!("holes{of}"), value, allowed: allowed_all };
        for ring in value.try_iter().map_err(|_| all.wrong_type())? {
            let name = format!("hole {}{of}", rings.len());
            rings.push(Argument { name: &name, value: &ring?, allowed }.points()?);
        }
    }
    Ok(Drawing { outline, holes: rings })
}
