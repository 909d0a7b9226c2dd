//! Time of tubes between two loops, and of their faces alone.

use std::f64::consts::TAU;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DMat3, DVec3};
use gridmesh::fill::{BridgeOptions, bridge};
use gridmesh::progress::Progress;

/// A waved circle of `n` vertices about the z axis, tilted about the x axis, and a row of triangles beyond it.
fn ring(n: u32, tilt: f64, height: f64, wave: f64) -> (Vec<DVec3>, Vec<DVec3>) {
    let turn = DMat3::from_rotation_x(tilt);
    let at = |k: f64, down: f64| {
        let t = TAU * k / f64::from(n);
        let out = 1.0 + wave * (3.0 * t).cos();
        turn * DVec3::new(out * t.cos(), out * t.sin(), down + wave * (2.0 * t).sin()) + height * DVec3::Z
    };
    let edge = TAU / f64::from(n);
    let own = (0..n).map(|k| at(f64::from(k), 0.0)).collect();
    let beyond = (0..n).map(|k| at(f64::from(k) + 0.5, 0.87 * edge * height.signum())).collect();
    (own, beyond)
}

/// Triangles between a ring of vertices and the one beyond.
fn collar(n: u32, own: u32, far: u32, below: bool) -> Vec<[u32; 3]> {
    let row = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[own + k, far + k, own + next], [own + next, far + k, far + next]]
    });
    row.map(|[a, b, c]| if below { [a, b, c] } else { [a, c, b] }).collect()
}

fn bridges(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bridge");
    for (name, [n, m], tilt, wave) in [
        ("level", [60, 60], 0.0, 0.0),
        ("tilted", [60, 60], 0.4, 0.1),
        ("wider", [60, 90], 0.4, 0.1),
        ("long", [60, 60], 0.0, 0.1),
    ] {
        let height = if name == "long" { 3.0 } else { 0.8 };
        let ((lower, below), (upper, above)) = (ring(n, tilt, -height, wave), ring(m, -tilt, height, wave));
        let vertices = [lower, upper, below, above].concat();
        let triangles = [collar(n, 0, n + m, true), collar(m, n, 2 * n + m, false)].concat();
        let (one, other) = ((0..n).collect::<Vec<_>>(), (n..n + m).collect::<Vec<_>>());
        let run = || bridge(&vertices, &triangles, &one, &other, &BridgeOptions::default(), Progress::NONE);
        assert!(run().is_ok_and(|tube| tube.report.irregular == 0));
        group.bench_function(BenchmarkId::new(name, format!("{n} to {m}")), |bench| bench.iter(run));
    }
    group.finish();
}

criterion_group!(benches, bridges);
criterion_main!(benches);
