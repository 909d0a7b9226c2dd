//! What caps are made with, and what they are.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use rustc_hash::FxHashSet;

use crate::cut::caps::regions::Spot;
use crate::cut::caps::sources;
use crate::cut::cutting::Cutting;
use crate::cut::divide::node::Node;
use crate::cut::divide::parted::Parted;
use crate::cut::input::Polygons;
use crate::cut::options::Keep;
use crate::cut::report::Tally;
use crate::cut::sheet::Sheet;
use crate::cut::sheet::roll::Roll;
use crate::error::{Error, Result};
use crate::fill::planar::flat::{FlatOptions, fill_flat};
use crate::fill::planar::flat_patch::{FlatFill, FlatPatch};
use crate::fill::planar::quads::fill_flat_quads;
use crate::options::CellShape;
use crate::progress::Progress;

/// What closes the pieces.
pub(in crate::cut) struct Caps {
    /// New vertices, numbered after those of the divided mesh.
    pub vertices: Vec<Node>,
    /// Corners of the faces, which are triangles and quads, wound as the right piece needs them.
    corners: Vec<u32>,
    /// Where each face begins, and the end.
    offsets: Vec<u32>,
}

impl Caps {
    /// No faces yet.
    pub fn new(vertices: Vec<Node>) -> Caps {
        Caps { vertices, corners: vec![], offsets: vec![0] }
    }

    pub fn faces(&self) -> Polygons<'_> {
        Polygons { corners: &self.corners, offsets: &self.offsets }
    }

    /// The faces as triangles, quads cut in two.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.faces().iter().flat_map(|face| (2..face.len()).map(|k| [face[0], face[k - 1], face[k]]))
    }

    /// Adds a face; `turned`: it is wound for the left piece.
    fn push(&mut self, face: &[u32], turned: bool) {
        let first = self.corners.len();
        self.corners.extend(face);
        if turned {
            self.corners[first + 1..].reverse();
        }
        self.offsets.push(self.corners.len() as u32);
    }
}

pub(in crate::cut) struct Capper<'a> {
    pub cutting: Cutting<'a>,
    pub parted: &'a Parted,
    pub(crate) sheet: &'a Sheet,
    /// Edges between vertices of the cut that are there already, and facets.
    pub edges: FxHashSet<(u32, u32)>,
    pub(crate) facets: FxHashSet<Facet>,
    /// Number of the first new vertex.
    pub first: u32,
    pub caps: Caps,
    /// Edges of the caps along planes of symmetry.
    pub(crate) seams: FxHashSet<(u32, u32)>,
}

/// The corners of a triangle or quad, sorted; a triangle has [`u32::MAX`] as its last.
type Facet = [u32; 4];

/// The facet of a face; `None` if it has more corners than a quad.
fn facet(corners: impl ExactSizeIterator<Item = u32>) -> Option<Facet> {
    let mut facet = [u32::MAX; 4];
    if corners.len() > facet.len() {
        return None;
    }
    corners.zip(&mut facet).for_each(|(v, place)| *place = v);
    facet.sort_unstable();
    Some(facet)
}

/// The edges of a face.
fn sides(face: &[u32]) -> impl Iterator<Item = (u32, u32)> {
    (0..face.len()).map(|k| key(face[k], face[(k + 1) % face.len()]))
}

