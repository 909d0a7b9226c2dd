//! Gauss-Seidel sweeps: one vertex at a time to a lower energy, on the boundary along the curve.

use glam::DVec2;

use super::band::Band;
use super::contour::{Contour, Rim};
use super::energy::{Energy, det, local, value};

/// The boundary vertices as the sweeps need them, in one list over all contours.
pub(super) struct Slide<'a> {
    contours: &'a [Contour<'a>],
    pub s: Vec<f64>,
    /// Where the vertex was mapped to; sliding away from there costs `stiffness`.
    home: Vec<f64>,
    pub pinned: Vec<bool>,
    segment: Vec<u32>,
    contour: Vec<u32>,
    /// Least distance to a neighbour along the curve.
    gap: Vec<f64>,
    before: Vec<u32>,
    after: Vec<u32>,
    pub stiffness: f64,
}

impl<'a> Slide<'a> {
    pub fn new(contours: &'a [Contour<'a>], rims: &[Rim], stiffness: f64, min_gap: f64) -> Slide<'a> {
        let mut slide = Slide {
            contours,
            s: Vec::new(),
            home: Vec::new(),
            pinned: Vec::new(),
            segment: Vec::new(),
            contour: Vec::new(),
            gap: Vec::new(),
            before: Vec::new(),
            after: Vec::new(),
            stiffness,
        };
        for (k, (rim, contour)) in rims.iter().zip(contours).enumerate() {
            let (start, n) = (slide.s.len() as u32, rim.s.len() as u32);
            let gap = min_gap * contour.length() / f64::from(n);
            slide.s.extend(&rim.s);
            slide.pinned.extend(&rim.pinned);
            for i in 0..n {
                slide.before.push(start + (i + n - 1) % n);
                slide.after.push(start + (i + 1) % n);
                slide.contour.push(k as u32);
                slide.gap.push(gap);
                slide.segment.push(0);
            }
        }
        slide.home.clone_from(&slide.s);
        slide
    }

    pub fn even_out(&mut self, weight: f64, sweeps: usize) {
        for _ in 0..sweeps {
            for v in 0..self.s.len() {
                if !self.pinned[v] {
                    let (back, ahead) = self.spacing(v);
                    let middle = self.s[v] + 0.5 * (ahead - back);
                    self.s[v] = (self.home[v] + weight * middle) / (1.0 + weight);
                }
            }
        }
        self.home.clone_from(&self.s);
    }

    pub fn place(&mut self, vertex: usize, s: f64) -> DVec2 {
        self.contours[self.contour[vertex] as usize].point_near(s, &mut self.segment[vertex])
    }

    /// Arc distances to the neighbours on either side.
    pub fn spacing(&self, vertex: usize) -> (f64, f64) {
        let length = self.contours[self.contour[vertex] as usize].length();
        let (before, after) = (self.before[vertex] as usize, self.after[vertex] as usize);
        let mut back = self.s[vertex] - self.s[before];
        let mut ahead = self.s[after] - self.s[vertex];
        if before >= vertex {
            back += length;
        }
        if after <= vertex {
            ahead += length;
        }
        (back, ahead)
    }

    /// How far the vertex may slide back and ahead.
    fn room(&self, vertex: usize) -> (f64, f64) {
        let (back, ahead) = self.spacing(vertex);
        ((back - self.gap[vertex]).max(0.0), (ahead - self.gap[vertex]).max(0.0))
    }
}

/// Which vertices are worth a visit.
pub(super) struct Active {
    dirty: Vec<bool>,
}

impl Active {
    pub fn all(n: usize) -> Active {
        Active { dirty: vec![true; n] }
    }

    pub fn none(n: usize) -> Active {
        Active { dirty: vec![false; n] }
    }

    pub fn mark(&mut self, vertex: usize) {
        if let Some(d) = self.dirty.get_mut(vertex) {
            *d = true;
        }
    }

    fn take(&mut self, vertex: usize) -> bool {
        std::mem::take(&mut self.dirty[vertex])
    }
}

/// Moves every active vertex once; returns the number of vertices that moved by more than
/// `tolerance`, whose neighbours become active.
pub(super) fn sweep<E: Energy>(
    energy: &E,
    band: &mut Band,
    slide: &mut Slide,
    sliding: bool,
    active: &mut Active,
    tolerance: f64,
) -> usize {
    let mut moved = 0;
    for v in 0..band.n_free {
        if !active.take(v) {
            continue;
        }
        let step = if v >= band.n_rim {
            move_inside(energy, band, v)
        } else if sliding && !slide.pinned[v] {
            move_along(energy, band, slide, v)
        } else {
            0.0
        };
        if step > tolerance {
            moved += 1;
            active.mark(v);
            let around = band.around(v);
            for &w in around {
                active.mark(w as usize);
            }
        }
    }
    moved
}

