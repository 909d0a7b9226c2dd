//! Boundary edges of triangles split where a drawing still reaches beyond them: a finer mesh would have many times the triangles.

use glam::DVec2;

use crate::cover::needs_of;
use crate::cover::outside::Followers;
use crate::geometry::segments::segments_meet;
use crate::patch::Patch;

/// Splits and moves at most, for each contour.
const MOST: usize = 64;

/// Splits for each edge of a contour, if that is less.
const EACH: f64 = 0.25;

/// The shortest edge that may come of one, in mean lengths of the patch's edges: a third shows in a texture.
const SHORT: f64 = 0.36;

/// Cotangent of the least angle, 14 degrees, of the triangles that come of one.
const THINNEST: f64 = 4.010_780_933_535_845;

/// Splits boundary edges at points of the contours that are farther outside than `beyond`, besides the slack, the farthest first, and moves
/// ends of edges to such points, as far as no triangle becomes thin, no edge short and no edges meet by that; keeps what is best of it.
pub(super) fn taken_in(
    patch: &mut Patch,
    fine: &[Vec<DVec2>],
    followers: &mut [Followers],
    (slack, beyond): (f64, f64),
) {
    if patch.triangles.is_empty() {
        return;
    }
    for k in 0..fine.len() {
        let farthest = |patch: &Patch, follow: &Followers| {
            needs_of(patch, k, &fine[k], follow, slack).into_iter().fold(0.0, f64::max)
        };
        let mut best = (farthest(patch, &followers[k]), patch.clone(), followers[k].clone());
        if best.0 <= beyond {
            continue;
        }
        let shortest = SHORT * mean_edge(patch);
        let most = ((EACH * patch.loops[k].len() as f64) as usize).clamp(1, MOST);
        let mut tried = vec![false; fine[k].len()];
        let mut done = 0;
        while done < most {
            let needs = needs_of(patch, k, &fine[k], &followers[k], slack);
            let open = (0..needs.len()).filter(|&at| !tried[at] && needs[at] > beyond);
            let Some(at) = open.max_by(|&i, &j| needs[i].total_cmp(&needs[j]).then(j.cmp(&i))) else { break };
            tried[at] = true;
            let Some(edge) = followers[k].edge(at) else { continue };
            if !split(patch, (k, edge), fine[k][at], shortest) {
                if !moved(patch, (k, edge), fine[k][at], shortest) {
                    continue;
                }
            } else {
                followers[k].split(edge, at);
            }
            done += 1;
            let now = farthest(patch, &followers[k]);
            if now < best.0 {
                best = (now, patch.clone(), followers[k].clone());
            }
        }
        (_, *patch, followers[k]) = best;
    }
}

/// Splits an edge of a loop at a new vertex; false if that makes no good triangles.
fn split(patch: &mut Patch, (k, edge): (usize, usize), point: DVec2, shortest: f64) -> bool {
    let (start, n) = (patch.loops[k].start as usize, patch.loops[k].len());
    let next = (edge + 1) % n;
    let [a, b] = [start + edge, start + next].map(|v| v as u32);
    let Some((at, apex)) = patch.triangles.iter().enumerate().find_map(|(at, triangle)| {
        (0..3).find(|&i| triangle[i] == a && triangle[(i + 1) % 3] == b).map(|i| (at, triangle[(i + 2) % 3]))
    }) else {
        return false;
    };
    let [from, to, inner] = [a, b, apex].map(|v| patch.vertices[v as usize]);
    let is_long = [from, to, inner].iter().all(|end| end.distance(point) >= shortest);
    if !is_long || cotangent([from, point, inner]).max(cotangent([point, to, inner])) > THINNEST {
        return false;
    }
    if meets(patch, [from, point], &[a, b]) || meets(patch, [point, to], &[a, b]) {
        return false;
    }
    // The new vertex comes after the first end.
    let new = a + 1;
    let shifted = |v: u32| if v >= new { v + 1 } else { v };
    for triangle in &mut patch.triangles {
        *triangle = triangle.map(shifted);
    }
    let (b, apex) = (shifted(b), shifted(apex));
    patch.triangles[at] = [a, new, apex];
    patch.triangles.push([new, b, apex]);
    patch.vertices.insert(new as usize, point);
    for contour in &mut patch.loops[k + 1..] {
        contour.start += 1;
    }
    let contour = &mut patch.loops[k];
    let (low, high) = (contour.arc[edge], contour.arc[next]);
    let span = if high > low { high - low } else { high - low + contour.length };
    contour.arc.insert(edge + 1, low + 0.5 * span);
    contour.source.insert(edge + 1, contour.source[edge]);
    contour.corner.insert(edge + 1, 0.0);
    true
}