/// An edge, its lower vertex first.
pub(in crate::cut) fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Capper<'_> {
    /// Notes which edges and facets between vertices of the cut exist.
    pub(crate) fn reserve(&mut self) {
        let on_cut = self.parted.on_cut();
        let mut note = |corners: &[u32]| {
            let n = corners.len();
            let on = corners.iter().filter(|&&v| on_cut[v as usize]).count();
            if on < 2 {
                return;
            }
            self.edges.extend(sides(corners).filter(|&(a, b)| on_cut[a as usize] && on_cut[b as usize]));
            if on == n {
                self.facets.extend(facet(corners.iter().copied()));
            }
        };
        // Of a piece that is not kept nothing can be repeated.
        let is_kept = |left: bool| self.cutting.options.keep.has(if left { Keep::Left } else { Keep::Right });
        for part in self.parted.parts.iter().filter(|part| is_kept(part.left)) {
            note(&part.corners);
        }
        let whole = (0..self.cutting.faces.len()).filter(|&f| !self.parted.divided[f]);
        for f in whole.filter(|&f| is_kept(self.parted.left[f])) {
            note(self.cutting.faces.face(f));
        }
    }

    /// A vertex of the sheet; its source follows.
    pub(crate) fn node(&self, at: DVec2) -> Node {
        Node { position: self.sheet.lift(at.x, at.y), source: [u32::MAX; 3], weights: [1.0, 0.0, 0.0] }
    }

    /// Fills a polygon of the unrolled sheet.
    pub(crate) fn plan(&self, polygon: &[Spot], progress: Progress<'_>) -> Result<FlatFill> {
        let n = polygon.len();
        let roll = Roll::new(self.sheet, polygon);
        let flat = polygon.iter().map(|s| roll.flatten(s.at)).collect::<Vec<_>>();
        let taken = |i: usize, j: usize| self.edges.contains(&key(polygon[i].node, polygon[j].node));
        let own = facet(polygon.iter().map(|s| s.node));
        let single = own.is_none_or(|own| !self.facets.contains(&own));
        if self.cutting.options.cells == CellShape::Quad {
            let filled = fill_flat_quads(&flat, &vec![2.0; n], &taken, single, progress);
            return filled.map_err(|err| match err {
                Error::NoPatch { .. } => {
                    let at = self.sheet.lift(polygon[0].at.x, polygon[0].at.y).into();
                    Error::CutFailed { reason: "every cap of quads repeats an edge of the mesh", at }
                }
                other => other,
            });
        }
        let mut options = FlatOptions { single, ..FlatOptions::default() };
        if n > LARGE {
            (options.angles, options.placed) = (3, 1);
            // Graded patches take longer than all else, and are hardly better.
            options.enough = ENOUGH;
            options.thin = true;
        }
        fill_flat(&flat, &vec![4; n], &taken, &options, progress)
    }

    /// True if a patch has an edge across it that exists by now. `rims`: its loops, in the order of its vertices.
    pub(crate) fn repeats(&self, rims: &[&[Spot]], patch: &FlatPatch) -> bool {
        let spots = rims.concat();
        let follows = |rim: &&[Spot]| (1..=rim.len()).map(|k| k % rim.len()).collect::<Vec<_>>();
        let starts = rims.iter().scan(0, |end, rim| Some(std::mem::replace(end, *end + rim.len())));
        let next = starts.zip(rims).flat_map(|(start, rim)| follows(rim).into_iter().map(move |k| start + k));
        let next = next.collect::<Vec<_>>();
        patch.sides().any(|[a, b]| {
            let (i, j) = (a as usize, b as usize);
            let (Some(p), Some(q)) = (spots.get(i), spots.get(j)) else { return false };
            next[i] != j && next[j] != i && self.edges.contains(&key(p.node, q.node))
        })
    }

    /// Makes vertices and faces of a patch. `rim`: its loops, one after the other.
    pub(crate) fn roll_up(
        &mut self,
        rim: &[Spot],
        patch: &FlatPatch,
        inverted: bool,
        progress: Progress<'_>,
    ) -> Result<()> {
        progress.report(1.0)?;
        let n = rim.len();
        let roll = Roll::new(self.sheet, rim);
        let base = self.first + self.caps.vertices.len() as u32;
        let name = |v: u32| rim.get(v as usize).map_or_else(|| base + (v - n as u32), |s| s.node);
        let mut flat = rim.iter().map(|s| roll.flatten(s.at)).collect::<Vec<_>>();
        flat.extend(&patch.interior);
        let near = sources::nearest_on_rim(n, &flat, &patch.triangles);
        progress.report(1.0)?;
        for (&p, near) in patch.interior.iter().zip(near) {
            let mut node = self.node(roll.unflatten(p));
            let from = self.source(rim[near as usize].node);
            (node.source, node.weights) = (from.source, from.weights);
            self.caps.vertices.push(node);
        }
        for quad in patch.quads() {
            self.push(&quad.map(name), inverted, base);
        }
        for triangle in patch.single() {
            self.push(&triangle.map(name), inverted, base);
        }
        progress.report(1.0)
    }

    /// The vertex of this number as a combination of old ones.
    pub(crate) fn source(&self, v: u32) -> Node {
        match v.checked_sub(self.first) {
            Some(k) => self.caps.vertices[k as usize],
            None => self.parted.source(self.cutting.vertices, v),
        }
    }

    /// Gives vertices of bridges, and those next to them, the sources of the nearest vertices of the cut.
    pub(crate) fn name_sources<'s>(&mut self, rims: impl Iterator<Item = &'s Spot>) {
        if self.caps.vertices.iter().all(|node| node.source[0] != u32::MAX) {
            return;
        }
        let known = rims.filter(|s| s.node < self.first);
        let place = |s: &Spot| {
            let p = self.parted.position(self.cutting.vertices, s.node);
            GeomWithData::new(p.to_array(), s.node)
        };
        let tree = RTree::bulk_load(known.map(place).collect::<Vec<_>>());
        for node in &mut self.caps.vertices {
            if node.source[0] == u32::MAX
                && let Some(near) = tree.nearest_neighbor(node.position.to_array())
            {
                let from = self.parted.source(self.cutting.vertices, near.data);
                (node.source, node.weights) = (from.source, from.weights);
            }
        }
    }

    /// Adds a face of a patch whose own vertices begin with `base`; others ask only for edges between vertices that they know.
    /// `turned`: it is wound for the left piece.
    pub fn push(&mut self, face: &[u32], turned: bool, base: u32) {
        self.edges.extend(sides(face).filter(|edge| edge.1 < base));
        self.caps.push(face, turned);
    }

    /// Refuses caps that do not close what they should: each edge has two cap faces, or one and is of the cut.
    pub(crate) fn prove(&self) -> Result<()> {
        // Each edge once for each face, with its direction last.
        let directed = |a: u32, b: u32| (key(a, b), a < b);
        let faces = self.caps.faces();
        let edges = (0..faces.len()).into_par_iter().with_min_len(4096).flat_map_iter(|f| {
            let face = faces.face(f);
            (0..face.len()).map(move |k| directed(face[k], face[(k + 1) % face.len()]))
        });
        let mut edges: Vec<((u32, u32), bool)> = edges.collect();
        edges.par_sort_unstable();
        let is_right = |group: &[((u32, u32), bool)]| {
            let is_cut = self.parted.cut.contains_key(&group[0].0);
            if is_cut || self.seams.contains(&group[0].0) {
                group.len() == 1
            } else {
                group.len() == 2 && group[0].1 != group[1].1
            }
        };
        match edges.chunk_by(|a, b| a.0 == b.0).find(|group| !is_right(group)) {
            None => Ok(()),
            Some(group) => {
                let at = self.source(group[0].0.0).position;
                Err(Error::CutFailed { reason: "cut lines touch each other", at: at.into() })
            }
        }
    }

    pub(crate) fn measure(&self, tally: &mut Tally) {
        let report = &mut tally.report;
        let position = |v: u32| match v.checked_sub(self.first) {
            Some(k) => self.caps.vertices[k as usize].position,
            None => self.parted.position(self.cutting.vertices, v),
        };
        let faces = self.caps.faces();
        let mut at = vec![0u32; self.caps.vertices.len()];
        for v in faces.iter().flatten().filter_map(|v| v.checked_sub(self.first)) {
            at[v as usize] += 1;
        }
        // Sums of equal stretches, added up in their order.
        const STRETCH: usize = 8192;
        let sum = |k: usize| {
            let here = k * STRETCH..((k + 1) * STRETCH).min(faces.len());
            here.fold((f64::INFINITY, 0.0), |(least, sum), f| match *faces.face(f) {
                [a, b, c] => {
                    let (angle, ratio) = shape([a, b, c].map(position));
                    (angle.min(least), sum + ratio)
                }
                ref face => (least_corner(face, position).min(least), sum),
            })
        };
        let sums: Vec<(f64, f64)> = (0..faces.len().div_ceil(STRETCH)).into_par_iter().map(sum).collect();
        let mut ratios = 0.0;
        for (angle, ratio) in sums {
            report.cap_min_angle = report.cap_min_angle.min(angle);
            ratios += ratio;
        }
        report.cap_triangles = faces.iter().filter(|face| face.len() == 3).count();
        report.cap_quads = faces.len() - report.cap_triangles;
        report.cap_vertices = at.len();
        let regular = if self.cutting.options.cells == CellShape::Quad { 4 } else { 6 };
        report.cap_irregular = at.iter().filter(|&&n| n != regular).count();
        if report.cap_triangles > 0 {
            report.cap_radius_ratio = ratios / report.cap_triangles as f64;
        }
    }
}

