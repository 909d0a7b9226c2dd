//! What a placement is held against: the exact checks, the drawing, the deviation from it.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::error::Result;
use crate::options::SketchOptions;
use crate::patch::deviation::{Stray, beside, crossings, deviation};
use crate::patch::expel::expel;
use crate::patch::placed::Placed;
use crate::patch::pockets::{Fans, pockets};
use crate::patch::tips::{blunted, pinned_at, stray_off_tips, turning_at, worn};
use crate::patch::{Loop, Patch};
use crate::path::mapping::{Corner, corners};
use crate::path::outline::Obstacle;
use crate::path::placement::Lattice;
use crate::progress::Progress;
use crate::relax::{Contour, Rim, first_inverted};

/// Half the length over which a corner's turning angle is measured, in edges.
pub(crate) const CORNER_WINDOW: f64 = 0.5;

/// The drawing may lie this far outside the mesh, in edges.
pub(crate) const STRAY: f64 = 2.0;

/// A vertex may lie this far outside the drawing, in an inlet that the boundary bridges.
pub(crate) const INLET: f64 = 0.05;

/// Where it lies this far outside, a boundary vertex is held there, if the triangles allow.
pub(super) const CLOSE: f64 = 0.7;

/// What a placement is held against.
pub(super) struct Judge<'a> {
    pub(super) contours: &'a [ClosedCurve],
    pub(super) lattice: &'a Lattice,
    /// The contours in units of the lattice.
    pub(super) lines: &'a [Contour<'a>],
    /// Their corners.
    pub(super) found: &'a [Vec<Corner>],
    /// Three vertices of each triangle or of each corner of a quad, to be counter-clockwise.
    pub(super) corners: &'a [[u32; 3]],
    pub(super) options: &'a SketchOptions,
    pub(super) is_blunt: bool,
}

/// What is said of a placement.
pub(super) enum Judgement {
    Inverted(Obstacle),
    /// The drawing lies too far from it, in these places.
    Far(Vec<Stray>),
    /// It has no faces yet; where the drawing lies outside, and where a part of it is lost.
    Valid(Box<Placed>, Vec<Stray>, Vec<Stray>),
}

impl Judge<'_> {
    pub(super) fn judged(
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
            patch: Patch { vertices, triangles, quads, loops, inlets, lattice: *lattice, belt: None },
            arcs: own,
            pinned: rims.iter().map(|rim| rim.pinned.clone()).collect(),
            held: rims.iter().map(|rim| rim.held.clone()).collect(),
            corners: n_corners,
            released_corners: n_corners - kept,
            worn: worn(contours, &beside, self.found, h),
            max_deviation: farthest / h,
            strayed: strayed / h,
            bridged_inlets,
            crossings: crossed,
        };
        Ok(Judgement::Valid(Box::new(placed), strays, lost))
    }

    /// Which boundary vertices are to be held where, so that less of the drawing lies outside; or is lost, in a
    /// placement that is valid.
    pub(super) fn to_hold(
        &self,
        mut strays: Vec<Stray>,
        lost: Option<Vec<Stray>>,
        rims: &[Rim],
    ) -> Vec<(usize, f64)> {
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
pub(super) fn corners_of(contour: &ClosedCurve, angle: f64, h: f64) -> Vec<Corner> {
    let arcs: Vec<f64> = contour.arc().iter().map(|&s| s / h).collect();
    let turning = contour.turning(CORNER_WINDOW * h);
    corners(&arcs[..turning.len()], &turning, contour.length() / h, angle, 1.0)
}
