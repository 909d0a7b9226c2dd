//! A fill taken apart and put together again, for those who store it.

use glam::{DVec2, DVec3};

use crate::error::{Error, Result};
use crate::fill::filled::{Bridged, Fill, Shape};
use crate::fill::options::Smooth;
use crate::fill::report::FillReport;
use crate::fill::surface::patchwork::Patchwork;

/// All that a [`Fill`] knows but its report.
#[derive(Clone, Debug, PartialEq)]
pub struct FillParts {
    /// The loop as the patch's boundary runs.
    pub loop_: Vec<u32>,
    /// It was given the other way round.
    pub reversed: bool,
    /// The loops after the first, of a patch between several.
    pub bridged: Vec<Bridged>,
    /// How the patch continues the surface.
    pub smooth: Smooth,
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Loop, then new vertices, as laid out in the plane.
    pub flat: Vec<DVec2>,
    /// Loop, new vertices, those around.
    pub positions: Vec<DVec3>,
    /// The mesh's numbers of the vertices around.
    pub outer: Vec<u32>,
    /// The patch's triangles, then those around, by the place of their vertices in `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// How many of them are the patch's.
    pub patch: usize,
    /// How many pairs of those, from the first on, are quads: `[a, b, c]` and `[a, c, d]`.
    pub quads: usize,
    /// Hard edges, by the place of their vertices in `positions`.
    pub creases: Vec<[u32; 2]>,
}

impl Fill {
    /// What this fill is made of.
    pub fn parts(&self) -> FillParts {
        let shape = self.shape.as_ref();
        let work = &shape.work;
        FillParts {
            loop_: shape.loop_.clone(),
            reversed: shape.reversed,
            bridged: shape.bridged.clone(),
            smooth: shape.smooth,
            vertices: shape.vertices,
            flat: shape.flat.clone(),
            positions: shape.positions.clone(),
            outer: work.outer.clone(),
            triangles: work.triangles.clone(),
            patch: work.n_patch,
            quads: work.quads,
            creases: shape.creases.clone(),
        }
    }

    /// The fill that these are the parts of.
    ///
    /// # Errors
    /// [`Error::InvalidOption`] if they do not fit together.
    pub fn from_parts(parts: FillParts, report: FillReport) -> Result<Fill> {
        let FillParts {
            loop_,
            reversed,
            bridged,
            smooth,
            vertices,
            flat,
            positions,
            outer,
            triangles,
            patch,
            quads,
            creases,
        } = parts;
        let (n, end) = (loop_.len(), flat.len());
        let loops = [0].into_iter().chain(bridged.iter().map(|b| b.first)).chain([n]).collect::<Vec<_>>();
        let known = |v: &u32| (*v as usize) < vertices;
        let within = |t: &[u32; 3], most: usize| {
            t.iter().all(|&v| (v as usize) < most) && t[0] != t[1] && t[1] != t[2] && t[2] != t[0]
        };
        let sound = n >= 3
            && end >= n
            && patch + n + 2 == 2 * (end + bridged.len())
            && loops.windows(2).all(|pair| pair[0].checked_add(3).is_some_and(|least| least <= pair[1]))
            && bridged.iter().all(|b| (0.0..=1.0).contains(&b.pull))
            && (bridged.is_empty() || creases.is_empty())
            && positions.len() == end + outer.len()
            && loop_.iter().chain(&outer).all(known)
            && patch <= triangles.len()
            && quads <= patch / 2
            && triangles[..2 * quads].chunks_exact(2).all(|t| t[0][0] == t[1][0] && t[0][2] == t[1][1])
            && triangles.iter().all(|t| within(t, positions.len()))
            && triangles[..patch].iter().all(|t| within(t, end))
            && creases.iter().flatten().all(|&v| (v as usize) < end)
            && vertices.checked_add(end).is_some_and(|most| u32::try_from(most).is_ok());
        if !sound {
            return Err(Error::InvalidOption {
                name: "parts",
                value: "of different fills".into(),
                allowed: "the parts of one fill",
            });
        }
        let mut given = loop_.clone();
        let turned = [reversed].into_iter().chain(bridged.iter().map(|b| b.reversed));
        for (pair, _) in loops.windows(2).zip(turned).filter(|(_, turned)| *turned) {
            given[pair[0]..pair[1]].reverse();
        }
        let mut work = Patchwork::of(n, end, outer, triangles, patch)?;
        work.later = bridged.iter().map(|b| b.first).collect();
        let work = work.of_quads(quads);
        let shape = Shape { work, loop_, reversed, bridged, flat, smooth, vertices, positions, creases };
        Ok(Fill::of(given, shape, report))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::fill_hole;
    use crate::fill::options::FillOptions;
    use crate::options::CellShape;
    use crate::progress::Progress;

    fn filled(cells: CellShape) -> (Vec<DVec3>, Fill) {
        // The wall of a drum, its upper rim open.
        let n = 20;
        let place = |k: u32, z: f64| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n);
            DVec3::new(angle.cos(), angle.sin(), z)
        };
        let vertices = (0..2 * n).map(|v| place(v % n, f64::from(v / n) * 0.3)).collect::<Vec<_>>();
        let wall = (0..n).flat_map(|k| {
            let next = (k + 1) % n;
            [[k, next, k + n], [next, next + n, k + n]]
        });
        let rim = (n..2 * n).collect::<Vec<_>>();
        let options = FillOptions { cells, ..FillOptions::default() };
        let fill = fill_hole(&vertices, &wall.collect::<Vec<_>>(), &rim, &options, Progress::NONE).unwrap();
        (vertices, fill)
    }

    #[test]
    fn a_fill_put_together_again_is_the_same() {
        for cells in [CellShape::Triangle, CellShape::Quad] {
            put_together_again(cells);
        }
    }

    fn put_together_again(cells: CellShape) {
        let (mut vertices, fill) = filled(cells);
        let again = Fill::from_parts(fill.parts(), fill.report.clone()).unwrap();
        assert_eq!((&again, again.parts()), (&fill, fill.parts()));
        vertices[3].z -= 0.2;
        assert_eq!(
            again.refit(&vertices, Progress::NONE).unwrap(),
            fill.refit(&vertices, Progress::NONE).unwrap()
        );
        let values = (0..20).map(|k| f64::from(k % 3)).collect::<Vec<_>>();
        assert_eq!(
            again.extend(&values, 1, Progress::NONE).unwrap(),
            fill.extend(&values, 1, Progress::NONE).unwrap()
        );
    }

    #[test]
    fn parts_that_do_not_fit_are_refused() {
        let parts = filled(CellShape::Quad).1.parts();
        let damages: [fn(&mut FillParts); 10] = [
            |p| p.quads = 10_000,
            |p| p.triangles[1] = p.triangles[0],
            |p| p.loop_[0] = 99,
            |p| p.outer.push(1),
            |p| p.triangles[0][0] = 10_000,
            |p| p.triangles[0][0] = p.triangles[0][1],
            |p| p.patch = 10_000,
            |p| p.flat.truncate(4),
            |p| p.positions.truncate(4),
            |p| p.creases.push([0, 10_000]),
        ];
        for damage in damages {
            let mut broken = parts.clone();
            damage(&mut broken);
            assert_eq!(Fill::from_parts(broken, FillReport::default()).unwrap_err().kind(), "invalid_option");
        }
    }
}
