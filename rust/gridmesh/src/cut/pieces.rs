//! The pieces: faces of one side and the caps, with vertices of their own.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::cutting::Cutting;
use super::input::{Polygons, volume};
use super::options::Keep;
use super::report::Tally;
use crate::cut::caps::capper::{Caps, shape};
use crate::cut::caps::loops::Loops;
use crate::cut::divide::node::Node;
use crate::cut::divide::parted::Parted;
use crate::geometry::disjoint::Disjoint;

/// Which piece it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// On the left of the stroke, or inside.
    Left,
    /// On the right of the stroke, or outside.
    Right,
}

impl Side {
    /// A stable word, for programs.
    pub fn word(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
        }
    }
}

/// One side of a divided mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Which one.
    pub side: Side,
    /// Old vertices in their order, then those of the cut, then those of the caps, then doubled ones.
    pub vertices: Vec<DVec3>,
    /// Corners of the faces: untouched ones in their order, then parts of divided ones, then caps.
    pub corners: Vec<u32>,
    /// Where each face begins in `corners`, and the end.
    pub offsets: Vec<u32>,
    /// For each face the input's face that it is or was a part of; -1 for cap faces.
    pub source_face: Vec<i32>,
    /// For each vertex old ones, of which it is a combination.
    pub source_vertices: Vec<[u32; 3]>,
    /// Their weights; an old vertex is one times itself. Cap vertices take the combination of a vertex of the
    /// cut near them: for data, not for positions.
    pub source_weights: Vec<[f64; 3]>,
    /// The closed cut lines, as the faces along them run, caps or not.
    pub cap_loops: Vec<Vec<u32>>,
}

pub(super) fn assemble(
    cutting: Cutting<'_>,
    parted: &Parted,
    loops: &Loops,
    caps: &Caps,
    tally: &mut Tally,
) -> Vec<Piece> {
    let Cutting { vertices, faces, options } = cutting;
    let keep = options.keep;
    let on_cut = parted.on_cut();
    let sides = [(Side::Left, Keep::Left), (Side::Right, Keep::Right)];
    let kept = sides.into_iter().filter(|(_, word)| keep.has(*word)).map(|s| s.0).collect::<Vec<_>>();
    let made: Vec<_> =
        kept.into_par_iter().map(|side| one(cutting, parted, loops, caps, side, &on_cut)).collect();
    let mut pieces = vec![];
    for (piece, least, doubled) in made {
        tally.report.rim_min_angle = tally.report.rim_min_angle.min(least);
        tally.report.pinched += doubled;
        pieces.push(piece);
    }
    let origin = vertices.iter().sum::<DVec3>() / vertices.len().max(1) as f64;
    let report = &mut tally.report;
    let own = |p: &Piece| {
        let faces = Polygons { corners: &p.corners, offsets: &p.offsets };
        whole_volume(&p.vertices, origin, faces)
    };
    report.volumes = pieces.iter().map(own).collect();
    report.volume = whole_volume(vertices, origin, faces);
    pieces
}

/// Signed volume. Sums of equal stretches, added up in their order.
fn whole_volume(vertices: &[DVec3], origin: DVec3, faces: Polygons<'_>) -> f64 {
    const STRETCH: usize = 8192;
    let sum = |k: usize| {
        let faces_here = k * STRETCH..((k + 1) * STRETCH).min(faces.len());
        faces_here.map(|f| volume(vertices, origin, faces.face(f))).sum::<f64>()
    };
    let sums: Vec<f64> = (0..faces.len().div_ceil(STRETCH)).into_par_iter().map(sum).collect();
    sums.iter().sum::<f64>() / 6.0
}

/// Faces of one side, with the vertices of the divided mesh and the caps.
struct Faces {
    corners: Vec<u32>,
    offsets: Vec<u32>,
    source_face: Vec<i32>,
    /// The smallest angle along the cut.
    rim: f64,
}

fn faces_of(
    Cutting { vertices, faces, .. }: Cutting<'_>,
    parted: &Parted,
    caps: &Caps,
    left: bool,
    on_cut: &[bool],
) -> Faces {
    let mut corners: Vec<u32> = Vec::with_capacity(faces.corners.len());
    let mut offsets = vec![0u32];
    let mut source_face = vec![];
    for f in 0..faces.len() {
        if !parted.divided[f] && parted.left[f] == left {
            corners.extend(faces.face(f));
            offsets.push(corners.len() as u32);
            source_face.push(f as i32);
        }
    }
    let mut add = |t: [u32; 3], face: i32| {
        corners.extend(t);
        offsets.push(corners.len() as u32);
        source_face.push(face);
    };
    let mut rim = std::f64::consts::PI;
    for part in parted.parts.iter().filter(|p| p.left == left) {
        add(part.corners, part.face as i32);
        if part.corners.iter().any(|&v| on_cut[v as usize]) {
            let least = shape(part.corners.map(|v| parted.position(vertices, v))).0;
            rim = rim.min(least);
        }
    }
    for face in caps.faces().iter() {
        let at = corners.len();
        corners.extend(face);
        if left {
            corners[at + 1..].reverse();
        }
        offsets.push(corners.len() as u32);
        source_face.push(-1);
    }
    Faces { corners, offsets, source_face, rim }
}

