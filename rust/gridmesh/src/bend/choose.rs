//! Which bends are worth a lattice: start angles and strengths, judged before anything is traced.

use std::sync::Arc;

use rayon::prelude::*;

use super::conformal::{Operators, Rotation, Solver, keep_area};
use super::image::{BentContours, Image};
use super::mirrored::Mirrored;
use super::tangents::Tangents;
use super::width::Wish;
use super::{Bent, Ground};
use crate::error::Result;
use crate::progress::Progress;

/// Price of a change of direction against a squared radian along one edge, while directions are sought.
const TURN: f64 = 1.0;
/// A squared radian along one edge costs so many turns in the end.
const MISFIT: f64 = 2.0;
/// Start angles tried between two lattice directions.
const STARTS: usize = 8;
/// Pull of the directions, per edge length of contour: how hard the drawing is bent.
const STRENGTH: f64 = 3.0;
/// Weight of the wish for more triangles in narrow parts.
const SIZE: f64 = 0.1;
/// The same where more triangles are asked for.
const ASKED: f64 = 4.0;
/// Rounds of conjugate gradients for the one and for the other.
const ROUNDS: [usize; 2] = [3, 12];
/// Shares of a bend that are tried while the bent drawing overlaps itself.
const SHARES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];
/// Two rotations that differ by less than this everywhere, in radians, are one.
const SAME: f64 = 0.06;

/// The most promising bends of a drawing, at most `count`, best first.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled), [`Error::Solver`](crate::error::Error::Solver).
pub(crate) fn candidates(
    ground: &Arc<Ground>,
    bend: f64,
    count: usize,
    progress: Progress<'_>,
) -> Result<Vec<Bent>> {
    let tangents: Vec<Tangents> =
        ground.lines.iter().map(|line| Tangents::new(&line.points, &line.arcs)).collect();
    let operators = Operators::new(&ground.carrier, &tangents, ground.shape)?;
    let solver = operators.solver()?;
    let beta = STRENGTH * bend;
    let robin = operators.robin(beta)?;
    progress.report(0.1)?;
    // On a mirror axis the lattice can only lie in two ways.
    let n = if ground.is_symmetric { 2 } else { STARTS };
    let step = ground.shape.step();
    let starts: Vec<f64> = (0..n).map(|k| step * k as f64 / n as f64).collect();
    let mut found = operators.rotations(&starts, beta, &robin, TURN)?;
    let cost = |r: &Rotation| r.turns as f64 + MISFIT * r.misfit;
    found.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let mut chosen: Vec<Rotation> = Vec::new();
    for candidate in found {
        if chosen.len() == count {
            break;
        }
        if chosen.iter().all(|other| !is_same(&candidate.v, &other.v, step)) {
            chosen.push(candidate);
        }
    }
    progress.report(0.2)?;
    let is_asked = ground.asks_width || ground.densities.is_some();
    let (gamma, rounds) = if is_asked { (ASKED, ROUNDS[1]) } else { (SIZE, ROUNDS[0]) };
    let wish = match &ground.densities {
        Some(densities) => Wish::of_densities(densities),
        None => Wish::of_narrowness(&ground.carrier),
    };
    let mirrored = ground.is_symmetric.then(|| Mirrored::new(&ground.carrier));
    let bent: Vec<Result<Option<Bent>>> = chosen
        .par_iter()
        .map(|rotation| {
            let v = solver.sized(rotation, (beta, &robin), (gamma, rounds), &wish)?;
            bent(ground, &solver, v, mirrored.as_ref())
        })
        .collect();
    bent.into_iter().filter_map(Result::transpose).collect()
}

/// The drawing bent by a rotation, or by a part of it where it would overlap itself.
fn bent(
    ground: &Arc<Ground>,
    solver: &Solver<'_>,
    mut v: Vec<f64>,
    mirrored: Option<&Mirrored>,
) -> Result<Option<Bent>> {
    let mut turn = v.iter().sum::<f64>() / v.len() as f64;
    if let Some(mirrored) = mirrored {
        let Some(allowed) = Mirrored::turn(&v, 0.5 * ground.shape.step()) else { return Ok(None) };
        turn = allowed;
        v = mirrored.antisymmetric(&v, turn);
    }
    let u = solver.scale(&v)?;
    for share in SHARES {
        let v: Vec<f64> = v.iter().map(|v| turn + share * (v - turn)).collect();
        let mut u: Vec<f64> = u.iter().map(|u| share * u).collect();
        keep_area(&ground.carrier, &mut u);
        let mut positions = solver.map(&ground.carrier, &u, &v)?;
        if let Some(mirrored) = mirrored {
            positions = mirrored.symmetric(&positions, turn);
        }
        let is_asked = ground.asks_width || ground.densities.is_some();
        let price = if is_asked { 0.0 } else { price_of_size(ground, &u) };
        let image = Image { positions, u, v };
        if !image.is_upright(&ground.carrier) {
            continue;
        }
        if let Some(drawing) = BentContours::new(&ground.carrier, &image, &ground.lines) {
            return Ok(Some(Bent { ground: ground.clone(), image, drawing, share, turn, price }));
        }
    }
    Ok(None)
}

/// True if two rotations differ by one multiple of a lattice direction's `step` and little else.
fn is_same(a: &[f64], b: &[f64], step: f64) -> bool {
    let shift = ((a[0] - b[0]) / step).round() * step;
    a.iter().zip(b).all(|(a, b)| (a - b - shift).abs() < SAME)
}

/// What unequal sizes cost, in turns: nothing while the longest edges are less than half longer than
/// most, nor a few of them up to twice as long.
fn price_of_size(ground: &Ground, u: &[f64]) -> f64 {
    const FREE: f64 = 0.45;
    const EACH: f64 = 30.0;
    const RARE: f64 = 0.8;
    const LONGEST: f64 = 5.0;
    // Log edge lengths, each counted by the lattice edges that have it.
    let mut sizes: Vec<(f64, f64)> = ground
        .carrier
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| ground.carrier.vertices[i as usize]);
            let mean = t.iter().map(|&i| u[i as usize]).sum::<f64>() / 3.0;
            (-mean, (b - a).perp_dot(c - a) * (2.0 * mean).exp())
        })
        .collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = sizes.iter().map(|s| s.1).sum();
    let quantile = |share: f64| {
        let mut sum = 0.0;
        sizes
            .iter()
            .find(|s| {
                sum += s.1;
                sum >= share * whole
            })
            .map_or(0.0, |s| s.0)
    };
    let middle = quantile(0.5);
    let longest = sizes.last().map_or(0.0, |s| s.0);
    EACH * (quantile(0.99) - middle - FREE).max(0.0).powi(2) + LONGEST * (longest - middle - RARE).max(0.0)
}
