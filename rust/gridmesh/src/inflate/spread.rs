//! Slides vertices along the lifted surface until its triangles are even.

use glam::{DVec2, DVec3};

use super::crease::{Crease, creases};
use super::field::{Field, Place};
use super::inlets::Inlets;
use super::polish::{ASK_EVERY, rim_flatness, sharpen, sweep};
use crate::error::Result;
use crate::patch::Loop;
use crate::progress::Progress;

/// The front of a body: a graph over the flat patch.
pub(crate) struct Front {
    /// Positions in the plane; the boundary's are the patch's.
    pub flat: Vec<DVec2>,
    /// Heights, zero on the boundary, positive inside.
    pub height: Vec<f64>,
    /// Where each interior vertex lies in the flat patch, from `first` on.
    pub place: Vec<Place>,
    /// First interior vertex.
    pub first: usize,
    /// Moves that were shortened so that no triangle of the projection turned over.
    pub shortened: usize,
}

impl Front {
    /// The lifted patch, no vertex moved sideways.
    pub fn new(field: &Field<'_>, first: usize) -> Self {
        let mut place = vec![Place { triangle: 0, weights: [0.0; 3] }; field.vertices.len() - first];
        for (t, corners) in field.triangles.iter().enumerate() {
            for (k, &v) in corners.iter().enumerate() {
                if let Some(slot) = (v as usize).checked_sub(first) {
                    let mut weights = [0.0; 3];
                    weights[k] = 1.0;
                    place[slot] = Place { triangle: t as u32, weights };
                }
            }
        }
        let height = (0..field.value.len()).map(|v| field.at_vertex(v).0.sqrt()).collect();
        Front { flat: field.vertices.to_vec(), height, place, first, shortened: 0 }
    }

    /// Whether `v`, which was at `start`, may go to `point`: all its triangles stay positive in
    /// projection, it does not leave its crease, and it does not enter an inlet of the drawing.
    pub fn may_move(&self, guide: &Guide<'_>, v: usize, start: DVec2, point: DVec2) -> bool {
        if guide.inlets.hold(point) && !guide.inlets.hold(start) {
            return false;
        }
        let stays = guide.crease[v].as_ref().is_none_or(|crease| crease.holds(point) || !crease.holds(start));
        stays
            && guide.field.topology.fan(v).iter().all(|&[a, b]| {
                (self.flat[a as usize] - point).perp_dot(self.flat[b as usize] - point) >= guide.least_area
            })
    }

    /// Where vertex `v` lies in space.
    pub fn position(&self, v: usize) -> DVec3 {
        self.flat[v].extend(self.height[v])
    }
}

/// What guides the vertices of a front.
pub(crate) struct Guide<'a> {
    pub field: &'a Field<'a>,
    /// Height of the surface above the middle of a circle of radius one.
    pub depth: f64,
    /// Where each vertex is to slide: a height.
    pub goal: Vec<f64>,
    /// The crease that each vertex is to follow.
    pub crease: Vec<Option<Crease>>,
    /// See [`rim_flatness`].
    pub flatness: Vec<f64>,
    /// Where vertices may not go.
    pub inlets: Inlets,
    /// Twice the area that each triangle keeps in projection at least.
    pub least_area: f64,
}

impl<'a> Guide<'a> {
    /// `limb` is 0 where the surface is round and 1 in a limb.
    pub fn new(
        field: &'a Field<'a>,
        limb: impl Fn(usize) -> f64,
        loops: &[Loop],
        inlets: Inlets,
        depth: f64,
        least_area: f64,
    ) -> Self {
        let first: usize = loops.iter().map(Loop::len).sum();
        let goal = |v: usize| if v < first { 0.0 } else { unrolled(field, v, limb(v), depth) };
        Guide {
            field,
            depth,
            goal: (0..field.value.len()).map(goal).collect(),
            crease: creases(field, loops, first),
            flatness: rim_flatness(field, loops, first),
            inlets,
            least_area,
        }
    }
}

/// Spreads the vertices of a front over its surface, the silhouette fixed.
///
/// In turn all slide a part of the way to their goals and improve the triangles around them; at the
/// end those of the sharpest triangles are moved once more. Every triangle stays positive in
/// projection, so that the front stays a graph over the drawing. Near-linear.
pub(crate) fn spread(front: &mut Front, guide: &Guide<'_>, progress: Progress<'_>) -> Result<()> {
    const LEGS: usize = 3;
    for leg in 0..LEGS {
        slide(front, guide, 1.0 / (LEGS - leg) as f64, progress)?;
        sweep(front, guide, progress)?;
        progress.report(0.2 * (leg + 1) as f64)?;
    }
    for _ in 0..2 {
        sweep(front, guide, progress)?;
    }
    progress.report(0.8)?;
    sharpen(front, guide, progress)?;
    progress.report(1.0)
}

