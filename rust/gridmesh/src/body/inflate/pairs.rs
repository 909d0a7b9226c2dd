//! Two neighbours of a front moved as one, where the triangles between them hold each fast.

use glam::DVec3;

use super::fan::LEVEL;
use super::front::{Front, Guide, Spot, Trial, project};

/// Moves `v` and another vertex of its sharpest triangle by the same way along the surface, to where the least angle around
/// both is larger (of quads: the corner furthest from a right angle nearer to one). On a steep wall triangles are thin in
/// projection: a vertex alone soon meets the bound that they stay positive, and its neighbour does not make room
/// as long as its own triangles are good.
///
/// `reach` is the length of the way in mean lengths of the edges around `v`; the `directions` that are tried are sines and cosines.
/// False if no pair has a better place.
pub(super) fn has_moved_with_another(
    front: &mut Front,
    guide: &Guide<'_>,
    v: usize,
    reach: f64,
    directions: &[(f64, f64); 8],
) -> bool {
    let here = front.position(v);
    let normal = front.normal(guide, v);
    let (e, f) = normal.any_orthonormal_pair();
    let length = reach * guide.around.fan(v).mean_edge(front.positions(), here);
    let ways = directions.map(|(sin, cos)| length * (cos * e + sin * f));
    let ends = guide.around.fan(v).ends_of_sharpest(front.positions(), here, normal);
    let first = front.first;
    let mut others = ends.into_iter().flatten().map(|u| u as usize).filter(|&u| u >= first);
    others.any(|u| has_moved(front, guide, [v, u], &ways))
}

/// Moves two vertices by the best of `ways`; false if none is better.
fn has_moved(front: &mut Front, guide: &Guide<'_>, pair: [usize; 2], ways: &[DVec3]) -> bool {
    let starts = pair.map(|v| front.flat[v]);
    let normals = pair.map(|v| front.normal(guide, v));
    let sharpest_of = |k: usize| {
        let fan = guide.around.fan(pair[k]);
        fan.sharpest(front.positions(), front.position(pair[k]), normals[k])
    };
    let mut best = sharpest_of(0).max(sharpest_of(1));
    let mut levels = None;
    let mut kept = pair.map(|v| front.spot(v));
    let mut is_moved = false;
    for &way in ways {
        let moved = |w: u32| {
            front.position(w as usize) + if pair.contains(&(w as usize)) { way } else { DVec3::ZERO }
        };
        // Off the surface by a second-order term: a cheap first look.
        let is_sharp = |k: usize| {
            let fan = guide.around.fan(pair[k]);
            fan.is_sharp(moved, moved(pair[k] as u32), normals[k], best)
        };
        if is_sharp(0) || is_sharp(1) {
            continue;
        }
        let spots = pair.map(|v| spot_near(front, guide, v, front.position(v) + way));
        let [Some(first), Some(second)] = spots else { continue };
        // Measured before anything is moved.
        let levels = *levels.get_or_insert_with(|| pair.map(|v| facing(front, guide, v).min(LEVEL)));
        front.put_at(pair[0], &first);
        front.put_at(pair[1], &second);
        let now = sharpest(front, guide, pair);
        let may = |k: usize| {
            front.may_move(guide, pair[k], starts[k], front.flat[pair[k]])
                && facing(front, guide, pair[k]) >= levels[k]
        };
        if now < best && may(0) && may(1) {
            (best, kept, is_moved) = (now, [first, second], true);
        }
        front.put_at(pair[0], &kept[0]);
        front.put_at(pair[1], &kept[1]);
    }
    is_moved
}

/// The largest cotangent around either of two vertices.
fn sharpest(front: &Front, guide: &Guide<'_>, pair: [usize; 2]) -> f64 {
    front.sharpest(guide, pair[0]).max(front.sharpest(guide, pair[1]))
}

fn facing(front: &Front, guide: &Guide<'_>, v: usize) -> f64 {
    guide.around.fan(v).facing(front.positions(), front.position(v), front.normal(guide, v))
}

/// The place of the surface nearest to `target`.
fn spot_near(front: &Front, guide: &Guide<'_>, v: usize, target: DVec3) -> Option<Spot> {
    let (point, place) = project(guide.field, target, front.spot(v).place.triangle)?;
    Some(Trial::new(guide.field, point, place).spot())
}
