//! Whether new triangles meet each other or the mesh.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::error::Result;
use crate::fill::layout::unroll::{area_vector, is_simple};
use crate::fill::loops::mesh::{CHUNK, in_chunks, place};
use crate::geometry::embed::triangles_meet;
use crate::geometry::segments::orientation;
use crate::progress::Progress;

/// Cells along each axis of the grid that tells which boxes may be near.
const CELLS: usize = 48;

/// Meetings that are counted at most.
pub(crate) const MOST: usize = 100_000;

/// Triangles between two looks at how many meetings there are, and whether to go on.
const BLOCK: usize = 256;

/// The same where one thread works alone.
const SMALL_BLOCK: usize = 16;

/// From this number of triangles on the work is shared among threads.
const MANY: usize = 4096;

/// An axis-parallel box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box3 {
    pub low: DVec3,
    pub high: DVec3,
}

impl Box3 {
    /// Around points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        let none = Box3 { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.into_iter().fold(none, |b, p| Box3 { low: b.low.min(p), high: b.high.max(p) })
    }

    /// A bit for each face of the box beyond which a point lies: a triangle whose corners share one is
    /// outside.
    fn side(&self, p: DVec3) -> u8 {
        (p.cmplt(self.low).bitmask() | p.cmpgt(self.high).bitmask() << 3) as u8
    }

    /// True if they have a point in common.
    pub fn meets(&self, other: &Box3) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// For each box the triangles of a mesh whose own boxes meet it, ascending. One pass over the mesh. Triangles
/// with a corner that is not finite lie nowhere.
pub(crate) fn near_boxes(boxes: &[Box3], positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut near = vec![vec![]; boxes.len()];
    let all = Box3::around(boxes.iter().flat_map(|b| [b.low, b.high]));
    // Cells that some box meets; a triangle that meets none of them is near no box.
    let size = ((all.high - all.low) / CELLS as f64).max(DVec3::splat(f64::MIN_POSITIVE));
    let cell =
        |p: DVec3| ((p - all.low) / size).clamp(DVec3::ZERO, DVec3::splat(CELLS as f64 - 1.0)).as_uvec3();
    let several = boxes.len() > 1;
    let mut taken = vec![false; if several { CELLS * CELLS * CELLS } else { 0 }];
    let cell_number = |x: u32, y: u32, z: u32| (z as usize * CELLS + y as usize) * CELLS + x as usize;
    if several {
        for b in boxes {
            let (low, high) = (cell(b.low), cell(b.high));
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    taken[cell_number(low.x, y, z)..=cell_number(high.x, y, z)].fill(true);
                }
            }
        }
    }
    // A point that is not finite is beyond all faces at once, and so is a triangle that has it; of other points
    // never both of two opposite ones.
    const NOWHERE: u8 = u8::MAX;
    let side = |p: DVec3| if p.is_finite() { all.side(p) } else { NOWHERE };
    let sides: Vec<u8> = if positions.len() <= CHUNK {
        positions.iter().map(|&p| side(p)).collect()
    } else {
        positions.par_iter().with_min_len(CHUNK).map(|&p| side(p)).collect()
    };
    let scan = |(part, chunk): (usize, &[[u32; 3]])| {
        let mut found = vec![];
        for (k, t) in chunk.iter().enumerate() {
            let [a, b, c] = t.map(|v| sides[v as usize]);
            if a & b & c != 0 || a == NOWHERE || b == NOWHERE || c == NOWHERE {
                continue;
            }
            if several {
                let own = Box3::around(t.map(|v| positions[v as usize]));
                let (low, high) = (cell(own.low), cell(own.high));
                let hit = (low.z..=high.z).any(|z| {
                    (low.y..=high.y)
                        .any(|y| taken[cell_number(low.x, y, z)..=cell_number(high.x, y, z)].contains(&true))
                });
                if !hit {
                    continue;
                }
            }
            found.push((part * CHUNK + k) as u32);
        }
        found
    };
    let parts = in_chunks(triangles, scan);
    if !several {
        if let Some(near) = near.first_mut() {
            *near = parts.concat();
        }
        return near;
    }
    let tree: RTree<Boxed> =
        RTree::bulk_load(boxes.iter().enumerate().map(|(i, b)| boxed(b, i as u32)).collect());
    for t in parts.into_iter().flatten() {
        let own = Box3::around(triangles[t as usize].map(|v| positions[v as usize]));
        let envelope = AABB::from_corners(own.low.into(), own.high.into());
        for hit in tree.locate_in_envelope_intersecting(envelope) {
            near[hit.data as usize].push(t);
        }
    }
    near
}

