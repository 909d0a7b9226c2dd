//! Plain Dijkstra from every start, without bounds or pruning: what the search must agree with.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::graph::{Graph, TURN};
use super::half::{Half, Memory};
use super::prices::Prices;
use super::pulse::Pulse;
use super::search::Search;
use super::straightest::fewest_turns;
use crate::lattice::axial::Axial;
use crate::lattice::dir::Dir;
use crate::lattice::grid::Triangular;
use crate::lattice::reflection::Reflection;
use crate::path::band::Band;
use crate::path::placement::Lattice;
use crate::path::target::Target;
use crate::progress::Progress;

const SHEETS: i64 = 4;

/// The least cost of a closed path once round the band, over four sheets of it.
fn brute_force(band: &Band, closeness: f64) -> Option<u32> {
    let n = band.nodes.len() as i64;
    let cost = |node: usize| {
        let distance = band.nodes[node].distance;
        (closeness * distance * distance * f64::from(TURN)).round() as u32
    };
    let state = |node: u32, sheet: i64, dir: usize| 6 * (i64::from(node) + sheet * n) + dir as i64;
    let mut best = None;
    for node in 0..band.nodes.len() {
        for dir in Dir::ALL {
            let behind = band.links(node, dir.opposite());
            if !behind.iter().any(|link| link.wrap == -1) {
                continue;
            }
            let start = state(node as u32, 1, dir.index());
            let goal = state(node as u32, 2, dir.index());
            let mut reached = vec![u32::MAX; (6 * n * SHEETS) as usize];
            let mut heap = BinaryHeap::from([Reverse((0, start))]);
            reached[start as usize] = 0;
            while let Some(Reverse((so_far, at))) = heap.pop() {
                if reached[at as usize] < so_far {
                    continue;
                }
                if at == goal {
                    best = Some(best.map_or(so_far, |best: u32| best.min(so_far)));
                    break;
                }
                let (place, dir) = (at / 6, Dir::new((at % 6) as i32));
                let (node, sheet) = ((place % n) as usize, place / n);
                for turn in -2..=1 {
                    let out = dir.rotate(turn);
                    for link in band.links(node, out) {
                        let next_sheet = sheet + i64::from(link.wrap);
                        if !(0..SHEETS).contains(&next_sheet) {
                            continue;
                        }
                        let next = state(link.node, next_sheet, out.index());
                        let through = so_far + turn.unsigned_abs() * TURN + cost(link.node as usize);
                        if through < reached[next as usize] {
                            reached[next as usize] = through;
                            heap.push(Reverse((through, next)));
                        }
                    }
                }
            }
        }
    }
    best
}

/// Points a quarter of an edge apart.
fn target(corners: &[DVec2], angle: f64) -> Target {
    let turn = DVec2::from_angle(angle);
    let mut points = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let pieces = (a.distance(b) / 0.25).ceil().max(1.0) as usize;
        points.extend((0..pieces).map(|k| turn.rotate(a.lerp(b, k as f64 / pieces as f64))));
    }
    Target { points, step: 0.25 }
}

fn polar(n: usize, radius: impl Fn(f64) -> f64) -> Vec<DVec2> {
    (0..n)
        .map(|i| {
            let t = std::f64::consts::TAU * i as f64 / n as f64;
            radius(t) * DVec2::from_angle(t)
        })
        .collect()
}

/// A circle roughened by random displacement of midpoints.
fn coast(seed: u64, radius: f64, roughness: f64) -> Vec<DVec2> {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    let mut points = polar(8, |_| radius);
    for _ in 0..6 {
        points = (0..points.len())
            .flat_map(|i| {
                let (a, b) = (points[i], points[(i + 1) % points.len()]);
                [a, 0.5 * (a + b) + roughness * random() * (b - a).perp()]
            })
            .collect();
    }
    points
}

