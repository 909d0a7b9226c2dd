//! The first surface in several loops: triangles between their vertices.
//!
//! Source: Barequet and Sharir, *Filling gaps in the boundary of a polyhedron*, 1995, for the dynamic program; Liepa, *Filling holes in
//! meshes*, 2003, weighs by angles between triangles and to those around, too.

use std::collections::BTreeMap;

use glam::DVec3;
use rustc_hash::FxHashSet;

use super::tour::{Loops, walk};
use crate::error::{Error, Result};
use crate::fill::even::local::edge;
use crate::progress::Progress;

/// Vertices of the polygon, about; of longer loops only every second, third, ... is looked at. The time grows with the cube.
const MOST: usize = 160;

/// Vertices of a loop that are looked at in any case.
const LEAST: usize = 8;

/// The loops, and what is around them.
pub(super) struct Outline<'a> {
    pub loops: &'a Loops,
    /// Where each place is.
    pub at: &'a [DVec3],
    /// The normal of the triangle beyond the edge that begins at each place, as if wound like the patch.
    pub outside: &'a [Option<DVec3>],
    /// Edges that the mesh has between places.
    pub taken: &'a FxHashSet<[u32; 2]>,
}

/// Positions, those of the loops' places first, and triangles between them, which have every edge of the loops once.
///
/// # Errors
/// [`Error::NoPatch`], [`Error::Cancelled`].
pub(super) fn triangulated(
    outline: &Outline<'_>,
    spanning: &[[usize; 2]],
    progress: Progress<'_>,
) -> Result<(Vec<DVec3>, Vec<[u32; 3]>)> {
    let Outline { loops, at, taken, .. } = *outline;
    let refused = |reason: &str| Error::NoPatch { reason: reason.into(), at: at[0].truncate().to_array() };
    let coarse = Coarse::new(loops, at.len());
    let links = coarse
        .links(spanning, at, taken)
        .ok_or_else(|| refused("the loops have too few vertices to be joined"))?;
    let walk = walk(&coarse.loops, &links).into_iter().map(|k| coarse.places[k]).collect::<Vec<_>>();
    let triangles = cheapest(&walk, outline, progress)?
        .ok_or_else(|| refused("no triangles between the loops are sound"))?;
    let mut draft =
        Draft { names: walk.iter().map(|&k| k as u32).collect(), positions: at.to_vec(), triangles };
    draft.insert_skipped(loops);
    draft.split_repeated(taken);
    let named = |t: &[u32; 3]| t.map(|id| draft.names[id as usize]);
    let triangles = draft.triangles.iter().map(named).collect::<Vec<_>>();
    let mut seen = FxHashSet::default();
    let mut sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    // Triangles that run along an edge the same way are no surface: walks around its vertices need not end.
    if !sides.all(|side| seen.insert(side)) {
        return Err(refused("no triangles between the loops are sound"));
    }
    Ok((draft.positions, triangles))
}

/// Vertices of the loops that are looked at.
struct Coarse {
    loops: Loops,
    places: Vec<usize>,
}

impl Coarse {
    fn new(loops: &Loops, all: usize) -> Coarse {
        let step = all.div_ceil(MOST);
        let lengths = (0..loops.starts.len()).map(|k| {
            let n = loops.range(k).len();
            (n / step).max(LEAST).min(n)
        });
        let lengths = lengths.collect::<Vec<_>>();
        let of = |(k, &m): (usize, &usize)| {
            let range = loops.range(k);
            (0..m).map(move |i| range.start + i * range.len() / m)
        };
        let places = lengths.iter().enumerate().flat_map(of).collect();
        Coarse { loops: Loops::new(lengths.into_iter()), places }
    }

