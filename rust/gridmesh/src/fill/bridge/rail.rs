//! The loops of a bridge, how the surface goes on from them, and curves across between them.

use glam::DVec3;

use super::align::Ring;

/// A loop is the end of a pipe if the surface goes on from its vertices in directions whose mean is at least this long.
const PIPE: f64 = 0.8;

/// A closed curve through the vertices of a loop, with the slope of the surface along it.
#[derive(Clone, Debug)]
pub(super) struct Rail {
    /// Ascending, over one round.
    around: Vec<f64>,
    points: Vec<DVec3>,
    /// For each of as many equal parts of a round the last vertex before it.
    index: Vec<u32>,
    /// From each vertex to the next.
    spans: Vec<Cubic>,
}

/// The curve between two vertices, by powers of the share of the way.
#[derive(Clone, Copy, Debug)]
struct Cubic {
    powers: [DVec3; 4],
    /// The derivative across where it begins, and how that changes along.
    across: DVec3,
    turn: DVec3,
    width: f64,
    inverse: f64,
}

/// Point and derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub point: DVec3,
    pub along: DVec3,
    pub across: DVec3,
}

impl Rail {
    /// `across`: derivatives across the curve at its vertices, from the lower loop to the upper one.
    pub fn new(around: Vec<f64>, points: Vec<DVec3>, across: Vec<DVec3>) -> Rail {
        let n = points.len();
        let width =
            |k: usize| if k + 1 < n { around[k + 1] - around[k] } else { around[0] + 1.0 - around[k] };
        let slope = |k: usize| (points[(k + 1) % n] - points[k]) / width(k).max(1e-12);
        // Of the parabola through three vertices.
        let along = |k: usize| {
            let before = (k + n - 1) % n;
            let (a, b) = (width(before), width(k));
            (slope(before) * b + slope(k) * a) / (a + b).max(1e-12)
        };
        let along = (0..n).map(along).collect::<Vec<_>>();
        let span = |a: usize| {
            let (b, width) = ((a + 1) % n, width(a).max(1e-12));
            let (p, q) = (points[a], points[b]);
            let (u, v) = (along[a] * width, along[b] * width);
            Cubic {
                powers: [p, u, 3.0 * (q - p) - 2.0 * u - v, 2.0 * (p - q) + u + v],
                across: across[a],
                turn: (across[b] - across[a]) / width,
                width,
                inverse: 1.0 / width,
            }
        };
        let spans = (0..n).map(span).collect();
        let index = |part: usize| {
            let at = around[0] + part as f64 / n as f64;
            (around.partition_point(|&x| x <= at) - 1) as u32
        };
        let index = (0..n).map(index).collect();
        Rail { points, index, around, spans }
    }

    /// One without derivatives across.
    pub fn flat(around: &[f64], points: Vec<DVec3>) -> Rail {
        let none = vec![DVec3::ZERO; points.len()];
        Rail::new(around.to_vec(), points, none)
    }

    /// The same curve with derivatives across it.
    pub fn with_slopes(self, across: Vec<DVec3>) -> Rail {
        Rail::new(self.around, self.points, across)
    }

    /// The vertex before a place, and the share of the way to the next.
    pub fn segment(&self, around: f64) -> (usize, f64) {
        let n = self.points.len();
        let start = self.around[0];
        let off = around - start;
        let within = if (0.0..1.0).contains(&off) { around } else { around - off.floor() };
        let part = (((within - start) * n as f64) as usize).min(n - 1);
        let mut k = self.index[part] as usize;
        while k + 1 < n && self.around[k + 1] <= within {
            k += 1;
        }
        (k, ((within - self.around[k]) * self.spans[k].inverse).clamp(0.0, 1.0))
    }

    /// The point, the derivative along, the one across, and how that changes along.
    pub fn at(&self, around: f64) -> [DVec3; 4] {
        let (k, t) = self.segment(around);
        let Cubic { powers: [p, u, c, d], across, turn, width, inverse } = self.spans[k];
        let point = p + t * (u + t * (c + t * d));
        let along = (u + t * (2.0 * c + t * (3.0 * d))) * inverse;
        [point, along, across + t * width * turn, turn]
    }
}

