//! The division of one face, and the chains of the line through it.

use glam::{DVec2, DVec3};
use rustc_hash::{FxHashMap, FxHashSet};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

use crate::cut::divide::locate::Met;
use crate::cut::divide::node::{Node, Tolerance};
use crate::cut::divide::parted::Part;
use crate::cut::sheet::Sheet;
use crate::error::{Error, Result};

/// A part of a triangle has at least this part of the square over its longest edge as its area, twice.
pub(crate) const AREA: f64 = 1e-9;

pub(in crate::cut) struct Divider<'a> {
    pub vertices: &'a [DVec3],
    pub sheet: &'a Sheet,
    pub met: &'a Met,
    pub edges: &'a FxHashMap<(u32, u32), u32>,
    pub hits: &'a [Vec<super::cross::Hit>],
    pub nodes: Vec<Node>,
    pub tolerance: Tolerance,
    pub parts: Vec<Part>,
    pub cut: FxHashMap<(u32, u32), [f64; 2]>,
}

impl Divider<'_> {
    pub fn hits(&self, a: u32, b: u32) -> &[super::cross::Hit] {
        self.edges.get(&(a.min(b), a.max(b))).map_or(&[], |&k| &self.hits[k as usize])
    }

    pub fn position(&self, v: u32) -> DVec3 {
        match (v as usize).checked_sub(self.vertices.len()) {
            Some(k) => self.nodes[k].position,
            None => self.vertices[v as usize],
        }
    }

    pub fn failed(&self, corners: [u32; 3], reason: &'static str) -> Error {
        let at = corners.iter().map(|&v| self.vertices[v as usize]).sum::<DVec3>() / 3.0;
        Error::CutFailed { reason, at: at.into() }
    }

    /// Divides one triangle.
    pub(crate) fn triangle(&mut self, corners: [u32; 3], face: u32) -> Result<()> {
        // The boundary: vertices in order, each followed by the side of the stretch after it.
        let mut ring: Vec<(u32, bool)> = vec![];
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let hits = self.hits(a, b);
            let mut side = self.met.left[a as usize];
            let mut at = a;
            let mut pass = |node: u32| {
                if node != at {
                    ring.push((at, side));
                    at = node;
                }
                side = !side;
            };
            if a < b {
                hits.iter().for_each(|h| pass(h.node));
            } else {
                hits.iter().rev().for_each(|h| pass(h.node));
            }
            if at != b {
                ring.push((at, side));
            }
            if side != self.met.left[b as usize] {
                return Err(self.failed(corners, "an edge has its ends on the wrong sides"));
            }
        }
        let chains = self.chains(corners)?;
        if ring.len() == 3 && chains.iter().all(|c| c.0.iter().all(|v| corners.contains(v))) {
            // Whole: at most the line runs along its edges.
            let flips = |a: u32, b: u32| chains.iter().any(|c| c.2 && (c.0 == [a, b] || c.0 == [b, a]));
            let sides = [0, 1, 2].map(|k| ring[k].1 != flips(ring[k].0, ring[(k + 1) % 3].0));
            if sides[0] != sides[1] || sides[1] != sides[2] {
                return Err(self.failed(corners, "a face is on both sides"));
            }
            self.parts.push(Part { corners, face, home: corners, left: sides[0] });
        } else {
            self.divide(corners, face, &ring, &chains)?;
        }
        for ([a, b], [x, y], odd) in chains {
            if odd {
                // On closed lines the short way.
                let width = self.sheet.width();
                let y = if self.sheet.closed { y + width * ((x - y) / width).round() } else { y };
                self.cut.insert((a.min(b), a.max(b)), if a < b { [x, y] } else { [y, x] });
            }
        }
        Ok(())
    }

    /// Divides a triangle with a boundary `ring` along `chains`.
    pub(crate) fn divide(
        &mut self,
        corners: [u32; 3],
        face: u32,
        ring: &[(u32, bool)],
        chains: &Chains,
    ) -> Result<()> {
        let points = self.flat_points(corners, ring, chains);
        let Divided { mesh, number, handles, odd } =
            Divided::new(points, ring, chains).map_err(|reason| self.failed(corners, reason))?;
        let failed = |reason| self.failed(corners, reason);
        // Flood from the boundary.
        let is_odd = |a: u32, b: u32| odd.contains(&(a.min(b), a.max(b)));
        let mut sides: Vec<Option<bool>> = vec![None; mesh.num_all_faces()];
        let mut stack = vec![];
        for (k, &(node, left)) in ring.iter().enumerate() {
            let next = ring[(k + 1) % ring.len()].0;
            let edge = mesh.get_edge_from_neighbors(handles[&node], handles[&next]);
            let Some(edge) = edge else { return Err(failed("an edge of a face is missing")) };
            stack.push((edge.face().fix(), left != is_odd(node, next)));
        }
        let border =
            (0..ring.len()).map(|k| (ring[k].0, ring[(k + 1) % ring.len()].0)).collect::<FxHashSet<_>>();
        let mut new = vec![];
        while let Some((face_handle, left)) = stack.pop() {
            match sides[face_handle.index()] {
                Some(known) if known == left => continue,
                Some(_) => return Err(failed("the cut does not divide a face")),
                None => sides[face_handle.index()] = Some(left),
            }
            let Some(inner) = mesh.face(face_handle).as_inner() else {
                return Err(failed("a face is turned over"));
            };
            for edge in inner.adjacent_edges() {
                let (a, b) = (number[edge.from().index()], number[edge.to().index()]);
                if !border.contains(&(a, b)) {
                    stack.push((edge.rev().face().fix(), left != is_odd(a, b)));
                }
            }
            let own = inner.vertices().map(|v| number[v.index()]);
            let [p, q, r] = own.map(|v| self.position(v));
            let longest = p.distance_squared(q).max(q.distance_squared(r)).max(r.distance_squared(p));
            if self.tolerance.length > 0.0 && (q - p).cross(r - p).length() <= AREA * longest {
                return Err(failed("a part of a face has no area"));
            }
            new.push(Part { corners: own, face, home: corners, left });
        }
        self.parts.extend(new);
        Ok(())
    }

    /// The nodes of a triangle's `ring` and of the chains inside in the triangle's plane, its longest side 1.
    fn flat_points(&self, corners: [u32; 3], ring: &[(u32, bool)], chains: &Chains) -> Vec<(u32, DVec2)> {
        let [x, y, z] = corners.map(|v| self.vertices[v as usize]);
        let u = (y - x).normalize_or(DVec3::X);
        let normal = (y - x).cross(z - x);
        let v = normal.cross(u).normalize_or_zero();
        let size = x.distance(y).max(y.distance(z)).max(z.distance(x));
        let flat = |p: DVec3| DVec2::new((p - x).dot(u), (p - x).dot(v)) / size;
        let centre = flat((x + y + z) / 3.0);
        // Points on an edge are moved inwards by next to nothing, so that rounding makes no triangle of three of them.
        const BEND: f64 = 1e-9;
        let mut points: Vec<(u32, DVec2)> = vec![];
        let mut side = 0;
        for &(node, _) in ring {
            let p = flat(self.position(node));
            if let Some(k) = corners.iter().position(|&c| c == node) {
                side = k;
                points.push((node, p));
                continue;
            }
            let [a, b] = [side, (side + 1) % 3].map(|k| flat(self.vertices[corners[k] as usize]));
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let foot = a.lerp(b, t);
            points.push((node, foot + 4.0 * t * (1.0 - t) * BEND * (centre - foot).normalize_or_zero()));
        }
        let known = points.iter().map(|p| p.0).collect::<FxHashSet<_>>();
        let mut inner = chains.iter().flat_map(|c| c.0).filter(|v| !known.contains(v)).collect::<Vec<_>>();
        inner.sort_unstable();
        inner.dedup();
        points.extend(inner.into_iter().map(|node| (node, flat(self.position(node)))));
        points
    }
}

