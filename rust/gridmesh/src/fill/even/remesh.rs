//! Makes the triangles of a strip even, on its surface.
//!
//! Source: Botsch and Kobbelt, *A remeshing approach to multiresolution modeling*, 2004: long edges are split, short ones collapsed,
//! flips even out the valences, vertices move within the surface.

use std::collections::BTreeMap;

use glam::DVec3;

use super::local::{Local, edge, quality};
use super::nearest::{Facets, Lines};
use crate::error::Result;
use crate::progress::Progress;

/// Rounds of splits, collapses, flips and moves.
const ROUNDS: usize = 8;

/// Rounds of flips and moves at the end.
const LAST: usize = 4;

/// Edges longer than this are split, shorter ones collapsed, in wanted lengths.
const LONG: f64 = 4.0 / 3.0;
const SHORT: f64 = 4.0 / 5.0;

/// The surface that vertices stay on.
pub(crate) struct Ground {
    /// The triangles of each part, by its number; without hard lines all are one.
    pub sides: BTreeMap<u32, Facets>,
    /// The hard lines.
    pub lines: Option<Lines>,
}

impl Ground {
    /// The surface of a mesh as it is.
    pub fn of(local: &Local) -> Ground {
        let mut corners: BTreeMap<u32, Vec<[DVec3; 3]>> = BTreeMap::new();
        for t in 0..local.triangles.len() as u32 {
            let side = if local.hard.is_empty() { 0 } else { local.sides[t as usize] };
            corners.entry(side).or_default().push(local.corners(t));
        }
        let sides = corners.into_iter().map(|(side, own)| (side, Facets::new(own))).collect();
        let ends = |e: [u32; 2]| e.map(|v| local.positions[v as usize]);
        let lines =
            (!local.hard.is_empty()).then(|| Lines::new(local.hard.iter().copied().map(ends).collect()));
        Ground { sides, lines }
    }

    /// The nearest point of a part's surface that faces the same way.
    pub fn nearest(&self, side: u32, p: DVec3, normal: DVec3) -> DVec3 {
        let side = if self.lines.is_some() { side } else { 0 };
        self.sides.get(&side).map_or(p, |facets| facets.nearest(p, normal))
    }
}

/// Makes a strip's triangles even.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn remesh(local: &mut Local, ground: &Ground, progress: Progress<'_>) -> Result<()> {
    for round in 0..ROUNDS + LAST {
        progress.report(round as f64 / (ROUNDS + LAST) as f64)?;
        if round < ROUNDS {
            split_long(local);
            collapse_short(local);
        }
        flip_valences(local);
        relax(local, Some(ground));
    }
    mend_thin(local);
    relax(local, Some(ground));
    local.compact();
    Ok(())
}

/// Splits, collapses and flips once, without moving anything.
pub(crate) fn adapt(local: &mut Local) {
    split_long(local);
    collapse_short(local);
    flip_valences(local);
    local.compact();
}

/// Divides what is longer than wanted, without moving anything.
pub(crate) fn refine(local: &mut Local) {
    for _ in 0..ROUNDS {
        let before = local.positions.len();
        split_long(local);
        flip_valences(local);
        if local.positions.len() == before {
            break;
        }
    }
}

fn split_long(local: &mut Local) {
    let mut long = local.edges().into_iter().map(|e| (local.length(e), e)).collect::<Vec<_>>();
    long.retain(|&(length, e)| length > LONG && !local.is_border(e));
    long.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    for (_, e) in long {
        local.split(e);
    }
}

fn collapse_short(local: &mut Local) {
    let mut short = local.edges().into_iter().map(|e| (local.length(e), e)).collect::<Vec<_>>();
    short.retain(|&(length, _)| length < SHORT);
    short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, [a, b]) in short {
        if local.beside([a, b]).is_empty() || local.length([a, b]) >= SHORT {
            continue;
        }
        // Towards the border, and towards hard lines.
        if !local.collapse(b, a, LONG) {
            local.collapse(a, b, LONG);
        }
    }
}

/// Flips edges where that brings the numbers of triangles at vertices nearer to those wanted.
pub(crate) fn flip_valences(local: &mut Local) {
    for e in local.edges() {
        let Some((old, new)) = local.flipped(e) else { continue };
        let [c, a, d] = new[0];
        let b = new[1][1];
        let off = |v: u32, more: i64| (local.fan(v).len() as i64 + more - local.wanted_at(v)).pow(2);
        let before = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
        let after = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1);
        let at = |t: [u32; 3]| t.map(|v| local.positions[v as usize]);
        let was = quality(local.corners(old[0])).min(quality(local.corners(old[1])));
        let will = quality(at(new[0])).min(quality(at(new[1])));
        let better = if after == before { will > was + 0.1 } else { after < before };
        if better && (will > 0.3 || will > was) && is_unfolded(local, old, new) {
            local.flip(old, new);
        }
    }
}

