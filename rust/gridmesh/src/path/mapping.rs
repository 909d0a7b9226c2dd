//! Boundary vertices to arc lengths of the drawn curve (paper, section IV-C).

use rustc_hash::FxHashMap;

use crate::lattice::axial::Axial;
use crate::path::band::Band;

/// Least distance along the curve between neighbouring boundary vertices, relative to the mean.
pub const MIN_SPACING: f64 = 0.15;

/// Projects the vertices of a grown path onto the curve: section IV-C, before the boundary is
/// optimised.
///
/// Each vertex takes the nearest point of the curve. Where that breaks the order along the curve,
/// the largest set of vertices that is in order (and leaves room for the others) is kept, starting
/// from the vertex that is nearest to the curve; the rest is left to [`complete`]. The result
/// holds the arc lengths of the kept vertices, in samples of the band's target.
pub fn project(path: &[Axial], band: &Band) -> FxHashMap<Axial, f64> {
    let n = path.len();
    let length = band.n_samples() as f64;
    let gap = MIN_SPACING * length / n as f64;
    let nearest: Vec<Option<(f64, f64)>> =
        path.iter().map(|&p| band.nearest(p).map(|node| (node.parameter, node.distance))).collect();
    let anchor = (0..n)
        .filter_map(|i| nearest[i].map(|(parameter, distance)| (i, parameter, distance)))
        .min_by(|a, b| a.2.total_cmp(&b.2).then(a.0.cmp(&b.0)));
    let Some((anchor, origin, _)) = anchor else {
        return FxHashMap::default();
    };
    // Arc lengths from the anchor, less the room that the vertices up to here need.
    let candidates: Vec<(usize, f64)> = (1..n)
        .filter_map(|k| {
            let (parameter, _) = nearest[(anchor + k) % n]?;
            let room = gap * k as f64;
            let s = (parameter - origin).rem_euclid(length) - room;
            (s >= 0.0 && s + gap * n as f64 <= length).then_some((k, s))
        })
        .collect();
    let values: Vec<f64> = candidates.iter().map(|c| c.1).collect();
    let mut kept = FxHashMap::default();
    kept.insert(path[anchor], origin.rem_euclid(length));
    for i in longest_increasing(&values) {
        let (k, s) = candidates[i];
        kept.insert(path[(anchor + k) % n], (s + gap * k as f64 + origin).rem_euclid(length));
    }
    kept
}

/// Gives every vertex of a path a parameter: the known ones keep theirs, the others share the
/// stretch of curve between their known neighbours evenly (arc length parameterisation, sections
/// IV-C and IV-D).
///
/// The known ones must be in cyclic order. The result is unwrapped: strictly increasing, the last
/// less than one turn after the first.
pub fn complete(path: &[Axial], known: &FxHashMap<Axial, f64>, length: f64) -> Vec<f64> {
    let n = path.len();
    let first = path.iter().position(|p| known.contains_key(p));
    let Some(first) = first else {
        return (0..n).map(|i| length * i as f64 / n as f64).collect();
    };
    let origin = known[&path[first]];
    let mut parameters = vec![origin; n];
    let (mut last, mut last_parameter) = (0, origin);
    for k in 1..=n {
        let here = if k == n {
            origin + length
        } else {
            match known.get(&path[(first + k) % n]) {
                Some(&parameter) => origin + (parameter - origin).rem_euclid(length),
                None => continue,
            }
        };
        for j in last + 1..=k.min(n - 1) {
            let share = (j - last) as f64 / (k - last) as f64;
            parameters[(first + j) % n] = last_parameter + share * (here - last_parameter);
        }
        (last, last_parameter) = (k, here);
    }
    // Rotate the unwrapping to the start of the path.
    for parameter in &mut parameters[..first] {
        *parameter -= length;
    }
    parameters
}

/// A place where the drawn curve turns sharply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Arc length of the corner.
    pub arc: f64,
    /// Turning angle in radians, positive where the patch is convex.
    pub angle: f64,
}

