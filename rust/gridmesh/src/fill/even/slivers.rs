//! Thin triangles and short edges of a finished surface are taken out one at a time, as far as nothing meets by it.
//!
//! Where a surface was taken back since it met something, its triangles are those that the way back has left: some with hardly an
//! angle. Flips, collapses and moves of their vertices are tried; what makes the worst triangle among those that change the best is done.

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::local::{GONE, Local, quality};
use super::untangle::Near;
use crate::error::Result;
use crate::geometry::embed::triangles_meet;
use crate::progress::Progress;

/// Triangles below this quality, about 20 degrees, are worth a change.
const THIN: f64 = 0.55;

/// Edges shorter than this, in wanted lengths, are worth one as well: 4 to 1 is where edges stand out from those around.
const SHORT: f64 = 0.3;

/// A change must gain so much.
const GAIN: f64 = 0.02;

/// No edge gets longer by a collapse, in wanted lengths.
const LONGEST: f64 = 1.8;

/// Rounds over all thin triangles.
const ROUNDS: usize = 6;

/// Lengths of moves that are tried, in wanted edge lengths, and directions within the surface.
const STEPS: [f64; 3] = [0.3, 0.12, 0.04];
const WAYS: usize = 8;

/// Edges around a tunnel that are tried, in wanted lengths.
const WIDE: [f64; 4] = [0.8, 0.6, 0.4, 0.2];

type Boxed = GeomWithData<Rectangle<[f64; 3]>, u32>;

/// What can be done about a thin triangle.
enum Change {
    /// The first vertex goes into the second.
    Collapse([u32; 2]),
    Flip,
    Move(Vec<(u32, DVec3)>),
}

/// A change with the triangles that it takes away and those that it makes.
struct Trial {
    change: Change,
    old: Vec<u32>,
    new: Vec<[u32; 3]>,
    /// The quality of the worst new one.
    worst: f64,
}

/// Makes the worst triangles rounder and takes edges out that are much too short. Nothing may meet before; nothing does afterwards.
/// Meshes with hard lines stay as they are.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(crate) fn mend_slivers(local: &mut Local, near: &Near, progress: Progress<'_>) -> Result<()> {
    if !local.hard.is_empty() || !(0..local.triangles.len() as u32).any(|t| is_bad(local, t)) {
        return Ok(());
    }
    let mut mender = Mender::new(local.clone(), near);
    for round in 0..ROUNDS {
        let mut bad = mender.live().filter(|&t| is_bad(&mender.local, t)).collect::<Vec<_>>();
        let worst = |t: &u32| quality(mender.local.corners(*t));
        bad.sort_by(|s, t| worst(s).total_cmp(&worst(t)).then(s.cmp(t)));
        let mut changed = false;
        for (k, &t) in bad.iter().enumerate() {
            progress.report((round as f64 + k as f64 / bad.len() as f64) / ROUNDS as f64)?;
            changed |= mender.mend(t);
        }
        if !changed {
            break;
        }
    }
    *local = mender.local;
    local.compact();
    Ok(())
}

fn is_bad(local: &Local, t: u32) -> bool {
    let own = local.triangles[t as usize];
    let short = |k: usize| {
        let e = [own[k], own[(k + 1) % 3]];
        local.length(e) < SHORT && e.iter().any(|&v| v as usize >= local.border)
    };
    quality(local.corners(t)) < THIN || (0..3).any(short)
}

struct Mender {
    local: Local,
    /// Positions of the mesh and of what is near, and the triangles of what is near.
    points: Vec<DVec3>,
    around: Vec<[u32; 3]>,
    /// Boxes of the mesh's triangles; then of those that are near, from that number on.
    tree: RTree<Boxed>,
    first: u32,
}

impl Mender {
    fn new(local: Local, near: &Near) -> Mender {
        let first = local.triangles.len() as u32;
        let (points, around) = near.beside(&local);
        let mut mender = Mender { local, points, around, tree: RTree::new(), first };
        let own = mender.local.triangles.iter().chain(&mender.around).enumerate();
        let boxes = own.filter(|(_, t)| **t != GONE).map(|(k, &t)| mender.boxed(t, k as u32)).collect();
        mender.tree = RTree::bulk_load(boxes);
        mender
    }

    fn live(&self) -> impl Iterator<Item = u32> {
        (0..self.local.triangles.len() as u32).filter(|&t| self.local.triangles[t as usize] != GONE)
    }

