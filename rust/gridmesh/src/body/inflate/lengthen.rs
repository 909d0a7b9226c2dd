//! Ends of a front's short edges moved apart.

use glam::{DVec2, DVec3};

use super::fan::{LEVEL, REFLEX};
use crate::body::inflate::front::{Front, Guide};
use crate::error::Result;
use crate::geometry::active::{Directions, Visit, visit_active};
use crate::geometry::lengthen::{ROUNDS, THIN, THIN_OF_QUADS, lack};
use crate::options::CellShape;
use crate::progress::Progress;

/// For each stage the length wanted, in mean lengths of the body's edges (a third shows in a texture), and the cosine
/// up to which moves may not turn the triangles around a vertex further from the surface.
const STAGES: [(f64, f64); 4] = [(0.36, LEVEL), (0.36, LEVEL), (0.345, 0.3), (0.336, -1.0)];

/// Lengths of moves tried, in lengths wanted.
const REACHES: [f64; 4] = [1.0, 0.5, 0.2, 0.07];

/// Moves interior vertices along the surface until the edges at them are as long as [`STAGES`] says, as far as the
/// corners of triangles allow.
///
/// Stages are ever more lenient: in each a vertex is left where it is if a corner around it would become both sharper
/// than the sharpest there and sharper than [`THIN`] or [`THIN_OF_QUADS`] says. In none the sharpest corner of the whole
/// becomes sharper, but for one that is better than their first. Every triangle stays positive in projection; where that
/// holds a vertex fast, its neighbours make room. Near-linear.
pub(crate) fn lengthen(front: &mut Front, guide: &Guide<'_>, progress: Progress<'_>) -> Result<()> {
    let limits = match guide.patch.cells() {
        CellShape::Triangle => THIN,
        CellShape::Quad => THIN_OF_QUADS,
    };
    let near = |v: usize| guide.around.fan(v).iter().flat_map(|(a, b, _)| [a, b]);
    let mean = mean_length(front, guide);
    let vertices = front.first..front.flat.len();
    let thinnest = vertices.map(|v| front.sharpest(guide, v)).fold(limits[0], f64::max);
    let mut directions = Directions::new();
    for ((share, level), thin) in STAGES.into_iter().zip(limits) {
        let (wanted, thin) = (share * mean, thin.min(thinnest));
        visit_active(front.first..front.flat.len(), near, ROUNDS, progress, |v, round| {
            let limits = Limits { wanted, level, thin, directions: directions.of(round) };
            if lacking(front, guide, v, front.position(v), wanted) == 0.0 {
                Visit::Done
            } else if moved_apart(front, guide, v, &limits) || has_made_room(front, guide, v, &limits) {
                Visit::Moved
            } else {
                Visit::Stuck
            }
        })?;
    }
    Ok(())
}

/// What moves are tried.
struct Limits<'a> {
    /// The length wanted.
    wanted: f64,
    /// See [`STAGES`].
    level: f64,
    /// See [`THIN`].
    thin: f64,
    /// The directions tried, as sine and cosine.
    directions: &'a [(f64, f64); 8],
}

