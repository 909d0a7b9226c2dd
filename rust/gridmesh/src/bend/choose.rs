//! Which bends are worth a lattice: start angles and strengths, judged before anything is traced.

use std::sync::Arc;

use rayon::prelude::*;

use super::conformal::{Operators, Rotation, Solver, keep_area};
use super::image::{BentContours, Image};
use super::mirrored::Mirrored;
use super::tangents::Tangents;
use super::width::narrowest;
use super::{Bent, Ground};
use crate::error::Result;
use crate::options::CellShape;
use crate::progress::Progress;

/// Price of a change of direction against a squared radian along one edge, while directions are sought.
const TURN: f64 = 1.0;
/// A squared radian along one edge costs so many turns in the end.
const MISFIT: f64 = 2.0;
/// Start angles tried between two lattice directions.
const STARTS: usize = 8;
/// Pull of the directions, per edge length of contour: how hard the drawing is bent.
const STRENGTH: f64 = 3.0;
/// The same for quads, and the price of a change of direction while they are sought, in contours of so many edges and fewer;
/// in longer ones it grows with them, as misfits do, or there would be more changes the finer the mesh is. Twice the
/// strength leaves more hand-drawn outlines to straight lattices at 1000 quads, half of it more changes at 10,000.
const STRENGTH_OF_QUADS: f64 = 4.2;
const TURN_OF_QUADS: f64 = 3.0;
pub(crate) const EDGES_OF_QUADS: f64 = 200.0;
/// So many times the bends that are asked for are sized, and judged again.
const SIZED: usize = 2;
/// Log scales below which the outline should not be, relative to a straight lattice: where it is narrowest, and elsewhere.
const NARROW_FLOOR: f64 = 0.2;
const FLOOR: f64 = -0.4;
/// Weight of what is below those; rounds, and steps of conjugate gradients in each.
const HELD: (f64, usize, usize) = (0.7, 2, 3);
/// Weight of the sizes that are asked for, and steps for these.
const ASKED: (f64, usize) = (4.0, 12);
/// The same of the wish for finer narrow parts on a lattice of squares: with a third of it the bend leaves limbs so coarse that
/// they lose their corners.
const QUAD_SIZE: (f64, usize) = (0.3, 3);
/// The largest log of the edge length that 99 % of the edges do not reach, over the median.
const UNEVEN: f64 = 0.65;
/// Price of narrow parts that are coarser than on a straight lattice, in turns for a factor of e.
const COARSE: f64 = 8.0;
/// Shares of a bend that are tried while the bent drawing overlaps itself.
const SHARES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];
/// Two rotations that differ by less than this everywhere, in radians, are one.
const SAME: f64 = 0.06;

