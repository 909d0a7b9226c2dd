//! Checks and measures of triangle meshes.

use glam::DVec3;

use super::disjoint::Disjoint;

/// What [`check_mesh`] found out about a triangle mesh's connections.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshCheck {
    /// True if every edge joins exactly two triangles, wound alike, the triangles around each
    /// vertex form one closed fan, and no triangle repeats a vertex.
    pub watertight: bool,
    /// Edges of one triangle.
    pub boundary_edges: usize,
    /// Edges of more than two triangles, or of two that are wound against each other.
    pub bad_edges: usize,
    /// Used vertices whose triangles do not form one fan, open or closed.
    pub bad_vertices: usize,
    /// Triangles that repeat a vertex or name one that does not exist.
    pub bad_triangles: usize,
    /// Connected pieces.
    pub components: usize,
    /// Boundary curves.
    pub boundaries: usize,
    /// Vertices (used ones) minus edges plus triangles.
    pub euler: i64,
    /// Sum of the pieces' genera (handles). Meaningful if nothing is bad.
    pub genus: i32,
    /// Vertices of valence other than six; on a boundary, other than four.
    pub irregular: usize,
}

/// Checks how `triangles` over `n_vertices` vertices are connected. Linear in the mesh's size (and
/// quadratic in the valence).
pub fn check_mesh(n_vertices: usize, triangles: &[[u32; 3]]) -> MeshCheck {
    let mut check = MeshCheck::default();
    let sound = |t: &[u32; 3]| {
        t.iter().all(|&v| (v as usize) < n_vertices) && t[0] != t[1] && t[1] != t[2] && t[2] != t[0]
    };
    check.bad_triangles = triangles.iter().filter(|t| !sound(t)).count();
    let wedges = Wedges::new(n_vertices, triangles.iter().filter(|t| sound(t)));
    let mut pieces = Disjoint::new(n_vertices);
    let mut next_boundary = vec![u32::MAX; n_vertices];
    let (mut used, mut edges) = (0i64, 0i64);
    for v in 0..n_vertices as u32 {
        let fan = wedges.around(v);
        if fan.is_empty() {
            continue;
        }
        used += 1;
        let leaving = |u: u32| fan.iter().filter(|w| w.0 == u).count();
        let arriving = |u: u32| fan.iter().filter(|w| w.1 == u).count();
        let (mut valence, mut open) = (0, false);
        // Every neighbour once: those that leave, then those that only arrive.
        let firsts =
            fan.iter().enumerate().filter(|(i, w)| fan[..*i].iter().all(|x| x.0 != w.0)).map(|(_, w)| w.0);
        let lasts = fan
            .iter()
            .enumerate()
            .filter(|(i, w)| leaving(w.1) == 0 && fan[..*i].iter().all(|x| x.1 != w.1))
            .map(|(_, w)| w.1);
        for u in firsts.chain(lasts) {
            valence += 1;
            pieces.join(v, u);
            let (out, back) = (leaving(u), arriving(u));
            let single = out + back == 1;
            open |= single;
            if single && out == 1 {
                next_boundary[v as usize] = u;
            }
            if v < u {
                edges += 1;
                check.boundary_edges += usize::from(single);
                check.bad_edges += usize::from(out > 1 || back > 1);
            }
        }
        check.irregular += usize::from(valence != if open { 4 } else { 6 });
        check.bad_vertices += usize::from(!is_fan(fan));
    }
    for v in 0..n_vertices {
        check.components +=
            usize::from(!wedges.around(v as u32).is_empty() && pieces.root(v as u32) == v as u32);
        let mut at = v;
        while next_boundary[at] != u32::MAX {
            let next = next_boundary[at] as usize;
            next_boundary[at] = u32::MAX;
            check.boundaries += usize::from(next == v);
            at = next;
        }
    }
    check.euler = used - edges + triangles.len() as i64 - check.bad_triangles as i64;
    check.genus = (check.components as i64 - (check.euler + check.boundaries as i64).div_euclid(2)) as i32;
    check.watertight = !triangles.is_empty()
        && check.boundary_edges == 0
        && check.bad_edges == 0
        && check.bad_vertices == 0
        && check.bad_triangles == 0;
    check
}

/// The triangles around each vertex as pairs of their other corners: next, previous.
struct Wedges {
    start: Vec<u32>,
    pairs: Vec<(u32, u32)>,
}

impl Wedges {
    fn new<'a>(n_vertices: usize, triangles: impl Iterator<Item = &'a [u32; 3]> + Clone) -> Self {
        let mut start = vec![0u32; n_vertices + 1];
        for v in triangles.clone().flatten() {
            start[*v as usize + 1] += 1;
        }
        for v in 0..n_vertices {
            start[v + 1] += start[v];
        }
        let mut fill = start.clone();
        let mut pairs = vec![(0u32, 0u32); start[n_vertices] as usize];
        for t in triangles {
            for k in 0..3 {
                let slot = &mut fill[t[k] as usize];
                pairs[*slot as usize] = (t[(k + 1) % 3], t[(k + 2) % 3]);
                *slot += 1;
            }
        }
        Self { start, pairs }
    }

    fn around(&self, v: u32) -> &[(u32, u32)] {
        &self.pairs[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }
}

