//! The part of the patch that may move: the boundary and a few rings behind it.

use glam::DVec2;

use super::energy::{Energy, Local, local, value};

/// The rings next to the boundary as a mesh of their own, numbered from the boundary inwards.
///
/// `N` is the number of corners of its cells, triangles or quads.
#[derive(Debug)]
pub struct Band<const N: usize> {
    /// Vertex numbers in the patch; the boundary vertices keep theirs.
    pub global: Vec<u32>,
    /// Vertices `0..n_rim` are on the boundary.
    pub n_rim: usize,
    /// Vertices `0..n_free` may move, the rest are fixed.
    pub n_free: usize,
    /// Where they are, in lattice units.
    pub positions: Vec<DVec2>,
    /// Every cell of the patch that has a vertex that may move, as triangles that must stay positive: itself, or
    /// those at the four corners of a quad.
    pub triangles: Vec<[u32; 3]>,
    pub(super) start: Vec<u32>,
    pub(super) around: Vec<u32>,
    /// At each vertex the quads, as the three vertices that follow it: where they start, and they.
    pub(super) quads: (Vec<u32>, Vec<[u32; 3]>),
}

/// The cells around the vertices of a band.
pub trait Stars: Sized {
    /// The triangles that must stay positive for the cells to be valid.
    fn corners<const N: usize>(cells: &[[u32; N]]) -> Vec<[u32; 3]>;

    /// Fills in what is around each vertex. `Err` names one whose cells are not one fan.
    fn gather<const N: usize>(&mut self, cells: &[[u32; N]]) -> Result<(), usize>;

    /// The energy of the cells at a vertex, were it at `x`, with derivatives.
    fn local<E: Energy>(&self, energy: &E, vertex: usize, x: DVec2) -> Local;

    /// The energy alone.
    fn value<E: Energy>(&self, energy: &E, vertex: usize, x: DVec2) -> f64;

    /// Calls `visit` with the triangles that must stay positive at a vertex, it first.
    fn each_corner(&self, vertex: usize, visit: impl FnMut([u32; 3]));

    /// The cells' own corners at a vertex: the two neighbours that enclose each.
    fn own_corners(&self, vertex: usize) -> impl Iterator<Item = [u32; 2]>;
}

impl Stars for Band<3> {
    fn corners<const N: usize>(cells: &[[u32; N]]) -> Vec<[u32; 3]> {
        cells.iter().map(|c| [c[0], c[1], c[2]]).collect()
    }

    fn gather<const N: usize>(&mut self, _cells: &[[u32; N]]) -> Result<(), usize> {
        (self.start, self.around) = fans(&self.triangles, self.n_rim, self.n_free)?;
        Ok(())
    }

    fn local<E: Energy>(&self, energy: &E, vertex: usize, x: DVec2) -> Local {
        local(energy, x, self.around(vertex), &self.positions)
    }

    fn value<E: Energy>(&self, energy: &E, vertex: usize, x: DVec2) -> f64 {
        value(energy, x, self.around(vertex), &self.positions)
    }

    fn each_corner(&self, vertex: usize, mut visit: impl FnMut([u32; 3])) {
        self.around(vertex).windows(2).for_each(|pair| visit([vertex as u32, pair[0], pair[1]]));
    }

    fn own_corners(&self, vertex: usize) -> impl Iterator<Item = [u32; 2]> {
        self.around(vertex).windows(2).map(|pair| [pair[0], pair[1]])
    }
}

const FAR: u32 = u32::MAX;

impl<const N: usize> Band<N>
where
    Self: Stars,
{
    /// The rings `0..=rings` of a patch whose boundary vertices are `0..n_rim`; linear in the
    /// number of cells. `Err` names a vertex that is not surrounded by one counter-clockwise fan of cells.
    pub fn new(cells: &[[u32; N]], positions: &[DVec2], n_rim: usize, rings: usize) -> Result<Self, u32> {
        // `local` holds FAR, or the number in the band: vertices of one ring are consecutive.
        let mut local = vec![FAR; positions.len()];
        let mut global: Vec<u32> = (0..n_rim as u32).collect();
        local.iter_mut().zip(0..n_rim as u32).for_each(|(l, v)| *l = v);
        let mut near: Vec<[u32; N]> = Vec::new();
        let mut rest: Vec<[u32; N]> = Vec::new();
        let mut n_free = n_rim;
        for ring in 0..=rings {
            n_free = global.len();
            let reached = |t: &[u32; N]| t.iter().any(|&v| local[v as usize] != FAR);
            let before = near.len();
            if ring == 0 {
                for t in cells {
                    if reached(t) { near.push(*t) } else { rest.push(*t) }
                }
            } else {
                rest.retain(|t| {
                    let take = reached(t);
                    if take {
                        near.push(*t);
                    }
                    !take
                });
            }
            for &v in near[before..].iter().flatten() {
                if local[v as usize] == FAR {
                    local[v as usize] = global.len() as u32;
                    global.push(v);
                }
            }
            if rest.is_empty() && global.len() == n_free {
                break;
            }
        }
        for v in near.iter_mut().flatten() {
            *v = local[*v as usize];
        }
        let positions = global.iter().map(|&v| positions[v as usize]).collect();
        let triangles = Self::corners(&near);
        let (start, around) = (Vec::new(), Vec::new());
        let mut band = Band {
            global,
            n_rim,
            n_free,
            positions,
            triangles,
            start,
            around,
            quads: (Vec::new(), Vec::new()),
        };
        band.gather(&near).map_err(|v| band.global[v])?;
        Ok(band)
    }
}

