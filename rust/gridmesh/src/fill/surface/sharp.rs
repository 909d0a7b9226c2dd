//! Hard edges: creases of the surface around a loop go on into the patch and meet where its planes do.
//!
//! Creases that run into the loop part it into chains, each with a plane beside it. Two creases are joined by a
//! straight line, three or more meet in the point that the planes have in common; then every part between them is a
//! planar polygon, and is filled as such. What does not fit into this picture is left to a smooth patch.

use glam::{DMat3, DVec2, DVec3};
use rustc_hash::FxHashSet;

use super::fit::{Faults, Solved, rim_angle};
use super::patchwork::Patchwork;
use crate::error::{Error, Result};
use crate::fill::filled::Shape;
use crate::fill::layout::unroll::{Unrolled, Unrolling, area_vector, is_simple};
use crate::fill::loops::reserve::{room, wanted};
use crate::fill::one::{Attempt, Task};
use crate::fill::planar::flat::{FlatOptions, fill_flat};
use crate::fill::planar::flat_patch::FlatFill;
use crate::fill::planar::quads::fill_flat_quads;
use crate::options::CellShape;
use crate::progress::{Clock, Progress};

/// How far points may be off a plane or a line, in sizes of the loop.
const OFF: f64 = 0.02;

/// Cosine of how much the faces beside a chain may differ from their mean.
const ALIKE: f64 = 0.966;

/// Cosine of how much a crease may turn where it enters the patch.
const STRAIGHT: f64 = 0.9;

/// Squared determinant of the normals of planes that have a point in common, at least.
const CLEAR: f64 = 0.01;

/// How far that point may be from the middle of the loop, in sizes of the loop.
const FAR: f64 = 1.5;

/// A stretch of the loop from one crease to the next, and the plane beside it.
struct Chain {
    /// Places on the loop, both ends included.
    places: Vec<usize>,
    normal: DVec3,
    offset: f64,
}

/// A patch of planar parts. Vertices are numbered as in a patchwork: the loop's, then those of creases.
struct Plan {
    parts: Vec<Part>,
    /// Positions of the vertices that creases have besides those of the loop.
    along: Vec<DVec3>,
    /// Edges that are creases.
    creases: Vec<[u32; 2]>,
    /// The last one of `along` is a point in which so many of them meet.
    apex: Option<usize>,
}

struct Part {
    boundary: Vec<u32>,
    normal: DVec3,
}

