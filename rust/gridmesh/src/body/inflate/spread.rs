//! Slides vertices along the lifted surface until its triangles are even.

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
    for leg in 0..LEGS {
        slide(front, guide, 1.0 / (LEGS - leg) as f64, progress)?;
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
    settle(front, guide, &target, progress)
}

/// Moves the vertices in the plane as far towards `target` as the triangles allow.
fn settle(front: &mut Front, guide: &Guide<'_>, target: &[DVec2], progress: Progress<'_>) -> Result<()> {
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
        // Of large patches rounds are many, each for a few vertices: only what is around those can have become bad.
        for v in moved.iter().map(|slot| slot + first as u32) {
            for (a, b, _) in guide.around.fan(v as usize).iter() {
                let [p, q, r] = [v, a, b].map(|u| flat[u as usize]);
                if (q - p).perp_dot(r - p) < guide.least_area {
                    bad.extend([v, a, b].iter().filter_map(|u| u.checked_sub(first as u32)));
                }
            }
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
