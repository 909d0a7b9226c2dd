//! Better angles near the line: edges turned, taken out or halved.

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};

use super::strip::{Strip, Trial};
use crate::cut::divide::parted::Part;
use crate::error::Result;
use crate::progress::Progress;

/// Angles below this are worked on.
pub(super) const SMALL: f64 = 0.42;

/// Rounds of collapsing, flipping and splitting.
pub(super) const ROUNDS: usize = 8;

/// Angles below this are reason enough to draw the cut through a vertex.
pub(super) const POOR: f64 = 0.19;

/// Triangles looked at between two reports of progress.
pub(super) const BATCH: usize = 32;

/// Vertices of the line may go for better angles while its edges stay shorter than this, in edge lengths.
const LONGEST: f64 = 1.5;

/// Triangles looked at in a round, for each one that has a small angle at its start.
const EDITS: usize = 32;

/// The longest edge of a triangle is halved if the triangle is at least this wide across it, in edge lengths: narrower
/// ones are between walls, and no better in halves.
const WIDE: f64 = 0.1;

/// Edges of a triangle with their lengths, the longest first.
type Edges = [(f64, u32, u32); 3];

/// This many vertices made by halving edges on one old triangle may be taken out again in a round, or half of them.
const TAKEN_BACK: usize = 8;

/// The halved edges of a round. Halves have smaller angles than the whole: where nothing can be turned in between they
/// are put together again at once, and would be halved and put together without end.
#[derive(Default)]
struct Halved {
    edges: FxHashSet<(u32, u32)>,
    /// The old triangle that each new vertex was made for.
    homes: FxHashMap<u32, [u32; 3]>,
    /// For each old triangle the vertices made, and those taken out again.
    counts: FxHashMap<[u32; 3], [usize; 2]>,
}

impl Halved {
    /// True if halving the edge from `a` to `b` for a triangle on this old one could be of use.
    fn is_worth_it(&self, a: u32, b: u32, home: [u32; 3]) -> bool {
        let lasts = |&[made, gone]: &[usize; 2]| gone < TAKEN_BACK || 2 * gone < made;
        !self.edges.contains(&(a.min(b), a.max(b))) && self.counts.get(&home).is_none_or(lasts)
    }

    fn add(&mut self, a: u32, b: u32, home: [u32; 3], middle: u32) {
        self.edges.insert((a.min(b), a.max(b)));
        self.homes.insert(middle, home);
        self.counts.entry(home).or_default()[0] += 1;
    }

    fn remove(&mut self, v: u32) {
        if let Some(counts) = self.homes.remove(&v).and_then(|home| self.counts.get_mut(&home)) {
            counts[1] += 1;
        }
    }
}

/// Takes an edge out, the shortest if it may go, if that leaves better angles than there were; the vertex that is gone.
fn shorten(
    strip: &mut Strip<'_>,
    part: &Part,
    edges: Edges,
    kept: &FxHashSet<u32>,
    length: f64,
) -> Option<u32> {
    let least = strip.min_angle(part.corners);
    edges.iter().rev().find_map(|&(short, a, b)| {
        let gone = [(a, b), (b, a)].into_iter().find(|&(u, v)| {
            if short > 0.75 * length && least > POOR
                || short > length
                || (kept.contains(&u) && !strip.may_go(u, v, LONGEST * length))
            {
                return false;
            }
            let worst = strip.triangles_at(u).iter().filter_map(|&t| strip.part(t));
            let worst = worst.map(|p| strip.min_angle(p.corners)).fold(f64::INFINITY, f64::min);
            strip.collapse(u, v, worst.max(1e-3) * 1.05)
        });
        gone.map(|(u, _)| u)
    })
}

/// Halves the longest edge if it is much longer than the others should be; the vertex in its middle.
fn halve(strip: &mut Strip<'_>, part: &Part, edges: Edges, length: f64) -> Option<u32> {
    let (long, a, b) = edges[0];
    let [p, q, r] = part.corners.map(|v| strip.position(v));
    let may = long > 1.6 * length
        && long > 1.6 * edges[2].0
        && (q - p).cross(r - p).length() > WIDE * length * long
        && !strip.is_cut(a, b);
    if may { strip.split(a, b, 0.5) } else { None }
}

