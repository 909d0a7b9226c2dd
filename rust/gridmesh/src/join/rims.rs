//! The rims of what is left: simple closed loops.

use super::collar::Left;
use super::parts::{Around, Parts};

/// Pieces with a rim and fewer vertices inside go.
const FEW: usize = 4;

/// What stays of the parts.
pub(super) struct Outside {
    /// Faces that stay.
    pub faces: Vec<bool>,
    /// Closed loops of the vertices between them and what goes, as the faces run; no vertex is in them twice.
    pub rims: Vec<Vec<u32>>,
}

/// Vertices that go, and faces whose vertices all stay but that go.
struct Trim<'a> {
    parts: &'a Parts,
    around: Around,
    gone: Vec<bool>,
    faces: Vec<bool>,
}

impl Outside {
    /// Takes away, beyond the vertices `gone`, what makes the rims simple: vertices in which they would touch, teeth of one
    /// face, pieces and strips without a vertex inside.
    pub fn new(parts: &Parts, left: &Left, gone: Vec<bool>) -> Outside {
        let faces = left.faces.clone();
        let mut trim = Trim { parts, around: parts.around(0, 0), gone, faces };
        for f in 0..parts.n_faces() as u32 {
            trim.faces[f as usize] &= parts.face(f).iter().all(|&v| !trim.gone[v as usize]);
        }
        while trim.unalter(left) || trim.pinches() || trim.teeth() || trim.strips() {}
        let rims = trim.loops();
        Outside { faces: trim.faces, rims }
    }
}

impl Trim<'_> {
    fn remove(&mut self, v: u32) {
        if !std::mem::replace(&mut self.gone[v as usize], true) {
            for corner in self.around.of(v) {
                self.faces[corner.face as usize] = false;
            }
        }
    }

    /// The face beyond the edge from `v` to `next`.
    fn across(&self, v: u32, next: u32) -> Option<u32> {
        self.around.of(v).iter().find(|c| c.before == next).map(|c| c.face)
    }

    /// Whether the edge from `v` to `next` of a face that stays is one of a rim.
    fn is_rim(&self, v: u32, next: u32) -> bool {
        self.across(v, next).is_some_and(|f| !self.faces[f as usize])
    }

    /// Faces that the union has divided in another way go where they touch what goes: there it has other edges.
    fn unalter(&mut self, left: &Left) -> bool {
        let mut changed = false;
        for f in 0..self.parts.n_faces() as u32 {
            if !left.altered[f as usize] || !self.faces[f as usize] {
                continue;
            }
            let own = self.parts.face(f);
            let touches = (0..own.len()).any(|k| self.is_rim(own[k], own[(k + 1) % own.len()]));
            if touches {
                self.faces[f as usize] = false;
                changed = true;
            }
        }
        changed
    }

    fn pinches(&mut self) -> bool {
        let n = self.parts.vertices.len() as u32;
        let bad = |v: &u32| {
            let stays = |c: &&super::parts::Corner| self.faces[c.face as usize];
            self.around.of(*v).iter().filter(stays).filter(|c| self.is_rim(*v, c.next)).count() > 1
        };
        let found = (0..n).filter(|&v| !self.gone[v as usize]).filter(bad).collect::<Vec<_>>();
        found.iter().for_each(|&v| self.remove(v));
        !found.is_empty()
    }

    fn teeth(&mut self) -> bool {
        let tooth = |f: &u32| {
            let own = self.parts.face(*f);
            let m = own.len();
            let free = (0..m).filter(|&k| self.is_rim(own[k], own[(k + 1) % m])).count();
            free + 1 >= m
        };
        let all = 0..self.parts.n_faces() as u32;
        let found = all.filter(|&f| self.faces[f as usize]).filter(tooth).collect::<Vec<_>>();
        found.iter().for_each(|&f| self.faces[f as usize] = false);
        !found.is_empty()
    }

    /// Connected faces with a rim and hardly a vertex inside.
    fn strips(&mut self) -> bool {
        let n = self.parts.n_faces();
        let mut seen = vec![false; n];
        let mut found = vec![];
        for start in 0..n as u32 {
            if seen[start as usize] || !self.faces[start as usize] {
                continue;
            }
            seen[start as usize] = true;
            let (mut piece, mut next) = (vec![start], 0);
            let (mut inner, mut rim) = (0, false);
            while let Some(&f) = piece.get(next) {
                next += 1;
                let own = self.parts.face(f);
                for k in 0..own.len() {
                    let fan = self.around.of(own[k]);
                    let all = fan.iter().all(|c| self.faces[c.face as usize]);
                    rim |= !all;
                    // Each vertex once, in the first of its faces.
                    inner += usize::from(all && fan[0].face == f);
                    let beyond = self.across(own[k], own[(k + 1) % own.len()]);
                    if let Some(g) = beyond.filter(|&g| self.faces[g as usize] && !seen[g as usize]) {
                        seen[g as usize] = true;
                        piece.push(g);
                    }
                }
            }
            if rim && inner < FEW {
                found.extend(piece);
            }
        }
        found.iter().for_each(|&f| self.faces[f as usize] = false);
        !found.is_empty()
    }

    fn loops(&self) -> Vec<Vec<u32>> {
        let n = self.parts.vertices.len();
        let mut following = vec![u32::MAX; n];
        for v in 0..n as u32 {
            for corner in self.around.of(v).iter().filter(|c| self.faces[c.face as usize]) {
                if self.is_rim(v, corner.next) {
                    following[v as usize] = corner.next;
                }
            }
        }
        let mut rims = vec![];
        for v in 0..n {
            let mut rim = vec![];
            let mut at = v;
            while following[at] != u32::MAX {
                rim.push(at as u32);
                at = std::mem::replace(&mut following[at], u32::MAX) as usize;
            }
            if !rim.is_empty() {
                rims.push(rim);
            }
        }
        rims
    }
}
