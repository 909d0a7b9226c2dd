//! Which lattice direction each stretch of a contour should follow: cyclic dynamic programming.

/// A direction may be so many steps from the nearest one.
const REACH: i32 = 2;
const STATES: usize = 2 * REACH as usize + 1;

/// Directions along a closed contour and what they cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    /// For each sample the multiple of the step that the tangent should have.
    pub steps: Vec<i32>,
    /// Sum of the absolute changes from sample to sample, once around.
    pub turns: usize,
    /// Sum of the squared distances between tangent and direction, weighted by length.
    pub misfit: f64,
}

/// The integers `m` along a closed contour for which `sum of length (tangent - step m)^2 + price x sum of
/// |change of m|` is least, where `m` gains `total` in one turn and `step` is the angle between lattice
/// directions.
///
/// `tangents` are unwrapped angles in radians at the samples, `lengths` how much of the contour each
/// sample stands for. The contour is cut where its tangents agree best with a direction for some
/// samples; there `m` is the nearest integer. O(samples).
pub fn directions(tangents: &[f64], lengths: &[f64], (total, step): (i32, f64), price: f64) -> Directions {
    let n = tangents.len();
    let nearest = |angle: f64| rounded(angle / step);
    let misfit = |angle: f64, m: i32| (angle - step * f64::from(m)).powi(2);
    let start = quietest(&tangents.iter().map(|&a| misfit(a, nearest(a))).collect::<Vec<f64>>());
    // From the start on, a turn further beyond the seam.
    let at = |k: usize| {
        let i = (start + k) % n;
        (tangents[i] + if start + k >= n { step * f64::from(total) } else { 0.0 }, lengths[i])
    };
    let mut costs = [f64::INFINITY; STATES];
    let (first, first_length) = at(0);
    let base = nearest(first);
    costs[REACH as usize] = first_length * misfit(first, base);
    let mut bases = vec![base];
    let mut back: Vec<[u8; STATES]> = vec![[0; STATES]];
    for k in 1..n {
        let (angle, length) = at(k);
        let (before, base) = (bases[k - 1], nearest(angle));
        let (reached, from) = with_changes(costs, price);
        let mut next = [0.0; STATES];
        let mut origin = [0u8; STATES];
        for (state, (next, origin)) in next.iter_mut().zip(&mut origin).enumerate() {
            let m = base + state as i32 - REACH;
            // Among the states of the sample before; beyond them the last one is nearest.
            let wanted = m - before + REACH;
            let nearest = wanted.clamp(0, STATES as i32 - 1);
            let beyond = f64::from((wanted - nearest).abs());
            *next = reached[nearest as usize] + price * beyond + length * misfit(angle, m);
            *origin = from[nearest as usize];
        }
        costs = next;
        bases.push(base);
        back.push(origin);
    }
    let end = bases[0] + total;
    let closing = |state: usize| (end - (bases[n - 1] + state as i32 - REACH)).abs();
    let mut state = (0..STATES)
        .min_by(|&a, &b| {
            let sum = |s: usize| costs[s] + price * f64::from(closing(s));
            sum(a).total_cmp(&sum(b))
        })
        .unwrap_or(REACH as usize);
    let mut steps = vec![0; n];
    for k in (0..n).rev() {
        let m = bases[k] + state as i32 - REACH;
        steps[(start + k) % n] = if start + k >= n { m - total } else { m };
        state = back[k][state] as usize;
    }
    let change = |i: usize| if i + 1 < n { steps[i + 1] - steps[i] } else { steps[0] + total - steps[i] };
    let turns = (0..n).map(|i| change(i).unsigned_abs() as usize).sum();
    let misfit = (0..n).map(|i| lengths[i] * misfit(tangents[i], steps[i])).sum();
    Directions { steps, turns, misfit }
}

/// The least costs of states once changes are made between them, each a step to the state beside for `price`; and from
/// which state each is reached.
fn with_changes(mut costs: [f64; STATES], price: f64) -> ([f64; STATES], [u8; STATES]) {
    let mut from: [u8; STATES] = std::array::from_fn(|state| state as u8);
    let mut change = |to: usize, other: usize| {
        let sum = costs[other] + price;
        if sum < costs[to] {
            (costs[to], from[to]) = (sum, from[other]);
        }
    };
    for state in 1..STATES {
        change(state, state - 1);
    }
    for state in (1..STATES).rev() {
        change(state - 1, state);
    }
    (costs, from)
}

/// The nearest integer, halves away from zero: as `round`, which is a call for processors without an instruction for it.
fn rounded(x: f64) -> i32 {
    let whole = x as i32;
    let rest = x - f64::from(whole);
    whole + i32::from(rest >= 0.5) - i32::from(rest <= -0.5)
}

/// Where the sum over seven samples in a row is least: their middle.
fn quietest(misfits: &[f64]) -> usize {
    let n = misfits.len();
    let around = |i: usize| (0..7).map(|k| misfits[(i + n * 3 + k - 3) % n]).sum::<f64>();
    (0..n).min_by(|&i, &j| around(i).total_cmp(&around(j)).then(i.cmp(&j))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_3;

    use super::*;

    #[test]
    fn a_circle_turns_six_times_and_a_hole_six_times_back() {
        for total in [6, -6] {
            for shift in [0.0, 0.3, 1.0] {
                let tangents: Vec<f64> =
                    (0..120).map(|i| shift + f64::from(total) * FRAC_PI_3 * f64::from(i) / 120.0).collect();
                let found = directions(&tangents, &[1.0; 120], (total, FRAC_PI_3), 0.2);
                assert_eq!(found.turns, 6);
                assert!(found.misfit < 120.0 * (0.5 * FRAC_PI_3).powi(2));
            }
        }
    }

    #[test]
    fn rounded_is_round() {
        for x in [-2.5, -1.5, -0.5, -0.49999, 0.0, 0.49999, 0.5, 1.5, 2.4, -7.6, 7.5, 1e6 + 0.5] {
            assert_eq!(f64::from(rounded(x)), f64::round(x));
        }
    }

    #[test]
    fn small_wiggles_do_not_turn() {
        let tangents: Vec<f64> =
            (0..60).map(|i| FRAC_PI_3 * f64::from(i / 10) + if i % 2 == 0 { 0.45 } else { -0.45 }).collect();
        let found = directions(&tangents, &[1.0; 60], (6, FRAC_PI_3), 1.0);
        assert_eq!(found.turns, 6);
    }

    #[test]
    fn the_start_does_not_matter() {
        let wavy = |i: i32| {
            let t = std::f64::consts::TAU * f64::from(i) / 90.0;
            t + 0.7 * (3.0 * t).sin() + 0.3 * (5.0 * t + 1.0).cos()
        };
        let whole: Vec<f64> = (0..180).map(wavy).collect();
        let lengths: Vec<f64> = (0..180).map(|i| 1.0 + 0.3 * f64::from(i % 90).sin()).collect();
        let first = directions(&whole[..90], &lengths[..90], (6, FRAC_PI_3), 0.2);
        for shift in [1, 17, 60] {
            let found =
                directions(&whole[shift..shift + 90], &lengths[shift..shift + 90], (6, FRAC_PI_3), 0.2);
            assert_eq!(found.turns, first.turns);
            for i in 0..90 {
                let j = (i + shift) % 90;
                assert_eq!(found.steps[i], first.steps[j] + if i + shift >= 90 { 6 } else { 0 });
            }
        }
    }
}
