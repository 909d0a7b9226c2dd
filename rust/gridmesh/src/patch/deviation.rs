//! How far a drawing lies from the boundary of its mesh.

use std::ops::Range;

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::geometry::embed::{crossing_edges, turned_over};
use crate::geometry::segments::{SegmentGrid, nearest_on_segment};

/// A boundary edge that the drawing strays from, and the farthest point of the stretch beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stray {
    /// The contour.
    pub(crate) contour: usize,
    /// The edge starts at this vertex of the contour's loop.
    pub(crate) edge: usize,
    /// Arc length of the farthest point, between those of the edge's ends (the drawing's units).
    pub(crate) arc: f64,
    /// The point.
    pub(crate) point: DVec2,
    /// Its distance from the boundary.
    pub(crate) distance: f64,
}

/// A drawn point and the boundary edge beside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beside {
    pub(crate) point: DVec2,
    /// The edge starts at this vertex of the contour's loop.
    pub(crate) edge: usize,
    /// Arc length of the point, between those of the edge's ends.
    pub(crate) arc: f64,
    /// Squared distance from the edge.
    pub(crate) squared: f64,
}

/// For each contour its points in order, beginning with the first on the loop's first edge.
///
/// `vertices` are numbered loop by loop, `arcs` are their arc lengths: strictly increasing,
/// unwrapped. Linear.
pub(crate) fn beside(contours: &[ClosedCurve], vertices: &[DVec2], arcs: &[Vec<f64>]) -> Vec<Vec<Beside>> {
    let mut start = 0;
    let of = |(contour, arcs): (&ClosedCurve, &Vec<f64>)| {
        let n = arcs.len();
        let vertices = &vertices[start..start + n];
        start += n;
        let points = contour.points();
        let wrapped = contour.wrap(arcs[0]);
        let lap = arcs[0] - wrapped;
        let first = contour.arc()[..points.len()].partition_point(|&s| s < wrapped);
        let ahead = (first..points.len()).map(|i| (i, lap));
        let round = (0..first).map(|i| (i, lap + contour.length()));
        let mut edge = 0;
        let mut place = |(i, lap): (usize, f64)| {
            let (point, arc) = (points[i], contour.arc()[i] + lap);
            while edge + 1 < n && arcs[edge + 1] <= arc {
                edge += 1;
            }
            let squared = nearest_on_segment(point, vertices[edge], vertices[(edge + 1) % n]).1;
            Beside { point, edge, arc, squared }
        };
        ahead.chain(round).map(&mut place).collect()
    };
    contours.iter().zip(arcs).map(of).collect()
}

/// The greatest distance from the drawn curve to the mesh boundary, and the strays: the farthest drawn
/// point beside each edge that is more than `limit` away from it; or the farthest point of the curve, if
/// that is more than `lost` away.
///
/// Each stretch of the curve is measured against the edge [`beside`] it: the distance from one edge is
/// convex along a straight line, so that the drawn points bound all the curve between them. Only where
/// that exceeds `limit` the nearest of all edges counts, between the drawn points too, to a thousandth
/// of `limit`.
pub(crate) fn deviation(
    beside: &[Vec<Beside>],
    vertices: &[DVec2],
    arcs: &[Vec<f64>],
    limit: f64,
    lost: f64,
) -> (f64, Vec<Stray>) {
    let is_near = |point: &Beside| point.squared <= limit * limit;
    let near = beside.iter().flatten().filter(|point| is_near(point));
    let mut worst = near.map(|point| point.squared).fold(0.0, f64::max).sqrt();
    let mut strays: Vec<Stray> = Vec::new();
    let mut all: Option<Edges> = None;
    let mut start = 0;
    for (contour, (points, loop_arcs)) in beside.iter().zip(arcs).enumerate() {
        let n = loop_arcs.len();
        for stretch in points.chunk_by(|a, b| a.edge == b.edge) {
            if stretch.iter().all(is_near) {
                continue;
            }
            let all = all.get_or_insert_with(|| Edges::new(vertices, arcs, limit));
            let edge = stretch[0].edge;
            let (first, last) = (start + edge, start + (edge + 1) % n);
            let before = Beside { point: vertices[first], edge, arc: loop_arcs[edge], squared: 0.0 };
            let arc = stretch.last().map_or(0.0, |p| p.arc + p.point.distance(vertices[last]));
            let after = Beside { point: vertices[last], edge, arc, squared: 0.0 };
            let mut farthest =
                Farthest { all, own: first, above: worst.min(limit), best: before, distance: 0.0 };
            let (drawn, at_drawn) = farthest.search(before, stretch, after);
            let Farthest { best, distance, .. } = farthest;
            worst = worst.max(distance);
            let (best, distance) = if distance > lost { (best, distance) } else { (drawn, at_drawn) };
            if distance > limit {
                strays.push(Stray { contour, edge, arc: best.arc, point: best.point, distance });
            }
        }
        start += n;
    }
    // The first and the last stretch may lie beside one edge.
    strays.sort_by(|a, b| {
        (a.contour, a.edge).cmp(&(b.contour, b.edge)).then(b.distance.total_cmp(&a.distance))
    });
    strays.dedup_by_key(|stray| (stray.contour, stray.edge));
    (worst, strays)
}

