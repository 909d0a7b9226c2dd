//! How far a drawing lies from the boundary of its mesh.

use std::ops::Range;

use glam::DVec2;

use crate::curve::ClosedCurve;
use crate::embed::crossing_edges;
use crate::segments::{SegmentGrid, nearest_on_segment};

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

/// The greatest distance from the drawn points to the mesh boundary, and the strays: the farthest
/// point beside each edge from which the drawing is more than `limit` away.
///
/// Each point is measured against the edge [`beside`] it, which bounds the distance of all the
/// curve between the points; only where that exceeds `limit`, against all edges nearby.
pub(crate) fn deviation(
    beside: &[Vec<Beside>],
    vertices: &[DVec2],
    arcs: &[Vec<f64>],
    limit: f64,
) -> (f64, Vec<Stray>) {
    let mut worst = 0.0f64;
    let mut far: Vec<Stray> = Vec::new();
    for (contour, points) in beside.iter().enumerate() {
        for &Beside { point, edge, arc, squared } in points {
            if squared > limit * limit {
                far.push(Stray { contour, edge, arc, point, distance: squared.sqrt() });
            } else {
                worst = worst.max(squared);
            }
        }
    }
    worst = worst.sqrt();
    if !far.is_empty() {
        measure_all_round(&mut far, vertices, arcs, limit);
    }
    worst = far.iter().map(|stray| stray.distance).fold(worst, f64::max);
    far.retain(|stray| stray.distance > limit);
    // The farthest of each edge; the first and the last points may share one.
    far.sort_by(|a, b| (a.contour, a.edge).cmp(&(b.contour, b.edge)).then(b.distance.total_cmp(&a.distance)));
    far.dedup_by_key(|stray| (stray.contour, stray.edge));
    (worst, far)
}

/// The boundary edges that cross others, each with the farthest drawn point beside it.
pub(crate) fn crossings(beside: &[Vec<Beside>], vertices: &[DVec2], arcs: &[Vec<f64>]) -> Vec<Stray> {
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
    crossing_edges(vertices, &loops).into_iter().filter_map(stray).collect()
}

/// Replaces the distances by those to the nearest of all boundary edges.
fn measure_all_round(far: &mut [Stray], vertices: &[DVec2], arcs: &[Vec<f64>], limit: f64) {
    let mut edges: Vec<[DVec2; 2]> = Vec::new();
    let mut start = 0;
    for arcs in arcs {
        let n = arcs.len();
        edges.extend((0..n).map(|i| [vertices[start + i], vertices[start + (i + 1) % n]]));
        start += n;
    }
    let grid = SegmentGrid::new(&edges);
    let distance = |p: DVec2, i: usize| nearest_on_segment(p, edges[i][0], edges[i][1]).1;
    for stray in far {
        let mut squared = f64::INFINITY;
        grid.near(stray.point - limit, stray.point + limit, |i| {
            squared = squared.min(distance(stray.point, i));
        });
        if squared > limit * limit {
            squared = (0..edges.len()).map(|i| distance(stray.point, i)).fold(f64::INFINITY, f64::min);
        }
        stray.distance = squared.sqrt();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Winding;
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
        let (worst, strays) = deviation(&beside(&contours, &vertices, &arcs), &vertices, &arcs, 2.0);
        assert_eq!(worst, 5.0);
        assert_eq!(strays.len(), 1);
        assert_eq!((strays[0].edge, strays[0].point), (3, drawn[4]));
        let (worst, strays) = deviation(&beside(&contours, &vertices, &arcs), &vertices, &arcs, 6.0);
        assert_eq!((worst, strays.len()), (5.0, 0));
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
        let (worst, strays) = deviation(&beside(&[contour], &vertices, &arcs), &vertices, &arcs, 2.0);
        assert_eq!(worst, 5.0);
        assert_eq!(strays.len(), 1);
        assert_eq!((strays[0].edge, strays[0].point), (3, drawn[0]));
        Ok(())
    }
}
