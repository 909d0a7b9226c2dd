//! From a lattice outline to a patch: vertices on the drawn curve, the interior relaxed, checked.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::error::Result;
use crate::lattice::assemble::assemble_asking;
use crate::lattice::axial::Axial;
use crate::lattice::squares::assemble_squares;
use crate::options::{CellShape, SketchOptions};
use crate::patch::angles::min_angle;
use crate::patch::judge::{Judge, Judgement, corners_of};
use crate::patch::placed::Placed;
use crate::patch::pockets::Fans;
use crate::patch::tips::BLUNT;
use crate::path::mapping::{Corner, Snapping, snap, straddle};
use crate::path::outline::{Obstacle, Outline};
use crate::path::placement::Lattice;
use crate::progress::Progress;
use crate::relax::{Band, Contour, RelaxOptions, Relaxation, Rim, Stars, settle_corners};

/// A boundary vertex moves so far along the drawing to sit on a corner, in edges.
const NEAR: Snapping = Snapping { reach: 1.5, room: 0.3 };

/// Corners that get none so take one that is farther away or nearer to its neighbours on a rim of quads, whose vertices are
/// far apart where the path cuts corners off and bunch in inlets. They are spaced evenly before anything else.
const FAR: Snapping = Snapping { reach: 4.0, room: 0.15 };

/// A corner that turns so far into the patch, 140 degrees, is the end of a crack: two quads that share what is left have nearly
/// straight corners. Where there is no patch so, two vertices stand around it, so many edges away. Of 60 discs with
/// cracks of a hundredth to a ten-thousandth of their size 30 had none with one vertex there, 9 and 2 with two at these distances.
const CRACK: f64 = -140.0 * std::f64::consts::PI / 180.0;
const BESIDE_CRACK: [f64; 2] = [0.5, 1.0];

/// Triangles may be bent down to this angle for the drawing's sake.
const LEAST_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// Rings of quads behind the rim that may move: their path strays farther from the drawing than that of triangles.
pub(super) const QUAD_RINGS: usize = 6;

/// Rounds of relaxing, each holding vertices where the drawing strayed in the one before.
const ROUNDS: usize = 4;

/// Puts the boundary on the contours, snaps corners, relaxes the interior and proves that no
/// triangle is inverted and no quad concave, also after rounding to `f32` at the lattice origin, and that the drawing
/// lies within two edges of the boundary.
///
/// `laid` gives the positions of lattice points in units of `lattice`, from which they are moved.
/// Where the drawing does not, as at a tip that the lattice path cuts off, a boundary vertex is held at the
/// farthest point and the patch relaxed again.
pub(crate) fn place(
    contours: &[ClosedCurve],
    lattice: &Lattice,
    laid: impl Fn(&[Axial]) -> Vec<DVec2>,
    outline: &Outline,
    options: &SketchOptions,
    progress: Progress<'_>,
) -> Result<Result<Placed, Obstacle>> {
    let snapped =
        |far: bool, crack: Option<f64>| Snapped::new(contours, lattice, outline, options, (far, crack));
    match options.cells {
        CellShape::Triangle => {
            let region = assemble_asking(&outline.paths, || progress.report(0.0))?;
            let positions = laid(&region.points);
            let faces = |triangles: &[[u32; 3]]| (triangles.to_vec(), Vec::new());
            let sheet = Sheet { cells: &region.triangles, positions, faces };
            let blunt = (options.bend > 0.0).then_some(BLUNT);
            let placed = sheet.place(contours, lattice, snapped(false, None), (options, blunt), progress)?;
            match &placed {
                Ok(placed) if placed.fault(options).is_none() => {}
                _ if blunt.is_none() => {}
                // A tip of a few degrees has room for its own point alone.
                _ => return sheet.place(contours, lattice, snapped(false, None), (options, None), progress),
            }
            Ok(placed)
        }
        CellShape::Quad => {
            let region = assemble_squares(&outline.paths);
            // The rim itself is put on the drawing before anything else moves.
            let mut positions = Vec::with_capacity(region.n_rim + region.points.len());
            for (contour, arcs) in contours.iter().zip(&outline.arcs) {
                let at = |s: &f64| lattice.to_units(contour.point_at(s * lattice.edge_length));
                positions.extend(arcs.iter().map(at));
            }
            positions.extend(laid(&region.points));
            let faces = |quads: &[[u32; 4]]| (Vec::new(), quads.to_vec());
            let sheet = Sheet { cells: &region.quads, positions, faces };
            let [nearer, farther] = BESIDE_CRACK;
            let corners = snapped(true, None);
            let (from_afar, cracked) = (corners.from_afar, corners.cracked);
            let mut placed = sheet.place(contours, lattice, corners, (options, None), progress)?;
            // Where there is no room for corners, or a crack ends.
            let others = [(cracked, Some(nearer)), (cracked, Some(farther)), (from_afar, None)];
            for (_, beside_crack) in others.into_iter().filter(|(differs, _)| *differs) {
                if placed.as_ref().is_ok_and(|placed| placed.fault(options).is_none()) {
                    break;
                }
                let corners = snapped(beside_crack.is_some(), beside_crack);
                let other = sheet.place(contours, lattice, corners, (options, None), progress)?;
                // A valid patch with faults is better than none.
                if other.is_ok() || placed.is_err() {
                    placed = other;
                }
            }
            Ok(placed)
        }
    }
}