impl Task<'_> {
    /// For each place on the loop the direction in which a crease of the surroundings runs into it.
    pub(in crate::fill) fn creases(&self, angle: f64) -> Vec<Option<DVec3>> {
        let loop_ = &self.checked.vertices;
        let n = loop_.len();
        let marked: FxHashSet<[u32; 2]> =
            self.job.options.creases.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
        let into = |k: usize| {
            let v = self.rim.local(loop_[k])?;
            let beside = [loop_[(k + n - 1) % n], loop_[(k + 1) % n]];
            let across = self.rim.neighbours(v).into_iter().filter(|&u| {
                let (a, b) = (self.rim.ids[v as usize], self.rim.ids[u as usize]);
                !beside.contains(&b) && (marked.contains(&[a.min(b), a.max(b)]) || self.bends(v, u, angle))
            });
            let directions = across.map(|u| (self.at(v) - self.at(u)).normalize_or_zero());
            directions.reduce(|a, b| (a + b).normalize_or(a))
        };
        (0..n).map(into).collect()
    }

    /// Whether two triangles meet at an edge, with more than `angle` between their normals.
    fn bends(&self, v: u32, u: u32, angle: f64) -> bool {
        let beside = self.rim.around(v).iter().map(|&t| self.rim.triangles[t as usize]);
        let beside = beside.filter(|t| t.contains(&u)).collect::<Vec<_>>();
        let [a, b] = beside[..] else { return false };
        let normal = |t: [u32; 3]| {
            let [p, q, r] = t.map(|v| self.at(v));
            let along = (0..3).any(|i| t[i] == v && t[(i + 1) % 3] == u);
            (q - p).cross(r - p) * if along { 1.0 } else { -1.0 }
        };
        // Each as if wound along the edge: in one plane they are opposite.
        normal(a).angle_between(-normal(b)) > angle
    }

    fn at(&self, v: u32) -> DVec3 {
        self.job.vertices[self.rim.ids[v as usize] as usize]
    }

    /// A patch that keeps `creases`, if there is a good one.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub(in crate::fill) fn sharp(
        &self,
        creases: &[Option<DVec3>],
        clock: &mut Clock,
        progress: Progress<'_>,
    ) -> Result<Option<Attempt>> {
        let loop_ = &self.checked.vertices;
        let around = loop_.iter().map(|&v| self.job.vertices[v as usize]).collect::<Vec<_>>();
        let Some(plan) = Layout::new(self, &around, creases).and_then(|layout| layout.plan()) else {
            return Ok(None);
        };
        let made = self.carried_out(&plan, &around, progress)?;
        clock.stage("sharp");
        Ok(made)
    }

    /// Fills the parts of a plan, one after the other.
    fn carried_out(&self, plan: &Plan, around: &[DVec3], progress: Progress<'_>) -> Result<Option<Attempt>> {
        let loop_ = &self.checked.vertices;
        let n = loop_.len();
        let polygons = &self.job.options.polygons;
        let (wanted, room) = (wanted(loop_, self.rim, polygons), room(loop_, self.rim, polygons));
        let cells = self.job.options.cells;
        let odd = plan.parts.iter().filter(|part| part.boundary.len() % 2 == 1).count();
        if cells == CellShape::Quad && odd != n % 2 {
            return Ok(None);
        }
        let mut positions = [around, &plan.along].concat();
        let mut flat = vec![DVec2::ZERO; positions.len()];
        // Of quads the pairs first, then the triangle of an odd part.
        let (mut triangles, mut last): (Vec<[u32; 3]>, Vec<[u32; 3]>) = (vec![], vec![]);
        let mut used = FxHashSet::default();
        let mut quads = 0;
        let mut largest: Option<FlatFill> = None;
        for (i, part) in plan.parts.iter().enumerate() {
            let here = progress.part(i as f64, i as f64 + 1.0);
            let here = here.part(0.0, 1.0 / plan.parts.len() as f64);
            let (e, f) = part.normal.any_orthonormal_pair();
            let origin = positions[part.boundary[0] as usize];
            let laid = |p: DVec3| DVec2::new((p - origin).dot(e), (p - origin).dot(f));
            let polygon = part.boundary.iter().map(|&v| laid(positions[v as usize])).collect::<Vec<_>>();
            let taken = |i: usize, j: usize| {
                let (a, b) = (part.boundary[i], part.boundary[j]);
                let old = (a.max(b) as usize) < n && self.taken.has(a as usize, b as usize);
                old || used.contains(&[a.min(b), a.max(b)])
            };
            let single = !self.taken.face;
            let made = match cells {
                CellShape::Triangle => {
                    let shares = part.boundary.iter().map(|&v| plan.share(v as usize, &wanted));
                    let options = FlatOptions { single, ..FlatOptions::default() };
                    fill_flat(&polygon, &shares.collect::<Vec<_>>(), &taken, &options, here)
                }
                CellShape::Quad => {
                    let shares = part.boundary.iter().map(|&v| plan.share_of_quads(v as usize, &room));
                    fill_flat_quads(&polygon, &shares.collect::<Vec<_>>(), &taken, single, here)
                }
            };
            let made = match made {
                Err(Error::NoPatch { .. } | Error::Solver { .. }) => return Ok(None),
                made => made?,
            };
            let patch = &made.patch;
            if made.folded || made.quality.repeated > 0 {
                return Ok(None);
            }
            let (first, count) = (positions.len(), part.boundary.len());
            let name = |v: u32| match part.boundary.get(v as usize) {
                Some(&v) => v,
                None => (first + v as usize - count) as u32,
            };
            let (pairs, rest) = patch.triangles.split_at(2 * patch.quads);
            let pairs = pairs.iter().map(|t| t.map(name)).collect::<Vec<_>>();
            let rest = rest.iter().map(|t| t.map(name)).collect::<Vec<_>>();
            used.extend(patch.sides().map(|side| side.map(name)).map(|[a, b]| [a.min(b), a.max(b)]));
            quads += patch.quads;
            triangles.extend(pairs);
            last.extend(rest);
            positions.extend(patch.interior.iter().map(|p| origin + p.x * e + p.y * f));
            for (&v, &p) in part.boundary.iter().zip(&polygon) {
                flat[v as usize] = p;
            }
            flat.extend(&patch.interior);
            if largest.as_ref().is_none_or(|known| known.patch.triangles.len() < patch.triangles.len()) {
                largest = Some(made);
            }
        }
        let Some(patch) = largest else { return Ok(None) };
        triangles.extend(last);
        let work = Patchwork::new(loop_, positions.len() - n, &triangles, self.rim, 1)?.of_quads(quads);
        positions.extend(work.outer.iter().map(|&v| self.job.vertices[v as usize]));
        let faults = Faults::of(&work, &positions, 1, progress)?;
        if faults != Faults::default() {
            return Ok(None);
        }
        let rim_angle = rim_angle(&work, &positions);
        let shape = Shape {
            work,
            loop_: loop_.clone(),
            reversed: self.checked.reversed,
            bridged: vec![],
            flat,
            smooth: self.job.options.smooth,
            vertices: self.job.vertices.len(),
            positions: vec![],
            creases: plan.creases.clone(),
        };
        let unrolled = Unrolled { points: vec![], method: Unrolling::Projected, distortion: 0.0 };
        let solved = Solved { positions, faults, repaired: 0, rim_angle };
        Ok(Some(Attempt { unrolled, patch, shape, solved, worth: None }))
    }
}

