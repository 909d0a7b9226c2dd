//! How far points of a contour lie outside the loop of a patch that follows it.

use std::cell::OnceCell;

use glam::DVec2;

use crate::geometry::segments::{SegmentGrid, nearest_on_segment};
use crate::patch::Patch;

/// Edges to each side of the one that follows a point, from which its distance is taken: an end may have been moved past it.
const BESIDE: usize = 1;

/// How far from its contour a vertex may be that lies on it, in edge lengths: coordinates of unions are rounded.
const ON: f64 = 1e-3;

/// So many segments ahead are looked at before all are sorted by their places: some times those of an edge.
const SOON: usize = 64;

/// Which edge of a loop follows each point of its contour.
#[derive(Clone, Debug)]
pub(super) struct Followers {
    /// Where each vertex of the loop lies on the contour: segment and share.
    places: Vec<f64>,
    edge: Vec<Option<u32>>,
    /// By edge, the points that it follows.
    points: Vec<Vec<u32>>,
}

impl Followers {
    /// For a loop whose vertices lie on `meshed`, the contour or a wider one, point for point.
    pub(super) fn new(patch: &Patch, k: usize, meshed: &[DVec2]) -> Self {
        let places = places(loop_of(patch, k), meshed, patch.lattice.edge_length);
        let (n, count) = (places.len(), meshed.len());
        let mut edge = vec![None; count];
        for i in 0..n {
            let (from, to) = (places[i], places[(i + 1) % n]);
            let span = (to - from).rem_euclid(count as f64);
            // Back by a little, where rounding puts two vertices the wrong way round: no point follows.
            if span > 0.5 * count as f64 && n > 3 {
                continue;
            }
            let (first, last) = (from.ceil() as usize, (from + span).floor() as usize);
            (first..=last).for_each(|at| edge[at % count] = Some(i as u32));
        }
        let mut points = vec![Vec::new(); n];
        for (at, edge) in edge.iter().enumerate() {
            if let Some(edge) = edge {
                points[*edge as usize].push(at as u32);
            }
        }
        Self { places, edge, points }
    }

    /// The edge that follows a point; none where what the contour encloses twice was merged.
    pub(super) fn edge(&self, at: usize) -> Option<usize> {
        self.edge[at].map(|edge| edge as usize)
    }

    /// The points whose distance from the loop its vertex `i` may change.
    pub(super) fn points_near(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        let n = self.points.len();
        let edges = (i + 2 * n - BESIDE - 1..=i + 2 * n + BESIDE).map(move |edge| &self.points[edge % n]);
        edges.flatten().map(|&at| at as usize)
    }

    /// How far a point of the contour is outside the edges of a loop that follow it; inside negative.
    pub(super) fn beyond(&self, points: &[DVec2], at: usize, point: DVec2) -> f64 {
        let n = points.len();
        self.edge(at).map_or(0.0, |edge| right_of(points, edge + n - BESIDE, 2 * BESIDE + 1, point))
    }

    /// How far the contour reaches beyond vertex `i` of a loop, if the loop is dented there: between two points of the contour
    /// edges go no deeper than at such a vertex.
    pub(super) fn beyond_dent(&self, points: &[DVec2], i: usize, contour: &[DVec2]) -> Option<f64> {
        let (n, count) = (points.len(), contour.len());
        let (before, after) = (if i == 0 { n - 1 } else { i - 1 }, if i + 1 == n { 0 } else { i + 1 });
        let (here, turn) = (points[i], (points[i] - points[before]).perp_dot(points[after] - points[i]));
        let span = (self.places[after] - self.places[before]).rem_euclid(count as f64);
        if turn >= 0.0 {
            return None;
        }
        // Around loops of few edges the neighbours are as near to each other the other way.
        let (first, segments) = if 2.0 * span > count as f64 {
            (0, count)
        } else {
            let first = self.places[before];
            (first as usize, (first + span).floor() as usize - first.floor() as usize + 1)
        };
        Some(-right_of(contour, first, segments, here))
    }

