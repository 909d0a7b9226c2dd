//! Sharp tips of a drawing, which a mesh may blunt, and its wide corners, which it should keep.

use glam::DVec2;

use crate::drawing::curve::ClosedCurve;
use crate::patch::deviation::{Beside, Stray};
use crate::path::mapping::Corner;
use crate::relax::{Contour, Rim};

/// On bent lattices corners are let go whose triangles have less than this angle, 17.5 degrees: half that of
/// a drawn corner of 35, below which a corner is a tip.
pub(crate) const BLUNT: f64 = 17.5 * std::f64::consts::PI / 180.0;

/// A blunted tip is so wide where it is cut off, if that is between these distances from its point along the
/// drawing; in edges.
const ACROSS: f64 = 0.5;
const BACK: (f64, f64) = (0.8, 1.9);

/// Tips that are cut off so many times farther from their point are cut off nearer to it.
const FAR: f64 = 1.15;

/// A corner of the drawing is lost that lies so far from the boundary, in edges: one that has no vertex.
const WORN: f64 = 1e-3;

/// The angle of the drawing at an arc length, in radians, if it is a tip's; in edges.
fn tip(line: &Contour<'_>, at: f64) -> Option<f64> {
    let point = line.point_at(line.wrap(at));
    let [a, b] = [-1.0, 1.0].map(|away| line.point_at(line.wrap(at + away)) - point);
    let angle = a.angle_to(b).abs();
    (angle < 2.0 * BLUNT).then_some(angle)
}

/// Takes strays at drawn tips out of a list. The ends of the edges that cut those off are to be held at either side of
/// the tip where they are far from it, given by number and arc position in edges.
pub(crate) fn blunted(
    strays: &mut Vec<Stray>,
    rims: &[Rim],
    lines: &[Contour<'_>],
    h: f64,
) -> Vec<(usize, f64)> {
    let mut held = Vec::new();
    strays.retain(|stray| {
        let (rim, line) = (&rims[stray.contour], &lines[stray.contour]);
        let at = stray.arc / h;
        let Some(angle) = tip(line, at) else { return true };
        let back = (0.5 * ACROSS / libm::sin(0.5 * angle)).clamp(BACK.0, BACK.1);
        let after = (stray.edge + 1) % rim.s.len();
        // The last edge ends at the first vertex, a lap on.
        let lap = if after == 0 { line.length() } else { 0.0 };
        let (before, behind) = (at - rim.s[stray.edge], rim.s[after] + lap - at);
        let is_free = !rim.held[stray.edge] && !rim.held[after] && before > 0.0 && behind > 0.0;
        if is_free && stray.distance > FAR.min(BACK.1 / back) * back * h {
            held.push((rim.start + stray.edge, at - before.min(back)));
            held.push((rim.start + after, at + behind.min(back) - lap));
        }
        !is_free
    });
    held
}

/// How far the drawing strays from the boundary elsewhere than at its tips, at least `least`.
pub(crate) fn stray_off_tips(strays: &[Stray], lines: &[Contour<'_>], h: f64, least: f64) -> f64 {
    let off = strays.iter().filter(|stray| tip(&lines[stray.contour], stray.arc / h).is_none());
    off.map(|stray| stray.distance).fold(least, f64::max)
}

/// The corners of the drawing wider than tips that the boundary cuts off.
pub(crate) fn worn(
    contours: &[ClosedCurve],
    beside: &[Vec<Beside>],
    corners: &[Vec<Corner>],
    h: f64,
) -> Vec<DVec2> {
    let is_wide = |turning: f64| turning != 0.0 && turning < std::f64::consts::PI - 2.0 * BLUNT;
    let mut worn = Vec::new();
    for ((contour, points), corners) in contours.iter().zip(beside).zip(corners) {
        let far = points.iter().filter(|point| point.squared > WORN * WORN * h * h);
        worn.extend(far.filter(|p| is_wide(turning_at(contour, corners, p.arc, h))).map(|p| p.point));
    }
    worn
}

/// The angle of the corner at arc length `s`, however its vertex came there; zero if there is none.
pub(crate) fn turning_at(contour: &ClosedCurve, corners: &[Corner], s: f64, h: f64) -> f64 {
    const SAME: f64 = 1e-6;
    let length = contour.length();
    let gap = |corner: &Corner| {
        let away = corner.arc * h - s;
        // Most corners are far away: no need to divide.
        if away.abs() > 2.0 * SAME * h && away.abs() < 0.5 * length {
            return f64::INFINITY;
        }
        let turns = away / length;
        (turns - turns.round()).abs() * length
    };
    corners.iter().find(|corner| gap(corner) <= SAME * h).map_or(0.0, |corner| corner.angle)
}

/// The point of a contour at which a vertex is pinned: one that was drawn, if it is there.
pub(crate) fn pinned_at(contour: &ClosedCurve, s: f64, h: f64) -> f64 {
    const SAME: f64 = 1e-6;
    let (segment, t) = contour.locate(s);
    let (from, to) = (contour.arc()[segment], contour.arc()[segment + 1]);
    let drawn = if t < 0.5 { from } else { to };
    let s = contour.wrap(s);
    if (drawn - s).abs() <= SAME * h { drawn } else { s }
}
