//! `bone_weights`: flat meshes that follow bones.

use gridmesh::geometry::bones::{WeightOptions, bone_weights as core_weights};
use numpy::{AllowTypeChange, PyArray1, PyArrayLike3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::input::Argument;
use crate::mesh;
use crate::watch::Watch;

/// Tell how much each bone moves each vertex of a flat mesh.
///
/// Parameters
/// ----------
/// vertices : (n, 2) array of real numbers
/// triangles : (m, 3) array of integers
///     Either orientation.
/// bones : (b, 2, 2) array of real numbers, b >= 1
///     Head and tail of each bone in the plane of the mesh.
/// most : int, optional
///     The most bones that move a vertex.
/// reach : float, optional
///     How far a joint reaches into the limbs that meet there, relative to half their width, 0.01 to 100.
/// progress : callable, optional
///     Called with fractions of the work done; cancels by returning False.
///
/// Returns
/// -------
/// (n, b) float64
///     Rows sum to 1 (within 1e-12) and hold no negative number and at most `most` that are not 0. They vary smoothly over the
///     mesh. Distances are measured within it: a bone has no hold on a limb that is near in the plane but far in the drawing. A
///     part that no bone meets follows, as a whole, the bone that is nearest.
///
/// Raises
/// ------
/// GridMeshError
///     "not_finite", "extreme_size", "index_out_of_range", "invalid_option", "invalid_shape", "solver", "cancelled".
/// TypeError
///     If an argument has a type that is not allowed.
///
/// Notes
/// -----
/// One sparse Cholesky factorisation; in O(b n log n) in practice. After the heat equilibrium of Baran and Popovic: Automatic rigging
/// and animation of 3D characters, 2007, with a transfer that depends on the limb's width.
///
/// Examples
/// --------
/// >>> import gridmesh
/// >>> bar = gridmesh.mesh_sketch([[0, 0], [8, 0], [8, 2], [0, 2]], triangles=300)
/// >>> weights = gridmesh.bone_weights(bar.vertices, bar.triangles, [[[0, 1], [4, 1]], [[4, 1], [8, 1]]])
/// >>> bool(weights[bar.vertices[:, 0] < 1, 0].min() > 0.95)
/// True
#[pyfunction]
#[pyo3(
    signature = (vertices, triangles, bones, *, most = None, reach = None, progress = None),
    text_signature = "(vertices, triangles, bones, *, most=4, reach=1.0, progress=None)"
)]
pub fn bone_weights<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    triangles: &Bound<'py, PyAny>,
    bones: &Bound<'py, PyAny>,
    most: Option<&Bound<'py, PyAny>>,
    reach: Option<&Bound<'py, PyAny>>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let allowed = "an (n, 2) array of real numbers";
    let points = Argument { name: "vertices", value: vertices, allowed }.points()?;
    let faces = mesh::triangles(triangles)?;
    let segments = segments(&Argument {
        name: "bones",
        value: bones,
        allowed: "a (b, 2, 2) array of real numbers, head and tail of each bone",
    })?;
    let mut options = WeightOptions::default();
    if let Some(value) = most {
        options.most = Argument { name: "most", value, allowed: "a whole number, 1 or more" }.count()?;
    }
    if let Some(value) = reach {
        options.reach = Argument { name: "reach", value, allowed: "a number from 0.01 to 100" }.float()?;
    }
    let watch = Watch::new(progress)?;
    let (n, b) = (points.len(), segments.len());
    let found =
        watch.run(py, move |progress| core_weights(&points, &faces, &segments, &options, progress))?;
    Ok(PyArray1::from_vec(py, found).reshape([n, b])?.into_any())
}

fn segments(it: &Argument<'_, '_>) -> PyResult<Vec<[glam::DVec2; 2]>> {
    let array = it.array()?;
    if array.len() == 0 {
        return Ok(vec![]);
    }
    if array.ndim() != 3 || array.shape()[1..] != [2, 2] {
        return Err(it.wrong_shape(&format!("has shape {:?}", array.shape())));
    }
    let held = array.extract::<PyArrayLike3<'_, f64, AllowTypeChange>>()?;
    let point = |bone: usize, end: usize| {
        let all = held.as_array();
        glam::DVec2::new(all[[bone, end, 0]], all[[bone, end, 1]])
    };
    Ok((0..array.shape()[0]).map(|bone| [point(bone, 0), point(bone, 1)]).collect())
}