    fn boxed(&self, t: [u32; 3], number: u32) -> Boxed {
        let [a, b, c] = t.map(|v| self.points[v as usize]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        GeomWithData::new(Rectangle::from_corners(low.to_array(), high.to_array()), number)
    }

    /// Does what helps a triangle most; whether there was something.
    fn mend(&mut self, t: u32) -> bool {
        if self.local.triangles[t as usize] == GONE || !is_bad(&self.local, t) {
            return false;
        }
        let own = self.local.triangles[t as usize];
        let mut trials = vec![];
        for k in 0..3 {
            let [a, b, _] = [0, 1, 2].map(|i| own[(k + i) % 3]);
            for e in [[a, b], [b, a]] {
                trials.extend(self.collapsed(e));
            }
            trials.extend(self.flipped([a, b]));
            trials.extend(self.moved(a));
            trials.extend(self.widened([a, b]));
        }
        // Of equal ones the first.
        trials.sort_by(|s, t| t.worst.total_cmp(&s.worst));
        let found = trials.into_iter().find(|trial| self.is_free(trial));
        found.is_some_and(|trial| self.apply(trial))
    }

    fn normal(&self, t: [u32; 3]) -> DVec3 {
        let [a, b, c] = t.map(|v| self.points[v as usize]);
        (b - a).cross(c - a)
    }

    fn quality(&self, t: [u32; 3]) -> f64 {
        quality(t.map(|v| self.points[v as usize]))
    }

    /// A change, if it gains enough, and all new triangles face as the old ones do.
    fn trial(&self, change: Change, old: Vec<u32>, new: Vec<[u32; 3]>, extra: f64) -> Option<Trial> {
        let before = old.iter().map(|&t| self.local.triangles[t as usize]);
        let up = before.clone().map(|t| self.normal(t)).sum::<DVec3>();
        let was = before.map(|t| self.quality(t)).fold(1.0, f64::min);
        let facing = new.iter().all(|&t| self.normal(t).dot(up) > 0.0);
        let worst = new.iter().map(|&t| self.quality(t)).fold(1.0, f64::min);
        (facing && worst > was.min(THIN) + GAIN - extra).then_some(Trial { change, old, new, worst })
    }

    fn collapsed(&self, [a, b]: [u32; 2]) -> Option<Trial> {
        let local = &self.local;
        if (a as usize) < local.border {
            return None;
        }
        let old = local.fan(a).to_vec();
        let stays = old.iter().map(|&t| local.triangles[t as usize]).filter(|t| !t.contains(&b));
        let new = stays.map(|t| t.map(|v| if v == a { b } else { v })).collect();
        // A short edge may go without gain.
        let extra = if local.length([a, b]) < SHORT { 2.0 * GAIN } else { 0.0 };
        self.trial(Change::Collapse([a, b]), old, new, extra)
    }

    fn flipped(&self, e: [u32; 2]) -> Option<Trial> {
        let (old, new) = self.local.flipped(e)?;
        self.trial(Change::Flip, old.to_vec(), new.to_vec(), 0.0)
    }

    /// The best of some moves of a vertex, along the surface and across it.
    fn moved(&mut self, v: u32) -> Option<Trial> {
        if (v as usize) < self.local.border {
            return None;
        }
        let old = self.local.fan(v).to_vec();
        let normals = old.iter().map(|&t| self.normal(self.local.triangles[t as usize]));
        let up = normals.sum::<DVec3>().try_normalize()?;
        let (e, f) = up.any_orthonormal_pair();
        let (here, size) = (self.points[v as usize], self.local.sizes[v as usize]);
        let moves = STEPS.into_iter().flat_map(|step| {
            (0..WAYS).map(move |way| {
                let t = std::f64::consts::TAU * way as f64 / WAYS as f64;
                vec![(v, here + step * size * (libm::cos(t) * e + libm::sin(t) * f))]
            })
        });
        let ups = vec![up; old.len()];
        self.best_of(moves, old, &ups)
    }

    /// The best of some moves, if it gains enough; triangles face as `ups` do.
    fn best_of(
        &mut self,
        moves: impl Iterator<Item = Vec<(u32, DVec3)>>,
        old: Vec<u32>,
        ups: &[DVec3],
    ) -> Option<Trial> {
        let new = old.iter().map(|&t| self.local.triangles[t as usize]).collect::<Vec<_>>();
        let mut best = (new.iter().map(|&t| self.quality(t)).fold(1.0, f64::min) + GAIN, None);
        for moved in moves {
            let here = self.placed(&moved);
            let facing = new.iter().zip(ups).all(|(&t, up)| self.normal(t).dot(*up) > 0.0);
            let worst = new.iter().map(|&t| self.quality(t)).fold(1.0, f64::min);
            if facing && worst > best.0 {
                best = (worst, Some(moved));
            }
            self.placed(&here);
        }
        Some(Trial { change: Change::Move(best.1?), old, new, worst: best.0 })
    }

    /// Puts vertices to places, and returns where they were.
    fn placed(&mut self, places: &[(u32, DVec3)]) -> Vec<(u32, DVec3)> {
        let put = |&(v, p): &(u32, DVec3)| (v, std::mem::replace(&mut self.points[v as usize], p));
        places.iter().map(put).collect()
    }

    /// Around a tunnel, or a thread, three edges wide none of them can go: it is made wider.
    fn widened(&mut self, [a, b]: [u32; 2]) -> Option<Trial> {
        let local = &self.local;
        if local.length([a, b]) > SHORT {
            return None;
        }
        let apexes = local.beside([a, b]).into_iter().map(|t| local.apex(t, [a, b])).collect::<Vec<_>>();
        let (near, other) = (local.neighbours(a), local.neighbours(b));
        let way = |c: u32| local.length([a, c]) + local.length([b, c]);
        let beyond = near.into_iter().filter(|c| other.contains(c) && !apexes.contains(c));
        let c = beyond.min_by(|&c, &d| way(c).total_cmp(&way(d)).then(c.cmp(&d)))?;
        let ring = [a, b, c].into_iter().filter(|&v| v as usize >= local.border).collect::<Vec<_>>();
        let centre = [a, b, c].into_iter().map(|v| self.points[v as usize]).sum::<DVec3>() / 3.0;
        let length = (local.length([a, b]) + way(c)) / 3.0;
        let mut old = ring.iter().flat_map(|&v| local.fan(v)).copied().collect::<Vec<_>>();
        old.sort_unstable();
        old.dedup();
        let ups = old.iter().map(|&t| self.normal(local.triangles[t as usize])).collect::<Vec<_>>();
        let here = ring.iter().map(|&v| (v, self.points[v as usize])).collect::<Vec<_>>();
        let moves = WIDE
            .into_iter()
            .map(|wide| here.iter().map(|&(v, p)| (v, centre + (p - centre) * (wide / length))).collect());
        self.best_of(moves, old, &ups)
    }

    /// Whether no new triangle meets anything.
    fn is_free(&mut self, trial: &Trial) -> bool {
        let back = match &trial.change {
            Change::Move(moved) => self.placed(moved),
            _ => vec![],
        };
        let meets = |t: [u32; 3]| {
            let rectangle = *self.boxed(t, 0).geom();
            let envelope = AABB::from_corners(rectangle.lower(), rectangle.upper());
            self.tree.locate_in_envelope_intersecting(envelope).any(|hit| {
                let k = hit.data;
                let other = if k < self.first {
                    self.local.triangles[k as usize]
                } else {
                    self.around[(k - self.first) as usize]
                };
                !trial.old.contains(&k) && triangles_meet(&self.points, t, other)
            })
        };
        let pairs = |k: usize| {
            trial.new[k + 1..].iter().any(|&other| triangles_meet(&self.points, trial.new[k], other))
        };
        let free = !trial.new.iter().any(|&t| meets(t)) && !(0..trial.new.len()).any(pairs);
        self.placed(&back);
        free
    }

    fn apply(&mut self, trial: Trial) -> bool {
        let gone =
            trial.old.iter().map(|&t| self.boxed(self.local.triangles[t as usize], t)).collect::<Vec<_>>();
        let done = match trial.change {
            Change::Collapse([a, b]) => self.local.collapse(a, b, LONGEST),
            Change::Flip => {
                let &[s, t] = trial.old.as_slice() else { return false };
                let &[x, y] = trial.new.as_slice() else { return false };
                self.local.flip([s, t], [x, y]);
                true
            }
            Change::Move(moved) => {
                moved.iter().for_each(|&(v, p)| self.local.positions[v as usize] = p);
                self.placed(&moved);
                true
            }
        };
        if done {
            for gone in &gone {
                self.tree.remove(gone);
            }
            for t in trial.old {
                let own = self.local.triangles[t as usize];
                if own != GONE {
                    self.tree.insert(self.boxed(own, t));
                }
            }
        }
        done
    }
}

#[cfg(test)]
#[path = "slivers_tests.rs"]
mod tests;