/// One round of edits to triangles with small angles.
///
/// Edges are turned first, everywhere: a vertex put on an edge then takes over the triangles around it, which need no
/// vertices of their own. So the triangles grow with the distance from the line.
pub(super) fn improve(
    strip: &mut Strip<'_>,
    kept: &FxHashSet<u32>,
    length: f64,
    round: usize,
    progress: Progress<'_>,
) -> Result<usize> {
    let mut changes = 0;
    // Near the line: its triangles, and those that were made.
    let touches = |strip: &Strip<'_>, part: &Part| {
        part.corners.iter().any(|&v| v as usize >= strip.parted.n_old || !strip.on_line(v).is_empty())
    };
    let fresh = std::mem::take(&mut strip.fresh);
    let looked_at: BTreeSet<u32> = if round == 0 {
        (0..strip.parts.len() as u32).collect()
    } else {
        // Only what has changed, and what is next to it.
        let corners = fresh.iter().filter_map(|&t| strip.part(t)).flat_map(|p| p.corners);
        corners.flat_map(|v| strip.triangles_at(v)).copied().collect()
    };
    let is_sharp = |strip: &Strip<'_>, t: &u32| {
        strip.part(*t).is_some_and(|p| touches(strip, p) && strip.min_angle(p.corners) < SMALL)
    };
    let mut turned: BTreeSet<u32> = looked_at.into_iter().filter(|t| is_sharp(strip, t)).collect();
    let mut edited: BTreeSet<u32> = BTreeSet::new();
    let mut halved = Halved::default();
    let mut budget = EDITS * turned.len() + 64;
    let next = |turned: &mut BTreeSet<u32>, edited: &mut BTreeSet<u32>| {
        turned.pop_first().map(|t| (t, true)).or_else(|| edited.pop_first().map(|t| (t, false)))
    };
    while let Some((t, turns)) = next(&mut turned, &mut edited).filter(|_| budget > 0) {
        budget -= 1;
        if budget.is_multiple_of(BATCH) {
            progress.report(0.0)?;
        }
        let Some(part) = strip.part(t).copied().filter(|p| strip.min_angle(p.corners) < SMALL) else {
            continue;
        };
        let mut edges = [0, 1, 2].map(|k| {
            let (a, b) = (part.corners[k], part.corners[(k + 1) % 3]);
            (strip.position(a).distance(strip.position(b)), a, b)
        });
        edges.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let from = strip.fresh.len();
        let mut edit = |strip: &mut Strip<'_>| {
            if turns {
                return edges.iter().any(|&(_, a, b)| strip.flip(a, b));
            }
            if let Some(gone) = shorten(strip, &part, edges, kept, length) {
                halved.remove(gone);
                return true;
            }
            let (_, a, b) = edges[0];
            if round + 2 >= ROUNDS || !halved.is_worth_it(a, b, part.home) {
                return false;
            }
            let middle = halve(strip, &part, edges, length);
            middle.inspect(|&middle| halved.add(a, b, part.home, middle)).is_some()
        };
        if edit(strip) {
            changes += 1;
            turned.extend(strip.changed_since(from).into_iter().filter(|t| is_sharp(strip, t)));
        } else if turns {
            edited.insert(t);
        }
    }
    let new = (strip.parted.n_old..strip.parted.n_old + strip.parted.nodes.len()).map(|v| v as u32);
    for (k, v) in new.collect::<Vec<_>>().into_iter().enumerate() {
        if k % BATCH == 0 {
            progress.report(1.0)?;
        }
        if strip.triangles_at(v).is_empty() || strip.is_hopeless(v, Trial::Centre) {
            continue;
        }
        if strip.centre(v) {
            changes += 1;
        } else {
            strip.give_up(v, Trial::Centre);
        }
    }
    Ok(changes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_together_again_is_not_halved_without_end() {
        let (home, other) = ([0, 1, 2], [2, 1, 3]);
        let mut halved = Halved::default();
        halved.add(0, 1, home, 100);
        assert!(!halved.is_worth_it(1, 0, home), "the same edge");
        assert!(halved.is_worth_it(1, 2, home));
        for k in 1..=3 * TAKEN_BACK as u32 {
            halved.add(1, 2 * k, home, 100 + k);
            halved.remove(100 + k);
        }
        assert!(!halved.is_worth_it(1, 2, other) && !halved.is_worth_it(5, 7, home));
        assert!(halved.is_worth_it(5, 7, other));
        // Vertices that were not made by halving do not count.
        halved.add(1, 1000, other, 1000);
        (0..100).for_each(|v| halved.remove(v));
        assert!(halved.is_worth_it(5, 7, other));
        // Where half of them stays, more are welcome.
        (0..=3 * TAKEN_BACK as u32).for_each(|k| halved.add(2, 2000 + k, home, 2000 + k));
        assert!(halved.is_worth_it(5, 7, home));
    }
}
