//! One vertex for each fan of faces: what meets in a vertex or along an edge alone is taken apart there.

use std::f64::consts::TAU;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::parts::{Around, Corner, Parts};
use crate::error::Result;

/// Faces with less than this angle between them, in radians, lie on each other.
const SAME: f64 = 1e-9;

const CROWDED: &str = "an edge joins more than two faces";

/// The face beyond each edge with more than two faces, for each of its faces.
type Beyond = FxHashMap<([u32; 2], u32), u32>;

impl Parts {
    /// Refuses the last part if it is not closed, and gives each fan of faces at one of its vertices a vertex of its own.
    pub(super) fn separate(&mut self, part: usize) -> Result<()> {
        let [vertex, face, _] = self.first[part];
        let mut around = self.around(vertex, face);
        let mut crowded = self.crowded(part, &around)?;
        for inside in [true, false] {
            let mut beyond = Beyond::default();
            for &edge in &crowded {
                let paired = self.pair(edge, inside, &around, &mut beyond);
                paired.ok_or_else(|| self.not_closed(part, CROWDED, edge[0]))?;
            }
            self.divide_fans(part, &around, &beyond);
            if crowded.is_empty() {
                return Ok(());
            }
            around = self.around(vertex, face);
            crowded = self.crowded(part, &around)?;
        }
        crowded.first().map_or(Ok(()), |edge| Err(self.not_closed(part, CROWDED, edge[0])))
    }

    /// Gives each fan at the vertices of the last part a vertex of its own.
    fn divide_fans(&mut self, part: usize, around: &Around, beyond: &Beyond) {
        let [vertex, _, triangle] = self.first[part];
        for v in vertex..self.vertices.len() as u32 {
            for fan in fans(v, around.of(v), beyond).into_iter().skip(1) {
                let new = self.vertices.len() as u32;
                self.vertices.push(self.vertices[v as usize]);
                self.numbers.push(self.numbers[v as usize]);
                self.separated += 1;
                let rename = |corner: &mut u32| *corner = if *corner == v { new } else { *corner };
                for f in fan {
                    let [from, to] = [f, f + 1].map(|f| self.offsets[f as usize] as usize);
                    self.corners[from..to].iter_mut().for_each(rename);
                    let own = &self.face_of[triangle as usize..];
                    let [from, to] = [f, f + 1].map(|f| triangle as usize + own.partition_point(|&g| g < f));
                    self.triangles[from..to].iter_mut().flatten().for_each(rename);
                }
            }
        }
    }

    /// The edges with more than two faces, half of them to each side.
    fn crowded(&self, part: usize, around: &Around) -> Result<Vec<[u32; 2]>> {
        let mut found = vec![];
        for v in self.first[part][0]..self.vertices.len() as u32 {
            let fan = around.of(v);
            for other in fan.iter().flat_map(|w| [w.next, w.before]) {
                let leaving = fan.iter().filter(|w| w.next == other).count();
                let arriving = fan.iter().filter(|w| w.before == other).count();
                let bad = |reason| Err(self.not_closed(part, reason, v));
                match (leaving, arriving) {
                    (1, 1) => {}
                    (1, 0) | (0, 1) => return bad("an edge has a face on one side only"),
                    (2, 0) | (0, 2) => return bad("two faces at an edge are wound against each other"),
                    _ if leaving != arriving => return bad(CROWDED),
                    _ => found.push([v.min(other), v.max(other)]),
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    /// Pairs the faces at an edge, each with that across what they enclose, or across what is empty if not `inside`; None if
    /// they lie on each other so that no order is right.
    fn pair(&self, edge: [u32; 2], inside: bool, around: &Around, beyond: &mut Beyond) -> Option<()> {
        let [a, b] = edge;
        let along = (self.vertices[b as usize] - self.vertices[a as usize]).try_normalize()?;
        let (x, y) = along.any_orthonormal_pair();
        let mut faces = vec![];
        for corner in around.of(a).iter().filter(|w| w.next == b || w.before == b) {
            let forward = corner.next == b;
            let inward = self.normal(corner.face).cross(if forward { along } else { -along });
            let inward = inward.try_normalize()?;
            faces.push((libm::atan2(inward.dot(y), inward.dot(x)), forward, corner.face));
        }
        faces.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        let same = |a: &(f64, bool, u32), b: &(f64, bool, u32)| {
            let turn = (b.0 - a.0).rem_euclid(TAU);
            turn.min(TAU - turn) < SAME
        };
        let n = faces.len();
        let start = (0..n)
            .find(|&k| !same(&faces[(k + n - 1) % n], &faces[k]) && !same(&faces[k], &faces[(k + 1) % n]))?;
        faces.rotate_left(start);
        for k in 1..n - 1 {
            if faces[k].1 == faces[k - 1].1 && same(&faces[k], &faces[k + 1]) {
                faces.swap(k, k + 1);
            }
        }
        // Going around the edge, what is enclosed begins at a face that runs backward, what is empty at one that runs forward.
        let ends = faces[0].1 == inside;
        faces.rotate_left(usize::from(ends));
        for pair in faces.chunks(2) {
            let &[(_, first, one), (_, second, two)] = pair else { return None };
            if first == inside || second != inside {
                return None;
            }
            beyond.insert((edge, one), two);
            beyond.insert((edge, two), one);
        }
        Some(())
    }

    /// A vector along the outward normal of a face.
    fn normal(&self, face: u32) -> DVec3 {
        let own = self.face(face);
        let at = |k: usize| self.vertices[own[k % own.len()] as usize] - self.vertices[own[0] as usize];
        (1..own.len() - 1).map(|k| at(k).cross(at(k + 1))).sum()
    }
}

/// The faces around a vertex, for each fan those it consists of.
fn fans(v: u32, corners: &[Corner], beyond: &Beyond) -> Vec<Vec<u32>> {
    let mut seen = vec![false; corners.len()];
    let mut found = vec![];
    while let Some(start) = seen.iter().position(|seen| !seen) {
        let (mut fan, mut at) = (vec![], start);
        while !seen[at] {
            seen[at] = true;
            let &Corner { next, face, .. } = &corners[at];
            fan.push(face);
            let paired = beyond.get(&([v.min(next), v.max(next)], face));
            let fits = |w: &Corner| w.before == next && paired.is_none_or(|&face| w.face == face);
            at = corners.iter().position(fits).unwrap_or(start);
        }
        found.push(fan);
    }
    found
}
