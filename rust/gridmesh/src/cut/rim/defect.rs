//! How far the rebuilt faces along a cut are off the old ones.

use glam::DVec3;
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use rustc_hash::FxHashSet;

use super::nearness::{closest, within};
use super::strip::Strip;
use crate::cut::input::{Polygons, triangles};
use crate::error::Result;
use crate::progress::Progress;

/// Largest distance of the changed triangles from the old surface.
pub(in crate::cut) fn defect(faces: Polygons<'_>, strip: &Strip<'_>, progress: Progress<'_>) -> Result<f64> {
    let mut tree = None;
    let mut most = 0.0f64;
    let parts = strip.parts.iter().flatten();
    for (k, part) in parts.filter(|p| strip.altered.contains(&p.face)).enumerate() {
        if k % 256 == 0 {
            progress.report(1.0)?;
        }
        // The distance from something convex is greatest at corners.
        let own = strip.home(part.home);
        if part.corners.iter().all(|&v| within(strip.position(v), own, most).is_some()) {
            continue;
        }
        for p in strip.samples(part.corners) {
            let mut off = strip.distance(p, part.home, most);
            if off > most.max(strip.tolerance) {
                let tree = tree.get_or_insert_with(|| old_faces(faces, strip));
                off = tree.nearest_neighbor(p.to_array()).map_or(0.0, |f| closest(p, f.0).0);
            }
            most = most.max(off);
        }
    }
    Ok(most)
}

/// The triangles of all faces that the strip had or has.
fn old_faces(faces: Polygons<'_>, strip: &Strip<'_>) -> RTree<Facet> {
    let mut old = vec![];
    let mut known = FxHashSet::default();
    let mut altered = strip.altered.iter().copied().collect::<Vec<_>>();
    altered.sort_unstable();
    for f in strip.parts.iter().flatten().map(|p| p.face).chain(altered) {
        if known.insert(f) {
            triangles(strip.vertices, faces.face(f as usize), |t| old.push(Facet(strip.home(t))));
        }
    }
    RTree::bulk_load(old)
}

/// An old triangle.
struct Facet([DVec3; 3]);

impl RTreeObject for Facet {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let [a, b, c] = self.0;
        AABB::from_corners(a.min(b).min(c).to_array(), a.max(b).max(c).to_array())
    }
}

impl PointDistance for Facet {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let off = closest(DVec3::from_array(*point), self.0).0;
        off * off
    }
}