/// Cells of a lattice, to be placed.
struct Sheet<'a, const N: usize, F> {
    cells: &'a [[u32; N]],
    /// In units of the lattice.
    positions: Vec<DVec2>,
    /// The cells as triangles and quads.
    faces: F,
}

impl<const N: usize, F: Fn(&[[u32; N]]) -> (Vec<[u32; 3]>, Vec<[u32; 4]>)> Sheet<'_, N, F>
where
    Band<N>: Stars,
{
    /// See [`place`]; corners whose triangles are sharper than `blunt` are let go.
    fn place(
        &self,
        contours: &[ClosedCurve],
        lattice: &Lattice,
        snapped: Snapped,
        (options, blunt): (&SketchOptions, Option<f64>),
        progress: Progress<'_>,
    ) -> Result<Result<Placed, Obstacle>> {
        let drawn = in_units(contours, lattice);
        let lines: Vec<Contour<'_>> = drawn.iter().map(|(points, arc)| Contour { points, arc }).collect();
        let Snapped { corners: found, mut rims, mut angles, .. } = snapped;
        let corners = Band::<N>::corners(self.cells);
        if options.relax && N == 3 {
            settle_corners(&corners, &lines, &mut rims, &mut angles);
        }
        let rings = if N == 4 { QUAD_RINGS } else { RelaxOptions::default().rings };
        let relaxed = RelaxOptions { rings, blunt, ..RelaxOptions::default() };
        let mut relaxation = Relaxation::<N>::new(self.cells, &self.positions, &lines, &rims, &relaxed)?;
        let mut fans = Fans::new(self.positions.len(), &corners);
        let is_blunt = blunt.is_some();
        let judge =
            Judge { contours, lattice, lines: &lines, found: &found, corners: &corners, options, is_blunt };
        // A valid patch that bridges an inlet serves if following the inlet leads to none.
        let mut valid: Option<Box<Placed>> = None;
        let mut obstacle = Obstacle::new("a part of the drawing is lost", contours[0].points()[0]);
        let mut held: Vec<(usize, f64)> = Vec::new();
        for round in 0..ROUNDS {
            let progress = progress.part(round as f64 / ROUNDS as f64, (round + 1) as f64 / ROUNDS as f64);
            if options.relax {
                if round == 0 {
                    relaxation.run(progress)?;
                } else {
                    relaxation.hold(&held, progress)?;
                }
                relaxation.store(&mut rims);
            }
            let vertices = relaxation.positions.iter().map(|&p| lattice.from_units(p)).collect();
            held = match judge.judged(vertices, &rims, &mut fans, progress)? {
                Judgement::Inverted(found) => {
                    obstacle = found;
                    break;
                }
                Judgement::Far(strays) => {
                    obstacle.at = strays.first().map_or(obstacle.at, |stray| stray.point);
                    judge.to_hold(strays, None, &rims)
                }
                Judgement::Valid(mut placed, strays, lost) => {
                    (placed.patch.triangles, placed.patch.quads) = (self.faces)(self.cells);
                    let first = valid.is_none();
                    if valid.as_ref().is_none_or(|best| better(&placed, best)) {
                        valid = Some(placed);
                    }
                    // Following the drawing more closely is worth one more round.
                    if !first && valid.as_ref().is_some_and(|best| best.lost() == 0) {
                        break;
                    }
                    judge.to_hold(strays, Some(lost), &rims)
                }
            };
            if held.is_empty() || !options.relax {
                break;
            }
        }
        Ok(valid.map(|placed| *placed).ok_or(obstacle))
    }
}

