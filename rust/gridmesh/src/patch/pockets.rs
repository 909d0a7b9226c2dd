//! Interior vertices that lie outside the drawing: in inlets that the boundary bridges.

use std::cell::OnceCell;

use glam::DVec2;

use crate::drawing::contours::encloses;
use crate::geometry::segments::nearest_on_segment;
use crate::patch::deviation::{Beside, Stray};

/// Rings of vertices behind a boundary edge that are looked at.
const RINGS: usize = 3;

/// What boundary edges bridge.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pockets {
    /// The inlets (see [`Patch::inlets`](crate::patch::Patch::inlets)).
    pub(crate) inlets: Vec<Vec<DVec2>>,
    /// For each inlet with a mesh vertex in it the farthest point of the drawing beside the edge.
    /// `distance` is the greatest distance of such a vertex from the drawing.
    pub(crate) occupied: Vec<Stray>,
    /// Those vertices, each with its inlet.
    pub(crate) inside: Vec<(usize, usize)>,
}

/// The inlets that boundary edges bridge by more than `limit`, and the mesh vertices in them.
///
/// A vertex counts if it lies between the edge and the stretch of drawing beside it, by more than
/// `limit` off the drawing. `fans` are those of the triangles. `vertices` are numbered loop by loop, then the interior; `arcs` are the
/// loops' arc lengths, unwrapped. Linear.
pub(crate) fn pockets(
    beside: &[Vec<Beside>],
    vertices: &[DVec2],
    fans: &mut Fans<'_>,
    arcs: &[Vec<f64>],
    limit: f64,
) -> Pockets {
    let n_boundary: usize = arcs.iter().map(Vec::len).sum();
    let mut found = Pockets::default();
    let mut start = 0;
    for (contour, (beside, arcs)) in beside.iter().zip(arcs).enumerate() {
        let n = arcs.len();
        for stretch in beside.chunk_by(|a, b| a.edge == b.edge) {
            let Some(deepest) = stretch.iter().max_by(|a, b| a.squared.total_cmp(&b.squared)) else {
                continue;
            };
            if deepest.squared <= limit * limit {
                continue;
            }
            let edge = deepest.edge;
            let ends = [start + edge, start + (edge + 1) % n];
            let [a, b] = ends.map(|v| vertices[v]);
            let pocket: Vec<DVec2> =
                [a].into_iter().chain(stretch.iter().map(|p| p.point)).chain([b]).collect();
            // The mesh lies left of the edge; a stretch right of it bulges outwards.
            if doubled_area(&pocket) >= 0.0 {
                continue;
            }
            let mut depth = 0.0f64;
            for &v in fans.around(ends, RINGS) {
                let v = v as usize;
                if v >= n_boundary
                    && let Some(off) = depth_in(&pocket, vertices[v]).filter(|&off| off > limit)
                {
                    found.inside.push((v, found.inlets.len()));
                    depth = depth.max(off);
                }
            }
            if depth > limit {
                let Beside { point, arc, .. } = *deepest;
                found.occupied.push(Stray { contour, edge, arc, point, distance: depth });
            }
            found.inlets.push(pocket);
        }
        start += n;
    }
    found
}

/// How far a point in a pocket is from the drawing; none if it is not in it.
pub(crate) fn depth_in(pocket: &[DVec2], p: DVec2) -> Option<f64> {
    let low = pocket.iter().fold(pocket[0], |low, q| low.min(*q));
    let high = pocket.iter().fold(pocket[0], |high, q| high.max(*q));
    let in_box = p.cmpge(low).all() && p.cmple(high).all();
    (in_box && encloses(pocket, p)).then(|| distance_to(pocket, p))
}

fn doubled_area(polygon: &[DVec2]) -> f64 {
    let origin = polygon[0];
    polygon.windows(2).map(|w| (w[0] - origin).perp_dot(w[1] - origin)).sum()
}

/// Distance to an open polyline.
pub(crate) fn distance_to(line: &[DVec2], p: DVec2) -> f64 {
    line.windows(2).map(|w| nearest_on_segment(p, w[0], w[1]).1).fold(f64::INFINITY, f64::min).sqrt()
}

