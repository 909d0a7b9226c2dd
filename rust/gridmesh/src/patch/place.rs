//! From a lattice outline to a patch: vertices on the drawn curve, the interior relaxed, checked.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::error::Result;
use crate::lattice::assemble::assemble_asking;
use crate::lattice::axial::Axial;
use crate::lattice::squares::assemble_squares;
use crate::options::{CellShape, SketchOptions};
use crate::patch::angles::min_angle;
use crate::patch::deviation::{Stray, beside, crossings, deviation};
use crate::patch::expel::expel;
use crate::patch::pockets::{Fans, pockets};
use crate::patch::tips::{BLUNT, blunted, pinned_at, stray_off_tips, turning_at, worn};
use crate::patch::{Loop, Patch};
use crate::path::mapping::{Corner, corners, snap};
use crate::path::outline::{Obstacle, Outline};
use crate::path::placement::Lattice;
use crate::progress::Progress;
use crate::relax::{Band, Contour, RelaxOptions, Relaxation, Rim, Stars, first_inverted, settle_corners};

/// Half the length over which a corner's turning angle is measured, in edges.
pub(crate) const CORNER_WINDOW: f64 = 0.5;

/// A boundary vertex moves this far along the drawing to sit on a corner, in edges.
const REACH: f64 = 1.5;

/// The drawing may lie this far outside the mesh, in edges.
pub(crate) const STRAY: f64 = 2.0;

/// Where it lies this far outside, a boundary vertex is held there, if the triangles allow.
const CLOSE: f64 = 0.7;

/// Triangles may be bent down to this angle for the drawing's sake.
const LEAST_ANGLE: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A vertex may lie this far outside the drawing, in an inlet that the boundary bridges.
pub(crate) const INLET: f64 = 0.05;

/// Rings of quads behind the rim that may move: their path strays farther from the drawing than that of triangles.
const QUAD_RINGS: usize = 6;

/// Rounds of relaxing, each holding vertices where the drawing strayed in the one before.
const ROUNDS: usize = 4;

/// A patch and what placing it cost.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) patch: Patch,
    /// For each loop the arc length of each vertex on its contour, from the contour's own first point:
    /// unlike that from the first input point it does not depend on where the drawing starts.
    pub(crate) arcs: Vec<Vec<f64>>,
    pub(crate) corners: usize,
    pub(crate) released_corners: usize,
    /// Corners wider than tips that the boundary cuts off: a mesh without them looks worn.
    pub(crate) worn_corners: usize,
    /// Greatest distance of the drawing from the boundary, in edges.
    pub(crate) max_deviation: f64,
    /// The same elsewhere than at blunted tips.
    pub(crate) strayed: f64,
    /// Boundary edges that bridge an inlet with a mesh vertex in it.
    pub(crate) bridged_inlets: usize,
    /// Boundary edges that cross others.
    pub(crate) crossings: usize,
}

impl Placed {
    /// In how many places a part of the drawing is lost in the mesh.
    pub(crate) fn lost(&self) -> usize {
        self.bridged_inlets + self.crossings
    }