/// Whether a patch that follows the drawing more closely is worth the triangles that this bends.
fn better(placed: &Placed, best: &Placed) -> bool {
    let (least, before) = (min_angle(&placed.patch), min_angle(&best.patch));
    placed.lost() < best.lost()
        || (placed.lost() == best.lost()
            && placed.max_deviation < best.max_deviation
            && least >= before.min(LEAST_ANGLE))
}

/// The points of contours and their arc lengths, in units of a lattice.
pub(super) fn in_units(contours: &[ClosedCurve], lattice: &Lattice) -> Vec<(Vec<DVec2>, Vec<f64>)> {
    let of = |contour: &ClosedCurve| {
        let points = contour.points().iter().map(|&p| lattice.to_units(p)).collect();
        (points, contour.arc().iter().map(|&s| s / lattice.edge_length).collect())
    };
    contours.iter().map(of).collect()
}

/// Boundary vertices, some of them pinned to corners.
struct Snapped {
    /// The corners of each contour, the sharpest first.
    corners: Vec<Vec<Corner>>,
    /// With arc lengths in edges.
    rims: Vec<Rim>,
    /// The angle of the corner at each vertex, zero for those that are free.
    angles: Vec<Vec<f64>>,
    /// Whether a corner has one that was not [`NEAR`].
    from_afar: bool,
    /// Whether the drawing has cracks.
    cracked: bool,
    /// How many corners have none.
    left: usize,
}

impl Snapped {
    /// Corners take vertices from afar as well where `far` and those are spaced evenly then; ends of cracks get two that stand
    /// `beside_crack` away.
    fn new(
        contours: &[ClosedCurve],
        lattice: &Lattice,
        outline: &Outline,
        options: &SketchOptions,
        (far, beside_crack): (bool, Option<f64>),
    ) -> Self {
        let h = lattice.edge_length;
        let corners = contours.iter().map(|contour| corners_of(contour, options.corner_angle, h)).collect();
        let (far, beside_crack) = (far && options.relax, beside_crack.filter(|_| options.relax));
        let mut all = Snapped {
            corners,
            rims: Vec::new(),
            angles: Vec::new(),
            from_afar: false,
            cracked: false,
            left: 0,
        };
        let mut start = 0;
        for ((contour, arcs), corners) in contours.iter().zip(&outline.arcs).zip(&mut all.corners) {
            let (mut s, length, n) = (arcs.clone(), contour.length() / h, arcs.len());
            let (mut angle, mut held) = (vec![0.0; n], vec![false; n]);
            all.cracked |= options.relax && corners.iter().any(|corner| corner.angle < CRACK);
            if let Some(back) = beside_crack {
                corners.retain(|corner| {
                    let is_crack = corner.angle < CRACK;
                    let ends =
                        is_crack.then(|| straddle(&mut s, corner.arc, length, back, FAR.room)).flatten();
                    ends.into_iter().flatten().for_each(|v| held[v] = true);
                    ends.is_none()
                });
            }
            let mut left = snap(&mut s, &mut angle, corners, length, NEAR);
            if far && !left.is_empty() {
                let before = left.len();
                left = snap(&mut s, &mut angle, &left, length, FAR);
                all.from_afar |= left.len() < before;
            }
            let pinned = angle.iter().zip(&held).map(|(&a, &held)| a != 0.0 || held).collect();
            all.rims.push(Rim { start, s, pinned, held });
            all.angles.push(angle);
            all.left += left.len();
            start += n;
        }
        all
    }
}

/// True if some corner of the drawing finds no vertex of the boundary to sit on it.
pub(crate) fn loses_corners(
    contours: &[ClosedCurve],
    lattice: &Lattice,
    outline: &Outline,
    options: &SketchOptions,
) -> bool {
    let far = options.cells == CellShape::Quad;
    Snapped::new(contours, lattice, outline, options, (far, None)).left > 0
}

/// Arc length of the drawn point nearest to arc length `s`, along the curve.
pub(crate) fn nearest_drawn(contour: &ClosedCurve, s: f64) -> f64 {
    let (segment, t) = contour.locate(s);
    contour.arc()[if t < 0.5 { segment } else { segment + 1 }]
}