/// True if a walk from wedge to wedge, from the open end if there is one, meets all of them.
fn is_fan(wedges: &[(u32, u32)]) -> bool {
    let is_first = |w: &&(u32, u32)| wedges.iter().all(|x| x.1 != w.0);
    let begin = wedges.iter().find(is_first).unwrap_or(&wedges[0]).0;
    let (mut at, mut steps) = (begin, 0);
    while let Some(wedge) = wedges.iter().find(|w| w.0 == at) {
        at = wedge.1;
        steps += 1;
        if at == begin || steps > wedges.len() {
            break;
        }
    }
    steps == wedges.len()
}

/// Signed volume within a closed mesh; positive if its triangles face outward.
pub fn volume(vertices: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let Some(&origin) = vertices.first() else { return 0.0 };
    let six_fold: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| vertices[v as usize] - origin);
            a.dot(b.cross(c))
        })
        .sum();
    six_fold / 6.0
}

/// Smallest angle of any triangle, in radians; zero if one is degenerate.
pub fn min_angle(vertices: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    // The smallest angle of a triangle faces its shortest edge; the largest tangent wins cheaply.
    let mut largest_cotangent: f64 = f64::NEG_INFINITY;
    for t in triangles {
        let [a, b, c] = t.map(|v| vertices[v as usize]);
        let area = (b - a).cross(c - a).length();
        let dots = [(b - a).dot(c - a), (c - b).dot(a - b), (a - c).dot(b - c)];
        let largest = dots[0].max(dots[1]).max(dots[2]);
        largest_cotangent = largest_cotangent.max(if area > 0.0 { largest / area } else { f64::INFINITY });
    }
    if triangles.is_empty() { 0.0 } else { libm::atan2(1.0, largest_cotangent) }
}

/// The angle between the normals of the two triangles of each inner edge, in radians, with the
/// edge's vertices in ascending order; sorted by edge. Edges of one or of more than two triangles
/// are left out.
pub fn face_angles(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Vec<([u32; 2], f64)> {
    let normals = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| vertices[v as usize]);
            (b - a).cross(c - a).normalize_or_zero()
        })
        .collect::<Vec<_>>();
    let mut sides = vec![];
    for (index, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            sides.push(([a.min(b), a.max(b)], index));
        }
    }
    sides.sort_unstable();
    sides
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|pair| pair.len() == 2)
        .map(|pair| {
            let (n, m) = (normals[pair[0].1], normals[pair[1].1]);
            (pair[0].0, libm::atan2(n.cross(m).length(), n.dot(m)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn a_tetrahedron_is_watertight() {
        let check = check_mesh(4, &TETRAHEDRON);
        assert!(check.watertight, "{check:?}");
        assert_eq!((check.euler, check.genus, check.components, check.irregular), (2, 0, 1, 4));
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert!((volume(&vertices, &TETRAHEDRON) - 1.0 / 6.0).abs() < 1e-15);
        assert!((min_angle(&vertices, &TETRAHEDRON) - std::f64::consts::FRAC_PI_4).abs() < 1e-12);
        let angles = face_angles(&vertices, &TETRAHEDRON);
        assert_eq!(angles.len(), 6);
        assert!((angles[0].1 - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn defects_are_found() {
        let open = check_mesh(4, &TETRAHEDRON[1..]);
        assert!(!open.watertight);
        assert_eq!((open.boundary_edges, open.boundaries, open.genus), (3, 1, 0));
        let mut flipped = TETRAHEDRON;
        flipped[2].swap(0, 1);
        assert!(check_mesh(4, &flipped).bad_edges == 3);
        // Two tetrahedra that share one vertex, or lie apart.
        let pinched = TETRAHEDRON.iter().map(|t| t.map(|v| if v == 0 { 0 } else { v + 3 }));
        let check = check_mesh(7, &TETRAHEDRON.into_iter().chain(pinched).collect::<Vec<_>>());
        assert_eq!((check.watertight, check.bad_vertices, check.components), (false, 1, 1));
        let apart = TETRAHEDRON.iter().map(|t| t.map(|v| v + 4));
        let check = check_mesh(8, &TETRAHEDRON.into_iter().chain(apart).collect::<Vec<_>>());
        assert_eq!((check.watertight, check.genus, check.components), (true, 0, 2));
        assert!(!check_mesh(3, &[[0, 1, 3]]).watertight);
        assert!(!check_mesh(3, &[]).watertight);
    }

    #[test]
    fn a_torus_has_genus_one() {
        let n = 5u32;
        let at = |i: u32, j: u32| (i % n) * n + j % n;
        let mut triangles = vec![];
        for i in 0..n {
            for j in 0..n {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        let check = check_mesh((n * n) as usize, &triangles);
        assert_eq!((check.watertight, check.genus, check.irregular), (true, 1, 0));
    }
}
