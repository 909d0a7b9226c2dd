use super::*;
use crate::geometry::metrics::check_mesh;

/// A grid of triangles whose border is fixed.
pub fn sheet(n: u32) -> Local {
    let inside = |i: u32, j: u32| i > 0 && j > 0 && i < n && j < n;
    let all = || (0..=n).flat_map(move |i| (0..=n).map(move |j| (i, j)));
    let order = all().filter(|&(i, j)| !inside(i, j)).chain(all().filter(|&(i, j)| inside(i, j)));
    let order = order.collect::<Vec<_>>();
    let number = |p: (u32, u32)| order.iter().position(|&q| q == p).unwrap() as u32;
    let mut triangles = vec![];
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(number);
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let positions = order.iter().map(|&(i, j)| DVec3::new(f64::from(i), f64::from(j), 0.0)).collect();
    let sides = vec![0; triangles.len()];
    let mut local = Local::new(positions, triangles, sides, 4 * n as usize);
    local.sizes.fill(1.0);
    local
}

fn is_disk(local: &Local) -> bool {
    let mut copy = local.clone();
    copy.compact();
    let check = check_mesh(copy.positions.len(), &copy.triangles);
    (check.bad_edges, check.bad_vertices, check.euler, check.boundaries) == (0, 0, 1, 1)
}

#[test]
fn edits_keep_a_disk_with_its_border() {
    let mut local = sheet(5);
    let mut state = 7u64;
    let (mut split, mut collapsed, mut flipped) = (0, 0, 0);
    for _ in 0..600 {
        let edges = local.edges();
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let [a, b] = edges[(state >> 33) as usize % edges.len()];
        match (state >> 20) % 3 {
            0 if !local.is_border([a, b]) && edges.len() < 200 => {
                local.split([a, b]);
                split += 1;
            }
            1 => collapsed += usize::from(local.collapse(b, a, 9.0)),
            _ => {
                let upright = |t: &[u32; 3]| {
                    let [a, b, c] = t.map(|v| local.positions[v as usize]);
                    (b - a).cross(c - a).z > 1e-9
                };
                if let Some((old, new)) = local.flipped([a, b]).filter(|f| f.1.iter().all(upright)) {
                    local.flip(old, new);
                    flipped += 1;
                }
            }
        }
    }
    assert!(split > 20 && collapsed > 20 && flipped > 20, "{split} {collapsed} {flipped}");
    assert!(is_disk(&local));
}

#[test]
fn hard_lines_are_split_and_collapsed_along_themselves() {
    let mut local = sheet(4);
    let at = |local: &Local, x: f64, y: f64| {
        local.positions.iter().position(|p| *p == DVec3::new(x, y, 0.0)).unwrap() as u32
    };
    let line = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| at(&local, x, 2.0));
    local.hard.extend(line.windows(2).map(|w| edge(w[0], w[1])));
    let above = at(&local, 2.0, 3.0);
    assert!(local.flipped(edge(line[1], line[2])).is_none());
    assert!(!local.collapse(line[2], above, 9.0));
    local.split(edge(line[1], line[2]));
    assert_eq!(local.hard.len(), 5);
    assert!(local.collapse(line[2], line[3], 9.0));
    assert_eq!(local.hard.len(), 4);
    local.compact();
    assert!(local.hard.iter().flatten().all(|&v| local.positions[v as usize].y == 2.0));
    assert!(is_disk(&local));
}

/// A sheet with the vertices at the given places moved.
fn moved(n: u32, places: &[([f64; 2], [f64; 2])]) -> (Local, Vec<u32>) {
    let mut local = sheet(n);
    let found = |&([x, y], _): &([f64; 2], _)| {
        local.positions.iter().position(|p| *p == DVec3::new(x, y, 0.0)).unwrap()
    };
    let which = places.iter().map(found).collect::<Vec<_>>();
    for (&v, (_, [x, y])) in which.iter().zip(places) {
        local.positions[v] = DVec3::new(*x, *y, 0.0);
    }
    (local, which.into_iter().map(|v| v as u32).collect())
}

#[test]
fn knots_become_one_where_they_are_close_along_a_line() {
    for (apart, merges, may) in [(0.25, true, true), (0.25, false, false), (0.5, true, false)] {
        let places = [([2.0, 2.0], [2.0, 2.0]), ([3.0, 2.0], [2.0 + apart, 2.0]), ([3.0, 3.0], [3.0, 3.0])];
        let (mut local, v) = moved(5, &places);
        local.merges = merges;
        local.sizes.fill(1.0);
        local.hard.extend([edge(v[0], v[1]), edge(v[1], v[2])]);
        local.knots.extend([v[0], v[1]]);
        assert_eq!(local.collapse(v[1], v[0], 9.0), may, "{apart} {merges}");
        if may {
            assert!(local.hard.contains(&edge(v[0], v[2])) && !local.knots.contains(&v[1]));
            assert!(is_disk(&local));
        }
    }
}

#[test]
fn lines_that_are_as_good_as_the_same_become_one() {
    for (apart, may) in [(0.05, true), (0.6, false)] {
        // Two ways from one vertex to another one, around one triangle on each side.
        let places = [([2.0, 2.0], [2.0, 2.0]), ([3.0, 3.0], [3.0 - apart / 2.0, 2.0 + apart])];
        let (mut local, v) = moved(6, &places);
        let at = |x, y| local.positions.iter().position(|p| *p == DVec3::new(x, y, 0.0)).unwrap() as u32;
        let (side, end) = (at(3.0, 2.0), at(4.0, 3.0));
        local.sizes.fill(1.0);
        local.hard.extend([edge(v[0], side), edge(side, end), edge(v[0], v[1]), edge(v[1], end)]);
        assert_eq!(local.collapse(v[1], side, 9.0), may, "{apart}");
        if may {
            assert_eq!(local.hard.len(), 2);
            assert!(is_disk(&local));
        }
    }
}
