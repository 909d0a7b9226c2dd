//! Along which diagonal each quad of a patch is cut in two: where the surface bends least.

use glam::DVec3;

use super::fit::SEAM;
use super::patchwork::Patchwork;
use crate::error::Result;

/// Rounds over all quads, at most.
const ROUNDS: usize = 8;

/// Bending that must be saved, in squared radians of an edge between squares: for less the shorter diagonal stays.
const GAIN: f64 = 1e-3;

/// The bending of a quad that is folded along its diagonal, or whose diagonal the mesh has already.
const NEVER: f64 = 1e6;

/// What is on the other side of a quad's side.
#[derive(Clone, Copy, Debug)]
enum Beyond {
    /// Another quad, at this side of it.
    Quad(usize, usize),
    /// A triangle that stays as it is, of the patch or around it, wound as the quad is.
    Fixed(Facet, bool),
    Nothing,
}

/// The unit normal and the area of a triangle.
#[derive(Clone, Copy, Debug)]
struct Facet {
    normal: DVec3,
    area: f64,
}

impl Facet {
    fn new([a, b, c]: [DVec3; 3]) -> Facet {
        let doubled = (b - a).cross(c - a);
        Facet { normal: doubled.normalize_or_zero(), area: 0.5 * doubled.length() }
    }

    /// The bending across an edge between two.
    fn across(self, other: Facet, squared: f64) -> f64 {
        let (m, o) = (self.normal, other.normal);
        let angle = libm::atan2(m.cross(o).length(), m.dot(o));
        squared * angle * angle / (self.area + other.area).max(f64::MIN_POSITIVE)
    }
}

/// A quad in space, and its halves either way.
struct Quad {
    corners: [u32; 4],
    at: [DVec3; 4],
    /// Halves if cut from its first corner, then from its second.
    halves: [[Facet; 2]; 2],
    /// Bending within it, either way.
    own: [f64; 2],
    beyond: [Beyond; 4],
}

impl Quad {
    /// The half at a side, if cut from the first or the second corner.
    fn half(&self, side: usize, cut: usize) -> Facet {
        self.halves[cut][if cut == 0 { side / 2 } else { (side + 3) % 4 / 2 }]
    }
}

