//! The closed lattice path that bounds a growing patch, and the one move that extends it.

use std::sync::Arc;

use crate::lattice::axial::Axial;
use crate::lattice::cells::{Cells, Layout};
use crate::lattice::dir::Dir;

/// What a lattice point is to the patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// Not in the patch.
    Outside,
    /// In the patch with all six neighbours.
    Interior,
    /// On the boundary: the path comes in by one direction and goes on by the other.
    Boundary {
        /// Direction of the step that arrives here.
        enter: Dir,
        /// Direction of the step that goes on.
        leave: Dir,
    },
}

const OUTSIDE: u8 = 0;
const INTERIOR: u8 = 1;

/// Boundary cells are packed as this plus eight times the entering direction plus the leaving one.
const BOUNDARY: u8 = 64;

const fn packed(enter: usize, leave: usize) -> u8 {
    BOUNDARY + 8 * enter as u8 + leave as u8
}

const fn enter_of(code: u8) -> usize {
    ((code - BOUNDARY) >> 3) as usize
}

const fn leave_of(code: u8) -> usize {
    (code & 7) as usize
}

/// The turn of each packed cell; zero for codes that are not boundary cells.
const TURN: [i8; 256] = {
    let mut table = [0; 256];
    let mut enter = 0;
    while enter < 6 {
        let mut leave = 0;
        while leave < 6 {
            let turn = Dir::new(enter).turn_to(Dir::new(leave));
            table[packed(enter as usize, leave as usize) as usize] = turn as i8;
            leave += 1;
        }
        enter += 1;
    }
    table
};

/// `i` modulo six, for `i` below twelve.
const fn wrap(i: usize) -> usize {
    if i >= 6 { i - 6 } else { i }
}

impl Cell {
    fn unpack(code: u8) -> Self {
        match code {
            OUTSIDE => Cell::Outside,
            INTERIOR => Cell::Interior,
            _ => Cell::Boundary {
                enter: Dir::ALL[wrap(enter_of(code))],
                leave: Dir::ALL[wrap(leave_of(code))],
            },
        }
    }
}

/// Adding one point to the patch: its link meets the boundary in a single arc of `edges` edges.
///
/// ```text
///   edges = 1          edges = 2          edges = 3          edges = 4
///       p                -- p --           / p \              \ p /
///      / \                / | \            -- -- --           -- -- -- around p
///   --*---*--          --*--*--*--
/// ```
/// The patch gains `edges` triangles, the boundary `2 - edges` edges, and `p` turns by
/// `3 - edges` (figure 8 of the paper; its fifth case, five edges, is a notch one point wide).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expansion {
    /// The point that joins.
    pub point: Axial,
    /// Number of boundary edges it covers, 1 to 5.
    pub edges: i32,
    /// Direction from the point to the first covered vertex, in the order of the path.
    pub first: Dir,
    /// Bit `d` is set if the neighbour in direction `d` is a boundary vertex.
    pub beside: u8,
    /// Cell numbers of the neighbours.
    around: [usize; 6],
}

impl Expansion {
    /// Direction from the point to the `i`-th vertex of the arc, 0 to `edges`.
    fn arc(&self, i: i32) -> Dir {
        Dir::ALL[wrap(self.first.index() + 6 - i as usize)]
    }
}

/// A simple closed lattice path with the patch on its left.
///
/// The linked list lives in the cells: a vertex knows the step that arrives and the step that
/// leaves, so that no point can occur twice, and lookup, insertion and removal take constant time.
/// Always: the turns add up to six, and there are `2 * vertices - 2 - length` triangles.
#[derive(Clone, Debug)]
pub struct Boundary {
    cells: Cells<u8>,
    some: Axial,
    length: usize,
    triangles: usize,
    bend: i64,
}

/// Cells overwritten since a [`Boundary::mark`].
#[derive(Debug, Default)]
pub(crate) struct Journal {
    changed: Vec<(Axial, u8)>,
    state: Option<(Axial, usize, usize, i64)>,
}

impl Boundary {
    /// The six neighbours of `centre` around it: the paper's seed (section IV-B).
    ///
    /// `None` if one of them has no cell.
    pub fn hexagon(layout: Arc<Layout>, centre: Axial) -> Option<Self> {
        let mut cells = Cells::new(layout, OUTSIDE);
        let mut complete = cells.set(centre, INTERIOR);
        for dir in Dir::ALL {
            complete &= cells.set(centre + dir, packed(dir.rotate(1).index(), dir.rotate(2).index()));
        }
        let some = centre + Dir::new(0);
        complete.then_some(Self { cells, some, length: 6, triangles: 6, bend: 6 })
    }

