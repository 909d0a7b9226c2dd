//! The least number of triangles that can follow a drawing.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::Symmetry;
use crate::error::{Error, Needed, Result};
use crate::options::{CellShape, MAX_TRIANGLES};
use crate::path::outline::Obstacle;
use crate::path::target::Target;
use crate::progress::Progress;
use crate::sketch::job::{Asked, Effort, Job};

/// Work that the search may take, in triangles; an edge of the boundary counts as `EDGE` of them. A second or
/// two, whatever the drawing, and as much for each leap. Where walls get in each other's way the states that searches take count, so many
/// as a triangle: eight million at most, less than a second.
const WORK: f64 = 8e5;
const EDGE: f64 = 20.0;
/// A leap may take more by itself, up to this: three seconds.
const MOST_OF_LEAP: f64 = 2.4e6;
const STATES: f64 = 10.0;

/// Where that work is done and no number was found, so many larger ones are tried, so many steps on: no least number, but one that works.
const LEAPS: usize = 2;
const LEAP: i32 = 9;

/// No number beyond so many times the one asked for, or the last that is hopeless if that is more, is tried, but up to the second in
/// any case: nobody waits for a mesh of half a million faces who asked for two thousand.
const MOST_TIMES: f64 = 40.0;
const MOST_AT_LEAST: f64 = 20_000.0;

/// Sizes are tried in steps of this factor.
const STEP: f64 = 1.1;

