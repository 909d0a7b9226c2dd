//! The triangles between two closed paths around a lattice of rings.

use super::rings::{Node, Rings};
use crate::error::{Error, Result};
use crate::geometry::topology::NONE;

/// A closed path, and how much further around the axis its vertices are than where the loop's are.
pub(super) struct Bound<'a> {
    pub nodes: &'a [Node],
    pub shifts: Vec<f64>,
}

/// The faces of a tube: the vertices of the lower path, those of the upper one, then those between.
#[derive(Clone, Debug, Default)]
pub(super) struct Tube {
    /// Counter-clockwise where the paths run to the right and rings follow each other upwards.
    pub triangles: Vec<[u32; 3]>,
    /// The same; of a tube of triangles none.
    pub quads: Vec<[u32; 4]>,
    /// Where each vertex between lies around the axis: the difference to any neighbour is less than half a round.
    pub around: Vec<f64>,
    /// How far each vertex between is from the lower path, 0, to the upper one, 1.
    pub height: Vec<f64>,
    /// Rings between the paths, on average.
    pub rows: f64,
    /// The least and the most rings from the lowest place of the lower path to the upper one.
    pub least: f64,
    pub most: f64,
}

/// Triangles of the strip above a ring that a path leaves on its lower side, by the sum of the numbers of their first edge's ends.
struct Below {
    period: i64,
    inside: Vec<bool>,
}

impl Below {
    /// The steps of the path between `ring` and the next.
    fn new(rings: &Rings, path: &[Node], ring: i64) -> Below {
        let period = rings.len(ring) + rings.len(ring + 1);
        let n = path.len();
        let mut rises = vec![];
        let mut falls = vec![];
        for k in 0..n {
            let (from, mut to) = (path[k], path[(k + 1) % n]);
            if k + 1 == n {
                to.at += rings.len(to.ring);
            }
            if from.ring == ring && to.ring == ring + 1 {
                rises.push(from.at + to.at);
            } else if from.ring == ring + 1 && to.ring == ring {
                falls.push(from.at + to.at);
            }
        }
        let all = rises.is_empty() && path.iter().all(|node| node.ring > ring);
        let mut inside = vec![all; period as usize];
        for rise in rises {
            let fall = falls.iter().map(|fall| fall + if *fall < rise { period } else { 0 }).min();
            for key in rise..fall.unwrap_or(rise) {
                inside[key.rem_euclid(period) as usize] = true;
            }
        }
        Below { period, inside }
    }

    fn has(&self, key: i64) -> bool {
        self.inside[key.rem_euclid(self.period) as usize]
    }
}

/// The tube between two paths, which must not meet.
///
/// # Errors
/// [`Error::Internal`] if they do.
pub(super) fn tube(rings: &Rings, lower: &Bound<'_>, upper: &Bound<'_>) -> Result<Tube> {
    let (bottom, top) = (Profile::new(rings, lower), Profile::new(rings, upper));
    let (lower, upper) = (lower.nodes, upper.nodes);
    let (m, n) = (lower.len(), upper.len());
    let least = lower.iter().map(|node| node.ring).min().unwrap_or(0);
    let most = upper.iter().map(|node| node.ring).max().unwrap_or(0);
    // Of each ring from the lowest on.
    let mut number = (least..=most).map(|ring| vec![NONE; rings.len(ring) as usize]).collect::<Vec<_>>();
    for (k, &node) in lower.iter().chain(upper).enumerate() {
        let node = rings.reduced(node);
        let ring = usize::try_from(node.ring - least).ok().and_then(|ring| number.get_mut(ring));
        let Some(own) = ring.and_then(|ring| ring.get_mut(node.at as usize)) else {
            return Err(Error::Internal { reason: "a path of a tube leaves it" });
        };
        if std::mem::replace(own, k as u32) != NONE {
            return Err(Error::Internal { reason: "two paths of a tube meet" });
        }
    }
    let mut tube = Tube::default();
    for ring in least..most {
        let (under, over) = (Below::new(rings, lower, ring), Below::new(rings, upper, ring));
        let mut enter = |corners: [Node; 3]| {
            let ids = corners.map(|node| {
                let node = rings.reduced(node);
                let own = &mut number[(node.ring - least) as usize][node.at as usize];
                if *own == NONE {
                    let around = rings.around(node);
                    let ([low, before], [high, after]) = (bottom.at(around), top.at(around));
                    let height = ((node.ring as f64 - low) / (high - low).max(1.0)).clamp(0.01, 0.99);
                    *own = (m + n + tube.around.len()) as u32;
                    tube.around.push(around - before - height * (after - before));
                    tube.height.push(height);
                }
                *own
            });
            tube.triangles.push(ids);
        };
        for at in 0..rings.len(ring) {
            let node = Node { ring, at };
            let [first, last] = rings.up(node);
            for left in first.at..=last.at {
                let key = at + left;
                if !over.has(key) || under.has(key) {
                    continue;
                }
                let left = Node { ring: ring + 1, at: left };
                let right =
                    if left == last { Node { ring, at: at + 1 } } else { Node { at: left.at + 1, ..left } };
                enter([node, right, left]);
            }
        }
    }
    tube.rows = top.mean() - bottom.mean();
    let nearest = upper.iter().map(|node| node.ring).min().unwrap_or(0);
    (tube.least, tube.most) = ((nearest - least) as f64, (most - least) as f64);
    Ok(tube)
}

