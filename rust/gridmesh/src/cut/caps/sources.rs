//! Which vertex of the rim a vertex inside a cap gets its data from.

use std::collections::VecDeque;

use glam::DVec2;

/// For each vertex of a patch after its first `n`, which are its rim, a vertex of the rim near it: handed on from
/// neighbour to neighbour, the nearest of those on offer. 0 for vertices without triangles. Linear.
pub(in crate::cut) fn nearest_on_rim(n: usize, positions: &[DVec2], triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut starts = vec![0u32; positions.len() + 1];
    for &v in triangles.iter().flatten() {
        starts[v as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut filled = starts.clone();
    let mut around = vec![0u32; 3 * triangles.len()];
    for (t, &v) in triangles.iter().enumerate().flat_map(|(t, corners)| corners.iter().map(move |v| (t, v))) {
        around[filled[v as usize] as usize] = t as u32;
        filled[v as usize] += 1;
    }
    let neighbours = |v: u32| {
        let own = starts[v as usize] as usize..starts[v as usize + 1] as usize;
        around[own].iter().flat_map(|&t| triangles[t as usize]).filter(move |&w| w != v)
    };
    let mut near: Vec<Option<u32>> = (0..positions.len()).map(|v| (v < n).then_some(v as u32)).collect();
    let mut queue: VecDeque<u32> = (0..n as u32).collect();
    while let Some(v) = queue.pop_front() {
        for w in neighbours(v) {
            if near[w as usize].is_some() {
                continue;
            }
            let p = positions[w as usize];
            let off = |rim: u32| positions[rim as usize].distance_squared(p);
            near[w as usize] = neighbours(w)
                .filter_map(|x| near[x as usize])
                .min_by(|&a, &b| off(a).total_cmp(&off(b)).then(a.cmp(&b)));
            queue.push_back(w);
        }
    }
    near[n.min(positions.len())..].iter().map(|near| near.unwrap_or(0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_vertex_gets_one_of_the_nearest() {
        // A square of 20 by 20 cells, its rim first.
        let k = 20i32;
        let is_rim = |i: i32, j: i32| i == 0 || j == 0 || i == k || j == k;
        let all = (0..=k).flat_map(|i| (0..=k).map(move |j| (i, j)));
        let (mut cells, inner): (Vec<_>, Vec<_>) = all.partition(|&(i, j)| is_rim(i, j));
        let n = cells.len();
        cells.extend(inner);
        let at = |i, j| cells.iter().position(|&c| c == (i, j)).unwrap() as u32;
        let squares = (0..k).flat_map(|i| (0..k).map(move |j| (i, j)));
        let triangles = squares.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        let triangles = triangles.collect::<Vec<_>>();
        let positions =
            cells.iter().map(|&(i, j)| DVec2::new(f64::from(i), f64::from(j))).collect::<Vec<_>>();
        let near = nearest_on_rim(n, &positions, &triangles);
        assert_eq!(near.len(), cells.len() - n);
        for (p, &rim) in positions[n..].iter().zip(&near) {
            let best = positions[..n].iter().map(|q| q.distance(*p)).fold(f64::INFINITY, f64::min);
            assert!(positions[rim as usize].distance(*p) <= 1.5 * best);
        }
    }
}
