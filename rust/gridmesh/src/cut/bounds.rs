//! What an edge length asks for, before anything is made of it.

use glam::DVec3;

use super::input::Polygons;
use super::sheet::Sheet;
use crate::cut::caps::loops;
use crate::cut::divide::parted::Parted;
use crate::error::{Error, Result};

/// Triangles that caps may have.
const CAPS: f64 = 2e6;

/// Edges that the lines of a cut may have.
const ALONG: f64 = 20_000.0;

/// Refuses edge lengths that would make too many edges or triangles, by the length of the lines and the area within them.
///
/// # Errors
/// [`Error::CutTooLarge`].
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
    refuse("edges along its lines", along / length, ALONG)?;
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
    let triangles = (unit * area).abs() / length / length / (0.25 * 3f64.sqrt());
    refuse("triangles in its caps", triangles, CAPS)
}

fn refuse(what: &'static str, number: f64, limit: f64) -> Result<()> {
    if number <= limit { Ok(()) } else { Err(Error::CutTooLarge { what, number, limit }) }
}
