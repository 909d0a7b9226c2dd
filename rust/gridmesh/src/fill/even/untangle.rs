//! Surfaces that meet nothing: a smoothed one is taken back where it does (`untangle`), folds are drawn flat (`unfold`).

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashMap;

use super::local::Local;
use super::remesh::{flip_valences, mend_thin};
use crate::error::Result;
use crate::fill::surface::meet::{Box3, near_boxes};
use crate::geometry::embed::triangles_meet;
use crate::progress::Progress;

/// Rounds at most.
const ROUNDS: usize = 7;

/// What is left of the smoothing, each round, at vertices of triangles that meet something, and at one and two edges from them.
const LEFT: [f64; 3] = [0.4, 0.6, 0.8];

/// Less of the smoothing than this is none.
const NOTHING: f64 = 0.05;

/// Rounds of drawing flat, and steps in each.
const UNFOLDED: usize = 8;
const DRAWN: usize = 30;

/// Triangles of the mesh near a patch.
#[derive(Default)]
pub(crate) struct Near {
    /// Vertices that are not the patch's.
    positions: Vec<DVec3>,
    /// Numbers below that of the border's vertices are the patch's, the others those above.
    triangles: Vec<[u32; 3]>,
    /// Their boxes: a patch is looked at many times, and what is near stays.
    boxes: RTree<Boxed>,
}

type Boxed = GeomWithData<Rectangle<[f64; 3]>, u32>;

fn boxed(number: usize, corners: [DVec3; 3]) -> Boxed {
    let own = Box3::around(corners);
    Boxed::new(Rectangle::from_corners(own.low.to_array(), own.high.to_array()), number as u32)
}

impl Near {
    /// Those whose boxes meet that of the patch. `place`: the numbers of vertices in the patch's border.
    pub fn new(
        around: Box3,
        vertices: &[DVec3],
        triangles: &[[u32; 3]],
        place: &FxHashMap<u32, u32>,
    ) -> Near {
        let found = near_boxes(&[around], vertices, triangles);
        let mut near = Near::default();
        let mut number = place.clone();
        for &t in &found[0] {
            let named = triangles[t as usize].map(|v| {
                *number.entry(v).or_insert_with(|| {
                    near.positions.push(vertices[v as usize]);
                    (place.len() + near.positions.len()) as u32 - 1
                })
            });
            near.triangles.push(named);
        }
        let corners = found[0].iter().map(|&t| triangles[t as usize].map(|v| vertices[v as usize]));
        near.boxes = RTree::bulk_load(corners.enumerate().map(|(k, corners)| boxed(k, corners)).collect());
        near
    }

    /// The positions of a patch and of what is near, and the triangles of what is near between them.
    pub(super) fn beside(&self, local: &Local) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (border, own) = (local.border as u32, local.positions.len() as u32);
        let named = |v: u32| if v < border { v } else { v - border + own };
        let triangles = self.triangles.iter().map(|t| t.map(named)).collect();
        ([&local.positions[..], &self.positions[..]].concat(), triangles)
    }
}

/// The triangles of a patch that meet others of it, or what is near, elsewhere than in shared vertices and edges (exact
/// predicates).
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn tangled(local: &Local, near: &Near, progress: Progress<'_>) -> Result<Vec<u32>> {
    let (vertices, around) = near.beside(local);
    let corners = |t: &[u32; 3]| t.map(|v| vertices[v as usize]);
    let finite = |t: &[u32; 3]| t.iter().all(|&v| vertices[v as usize].is_finite());
    let own = local.triangles.iter().enumerate().filter(|(_, t)| finite(t));
    let tree = RTree::bulk_load(own.map(|(k, t)| boxed(k, corners(t))).collect());
    let n = local.triangles.len();
    let mut bad = vec![false; n];
    for (i, &t) in local.triangles.iter().enumerate() {
        if i % 64 == 0 {
            progress.report(i as f64 / n as f64)?;
        }
        if !finite(&t) {
            bad[i] = true;
            continue;
        }
        let own = Box3::around(corners(&t));
        let envelope = AABB::from_corners(own.low.to_array(), own.high.to_array());
        for hit in tree.locate_in_envelope_intersecting(envelope) {
            let k = hit.data as usize;
            if k > i && triangles_meet(&vertices, t, local.triangles[k]) {
                (bad[i], bad[k]) = (true, true);
            }
        }
        let mut beside = near.boxes.locate_in_envelope_intersecting(envelope);
        bad[i] = bad[i] || beside.any(|hit| triangles_meet(&vertices, t, around[hit.data as usize]));
    }
    Ok((0..n as u32).filter(|&t| bad[t as usize]).collect())
}

/// Moves vertices near triangles that meet something towards where they were on a surface that did not, as far as needed;
/// `mend` is done each time before. Leaves the best state found and gives its triangles that meet something.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn untangle(
    local: &mut Local,
    before: &[DVec3],
    near: &Near,
    mend: impl Fn(&mut Local),
    progress: Progress<'_>,
) -> Result<Vec<u32>> {
    let smooth = local.positions.clone();
    let mut share = vec![1.0; smooth.len()];
    let mut best: Option<(Vec<u32>, Vec<DVec3>)> = None;
    for round in 0..ROUNDS {
        let part = progress.part(round as f64 / ROUNDS as f64, (round + 1) as f64 / ROUNDS as f64);
        for v in local.border..smooth.len() {
            local.positions[v] = before[v].lerp(smooth[v], share[v]);
        }
        mend(local);
        let bad = tangled(local, near, part)?;
        let zone = rings(local, &bad, LEFT.len());
        if best.as_ref().is_none_or(|best| bad.len() < best.0.len()) {
            best = Some((bad, local.positions.clone()));
        }
        if zone.iter().all(|&(v, ring)| ring > 0 || share[v as usize] == 0.0) {
            break;
        }
        for (v, ring) in zone {
            let own = &mut share[v as usize];
            *own = if *own * LEFT[ring] < NOTHING { 0.0 } else { *own * LEFT[ring] };
        }
    }
    let (bad, positions) = best.unwrap_or_default();
    local.positions = positions;
    Ok(bad)
}

