//! Another drawing under a map that was made before: bends that stay while an outline is being dragged.

use glam::DVec2;

use super::carrier::{Carrier, Line};
use super::chords::Chords;
use super::grid::TriangleGrid;
use super::image::{BentContours, Image};
use super::{Bent, in_frame};
use crate::drawing::curve::ClosedCurve;

/// Places of a line are bent that are at most so far apart, in edges; and where its points are those of the old
/// line, others between them only where they are farther apart.
const SPACING: f64 = 1.0;
const GAP: f64 = 2.5;

/// So many points of two lines are compared to find how one is numbered in the other.
const COMPARED: usize = 32;

/// A place of a line and what is added to its image.
struct Place {
    arc: f64,
    more: DVec2,
}

impl Bent {
    /// The same map for other contours, in the units of the drawing: inside the old drawing it is what it was,
    /// outside that is extended by its derivative at the nearest place of the outline. A drawing of as many points
    /// is taken for the old one with its points moved, and bent at the same places: then the contours that have not
    /// moved are what they were. None where the bent contours meet themselves or each other.
    ///
    /// O(n) for contours inside the old drawing.
    pub(crate) fn followed(&self, contours: &[ClosedCurve]) -> Option<Self> {
        let ground = &self.ground;
        let way = WayThere::new(&ground.carrier, &self.image);
        let in_detail = self.drawing.in_detail;
        let (images, known) = BentContours::samples(&ground.carrier, &self.image, &ground.lines, in_detail);
        let (mut rings, mut drawn, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
        for (k, line) in contours.iter().map(|contour| in_frame(contour, &ground.frame)).enumerate() {
            let old = ground
                .lines
                .get(k)
                .filter(|old| contours.len() == ground.lines.len() && old.points.len() == line.points.len());
            let places = match old {
                Some(old) => moved_places(&way, old, (&known[k], &images[k]), &line),
                None => even_places(&line),
            };
            ring_of(&way, &line, &places, &mut rings, &mut drawn);
            lengths.push(line.length());
        }
        let drawing = BentContours::of_rings(&rings, &drawn, &lengths, in_detail)?;
        Some(Self {
            ground: ground.clone(),
            image: self.image.clone(),
            drawing,
            share: self.share,
            turn: self.turn,
            price: 0.0,
            price_of_limbs: 0.0,
            is_followed: true,
        })
    }
}

/// The points of a line and others between them.
fn even_places(line: &Line) -> Vec<Place> {
    let mut places = Vec::new();
    for ends in line.arcs.windows(2) {
        let parts = ((ends[1] - ends[0]) / SPACING).ceil().max(1.0);
        let arc = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / parts;
        places.extend((0..parts as usize).map(|k| Place { arc: arc(k), more: DVec2::ZERO }));
    }
    places
}

/// The places of an old line, given by arc lengths with their images, on one with its points moved; more where these
/// are far apart.
fn moved_places(
    way: &WayThere<'_>,
    old: &Line,
    (known, images): (&[f64], &[DVec2]),
    line: &Line,
) -> Vec<Place> {
    let n = line.points.len();
    let ahead = numbering(&old.points, &line.points);
    let mut places: Vec<Place> = known
        .iter()
        .zip(images)
        .map(|(&s, &image)| {
            let (i, t) = old.place(s);
            let i = (i + ahead) % n;
            let arc = line.arcs[i] + t * (line.arcs[i + 1] - line.arcs[i]);
            Place { arc, more: image - way.at(old.at(s)) }
        })
        .collect();
    places.sort_by(|a, b| a.arc.total_cmp(&b.arc));
    places.dedup_by(|b, a| b.arc <= a.arc || b.arc >= line.length());
    let mut all = Vec::with_capacity(places.len());
    for k in 0..places.len() {
        let (from, to) = (&places[k], &places[(k + 1) % places.len()]);
        let gap = (to.arc - from.arc).rem_euclid(line.length());
        let parts = if gap > GAP { (gap / SPACING).ceil() } else { 1.0 };
        all.extend((0..parts as usize).map(|k| {
            let t = k as f64 / parts;
            let arc = from.arc + t * gap;
            let arc = if arc >= line.length() { arc - line.length() } else { arc };
            Place { arc, more: from.more.lerp(to.more, t) }
        }));
    }
    all.sort_by(|a, b| a.arc.total_cmp(&b.arc));
    all
}

/// How many points later those of an old line come in one with its points moved.
fn numbering(old: &[DVec2], line: &[DVec2]) -> usize {
    let n = line.len();
    let step = n.div_ceil(COMPARED);
    let apart = |ahead: usize| -> f64 {
        (0..n).step_by(step).map(|i| old[i].distance_squared(line[(i + ahead) % n])).sum()
    };
    let mut best = (apart(0), 0);
    for ahead in 1..n {
        let apart = apart(ahead);
        if apart < best.0 {
            best = (apart, ahead);
        }
    }
    best.1
}

/// Adds the image of a line and where its points are on it.
fn ring_of(
    way: &WayThere<'_>,
    line: &Line,
    places: &[Place],
    rings: &mut Vec<Vec<DVec2>>,
    drawn: &mut Vec<Vec<f64>>,
) {
    rings.push(places.iter().map(|place| way.at(line.at(place.arc)) + place.more).collect());
    drawn.push(places.iter().map(|place| place.arc).collect());
}

/// Finds the image of points of the drawing.
struct WayThere<'a> {
    carrier: &'a Carrier,
    image: &'a Image,
    grid: TriangleGrid,
    chords: Chords<'a>,
}

