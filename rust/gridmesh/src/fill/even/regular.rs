//! Fewer irregular vertices: flips that move them about until they meet, and collapses and divisions that take them out in pairs.

use glam::DVec3;

use super::local::{Local, quality};
use super::remesh::{Ground, relax};
use crate::error::Result;
use crate::progress::Progress;

/// Sweeps over all edges.
const SWEEPS: usize = 24;

/// Sweeps between two projections to the surface.
const PROJECTED: usize = 4;

/// Collapses leave no edge longer than this, and take none longer than that, in wanted lengths.
const LONGEST: f64 = 1.8;
const TAKEN: f64 = 1.4;

/// Vertices are divided if their edges are longer than this on average.
const ROOMY: f64 = 0.75;

/// Flips and collapses leave no triangle with a lower quality, divisions, after which vertices move, none with a lower one than that.
const LEAST: f64 = 0.5;
const LEAST_DIVIDED: f64 = 0.3;

/// Random numbers, the same each time.
struct Dice(u64);

impl Dice {
    /// From 0 to 1.
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Moves connections towards the wanted numbers of triangles at vertices and keeps the best state found. `ground`: the surface that
/// vertices stay on; without it they move within the planes of their neighbours.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn regularize(local: &mut Local, ground: Option<&Ground>, progress: Progress<'_>) -> Result<()> {
    let mut best = (cost(local), local.clone());
    let mut dice = Dice(1);
    for sweep in 0..SWEEPS {
        progress.report(sweep as f64 / SWEEPS as f64)?;
        if best.0 == 0 {
            break;
        }
        for e in local.edges() {
            flip(local, e, &mut dice);
            collapse(local, e);
        }
        for v in local.border as u32..local.positions.len() as u32 {
            divide(local, v);
        }
        relax(local, ground.filter(|_| sweep % PROJECTED == PROJECTED - 1));
        let own = cost(local);
        if own < best.0 {
            best = (own, local.clone());
        }
    }
    *local = best.1;
    local.compact();
    relax(local, ground);
    Ok(())
}

/// The sum of the squared differences from what is wanted.
fn cost(local: &Local) -> i64 {
    (0..local.positions.len() as u32).filter(|&v| !local.fan(v).is_empty()).map(|v| off(local, v, 0)).sum()
}

fn off(local: &Local, v: u32, more: i64) -> i64 {
    (local.fan(v).len() as i64 + more - local.wanted_at(v)).pow(2)
}

fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Flips an edge if that costs less; if as much, every second time.
fn flip(local: &mut Local, e: [u32; 2], dice: &mut Dice) {
    let &[s, t] = local.beside(e).as_slice() else { return };
    let apexes = [local.apex(s, e), local.apex(t, e)];
    let before = e.into_iter().chain(apexes).map(|v| off(local, v, 0)).sum::<i64>();
    if before == 0 {
        return;
    }
    let after = e.into_iter().map(|v| off(local, v, -1)).chain(apexes.map(|v| off(local, v, 1))).sum::<i64>();
    if after > before || after == before && dice.roll() < 0.5 {
        return;
    }
    let Some((old, new)) = local.flipped(e) else { return };
    let way = normal(local.corners(old[0])) + normal(local.corners(old[1]));
    let good = |t: [u32; 3]| {
        let corners = t.map(|v| local.positions[v as usize]);
        quality(corners) > LEAST && normal(corners).dot(way) > 0.0
    };
    if new.into_iter().all(good) {
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

/// Makes two vertices of one inside with too many triangles, if that costs less.
fn divide(local: &mut Local, v: u32) {
    let k = local.fan(v).len();
    if k < 7 || !local.is_soft(v) || local.knots.contains(&v) {
        return;
    }
    let Some(ring) = local.ring(v) else { return };
    let mean = ring.iter().map(|&u| local.length([u, v])).sum::<f64>() / k as f64;
    if mean < ROOMY {
        return;
    }
    let mut best: Option<(i64, usize, usize)> = None;
    for i in 0..k {
        // The new vertex gets the neighbours from i to j, those two are shared.
        for m in 3..=(k / 2) {
            let j = (i + m) % k;
            let [s, t] = [ring[i], ring[j]];
            let own = [m + 2, k - m + 2].map(|n| (n as i64 - 6).pow(2)).iter().sum::<i64>();
            let change = own + off(local, s, 1) + off(local, t, 1)
                - off(local, v, 0)
                - off(local, s, 0)
                - off(local, t, 0);
            if change < best.map_or(0, |b| b.0) {
                best = Some((change, i, m));
            }
        }
    }
    if let Some((_, i, m)) = best {
        let side = (0..=m).map(|d| ring[(i + d) % k]).collect::<Vec<_>>();
        local.divide(v, &side, LEAST_DIVIDED);
    }
}

#[cfg(test)]
mod tests {
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
        let before = cost(&local);
        assert!(before > 40, "{before}");
        regularize(&mut local, None, Progress::NONE).unwrap();
        let check = check_mesh(local.positions.len(), &local.triangles);
        assert_eq!((check.bad_edges, check.bad_vertices, check.euler, check.boundaries), (0, 0, 1, 1));
        let after = cost(&local);
        assert!(6 * after <= before, "{before} {after}");
        let thin = (0..local.triangles.len() as u32).map(|t| quality(local.corners(t)));
        assert!(thin.fold(1.0, f64::min) > 0.3);
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
        divide(&mut local, 8);
        assert_eq!([local.positions.len(), local.triangles.len()], [first[0] + 1, first[1] + 2]);
        assert_eq!([local.fan(8).len(), local.fan(9).len()], [6, 6]);
        assert_eq!(cost(&local), 0);
        assert!((0..local.triangles.len() as u32).all(|t| normal(local.corners(t)).z > 0.0));
    }
}
