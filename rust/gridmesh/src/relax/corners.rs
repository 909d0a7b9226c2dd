//! Which boundary vertex a drawn corner should have.

use super::contour::{Contour, Rim};

/// Hands drawn corners on to boundary vertices whose number of triangles suits the corner better.
///
/// A corner of interior angle a at a vertex with m triangles has angles of about a / m there: a
/// sharp convex corner wants two triangles, a concave one four or five. For each pinned vertex the
/// neighbours on either side are considered, up to two edges away along the curve; the corner goes
/// to the best of them, weighed against the distance that it has to slide. Only vertices that are
/// neither pinned nor next to another pinned one are taken.
///
/// `turning` holds, for each rim, the turning angle (radians, positive where convex) of the corner
/// at each vertex, and moves with the pins. Lengths in lattice units. Afterwards the arc positions
/// are strictly increasing as before. Returns the number of corners that changed hands. Linear.
pub fn settle_corners(
    triangles: &[[u32; 3]],
    contours: &[Contour<'_>],
    rims: &mut [Rim],
    turning: &mut [Vec<f64>],
) -> usize {
    let n_rim: usize = rims.iter().map(|rim| rim.s.len()).sum();
    let mut fan = vec![0u32; n_rim];
    for &v in triangles.iter().flatten() {
        if let Some(count) = fan.get_mut(v as usize) {
            *count += 1;
        }
    }
    let mut changed = 0;
    for ((rim, contour), turning) in rims.iter_mut().zip(contours).zip(turning) {
        let n = rim.s.len();
        if n < 6 {
            continue;
        }
        let spacing = contour.length() / n as f64;
        for k in 0..n {
            if !rim.pinned[k] {
                continue;
            }
            let interior = std::f64::consts::PI - turning[k];
            let corner = rim.s[k];
            let cost = |i: usize, moved: f64| {
                let each = interior / f64::from(fan[rim.start + i].max(1));
                let ideal = libm::log(each / std::f64::consts::FRAC_PI_3);
                ideal * ideal + 0.1 * moved * moved
            };
            let mut best = (cost(k, 0.0) - 0.05, k, 0.0);
            for (other, far, lap) in
                [(n - 1, n - 2, -contour.length()), (1, 2, contour.length())].map(|(near, far, lap)| {
                    let i = (k + near) % n;
                    // Beyond the seam of the numbering the same place is a lap away.
                    let crossed = if near == 1 { i < k } else { i > k };
                    (i, (k + far) % n, if crossed { lap } else { 0.0 })
                })
            {
                let moved = rim.s[other] + lap - corner;
                if rim.pinned[other] || rim.pinned[far] || moved.abs() > 2.0 * spacing {
                    continue;
                }
                let c = cost(other, moved);
                if c < best.0 {
                    best = (c, other, lap);
                }
            }
            let (_, to, lap) = best;
            if to == k {
                continue;
            }
            let ahead = to == (k + 1) % n;
            rim.pinned[k] = false;
            rim.pinned[to] = true;
            turning[to] = std::mem::take(&mut turning[k]);
            // The old vertex goes half way to its other neighbour.
            let other = if ahead { (k + n - 1) % n } else { (k + 1) % n };
            let wrapped = if ahead && other > k {
                -contour.length()
            } else if !ahead && other < k {
                contour.length()
            } else {
                0.0
            };
            rim.s[to] = corner - lap;
            rim.s[k] = corner + 0.5 * (rim.s[other] + wrapped - corner);
            changed += 1;
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    const SQUARE: [DVec2; 4] =
        [DVec2::ZERO, DVec2::new(4.0, 0.0), DVec2::new(4.0, 4.0), DVec2::new(0.0, 4.0)];
    const ARC: [f64; 5] = [0.0, 4.0, 8.0, 12.0, 16.0];

    #[test]
    fn a_sharp_corner_goes_to_the_neighbour_with_two_triangles_also_across_the_seam() {
        for shift in 0..8usize {
            let contours = [Contour { points: &SQUARE, arc: &ARC }];
            let s: Vec<f64> = (0..8).map(|i| 2.0 * (i as f64 - shift as f64)).collect();
            let mut pinned = vec![false; 8];
            pinned[shift] = true;
            let mut turning = [vec![0.0; 8]];
            turning[0][shift] = 2.0;
            let mut rims = [Rim { start: 0, held: vec![false; s.len()], s, pinned }];
            // Three triangles at each vertex but the one ahead of the corner, which has two.
            let ahead = (shift + 1) % 8;
            let triangles: Vec<[u32; 3]> =
                (0..8).flat_map(|v| vec![[v as u32, 90, 91]; if v == ahead { 2 } else { 3 }]).collect();
            assert_eq!(settle_corners(&triangles, &contours, &mut rims, &mut turning), 1);
            assert!(rims[0].pinned[ahead] && !rims[0].pinned[shift]);
            assert_eq!((turning[0][ahead], turning[0][shift]), (2.0, 0.0));
            assert_eq!(contours[0].point_at(rims[0].s[ahead]), DVec2::ZERO);
            assert!(rims[0].s.windows(2).all(|w| w[0] < w[1]), "{:?}", rims[0].s);
            assert!(rims[0].s[7] < rims[0].s[0] + 16.0);
        }
    }
}