    /// The shortest lines from loop to loop, with ends of their own.
    fn links(
        &self,
        spanning: &[[usize; 2]],
        at: &[DVec3],
        taken: &FxHashSet<[u32; 2]>,
    ) -> Option<Vec<[usize; 2]>> {
        let mut used = vec![false; self.places.len()];
        let mut joined = vec![0];
        let mut links = vec![];
        for &[from, to] in spanning {
            let between = |from: usize, used: &[bool]| {
                let ends = |k: usize| self.loops.range(k).filter(|&i| !used[i]);
                let pairs = ends(from).flat_map(|i| ends(to).map(move |j| [i, j]));
                let [a, b] = [0, 1];
                pairs
                    .filter(|pair| {
                        !taken.contains(&edge(self.places[pair[a]] as u32, self.places[pair[b]] as u32))
                    })
                    .map(|pair| (at[self.places[pair[a]]].distance_squared(at[self.places[pair[b]]]), pair))
                    .min_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)))
            };
            // A loop without room leaves the new one to another.
            let found = between(from, &used).or_else(|| {
                let others = joined.iter().filter_map(|&other| between(other, &used));
                others.min_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)))
            });
            let (_, link) = found?;
            link.iter().for_each(|&k| used[k] = true);
            joined.push(to);
            links.push(link);
        }
        Some(links)
    }
}

/// The triangulation of a polygon that is bent least: with the least sum, over all edges, of length times squared angle, to what lies
/// beyond too; by places in the polygon. None if all have a triangle with a vertex twice.
fn cheapest(
    polygon: &[usize],
    outline: &Outline<'_>,
    progress: Progress<'_>,
) -> Result<Option<Vec<[u32; 3]>>> {
    let n = polygon.len();
    let point = |i: usize| outline.at[polygon[i]];
    let normal = |[i, j, k]: [usize; 3]| (point(j) - point(i)).cross(point(k) - point(i));
    let own_loop = polygon.iter().map(|&place| outline.loops.of(place)).collect::<Vec<_>>();
    let bend = |a: DVec3, b: DVec3| {
        let angle = a.angle_between(b);
        if angle.is_finite() { angle * angle } else { std::f64::consts::PI * std::f64::consts::PI }
    };
    // For the chord from i to k: the price of its side, and the apex of the triangle there.
    let mut best: Vec<Option<(f64, usize)>> = vec![None; n * n];
    // The price of a side of a triangle: a chord with the triangle beyond, or an edge of a loop.
    let turn = |own: DVec3, [a, c]: [usize; 2], apex: usize| {
        let length = point(a).distance(point(c));
        if c > a + 1 && c - a < n - 1 {
            return length * bend(own, normal([a, apex, c]));
        }
        let edge = if c == a + 1 { a } else { c };
        match outline.outside[polygon[edge]] {
            Some(beyond) if own_loop[a] == own_loop[c] => length * bend(own, beyond),
            _ => 0.0,
        }
    };
    for span in 1..n {
        progress.report(span as f64 / n as f64)?;
        for i in 0..n - span {
            let k = i + span;
            if span == 1 {
                best[i * n + k] = Some((0.0, i));
                continue;
            }
            if polygon[i] == polygon[k] {
                continue;
            }
            let mut least: Option<(f64, usize)> = None;
            for j in i + 1..k {
                let (Some(left), Some(right)) = (best[i * n + j], best[j * n + k]) else { continue };
                if polygon[j] == polygon[i] || polygon[j] == polygon[k] {
                    continue;
                }
                let own = normal([i, j, k]);
                let mut price = left.0 + right.0 + turn(own, [i, j], left.1) + turn(own, [j, k], right.1);
                if span == n - 1 {
                    price += turn(own, [i, k], j);
                }
                if least.is_none_or(|least| price < least.0) {
                    least = Some((price, j));
                }
            }
            best[i * n + k] = least;
        }
    }
    if best[n - 1].is_none() {
        return Ok(None);
    }
    let (mut triangles, mut stack) = (vec![], vec![(0, n - 1)]);
    while let Some((i, k)) = stack.pop() {
        if k > i + 1
            && let Some((_, j)) = best[i * n + k]
        {
            triangles.push([i as u32, j as u32, k as u32]);
            stack.extend([(i, j), (j, k)]);
        }
    }
    Ok(Some(triangles))
}

