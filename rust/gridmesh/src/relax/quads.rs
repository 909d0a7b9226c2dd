//! Quads around a vertex: their energy is that of the four corners of each.
//!
//! With J the linear map that takes the corner of a unit square to a corner of a quad, `stretch` = |J|^2 is the
//! sum of the squared lengths of its two edges and `det` their cross product: two and one for a unit square,
//! so that the energies of triangles serve. All corners of a quad are positive exactly where it is convex.

use glam::DVec2;
use wide::f64x2;

use super::band::{Band, Stars};
use super::energy::{Energy, Local};
use crate::geometry::quadratic::Quadratic;

impl Stars for Band<4> {
    fn corners<const N: usize>(cells: &[[u32; N]]) -> Vec<[u32; 3]> {
        let corner = |c: &[u32; N], k: usize| [c[(k + N - 1) % N], c[k], c[(k + 1) % N]];
        cells.iter().flat_map(|c| (0..N).map(move |k| corner(c, k))).collect()
    }

    fn gather<const N: usize>(&mut self, cells: &[[u32; N]]) -> Result<(), usize> {
        let n_free = self.n_free;
        let mut starts = vec![0u32; n_free + 1];
        for &v in cells.iter().flatten().filter(|&&v| (v as usize) < n_free) {
            starts[v as usize + 1] += 1;
        }
        for v in 0..n_free {
            starts[v + 1] += starts[v];
        }
        let mut fill = starts.clone();
        let mut quads = vec![[0u32; 3]; starts[n_free] as usize];
        for cell in cells {
            for k in 0..N {
                if let Some(slot) = fill.get_mut(cell[k] as usize).filter(|_| (cell[k] as usize) < n_free) {
                    quads[*slot as usize] = [1, 2, 3].map(|ahead| cell[(k + ahead) % N]);
                    *slot += 1;
                }
            }
        }
        self.start.push(0);
        for v in 0..n_free {
            let fan = &mut quads[starts[v] as usize..starts[v + 1] as usize];
            order(fan, v < self.n_rim).ok_or(v)?;
            self.around.push(fan[0][0]);
            self.around.extend(fan.iter().map(|quad| quad[2]));
            self.start.push(self.around.len() as u32);
        }
        self.quads = (starts, quads);
        Ok(())
    }

    fn local<E: Energy>(&self, energy: &E, vertex: usize, x: DVec2) -> Local {
        let mut sum = Sum::new();
        let quads = self.quads_at(vertex);
        let at = |v: u32| self.positions[v as usize];
        for pair in quads.chunks(2) {
            let other = pair.len() - 1;
            let [next, _, last] = pair[0].map(at);
            let [other_next, _, other_last] = pair[other].map(at);
            // A quad without a partner is taken twice at half its weight.
            let weight = if other == 0 { 0.5 } else { 1.0 };
            sum.own(energy, weight, [next - x, other_next - x], [last - x, other_last - x]);
        }
        for quad in quads {
            let [next, far, last] = quad.map(at);
            // Beside the next vertex, and beside the last, as its mirror image.
            sum.beside(energy, [x - next, x - last], [far - next, far - last]);
        }
        sum.finish()
    }

    fn value<E: Energy>(&self, energy: &E, vertex: usize, x: DVec2) -> f64 {
        let at = |v: u32| self.positions[v as usize];
        let corner =
            |a: DVec2, b: DVec2| energy.value(a.length_squared() + b.length_squared(), a.perp_dot(b));
        let of = |quad: &[u32; 3]| {
            let [next, far, last] = quad.map(at);
            corner(next - x, last - x) + corner(far - next, x - next) + corner(x - last, far - last)
        };
        self.quads_at(vertex).iter().map(of).sum()
    }

    fn each_corner(&self, vertex: usize, mut visit: impl FnMut([u32; 3])) {
        let v = vertex as u32;
        for &[next, far, last] in self.quads_at(vertex) {
            [[v, next, last], [v, next, far], [v, far, last]].into_iter().for_each(&mut visit);
        }
    }