/// A piece, the smallest angle along its rim, and how many vertices were doubled.
fn one(
    cutting: Cutting<'_>,
    parted: &Parted,
    loops: &Loops,
    caps: &Caps,
    side: Side,
    on_cut: &[bool],
) -> (Piece, f64, usize) {
    let left = side == Side::Left;
    let n_before = parted.n_old + parted.nodes.len();
    let Faces { mut corners, offsets, source_face, rim } = faces_of(cutting, parted, caps, left, on_cut);
    let mut new = vec![u32::MAX; n_before + caps.vertices.len()];
    for &v in &corners {
        new[v as usize] = 0;
    }
    let mut old = vec![];
    for (v, new) in new.iter_mut().enumerate().filter(|(_, new)| **new == 0) {
        *new = old.len() as u32;
        old.push(v as u32);
    }
    corners.iter_mut().for_each(|v| *v = new[*v as usize]);
    let nodes = old.iter().map(|&v| match (v as usize).checked_sub(n_before) {
        Some(k) => caps.vertices[k],
        None => parted.source(cutting.vertices, v),
    });
    let mut nodes = nodes.collect::<Vec<Node>>();
    let watched = old.iter().map(|&v| on_cut.get(v as usize).copied().unwrap_or(false)).collect::<Vec<_>>();
    let before = nodes.len();
    let doubled = double(&mut corners, &offsets, &watched, &mut nodes);
    // Which copy a loop passes through is told by the faces along it.
    let ends = along(&corners, &offsets, &source_face, &old, &doubled);
    let cap_loops = loops.closed.iter().map(|l| {
        let n = l.nodes.len();
        let order: Vec<usize> = if left { (0..n).collect() } else { (0..n).rev().collect() };
        let name = |k: usize| new[l.nodes[k] as usize];
        (0..n)
            .map(|i| {
                let (a, b) = (name(order[i]), name(order[(i + 1) % n]));
                ends.get(&(a, b)).copied().unwrap_or(a)
            })
            .collect()
    });
    let cap_loops = cap_loops.collect();
    let piece = Piece {
        side,
        vertices: nodes.iter().map(|n| n.position).collect(),
        corners,
        offsets,
        source_face,
        source_vertices: nodes.iter().map(|n| n.source).collect(),
        source_weights: nodes.iter().map(|n| n.weights).collect(),
        cap_loops,
    };
    (piece, rim, nodes.len() - before)
}

/// Gives every fan of faces around a watched vertex a vertex of its own. Returns for the new vertices what they
/// are copies of.
fn double(corners: &mut [u32], offsets: &[u32], watched: &[bool], nodes: &mut Vec<Node>) -> Vec<u32> {
    // Corners at watched vertices, by vertex: place, and the neighbours before and after.
    let mut at: Vec<(u32, u32, u32, u32)> = vec![];
    for w in offsets.windows(2) {
        let face = w[0] as usize..w[1] as usize;
        let n = face.len();
        for k in 0..n {
            let v = corners[face.start + k];
            if watched[v as usize] {
                let [before, after] = [(k + n - 1) % n, (k + 1) % n].map(|k| corners[face.start + k]);
                at.push((v, (face.start + k) as u32, before, after));
            }
        }
    }
    at.sort_unstable();
    let mut copies = vec![];
    let mut from = 0;
    while from < at.len() {
        let v = at[from].0;
        let end = from + at[from..].iter().take_while(|c| c.0 == v).count();
        let fan = &at[from..end];
        from = end;
        // Faces that share an edge at the vertex are of one fan.
        let mut fans = Disjoint::new(fan.len());
        let mut by_neighbour =
            fan.iter().enumerate().flat_map(|(i, c)| [(c.2, i), (c.3, i)]).collect::<Vec<_>>();
        by_neighbour.sort_unstable();
        for pair in by_neighbour.windows(2).filter(|p| p[0].0 == p[1].0) {
            fans.join(pair[0].1 as u32, pair[1].1 as u32);
        }
        let mut named: Vec<(u32, u32)> = vec![(0, v)];
        for i in 1..fan.len() {
            let fan_root = fans.root(i as u32);
            let name = match named.iter().find(|f| f.0 == fan_root) {
                Some(&(_, name)) => name,
                None => {
                    let name = nodes.len() as u32;
                    nodes.push(nodes[v as usize]);
                    copies.push(v);
                    named.push((fan_root, name));
                    name
                }
            };
            corners[fan[i].1 as usize] = name;
        }
    }
    copies
}

/// For edges of faces, caps aside, that begin at a doubled vertex: from the names before to the copy.
fn along(
    corners: &[u32],
    offsets: &[u32],
    source_face: &[i32],
    old: &[u32],
    copies: &[u32],
) -> FxHashMap<(u32, u32), u32> {
    let mut found = FxHashMap::default();
    if copies.is_empty() {
        return found;
    }
    let original = |v: u32| (v as usize).checked_sub(old.len()).map_or(v, |k| copies[k]);
    for (f, w) in offsets.windows(2).enumerate().filter(|(f, _)| source_face[*f] >= 0) {
        let face = &corners[w[0] as usize..w[1] as usize];
        let _ = f;
        for k in 0..face.len() {
            let (a, b) = (face[k], face[(k + 1) % face.len()]);
            if a as usize >= old.len() || b as usize >= old.len() {
                found.insert((original(a), original(b)), a);
            }
        }
    }
    found
}
