//! Conformal maps of the drawing by their derivative exp(u + i v): rotation v, log scale u, map f.

use glam::DVec2;

use super::carrier::{Carrier, Rim};
use super::directions::{Directions, directions};
use super::tangents::Tangents;
use super::width::room;
use crate::error::Result;
use crate::geometry::laplace::{Factor, Pattern, cotangent_weights};
use crate::geometry::topology::Topology;
use crate::options::CellShape;
use crate::progress::Progress;

/// What keeps the operators definite whose constants are free.
const FLOOR: f64 = 1e-9;
/// Rounds of directions for the rotation and rotation for the directions.
const ROUNDS: usize = 6;
/// So many of the first rounds may have another price for a change of direction.
const FIRST: usize = 3;

/// The cotangent Laplacian of a carrier and what stands on its boundary; lengths in edges.
pub struct Operators {
    topology: Topology,
    weights: Vec<f64>,
    pattern: Pattern,
    /// The factorisation without a boundary weight.
    neumann: Factor,
    /// Length of contour that each boundary vertex stands for.
    lengths: Vec<f64>,
    /// The part of it that wants to run along a lattice direction.
    pulls: Vec<f64>,
    /// Smoothed tangent angle at each boundary vertex.
    tangents: Vec<f64>,
    /// Per contour: first vertex, number of vertices, lattice directions that the tangent turns through.
    contours: Vec<(usize, usize, i32)>,
    /// Angle between two lattice directions.
    step: f64,
}

/// A rotation and the directions that it was made for.
#[derive(Clone)]
pub struct Rotation {
    /// At each vertex of the carrier, in radians.
    pub v: Vec<f64>,
    /// Sum over the contours.
    pub turns: usize,
    pub misfit: f64,
}

/// Operators that are solved with. Each solve asks whether to go on.
pub struct Solver<'a> {
    pub operators: &'a Operators,
    progress: Progress<'a>,
}

impl Operators {
    /// `widths` as [`log_widths`](super::width::log_widths) gives them.
    pub fn new(
        carrier: &Carrier,
        widths: &[f64],
        tangents: &[Tangents],
        shape: CellShape,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let topology = Topology::new(carrier.vertices.len(), &carrier.triangles);
        let weights = cotangent_weights(&topology, &carrier.vertices, &carrier.triangles)?;
        let pattern = Pattern::new(&topology, 0, progress)?;
        let neumann = pattern.factor(&topology, &weights, |_| FLOOR, progress)?;
        let mut at_rim = Vec::new();
        for (rim, tangents) in carrier.rims.iter().zip(tangents) {
            at_rim.extend(rim.arcs.iter().map(|&s| tangents.at(s)));
        }
        let step = shape.step();
        let contour = |(rim, t): (&Rim, &Tangents)| (rim.start, rim.len(), t.total(step));
        let contours = carrier.rims.iter().zip(tangents).map(contour).collect();
        let lengths = carrier.lengths();
        let pulls = lengths.iter().zip(room(widths, shape)).map(|(length, room)| length * room).collect();
        Ok(Self { topology, weights, pattern, neumann, lengths, pulls, tangents: at_rim, contours, step })
    }

    /// The Laplacian with `beta` times the length of contour that wants a direction on its diagonal.
    pub fn robin(&self, beta: f64, progress: Progress<'_>) -> Result<Factor> {
        let diagonal = |v: usize| self.pulls.get(v).map_or(0.0, |pull| beta * pull);
        self.pattern.factor(&self.topology, &self.weights, diagonal, progress)
    }

    /// To solve with, asking `progress`.
    pub fn solver<'a>(&'a self, progress: Progress<'a>) -> Solver<'a> {
        Solver { operators: self, progress }
    }

    /// The directions for a rotation, contour by contour.
    pub fn directions(&self, v: &[f64], price: f64) -> Vec<Directions> {
        let of = |&(start, n, total): &(usize, usize, i32)| {
            let range = start..start + n;
            let turned: Vec<f64> =
                self.tangents[range.clone()].iter().zip(&v[range.clone()]).map(|(t, v)| t + v).collect();
            directions(&turned, &self.pulls[range], (total, self.step), price)
        };
        self.contours.iter().map(of).collect()
    }

    /// A rotation with the turns and the misfit of the directions that are best for it.
    pub fn judged(&self, v: Vec<f64>, price: f64) -> Rotation {
        let found = self.directions(&v, price);
        let (turns, misfit) = (found.iter().map(|d| d.turns).sum(), found.iter().map(|d| d.misfit).sum());
        Rotation { v, turns, misfit }
    }

    /// Angle between two lattice directions.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Per contour: first vertex, number of vertices, lattice directions that the tangent turns through.
    pub fn contours(&self) -> &[(usize, usize, i32)] {
        &self.contours
    }

