//! The rim with two more vertices at each opened corner, and the quads at it.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::patch::Patch;
use crate::patch::mirror::Partners;
use crate::patch::open::choose::{Belt, Opening, ahead};
use crate::relax::Rim;

/// So many edges of the rim on either side of an opened corner make room.
const ROOM: usize = 8;

/// Quads with opened corners, before they are relaxed. In units of the lattice.
pub(super) struct Opened {
    pub(super) quads: Vec<[u32; 4]>,
    pub(super) positions: Vec<DVec2>,
    pub(super) rims: Vec<Rim>,
    /// The vertices around which there is something to relax.
    pub(super) moved: Vec<u32>,
    /// The new number of each vertex of the belted quads.
    number: Vec<u32>,
    /// At each vertex of the rim, numbered as before, the new ones before and behind it; itself where there are none.
    beside: Vec<[u32; 2]>,
}

impl Opened {
    pub(super) fn new(belt: &Belt<'_>, openings: &[Opening], contours: &[ClosedCurve]) -> Self {
        let patch = &belt.placed.patch;
        let n_rim = patch.n_boundary();
        let mut is_opened = vec![false; n_rim];
        for one in openings {
            is_opened[patch.loops[one.of].start as usize + belt.target(one)] = true;
        }
        let mut number: Vec<u32> = Vec::with_capacity(patch.vertices.len());
        let mut beside = Vec::with_capacity(n_rim);
        let mut next = 0u32;
        for &is_opened in &is_opened {
            if is_opened {
                number.push(next + 1);
                beside.push([next, next + 2]);
                next += 3;
            } else {
                number.push(next);
                beside.push([next; 2]);
                next += 1;
            }
        }
        let more = next - n_rim as u32;
        number.extend((n_rim..patch.vertices.len()).map(|v| v as u32 + more));
        let mut rims = Vec::new();
        let mut moved = Vec::new();
        for (of, contour) in patch.loops.iter().enumerate() {
            let start = beside[contour.start as usize][0] as usize;
            let of_loop: Vec<Opening> = openings.iter().filter(|one| one.of == of).copied().collect();
            let rim = rim(belt, of, &of_loop, &mut moved, start);
            rims.push(rim);
        }
        let lattice = &patch.lattice;
        let mut positions = Vec::with_capacity(number.len() + more as usize);
        for (rim, contour) in rims.iter().zip(contours) {
            positions.extend(
                rim.s
                    .iter()
                    .map(|s| lattice.to_units(contour.point_at(contour.wrap(s * lattice.edge_length)))),
            );
        }
        positions.extend(patch.vertices[n_rim..].iter().map(|&p| lattice.to_units(p)));
        let mut quads = Vec::with_capacity(patch.quads.len() + openings.len());
        for (k, quad) in patch.quads.iter().enumerate() {
            let mut new = quad.map(|v| number[v as usize]);
            if k < n_rim {
                // Of the belt: this vertex of the rim and the next, and the two behind them.
                (new[0], new[1]) = (beside[quad[0] as usize][1], beside[quad[1] as usize][0]);
            }
            quads.push(new);
        }
        for (v, beside) in beside.iter().enumerate().filter(|(_, beside)| beside[0] != beside[1]) {
            quads.push([beside[0], number[v], beside[1], number[n_rim + v]]);
        }
        Self { quads, positions, rims, moved, number, beside }
    }

    /// True if the vertex of an opened corner is still on the corner, in a patch of the opened quads.
    pub(super) fn keeps(&self, belt: &Belt<'_>, made: &Patch, opening: &Opening) -> bool {
        let old = belt.placed.patch.loops[opening.of].start as usize + belt.target(opening);
        let contour = &made.loops[opening.of];
        contour.corner[(self.number[old] - contour.start) as usize] > 0.0
    }

    /// By how much the worst corner of the quads around an opened corner is better than it was around the corner in the
    /// belt, in radians.
    pub(super) fn gain(
        &self,
        belt: &Belt<'_>,
        (before, now): (&Sharpness, &Sharpness),
        opening: &Opening,
    ) -> f64 {
        const NEAR: i64 = 2;
        let contour = &belt.placed.patch.loops[opening.of];
        let n_rim = belt.placed.patch.n_boundary();
        let (mut least_before, mut least) = (f64::INFINITY, f64::INFINITY);
        for by in opening.by.min(0) - NEAR..=opening.by.max(0) + NEAR {
            let v = contour.start as usize + ahead(contour, opening.from, by);
            least_before = least_before.min(before.0[v]).min(before.0[v + n_rim]);
            for v in [self.number[v], self.number[v + n_rim], self.beside[v][0], self.beside[v][1]] {
                least = least.min(now.0[v as usize]);
            }
        }
        least - least_before
    }

