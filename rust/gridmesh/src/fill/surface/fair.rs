//! Where the new vertices of a patch go: functionals made least with the loop held.

use glam::DVec3;

use super::patchwork::Patchwork;
use super::solver::LeastSquares;
use crate::error::Result;
use crate::progress::Progress;

/// Equations of second order, one for each vertex at which a curvature can be read: the Laplacian there.
pub(crate) struct Bending<'a> {
    work: &'a Patchwork,
    /// The vertex of each equation.
    rows: Vec<u32>,
    /// See [`seams`], those with a free apex; an equation for each follows those of the vertices.
    seams: Vec<[u32; 4]>,
    system: LeastSquares,
}

impl<'a> Bending<'a> {
    pub fn new(work: &'a Patchwork, progress: Progress<'_>) -> Result<Self> {
        let rows = (0..work.end as u32).filter(|&v| {
            let v = v as usize;
            let own = work.unknown(v).is_some();
            let near = work.near[work.range(v)].iter().any(|&u| work.unknown(u as usize).is_some());
            own || (work.closed[v] && near)
        });
        let rows = rows.collect::<Vec<_>>();
        let mut start = vec![0];
        let mut columns = vec![];
        for &v in &rows {
            let v = v as usize;
            columns.extend(work.unknown(v));
            columns.extend(work.near[work.range(v)].iter().filter_map(|&u| work.unknown(u as usize)));
            start.push(columns.len() as u32);
        }
        let mut seams = seams(work);
        seams.retain(|&[.., apex, _]| work.unknown(apex as usize).is_some());
        for &[.., apex, _] in &seams {
            columns.extend(work.unknown(apex as usize));
            start.push(columns.len() as u32);
        }
        let system = LeastSquares::new(work.end - work.n, start, columns, progress)?;
        Ok(Bending { work, rows, seams, system })
    }

    /// The thin plate: minimises the squared Laplacians of the positions on the present metric, one
    /// factorisation for the three coordinates.
    pub fn positions(&self, positions: &mut [DVec3], progress: Progress<'_>) -> Result<()> {
        let work = self.work;
        let cotangents = work.cotangents(positions);
        let masses = bounded_masses(work, positions);
        let n_rows = self.rows.len() + self.seams.len();
        let mut coefficients = Vec::with_capacity(7 * n_rows);
        let mut right = Vec::with_capacity(n_rows);
        let mut weights = Vec::with_capacity(n_rows);
        for &v in &self.rows {
            let v = v as usize;
            let mut sum = 0.0;
            let mut known = DVec3::ZERO;
            let own = coefficients.len();
            if work.unknown(v).is_some() {
                coefficients.push(0.0);
            }
            for slot in work.range(v) {
                let u = work.near[slot] as usize;
                sum += cotangents[slot];
                if work.unknown(u).is_some() {
                    coefficients.push(cotangents[slot]);
                } else {
                    known += cotangents[slot] * positions[u];
                }
            }
            if work.unknown(v).is_some() {
                coefficients[own] = -sum;
            } else {
                known -= sum * positions[v];
            }
            right.push((-known).to_array());
            weights.push(1.0 / masses[v]);
        }
        // The angles across the loop are not linear in the positions.
        coefficients.resize(coefficients.len() + self.seams.len(), 0.0);
        right.resize(n_rows, [0.0; 3]);
        weights.resize(n_rows, 0.0);
        let found = self.system.solve(&coefficients, &weights, &right, progress)?;
        for (v, x) in work.inner().zip(found) {
            positions[v] = x.into();
        }
        Ok(())
    }

