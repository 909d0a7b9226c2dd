//! Mirror-symmetric meshes: topology and positions are their own image.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeSet;

use glam::DVec2;
use gridmesh::options::{BoundaryMethod, Mirror, SketchOptions};
use gridmesh::patch::Patch;
use gridmesh::progress::Progress;
use gridmesh::sketch::{Sketch, mesh_sketch};

/// A drawing that is symmetric in the vertical axis through the origin, to the last bit.
struct Drawing {
    name: &'static str,
    outline: Vec<DVec2>,
    holes: Vec<Vec<DVec2>>,
}

/// A closed line from the part right of the axis; points on the axis are given once, at the ends.
fn unfolded(right: &[DVec2]) -> Vec<DVec2> {
    let left = right.iter().rev().filter(|p| p.x != 0.0).map(|p| DVec2::new(-p.x, p.y));
    right.iter().copied().chain(left).collect()
}

fn points(coords: &[[f64; 2]]) -> Vec<DVec2> {
    coords.iter().map(|&c| DVec2::from_array(c)).collect()
}

fn polar(n: usize, radius: impl Fn(f64) -> f64) -> Vec<DVec2> {
    let at = |i: usize| {
        let t = std::f64::consts::PI * (i as f64 + 0.5) / n as f64;
        radius(t) * DVec2::new(t.sin(), -t.cos())
    };
    unfolded(&(0..n).map(at).collect::<Vec<_>>())
}

fn drawings() -> Vec<Drawing> {
    let drawing = |name, outline, holes| Drawing { name, outline, holes };
    let square = |x: f64, y: f64, half: f64| {
        points(&[[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]])
    };
    let pair = |hole: Vec<DVec2>| {
        let image: Vec<DVec2> = hole.iter().map(|p| DVec2::new(-p.x, p.y)).collect();
        [hole, image]
    };
    let [left, right] = pair(polar(30, |_| 0.7).into_iter().map(|p| p + DVec2::new(1.4, 0.8)).collect());
    vec![
        drawing("disc", polar(60, |_| 3.0), vec![]),
        drawing("leaf", polar(80, |t| 2.0 + 0.7 * (3.0 * t).cos() + 0.3 * (2.0 * t).cos()), vec![]),
        drawing("flower", polar(150, |t| 3.0 + 1.6 * (5.0 * t).cos()), vec![]),
        drawing(
            "heart",
            unfolded(&points(&[[0.0, -3.0], [2.6, -0.2], [3.0, 1.4], [2.2, 2.5], [0.9, 2.4], [0.0, 1.2]])),
            vec![],
        ),
        drawing("arrow", unfolded(&points(&[[0.5, -3.0], [0.5, 1.0], [2.0, 1.0], [0.0, 3.0]])), vec![]),
        drawing(
            "slit",
            unfolded(&points(&[[0.0, -3.0], [3.0, -3.0], [3.0, 3.0], [0.12, 3.0], [0.0, -1.0]])),
            vec![],
        ),
        drawing("face", polar(60, |_| 3.0), vec![left.clone(), right.clone(), square(0.0, -1.2, 0.5)]),
        drawing("bridge", polar(60, |_| 3.0), pair(square(0.6, 0.0, 0.5)).to_vec()),
        drawing("ring", polar(60, |_| 3.0), vec![polar(40, |t| 1.4 + 0.3 * (2.0 * t).cos())]),
    ]
}

fn moved(line: &[DVec2], turn: f64, shift: DVec2) -> Vec<DVec2> {
    line.iter().map(|&p| DVec2::from_angle(turn).rotate(p) + shift).collect()
}

fn mesh(drawing: &Drawing, turn: f64, shift: DVec2, options: &SketchOptions) -> Sketch {
    let holes: Vec<Vec<DVec2>> = drawing.holes.iter().map(|hole| moved(hole, turn, shift)).collect();
    mesh_sketch(&moved(&drawing.outline, turn, shift), &holes, options, Progress::NONE)
        .unwrap_or_else(|error| panic!("{}: {error}", drawing.name))
}

