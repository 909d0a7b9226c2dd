//! Growth of a boundary from its seed, and the search for the seed (section IV-B): time for each
//! triangle.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec2;
use gridmesh::drawing::curve::{ClosedCurve, Winding};
use gridmesh::lattice::boundary::{Boundary, Expansion};
use gridmesh::path::growth::{Watch, grow};
use gridmesh::path::placement::Lattice;
use gridmesh::path::raster::Raster;
use gridmesh::path::target::Target;
use gridmesh::progress::Progress;

/// A smooth outline with five bays.
fn flower() -> Vec<DVec2> {
    (0..2000)
        .map(|i| {
            let t = f64::from(i) / 2000.0 * std::f64::consts::TAU;
            (1.0 + 0.3 * (5.0 * t).cos()) * DVec2::from_angle(t)
        })
        .collect()
}

fn growth(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("growth");
    for triangles in [2_000.0, 10_000.0, 100_000.0, 1_000_000.0] {
        let Ok(curve) = ClosedCurve::new(&flower(), Winding::CounterClockwise, "outline") else { return };
        let edge_length = Lattice::edge_length_for(curve.area(), triangles);
        let lattice = Lattice { origin: DVec2::ZERO, angle: 0.2, edge_length };
        let raster = Raster::new(&Target::new(&curve, &lattice), 5);
        let within = |_: &Boundary, expansion: &Expansion| raster.is_free(expansion.point, expansion.beside);
        let from = |seed| {
            let mut boundary = Boundary::hexagon(raster.layout().clone(), seed)?;
            grow(&mut boundary, Watch::Point, within, Progress::NONE).ok()?;
            Some(boundary)
        };
        let Some(seed) = raster.seed() else { return };
        let Some(boundary) = from(seed) else { return };
        group.throughput(Throughput::Elements(boundary.triangles() as u64));
        group.bench_function(format!("grow {triangles}"), |b| b.iter(|| from(seed)));
        group.bench_function(format!("seed {triangles}"), |b| b.iter(|| raster.seed()));
    }
    group.finish();
}

criterion_group!(benches, growth);
criterion_main!(benches);