/// Mean length of the edges of the body: those of the silhouette count once, others for the back as well.
fn mean_length(front: &Front, guide: &Guide<'_>) -> f64 {
    let lengths =
        guide.patch.sides().map(|[a, b]| front.position(a as usize).distance(front.position(b as usize)));
    let (sum, count) = lengths.fold((0.0, 0.0), |(sum, count), length| (sum + length, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// What the edges at a vertex lack at `point`.
fn lacking(front: &Front, guide: &Guide<'_>, v: usize, point: DVec3, wanted: f64) -> f64 {
    guide.around.near(v).iter().map(|&u| lack(point.distance(front.position(u as usize)), wanted)).sum()
}

/// Moves a vertex to where the edges at it lack less.
fn moved_apart(front: &mut Front, guide: &Guide<'_>, v: usize, limits: &Limits<'_>) -> bool {
    let cost = |front: &Front, point: DVec3| lacking(front, guide, v, point, limits.wanted);
    let present = 0.999 * cost(front, front.position(v));
    moved(front, guide, v, limits, present, cost)
}

/// Moves the neighbours of a vertex to where its triangles are larger in projection.
fn has_made_room(front: &mut Front, guide: &Guide<'_>, v: usize, limits: &Limits<'_>) -> bool {
    let mut has_moved = false;
    for &u in guide.around.near(v) {
        if u as usize >= front.first {
            let room = Room::new(front, guide, v, u);
            let present = -1.001 * room.at(front.flat[u as usize]);
            // The least of the triangles may not be one of this neighbour's.
            if -room.without >= present {
                continue;
            }
            let lacked = lacking(front, guide, u as usize, front.position(u as usize), limits.wanted);
            let cost = |front: &Front, point: DVec3| {
                let room = room.at(point.truncate());
                let is_worse = || lacking(front, guide, u as usize, point, limits.wanted) > lacked;
                if -room < present && is_worse() { f64::INFINITY } else { -room }
            };
            has_moved |= moved(front, guide, u as usize, limits, present, cost);
        }
    }
    has_moved
}

/// The triangles at a vertex, by their areas in projection, one of its neighbours apart.
struct Room {
    /// Twice the least area of those that do not have the neighbour.
    without: f64,
    /// Where the vertex is.
    middle: DVec2,
    /// From there to the third vertex of the others, and whether that follows the neighbour.
    thirds: Vec<(DVec2, bool)>,
}

impl Room {
    fn new(front: &Front, guide: &Guide<'_>, v: usize, u: u32) -> Self {
        let middle = front.flat[v];
        let place = |w: u32| front.flat[w as usize] - middle;
        let mut room = Room { without: f64::INFINITY, middle, thirds: Vec::with_capacity(4) };
        for (a, b, _) in guide.around.fan(v).iter() {
            if a == u {
                room.thirds.push((place(b), true));
            } else if b == u {
                room.thirds.push((place(a), false));
            } else {
                room.without = room.without.min(place(a).perp_dot(place(b)));
            }
        }
        room
    }

    /// Twice the least area of all, were the neighbour at `point`.
    fn at(&self, point: DVec2) -> f64 {
        let away = point - self.middle;
        let area = |&(third, follows): &(DVec2, bool)| {
            if follows { away.perp_dot(third) } else { third.perp_dot(away) }
        };
        self.thirds.iter().map(area).fold(self.without, f64::min)
    }
}

/// Moves a vertex to the best of a few places around it; false if none costs less than `present`.
fn moved(
    front: &mut Front,
    guide: &Guide<'_>,
    v: usize,
    limits: &Limits<'_>,
    present: f64,
    cost: impl Fn(&Front, DVec3) -> f64,
) -> bool {
    let fan = guide.around.fan(v);
    let (here, start) = (front.position(v), front.flat[v]);
    let normal = front.normal(guide, v);
    let (e, f) = normal.any_orthonormal_pair();
    // Hardly any place costs less: what else is asked of one is only measured then.
    let (mut level_here, mut thin) = (None, None);
    let mut best = present;
    let mut is_moved = false;
    for reach in REACHES {
        for (sin, cos) in limits.directions {
            let target = here + reach * limits.wanted * (*cos * e + *sin * f);
            // Off the surface by a second-order term: a cheap first look.
            if cost(front, target) >= best {
                continue;
            }
            let thin = *thin.get_or_insert_with(|| {
                let sharpest = fan.sharpest(front.positions(), here, normal);
                if sharpest < REFLEX { sharpest.max(limits.thin) } else { limits.thin }
            });
            if fan.is_sharper(front.positions(), target, normal, thin) {
                continue;
            }
            let Some(there) = front.trial(guide, v, start, target) else { continue };
            let costs = cost(front, there.position);
            let mut level = || {
                let level = || fan.facing(front.positions(), here, normal).min(limits.level);
                *level_here.get_or_insert_with(level)
            };
            if costs < best
                && !fan.is_sharper(front.positions(), there.position, there.normal, thin)
                && fan.facing(front.positions(), there.position, there.normal) >= level()
            {
                best = costs;
                is_moved = true;
                front.put(v, &there);
            }
        }
    }
    is_moved
}
