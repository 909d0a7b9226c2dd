//! Symmetric placement: partners at each other's images, on each side's own line.

use glam::DVec2;
use rustc_hash::FxHashMap;

use crate::drawing::curve::ClosedCurve;
use crate::drawing::symmetry::{Pairing, Symmetry};
use crate::error::Result;
use crate::lattice::assemble::assemble;
use crate::lattice::axial::Axial;
use crate::lattice::grid::{Grid, Square, Triangular};
use crate::lattice::reflection::Reflection;
use crate::lattice::squares::assemble_squares;
use crate::options::{CellShape, SketchOptions};
use crate::patch::angles::min_angle;
use crate::patch::deviation::{beside, crossings, deviation};
use crate::patch::judge::{INLET, STRAY};
use crate::patch::mirror::sides::{arc_at, contours_of, reflection};
use crate::patch::place::nearest_drawn;
use crate::patch::placed::Placed;
use crate::patch::pockets::{Fans, pockets};
use crate::patch::{Loop, Patch};
use crate::path::outline::{Obstacle, Outline};
use crate::path::placement::Lattice;
use crate::relax::first_inverted;

/// A corner of the drawing this near to where a vertex's image belongs gets it, in edges.
const CORNER_REACH: f64 = 0.5;

/// Makes a placement symmetric: partners take the mean of their two places, or both that of the one
/// side, whatever leaves the best triangles; on each side's own line.
///
/// Proves again what placing proves. If the sides differ and no symmetric placement is valid, the
/// one given is kept. The second number is the greatest distance of a vertex from the image of its
/// partner, in edges.
pub(crate) fn symmetrised(
    contours: &[ClosedCurve],
    symmetry: &Symmetry,
    partners: &Partners,
    placed: Placed,
    options: &SketchOptions,
) -> Result<(Placed, f64), Obstacle> {
    let lattice = placed.patch.lattice;
    let at = contours[0].points()[0];
    let Partners { partner, side } = partners;
    let both = Both { contours, symmetry, side, partner, placed: &placed };
    let mut best: Option<(usize, f64, Placed)> = None;
    for side in [Side::Mean, Side::Left, Side::Right] {
        let Some(found) = both.placed_by(side, options) else { continue };
        // The mean, unless it bends triangles that a single side leaves in shape.
        let angle = min_angle(&found.patch) * if side == Side::Mean { 1.1 } else { 1.0 };
        let lost = found.lost();
        let is_better =
            |&(fewest, least, _): &(usize, f64, Placed)| lost < fewest || lost == fewest && angle > least;
        if best.as_ref().is_none_or(is_better) {
            best = Some((lost, angle, found));
        }
    }
    let exact = is_exact(symmetry, lattice.edge_length);
    let placed = match best {
        Some((.., placed)) => placed,
        None if exact => {
            let is_inverted = !options.relax;
            return Err(Obstacle { is_inverted, ..Obstacle::new("a triangle stays inverted", at) });
        }
        None => placed.clone(),
    };
    let error = (0..side.len())
        .map(|v| {
            let image = placed.patch.vertices[both.partner[v]];
            symmetry.axis.reflected(placed.patch.vertices[v]).distance(image)
        })
        .fold(0.0, f64::max);
    Ok((placed, error / lattice.edge_length))
}

/// True if the sides of a drawing differ by rounding only.
fn is_exact(symmetry: &Symmetry, edge_length: f64) -> bool {
    symmetry.difference <= 1e-9 * edge_length
}

/// Which vertices of a patch are each other's mirror images.
pub(crate) struct Partners {
    /// The vertex at the mirror image of each vertex.
    pub(crate) partner: Vec<usize>,
    /// On which side of the axis each lies: above 0 on the left.
    pub(crate) side: Vec<i32>,
}

impl Partners {
    /// Of the patch of a symmetric outline on a lattice.
    pub(crate) fn of(
        contours: &[ClosedCurve],
        symmetry: &Symmetry,
        outline: &Outline,
        lattice: &Lattice,
        cells: CellShape,
    ) -> Result<Self, Obstacle> {
        let axis = reflection(symmetry, lattice);
        let found = match cells {
            CellShape::Triangle => Self::new::<Triangular>(&assemble(&outline.paths).points, 0, axis),
            CellShape::Quad => {
                let belted = assemble_squares(&outline.paths);
                Self::new::<Square>(&belted.points, belted.n_rim, axis)
            }
        };
        found.ok_or_else(|| Obstacle::new("the boundary is not symmetric", contours[0].points()[0]))
    }

