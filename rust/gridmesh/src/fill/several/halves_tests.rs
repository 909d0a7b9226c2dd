use std::collections::BTreeMap;

use super::*;

/// A flat ring between two loops of large triangles, `n` and `m` of them, after which come `n` new vertices between.
fn ring(halves: &Halves) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (n, m) = (halves.loops.range(0).len(), halves.loops.range(1).len());
    let mut positions = vec![];
    for (count, radius, way) in [(n, 3.0, 1.0), (m, 1.0, -1.0), (n, 2.0, 1.0)] {
        for k in 0..count {
            let t = way * std::f64::consts::TAU * k as f64 / count as f64;
            positions.push(DVec3::new(radius * t.cos(), radius * t.sin(), 0.0));
        }
    }
    let mut triangles = vec![];
    let middle = |k: usize| (n + m + k % n) as u32;
    let inner = |k: usize| (n + (m - k % m) % m) as u32;
    for k in 0..n {
        let outer = |k: usize| (k % n) as u32;
        triangles.extend([[outer(k), outer(k + 1), middle(k)], [outer(k + 1), middle(k + 1), middle(k)]]);
    }
    let (mut i, mut j) = (0, 0);
    while i < n || j < m {
        if j == m || (i < n && i * m <= j * n) {
            triangles.push([middle(i), middle(i + 1), inner(j)]);
            i += 1;
        } else {
            triangles.push([middle(i), inner(j + 1), inner(j)]);
            j += 1;
        }
    }
    (positions, triangles)
}

fn circle(n: usize, radius: f64, way: f64) -> impl Iterator<Item = DVec3> {
    let angle = move |k: usize| way * std::f64::consts::TAU * k as f64 / n as f64;
    (0..n).map(move |k| DVec3::new(radius * angle(k).cos(), radius * angle(k).sin(), 0.0))
}

fn cut(n: usize, m: usize) -> (usize, Quads) {
    let at = circle(n, 3.0, 1.0).chain(circle(m, 1.0, -1.0)).collect::<Vec<_>>();
    let room = vec![2.0; n + m];
    let halves = Halves::new(Loops::new([n, m].into_iter()), &at, &room);
    let (positions, triangles) = ring(&halves);
    let taken = FxHashSet::default();
    let quads = halves.cut(&at, &room, &positions, &triangles, &taken, Progress::NONE).unwrap().unwrap();
    (n + m, quads)
}

#[test]
fn loops_of_any_counts_are_quads_with_one_triangle_for_odd_sums() {
    for n in [3, 4, 5, 6, 7, 8, 20, 31] {
        for m in [3, 4, 5, 6, 7, 12, 15] {
            let (loops, made) = cut(n, m);
            assert_eq!(usize::from(made.odd.is_some()), (n + m) % 2, "{n} {m}");
            let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
            let faces = made.quads.iter().map(|q| q.to_vec()).chain(made.odd.iter().map(|t| t.to_vec()));
            let faces = faces.collect::<Vec<_>>();
            for face in &faces {
                for k in 0..face.len() {
                    *sides.entry([face[k], face[(k + 1) % face.len()]]).or_default() += 1;
                }
            }
            assert!(sides.values().all(|&uses| uses == 1), "{n} {m}: wound against a neighbour");
            let mut open =
                sides.keys().filter(|[a, b]| !sides.contains_key(&[*b, *a])).copied().collect::<Vec<_>>();
            open.sort_unstable();
            let following = |v: usize| if v < n { (v + 1) % n } else { n + (v + 1 - n) % m };
            let rims = (0..loops).map(|v| [v as u32, following(v) as u32]).collect::<Vec<_>>();
            assert_eq!(open, rims, "{n} {m}");
            let edges = (sides.len() + loops) / 2;
            assert_eq!(made.positions.len() + faces.len(), edges, "{n} {m}: not an annulus");
            assert!(made.positions.iter().all(|p| p.is_finite()));
        }
    }
}

#[test]
fn pairs_leave_few_poles() {
    let (loops, made) = cut(40, 40);
    let mut faces = vec![0; made.positions.len()];
    made.quads.iter().flatten().for_each(|&v| faces[v as usize] += 1);
    let poles = faces[loops..].iter().filter(|&&at| at != 4).count();
    assert!(poles <= 4, "{poles}");
    assert!(faces[..loops].iter().filter(|&&at| at != 2).count() <= 4);
}