    fn own_corners(&self, vertex: usize) -> impl Iterator<Item = [u32; 2]> {
        self.quads_at(vertex).iter().map(|&[next, _, last]| [next, last])
    }
}

impl Band<4> {
    /// The quads at a vertex, counter-clockwise, as the three vertices that follow it.
    fn quads_at(&self, vertex: usize) -> &[[u32; 3]] {
        let (starts, quads) = &self.quads;
        &quads[starts[vertex] as usize..starts[vertex + 1] as usize]
    }
}

/// Sorts the quads at a vertex counter-clockwise; none if they are not one fan.
fn order(fan: &mut [[u32; 3]], is_open: bool) -> Option<()> {
    let first = if is_open { (0..fan.len()).find(|&i| fan.iter().all(|q| q[2] != fan[i][0]))? } else { 0 };
    fan.get(first)?;
    fan.swap(0, first);
    for i in 1..fan.len() {
        let next = (i..fan.len()).find(|&j| fan[j][0] == fan[i - 1][2])?;
        fan.swap(i, next);
    }
    (is_open || fan[0][0] == fan[fan.len() - 1][2]).then_some(())
}

/// A sum of corners in pairs, as a function of one vertex.
struct Sum {
    value: f64x2,
    gradient: [f64x2; 2],
    hessian: [f64x2; 3],
    least: f64x2,
    most: f64x2,
}

/// Two vectors side by side.
fn lanes(pair: [DVec2; 2]) -> [f64x2; 2] {
    [f64x2::new([pair[0].x, pair[1].x]), f64x2::new([pair[0].y, pair[1].y])]
}

impl Sum {
    fn new() -> Self {
        let zero = f64x2::ZERO;
        Self {
            value: zero,
            gradient: [zero; 2],
            hessian: [zero; 3],
            least: f64x2::splat(f64::INFINITY),
            most: zero,
        }
    }

    /// Two corners at the vertex, with edges `a` and, counter-clockwise of them, `b`.
    fn own<E: Energy>(&mut self, energy: &E, weight: f64, a: [DVec2; 2], b: [DVec2; 2]) {
        let ([ax, ay], [bx, by]) = (lanes(a), lanes(b));
        let det = ax * by - ay * bx;
        let stretch = ax * ax + ay * ay + bx * bx + by * by;
        let (ex, ey) = (bx - ax, by - ay);
        let slope = [(ax + bx) * -2.0, (ay + by) * -2.0];
        self.add(energy, (weight, 4.0), (stretch, det), slope, [ey * -1.0, ex]);
        self.most = self.most.fast_max(ex * ex + ey * ey);
    }

    /// The corners at the next vertex of a quad and at the last one. `to`: the edges from them to the vertex,
    /// `away`: those to the far vertex.
    fn beside<E: Energy>(&mut self, energy: &E, to: [DVec2; 2], away: [DVec2; 2]) {
        // Counter-clockwise the far vertex comes first at the next one and second at the last one.
        let sign = f64x2::new([1.0, -1.0]);
        let ([tx, ty], [wx, wy]) = (lanes(to), lanes(away));
        let (wx, wy) = (wx * sign, wy * sign);
        let det = wx * ty - wy * tx;
        let squared = wx * wx + wy * wy;
        let stretch = tx * tx + ty * ty + squared;
        self.add(energy, (1.0, 2.0), (stretch, det), [tx * 2.0, ty * 2.0], [wy * -1.0, wx]);
        self.most = self.most.fast_max(squared);
    }

