//! The line where the surfaces of two parts meet, along edges of the patch that lies over it.
//!
//! A patch runs smoothly from one part to another, and its triangles keep to no line between them. Where each part has a colour of
//! its own, the border of the colours would have teeth. So vertices next to the line are moved onto it, along the surface,
//! nearest first and as far as their triangles allow, until no edge crosses it; then each triangle lies on one side. In narrow
//! patches, where edges run from rim to rim, the line gets vertices of its own (`divide`).

mod divide;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::site::Site;
use super::strips::Strip;
use super::take::surroundings;
use super::tries::{Kind, Patch};
use crate::error::{Error, Result};
use crate::fill::even::local::{Local, quality};
use crate::fill::even::nearest::Facets;
use crate::fill::even::polish::improve;
use crate::fill::even::untangle::{Near, tangled};
use crate::geometry::metrics::min_angle;
use crate::progress::Progress;

/// In each round vertices are moved onto the line if no triangle becomes worse than this, unless it was before; then vertices
/// on it are spread evenly along it, and those beside it make room.
const POOR: [f64; 5] = [0.7, 0.6, 0.5, 0.45, 0.42];

/// No patch gets a smaller angle, unless it had one.
const THIN: f64 = 0.15;

/// Times that triangles are looked at which the line still crosses.
const TEETH: usize = 8;

/// Moves the vertices of a patch that are next to the line between its parts onto it; the part of each triangle.
///
/// # Errors
/// [`Error::Cancelled`].
pub(super) fn straighten(
    site: &Site<'_>,
    strip: &Strip,
    patch: &mut Patch,
    progress: Progress<'_>,
) -> Result<Vec<i32>> {
    progress.report(0.0)?;
    let parts = surfaces(site, strip, |part| part as u32);
    let surfaces = surfaces(site, strip, |part| site.options.border.color(part));
    if let [_] = surfaces.as_slice() {
        let middles = patch.middles(site);
        return Ok(middles.into_iter().map(|p| nearest_part(site, &parts, None, p)).collect());
    }
    let border = strip.border(&site.outside);
    let Some(mut local) = patch.local(site, &border) else {
        return Err(Error::Internal { reason: "a patch of a joint has vertices beyond its rims" });
    };
    let place = border.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
    surroundings(site, strip, &border, &place, &mut local);
    let mut line = Line::new(site, &border, local, &surfaces);
    let mut sides = line.sides();
    if patch.kind != Kind::Exact {
        let near = site.near(strip, &place);
        let before = Harm::of(&line.local, &near, progress)?;
        for (round, poor) in (0..).zip(POOR) {
            progress.report(0.3 * f64::from(round) / POOR.len() as f64)?;
            line.snap(poor);
            line.spread(poor);
        }
        let snapped = (line.sides(), line.local.clone());
        let divided = line.divide(progress.part(0.3, 0.9))?.map(|sides| (sides, line.local));
        // What is smooth gives way to what is sound.
        for (new, local) in divided.into_iter().chain([snapped]) {
            if Harm::of(&local, &near, progress)?.is_no_more(&before) {
                patch.retake(site, &border, &local);
                sides = new;
                break;
            }
        }
    }
    progress.report(1.0)?;
    let each = sides.into_iter().zip(patch.middles(site));
    Ok(each.map(|(side, p)| nearest_part(site, &parts, Some(surfaces[side].0), p)).collect())
}

/// What is wrong with a patch.
struct Harm {
    /// Triangles that meet something.
    meetings: usize,
    /// The least angle, in radians.
    angle: f64,
}

impl Harm {
    fn of(local: &Local, near: &Near, progress: Progress<'_>) -> Result<Harm> {
        let meetings = tangled(local, near, progress.part(1.0, 1.0))?.len();
        Ok(Harm { meetings, angle: min_angle(&local.positions, &local.triangles) })
    }

    fn is_no_more(&self, other: &Harm) -> bool {
        self.meetings <= other.meetings && self.angle >= other.angle.min(THIN)
    }
}

/// What is left of the parts' surfaces in the strip, by a number of each part, ascending.
fn surfaces(site: &Site<'_>, strip: &Strip, number: impl Fn(usize) -> u32) -> Vec<(u32, Facets)> {
    let mut corners: BTreeMap<u32, Vec<[DVec3; 3]>> = BTreeMap::new();
    for &t in &strip.triangles {
        let own = site.union.triangles[t as usize].map(|v| site.union.vertices[v as usize]);
        corners
            .entry(number(site.parts.solids[site.union.solid(site.parts, t as usize)].part))
            .or_default()
            .push(own);
    }
    corners.into_iter().map(|(part, corners)| (part, Facets::new(corners))).collect()
}