    /// The points that the boundary can reach.
    pub fn layout(&self) -> &Arc<Layout> {
        self.cells.layout()
    }

    /// What a point is to the patch.
    pub fn cell(&self, point: Axial) -> Cell {
        Cell::unpack(self.cells.get(point))
    }

    /// True for a point that is not in the patch.
    pub fn is_outside(&self, point: Axial) -> bool {
        self.cells.get(point) == OUTSIDE
    }

    /// Calls `visit` with the neighbours of a point that lie outside the patch, and their cells.
    pub(crate) fn outside_around(&self, point: Axial, visit: impl FnMut(Axial, usize)) {
        if let Some(around) = self.layout().neighbours(point) {
            self.outside_of(point, &around, visit);
        }
    }

    /// As [`Boundary::outside_around`], for the point of an expansion.
    pub(crate) fn outside_beside(&self, expansion: &Expansion, visit: impl FnMut(Axial, usize)) {
        self.outside_of(expansion.point, &expansion.around, visit);
    }

    fn outside_of(&self, point: Axial, around: &[usize; 6], mut visit: impl FnMut(Axial, usize)) {
        let values = self.cells.values();
        for (i, dir) in Dir::ALL.into_iter().enumerate() {
            if values[around[i]] == OUTSIDE {
                visit(point + dir, around[i]);
            }
        }
    }

    /// True for a boundary vertex.
    pub fn is_boundary(&self, point: Axial) -> bool {
        self.cells.get(point) > INTERIOR
    }

    /// Number of boundary vertices.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Number of triangles of the patch.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// The sum of absolute turns along the boundary: the paper's `err_dc`, equation (1).
    pub fn bend(&self) -> i64 {
        self.bend
    }

    /// The turn at a boundary vertex, positive where convex; `None` for other points.
    pub fn turn(&self, point: Axial) -> Option<i32> {
        let code = self.cells.get(point);
        (code > INTERIOR).then(|| i32::from(TURN[code as usize]))
    }

    /// The boundary vertices in order, the patch on the left.
    pub fn path(&self) -> Vec<Axial> {
        let mut path = Vec::with_capacity(self.length);
        let mut at = self.some;
        for _ in 0..self.length {
            path.push(at);
            if let Cell::Boundary { leave, .. } = self.cell(at) {
                at = at + leave;
            }
        }
        path
    }

    /// The expansion by `point`, if it is valid adjacent (section IV-B, figures 7 and 8).
    ///
    /// It is when it lies outside and its link meets the boundary in one arc of at least an edge,
    /// that is, when it has one more boundary neighbour than boundary edges in its link. The paper
    /// asks for two boundary neighbours only; that lets the boundary touch itself.
    pub fn expansion(&self, point: Axial) -> Option<Expansion> {
        if self.cells.get(point) != OUTSIDE {
            return None;
        }
        let values = self.cells.values();
        let around = self.cells.layout().neighbours(point)?;
        let codes = around.map(|i| values[i]);
        let (mut beside, mut along) = (0u8, 0u8);
        for (i, &code) in codes.iter().enumerate() {
            if code > INTERIOR {
                beside |= 1 << i;
                // The path runs clockwise round an outside point: from neighbour i to i - 1.
                along |= u8::from(leave_of(code) == wrap(i + 4)) << i;
            }
        }
        let edges = along.count_ones();
        if edges == 0 || beside.count_ones() != edges + 1 {
            return None;
        }
        // The arc begins where an edge leaves along the link and none arrives.
        let arrived = (along >> 1) | ((along & 1) << 5);
        let first = Dir::ALL[wrap((along & !arrived).trailing_zeros() as usize)];
        Some(Expansion { point, edges: edges as i32, first, beside, around })
    }

    /// How an expansion changes [`Boundary::bend`].
    pub fn bend_change(&self, expansion: &Expansion) -> i64 {
        let turn = |i: i32| i32::from(TURN[self.cells.get(expansion.point + expansion.arc(i)) as usize]);
        let ends = [turn(0), turn(expansion.edges)];
        let covered: i32 = (1..expansion.edges).map(|i| turn(i).abs()).sum();
        let straightened: i32 = ends.iter().map(|t| (t - 1).abs() - t.abs()).sum();
        i64::from((3 - expansion.edges).abs() + straightened - covered)
    }

