//! The vertices of a bridge moved within its surface to where their faces are good.

use glam::{DVec2, DVec3};

use super::loft::Loft;
use super::rail::Spot;
use crate::error::Result;
use crate::fill::surface::patchwork::Patchwork;
use crate::geometry::corner::{Corner, EQUILATERAL, Ideal};
use crate::geometry::quadratic::Quadratic;
use crate::progress::Progress;

/// Steps are halved this often before a vertex stays where it is.
const HALVINGS: usize = 4;

/// Sweeps at most.
const SWEEPS: usize = 10;

/// Steps are this many times those to the minimum for fixed neighbours: the neighbours follow.
const BEYOND: f64 = 1.3;

/// A vertex that gains less than this share of a good corner rests until one beside it gains more; one that is expected to
/// gain less than half of it stays where it is.
const RESTS: f64 = 0.05;

/// The badness of a corner counts to this power, and one: the worst ones most.
const POWER: i32 = 6;

/// What a step gains of the sum over corners of badness to the power `POWER + 1`, for each unit that the model falls by: the
/// model holds all but one factor fixed and leaves out the ideal's sides over its area, which are those of a triangle here.
const GAINED: f64 = (POWER + 1) as f64 / EQUILATERAL;

/// Moves the vertices between the loops. `flat`: where all vertices are on the loft; those of the loops stay. `spots`: what the
/// loft is there, for those between.
pub(super) fn settle(
    work: &Patchwork,
    loft: &Loft,
    flat: &mut [DVec2],
    spots: &mut [Spot],
    positions: &mut [DVec3],
    progress: Progress<'_>,
) -> Result<()> {
    let mut awake = vec![true; positions.len()];
    let mut mover = Mover { loft, star: vec![], seen: vec![] };
    for _ in 0..SWEEPS {
        progress.report(0.0)?;
        let mut all_rest = true;
        for v in work.inner() {
            if !std::mem::take(&mut awake[v]) {
                continue;
            }
            work.star(v, &mut mover.star);
            let spot = &mut spots[v - work.n];
            let gain = match work.corners {
                None => mover.moved::<false>(&mut flat[v], spot, positions, v),
                Some(_) => mover.moved::<true>(&mut flat[v], spot, positions, v),
            };
            if gain > RESTS {
                all_rest = false;
                awake[v] = true;
                mover.star.iter().flat_map(|&(i, j, _)| [i, j]).for_each(|w| awake[w as usize] = true);
            }
        }
        if all_rest {
            break;
        }
    }
    Ok(())
}

/// Moves one vertex at a time.
struct Mover<'a> {
    loft: &'a Loft,
    /// The corners around it.
    star: Vec<(u32, u32, Ideal)>,
    /// Their sides, and the products of these.
    seen: Vec<[DVec3; 3]>,
}

impl Mover<'_> {
    /// Moves a vertex; how much less bad its faces are then.
    fn moved<const QUADS: bool>(
        &mut self,
        flat: &mut DVec2,
        spot: &mut Spot,
        positions: &mut [DVec3],
        v: usize,
    ) -> f64 {
        let here = positions[v];
        // Known to the compiler where it is the only one.
        let kind = |ideal: Ideal| if QUADS { ideal } else { Ideal::Equilateral };
        let sides = |from: DVec3, i: u32, j: u32, positions: &[DVec3]| {
            let (a, b) = (positions[i as usize] - from, positions[j as usize] - from);
            [a, b, a.cross(b)]
        };
        self.seen.clear();
        self.seen.extend(self.star.iter().map(|&(i, j, _)| sides(here, i, j, positions)));
        let own = self.star.iter().zip(&self.seen).filter(|((.., ideal), _)| kind(*ideal).is_own());
        let sum = own.map(|(_, [.., cross])| *cross).sum::<DVec3>();
        let mut normal = spot.along.cross(spot.across).normalize_or_zero();
        if normal.dot(sum) < 0.0 {
            normal = -normal;
        }
        if normal == DVec3::ZERO {
            return 0.0;
        }
        let e = spot.along.normalize();
        let f = normal.cross(e);
        let mut model = Quadratic::default();
        let mut present = 0.0;
        for (&(.., ideal), &seen) in self.star.iter().zip(&self.seen) {
            let corner = Corner::crossed(kind(ideal), seen, normal);
            let badness = corner.badness();
            let weight = badness.powi(POWER);
            present += weight * badness;
            model += corner.model(weight, [e, f]);
        }
        // The loft's derivatives in the same frame.
        let (p, q) = (spot.along.dot(e), DVec2::new(spot.across.dot(e), spot.across.dot(f)));
        let area = p * q.y;
        if area.is_nan() || area.abs() < 1e-12 * p * p {
            return 0.0;
        }
        let Some(step) = model.minimum() else { return 0.0 };
        if -0.5 * model.gradient.dot(step) * GAINED < 0.5 * RESTS {
            return 0.0;
        }
        let near = self.seen.iter().map(|[a, ..]| a.length_squared()).fold(f64::INFINITY, f64::min);
        let mut step = (BEYOND * step).clamp_length_max(near.sqrt());
        for _ in 0..HALVINGS {
            let height = step.y / q.y;
            let there = *flat + DVec2::new((step.x - height * q.x) / p, height);
            if (0.001..0.999).contains(&there.y) {
                let found = self.loft.at(there.x, there.y);
                let mut sum = 0.0;
                for &(i, j, ideal) in &self.star {
                    let corner = Corner::crossed(kind(ideal), sides(found.point, i, j, positions), normal);
                    sum += corner.badness().powi(POWER + 1);
                    if sum >= present {
                        break;
                    }
                }
                if sum < present {
                    *flat = there;
                    positions[v] = found.point;
                    *spot = found;
                    return present - sum;
                }
            }
            step *= 0.5;
        }
        0.0
    }
}
