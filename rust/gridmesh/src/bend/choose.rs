//! Which bends are worth a lattice: start angles and strengths, judged before anything is traced.

use std::sync::Arc;

use rayon::prelude::*;

use super::conformal::{Operators, Rotation, Solver, keep_area};
use super::directions::Directions;
use super::image::{BentContours, Image};
use super::mirrored::Mirrored;
use super::price::{coarseness_of_limbs, largest_over_median, price_of_size};
use super::width::{Wish, narrowest};
use super::{Bent, Ground};
use crate::error::Result;
use crate::geometry::laplace::Factor;
use crate::options::CellShape;
use crate::progress::Progress;

/// Price of a change of direction against a squared radian along one edge, while directions are sought.
pub(super) const TURN: f64 = 1.0;
/// A squared radian along one edge costs so many turns in the end.
const MISFIT: f64 = 2.0;
/// The same for a bend of triangles that is made: steps along its sides cost about so much.
const MISFIT_MADE: f64 = 1.25;
/// Start angles tried between two lattice directions.
const STARTS: usize = 8;
/// Pull of the directions, per edge length of contour: how hard the drawing is bent.
const STRENGTH: f64 = 3.0;
/// The same for quads, and the price of a change of direction while they are sought, in contours of so many edges and fewer;
/// in longer ones it grows with them, as misfits do, or there would be more changes the finer the mesh is. Twice the
/// strength leaves more hand-drawn outlines to straight lattices at 1000 quads, half of it more changes at 10,000.
const STRENGTH_OF_QUADS: f64 = 4.2;
const TURN_OF_QUADS: f64 = 3.0;
pub(crate) const EDGES: f64 = 200.0;
/// So many rotations are sized at most, of 16 from eight start angles: the second in meshes of so many triangles and more, where
/// bends differ less from each other. At 10,000 triangles (317 drawings) .200 % of the vertices are irregular so, .204 with as
/// many as in coarse ones; at 2000 .77 instead of .71.
const SIZED: [usize; 2] = [8, 5];
const FINE: f64 = 5000.0;
/// And so many bends of triangles are made of them and judged once more: a bend that overlaps itself is only known by then,
/// and a solve is cheap beside a trace.
const MADE: usize = 4;
/// Price of a change of direction of triangles in the first rounds from the same start angles once more. Over 162 drawings at
/// 2000 triangles the median is .71 % irregular vertices with 3, .75 with 2, .81 without.
const DEAR: f64 = 3.0;
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
/// The share of the wish for finer narrow parts in a bend that is made where limbs would be coarse.
const FINER: f64 = 0.5;
/// Coarse limbs that cost fewer turns are not worth it.
const WORTH: f64 = 1.0;
/// The largest log of the edge length that 99 % of the edges do not reach, over the median.
const UNEVEN: f64 = 0.62;
/// Shares of a bend that are tried while the bent drawing overlaps itself.
const SHARES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];
/// Two rotations that differ by less than this everywhere, in radians, are one.
const SAME: f64 = 0.06;