fn shapes() -> Vec<(String, Vec<DVec2>)> {
    let xy = |coords: &[[f64; 2]]| coords.iter().map(|&c| DVec2::from_array(c)).collect();
    let mut shapes: Vec<(String, Vec<DVec2>)> = vec![
        ("disc".into(), polar(60, |_| 7.0)),
        ("flower".into(), polar(200, |t| 8.0 + 5.0 * (5.0 * t).cos())),
        ("square".into(), xy(&[[0.0, 0.0], [12.0, 0.0], [12.0, 12.0], [0.0, 12.0]])),
        (
            "inlet".into(),
            xy(&[
                [0.0, 0.0],
                [14.0, 0.0],
                [14.0, 6.0],
                [3.0, 6.2],
                [3.0, 6.7],
                [14.0, 6.9],
                [14.0, 13.0],
                [0.0, 13.0],
            ]),
        ),
        (
            "neck".into(),
            xy(&[
                [0.0, 0.0],
                [7.0, 0.0],
                [7.0, 3.8],
                [15.0, 3.8],
                [15.0, 0.0],
                [22.0, 0.0],
                [22.0, 8.0],
                [15.0, 8.0],
                [15.0, 4.1],
                [7.0, 4.1],
                [7.0, 8.0],
                [0.0, 8.0],
            ]),
        ),
        ("sliver".into(), xy(&[[0.0, 0.0], [30.0, 0.3], [0.0, 0.8]])),
    ];
    shapes.extend((1..12).map(|seed| (format!("coast {seed}"), coast(seed, 9.0, 0.9))));
    shapes.extend((1..4).map(|seed| (format!("rough {seed}"), coast(seed, 7.0, 1.6))));
    shapes
}

#[test]
fn the_search_finds_what_brute_force_finds() {
    let mut search = Search::new(Pulse::new(Progress::NONE));
    for (name, corners) in shapes() {
        for (angle, max_distance, closeness) in
            [(0.0, 1.5, 0.3), (0.4, 1.5, 0.3), (0.9, 1.0, 1.0), (0.2, 2.0, 0.05)]
        {
            let band = Band::new(&target(&corners, angle), max_distance);
            let graph = Graph::new(&band, closeness);
            let potential = search.potential(&graph);
            let prices = Prices::none(graph.n_nodes());
            let found = search.closed(&graph, &potential, &prices, u32::MAX);
            if let Some((walk, cost)) = &found {
                assert_eq!(walk.cost, *cost);
                assert_eq!(walk.base_cost(&graph), *cost);
            }
            assert_eq!(
                found.map(|(_, cost)| cost),
                brute_force(&band, closeness),
                "{name} at {angle}, distance {max_distance}, closeness {closeness}"
            );
        }
    }
}

#[test]
fn the_fewest_turns_are_those_of_the_cheapest_path_that_pays_for_turns_alone() {
    let mut search = Search::new(Pulse::new(Progress::NONE));
    let mut found = 0;
    for (name, corners) in shapes() {
        for (angle, max_distance) in [(0.0, 1.5), (0.4, 1.5), (0.9, 1.0), (0.2, 2.0)] {
            let mut graph = Graph::new(&Band::new(&target(&corners, angle), max_distance), 0.3);
            let fewest = fewest_turns(&graph, u32::MAX, &mut Pulse::new(Progress::NONE));
            graph.cost.fill(0);
            let potential = search.potential(&graph);
            let prices = Prices::none(graph.n_nodes());
            let cheapest = search.closed(&graph, &potential, &prices, u32::MAX);
            let Some((_, cost)) = cheapest else {
                assert_eq!(fewest, u32::MAX, "{name} at {angle}, distance {max_distance}");
                continue;
            };
            found += 1;
            assert_eq!(fewest * TURN, cost, "{name} at {angle}, distance {max_distance}");
            // A limit changes nothing.
            assert_eq!(fewest_turns(&graph, fewest + 3, &mut Pulse::new(Progress::NONE)), fewest);
            assert_eq!(fewest_turns(&graph, fewest, &mut Pulse::new(Progress::NONE)), fewest);
        }
    }
    assert!(found > 20);
}

#[test]
fn windows_give_the_same_as_the_whole() {
    let mut search = Search::new(Pulse::new(Progress::NONE));
    for (name, corners) in shapes() {
        let band = Band::new(&target(&corners, 0.3), 1.5);
        let graph = Graph::new(&band, 0.3);
        let potential = search.potential(&graph);
        let prices = Prices::none(graph.n_nodes());
        let Some((walk, _)) = search.closed(&graph, &potential, &prices, u32::MAX) else {
            continue;
        };
        // A part of a cheapest path is a cheapest path; round the end too.
        let n = walk.len();
        for from in (0..n).step_by(7) {
            let to = from + 12.min(n - 1);
            let part = (&walk, from, to);
            let found = search.between(&graph, &potential, &prices, part, u32::MAX);
            assert!(found.is_some(), "{name}: no way from {from} to {to}");
            let (steps, cost) = found.unwrap_or_default();
            let mut other = walk.clone();
            other.splice(from, to, &steps);
            assert_eq!(other.base_cost(&graph), walk.cost, "{name} {from} {to} {cost}");
        }
    }
}