/// Flips edges of thin triangles where that makes them rounder.
pub(crate) fn mend_thin(local: &mut Local) {
    for _ in 0..3 {
        for e in local.edges() {
            let Some((old, new)) = local.flipped(e) else { continue };
            let at = |t: [u32; 3]| t.map(|v| local.positions[v as usize]);
            let was = quality(local.corners(old[0])).min(quality(local.corners(old[1])));
            let will = quality(at(new[0])).min(quality(at(new[1])));
            if was < 0.4 && will > was + 0.05 && is_unfolded(local, old, new) {
                local.flip(old, new);
            }
        }
    }
}

/// Whether a flip keeps the way that the surface faces.
fn is_unfolded(local: &Local, old: [u32; 2], new: [[u32; 3]; 2]) -> bool {
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let before = normal(local.corners(old[0])) + normal(local.corners(old[1]));
    let after = new.map(|t| normal(t.map(|v| local.positions[v as usize])));
    let least = 0.3 * before.length();
    after.iter().all(|n| n.dot(before) > least * n.length()) && after[0].dot(after[1]) > 0.0
}

/// Moves vertices towards the middle of their neighbours, within the surface; those of hard lines along them. Without a surface each
/// moves in its tangent plane. No triangle gets thin or turns over by it.
pub(crate) fn relax(local: &mut Local, ground: Option<&Ground>) {
    for v in local.border as u32..local.positions.len() as u32 {
        if local.fan(v).is_empty() || local.knots.contains(&v) {
            continue;
        }
        let near = local.neighbours(v);
        let at = |u: u32| local.positions[u as usize];
        let p = at(v);
        let along = near.iter().copied().filter(|&u| local.hard.contains(&edge(u, v))).collect::<Vec<_>>();
        let lines = ground.and_then(|ground| ground.lines.as_ref());
        let moved = match (along.as_slice(), lines) {
            ([a, b], Some(lines)) => {
                let there = lines.nearest(0.5 * p + 0.25 * (at(*a) + at(*b)));
                // A short closed line would shrink to a point of it.
                let apart = |p: DVec3| p.distance(at(*a)).min(p.distance(at(*b)));
                if apart(there) < apart(p) {
                    continue;
                }
                there
            }
            ([], _) => {
                let mean = near.iter().map(|&u| at(u)).sum::<DVec3>() / near.len() as f64;
                let normal = local
                    .fan(v)
                    .iter()
                    .map(|&t| local.corners(t))
                    .fold(DVec3::ZERO, |sum, [a, b, c]| sum + (b - a).cross(c - a));
                let up = normal.try_normalize().unwrap_or(DVec3::Z);
                let there = p + 0.7 * (mean - p).reject_from_normalized(up);
                ground
                    .map_or(there, |ground| ground.nearest(local.sides[local.fan(v)[0] as usize], there, up))
            }
            _ => continue,
        };
        if along.is_empty() && !stays_sound(local, v, moved) {
            continue;
        }
        local.positions[v as usize] = moved;
    }
}

/// Whether no triangle at a vertex gets thin or turns over by a move of it.
fn stays_sound(local: &Local, v: u32, p: DVec3) -> bool {
    local.fan(v).iter().all(|&t| {
        let own = local.triangles[t as usize];
        let moved = own.map(|u| if u == v { p } else { local.positions[u as usize] });
        local.is_better(local.corners(t), moved)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::even::local::tests::sheet;

    #[test]
    fn short_closed_lines_do_not_shrink_to_a_point() {
        let mut local = sheet(9);
        for p in &mut local.positions {
            p.y = 0.2 * (p.y - 3.0);
        }
        let at = |[x, y]: [f64; 2]| {
            let place = DVec3::new(x, 0.2 * (y - 3.0), 0.0);
            local.positions.iter().position(|p| *p == place).unwrap() as u32
        };
        let line = [[3.0, 3.0], [4.0, 3.0], [5.0, 3.0], [6.0, 4.0], [5.0, 4.0], [4.0, 4.0]].map(at);
        local.hard.extend((0..6).map(|k| edge(line[k], line[(k + 1) % 6])));
        local.knots.insert(line[0]);
        local.sizes.fill(3.0);
        local.merges = false;
        let ground = Ground::of(&local);
        remesh(&mut local, &ground, Progress::NONE).unwrap();
        let ends = local.hard.iter().map(|e| e.map(|v| local.positions[v as usize])).collect::<Vec<_>>();
        assert!(ends.len() >= 3);
        let shortest = ends.iter().map(|[a, b]| a.distance(*b)).fold(f64::INFINITY, f64::min);
        assert!(shortest > 0.1, "{ends:?}");
    }
}
