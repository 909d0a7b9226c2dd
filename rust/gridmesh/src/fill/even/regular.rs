//! Fewer irregular vertices: changes of connections at random, fewer and fewer of which may make things worse.
//!
//! Two vertices beside each other with five and seven triangles are the end of a row; a flip moves them along the row, a collapse or
//! a division across it, without making more of them. Where two such pairs meet, or one comes to a vertex of the border that lacks what
//! it has, they become one, or none.
//!
//! Source: Kirkpatrick, Gelatt and Vecchi, *Optimization by simulated annealing*, 1983; the moves are those of Li, Zhang, Kobayashi
//! and Wonka, *Editing operations for irregular vertices in triangle meshes*, 2010.

use super::local::{Local, quality};
use super::net::{Net, Pair, normal};
use super::remesh::{Ground, relax};
use crate::error::Result;
use crate::progress::Progress;

/// Sweeps over all edges. With twice as many 4 % fewer irregular vertices are left, with half as many there are a tenth more.
const SWEEPS: usize = 600;

/// Sweeps between two over all vertices, with collapses and divisions.
const CLIMBS: usize = 5;

/// Sweeps between two moves of all vertices, and between two projections to the surface.
const RELAXED: usize = 2;
const PROJECTED: usize = 120;

/// Sweeps between two looks at whether to go on.
const ASKED: usize = 10;

/// What may cost so much more is done in one of e cases at first; less each sweep, until after this share of them nothing may cost more.
const HOT: f64 = 1.2;
const COOL: f64 = 0.9;

/// No triangle gets a lower quality.
const LEAST: f64 = 0.4;

/// Vertices are moved into neighbours nearer than this, in wanted lengths, and no edge gets longer than that. Where only edges of less
/// than .9 go, narrow collars keep more irregular vertices and get thinner triangles.
const SHORT: f64 = 1.3;
const LONGEST: f64 = 1.8;

/// Vertices are divided if their edges are longer than this on average; longer than that also where it gains nothing.
const ROOMY: f64 = 0.75;
const WIDE: f64 = 0.8;

/// Random numbers, the same each time.
struct Dice(u64);

impl Dice {
    /// From 0 to 1.
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Changes connections towards the wanted numbers of triangles at vertices. `ground`: the surface that vertices stay on; without it
/// they move within the planes of their neighbours. Meshes with hard lines stay as they are.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn regularize(local: &mut Local, ground: Option<&Ground>, progress: Progress<'_>) -> Result<()> {
    regularize_beside(local, ground, &[], progress)
}

/// The same for a mesh with hard lines on one surface: their edges and vertices stay.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn regularize_along(
    local: &mut Local,
    ground: Option<&Ground>,
    progress: Progress<'_>,
) -> Result<()> {
    anneal(local, ground, &[], progress)
}

/// The same where the triangles of some vertices stay as they are.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn regularize_beside(
    local: &mut Local,
    ground: Option<&Ground>,
    held: &[u32],
    progress: Progress<'_>,
) -> Result<()> {
    if !local.hard.is_empty() {
        return Ok(());
    }
    anneal(local, ground, held, progress)
}

fn anneal(local: &mut Local, ground: Option<&Ground>, held: &[u32], progress: Progress<'_>) -> Result<()> {
    let mut net = Net::new(local);
    held.iter().for_each(|&v| net.held[v as usize] = true);
    let before = cost(&net);
    // They cannot all be taken out: flips leave the sum as it is.
    let least = 2 * net.off.iter().sum::<i32>().abs();
    let mut annealer = Annealer { net, dice: Dice(1), chance: Chance::new(HOT), ring: vec![] };
    for sweep in 0..SWEEPS {
        if sweep % ASKED == 0 {
            progress.report(sweep as f64 / SWEEPS as f64)?;
            if cost(&annealer.net) <= least {
                break;
            }
        }
        let share = sweep as f64 / (COOL * SWEEPS as f64);
        annealer.chance = Chance::new(HOT * (1.0 - share).max(0.0));
        annealer.flips();
        if sweep % CLIMBS == 0 {
            annealer.climbs();
        }
        if sweep % RELAXED == 0 {
            annealer.net.relax(ground.filter(|_| sweep % PROJECTED == 0));
        }
    }
    if cost(&annealer.net) <= before {
        annealer.net.write(local);
    }
    // It would move the held ones, too.
    if held.is_empty() {
        relax(local, ground);
    }
    Ok(())
}