impl<const N: usize> Band<N> {
    /// The neighbours of a vertex that may move, counter-clockwise. Around an interior vertex the
    /// first is repeated at the end, so that each pair in a row makes a triangle.
    pub fn around(&self, vertex: usize) -> &[u32] {
        &self.around[self.start[vertex] as usize..self.start[vertex + 1] as usize]
    }
}

/// Sorts the triangles around each vertex into a fan.
fn fans(triangles: &[[u32; 3]], n_rim: usize, n_free: usize) -> Result<(Vec<u32>, Vec<u32>), usize> {
    let mut start = vec![0u32; n_free + 1];
    for &v in triangles.iter().flatten() {
        if (v as usize) < n_free {
            start[v as usize + 1] += 1;
        }
    }
    for v in 0..n_free {
        start[v + 1] += start[v];
    }
    let mut fill = start.clone();
    let mut pairs = vec![(0u32, 0u32); start[n_free] as usize];
    for &[a, b, c] in triangles {
        for (v, pair) in [(a, (b, c)), (b, (c, a)), (c, (a, b))] {
            if (v as usize) < n_free {
                pairs[fill[v as usize] as usize] = pair;
                fill[v as usize] += 1;
            }
        }
    }
    let mut offsets = Vec::with_capacity(n_free + 1);
    let mut around = Vec::with_capacity(pairs.len() + n_free);
    offsets.push(0);
    for v in 0..n_free {
        let fan = &mut pairs[start[v] as usize..start[v + 1] as usize];
        if fan.is_empty() {
            return Err(v);
        }
        if v < n_rim {
            // An open fan begins with the neighbour that no triangle leads to.
            let Some(first) = (0..fan.len()).find(|&i| fan.iter().all(|p| p.1 != fan[i].0)) else {
                return Err(v);
            };
            fan.swap(0, first);
        }
        around.push(fan[0].0);
        around.push(fan[0].1);
        for i in 1..fan.len() {
            let Some(next) = (i..fan.len()).find(|&j| fan[j].0 == fan[i - 1].1) else {
                return Err(v);
            };
            fan.swap(i, next);
            around.push(fan[i].1);
        }
        if v >= n_rim && fan[0].0 != fan[fan.len() - 1].1 {
            return Err(v);
        }
        offsets.push(around.len() as u32);
    }
    Ok((offsets, around))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wheels side by side: two interior vertices.
    fn two_wheels() -> Vec<[u32; 3]> {
        let (p, q) = (8, 9);
        let ring = |c: u32, r: [u32; 6]| (0..6).map(move |i| [c, r[i], r[(i + 1) % 6]]);
        let mut all: Vec<[u32; 3]> = ring(p, [0, 1, q, 5, 6, 7]).chain(ring(q, [2, 3, 4, 5, p, 1])).collect();
        all.retain(|t| !(t[0] == q && t[1..].contains(&p)));
        all
    }

    #[test]
    fn fans_are_counter_clockwise_and_open_only_on_the_boundary() {
        let Ok(band) = Band::<3>::new(&two_wheels(), &[DVec2::ZERO; 10], 8, 5) else {
            unreachable!("two wheels are a patch");
        };
        assert_eq!((band.n_rim, band.n_free), (8, 10));
        assert_eq!(band.around(1), [2, 9, 8, 0]);
        let around: Vec<u32> = band.around(8).to_vec();
        assert_eq!(around.len(), 7);
        assert_eq!(around.first(), around.last());
    }

    #[test]
    fn two_fans_at_a_vertex_are_refused() {
        assert!(Band::<3>::new(&[[0, 1, 2], [0, 3, 4]], &[DVec2::ZERO; 5], 5, 1).is_err());
    }
}
