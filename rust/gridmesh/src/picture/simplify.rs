//! Points that add nothing are dropped.

use glam::DVec2;

use crate::geometry::segments::nearest_on_segment;
use crate::picture::heights::Sample;

/// How far dropped points may be from the line, in pixels.
const TOLERANCE: f64 = 0.03;

/// The fewest samples of a closed line with the same shape, to within the tolerance; corners are kept.
pub fn simplify(samples: Vec<Sample>) -> Vec<Sample> {
    let points: Vec<DVec2> = samples.iter().map(|sample| sample.at).collect();
    let corners = (0..samples.len()).filter(|&i| samples[i].corner).collect();
    let keep = needed(&points, corners, TOLERANCE);
    samples.into_iter().zip(keep).filter_map(|(sample, keep)| keep.then_some(sample)).collect()
}

/// Which points of a closed line it needs to have the same shape, to within the tolerance: the anchors, or three if these are
/// fewer, and others.
///
/// Source: Ramer, An iterative procedure for the polygonal approximation of plane curves, 1972.
pub fn needed(points: &[DVec2], mut anchors: Vec<usize>, tolerance: f64) -> Vec<bool> {
    let n = points.len();
    if anchors.len() < 3 {
        anchors.extend([0, n / 3, 2 * n / 3]);
        anchors.sort_unstable();
        anchors.dedup();
    }
    let mut keep = vec![false; n];
    let mut open = Vec::new();
    for (k, &anchor) in anchors.iter().enumerate() {
        keep[anchor] = true;
        open.push((anchor, anchors.get(k + 1).copied().unwrap_or(anchors[0] + n)));
    }
    while let Some((first, last)) = open.pop() {
        let (a, b) = (points[first % n], points[last % n]);
        let off = |i: &usize| distance_squared(points[i % n], a, b);
        let Some(far) = (first + 1..last).max_by(|i, j| off(i).total_cmp(&off(j))) else { continue };
        if off(&far) > tolerance * tolerance {
            keep[far % n] = true;
            open.extend([(first, far), (far, last)]);
        }
    }
    keep
}

fn distance_squared(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    nearest_on_segment(point, a, b).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_lose_their_points_and_curves_keep_their_shape() {
        let samples = |points: Vec<DVec2>| -> Vec<Sample> {
            let sample = |(crossing, at)| Sample { crossing, at, exact: true, corner: false };
            points.into_iter().enumerate().map(sample).collect()
        };
        let square = (0..80).map(|k| match k / 20 {
            0 => DVec2::new(f64::from(k), 0.0),
            1 => DVec2::new(20.0, f64::from(k - 20)),
            2 => DVec2::new(f64::from(60 - k), 20.0),
            _ => DVec2::new(0.0, f64::from(80 - k)),
        });
        assert!(simplify(samples(square.collect())).len() <= 7);
        let circle: Vec<DVec2> = (0..600)
            .map(|k| 90.0 * DVec2::from_angle(std::f64::consts::TAU / 600.0 * f64::from(k)))
            .collect();
        let kept = simplify(samples(circle.clone()));
        assert!(kept.len() < 200);
        for point in circle {
            let off = (0..kept.len())
                .map(|i| distance_squared(point, kept[i].at, kept[(i + 1) % kept.len()].at))
                .fold(f64::MAX, f64::min);
            assert!(off <= TOLERANCE * TOLERANCE);
        }
    }
}