/// The triangles at each vertex, found when first asked for.
pub(crate) struct Fans<'a> {
    triangles: &'a [[u32; 3]],
    index: OnceCell<Index>,
    /// The search in which a vertex was found last.
    seen: Vec<u32>,
    searches: u32,
    found: Vec<u32>,
}

/// The triangles at each vertex: `items[starts[v]..starts[v + 1]]`.
struct Index {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Index {
    fn new(n_vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0u32; n_vertices + 1];
        for &v in triangles.iter().flatten() {
            starts[v as usize + 1] += 1;
        }
        for v in 0..n_vertices {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut items = vec![0; 3 * triangles.len()];
        for (t, corners) in triangles.iter().enumerate() {
            for &v in corners {
                items[next[v as usize] as usize] = t as u32;
                next[v as usize] += 1;
            }
        }
        Self { starts, items }
    }

    fn at(&self, v: usize) -> &[u32] {
        &self.items[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

impl<'a> Fans<'a> {
    pub(crate) fn new(n_vertices: usize, triangles: &'a [[u32; 3]]) -> Self {
        Self { triangles, index: OnceCell::new(), seen: vec![0; n_vertices], searches: 0, found: Vec::new() }
    }

    /// The triangles at a vertex, each beginning with it.
    pub(crate) fn at(&self, v: usize) -> impl Iterator<Item = [u32; 3]> {
        let index = self.index.get_or_init(|| Index::new(self.seen.len(), self.triangles));
        index.at(v).iter().map(move |&t| {
            let mut triangle = self.triangles[t as usize];
            let first = triangle.iter().position(|&w| w as usize == v).unwrap_or(0);
            triangle.rotate_left(first);
            triangle
        })
    }

    /// The vertices within `rings` edges of any of `seeds`.
    fn around(&mut self, seeds: [usize; 2], rings: usize) -> &[u32] {
        let index = self.index.get_or_init(|| Index::new(self.seen.len(), self.triangles));
        self.searches += 1;
        self.found.clear();
        self.found.extend(seeds.map(|v| v as u32));
        for v in seeds {
            self.seen[v] = self.searches;
        }
        let mut from = 0;
        for _ in 0..rings {
            let to = self.found.len();
            for i in from..to {
                let v = self.found[i] as usize;
                for &t in index.at(v) {
                    for w in self.triangles[t as usize] {
                        if std::mem::replace(&mut self.seen[w as usize], self.searches) != self.searches {
                            self.found.push(w);
                        }
                    }
                }
            }
            from = to;
        }
        &self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::curve::{ClosedCurve, Winding};
    use crate::error::Result;
    use crate::patch::deviation::beside;

    #[test]
    fn a_vertex_in_a_bridged_inlet_is_found() -> Result<()> {
        let drawn = [[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [6.0, 8.0], [5.0, 3.0], [4.0, 8.0], [0.0, 8.0]];
        let drawn = drawn.map(DVec2::from_array);
        let contour = ClosedCurve::new(&drawn, Winding::CounterClockwise, "outline")?;
        let kept = [0, 1, 2, 3, 5, 6];
        let mut vertices: Vec<DVec2> = kept.iter().map(|&i| drawn[i]).collect();
        let arcs = vec![kept.iter().map(|&i| contour.arc()[i]).collect::<Vec<f64>>()];
        vertices.push(DVec2::new(5.0, 5.0));
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [i, (i + 1) % 6, 6]).collect();
        let contours = [contour];
        let search = |vertices: &[DVec2]| {
            pockets(
                &beside(&contours, vertices, &arcs),
                vertices,
                &mut Fans::new(vertices.len(), &triangles),
                &arcs,
                0.1,
            )
        };
        let Pockets { inlets, occupied: found, inside } = search(&vertices);
        assert_eq!(inlets.len(), 1);
        assert!(inlets[0].contains(&drawn[4]));
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].edge, found[0].point), (3, drawn[4]));
        assert!((found[0].distance - 0.392).abs() < 1e-3, "{}", found[0].distance);
        assert_eq!(inside, [(6, 0)]);
        vertices[6] = DVec2::new(5.0, 2.0);
        assert!(search(&vertices).occupied.is_empty());
        Ok(())
    }
}
