//! `mesh_cutout`: meshes of all that a picture shows.

use gridmesh::body::inflate::InflateOptions;
use gridmesh::cutout::{CutoutOptions, CutoutRim, Finer};
use gridmesh::drawing::combine::Part;
use gridmesh::options::CellShape;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::input::Argument;
use crate::sketch::drawing_named;
use crate::surface::Surface;
use crate::watch::Watch;
use crate::{error, options};

/// Mesh all that a picture shows, with edges of about one length.
///
/// Parameters
/// ----------
/// parts : sequence of (outline, holes)
///     As `trace_image` returns them, in pixels.
/// triangles, quads : int, optional
///     Number of faces of one side of the whole, shared by the parts according to their areas; 1000 triangles if neither is given.
/// margin : float
///     How far the outlines lie outside what is to be covered, in pixels, as `trace_image` was told. Above 0 the meshes cover the
///     parts but for what of the margin they need not, see `cover_sketch`. 0: see `cover`.
/// cover : bool
///     Without a margin the rim lies across the outlines, so that the area between is least. False: its vertices lie on them.
/// faint : float
///     How many times fainter than an edge what lies at the outlines is, as where soft rims are covered: of that more may be cut off. At least 1.
/// most : float
///     What is too thin, or lacks much, is meshed with up to so many times the number asked for; beyond 16 times
///     only where no fewer can follow it, and with no more than 100 000 for the whole. At least 1.
/// body : dict, optional
///     Keyword arguments of `inflate` for bodies. None: flat sprites, triangles of them on straight lattices.
/// progress : callable, optional
///     Called with a fraction from 0 to 1; cancels by returning False. What it raises is raised here.
///
/// Returns
/// -------
/// surfaces : list of Surface or GridMeshError
///     In the order of the parts. A part that cannot be meshed gives its error and does not stop the others.
/// finer : {"thin", "cut_off", "area", "short", "beside"} or None
///     Why most of what is finer than asked for is so: fewer faces could not follow thin lines, would cut off more of tips, follow the outline
///     less closely, or have edges below a third of the mean; "beside": other parts have such edges. Of two numbers asked for
///     the smaller never leads to a finer size of a part, but for "beside".
///
/// Raises
/// ------
/// GridMeshError
///     If an option is not allowed, or when cancelled.
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// Takes the time of a few meshes for each part; of some twenty where tips or thin lines ask for more. Other Python threads run
/// meanwhile. The same input gives the same bytes.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> import numpy as np
/// >>> y, x = np.mgrid[:100, :100]
/// >>> disk = np.clip(40.5 - np.hypot(x - 49.5, y - 49.5), 0, 1)
/// >>> surfaces, finer = gridmesh.mesh_cutout(gridmesh.trace_image(disk, margin=1.0), triangles=500, margin=1.0)
/// >>> 450 < len(surfaces[0].triangles) < 550, finer
/// (True, None)
#[expect(clippy::too_many_arguments, reason = "the Python signature")]
#[pyfunction]
#[pyo3(
    signature = (parts, *, triangles = None, quads = None, margin = None, cover = None, faint = None, most = None, body = None, progress = None),
    text_signature = "(parts, *, triangles=None, quads=None, margin=0.0, cover=True, faint=1.0, most=250.0, body=None, progress=None)"
)]
pub fn mesh_cutout(
    py: Python<'_>,
    parts: &Bound<'_, PyAny>,
    triangles: Option<&Bound<'_, PyAny>>,
    quads: Option<&Bound<'_, PyAny>>,
    margin: Option<&Bound<'_, PyAny>>,
    cover: Option<&Bound<'_, PyAny>>,
    faint: Option<&Bound<'_, PyAny>>,
    most: Option<&Bound<'_, PyAny>>,
    body: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Py<PyList>, Option<&'static str>)> {
    let mut chosen = CutoutOptions::default();
    for (name, value, option) in [("faint", faint, &mut chosen.faint), ("most", most, &mut chosen.most)] {
        if let Some(value) = value {
            *option = Argument { name, value, allowed: "a finite number, at least 1" }.float()?;
        }
    }
    let number = |name, value| Argument { name, value, allowed: "a positive whole number" }.count();
    match (triangles, quads) {
        (Some(_), Some(value)) => {
            let allowed = "a number of quads or of triangles, not both";
            return Err(Argument { name: "quads", value, allowed }.wrong_value());
        }
        (Some(value), None) => chosen.number = number("triangles", value)?,
        (None, Some(value)) => {
            (chosen.number, chosen.cells) = (number("quads", value)?, CellShape::Quad);
        }
        (None, None) => {}
    }
    chosen.rim = rim(margin, cover)?;
    if let Some(value) = body.filter(|body| !body.is_none()) {
        let allowed = "a dict of keyword arguments of inflate, or None";
        let body =
            value.cast::<PyDict>().map_err(|_| Argument { name: "body", value, allowed }.wrong_type())?;
        let mut inflated = InflateOptions::default();
        options::read("inflate", Some(body), |name, value| options::set_inflate(&mut inflated, name, value))?;
        chosen.body = Some(inflated);
    }
    let watch = Watch::new(progress)?;
    let parts = read_parts(parts)?;
    let made = watch.run(py, |progress| gridmesh::cutout::mesh_cutout(&parts, &chosen, progress))?;
    let surfaces = PyList::empty(py);
    for surface in &made.surfaces {
        match surface {
            Ok(surface) => surfaces.append(Surface::new(py, surface)?)?,
            Err(refused) => surfaces.append(error::from_core(py, refused).into_value(py))?,
        }
    }
    let finer = made.finer.map(|finer| match finer {
        Finer::Thin => "thin",
        Finer::CutOff => "cut_off",
        Finer::Area => "area",
        Finer::Short => "short",
        Finer::Beside => "beside",
    });
    Ok((surfaces.unbind(), finer))
}

/// Where the boundaries lie.
fn rim(margin: Option<&Bound<'_, PyAny>>, cover: Option<&Bound<'_, PyAny>>) -> PyResult<CutoutRim> {
    let cover =
        cover.map_or(Ok(true), |value| Argument { name: "cover", value, allowed: "True or False" }.bool())?;
    if let Some(value) = margin {
        let it = Argument { name: "margin", value, allowed: "a finite number of pixels, 0 or more" };
        let margin = it.float()?;
        if !(margin.is_finite() && margin >= 0.0) {
            return Err(it.wrong_value());
        }
        if margin > 0.0 {
            return Ok(CutoutRim::Around { margin });
        }
    }
    Ok(if cover { CutoutRim::Across } else { CutoutRim::On })
}

fn read_parts(value: &Bound<'_, PyAny>) -> PyResult<Vec<Part>> {
    let all = Argument { name: "parts", value, allowed: "a sequence of (outline, holes)" };
    let read = |(k, part): (usize, PyResult<Bound<'_, PyAny>>)| {
        let part = part?;
        let name = format!("part {k}");
        let one = Argument { name: &name, value: &part, allowed: "a pair (outline, holes)" };
        let (outline, holes) =
            part.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>().map_err(|_| one.wrong_type())?;
        let drawing = drawing_named(&format!(" of part {k}"), &outline, Some(&holes))?;
        Ok(Part { outline: drawing.outline, holes: drawing.holes })
    };
    value.try_iter().map_err(|_| all.wrong_type())?.enumerate().map(read).collect()
}