/// The corners of a curve: points that turn by more than `angle` and by more than all others
/// within `separation` along the curve. Sharpest first.
///
/// `arcs` and `turning` belong to the curve's points; see
/// [`ClosedCurve::turning`](crate::drawing::curve::ClosedCurve::turning).
pub fn corners(arcs: &[f64], turning: &[f64], length: f64, angle: f64, separation: f64) -> Vec<Corner> {
    let mut found: Vec<Corner> = arcs
        .iter()
        .zip(turning)
        .filter(|(_, turn)| turn.abs() > angle)
        .map(|(&arc, &angle)| Corner { arc, angle })
        .collect();
    found.sort_by(|a, b| b.angle.abs().total_cmp(&a.angle.abs()).then(a.arc.total_cmp(&b.arc)));
    // Cells as long as the separation, or a little longer: only neighbours can be too near.
    let n = ((length / separation) as usize).clamp(1, found.len().max(1));
    let cell_of = |arc: f64| ((arc.rem_euclid(length) / length * n as f64) as usize).min(n - 1);
    let mut cells: Vec<Vec<f64>> = vec![Vec::new(); n];
    let mut kept: Vec<Corner> = Vec::new();
    for corner in found {
        let apart = |other: &f64| {
            let d = (corner.arc - other).rem_euclid(length);
            d.min(length - d) >= separation
        };
        let cell = cell_of(corner.arc);
        // Rounding may put a corner one cell aside.
        if (0..5).all(|k| cells[(cell + n * 2 + k - 2) % n].iter().all(apart)) {
            cells[cell].push(corner.arc);
            kept.push(corner);
        }
    }
    kept
}

/// How far boundary vertices move to sit on corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapping {
    /// At most so far along the curve, in the unit of the arc lengths.
    pub reach: f64,
    /// And so far from their neighbours, in shares of the mean spacing.
    pub room: f64,
}

/// Moves boundary vertices onto corners (section IV-C, figure 10). Returns the corners that get none.
///
/// The corners choose in their order, the sharpest first. A corner takes the nearer of the two vertices beside it that is
/// still free, if it is near enough and that leaves room to the vertex's neighbours. All lengths in the unit of
/// `arcs`, which are unwrapped. `angle` is the corner angle of each vertex, zero for those that are free, and is kept.
pub fn snap(
    arcs: &mut [f64],
    angle: &mut [f64],
    corners: &[Corner],
    length: f64,
    snapping: Snapping,
) -> Vec<Corner> {
    let n = arcs.len();
    let room = snapping.room * length / n as f64;
    let mut left = Vec::new();
    for &corner in corners {
        let at = arcs[0] + (corner.arc - arcs[0]).rem_euclid(length);
        let after = arcs.partition_point(|&s| s <= at);
        let mut beside = [after - 1, after % n];
        let place = |i: usize| {
            if i == 0 && at > arcs[n - 1] { at - length } else { at }
        };
        beside.sort_by(|&i, &j| (arcs[i] - place(i)).abs().total_cmp(&(arcs[j] - place(j)).abs()));
        let taken = beside.into_iter().find(|&i| {
            let to = place(i);
            let before = if i > 0 { arcs[i - 1] } else { arcs[n - 1] - length };
            let next = if i + 1 < n { arcs[i + 1] } else { arcs[0] + length };
            let is_near = (arcs[i] - to).abs() <= snapping.reach;
            angle[i] == 0.0 && is_near && to - before >= room && next - to >= room
        });
        match taken {
            Some(i) => (arcs[i], angle[i]) = (place(i), corner.angle),
            None => left.push(corner),
        }
    }
    left
}

