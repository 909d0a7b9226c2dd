//! The faces of a patch: squares within a lattice path, with a row around them or not, one of them a triangle or none.

use glam::DVec2;

use crate::fill::planar::mean_value::{spread, step};
use crate::lattice::axial::Axial;
use crate::lattice::grid::Square;
use crate::lattice::squares::squares_within;
use crate::path::placement::Laid;

/// A closed path on the square lattice, and what is made of it.
pub(super) struct Plan {
    /// In the order of the loop, the region on its left.
    pub path: Vec<Axial>,
    /// The place on the path of a vertex that the loop has not got: its quad is to be a triangle.
    pub apex: Option<usize>,
    /// The loop lies a row of quads around the path, not on it.
    pub belt: bool,
}

impl Plan {
    /// A row of quads along a loop of three or four vertices, and one face inside.
    pub fn ring(n: usize) -> Plan {
        let path = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[q, r]| Axial::new(q, r)).to_vec();
        Plan { path, apex: (n == 3).then_some(3), belt: true }
    }
}

/// The faces over vertices of which those of the loop come first.
pub(super) struct Cells {
    pub n_loop: usize,
    /// Counter-clockwise.
    pub quads: Vec<[u32; 4]>,
    pub odd: Option<[u32; 3]>,
    /// Where the vertices are before they are brought to the loop.
    pub start: Vec<DVec2>,
    /// Lattice points of the loop or, behind a belt, of the row after it; then those inside.
    lattice: Vec<Axial>,
    belt: bool,
}

impl Cells {
    /// The loop itself as a face.
    pub fn face(n: usize) -> Cells {
        let (quads, odd) = if n == 4 { (vec![[0, 1, 2, 3]], None) } else { (vec![], Some([0, 1, 2])) };
        Cells::free(n, quads, odd, vec![DVec2::ZERO; n])
    }

    /// Faces that are not from a lattice.
    pub fn free(n_loop: usize, quads: Vec<[u32; 4]>, odd: Option<[u32; 3]>, start: Vec<DVec2>) -> Cells {
        Cells { n_loop, quads, odd, start, lattice: vec![], belt: false }
    }

    /// The faces of a plan; none if the vertex that is to be left out has not one quad alone.
    pub fn of(plan: &Plan) -> Option<Cells> {
        let (points, squares) = squares_within(std::slice::from_ref(&plan.path));
        let all = plan.path.len();
        let n = all - usize::from(plan.apex.is_some());
        let behind = if plan.belt { n as u32 } else { 0 };
        let number = |v: u32| match plan.apex {
            Some(apex) if v as usize > apex => v - 1 + behind,
            _ => v + behind,
        };
        let mut quads = vec![];
        if plan.belt {
            let row = (0..n as u32).map(|i| {
                let next = (i + 1) % n as u32;
                [i, next, next + behind, i + behind]
            });
            quads.extend(row);
        }
        let mut odd = None;
        for quad in squares {
            match plan.apex.and_then(|apex| quad.iter().position(|&v| v as usize == apex)) {
                None => quads.push(quad.map(number)),
                Some(_) if odd.is_some() => return None,
                Some(k) => odd = Some([1, 2, 3].map(|ahead| number(quad[(k + ahead) % 4]))),
            }
        }
        if odd.is_some() != plan.apex.is_some() {
            return None;
        }
        let kept = |i: &usize| Some(*i) != plan.apex;
        let lattice: Vec<Axial> = (0..points.len()).filter(kept).map(|i| points[i]).collect();
        let mut start = vec![];
        if plan.belt {
            start.extend((0..all).filter(kept).map(|i| beside(&plan.path, i)));
        }
        start.extend(lattice.iter().map(|&p| Square::units(p)));
        Some(Cells { n_loop: n, quads, odd, start, lattice, belt: plan.belt })
    }

    /// A guess of the harmonic extension of values at the loop to the other vertices.
    pub fn spread(&self, values: &[DVec2]) -> Vec<DVec2> {
        let row = if self.belt { values.to_vec() } else { vec![] };
        let (outline, inner) = self.lattice.split_at(self.n_loop);
        [row, spread::<Square>(outline, values, inner)].concat()
    }

    /// Waves of fewer edges are not in that guess.
    pub fn wave(&self) -> f64 {
        f64::from(step(self.n_loop))
    }

    /// Two triangles for each quad, cut where it is shorter, from its first vertex or its second on; then the odd one.
    pub fn triangles(&self, positions: &[DVec2]) -> Vec<[u32; 3]> {
        let at = |v: u32| positions[v as usize];
        let cut = |&[a, b, c, d]: &[u32; 4]| {
            if at(a).distance_squared(at(c)) <= at(b).distance_squared(at(d)) {
                [[a, b, c], [a, c, d]]
            } else {
                [[b, c, d], [b, d, a]]
            }
        };
        self.quads.iter().flat_map(cut).chain(self.odd).collect()
    }
}

/// A place a step outside a path, beside one of its vertices.
fn beside(path: &[Axial], i: usize) -> DVec2 {
    let n = path.len();
    let right = |from: Axial, to: Axial| -(Square::units(to) - Square::units(from)).perp();
    let (before, after) = (right(path[(i + n - 1) % n], path[i]), right(path[i], path[(i + 1) % n]));
    let out = if before == after { before } else { before + after };
    Square::units(path[i]) + out
}