impl Plan {
    /// The valence that a vertex should have in each of the parts that it belongs to.
    fn share(&self, v: usize, wanted: &[i32]) -> i32 {
        let among = self.parts.iter().filter(|part| part.boundary.contains(&(v as u32))).count() as i32;
        match wanted.get(v) {
            // Parts share the edge between them.
            Some(&all) => ((f64::from(all + among - 1)) / f64::from(among.max(1))).round() as i32,
            None if self.apex == Some(v) => (f64::from(6 + among) / f64::from(among.max(1))).round() as i32,
            None => 4,
        }
    }

    /// The number of quads that a vertex should have in each of the parts that it belongs to.
    fn share_of_quads(&self, v: usize, room: &[f64]) -> f64 {
        let among = self.parts.iter().filter(|part| part.boundary.contains(&(v as u32))).count();
        room.get(v).copied().unwrap_or(4.0) / among.max(1) as f64
    }
}

/// A loop parted by creases.
struct Layout<'a> {
    task: &'a Task<'a>,
    around: &'a [DVec3],
    creases: &'a [Option<DVec3>],
    /// Places on the loop where creases run into it.
    corners: Vec<usize>,
    chains: Vec<Chain>,
    size: f64,
    middle: DVec3,
}

impl<'a> Layout<'a> {
    /// `None` without two creases, or if there is not one plane beside each chain.
    fn new(task: &'a Task<'a>, around: &'a [DVec3], creases: &'a [Option<DVec3>]) -> Option<Self> {
        let n = around.len();
        let corners = (0..n).filter(|&k| creases[k].is_some()).collect::<Vec<_>>();
        if corners.len() < 2 {
            return None;
        }
        let (low, high) = around
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let size = low.distance(high);
        let outside = task.outside();
        let chain = |i: usize| {
            let (from, to) = (corners[i], corners[(i + 1) % corners.len()]);
            let steps = (to + n - from - 1) % n + 1;
            let normals = (0..steps).map(|s| outside[(from + s) % n]).collect::<Option<Vec<_>>>()?;
            let normal = normals.iter().sum::<DVec3>().try_normalize()?;
            if normals.iter().any(|m| m.dot(normal) < ALIKE * m.length()) {
                return None;
            }
            let places = (0..=steps).map(|s| (from + s) % n).collect::<Vec<_>>();
            let heights = places.iter().map(|&k| around[k].dot(normal));
            let offset = heights.sum::<f64>() / places.len() as f64;
            let off = |&k: &usize| (around[k].dot(normal) - offset).abs() <= OFF * size;
            places.iter().all(off).then_some(Chain { places, normal, offset })
        };
        let chains = (0..corners.len()).map(chain).collect::<Option<Vec<_>>>()?;
        let middle = around.iter().sum::<DVec3>() / n as f64;
        Some(Layout { task, around, creases, corners, chains, size, middle })
    }