/// Moves the nearer end of an edge to a point; false if that makes no good triangles.
fn moved(patch: &mut Patch, (k, edge): (usize, usize), point: DVec2, shortest: f64) -> bool {
    let (start, n) = (patch.loops[k].start as usize, patch.loops[k].len());
    let ends = [edge, (edge + 1) % n];
    let away = |i: usize| patch.vertices[start + i].distance_squared(point);
    let own = if away(ends[0]) <= away(ends[1]) { ends[0] } else { ends[1] };
    let vertex = start + own;
    let beside = [start + (own + n - 1) % n, start + (own + 1) % n].map(|v| v as u32);
    let before = std::mem::replace(&mut patch.vertices[vertex], point);
    let at = |v: u32| patch.vertices[v as usize];
    let around = patch.triangles.iter().filter(|triangle| triangle.contains(&(vertex as u32)));
    let is_good = around.into_iter().all(|triangle| {
        let far = |&v: &u32| v == vertex as u32 || at(v).distance(point) >= shortest;
        triangle.iter().all(far) && cotangent(triangle.map(at)) <= THINNEST
    });
    let is_simple = || beside.iter().all(|&other| !meets(patch, [point, at(other)], &[vertex as u32, other]));
    if is_good && is_simple() {
        return true;
    }
    patch.vertices[vertex] = before;
    false
}

/// Whether a segment meets a boundary edge that has none of these vertices.
fn meets(patch: &Patch, segment: [DVec2; 2], but: &[u32]) -> bool {
    let [low, high] = [segment[0].min(segment[1]), segment[0].max(segment[1])];
    patch.loops.iter().any(|contour| {
        let (start, n) = (contour.start, contour.len() as u32);
        (0..n).any(|i| {
            let ends = [start + i, start + (i + 1) % n];
            if ends.iter().any(|v| but.contains(v)) {
                return false;
            }
            let [a, b] = ends.map(|v| patch.vertices[v as usize]);
            let is_near = a.min(b).cmple(high).all() && a.max(b).cmpge(low).all();
            is_near && segments_meet(segment, [a, b])
        })
    })
}

/// Cotangent of the least angle of a triangle; infinite if it is turned over.
fn cotangent([a, b, c]: [DVec2; 3]) -> f64 {
    let doubled = (b - a).perp_dot(c - a);
    if doubled <= 0.0 {
        return f64::INFINITY;
    }
    (b - a).dot(c - a).max((c - b).dot(a - b)).max((a - c).dot(b - c)) / doubled
}

