//! What unequal sizes of a bent lattice and coarse limbs cost beside turns.

use super::Ground;
use super::conformal::image_areas;
use crate::options::CellShape;

/// Price of narrow parts that are coarser than on a straight lattice, in turns for a factor of e.
const COARSE: f64 = 8.0;
/// The log of the edge length that 99 % of the edges do not reach, over the median, costs its square times the second
/// beyond the first: so that it is 1.65 for half of the drawings at 2000 triangles, and 1.7 for quads.
const UNEVEN: (f64, f64) = (0.35, 40.0);
const UNEVEN_OF_QUADS: (f64, f64) = (0.45, 30.0);
/// So does the longest edge, linearly.
const LONGEST: (f64, f64) = (0.8, 5.0);

/// With so many edges across, the end of a limb looks round.
const ROUND: f64 = 3.0;
/// The largest factor by which limbs count as too coarse, as a logarithm.
const COARSEST: f64 = 1.0;

/// Log edge lengths, ascending, each counted by the lattice edges that have it; with the sum of the counts.
struct Sizes(Vec<(f64, f64)>, f64);

impl Sizes {
    fn new(ground: &Ground, u: &[f64]) -> Self {
        let carrier = &ground.carrier;
        let mean = |t: &[u32; 3]| t.iter().map(|&i| u[i as usize]).sum::<f64>() / 3.0;
        let logs = carrier.triangles.iter().map(|t| -mean(t));
        let mut sizes: Vec<(f64, f64)> = logs.zip(image_areas(carrier, u)).collect();
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
pub(super) fn largest_over_median(ground: &Ground, u: &[f64]) -> f64 {
    let sizes = Sizes::new(ground, u);
    sizes.quantile(0.99) - sizes.quantile(0.5)
}

/// What unequal sizes cost, in turns: nothing while the longest edges are less than two fifths longer than
/// most, nor a few of them up to twice as long; and narrow parts that are coarser.
pub(super) fn price_of_size(ground: &Ground, u: &[f64], narrowest: &[bool]) -> f64 {
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
    let (free, each) = if is_for_triangles { UNEVEN } else { UNEVEN_OF_QUADS };
    let (rare, longer) = LONGEST;
    let sizes = Sizes::new(ground, u);
    let middle = sizes.quantile(0.5);
    let longest = sizes.0.last().map_or(0.0, |s| s.0);
    thin + each * (sizes.quantile(0.99) - middle - free).max(0.0).powi(2)
        + longer * (longest - middle - rare).max(0.0)
}

/// By how much limbs are coarser than on a straight lattice, as far as their ends lack edges to be round: the logarithm,
/// summed along the contours, in edges. The end of a limb whose sides converge in the bent plane needs a turn less, and so
/// does its base; but it has fewer edges across.
pub(super) fn coarseness_of_limbs(ground: &Ground, u: &[f64]) -> f64 {
    let lengths = ground.carrier.lengths();
    let of = |((width, length), u): ((&f64, &f64), &f64)| {
        let lacking = libm::log(ROUND) - width - u;
        length * lacking.min(-u).clamp(0.0, COARSEST)
    };
    ground.limbs.iter().zip(&lengths).zip(u).map(of).sum()
}
