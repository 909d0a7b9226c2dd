//! A strip of the union taken out to be worked on: its border first, with the edge lengths that are wanted in it.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::site::Site;
use super::strips::Strip;
use crate::fill::even::fair::Beyond;
use crate::fill::even::local::{Local, edge};
use crate::geometry::topology::NONE;

/// Edges of one part with a larger angle between their faces stay with a crease, in radians.
const SHARP: f64 = 0.6;

/// A line that turns by more within an edge length has a corner there, in radians.
const CORNER: f64 = 0.8;

/// How far along a line its turn is measured, in edge lengths.
const WINDOW: f64 = 0.4;

/// Times that wanted lengths are evened out along a rim.
const EVEN: usize = 2;

/// A strip taken out.
pub(super) struct Taken {
    pub local: Local,
    pub beyond: Beyond,
}

/// Takes a strip out, with the line as a hard one if there is to be a crease; `None` if its border is not that of its rims.
pub(super) fn take(site: &Site<'_>, strip: &Strip, crease: bool) -> Option<Taken> {
    let union = site.union;
    let border = strip.border(&site.outside);
    let place: FxHashMap<u32, u32> = border.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
    let mut positions = border.iter().map(|&v| site.parts.vertices[v as usize]).collect::<Vec<_>>();
    let mut number: FxHashMap<u32, u32> = FxHashMap::default();
    let mut found = vec![false; border.len()];
    let (mut triangles, mut sides) = (vec![], vec![]);
    for &t in &strip.triangles {
        let corners = union.triangles[t as usize].map(|v| {
            *number.entry(v).or_insert_with(|| match place.get(&union.old[v as usize]) {
                Some(&k) if !std::mem::replace(&mut found[k as usize], true) => k,
                // A second vertex of that name would be one on the same point.
                _ => {
                    positions.push(union.vertices[v as usize]);
                    positions.len() as u32 - 1
                }
            })
        });
        triangles.push(corners);
        sides.push(site.union.solid(site.parts, t as usize) as u32);
    }
    if found.contains(&false) {
        return None;
    }
    let mut local = Local::new(positions, triangles, sides, border.len());
    let beyond = surroundings(site, strip, &border, &place, &mut local);
    if crease {
        let seams = site.seams.iter().filter_map(|(ends, _)| {
            let [a, b] = ends.map(|v| number.get(&v).copied());
            Some(edge(a?, b?))
        });
        local.hard = seams.collect();
        harden(site, strip, &number, &mut local);
        local.knots = knots(&local);
    }
    Some(Taken { local, beyond })
}

/// Wanted lengths, numbers of triangles, and edges that exist beyond the border; what lies beyond it.
pub(super) fn surroundings(
    site: &Site<'_>,
    strip: &Strip,
    border: &[u32],
    place: &FxHashMap<u32, u32>,
    local: &mut Local,
) -> Beyond {
    let at = |v: u32| site.parts.vertices[v as usize];
    let mut beyond = vec![(DVec3::ZERO, 0); border.len()];
    let mut taken_by = vec![0.0; border.len()];
    for f in (0..site.parts.n_faces() as u32).filter(|&f| site.outside.faces[f as usize]) {
        let own = site.parts.face(f);
        let m = own.len();
        for k in 0..m {
            let Some(&v) = place.get(&own[k]) else { continue };
            taken_by[v as usize] += 3.0 * (m - 2) as f64 / m as f64;
            let next = own[(k + 1) % m];
            // Each edge that leaves, in one of its two faces; the rim's own are the patch's.
            if let Some(&u) = place.get(&next) {
                local.taken.insert(edge(v, u));
                if local.neighbours(v).contains(&u) {
                    continue;
                }
            }
            beyond[v as usize].0 += at(next);
            beyond[v as usize].1 += 1;
        }
    }
    local.wanted = taken_by.iter().map(|&t: &f64| (6.0 - t.round()).clamp(1.0, 5.0) as usize).collect();
    let mut first = 0;
    for &k in &strip.rims {
        let rim = &site.outside.rims[k];
        let n = rim.len();
        let length = |i: usize| at(rim[i % n]).distance(at(rim[(i + 1) % n]));
        let mut own = (0..n).map(|i| 0.5 * (length(i) + length(i + n - 1))).collect::<Vec<_>>();
        for _ in 0..EVEN {
            own = (0..n).map(|i| 0.25 * (own[(i + n - 1) % n] + 2.0 * own[i] + own[(i + 1) % n])).collect();
        }
        local.sizes[first..first + n].copy_from_slice(&own);
        first += n;
    }
    let inside = border.len()..local.positions.len();
    let everywhere = if border.is_empty() { mean_edge(site) } else { 0.0 };
    for v in inside {
        let p = local.positions[v];
        let (mut sum, mut weights) = (everywhere, if border.is_empty() { 1.0 } else { 0.0 });
        for k in 0..border.len() {
            let weight = 1.0 / local.positions[k].distance_squared(p).max(f64::MIN_POSITIVE);
            sum += weight * local.sizes[k];
            weights += weight;
        }
        local.sizes[v] = sum / weights;
    }
    beyond
}

