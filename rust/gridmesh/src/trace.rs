//! The optimal boundary.

mod conflicts;
mod dive;
mod graph;
mod parameters;
mod prices;
mod proof;
mod queue;
mod search;
mod sides;

use crate::axial::Axial;
use crate::band::Band;
use crate::progress::Progress;
use crate::target::Target;

use dive::Contour;
use graph::{Graph, TURN};
use prices::Prices;
use search::{Search, Walk};

#[derive(Clone, Debug)]
pub struct TraceOptions {
    pub max_distance: f64,
    pub closeness: f64,
    pub proof_nodes: usize,
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self { max_distance: 1.5, closeness: 0.3, proof_nodes: 0 }
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
    NoPath { contour: usize, at: Axial },
    Conflict { kind: &'static str, at: Axial, n: usize },
    WrongRegion { contour: usize, at: Axial, turns: i32 },
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
    let mut contours = Vec::new();
    let mut walks = Vec::new();
    let mut prices = Vec::new();
    let t = std::time::Instant::now();
    let times = std::env::var("TIMES").is_ok();
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
        if times {
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
        contours.push(Contour { graph, potential });
        walks.push(walk);
        prices.push(none);
    }
    let root: u32 = walks.iter().map(|w| w.cost).sum();
    let root_turns: usize = turns(&walks);
    let roots = walks.clone();
    let dive = dive::dive(&contours, &mut walks, &mut prices, &mut search, progress)
        .map_err(|_| TraceFailure::Cancelled)?;
    if times {
        eprintln!("all {:.3} rounds {}", t.elapsed().as_secs_f64() * 1e3, dive.rounds);
    }
    if let Some(c) = dive.conflicts.first() {
        let w = &walks[c.a.contour as usize];
        let g = &contours[c.a.contour as usize].graph;
        return Err(TraceFailure::Conflict {
            kind: if c.chord.is_some() { "chord" } else { "repeat" },
            at: g.points[w.node(c.a.index as usize) as usize],
            n: dive.conflicts.len(),
        });
    }
    if !dive::turned_once(&walks) {
        return Err(TraceFailure::WrongRegion { contour: 0, at: Axial::default(), turns: 0 });
    }
    let mut cost = walks.iter().map(|w| w.cost).sum::<u32>();
    let mut bound = root;
    let mut optimal = dive.rounds == 0;
    if !optimal {
        let t = std::time::Instant::now();
        let proof = proof::prove(&contours, &roots, cost, options.proof_nodes, &mut search, progress)
            .map_err(|_| TraceFailure::Cancelled)?;
        if let Some(w) = proof.walks {
            walks = w;
        }
        let was = cost;
        cost = walks.iter().map(|w| w.cost).sum::<u32>();
        bound = proof.bound;
        optimal = proof.optimal;
        if times {
            eprintln!(
                "proof {:.3} from {was} to {cost} root {root} bound {bound}",
                t.elapsed().as_secs_f64() * 1e3
            );
        }
    }
    Ok(Traced {
        paths: walks
            .iter()
            .zip(&contours)
            .map(|(w, c)| Path {
                points: (0..w.len()).map(|i| c.graph.points[w.node(i) as usize]).collect(),
                parameters: parameters::parameters(&c.graph, w),
            })
            .collect(),
        cost: f64::from(cost) / f64::from(TURN),
        cost_bound: f64::from(bound) / f64::from(TURN),
        turns: turns(&walks),
        turns_bound: root_turns,
        optimal,
        max_distance_used: max_distance,
        rounds: dive.rounds,
    })
}

fn turns(walks: &[Walk]) -> usize {
    walks.iter().map(|w| (0..w.len()).map(|i| w.turn(i).unsigned_abs() as usize).sum::<usize>()).sum()
}
