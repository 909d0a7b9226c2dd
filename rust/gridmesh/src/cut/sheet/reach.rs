//! How far a stroke reaches whose ends are not continued to infinity: which of the curves in which the swept surface
//! meets the mesh are cut.
//!
//! The crossings of the line with the mesh's edges are joined within triangles to curves. Those that the stroke itself
//! meets are cut, and with an outline the holes in it; the crossings of all others are forgotten, and the sides of the
//! vertices told anew, by going from vertex to vertex.

use glam::{DVec2, DVec3};

use crate::cut::divide::chains::{is_inside, start};
use crate::cut::divide::cross::Edges;
use crate::cut::divide::locate::Met;
use crate::cut::input::{Polygons, triangles};
use crate::cut::options::Keep;
use crate::cut::sheet::Sheet;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// A curve in which the swept surface meets the mesh, on the unrolled surface.
#[derive(Default)]
struct Curve {
    /// Stretches, as the left piece's faces run along them.
    stretches: Vec<[DVec2; 2]>,
    low: f64,
    high: f64,
    area: f64,
}

/// Curves, and for each crossing the one that it is on.
struct Curves {
    curves: Vec<Curve>,
    /// First crossing of each edge.
    starts: Vec<usize>,
    curve_of: Vec<u32>,
}

/// Where parts go that the stroke does not cross.
#[derive(Clone, Copy, Debug)]
pub(in crate::cut) enum Alone {
    /// Into the only piece that is kept, or the larger one.
    Kept(Keep),
    /// To the left, or to the right.
    On(bool),
}

/// What a stroke cuts whose ends are not continued.
pub(in crate::cut) struct Reach {
    /// For each crossing, counted along all edges: whether it is cut.
    cut: Vec<bool>,
    starts: Vec<usize>,
    /// From where to where on the unrolled line.
    pub from: f64,
    pub to: f64,
}

/// Finds what the stroke itself cuts.
///
/// # Errors
/// [`Error::StrokeMisses`] if that is nothing, [`Error::Cancelled`].
pub(in crate::cut) fn reach(
    vertices: &[DVec3],
    sheet: &Sheet,
    met: &Met,
    edges: &Edges,
    progress: Progress<'_>,
) -> Result<Reach> {
    let found = join(vertices, sheet, met, edges, progress)?;
    let [from, to] = sheet.drawn();
    let curves = &found.curves;
    let meets = |c: &Curve| c.stretches.iter().any(|[p, q]| p.x.min(q.x) <= to && p.x.max(q.x) >= from);
    let mut cut = curves.iter().map(meets).collect::<Vec<_>>();
    // Holes go with what they are in.
    let sign = curves.iter().map(|c| c.area).sum::<f64>().signum();
    for k in 0..curves.len() {
        if sign * curves[k].area >= 0.0 {
            continue;
        }
        progress.report(1.0)?;
        let around = (0..curves.len())
            .filter(|&o| o != k && sign * curves[o].area > 0.0 && curves[o].holds(&curves[k]));
        if let Some(outline) = around.min_by(|&a, &b| curves[a].area.abs().total_cmp(&curves[b].area.abs())) {
            cut[k] = cut[outline];
        }
    }
    let own = || (0..curves.len()).filter(|&k| cut[k]);
    if own().next().is_none() {
        return Err(Error::StrokeMisses);
    }
    let (low, high) = (own().map(|k| curves[k].low), own().map(|k| curves[k].high));
    let (from, to) = (low.fold(from, f64::min), high.fold(to, f64::max));
    let cut = found.curve_of.iter().map(|&c| cut[c as usize]).collect();
    Ok(Reach { cut, starts: found.starts, from, to })
}

