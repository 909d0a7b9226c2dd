//! Positions of the interior vertices between a fixed loop.
//!
//! First the harmonic extension of how the loop is displaced from the lattice; then, only where
//! that has inverted triangles, an energy that is finite for them; then the squared conformal
//! distortion, the sum over all triangles of ((a^2 + b^2 + c^2) / (4 sqrt(3) area))^2, and over the four corners
//! of quads of the same against right angles. That knows no lengths, so that cells may be small beside short edges
//! of the loop and large elsewhere.

use glam::DVec2;

use crate::error::Result;
use crate::geometry::corner::Ideal;
use crate::geometry::quadratic::Quadratic;
use crate::geometry::stars::Stars;
use crate::progress::Progress;

/// Vertices between two questions whether to go on.
const ASK_EVERY: usize = 1 << 14;

impl Stars for Rings {
    fn n_loop(&self) -> usize {
        self.n_loop
    }

    fn len(&self) -> usize {
        self.start.len() - 1
    }

    fn near(&self, i: usize) -> &[u32] {
        &self.ring(i)[1..]
    }

    fn triangles(&self, i: usize) -> impl Iterator<Item = (u32, u32, Ideal)> {
        self.ring(i).windows(2).map(|pair| (pair[0], pair[1], Ideal::Equilateral))
    }
}

/// The neighbours of each interior vertex, counter-clockwise, the first repeated at the end.
pub(in crate::fill) struct Rings {
    n_loop: usize,
    start: Vec<u32>,
    around: Vec<u32>,
}

impl Rings {
    /// `None` if a vertex `n_loop..n_vertices` is not surrounded by one fan of triangles.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::error::Error::Cancelled).
    pub fn new(
        triangles: &[[u32; 3]],
        n_loop: usize,
        n_vertices: usize,
        progress: Progress<'_>,
    ) -> Result<Option<Rings>> {
        let mut start = vec![0u32; n_vertices - n_loop + 1];
        for part in triangles.chunks(ASK_EVERY) {
            progress.report(0.0)?;
            for &v in part.iter().flatten().filter(|&&v| v as usize >= n_loop) {
                start[v as usize - n_loop + 1] += 1;
            }
        }
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut fill = start.clone();
        let mut pairs = vec![(0u32, 0u32); start.last().map_or(0, |&s| s as usize)];
        for (at, &[a, b, c]) in triangles.iter().enumerate() {
            if at % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
            for (v, pair) in [(a, (b, c)), (b, (c, a)), (c, (a, b))] {
                if v as usize >= n_loop {
                    let at = &mut fill[v as usize - n_loop];
                    pairs[*at as usize] = pair;
                    *at += 1;
                }
            }
        }
        let mut rings = Rings { n_loop, start: vec![0], around: Vec::with_capacity(pairs.len() * 7 / 6) };
        for v in 0..start.len() - 1 {
            if v % ASK_EVERY == 0 {
                progress.report(0.0)?;
            }
            let fan = &mut pairs[start[v] as usize..start[v + 1] as usize];
            let Some(first) = fan.first() else { return Ok(None) };
            rings.around.push(first.0);
            for i in 0..fan.len() {
                let end = rings.around.last().copied();
                let Some(next) = (i..fan.len()).find(|&j| Some(fan[j].0) == end) else { return Ok(None) };
                fan.swap(i, next);
                rings.around.push(fan[i].1);
            }
            if fan[0].0 != fan[fan.len() - 1].1 {
                return Ok(None);
            }
            rings.start.push(rings.around.len() as u32);
        }
        Ok(Some(rings))
    }

    /// Around the i-th interior vertex.
    fn ring(&self, i: usize) -> &[u32] {
        &self.around[self.start[i] as usize..self.start[i + 1] as usize]
    }
}

