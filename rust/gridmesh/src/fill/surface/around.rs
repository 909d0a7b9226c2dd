//! Whether a tube is free of meetings because it goes once around an axis.

use glam::DVec3;

use crate::fill::layout::unroll::area_vector;

/// What counts as facing away from the axis: the sine of the angle, beyond rounding.
const CLEAR: f64 = 1e-6;

/// True if the tube meets itself nowhere since it is seen once from each side of an axis.
///
/// Seen from the axis all triangles are the same way round, and both loops run once around it: then each ray from the axis
/// meets the tube as often as the loops' places on it say, which is once or not at all. `positions`: the first loop's,
/// `first` of them, the second's up to `n`, then those between.
pub(crate) fn is_around(positions: &[DVec3], first: usize, n: usize, triangles: &[[u32; 3]]) -> bool {
    let (one, two) = positions[..n].split_at(first);
    let centre = |loop_: &[DVec3]| loop_.iter().sum::<DVec3>() / loop_.len() as f64;
    let (a, b) = (centre(one), centre(two));
    let size = one.iter().map(|p| p.distance(a)).fold(0.0, f64::max);
    let way = if a.distance(b) > 0.5 * size { b - a } else { area_vector(one) - area_vector(two) };
    let Some(axis) = way.try_normalize() else { return false };
    let out = |p: DVec3| (p - a).reject_from_normalized(axis);
    // +1 or -1 if a loop runs once around, the second one against the first.
    let once = |loop_: &[DVec3]| {
        let mut turned = 0.0;
        let mut sign = 0.0;
        for k in 0..loop_.len() {
            let (p, q) = (out(loop_[k]), out(loop_[(k + 1) % loop_.len()]));
            let sine = p.cross(q).dot(axis);
            let own = if sine.abs() > CLEAR * p.length() * q.length() { sine.signum() } else { 0.0 };
            if own == 0.0 || own * sign < 0.0 {
                return 0.0;
            }
            sign = own;
            turned += libm::atan2(sine, p.dot(q));
        }
        if turned.abs() < 3.0 * std::f64::consts::PI { sign } else { 0.0 }
    };
    let sign = once(one);
    if sign == 0.0 || once(two) != -sign {
        return false;
    }
    let away = positions.iter().map(|&p| (out(p), out(p).length())).collect::<Vec<_>>();
    let facing = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| positions[v as usize]);
        let normal = (q - p).cross(r - p);
        let least = CLEAR * normal.length();
        t.iter().map(|&v| away[v as usize]).all(|(out, length)| normal.dot(out) * sign > least * length)
    };
    let outward = |t: &[u32; 3]| facing(t);
    let inward = |t: &[u32; 3]| facing(&[t[0], t[2], t[1]]);
    triangles.iter().all(outward) || triangles.iter().all(inward)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight tube of two rows, its loops run as a patch's boundary does; the middle ring is `radius` wide.
    fn tube(radius: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let n = 12;
        let ring = |radius: f64, z: f64| {
            let at = move |k: u32| {
                let t = std::f64::consts::TAU * f64::from(k) / f64::from(n);
                DVec3::new(radius * t.cos(), radius * t.sin(), z)
            };
            (0..n).map(at).collect::<Vec<_>>()
        };
        let mut top = ring(1.0, 1.0);
        top.reverse();
        let positions = [ring(1.0, 0.0), top, ring(radius, 0.5)].concat();
        let (low, high, middle) = (|k: u32| k % n, |k: u32| 2 * n - 1 - k % n, |k: u32| 2 * n + k % n);
        let rows = (0..n).flat_map(|k| {
            [
                [low(k), low(k + 1), middle(k)],
                [low(k + 1), middle(k + 1), middle(k)],
                [middle(k), middle(k + 1), high(k)],
                [middle(k + 1), high(k + 1), high(k)],
            ]
        });
        (positions, rows.collect())
    }

    #[test]
    fn tubes_around_their_axis_are_known() {
        let (positions, triangles) = tube(1.2);
        assert!(is_around(&positions, 12, 24, &triangles));
        let turned = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect::<Vec<_>>();
        assert!(is_around(&positions, 12, 24, &turned));
        // Through the axis and out on the other side.
        let (positions, triangles) = tube(-1.0);
        assert!(!is_around(&positions, 12, 24, &triangles));
        let (mut positions, triangles) = tube(1.2);
        positions.swap(25, 26);
        assert!(!is_around(&positions, 12, 24, &triangles));
    }
}