/// The part, of those of a colour, whose surface is nearest to a point.
fn nearest_part(site: &Site<'_>, parts: &[(u32, Facets)], color: Option<u32>, p: DVec3) -> i32 {
    let alike = |part: u32| color.is_none_or(|color| site.options.border.color(part as usize) == color);
    let own = parts.iter().filter(|(part, _)| alike(*part)).collect::<Vec<_>>();
    match own.as_slice() {
        [(part, _)] => *part as i32,
        _ => own
            .get(least(own.iter().map(|(_, facets)| facets.distance(p))))
            .map_or(-1, |(part, _)| *part as i32),
    }
}

/// A patch and the line between the colours that it lies over.
struct Line<'a> {
    surfaces: &'a [(u32, Facets)],
    local: Local,
    /// For each vertex its distance from the surface of each colour.
    off: Vec<Vec<f64>>,
    /// Vertices that were moved onto the line.
    on: BTreeSet<u32>,
}

impl<'a> Line<'a> {
    fn new(site: &Site<'_>, border: &[u32], mut local: Local, surfaces: &'a [(u32, Facets)]) -> Line<'a> {
        let off = local.positions.iter().map(|&p| distances(surfaces, p)).collect();
        for v in 0..local.positions.len() as u32 {
            let p = local.positions[v as usize];
            let near = local.neighbours(v);
            let sum = near.iter().map(|&u| local.positions[u as usize].distance(p)).sum::<f64>();
            local.sizes[v as usize] = sum / near.len().max(1) as f64;
        }
        let mut line = Line { surfaces, local, off, on: BTreeSet::new() };
        // Vertices of a rim are their own part's.
        for (v, &old) in border.iter().enumerate() {
            let color = site.options.border.color(site.parts.solids[site.parts.solid_of_vertex(old)].part);
            if let Some(k) = surfaces.iter().position(|(own, _)| *own == color) {
                line.off[v][k] = 0.0;
            }
        }
        line
    }

    /// The colour whose surface is nearest to a vertex, by its place.
    fn nearest(&self, v: u32) -> usize {
        least(self.off[v as usize].iter().copied())
    }

    /// The colour that a triangle belongs to: its vertices on the line do not count.
    fn side(&self, t: u32) -> usize {
        let own = self.local.triangles[t as usize];
        let sum = |k: usize, all: bool| {
            let counted = own.iter().filter(|v| all || !self.on.contains(v));
            counted.map(|&v| self.off[v as usize][k]).sum::<f64>()
        };
        let all = own.iter().all(|v| self.on.contains(v));
        least((0..self.off[own[0] as usize].len()).map(|k| sum(k, all)))
    }

    /// Where the line crosses an edge between vertices of different colours.
    fn crossing(&self, u: u32, v: u32) -> Option<DVec3> {
        let (i, j) = (self.nearest(u), self.nearest(v));
        if i == j {
            return None;
        }
        let [f, g] = [(u, j, i), (v, i, j)].map(|(w, far, near)| {
            let off = &self.off[w as usize];
            off[far] - off[near]
        });
        let t = if f + g > 0.0 { f / (f + g) } else { 0.5 };
        let [p, q] = [u, v].map(|w| self.local.positions[w as usize]);
        Some(p.lerp(q, t))
    }

    /// Whether the line crosses an edge between two vertices, neither of which is on it.
    fn is_open(&self, u: u32, v: u32) -> bool {
        self.nearest(u) != self.nearest(v) && !self.on.contains(&u) && !self.on.contains(&v)
    }

    /// Places on the line to which a vertex can be moved within its triangles, the nearest first.
    fn targets(&self, v: u32) -> Vec<DVec3> {
        let p = self.local.positions[v as usize];
        let mut found = vec![];
        for &t in self.local.fan(v) {
            let own = self.local.triangles[t as usize];
            let ends = (0..3).filter_map(|k| self.crossing(own[k], own[(k + 1) % 3])).collect::<Vec<_>>();
            if let [a, b] = ends.as_slice() {
                let t = (p - *a).dot(*b - *a) / a.distance_squared(*b).max(f64::MIN_POSITIVE);
                found.push(a.lerp(*b, t.clamp(0.0, 1.0)));
                found.push(a.lerp(*b, 0.5));
            }
            found.extend(ends);
        }
        found.sort_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p)));
        found
    }

    /// Moves vertices onto the line until no edge crosses it, or none can be moved.
    fn snap(&mut self, poor: f64) {
        let first = self.local.border as u32;
        let mut found = (first..self.local.positions.len() as u32)
            .filter(|&v| self.local.neighbours(v).into_iter().any(|u| self.is_open(u, v)))
            .filter_map(|v| {
                let places = self.targets(v);
                let far = places.first()?.distance(self.local.positions[v as usize]);
                Some((far / self.local.sizes[v as usize], v, places))
            })
            .collect::<Vec<_>>();
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, v, places) in found {
            if self.local.neighbours(v).into_iter().any(|u| self.is_open(u, v))
                && places.into_iter().any(|place| self.moves(v, place, poor))
            {
                self.on.insert(v);
                let off = &mut self.off[v as usize];
                let near = least(off.iter().copied());
                let next =
                    least(off.iter().enumerate().map(|(k, &o)| if k == near { f64::INFINITY } else { o }));
                off[next] = off[near];
            }
        }
    }

    /// Moves a vertex if no triangle around it becomes worse than `poor`.
    fn moves(&mut self, v: u32, place: DVec3, poor: f64) -> bool {
        let before = std::mem::replace(&mut self.local.positions[v as usize], place);
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let fan = self.local.fan(v);
        let at = |u: u32| if u == v { before } else { self.local.positions[u as usize] };
        let was = |t: u32| self.local.triangles[t as usize].map(at);
        let is = |t: u32| self.local.corners(t);
        let worst = |of: &dyn Fn(u32) -> [DVec3; 3]| fan.iter().map(|&t| quality(of(t))).fold(1.0, f64::min);
        let fits = worst(&is) >= worst(&was).min(poor)
            && fan.iter().all(|&t| normal(is(t)).dot(normal(was(t))) > 0.0);
        if !fits {
            self.local.positions[v as usize] = before;
        }
        fits
    }

    /// For each vertex at the border between triangles of different sides those before and after it.
    fn along(&self) -> BTreeMap<u32, Vec<u32>> {
        let mut along: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for [a, b] in self.local.edges() {
            if let [s, t] = self.local.beside([a, b]).as_slice()
                && self.side(*s) != self.side(*t)
            {
                along.entry(a).or_default().push(b);
                along.entry(b).or_default().push(a);
            }
        }
        along
    }

    /// Spreads vertices evenly along the line, and those beside it around them, each on its side.
    fn spread(&mut self, poor: f64) {
        let along = self.along();
        let first = self.local.border as u32;
        let beside = |v: &u32| self.local.neighbours(*v).into_iter().chain([*v]).collect::<Vec<_>>();
        let near = along.keys().flat_map(beside).filter(|&v| v >= first).collect::<BTreeSet<_>>();
        for v in near {
            let p = self.local.positions[v as usize];
            if self.on.contains(&v) {
                if let Some(&[a, b]) = along.get(&v).map(Vec::as_slice) {
                    let [a, b] = [a, b].map(|u| self.local.positions[u as usize]);
                    let on = (0.5 * (a + b) - p).project_onto_normalized((b - a).normalize_or_zero());
                    self.moves(v, p + on, poor);
                }
            } else if improve(&mut self.local, v) {
                let side = self.nearest(v);
                let off = distances(self.surfaces, self.local.positions[v as usize]);
                if least(off.iter().copied()) == side {
                    self.off[v as usize] = off;
                } else {
                    self.local.positions[v as usize] = p;
                }
            }
        }
    }

    /// The colour of each triangle. Triangles that the line still crosses go to the side that makes the border shorter.
    fn sides(&self) -> Vec<usize> {
        let mut sides = (0..self.local.triangles.len() as u32).map(|t| self.side(t)).collect::<Vec<_>>();
        let open = |[u, v]: &[u32; 2]| self.is_open(*u, *v);
        let torn = self.local.edges().into_iter().filter(open).flatten().collect::<BTreeSet<_>>();
        let torn = torn.iter().flat_map(|&v| self.local.fan(v).iter().copied()).collect::<BTreeSet<_>>();
        for _ in 0..TEETH {
            let mut changed = false;
            for &t in &torn {
                let own = self.local.triangles[t as usize];
                let around = [0, 1, 2].map(|k| {
                    let ends = [own[k], own[(k + 1) % 3]];
                    let [p, q] = ends.map(|v| self.local.positions[v as usize]);
                    let beyond = self.local.beside(ends).into_iter().find(|&u| u != t);
                    (p.distance(q), beyond.map_or(self.nearest(own[k]), |u| sides[u as usize]))
                });
                let length = |side: usize| around.iter().filter(|a| a.1 != side).map(|a| a.0).sum::<f64>();
                let best = around
                    .iter()
                    .map(|a| a.1)
                    .min_by(|&a, &b| length(a).total_cmp(&length(b)).then(a.cmp(&b)));
                if let Some(best) = best
                    && length(best) < length(sides[t as usize])
                {
                    sides[t as usize] = best;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        sides
    }
}

/// The distance of a point from each surface.
fn distances(surfaces: &[(u32, Facets)], p: DVec3) -> Vec<f64> {
    surfaces.iter().map(|(_, own)| own.distance(p)).collect()
}

/// The place of the first of the least values.
fn least(values: impl Iterator<Item = f64>) -> usize {
    values.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k)
}
