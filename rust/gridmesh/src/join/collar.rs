//! Which faces go: all near the lines where surfaces meet.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use super::options::JoinOptions;
use super::parts::Parts;
use super::union::Union;
use crate::fill::even::nearest::Lines;
use crate::geometry::disjoint::Disjoint;
use crate::geometry::topology::NONE;

/// Faces go that have a vertex nearer to the line than this, in edge lengths, however narrow the blend is: the patch needs room.
const LEAST: f64 = 0.45;

/// What is left of a face's size beyond the vertices that go, in edge lengths: so much less is measured to vertices.
const HALF: f64 = 0.5;

/// The lines where surfaces meet.
pub(super) struct Curves {
    /// Their edges.
    lines: Lines,
    /// The mean edge length of each solid near each curve.
    lengths: Vec<BTreeMap<usize, f64>>,
    /// How many there are; those that branch with all their branches.
    pub count: usize,
    /// The curve of each seam.
    pub seams: Vec<usize>,
}

/// What the union leaves of vertices and faces.
pub(super) struct Left {
    /// Vertices that are on the union's surface, and on no curve.
    pub vertices: Vec<bool>,
    /// Faces of which all vertices are left and which no curve crosses.
    pub faces: Vec<bool>,
    /// Of those the ones that the union has divided otherwise, near slivers.
    pub altered: Vec<bool>,
}

impl Left {
    pub fn new(parts: &Parts, union: &Union, seams: &[([u32; 2], [u32; 2])]) -> Left {
        let mut on_curve = vec![false; union.vertices.len()];
        seams.iter().flat_map(|s| s.0).for_each(|v| on_curve[v as usize] = true);
        let mut vertices = vec![false; parts.vertices.len()];
        for (v, &old) in union.old.iter().enumerate() {
            if old != NONE && !on_curve[v] {
                vertices[old as usize] = true;
            }
        }
        let pieces = union.by_source();
        let mut faces = vec![true; parts.n_faces()];
        let mut altered = vec![false; parts.n_faces()];
        for (s, t) in parts.triangles.iter().enumerate() {
            let face = parts.face_of[s] as usize;
            faces[face] &= t.iter().all(|&v| vertices[v as usize]);
            let own = pieces.get(&(s as u32)).map_or(&[][..], Vec::as_slice);
            let corners = |&u: &u32| union.triangles[u as usize];
            let whole = |u: &u32| corners(u).iter().all(|&v| t.contains(&union.old[v as usize]));
            altered[face] |= !(own.len() == 1 && whole(&own[0]));
            let crossed =
                own.iter().flat_map(corners).any(|v| on_curve[v as usize] || union.old[v as usize] == NONE);
            faces[face] &= !crossed;
        }
        for f in 0..faces.len() {
            altered[f] &= faces[f];
        }
        Left { vertices, faces, altered }
    }
}

impl Curves {
    pub fn new(parts: &Parts, union: &Union, seams: &[([u32; 2], [u32; 2])]) -> Curves {
        let mut sets = Disjoint::new(union.vertices.len());
        seams.iter().for_each(|([a, b], _)| sets.join(*a, *b));
        let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
        let (mut segments, mut seam_curves) = (vec![], vec![]);
        let mut faces: Vec<BTreeMap<usize, Vec<u32>>> = vec![];
        for &([a, b], triangles) in seams {
            let next = numbers.len() as u32;
            let curve = *numbers.entry(sets.root(a)).or_insert(next);
            if curve == next {
                faces.push(BTreeMap::new());
            }
            segments.push(([a, b].map(|v| union.vertices[v as usize]), curve));
            seam_curves.push(curve as usize);
            for t in triangles {
                let face = parts.face_of[union.source[t as usize] as usize];
                faces[curve as usize].entry(parts.solid_of_face(face)).or_default().push(face);
            }
        }
        let mean = |faces: &Vec<u32>| {
            let mut faces = faces.clone();
            faces.sort_unstable();
            faces.dedup();
            let (mut sum, mut count) = (0.0, 0.0);
            for &f in &faces {
                let own = parts.face(f);
                for k in 0..own.len() {
                    let [a, b] = [own[k], own[(k + 1) % own.len()]].map(|v| parts.vertices[v as usize]);
                    sum += a.distance(b);
                    count += 1.0;
                }
            }
            sum / count
        };
        let lengths = faces.iter().map(|own| own.iter().map(|(&p, f)| (p, mean(f))).collect()).collect();
        Curves { lines: Lines::numbered(segments), lengths, count: numbers.len(), seams: seam_curves }
    }

    /// How near vertices of a solid may be to a curve, if the blend is `scale` times what is asked for.
    fn reach(&self, solid: usize, curve: usize, options: &JoinOptions, scale: f64) -> f64 {
        let own = self.lengths[curve].get(&solid).copied().unwrap_or(0.0);
        let asked = options.edge_length.unwrap_or(own) * (options.blend * scale);
        (asked - HALF * own).max(LEAST * own)
    }

    /// Marks the vertices that go: those not left, and those along the surface within the reach of a curve. `scales`: for
    /// each curve how much of its blend is taken.
    pub fn near(&self, parts: &Parts, left: &Left, options: &JoinOptions, scales: &[f64]) -> Vec<bool> {
        let mut gone = left.vertices.iter().map(|&l| !l).collect::<Vec<_>>();
        let mut seen = vec![false; parts.vertices.len()];
        let mut waiting = vec![];
        let mut visit = |v: u32, waiting: &mut Vec<u32>| {
            if left.vertices[v as usize] && !std::mem::replace(&mut seen[v as usize], true) {
                waiting.push(v);
            }
        };
        for f in (0..parts.n_faces() as u32).filter(|&f| !left.faces[f as usize]) {
            parts.face(f).iter().for_each(|&v| visit(v, &mut waiting));
        }
        let around = parts.around(0, 0);
        while let Some(v) = waiting.pop() {
            let at = parts.vertices[v as usize];
            let solid = parts.solid_of_vertex(v);
            let Some((curve, distance)) = self.lines.find(at) else { continue };
            let curve = curve as usize;
            if distance >= self.reach(solid, curve, options, scales[curve]) {
                continue;
            }
            gone[v as usize] = true;
            around.of(v).iter().for_each(|corner| visit(corner.next, &mut waiting));
        }
        gone
    }
}
