//! Caps that continue the model around them, and stay inside what they close.

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use rustc_hash::FxHashMap;

use super::regions::Spot;
use crate::cut::caps::capper::{Capper, key};
use crate::cut::divide::node::Node;
use crate::cut::input::triangles;
use crate::cut::options::{CutOptions, Keep};
use crate::cut::sheet::roll::Roll;
use crate::error::{Error, Result};
use crate::fill::fill_hole;
use crate::fill::options::FillOptions;
use crate::fill::planar::flat_patch::FlatPatch;
use crate::fill::surface::meet::{Box3, count_meetings, near_boxes};
use crate::progress::Progress;

/// How much of its bulge a cap keeps where it would leave the model, tried in this order; then it lies flat.
const SHARES: [f64; 6] = [1.0, 0.75, 0.5, 0.3, 0.15, 0.05];

/// Vertices between two questions whether to go on.
const ASK_EVERY: usize = 1 << 10;

/// What became of a cap.
pub(in crate::cut) enum Bulged {
    /// It is as it should be.
    Whole,
    /// It bulges less.
    Reduced,
    /// It has to lie flat: it would leave the model, however little it bulges, or repeat an edge, or its rim has edges
    /// without a length or touches itself.
    Flat,
}

impl Capper<'_> {
    /// The triangles of a cap that lies flat.
    pub(in crate::cut) fn placed(&self, outline: &[Spot], patch: &FlatPatch) -> Vec<[DVec3; 3]> {
        let roll = Roll::new(self.sheet, outline);
        let mut at: Vec<DVec3> =
            outline.iter().map(|s| self.parted.position(self.cutting.vertices, s.node)).collect();
        at.extend(patch.interior.iter().map(|&p| self.node(roll.unflatten(p)).position));
        patch.triangles.iter().map(|t| t.map(|v| at[v as usize])).collect()
    }

    /// Whether a cap that lies flat meets one that was made before.
    pub(in crate::cut) fn meets_caps(&self, flat: &[[DVec3; 3]], progress: Progress<'_>) -> Result<bool> {
        let first = self.first + self.caps.vertices.len() as u32;
        let position = |v: u32| match v.checked_sub(first) {
            Some(k) => flat[k as usize / 3][k as usize % 3],
            None => match v.checked_sub(self.first) {
                Some(k) => self.caps.vertices[k as usize].position,
                None => self.parted.position(self.cutting.vertices, v),
            },
        };
        let new: Vec<[u32; 3]> =
            (0..flat.len() as u32).map(|t| [first + 3 * t, first + 3 * t + 1, first + 3 * t + 2]).collect();
        let old: Vec<[u32; 3]> = self.caps.triangles().collect();
        Ok(count_meetings(position, &new, &old, true, 1, progress)?.0 > 0)
    }

    /// Fills a loop so that it continues the piece around it, as much as there is room in what it closes, beside caps that are yet to
    /// be made and may lie flat.
    pub(in crate::cut) fn bulge(
        &mut self,
        outline: &[Spot],
        later: &[Vec<[DVec3; 3]>],
        inverted: bool,
        progress: Progress<'_>,
    ) -> Result<Bulged> {
        let left = self.cutting.options.keep != Keep::Right;
        let both = self.cutting.options.keep == Keep::Both;
        let n = outline.len();
        let mut positions = self.cutting.vertices.to_vec();
        positions.extend(self.parted.nodes.iter().map(|node| node.position));
        let around = self.side(left);
        let nodes = outline.iter().map(|s| s.node).collect::<Vec<_>>();
        let CutOptions { smooth, cells, .. } = *self.cutting.options;
        let options = FillOptions { smooth, cells, ..FillOptions::default() };
        let fill = match fill_hole(&positions, &around, &nodes, &options, progress) {
            // What is filled in space is held to more than what is filled in the unrolled surface.
            Err(Error::ZeroLengthEdge { .. } | Error::SelfTouching { .. } | Error::NoPatch { .. }) => {
                return Ok(Bulged::Flat);
            }
            fill => fill?,
        };
        let place: FxHashMap<u32, usize> = nodes.iter().enumerate().map(|(k, &v)| (v, k)).collect();
        let repeats = |[a, b]: [u32; 2]| {
            let (Some(&i), Some(&j)) = (place.get(&a), place.get(&b)) else { return false };
            (i + 1) % n != j && (j + 1) % n != i && self.edges.contains(&key(a, b))
        };
        if fill.sides().any(repeats) {
            return Ok(Bulged::Flat);
        }
        // Without a bulge: what hangs evenly in the rim.
        let rim = nodes.iter().flat_map(|&v| positions[v as usize].to_array()).collect::<Vec<_>>();
        let level = fill.extend(&rim, 3, progress.part(1.0, 1.0))?;
        let level = level.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>();
        let other = if both { self.side(!left) } else { vec![] };
        let mut room = Room::new(self, &positions, [&around, &other], &nodes, inverted);
        room.keep_apart(later.iter().flatten());
        let facets = fill.facets();
        let mut chosen = None;
        for share in SHARES {
            progress.report(1.0)?;
            let at = level
                .iter()
                .zip(&fill.vertices)
                .map(|(&l, &p)| if share < 1.0 { l.lerp(p, share) } else { p });
            let at = at.collect::<Vec<_>>();
            if room.holds(&at, &facets, progress.part(1.0, 1.0))? {
                chosen = Some((share, at));
                break;
            }
        }
        let Some((share, at)) = chosen else { return Ok(Bulged::Flat) };
        let base = self.first + self.caps.vertices.len() as u32;
        let old = positions.len() as u32;
        let known = nodes.iter().map(|&v| GeomWithData::new(positions[v as usize].to_array(), v));
        let tree = RTree::bulk_load(known.collect::<Vec<_>>());
        for (k, position) in at.into_iter().enumerate() {
            if k % ASK_EVERY == 0 {
                progress.report(1.0)?;
            }
            let near = tree.nearest_neighbor(position.to_array()).map_or(nodes[0], |near| near.data);
            self.caps.vertices.push(Node { position, ..self.parted.source(self.cutting.vertices, near) });
        }
        let name = |v: u32| if v < old { v } else { base + v - old };
        // Wound for the piece that they were made for.
        for quad in &fill.quads {
            self.push(&quad.map(name), left, base);
        }
        for triangle in &fill.triangles {
            self.push(&triangle.map(name), left, base);
        }
        Ok(if share < 1.0 { Bulged::Reduced } else { Bulged::Whole })
    }

    /// Triangles of one side of the divided mesh.
    fn side(&self, left: bool) -> Vec<[u32; 3]> {
        let mut found = vec![];
        for f in
            (0..self.cutting.faces.len()).filter(|&f| !self.parted.divided[f] && self.parted.left[f] == left)
        {
            triangles(self.cutting.vertices, self.cutting.faces.face(f), |t| found.push(t));
        }
        found.extend(self.parted.parts.iter().filter(|p| p.left == left).map(|p| p.corners));
        found
    }
}

