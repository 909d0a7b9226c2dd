//! Fewer irregular vertices: flips that move them about until they meet, and collapses that take them out in pairs.

use crate::error::Result;
use crate::fill::even::local::{Local, quality};
use crate::fill::even::remesh::{Ground, relax};
use crate::progress::Progress;

/// Rounds.
const ROUNDS: usize = 14;

/// Collapses leave no edge longer than this, and take none longer than that, in wanted lengths.
const LONGEST: f64 = 1.8;
const TAKEN: f64 = 1.4;

/// Flips and collapses leave no triangle with a lower quality.
const LEAST: f64 = 0.5;

/// Moves connections towards the wanted numbers of triangles at vertices, at equal cost too, and keeps the best state found.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(super) fn regularize(local: &mut Local, ground: &Ground, progress: Progress<'_>) -> Result<()> {
    let mut best = (cost(local), local.clone());
    let mut state = 1u64;
    for round in 0..ROUNDS {
        progress.report(round as f64 / ROUNDS as f64)?;
        for e in local.edges() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            flip(local, e, state >> 63 == 1);
            collapse(local, e);
        }
        relax(local, ground);
        let own = cost(local);
        if own < best.0 {
            best = (own, local.clone());
        }
        if own == 0 {
            break;
        }
    }
    *local = best.1;
    local.compact();
    Ok(())
}

/// The sum of the squared differences from what is wanted.
fn cost(local: &Local) -> i64 {
    (0..local.positions.len() as u32).filter(|&v| !local.fan(v).is_empty()).map(|v| off(local, v, 0)).sum()
}

fn off(local: &Local, v: u32, more: i64) -> i64 {
    (local.fan(v).len() as i64 + more - local.wanted_at(v)).pow(2)
}

/// Flips an edge if that costs less, or, if `idle`, as much.
fn flip(local: &mut Local, e: [u32; 2], idle: bool) {
    let Some((old, new)) = local.flipped(e) else { return };
    let [c, a, d] = new[0];
    let b = new[1][1];
    let before = off(local, a, 0) + off(local, b, 0) + off(local, c, 0) + off(local, d, 0);
    let after = off(local, a, -1) + off(local, b, -1) + off(local, c, 1) + off(local, d, 1);
    if after > before || after == before && !(idle && before > 0) {
        return;
    }
    let corners = new.map(|t| t.map(|v| local.positions[v as usize]));
    let normal = |[a, b, c]: [glam::DVec3; 3]| (b - a).cross(c - a);
    let way = normal(local.corners(old[0])) + normal(local.corners(old[1]));
    let good = |t: &[glam::DVec3; 3]| quality(*t) > LEAST && normal(*t).dot(way) > 0.0;
    if corners.iter().all(good) {
        local.flip(old, new);
    }
}

/// Collapses an edge if that costs less.
fn collapse(local: &mut Local, e: [u32; 2]) {
    let beside = local.beside(e);
    if beside.len() != 2 || local.length(e) > TAKEN {
        return;
    }
    let apexes = [local.apex(beside[0], e), local.apex(beside[1], e)];
    let before =
        off(local, e[0], 0) + off(local, e[1], 0) + apexes.map(|v| off(local, v, 0)).iter().sum::<i64>();
    let after = apexes.map(|v| off(local, v, -1)).iter().sum::<i64>();
    for [gone, stays] in [[e[1], e[0]], e] {
        let merged = off(local, stays, local.fan(gone).len() as i64 - 4);
        if after + merged < before && (gone as usize) >= local.border && local.collapse(gone, stays, LONGEST)
        {
            return;
        }
    }
}
