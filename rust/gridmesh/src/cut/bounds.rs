//! What an edge length asks for, before anything is made of it.

use glam::DVec3;

use super::input::Polygons;
use super::sheet::Sheet;
use crate::cut::caps::loops;
use crate::cut::divide::parted::Parted;
use crate::error::{Error, Result};

/// Triangles that caps may have.
const CAPS: f64 = 2e6;

/// Triangles that may lie along the lines of a cut: two on each side of every edge.
const ALONG: f64 = 80_000.0;
const BESIDE: f64 = 4.0;

/// Refuses edge lengths that would make too many triangles, by the length of the lines and the area within them.
///
/// # Errors
/// [`Error::TooLarge`].
pub(super) fn check(
    vertices: &[DVec3],
    faces: Polygons<'_>,
    parted: &Parted,
    sheet: &Sheet,
    length: f64,
) -> Result<()> {
    let position = |v: u32| parted.position(vertices, v);
    let mut edges = parted.cut.keys().copied().collect::<Vec<_>>();
    edges.sort_unstable();
    let along: f64 = edges.iter().map(|&(a, b)| position(a).distance(position(b))).sum();
    refuse(BESIDE * (along / length), ALONG)?;
    let loops = loops::trace(faces, parted, sheet);
    let (mut area, mut heights, mut count) = (0.0, 0.0, 0usize);
    for l in &loops.closed {
        let height = |k: usize| sheet.view.height(position(l.nodes[k % l.nodes.len()]));
        // The area below each edge: holes count less than nothing.
        for k in 0..l.nodes.len() {
            let (low, high) = (height(k), height(k + 1));
            area += 0.5 * (low + high) * (l.places[k + 1] - l.places[k]);
            heights += low;
            count += 1;
        }
    }
    // Through an eye the places are angles.
    let unit = if sheet.view.central { heights / count.max(1) as f64 } else { 1.0 };
    refuse((unit * area).abs() / length / length / (0.25 * 3f64.sqrt()), CAPS)
}

fn refuse(triangles: f64, limit: f64) -> Result<()> {
    if triangles <= limit { Ok(()) } else { Err(Error::TooLarge { triangles, limit }) }
}
