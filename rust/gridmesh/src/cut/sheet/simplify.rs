//! A stroke without the jitter of the hand, where the edges along the cut have a length of their own.

use glam::{DVec2, DVec3};

use crate::cut::options::Sweep;
use crate::cut::sheet::View;

/// How far the simplified stroke may be off, in edge lengths.
const SHARE: f64 = 0.01;

/// And in parts of the stroke's own size.
const OWN: f64 = 0.002;

/// The stroke without points that are, as seen along the sweep, within a hundredth of an edge length of the line between
/// others (Douglas and Peucker 1973). `None` if none can go, or if a point cannot be seen.
pub(in crate::cut) fn simplified(
    vertices: &[DVec3],
    stroke: &[DVec3],
    sweep: Sweep,
    length: f64,
) -> Option<Vec<DVec3>> {
    let n = stroke.len();
    if n < 4 {
        return None;
    }
    let view = View::new(vertices, stroke, sweep);
    let seen = stroke.iter().map(|&p| view.project(p)).collect::<Option<Vec<_>>>()?;
    // Of the plane: what is farther from the eye is seen smaller.
    let depth = vertices.iter().map(|&v| view.depth(v)).fold(f64::MIN_POSITIVE, f64::max);
    let (low, high) =
        seen.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |b, &p| (b.0.min(p), b.1.max(p)));
    let tolerance = (SHARE * length / depth).min(OWN * low.distance(high));
    let mut kept = vec![false; n];
    (kept[0], kept[n - 1]) = (true, true);
    let mut spans = vec![(0, n - 1)];
    // A line that comes back to where it began has no direction of its own.
    if seen[0].distance(seen[n - 1]) <= tolerance {
        let far = (0..n).max_by(|&a, &b| seen[0].distance(seen[a]).total_cmp(&seen[0].distance(seen[b])))?;
        kept[far] = true;
        spans = vec![(0, far), (far, n - 1)];
    }
    while let Some((from, to)) = spans.pop() {
        let (p, q) = (seen[from], seen[to]);
        let along = (q - p) / (q - p).length_squared().max(f64::MIN_POSITIVE);
        let off = |k: usize| {
            let t = (seen[k] - p).dot(along).clamp(0.0, 1.0);
            seen[k].distance(p + t * (q - p))
        };
        let farthest = (from + 1..to).map(|k| (off(k), k)).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, k)) = farthest.filter(|f| f.0 > tolerance) {
            kept[k] = true;
            spans.extend([(from, k), (k, to)]);
        }
    }
    let fewer = (0..n).filter(|&k| kept[k]).map(|k| stroke[k]).collect::<Vec<_>>();
    (fewer.len() < n && fewer.len() > 1).then_some(fewer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_and_jitter_goes() {
        let cube = [DVec3::splat(-1.0), DVec3::ONE];
        let sweep = Sweep::Along(DVec3::NEG_Z);
        let at = |k: i32| {
            let x = f64::from(k) / 100.0;
            DVec3::new(x, x.abs() + 1e-4 * f64::from(k * k % 7), 0.0)
        };
        let stroke = (-100..=100).map(at).collect::<Vec<_>>();
        let fewer = simplified(&cube, &stroke, sweep, 0.2).unwrap();
        assert!(fewer.len() < 8 && fewer.iter().any(|p| p.x.abs() < 0.02), "{fewer:?}");
        assert_eq!((fewer[0], fewer[fewer.len() - 1]), (stroke[0], stroke[200]));
        assert!(simplified(&cube, &stroke[..3], sweep, 0.2).is_none());
    }
}