fn mean_edge(patch: &Patch) -> f64 {
    let (sum, count) = patch.sides().fold((0.0, 0usize), |(sum, count), [a, b]| {
        (sum + patch.vertices[a as usize].distance(patch.vertices[b as usize]), count + 1)
    });
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::f64::consts::TAU;

    use super::*;
    use crate::cover::followers_of;
    use crate::options::SketchOptions;
    use crate::progress::Progress;
    use crate::sketch::mesh_sketch;

    /// A disk with thin spikes, and a hole; dense points of both.
    fn spiked(spikes: usize) -> Vec<Vec<DVec2>> {
        let point = |k: usize| {
            let turn = k as f64 / 200.0;
            let tip = (1.0 - (2.0 * (turn - turn.round())).abs() * 6.0).max(0.0);
            (1.0 + 0.3 * tip) * DVec2::from_angle(TAU * turn / spikes as f64)
        };
        let ring = |n: usize, radius: f64| {
            (0..n).map(move |k| radius * DVec2::from_angle(TAU * k as f64 / n as f64))
        };
        vec![(0..200 * spikes).map(point).collect(), ring(120, 0.4).collect()]
    }

    #[test]
    fn tips_are_taken_in_by_triangles_that_are_sound() {
        for (spikes, triangles) in [(5, 200), (5, 400), (7, 100), (7, 200)] {
            let fine = spiked(spikes);
            let options = SketchOptions { triangles: Some(triangles), ..SketchOptions::default() };
            let mut patch = mesh_sketch(&fine[0], &fine[1..], &options, Progress::NONE).unwrap().patch;
            let mut followers = followers_of(&patch, &fine);
            let outside = |patch: &Patch, followers: &[Followers]| {
                let needs = (0..2).flat_map(|k| needs_of(patch, k, &fine[k], &followers[k], 0.0));
                needs.fold(0.0, f64::max)
            };
            let (before, plain) = (outside(&patch, &followers), patch.clone());
            let shortest = SHORT * mean_edge(&patch);
            taken_in(&mut patch, &fine, &mut followers, (0.0, 0.01));
            let after = outside(&patch, &followers);
            assert!(after < 0.5 * before, "{spikes} spikes: {before} and {after}");
            // One vertex, one triangle and one boundary edge more for each split.
            let splits = patch.vertices.len() - plain.vertices.len();
            assert!(splits > 0);
            assert_eq!(patch.triangles.len(), plain.triangles.len() + splits);
            assert_eq!(
                patch.loops.iter().map(|own| own.len()).sum::<usize>(),
                plain.loops.iter().map(|own| own.len()).sum::<usize>() + splits
            );
            check(&patch, &plain, shortest);
        }
    }

    /// Every triangle that is not of the patch before is well shaped, each loop is the boundary, and its arc lengths rise.
    fn check(patch: &Patch, before: &Patch, shortest: f64) {
        let mut sides: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for triangle in &patch.triangles {
            let corners = triangle.map(|v| patch.vertices[v as usize]);
            let is_new = corners.map(|corner| !before.vertices.contains(&corner));
            assert!(cotangent(corners) <= if is_new.contains(&true) { THINNEST } else { f64::MAX });
            for i in 0..3 {
                let [a, b] = [triangle[i], triangle[(i + 1) % 3]];
                *sides.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
                let length = corners[i].distance(corners[(i + 1) % 3]);
                assert!(!(is_new[i] || is_new[(i + 1) % 3]) || length >= shortest, "{length}");
            }
        }
        let rim = sides.values().filter(|&&uses| uses != 0).count();
        assert_eq!(rim, patch.loops.iter().map(|own| own.len()).sum::<usize>());
        for own in &patch.loops {
            let n = own.len() as u32;
            for i in 0..n {
                let [a, b] = [own.start + i, own.start + (i + 1) % n];
                assert_ne!(sides[&[a.min(b), a.max(b)]], 0);
            }
            let falls =
                (0..own.arc.len()).filter(|&i| own.arc[i] >= own.arc[(i + 1) % own.arc.len()]).count();
            assert_eq!(falls, 1, "arc lengths");
            assert_eq!([own.arc.len(), own.source.len(), own.corner.len()], [own.len(); 3]);
        }
    }

    #[test]
    fn what_covers_enough_stays_as_it_is() {
        let fine = spiked(5);
        let options = SketchOptions { triangles: Some(200), ..SketchOptions::default() };
        let mut patch = mesh_sketch(&fine[0], &fine[1..], &options, Progress::NONE).unwrap().patch;
        let (before, mut followers) = (patch.clone(), followers_of(&patch, &fine));
        taken_in(&mut patch, &fine, &mut followers, (0.0, 1.0));
        assert_eq!((patch.vertices, patch.triangles), (before.vertices, before.triangles));
    }
}