    /// How far the contour reaches beyond vertex `i` or one beside it where the loop is dented there.
    pub(super) fn beyond_dents(&self, points: &[DVec2], i: usize, contour: &[DVec2]) -> f64 {
        let n = points.len();
        let of = |i: usize| self.beyond_dent(points, i % n, contour);
        [i + n - 1, i, i + 1].into_iter().filter_map(of).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Notes a new vertex of the loop on an edge, at a point of the contour that the edge follows.
    pub(super) fn split(&mut self, edge: usize, at: usize) {
        let own = std::mem::take(&mut self.points[edge]);
        let here = own.iter().position(|&point| point as usize == at).unwrap_or(own.len());
        let (before, after) = own.split_at(here);
        let (before, after) = (before.to_vec(), after.to_vec());
        for edge_of in self.edge.iter_mut().flatten() {
            *edge_of += u32::from(*edge_of as usize > edge);
        }
        for &point in &after {
            self.edge[point as usize] = Some(edge as u32 + 1);
        }
        self.points[edge] = before;
        self.points.insert(edge + 1, after);
        self.places.insert(edge + 1, at as f64);
    }

    /// The point of the contour nearest to the place of vertex `i`.
    pub(super) fn point_at(&self, i: usize) -> usize {
        self.places[i].round() as usize % self.edge.len()
    }
}

/// How far a point lies to the right of the nearest one of some edges of a closed line, from the edge `first` on; to the left negative.
fn right_of(points: &[DVec2], first: usize, count: usize, point: DVec2) -> f64 {
    let n = points.len();
    let next = |i: usize| if i + 1 == n { 0 } else { i + 1 };
    let mut i = first % n;
    let mut nearest = (f64::INFINITY, 0.0, i);
    for _ in 0..count {
        let (share, squared) = nearest_on_segment(point, points[i], points[next(i)]);
        if squared < nearest.0 {
            nearest = (squared, share, i);
        }
        i = next(i);
    }
    let (squared, share, i) = nearest;
    let along = |j: usize| points[next(j)] - points[j];
    let is_right = |j: usize| along(j).perp_dot(point - points[j]) < 0.0;
    // At an end both edges there decide: outside of either at a turn to the left, of both at one to the right.
    let joint = |j: usize, k: usize| {
        if along(j).perp_dot(along(k)) > 0.0 {
            is_right(j) || is_right(k)
        } else {
            is_right(j) && is_right(k)
        }
    };
    let is_outside = if share >= 1.0 {
        joint(i, next(i))
    } else if share <= 0.0 {
        joint(if i == 0 { n - 1 } else { i - 1 }, i)
    } else {
        is_right(i)
    };
    if is_outside { squared.sqrt() } else { -squared.sqrt() }
}

/// Places of the vertices of a loop on the contour that they lie on, in order: segment and share.
fn places(vertices: &[DVec2], meshed: &[DVec2], edge_length: f64) -> Vec<f64> {
    let n = meshed.len();
    let on = ON * edge_length;
    let segment = |i: usize| [meshed[i], meshed[(i + 1) % n]];
    let share_on = |vertex: DVec2, i: usize| {
        let [a, b] = segment(i);
        let (share, squared) = nearest_on_segment(vertex, a, b);
        (squared <= on * on).then_some(share)
    };
    // Asked for where the vertices of a loop and the points of its contour do not keep step.
    let all = OnceCell::new();
    let grid = || {
        all.get_or_init(|| {
            let segments: Vec<[DVec2; 2]> = (0..n).map(segment).collect();
            (SegmentGrid::new(&segments), segments)
        })
    };
    let mut start = 0;
    let mut place = |&vertex: &DVec2| {
        // Where the search begins the next vertex is a few segments ahead.
        let soon = (0..n.min(SOON)).find_map(|k| {
            let i = (start + k) % n;
            share_on(vertex, i).map(|share| (i, share))
        });
        let (segment, share) = soon
            .or_else(|| {
                let mut ahead = Vec::new();
                grid().0.near(vertex - on, vertex + on, |i| ahead.push((i + n - start) % n));
                ahead.sort_unstable();
                ahead.into_iter().find_map(|k| {
                    let i = (start + k) % n;
                    share_on(vertex, i).map(|share| (i, share))
                })
            })
            .unwrap_or_else(|| {
                let (grid, segments) = grid();
                grid.nearest(segments, vertex)
            });
        start = segment;
        segment as f64 + share
    };
    vertices.iter().map(&mut place).collect()
}

/// The edges of one loop of a patch.
pub(super) struct LoopEdges<'a> {
    points: &'a [DVec2],
    followers: &'a Followers,
    /// Edges by the rows of equal height that they reach into.
    rows: Vec<Vec<u32>>,
    low: f64,
    height: f64,
    is_hole: bool,
}