/// How many boundary edges meet others elsewhere than in a shared end (exact) and loops are turned over, also after rounding to
/// `f32` at `origin`, and the farthest drawn point beside each that has one.
pub(crate) fn crossings(
    beside: &[Vec<Beside>],
    vertices: &[DVec2],
    arcs: &[Vec<f64>],
    origin: DVec2,
) -> (usize, Vec<Stray>) {
    let mut start = 0;
    let loops = arcs.iter().map(|arcs| {
        start += arcs.len() as u32;
        start - arcs.len() as u32..start
    });
    let loops: Vec<Range<u32>> = loops.collect();
    let stray = |v: u32| {
        let contour = loops.iter().position(|l| l.contains(&v))?;
        let edge = (v - loops[contour].start) as usize;
        let stretch = beside[contour].iter().filter(|point| point.edge == edge);
        let Beside { point, arc, squared, .. } = *stretch.max_by(|a, b| a.squared.total_cmp(&b.squared))?;
        Some(Stray { contour, edge, arc, point, distance: squared.sqrt() })
    };
    let rim = loops.last().map_or(0, |last| last.end as usize);
    let rounded: Vec<DVec2> = vertices[..rim].iter().map(|&p| (p - origin).as_vec2().as_dvec2()).collect();
    let mut crossing = crossing_edges(&vertices[..rim], &loops);
    crossing.extend(crossing_edges(&rounded, &loops));
    for k in turned_over(&vertices[..rim], &loops).chain(turned_over(&rounded, &loops)) {
        let farthest = beside[k].iter().max_by(|a, b| a.squared.total_cmp(&b.squared));
        crossing.push(loops[k].start + farthest.map_or(0, |point| point.edge as u32));
    }
    crossing.sort_unstable();
    crossing.dedup();
    (crossing.len(), crossing.into_iter().filter_map(stray).collect())
}

/// All boundary edges, to be searched for the nearest.
struct Edges {
    edges: Vec<[DVec2; 2]>,
    grid: SegmentGrid,
    /// How far is searched at first.
    reach: f64,
}

impl Edges {
    /// Edge `i` starts at vertex `i`.
    fn new(vertices: &[DVec2], arcs: &[Vec<f64>], reach: f64) -> Self {
        let mut edges: Vec<[DVec2; 2]> = Vec::new();
        let mut start = 0;
        for arcs in arcs {
            let n = arcs.len();
            edges.extend((0..n).map(|i| [vertices[start + i], vertices[start + (i + 1) % n]]));
            start += n;
        }
        let grid = SegmentGrid::new(&edges);
        Self { edges, grid, reach }
    }

    fn distance(&self, p: DVec2, edge: usize) -> f64 {
        let [a, b] = self.edges[edge];
        nearest_on_segment(p, a, b).1.sqrt()
    }