/// One damped Newton step of an interior vertex; returns its length.
fn move_inside<E: Energy>(energy: &E, band: &mut Band, v: usize) -> f64 {
    let ring = band.around(v);
    let x = band.positions[v];
    let here = local(energy, x, ring, &band.positions);
    let mut step = here.newton();
    let mut length = step.length();
    // NaN too: leave the vertex where it is.
    if !(length > 1e-9) {
        return 0.0;
    }
    if length > 0.5 {
        step *= 0.5 / length;
        length = 0.5;
    }
    let decrement = -here.gradient.dot(step);
    // Far from the barrier and with little to gain, the full step is safe.
    let near_barrier = length * here.edge.sqrt() > 0.4 * here.det;
    if !E::BARRIER || near_barrier || decrement > 0.02 * here.value {
        let mut tries = 0;
        loop {
            let x1 = x + step;
            if value(energy, x1, ring, &band.positions) < here.value {
                break;
            }
            tries += 1;
            if tries == 5 {
                return 0.0;
            }
            step *= 0.4;
            length *= 0.4;
        }
    }
    band.positions[v] = x + step;
    length
}

/// One step of a boundary vertex along the curve; returns its length.
fn move_along<E: Energy>(energy: &E, band: &mut Band, slide: &mut Slide, v: usize) -> f64 {
    const REACH: f64 = 0.1;
    let (back, ahead) = slide.room(v);
    let slide_stiffness = slide.stiffness;
    let (s, home) = (slide.s[v], slide.home[v]);
    let ring = band.around(v);
    let x = band.positions[v];
    if !E::BARRIER {
        // Untangling: the energy along a winding curve has many local minima, so look around.
        let cost = |x: DVec2, s: f64| {
            value(energy, x, ring, &band.positions) + slide_stiffness * (s - home) * (s - home)
        };
        let mut best = (cost(x, s), x, s);
        let (low, high) = (back.min(1.5), ahead.min(1.5));
        const SAMPLES: u32 = 12;
        for i in 0..=SAMPLES {
            let s1 = s - low + (low + high) * f64::from(i) / f64::from(SAMPLES);
            let x1 = slide.place(v, s1);
            let c = cost(x1, s1);
            if c < best.0 {
                best = (c, x1, s1);
            }
        }
        if best.2 != s {
            band.positions[v] = best.1;
            slide.s[v] = best.2;
            return (best.2 - s).abs();
        }
    }
    let here = local(energy, x, ring, &band.positions);
    // The direction over a stretch of the curve, since a drawn line may tremble.
    let tangent = (slide.place(v, s + REACH) - slide.place(v, s - REACH)) * (0.5 / REACH);
    let pull = slide.stiffness * (s - home);
    let gradient = here.gradient.dot(tangent) + 2.0 * pull;
    let curvature = here.along(tangent) + 2.0 * slide.stiffness;
    let scale = here.xx + here.yy;
    let mut step = if curvature > 1e-3 * scale { -gradient / curvature } else { -gradient.signum() * 0.2 };
    if !step.is_finite() {
        return 0.0;
    }
    step = step.clamp(-0.3, 0.3).clamp(-back, ahead);
    let now = here.value + pull * (s - home);
    for _ in 0..4 {
        if step.abs() < 1e-6 {
            return 0.0;
        }
        let s1 = s + step;
        let x1 = slide.place(v, s1);
        let then = value(energy, x1, ring, &band.positions) + slide.stiffness * (s1 - home) * (s1 - home);
        if then < now {
            band.positions[v] = x1;
            slide.s[v] = s1;
            return step.abs();
        }
        step *= 0.4;
    }
    0.0
}

/// Harmonic displacement of the rings from that of the boundary, a few sweeps.
pub(super) fn extend(band: &mut Band, displacement: &[DVec2], sweeps: usize) {
    let mut moved = displacement.to_vec();
    let rim = moved.len();
    moved.resize(band.positions.len(), DVec2::ZERO);
    for _ in 0..sweeps {
        for v in rim..band.n_free {
            let around = &band.around(v)[1..];
            let sum = around.iter().fold(DVec2::ZERO, |sum, &w| sum + moved[w as usize]);
            moved[v] = sum / around.len() as f64;
        }
    }
    for (x, d) in band.positions.iter_mut().zip(&moved) {
        *x += *d;
    }
}

/// Signed area of a triangle over that of the equilateral one.
pub(super) fn det_of(band: &Band, t: [u32; 3]) -> f64 {
    let [a, b, c] = t.map(|v| band.positions[v as usize]);
    det(b - a, c - a)
}
