//! The faces of a patch: triangles, or quads that the solvers know as pairs of triangles.

use glam::{DVec2, DVec3};

use super::fair::{Bending, Membrane};
use super::fit::{Faults, SEAM, SEAM_OF_CURVATURE, Solved, TANGLED, curvature_target, sound};
use super::patchwork::Patchwork;
use crate::error::{Error, Result};
use crate::fill::filled::Shape;
use crate::fill::loops::mesh::Rim;
use crate::fill::loops::reserve::room;
use crate::fill::options::Smooth;
use crate::fill::planar::flat_patch::quads_of;
use crate::geometry::corner::Ideal;
use crate::geometry::stars::{CornerStars, Stars};
use crate::options::CellShape;
use crate::progress::Progress;

/// Share of the last step that is taken: with all of it patches of few quads bulge, since diagonals stand for curved
/// quads; with none of it their seams are rougher than those of triangles by a quarter.
const POLISH: f64 = 0.7;

impl Shape {
    /// The same with a vertex in the middle of each quad, and four triangles around it: bent, it is the same in all
    /// directions, where a diagonal would make a difference.
    pub(in crate::fill) fn centred(&self) -> Result<Shape> {
        let work = &self.work;
        let (end, more) = (work.end, work.quads);
        let quads = work.quads().collect::<Vec<_>>();
        let centre = |k: usize| (end + k) as u32;
        let four = |(k, q): (usize, &[u32; 4])| [0, 1, 2, 3].map(|i| [q[i], q[(i + 1) % 4], centre(k)]);
        let mut triangles = quads.iter().enumerate().flat_map(four).collect::<Vec<_>>();
        triangles.extend(work.single());
        let n_patch = triangles.len();
        let shifted = |v: u32| if (v as usize) < end { v } else { v + more as u32 };
        triangles.extend(work.triangles[work.n_patch..].iter().map(|t| t.map(shifted)));
        let mut fine = Patchwork::of(work.n, end + more, work.outer.clone(), triangles, n_patch)?;
        fine.corners =
            Some(CornerStars::new(&quads, work.single().first().copied(), work.n, end).with_centres(&quads));
        let mut flat = self.flat.clone();
        flat.extend(quads.iter().map(|q| q.iter().map(|&v| self.flat[v as usize]).sum::<DVec2>() / 4.0));
        Ok(Shape { work: fine, flat, ..self.clone() })
    }

    /// Positions for a mesh with vertices at `mesh`.
    ///
    /// # Errors
    /// As [`Shape::solved`].
    pub(in crate::fill) fn solve(&self, mesh: &[DVec3], progress: Progress<'_>) -> Result<Solved> {
        if self.work.quads == 0 {
            return self.solved(mesh, progress);
        }
        let middle = self.bent_on_centres(mesh, progress.part(0.0, 0.6))?;
        self.finished(middle, mesh, progress.part(0.6, 1.0))
    }

    /// The same for a patch that is new: its quads are cut along the diagonals that bend it least.
    ///
    /// # Errors
    /// As [`Shape::solved`].
    pub(in crate::fill) fn cut_and_solve(
        &mut self,
        mesh: &[DVec3],
        progress: Progress<'_>,
    ) -> Result<Solved> {
        if self.work.quads == 0 {
            return self.solved(mesh, progress);
        }
        let middle = self.bent_on_centres(mesh, progress.part(0.0, 0.6))?;
        if let Some(work) = self.work.recut(&middle.positions)? {
            self.work = work;
        }
        self.finished(middle, mesh, progress.part(0.6, 1.0))
    }

    /// Positions that do not depend on how the quads are cut.
    fn bent_on_centres(&self, mesh: &[DVec3], progress: Progress<'_>) -> Result<Solved> {
        let mut solved = self.centred()?.solved(mesh, progress)?;
        solved.positions.drain(self.work.end..self.work.end + self.work.quads);
        Ok(solved)
    }

    /// Those brought to the diagonals.
    fn finished(&self, mut solved: Solved, mesh: &[DVec3], progress: Progress<'_>) -> Result<Solved> {
        let mut polished = solved.positions.clone();
        let bends = self.smooth != Smooth::Flat && !self.work.inner().is_empty();
        if bends && !self.is_coarse(solved.rim_angle) {
            match self.polish(&mut polished, progress.part(0.0, 0.0)) {
                Ok(()) => {
                    for (p, to) in solved.positions.iter_mut().zip(polished) {
                        *p = p.lerp(to, POLISH);
                    }
                }
                // Triangles without area can spoil the equations.
                Err(Error::Solver { .. }) => {}
                Err(other) => return Err(other),
            }
        }
        let film = solved.faults.film;
        solved.faults = Faults { film, ..self.faults(&solved.positions, TANGLED, progress.part(0.0, 0.2))? };
        if solved.faults == Faults::default() {
            return Ok(solved);
        }
        // Where much is bent on few quads, the other way may be better.
        let mut plain = self.solved(mesh, progress.part(0.2, 0.7))?;
        let film = plain.faults.film;
        plain.faults = Faults { film, ..self.faults(&plain.positions, TANGLED, progress.part(0.7, 1.0))? };
        Ok(if plain.faults < solved.faults { plain } else { solved })
    }