type Boxed = GeomWithData<Rectangle<[f64; 3]>, u32>;

fn boxed(b: &Box3, data: u32) -> Boxed {
    Boxed::new(Rectangle::from_corners(b.low.into(), b.high.into()), data)
}

/// Pairs of triangles, at least one of them new, that meet elsewhere than in shared vertices and edges
/// (exact predicates), and a corner of the first such new triangle.
///
/// Vertices on the same point count as one: a mesh along a seam of doubled vertices touches itself
/// all along, and means nothing by it. Triangles with a corner that is not finite meet nothing. Counting ends at
/// about `most`, if that is reached, or at [`MOST`]: in a tangle every triangle meets every other. `apart`: the new
/// triangles are known not to meet each other.
///
/// # Errors
/// [`crate::error::Error::Cancelled`].
pub(crate) fn count_meetings(
    position: impl Fn(u32) -> DVec3 + Sync,
    new: &[[u32; 3]],
    old: &[[u32; 3]],
    apart: bool,
    most: usize,
    progress: Progress<'_>,
) -> Result<(usize, Option<DVec3>)> {
    let finite = |t: &&[u32; 3]| t.iter().all(|&v| position(v).is_finite());
    let mut new = new.iter().filter(finite).copied().collect::<Vec<_>>();
    let old = old.iter().filter(finite).copied().collect::<Vec<_>>();
    if apart {
        new = touching_boxes(&position, &new, &old);
    }
    if new.is_empty() {
        return Ok((0, None));
    }
    let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut ids = new.iter().chain(&old).flatten().copied().collect::<Vec<_>>();
    ids.sort_unstable();
    ids.dedup();
    let mut points = ids.iter().enumerate().map(|(k, &v)| (key(position(v)), k)).collect::<Vec<_>>();
    points.sort_unstable();
    let mut point = vec![0u32; ids.len()];
    let mut vertices = vec![];
    for same in points.chunk_by(|a, b| a.0 == b.0) {
        for &(_, k) in same {
            point[k] = vertices.len() as u32;
        }
        vertices.push(position(ids[same[0].1]));
    }
    let renumbered = |triangles: &[[u32; 3]]| -> Result<Vec<[u32; 3]>> {
        let mut kept = Vec::with_capacity(triangles.len());
        for t in triangles {
            let t = [point[place(&ids, t[0])?], point[place(&ids, t[1])?], point[place(&ids, t[2])?]];
            if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                kept.push(t);
            }
        }
        Ok(kept)
    };
    let (new, old) = (renumbered(&new)?, renumbered(&old)?);
    let around = |t: &[u32; 3]| Box3::around(t.map(|v| vertices[v as usize]));
    // The old triangles, and the new ones if they have to be compared with each other, by their number
    // after the old ones.
    let mut items = old.iter().enumerate().map(|(i, t)| boxed(&around(t), i as u32)).collect::<Vec<_>>();
    if !apart {
        let number = |i: usize| (old.len() + i) as u32;
        items.extend(new.iter().enumerate().map(|(i, t)| boxed(&around(t), number(i))));
    }
    if items.is_empty() {
        return Ok((0, None));
    }
    let tree = RTree::bulk_load(items);
    let meets = |i: usize| -> usize {
        let own = around(&new[i]);
        let plane = Plane::of(new[i].map(|v| vertices[v as usize]));
        let envelope = AABB::from_corners(own.low.into(), own.high.into());
        let hits = tree.locate_in_envelope_intersecting(envelope).filter(|hit| {
            let k = hit.data as usize;
            let other = match k.checked_sub(old.len()) {
                Some(j) if j <= i => return false,
                Some(j) => new[j],
                None => old[k],
            };
            let apart = plane.is_beside(other.iter().filter(|v| !new[i].contains(v)), &vertices);
            !apart && triangles_meet(&vertices, new[i], other)
        });
        hits.count()
    };
    let block = if new.len() < MANY { SMALL_BLOCK } else { BLOCK };
    let (mut sum, mut first) = (0, None);
    for start in (0..new.len()).step_by(block) {
        progress.report(start as f64 / new.len() as f64)?;
        let end = new.len().min(start + block);
        let counts: Vec<usize> = if new.len() < MANY {
            (start..end).map(meets).collect()
        } else {
            (start..end).into_par_iter().map(meets).collect()
        };
        sum += counts.iter().sum::<usize>();
        first = first.or(counts.iter().position(|&count| count > 0).map(|k| start + k));
        if sum >= most.min(MOST) {
            break;
        }
    }
    Ok((sum.min(MOST), first.map(|i| vertices[new[i][0] as usize])))
}