/// The least cost of a symmetric closed path: half of it, through the band of the whole curve, on three
/// sheets, from every way to begin on the axis.
fn brute_force_symmetric(
    target: &Target,
    axis: Reflection,
    max_distance: f64,
    closeness: f64,
) -> Option<u32> {
    let band = Band::new(target, max_distance);
    let (n, samples) = (band.nodes.len() as i64, band.n_samples() as i64);
    let cost = |node: usize| {
        let distance = band.nodes[node].distance;
        (closeness * distance * distance * f64::from(TURN)).round() as u32
    };
    let runs_through = |node: usize, sheet: i64, segment: i64| {
        let run = (i64::from(band.nodes[node].first), i64::from(band.nodes[node].last));
        (run.0 + sheet * samples..=run.1 + sheet * samples).contains(&segment)
    };
    let meets = |node: usize, sheet: i64, sample: i64| {
        runs_through(node, sheet, sample - 1) && runs_through(node, sheet, sample)
    };
    let point = |node: usize| band.nodes[node].point;
    let passes = |enter: Dir, leave: Dir| Some(enter.turn_to(leave)).filter(|turn| (-2..=1).contains(turn));
    let onward = |dir: Dir| axis.dir(dir).opposite();
    // Whether the edge from a point to its image lies inside the patch.
    let is_chord = |p: Axial, leave: Dir, turn: i32| {
        (1..=2 - turn).any(|k| axis.side(p) == 1 && p + leave.rotate(k) == axis.point(p))
    };
    let state = |node: usize, sheet: i64, dir: Dir| 6 * (node as i64 + (sheet + 1) * n) + dir.index() as i64;
    let mut reached = vec![u32::MAX; 18 * n as usize];
    let mut heap = BinaryHeap::new();
    for node in 0..n as usize {
        for sheet in -1..=1 {
            if !meets(node, sheet, 0) {
                continue;
            }
            if axis.side(point(node)) == 1 {
                for dir in Dir::ALL.into_iter().filter(|&dir| point(node) - dir == axis.point(point(node))) {
                    heap.push(Reverse((2 * cost(node), state(node, sheet, dir))));
                }
            }
            if axis.side(point(node)) != 0 {
                continue;
            }
            for leave in Dir::ALL {
                let Some(turn) = passes(onward(leave), leave) else { continue };
                for link in band.links(node, leave) {
                    let (to, on) = (link.node as usize, sheet + i64::from(link.wrap));
                    if axis.side(point(to)) > 0 && (-1..=1).contains(&on) {
                        let cost = cost(node) + turn.unsigned_abs() * TURN + 2 * cost(to);
                        heap.push(Reverse((cost, state(to, on, leave))));
                    }
                }
            }
        }
    }
    let mut best: Option<u32> = None;
    while let Some(Reverse((so_far, at))) = heap.pop() {
        if reached[at as usize] <= so_far {
            continue;
        }
        reached[at as usize] = so_far;
        let (place, enter) = (at / 6, Dir::new((at % 6) as i32));
        let (node, sheet) = ((place % n) as usize, place / n - 1);
        for leave in Dir::ALL {
            let Some(turn) = passes(enter, leave) else { continue };
            if is_chord(point(node), leave, turn) {
                continue;
            }
            let through = so_far + 2 * turn.unsigned_abs() * TURN;
            let mut finish = |cost: u32| best = Some(best.map_or(cost, |best| best.min(cost)));
            let crosses = axis.side(point(node)) == 1 && point(node) + leave == axis.point(point(node));
            if crosses && meets(node, sheet, samples / 2) {
                finish(through);
            }
            for link in band.links(node, leave) {
                let (to, on) = (link.node as usize, sheet + i64::from(link.wrap));
                if !(-1..=1).contains(&on) {
                    continue;
                }
                if axis.side(point(to)) > 0 {
                    heap.push(Reverse((through + 2 * cost(to), state(to, on, leave))));
                } else if axis.side(point(to)) == 0
                    && meets(to, on, samples / 2)
                    && let Some(turn) = passes(leave, onward(leave))
                {
                    finish(through + cost(to) + turn.unsigned_abs() * TURN);
                }
            }
        }
    }
    best
}

