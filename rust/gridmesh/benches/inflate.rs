//! Time of inflation: circles and re-entrant outlines, by vertices of the closed body.

use std::f64::consts::TAU;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec2;
use gridmesh::body::inflate::{InflateOptions, inflate};
use gridmesh::body::stitch::stitch;
use gridmesh::geometry::embed::count_self_intersections;
use gridmesh::options::{BoundaryMethod, SketchOptions};
use gridmesh::patch::Patch;
use gridmesh::progress::Progress;
use gridmesh::sketch::mesh_sketch;

fn patch(radius: impl Fn(f64) -> f64, triangles: usize) -> Option<Patch> {
    let outline = (0..1000)
        .map(|k| TAU * f64::from(k) / 1000.0)
        .map(|angle| radius(angle) * DVec2::from_angle(angle))
        .collect::<Vec<_>>();
    let options = SketchOptions {
        triangles: Some(triangles),
        boundary: BoundaryMethod::Grown,
        ..SketchOptions::default()
    };
    mesh_sketch(&outline, &[], &options, Progress::NONE).ok().map(|sketch| sketch.patch)
}

fn bodies(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("inflate");
    group.sample_size(20);
    // A body has about as many vertices as its patch has triangles.
    for count in [1000, 5000, 20_000, 100_000] {
        let circle = patch(|_| 1.0, count);
        let flower = patch(|angle| 1.0 + 0.25 * (7.0 * angle).cos(), count);
        for (name, patch) in [("circle", circle), ("flower", flower)] {
            let Some(patch) = patch else { continue };
            let vertices = 2 * patch.vertices.len() - patch.n_boundary();
            group.bench_function(BenchmarkId::new(name, vertices), |bench| {
                bench.iter(|| inflate(&patch, &InflateOptions::default(), Progress::NONE));
            });
        }
    }
    group.finish();
    let Some(patch) = patch(|_| 1.0, 5000) else { return };
    criterion.bench_function("stitch/5000", |bench| bench.iter(|| stitch(&patch)));
    let Ok(body) = inflate(&patch, &InflateOptions::default(), Progress::NONE) else { return };
    criterion.bench_function("count_self_intersections/5000", |bench| {
        bench.iter(|| count_self_intersections(&body.vertices, &body.triangles));
    });
}

criterion_group!(benches, bodies);
criterion_main!(benches);