    /// Which of the vertices are each other's mirror images.
    pub(super) fn partners(&self, belt: &Belt<'_>, partners: &Partners) -> Partners {
        let n_rim = belt.placed.patch.n_boundary();
        let mut new =
            Partners { partner: vec![0; self.positions.len()], side: vec![0; self.positions.len()] };
        for (v, &number) in self.number.iter().enumerate() {
            let partner = partners.partner[v];
            new.partner[number as usize] = self.number[partner] as usize;
            new.side[number as usize] = partners.side[v];
            if v < n_rim {
                let ([before, behind], image) = (self.beside[v], self.beside[partner]);
                if before == behind {
                    continue;
                }
                new.partner[before as usize] = image[1] as usize;
                new.partner[behind as usize] = image[0] as usize;
                new.side[before as usize] = partners.side[v];
                new.side[behind as usize] = partners.side[v];
            }
        }
        // Beside a corner on the axis they are on the sides of their other neighbours.
        let mut start = 0;
        for rim in &self.rims {
            let n = rim.s.len();
            for i in 0..n {
                let here = start + i;
                if new.side[here] == 0 && new.partner[here] != here {
                    let [last, next] = [n - 1, 1].map(|by| new.side[start + (i + by) % n]);
                    new.side[here] = if last != 0 { last } else { next };
                }
            }
            start += n;
        }
        new
    }
}

/// At each vertex the least corner of its quads, or what the greatest is short of a straight one if that is less.
pub(super) struct Sharpness(Vec<f64>);

impl Sharpness {
    pub(super) fn new(patch: &Patch) -> Self {
        let mut at = vec![f64::INFINITY; patch.vertices.len()];
        for quad in &patch.quads {
            let p = quad.map(|v| patch.vertices[v as usize]);
            let corner = |k: usize| {
                let (on, back) = (p[(k + 1) % 4] - p[k], p[(k + 3) % 4] - p[k]);
                libm::atan2(on.perp_dot(back), on.dot(back).abs())
            };
            let least = (0..4).map(corner).fold(f64::INFINITY, f64::min);
            for &v in quad {
                at[v as usize] = at[v as usize].min(least);
            }
        }
        Self(at)
    }

    /// The least of all.
    pub(super) fn least(&self) -> f64 {
        self.0.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The vertices of quads with corners below one.
    pub(super) fn below(&self, least: f64) -> impl Iterator<Item = usize> + '_ {
        (0..self.0.len()).filter(move |&v| self.0[v] < least)
    }
}

/// A run of the rim from one pinned vertex to the next, in edges: how many it has, and how many more at either end.
struct Run {
    edges: usize,
    more: [i64; 2],
}

impl Run {
    /// Where the vertex so many edges on was, in edges of before.
    fn before(&self, at: usize) -> f64 {
        let n = self.edges as i64 + self.more[0] + self.more[1];
        if self.more == [0; 2] {
            return at as f64;
        }
        let room = self.edges.min(ROOM);
        let ends = self.more.map(|more| if more == 0 { 0 } else { room });
        if ends[0] + ends[1] > self.edges || n <= 0 {
            return at as f64 * self.edges as f64 / n.max(1) as f64;
        }
        let [first, last] = [0, 1].map(|k| ends[k] as f64 + self.more[k] as f64);
        let (at, n) = (at as f64, n as f64);
        match at {
            _ if at < first => at * ends[0] as f64 / first,
            _ if n - at < last => self.edges as f64 - (n - at) * ends[1] as f64 / last,
            _ => at - self.more[0] as f64,
        }
    }
}