    /// Distance of the nearest edge, and which it is. `own` is any edge: none farther away is looked for.
    fn nearest(&self, p: DVec2, own: usize) -> (f64, usize) {
        let mut best = (self.distance(p, own), own);
        let mut reach = self.reach;
        loop {
            let reached = reach.min(best.0);
            self.grid.near(p - reached, p + reached, |i| {
                let distance = self.distance(p, i);
                if distance < best.0 || (distance == best.0 && i < best.1) {
                    best = (distance, i);
                }
            });
            if best.0 <= reach {
                return best;
            }
            reach *= 2.0;
        }
    }
}

/// The search for the point of a stretch of curve that is farthest from all edges.
struct Farthest<'a> {
    all: &'a Edges,
    /// The edge beside the stretch.
    own: usize,
    /// Distances below this are of no interest.
    above: f64,
    best: Beside,
    distance: f64,
}

impl Farthest<'_> {
    /// `before` and `after` are the ends of the edge, which lie on the curve. The farthest of the drawn
    /// points, and its distance.
    fn search(&mut self, before: Beside, stretch: &[Beside], after: Beside) -> (Beside, f64) {
        let mut known: Vec<Option<(f64, usize)>> = vec![None; stretch.len()];
        // The farthest from the edge beside them first: most of the others need not be measured then.
        let mut order: Vec<usize> = (0..stretch.len()).collect();
        order.sort_by(|&i, &j| stretch[j].squared.total_cmp(&stretch[i].squared));
        for i in order {
            if stretch[i].squared.sqrt() < self.distance.max(self.above) {
                break;
            }
            known[i] = Some(self.measure(stretch[i]));
        }
        let drawn = (self.best, self.distance);
        let at = |i: usize| match i {
            0 => before,
            i => stretch.get(i - 1).copied().unwrap_or(after),
        };
        for i in 0..=stretch.len() {
            let (from, to) = (at(i), at(i + 1));
            if from.squared.max(to.squared).sqrt() <= self.enough() {
                continue;
            }
            let near = [i, i + 1].map(|i| match i.checked_sub(1).and_then(|i| known.get(i)) {
                Some(known) => known.unwrap_or_else(|| self.all.nearest(at(i).point, self.own)),
                None => (0.0, self.own),
            });
            self.divide((from, near[0]), (to, near[1]));
        }
        drawn
    }

    /// What need not be found out: a thousandth of the limit more than what is known.
    fn enough(&self) -> f64 {
        self.distance.max(self.above) + 1e-3 * self.all.reach
    }

    fn measure(&mut self, point: Beside) -> (f64, usize) {
        let found = self.all.nearest(point.point, self.own);
        if found.0 > self.distance {
            (self.best, self.distance) = (point, found.0);
        }
        found
    }

    /// Searches a straight piece between two points whose nearest edges are known.
    fn divide(&mut self, from: (Beside, (f64, usize)), to: (Beside, (f64, usize))) {
        let mut pieces = vec![(from, to)];
        while let Some(((a, near_a), (b, near_b))) = pieces.pop() {
            let length = a.point.distance(b.point);
            let along = |edge: usize| self.all.distance(a.point, edge).max(self.all.distance(b.point, edge));
            let most = (0.5 * (near_a.0 + near_b.0 + length)).min(along(near_a.1)).min(along(near_b.1));
            if most <= self.enough() {
                continue;
            }
            let point = 0.5 * (a.point + b.point);
            let middle = Beside { point, arc: 0.5 * (a.arc + b.arc), ..a };
            let near = self.measure(middle);
            pieces.push(((middle, near), (b, near_b)));
            pieces.push(((a, near_a), (middle, near)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::curve::Winding;
    use crate::error::Result;

    #[test]
    fn a_cut_tip_is_found_and_measured() -> Result<()> {
        let drawn = [[0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [6.0, 4.0], [5.0, 9.0], [4.0, 4.0], [0.0, 4.0]];
        let drawn = drawn.map(DVec2::from_array);
        let contour = ClosedCurve::new(&drawn, Winding::CounterClockwise, "outline")?;
        // The boundary leaves the tip out.
        let kept = [0, 1, 2, 3, 5, 6];
        let vertices: Vec<DVec2> = kept.iter().map(|&i| drawn[i]).collect();
        let arcs = vec![kept.iter().map(|&i| contour.arc()[i]).collect::<Vec<f64>>()];
        let contours = [contour];
        let (worst, strays) = deviation(&beside(&contours, &vertices, &arcs), &vertices, &arcs, 2.0, 2.0);
        assert_eq!(worst, 5.0);
        assert_eq!(strays.len(), 1);
        assert_eq!((strays[0].edge, strays[0].point), (3, drawn[4]));
        let (worst, strays) = deviation(&beside(&contours, &vertices, &arcs), &vertices, &arcs, 6.0, 6.0);
        assert_eq!((worst, strays.len()), (5.0, 0));
        Ok(())
    }

    /// A needle whose tip ends beside another wall: its points are near the boundary without it, its middle is not.
    #[test]
    fn a_needle_is_missed_between_its_points() -> Result<()> {
        let drawn = [
            [0.0, 0.0],
            [20.0, 0.0],
            [20.0, 1.0],
            [4.0, 1.0],
            [4.0, 11.0],
            [18.0, 1.2],
            [4.2, 11.2],
            [0.0, 12.0],
        ];
        let drawn = drawn.map(DVec2::from_array);
        let contour = ClosedCurve::new(&drawn, Winding::CounterClockwise, "outline")?;
        // All but the tip.
        let own: Vec<usize> = (0..8).filter(|&i| contour.points()[i] != drawn[5]).collect();
        let vertices: Vec<DVec2> = own.iter().map(|&i| contour.points()[i]).collect();
        let arcs = vec![own.iter().map(|&i| contour.arc()[i]).collect()];
        let beside = beside(&[contour], &vertices, &arcs);
        let (worst, strays) = deviation(&beside, &vertices, &arcs, 0.7, 2.0);
        // By brute force.
        let n = vertices.len();
        let nearest = |p: DVec2| {
            let to = |i: usize| nearest_on_segment(p, vertices[i], vertices[(i + 1) % n]).1;
            (0..n).map(to).fold(f64::INFINITY, f64::min).sqrt()
        };
        let sides = [[drawn[4], drawn[5]], [drawn[5], drawn[6]]];
        let samples =
            sides.into_iter().flat_map(|[a, b]| (0..=20_000).map(move |k| a.lerp(b, f64::from(k) / 2e4)));
        let expected = samples.map(nearest).fold(0.0, f64::max);
        assert!(nearest(drawn[5]) < 0.5 && expected > 3.0);
        assert!((worst - expected).abs() < 2e-3, "{worst} {expected}");
        assert_eq!(strays.len(), 1);
        assert!((strays[0].distance - expected).abs() < 2e-3);
        Ok(())
    }

    #[test]
    fn an_edge_across_the_first_point_strays_once() -> Result<()> {
        // The first point, the one farthest left, lies in the middle of the tip that is cut off.
        let drawn = [[-5.0, 2.0], [-4.0, 1.5], [0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [0.0, 4.0], [-4.0, 2.5]];
        let drawn = drawn.map(DVec2::from_array);
        let contour = ClosedCurve::new(&drawn, Winding::CounterClockwise, "outline")?;
        let vertices: Vec<DVec2> = (2..6).map(|i| drawn[i]).collect();
        let arcs = vec![contour.arc()[2..6].to_vec()];
        let (worst, strays) = deviation(&beside(&[contour], &vertices, &arcs), &vertices, &arcs, 2.0, 2.0);
        assert_eq!(worst, 5.0);
        assert_eq!(strays.len(), 1);
        assert_eq!((strays[0].edge, strays[0].point), (3, drawn[0]));
        Ok(())
    }
}