/// A symmetric target from the half of it on the positive side of an axis.
fn symmetric_target(half: &[DVec2], axis: Reflection) -> Target {
    let mut points = Vec::new();
    for pair in half.windows(2) {
        let pieces = (pair[0].distance(pair[1]) / 0.3).ceil().max(1.0) as usize;
        points.extend((0..pieces).map(|k| pair[0].lerp(pair[1], k as f64 / pieces as f64)));
    }
    points.extend(half.last());
    let inner = 1..points.len() - 1;
    let images: Vec<DVec2> = points[inner].iter().rev().map(|&p| Lattice::reflected(axis, p)).collect();
    points.extend(images);
    Target { points, step: 0.3 }
}

/// Halves of curves left of the axis, which runs upwards (or east), begun at its lower end.
fn halves() -> Vec<(String, Vec<DVec2>)> {
    let mut found: Vec<(String, Vec<DVec2>)> = Vec::new();
    for seed in 1..25u64 {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let phase = [random(), random()].map(|x| std::f64::consts::TAU * x);
        let shift = random();
        let size = 4.0 + 3.0 * random();
        let half = (0..=24)
            .map(|i| {
                let t = std::f64::consts::PI * f64::from(i) / 24.0;
                let radius =
                    size * (1.0 + 0.25 * (3.0 * t + phase[0]).cos() + 0.25 * (5.0 * t + phase[1]).cos());
                radius * DVec2::new(t.sin(), -t.cos()) + DVec2::new(0.0, shift)
            })
            .map(|p| if p.x.abs() < 1e-9 { DVec2::new(0.0, p.y) } else { p })
            .collect();
        found.push((format!("blob {seed}"), half));
    }
    found
}

#[test]
fn the_symmetric_search_finds_what_brute_force_finds() {
    let mut memory = Memory::new(Pulse::new(Progress::NONE));
    for (name, half) in halves() {
        for axis in [Reflection::Along, Reflection::Across] {
            // Counter-clockwise: from the lower end along the right; along the axis: from the right end.
            let half: Vec<DVec2> = match axis {
                Reflection::Across => half.clone(),
                Reflection::Along => half.iter().map(|p| DVec2::new(-p.y, p.x)).collect(),
            };
            let target = symmetric_target(&half, axis);
            for (max_distance, closeness) in [(1.5, 0.3), (1.0, 1.0), (2.0, 0.05)] {
                let (search, graph) = Half::<Triangular>::new(
                    &target,
                    [false; 2],
                    axis,
                    (max_distance, closeness),
                    &mut memory,
                );
                let walk = search.cheapest(&graph, &Prices::none(graph.n_nodes()), &mut memory);
                let found = walk.as_ref().map(|walk| walk.cost);
                let expected = brute_force_symmetric(&target, axis, max_distance, closeness);
                assert_eq!(found, expected, "{name} {axis:?} {max_distance} {closeness}");
                let Some(walk) = walk else { continue };
                let points: Vec<Axial> = walk.points(&graph).collect();
                for (i, &p) in points.iter().enumerate() {
                    assert_eq!(p.distance(points[(i + 1) % points.len()]), 1);
                    assert!(points.contains(&axis.point(p)));
                }
                let turns: i32 = (0..walk.len()).map(|i| walk.turn(i)).sum();
                assert_eq!(turns, 6, "{name} {axis:?}");
                // No boundary costs less without the symmetry.
                let closed = Graph::new(&Band::new(&target, max_distance), closeness);
                let mut search = Search::new(Pulse::new(Progress::NONE));
                let potential = search.potential(&closed);
                let free = search.closed(&closed, &potential, &Prices::none(closed.n_nodes()), u32::MAX);
                assert!(free.is_some_and(|(_, cost)| cost <= walk.cost), "{name} {axis:?}");
            }
        }
    }
}