/// So many triangles more or fewer than wanted: two next to each other with one are better than one with two.
fn price(off: i32) -> i32 {
    match off.abs() {
        0 => 0,
        1 => 2,
        2 => 5,
        more => more * more + 1,
    }
}

fn cost(net: &Net) -> i32 {
    net.off.iter().map(|&off| price(off)).sum()
}

/// How likely it is that something is done that costs more.
struct Chance {
    heat: f64,
    /// For each whole cost no less than that with any gain of quality.
    most: [f64; 8],
}

impl Chance {
    fn new(heat: f64) -> Chance {
        let mut chance = Chance { heat, most: [1.0; 8] };
        chance.most = std::array::from_fn(|more| chance.of(more as f64 - 1.0));
        chance
    }

    fn of(&self, more: f64) -> f64 {
        if more <= 0.0 {
            1.0
        } else if self.heat > 0.0 {
            libm::exp(-more / self.heat)
        } else {
            0.0
        }
    }

    /// Whether it can be done, whatever it does to the quality.
    fn can(&self, more: i32, roll: f64) -> bool {
        more <= 0 || self.most.get(more as usize).is_some_and(|most| roll < *most)
    }

    fn takes(&self, more: f64, roll: f64) -> bool {
        more <= 0.0 || roll < self.of(more)
    }
}

/// One of several that cost the least, each as likely.
struct Cheapest<T> {
    found: Option<(i32, T)>,
    ties: f64,
}

impl<T> Cheapest<T> {
    fn new() -> Self {
        Cheapest { found: None, ties: 1.0 }
    }

    fn offer(&mut self, more: i32, what: T, dice: &mut Dice) {
        let least = self.found.as_ref().map_or(i32::MAX, |found| found.0);
        if more == least {
            self.ties += 1.0;
        }
        if more < least {
            self.ties = 1.0;
        }
        if more < least || more == least && dice.roll() * self.ties < 1.0 {
            self.found = Some((more, what));
        }
    }
}

struct Annealer {
    net: Net,
    dice: Dice,
    chance: Chance,
    /// Neighbours of the vertex in hand.
    ring: Vec<[u32; 2]>,
}

impl Annealer {
    fn off(&self, v: u32) -> i32 {
        self.net.off[v as usize]
    }

    fn price(&self, v: u32) -> i32 {
        price(self.off(v))
    }

    /// Flips edges beside irregular vertices.
    fn flips(&mut self) {
        for t in 0..self.net.triangles.len() as u32 {
            for k in 0..3 {
                if self.net.is_irregular_at(t, k)
                    && let Some(pair) = self.net.pair(t, k)
                {
                    self.flip(pair);
                }
            }
        }
    }

    fn flip(&mut self, it: Pair) {
        let [a, b, c, d] = [it.a, it.b, it.c, it.d].map(|v| self.off(v));
        if a | b | c | d == 0 || [it.a, it.b, it.c, it.d].into_iter().any(|v| self.net.held[v as usize]) {
            return;
        }
        let after = price(a - 1) + price(b - 1) + price(c + 1) + price(d + 1);
        let more = after - price(a) - price(b) - price(c) - price(d);
        let roll = self.dice.roll();
        if !self.chance.can(more, roll) {
            return;
        }
        let net = &self.net;
        let old = [net.corners([it.c, it.a, it.b]), net.corners([it.d, it.b, it.a])];
        let new = [net.corners([it.c, it.a, it.d]), net.corners([it.d, it.b, it.c])];
        let way = normal(old[0]) + normal(old[1]);
        let [was, will] = [old, new].map(|both| quality(both[0]).min(quality(both[1])));
        let good = will >= LEAST && new.into_iter().all(|t| normal(t).dot(way) > 0.0);
        if good && self.chance.takes(f64::from(more) + was - will, roll) && net.may_flip(it) {
            self.net.flip(it);
        }
    }

