//! The least number of triangles that can follow a drawing.

use glam::DVec2;

use super::{Asked, Effort, Job};
use crate::curve::ClosedCurve;
use crate::error::{Error, Result};
use crate::outline::Obstacle;
use crate::progress::Progress;
use crate::target::Target;

impl Job<'_> {
    /// The error for a drawing that has no patch of the size asked for: the least number of
    /// triangles that works, searched in steps of a tenth, one placement each. Given up where the
    /// boundary alone would take too many edges: parts thin as a hair fit no grid.
    pub(super) fn least_that_works(
        &mut self,
        asked: f64,
        obstacle: Obstacle,
        progress: Progress<'_>,
    ) -> Result<Error> {
        const LARGEST: f64 = 1e6;
        const MOST_EDGES: f64 = 8e3;
        let most_edges = MOST_EDGES.max(3.0 * self.boundary_edges(asked.max(6.0) as usize));
        let at = |step: i32| (asked.max(6.0) * 1.1f64.powi(step)).ceil() as usize;
        let (mut fails, mut works, mut stride) = (0, None, 1);
        let fits = |job: &Self, n: usize| (n as f64) < LARGEST && job.boundary_edges(n) < most_edges;
        while works.is_none() && fits(self, at(fails + stride)) {
            let step = fails + stride;
            if self.works(at(step), progress)? {
                works = Some(step);
            } else {
                fails = step;
            }
            // Small steps first, for drawings that nearly fit; larger ones after them.
            stride = 1 + fails / 3;
        }
        let Some(mut works) = works else {
            return Ok(Error::NoPatch { reason: obstacle.reason, at: obstacle.at.to_array() });
        };
        while works - fails > 1 {
            let step = (works + fails) / 2;
            if self.works(at(step), progress)? {
                works = step;
            } else {
                fails = step;
            }
        }
        Ok(Error::TooCoarse { triangles: asked.round().max(1.0) as usize, least: at(works) })
    }

    /// Whether the first placement at `n` triangles gives a valid patch.
    fn works(&mut self, n: usize, progress: Progress<'_>) -> Result<bool> {
        progress.report(0.9)?;
        Ok(!self.is_hopeless(n) && self.attempt(Asked::Triangles(n), Effort::Quick, progress)?.is_ok())
    }

    /// Length of the drawing in edges at about `n` triangles.
    fn boundary_edges(&self, n: usize) -> f64 {
        self.contours.iter().map(ClosedCurve::length).sum::<f64>() / self.first_guess(n)
    }

    /// True if `n` triangles cannot follow the drawing: a chord-free lattice patch with `b` boundary
    /// vertices has at least `2 b - 6`, and a path beside the faired contours is not much shorter
    /// than they are.
    pub(super) fn is_hopeless(&self, n: usize) -> bool {
        const SHORTER: f64 = 0.7;
        let lattice = self.lattice(self.first_guess(n), 0.0, DVec2::ZERO);
        // The number of samples alone shows the worst cases; no need to take them.
        let edges = self.boundary_edges(n);
        let needed = |edges: f64| 2.0 * SHORTER * edges - 6.0 * self.contours.len() as f64;
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
