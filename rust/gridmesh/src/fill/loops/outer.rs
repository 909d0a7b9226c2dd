//! Outer borders of sheets, which are no holes: what would fill them would lie on the sheet.

use glam::DVec3;

/// Cosine of 26 degrees: a border is that of a sheet if its faces lead into what it encloses, at less than this on average.
const ON_FACES: f64 = 0.9;

/// Whether a loop is the outer border of a sheet that is flat there, and no hole in one and no end of a pipe.
///
/// `points`: the loop's positions in the direction of a patch. `into`: from the edge behind each point into its face, of any
/// length; zero where there is no face. False for what is not finite. O(points).
pub fn is_outer_border(points: &[DVec3], into: &[DVec3]) -> bool {
    let finite = points.iter().chain(into).all(|p| p.is_finite());
    if !finite || points.is_empty() || points.len() != into.len() {
        return false;
    }
    let n = points.len();
    let middle = points.iter().sum::<DVec3>() / n as f64;
    let next = |k: usize| points[(k + 1) % n];
    let normal = (0..n).map(|k| (points[k] - middle).cross(next(k) - middle)).sum::<DVec3>();
    let (mut leading, mut length) = (0.0, 0.0);
    for (k, &into) in into.iter().enumerate() {
        let along = next(k) - points[k];
        let tangent = along.normalize_or_zero();
        let inward = normal.cross(along).normalize_or_zero();
        leading += along.length() * inward.dot((into - into.dot(tangent) * tangent).normalize_or_zero());
        length += along.length();
    }
    leading > ON_FACES * length
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn faces_tell_the_border_of_a_sheet_from_a_hole_and_the_end_of_a_pipe() {
        let at = |k: i32| DVec2::from_angle(0.3 * f64::from(k)).extend(0.0);
        let ring = (0..20).map(at).collect::<Vec<_>>();
        let is_outer = |into: &dyn Fn(DVec3) -> DVec3| {
            is_outer_border(&ring, &ring.iter().map(|&p| into(p)).collect::<Vec<_>>())
        };
        assert!(is_outer(&|p| 0.2 * DVec3::Z - 3.0 * p));
        assert!(!is_outer(&|p| p) && !is_outer(&|_| DVec3::Z) && !is_outer(&|p| p / 0.0));
        assert!(!is_outer_border(&[], &[]) && !is_outer_border(&ring, &[]));
    }
}