/// The rim of a loop with its corners opened: those near them are moved together as far as they were apart.
fn rim(belt: &Belt<'_>, of: usize, openings: &[Opening], moved: &mut Vec<u32>, start: usize) -> Rim {
    let placed = belt.placed;
    let contour = &placed.patch.loops[of];
    let (n, h) = (contour.len(), placed.patch.lattice.edge_length);
    // Unwrapped, in edges.
    let length = contour.length / h;
    let mut old: Vec<f64> = Vec::with_capacity(n);
    for s in &placed.arcs[of] {
        let s = s / h;
        let last = old.last().copied().unwrap_or(s);
        old.push(s + length * ((last - s) / length).ceil().max(0.0));
    }
    let at = |u: f64| {
        let (whole, part) = (u.floor(), u - u.floor());
        let arc = |k: i64| old[k.rem_euclid(n as i64) as usize] + length * k.div_euclid(n as i64) as f64;
        let k = whole as i64;
        if part == 0.0 { arc(k) } else { arc(k) + part * (arc(k + 1) - arc(k)) }
    };
    if openings.is_empty() {
        return Rim { start, s: old, pinned: placed.pinned[of].clone(), held: placed.held[of].clone() };
    }
    // How far each corner that is opened goes, and which vertices get one.
    let (mut by, mut is_opened) = (vec![None; n], vec![false; n]);
    for one in openings {
        by[one.from] = Some(one.by);
        is_opened[belt.target(one)] = true;
    }
    let anchors: Vec<usize> =
        (0..n).filter(|&i| placed.pinned[of][i] || contour.corner[i] != 0.0 || by[i].is_some()).collect();
    // From the first anchor on, each vertex with whether it is pinned, and held.
    let total = n + 2 * openings.len();
    let mut round: Vec<(f64, bool, bool)> = Vec::with_capacity(total);
    let mut changed: Vec<bool> = Vec::with_capacity(total);
    for (j, &from) in anchors.iter().enumerate() {
        let to = anchors.get(j + 1).copied().unwrap_or(anchors[0] + n);
        let more = |i: usize, sign: i64| by[i % n].map_or(0, |by: i64| 1 + sign * by);
        let run = Run { edges: to - from, more: [more(from, -1), more(to, 1)] };
        let count = (run.edges as i64 + run.more[0] + run.more[1]).max(1) as usize;
        for k in 0..count {
            let before = run.before(k);
            let is_anchor = k == 0;
            round.push((at(from as f64 + before), is_anchor, is_anchor && placed.held[of][from]));
            changed.push(if is_anchor { by[from].is_some() } else { before.fract() != 0.0 });
        }
    }
    // The numbering begins with what was the first vertex, or the one before it.
    let target = ahead(contour, anchors[0], by[anchors[0]].unwrap_or(0));
    let first = steps_to_start(target, &is_opened);
    let count = round.len();
    let (mut s, mut pinned, mut held) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..count {
        let (arc, is_pinned, is_held) = round[(first + k) % count];
        let lap = if first + k < count { -length } else { 0.0 };
        s.push(arc + lap);
        pinned.push(is_pinned);
        held.push(is_held);
        if changed[(first + k) % count] {
            moved.push((start + k) as u32);
        }
    }
    Rim { start, s, pinned, held }
}

/// How many vertices lie between one of a loop, numbered as before, and the first of the new numbering.
fn steps_to_start(from: usize, is_opened: &[bool]) -> usize {
    // Itself and each later one, with the new ones beside them.
    let later = is_opened[from + 1..].iter().map(|&is_opened| if is_opened { 3 } else { 1 });
    1 + usize::from(is_opened[from]) + later.sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_keeps_its_ends_and_its_order() {
        for edges in 1..40usize {
            for more in [[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [3, 1], [0, 2], [-1, 1], [1, -1]] {
                let count = edges as i64 + more[0] + more[1];
                if count < 1 {
                    continue;
                }
                let run = Run { edges, more };
                let before: Vec<f64> = (0..=count as usize).map(|at| run.before(at)).collect();
                assert_eq!((before[0], before[count as usize]), (0.0, edges as f64), "{edges} {more:?}");
                assert!(before.windows(2).all(|pair| pair[0] < pair[1]), "{edges} {more:?} {before:?}");
            }
        }
    }

    #[test]
    fn only_the_vertices_near_an_opened_corner_make_room() {
        let run = Run { edges: 30, more: [1, 0] };
        assert_eq!(run.before(9), 8.0);
        assert!((9..=31).all(|at| run.before(at) == at as f64 - 1.0));
        assert!((1..9).all(|at| run.before(at) > at as f64 - 1.0));
    }
}