    /// The length of contour at each boundary vertex that wants to run along a lattice direction.
    pub fn pulls(&self) -> &[f64] {
        &self.pulls
    }

    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// The differences of a function along the contours, halves to both ends of each chord.
    pub fn along(&self, of: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; of.len()];
        for &(start, n, _) in &self.contours {
            for i in 0..n {
                let (a, b) = (start + i, start + (i + 1) % n);
                let change = 0.5 * (of[b] - of[a]);
                sums[a] += change;
                sums[b] += change;
            }
        }
        sums
    }

    /// The matrix of [`Operators::robin`] times a function.
    pub fn times(&self, of: &[f64], beta: f64) -> Vec<f64> {
        (0..of.len())
            .map(|v| {
                let slots = self.topology.range(v);
                let sum: f64 = slots
                    .map(|slot| self.weights[slot] * (of[v] - of[self.topology.near[slot] as usize]))
                    .sum();
                sum + self.pulls.get(v).map_or(0.0, |pull| beta * pull * of[v])
            })
            .collect()
    }

    /// Rotations that turn tangents into lattice directions, each of least
    /// `1/2 |grad v|^2 + beta/2 |v - (step m - tangent)|^2` with `m` the directions of least cost for it,
    /// in turns, from even rotations by `starts` on. `robin` is the factor for `beta`. `prices` are those of a change of
    /// direction in the end and in the first rounds: where changes are dear at first, the rotation comes to suit
    /// directions that change less often. One solve a round for all.
    pub fn rotations(
        &self,
        starts: &[f64],
        (beta, robin): (f64, &Factor),
        prices: (f64, f64),
        progress: Progress<'_>,
    ) -> Result<Vec<Rotation>> {
        let n = self.topology.start.len() - 1;
        let mut found: Vec<(Vec<f64>, Vec<Directions>)> =
            starts.iter().map(|&start| (vec![start; n], Vec::new())).collect();
        let mut open: Vec<usize> = (0..starts.len()).collect();
        for round in 0..ROUNDS {
            let price = if round < FIRST { prices.1 } else { prices.0 };
            open.retain(|&k| {
                let (v, directions) = &mut found[k];
                let next = self.directions(v, price);
                let moves = !next.iter().map(|d| &d.steps).eq(directions.iter().map(|d| &d.steps));
                *directions = next;
                moves || (round < FIRST && prices.0 != prices.1)
            });
            let mut sides = vec![0.0; n * open.len()];
            for (&k, side) in open.iter().zip(sides.chunks_exact_mut(n)) {
                for (&(start, ..), found) in self.contours.iter().zip(&found[k].1) {
                    for (i, &m) in found.steps.iter().enumerate() {
                        let wish = self.step * f64::from(m) - self.tangents[start + i];
                        side[start + i] = beta * self.pulls[start + i] * wish;
                    }
                }
            }
            if open.is_empty() {
                break;
            }
            progress.report(0.0)?;
            robin.solve(&mut sides, open.len())?;
            progress.report(0.0)?;
            for (&k, side) in open.iter().zip(sides.chunks_exact(n)) {
                found[k].0.copy_from_slice(side);
            }
        }
        Ok(found.into_iter().map(|(v, _)| self.judged(v, prices.0)).collect())
    }
}

impl Solver<'_> {
    /// The harmonic conjugate of a rotation, up to a constant: its normal derivative is the rotation's
    /// derivative along the contours.
    pub fn scale(&self, v: &[f64]) -> Result<Vec<f64>> {
        self.progress.report(0.0)?;
        let mut u = self.operators.along(v);
        self.operators.neumann.solve(&mut u, 1)?;
        Ok(u)
    }

    /// Solves with the Laplacian alone, in place; the right side should add up to zero.
    pub fn potential(&self, of: &mut [f64]) -> Result<()> {
        self.progress.report(0.0)?;
        self.operators.neumann.solve(of, 1)
    }

    /// The map whose gradient is nearest to exp(u) times the rotation by v, its image centred.
    pub fn map(&self, carrier: &Carrier, u: &[f64], v: &[f64]) -> Result<Vec<DVec2>> {
        let n = carrier.vertices.len();
        let mut sums = vec![0.0; 2 * n];
        // A triangle's exponent is the mean of its corners'.
        let thirds = u.iter().zip(v).map(|(u, v)| libm::exp(u / 3.0) * DVec2::from_angle(v / 3.0));
        let thirds: Vec<DVec2> = thirds.collect();
        for t in &carrier.triangles {
            let corner = t.map(|i| carrier.vertices[i as usize]);
            let [a, b, c] = t.map(|i| thirds[i as usize]);
            let gradient = a.rotate(b).rotate(c);
            for k in 0..3 {
                // Twice the area times the gradient of the corner's hat function.
                let across = (corner[(k + 2) % 3] - corner[(k + 1) % 3]).perp();
                let i = t[k] as usize;
                sums[i] += 0.5 * (across.x * gradient.x - across.y * gradient.y);
                sums[n + i] += 0.5 * (across.x * gradient.y + across.y * gradient.x);
            }
        }
        self.progress.report(0.0)?;
        self.operators.neumann.solve(&mut sums, 2)?;
        Ok((0..n).map(|i| DVec2::new(sums[i], sums[n + i])).collect())
    }
}

/// Shifts a log scale so that the map keeps the area.
pub fn keep_area(carrier: &Carrier, u: &mut [f64]) {
    let before: f64 = carrier.triangles.iter().map(|t| carrier.doubled_area(t)).sum();
    let after: f64 = image_areas(carrier, u).sum();
    let shift = 0.5 * libm::log(after / before);
    u.iter_mut().for_each(|u| *u -= shift);
}

/// Twice the area that each triangle of a carrier has under a map of this log scale.
pub fn image_areas<'a>(carrier: &'a Carrier, u: &[f64]) -> impl Iterator<Item = f64> + 'a {
    // The square of a triangle's scale is the exponential of twice the mean of its corners' logs.
    let factors: Vec<f64> = u.iter().map(|u| libm::exp(2.0 / 3.0 * u)).collect();
    carrier.triangles.iter().map(move |t| {
        let [a, b, c] = t.map(|i| factors[i as usize]);
        carrier.doubled_area(t) * (a * b * c)
    })
}
