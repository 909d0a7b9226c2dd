//! Bodies of symmetric patches: the two sides made mirror images of each other.
//!
//! Vertices slide one after the other, so that the two sides of a body come out a little unlike even where those of
//! its patch are not.

use glam::{DMat2, DVec2};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::body::inflate::field::Field;
use crate::body::inflate::front::Front;
use crate::options::CellShape;
use crate::patch::Patch;

/// How far a vertex may be from the mirror image of its twin, in edges.
const OFF: f64 = 1e-9;

/// Directions of a lattice that may be those of an axis, over half a circle.
const DIRECTIONS: u32 = 12;

/// For each vertex of a patch its mirror image; on the axis a vertex is its own.
pub(super) struct Twins {
    twin: Vec<u32>,
    foot: DVec2,
    along: DVec2,
}

impl Twins {
    /// The twins in a patch with these vertices, if it is symmetric. Near-linear.
    pub fn find(patch: &Patch, vertices: &[DVec2]) -> Option<Twins> {
        let foot = vertices.iter().sum::<DVec2>() / vertices.len() as f64;
        let off = OFF * patch.lattice.edge_length;
        let grid = Grid::new(vertices, patch.lattice.edge_length);
        // The axis is a direction of the lattice or between two, and a principal axis if there is just one.
        let moments = vertices
            .iter()
            .map(|&p| p - foot)
            .fold(DMat2::ZERO, |sum, d| sum + DMat2::from_cols(d * d.x, d * d.y));
        let turn = 0.5 * libm::atan2(2.0 * moments.x_axis.y, moments.x_axis.x - moments.y_axis.y);
        let step = std::f64::consts::PI / f64::from(DIRECTIONS);
        let of_lattice = (0..DIRECTIONS).map(|k| patch.lattice.angle + f64::from(k) * step);
        let principal = [turn, turn + std::f64::consts::FRAC_PI_2];
        principal.into_iter().chain(of_lattice).find_map(|angle| {
            let along = DVec2::from_angle(angle);
            let image = |v: u32| grid.at(reflected(vertices[v as usize], foot, along), off);
            let twin = (0..vertices.len() as u32).map(image).collect::<Option<Vec<u32>>>()?;
            let is_mutual = (0..).zip(&twin).all(|(v, &w)| twin[w as usize] == v);
            (is_mutual && keeps_cells(patch, &twin)).then_some(Twins { twin, foot, along })
        })
    }

    /// Makes a front its own mirror image: the mean of its sides where that is allowed, else one of them. The places of
    /// triangles that must stay positive are given, and points where no vertex may be.
    pub fn even(
        &self,
        front: &mut Front,
        field: &Field<'_>,
        (corners, least_area): (&[[u32; 3]], f64),
        is_forbidden: impl Fn(DVec2) -> bool,
    ) {
        let own = |v: usize| front.flat[v];
        let image = |v: usize| reflected(front.flat[self.twin[v] as usize], self.foot, self.along);
        let side = |v: usize| self.along.perp_dot(field.vertices[v] - self.foot);
        let mean = |v: usize| own(v).midpoint(image(v));
        let ways: [&dyn Fn(usize) -> DVec2; 3] = [
            &mean,
            &|v| {
                if self.twin[v] as usize == v {
                    mean(v)
                } else if side(v) > 0.0 {
                    own(v)
                } else {
                    image(v)
                }
            },
            &|v| {
                if self.twin[v] as usize == v {
                    mean(v)
                } else if side(v) < 0.0 {
                    own(v)
                } else {
                    image(v)
                }
            },
        ];
        let fits = |flat: &[DVec2]| {
            let area = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|v| flat[v as usize]);
                (b - a).perp_dot(c - a)
            };
            corners.iter().all(|t| area(t) >= least_area)
                && flat[front.first..]
                    .iter()
                    .zip(&front.flat[front.first..])
                    .all(|(&new, &old)| new == old || !is_forbidden(new) || is_forbidden(old))
        };
        let even = |way: &dyn Fn(usize) -> DVec2| {
            let mut flat = front.flat.clone();
            for v in front.first..flat.len() {
                let twin = self.twin[v] as usize;
                if twin >= v {
                    flat[v] = way(v);
                }
                if twin > v {
                    flat[twin] = reflected(flat[v], self.foot, self.along);
                }
            }
            let place = (front.first..flat.len())
                .map(|v| field.locate(flat[v], front.place[v - front.first].triangle))
                .collect::<Option<Vec<_>>>()?;
            fits(&flat).then_some((flat, place))
        };
        let Some((flat, place)) = ways.into_iter().find_map(even) else { return };
        let first = front.first;
        let height = (first..flat.len()).map(|v| field.at(flat[v], place[v - first]).0.sqrt());
        let height = height.collect::<Vec<_>>();
        for v in first..flat.len() {
            front.height[v] = 0.5 * (height[v - first] + height[self.twin[v] as usize - first]);
        }
        (front.flat, front.place) = (flat, place);
    }
}

fn reflected(p: DVec2, foot: DVec2, along: DVec2) -> DVec2 {
    let away = p - foot;
    foot + 2.0 * away.dot(along) * along - away
}

/// True if the mirror image of every cell is one, and boundary vertices are those of boundary vertices.
fn keeps_cells(patch: &Patch, twin: &[u32]) -> bool {
    let first = patch.n_boundary();
    let sorted = |mut cell: [u32; 4]| {
        cell.sort_unstable();
        cell
    };
    let cells: Vec<[u32; 4]> = match patch.cells() {
        CellShape::Triangle => patch.triangles.iter().map(|&[a, b, c]| [a, b, c, u32::MAX]).collect(),
        CellShape::Quad => patch.quads.clone(),
    };
    let known: FxHashSet<[u32; 4]> = cells.iter().map(|&cell| sorted(cell)).collect();
    let image = |v: u32| twin.get(v as usize).copied().unwrap_or(u32::MAX);
    (0..first).all(|v| (twin[v] as usize) < first)
        && cells.iter().all(|cell| known.contains(&sorted(cell.map(image))))
}

/// Points by the squares of a grid.
struct Grid<'a> {
    points: &'a [DVec2],
    size: f64,
    cells: FxHashMap<[i64; 2], Vec<u32>>,
}

impl<'a> Grid<'a> {
    fn new(points: &'a [DVec2], size: f64) -> Self {
        let mut grid = Grid { points, size, cells: FxHashMap::default() };
        for (v, &p) in (0..).zip(points) {
            grid.cells.entry(grid.cell(p)).or_default().push(v);
        }
        grid
    }

    fn cell(&self, p: DVec2) -> [i64; 2] {
        [(p.x / self.size).floor() as i64, (p.y / self.size).floor() as i64]
    }

    /// The point nearest to a place, if it is no farther than `off`.
    fn at(&self, place: DVec2, off: f64) -> Option<u32> {
        let (low, high) = (self.cell(place - off), self.cell(place + off));
        let cells = (low[0]..=high[0]).flat_map(|x| (low[1]..=high[1]).map(move |y| [x, y]));
        let near = cells.filter_map(|cell| self.cells.get(&cell)).flatten();
        let squared = |v: u32| self.points[v as usize].distance_squared(place);
        near.copied().min_by(|&v, &w| squared(v).total_cmp(&squared(w))).filter(|&v| squared(v) <= off * off)
    }
}
