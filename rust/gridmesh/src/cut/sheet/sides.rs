//! Sides of the vertices where not all crossings of the line are cut: told by going from vertex to vertex.

use glam::DVec3;

use crate::cut::divide::cross::{Edges, Hit};
use crate::cut::divide::locate::{Met, Uncut};
use crate::cut::input::{Polygons, triangles};
use crate::cut::options::Keep;
use crate::error::{Error, Result};

/// Where parts go that are not cut, and have vertices on both sides of the line.
#[derive(Clone, Debug)]
pub(in crate::cut) enum Alone {
    /// Into the only piece that is kept, or the larger one.
    Kept(Keep),
    /// To the side where they are in another cut, all parts that are not cut there.
    As(Uncut),
}

/// Forgets the crossings that are not `cut`, counted along all edges, and tells the sides of all vertices anew.
///
/// A part that is not cut is on the side of the line where its vertices are, but for those that are `near` the line. If they are on
/// both, or the line would cross what is cut elsewhere, too, `alone` tells.
///
/// # Errors
/// [`Error::StillJoined`] if what is cut does not come apart.
pub(in crate::cut) fn retell(
    cut: &[bool],
    (vertices, faces): (&[DVec3], Polygons<'_>),
    met: &mut Met,
    edges: &mut Edges,
    alone: &Alone,
    near: impl Fn(usize) -> bool,
) -> Result<()> {
    // Which vertex is on which side where it is cut: the side of an edge's first vertex.
    let mut seeds: Vec<(u32, bool)> = vec![];
    let (mut keys, mut hits) = (vec![], vec![]);
    let mut start = 0;
    for (&(a, b), all) in edges.keys.iter().zip(&edges.hits) {
        let is_cut = |j: usize| cut[start + j];
        if let Some(first) = (0..all.len()).find(|&j| is_cut(j)) {
            seeds.push((a, met.left[a as usize] != (first % 2 == 1)));
            keys.push((a, b));
            hits.push((0..all.len()).filter(|&j| is_cut(j)).map(|j| all[j]).collect::<Vec<_>>());
        }
        start += all.len();
    }
    let mut sides = joined(vertices, faces, met, &keys, &hits)?;
    let mut known: Vec<Option<bool>> = vec![None; vertices.len()];
    for (v, left) in seeds {
        let (root, odd) = sides.root(v);
        known[root as usize].get_or_insert(left != odd);
    }
    let mut areas = [0.0; 2];
    for f in 0..faces.len() {
        let corners = faces.face(f);
        let (root, odd) = sides.root(corners[0]);
        if let Some(side) = known[root as usize] {
            let origin = vertices[corners[0] as usize];
            let at = |k: usize| vertices[corners[k] as usize] - origin;
            let double: DVec3 = (1..corners.len() - 1).map(|k| at(k).cross(at(k + 1))).sum();
            areas[usize::from(side != odd)] += double.length();
        }
    }
    // Of parts that are not cut: whether they have vertices on the right of the line, and on the left.
    let mut seen = vec![[false; 2]; vertices.len()];
    let mut straight = true;
    for v in 0..vertices.len() {
        let (root, odd) = sides.root(v as u32);
        match known[root as usize] {
            Some(side) => straight &= (side != odd) == met.left[v],
            None if near(v) => {}
            None => seen[root as usize][usize::from(met.left[v])] = true,
        }
    }
    let larger = areas[1] >= areas[0];
    let side = |root: u32| match (seen[root as usize], alone) {
        (_, Alone::As(before)) if before[root as usize].is_some() => before[root as usize] == Some(true),
        ([false, true], _) if straight => true,
        ([true, false], _) if straight => false,
        (_, Alone::Kept(Keep::Left)) => true,
        (_, Alone::Kept(Keep::Right)) => false,
        _ => larger,
    };
    let mut uncut = vec![None; vertices.len()];
    for (v, uncut) in uncut.iter_mut().enumerate() {
        let (root, odd) = sides.root(v as u32);
        met.left[v] = match known[root as usize] {
            Some(side) => side != odd,
            None => *uncut.insert(side(root)),
        };
    }
    met.uncut = Some(uncut);
    (edges.keys, edges.hits) = (keys, hits);
    Ok(())
}

/// Vertices joined along all edges.
fn joined(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    met: &Met,
    keys: &[(u32, u32)],
    hits: &[Vec<Hit>],
) -> Result<Sides> {
    let mut sides = Sides::new(vertices.len());
    let mut near = vec![false; faces.len()];
    met.faces.iter().for_each(|&f| near[f as usize] = true);
    let mut torn = None;
    let mut join = |sides: &mut Sides, a: u32, b: u32, look: bool| {
        let edge = if look { keys.binary_search(&(a.min(b), a.max(b))).ok() } else { None };
        let odd = edge.is_some_and(|k| hits[k].len() % 2 == 1);
        if !sides.join(a, b, odd) {
            torn = torn.or(Some(a));
        }
    };
    for (f, &near) in near.iter().enumerate() {
        let corners = faces.face(f);
        for k in 0..corners.len() {
            join(&mut sides, corners[k], corners[(k + 1) % corners.len()], near);
        }
        if near && corners.len() > 3 {
            triangles(vertices, corners, |t| {
                (0..3).for_each(|k| join(&mut sides, t[k], t[(k + 1) % 3], true))
            });
        }
    }
    match torn {
        Some(v) => Err(Error::StillJoined { at: vertices[v as usize].into() }),
        None => Ok(sides),
    }
}

/// Disjoint sets of vertices, each on the side of the first of its set or on the other one.
struct Sides {
    parents: Vec<u32>,
    odd: Vec<bool>,
}

impl Sides {
    fn new(n: usize) -> Self {
        Sides { parents: (0..n as u32).collect(), odd: vec![false; n] }
    }

    /// The first of the set, and whether `v` is on the other side of it.
    fn root(&mut self, v: u32) -> (u32, bool) {
        let (mut at, mut odd) = (v, false);
        while self.parents[at as usize] != at {
            odd ^= self.odd[at as usize];
            at = self.parents[at as usize];
        }
        // The way there becomes short.
        let (mut next, mut rest) = (v, odd);
        while self.parents[next as usize] != at && next != at {
            let (parent, own) = (self.parents[next as usize], self.odd[next as usize]);
            (self.parents[next as usize], self.odd[next as usize]) = (at, rest);
            (next, rest) = (parent, rest ^ own);
        }
        (at, odd)
    }

    /// Notes that two vertices are on one side, or on `different` ones; false if that is known to be otherwise.
    fn join(&mut self, a: u32, b: u32, different: bool) -> bool {
        let ((x, of_a), (y, of_b)) = (self.root(a), self.root(b));
        let odd = of_a ^ of_b ^ different;
        if x == y {
            return !odd;
        }
        self.parents[x.max(y) as usize] = x.min(y);
        self.odd[x.max(y) as usize] = odd;
        true
    }
}
