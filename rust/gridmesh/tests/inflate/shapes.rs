//! Patches to inflate, and what holds for every body.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};
use gridmesh::body::inflate::{InflateOptions, inflate};
use gridmesh::body::surface::Surface;
use gridmesh::geometry::embed::count_self_intersections;
use gridmesh::geometry::metrics::{check_mesh, face_angles, min_angle};
use gridmesh::lattice::axial::Axial;
use gridmesh::lattice::dir::Dir;
use gridmesh::options::{BoundaryMethod, SketchOptions};
use gridmesh::patch::{Loop, Patch};
use gridmesh::path::placement::Lattice;
use gridmesh::progress::Progress;
use gridmesh::sketch::mesh_sketch;

/// The lattice points of a hexagon of this radius, ring by ring, as (ring, place on the ring).
pub fn hexagon(radius: i32) -> Vec<(i32, i32, Axial)> {
    let mut points = vec![(0, 0, Axial::new(0, 0))];
    for ring in 1..=radius {
        let mut at = Axial::new(ring, 0);
        for side in 0..6 {
            for step in 0..ring {
                points.push((ring, side * ring + step, at));
                at = at + Dir::new(side + 2);
            }
        }
    }
    points
}

/// A lattice hexagon with rings `from..=radius`, mapped by `place(ring / radius, angle)`; with
/// `from > 0` it has a hexagonal hole.
pub fn hex_patch(from: i32, radius: i32, place: impl Fn(f64, f64) -> DVec2) -> Patch {
    let mut points = hexagon(radius);
    points.retain(|p| p.0 >= from);
    // The outer contour counter-clockwise, the hole clockwise, then the rest.
    let rank = |&(ring, k, _): &(i32, i32, Axial)| {
        if ring == radius {
            (0, k)
        } else if ring == from && from > 0 {
            (1, -k)
        } else {
            (2 + ring, k)
        }
    };
    points.sort_by_key(rank);
    let number = |a: Axial| points.iter().position(|p| p.2 == a);
    let lookup: std::collections::BTreeMap<Axial, u32> =
        points.iter().enumerate().map(|(i, p)| (p.2, i as u32)).collect();
    assert_eq!(number(points[0].2), Some(0));
    let mut triangles = vec![];
    for (&a, &i) in &lookup {
        let n = a.neighbours();
        for (b, c) in [(n[0], n[1]), (n[1], n[2])] {
            if let (Some(&j), Some(&k)) = (lookup.get(&b), lookup.get(&c)) {
                triangles.push([i, j, k]);
            }
        }
    }
    let vertices = points
        .iter()
        .map(|&(ring, k, _)| {
            place(f64::from(ring) / f64::from(radius), TAU * f64::from(k) / f64::from(6 * ring.max(1)))
        })
        .collect::<Vec<_>>();
    let contour = |start: u32, len: i32| Loop {
        start,
        arc: (0..len).map(f64::from).collect(),
        source: (0..len).map(|k| (k as u32, 0.0)).collect(),
        corner: vec![0.0; len as usize],
        length: f64::from(len),
    };
    let mut loops = vec![contour(0, 6 * radius)];
    if from > 0 {
        loops.push(contour(6 * radius as u32, 6 * from));
    }
    let mut patch = Patch {
        vertices,
        triangles,
        quads: vec![],
        loops,
        inlets: vec![],
        lattice: Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 },
        belt: None,
    };
    patch.lattice.edge_length = Lattice::edge_length_for(patch.area(), patch.triangles.len() as f64);
    patch
}

pub fn disk(radius: i32) -> Patch {
    hex_patch(0, radius, |r, angle| r * DVec2::from_angle(angle))
}

pub fn sketched(outline: &[DVec2], triangles: usize) -> Patch {
    let options = SketchOptions {
        triangles: Some(triangles),
        boundary: BoundaryMethod::Grown,
        ..SketchOptions::default()
    };
    mesh_sketch(outline, &[], &options, Progress::NONE).unwrap().patch
}

pub fn polar(n: usize, radius: impl Fn(f64) -> f64) -> Vec<DVec2> {
    (0..n).map(|k| TAU * k as f64 / n as f64).map(|angle| radius(angle) * DVec2::from_angle(angle)).collect()
}

/// A band of this half width along a path, as an outline.
pub fn band(path: &[DVec2], half: f64) -> Vec<DVec2> {
    let n = path.len();
    let normal = |k: usize| (path[(k + 1).min(n - 1)] - path[k.saturating_sub(1)]).normalize().perp();
    let right = (0..n).map(|k| path[k] - half * normal(k));
    let left = (0..n).rev().map(|k| path[k] + half * normal(k));
    right.chain(left).collect()
}

pub fn stadium(half_length: f64, half: f64) -> Vec<DVec2> {
    let arc = |centre: f64, from: f64| {
        (0..60)
            .map(move |k| DVec2::new(centre, 0.0) + half * DVec2::from_angle(from + PI * f64::from(k) / 60.0))
    };
    arc(half_length, -FRAC_PI_2).chain(arc(-half_length, FRAC_PI_2)).collect()
}

