//! Lattice patches around drawn curves, for the tests and benchmarks of the placement alone.
//!
//! The boundary is a shortest path through layers: layer `k` holds the lattice points near the
//! `k`-th of `n` points spaced evenly along the curve; cells where the path meets itself are priced
//! until it does not. Not fast and not the optimum, but every patch is chord-free.
#![allow(dead_code, clippy::unwrap_used, clippy::panic)]

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::f64::consts::TAU;

use glam::DVec2;
use gridmesh::lattice::axial::Axial;
use gridmesh::lattice::dir::Dir;
use gridmesh::path::placement::Lattice;
use gridmesh::relax::{Contour, Rim};

/// A patch ready to be placed, and the curve (lattice units) that it belongs to.
#[derive(Clone)]
pub struct Shape {
    pub curve: Vec<DVec2>,
    pub arc: Vec<f64>,
    pub triangles: Vec<[u32; 3]>,
    pub positions: Vec<DVec2>,
    pub rim: Rim,
    /// Interior angle of the drawn corner at pinned vertices.
    pub corner: Vec<Option<f64>>,
}

impl Shape {
    pub fn contour(&self) -> Contour<'_> {
        Contour { points: &self.curve, arc: &self.arc }
    }
}

/// Named analytic outlines, counter-clockwise.
pub fn outline(name: &str) -> Vec<DVec2> {
    let polar = |r: &dyn Fn(f64) -> f64| -> Vec<DVec2> {
        (0..720).map(|i| TAU * f64::from(i) / 720.0).map(|t| r(t) * DVec2::from_angle(t)).collect()
    };
    match name {
        "circle" => polar(&|_| 1.0),
        "trefoil" => polar(&|t| 1.0 + 0.3 * (3.0 * t).cos()),
        "ellipse" => polar(&|_| 1.0).into_iter().map(|p| p * DVec2::new(3.0, 1.0)).collect(),
        "star" => (0..10)
            .map(|i| DVec2::from_angle(TAU * f64::from(i) / 10.0) * if i % 2 == 0 { 1.0 } else { 0.45 })
            .collect(),
        "dumbbell" => (0..720)
            .map(|i| TAU * f64::from(i) / 720.0)
            .map(|t| {
                let (x, side) = (2.0 * t.cos(), t.sin().signum());
                let lobe = (1.0 - (x.abs() - 1.2).powi(2) / 0.64).max(0.0).sqrt() * 0.8;
                DVec2::new(x, side * lobe.max(0.08 * (t.sin().abs() * 40.0).min(1.0)))
            })
            .collect(),
        "crescent" => (0..720)
            .map(|i| f64::from(i) / 720.0)
            .map(|u| {
                if u < 0.5 {
                    DVec2::from_angle(0.6 + (TAU - 1.2) * 2.0 * u)
                } else {
                    let t = 0.6 + (TAU - 1.2) * 2.0 * (1.0 - u);
                    let away = (t - TAU / 2.0).abs() / (TAU / 2.0 - 0.6);
                    (0.6 + 0.4 * away * away) * DVec2::from_angle(t)
                }
            })
            .collect(),
        "square" => {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec2::new(x, y)).to_vec()
        }
        _ => panic!("no outline called {name}"),
    }
}

pub fn area(points: &[DVec2]) -> f64 {
    let n = points.len();
    (0..n).map(|i| 0.5 * points[i].perp_dot(points[(i + 1) % n])).sum()
}

pub fn cumulative(points: &[DVec2]) -> Vec<f64> {
    let mut arc = vec![0.0];
    for i in 0..points.len() {
        arc.push(arc[i] + points[i].distance(points[(i + 1) % points.len()]));
    }
    arc
}

/// Position and direction at arc length `s` (any real number).
fn at(points: &[DVec2], arc: &[f64], s: f64) -> DVec2 {
    let length = arc[points.len()];
    let s = s.rem_euclid(length);
    let i = arc.partition_point(|&a| a <= s).clamp(1, points.len()) - 1;
    let d = arc[i + 1] - arc[i];
    points[i].lerp(points[(i + 1) % points.len()], if d > 0.0 { (s - arc[i]) / d } else { 0.0 })
}

