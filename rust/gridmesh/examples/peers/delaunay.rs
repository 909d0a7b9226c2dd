//! Constrained Delaunay triangulation and Delaunay refinement by spade.

use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, RefinementResult,
    Triangulation,
};

use crate::{Mesh, Outcome};

/// Smallest angle that refinement aims at, as in Triangle's `q30`.
const ANGLE: f64 = 30.0;

/// Refinement ends without success when it has added this many vertices per triangle asked for.
const LIMIT: usize = 20;

pub(crate) struct Input {
    pub(crate) points: Vec<Point2<f64>>,
    pub(crate) edges: Vec<[usize; 2]>,
}

/// The contours' points one after the other, and the edges along them.
pub(crate) fn input(contours: &[Vec<[f64; 2]>]) -> Input {
    let mut input = Input { points: Vec::new(), edges: Vec::new() };
    for contour in contours {
        let (start, n) = (input.points.len(), contour.len());
        input.points.extend(contour.iter().map(|&[x, y]| Point2::new(x, y)));
        input.edges.extend((0..n).map(|i| [start + i, start + (i + 1) % n]));
    }
    input
}

/// Spade's refinement: no angle below 30 degrees, no area above that of an equilateral triangle
/// of edge `size`.
pub(crate) fn refined(input: &Input, size: f64, target: usize) -> Outcome<Mesh> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(
        input.points.clone(),
        input.edges.clone(),
    )?;
    let result = cdt.refine(
        RefinementParameters::new()
            .exclude_outer_faces(true)
            .with_angle_limit(AngleLimit::from_deg(ANGLE))
            .with_max_allowed_area(0.25 * 3f64.sqrt() * size * size)
            .with_max_additional_vertices(LIMIT * target),
    );
    if !result.refinement_complete {
        return Err("the refinement does not end".into());
    }
    Ok(inside(&cdt, &result))
}

/// The constrained Delaunay triangulation of the contours and further points inside them.
pub(crate) fn triangulated(input: Input) -> Outcome<Mesh> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(input.points, input.edges)?;
    // Adds nothing: it only tells the inside from the outside.
    let result = cdt.refine(
        RefinementParameters::new()
            .exclude_outer_faces(true)
            .with_angle_limit(AngleLimit::from_deg(0.0))
            .with_max_additional_vertices(0),
    );
    Ok(inside(&cdt, &result))
}

fn inside(cdt: &ConstrainedDelaunayTriangulation<Point2<f64>>, result: &RefinementResult) -> Mesh {
    let mut outside = vec![false; cdt.num_all_faces()];
    for face in &result.excluded_faces {
        outside[face.index()] = true;
    }
    let vertices = cdt.vertices().map(|v| [v.position().x, v.position().y]).collect();
    let triangles = cdt
        .inner_faces()
        .filter(|face| !outside[face.fix().index()])
        .map(|face| face.vertices().map(|v| v.fix().index() as u32))
        .collect();
    Mesh { vertices, triangles }
}
