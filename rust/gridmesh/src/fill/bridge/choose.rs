//! Which lattice and which paths on it suit two loops best.

use super::align::Ring;
use super::loft::Loft;
use super::rings::Rings;
use super::route::{NEVER, Path, Side, Target, Wishes, route, straight};
use super::squares::{Plan, squares};
use super::tube::{Bound, Tube, is_tube, stacked, tube};
use crate::error::{Error, Result};
use crate::options::CellShape;
use crate::path::placement::ROW_HEIGHT;
use crate::progress::Progress;

/// Places around the axis at which distances are taken.
const SAMPLES: usize = 64;

/// Cost of a squared ring, and of a squared step along it, off the target, where there are few rows.
const ACROSS: f64 = 0.6;
const ALONG: f64 = 0.2;

/// So many rows are few: with more of them the same distance off matters less.
const FEW: f64 = 4.0;

/// A choice that costs less than this share of a triangle per loop vertex ends the search.
const ENOUGH: f64 = 0.02;

/// Of its steps a path rises by at most this share, and falls as often.
const MOST_RISES: f64 = 0.33;

/// Loops count as differently uneven if a vertex is this many steps further than by its number.
const UNEVEN: f64 = 1.5;

/// Rows are even if they differ by no more from a whole number.
const EVEN: f64 = 0.4;

/// Triangles at most.
const LIMIT: f64 = 2e7;

/// One of the two loops, run to the right as seen from outside with the other loop above or below.
pub(super) struct Bank {
    pub ring: Ring,
    /// Where each vertex lies around the axis, ascending over less than one round.
    pub around: Vec<f64>,
    /// The triangles that each vertex should have.
    pub wanted: Vec<i64>,
}

impl Bank {
    fn len(&self) -> usize {
        self.around.len()
    }

    /// How many vertices come before a place around the axis.
    fn before(&self, around: f64) -> f64 {
        let n = self.len();
        let start = self.around[0];
        let round = (around - start).floor();
        let within = around - round;
        // Rounding can put it before the first.
        let k = self.around.partition_point(|&x| x <= within).saturating_sub(1);
        let end = self.around.get(k + 1).copied().unwrap_or(start + 1.0);
        let share = (within - self.around[k]) / (end - self.around[k]).max(1e-12);
        round * n as f64 + k as f64 + share.clamp(0.0, 1.0)
    }

    /// The place around the axis before which so many vertices come.
    fn after(&self, count: f64) -> f64 {
        let n = self.len();
        let round = (count / n as f64).floor();
        let within = count - round * n as f64;
        let k = (within as usize).min(n - 1);
        let end = self.around.get(k + 1).copied().unwrap_or(self.around[0] + 1.0);
        round + self.around[k] + (within - k as f64) * (end - self.around[k])
    }

    /// The length of the edges about a place around the axis.
    fn edge(&self, around: f64) -> f64 {
        let reach = 1.5 / self.len() as f64;
        let edges = self.before(around + reach) - self.before(around - reach);
        2.0 * reach * self.ring.length / edges.max(1e-9)
    }
}

/// The lattice that fits two loops.
pub(super) struct Chosen {
    pub tube: Tube,
    /// Whether it is a lattice; otherwise rings of any lengths.
    pub lattice: bool,
}

/// What suits the space between two loops.
///
/// The lattice is laid out around the axis such that the vertices of the lower loop are evenly spaced there, however they are
/// in space.
pub(super) struct Chooser<'a> {
    lower: &'a Bank,
    upper: &'a Bank,
    /// Where the vertices of the upper loop are on the lattice, in rounds.
    places: Vec<f64>,
    /// Rows that suit the distance, at places around the axis.
    rows: Vec<f64>,
    /// Rows between the loops at least.
    least: i64,
    /// There are as many rows as were asked for.
    exact: bool,
}

/// One lattice to try.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate {
    growth: usize,
    /// How often the lower path rises.
    rises: usize,
    /// How much of the differences of distance the lower path takes on.
    share: f64,
}