/// The partner of each vertex by position; panics unless it is one to one and maps triangles to
/// triangles. Returns the greatest distance of an image from the partner.
fn check_symmetric(patch: &Patch, reflect: impl Fn(DVec2) -> DVec2, name: &str) -> f64 {
    let mut worst = 0f64;
    let partner: Vec<u32> = patch
        .vertices
        .iter()
        .map(|&p| {
            let image = reflect(p);
            let distance = |v: &usize| patch.vertices[*v].distance(image);
            let nearest =
                (0..patch.vertices.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
            worst = worst.max(distance(&nearest));
            nearest as u32
        })
        .collect();
    for (v, &w) in partner.iter().enumerate() {
        assert_eq!(partner[w as usize] as usize, v, "{name}");
        assert_eq!(v < patch.n_boundary(), (w as usize) < patch.n_boundary(), "{name}");
    }
    let sorted = |mut t: [u32; 3]| {
        t.sort_unstable();
        t
    };
    let triangles: BTreeSet<[u32; 3]> = patch.triangles.iter().map(|&t| sorted(t)).collect();
    for t in &patch.triangles {
        assert!(triangles.contains(&sorted(t.map(|v| partner[v as usize]))), "{name}");
    }
    worst
}

#[test]
fn symmetric_drawings_get_symmetric_meshes() {
    for drawing in drawings() {
        for (turn, shift, triangles) in [
            (0.0, DVec2::ZERO, 500),
            (0.0, DVec2::ZERO, 2000),
            (0.7, DVec2::new(11.0, -4.0), 900),
            (2.6, DVec2::new(-3.0, 2.0), 3000),
        ] {
            let axis = Mirror::Axis { point: shift, direction: DVec2::from_angle(turn).rotate(DVec2::Y) };
            let auto = drawing.name != "disc" && drawing.name != "ring" && turn == 0.0;
            for mirror in [axis, Mirror::Auto].into_iter().take(if auto { 2 } else { 1 }) {
                let options = SketchOptions {
                    triangles: Some(triangles),
                    mirror: Some(mirror),
                    ..SketchOptions::default()
                };
                let sketch = mesh(&drawing, turn, shift, &options);
                let name = format!("{} {triangles} {turn} {mirror:?}", drawing.name);
                let normal = DVec2::from_angle(turn).rotate(DVec2::X);
                let reflect = |p: DVec2| p - 2.0 * normal.dot(p - shift) * normal;
                let error = check_symmetric(&sketch.patch, reflect, &name);
                assert!(error < 1e-12 * 20.0, "{name}: {error}");
                assert!(sketch.report.mirror_error.unwrap() < 1e-10, "{name}");
                assert!(sketch.report.cost_bound.unwrap() <= sketch.report.cost, "{name}");
                let count = sketch.patch.triangles.len() as f64 / triangles as f64;
                assert!((count - 1.0).abs() <= 0.1, "{name}: {count}");
            }
        }
    }
}

#[test]
fn drawings_that_are_nearly_symmetric_get_symmetric_topology() {
    // The end of a crooked slit lies beside the axis.
    for drawing in drawings().into_iter().filter(|d| d.holes.is_empty() && d.name != "slit") {
        let mut crooked = Drawing { outline: drawing.outline.clone(), ..drawing };
        for (i, p) in crooked.outline.iter_mut().enumerate() {
            let t = i as f64;
            *p += 0.012 * DVec2::new((1.7 * t).sin(), (2.3 * t).cos());
        }
        let mirror = Some(Mirror::Axis { point: DVec2::ZERO, direction: DVec2::Y });
        let options = SketchOptions { triangles: Some(1200), mirror, ..SketchOptions::default() };
        let sketch = mesh(&crooked, 0.0, DVec2::ZERO, &options);
        let error = check_symmetric(&sketch.patch, |p| DVec2::new(-p.x, p.y), crooked.name);
        assert!(error > 1e-6, "{}: the sides keep their own lines", crooked.name);
        assert!(sketch.report.mirror_error.unwrap() < 1.0, "{}", crooked.name);
    }
}

#[test]
fn the_lattice_angle_may_be_fixed_if_it_fits_the_axis() {
    let drawing = &drawings()[1];
    let third = std::f64::consts::FRAC_PI_3;
    let options = |angle: f64| SketchOptions {
        angle: Some(angle),
        triangles: Some(700),
        mirror: Some(Mirror::Auto),
        ..SketchOptions::default()
    };
    for angle in [0.0, 0.5 * third] {
        let sketch = mesh(drawing, 0.0, DVec2::ZERO, &options(angle));
        let off = (sketch.patch.lattice.angle - angle).rem_euclid(third);
        assert!(off.min(third - off) < 1e-9);
    }
    let refused = mesh_sketch(&drawing.outline, &[], &options(0.2), Progress::NONE).unwrap_err();
    assert_eq!(refused.kind(), "invalid_option");
}

#[test]
fn drawings_without_symmetry_and_growth_are_refused() {
    let kind = |outline: &[DVec2], boundary: BoundaryMethod| {
        let options = SketchOptions { boundary, mirror: Some(Mirror::Auto), ..SketchOptions::default() };
        mesh_sketch(outline, &[], &options, Progress::NONE).unwrap_err().kind()
    };
    let crooked = points(&[[0.0, 0.0], [4.0, 0.0], [5.0, 3.0], [1.0, 2.0]]);
    assert_eq!(kind(&crooked, BoundaryMethod::Optimal), "not_symmetric");
    assert_eq!(kind(&drawings()[0].outline, BoundaryMethod::Grown), "invalid_option");
    let options = SketchOptions { proof_nodes: 5, mirror: Some(Mirror::Auto), ..SketchOptions::default() };
    let refused = mesh_sketch(&drawings()[0].outline, &[], &options, Progress::NONE).unwrap_err();
    assert!(refused.to_string().contains("proof_nodes"), "{refused}");
}
