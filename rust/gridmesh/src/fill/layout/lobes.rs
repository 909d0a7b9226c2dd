//! Loops that cross themselves in a few places, as where a mesh is cut that meets itself: without the small lobes
//! behind the crossings they can be filled like others.

use glam::DVec2;

use crate::geometry::segments::{SegmentGrid, segments_meet};

/// Rounds of looking for crossings: an edge across the neck of a lobe may cross others.
const ROUNDS: usize = 8;

/// Numbers of the vertices, ascending, that are left when the smaller of the two parts between each pair of edges
/// that meet is left out. `None` if the loop does not meet itself, or if a part has more than an eighth of the
/// vertices: then the loop lies upon itself.
pub(in crate::fill) fn without_lobes(points: &[DVec2]) -> Option<Vec<usize>> {
    let n = points.len();
    let mut kept: Vec<usize> = (0..n).collect();
    for _ in 0..ROUNDS {
        let m = kept.len();
        let segments: Vec<[DVec2; 2]> =
            (0..m).map(|k| [points[kept[k]], points[kept[(k + 1) % m]]]).collect();
        let mut left_out = vec![false; m];
        let mut largest = 0;
        SegmentGrid::new(&segments).pairs(|i, j| {
            let between = j - i;
            if between > 1 && between < m - 1 && segments_meet(segments[i], segments[j]) {
                let lobe = if 2 * between <= m { i + 1..j + 1 } else { j + 1..m + i + 1 };
                largest = largest.max(lobe.len());
                lobe.for_each(|k| left_out[k % m] = true);
            }
            largest <= n / 8 + 1
        });
        if largest == 0 {
            return (m < n).then_some(kept);
        }
        if largest > n / 8 + 1 {
            return None;
        }
        kept = kept.into_iter().zip(left_out).filter_map(|(v, out)| (!out).then_some(v)).collect();
        if kept.len() < 5 {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(n: usize) -> Vec<DVec2> {
        (0..n).map(|k| DVec2::from_angle(std::f64::consts::TAU * k as f64 / n as f64)).collect()
    }

    #[test]
    fn lobes_are_left_out_and_nothing_else() {
        let mut points = circle(40);
        assert_eq!(without_lobes(&points), None);
        points.swap(10, 12);
        let kept = without_lobes(&points).unwrap_or_default();
        assert!((36..40).contains(&kept.len()), "{kept:?}");
        assert!((0..9).chain(14..40).all(|k| kept.contains(&k)), "{kept:?}");
    }

    #[test]
    fn loops_that_lie_upon_themselves_have_none() {
        let twice: Vec<DVec2> = (0..40).map(|k| DVec2::from_angle(0.3 * f64::from(k))).collect();
        assert_eq!(without_lobes(&twice), None);
        assert_eq!(without_lobes(&[DVec2::ZERO; 12]), None);
    }
}
