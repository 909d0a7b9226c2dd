//! The faces of a patch: triangles, or quads that the solvers know as pairs of triangles.

use glam::DVec3;

use super::patchwork::Patchwork;
use crate::fill::planar::stars::CornerStars;

impl Patchwork {
    /// Takes the first `quads` pairs of the patch's triangles for quads: `[a, b, c]` and `[a, c, d]` are `[a, b, c, d]`.
    pub fn of_quads(mut self, quads: usize) -> Patchwork {
        if quads > 0 {
            self.quads = quads;
            let all = self.quads().collect::<Vec<_>>();
            self.corners = Some(CornerStars::new(&all, self.single().first().copied(), self.n, self.end));
        }
        self
    }

    /// The quads of the patch.
    pub fn quads(&self) -> impl Iterator<Item = [u32; 4]> {
        self.triangles[..2 * self.quads].chunks_exact(2).map(|pair| {
            let ([a, b, c], [.., d]) = (pair[0], pair[1]);
            [a, b, c, d]
        })
    }

    /// The faces of the patch that are triangles.
    pub fn single(&self) -> &[[u32; 3]] {
        &self.triangles[2 * self.quads..self.n_patch]
    }

    /// How many faces of the patch each vertex of it has.
    pub fn faces_at(&self) -> Vec<usize> {
        let mut faces = vec![0; self.end];
        self.quads().flatten().for_each(|v| faces[v as usize] += 1);
        self.single().iter().flatten().for_each(|&v| faces[v as usize] += 1);
        faces
    }

    /// The least and the greatest corner of the patch's faces, in radians; beyond a straight angle where a quad is
    /// concave, seen along its normal. Zero twice if there is none.
    pub fn corner_range(&self, positions: &[DVec3]) -> [f64; 2] {
        let at = |v: u32| positions[v as usize];
        let mut range = [f64::INFINITY, 0.0];
        let mut corner = |before: DVec3, here: DVec3, after: DVec3, normal: DVec3| {
            let (back, ahead) = (before - here, after - here);
            let cross = ahead.cross(back);
            let angle = cross.length().atan2(ahead.dot(back));
            let angle = if cross.dot(normal) < 0.0 { std::f64::consts::TAU - angle } else { angle };
            range = [angle.min(range[0]), angle.max(range[1])];
        };
        for quad in self.quads() {
            let p = quad.map(at);
            let normal = (p[2] - p[0]).cross(p[3] - p[1]);
            (0..4).for_each(|k| corner(p[(k + 3) % 4], p[k], p[(k + 1) % 4], normal));
        }
        for triangle in self.single() {
            let p = triangle.map(at);
            (0..3).for_each(|k| corner(p[(k + 2) % 3], p[k], p[(k + 1) % 3], DVec3::ZERO));
        }
        if range[0].is_finite() { range } else { [0.0; 2] }
    }
}