/// What a cap must not leave: the faces of the pieces that it closes, and the other caps.
struct Room {
    /// Of the mesh, of the divided faces, and of other caps.
    positions: Vec<DVec3>,
    /// Number of those that a fill knows.
    known: u32,
    near: Vec<[u32; 3]>,
    /// Edges of the rim, and the third corners of the faces on both sides: that of the piece which the cap continues first.
    wedges: FxHashMap<(u32, u32), [u32; 2]>,
    caps: Vec<[u32; 3]>,
    /// The model's faces look inward.
    inverted: bool,
}

impl Room {
    fn new(
        capper: &Capper<'_>,
        positions: &[DVec3],
        [own, other]: [&[[u32; 3]]; 2],
        nodes: &[u32],
        inverted: bool,
    ) -> Self {
        let known = positions.len() as u32;
        let mut positions = positions.to_vec();
        positions.extend(capper.caps.vertices.iter().map(|node| node.position));
        let n = nodes.len();
        let mut rim: FxHashMap<(u32, u32), [u32; 2]> =
            (0..n).map(|k| (key(nodes[k], nodes[(k + 1) % n]), [u32::MAX; 2])).collect();
        for (which, triangles) in [own, other].into_iter().enumerate() {
            for t in triangles {
                for k in 0..3 {
                    if let Some(corners) = rim.get_mut(&key(t[k], t[(k + 1) % 3])) {
                        corners[which] = t[(k + 2) % 3];
                    }
                }
            }
        }
        rim.retain(|_, corners| corners.iter().all(|&v| v != u32::MAX));
        let near = own.iter().chain(other).copied().collect();
        Room { positions, known, near, wedges: rim, caps: capper.caps.triangles().collect(), inverted }
    }

    /// Adds triangles that a cap must not meet.
    fn keep_apart<'t>(&mut self, triangles: impl Iterator<Item = &'t [DVec3; 3]>) {
        for triangle in triangles {
            let first = self.positions.len() as u32;
            self.positions.extend(triangle);
            self.caps.push([first, first + 1, first + 2]);
        }
    }

    /// True if a cap with these new vertices meets nothing but its rim, and lies inside along it.
    fn holds(&self, at: &[DVec3], triangles: &[[u32; 3]], progress: Progress<'_>) -> Result<bool> {
        let n = self.positions.len() as u32;
        let name = |v: u32| if v < self.known { v } else { n + v - self.known };
        let position = |v: u32| match v.checked_sub(n) {
            Some(k) => at[k as usize],
            None => self.positions[v as usize],
        };
        let new = triangles.iter().map(|t| t.map(name)).collect::<Vec<_>>();
        if !new.iter().all(|t| self.is_inside(*t, &position)) {
            return Ok(false);
        }
        let around = Box3::around(new.iter().flatten().map(|&v| position(v)));
        let mut old: Vec<[u32; 3]> = near_boxes(&[around], &self.positions, &self.near)
            .into_iter()
            .flatten()
            .map(|t| self.near[t as usize])
            .collect();
        old.extend(&self.caps);
        Ok(count_meetings(position, &new, &old, false, 1, progress)?.0 == 0)
    }

    /// False if a triangle at the rim leaves the model there: it lies between the faces of both pieces.
    fn is_inside(&self, t: [u32; 3], position: &impl Fn(u32) -> DVec3) -> bool {
        (0..3).all(|k| {
            // A cap runs along its rim against the faces of the piece that it continues.
            let (b, a, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            let Some(&[own, other]) = self.wedges.get(&key(a, b)) else { return true };
            let origin = position(a);
            let axis = (position(b) - origin).normalize_or_zero();
            let across = |v: u32| {
                let d = position(v) - origin;
                d - d.dot(axis) * axis
            };
            let first = across(own);
            let outward = axis.cross(first) * if self.inverted { -1.0 } else { 1.0 };
            let angle = |v: u32| {
                let d = across(v);
                libm::atan2(-d.dot(outward), d.dot(first)).rem_euclid(std::f64::consts::TAU)
            };
            angle(c) < angle(other)
        })
    }
}