/// Joins crossings within triangles.
fn join(
    vertices: &[DVec3],
    sheet: &Sheet,
    met: &Met,
    edges: &Edges,
    progress: Progress<'_>,
) -> Result<Curves> {
    let mut starts = vec![0];
    for hits in &edges.hits {
        starts.push(starts[starts.len() - 1] + hits.len());
    }
    let mut roots = (0..starts[edges.hits.len()]).collect::<Vec<_>>();
    let spot = |id: usize| {
        let k = starts.partition_point(|&s| s <= id) - 1;
        let (hit, (a, b)) = (&edges.hits[k][id - starts[k]], edges.keys[k]);
        let p = vertices[a as usize].lerp(vertices[b as usize], hit.t);
        DVec2::new(sheet.place(hit.segment as usize, hit.s), sheet.view.height(p))
    };
    let mut stretches = vec![];
    for (at, &(corners, _)) in edges.triangles.iter().enumerate() {
        if at % 4096 == 0 {
            progress.report(at as f64 / edges.triangles.len() as f64)?;
        }
        // Around the triangle: segment, place, number, and whether the side before it is on the left.
        let mut events: Vec<(u32, f64, usize, bool)> = vec![];
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let Ok(edge) = edges.keys.binary_search(&(a.min(b), a.max(b))) else { continue };
            let n = edges.hits[edge].len();
            for j in 0..n {
                let i = if a < b { j } else { n - 1 - j };
                let hit = &edges.hits[edge][i];
                let place = sheet.place(hit.segment as usize, hit.s);
                events.push((hit.segment, place, starts[edge] + i, met.left[a as usize] != (j % 2 == 1)));
            }
        }
        events.sort_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
        let segments = events.iter().map(|e| e.0).collect::<Vec<_>>();
        let Some(begin) = start(&segments, |k| is_inside(sheet, corners, k)) else { continue };
        let count = events.len();
        for pair in 0..count / 2 {
            let p = events[(begin + 2 * pair) % count];
            let q = events[(begin + 2 * pair + 1) % count];
            let (x, y) = (root(&mut roots, p.2), root(&mut roots, q.2));
            roots[x.max(y)] = x.min(y);
            stretches.push(if p.3 { (p.2, q.2) } else { (q.2, p.2) });
        }
    }
    let mut number = vec![u32::MAX; roots.len()];
    let mut curves: Vec<Curve> = vec![];
    let mut curve_of = vec![0; roots.len()];
    for id in 0..roots.len() {
        let own = root(&mut roots, id);
        if own == id {
            number[id] = curves.len() as u32;
            let x = spot(id).x;
            curves.push(Curve { low: x, high: x, ..Curve::default() });
        }
        curve_of[id] = number[own];
    }
    for (p, q) in stretches {
        let curve = &mut curves[curve_of[p] as usize];
        let ends = [spot(p), spot(q)];
        for end in ends {
            (curve.low, curve.high) = (curve.low.min(end.x), curve.high.max(end.x));
        }
        let origin = curve.stretches.first().map_or(ends[0], |s| s[0]);
        curve.area += 0.5 * (ends[0] - origin).perp_dot(ends[1] - origin);
        curve.stretches.push(ends);
    }
    Ok(Curves { curves, starts, curve_of })
}

fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}

impl Curve {
    /// True if another curve lies inside this one.
    fn holds(&self, other: &Curve) -> bool {
        if other.low < self.low || other.high > self.high || other.stretches.is_empty() {
            return false;
        }
        let n = other.stretches.len();
        let within = |k: usize| {
            let p = other.stretches[k * n / 3][0];
            let passes = |[a, b]: &&[DVec2; 2]| {
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
            };
            self.stretches.iter().filter(passes).count() % 2 == 1
        };
        (0..3).filter(|&k| within(k)).count() >= 2
    }
}

impl Reach {
    /// Forgets the crossings that are not cut, and tells the sides of all vertices anew.
    ///
    /// # Errors
    /// [`Error::StillJoined`] if what is cut does not come apart.
    pub fn restrict(
        &self,
        vertices: &[DVec3],
        faces: Polygons<'_>,
        met: &mut Met,
        edges: &mut Edges,
        alone: Alone,
    ) -> Result<()> {
        // Which vertex is on which side where it is cut: the side of an edge's first vertex.
        let mut seeds: Vec<(u32, bool)> = vec![];
        let (mut keys, mut hits) = (vec![], vec![]);
        for (k, (&(a, b), all)) in edges.keys.iter().zip(&edges.hits).enumerate() {
            let is_cut = |j: usize| self.cut[self.starts[k] + j];
            let Some(first) = (0..all.len()).find(|&j| is_cut(j)) else { continue };
            seeds.push((a, met.left[a as usize] != (first % 2 == 1)));
            keys.push((a, b));
            hits.push((0..all.len()).filter(|&j| is_cut(j)).map(|j| all[j]).collect::<Vec<_>>());
        }
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
        if let Some(v) = torn {
            return Err(Error::StillJoined { at: vertices[v as usize].into() });
        }
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
        let alone = match alone {
            Alone::On(left) => left,
            Alone::Kept(Keep::Left) => true,
            Alone::Kept(Keep::Right) => false,
            Alone::Kept(Keep::Both) => areas[1] >= areas[0],
        };
        met.alone = Some(alone);
        for v in 0..vertices.len() {
            let (root, odd) = sides.root(v as u32);
            met.left[v] = known[root as usize].map_or(alone, |side| side != odd);
        }
        (edges.keys, edges.hits) = (keys, hits);
        Ok(())
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
