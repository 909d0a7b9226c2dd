//! Where weights change so fast that a bend of a joint presses triangles together.

use glam::DVec2;

use super::ways::Joint;

/// How far a joint is bent, as cosine and sine: 60 degrees.
const BENT: [f64; 2] = [0.5, 0.866_025_403_784_438_6];

/// What of a triangle may be lost across by the change of weights when one joint is bent; all of it is a fold, and two
/// joints may come together.
const MOST: f64 = 0.6;

/// What heat aims at when it flows more easily, of [`MOST`]: with both it takes half the rounds of aiming at the limit itself, and the
/// square of what is over, instead of once, half of those.
const BELOW: f64 = 0.85;

/// How many times as easily as elsewhere heat flows at most: sums of much more would lose what is held to rounding.
const EASIEST: f64 = 1e6;

/// Lets heat flow the more easily through triangles the more a bend of a joint would press them together; whether there are any.
///
/// A `reach` below half a limb's width asks for sharper bends.
pub(super) fn ease(
    joints: &[Joint],
    reach: f64,
    vertices: &[DVec2],
    triangles: &[[u32; 3]],
    weights: &[f64],
    eased: &mut [f64],
) -> bool {
    let most = MOST / reach.min(1.0);
    let bones = (weights.len() / vertices.len().max(1)).max(1);
    let mut lost = vec![0.0; triangles.len()];
    for joint in joints {
        let share = |of: &[usize]| -> Vec<f64> {
            weights.chunks_exact(bones).map(|row| of.iter().map(|&bone| row[bone]).sum()).collect()
        };
        let (moved, kept) = (share(&joint.moved), share(&joint.kept));
        for (corners, lost) in triangles.iter().zip(&mut lost) {
            let at = corners.map(|v| vertices[v as usize] - joint.at);
            let [by_moved, by_kept] =
                [&moved, &kept].map(|part| pressed(at, corners.map(|v| part[v as usize])));
            *lost = f64::max(*lost, by_moved.min(by_kept));
        }
    }
    for (eased, lost) in eased.iter_mut().zip(&lost) {
        let over = (lost / (BELOW * most)).max(1.0);
        *eased = (*eased * over * over).min(EASIEST);
    }
    lost.iter().any(|&lost| lost > most)
}

/// What a triangle loses across, at most, when its corners follow a turn around the origin to either side as far as they are told to, beyond
/// what all of it would lose that followed as its mean does; more than 1 is a fold.
fn pressed(corners: [DVec2; 3], follows: [f64; 3]) -> f64 {
    let [a, b, c] = corners;
    let before = (b - a).perp_dot(c - a);
    let mean = (follows[0] + follows[1] + follows[2]) / 3.0;
    if before == 0.0 || follows == [mean; 3] {
        return 0.0;
    }
    let lost = |side: f64| {
        let turn = DVec2::new(BENT[0] - 1.0, side * BENT[1]);
        let moved = |k: usize| corners[k] + follows[k] * turn.rotate(corners[k]);
        let after = (moved(1) - moved(0)).perp_dot(moved(2) - moved(0));
        1.0 - after / before / (DVec2::X + mean * turn).length_squared()
    };
    lost(1.0).max(lost(-1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_that_follows_as_a_whole_loses_nothing() {
        let corners = [DVec2::new(2.0, 1.0), DVec2::new(3.0, 1.0), DVec2::new(2.0, 2.0)];
        for follows in [0.0, 0.4, 1.0] {
            assert!(pressed(corners, [follows; 3]).abs() < 1e-12);
        }
    }

    #[test]
    fn the_farther_from_the_joint_the_more_is_lost_until_it_folds() {
        let lost = |far: f64| {
            let corners = [DVec2::new(far, 0.0), DVec2::new(far + 1.0, 0.0), DVec2::new(far, 1.0)];
            pressed(corners, [0.5, 0.5, 0.6])
        };
        let lost = [1.0, 2.0, 5.0, 8.0, 20.0].map(lost);
        assert!(lost.is_sorted() && lost[1] < 0.3 && lost[3] < 1.0 && lost[4] > 1.0, "{lost:?}");
    }

    #[test]
    fn heat_flows_more_easily_where_a_bend_presses() {
        let vertices = [[8.0, 0.0], [9.0, 0.0], [8.0, 1.0], [9.0, 1.0]].map(DVec2::from);
        let eased = |weights: [f64; 8], reach: f64| {
            let mut eased = [1.0; 2];
            let triangles = [[0, 1, 2], [1, 3, 2]];
            let joint = Joint { at: DVec2::ZERO, moved: vec![0], kept: vec![1] };
            let any = ease(&[joint], reach, &vertices, &triangles, &weights, &mut eased);
            (any, eased[0])
        };
        assert_eq!(eased([0.5; 8], 1.0), (false, 1.0));
        let steep = [1.0, 0.0, 1.0, 0.0, 0.5, 0.5, 0.5, 0.5];
        let (any, wide) = eased(steep, 1.0);
        assert!(any && wide > 2.0);
        assert!(eased(steep, 0.5).1 < 0.6 * wide);
    }
}
