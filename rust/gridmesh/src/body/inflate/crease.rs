//! Creases above the re-entrant corners of the outline.

use glam::DVec2;

use super::field::Field;
use crate::patch::Loop;

/// Turning angle in radians from which on a boundary vertex is re-entrant enough for a crease.
const RE_ENTRANT: f64 = 0.3;

/// Where the body has a crease above a re-entrant corner of the outline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crease {
    /// The corner's position.
    pub corner: DVec2,
    /// Unit vector from it along the bisector.
    pub inward: DVec2,
    cos_limit: f64,
}

impl Crease {
    /// Whether both sides of the corner are seen from `point`.
    pub fn holds(&self, point: DVec2) -> bool {
        let away = point - self.corner;
        away.dot(self.inward) >= self.cos_limit * away.length()
    }
}

/// For each vertex the re-entrant corner that it is to stand above, if any.
///
/// Above such a corner the body has a crease. A mesh that is a graph over the drawing follows it
/// only if one of the corner's neighbours lies on it: the innermost one is chosen.
pub(crate) fn creases(field: &Field<'_>, loops: &[Loop], first: usize) -> Vec<Option<Crease>> {
    let mut creases = vec![None; field.vertices.len()];
    for contour in loops {
        let (start, n) = (contour.start as usize, contour.len());
        for k in 0..n {
            let corner = field.vertices[start + k];
            let to_next = (field.vertices[start + (k + 1) % n] - corner).normalize_or_zero();
            let to_previous = (field.vertices[start + (k + n - 1) % n] - corner).normalize_or_zero();
            let turn = (-to_previous).angle_to(to_next);
            if turn > -RE_ENTRANT {
                continue;
            }
            let inward = (-to_next - to_previous).try_normalize().unwrap_or(to_next.perp());
            let inner = field.topology.near[field.topology.range(start + k)]
                .iter()
                .map(|&v| v as usize)
                .filter(|&v| v >= first)
                .map(|v| (v, (field.vertices[v] - corner).normalize_or_zero().dot(inward)))
                .reduce(|best, other| if other.1 > best.1 { other } else { best });
            let cos_limit = to_next.dot(inward).abs();
            if let Some((v, _)) = inner {
                creases[v] = Some(Crease { corner, inward, cos_limit });
            }
        }
    }
    creases
}