impl<'a> WayThere<'a> {
    fn new(carrier: &'a Carrier, image: &'a Image) -> Self {
        let grid = TriangleGrid::new(&carrier.vertices, &carrier.triangles);
        Self { carrier, image, grid, chords: Chords::new(carrier, &carrier.vertices) }
    }

    /// Half the linear map, half the corners' own derivatives; outside by the derivative at the nearest chord.
    fn at(&self, x: DVec2) -> DVec2 {
        let (carrier, image) = (self.carrier, self.image);
        if let Some((t, weights)) = self.grid.locate(x, &carrier.vertices, &carrier.triangles) {
            let corner = |(v, w): (u32, f64)| {
                let v = v as usize;
                w * (image.positions[v] + 0.5 * image.turned(v, x - carrier.vertices[v]))
            };
            return carrier.triangles[t].into_iter().zip(weights).map(corner).sum();
        }
        self.chords.nearest(x).map_or(x, |([a, b], t)| {
            let off = x - carrier.vertices[a].lerp(carrier.vertices[b], t);
            let [p, q] = [a, b].map(|e| image.turned(e, off));
            image.positions[a].lerp(image.positions[b], t) + p.lerp(q, t)
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::Arc;

    use super::*;
    use crate::bend::{Ground, choose};
    use crate::drawing::contours::read_contours;
    use crate::error::Result;
    use crate::options::CellShape;
    use crate::path::placement::Lattice;
    use crate::progress::Progress;

    fn wavy(shift: impl Fn(usize) -> DVec2) -> Vec<DVec2> {
        let at = |i: usize| {
            let t = TAU * i as f64 / 60.0;
            DVec2::new((14.0 + 3.0 * (3.0 * t).sin()) * t.cos(), (9.0 + 2.0 * t.cos()) * t.sin())
        };
        (0..60).map(|i| at(i) + shift(i)).collect()
    }

    #[test]
    fn a_drawing_that_has_hardly_moved_has_hardly_another_image() -> Result<()> {
        let contours = read_contours(&wavy(|_| DVec2::ZERO), &[])?;
        let moved = read_contours(&wavy(|i| DVec2::new(0.0, 1e-6 * (i % 7) as f64)), &[])?;
        let frame = Lattice { origin: DVec2::ZERO, angle: 0.0, edge_length: 1.0 };
        let ground =
            Ground::new(&contours, frame, None, false, CellShape::Triangle, Progress::NONE)?.map(Arc::new);
        let mut seen = 0;
        if let Some(ground) = ground {
            let operators = ground.operators(Progress::NONE)?;
            for (bent, _) in choose::candidates((&ground, &operators), 1.0, 1, Progress::NONE)? {
                for (contours, near) in [(&contours, 1e-9), (&moved, 1e-4)] {
                    let again = bent.followed(contours);
                    let again = again.as_ref().map_or(&[][..], |bent| bent.contours());
                    assert_eq!(again.len(), 1);
                    assert_eq!(again[0].points().len(), bent.contours()[0].points().len());
                    for (p, q) in bent.contours()[0].points().iter().zip(again[0].points()) {
                        assert!(p.distance(*q) < near, "{p} {q}");
                    }
                    seen += 1;
                }
            }
        }
        assert_eq!(seen, 2);
        Ok(())
    }
}