impl<'a> LoopEdges<'a> {
    /// Those of the loop `k`.
    pub(super) fn new(patch: &'a Patch, k: usize, followers: &'a Followers) -> Self {
        let points = loop_of(patch, k);
        let n = points.len();
        let low = points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.y).fold(-f64::INFINITY, f64::max);
        let height = ((high - low) / n as f64).max(f64::MIN_POSITIVE);
        let mut rows = vec![Vec::new(); n + 1];
        for i in 0..n {
            let (a, b) = (points[i], points[(i + 1) % n]);
            let row = |y: f64| (((y - low) / height) as usize).min(n);
            for row in &mut rows[row(a.y.min(b.y))..=row(a.y.max(b.y))] {
                row.push(i as u32);
            }
        }
        Self { points, followers, rows, low, height, is_hole: k > 0 }
    }

    /// The distance of the contour's point `at` from the edges that follow the contour there, less the slack; 0 inside.
    ///
    /// Not from any edge: across a narrow inlet another part of the loop may be nearer, which has its own points to cover.
    pub(super) fn outside(&self, at: usize, point: DVec2, slack: f64) -> f64 {
        // The loop of a hole has the mesh around it.
        if self.encloses(point) != self.is_hole {
            return 0.0;
        }
        (self.distance(at, point) - slack).max(0.0)
    }

    fn edge(&self, i: usize) -> [DVec2; 2] {
        let n = self.points.len();
        [self.points[i % n], self.points[(i + 1) % n]]
    }

    /// Even-odd.
    fn encloses(&self, point: DVec2) -> bool {
        let row = (point.y - self.low) / self.height;
        if row < 0.0 || row >= self.rows.len() as f64 {
            return false;
        }
        let crossed = self.rows[row as usize].iter().filter(|&&i| {
            let [a, b] = self.edge(i as usize);
            (a.y <= point.y) != (b.y <= point.y)
                && a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x) > point.x
        });
        crossed.count() % 2 == 1
    }

    fn distance(&self, at: usize, point: DVec2) -> f64 {
        let n = self.points.len();
        let edges = match self.followers.edge(at) {
            Some(edge) => edge + n - BESIDE..=edge + n + BESIDE,
            None => 0..=n - 1,
        };
        let squared = edges.map(|i| {
            let [a, b] = self.edge(i);
            nearest_on_segment(point, a, b).1
        });
        squared.fold(f64::INFINITY, f64::min).sqrt()
    }
}

pub(super) fn loop_of(patch: &Patch, k: usize) -> &[DVec2] {
    let loop_ = &patch.loops[k];
    &patch.vertices[loop_.start as usize..][..loop_.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SketchOptions;
    use crate::progress::Progress;
    use crate::sketch::mesh_sketch;

    /// A block with an inlet of this width from above, points a half apart.
    fn inlet(width: f64) -> Vec<DVec2> {
        let half = 0.5 * width;
        let corners = [
            (-8.0, 0.0),
            (8.0, 0.0),
            (8.0, 12.0),
            (half, 12.0),
            (half, 4.0),
            (-half, 4.0),
            (-half, 12.0),
            (-8.0, 12.0),
        ]
        .map(DVec2::from);
        let mut points = Vec::new();
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let count = (2.0 * a.distance(b)).ceil();
            points.extend((0..count as usize).map(|i| a.lerp(b, i as f64 / count)));
        }
        points
    }

    #[test]
    fn each_wall_of_an_inlet_is_measured_from_its_own_edges() {
        let contour = inlet(1.0);
        let options = SketchOptions { triangles: Some(400), ..SketchOptions::default() };
        let mut patch = mesh_sketch(&contour, &[], &options, Progress::NONE).unwrap().patch;
        let followers = Followers::new(&patch, 0, &contour);
        assert!((0..contour.len()).all(|at| followers.edge(at).is_some()));
        let n = patch.loops[0].len();
        for i in 0..n {
            assert!(followers.points_near(i).count() < contour.len() / 3);
        }
        // The right wall moves away from the inlet by two: the left one is as far from its edges as before.
        for vertex in 0..n {
            let point = &mut patch.vertices[vertex];
            if point.x > 0.4 && point.x < 0.6 && point.y > 5.0 {
                point.x += 2.0;
            }
        }
        let edges = LoopEdges::new(&patch, 0, &followers);
        for (at, &point) in contour.iter().enumerate() {
            let expected = match point {
                DVec2 { x, y } if x == 0.5 && y > 7.0 && y < 11.0 => 2.0,
                DVec2 { x, y } if x == -0.5 && y > 7.0 => 0.0,
                _ => continue,
            };
            assert!((edges.outside(at, point, 0.0) - expected).abs() < 0.2, "{point}");
            assert!((followers.beyond(loop_of(&patch, 0), at, point) - expected).abs() < 0.2, "{point}");
        }
    }

    #[test]
    fn points_inside_are_less_than_nothing_beyond() {
        let contour = inlet(4.0);
        let options = SketchOptions { triangles: Some(400), ..SketchOptions::default() };
        let patch = mesh_sketch(&contour, &[], &options, Progress::NONE).unwrap().patch;
        let followers = Followers::new(&patch, 0, &contour);
        for (at, &point) in contour.iter().enumerate() {
            let inwards = if point.x.abs() == 8.0 { DVec2::new(-point.x.signum(), 0.0) } else { continue };
            if point.y > 2.0 && point.y < 10.0 {
                let beyond = |by: f64| followers.beyond(loop_of(&patch, 0), at, point + by * inwards);
                assert!((beyond(0.2) + 0.2).abs() < 0.1 && (beyond(-0.2) - 0.2).abs() < 0.1, "{point}");
            }
        }
    }
}
