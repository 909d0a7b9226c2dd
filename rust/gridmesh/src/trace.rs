//! The optimal boundary.

mod conflicts;
mod graph;
mod parameters;
mod prices;
mod queue;
mod search;

use crate::axial::Axial;
use crate::band::Band;
use crate::dir::Dir;
use crate::progress::Progress;
use crate::target::Target;

use conflicts::{Conflict, Finder};
use graph::{Graph, TURN};
use prices::Prices;
use search::{Potential, Search, Walk};

#[derive(Clone, Debug)]
pub struct TraceOptions {
    pub max_distance: f64,
    pub closeness: f64,
    pub proof_nodes: usize,
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self {
            max_distance: 1.5,
            closeness: 0.3,
            proof_nodes: 0,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    pub points: Vec<Axial>,
    pub parameters: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    pub paths: Vec<Path>,
    pub cost: f64,
    pub cost_bound: f64,
    pub turns: usize,
    pub turns_bound: usize,
    pub optimal: bool,
    pub max_distance_used: f64,
    pub rounds: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub enum TraceFailure {
    Cancelled,
    NoPath {
        contour: usize,
        at: Axial,
    },
    Conflict {
        kind: &'static str,
        at: Axial,
        n: usize,
    },
    WrongRegion {
        contour: usize,
        at: Axial,
        turns: i32,
    },
}

struct Contour {
    graph_index: usize,
}

pub fn trace(
    targets: &[Target],
    options: &TraceOptions,
    progress: Progress<'_>,
) -> Result<Traced, TraceFailure> {
    match attempt(targets, options, options.max_distance, progress) {
        Ok(t) => Ok(t),
        Err(TraceFailure::Cancelled) => Err(TraceFailure::Cancelled),
        Err(e) if options.max_distance >= 2.0 => Err(e),
        Err(_) => attempt(targets, options, 2.0, progress),
    }
}

fn attempt(
    targets: &[Target],
    options: &TraceOptions,
    max_distance: f64,
    progress: Progress<'_>,
) -> Result<Traced, TraceFailure> {
    let mut search = Search::new();
    let mut graphs = Vec::new();
    let mut potentials = Vec::new();
    let mut walks = Vec::new();
    let mut prices = Vec::new();
    let t = std::time::Instant::now();
    for (c, target) in targets.iter().enumerate() {
        let band = Band::new(target, max_distance);
        let t1 = t.elapsed().as_secs_f64();
        let graph = Graph::new(&band, options.closeness);
        let t2 = t.elapsed().as_secs_f64();
        let potential = search.potential(&graph);
        let t3 = t.elapsed().as_secs_f64();
        let none = Prices::none(graph.n_nodes());
        let k = search.taken;
        let Some((walk, _)) = search.closed(&graph, &potential, &none, u32::MAX) else {
            return Err(TraceFailure::NoPath {
                contour: c,
                at: crate::lattice::Lattice::nearest(target.points[0]),
            });
        };
        let t4 = t.elapsed().as_secs_f64();
        if std::env::var("TIMES").is_ok() {
            eprintln!(
                "B {} nodes {} band {:.3} graph {:.3} pi {:.3} ({}) astar {:.3} ({}) starts {}",
                walk.len(),
                graph.n_nodes(),
                t1 * 1e3,
                (t2 - t1) * 1e3,
                (t3 - t2) * 1e3,
                k,
                (t4 - t3) * 1e3,
                search.taken - k,
                potential.starts.len()
            );
        }
        graphs.push(graph);
        potentials.push(potential);
        walks.push(walk);
        prices.push(none);
    }
    let root: u32 = walks.iter().map(|w| w.cost).sum();
    let root_turns: usize = turns(&walks);
    let mut finder = Finder::default();
    let mut rounds = 0;
    let mut conflicts = finder.find(&graphs, &walks);
    let clean = conflicts.is_empty();
    while !conflicts.is_empty() && rounds < 100 {
        rounds += 1;
        progress
            .report(rounds as f64 / 100.0)
            .map_err(|_| TraceFailure::Cancelled)?;
        let mut touched = vec![false; walks.len()];
        for c in &conflicts {
            price(&graphs, &walks, &mut prices, c, TURN / 4);
            touched[c.a.contour as usize] = true;
            touched[c.b.contour as usize] = true;
        }
        for i in 0..walks.len() {
            if touched[i] {
                let (w, _) = search
                    .closed(&graphs[i], &potentials[i], &prices[i], u32::MAX)
                    .unwrap();
                walks[i] = w;
            }
        }
        conflicts = finder.find(&graphs, &walks);
    }
    if let Some(c) = conflicts.first() {
        let w = &walks[c.a.contour as usize];
        let g = &graphs[c.a.contour as usize];
        return Err(TraceFailure::Conflict {
            kind: if c.chord.is_some() { "chord" } else { "repeat" },
            at: g.points[w.node(g, c.a.index as usize) as usize],
            n: conflicts.len(),
        });
    }
    for (c, w) in walks.iter().enumerate() {
        let sum: i32 = (0..w.len()).map(|i| w.turn(i)).sum();
        if sum != if c == 0 { 6 } else { -6 } {
            return Err(TraceFailure::WrongRegion {
                contour: c,
                at: graphs[c].points[w.node(&graphs[c], 0) as usize],
                turns: sum,
            });
        }
    }
    let cost = walks.iter().map(|w| w.cost).sum::<u32>();
    Ok(Traced {
        paths: walks
            .iter()
            .zip(&graphs)
            .map(|(w, g)| Path {
                points: (0..w.len())
                    .map(|i| g.points[w.node(g, i) as usize])
                    .collect(),
                parameters: parameters::parameters(g, w),
            })
            .collect(),
        cost: f64::from(cost) / f64::from(TURN),
        cost_bound: f64::from(root) / f64::from(TURN),
        turns: turns(&walks),
        turns_bound: root_turns,
        optimal: clean,
        max_distance_used: max_distance,
        rounds,
    })
}

fn turns(walks: &[Walk]) -> usize {
    walks
        .iter()
        .map(|w| {
            (0..w.len())
                .map(|i| w.turn(i).unsigned_abs() as usize)
                .sum::<usize>()
        })
        .sum()
}

fn price(graphs: &[Graph], walks: &[Walk], prices: &mut [Prices], c: &Conflict, amount: u32) {
    let node = |v: conflicts::Vertex| {
        walks[v.contour as usize].node(&graphs[v.contour as usize], v.index as usize)
    };
    let (a, b) = (node(c.a), node(c.b));
    match c.chord {
        Some(dir) => {
            prices[c.a.contour as usize].raise_inside(a, dir, amount);
            prices[c.b.contour as usize].raise_inside(b, (dir + 3) % 6, amount);
        }
        None => {
            prices[c.a.contour as usize].raise_visit(a, amount);
            prices[c.b.contour as usize].raise_visit(b, amount);
        }
    }
}
