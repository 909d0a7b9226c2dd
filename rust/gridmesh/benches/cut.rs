//! Time of cuts with both pieces capped, by triangles of the model, and of large holes.

use std::f64::consts::{PI, TAU};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use gridmesh::cut::{CutOptions, Polygons, Sweep, cut};
use gridmesh::fill::{FillOptions, Smooth, fill_hole};
use gridmesh::progress::Progress;

/// A ball of rings of triangles, closed by a fan at either pole.
fn ball(rings: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let around = 2 * rings;
    let mut vertices = vec![DVec3::NEG_Z];
    for r in 1..rings {
        let (low, height) = (PI * f64::from(r) / f64::from(rings)).sin_cos();
        vertices.extend((0..around).map(|k| {
            let (y, x) = (TAU * f64::from(k) / f64::from(around)).sin_cos();
            DVec3::new(low * x, low * y, -height)
        }));
    }
    let top = vertices.len() as u32;
    vertices.push(DVec3::Z);
    let at = |r: u32, k: u32| 1 + (r - 1) * around + k % around;
    let mut triangles = vec![];
    for k in 0..around {
        triangles.push([0, at(1, k + 1), at(1, k)]);
        triangles.push([top, at(rings - 1, k), at(rings - 1, k + 1)]);
        for r in 1..rings - 1 {
            let [a, b, c, d] = [at(r, k), at(r, k + 1), at(r + 1, k + 1), at(r + 1, k)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (vertices, triangles)
}

fn cuts(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cut");
    group.sample_size(10);
    let wave = (0..200).map(|k| -3.0 + 6.0 * f64::from(k) / 199.0);
    let wave: Vec<DVec3> = wave.map(|x| DVec3::new(x, 0.0, 0.1 + 0.12 * (5.0 * x).sin())).collect();
    let straight = vec![DVec3::new(-3.0, 0.0, 0.13), DVec3::new(3.0, 0.0, 0.13)];
    for rings in [159, 501] {
        let (vertices, triangles) = ball(rings);
        let corners = triangles.concat();
        let offsets: Vec<u32> = (0..=triangles.len() as u32).map(|face| 3 * face).collect();
        let faces = Polygons { corners: &corners, offsets: &offsets };
        for (line, stroke) in [("straight", &straight), ("wave", &wave)] {
            for (rim, edge_length) in [("exact", None), ("even", Some(PI / f64::from(rings)))] {
                let options = CutOptions { edge_length, ..CutOptions::new(Sweep::Along(DVec3::Y)) };
                let id = BenchmarkId::new(format!("{line}, {rim}"), triangles.len());
                let run = || cut(&vertices, faces, stroke, &options, Progress::NONE);
                assert!(run().is_ok_and(|cut| cut.pieces.len() == 2 && cut.report.caps == 1));
                group.bench_function(id, |bench| bench.iter(run));
            }
        }
    }
    group.finish();
}

/// A strip around a hole of `n` edges.
fn fills(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fill");
    group.sample_size(10);
    for n in [60, 200, 1000] {
        let ring = |radius: f64, z: f64| {
            (0..n).map(move |k| {
                let (y, x) = (TAU * f64::from(k) / f64::from(n)).sin_cos();
                DVec3::new(radius * x, radius * y, z)
            })
        };
        let step = TAU / f64::from(n);
        let vertices: Vec<DVec3> = ring(1.0, 0.0).chain(ring(1.0 + 0.8 * step, -0.4 * step)).collect();
        let strip = (0..n).flat_map(|a| {
            let b = (a + 1) % n;
            [[a, a + n, b], [b, a + n, b + n]]
        });
        let (strip, hole): (Vec<[u32; 3]>, Vec<u32>) = (strip.collect(), (0..n).collect());
        for (name, smooth) in [("flat", Smooth::Flat), ("tangent", Smooth::Tangent)] {
            let options = FillOptions { smooth, ..FillOptions::default() };
            let run = || fill_hole(&vertices, &strip, &hole, &options, Progress::NONE);
            assert!(run().is_ok_and(|fill| !fill.triangles.is_empty()));
            group.bench_function(BenchmarkId::new(name, n), |bench| bench.iter(run));
        }
    }
    group.finish();
}

criterion_group!(benches, cuts, fills);
criterion_main!(benches);