/// Hands over the most promising bends of a drawing, at most `count`, best first, each with what the next one is
/// expected to cost in turns, until one is enough.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled), [`Error::Solver`](crate::error::Error::Solver), and those
/// of `is_enough`.
pub(crate) fn candidates(
    ground: &Arc<Ground>,
    bend: f64,
    count: usize,
    progress: Progress<'_>,
    mut is_enough: impl FnMut(Bent, f64) -> Result<bool>,
) -> Result<()> {
    let tangents: Vec<Tangents> =
        ground.lines.iter().map(|line| Tangents::new(&line.points, &line.arcs)).collect();
    let operators = Operators::new(&ground.carrier, &ground.widths, &tangents, ground.shape, progress)?;
    // What is solved after this is reported as one part.
    let solver = operators.solver(progress.part(0.1, 0.2))?;
    let (strength, turn) = match ground.shape {
        CellShape::Triangle => (STRENGTH, TURN),
        CellShape::Quad => {
            let length: f64 = ground.carrier.lengths().iter().sum();
            (STRENGTH_OF_QUADS, TURN_OF_QUADS * (length / EDGES_OF_QUADS).max(1.0))
        }
    };
    let beta = strength * bend;
    let robin = operators.robin(beta, progress)?;
    progress.report(0.1)?;
    // On a mirror axis the lattice can only lie in two ways.
    let n = if ground.is_symmetric { 2 } else { STARTS };
    let step = ground.shape.step();
    let starts: Vec<f64> = (0..n).map(|k| step * k as f64 / n as f64).collect();
    let mut found = operators.rotations(&starts, (beta, &robin), turn, progress.part(0.1, 0.2))?;
    found.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let wide = if ground.shape == CellShape::Quad { STARTS } else { SIZED * count };
    let mut chosen: Vec<Rotation> = Vec::new();
    for candidate in found {
        if chosen.len() == wide {
            break;
        }
        if chosen.iter().all(|other| !is_same(&candidate.v, &other.v, step)) {
            chosen.push(candidate);
        }
    }
    progress.report(0.2)?;
    let wish = ground.wish();
    let wished = if ground.is_asked() { ASKED } else { QUAD_SIZE };
    let narrowest = narrowest(&ground.carrier, &ground.widths);
    let floor = |&narrow: &bool| if narrow { NARROW_FLOOR } else { FLOOR };
    let floors: Vec<f64> = narrowest.iter().map(floor).collect();
    let sized = |rotation: &Rotation| -> Result<Rotation> {
        let v = match &wish {
            Some(wish) => solver.sized(rotation, (beta, &robin), wished, wish)?,
            None => solver.floored(&ground.carrier, rotation, (beta, &robin), HELD, &floors)?,
        };
        Ok(operators.judged(v, turn))
    };
    let mirrored = ground.is_symmetric.then(|| Mirrored::new(&ground.carrier));
    let made = |v: Vec<f64>| bent(ground, &solver, v, mirrored.as_ref(), &narrowest);
    let straightened = |v: &[f64]| -> Result<Option<Bent>> {
        let straight = solver.straightened(&ground.carrier, v, (beta, &robin), turn, ground.shape)?;
        Ok(match made(straight)? {
            Some(bent) if bent.share == 1.0 => Some(bent),
            // Better bent as a whole than straight and bent less.
            less => most(made(v.to_vec())?, less),
        })
    };
    if ground.shape == CellShape::Quad {
        let priced = |rotation: &Rotation| -> Result<Option<(f64, Bent)>> {
            let found = straightened(&sized(rotation)?.v)?;
            let cost_of = |bent: &Bent| cost(&operators.judged(bent.image.v.clone(), turn)) + bent.price;
            Ok(found.map(|bent| (cost_of(&bent), bent)))
        };
        for bent in cheapest(&chosen, count, priced)? {
            if is_enough(bent, f64::INFINITY)? {
                break;
            }
        }
        return Ok(());
    }
    let expected: Vec<Result<(f64, Rotation)>> = chosen
        .par_iter()
        .map(|rotation| {
            let rotation = sized(rotation)?;
            let mut u = solver.scale(&rotation.v)?;
            keep_area(&ground.carrier, &mut u);
            let price = if ground.is_asked() { 0.0 } else { price_of_size(ground, &u, &narrowest) };
            Ok((cost(&rotation) + price, rotation))
        })
        .collect();
    let mut expected = expected.into_iter().collect::<Result<Vec<(f64, Rotation)>>>()?;
    expected.sort_by(|a, b| a.0.total_cmp(&b.0));
    expected.truncate(count);
    for (k, (_, rotation)) in expected.iter().enumerate() {
        let next = expected.get(k + 1).map_or(f64::INFINITY, |(cost, _)| *cost);
        if let Some(bent) = straightened(&rotation.v)?
            && is_enough(bent, next)?
        {
            break;
        }
    }
    Ok(())
}

/// What a rotation is expected to cost, in turns, its sizes apart.
fn cost(rotation: &Rotation) -> f64 {
    rotation.turns as f64 + MISFIT * rotation.misfit
}

/// The bends that cost least, at most `count`, best first. Rotations are bent in the order of their costs, `count` at a time,
/// until so many bends cost no more than any of the rest can: where the drawing would overlap itself another
/// rotation may not have to be scaled down.
fn cheapest(
    chosen: &[Rotation],
    count: usize,
    bent: impl Fn(&Rotation) -> Result<Option<(f64, Bent)>> + Sync,
) -> Result<Vec<Bent>> {
    let mut best: Vec<(f64, Bent)> = Vec::new();
    for some in chosen.chunks(count) {
        if best.len() == count && best.iter().all(|(price, _)| *price <= cost(&some[0])) {
            break;
        }
        let found: Vec<Result<Option<(f64, Bent)>>> = some.par_iter().map(&bent).collect();
        for found in found {
            best.extend(found?);
        }
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        best.truncate(count);
    }
    Ok(best.into_iter().map(|(_, bent)| bent).collect())
}