/// The ring of a path and its shift as functions of where around the axis it is.
struct Profile {
    /// Ascending.
    around: Vec<f64>,
    values: Vec<[f64; 2]>,
}

impl Profile {
    fn new(rings: &Rings, path: &Bound<'_>) -> Profile {
        let place = |(&node, &shift): (&Node, &f64)| {
            let around = rings.around(node);
            (around - around.floor(), [node.ring as f64, shift])
        };
        let mut places = path.nodes.iter().zip(&path.shifts).map(place).collect::<Vec<_>>();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (around, values) = places.into_iter().unzip();
        Profile { around, values }
    }

    fn at(&self, around: f64) -> [f64; 2] {
        let around = around - around.floor();
        let n = self.around.len();
        let next = self.around.partition_point(|&x| x <= around);
        let (a, b) = ((next + n - 1) % n, next % n);
        let (mut from, mut to) = (self.around[a], self.around[b]);
        if next == 0 {
            from -= 1.0;
        }
        if next == n {
            to += 1.0;
        }
        let share = if to > from { (around - from) / (to - from) } else { 0.0 };
        std::array::from_fn(|k| self.values[a][k] + share * (self.values[b][k] - self.values[a][k]))
    }

    fn mean(&self) -> f64 {
        self.values.iter().map(|value| value[0]).sum::<f64>() / self.values.len() as f64
    }
}

/// A tube over rings of any lengths, each step between two of them spread evenly: the vertices are irregular where the
/// lengths grow unevenly. The first vertex of the lowest ring lies below that numbered `shift` of the highest.
pub(super) fn stacked(lengths: &[usize], shift: usize) -> Tube {
    let (m, n) = (lengths[0], lengths[lengths.len() - 1]);
    let rows = lengths.len() - 1;
    let mut tube = Tube { rows: rows as f64, least: rows as f64, most: rows as f64, ..Tube::default() };
    let mut first = vec![0u32];
    for (row, &length) in lengths.iter().enumerate().take(rows).skip(1) {
        first.push((m + n + tube.around.len()) as u32);
        for at in 0..length {
            tube.around.push((at as f64 + 0.5 * (row % 2) as f64) / length as f64);
            tube.height.push(row as f64 / rows as f64);
        }
    }
    first.push(m as u32);
    for row in 0..rows {
        let (a, b) = (lengths[row], lengths[row + 1]);
        let low = |k: usize| first[row] + (k % a) as u32;
        let ahead = if row + 1 == rows { shift } else { 0 };
        let high = |k: usize| first[row + 1] + ((k + ahead) % b) as u32;
        let (here, there) = (0.5 * (row % 2) as f64, 0.5 * ((row + 1) % 2) as f64);
        let (mut i, mut j) = (0, 0);
        while i < a || j < b {
            let ahead = (i as f64 + 0.5 + here) * b as f64 <= (j as f64 + 0.5 + there) * a as f64;
            if j == b || (i < a && ahead) {
                tube.triangles.push([low(i), low(i + 1), high(j)]);
                i += 1;
            } else {
                tube.triangles.push([low(i), high(j + 1), high(j)]);
                j += 1;
            }
        }
    }
    tube
}

