//! Edges of about one length over all parts of a picture.

use crate::body::surface::Surface;
use crate::cutout::made::Made;
use crate::cutout::steps::Step;
use crate::error::Result;

/// Edges shorter than this, in mean lengths of the edges of a picture, show in a texture.
const SHORT: f64 = 1.0 / 3.0;

/// Times that parts are made finer because others are.
const ROUNDS: usize = 8;

/// The least edge length in one of these rounds, relative to what it was.
const LEAST: f64 = 0.7;

/// Makes parts finer as long as edges of others are short for the picture and that helps; returns which were.
///
/// `best` makes the best mesh of a part from a step on; what is no surface, or has an edge that is short for itself, is left.
pub(super) fn evened(
    made: &mut [Made],
    best: impl Fn(usize, Step) -> Result<Option<Made>>,
) -> Result<Vec<usize>> {
    let mut first: Vec<Step> = made.iter().map(|made| made.step).collect();
    let mut changed = vec![false; made.len()];
    for _ in 0..ROUNDS {
        let edges: Vec<Option<Edges>> =
            made.iter().map(|made| made.surface.as_ref().ok().map(Edges::of)).collect();
        let (sum, count) =
            edges.iter().flatten().fold((0.0, 0), |(sum, count), own| (sum + own.sum, count + own.count));
        let mean = sum / count as f64;
        let least = edges.iter().flatten().map(|own| own.least).fold(f64::INFINITY, f64::min);
        let ratio = least / (SHORT * mean);
        let is_coarse = |own: &Edges| own.mean() > mean && own.least > 1.1 * SHORT * mean;
        let coarse: Vec<usize> =
            (0..made.len()).filter(|&k| edges[k].as_ref().is_some_and(is_coarse)).collect();
        // Not a number, where there is no surface.
        if ratio >= 1.0 || ratio.is_nan() || coarse.is_empty() {
            break;
        }
        for k in coarse {
            let by = LEAST.max(0.95 * ratio);
            first[k] = first[k].next().max(Step::nearest(first[k].number() / (by * by)));
            let Some(finer) = best(k, first[k])? else { continue };
            let Ok(surface) = &finer.surface else { continue };
            let own = Edges::of(surface);
            if !own.has_short() && edges[k].as_ref().is_some_and(|before| own.mean() < before.mean()) {
                made[k] = finer;
                changed[k] = true;
            }
        }
    }
    Ok((0..changed.len()).filter(|&k| changed[k]).collect())
}

/// The lengths of the edges of a surface.
pub(super) struct Edges {
    least: f64,
    sum: f64,
    count: usize,
}

impl Edges {
    pub(super) fn of(surface: &Surface) -> Self {
        let mut ends: Vec<[u32; 2]> = Vec::new();
        let mut sides = |face: &[u32]| {
            ends.extend((0..face.len()).map(|i| {
                let [a, b] = [face[i], face[(i + 1) % face.len()]];
                [a.min(b), a.max(b)]
            }));
        };
        surface.triangles.iter().for_each(|face| sides(face));
        surface.quads.iter().for_each(|face| sides(face));
        ends.sort_unstable();
        ends.dedup();
        let length = |&[a, b]: &[u32; 2]| surface.vertices[a as usize].distance(surface.vertices[b as usize]);
        let start = Self { least: f64::INFINITY, sum: 0.0, count: ends.len() };
        ends.iter().map(length).fold(start, |edges, length| Self {
            least: edges.least.min(length),
            sum: edges.sum + length,
            ..edges
        })
    }

    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// Whether one is short for the surface itself.
    pub(super) fn has_short(&self) -> bool {
        self.least < SHORT * self.mean()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn edges_between_two_faces_count_once() {
        let vertices =
            vec![dvec3(0.0, 0.0, 0.0), dvec3(3.0, 0.0, 0.0), dvec3(3.0, 4.0, 0.0), dvec3(0.0, 4.0, 0.0)];
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let sheet = Surface { vertices: vertices.clone(), triangles, ..Surface::default() };
        let edges = Edges::of(&sheet);
        assert_eq!((edges.least, edges.sum, edges.count), (3.0, 3.0 + 4.0 + 5.0 + 3.0 + 4.0, 5));
        assert!(!edges.has_short());
        let quad = Surface { vertices, quads: vec![[0, 1, 2, 3]], ..Surface::default() };
        assert_eq!(Edges::of(&quad).count, 4);
    }
}