/// The plane of a triangle, to see without exact arithmetic that others lie beside it.
struct Plane {
    corner: DVec3,
    normal: DVec3,
    /// How far rounding can move a product with the normal, for each length from the corner.
    doubt: f64,
}

impl Plane {
    fn of([a, b, c]: [DVec3; 3]) -> Plane {
        // Seven roundings of each of the six products of three differences, which are rounded once themselves.
        const ROUNDING: f64 = 1e-14;
        let (u, v) = (b - a, c - a);
        let doubt = ROUNDING * u.abs().max_element() * v.abs().max_element();
        Plane { corner: a, normal: u.cross(v), doubt }
    }

    /// True if vertices certainly lie all on one side of the plane; false if there are none.
    fn is_beside<'a>(&self, points: impl Iterator<Item = &'a u32>, vertices: &[DVec3]) -> bool {
        /// Products below this may have lost more than roundings.
        const TINY: f64 = 1e-280;
        let (mut above, mut below) = (0, 0);
        for &v in points {
            let d = vertices[v as usize] - self.corner;
            let (side, doubt) = (self.normal.dot(d), self.doubt * d.abs().max_element());
            // Also if something is not a number.
            if doubt.is_nan() || side.abs() <= doubt.max(TINY) || !side.is_finite() {
                return false;
            }
            if side > 0.0 {
                above += 1;
            } else {
                below += 1;
            }
        }
        (above == 0) != (below == 0)
    }
}

/// The new triangles whose boxes meet that of an old one, in order.
fn touching_boxes(
    position: &(impl Fn(u32) -> DVec3 + Sync),
    new: &[[u32; 3]],
    old: &[[u32; 3]],
) -> Vec<[u32; 3]> {
    let around = |t: &[u32; 3]| Box3::around(t.map(position));
    if old.is_empty() {
        return vec![];
    }
    let tree = RTree::bulk_load(old.iter().map(|t| boxed(&around(t), 0)).collect());
    let touches = |t: &&[u32; 3]| {
        let own = around(t);
        let envelope = AABB::from_corners(own.low.into(), own.high.into());
        tree.locate_in_envelope_intersecting(envelope).next().is_some()
    };
    if new.len() < MANY {
        return new.iter().filter(touches).copied().collect();
    }
    new.par_iter().filter(touches).copied().collect()
}