    /// Takes vertices out and puts some in, where irregular ones are.
    fn climbs(&mut self) {
        let mut ring = std::mem::take(&mut self.ring);
        for v in self.net.border as u32..self.net.positions.len() as u32 {
            self.net.ring(v, &mut ring);
            let regular = self.off(v) == 0 && ring.iter().all(|r| self.off(r[0]) == 0);
            // A vertex where two fans meet stays, and so do those of hard lines.
            let held = |v: u32| self.net.held[v as usize];
            if regular
                || self.net.fixed[v as usize]
                || ring.len() as i32 != self.net.count[v as usize]
                || held(v)
                || ring.iter().any(|r| held(r[0]))
            {
                continue;
            }
            if !self.collapse(v, &ring) {
                self.divide(v, &ring);
            }
        }
        self.ring = ring;
    }

    /// Half of what gains nothing is left as it is.
    fn takes(&mut self, more: i32, room: bool) -> bool {
        let roll = self.dice.roll();
        self.chance.takes(f64::from(more), roll) && (more < 0 || room && self.dice.roll() < 0.5)
    }

    /// Moves a vertex into a neighbour.
    fn collapse(&mut self, v: u32, ring: &[[u32; 2]]) -> bool {
        let k = ring.len();
        let mut best = Cheapest::new();
        for i in 0..k {
            let [s, x, y] = [i, i + 1, i + k - 1].map(|i| ring[i % k][0]);
            let after = price(self.off(s) + k as i32 - 4) + price(self.off(x) - 1) + price(self.off(y) - 1);
            let before = self.price(v) + self.price(s) + self.price(x) + self.price(y);
            best.offer(after - before, i, &mut self.dice);
        }
        let Some((more, i)) = best.found else { return false };
        let length = self.net.length(v, ring[i][0]);
        let taken =
            length < SHORT && self.takes(more, true) && self.net.may_collapse(ring, i, LONGEST, LEAST);
        if taken {
            self.net.collapse(v, ring, i);
        }
        taken
    }