/// The mean edge length of all parts.
fn mean_edge(site: &Site<'_>) -> f64 {
    let at = |v: u32| site.parts.vertices[v as usize];
    let sides = |t: &[u32; 3]| (0..3).map(|k| at(t[k]).distance(at(t[(k + 1) % 3]))).sum::<f64>();
    site.parts.triangles.iter().map(sides).sum::<f64>() / (3 * site.parts.triangles.len()) as f64
}

/// Edges along which a part itself is sharp stay as well.
fn harden(site: &Site<'_>, strip: &Strip, number: &FxHashMap<u32, u32>, local: &mut Local) {
    let normal = |t: u32| {
        let [a, b, c] = site.parts.triangles[site.union.source[t as usize] as usize]
            .map(|v| site.parts.vertices[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    for &t in &strip.triangles {
        let own = site.union.triangles[t as usize];
        for k in 0..3 {
            let other = site.union.topology.across[t as usize][k];
            let same =
                site.union.solid(site.parts, t as usize) == site.union.solid(site.parts, other as usize);
            if other == NONE || other < t || !same || normal(t).angle_between(normal(other)) < SHARP {
                continue;
            }
            let ends = [own[(k + 1) % 3], own[(k + 2) % 3]].map(|v| number.get(&v).copied());
            if let [Some(a), Some(b)] = ends
                && !local.is_border(edge(a, b))
            {
                local.hard.insert(edge(a, b));
            }
        }
    }
}

/// Vertices in which hard lines end, branch or have a corner.
fn knots(local: &Local) -> BTreeSet<u32> {
    let mut lines: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &[a, b] in &local.hard {
        lines.entry(a).or_default().push(b);
        lines.entry(b).or_default().push(a);
    }
    let at = |v: u32| local.positions[v as usize];
    // The point of a line some way on from a vertex.
    let ahead = |v: u32, first: u32| {
        let (mut before, mut here) = (v, first);
        let mut steps = 0;
        while at(here).distance(at(v)) < WINDOW * local.sizes[v as usize] && steps < 1000 {
            match lines[&here].as_slice() {
                [a, b] => (before, here) = (here, if *a == before { *b } else { *a }),
                _ => break,
            }
            steps += 1;
        }
        at(here) - at(v)
    };
    let mut found = BTreeSet::new();
    let mut bends = vec![];
    for (&v, beside) in &lines {
        match beside.as_slice() {
            [a, b] => {
                let turn = std::f64::consts::PI - ahead(v, *a).angle_between(ahead(v, *b));
                if turn > CORNER {
                    bends.push((turn, v));
                }
            }
            _ => {
                found.insert(v);
            }
        }
    }
    bends.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut corners: Vec<u32> = vec![];
    for (_, v) in bends {
        let apart = |&u: &u32| at(u).distance(at(v)) > 2.0 * WINDOW * local.sizes[v as usize];
        if corners.iter().chain(&found).all(apart) {
            corners.push(v);
        }
    }
    found.extend(corners);
    found
}