/// The height to which a vertex slides: one at which the lifted surface nearly keeps the angles of
/// the flat patch.
///
/// Stereographic projection sends the squared height `f` of a sphere of radius `R` to
/// `f (1 - t) / (1 + t)^2`, where `t = 1 - f / R^2` is also `s^2 / (f + s^2)` with `s` half the slope
/// of `f`: so read it needs no circle, and at the silhouette of any drawing the height becomes the
/// distance from it. A limb is stretched across only; there vertices move less.
///
/// A body deeper than a sphere has the heights of the sphere, scaled. Heights are those before a curve
/// reshapes them; where it makes walls, vertices come from all over the section.
fn unrolled(field: &Field<'_>, v: usize, limb: f64, depth: f64) -> f64 {
    let value = field.value[v];
    let half = 0.25 * field.gradient[v].length_squared() / depth.max(1.0).powi(2);
    let t = half / (value + half);
    let k = 2.0 - 1.7 * limb;
    let height = (value * (1.0 - t) / (1.0 + k * t + (3.0 - k) * t * t)).sqrt();
    field.section.as_ref().map_or(height, |section| section.even(height, (value + half).sqrt()))
}

/// Slides every vertex down the slope by `share` of the way from its height to `goal`.
fn slide(front: &mut Front, guide: &Guide<'_>, share: f64, progress: Progress<'_>) -> Result<()> {
    let Guide { field, goal, crease, .. } = guide;
    let first = front.first;
    let target = (first..front.flat.len())
        .map(|v| {
            if v % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
            let (mut point, mut place) = (front.flat[v], front.place[v - first]);
            let height = match field.section {
                None => front.height[v],
                Some(_) => field.plain(point, place).0.sqrt(),
            };
            let height = height + share * (goal[v] - height);
            if let Some(crease) = &crease[v] {
                let away = point - crease.corner;
                let onto = crease.corner + crease.inward * away.dot(crease.inward);
                let next = point + share * (onto - point);
                if let Some(found) = field.locate(next, place.triangle) {
                    (point, place) = (next, found);
                }
            }
            for _ in 0..2 {
                let (value, gradient) = field.plain(point, place);
                let direction = match &crease[v] {
                    Some(crease) => crease.corner - point,
                    None => -gradient,
                };
                let direction = direction.normalize_or_zero();
                let slope = -gradient.dot(direction);
                let fall = value - height * height;
                // The root near zero of fall = slope s + bend s^2; a sphere's field bends so.
                let root = slope * slope + 4.0 * guide.depth * guide.depth * fall;
                if !(slope > 0.0 && root > 0.0) {
                    break;
                }
                let mut way = 2.0 * fall / (slope + root.sqrt());
                if let Some(crease) = &crease[v] {
                    way = way.min(0.9 * (crease.corner - point).length());
                }
                let next = point + direction * way;
                let Some(found) = field.locate(next, place.triangle) else { break };
                (point, place) = (next, found);
            }
            Ok(point)
        })
        .collect::<Result<Vec<_>>>()?;
    settle(front, guide, &target);
    Ok(())
}

/// The point of the plane below the foot of `point` on the surface `z^2 = field`.
pub(crate) fn project(field: &Field<'_>, point: DVec3, triangle: u32) -> Option<(DVec2, Place)> {
    let mut point = point;
    let mut triangle = triangle;
    for _ in 0..2 {
        let place = field.locate(point.truncate(), triangle)?;
        triangle = place.triangle;
        let (value, gradient) = field.at(point.truncate(), place);
        let slope = (-gradient).extend(2.0 * point.z);
        point -= (point.z * point.z - value) / slope.length_squared().max(f64::MIN_POSITIVE) * slope;
    }
    field.locate(point.truncate(), triangle).map(|place| (point.truncate(), place))
}

/// Moves the vertices in the plane as far towards `target` as the triangles allow.
fn settle(front: &mut Front, guide: &Guide<'_>, target: &[DVec2]) {
    const HALVINGS: u32 = 6;
    let field = guide.field;
    let first = front.first;
    let n = target.len();
    let mut share = vec![1.0; n];
    let mut flat = front.flat.clone();
    let mut place = front.place.clone();
    let mut moved: Vec<u32> = (0..n as u32).collect();
    for round in 0.. {
        for &slot in &moved {
            let slot = slot as usize;
            let v = first + slot;
            (flat[v], place[slot]) = (front.flat[v], front.place[slot]);
            if share[slot] > 0.0 {
                let wanted = front.flat[v].lerp(target[slot], share[slot]);
                if let Some(found) = field.locate(wanted, front.place[slot].triangle) {
                    (flat[v], place[slot]) = (wanted, found);
                }
            }
        }
        let mut bad: Vec<u32> =
            moved.iter().copied().filter(|&slot| guide.inlets.hold(flat[first + slot as usize])).collect();
        for corners in field.triangles {
            let [a, b, c] = corners.map(|v| flat[v as usize]);
            if (b - a).perp_dot(c - a) >= guide.least_area {
                continue;
            }
            bad.extend(
                corners.iter().filter_map(|&v| (v as usize).checked_sub(first)).map(|slot| slot as u32),
            );
        }
        bad.sort_unstable();
        bad.dedup();
        bad.retain(|&slot| share[slot as usize] > 0.0);
        if bad.is_empty() {
            break;
        }
        for &slot in &bad {
            let share = &mut share[slot as usize];
            *share = if round < HALVINGS { 0.5 * *share } else { 0.0 };
        }
        front.shortened += bad.len();
        moved = bad;
    }
    for slot in 0..n {
        front.height[first + slot] = field.at(flat[first + slot], place[slot]).0.sqrt();
    }
    front.flat = flat;
    front.place = place;
}