/// Triangles between corners, each of which stands for a vertex; one vertex may have several corners.
struct Draft {
    names: Vec<u32>,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Draft {
    /// Divides edges between vertices of a loop between which some were skipped.
    fn insert_skipped(&mut self, loops: &Loops) {
        let n = self.names.len();
        for a in 0..n {
            let b = (a + 1) % n;
            let (first, last) = (self.names[a] as usize, self.names[b] as usize);
            if loops.of(first) != loops.of(last) {
                continue;
            }
            let Some(mut t) =
                self.triangles.iter().position(|t| t.contains(&(a as u32)) && t.contains(&(b as u32)))
            else {
                continue;
            };
            let mut from = a as u32;
            let mut place = loops.next(first);
            while place != last {
                let id = self.names.len() as u32;
                self.names.push(place as u32);
                let own = self.triangles[t];
                // The first piece ends at the new corner, the rest begins there.
                self.triangles[t] = own.map(|v| if v == b as u32 { id } else { v });
                self.triangles.push(own.map(|v| if v == from { id } else { v }));
                t = self.triangles.len() - 1;
                from = id;
                place = loops.next(place);
            }
        }
    }

    /// Puts vertices on edges inside that repeat others, or edges of the mesh.
    fn split_repeated(&mut self, taken: &FxHashSet<[u32; 2]>) {
        let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for t in &self.triangles {
            for k in 0..3 {
                *sides.entry(edge(t[k], t[(k + 1) % 3])).or_default() += 1;
            }
        }
        let name = |e: &[u32; 2]| edge(self.names[e[0] as usize], self.names[e[1] as usize]);
        let mut seen: FxHashSet<[u32; 2]> = sides.iter().filter(|s| *s.1 == 1).map(|s| name(s.0)).collect();
        seen.extend(taken);
        let inside = sides.iter().filter(|s| *s.1 > 1).map(|s| *s.0).collect::<Vec<_>>();
        let repeated = inside.into_iter().filter(|e| !seen.insert(name(e))).collect::<Vec<_>>();
        for [a, b] in repeated {
            let id = self.names.len() as u32;
            let ends = [a, b].map(|v| self.positions[self.names[v as usize] as usize]);
            self.names.push(self.positions.len() as u32);
            self.positions.push(0.5 * (ends[0] + ends[1]));
            let mut more = vec![];
            for t in self.triangles.iter_mut().filter(|t| t.contains(&a) && t.contains(&b)) {
                more.push(t.map(|v| if v == a { id } else { v }));
                *t = t.map(|v| if v == b { id } else { v });
            }
            self.triangles.extend(more);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::metrics::check_mesh;

    fn ring(n: usize, radius: f64, middle: DVec3, way: f64) -> Vec<DVec3> {
        let turn = |k: usize| way * std::f64::consts::TAU * k as f64 / n as f64;
        (0..n).map(|k| middle + radius * DVec3::new(turn(k).cos(), turn(k).sin(), 0.0)).collect()
    }

    #[test]
    fn a_plate_with_holes_is_triangulated_with_its_area() {
        for n in [3, 7, 60, 200] {
            let rings = [
                ring(n, 5.0, DVec3::ZERO, 1.0),
                ring(n, 1.0, DVec3::new(2.0, 0.0, 0.0), -1.0),
                ring(n, 1.0, DVec3::new(-1.0, 1.0, 0.0), -1.0),
            ];
            let loops = Loops::new(rings.iter().map(Vec::len));
            let at = rings.concat();
            let outside = vec![None; at.len()];
            let outline = Outline { loops: &loops, at: &at, outside: &outside, taken: &FxHashSet::default() };
            let (positions, triangles) = triangulated(&outline, &[[0, 1], [0, 2]], Progress::NONE).unwrap();
            let check = check_mesh(positions.len(), &triangles);
            assert_eq!((check.boundaries, check.components, check.euler), (3, 1, -1), "{n}");
            assert_eq!((check.bad_edges, check.boundary_edges), (0, 3 * n));
            let area = |points: &[DVec3]| {
                (0..points.len()).map(|k| points[k].cross(points[(k + 1) % points.len()]).z).sum::<f64>()
            };
            let wanted: f64 = rings.iter().map(|ring| area(ring)).sum();
            let own = triangles.iter().map(|t| t.map(|v| positions[v as usize]));
            let found: f64 = own.map(|[a, b, c]| (b - a).cross(c - a).z).sum();
            assert!((found - wanted).abs() < 1e-9 * wanted, "{found} {wanted}");
        }
    }
}
