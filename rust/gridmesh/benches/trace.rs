//! The optimal boundary at growing resolution: band and search, without conflicts.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec2;
use gridmesh::drawing::curve::{ClosedCurve, Winding};
use gridmesh::path::band::Band;
use gridmesh::path::placement::Lattice;
use gridmesh::path::target::Target;
use gridmesh::path::trace::{TraceOptions, trace};
use gridmesh::progress::Progress;

fn stages(criterion: &mut Criterion) {
    let outline: Vec<DVec2> = (0..2000)
        .map(|i| {
            let t = std::f64::consts::TAU * f64::from(i) / 2000.0;
            (3.0 + (2.0 * t).cos() + 0.6 * (5.0 * t).sin()) * DVec2::from_angle(t)
        })
        .collect();
    let Ok(curve) = ClosedCurve::new(&outline, Winding::CounterClockwise, "outline") else {
        return;
    };
    let mut group = criterion.benchmark_group("trace");
    for boundary in [100, 290, 990, 3000] {
        let lattice = Lattice {
            origin: curve.points()[0],
            angle: 0.3,
            edge_length: 1.05 * curve.length() / f64::from(boundary),
        };
        let targets = [Target::new(&curve, &lattice)];
        group.bench_with_input(BenchmarkId::new("band", boundary), &targets, |b, targets| {
            b.iter(|| Band::new(&targets[0], 1.5));
        });
        group.bench_with_input(BenchmarkId::new("trace", boundary), &targets, |b, targets| {
            b.iter(|| trace(targets, &TraceOptions::default(), Progress::NONE));
        });
    }
    group.finish();
}

criterion_group!(benches, stages);
criterion_main!(benches);