/// Moves the boundary vertices before and after a place on the curve to either side of it, `back` away, if that keeps `room`
/// to their neighbours, in shares of the mean spacing. Returns them. Lengths as in [`snap`].
pub fn straddle(arcs: &mut [f64], arc: f64, length: f64, back: f64, room: f64) -> Option<[usize; 2]> {
    let n = arcs.len();
    let room = room * length / n as f64;
    let at = arcs[0] + (arc - arcs[0]).rem_euclid(length);
    let after = arcs.partition_point(|&s| s <= at);
    let lap = if after == n { length } else { 0.0 };
    let [i, j] = [after - 1, after % n];
    let before = if i > 0 { arcs[i - 1] } else { arcs[n - 1] - length };
    let next = lap + if j + 1 < n { arcs[j + 1] } else { arcs[0] + length };
    if n < 4 || at - back - before < room || next - at - back < room {
        return None;
    }
    (arcs[i], arcs[j]) = (at - back, at + back - lap);
    Some([i, j])
}

/// Indices of a longest strictly increasing subsequence; O(n log n).
fn longest_increasing(values: &[f64]) -> Vec<usize> {
    let mut ends: Vec<usize> = Vec::new();
    let mut before = vec![usize::MAX; values.len()];
    for (i, &value) in values.iter().enumerate() {
        let at = ends.partition_point(|&j| values[j] < value);
        if at > 0 {
            before[i] = ends[at - 1];
        }
        if at == ends.len() {
            ends.push(i);
        } else {
            ends[at] = i;
        }
    }
    let mut chain = Vec::with_capacity(ends.len());
    let mut at = ends.last().copied().unwrap_or(usize::MAX);
    while at != usize::MAX {
        chain.push(at);
        at = before[at];
    }
    chain.reverse();
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn longest_increasing_is_increasing_and_longest(values in prop::collection::vec(0u8..30, 0..12)) {
            let values: Vec<f64> = values.into_iter().map(f64::from).collect();
            let chain = longest_increasing(&values);
            prop_assert!(chain.windows(2).all(|w| w[0] < w[1] && values[w[0]] < values[w[1]]));
            let longest = (0u32..1 << values.len()).filter(|mask| {
                let picked: Vec<f64> = (0..values.len()).filter(|i| mask >> i & 1 == 1).map(|i| values[i]).collect();
                picked.windows(2).all(|w| w[0] < w[1])
            }).map(u32::count_ones).max();
            prop_assert_eq!(Some(chain.len() as u32), longest);
        }

        #[test]
        fn completed_parameters_increase_within_one_turn(
            n in 3usize..40,
            picks in prop::collection::vec((0usize..40, 0.0f64..100.0), 0..10),
            shift in 0usize..40,
        ) {
            let path: Vec<Axial> = (0..n as i32).map(|q| Axial::new(q, 0)).collect();
            let mut at: Vec<usize> = picks.iter().map(|p| p.0 % n).collect();
            at.sort_unstable();
            at.dedup();
            let mut s: Vec<f64> = picks.iter().map(|p| p.1).collect();
            s.sort_by(f64::total_cmp);
            s.dedup();
            let known: FxHashMap<Axial, f64> =
                at.iter().zip(&s).map(|(&i, &s)| (path[(i + shift) % n], s)).collect();
            let parameters = complete(&path, &known, 100.0);
            prop_assert!(parameters.windows(2).all(|w| w[0] < w[1]), "{:?}", parameters);
            prop_assert!(parameters[n - 1] < parameters[0] + 100.0);
            for (i, p) in path.iter().enumerate() {
                if let Some(s) = known.get(p) {
                    let d = (parameters[i] - s).rem_euclid(100.0);
                    prop_assert!(d.min(100.0 - d) < 1e-9);
                }
            }
        }
    }

    proptest! {
        #[test]
        fn corners_are_the_sharpest_apart(
            turns in prop::collection::vec((0.0f64..3.0, 0.01f64..2.0), 1..80),
            separation in 0.05f64..4.0,
        ) {
            let mut length = 0.0;
            let arcs: Vec<f64> = turns.iter().map(|t| { length += t.1; length - t.1 }).collect();
            let turning: Vec<f64> = turns.iter().map(|t| t.0).collect();
            let kept = corners(&arcs, &turning, length, 0.5, separation);
            let gap = |a: f64, b: f64| {
                let d = (a - b).rem_euclid(length);
                d.min(length - d)
            };
            let mut expected: Vec<Corner> = Vec::new();
            let mut found: Vec<Corner> =
                arcs.iter().zip(&turning).map(|(&arc, &angle)| Corner { arc, angle }).collect();
            found.sort_by(|a, b| b.angle.total_cmp(&a.angle).then(a.arc.total_cmp(&b.arc)));
            for corner in found.into_iter().filter(|corner| corner.angle > 0.5) {
                if expected.iter().all(|other| gap(corner.arc, other.arc) >= separation) {
                    expected.push(corner);
                }
            }
            prop_assert_eq!(kept, expected);
        }
    }

    #[test]
    fn snapped_vertices_sit_on_corners_and_keep_the_order() {
        let mut arcs: Vec<f64> = (0..20).map(|i| 0.5 + f64::from(i)).collect();
        let corners = [5.1, 5.4, 19.9, 0.35].map(|arc| Corner { arc, angle: 1.0 });
        let mut angle = vec![0.0; 20];
        let near = Snapping { reach: 1.0, room: 0.3 };
        let left = snap(&mut arcs, &mut angle, &corners, 20.0, near);
        assert!(arcs.windows(2).all(|w| w[0] < w[1]) && arcs[19] < arcs[0] + 20.0);
        assert!(arcs.contains(&5.1));
        assert!(angle.iter().filter(|&&a| a > 0.0).count() >= 3);
        assert_eq!(left.len() + angle.iter().filter(|&&a| a > 0.0).count(), 4);
    }

    #[test]
    fn vertices_straddle_a_place_where_their_neighbours_leave_room() {
        let even: Vec<f64> = (0..10).map(|i| 0.25 + f64::from(i)).collect();
        for (arc, pair) in [(4.5, [4, 5]), (0.1, [9, 0]), (9.9, [9, 0]), (0.3, [0, 1])] {
            let mut arcs = even.clone();
            assert_eq!(straddle(&mut arcs, arc, 10.0, 0.5, 0.15), Some(pair));
            assert!(arcs.windows(2).all(|w| w[0] < w[1]) && arcs[9] < arcs[0] + 10.0);
            let [d, e] = pair.map(|v| (arcs[v] - arc + 5.0).rem_euclid(10.0) - 5.0);
            assert!((d + 0.5).abs() < 1e-12 && (e - 0.5).abs() < 1e-12, "{arc} {d} {e}");
        }
        let mut bunched = [0.0, 2.0, 4.4, 4.6, 5.3, 5.5, 8.0];
        assert_eq!(straddle(&mut bunched, 5.0, 10.0, 0.5, 0.15), None);
    }

    #[test]
    fn corners_that_are_left_take_vertices_that_are_farther_away_or_nearer_together() {
        // Vertices bunch at 5, and none is near 12.
        let bunched = [0.0, 2.0, 4.8, 5.1, 5.3, 7.0, 9.0, 15.5, 18.0];
        let corners = [5.0, 12.0].map(|arc| Corner { arc, angle: 1.0 });
        let (mut arcs, mut angle) = (bunched.to_vec(), vec![0.0; 9]);
        let left = snap(&mut arcs, &mut angle, &corners, 20.0, Snapping { reach: 1.5, room: 0.3 });
        assert_eq!((left.as_slice(), arcs.as_slice()), (&corners[..], &bunched[..]));
        let left = snap(&mut arcs, &mut angle, &left, 20.0, Snapping { reach: 4.0, room: 0.05 });
        assert!(left.is_empty() && arcs.windows(2).all(|w| w[0] < w[1]));
        assert_eq!((arcs[3], arcs[6], angle[3], angle[6]), (5.0, 12.0, 1.0, 1.0));
    }
}