    fn plan(&self) -> Option<Plan> {
        let plan = self.in_one_plane().or_else(|| match self.corners[..] {
            [a, b] => self.across(a, b),
            _ => self.to_apex(),
        })?;
        // Each part must be a simple polygon as seen from its own side.
        let position = |v: u32| {
            let v = v as usize;
            self.around.get(v).copied().unwrap_or_else(|| plan.along[v - self.around.len()])
        };
        let simple = |part: &Part| {
            let (e, f) = part.normal.any_orthonormal_pair();
            let laid = part.boundary.iter().map(|&v| position(v)).map(|p| DVec2::new(p.dot(e), p.dot(f)));
            is_simple(&laid.collect::<Vec<_>>())
        };
        plan.parts.iter().all(simple).then_some(plan)
    }

    /// The loop lies in one plane; every chain is straight, with a crease along it, or has this plane beside it.
    fn in_one_plane(&self) -> Option<Plan> {
        let normal = area_vector(self.around).try_normalize()?;
        let height = self.middle.dot(normal);
        if self.around.iter().any(|p| (p.dot(normal) - height).abs() > OFF * self.size) {
            return None;
        }
        let mut creases = vec![];
        for chain in &self.chains {
            if chain.normal.dot(normal) > ALIKE {
                continue;
            }
            if !self.is_straight(&chain.places) {
                return None;
            }
            creases.extend(chain.places.windows(2).map(|pair| [pair[0] as u32, pair[1] as u32]));
        }
        if creases.is_empty() {
            return None;
        }
        let boundary = (0..self.around.len() as u32).collect();
        Some(Plan { parts: vec![Part { boundary, normal }], along: vec![], creases, apex: None })
    }

    fn is_straight(&self, places: &[usize]) -> bool {
        let (from, to) = (self.around[places[0]], self.around[places[places.len() - 1]]);
        let along = (to - from).normalize_or_zero();
        let off = |p: DVec3| (p - from) - (p - from).dot(along) * along;
        places.iter().all(|&k| off(self.around[k]).length() <= OFF * self.size)
    }

    /// A crease straight across the loop.
    fn across(&self, a: usize, b: usize) -> Option<Plan> {
        let (from, to) = (self.around[a], self.around[b]);
        if !self.goes_on(a, to) || !self.goes_on(b, from) {
            return None;
        }
        let least = if self.task.taken.has(a, b) { 2 } else { 1 };
        let [first, second] = &self.chains[..] else { return None };
        let (along, line) = self.line(from, to, least, 0, self.parity(first.places.len() - 1));
        let path = [&[a as u32], line.as_slice(), &[b as u32]].concat();
        let part = |chain: &Chain, line: Vec<u32>| {
            let boundary = chain.places.iter().map(|&k| k as u32).chain(line).collect();
            Part { boundary, normal: chain.normal }
        };
        let back = line.iter().rev().copied().collect();
        let parts = vec![part(first, back), part(second, line)];
        let creases = path.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        Some(Plan { parts, along, creases, apex: None })
    }