impl Job<'_> {
    /// The error for a drawing that has no patch of the size asked for: the least number of
    /// triangles that works, searched in steps of a tenth, a placement or a few each.
    ///
    /// The search ends where a mesh is found, at the largest size there is, where a finer mesh would not be
    /// symmetric though that was asked for, at the largest number that is told, or after a bounded amount of work.
    pub(super) fn least_that_works(
        &mut self,
        asked: f64,
        obstacle: Obstacle,
        progress: Progress<'_>,
    ) -> Result<Error> {
        let triangles = asked.round().max(1.0) as usize;
        let at = |step: i32| (asked.max(6.0) * STEP.powi(step)).ceil() as usize;
        // The largest size, and whether it is the symmetry that allows no larger one.
        let steps = |size: f64| (libm::log(size / asked.max(6.0)) / libm::log(STEP)).floor().max(0.0) as i32;
        let limit = steps(MAX_TRIANGLES);
        let most_symmetric = self.most_symmetric();
        let last = most_symmetric.map_or(limit, |most| steps(most - 1.0).min(limit));
        let mut work = WORK + 4.0 * asked;
        let mut fails = self.last_hopeless(last, at);
        let (mut works, first) = (None, fails);
        // Where the number is left to the drawing all that are allowed are tried.
        let at_least = if self.options.automatic { self.options.max_triangles as f64 } else { MOST_AT_LEAST };
        let farthest = steps((MOST_TIMES * at(first) as f64).max(at_least)).min(last);
        let mut leaps = LEAPS;
        let ahead_of = |job: &Self, step: i32| at(step) as f64 + EDGE * job.boundary_edges(at(step));
        while works.is_none() && fails < last {
            // Small steps first, for drawings that nearly fit; larger ones after them, and leaps where no work is left for more.
            let mut step = (fails + 2 + (fails - first) / 2).min(farthest);
            if work < ahead_of(self, step) && leaps > 0 {
                step = step.max(fails + LEAP).min(farthest);
                leaps -= 1;
                work = WORK.max(ahead_of(self, step).min(MOST_OF_LEAP));
            }
            let ahead = ahead_of(self, step);
            if work < ahead || step <= fails {
                return Ok(Error::TooCoarse {
                    triangles,
                    cells: self.options.cells.plural(),
                    needed: Needed::MoreThan(at(fails)),
                });
            }
            let (does, states) = self.works(at(step), progress)?;
            work -= (states as f64 / STATES).max(ahead);
            if does {
                works = Some(step);
            } else {
                fails = step;
            }
        }
        let Some(mut works) = works else {
            return match most_symmetric {
                Some(most) if last < limit => self.asymmetry(2.0 * most),
                _ => Ok(Error::NoPatch { reason: obstacle.reason, at: obstacle.at.to_array() }),
            };
        };
        while works - fails > 1 {
            let step = (works + fails) / 2;
            if work < ahead_of(self, step) {
                break;
            }
            let (does, states) = self.works(at(step), progress)?;
            work -= (states as f64 / STATES).max(ahead_of(self, step));
            if does {
                works = step;
            } else {
                fails = step;
            }
        }
        Ok(Error::TooCoarse {
            triangles,
            cells: self.options.cells.plural(),
            needed: Needed::Least(at(works)),
        })
    }

    /// The last of the first steps, up to `last`, at which the length of the boundary alone leaves no hope.
    fn last_hopeless(&self, last: i32, at: impl Fn(i32) -> usize) -> i32 {
        // Where the boundary takes more edges there will be no attempt.
        let most_edges = MOST_OF_LEAP / EDGE;
        let (mut hopeless, mut hopeful) = (0, last + 1);
        let mut stride = 1;
        while hopeful - hopeless > 1 {
            let step = if hopeful > last { (hopeless + stride).min(last) } else { (hopeless + hopeful) / 2 };
            let n = at(step);
            if self.boundary_edges(n) > most_edges.max(n as f64) || self.is_hopeless(n) {
                hopeless = step;
                stride *= 2;
            } else {
                hopeful = step;
            }
        }
        hopeless
    }

    /// The number of triangles up to which the drawing is symmetric enough for its edge length, if that is asked for.
    fn most_symmetric(&self) -> Option<f64> {
        let symmetry = self.symmetry.as_ref()?;
        Some(self.area / (self.options.cells.area() * symmetry.least_edge_length().powi(2)))
    }

    /// That a mesh of this many triangles would not be symmetric.
    fn asymmetry(&self, triangles: f64) -> Result<Error> {
        let edge_length = (self.area / (triangles * self.options.cells.area())).sqrt();
        let found = self.options.mirror.map(|mirror| Symmetry::find(&self.contours, mirror, edge_length));
        match found {
            Some(Err(error)) => Ok(error),
            _ => Err(Error::Internal { reason: "the sides of the drawing differ and do not" }),
        }
    }

    /// Whether the first placement at `n` triangles gives a valid patch with little effort, and the states that its searches
    /// took.
    fn works(&mut self, n: usize, progress: Progress<'_>) -> Result<(bool, u64)> {
        progress.report(0.9)?;
        let begun = self.states.taken();
        let does = self.attempt(Asked::Cells(n), Effort::quick(n as f64), progress)?.is_ok();
        Ok((does, self.states.taken() - begun))
    }

    /// Length of the drawing in edges at about `n` triangles.
    fn boundary_edges(&self, n: usize) -> f64 {
        self.contours.iter().map(ClosedCurve::length).sum::<f64>() / self.of_ample(n)
    }

    /// True if `n` cells cannot follow the drawing: a chord-free lattice patch with `b` boundary
    /// vertices has at least `2 b - 6` triangles, and one of quads more than `b`, and a path beside the faired contours is not much shorter
    /// than they are.
    pub(super) fn is_hopeless(&self, n: usize) -> bool {
        const SHORTER: f64 = 0.7;
        let lattice = self.lattice(self.of_ample(n), 0.0, DVec2::ZERO);
        // The number of samples alone shows the worst cases; no need to take them.
        let edges = self.boundary_edges(n);
        let needed = |edges: f64| match self.options.cells {
            CellShape::Triangle => 2.0 * SHORTER * edges - 6.0 * self.contours.len() as f64,
            // One quad in the belt for each edge, and what a path of so many edges encloses at least.
            CellShape::Quad => SHORTER * edges,
        };
        if needed(edges) <= n as f64 {
            return false;
        }
        if edges > 20.0 * n as f64 {
            return true;
        }
        let faired: f64 = self
            .contours
            .iter()
            .map(|contour| {
                let points = Target::new(contour, &lattice).points;
                (0..points.len()).map(|i| points[i].distance(points[(i + 1) % points.len()])).sum::<f64>()
            })
            .sum();
        needed(faired) > n as f64
    }
}