/// Draws the surface flat where it has folds or meets something, wider each round, and flips edges there. Leaves the best state found.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn unfold(local: &mut Local, near: &Near, progress: Progress<'_>) -> Result<()> {
    let mut best: Option<(usize, Local)> = None;
    for round in 0..=UNFOLDED {
        let part =
            progress.part(round as f64 / (UNFOLDED + 1) as f64, (round + 1) as f64 / (UNFOLDED + 1) as f64);
        let mut bad = tangled(local, near, part)?;
        bad.extend(folded(local));
        if best.as_ref().is_none_or(|best| bad.len() < best.0) {
            best = Some((bad.len(), local.clone()));
        }
        if bad.is_empty() || round == UNFOLDED {
            break;
        }
        let zone = rings(local, &bad, 3 + round);
        for _ in 0..DRAWN {
            for &(v, _) in &zone {
                let near = local.neighbours(v);
                let sum = near.iter().map(|&u| local.positions[u as usize]).sum::<DVec3>();
                local.positions[v as usize] = local.positions[v as usize].lerp(sum / near.len() as f64, 0.7);
            }
        }
        flip_valences(local);
        mend_thin(local);
    }
    if let Some((_, state)) = best {
        *local = state;
    }
    Ok(())
}

/// Triangles more than 120 degrees from a neighbour.
fn folded(local: &Local) -> Vec<u32> {
    let normal = |t: u32| {
        let [a, b, c] = local.corners(t);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let normals = (0..local.triangles.len() as u32).map(normal).collect::<Vec<_>>();
    let mut found = vec![];
    for e in local.edges() {
        if let &[s, t] = local.beside(e).as_slice()
            && normals[s as usize].dot(normals[t as usize]) < -0.5
        {
            found.extend([s, t]);
        }
    }
    found
}

/// The vertices of triangles, and those less than so many edges away, each once with that number.
fn rings(local: &Local, triangles: &[u32], count: usize) -> Vec<(u32, usize)> {
    let mut seen = vec![false; local.positions.len()];
    let mut found = vec![];
    let mut add = |v: u32, ring: usize, found: &mut Vec<(u32, usize)>| {
        if !std::mem::replace(&mut seen[v as usize], true) {
            found.push((v, ring));
        }
    };
    triangles.iter().flat_map(|&t| local.triangles[t as usize]).for_each(|v| add(v, 0, &mut found));
    let mut from = 0;
    for ring in 1..count {
        let to = found.len();
        for k in from..to {
            local.neighbours(found[k].0).into_iter().for_each(|u| add(u, ring, &mut found));
        }
        from = to;
    }
    found.retain(|&(v, _)| v as usize >= local.border);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::even::local::tests::sheet;

    #[test]
    fn a_fold_is_drawn_flat() {
        let mut local = sheet(20);
        let inside = |p: &DVec3| p.x > 8.5 && p.x < 12.5 && p.y > 8.5 && p.y < 12.5;
        for p in local.positions[80..].iter_mut().filter(|p| inside(p)) {
            p.x = 21.0 - p.x;
        }
        assert!(!tangled(&local, &Near::default(), Progress::NONE).unwrap().is_empty());
        unfold(&mut local, &Near::default(), Progress::NONE).unwrap();
        assert!(tangled(&local, &Near::default(), Progress::NONE).unwrap().is_empty());
        assert!(folded(&local).is_empty());
        // What is far from it stays.
        assert!(local.positions.contains(&DVec3::new(1.0, 1.0, 0.0)));
    }

    #[test]
    fn a_bump_through_a_wall_is_taken_back_and_another_stays() {
        let mut local = sheet(12);
        let flat = local.positions.clone();
        let bump = |p: DVec3, x: f64| 2.0 * (-(p.x - x).powi(2) - (p.y - 6.0).powi(2)).exp();
        for p in &mut local.positions[48..] {
            p.z = bump(*p, 3.0) + bump(*p, 9.0);
        }
        let wall = [DVec3::new(1.0, 0.0, 1.0), DVec3::new(5.0, 0.0, 1.0), DVec3::new(3.0, 20.0, 1.0)];
        let around = Box3::around(local.positions.iter().copied());
        let near = Near::new(around, &wall, &[[0, 1, 2]], &FxHashMap::default());
        let near = Near { triangles: near.triangles.iter().map(|t| t.map(|v| v + 48)).collect(), ..near };
        assert!(!tangled(&local, &near, Progress::NONE).unwrap().is_empty());
        let bad = untangle(&mut local, &flat, &near, |_| {}, Progress::NONE).unwrap();
        assert!(bad.is_empty() && tangled(&local, &near, Progress::NONE).unwrap().is_empty());
        let height = |x: f64| {
            let there = local.positions.iter().filter(|p| (p.x - x).abs() < 2.5);
            there.map(|p| p.z).fold(0.0, f64::max)
        };
        assert!((height(9.0) - 2.0).abs() < 1e-9 && height(3.0) < 1.0, "{} {}", height(9.0), height(3.0));
    }
}
