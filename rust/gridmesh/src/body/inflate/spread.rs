//! Slides vertices along the lifted surface until its triangles are even.

use std::ops::Range;

use glam::DVec2;

use super::lengthen::lengthen;
use super::polish::{sharpen, sweep};
use crate::body::inflate::front::{Front, Guide};
use crate::error::Result;
use crate::geometry::active::ASK_EVERY;
use crate::options::CellShape;
use crate::progress::Progress;

/// Spreads the vertices of a front over its surface, the silhouette fixed.
///
/// In turn all slide a part of the way to their goals and improve the triangles around them; at the
/// end those of the sharpest triangles, or corners of quads, are moved once more. Every triangle, or corner, stays
/// positive in projection, so that the front stays a graph over the drawing. Near-linear.
pub(crate) fn spread(front: &mut Front, guide: &Guide<'_>, progress: Progress<'_>) -> Result<()> {
    const LEGS: usize = 3;
    let incident = Incident::new(guide.corners, front.first..front.flat.len());
    for leg in 0..LEGS {
        slide(front, guide, &incident, 1.0 / (LEGS - leg) as f64, progress)?;
        sweep(front, guide, progress)?;
        progress.report(0.2 * (leg + 1) as f64)?;
    }
    let more = match guide.patch.cells() {
        CellShape::Triangle => 4,
        CellShape::Quad => 2,
    };
    for _ in 0..more {
        sweep(front, guide, progress)?;
    }
    progress.report(0.8)?;
    sharpen(front, guide, progress)?;
    progress.report(0.9)?;
    lengthen(front, guide, progress)?;
    progress.report(1.0)
}

/// Slides every vertex down the slope by `share` of the way from its height to `goal`.
fn slide(
    front: &mut Front,
    guide: &Guide<'_>,
    incident: &Incident,
    share: f64,
    progress: Progress<'_>,
) -> Result<()> {
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
    settle(front, guide, incident, &target, progress)
}

/// Moves the vertices in the plane as far towards `target` as the triangles allow.
fn settle(
    front: &mut Front,
    guide: &Guide<'_>,
    incident: &Incident,
    target: &[DVec2],
    progress: Progress<'_>,
) -> Result<()> {
    const HALVINGS: u32 = 6;
    let field = guide.field;
    let first = front.first;
    let n = target.len();
    let mut share = vec![1.0; n];
    let mut flat = front.flat.clone();
    let mut place = front.place.clone();
    let mut moved: Vec<u32> = (0..n as u32).collect();
    for round in 0.. {
        for (k, &slot) in moved.iter().enumerate() {
            if k % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
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
        let mut judge = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|v| flat[v as usize]);
            if (b - a).perp_dot(c - a) < guide.least_area {
                bad.extend(corners.iter().filter_map(|&v| v.checked_sub(first as u32)));
            }
        };
        if round == 0 {
            guide.corners.iter().for_each(|&corners| judge(corners));
        } else {
            // Of large patches rounds are many, each for a few vertices.
            let near = moved.iter().flat_map(|&slot| incident.of(slot));
            near.for_each(|&k| judge(guide.corners[k as usize]));
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
        if slot % ASK_EVERY == 0 {
            progress.report(0.0)?;
        }
        front.height[first + slot] = field.at(flat[first + slot], place[slot]).0.sqrt();
    }
    front.flat = flat;
    front.place = place;
    Ok(())
}

/// The triangles at each of some vertices.
struct Incident {
    start: Vec<u32>,
    triangles: Vec<u32>,
}

impl Incident {
    fn new(triangles: &[[u32; 3]], vertices: Range<usize>) -> Self {
        let slots = |t: [u32; 3]| {
            t.into_iter().map(|v| v as usize).filter(|v| vertices.contains(v)).map(|v| v - vertices.start)
        };
        let mut start = vec![0; vertices.len() + 1];
        triangles.iter().flat_map(|&t| slots(t)).for_each(|slot| start[slot + 1] += 1);
        for slot in 0..vertices.len() {
            start[slot + 1] += start[slot];
        }
        let mut next = start.clone();
        let mut at = vec![0; start[vertices.len()] as usize];
        for (k, &t) in (0..).zip(triangles) {
            for slot in slots(t) {
                at[next[slot] as usize] = k;
                next[slot] += 1;
            }
        }
        Incident { start, triangles: at }
    }

    /// Those at the vertex of this place among them.
    fn of(&self, slot: u32) -> &[u32] {
        let [from, to] = [slot, slot + 1].map(|k| self.start[k as usize] as usize);
        &self.triangles[from..to]
    }
}
