//! The last word: exact orientation of every triangle.

use glam::DVec2;
use robust::{Coord, orient2d};

/// The first triangle that is not counter-clockwise, if there is one.
///
/// Exact (adaptive predicates), for the positions as they are and for `position - origin` rounded
/// to `f32`, which is how Blender stores them. A degenerate triangle counts as inverted, and so
/// does one with a position that is not finite. Linear.
pub fn first_inverted(positions: &[DVec2], triangles: &[[u32; 3]], origin: DVec2) -> Option<usize> {
    triangles.iter().position(|t| {
        let p = t.map(|v| positions[v as usize]);
        !(oriented(p) && oriented(p.map(|q| (q - origin).as_vec2().as_dvec2())))
    })
}

fn oriented([a, b, c]: [DVec2; 3]) -> bool {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c)) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slivers_lost_by_rounding_are_found() {
        let far = DVec2::new(1000.0, 0.0);
        let positions = [far, far + DVec2::X, far + DVec2::new(0.5, 1e-6), far + DVec2::new(0.0, 1e-12)];
        let exact = [[0, 1, 2]];
        assert_eq!(first_inverted(&positions, &exact, far), None);
        // Relative to another origin the coordinates are too long for f32: only the x here.
        let lifted = positions.map(|p| p + DVec2::new(0.0, 1000.0));
        assert_eq!(first_inverted(&lifted, &exact, DVec2::ZERO), Some(0));
        assert_eq!(first_inverted(&positions, &[[0, 1, 2], [0, 2, 1]], far), Some(1));
        assert_eq!(first_inverted(&positions, &[[0, 0, 1]], far), Some(0));
        let nan = [DVec2::NAN, DVec2::X, DVec2::Y];
        assert_eq!(first_inverted(&nan, &exact, DVec2::ZERO), Some(0));
    }
}