impl Patchwork {
    /// The same patch with its quads cut so that the surface bends least across their edges; none if they are already.
    /// Of the quads only the corner that is named first changes.
    ///
    /// # Errors
    /// [`crate::error::Error::Internal`].
    pub fn recut(&self, positions: &[DVec3]) -> Result<Option<Patchwork>> {
        if self.quads == 0 {
            return Ok(None);
        }
        let quads = self.quads_in_space(positions);
        let mut cut = vec![0; quads.len()];
        for _ in 0..ROUNDS {
            let mut changed = false;
            for k in 0..quads.len() {
                let [first, second] = [0, 1].map(|way| bending(&quads, &cut, k, way));
                let better = if cut[k] == 0 { second + GAIN < first } else { first + GAIN < second };
                if better {
                    cut[k] = 1 - cut[k];
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        if cut.iter().all(|&way| way == 0) {
            return Ok(None);
        }
        let mut triangles = self.triangles.clone();
        for (k, (quad, &way)) in quads.iter().zip(&cut).enumerate() {
            let q = quad.corners;
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| q[(i + way) % 4]);
            (triangles[2 * k], triangles[2 * k + 1]) = ([a, b, c], [a, c, d]);
        }
        let mut other = Patchwork::of(self.n, self.end, self.outer.clone(), triangles, self.n_patch)?;
        other.later.clone_from(&self.later);
        Ok(Some(other.of_quads(self.quads)))
    }

    fn quads_in_space(&self, positions: &[DVec3]) -> Vec<Quad> {
        let one = |(k, corners): (usize, [u32; 4])| {
            let at = corners.map(|v| positions[v as usize]);
            let halves = [0, 1].map(|way| {
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| at[(i + way) % 4]);
                [Facet::new([a, b, c]), Facet::new([a, c, d])]
            });
            let own = [0, 1].map(|way| {
                let [one, two] = halves[way];
                let bent = one.across(two, at[way].distance_squared(at[way + 2]));
                let folded = one.normal.dot(two.normal) <= 0.0;
                let there = self.is_edge_around(corners[way], corners[way + 2]);
                if folded || there { NEVER } else { bent }
            });
            let beyond = [0, 1, 2, 3].map(|side| self.beyond(k, corners, side, positions));
            Quad { corners, at, halves, own, beyond }
        };
        self.quads().enumerate().map(one).collect()
    }

    /// Whether the mesh around has an edge between two vertices.
    fn is_edge_around(&self, a: u32, b: u32) -> bool {
        let outside = |&&[t, p, q]: &&[u32; 3]| t as usize >= self.n_patch && (p == b || q == b);
        self.fan(a as usize).iter().any(|it| outside(&it))
    }

    fn beyond(&self, k: usize, corners: [u32; 4], side: usize, positions: &[DVec3]) -> Beyond {
        let (a, b) = (corners[side], corners[(side + 1) % 4]);
        let halves = 2 * self.quads;
        for &[t, p, q] in self.fan(a as usize) {
            let t = t as usize;
            if (p != b && q != b) || (t < halves && t / 2 == k) {
                continue;
            }
            if t < halves {
                let [[x, y, z], [.., w]] = [self.triangles[t / 2 * 2], self.triangles[t / 2 * 2 + 1]];
                let other = [x, y, z, w];
                let Some(there) = (0..4).find(|&i| other[i] == b && other[(i + 1) % 4] == a) else {
                    continue;
                };
                return Beyond::Quad(t / 2, there);
            }
            let facet = Facet::new(self.triangles[t].map(|v| positions[v as usize]));
            // One that runs from `a` to `b`, too, is wound the other way.
            let normal = if p == b { -facet.normal } else { facet.normal };
            return Beyond::Fixed(Facet { normal, ..facet }, t >= self.n_patch);
        }
        Beyond::Nothing
    }
}

/// The bending within a quad and across its sides if it is cut one way.
fn bending(quads: &[Quad], cut: &[usize], k: usize, way: usize) -> f64 {
    let quad = &quads[k];
    let across = |side: usize| {
        let half = quad.half(side, way);
        let squared = quad.at[side].distance_squared(quad.at[(side + 1) % 4]);
        match quad.beyond[side] {
            Beyond::Quad(other, there) => half.across(quads[other].half(there, cut[other]), squared),
            Beyond::Fixed(facet, true) => SEAM * half.across(facet, squared),
            Beyond::Fixed(facet, false) => half.across(facet, squared),
            Beyond::Nothing => 0.0,
        }
    };
    quad.own[way] + (0..4).map(across).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One quad in a loop of four, with a triangle outside each edge whose far corner is at a height.
    fn one(heights: [f64; 4], middle: [f64; 4]) -> (Patchwork, Vec<DVec3>) {
        let xy = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let far = [[0.5, -1.0], [2.0, 0.5], [0.5, 2.0], [-1.0, 0.5]];
        let at = |([x, y], z): (&[f64; 2], &f64)| DVec3::new(*x, *y, *z);
        let positions =
            xy.iter().zip(&middle).map(at).chain(far.iter().zip(&heights).map(at)).collect::<Vec<_>>();
        let around = (0..4u32).map(|k| [(k + 1) % 4, k, 4 + k]);
        let triangles = [[0, 1, 2], [0, 2, 3]].into_iter().chain(around).collect();
        let work = Patchwork::of(4, 4, vec![4, 5, 6, 7], triangles, 2).unwrap().of_quads(1);
        (work, positions)
    }

    #[test]
    fn a_quad_is_cut_where_it_goes_on_like_its_surroundings() {
        // A ridge from the second corner to the fourth goes on outside.
        let (work, positions) = one([0.25; 4].map(|h: f64| -h), [0.0, 0.5, 0.0, 0.5]);
        let cut = work.recut(&positions).unwrap().unwrap();
        assert_eq!(cut.triangles[..2], [[1, 2, 3], [1, 3, 0]]);
        assert_eq!(cut.recut(&positions).unwrap().map(|it| it.triangles), None, "it stays");
        let (work, positions) = one([0.0; 4], [0.0; 4]);
        assert!(work.recut(&positions).unwrap().is_none(), "a plane needs nothing");
    }

    #[test]
    fn an_edge_of_the_mesh_is_no_diagonal() {
        let (work, positions) = one([-0.25; 4], [0.0, 0.5, 0.0, 0.5]);
        let mut triangles = work.triangles.clone();
        triangles.push([1, 3, 6]);
        let work = Patchwork::of(4, 4, work.outer.clone(), triangles, 2).unwrap().of_quads(1);
        assert!(work.recut(&positions).unwrap().is_none());
    }
}