/// A triangle's nodes triangulated in its plane.
struct Divided {
    mesh: ConstrainedDelaunayTriangulation<Point2<f64>>,
    /// The node of each point.
    number: Vec<u32>,
    handles: FxHashMap<u32, FixedVertexHandle>,
    /// Edges, smaller node first, along which the line runs an odd number of times.
    odd: FxHashSet<(u32, u32)>,
}

impl Divided {
    /// The error says why there is none.
    fn new(points: Vec<(u32, DVec2)>, ring: &[(u32, bool)], chains: &Chains) -> Result<Self, &'static str> {
        let mut mesh: ConstrainedDelaunayTriangulation<Point2<f64>> = ConstrainedDelaunayTriangulation::new();
        let mut number: Vec<u32> = vec![];
        let mut handles = FxHashMap::default();
        for (node, p) in points {
            // A corner on the axis may be off it by 1e-48, which is refused.
            let place = mitigate_underflow(Point2::new(p.x, p.y));
            let handle = mesh.insert(place).map_err(|_| "a face has no area")?;
            if handle.index() < number.len() {
                return Err("two points of the cut coincide");
            }
            number.push(node);
            handles.insert(node, handle);
        }
        let mut odd = FxHashSet::default();
        let edges = (0..ring.len()).map(|k| ([ring[k].0, ring[(k + 1) % ring.len()].0], false));
        let all = edges.chain(chains.iter().map(|c| (c.0, c.2)));
        for (ends, is_odd) in all {
            let [a, b] = ends.map(|v| handles.get(&v).copied());
            let (Some(a), Some(b)) = (a, b) else { return Err("a point of the cut is missing") };
            if mesh.get_edge_from_neighbors(a, b).is_none_or(|e| !e.is_constraint_edge())
                && (mesh.try_add_constraint(a, b).is_empty() || mesh.get_edge_from_neighbors(a, b).is_none())
            {
                return Err("stretches of the cut meet where they should not");
            }
            if is_odd {
                odd.insert((ends[0].min(ends[1]), ends[0].max(ends[1])));
            }
        }
        Ok(Self { mesh, number, handles, odd })
    }
}

/// A chain's edge: both ends with their places, counted once for each time the line runs along it.
pub(in crate::cut) type Chains = Vec<([u32; 2], [f64; 2], bool)>;
