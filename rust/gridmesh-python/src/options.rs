//! Options by name: one table for `mesh_sketch`, `inflate` and `map_sketches`.

use gridmesh::body::inflate::{InflateOptions, Profile, Side};
use gridmesh::body::surface::UvLayout;
use gridmesh::options::{BoundaryMethod, CellShape, Density, Mirror, SelfCrossing, SketchOptions};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyInt, PyString};

use crate::error::error;
use crate::input::Argument;

/// Reads every option of `given` with `set`, which says whether it knows the name.
pub fn read<'py>(
    function: &str,
    given: Option<&Bound<'py, PyDict>>,
    mut set: impl FnMut(&str, &Bound<'py, PyAny>) -> PyResult<bool>,
) -> PyResult<()> {
    for (name, value) in given.into_iter().flat_map(|dict| dict.iter()) {
        let Ok(name) = name.cast::<PyString>() else {
            let name = name.repr()?;
            return Err(PyTypeError::new_err(format!("{name} is no name of an option of {function}()")));
        };
        let name = name.to_string();
        if !set(&name, &value)? {
            return Err(PyTypeError::new_err(format!(
                "{function}() has no option {name}; see help(gridmesh.{function})"
            )));
        }
    }
    Ok(())
}

/// What the number of cells and their shape were given as; settled when all options are read.
#[derive(Default)]
pub struct Shape {
    cells: Option<CellShape>,
    /// The option that gave a number.
    number: Option<CellShape>,
}

