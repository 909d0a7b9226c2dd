//! Improves the triangles of a front, vertex by vertex.

use glam::DVec2;

use crate::body::inflate::fan::{LEVEL, Shape};
use crate::body::inflate::front::{Front, Guide, Trial, project};
use crate::body::inflate::pairs::has_moved_with_another;
use crate::error::Result;
use crate::geometry::active::{ASK_EVERY, Directions, Rounds, Visit, visit_active};
use crate::geometry::corner::{Corner, Ideal};
use crate::geometry::quadratic::Quadratic;
use crate::options::CellShape;
use crate::progress::Progress;

/// Cotangent of the angle, 32 degrees, below which [`sharpen`] acts on triangles.
const SHARP: f64 = 1.600_334_529_041_05;

/// The same for corners of quads, 50 and 130 degrees.
const SHARP_OF_QUADS: f64 = 0.839_099_631_177_28;

/// Power of a triangle's badness by which it counts in [`sweep`]; of quads all corners are to be near to right angles.
const POWER: i32 = 8;
const POWER_OF_QUADS: i32 = 3;

/// A vertex may make its worst triangle worse if it stays better than this, see `Shape::worst`: the quality of an isosceles
/// triangle with 26 degrees at its apex.
const GOOD: f64 = 0.692_8;

/// Rounds of [`sharpen`].
const ROUNDS: Rounds = Rounds { most: 32, stuck: 6 };

/// Lengths of moves, in mean lengths of the edges around, in turn from round to round.
const REACHES: [f64; 3] = [0.3, 0.12, 0.05];

/// One sweep over the vertices, each moved along the surface to where its triangles are best.
///
/// A triangle's badness is the sum of its squared sides over its area, for the corner of a quad that of the
/// quad's two sides, all seen in the tangent plane of the vertex: convex in the vertex's position there. One
/// Newton step, weighted by the badness itself so that the worst triangles count most, is taken and shortened
/// until no triangle falls below `least_area` in projection.
pub(crate) fn sweep(front: &mut Front, guide: &Guide<'_>, progress: Progress<'_>) -> Result<()> {
    let field = guide.field;
    let power = match guide.patch.cells() {
        CellShape::Triangle => POWER,
        CellShape::Quad => POWER_OF_QUADS,
    };
    for v in front.first..front.flat.len() {
        if v % ASK_EVERY == 0 {
            progress.report(0.0)?;
        }
        let slot = v - front.first;
        let normal = front.normal(guide, v);
        let (e, f) = normal.any_orthonormal_pair();
        let here = front.position(v);
        let fan = guide.around.fan(v);
        let mut model = Quadratic::default();
        let mut before = Shape::BEST;
        for (i, j, ideal) in fan.iter() {
            let (a, b) = (front.position(i as usize) - here, front.position(j as usize) - here);
            let cross = a.cross(b);
            let mut corner = Corner::crossed(ideal, [a, b, cross], normal);
            before.with(ideal, cross, corner.sides, normal);
            let mut flat = Quadratic::default();
            if (i as usize) < front.first && (j as usize) < front.first {
                // The height counts beside the other sides as at an equilateral triangle.
                let share = 0.5 * ideal.best() / Ideal::Equilateral.best();
                let flatter = share * (guide.flatness[i as usize] + guide.flatness[j as usize]);
                let m = corner.widening.normalize_or_zero();
                let height = a.dot(m);
                corner.sides += flatter * height * height;
                corner.lengthening -= 2.0 * flatter * height * m;
                let m = DVec2::new(m.dot(e), m.dot(f));
                let k = 2.0 * flatter * corner.inverse;
                flat = Quadratic { xx: k * m.x * m.x, xy: k * m.x * m.y, yy: k * m.y * m.y, ..flat };
            }
            let weight = corner.badness().powi(power);
            model += corner.model(weight, [e, f]);
            model += flat.scaled(weight);
        }
        let Some(u) = model.minimum() else { continue };
        let u = u.clamp_length_max(0.5 * fan.mean_edge(front.positions(), here));
        let Some((target, _)) = project(field, here + u.x * e + u.y * f, front.place[slot].triangle) else {
            continue;
        };
        let fidelity = before.facing.min(LEVEL);
        let mut share = 1.0;
        for _ in 0..4 {
            let point = front.flat[v].lerp(target, share);
            if front.may_move(guide, v, front.flat[v], point) {
                let Some(place) = field.locate(point, front.place[slot].triangle) else { break };
                let there = Trial::new(field, point, place);
                let after = fan.shape(front.positions(), there.position, there.normal);
                if (after.worst >= before.worst || after.worst > GOOD) && after.facing >= fidelity {
                    front.put(v, &there);
                    break;
                }
            } else {
                front.shortened += 1;
            }
            share *= 0.5;
        }
    }
    Ok(())
}

/// Moves the vertices of the sharpest triangles to where the least angle around them is largest, of quads
/// to where the corner furthest from a right angle is nearest to one, by trial in eight directions, together
/// with another vertex of the sharpest triangle where alone it has no better place. A vertex is left alone once it has not
/// moved for some rounds, nor its neighbours.
pub(crate) fn sharpen(front: &mut Front, guide: &Guide<'_>, progress: Progress<'_>) -> Result<()> {
    let sharp = match guide.patch.cells() {
        CellShape::Triangle => SHARP,
        CellShape::Quad => SHARP_OF_QUADS,
    };
    let near = |v: usize| guide.around.fan(v).iter().flat_map(|(a, b, _)| [a, b]);
    let mut directions = Directions::new();
    visit_active(front.first..front.flat.len(), near, ROUNDS, progress, |v, round| {
        let present = front.sharpest(guide, v);
        if present <= sharp {
            return Visit::Done;
        }
        let reach = REACHES[round % REACHES.len()];
        let directions = directions.of(round);
        let is_moved = try_around(front, guide, v, present, reach, directions)
            || has_moved_with_another(front, guide, v, reach, directions);
        if is_moved { Visit::Moved } else { Visit::Stuck }
    })
}

/// Moves `v`, the largest cotangent around which is `present`, to the best of eight places around it;
/// false if none is better.
fn try_around(
    front: &mut Front,
    guide: &Guide<'_>,
    v: usize,
    present: f64,
    reach: f64,
    directions: &[(f64, f64); 8],
) -> bool {
    let fan = guide.around.fan(v);
    let (here, start) = (front.position(v), front.flat[v]);
    let normal = front.normal(guide, v);
    let (e, f) = normal.any_orthonormal_pair();
    let mean = fan.mean_edge(front.positions(), here);
    let mut fidelity = None;
    let mut best = present;
    let mut moved = false;
    for (sin, cos) in directions {
        let target = here + reach * mean * (*cos * e + *sin * f);
        // Off the surface by a second-order term: a cheap first look.
        if fan.is_sharp(front.positions(), target, normal, best) {
            continue;
        }
        let Some(there) = front.trial(guide, v, start, target) else { continue };
        let now = fan.sharpest(front.positions(), there.position, there.normal);
        if now >= best {
            continue;
        }
        let fidelity =
            *fidelity.get_or_insert_with(|| fan.facing(front.positions(), here, normal).min(LEVEL));
        if fan.facing(front.positions(), there.position, there.normal) >= fidelity {
            best = now;
            moved = true;
            front.put(v, &there);
        }
    }
    moved
}