impl<'a> Chooser<'a> {
    /// `rows`: as many as asked for.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub fn new(
        lower: &'a Bank,
        upper: &'a Bank,
        loft: &Loft,
        rows: Option<usize>,
        least: usize,
        cells: CellShape,
    ) -> Result<Chooser<'a>> {
        let height = if cells == CellShape::Quad { 1.0 } else { ROW_HEIGHT };
        let suiting = |k: usize| {
            let around = k as f64 / SAMPLES as f64;
            let (a, b) = (lower.edge(around), upper.edge(around));
            // Edges grow evenly from one loop to the other.
            let edge = if (a - b).abs() > 1e-3 * a { (a - b) / libm::log(a / b) } else { a };
            loft.length(around) / (edge * height)
        };
        let exact = rows.is_some();
        let found = match rows {
            Some(rows) => vec![rows as f64; SAMPLES],
            None => smoothed(&(0..SAMPLES).map(suiting).collect::<Vec<_>>()),
        };
        let most = found.iter().copied().fold(0.0, f64::max);
        let triangles = most * (lower.len() + upper.len()) as f64;
        if triangles.is_nan() || triangles > LIMIT {
            return Err(Error::TooLarge { triangles, limit: LIMIT });
        }
        let rows = found.into_iter().map(|rows| rows.max(least as f64)).collect();
        let places = upper.around.iter().map(|&around| lower.before(around) / lower.len() as f64).collect();
        Ok(Chooser { lower, upper, places, rows, least: least as i64, exact })
    }

    fn mean(&self) -> f64 {
        self.rows.iter().sum::<f64>() / SAMPLES as f64
    }

    /// The best of some lattices, if one is found.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn lattice(&self, progress: Progress<'_>) -> Result<Option<Chosen>> {
        let enough = ENOUGH * (self.lower.len() + self.upper.len()) as f64;
        if let Some(tube) = self.even(progress)? {
            return Ok(Some(Chosen { tube, lattice: true }));
        }
        let mut best: Option<(f64, Chosen)> = None;
        let candidates = self.candidates();
        for (k, candidate) in candidates.iter().enumerate() {
            let progress = progress.part(k as f64 / candidates.len() as f64, 1.0);
            let bound = best.as_ref().map_or(NEVER, |best| best.0);
            if 2.0 * candidate.growth as f64 >= bound + 2.0 * self.spared(candidate.growth) {
                continue;
            }
            if let Some((cost, tube)) = self.tried(*candidate, bound, progress)? {
                best = Some((cost, Chosen { tube, lattice: true }));
                if cost < enough {
                    break;
                }
            }
        }
        Ok(best.map(|best| best.1))
    }

    /// The tube of as many rows everywhere, if they are to be even and the counts differ by as much in each.
    fn even(&self, progress: Progress<'_>) -> Result<Option<Tube>> {
        let rows = self.mean().round();
        let more = self.upper.len() - self.lower.len();
        let uneven = self.rows.iter().any(|own| (own - rows).abs() > EVEN);
        if uneven || !more.is_multiple_of(rows as usize) {
            return Ok(None);
        }
        let it = Candidate { growth: more / rows as usize, rises: 0, share: 0.0 };
        let found = self.tried(it, NEVER, progress)?;
        Ok(found.map(|found| found.1).filter(|tube| tube.least == rows && tube.most == rows))
    }

    /// Corners that vertices may want.
    fn spared(&self, growth: usize) -> f64 {
        let wants = |bank: &Bank| bank.wanted.iter().map(|w| (w - 3).abs()).sum::<i64>() as f64;
        (wants(self.lower) + wants(self.upper)).min(growth as f64)
    }

    /// Rings of lengths that grow evenly, whatever the counts.
    pub fn stacked(&self) -> Chosen {
        let (m, n) = (self.lower.len() as f64, self.upper.len() as f64);
        let rows = (self.mean().round() as usize).max(self.least as usize);
        let length = |row: usize| (m * libm::pow(n / m, row as f64 / rows as f64)).round() as usize;
        // The vertex of the upper loop above the first one of the lower.
        let shift = self.upper.before(self.lower.around[0]).round();
        let first = shift.rem_euclid(n) as usize;
        let mut tube = stacked(&(0..=rows).map(length).collect::<Vec<_>>(), first);
        for (around, height) in tube.around.iter_mut().zip(&tube.height) {
            let (low, high) = (self.lower.after(*around * m), self.upper.after(*around * n + shift));
            *around = low + height * (high - low);
        }
        Chosen { tube, lattice: false }
    }

    /// Rings of squares, as many all around.
    pub fn squares(&self) -> Chosen {
        let (m, n) = (self.lower.len(), self.upper.len());
        let rows = (self.mean().round() as usize).max(self.least as usize);
        let plan = Plan::new(m, n - m, rows, self.exact);
        let mut part = 0;
        let mut tube = squares(&plan, &self.places, |gain| self.reached(gain, &mut part));
        tube.around.iter_mut().for_each(|around| *around = self.lower.after(*around * m as f64));
        Chosen { tube, lattice: true }
    }

    fn candidates(&self) -> Vec<Candidate> {
        let more = (self.upper.len() - self.lower.len()) as f64;
        let mean = self.mean();
        let ideal = more / mean;
        let rise = |k: usize| (self.rows[(k + 1) % SAMPLES] - self.rows[k]).max(0.0);
        let varied = (0..SAMPLES).map(rise).sum::<f64>();
        let mut growths = [0.0, 1.0, -1.0, 2.0].map(|off| ideal.round() + off).to_vec();
        growths.sort_by(|a, b| (a - ideal).abs().total_cmp(&(b - ideal).abs()));
        if ideal < 3.0 {
            growths.push(0.0);
        }
        // Whole rows without a rest.
        growths.extend([mean.floor(), mean.ceil()].map(|rows| (more / rows.max(1.0)).floor()));
        // What a path rises and falls takes vertices that a cone does not get.
        let most = MOST_RISES * self.lower.len() as f64;
        for left in [2.0 * most, most, 0.0] {
            let less = (more - (varied - left).max(0.0)) / mean;
            growths.extend([less.floor(), less.ceil()]);
        }
        growths.retain(|&growth| (0.0..=more / self.least as f64).contains(&growth));
        let mut found: Vec<Candidate> = vec![];
        for growth in growths {
            let both = (0.5 * (varied - (more - growth * mean))).clamp(0.0, most);
            for part in [0.0, 1.0] {
                let rises = (part * both).round();
                let share = if rises > 0.0 { (rises / varied).min(1.0) } else { 0.0 };
                let it = Candidate { growth: growth as usize, rises: rises as usize, share };
                if !found.contains(&it) {
                    found.push(it);
                }
            }
        }
        found
    }

    /// The cost of a candidate and its tube, if it has one that costs less than `bound`.
    fn tried(&self, it: Candidate, bound: f64, progress: Progress<'_>) -> Result<Option<(f64, Tube)>> {
        let Some(rings) = self.rings(it) else { return Ok(None) };
        let mean = self.mean();
        let m = self.lower.len();
        // The lower path stays below the upper one.
        let split = if it.rises == 0 { 0 } else { ((mean - self.least as f64) / 2.0).floor() as i64 };
        let targets = |bank: &Bank, places: &[f64], level: f64, share: f64| {
            let target = |k: usize| {
                let rows = self.rows_at(bank.around[k]);
                let matter = (FEW / rows).powi(2).min(1.0);
                let (around, ring) = (places[k], level + share * (rows - mean));
                Target {
                    around,
                    ring,
                    wanted: bank.wanted[k],
                    along: ALONG * matter,
                    across: ACROSS * matter,
                }
            };
            (0..bank.len()).map(target).collect::<Vec<_>>()
        };
        let even = |n: usize| (0..n).map(|k| k as f64 / n as f64).collect::<Vec<_>>();
        let own = even(m);
        let below = targets(self.lower, &own, 0.0, -it.share);
        let least = rings.first;
        let wishes = Wishes { rings: &rings, side: Side::Above, least, most: split, targets: &below };
        let lower = match it.rises {
            0 => Some(straight(&wishes)),
            _ => route(&wishes, bound, progress.part(0.0, 0.3))?,
        };
        let Some(lower) = lower else { return Ok(None) };
        if lower.cost >= bound {
            return Ok(None);
        }
        let mut found = None;
        let (n, start) = (self.upper.len(), self.places[0]);
        let off = |k: usize| (start + k as f64 / n as f64 - self.places[k]).abs();
        let uneven = (0..n).map(off).fold(0.0, f64::max) * n as f64 > UNEVEN;
        // Loops that are uneven in different ways are matched by numbers, as far as it needs.
        for evenly in if uneven { &[0.0, 0.5, 1.0][..] } else { &[0.0] } {
            let place = |k: usize| self.places[k] + evenly * (start + k as f64 / n as f64 - self.places[k]);
            let places = (0..n).map(place).collect::<Vec<_>>();
            let above = targets(self.upper, &places, mean, 1.0 - it.share);
            let (least, most) = (split + self.least, i64::MAX / 4);
            let wishes = Wishes { rings: &rings, side: Side::Below, least, most, targets: &above };
            found = route(&wishes, bound - lower.cost, progress.part(0.3, 1.0))?;
            if found.is_some() {
                break;
            }
        }
        let Some(upper) = found else { return Ok(None) };
        let cost = lower.cost + upper.cost;
        if cost >= bound {
            return Ok(None);
        }
        let shifts = |path: &Path, places: &[f64]| {
            path.nodes.iter().zip(places).map(|(&node, place)| rings.around(node) - place).collect()
        };
        let lower = Bound { shifts: shifts(&lower, &own), nodes: &lower.nodes };
        let upper = Bound { shifts: shifts(&upper, &self.places), nodes: &upper.nodes };
        let mut tube = tube(&rings, &lower, &upper)?;
        tube.around.iter_mut().for_each(|around| *around = self.lower.after(*around * m as f64));
        Ok(is_tube(&tube, m, self.upper.len()).then_some((cost, tube)))
    }

    /// The rings with corners where the upper loop has more vertices than the lower one.
    fn rings(&self, it: Candidate) -> Option<Rings> {
        let m = self.lower.len();
        let length = m - it.rises;
        if length < 3 {
            return None;
        }
        let k = it.growth;
        let more = (self.upper.len() - m) as f64;
        // Corners where the upper loop gains on the lower one; ascending, also where it falls back.
        let (mut corners, mut rays) = (Vec::with_capacity(k), Vec::with_capacity(k));
        let mut part = 0;
        for a in 0..k {
            let ray = self.reached((a as f64 + 0.5) * more / k as f64, &mut part);
            rays.push(ray);
            corners.push((ray * length as f64).round() as i64);
        }
        // Numbers within one round, ascending.
        let first = corners.first().copied().unwrap_or(0);
        let turn = first.div_euclid(length as i64);
        corners.iter_mut().for_each(|c| *c -= turn * length as i64);
        rays.iter_mut().for_each(|ray| *ray -= turn as f64);
        while corners.last().is_some_and(|&c| c >= length as i64) {
            let (corner, ray) = (corners.pop()? - length as i64, rays.pop()? - 1.0);
            corners.insert(0, corner);
            rays.insert(0, ray);
        }
        Some(Rings::new(length, corners, rays))
    }

    /// The first place around the axis by which the upper loop has gained so many vertices on the lower one; also where it
    /// falls back later. `part`: where to look from, and where it was found.
    fn reached(&self, gain: f64, part: &mut usize) -> f64 {
        let m = self.lower.len() as f64;
        let ahead = |x: f64| self.upper.before(self.lower.after(x * m)) - x * m;
        let start = ahead(0.0);
        let parts = 4 * self.upper.len().max(SAMPLES);
        while *part < parts && ahead(*part as f64 / parts as f64) - start < gain {
            *part += 1;
        }
        *part as f64 / parts as f64
    }

    fn rows_at(&self, around: f64) -> f64 {
        let x = (around - around.floor()) * SAMPLES as f64;
        let k = x.floor();
        let (a, b) = (k as usize % SAMPLES, (k as usize + 1) % SAMPLES);
        self.rows[a] + (x - k) * (self.rows[b] - self.rows[a])
    }
}

/// The mean over a few neighbours.
fn smoothed(values: &[f64]) -> Vec<f64> {
    const REACH: usize = 3;
    let n = values.len();
    let mean = |k: usize| {
        let sum = (0..=2 * REACH).map(|off| values[(k + n + off - REACH) % n]).sum::<f64>();
        sum / (2 * REACH + 1) as f64
    };
    (0..n).map(mean).collect()
}