/// True if a patch is a graph over the plane of its loop's mean normal, which proves that it does not meet
/// itself: the projected loop is simple and every triangle is counter-clockwise there (exact for the
/// rounded projection).
pub(crate) fn is_graph(around: &[DVec3], positions: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    let Some(normal) = area_vector(around).try_normalize() else { return false };
    let (e, f) = normal.any_orthonormal_pair();
    let flat = positions.iter().map(|&p| p - around[0]).map(|p| DVec2::new(p.dot(e), p.dot(f)));
    let flat = flat.collect::<Vec<_>>();
    let up = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| flat[v as usize]);
        orientation(a, b, c) > 0.0
    };
    triangles.iter().all(up) && is_simple(&flat[..around.len()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meetings_are_counted_once_and_seams_forgiven() {
        let p = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [-1.0, 0.0, 0.0],
            [0.2, 0.2, -1.0],
            [0.2, 0.2, 1.0],
            [0.3, 0.9, 1.0],
        ]
        .map(DVec3::from);
        let at = |v: u32| p[v as usize];
        let count = |new: &[[u32; 3]], old: &[[u32; 3]]| {
            count_meetings(at, new, old, false, MOST, Progress::NONE).unwrap().0
        };
        assert_eq!(count(&[[0, 1, 2]], &[[3, 4, 5]]), 0);
        assert_eq!(count(&[[0, 1, 2]], &[[6, 7, 8], [3, 4, 5]]), 1);
        assert_eq!(count(&[[0, 1, 2], [6, 7, 8]], &[]), 1);
        assert_eq!(count(&[[3, 4, 5]], &[[6, 7, 8], [0, 1, 2]]), 0);
    }

    #[test]
    fn triangles_that_lie_nowhere_meet_nothing() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let mut points = vec![p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(0.0, 1.0, 0.0)];
        points.extend([p(0.2, 0.2, -1.0), p(0.2, 0.2, 1.0), p(0.3, 0.9, 1.0)]);
        let boxes = [Box3::around(points[..3].iter().copied()), Box3::around([p(5.0, 5.0, 5.0)])];
        let count = |points: &[DVec3]| {
            let at = |v: u32| points[v as usize];
            count_meetings(at, &[[0, 1, 2]], &[[3, 4, 5]], false, MOST, Progress::NONE).unwrap().0
        };
        assert_eq!(count(&points), 1);
        assert_eq!(near_boxes(&boxes, &points, &[[3, 4, 5]])[0], [0]);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for v in 3..6 {
                for axis in 0..3 {
                    let mut broken = points.clone();
                    broken[v][axis] = value;
                    assert_eq!(count(&broken), 0);
                    for several in [&boxes[..1], &boxes[..]] {
                        assert_eq!(near_boxes(several, &broken, &[[3, 4, 5]])[0], [0u32; 0]);
                    }
                }
            }
        }
    }

    #[test]
    fn planes_tell_only_what_is_certain() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Few values, so that much lies in one plane.
            f64::from((state >> 33) as u32 % 7) / 3.0
        };
        let (mut beside, mut meeting) = (0, 0);
        for _ in 0..20_000 {
            let points = (0..6).map(|_| DVec3::new(random(), random(), random())).collect::<Vec<_>>();
            let apart = Plane::of([points[0], points[1], points[2]]).is_beside([3, 4, 5].iter(), &points);
            let area = (points[4] - points[3]).cross(points[5] - points[3]).length();
            let meet = area > 0.0 && triangles_meet(&points, [0, 1, 2], [3, 4, 5]);
            assert!(!(apart && meet), "{points:?}");
            beside += usize::from(apart);
            meeting += usize::from(meet);
        }
        assert!(beside > 5000 && meeting > 500, "{beside} {meeting}");
    }

    #[test]
    fn near_triangles_are_found_for_every_box() {
        let mut positions = vec![];
        let mut triangles = vec![];
        for i in 0..30 {
            for j in 0..30 {
                let p = DVec3::new(f64::from(i), f64::from(j), 0.1 * f64::from((i * j) % 7));
                triangles.push([0, 1, 2].map(|k| positions.len() as u32 + k));
                positions.extend([p, p + DVec3::X, p + DVec3::Y + 0.4 * DVec3::Z]);
            }
        }
        let boxes = [[1.0, 2.0, 0.0], [20.5, 3.2, 0.1], [29.0, 29.0, 0.9], [8.0, 8.0, 5.0]]
            .map(|p| Box3 { low: DVec3::from(p), high: DVec3::from(p) + 1.3 });
        let own = |t: [u32; 3]| Box3::around(t.map(|v| positions[v as usize]));
        let wanted =
            boxes.map(|b| (0..900u32).filter(|&t| own(triangles[t as usize]).meets(&b)).collect::<Vec<_>>());
        assert_eq!(near_boxes(&boxes, &positions, &triangles), wanted);
        assert_eq!(near_boxes(&boxes[1..2], &positions, &triangles), wanted[1..2]);
        assert!(near_boxes(&[], &positions, &triangles).is_empty());
    }
}