pub fn drawings() -> Vec<(&'static str, Vec<DVec2>)> {
    let points = |p: &[(f64, f64)]| p.iter().map(|&(x, y)| DVec2::new(x, y)).collect::<Vec<_>>();
    let spiral = (0..200).map(|k| 0.1 * f64::from(k)).map(|t| (0.5 + 0.2 * t) * DVec2::from_angle(t));
    let mut comb = vec![(0.0, 0.0), (9.0, 0.0), (9.0, 4.0)];
    for tooth in (0..4).rev() {
        let x = f64::from(tooth) * 2.0;
        comb.extend([(x + 2.0, 4.0), (x + 2.0, 1.0), (x + 1.0, 1.0), (x + 1.0, 4.0)]);
    }
    comb.push((0.0, 4.0));
    vec![
        ("ellipse", polar(300, |a| 1.0 / (a.cos() / 3.0).hypot(a.sin()))),
        ("trefoil", polar(300, |a| 1.0 + 0.3 * (3.0 * a).cos())),
        ("star", polar(10, |a| if ((a / PI * 5.0).round() as i32) % 2 == 0 { 1.0 } else { 0.4 })),
        ("square", points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])),
        ("ell", points(&[(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)])),
        ("dumbbell", polar(400, |a| 0.25 + a.cos().powi(4))),
        ("spiral", band(&spiral.collect::<Vec<_>>(), 0.35)),
        ("comb", points(&comb)),
        ("needle", points(&[(0.0, 0.0), (10.0, 0.0), (10.0, 0.6)])),
    ]
}

pub fn inflated(patch: &Patch, options: &InflateOptions) -> Surface {
    inflate(patch, options, Progress::NONE).unwrap()
}

/// Everything that is promised of any body.
pub fn check_body(name: &str, patch: &Patch, body: &Surface) {
    let n = patch.vertices.len();
    let first = patch.n_boundary();
    assert_eq!(body.vertices.len(), 2 * n - first, "{name}");
    assert_eq!(body.triangles.len(), 2 * patch.triangles.len(), "{name}");
    assert_eq!(&body.triangles[..patch.triangles.len()], &patch.triangles[..], "{name}");
    assert!(body.vertices.iter().all(|v| v.is_finite()), "{name}");
    for v in 0..first {
        assert_eq!(body.vertices[v], patch.vertices[v].extend(0.0), "{name}: silhouette");
    }
    for (v, &front) in body.vertices.iter().enumerate().take(n).skip(first) {
        let back = body.vertices[v + n - first];
        assert_eq!(front.truncate(), back.truncate(), "{name}: x and y agree");
        assert!(front.z >= 0.0 && back.z <= 0.0 && front.z > back.z, "{name}: {front} {back}");
    }
    let check = check_mesh(body.vertices.len(), &body.triangles);
    assert!(check.watertight, "{name}: {check:?}");
    assert_eq!(check.genus as usize, patch.loops.len() - 1, "{name}");
    let report = &body.report;
    assert!(report.watertight && report.genus == check.genus && report.irregular == check.irregular);
    assert!(report.embedded, "{name}: not proved");
    assert_eq!(count_self_intersections(&body.vertices, &body.triangles), 0, "{name}: proved, yet counted");
    assert_eq!(report.self_intersections, 0, "{name}");
    assert!(report.volume > 0.0, "{name}");
    assert_eq!(report.min_angle, min_angle(&body.vertices, &body.triangles), "{name}");
    // No vertex leaves the drawing: its projection lies in a triangle of the flat patch.
    for p in body.vertices[first..n].iter().map(|v| v.truncate()) {
        let inside = patch.triangles.iter().any(|t| {
            let [a, b, c] = t.map(|v| patch.vertices[v as usize] - p);
            a.perp_dot(b) >= -1e-12 && b.perp_dot(c) >= -1e-12 && c.perp_dot(a) >= -1e-12
        });
        assert!(inside, "{name}: {p} is outside");
    }
}

pub fn is_mirrored(patch: &Patch, body: &Surface) -> bool {
    let (n, first) = (patch.vertices.len(), patch.n_boundary());
    (first..n).all(|v| {
        let (front, back) = (body.vertices[v], body.vertices[v + n - first]);
        back == DVec3::new(front.x, front.y, -front.z)
    })
}

/// Mean face angle across the silhouette over that of the two rings of edges beside it.
pub fn seam_ratio(patch: &Patch, body: &Surface) -> f64 {
    let mut ring = vec![u32::MAX; body.vertices.len()];
    ring[..patch.n_boundary()].fill(0);
    for k in 1..=2 {
        for t in &body.triangles {
            if t.iter().any(|&v| ring[v as usize] == k - 1) {
                for &v in t {
                    ring[v as usize] = ring[v as usize].min(k);
                }
            }
        }
    }
    let (mut seam, mut beside) = (vec![], vec![]);
    for ([u, v], angle) in face_angles(&body.vertices, &body.triangles) {
        match ring[u as usize].max(ring[v as usize]) {
            0 => seam.push(angle),
            1 | 2 => beside.push(angle),
            _ => {}
        }
    }
    let mean = |angles: &[f64]| angles.iter().sum::<f64>() / angles.len() as f64;
    mean(&seam) / mean(&beside)
}
