//! Whether new triangles meet each other or the mesh.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::mesh::{CHUNK, in_chunks};
use super::unroll::{area_vector, is_simple};
use crate::embed::triangles_meet;
use crate::segments::orientation;

/// Cells along each axis of the grid that tells which boxes may be near.
const CELLS: usize = 48;

/// Meetings that are counted at most.
pub(crate) const MOST: usize = 100_000;

/// Triangles between two looks at how many meetings there are.
const BLOCK: usize = 4096;

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

/// For each box the triangles of a mesh whose own boxes meet it, ascending. One pass over the mesh.
pub(crate) fn near_boxes(boxes: &[Box3], positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut near = vec![vec![]; boxes.len()];
    let all = Box3::around(boxes.iter().flat_map(|b| [b.low, b.high]));
    // Cells that some box meets; a triangle that meets none of them is near no box.
    let size = ((all.high - all.low) / CELLS as f64).max(DVec3::splat(f64::MIN_POSITIVE));
    let cell =
        |p: DVec3| ((p - all.low) / size).clamp(DVec3::ZERO, DVec3::splat(CELLS as f64 - 1.0)).as_uvec3();
    let several = boxes.len() > 1;
    let mut taken = vec![false; if several { CELLS * CELLS * CELLS } else { 0 }];
    let place = |x: u32, y: u32, z: u32| (z as usize * CELLS + y as usize) * CELLS + x as usize;
    if several {
        for b in boxes {
            let (low, high) = (cell(b.low), cell(b.high));
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    taken[place(low.x, y, z)..=place(high.x, y, z)].fill(true);
                }
            }
        }
    }
    let sides: Vec<u8> = if positions.len() <= CHUNK {
        positions.iter().map(|&p| all.side(p)).collect()
    } else {
        positions.par_iter().with_min_len(CHUNK).map(|&p| all.side(p)).collect()
    };
    let scan = |(part, chunk): (usize, &[[u32; 3]])| {
        let mut found = vec![];
        for (k, t) in chunk.iter().enumerate() {
            if t.iter().fold(u8::MAX, |side, &v| side & sides[v as usize]) != 0 {
                continue;
            }
            if several {
                let own = Box3::around(t.map(|v| positions[v as usize]));
                let (low, high) = (cell(own.low), cell(own.high));
                let hit = (low.z..=high.z).any(|z| {
                    (low.y..=high.y).any(|y| taken[place(low.x, y, z)..=place(high.x, y, z)].contains(&true))
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
        for hit in tree.locate_in_envelope_intersecting(&envelope) {
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
/// all along, and means nothing by it. Counting ends at [`MOST`]: in a tangle every triangle meets every
/// other. `apart`: the new triangles are known not to meet each other.
pub(crate) fn count_meetings(
    position: impl Fn(u32) -> DVec3 + Sync,
    new: &[[u32; 3]],
    old: &[[u32; 3]],
    apart: bool,
) -> (usize, Option<DVec3>) {
    let kept;
    let new = if apart && new.len() >= MANY {
        kept = touching_boxes(&position, new, old);
        kept.as_slice()
    } else {
        new
    };
    let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut ids = new.iter().chain(old).flatten().copied().collect::<Vec<_>>();
    ids.sort_unstable();
    ids.dedup();
    let mut points = ids.iter().map(|&v| (key(position(v)), v)).collect::<Vec<_>>();
    points.sort_unstable();
    let mut place = vec![0u32; ids.len()];
    let mut vertices = vec![];
    for same in points.chunk_by(|a, b| a.0 == b.0) {
        for &(_, v) in same {
            place[ids.binary_search(&v).unwrap_or_default()] = vertices.len() as u32;
        }
        vertices.push(position(same[0].1));
    }
    let renumber = |t: &[u32; 3]| t.map(|v| place[ids.binary_search(&v).unwrap_or_default()]);
    let sound = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    let new = new.iter().map(renumber).filter(sound).collect::<Vec<_>>();
    let old = old.iter().map(renumber).filter(sound).collect::<Vec<_>>();
    let around = |t: &[u32; 3]| Box3::around(t.map(|v| vertices[v as usize]));
    // The old triangles, and the new ones if they have to be compared with each other, by their number
    // after the old ones.
    let mut items = old.iter().enumerate().map(|(i, t)| boxed(&around(t), i as u32)).collect::<Vec<_>>();
    if !apart {
        let number = |i: usize| (old.len() + i) as u32;
        items.extend(new.iter().enumerate().map(|(i, t)| boxed(&around(t), number(i))));
    }
    if items.is_empty() {
        return (0, None);
    }
    let tree = RTree::bulk_load(items);
    let meets = |i: usize| -> usize {
        let own = around(&new[i]);
        let envelope = AABB::from_corners(own.low.into(), own.high.into());
        let hits = tree.locate_in_envelope_intersecting(&envelope).filter(|hit| {
            let k = hit.data as usize;
            match k.checked_sub(old.len()) {
                Some(j) => j > i && triangles_meet(&vertices, new[i], new[j]),
                None => triangles_meet(&vertices, new[i], old[k]),
            }
        });
        hits.count()
    };
    let (mut sum, mut first) = (0, None);
    for start in (0..new.len()).step_by(BLOCK) {
        let block = start..new.len().min(start + BLOCK);
        let counts: Vec<usize> = if new.len() < MANY {
            block.map(meets).collect()
        } else {
            block.into_par_iter().map(meets).collect()
        };
        sum += counts.iter().sum::<usize>();
        first = first.or(counts.iter().position(|&count| count > 0).map(|k| start + k));
        if sum >= MOST {
            break;
        }
    }
    (sum.min(MOST), first.map(|i| vertices[new[i][0] as usize]))
}

/// The new triangles whose boxes meet that of an old one, in order.
fn touching_boxes(
    position: &(impl Fn(u32) -> DVec3 + Sync),
    new: &[[u32; 3]],
    old: &[[u32; 3]],
) -> Vec<[u32; 3]> {
    let around = |t: &[u32; 3]| Box3::around(t.map(position));
    let tree = RTree::bulk_load(old.iter().map(|t| boxed(&around(t), 0)).collect());
    let touches = |t: &&[u32; 3]| {
        let own = around(t);
        let envelope = AABB::from_corners(own.low.into(), own.high.into());
        tree.locate_in_envelope_intersecting(&envelope).next().is_some()
    };
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
        assert_eq!(count_meetings(at, &[[0, 1, 2]], &[[3, 4, 5]], false).0, 0);
        assert_eq!(count_meetings(at, &[[0, 1, 2]], &[[6, 7, 8], [3, 4, 5]], false).0, 1);
        assert_eq!(count_meetings(at, &[[0, 1, 2], [6, 7, 8]], &[], false).0, 1);
        assert_eq!(count_meetings(at, &[[3, 4, 5]], &[[6, 7, 8], [0, 1, 2]], false).0, 0);
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