/// Cubics between two curves, by one parameter along these.
pub(super) struct Curves {
    pub ends: [DVec3; 2],
    /// Derivatives of the ends along the curves.
    pub along: [DVec3; 2],
    /// Derivatives across, over the whole way from one curve to the other.
    pub slopes: [DVec3; 2],
    /// Derivatives along the curves of the slopes.
    pub turns: [DVec3; 2],
}

impl Curves {
    /// The point at a height, where the first curve lies at the start of the range and the second one at its end.
    pub fn at(&self, height: f64, range: [f64; 2]) -> Spot {
        let Curves { ends: [p, q], along: [dp, dq], slopes: [u, v], turns: [du, dv] } = *self;
        let width = range[1] - range[0];
        let t = (height - range[0]) / width;
        let (h, k) = (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t));
        let (f, df) = (t * (1.0 - t) * (1.0 - t), (1.0 - t) * (1.0 - 3.0 * t));
        let (g, dg) = (t * t * (t - 1.0), t * (3.0 * t - 2.0));
        Spot {
            point: p + (q - p) * h + u * f + v * g,
            along: dp + (dq - dp) * h + du * f + dv * g,
            across: ((q - p) * k + u * df + v * dg) / width,
        }
    }
}

/// One loop of a loft.
pub(super) struct Edge<'a> {
    pub ring: &'a Ring,
    /// Where each vertex lies around the axis.
    pub around: &'a [f64],
    /// For each vertex the direction in which the surface around goes on into the tube, or zero.
    pub onward: &'a [DVec3],
}

/// For each vertex of a loop the direction in which the surface around goes on; `apexes`: the third corners of the
/// triangles beyond the edges. Zero where there are none.
pub(super) fn onward(points: &[DVec3], apexes: &[Option<DVec3>]) -> Vec<DVec3> {
    const ROUNDS: usize = 2;
    let n = points.len();
    let across = |k: usize| {
        let (a, b) = (points[k], points[(k + 1) % n]);
        let along = (b - a).normalize_or_zero();
        let away = apexes[k].map_or(DVec3::ZERO, |apex| 0.5 * (a + b) - apex);
        away.reject_from_normalized(along).normalize_or_zero()
    };
    let edges = (0..n).map(across).collect::<Vec<_>>();
    let mut onward = (0..n).map(|k| edges[k] + edges[(k + n - 1) % n]).collect::<Vec<_>>();
    for _ in 0..ROUNDS {
        let before = onward.clone();
        for k in 0..n {
            onward[k] = 2.0 * before[k] + before[(k + 1) % n] + before[(k + n - 1) % n];
        }
    }
    onward.into_iter().map(|v| v.normalize_or_zero()).collect()
}

/// The mean of the directions in which the surface goes on from the vertices of a loop: of length 1 at the end of a pipe, zero at a
/// hole in a sheet.
pub(in crate::fill) fn ahead(onward: &[DVec3]) -> DVec3 {
    onward.iter().sum::<DVec3>() / onward.len() as f64
}

/// Whether a loop, by the directions in which the surface goes on from its vertices, is the end of a pipe.
pub(in crate::fill) fn is_pipe(onward: &[DVec3]) -> bool {
    ahead(onward).length() >= PIPE
}

/// Whether it is a hole in a sheet; neither, if it has no faces.
pub(super) fn is_sheet(onward: &[DVec3]) -> bool {
    onward.iter().any(|&way| way != DVec3::ZERO) && !is_pipe(onward)
}

/// The derivative at the ends of a cubic that follows an arc, in chords of the arc; `angle`: by how much it turns, in radians above 0.
pub(super) fn arc_slope(angle: f64) -> f64 {
    2.0 * libm::tan(0.25 * angle) / libm::sin(0.5 * angle)
}