    /// Why the patch is not to be had, if it is not; without relaxation bridges and crossings are no fault.
    pub(crate) fn fault(&self, options: &SketchOptions) -> Option<&'static str> {
        match self {
            _ if !options.relax => None,
            Placed { crossings: 1.., .. } => Some("two walls of the drawing are too near to each other"),
            Placed { bridged_inlets: 1.., .. } => Some("an inlet is narrower than the grid"),
            _ => None,
        }
    }
}

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
    match options.cells {
        CellShape::Triangle => {
            let region = assemble_asking(&outline.paths, || progress.report(0.0))?;
            let positions = laid(&region.points);
            let faces = |triangles: &[[u32; 3]]| (triangles.to_vec(), Vec::new());
            let sheet = Sheet { cells: &region.triangles, positions, faces };
            let blunt = (options.bend > 0.0).then_some(BLUNT);
            let placed = sheet.place(contours, lattice, outline, (options, blunt), progress)?;
            match &placed {
                Ok(placed) if placed.fault(options).is_none() => {}
                _ if blunt.is_none() => {}
                // A tip of a few degrees has room for its own point alone.
                _ => return sheet.place(contours, lattice, outline, (options, None), progress),
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
            sheet.place(contours, lattice, outline, (options, None), progress)
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
        outline: &Outline,
        (options, blunt): (&SketchOptions, Option<f64>),
        progress: Progress<'_>,
    ) -> Result<Result<Placed, Obstacle>> {
        let h = lattice.edge_length;
        let drawn: Vec<(Vec<DVec2>, Vec<f64>)> = contours
            .iter()
            .map(|contour| {
                let points = contour.points().iter().map(|&p| lattice.to_units(p)).collect();
                (points, contour.arc().iter().map(|&s| s / h).collect())
            })
            .collect();
        let lines: Vec<Contour<'_>> = drawn.iter().map(|(points, arc)| Contour { points, arc }).collect();
        let found: Vec<Vec<Corner>> =
            contours.iter().map(|contour| corners_of(contour, options.corner_angle, h)).collect();
        let (mut rims, mut angles) = rims(contours, outline, &found, h);
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

/// What a placement is held against.
struct Judge<'a> {
    contours: &'a [ClosedCurve],
    lattice: &'a Lattice,
    /// The contours in units of the lattice.
    lines: &'a [Contour<'a>],
    /// Their corners.
    found: &'a [Vec<Corner>],
    /// Three vertices of each triangle or of each corner of a quad, to be counter-clockwise.
    corners: &'a [[u32; 3]],
    options: &'a SketchOptions,
    is_blunt: bool,
}

/// What is said of a placement.
enum Judgement {
    Inverted(Obstacle),
    /// The drawing lies too far from it, in these places.
    Far(Vec<Stray>),
    /// It has no faces yet; where the drawing lies outside, and where a part of it is lost.
    Valid(Box<Placed>, Vec<Stray>, Vec<Stray>),
}

impl Judge<'_> {
    fn judged(
        &self,
        mut vertices: Vec<DVec2>,
        rims: &[Rim],
        fans: &mut Fans,
        progress: Progress<'_>,
    ) -> Result<Judgement> {
        let Judge { contours, lattice, options, .. } = *self;
        let h = lattice.edge_length;
        let (loops, arcs, own) = loops(contours, rims, self.found, h, &mut vertices);
        if let Some(triangle) = first_inverted(&vertices, self.corners, lattice.origin) {
            let at = vertices[self.corners[triangle][0] as usize];
            let obstacle = Obstacle::new("a triangle stays inverted", at);
            return Ok(Judgement::Inverted(Obstacle { is_inverted: !options.relax, ..obstacle }));
        }
        let beside = beside(contours, &vertices, &arcs);
        let (farthest, mut strays) = deviation(&beside, &vertices, &arcs, CLOSE * h, STRAY * h);
        if farthest > STRAY * h {
            strays.retain(|stray| stray.distance > STRAY * h);
            return Ok(Judgement::Far(strays));
        }
        let mut pockets_now = pockets(&beside, &vertices, fans, &arcs, INLET * h);
        let mut lost = std::mem::take(&mut pockets_now.occupied);
        let mut bridged_inlets = lost.len();
        if !lost.is_empty() && options.relax {
            let mut expelled = vertices.clone();
            if expel(&pockets_now, &mut expelled, fans, INLET * h, h, progress)?
                && first_inverted(&expelled, self.corners, lattice.origin).is_none()
            {
                let left = pockets(&beside, &expelled, fans, &arcs, INLET * h);
                if left.occupied.len() < bridged_inlets {
                    bridged_inlets = left.occupied.len();
                    vertices = expelled;
                }
            }
        }
        let (crossed, crossing) = match options.relax {
            true => crossings(&beside, &vertices, &arcs, lattice.origin),
            false => (0, Vec::new()),
        };
        lost.extend(crossing);
        let n_corners = self.found.iter().map(Vec::len).sum();
        let kept = loops.iter().flat_map(|l| &l.corner).filter(|&&angle| angle != 0.0).count();
        let near = farthest.min(CLOSE * h);
        let strayed = if self.is_blunt { stray_off_tips(&strays, self.lines, h, near) } else { farthest };
        let (triangles, quads) = (Vec::new(), Vec::new());
        let inlets = pockets_now.inlets;
        let placed = Placed {
            patch: Patch { vertices, triangles, quads, loops, inlets, lattice: *lattice },
            arcs: own,
            corners: n_corners,
            released_corners: n_corners - kept,
            worn_corners: worn(contours, &beside, self.found, h),
            max_deviation: farthest / h,
            strayed: strayed / h,
            bridged_inlets,
            crossings: crossed,
        };
        Ok(Judgement::Valid(Box::new(placed), strays, lost))
    }

    /// Which boundary vertices are to be held where, so that less of the drawing lies outside; or is lost, in a
    /// placement that is valid.
    fn to_hold(&self, mut strays: Vec<Stray>, lost: Option<Vec<Stray>>, rims: &[Rim]) -> Vec<(usize, f64)> {
        let h = self.lattice.edge_length;
        let mut held = if self.is_blunt { blunted(&mut strays, rims, self.lines, h) } else { Vec::new() };
        if let Some(lost) = lost {
            strays.extend(lost);
            strays.sort_by_key(|stray| (stray.contour, stray.edge));
            strays.dedup_by_key(|stray| (stray.contour, stray.edge));
            strays.retain(|stray| !is_chosen(&held, &rims[stray.contour], stray.edge));
        }
        let lengths: Vec<f64> = self.contours.iter().map(|contour| contour.length() / h).collect();
        held.extend(to_hold(&strays, rims, &lengths, h));
        held
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

/// Boundary vertices with their arc lengths in edges, some of them pinned to corners; the angle of
/// the corner at each.
fn rims(
    contours: &[ClosedCurve],
    outline: &Outline,
    corners: &[Vec<Corner>],
    h: f64,
) -> (Vec<Rim>, Vec<Vec<f64>>) {
    let (mut rims, mut angles, mut start) = (Vec::new(), Vec::new(), 0);
    for ((contour, arcs), corners) in contours.iter().zip(&outline.arcs).zip(corners) {
        let mut s = arcs.clone();
        let angle = snap(&mut s, corners, contour.length() / h, REACH);
        let n = s.len();
        rims.push(Rim { start, s, pinned: angle.iter().map(|&a| a != 0.0).collect(), held: vec![false; n] });
        angles.push(angle);
        start += n;
    }
    (rims, angles)
}

/// Puts the boundary vertices exactly on their contours; the patch's loops, and the arc lengths in
/// the units of the drawing, unwrapped, and as they are placed.
fn loops(
    contours: &[ClosedCurve],
    rims: &[Rim],
    corners: &[Vec<Corner>],
    h: f64,
    vertices: &mut [DVec2],
) -> (Vec<Loop>, Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let mut loops = Vec::new();
    let mut arcs = Vec::new();
    let mut own = Vec::new();
    for ((contour, rim), corners) in contours.iter().zip(rims).zip(corners) {
        let mut placed = Loop { start: rim.start as u32, length: contour.length(), ..Loop::default() };
        let mut at = Vec::with_capacity(rim.s.len());
        for (i, &s) in rim.s.iter().enumerate() {
            let s = if rim.pinned[i] { pinned_at(contour, s * h, h) } else { contour.wrap(s * h) };
            at.push(contour.wrap(s));
            vertices[rim.start + i] = contour.point_at(s);
            placed.arc.push(contour.input_arc(s));
            placed.source.push(contour.source(s));
            placed.corner.push(if rim.pinned[i] { turning_at(contour, corners, s, h) } else { 0.0 });
        }
        loops.push(placed);
        arcs.push(rim.s.iter().map(|s| s * h).collect());
        own.push(at);
    }
    (loops, arcs, own)
}

/// The nearer end of each strayed edge and the arc position of the farthest point, in edges, where it
/// is to be held; ends that hold a corner of the drawing only if no other is free.
fn to_hold(strays: &[Stray], rims: &[Rim], lengths: &[f64], h: f64) -> Vec<(usize, f64)> {
    let mut chosen: Vec<(usize, f64)> = Vec::new();
    for stray in strays {
        let rim = &rims[stray.contour];
        let n = rim.s.len();
        let to = stray.arc / h;
        let after = (stray.edge + 1) % n;
        // The last edge ends at the first vertex, a lap on.
        let lap = if after == 0 { lengths[stray.contour] } else { 0.0 };
        let mut ends = [(stray.edge, 0.0), (after, lap)];
        ends.sort_by(|a, b| {
            let key = |&(i, lap): &(usize, f64)| (rim.pinned[i], (rim.s[i] + lap - to).abs());
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let is_free = |end: usize| !rim.held[end] && chosen.iter().all(|&(v, _)| v != rim.start + end);
        let Some(&(end, lap)) = ends.iter().find(|(end, _)| is_free(*end)) else { continue };
        chosen.push((rim.start + end, to - lap));
    }
    chosen
}

/// Whether an end of an edge is to be held.
fn is_chosen(held: &[(usize, f64)], rim: &Rim, edge: usize) -> bool {
    let ends = [edge, (edge + 1) % rim.s.len()];
    held.iter().any(|&(v, _)| ends.iter().any(|end| rim.start + end == v))
}

/// The corners of a contour, with arc lengths in edges.
fn corners_of(contour: &ClosedCurve, angle: f64, h: f64) -> Vec<Corner> {
    let arcs: Vec<f64> = contour.arc().iter().map(|&s| s / h).collect();
    let turning = contour.turning(CORNER_WINDOW * h);
    corners(&arcs[..turning.len()], &turning, contour.length() / h, angle, 1.0)
}

/// Arc length of the drawn point nearest to arc length `s`, along the curve.
pub(crate) fn nearest_drawn(contour: &ClosedCurve, s: f64) -> f64 {
    let (segment, t) = contour.locate(s);
    contour.arc()[if t < 0.5 { segment } else { segment + 1 }]
}
