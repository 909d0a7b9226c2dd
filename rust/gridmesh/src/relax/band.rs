//! The part of the patch that may move: the boundary and a few rings behind it.

use glam::DVec2;

/// The rings next to the boundary as a mesh of their own, numbered from the boundary inwards.
#[derive(Debug)]
pub(super) struct Band {
    /// Vertex numbers in the patch; the boundary vertices keep theirs.
    pub global: Vec<u32>,
    /// Vertices `0..n_rim` are on the boundary.
    pub n_rim: usize,
    /// Vertices `0..n_free` may move, the rest are fixed.
    pub n_free: usize,
    pub positions: Vec<DVec2>,
    /// Every triangle of the patch that has a vertex that may move.
    pub triangles: Vec<[u32; 3]>,
    start: Vec<u32>,
    around: Vec<u32>,
}

const FAR: u32 = u32::MAX;

impl Band {
    /// The rings `0..=rings` of a patch whose boundary vertices are `0..n_rim`; linear in the
    /// number of triangles. `Err` names a vertex that is not surrounded by one counter-clockwise
    /// fan of triangles.
    pub fn new(triangles: &[[u32; 3]], positions: &[DVec2], n_rim: usize, rings: usize) -> Result<Band, u32> {
        // `local` holds FAR, or the number in the band: vertices of one ring are consecutive.
        let mut local = vec![FAR; positions.len()];
        let mut global: Vec<u32> = (0..n_rim as u32).collect();
        local.iter_mut().zip(0..n_rim as u32).for_each(|(l, v)| *l = v);
        let mut near: Vec<[u32; 3]> = Vec::new();
        let mut rest: Vec<[u32; 3]> = Vec::new();
        let mut n_free = n_rim;
        for ring in 0..=rings {
            n_free = global.len();
            let reached = |t: &[u32; 3]| t.iter().any(|&v| local[v as usize] != FAR);
            let before = near.len();
            if ring == 0 {
                for t in triangles {
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
        let (start, around) = fans(&near, n_rim, n_free).map_err(|v| global[v])?;
        Ok(Band { global, n_rim, n_free, positions, triangles: near, start, around })
    }

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
        let Ok(band) = Band::new(&two_wheels(), &[DVec2::ZERO; 10], 8, 5) else {
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
        assert!(Band::new(&[[0, 1, 2], [0, 3, 4]], &[DVec2::ZERO; 5], 5, 1).is_err());
    }
}
