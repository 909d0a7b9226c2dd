//! The triangles around each interior vertex of a patch that are to be positive, and near to an ideal each.

use super::corner::Ideal;

/// What is around each interior vertex of a patch.
pub(crate) trait Stars {
    /// Vertices of the loop: interior ones are numbered from there.
    fn n_loop(&self) -> usize;

    /// Interior vertices.
    fn len(&self) -> usize;

    /// The neighbours of the i-th interior vertex.
    fn near(&self, i: usize) -> &[u32];

    /// The triangles at the i-th interior vertex that are to be positive and near to their ideals, by the two other
    /// vertices, counter-clockwise.
    fn triangles(&self, i: usize) -> impl Iterator<Item = (u32, u32, Ideal)>;
}

/// The corners around each interior vertex of a patch of quads with a triangle or none: its own in each quad, and
/// those beside it.
#[derive(Clone, Debug)]
pub(crate) struct CornerStars {
    n_loop: usize,
    start: Vec<u32>,
    corners: Vec<(u32, u32, Ideal)>,
    near_start: Vec<u32>,
    near: Vec<u32>,
}

impl CornerStars {
    /// Of a patch with the vertices of its loop first.
    pub fn new(quads: &[[u32; 4]], odd: Option<[u32; 3]>, n_loop: usize, n_vertices: usize) -> Self {
        let mut fans: Vec<Vec<(u32, u32, Ideal)>> = vec![vec![]; n_vertices - n_loop];
        let mut near: Vec<Vec<u32>> = vec![vec![]; n_vertices - n_loop];
        for quad in quads {
            for k in 0..4 {
                let Some(i) = (quad[k] as usize).checked_sub(n_loop) else { continue };
                let [next, far, last] = [1, 2, 3].map(|ahead| quad[(k + ahead) % 4]);
                fans[i].extend([
                    (next, last, Ideal::Own),
                    (next, far, Ideal::Next),
                    (far, last, Ideal::Last),
                ]);
                near[i].extend([next, last]);
            }
        }
        if let Some(triangle) = odd {
            for k in 0..3 {
                let Some(i) = (triangle[k] as usize).checked_sub(n_loop) else { continue };
                let [next, last] = [1, 2].map(|ahead| triangle[(k + ahead) % 3]);
                fans[i].push((next, last, Ideal::Equilateral));
                near[i].extend([next, last]);
            }
        }
        let mut stars =
            CornerStars { n_loop, start: vec![0], corners: vec![], near_start: vec![0], near: vec![] };
        for (fan, mut near) in fans.into_iter().zip(near) {
            near.sort_unstable();
            near.dedup();
            stars.corners.extend(fan);
            stars.start.push(stars.corners.len() as u32);
            stars.near.extend(near);
            stars.near_start.push(stars.near.len() as u32);
        }
        stars
    }

    /// The corners around the i-th interior vertex, see [`Stars::triangles`].
    pub fn corners(&self, i: usize) -> &[(u32, u32, Ideal)] {
        &self.corners[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// With a vertex more for each quad, in its middle.
    pub fn with_centres(mut self, quads: &[[u32; 4]]) -> Self {
        for quad in quads {
            self.corners.extend((0..4).map(|k| (quad[k], quad[(k + 1) % 4], Ideal::Own)));
            self.start.push(self.corners.len() as u32);
            self.near.extend(quad);
            self.near_start.push(self.near.len() as u32);
        }
        self
    }
}

impl Stars for CornerStars {
    fn n_loop(&self) -> usize {
        self.n_loop
    }

    fn len(&self) -> usize {
        self.start.len() - 1
    }

    fn near(&self, i: usize) -> &[u32] {
        &self.near[self.near_start[i] as usize..self.near_start[i + 1] as usize]
    }

    fn triangles(&self, i: usize) -> impl Iterator<Item = (u32, u32, Ideal)> {
        self.corners(i).iter().copied()
    }
}