    /// Of vertices at lattice points, before which there is one in a belt for each of the first `n_rim`; none if one has no
    /// image.
    fn new<G: Grid>(points: &[Axial], n_rim: usize, axis: Reflection) -> Option<Self> {
        let number: FxHashMap<Axial, usize> = points.iter().enumerate().map(|(v, &p)| (p, v)).collect();
        let images: Vec<usize> =
            points.iter().map(|&p| number.get(&G::image(axis, p)).copied()).collect::<Option<_>>()?;
        if images[..n_rim].iter().any(|&image| image >= n_rim) {
            return None;
        }
        let partner = images[..n_rim].iter().copied().chain(images.iter().map(|image| n_rim + image));
        let side = points[..n_rim].iter().chain(points).map(|&p| G::side(axis, p));
        Some(Self { partner: partner.collect(), side: side.collect() })
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Mean,
    Left,
    Right,
}

struct Both<'a> {
    contours: &'a [ClosedCurve],
    symmetry: &'a Symmetry,
    side: &'a [i32],
    partner: &'a [usize],
    placed: &'a Placed,
}

impl Both<'_> {
    /// The placement with both sides as one of them is; none if it is not valid.
    fn placed_by(&self, side: Side, options: &SketchOptions) -> Option<Placed> {
        let patch = &self.placed.patch;
        let mut vertices = self.interior(side);
        let mut loops = patch.loops.clone();
        let mut arcs: Vec<Vec<f64>> = vec![Vec::new(); loops.len()];
        for pairing in &self.symmetry.pairings {
            for (of, contour) in contours_of(pairing).into_iter().enumerate() {
                arcs[contour] = self.rim(pairing, of, side, &mut loops[contour], &mut vertices)?;
            }
        }
        if first_inverted(&vertices, &patch.corners(), patch.lattice.origin).is_some() {
            return None;
        }
        let h = patch.lattice.edge_length;
        let beside = beside(self.contours, &vertices, &arcs);
        let (farthest, _) = deviation(&beside, &vertices, &arcs, STRAY * h, STRAY * h);
        if farthest > STRAY * h {
            return None;
        }
        let found =
            pockets(&beside, &vertices, &mut Fans::new(vertices.len(), &patch.corners()), &arcs, INLET * h);
        let crossed = match options.relax {
            true => crossings(&beside, &vertices, &arcs, patch.lattice.origin).0,
            false => 0,
        };
        let kept = loops.iter().flat_map(|l| &l.corner).filter(|&&angle| angle != 0.0).count();
        let triangles = patch.triangles.clone();
        Some(Placed {
            patch: Patch {
                vertices,
                triangles,
                quads: patch.quads.clone(),
                loops,
                inlets: found.inlets,
                lattice: patch.lattice,
                belt: None,
            },
            released_corners: self.placed.corners.saturating_sub(kept),
            max_deviation: farthest / h,
            strayed: self.placed.strayed.min(farthest / h),
            bridged_inlets: found.occupied.len(),
            crossings: crossed,
            ..self.placed.clone()
        })
    }

    /// All vertices placed symmetrically; those of the rims are still to go onto their lines.
    fn interior(&self, side: Side) -> Vec<DVec2> {
        let axis = self.symmetry.axis;
        let at = &self.placed.patch.vertices;
        (0..at.len())
            .map(|v| {
                let partner = self.partner[v];
                let is_left = self.side[v] > 0;
                match side {
                    _ if partner == v => axis.foot(at[v]),
                    Side::Mean if is_left => 0.5 * (at[v] + axis.reflected(at[partner])),
                    Side::Mean => axis.reflected(0.5 * (at[partner] + axis.reflected(at[v]))),
                    Side::Left if !is_left => axis.reflected(at[partner]),
                    Side::Right if is_left => axis.reflected(at[partner]),
                    _ => at[v],
                }
            })
            .collect()
    }

    /// Puts a contour's vertices where they belong; their arc lengths, unwrapped. None if they are not
    /// in order.
    fn rim(
        &self,
        pairing: &Pairing,
        of: usize,
        side: Side,
        placed: &mut Loop,
        vertices: &mut [DVec2],
    ) -> Option<Vec<f64>> {
        let contour_number = contours_of(pairing)[of];
        let contour = &self.contours[contour_number];
        let old = &self.placed.patch.loops;
        let mut arcs: Vec<f64> = Vec::with_capacity(placed.len());
        for v in placed.vertices().map(|v| v as usize) {
            let w = self.partner[v];
            let partner_loop = old.iter().find(|l| l.vertices().contains(&(w as u32)))?;
            let i = v - placed.start as usize;
            let is_left = self.side[v] > 0;
            let own = self.left_turns(pairing, of, v);
            let other =
                self.left_turns(pairing, if contours_of(pairing).len() == 2 { 1 - of } else { of }, w);
            // A corner on the axis belongs to a vertex on the axis or to none.
            let corner = [
                (own, old[contour_number].corner[i]),
                (other, partner_loop.corner[w - partner_loop.start as usize]),
            ]
            .map(|(turns, angle)| if v != w && self.is_crossing(pairing, turns) { 0.0 } else { angle });
            // Which vertex, this one or its partner, says where both are.
            let (turns, from) = match side {
                _ if v != w && self.is_crossing(pairing, own) => (other, 1),
                _ if v != w && self.is_crossing(pairing, other) => (own, 0),
                Side::Left if is_left => (own, 0),
                Side::Right if !is_left => (own, 0),
                Side::Left | Side::Right => (other, 1),
                Side::Mean if corner[0] != 0.0 && (is_left || corner[1] == 0.0) => (own, 0),
                Side::Mean if corner[1] != 0.0 => (other, 1),
                Side::Mean => (own + 0.5 * nearest_lap(other - own), 2),
            };
            let (s, angle) = if v == w {
                self.on_axis(pairing, contour, own, (self.placed.arcs[contour_number][i], corner[0]))?
            } else if from == 0 {
                (self.placed.arcs[contour_number][i], corner[0])
            } else {
                let right = matches!(pairing, Pairing::Own { .. }) && !is_left
                    || matches!(pairing, Pairing::Two { .. }) && of == 1;
                let s = arc_at(self.contours, pairing, of, if right { 1.0 - turns } else { turns });
                self.at_corner(contour, contour.wrap(s), if from == 1 { corner[1] } else { 0.0 }, corner[0])
            };
            let s = if angle == 0.0 { s } else { nearest_drawn(contour, s) };
            vertices[v] = contour.point_at(s);
            placed.arc[i] = contour.input_arc(s);
            placed.source[i] = contour.source(s);
            placed.corner[i] = angle;
            let unwrapped = match arcs.last() {
                Some(last) => last + contour.wrap(s - last),
                None => s,
            };
            arcs.push(unwrapped);
        }
        let steps = arcs.windows(2).all(|s| s[0] < s[1]);
        (steps && arcs.last()? < &(arcs[0] + contour.length())).then_some(arcs)
    }

    /// Where a vertex is, in turns along the target of the side on the left: partners agree.
    fn left_turns(&self, pairing: &Pairing, of: usize, v: usize) -> f64 {
        let loops = &self.placed.patch.loops;
        let s = |contour: usize| self.placed.arcs[contour][v - loops[contour].start as usize];
        match pairing {
            Pairing::Own { contour, start, left, right, matching } => {
                let length = self.contours[*contour].length();
                let along = self.contours[*contour].wrap(s(*contour) - start);
                let turns = if along <= *left {
                    0.5 * matching.parameter(0, along / left)
                } else {
                    1.0 - 0.5 * matching.parameter(1, (length - along) / right)
                };
                if self.side[v] >= 0 { turns } else { 1.0 - turns }
            }
            Pairing::Two { contours: [a, b], start, matching } => {
                if of == 0 {
                    matching.parameter(0, s(*a) / self.contours[*a].length())
                } else {
                    let back = self.contours[*b].wrap(start - s(*b)) / self.contours[*b].length();
                    matching.parameter(1, back)
                }
            }
        }
    }

    /// The crossing of the axis that a vertex on it belongs to, or the drawn corner near it that it is
    /// on; and the angle of the corner.
    fn on_axis(
        &self,
        pairing: &Pairing,
        contour: &ClosedCurve,
        turns: f64,
        (old, angle): (f64, f64),
    ) -> Option<(f64, f64)> {
        let Pairing::Own { start, left, .. } = pairing else { return None };
        let is_end = (turns - 0.5).abs() < 0.25;
        let s = contour.wrap(if is_end { start + left } else { *start });
        let gap = nearest_lap((old - s) / contour.length()).abs() * contour.length();
        // Of an exactly symmetric drawing only a corner on the axis leaves the mesh symmetric.
        let h = self.placed.patch.lattice.edge_length;
        let reach = if is_exact(self.symmetry, h) { 1e-9 } else { CORNER_REACH };
        let on_corner = angle != 0.0 && gap <= reach * h;
        Some(if on_corner { (old, angle) } else { (s, 0.0) })
    }

    /// True where the target meets the axis.
    fn is_crossing(&self, pairing: &Pairing, turns: f64) -> bool {
        const NEAR: f64 = 0.05;
        let Pairing::Own { contour, .. } = pairing else { return false };
        let gap = nearest_lap(2.0 * turns).abs() * 0.5 * self.contours[*contour].length();
        gap < NEAR * self.placed.patch.lattice.edge_length
    }

    /// The drawn corner beside an arc length, if the partner is on one; else the arc length itself.
    fn at_corner(&self, contour: &ClosedCurve, s: f64, partner: f64, own: f64) -> (f64, f64) {
        if partner == 0.0 {
            return (s, 0.0);
        }
        let drawn = nearest_drawn(contour, s);
        let gap = nearest_lap((drawn - s) / contour.length()).abs() * contour.length();
        if gap > CORNER_REACH * self.placed.patch.lattice.edge_length {
            return (s, 0.0);
        }
        (drawn, if own != 0.0 { own } else { partner })
    }
}

/// A number of turns without whole ones, -1/2 to 1/2.
fn nearest_lap(turns: f64) -> f64 {
    turns - turns.round()
}