/// The one that is bent more, the first of equals.
fn most(a: Option<Bent>, b: Option<Bent>) -> Option<Bent> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.share > a.share { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// The drawing bent by a rotation, or by a part of it where it would overlap itself.
fn bent(
    ground: &Arc<Ground>,
    solver: &Solver<'_>,
    mut v: Vec<f64>,
    mirrored: Option<&Mirrored>,
    narrowest: &[bool],
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
        let is_asked = ground.is_asked();
        let price = if is_asked { 0.0 } else { price_of_size(ground, &u, narrowest) };
        let image = Image { positions, u, v };
        let is_free = is_asked || ground.shape == CellShape::Quad;
        let is_uneven = !is_free && largest_over_median(ground, &image.u) > UNEVEN;
        if is_uneven && share > SHARES[SHARES.len() - 1] || !image.is_upright(&ground.carrier) {
            continue;
        }
        if let Some(drawing) = BentContours::new(&ground.carrier, &image, &ground.lines) {
            return Ok(Some(Bent {
                ground: ground.clone(),
                image: Arc::new(image),
                drawing,
                share,
                turn,
                price,
                is_followed: false,
            }));
        }
    }
    Ok(None)
}

/// True if two rotations differ by one multiple of a lattice direction's `step` and little else.
fn is_same(a: &[f64], b: &[f64], step: f64) -> bool {
    let shift = ((a[0] - b[0]) / step).round() * step;
    a.iter().zip(b).all(|(a, b)| (a - b - shift).abs() < SAME)
}

/// Log edge lengths, ascending, each counted by the lattice edges that have it; with the sum of the counts.
struct Sizes(Vec<(f64, f64)>, f64);

impl Sizes {
    fn new(ground: &Ground, u: &[f64]) -> Self {
        let mut sizes: Vec<(f64, f64)> = ground
            .carrier
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| ground.carrier.vertices[i as usize]);
                let mean = t.iter().map(|&i| u[i as usize]).sum::<f64>() / 3.0;
                (-mean, (b - a).perp_dot(c - a) * libm::exp(2.0 * mean))
            })
            .collect();
        sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole = sizes.iter().map(|s| s.1).sum();
        Self(sizes, whole)
    }

    fn quantile(&self, share: f64) -> f64 {
        let mut sum = 0.0;
        let reached = |s: &&(f64, f64)| {
            sum += s.1;
            sum >= share * self.1
        };
        self.0.iter().find(reached).map_or(0.0, |s| s.0)
    }
}

/// The logarithm of the length that 99 % of the edges do not reach over the median.
fn largest_over_median(ground: &Ground, u: &[f64]) -> f64 {
    let sizes = Sizes::new(ground, u);
    sizes.quantile(0.99) - sizes.quantile(0.5)
}

/// What unequal sizes cost, in turns: nothing while the longest edges are less than half longer than
/// most, nor a few of them up to twice as long.
fn price_of_size(ground: &Ground, u: &[f64], narrowest: &[bool]) -> f64 {
    let lengths = ground.carrier.lengths();
    let (mut coarse, mut length) = (0.0, 0.0);
    for ((narrow, l), u) in narrowest.iter().zip(&lengths).zip(u) {
        if *narrow {
            coarse -= l * u;
            length += l;
        }
    }
    let is_for_triangles = ground.shape == CellShape::Triangle;
    let thin = if is_for_triangles { COARSE * (coarse / length).max(0.0) } else { 0.0 };
    const FREE: f64 = 0.45;
    const EACH: f64 = 30.0;
    const RARE: f64 = 0.8;
    const LONGEST: f64 = 5.0;
    let sizes = Sizes::new(ground, u);
    let middle = sizes.quantile(0.5);
    let longest = sizes.0.last().map_or(0.0, |s| s.0);
    thin + EACH * (sizes.quantile(0.99) - middle - FREE).max(0.0).powi(2)
        + LONGEST * (longest - middle - RARE).max(0.0)
}