    /// Makes two vertices of one.
    fn divide(&mut self, v: u32, ring: &[[u32; 2]]) {
        let k = ring.len();
        let mut best = Cheapest::new();
        for i in 0..k {
            // The new vertex gets the neighbours from i to i + m, those two are shared.
            for m in 3..=(k / 2) {
                let [s, t] = [i, i + m].map(|i| ring[i % k][0]);
                let own = price(m as i32 - 4) + price((k - m) as i32 - 4);
                let after = own + price(self.off(s) + 1) + price(self.off(t) + 1);
                let before = self.price(v) + self.price(s) + self.price(t);
                best.offer(after - before, (i, m), &mut self.dice);
            }
        }
        let Some((more, (i, m))) = best.found else { return };
        let mean = ring.iter().map(|r| self.net.length(v, r[0])).sum::<f64>() / k as f64;
        if mean > ROOMY && self.takes(more, mean > WIDE) {
            self.net.divide(v, ring, [i, m], LEAST);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::DVec3;

    use super::*;
    use crate::geometry::metrics::check_mesh;

    /// A hexagon of the lattice with n edges a side, whose border is fixed, with random flips inside.
    fn shuffled(n: i32, flips: usize) -> Local {
        let all = || (-n..=n).flat_map(|i| (-n..=n).map(move |j| (i, j)));
        let size = |(i, j): (i32, i32)| i.abs().max(j.abs()).max((i + j).abs());
        let mut order = all().filter(|&p| size(p) <= n).collect::<Vec<_>>();
        order.sort_by_key(|&p| size(p) < n);
        let number = |p: (i32, i32)| order.iter().position(|&q| q == p).map(|k| k as u32);
        let mut triangles = vec![];
        for &(i, j) in &order {
            for [b, c] in [[(i + 1, j), (i, j + 1)], [(i + 1, j - 1), (i + 1, j)]] {
                if let (Some(a), Some(b), Some(c)) = (number((i, j)), number(b), number(c)) {
                    triangles.push([a, b, c]);
                }
            }
        }
        let at = |&(i, j): &(i32, i32)| {
            DVec3::new(f64::from(i) + 0.5 * f64::from(j), 0.75f64.sqrt() * f64::from(j), 0.0)
        };
        let border = order.iter().filter(|&&p| size(p) == n).count();
        let sides = vec![0; triangles.len()];
        let mut local = Local::new(order.iter().map(at).collect(), triangles, sides, border);
        local.sizes.fill(1.0);
        local.wanted = (0..border as u32).map(|v| local.fan(v).len()).collect();
        let mut dice = Dice(5);
        for _ in 0..flips {
            let edges = local.edges();
            let e = edges[(dice.roll() * edges.len() as f64) as usize];
            if let Some((old, new)) = local.flipped(e) {
                let upright = |t: &[u32; 3]| normal(t.map(|v| local.positions[v as usize])).z > 0.5;
                if new.iter().all(upright) {
                    local.flip(old, new);
                }
            }
        }
        local
    }

    #[test]
    fn a_shuffled_lattice_becomes_regular() {
        let mut local = shuffled(6, 60);
        let before = cost(&Net::new(&local));
        assert!(before > 80, "{before}");
        regularize(&mut local, None, Progress::NONE).unwrap();
        let check = check_mesh(local.positions.len(), &local.triangles);
        assert_eq!((check.bad_edges, check.bad_vertices, check.euler, check.boundaries), (0, 0, 1, 1));
        let after = cost(&Net::new(&local));
        assert!(10 * after <= before, "{before} {after}");
        let thin = (0..local.triangles.len() as u32).map(|t| quality(local.corners(t)));
        assert!(thin.fold(1.0, f64::min) > 0.3);
    }

    #[test]
    fn what_is_held_stays_and_the_rest_becomes_regular() {
        let mut local = shuffled(6, 60);
        let held = (0..local.positions.len() as u32).filter(|&v| local.positions[v as usize].x < -1.0);
        let held = held.collect::<Vec<_>>();
        // Held vertices do not move, so that their positions tell them.
        let name = |local: &Local, v: u32| local.positions[v as usize].to_array().map(f64::to_bits);
        let names = held.iter().map(|&v| name(&local, v)).collect::<BTreeSet<_>>();
        let own = |local: &Local| {
            let corners = local.triangles.iter().map(|t| t.map(|v| name(local, v)));
            let mut all = corners.filter(|t| t.iter().all(|p| names.contains(p))).collect::<Vec<_>>();
            all.iter_mut().for_each(|t| t.sort_unstable());
            all.sort_unstable();
            all
        };
        let (before, first) = (cost(&Net::new(&local)), own(&local));
        regularize_beside(&mut local, None, &held, Progress::NONE).unwrap();
        let after = cost(&Net::new(&local));
        assert!(first.len() > 30 && own(&local) == first && after < before / 2, "{before} {after}");
    }

    #[test]
    fn a_vertex_with_too_many_triangles_is_divided() {
        let mut positions = (0..8)
            .map(|k| std::f64::consts::TAU * f64::from(k) / 8.0)
            .map(|t| DVec3::new(t.cos(), t.sin(), 0.0))
            .collect::<Vec<_>>();
        positions.push(DVec3::ZERO);
        let triangles = (0..8).map(|k| [8, k, (k + 1) % 8]).collect::<Vec<_>>();
        let mut local = Local::new(positions, triangles, vec![0; 8], 8);
        local.sizes.fill(1.0);
        local.wanted = vec![2, 2, 3, 2, 2, 2, 3, 2];
        let first = [local.positions.len(), local.triangles.len()];
        let net = Net::new(&local);
        let mut annealer = Annealer { net, dice: Dice(1), chance: Chance::new(0.0), ring: vec![] };
        annealer.climbs();
        assert_eq!(cost(&annealer.net), 0);
        annealer.net.write(&mut local);
        assert_eq!([local.positions.len(), local.triangles.len()], [first[0] + 1, first[1] + 2]);
        assert_eq!([local.fan(8).len(), local.fan(9).len()], [6, 6]);
        assert!((0..local.triangles.len() as u32).all(|t| normal(local.corners(t)).z > 0.0));
    }
}