    /// Adds a point to the patch. The expansion must be one that [`Boundary::expansion`] gave for
    /// the boundary as it is.
    pub fn expand(&mut self, expansion: &Expansion) {
        let p = expansion.point;
        let around = &expansion.around;
        // Cells of a row are numbered from west to east.
        let here = around[3] + 1;
        let values = self.cells.values_mut();
        let edges = expansion.edges;
        let (first, last) = (expansion.arc(0).index(), expansion.arc(edges).index());
        let bend = |code: u8| i64::from(TURN[code as usize].abs());
        for i in 0..=edges as usize {
            self.bend -= bend(values[around[wrap(first + 6 - i)]]);
        }
        values[around[first]] = packed(enter_of(values[around[first]]), wrap(first + 3));
        for i in 1..edges as usize {
            values[around[wrap(first + 6 - i)]] = INTERIOR;
        }
        values[around[last]] = packed(last, leave_of(values[around[last]]));
        values[here] = packed(wrap(first + 3), last);
        for cell in [here, around[first], around[last]] {
            self.bend += bend(values[cell]);
        }
        self.some = p;
        self.length = (self.length as i64 + 2 - i64::from(edges)) as usize;
        self.triangles += edges as usize;
    }

    /// Like [`Boundary::expand`], remembering what was there.
    pub(crate) fn expand_logged(&mut self, expansion: &Expansion, journal: &mut Journal) {
        journal.state.get_or_insert((self.some, self.length, self.triangles, self.bend));
        let p = expansion.point;
        journal.changed.push((p, self.cells.get(p)));
        for i in 0..=expansion.edges {
            let q = p + expansion.arc(i);
            journal.changed.push((q, self.cells.get(q)));
        }
        self.expand(expansion);
    }

    /// Takes back all that a journal remembers.
    pub(crate) fn roll_back(&mut self, journal: Journal) {
        for (point, code) in journal.changed.into_iter().rev() {
            self.cells.set(point, code);
        }
        if let Some((some, length, triangles, bend)) = journal.state {
            (self.some, self.length, self.triangles, self.bend) = (some, length, triangles, bend);
        }
    }

    /// The neighbours of a boundary vertex that lie in the patch and are not next to it on the
    /// boundary, counter-clockwise.
    pub fn inner_neighbours(&self, vertex: Axial) -> impl Iterator<Item = Axial> {
        let (from, count) = match self.cell(vertex) {
            Cell::Boundary { enter, leave } => (leave, 2 - enter.turn_to(leave)),
            _ => (Dir::new(0), 0),
        };
        (1..=count).map(move |i| vertex + from.rotate(i))
    }

    /// The neighbours of a boundary vertex that do not lie on its patch side, clockwise from the
    /// next vertex of the path to the one before.
    pub fn outer_neighbours(&self, vertex: Axial) -> impl Iterator<Item = Axial> {
        let (from, count) = match self.cell(vertex) {
            Cell::Boundary { enter, leave } => (leave, 2 + enter.turn_to(leave)),
            _ => (Dir::new(0), 0),
        };
        (1..=count).map(move |i| vertex + from.rotate(-i))
    }

    /// A boundary vertex that an edge inside the patch joins to this one, if there is any.
    ///
    /// Such a chord would be an edge of four triangles after stitching (section III-B, figures 5
    /// and 9).
    pub fn chord(&self, vertex: Axial) -> Option<Axial> {
        self.inner_neighbours(vertex).find(|&p| self.is_boundary(p))
    }

    /// Proves all that the documentation says of a boundary, chords aside. For tests; walks it.
    ///
    /// # Errors
    /// A sentence that names the broken fact.
    pub fn check(&self) -> Result<(), String> {
        let path = self.path();
        let (mut turns, mut bend) = (0, 0);
        for (i, &p) in path.iter().enumerate() {
            let next = path[(i + 1) % path.len()];
            match (self.cell(p), self.cell(next)) {
                (Cell::Boundary { leave, .. }, Cell::Boundary { enter, .. })
                    if leave == enter && p + leave == next => {}
                cells => return Err(format!("broken link from {p:?} to {next:?}: {cells:?}")),
            }
            let turn = self.turn(p).unwrap_or(3);
            if turn.abs() > 2 {
                return Err(format!("the path reverses at {p:?}"));
            }
            turns += turn;
            bend += i64::from(turn.abs());
        }
        let on_boundary = self.cells.layout().points().filter(|&p| self.is_boundary(p)).count();
        let interior = self.cells.layout().points().filter(|&p| self.cell(p) == Cell::Interior).count();
        let euler = 2 * (on_boundary + interior) - 2 - self.length;
        let facts = [
            ("turn sum", turns == 6),
            ("bend", bend == self.bend),
            ("length", on_boundary == self.length && path.len() == self.length),
            ("triangles", euler == self.triangles),
        ];
        match facts.iter().find(|fact| !fact.1) {
            Some((what, _)) => Err(format!("the {what} is wrong")),
            None => Ok(()),
        }
    }
}