/// Moves interior vertices by the harmonic extension of `moved`, which holds the displacement of the loop vertices
/// and a guess of the others', right but for waves of less than `wave` edges: over-relaxed sweeps in the order of the
/// numbers, there and back.
pub(in crate::fill) fn extend(
    stars: &impl Stars,
    positions: &mut [DVec2],
    mut moved: Vec<DVec2>,
    wave: f64,
    sweeps: usize,
    progress: Progress<'_>,
) -> Result<()> {
    let n = stars.n_loop();
    // The best factor for a grid of this diameter.
    let factor = 2.0 / (1.0 + libm::sin(std::f64::consts::PI / wave.max(2.0)));
    for sweep in 0..sweeps {
        let mut largest = 0.0f64;
        let mut visit = |i: usize| {
            let near = stars.near(i);
            let sum = near.iter().fold(DVec2::ZERO, |sum, &w| sum + moved[w as usize]);
            let step = (sum / near.len() as f64 - moved[n + i]) * factor;
            moved[n + i] += step;
            largest = largest.max(step.length_squared());
        };
        let last = stars.len();
        for from in (0..last).step_by(ASK_EVERY) {
            progress.report(0.0)?;
            let to = last.min(from + ASK_EVERY);
            if sweep % 2 == 0 {
                (from..to).for_each(&mut visit)
            } else {
                (last - to..last - from).rev().for_each(&mut visit)
            }
        }
        if largest < 1e-6 {
            break;
        }
    }
    for (x, d) in positions[n..].iter_mut().zip(&moved[n..]) {
        *x += *d;
    }
    Ok(())
}

/// Sweeps around inverted triangles until there is none; false if some stay.
pub(in crate::fill) fn untangle(
    stars: &impl Stars,
    positions: &mut [DVec2],
    sweeps: usize,
    progress: Progress<'_>,
) -> Result<bool> {
    let tangled = |positions: &[DVec2], i: usize| {
        let x = positions[stars.n_loop() + i];
        stars.triangles(i).any(|(u, w, ideal)| {
            let (a, b) = (positions[u as usize] - x, positions[w as usize] - x);
            let least = TANGLED * ideal.stretch(a, b);
            // A NaN is tangled too.
            !matches!(ideal.det(a, b).partial_cmp(&least), Some(std::cmp::Ordering::Greater))
        })
    };
    // Triangles become tangled only where a vertex has moved: only those are looked at again.
    let mut bad: Vec<usize> = vec![];
    for from in (0..stars.len()).step_by(ASK_EVERY) {
        progress.report(0.0)?;
        bad.extend((from..stars.len().min(from + ASK_EVERY)).filter(|&i| tangled(positions, i)));
    }
    let mut active: Vec<usize> = Vec::new();
    for sweep in 0..sweeps {
        if bad.is_empty() {
            return Ok(true);
        }
        progress.report(sweep as f64 / sweeps as f64)?;
        if sweep % 4 == 0 {
            active.clear();
        }
        for &i in &bad {
            active.push(i);
            active.extend(stars.near(i).iter().filter_map(|&w| (w as usize).checked_sub(stars.n_loop())));
        }
        active.sort_unstable();
        active.dedup();
        for (k, &i) in active.iter().enumerate() {
            if k % ASK_EVERY == 0 {
                progress.report(sweep as f64 / sweeps as f64)?;
            }
            positions[stars.n_loop() + i] = untangled(positions[stars.n_loop() + i], stars, i, positions);
        }
        bad = active.iter().copied().filter(|&i| tangled(positions, i)).collect();
    }
    Ok(bad.is_empty())
}

/// A triangle with a smaller share of the area that its edges allow counts as tangled.
const TANGLED: f64 = 2e-3;

/// Lowers the distortion of valid triangles until no vertex moves by more than `tolerance` of its
/// edges; never inverts one. Begins with the `active` interior vertices; others follow where those have moved.
/// Returns the number of sweeps.
pub(in crate::fill) fn even_out(
    stars: &impl Stars,
    positions: &mut [DVec2],
    mut active: Vec<bool>,
    sweeps: usize,
    tolerance: f64,
    progress: Progress<'_>,
) -> Result<usize> {
    let n = stars.n_loop();
    for sweep in 0..sweeps {
        let mut moved = 0;
        for i in 0..stars.len() {
            if i % ASK_EVERY == 0 {
                progress.report(sweep as f64 / sweeps as f64)?;
            }
            if !std::mem::take(&mut active[i]) {
                continue;
            }
            let before = positions[n + i];
            let (after, size) = evened(before, stars, i, positions);
            positions[n + i] = after;
            if after.distance_squared(before) > tolerance * tolerance * size {
                moved += 1;
                active[i] = true;
                for &w in stars.near(i) {
                    if let Some(near) = (w as usize).checked_sub(n) {
                        active[near] = true;
                    }
                }
            }
        }
        if moved == 0 {
            return Ok(sweep + 1);
        }
    }
    Ok(sweeps)
}

