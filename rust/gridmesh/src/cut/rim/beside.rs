//! Old edges that run along the line, close to it, get vertices as far apart as those of the line.
//!
//! Between the line and such an edge there is no room for anything but a strip of triangles from one to the other: the rim of a
//! thin plate that is split in its thickness.

use std::collections::BTreeSet;

use glam::DVec3;
use rstar::primitives::Line;
use rstar::{PointDistance, RTree};

use super::strip::Strip;
use crate::cut::rim::flip_all;
use crate::error::Result;
use crate::progress::Progress;

/// Edges longer than this get vertices, in edge lengths.
const LONG: f64 = 1.6;

/// Where they are nearer to the line than this, in edge lengths.
const NEAR: f64 = 0.5;

/// Steps of an edge that can still be told apart as shares of it.
const MOST_STEPS: f64 = 1e15;

/// Puts vertices on the long old edges beside the line where they are near it, and joins them with it.
pub(in crate::cut) fn divide(strip: &mut Strip<'_>, length: f64, progress: Progress<'_>) -> Result<()> {
    let n_old = strip.parted.n_old as u32;
    let mut long = vec![];
    for part in strip.parts.iter().flatten().filter(|p| p.corners.iter().any(|&v| v >= n_old)) {
        for k in 0..3 {
            let (a, b) = (part.corners[k], part.corners[(k + 1) % 3]);
            if a.max(b) < n_old
                && !strip.is_cut(a, b)
                && strip.position(a).distance(strip.position(b)) > LONG * length
            {
                long.push((a.min(b), a.max(b)));
            }
        }
    }
    if long.is_empty() {
        return Ok(());
    }
    long.sort_unstable();
    long.dedup();
    let at = |strip: &Strip<'_>, v: u32| strip.position(v).to_array();
    let mut edges = strip.parted.cut.keys().copied().collect::<Vec<_>>();
    edges.sort_unstable();
    let line = edges.into_iter().map(|(a, b)| Line::new(at(strip, a), at(strip, b)));
    let line = RTree::bulk_load(line.collect());
    let near = NEAR * length * NEAR * length;
    let around = line.root().envelope();
    let low = DVec3::from_array(around.lower()) - NEAR * length;
    let high = DVec3::from_array(around.upper()) + NEAR * length;
    let wanted = long.into_iter().filter_map(|(a, b)| {
        let (p, q) = (strip.position(a), strip.position(b));
        let steps = (p.distance(q) / length).round().clamp(2.0, MOST_STEPS);
        // An edge may be millions of times longer than the line.
        let (from, to) = within(p, q, low, high)?;
        let (first, last) =
            ((from * steps).ceil().max(1.0) as u64, (to * steps).floor().min(steps - 1.0) as u64);
        let is_near = |k: &u64| {
            let place = p.lerp(q, *k as f64 / steps).to_array();
            line.nearest_neighbor(place).is_some_and(|l| l.distance_2(&place) < near)
        };
        let places = (first..=last).filter(is_near).collect::<Vec<_>>();
        let steps = steps as u64;
        (!places.is_empty()).then(|| Edge { steps, made: vec![(0, a), (steps, b)], places })
    });
    let mut edges = wanted.collect::<Vec<_>>();
    // The middle ones first, so that each has few edges to turn on its way to the line.
    // All of them a step further, not the first alone.
    let mut looked_at = (0..strip.parts.len() as u32).collect::<BTreeSet<_>>();
    loop {
        let from = strip.fresh.len();
        if edges.iter_mut().filter_map(|edge| edge.divide(strip).then_some(())).count() == 0 {
            return Ok(());
        }
        looked_at.extend(strip.changed_since(from));
        flip_all(strip, std::mem::take(&mut looked_at), progress)?;
    }
}

/// The stretch of the segment from `p` to `q` that is inside a box, as shares of the segment.
fn within(p: DVec3, q: DVec3, low: DVec3, high: DVec3) -> Option<(f64, f64)> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (start, step) = (p[axis], q[axis] - p[axis]);
        if step == 0.0 {
            if start < low[axis] || start > high[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((low[axis] - start) / step, (high[axis] - start) / step);
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    (from <= to).then_some((from, to))
}

/// A long edge on its way to its vertices.
struct Edge {
    steps: u64,
    /// Places of its vertices so far, in steps, and the vertices.
    made: Vec<(u64, u32)>,
    /// Places that vertices are still to be at.
    places: Vec<u64>,
}

impl Edge {
    /// Puts a vertex into the middle of every stretch that still gets some; false if there is none.
    fn divide(&mut self, strip: &mut Strip<'_>) -> bool {
        let (mut made, mut left, mut any) = (vec![], vec![], false);
        for pair in self.made.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            made.push((from, a));
            let own = self.places.iter().copied().filter(|k| (from + 1..to).contains(k)).collect::<Vec<_>>();
            let Some(&middle) = own.get(own.len() / 2) else { continue };
            let share = (middle - from) as f64 / (to - from) as f64;
            if let Some(m) = strip.split(a, b, share) {
                made.push((middle, m));
                left.extend(own.into_iter().filter(|&k| k != middle));
                any = true;
            }
        }
        made.push((self.steps, self.made[self.made.len() - 1].1));
        (self.made, self.places) = (made, left);
        any
    }
}