impl Shape {
    /// Sets an option of `mesh_sketch` or notes it; false if it has none of this name.
    pub fn set(
        &mut self,
        options: &mut SketchOptions,
        name: &str,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<bool> {
        let argument = |allowed| Argument { name, value, allowed };
        match name {
            "cells" => {
                let words = [("triangles", CellShape::Triangle), ("quads", CellShape::Quad)];
                let it = argument("'triangles', 'quads', or None: quads if their number is given");
                self.cells = it.optional(|it| it.word(&words))?;
            }
            "quads" if value.is_none() => {}
            "quads" => {
                if self.number == Some(CellShape::Triangle) {
                    return Err(argument("a number of quads or of triangles, not both").wrong_value());
                }
                self.number = Some(CellShape::Quad);
                set_sketch(options, "triangles", value)?;
            }
            "triangles" if value.is_none() => {}
            "triangles" => {
                if self.number == Some(CellShape::Quad) {
                    return Err(argument("a number of quads or of triangles, not both").wrong_value());
                }
                self.number = Some(CellShape::Triangle);
                set_sketch(options, name, value)?;
            }
            "bend" if value.is_none() => {}
            _ => return set_sketch(options, name, value),
        }
        Ok(true)
    }

    /// Settles what follows from other options: a number of quads asks for quads.
    pub fn settle(&self, py: Python<'_>, options: &mut SketchOptions) -> PyResult<()> {
        options.cells = self.cells.or(self.number).unwrap_or_default();
        let of = |shape| self.number == Some(shape) && options.cells != shape;
        if of(CellShape::Triangle) || of(CellShape::Quad) {
            let message = "cells is of one kind and the number of the other; allowed: cells='quads' with quads, cells='triangles' with triangles";
            return Err(error(py, "invalid_option", message));
        }
        Ok(())
    }
}

/// Sets an option of `mesh_sketch`; false if it has none of this name.
fn set_sketch(options: &mut SketchOptions, name: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    let argument = |allowed| Argument { name, value, allowed };
    match name {
        "edge_length" => {
            let it = argument("a positive number in the units of the outline, or None");
            options.edge_length = it.optional(|it| it.float())?;
        }
        "triangles" => {
            let it = argument("a positive whole number, 'auto', or None");
            options.triangles = None;
            options.automatic = it.value.is_instance_of::<PyString>();
            if options.automatic {
                it.word(&[("auto", ())])?;
            } else {
                options.triangles = it.optional(|it| it.count())?;
            }
        }
        "max_triangles" => options.max_triangles = argument("a positive whole number").count()?,
        "boundary" => {
            let words = [("optimal", BoundaryMethod::Optimal), ("grown", BoundaryMethod::Grown)];
            options.boundary = argument("'optimal' or 'grown'").word(&words)?;
        }
        "max_distance" => options.max_distance = argument("a positive number of edge lengths").float()?,
        "closeness" => options.closeness = argument("a number not below 0").float()?,
        "angle" => {
            let it = argument("a number of radians from 0 to below pi / 3, or None");
            options.angle = it.optional(|it| it.float())?;
        }
        "origin" => {
            let it = argument("a pair of numbers, or None");
            options.origin = it.optional(|it| it.pair())?;
        }
        "corner_angle" => options.corner_angle = argument("a number of radians from 0 to pi").float()?,
        "mirror" => {
            let it = argument("an axis (point, direction) of two pairs of numbers, 'auto', or None");
            options.mirror = it.optional(mirror)?;
        }
        "self_crossing" => {
            let words = [("error", SelfCrossing::Error), ("union", SelfCrossing::Union)];
            options.self_crossing = argument("'error' or 'union'").word(&words)?;
        }
        "proof_nodes" => options.proof_nodes = argument("a whole number not below 0").count()?,
        "bend" => options.bend = argument("a number from 0 to 1").float()?,
        "density" => {
            let it = argument(
                "'width', a number from 0 to 1, one positive number per point of the outline, or a sequence of such arrays, for the outline and its holes; or None",
            );
            options.density = it.optional(density)?;
        }
        "open_corners" => options.open_corners = argument("True or False").bool()?,
        "relax" => options.relax = argument("True or False").bool()?,
        "least" => options.least = argument("True or False").bool()?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Sets an option of `inflate`; false if it has none of this name.
pub fn set_inflate(options: &mut InflateOptions, name: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    let argument = |allowed| Argument { name, value, allowed };
    let side = "a number, one number per point of the outline, or None";
    match name {
        "depth" => options.depth = argument("a positive number").float()?,
        "profile" => {
            let words = [
                ("round", Profile::Round),
                ("even", Profile::Even),
                ("flat", Profile::Flat),
                ("peak", Profile::Peak),
            ];
            options.profile = argument("'round', 'even', 'flat' or 'peak'").word(&words)?;
        }
        "curve" => {
            let it = argument("numbers, the first 0 and the others positive, or None");
            options.curve = it.optional(|it| it.numbers())?;
        }
        "uv" => {
            let words = [("apart", UvLayout::Apart), ("shared", UvLayout::Shared)];
            options.uv = argument("'apart' or 'shared'").word(&words)?;
        }
        "subdivided" => options.subdivided = argument("True or False").bool()?,
        "front" => options.front = argument(side).optional(depths)?,
        "back" => options.back = argument(side).optional(depths)?,
        "corner_angle" => options.corner_angle = argument("a number of radians from 0 to pi").float()?,
        _ => return Ok(false),
    }
    Ok(true)
}

fn density(it: Argument<'_, '_>) -> PyResult<Density> {
    if it.value.is_instance_of::<PyString>() {
        return it.word(&[("width", ())]).map(|()| Density::Width(1.0));
    }
    if let Ok(share) = it.value.extract::<f64>() {
        return Ok(Density::Width(share));
    }
    // Arrays in a row may have different lengths: they are no array together.
    let mut rows = it.value.try_iter().map_err(|_| it.wrong_type())?;
    let nested = rows.any(|row| row.is_ok_and(|row| row.len().is_ok()));
    if !nested {
        return Ok(Density::PerPoint(vec![it.numbers()?]));
    }
    let rows = it.value.try_iter().map_err(|_| it.wrong_type())?;
    let row = |row: PyResult<Bound<'_, PyAny>>| Argument { value: &row?, ..it }.numbers();
    rows.map(row).collect::<PyResult<Vec<Vec<f64>>>>().map(Density::PerPoint)
}

fn mirror(it: Argument<'_, '_>) -> PyResult<Mirror> {
    if it.value.is_instance_of::<PyString>() {
        return it.word(&[("auto", ())]).map(|()| Mirror::Auto);
    }
    let [point, direction] = it.value.extract::<[Bound<'_, PyAny>; 2]>().map_err(|_| it.wrong_type())?;
    Ok(Mirror::Axis {
        point: Argument { value: &point, ..it }.pair()?,
        direction: Argument { value: &direction, ..it }.pair()?,
    })
}

fn depths(it: Argument<'_, '_>) -> PyResult<Side> {
    let is_number = it.value.is_instance_of::<PyFloat>() || it.value.is_instance_of::<PyInt>();
    if is_number { it.float().map(Side::Uniform) } else { it.numbers().map(Side::PerPoint) }
}