/// Sum of squared distortions around the i-th vertex at `x`; infinite if a triangle is not valid.
fn distortion(x: DVec2, stars: &impl Stars, i: usize, positions: &[DVec2]) -> f64 {
    let mut sum = 0.0;
    for (u, w, ideal) in stars.triangles(i) {
        let (a, b) = (positions[u as usize] - x, positions[w as usize] - x);
        let d = ideal.det(a, b);
        if d <= 0.0 {
            return f64::INFINITY;
        }
        let m = ideal.stretch(a, b) / d;
        sum += m * m;
    }
    sum
}

/// One damped Newton step for `distortion`; also the mean squared length of the opposite edges.
fn evened(x: DVec2, stars: &impl Stars, i: usize, positions: &[DVec2]) -> (DVec2, f64) {
    let (mut value, mut model) = (0.0, Quadratic::default());
    let (mut size, mut count) = (0.0, 0usize);
    for (u, w, ideal) in stars.triangles(i) {
        let (a, b) = (positions[u as usize] - x, positions[w as usize] - x);
        let edge = b - a;
        let inverse = 1.0 / ideal.det(a, b);
        let m = ideal.stretch(a, b) * inverse;
        let n = edge.perp() / ideal.height();
        let (up, curved) = ideal.slope(a, b);
        // First and second derivatives of m, a square over a linear function.
        let g = (up - m * n) * inverse;
        let (un, nn) = (inverse * inverse, 2.0 * m * inverse * inverse);
        let identity = curved * inverse;
        let mxx = identity - 2.0 * un * up.x * n.x + nn * n.x * n.x;
        let mxy = -un * (up.x * n.y + up.y * n.x) + nn * n.x * n.y;
        let myy = identity - 2.0 * un * up.y * n.y + nn * n.y * n.y;
        value += m * m;
        model += Quadratic {
            gradient: 2.0 * m * g,
            xx: 2.0 * (g.x * g.x + m * mxx),
            xy: 2.0 * (g.x * g.y + m * mxy),
            yy: 2.0 * (g.y * g.y + m * myy),
        };
        size += edge.length_squared();
        count += 1;
    }
    size /= count as f64;
    let Some(mut step) = model.minimum() else { return (x, size) };
    let length = step.length_squared();
    if length > 0.25 * size {
        step *= (0.25 * size / length).sqrt();
    }
    for _ in 0..5 {
        if distortion(x + step, stars, i, positions) < value {
            return (x + step, size);
        }
        step *= 0.4;
    }
    (x, size)
}

/// A step down an energy that stays finite for inverted triangles.
fn untangled(x: DVec2, stars: &impl Stars, i: usize, positions: &[DVec2]) -> DVec2 {
    let at = |v: u32| positions[v as usize];
    let (sum, count) = stars
        .triangles(i)
        .fold((0.0, 0usize), |(sum, count), (u, w, _)| (sum + (at(w) - at(u)).length_squared(), count + 1));
    let size = (sum / count as f64).max(1e-300);
    let least = stars
        .triangles(i)
        .map(|(u, w, ideal)| ideal.det(at(u) - x, at(w) - x) / size)
        .fold(f64::INFINITY, f64::min);
    let eps = size * (0.01 + least.min(0.0).powi(2)).sqrt();
    let energy = |x: DVec2| -> f64 {
        let mut sum = 0.0;
        for (u, w, ideal) in stars.triangles(i) {
            let (a, b) = (at(u) - x, at(w) - x);
            let d = ideal.det(a, b);
            let chi = 0.5 * (d + (d * d + eps * eps).sqrt());
            sum += (ideal.stretch(a, b) + 0.1 * size) / chi;
        }
        sum
    };
    let (mut value, mut model) = (0.0, Quadratic::default());
    for (u, w, ideal) in stars.triangles(i) {
        let (a, b) = (at(u) - x, at(w) - x);
        let d = ideal.det(a, b);
        let root = (d * d + eps * eps).sqrt();
        let chi = 0.5 * (d + root);
        let slope = chi / root;
        let u = ideal.stretch(a, b) + 0.1 * size;
        let n = (b - a).perp() / ideal.height();
        let (up, curved) = ideal.slope(a, b);
        value += u / chi;
        // The positive part of the second derivative.
        let identity = curved / chi;
        let along = u * slope * slope / (chi * chi * chi);
        model += Quadratic {
            gradient: (up - u * slope / chi * n) / chi,
            xx: identity + along * n.x * n.x,
            xy: along * n.x * n.y,
            yy: identity + along * n.y * n.y,
        };
    }
    let Some(mut step) = model.minimum() else { return x };
    for _ in 0..6 {
        if energy(x + step) < value {
            return x + step;
        }
        step *= 0.4;
    }
    x
}