fn hex_norm(v: DVec2) -> f64 {
    let a = Lattice::axial_of(v);
    a.x.abs().max(a.y.abs()).max((a.x + a.y).abs())
}

/// The patch of about `triangles` triangles around `outline`; `None` if the path cannot be made
/// free of chords.
pub fn shape(outline: &[DVec2], triangles: usize, angle: f64, corners: bool) -> Option<Shape> {
    let mut points = outline.to_vec();
    points.dedup();
    while points.len() > 3 && points.first() == points.last() {
        points.pop();
    }
    if area(&points) < 0.0 {
        points.reverse();
    }
    let h = Lattice::edge_length_for(area(&points), triangles as f64);
    let lattice = Lattice { origin: points[0], angle, edge_length: h };
    let curve: Vec<DVec2> = points.iter().map(|&p| lattice.to_units(p)).collect();
    let arc = cumulative(&curve);
    let length = arc[curve.len()];

    // Targets: evenly spaced in the hexagonal norm along the smoothed curve.
    let m = (length / 0.25).ceil().max(24.0) as usize;
    let step = length / m as f64;
    let raw: Vec<DVec2> = (0..m).map(|i| at(&curve, &arc, i as f64 * step)).collect();
    let weights: Vec<f64> = (-6i32..=6).map(|j| (-0.5 * (f64::from(j) / 2.0).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let smooth: Vec<DVec2> = (0..m)
        .map(|i| {
            let sum: DVec2 =
                (0..13).map(|j| weights[j] * raw[(i + m + j - 6) % m]).fold(DVec2::ZERO, |a, b| a + b);
            sum / total
        })
        .collect();
    let mut hex = vec![0.0];
    for i in 0..m {
        hex.push(hex[i] + hex_norm(smooth[(i + 1) % m] - smooth[i]));
    }
    let n = hex[m].round() as usize;
    if n < 6 {
        return None;
    }
    let target_arc: Vec<f64> = (0..n)
        .map(|k| {
            let x = hex[m] * k as f64 / n as f64;
            let i = hex.partition_point(|&a| a <= x).clamp(1, m) - 1;
            step * (i as f64 + (x - hex[i]) / (hex[i + 1] - hex[i]).max(1e-12))
        })
        .collect();
    let targets: Vec<DVec2> = target_arc.iter().map(|&s| at(&raw, &cumulative_even(m, step), s)).collect();

    let mut prices: HashMap<Axial, f64> = HashMap::new();
    for round in 0..150 {
        let radius = 1.5 + 0.5 * f64::from(round / 50);
        let Some(path) = cheapest_loop(&targets, radius, &prices) else {
            continue;
        };
        let conflicts = conflicts(&path);
        if conflicts.is_empty() {
            return Some(assemble(curve, arc, &path, &target_arc, corners));
        }
        for c in conflicts {
            *prices.entry(c).or_default() += 0.25;
        }
    }
    None
}

fn cumulative_even(m: usize, step: f64) -> Vec<f64> {
    (0..=m).map(|i| i as f64 * step).collect()
}

fn cheapest_loop(targets: &[DVec2], radius: f64, prices: &HashMap<Axial, f64>) -> Option<Vec<Axial>> {
    let n = targets.len();
    let layers: Vec<Vec<(Axial, f64)>> = targets
        .iter()
        .map(|&t| {
            let c = Lattice::nearest(t);
            let mut near = Vec::new();
            for dq in -3..=3 {
                for dr in -3..=3 {
                    let p = Axial::new(c.q + dq, c.r + dr);
                    let d = Lattice::units(p).distance(t);
                    if d <= radius {
                        near.push((p, 0.3 * d * d + prices.get(&p).copied().unwrap_or(0.0)));
                    }
                }
            }
            near
        })
        .collect();
    // Two laps from a free start: the middle state is taken as the start of the second solve.
    let free = solve(&layers, 2 * n, None)?;
    let k = n / 2;
    let start = (free[k], free[k].step_to(free[k + 1])?);
    let rotated: Vec<_> = (0..n).map(|i| layers[(i + k) % n].clone()).collect();
    let mut path = solve(&rotated, n, Some(start))?;
    path.pop();
    path.rotate_right(k);
    Some(path)
}

/// States are (point, direction leaving it). With `start`, the path begins and ends in that state.
fn solve(layers: &[Vec<(Axial, f64)>], steps: usize, start: Option<(Axial, Dir)>) -> Option<Vec<Axial>> {
    let n = layers.len();
    let mut best: Vec<Vec<[(f64, u32); 6]>> = Vec::with_capacity(steps + 1);
    let first = layers[0]
        .iter()
        .map(|&(p, _)| {
            let mut row = [(f64::INFINITY, 0); 6];
            for d in Dir::ALL {
                if start.is_none_or(|s| s == (p, d)) {
                    row[d.index()].0 = 0.0;
                }
            }
            row
        })
        .collect();
    best.push(first);
    for k in 1..=steps {
        let (before, here) = (&layers[(k - 1) % n], &layers[k % n]);
        let index: BTreeMap<Axial, usize> = before.iter().enumerate().map(|(i, &(p, _))| (p, i)).collect();
        let rows = here
            .iter()
            .map(|&(p, cost)| {
                let mut row = [(f64::INFINITY, 0); 6];
                for enter in Dir::ALL {
                    let Some(&i) = index.get(&(p - enter)) else {
                        continue;
                    };
                    let so_far = best[k - 1][i][enter.index()].0;
                    for turn in -2..=1i32 {
                        let leave = enter.rotate(turn).index();
                        let c = so_far + cost + f64::from(turn.abs());
                        if c < row[leave].0 {
                            row[leave] = (c, (i * 6 + enter.index()) as u32);
                        }
                    }
                }
                row
            })
            .collect();
        best.push(rows);
    }
    let last = &layers[steps % n];
    let mut end: Option<(f64, usize, usize)> = None;
    for (i, &(p, _)) in last.iter().enumerate() {
        for d in Dir::ALL {
            let c = best[steps][i][d.index()].0;
            if c.is_finite() && start.is_none_or(|s| s == (p, d)) && end.is_none_or(|e| c < e.0) {
                end = Some((c, i, d.index()));
            }
        }
    }
    let (_, mut i, mut d) = end?;
    let mut path = vec![last[i].0];
    for k in (1..=steps).rev() {
        let from = best[k][i][d].1 as usize;
        (i, d) = (from / 6, from % 6);
        path.push(layers[(k - 1) % n][i].0);
    }
    path.reverse();
    Some(path)
}

/// Directions from `path[k]` that lead strictly into the patch.
fn inward(path: &[Axial], k: usize) -> Vec<Dir> {
    let n = path.len();
    let enter = path[(k + n - 1) % n].step_to(path[k]).unwrap();
    let leave = path[k].step_to(path[(k + 1) % n]).unwrap();
    let turn = enter.turn_to(leave);
    (1..3 - turn).map(|j| leave.rotate(j)).collect()
}

fn conflicts(path: &[Axial]) -> BTreeSet<Axial> {
    let mut seen = BTreeSet::new();
    let mut found: BTreeSet<Axial> = path.iter().copied().filter(|&p| !seen.insert(p)).collect();
    for k in 0..path.len() {
        for d in inward(path, k) {
            if seen.contains(&(path[k] + d)) {
                found.extend([path[k], path[k] + d]);
            }
        }
    }
    found
}

fn assemble(curve: Vec<DVec2>, arc: Vec<f64>, path: &[Axial], target: &[f64], corners: bool) -> Shape {
    let n = path.len();
    let mut number: BTreeMap<Axial, u32> = path.iter().enumerate().map(|(i, &p)| (p, i as u32)).collect();
    let mut order = path.to_vec();
    let mut todo = Vec::new();
    for k in 0..n {
        todo.extend(inward(path, k).into_iter().map(|d| path[k] + d));
    }
    while let Some(p) = todo.pop() {
        if let Entry::Vacant(entry) = number.entry(p) {
            entry.insert(order.len() as u32);
            order.push(p);
            todo.extend(p.neighbours());
        }
    }
    let mut triangles = BTreeSet::new();
    for &p in &order[n..] {
        for d in Dir::ALL {
            let t = [p, p + d, p + d.rotate(1)].map(|q| number[&q]);
            let first = (0..3).min_by_key(|&i| t[i]).unwrap();
            triangles.insert([t[first], t[(first + 1) % 3], t[(first + 2) % 3]]);
        }
    }
    let positions: Vec<DVec2> = order.iter().map(|&p| Lattice::units(p)).collect();
    let length = arc[curve.len()];

    // Projection onto the part of the curve near each vertex's own target, then order by pooling.
    let mut s: Vec<f64> = (0..n)
        .map(|k| {
            let (mut best, mut s) = (f64::INFINITY, target[k]);
            for j in -100..=100 {
                let x = target[k] + 0.025 * f64::from(j);
                let d = at(&curve, &arc, x).distance(positions[k]);
                if d < best {
                    (best, s) = (d, x);
                }
            }
            s
        })
        .collect();
    let gap = 0.2 * length / n as f64;
    pool(&mut s, gap, length);
    let mut pinned = vec![false; n];
    let mut corner = vec![None; n];
    if corners {
        for (c, angle) in drawn_corners(&curve, &arc) {
            let wrap = |x: f64| (x - c + 0.5 * length).rem_euclid(length) - 0.5 * length;
            let k = (0..n).min_by(|&a, &b| wrap(s[a]).abs().total_cmp(&wrap(s[b]).abs())).unwrap();
            let moved = s[k] - wrap(s[k]);
            let before = if k == 0 { s[n - 1] - length } else { s[k - 1] };
            let after = if k == n - 1 { s[0] + length } else { s[k + 1] };
            if !pinned[k] && moved > before + 0.5 * gap && moved < after - 0.5 * gap {
                s[k] = moved;
                pinned[k] = true;
                corner[k] = Some(angle);
            }
        }
    }
    Shape {
        curve,
        arc,
        triangles: triangles.into_iter().collect(),
        positions,
        rim: Rim { start: 0, held: vec![false; pinned.len()], s, pinned },
        corner,
    }
}

/// Least-squares increasing sequence with gaps of at least `gap` (pool adjacent violators).
fn pool(s: &mut [f64], gap: f64, length: f64) {
    let n = s.len();
    let mut blocks: Vec<(f64, usize)> = Vec::new();
    for (i, &x) in s.iter().enumerate() {
        blocks.push((x - gap * i as f64, 1));
        while blocks.len() > 1 && blocks[blocks.len() - 2].0 > blocks[blocks.len() - 1].0 {
            let (b, m) = blocks.pop().unwrap();
            let (a, l) = blocks.pop().unwrap();
            blocks.push(((a * l as f64 + b * m as f64) / (l + m) as f64, l + m));
        }
    }
    let mut i = 0;
    for (x, m) in blocks {
        for _ in 0..m {
            s[i] = x + gap * i as f64;
            i += 1;
        }
    }
    // Across the seam: push both ends apart.
    let (low, high) = (s[0], s[n - 1]);
    let excess = high - low - (length - gap);
    if excess > 0.0 {
        for (i, x) in s.iter_mut().enumerate() {
            let room = (low + 0.5 * excess + gap * i as f64, high - 0.5 * excess - gap * (n - 1 - i) as f64);
            *x = x.max(room.0).min(room.1);
        }
    }
}

/// Arc position and interior angle of corners that turn by more than 40 degrees.
fn drawn_corners(curve: &[DVec2], arc: &[f64]) -> Vec<(f64, f64)> {
    let n = curve.len();
    let turn = |i: usize| {
        let a = curve[i] - at(curve, arc, arc[i] - 0.6);
        let b = at(curve, arc, arc[i] + 0.6) - curve[i];
        a.perp_dot(b).atan2(a.dot(b))
    };
    let turns: Vec<f64> = (0..n).map(turn).collect();
    let length = arc[n];
    let mut found: Vec<(f64, f64)> = Vec::new();
    let mut order: Vec<usize> = (0..n).filter(|&i| turns[i].abs() > 0.7).collect();
    order.sort_by(|&a, &b| turns[b].abs().total_cmp(&turns[a].abs()).then(a.cmp(&b)));
    for i in order {
        let apart = |s: f64| {
            let d = (s - arc[i]).abs();
            d.min(length - d)
        };
        if found.iter().all(|&(s, _)| apart(s) > 1.5) {
            found.push((arc[i], TAU / 2.0 - turns[i]));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}
