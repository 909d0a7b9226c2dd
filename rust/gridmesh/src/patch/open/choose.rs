//! Which corners are opened, and at which vertices of the rim.

use glam::DVec2;
use rustc_hash::FxHashSet;

use crate::patch::Loop;
use crate::patch::mirror::Partners;
use crate::patch::placed::Placed;

/// Corners of the drawing with a greater angle keep two quads: their halves are nearer to right angles.
const WIDEST: f64 = 120.0 * std::f64::consts::PI / 180.0;

/// A corner goes to a vertex of the rim so many edges away, where the lattice turns there.
const FARTHEST: usize = 2;

/// A corner to be opened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Opening {
    /// The loop.
    pub(super) of: usize,
    /// The vertex that is on the corner, numbered along the loop.
    pub(super) from: usize,
    /// So many vertices ahead is the one that gets the corner.
    pub(super) by: i64,
}

/// A placement of belted quads.
pub(super) struct Belt<'a> {
    pub(super) placed: &'a Placed,
    partners: Option<&'a Partners>,
    /// How many quads the vertex behind each one of the rim has.
    behind: Vec<u8>,
}

impl<'a> Belt<'a> {
    pub(super) fn new(placed: &'a Placed, partners: Option<&'a Partners>) -> Self {
        let n_rim = placed.patch.n_boundary();
        let mut behind = vec![0u8; n_rim];
        for &v in placed.patch.quads.iter().flatten() {
            if let Some(count) = (v as usize).checked_sub(n_rim).and_then(|v| behind.get_mut(v)) {
                *count += 1;
            }
        }
        Self { placed, partners, behind }
    }

    /// The corners that are to be opened, along the loops.
    pub(super) fn openings(&self) -> Vec<Opening> {
        let mut chosen: Vec<Opening> = Vec::new();
        let mut taken = FxHashSet::default();
        for (of, contour) in self.placed.patch.loops.iter().enumerate() {
            for from in 0..contour.len() {
                let image = self.image(of, from);
                if !self.is_sharp(of, from) || image.is_none_or(|(other, at)| !self.is_sharp(other, at)) {
                    continue;
                }
                let (other, at) = image.unwrap_or((of, from));
                if self.side(of, from) < 0 {
                    // Its image on the other side of the axis decides.
                    continue;
                }
                let free = |opening: &Opening| self.is_free(opening, &taken);
                let found = self.ways(of, from).into_iter().find(|&by| {
                    let image = Opening { of: other, from: at, by: -by };
                    free(&Opening { of, from, by }) && ((other, at) == (of, from) || free(&image))
                });
                let Some(by) = found else { continue };
                let mut choose = |one: Opening| {
                    taken.insert((one.of, self.target(&one)));
                    chosen.push(one);
                };
                choose(Opening { of, from, by });
                if (other, at) != (of, from) {
                    choose(Opening { of: other, from: at, by: -by });
                }
            }
        }
        chosen.sort_unstable_by_key(|one| (one.of, one.from));
        chosen
    }

    /// To which vertices ahead a corner may go, the best first.
    fn ways(&self, of: usize, from: usize) -> Vec<i64> {
        let contour = &self.placed.patch.loops[of];
        let behind = |by: i64| self.behind[contour.start as usize + ahead(contour, from, by)];
        let is_on_axis = self.partners.is_some() && self.image(of, from) == Some((of, from));
        let most = if is_on_axis { 0 } else { FARTHEST as i64 };
        let mut ways: Vec<i64> = (-most..=most).filter(|&by| behind(by) == 3).collect();
        let away = |by: i64| self.arc(of, from, by).abs();
        ways.sort_by(|&a, &b| a.abs().cmp(&b.abs()).then(away(a).total_cmp(&away(b))));
        // Elsewhere the vertex behind gets a fifth quad.
        if behind(0) == 4 {
            ways.push(0);
        }
        ways
    }

    /// True if the vertices that a corner passes are free.
    fn is_free(&self, opening: &Opening, taken: &FxHashSet<(usize, usize)>) -> bool {
        let Opening { of, from, by } = *opening;
        let contour = &self.placed.patch.loops[of];
        if contour.len() < 2 * FARTHEST + 2 {
            return false;
        }
        let pinned = &self.placed.pinned[of];
        let mut passed = (1..=by.abs()).map(|k| ahead(contour, from, k * by.signum()));
        let taken = |at: usize| taken.contains(&(of, at));
        !passed.any(|at| pinned[at] || contour.corner[at] != 0.0 || taken(at)) && !taken(self.target(opening))
    }

    /// The vertex that gets the corner, numbered along the loop.
    pub(super) fn target(&self, opening: &Opening) -> usize {
        ahead(&self.placed.patch.loops[opening.of], opening.from, opening.by)
    }

    /// Arc length along the rim from a vertex to one ahead.
    fn arc(&self, of: usize, from: usize, by: i64) -> f64 {
        let contour = &self.placed.patch.loops[of];
        let arcs = &self.placed.arcs[of];
        let way = (arcs[ahead(contour, from, by)] - arcs[from]) / contour.length;
        (way - way.round()) * contour.length
    }

    fn is_sharp(&self, of: usize, at: usize) -> bool {
        let contour = &self.placed.patch.loops[of];
        if contour.corner[at] <= 0.0 {
            return false;
        }
        let place = |by: i64| self.place(of, ahead(contour, at, by));
        let here = place(0);
        let (back, on) = (place(-1) - here, place(1) - here);
        on.perp_dot(back) > 0.0 && on.angle_to(back).abs() < WIDEST
    }

    fn place(&self, of: usize, at: usize) -> DVec2 {
        self.placed.patch.vertices[self.placed.patch.loops[of].start as usize + at]
    }

    /// Loop and number of the mirror image of a vertex; of itself, where there is none.
    fn image(&self, of: usize, at: usize) -> Option<(usize, usize)> {
        let Some(partners) = self.partners else { return Some((of, at)) };
        let loops = &self.placed.patch.loops;
        let image = partners.partner[loops[of].start as usize + at] as u32;
        let of = loops.iter().position(|contour| contour.vertices().contains(&image))?;
        Some((of, (image - loops[of].start) as usize))
    }

    fn side(&self, of: usize, at: usize) -> i32 {
        self.partners.map_or(0, |partners| partners.side[self.placed.patch.loops[of].start as usize + at])
    }

    /// The openings nearest to some places; the first, if there is no place.
    pub(super) fn nearest(&self, openings: &[Opening], to: &[DVec2]) -> Vec<Opening> {
        if to.is_empty() {
            return openings.first().copied().into_iter().collect();
        }
        let nearest = |to: &DVec2| {
            let away = |one: &Opening| self.place(one.of, one.from).distance_squared(*to);
            openings.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b)))
        };
        to.iter().filter_map(nearest).collect()
    }

    /// True for the same corner, or its mirror image.
    pub(super) fn is_same(&self, one: &Opening, other: &Opening) -> bool {
        let at = |one: &Opening| (one.of, one.from);
        at(one) == at(other) || self.image(one.of, one.from) == Some(at(other))
    }
}

/// The vertex of a loop so many ahead.
pub(super) fn ahead(contour: &Loop, at: usize, by: i64) -> usize {
    (at as i64 + by).rem_euclid(contour.len().max(1) as i64) as usize
}