    /// Moves the new vertices along their normals so that the bending is least (to first order). The step
    /// is halved until it lowers the true bending; the energy before and after, for the caller to judge.
    pub fn normal_step(
        &self,
        positions: &mut [DVec3],
        seam: f64,
        target: Option<&[f64]>,
        progress: Progress<'_>,
    ) -> Result<[f64; 2]> {
        const HALVINGS: usize = 4;
        let work = self.work;
        let state = self.state(positions, seam, target);
        let found = self.system.solve(&state.coefficients, &state.weights, &state.right, progress)?;
        let start = positions[work.inner()].to_vec();
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            for (k, v) in work.inner().enumerate() {
                positions[v] = start[k] + share * found[k][0] * state.normals[v];
            }
            progress.report(0.0)?;
            let energy = self.state(positions, seam, target).energy();
            if energy < state.energy() {
                return Ok([state.energy(), energy]);
            }
            share *= 0.5;
        }
        positions[work.inner()].copy_from_slice(&start);
        Ok([state.energy(); 2])
    }

    /// The equations of [`Bending::normal_step`] at the present positions: for each vertex the mean
    /// curvature, weighted by area; for each edge of the loop the angle across it.
    fn state(&self, positions: &[DVec3], seam: f64, target: Option<&[f64]>) -> State {
        let work = self.work;
        let cotangents = work.cotangents(positions);
        let masses = bounded_masses(work, positions);
        let normals = work.normals(positions);
        let n_rows = self.rows.len() + self.seams.len();
        let mut coefficients = Vec::with_capacity(7 * n_rows);
        let mut right = Vec::with_capacity(n_rows);
        let mut weights = Vec::with_capacity(n_rows);
        for &v in &self.rows {
            let v = v as usize;
            let mut sum = 0.0;
            let mut laplacian = DVec3::ZERO;
            let own = coefficients.len();
            if work.unknown(v).is_some() {
                coefficients.push(0.0);
            }
            for slot in work.range(v) {
                let u = work.near[slot] as usize;
                sum += cotangents[slot];
                laplacian += cotangents[slot] * (positions[u] - positions[v]);
                if work.unknown(u).is_some() {
                    coefficients.push(cotangents[slot] * normals[v].dot(normals[u]));
                }
            }
            if work.unknown(v).is_some() {
                coefficients[own] = -sum;
            }
            let wanted = target.map_or(0.0, |h| h[v] * masses[v]);
            right.push([wanted - normals[v].dot(laplacian)]);
            weights.push(1.0 / masses[v]);
        }
        for &[a, b, c, d] in &self.seams {
            let [pa, pb, pc, pd] = [a, b, c, d].map(|v| positions[v as usize]);
            let edge = pb - pa;
            let (inner, outer) = (edge.cross(pc - pa), (pd - pa).cross(edge));
            let height = inner.length() / edge.length();
            let area = 0.5 * (inner.length() + outer.length());
            let (m, o) = (inner.normalize_or_zero(), outer.normalize_or_zero());
            // Raising the apex of the patch's triangle turns its normal away from the apex.
            let angle = libm::atan2(m.cross(o).dot(edge.normalize_or_zero()), m.dot(o));
            coefficients.push(-m.dot(normals[c as usize]) / height.max(f64::MIN_POSITIVE));
            right.push([-angle]);
            weights.push(seam * edge.length_squared() / area.max(f64::MIN_POSITIVE));
        }
        State { coefficients, right, weights, normals }
    }
}

/// See [`Bending::state`].
struct State {
    coefficients: Vec<f64>,
    right: Vec<[f64; 1]>,
    weights: Vec<f64>,
    normals: Vec<DVec3>,
}

impl State {
    fn energy(&self) -> f64 {
        self.right.iter().zip(&self.weights).map(|([x], w)| w * x * x).sum()
    }
}

/// For each edge of the loop with a triangle on either side: its two vertices, the apex inside and the
/// one outside.
pub(in crate::fill) fn seams(work: &Patchwork) -> Vec<[u32; 4]> {
    let across = |a: u32, b: u32| {
        let apex = |test: &dyn Fn(usize) -> bool| {
            work.fan(a as usize).iter().find_map(|&[t, p, q]| match test(t as usize) {
                true if p == b => Some(q),
                true if q == b => Some(p),
                _ => None,
            })
        };
        Some([a, b, apex(&|t| t < work.n_patch)?, apex(&|t| t >= work.n_patch)?])
    };
    (0..work.n).filter_map(|a| across(a as u32, work.after(a) as u32)).collect()
}

/// Areas at the vertices, kept away from zero.
fn bounded_masses(work: &Patchwork, positions: &[DVec3]) -> Vec<f64> {
    let mut masses = work.areas(positions);
    let mean = masses.iter().sum::<f64>() / masses.len() as f64;
    masses.iter_mut().for_each(|m| *m = m.max(1e-6 * mean).max(f64::MIN_POSITIVE));
    masses
}

/// Equations of first order, one for each edge at a new vertex.
pub(crate) struct Membrane<'a> {
    work: &'a Patchwork,
    edges: Vec<[u32; 2]>,
    system: LeastSquares,
}

impl<'a> Membrane<'a> {
    pub fn new(work: &'a Patchwork, progress: Progress<'_>) -> Result<Self> {
        let mut edges = vec![];
        let mut start = vec![0];
        let mut columns = vec![];
        for v in work.inner() {
            for &u in &work.near[work.range(v)] {
                // Once for each edge between new vertices.
                if work.unknown(u as usize).is_none() || (u as usize) < v {
                    edges.push([v as u32, u]);
                    columns.extend(work.unknown(v));
                    columns.extend(work.unknown(u as usize));
                    start.push(columns.len() as u32);
                }
            }
        }
        let system = LeastSquares::new(work.end - work.n, start, columns, progress)?;
        Ok(Membrane { work, edges, system })
    }

    /// The weighted harmonic extension of `K` values per vertex from all other vertices to the new ones.
    pub fn harmonic<const K: usize>(
        &self,
        weights: &[f64],
        known: impl Fn(usize) -> [f64; K],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; K]>> {
        let work = self.work;
        let mut coefficients = vec![];
        let mut importance = vec![];
        let mut right = vec![];
        for &[v, u] in &self.edges {
            let range = work.range(v as usize);
            let slot = work.near[range.clone()].partition_point(|&x| x < u);
            importance.push(weights[range.start + slot]);
            coefficients.push(1.0);
            if work.unknown(u as usize).is_some() {
                coefficients.push(-1.0);
                right.push([0.0; K]);
            } else {
                right.push(known(u as usize));
            }
        }
        self.system.solve(&coefficients, &importance, &right, progress)
    }
}