impl Tube {
    /// The faces as triangles, two for each quad.
    pub fn facets(&self) -> impl Iterator<Item = [u32; 3]> {
        let halves = self.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        halves.chain(self.triangles.iter().copied())
    }
}

/// True if the faces form a tube over `m` and `n` vertices of two loops, the lower one running to the right,
/// and over others of which none is missing: each loop edge in one triangle, all others in two, no triangle
/// or edge twice.
pub(super) fn is_tube(tube: &Tube, m: usize, n: usize) -> bool {
    let end = m + n + tube.around.len();
    let facets = tube.facets().collect::<Vec<_>>();
    if facets.len() + m + n != 2 * end {
        return false;
    }
    // The ends of all directed sides, by where they start.
    let mut start = vec![0u32; end + 1];
    facets.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
    if start[1..].contains(&0) {
        return false;
    }
    for v in 0..end {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut ends = vec![0u32; 3 * facets.len()];
    for t in &facets {
        for k in 0..3 {
            let slot = &mut next[t[k] as usize];
            ends[*slot as usize] = t[(k + 1) % 3];
            *slot += 1;
        }
    }
    let range = |v: u32| start[v as usize] as usize..start[v as usize + 1] as usize;
    for v in 0..end as u32 {
        ends[range(v)].sort_unstable();
    }
    let from = |v: u32| &ends[range(v)];
    let (m, n) = (m as u32, n as u32);
    let on_loop = |a: u32, b: u32| {
        if a < m { b == (a + 1) % m } else { a < m + n && b >= m && a == m + (b + 1 - m) % n }
    };
    let mut open = 0;
    for a in 0..end as u32 {
        if from(a).windows(2).any(|pair| pair[0] == pair[1]) {
            return false;
        }
        for &b in from(a).iter().filter(|&&b| from(b).binary_search(&a).is_err()) {
            if !on_loop(a, b) {
                return false;
            }
            open += 1;
        }
    }
    open == m + n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_paths_bound_tubes_without_irregular_vertices() {
        let cones = [
            (Rings::new(12, vec![], vec![]), 4),
            (Rings::new(5, vec![1, 1, 3], vec![0.2, 0.25, 0.7]), 3),
            (Rings::new(7, vec![0, 1, 2, 3, 4, 5, 6], (0..7).map(|a| f64::from(a) / 7.0).collect()), 1),
        ];
        for (rings, rows) in cones {
            let path = |ring: i64| (0..rings.len(ring)).map(|at| Node { ring, at }).collect::<Vec<_>>();
            let (lower, upper) = (path(0), path(rows));
            let bound = |nodes: &'_ [Node]| vec![0.0; nodes.len()];
            let (below, above) = (bound(&lower), bound(&upper));
            let below = Bound { nodes: &lower, shifts: below };
            let tube = tube(&rings, &below, &Bound { nodes: &upper, shifts: above }).unwrap();
            assert!(is_tube(&tube, lower.len(), upper.len()));
            assert_eq!(tube.rows, rows as f64);
            let mut valence = vec![0; lower.len() + upper.len() + tube.around.len()];
            tube.triangles.iter().flatten().for_each(|&v| valence[v as usize] += 1);
            assert!(valence[lower.len() + upper.len()..].iter().all(|&v| v == 6));
        }
    }

    #[test]
    fn rings_of_any_lengths_can_be_stacked() {
        for lengths in [vec![3, 200], vec![60, 61, 59, 62], vec![5, 5, 5], vec![100, 40, 3]] {
            let tube = stacked(&lengths, 2);
            assert!(is_tube(&tube, lengths[0], lengths[lengths.len() - 1]), "{lengths:?}");
        }
    }
}