    /// Creases that meet in the point that the planes have in common.
    fn to_apex(&self) -> Option<Plan> {
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for chain in &self.chains {
            let m = chain.normal;
            matrix += DMat3::from_cols(m * m.x, m * m.y, m * m.z);
            right += m * (chain.offset - m.dot(self.middle));
        }
        if matrix.determinant().is_nan() || matrix.determinant() < CLEAR {
            return None;
        }
        let apex = self.middle + matrix.inverse() * right;
        let off = |chain: &Chain| (chain.normal.dot(apex) - chain.offset).abs() > OFF * self.size;
        let far = apex.distance(self.middle) > FAR * self.size;
        if far || self.chains.iter().any(off) || !self.corners.iter().all(|&k| self.goes_on(k, apex)) {
            return None;
        }
        let n = self.around.len();
        let (mut along, mut lines) = (vec![], vec![]);
        for (i, &k) in self.corners.iter().enumerate() {
            // With the line before, the chain between them makes an even loop.
            let parity = lines.last().and_then(|before: &Vec<u32>| {
                self.parity(before.len() + 1 + self.chains[i - 1].places.len() - 1)
            });
            let (points, line) = self.line(self.around[k], apex, 1, along.len(), parity);
            along.extend(points);
            lines.push(line);
        }
        let last = (n + along.len()) as u32;
        along.push(apex);
        let (mut parts, mut creases) = (vec![], vec![]);
        for (i, chain) in self.chains.iter().enumerate() {
            let (here, next) = (&lines[i], &lines[(i + 1) % lines.len()]);
            let mut boundary = chain.places.iter().map(|&k| k as u32).collect::<Vec<_>>();
            boundary.extend(next.iter().copied().chain([last]).chain(here.iter().rev().copied()));
            parts.push(Part { boundary, normal: chain.normal });
            let path = [&[self.corners[i] as u32], here.as_slice(), &[last]].concat();
            creases.extend(path.windows(2).map(|pair| [pair[0], pair[1]]));
        }
        Some(Plan { parts, along, creases, apex: Some(last as usize) })
    }

    /// Whether a crease would go on from a corner about as it came.
    fn goes_on(&self, corner: usize, to: DVec3) -> bool {
        let ahead = (to - self.around[corner]).normalize_or_zero();
        self.creases[corner].is_some_and(|came| came.dot(ahead) > STRAIGHT)
    }

    /// Whether a line beside so many edges has to be of an even or an odd number, if that matters.
    fn parity(&self, beside: usize) -> Option<usize> {
        (self.task.job.options.cells == CellShape::Quad).then_some(beside % 2)
    }

    /// Points between two others, about as far apart as the loop's vertices are, and their numbers if `before`
    /// others come first.
    fn line(
        &self,
        from: DVec3,
        to: DVec3,
        least: usize,
        before: usize,
        parity: Option<usize>,
    ) -> (Vec<DVec3>, Vec<u32>) {
        let n = self.around.len();
        let length = (0..n).map(|k| self.around[k].distance(self.around[(k + 1) % n])).sum::<f64>();
        let exact = from.distance(to) * n as f64 / length;
        let mut steps = (exact.round() as usize).clamp(least, 4 * n);
        if parity.is_some_and(|parity| steps % 2 != parity) {
            steps = if steps > least && (steps as f64) > exact { steps - 1 } else { steps + 1 };
        }
        let points = (1..steps).map(|s| from.lerp(to, s as f64 / steps as f64)).collect::<Vec<_>>();
        let numbers = (0..points.len()).map(|i| (n + before + i) as u32).collect();
        (points, numbers)
    }
}
