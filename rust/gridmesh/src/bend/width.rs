//! How wide the drawing is along its contours, and the sizes that this asks for.

use glam::DVec2;

use super::carrier::{Carrier, Rim};
use crate::error::Result;
use crate::options::CellShape;
use crate::progress::Progress;

/// Parts narrower than this want more triangles across, in edges.
const WIDE: f64 = 12.0;
/// Nothing is asked to be finer than by this factor, as a logarithm.
const MOST: f64 = 1.2;
/// Standard deviation of the smoothing of widths along the contours, in edges.
const SIGMA: f64 = 1.5;
/// So many widths are measured between two questions whether to go on.
const ASKED: usize = 64;

/// Sizes that the boundary vertices wish for.
pub struct Wish {
    /// Log scale of each.
    pub sizes: Vec<f64>,
    /// How much each counts.
    pub shares: Vec<f64>,
}

impl Wish {
    /// Finer where the drawing is narrow, by this share of the most; wide parts count little.
    pub fn of_narrowness(widths: &[f64], share: f64) -> Self {
        const LITTLE: f64 = 0.1;
        let sizes = narrowness(widths);
        let shares = sizes.iter().map(|size| LITTLE + size / MOST).collect();
        let sizes = sizes.iter().map(|size| share * size).collect();
        Self { sizes, shares }
    }

    /// So many times the triangles at each boundary vertex.
    pub fn of_densities(densities: &[f64]) -> Self {
        let sizes = densities.iter().map(|density| 0.5 * libm::log(*density)).collect();
        Self { sizes, shares: vec![1.0; densities.len()] }
    }
}

/// Log scale that each boundary vertex wishes for: finer where the drawing is narrow.
fn narrowness(widths: &[f64]) -> Vec<f64> {
    widths.iter().map(|width| (libm::log(WIDE) - width).clamp(0.0, MOST)).collect()
}

/// How much the direction of each boundary vertex counts, 0 to 1: less at tips and in parts too narrow for
/// two lattice lines, which no lattice direction suits.
pub fn room(widths: &[f64], shape: CellShape) -> Vec<f64> {
    const LEAST: f64 = 0.02;
    // Triangles hardly mind; with 1.2 quads in the outline of Brazil have 40 poles instead of 16.
    let narrow = match shape {
        CellShape::Triangle => 1.2,
        CellShape::Quad => 2.5,
    };
    widths.iter().map(|width| (libm::exp(*width) / narrow).powi(2).clamp(LEAST, 1.0)).collect()
}

/// Logarithm of the width of the limb at each boundary vertex, in edges: of the largest disc inside the drawing that comes
/// near it. A bump on the rim of a wide part is no limb.
///
/// O(number of boundary vertices times number of all).
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub fn log_limbs(carrier: &Carrier, progress: Progress<'_>) -> Result<Vec<f64>> {
    /// A disc that ends so far from a boundary vertex, in edges, comes near it.
    const NEAR: f64 = 0.7;
    const LEAST: f64 = 0.5;
    let n: usize = carrier.rims.iter().map(Rim::len).sum();
    let (rim, inner) = carrier.vertices.split_at(n);
    let mut discs: Vec<(DVec2, f64)> = Vec::with_capacity(inner.len());
    for (i, &centre) in inner.iter().enumerate() {
        if i % ASKED == 0 {
            progress.report(0.0)?;
        }
        let nearest = rim.iter().map(|p| p.distance_squared(centre)).fold(f64::INFINITY, f64::min);
        discs.push((centre, nearest.sqrt()));
    }
    let width = |p: &DVec2| {
        let reaches =
            |&&(centre, radius): &&(DVec2, f64)| p.distance_squared(centre) <= (radius + NEAR).powi(2);
        let largest = discs.iter().filter(reaches).map(|disc| disc.1).fold(LEAST, f64::max);
        libm::log(2.0 * largest)
    };
    Ok(rim.iter().map(width).collect())
}

/// The boundary vertices in the narrowest part of the contours, a seventh of their length.
pub fn narrowest(carrier: &Carrier, widths: &[f64]) -> Vec<bool> {
    const SHARE: f64 = 0.15;
    let lengths = carrier.lengths();
    let mut order: Vec<usize> = (0..widths.len()).collect();
    order.sort_by(|&a, &b| widths[a].total_cmp(&widths[b]).then(a.cmp(&b)));
    let mut left = SHARE * lengths.iter().sum::<f64>();
    let mut chosen = vec![false; widths.len()];
    for i in order {
        if left <= 0.0 {
            break;
        }
        left -= lengths[i];
        chosen[i] = true;
    }
    chosen
}

/// Logarithm of the width at each boundary vertex, smoothed along the contours.
///
/// The width at a vertex is twice the smallest circle that touches the contour there from inside and
/// meets a contour again. O(square of the number of boundary vertices).
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub fn log_widths(carrier: &Carrier, progress: Progress<'_>) -> Result<Vec<f64>> {
    let n: usize = carrier.rims.iter().map(Rim::len).sum();
    let at = &carrier.vertices[..n];
    let mut found = Vec::with_capacity(n);
    for rim in &carrier.rims {
        let count = rim.len();
        let mut logs = Vec::with_capacity(count);
        for i in 0..count {
            if i % ASKED == 0 {
                progress.report(0.0)?;
            }
            let p = at[rim.start + i];
            let ahead = at[rim.next(i)] - at[rim.start + (i + count - 1) % count];
            let inwards = ahead.perp().normalize_or_zero();
            let radius = |q: &DVec2| {
                let d = *q - p;
                let depth = d.dot(inwards);
                if depth > 0.0 { d.length_squared() / (2.0 * depth) } else { f64::INFINITY }
            };
            let width = 2.0 * at.iter().map(radius).fold(f64::INFINITY, f64::min);
            logs.push(libm::log(width.clamp(0.5, 1e6)));
        }
        found.extend((0..count).map(|i| smoothed(rim, &logs, i)));
    }
    Ok(found)
}

/// The mean of the logarithms near a vertex, weighted by their distance along the contour.
fn smoothed(rim: &Rim, logs: &[f64], i: usize) -> f64 {
    let (here, reach) = (rim.arcs[i], 3.0 * SIGMA);
    // A little wider than it has to be: the distance decides.
    let within = |from: f64, to: f64| {
        let slack = 1e-6 * rim.length;
        let first = rim.arcs.partition_point(|&s| s < from - slack);
        first..rim.arcs.partition_point(|&s| s <= to + slack).max(first)
    };
    let low = within(f64::NEG_INFINITY, here + reach - rim.length);
    let middle = within(here - reach, here + reach);
    let high = within(here - reach + rim.length, f64::INFINITY);
    let middle = middle.start.max(low.end)..middle.end.max(low.end);
    let high = high.start.max(middle.end)..high.end.max(middle.end);
    let (mut sum, mut weights) = (0.0, 0.0);
    for k in low.chain(middle).chain(high) {
        let d = (rim.arcs[k] - here).abs();
        let d = d.min(rim.length - d);
        if d < reach {
            let weight = libm::exp(-0.5 * (d / SIGMA).powi(2));
            sum += weight * logs[k];
            weights += weight;
        }
    }
    sum / weights
}
