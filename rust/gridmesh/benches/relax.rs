//! Time of the placement alone, by number of triangles.

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use gridmesh::progress::Progress;
use gridmesh::relax::{RelaxOptions, relax};

#[path = "../tests/relax_shapes/mod.rs"]
mod relax_shapes;

fn placement(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("relax");
    for (name, triangles) in [("trefoil", 500), ("trefoil", 2000), ("trefoil", 10_000), ("star", 2000)] {
        let Some(shape) = relax_shapes::shape(&relax_shapes::outline(name), triangles, 0.1, true) else {
            continue;
        };
        let contours = [shape.contour()];
        group.throughput(Throughput::Elements(shape.triangles.len() as u64));
        group.bench_function(BenchmarkId::new(name, triangles), |bencher| {
            bencher.iter_batched(
                || (shape.positions.clone(), [shape.rim.clone()]),
                |(mut positions, mut rims)| {
                    let options = RelaxOptions::default();
                    relax(&shape.triangles, &mut positions, &contours, &mut rims, &options, Progress::NONE)
                },
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, placement);
criterion_main!(benches);
