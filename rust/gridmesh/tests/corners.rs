//! Drawn corners and what the report says of them.
#![allow(clippy::unwrap_used)]

use glam::DVec2;
use gridmesh::options::SketchOptions;
use gridmesh::progress::Progress;
use gridmesh::sketch::mesh_sketch;

fn star(tips: usize, inner: f64) -> Vec<DVec2> {
    let at = |i: usize| {
        let radius = if i.is_multiple_of(2) { 3.0 } else { inner };
        radius * DVec2::from_angle(std::f64::consts::PI * i as f64 / tips as f64 + 0.3)
    };
    (0..2 * tips).map(at).collect()
}

fn points(coords: &[[f64; 2]]) -> Vec<DVec2> {
    coords.iter().map(|&c| DVec2::from_array(c)).collect()
}

/// A corner counts as released if and only if no boundary vertex lies on it, whether it was snapped
/// there or held there later because the drawing strayed.
#[test]
fn released_corners_are_those_without_a_vertex() {
    let drawings = [
        ("square", points(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]), true),
        (
            "arrow",
            points(&[[0.0, 1.0], [3.0, 1.0], [3.0, 0.0], [5.0, 2.0], [3.0, 4.0], [3.0, 3.0], [0.0, 3.0]]),
            true,
        ),
        (
            "e",
            points(&[
                [0.0, 0.0],
                [4.0, 0.0],
                [4.0, 1.0],
                [1.0, 1.0],
                [1.0, 2.0],
                [3.0, 2.0],
                [3.0, 3.0],
                [1.0, 3.0],
                [1.0, 4.0],
                [4.0, 4.0],
                [4.0, 5.0],
                [0.0, 5.0],
            ]),
            true,
        ),
        ("star", star(5, 1.3), true),
        ("sharp star", star(5, 0.8), false),
        ("starlet", star(12, 1.5), false),
    ];
    for (name, outline, keeps_all) in drawings {
        for triangles in [500, 2000] {
            let options = SketchOptions { triangles: Some(triangles), ..SketchOptions::default() };
            let sketch = mesh_sketch(&outline, &[], &options, Progress::NONE).unwrap();
            let (patch, report) = (sketch.patch, sketch.report);
            let boundary = &patch.vertices[..patch.loops[0].len()];
            let bare = outline.iter().filter(|corner| !boundary.contains(corner)).count();
            assert_eq!(report.corners, outline.len(), "{name} {triangles}");
            assert_eq!(report.released_corners, bare, "{name} {triangles}");
            assert!(!keeps_all || bare == 0, "{name} {triangles}: {bare} corners bare");
            for (&vertex, &turning) in boundary.iter().zip(&patch.loops[0].corner) {
                assert_eq!(turning != 0.0, outline.contains(&vertex), "{name} {triangles} at {vertex}");
            }
        }
    }
}