/// Smallest angle between neighbouring edges of a face.
fn least_corner(face: &[u32], position: impl Fn(u32) -> DVec3) -> f64 {
    let n = face.len();
    let corner = |k: usize| {
        let [before, here, after] = [k + n - 1, k, k + 1].map(|k| position(face[k % n]));
        let (back, ahead) = (before - here, after - here);
        libm::atan2(back.cross(ahead).length(), back.dot(ahead))
    };
    (0..n).map(corner).fold(f64::INFINITY, f64::min)
}

/// Smallest angle of a triangle, and twice its inscribed by its circumscribed radius.
pub(in crate::cut) fn shape([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let angle = |p: DVec3, q: DVec3| libm::atan2(p.cross(q).length(), p.dot(q));
    let least = angle(b - a, c - a).min(angle(c - b, a - b)).min(angle(a - c, b - c));
    let [x, y, z] = [b.distance(c), c.distance(a), a.distance(b)];
    let double = (b - a).cross(c - a).length();
    let product = x * y * z * (x + y + z);
    (least, if product > 0.0 { 4.0 * double * double / product } else { 0.0 })
}

/// Polygons with more vertices are tried at fewer lattice angles.
pub(crate) const LARGE: usize = 300;

/// Badness up to which a lattice patch of theirs is taken.
pub(crate) const ENOUGH: f64 = 2.0;