/// The most promising bends of a drawing, at most `count`, best first, each with what it is expected to cost in turns. The
/// operators are those of the ground.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled), [`Error::Solver`](crate::error::Error::Solver).
pub(crate) fn candidates(
    (ground, operators): (&Arc<Ground>, &Operators),
    bend: f64,
    count: usize,
    progress: Progress<'_>,
) -> Result<Vec<(Bent, f64)>> {
    // What is solved after this is reported as one part.
    let solver = operators.solver(progress.part(0.1, 0.2));
    let (strength, turn) = match ground.shape {
        CellShape::Triangle => (STRENGTH, TURN),
        CellShape::Quad => {
            let length: f64 = ground.carrier.lengths().iter().sum();
            (STRENGTH_OF_QUADS, TURN_OF_QUADS * (length / EDGES).max(1.0))
        }
    };
    let beta = strength * bend;
    let robin = operators.robin(beta, progress)?;
    progress.report(0.1)?;
    let chosen = rotations((ground, operators), (beta, &robin), turn, progress.part(0.1, 0.2))?;
    progress.report(0.2)?;
    let narrowest = narrowest(&ground.carrier, &ground.widths);
    let floor = |&narrow: &bool| if narrow { NARROW_FLOOR } else { FLOOR };
    let maker = Maker {
        ground,
        operators,
        solver: &solver,
        pull: (beta, &robin),
        turn,
        mirrored: ground.is_symmetric.then(|| Mirrored::new(&ground.carrier)),
        wish: ground.wish(),
        floors: narrowest.iter().map(floor).collect(),
        narrowest,
    };
    if ground.shape == CellShape::Quad {
        return maker.cheapest(&chosen, count);
    }
    let priced: Vec<Result<Vec<(f64, Rotation)>>> = chosen.par_iter().map(|r| maker.priced(r)).collect();
    let mut sized = Vec::new();
    for priced in priced {
        sized.extend(priced?);
    }
    sized.sort_by(|a, b| a.0.total_cmp(&b.0));
    sized.truncate(MADE);
    let made: Vec<Result<Option<(Bent, f64)>>> = sized
        .par_iter()
        .map(|(_, rotation)| {
            let bent = maker.straightened(&rotation.v)?;
            Ok(bent.map(|bent| {
                let cost = maker.expected(&bent);
                (bent, cost)
            }))
        })
        .collect();
    let mut found = Vec::new();
    for made in made {
        found.extend(made?);
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found.truncate(count);
    Ok(found)
}

/// Different rotations to be sized, the best first.
fn rotations(
    (ground, operators): (&Ground, &Operators),
    pull: (f64, &Factor),
    turn: f64,
    progress: Progress<'_>,
) -> Result<Vec<Rotation>> {
    // On a mirror axis the lattice can only lie in two ways.
    let n = if ground.is_symmetric { 2 } else { STARTS };
    let step = ground.shape.step();
    let starts: Vec<f64> = (0..n).map(|k| step * k as f64 / n as f64).collect();
    let mut found = operators.rotations(&starts, pull, (turn, turn), progress.part(0.0, 0.5))?;
    if ground.shape == CellShape::Triangle {
        found.extend(operators.rotations(&starts, pull, (turn, DEAR), progress.part(0.5, 1.0))?);
    }
    found.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let is_fine = ground.shape == CellShape::Triangle && ground.triangles() >= FINE;
    let count = SIZED[usize::from(is_fine)];
    let mut chosen: Vec<Rotation> = Vec::new();
    for candidate in found {
        if chosen.len() == count {
            break;
        }
        if chosen.iter().all(|other| !is_same(&candidate.v, &other.v, step)) {
            chosen.push(candidate);
        }
    }
    Ok(chosen)
}

/// What a rotation is expected to cost, in turns, its sizes apart.
fn cost(rotation: &Rotation) -> f64 {
    rotation.turns as f64 + MISFIT * rotation.misfit
}

/// What makes bends of rotations.
struct Maker<'a> {
    ground: &'a Arc<Ground>,
    operators: &'a Operators,
    solver: &'a Solver<'a>,
    pull: (f64, &'a Factor),
    /// Price of a change of direction.
    turn: f64,
    mirrored: Option<Mirrored>,
    /// Scales that are wished for on the boundary; else those below which it should not be.
    wish: Option<Wish>,
    floors: Vec<f64>,
    narrowest: Vec<bool>,
}

impl Maker<'_> {
    /// A rotation that minds its scale.
    fn sized(&self, rotation: &Rotation) -> Result<Rotation> {
        let ground = self.ground;
        let v = match &self.wish {
            Some(wish) => {
                let wished = if ground.is_asked() { ASKED } else { QUAD_SIZE };
                self.solver.sized(rotation, self.pull, wished, wish)?
            }
            None => self.solver.floored(&ground.carrier, rotation, self.pull, HELD, &self.floors)?,
        };
        Ok(self.operators.judged(v, self.turn))
    }

    /// A rotation that minds its scale, with its cost in turns; and where limbs would be coarse, one that makes narrow
    /// parts finer.
    fn priced(&self, rotation: &Rotation) -> Result<Vec<(f64, Rotation)>> {
        let (cost, coarse, sized) = self.with_cost(self.sized(rotation)?)?;
        let mut found = vec![(cost, sized)];
        if coarse > WORTH {
            let wish = Wish::of_narrowness(&self.ground.widths, FINER);
            let v = self.solver.sized(rotation, self.pull, ASKED, &wish)?;
            let (cost, _, finer) = self.with_cost(self.operators.judged(v, self.turn))?;
            found.push((cost, finer));
        }
        Ok(found)
    }

    /// What a rotation is expected to cost, in turns, its sizes and coarse limbs included; and these alone.
    fn with_cost(&self, rotation: Rotation) -> Result<(f64, f64, Rotation)> {
        let ground = self.ground;
        let mut u = self.solver.scale(&rotation.v)?;
        keep_area(&ground.carrier, &mut u);
        let price = if ground.is_asked() { 0.0 } else { price_of_size(ground, &u, &self.narrowest) };
        let coarse = ground.price_of_limbs * coarseness_of_limbs(ground, &u);
        Ok((cost(&rotation) + price + coarse, coarse, rotation))
    }

    /// The bends of quads that cost least, at most `count`, best first. Rotations minding their scale are bent in the order of
    /// what they cost before their sides are straightened, `count` at a time, until so many bends cost no more than the
    /// next is expected to: straightening hardly changes that, but where a drawing would overlap itself and is bent less.
    fn cheapest(&self, chosen: &[Rotation], count: usize) -> Result<Vec<(Bent, f64)>> {
        let found: Vec<Result<(f64, f64, Rotation)>> =
            chosen.par_iter().map(|rotation| self.with_cost(self.sized(rotation)?)).collect();
        let step = self.ground.shape.step();
        let mut sized: Vec<(f64, Rotation)> = Vec::new();
        for found in found {
            let (cost, _, rotation) = found?;
            if sized.iter().all(|(_, other)| !is_same(&rotation.v, &other.v, step)) {
                sized.push((cost, rotation));
            }
        }
        sized.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Vec<(f64, Bent)> = Vec::new();
        for some in sized.chunks(count) {
            if best.len() == count && best.iter().all(|(price, _)| *price <= some[0].0) {
                break;
            }
            let found: Vec<Result<Option<(f64, Bent)>>> =
                some.par_iter().map(|(_, rotation)| self.priced_quads(rotation)).collect();
            for found in found {
                best.extend(found?);
            }
            best.sort_by(|a, b| a.0.total_cmp(&b.0));
            best.truncate(count);
        }
        Ok(best.into_iter().map(|(cost, bent)| (bent, cost)).collect())
    }

    /// The bend of quads by a rotation that minds its scale, with its cost in turns.
    fn priced_quads(&self, sized: &Rotation) -> Result<Option<(f64, Bent)>> {
        let found = self.straightened(&sized.v)?;
        let cost_of =
            |bent: &Bent| cost(&self.operators.judged(bent.image.v.clone(), self.turn)) + bent.price;
        Ok(found.map(|bent| (cost_of(&bent), bent)))
    }

    /// The drawing bent by a rotation whose sides are straightened.
    fn straightened(&self, v: &[f64]) -> Result<Option<Bent>> {
        let Maker { ground, solver, ref mirrored, ref narrowest, .. } = *self;
        let made = |v: Vec<f64>| bent(ground, solver, v, mirrored.as_ref(), narrowest);
        let straight = solver.straightened(
            &ground.carrier,
            v,
            self.pull,
            self.turn,
            (ground.shape, ground.sizes_matter),
        )?;
        Ok(match made(straight)? {
            Some(bent) if bent.share == 1.0 => Some(bent),
            // Better bent as a whole than straight and bent less.
            less => most(made(v.to_vec())?, less),
        })
    }

    /// What a bend of triangles is expected to cost in turns: those that it asks for, what it misses of the directions, and
    /// unequal sizes.
    fn expected(&self, bent: &Bent) -> f64 {
        let found = self.operators.directions(&bent.image.v, self.turn);
        let of = |d: &Directions| d.turns as f64 + MISFIT_MADE * d.misfit;
        found.iter().map(of).sum::<f64>() + bent.price + bent.price_of_limbs
    }
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
        let is_asked = ground.is_asked();
        let is_free = is_asked || ground.shape == CellShape::Quad;
        if !is_free && share > SHARES[SHARES.len() - 1] && largest_over_median(ground, &u) > UNEVEN {
            continue;
        }
        let mut positions = solver.map(&ground.carrier, &u, &v)?;
        if let Some(mirrored) = mirrored {
            positions = mirrored.symmetric(&positions, turn);
        }
        let price = if is_asked { 0.0 } else { price_of_size(ground, &u, narrowest) };
        let price_of_limbs = ground.price_of_limbs * coarseness_of_limbs(ground, &u);
        let image = Image { positions, u, v };
        if !image.is_upright(&ground.carrier) {
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
                price_of_limbs,
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