    /// A step along the normals with the diagonals that the quads are cut along: they are what meets the
    /// surroundings in the end.
    fn polish(&self, positions: &mut [DVec3], progress: Progress<'_>) -> Result<()> {
        let work = &self.work;
        let bending = Bending::new(work, progress)?;
        let curvature = self.smooth == Smooth::Curvature;
        let target = match curvature {
            true => Some(curvature_target(work, &Membrane::new(work, progress)?, positions, progress)?),
            false => None,
        };
        let seam = if curvature { SEAM_OF_CURVATURE } else { SEAM };
        bending.normal_step(positions, seam, target.as_deref(), progress)?;
        sound(positions)
    }

    /// What is wrong with positions of all vertices; meetings are counted up to `most`, or some more.
    pub(in crate::fill) fn faults(
        &self,
        positions: &[DVec3],
        most: usize,
        progress: Progress<'_>,
    ) -> Result<Faults> {
        let mut faults = Faults::of(&self.work, positions, most, progress)?;
        faults.folds += self.work.concave(positions);
        Ok(faults)
    }
}

/// Corners of faces are good above this, in radians.
pub(in crate::fill) fn good_corner(cells: CellShape) -> f64 {
    match cells {
        CellShape::Triangle => 0.35,
        CellShape::Quad => 0.525,
    }
}

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
        quads_of(&self.triangles[..2 * self.quads])
    }

    /// The faces of the patch that are triangles.
    pub fn single(&self) -> &[[u32; 3]] {
        &self.triangles[2 * self.quads..self.n_patch]
    }

    /// The corners that a new vertex should make good, into `star`.
    pub fn star(&self, v: usize, star: &mut Vec<(u32, u32, Ideal)>) {
        star.clear();
        match &self.corners {
            Some(corners) => star.extend(corners.triangles(v - self.n)),
            None => star.extend(self.fan(v).iter().map(|&[_, i, j]| (i, j, Ideal::Equilateral))),
        }
    }

    /// How many faces of the patch each vertex of it has.
    pub fn faces_at(&self) -> Vec<usize> {
        let mut faces = vec![0; self.end];
        self.quads().flatten().for_each(|v| faces[v as usize] += 1);
        self.single().iter().flatten().for_each(|&v| faces[v as usize] += 1);
        faces
    }

    /// New vertices that have another number of neighbours, or of quads, than regular ones; and those of the loops with
    /// other faces than the mesh leaves room for. `loops`: as the patch's boundary runs.
    pub fn irregular<'a>(
        &self,
        loops: impl Iterator<Item = &'a [u32]>,
        rim: &Rim,
        polygons: &[u32],
    ) -> [usize; 2] {
        if self.quads == 0 {
            let valence = |v: &usize| self.range(*v).len() != 6;
            return [self.inner().filter(valence).count(), (0..self.n).filter(valence).count()];
        }
        let faces = self.faces_at();
        let room = loops.flat_map(|loop_| room(loop_, rim, polygons));
        let off = room.zip(&faces).filter(|(room, faces)| (*room - **faces as f64).abs() > 0.5);
        [self.inner().filter(|&v| faces[v] != 4).count(), off.count()]
    }

    /// How many corners of quads are beyond a straight angle, seen along the normal.
    pub fn concave(&self, positions: &[DVec3]) -> usize {
        let one = |quad: [u32; 4]| {
            let p = quad.map(|v| positions[v as usize]);
            let normal = (p[2] - p[0]).cross(p[3] - p[1]);
            let is_concave =
                |k: usize| (p[(k + 1) % 4] - p[k]).cross(p[(k + 3) % 4] - p[k]).dot(normal) <= 0.0;
            (0..4).filter(|&k| is_concave(k)).count()
        };
        self.quads().map(one).sum()
    }

    /// The least and the greatest corner of the patch's faces, in radians; beyond a straight angle where a quad is
    /// concave, seen along its normal. Zero twice if there is none.
    pub fn corner_range(&self, positions: &[DVec3]) -> [f64; 2] {
        let at = |v: u32| positions[v as usize];
        // Of corners that are less than straight the squared cosine with its sign tells which is greater.
        let mut found: [Option<(f64, f64)>; 2] = [None; 2];
        let mut extremes = [f64::NEG_INFINITY, f64::INFINITY];
        let mut reflex: f64 = 0.0;
        let mut corner = |before: DVec3, here: DVec3, after: DVec3, normal: DVec3| {
            let (back, ahead) = (before - here, after - here);
            let cross = ahead.cross(back);
            let (squared, dot) = (cross.length_squared(), ahead.dot(back));
            if cross.dot(normal) < 0.0 {
                reflex = reflex.max(std::f64::consts::TAU - libm::atan2(squared.sqrt(), dot));
                return;
            }
            let whole = dot * dot + squared;
            let cosine = if whole > 0.0 { dot * dot.abs() / whole } else { 1.0 };
            if cosine > extremes[0] {
                (extremes[0], found[0]) = (cosine, Some((squared, dot)));
            }
            if cosine < extremes[1] {
                (extremes[1], found[1]) = (cosine, Some((squared, dot)));
            }
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
        let angles = found.map(|corner| corner.map(|(squared, dot)| libm::atan2(squared.sqrt(), dot)));
        match angles {
            [Some(least), Some(greatest)] => [least, greatest.max(reflex)],
            // Never with faces: a quad has three corners that are no reflex ones.
            _ => [reflex; 2],
        }
    }
}

/// Two triangles of a quad, cut where it is shorter.
pub(in crate::fill) fn cut([a, b, c, d]: [u32; 4], at: impl Fn(u32) -> DVec3) -> [[u32; 3]; 2] {
    if at(a).distance_squared(at(c)) <= at(b).distance_squared(at(d)) {
        [[a, b, c], [a, c, d]]
    } else {
        [[b, c, d], [b, d, a]]
    }
}
