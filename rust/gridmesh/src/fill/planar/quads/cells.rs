//! The faces of a patch: squares within a lattice path, with a row around them or not, one of them a triangle or none.

use glam::DVec2;

use crate::error::Result;
use crate::fill::planar::mean_value::{spread, step};
use crate::lattice::axial::Axial;
use crate::lattice::grid::Square;
use crate::lattice::squares::squares_within;
use crate::path::placement::Laid;
use crate::progress::Progress;

/// What a vertex of a path stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Name {
    /// A vertex of the loop.
    Loop(usize),
    /// A new one, behind a vertex of the loop.
    Behind(usize),
    /// One that is to be left out: its only quad becomes a triangle.
    Apex,
}

/// Where a row of quads lies between the loop and the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Belt {
    None,
    /// Along the whole loop.
    Whole,
    /// From one vertex of the loop to another, which have one quad each: the first and the last of the row.
    Part {
        from: usize,
        to: usize,
    },
}

impl Belt {
    /// Whether the path goes behind a vertex of a loop of n.
    pub fn covers(self, k: usize, n: usize) -> bool {
        match self {
            Belt::None => false,
            Belt::Whole => true,
            Belt::Part { from, to } => (1..(to + n - from) % n).contains(&((k + n - from) % n)),
        }
    }
}

/// A closed path on the square lattice, and what is made of it.
pub(super) struct Plan {
    /// The region on its left.
    pub path: Vec<Axial>,
    /// What its vertices stand for, in the order of the loop.
    pub names: Vec<Name>,
    pub belt: Belt,
    /// Vertices of the loop.
    pub n: usize,
}

impl Plan {
    /// A row of quads along a loop of three or four vertices, and one face inside.
    pub fn ring(n: usize) -> Plan {
        let path = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[q, r]| Axial::new(q, r)).to_vec();
        let names = (0..4).map(|k| if k < n { Name::Behind(k) } else { Name::Apex }).collect();
        Plan { path, names, belt: Belt::Whole, n }
    }

    /// The quads of the row, if the new vertex behind the k-th of the loop is called `behind[k]`.
    fn row(&self, behind: &[u32]) -> Vec<[u32; 4]> {
        let n = self.n;
        let quad = |k: usize| {
            let next = (k + 1) % n;
            [k as u32, next as u32, behind[next], behind[k]]
        };
        match self.belt {
            Belt::None => vec![],
            Belt::Whole => (0..n).map(quad).collect(),
            Belt::Part { from, to } => (0..(to + n - from) % n).map(|k| quad((from + k) % n)).collect(),
        }
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
    /// Lattice points of the path, but for one that is left out, with the loop vertex that each follows; then
    /// those inside.
    lattice: Vec<Axial>,
    follows: Vec<usize>,
    /// Which of the path's are new vertices.
    new: Vec<bool>,
}

impl Cells {
    /// The loop itself as a face.
    pub fn face(n: usize) -> Cells {
        let (quads, odd) = if n == 4 { (vec![[0, 1, 2, 3]], None) } else { (vec![], Some([0, 1, 2])) };
        Cells::free(n, quads, odd, vec![DVec2::ZERO; n])
    }

    /// Faces that are not from a lattice.
    pub fn free(n_loop: usize, quads: Vec<[u32; 4]>, odd: Option<[u32; 3]>, start: Vec<DVec2>) -> Cells {
        Cells { n_loop, quads, odd, start, lattice: vec![], follows: vec![], new: vec![] }
    }

    /// The faces of a plan; none if the vertex that is to be left out has not one quad alone.
    pub fn of(plan: &Plan) -> Option<Cells> {
        const NONE: u32 = u32::MAX;
        let (points, squares) = squares_within(std::slice::from_ref(&plan.path));
        let (all, n) = (plan.path.len(), plan.n);
        // What the path's vertices are called, then those inside.
        let (mut numbers, mut follows, mut new) = (vec![], vec![], vec![]);
        let mut behind = vec![NONE; n];
        let mut start = vec![DVec2::NAN; n];
        for (i, &name) in plan.names.iter().enumerate() {
            match name {
                Name::Loop(k) => {
                    numbers.push(k as u32);
                    start[k] = Square::units(points[i]);
                }
                Name::Behind(k) => {
                    behind[k] = start.len() as u32;
                    numbers.push(behind[k]);
                    start[k] = beside(&plan.path, i);
                    start.push(Square::units(points[i]));
                }
                Name::Apex => numbers.push(NONE),
            }
            if let Name::Loop(k) | Name::Behind(k) = name {
                follows.push(k);
                new.push(name == Name::Behind(k));
            }
        }
        if let Belt::Part { from, to } = plan.belt {
            let (before, after) = ((from + n - 1) % n, (to + 1) % n);
            (behind[from], behind[to]) = (before as u32, after as u32);
            let place = |name: usize| plan.names.iter().position(|&it| it == Name::Loop(name));
            let (first, last) = (place(before)?, place(after)?);
            let right = |a: usize, b: usize| right(plan.path[a % all], plan.path[b % all]);
            start[from] = start[before] + right(first, first + 1);
            start[to] = start[after] + right(last + all - 1, last);
        }
        for &p in &points[all..] {
            numbers.push(start.len() as u32);
            start.push(Square::units(p));
        }
        let apex = plan.names.iter().position(|&name| name == Name::Apex);
        let mut quads = plan.row(&behind);
        let mut odd = None;
        for quad in squares {
            let number = |v: u32| numbers[v as usize];
            match quad.iter().position(|&v| Some(v as usize) == apex) {
                None => quads.push(quad.map(number)),
                Some(_) if odd.is_some() => return None,
                Some(k) => odd = Some([1, 2, 3].map(|ahead| number(quad[(k + ahead) % 4]))),
            }
        }
        if odd.is_some() != apex.is_some() || start[..n].iter().any(|p| p.is_nan()) {
            return None;
        }
        let kept = |i: &usize| Some(*i) != apex;
        let lattice = (0..points.len()).filter(kept).map(|i| points[i]).collect();
        Some(Cells { n_loop: n, quads, odd, start, lattice, follows, new })
    }

    /// A guess of the harmonic extension of values at the loop to the other vertices.
    pub fn spread(&self, values: &[DVec2], progress: Progress<'_>) -> Result<Vec<DVec2>> {
        let outline = self.follows.iter().map(|&k| values[k]).collect::<Vec<_>>();
        let row = outline.iter().zip(&self.new).filter(|(_, new)| **new).map(|(value, _)| *value);
        let (path, inner) = self.lattice.split_at(self.follows.len());
        Ok(row.chain(spread::<Square>(path, &outline, inner, progress)?).collect())
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
    let (before, after) = (right(path[(i + n - 1) % n], path[i]), right(path[i], path[(i + 1) % n]));
    let out = if before == after { before } else { before + after };
    Square::units(path[i]) + out
}

/// To the right of a step.
fn right(from: Axial, to: Axial) -> DVec2 {
    -(Square::units(to) - Square::units(from)).perp()
}