    /// `slope` and `normal`: the derivatives of `stretch` and `det`; `bend`: the second one of `stretch`.
    fn add<E: Energy>(
        &mut self,
        energy: &E,
        (weight, bend): (f64, f64),
        (stretch, det): (f64x2, f64x2),
        [ux, uy]: [f64x2; 2],
        [nx, ny]: [f64x2; 2],
    ) {
        let d = energy.derivatives(stretch, det);
        let [value, du, dd, uu, ud, ddd] = [d.value, d.u, d.d, d.uu, d.ud, d.dd].map(|part| part * weight);
        self.value += value;
        self.gradient[0] += du * ux + dd * nx;
        self.gradient[1] += du * uy + dd * ny;
        let (pux, puy) = (uu * ux + ud * nx, uu * uy + ud * ny);
        let (pnx, pny) = (ud * ux + ddd * nx, ud * uy + ddd * ny);
        let identity = du * bend;
        self.hessian[0] += identity + pux * ux + pnx * nx;
        self.hessian[1] += pux * uy + pnx * ny;
        self.hessian[2] += identity + puy * uy + pny * ny;
        self.least = self.least.fast_min(det);
    }

    fn finish(&self) -> Local {
        let [xx, xy, yy] = self.hessian.map(|h| h.reduce_add());
        let [det, other_det] = self.least.to_array();
        let [edge, other_edge] = self.most.to_array();
        Local {
            value: self.value.reduce_add(),
            model: Quadratic {
                gradient: DVec2::new(self.gradient[0].reduce_add(), self.gradient[1].reduce_add()),
                xx,
                xy,
                yy,
            },
            det: det.min(other_det),
            edge: edge.max(other_edge),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::energy::{Power, Regularised};
    use super::*;
    use crate::relax::energy::tests::match_differences;

    /// A vertex (number 8) among `n` quads, not quite even.
    fn star(n: usize) -> Band<4> {
        let m = 2 * n;
        let at = |i: usize| {
            let length = if i.is_multiple_of(2) { 1.0 } else { 1.3 } + 0.1 * (i as f64).sin();
            length * DVec2::from_angle(std::f64::consts::TAU * i as f64 / m as f64)
        };
        let mut positions: Vec<DVec2> = (0..m).map(at).collect();
        positions.push(DVec2::ZERO);
        let quads: Vec<[u32; 4]> =
            (0..n).map(|k| [m, 2 * k, 2 * k + 1, (2 * k + 2) % m].map(|v| v as u32)).collect();
        let Ok(band) = Band::<4>::new(&quads, &positions, m, 1) else { unreachable!("a star is a patch") };
        band
    }

    fn derivatives_match_differences<E: Energy>(energy: &E, band: &Band<4>, v: usize, x: DVec2) {
        match_differences(|x| band.local(energy, v, x), band.value(energy, v, x), x, 1e-4);
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        for n in 3..=5 {
            let band = star(n);
            for x in [DVec2::ZERO, DVec2::new(0.1, -0.1), DVec2::new(-0.15, 0.12)] {
                derivatives_match_differences(&Power::<2>, &band, 2 * n, x);
                derivatives_match_differences(&Regularised { eps: 0.3 }, &band, 2 * n, x);
            }
            derivatives_match_differences(&Regularised { eps: 0.3 }, &band, 2 * n, DVec2::new(1.4, 0.6));
            derivatives_match_differences(&Regularised { eps: 0.3 }, &band, 1, DVec2::new(0.9, 0.6));
        }
    }

    #[test]
    fn unit_squares_are_the_minimum() {
        let mut band = star(4);
        let square = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1]];
        for (p, s) in band.positions.iter_mut().zip(square) {
            *p = DVec2::new(f64::from(s[0]), f64::from(s[1]));
        }
        let l = band.local(&Power::<2>, 8, DVec2::ZERO);
        assert!((l.value - 12.0).abs() < 1e-12);
        assert!(l.model.gradient.length() < 1e-12);
    }

    #[test]
    fn two_fans_at_a_vertex_are_refused() {
        let cells = [[0, 1, 2, 3], [0, 4, 5, 6]];
        assert!(Band::<4>::new(&cells, &[DVec2::ZERO; 7], 7, 1).is_err());
    }
}
