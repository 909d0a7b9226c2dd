//! Sentences and numbers of errors that depend on what they tell.

use std::fmt;

/// What is known of the number of triangles that a drawing needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needed {
    /// This number works, and none that is a tenth smaller was found to.
    Least(usize),
    /// Numbers up to this one were tried, and none of them works.
    MoreThan(usize),
    /// It was not searched for.
    Unknown,
}

pub(super) fn not_symmetric(
    what: &str,
    distance: &f64,
    allowed: &f64,
    [x, y]: &[f64; 2],
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    if distance.is_finite() {
        write!(
            f,
            "the {what} is not its own mirror image: near ({x:.6}, {y:.6}) it is {distance:.3e} off; \
             allowed: {allowed:.3e} (2 % of the drawing's size, 1.5 edge lengths); give another axis, \
             or mesh it without mirror"
        )
    } else {
        write!(
            f,
            "the {what} is not its own mirror image: near ({x:.6}, {y:.6}) it has no partner across the axis; \
             allowed: {allowed:.3e} (2 % of the drawing's size, 1.5 edge lengths); give another axis, \
             or mesh it without mirror"
        )
    }
}

pub(super) fn too_coarse(
    triangles: &usize,
    cells: &str,
    needed: &Needed,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    match cells {
        "quads" => write!(f, "{triangles} quads are too few to follow this drawing; ")?,
        _ => write!(f, "{triangles} triangles are too few to follow this drawing; ")?,
    }
    match needed {
        Needed::Least(least) => write!(f, "{least} work (or a smaller edge length)"),
        Needed::MoreThan(tried) => {
            write!(f, "none that work were found up to {tried}, use more or draw its thin parts wider")
        }
        Needed::Unknown => write!(f, "use more (or a smaller edge length)"),
    }
}

pub(super) fn out_of_range(
    what: &str,
    index: &i32,
    vertices: &usize,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    match vertices {
        0 => write!(f, "the {what} names vertex {index}, but no vertices were given; give those of the mesh"),
        _ => {
            let last = vertices - 1;
            write!(
                f,
                "the {what} names vertex {index}; allowed: 0 to {last}, one of the {vertices} vertices given"
            )
        }
    }
}

pub(super) fn no_such_face(index: &i32, faces: &usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match faces {
        0 => write!(f, "face {index} was chosen, but no triangles were given; give those of the mesh"),
        _ => {
            let last = faces - 1;
            write!(f, "face {index} was chosen; allowed: 0 to {last}, one of the {faces} triangles given")
        }
    }
}

pub(super) fn not_a_disk(faces: &usize, borders: &usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match (faces, borders) {
        (0, _) => write!(f, "no faces were chosen; choose one connected region"),
        (_, 0) => {
            write!(f, "the faces have no border; choose one connected region, not the whole of a closed mesh")
        }
        (_, 1) => {
            write!(f, "the faces touch themselves or form a handle; choose a region like a sheet of paper")
        }
        _ => write!(
            f,
            "the faces have {borders} borders or touch themselves; choose one connected region without holes"
        ),
    }
}

/// A number without a hundred zeros.
pub(crate) fn told(value: f64) -> String {
    if value == 0.0 || (1e-6..1e9).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

/// The numbers of a vector.
pub(crate) fn told_all(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|&value| told(value)).collect::<Vec<_>>().join(", "))
}
