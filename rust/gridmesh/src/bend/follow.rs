//! Another drawing under a map that was made before: bends that stay while an outline is being dragged.

use glam::DVec2;

use super::carrier::{Carrier, Rim};
use super::grid::TriangleGrid;
use super::image::{BentContours, Image};
use super::{Bent, in_frame};
use crate::drawing::curve::ClosedCurve;
use crate::geometry::segments::nearest_on_segment;

/// Places of a line are bent that are at most so far apart, in edges.
const SPACING: f64 = 1.0;

impl Bent {
    /// The same map for other contours, in the units of the drawing: inside the old drawing it is what it was,
    /// outside that is extended by its derivative at the nearest place of the outline. None where the bent
    /// contours meet themselves or each other.
    ///
    /// O(n) for contours inside the old drawing.
    pub(crate) fn followed(&self, contours: &[ClosedCurve]) -> Option<Self> {
        let ground = &self.ground;
        let way = WayThere::new(&ground.carrier, &self.image);
        let (mut rings, mut drawn, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
        for line in contours.iter().map(|contour| in_frame(contour, &ground.frame)) {
            let (mut ring, mut at) = (Vec::new(), Vec::new());
            for i in 0..line.points.len() {
                let (from, to) = (line.arcs[i], line.arcs[i + 1]);
                let parts = ((to - from) / SPACING).ceil().max(1.0);
                for k in 0..parts as usize {
                    let s = from + (to - from) * k as f64 / parts;
                    ring.push(way.at(if k == 0 { line.points[i] } else { line.at(s) }));
                    at.push(s);
                }
            }
            rings.push(ring);
            drawn.push(at);
            lengths.push(line.length());
        }
        let drawing = BentContours::of_rings(&rings, &drawn, &lengths)?;
        Some(Self {
            ground: ground.clone(),
            image: self.image.clone(),
            drawing,
            share: self.share,
            turn: self.turn,
            price: 0.0,
            is_followed: true,
        })
    }
}

/// Finds the image of points of the drawing.
struct WayThere<'a> {
    carrier: &'a Carrier,
    image: &'a Image,
    grid: TriangleGrid,
}

impl<'a> WayThere<'a> {
    fn new(carrier: &'a Carrier, image: &'a Image) -> Self {
        Self { carrier, image, grid: TriangleGrid::new(&carrier.vertices, &carrier.triangles) }
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
        let mut best: Option<(f64, [usize; 2], f64)> = None;
        let chords = |rim: &'a Rim| (0..rim.len()).map(|i| [rim.start + i, rim.next(i)]);
        for ends in carrier.rims.iter().flat_map(chords) {
            let [a, b] = ends.map(|e| carrier.vertices[e]);
            let (t, squared) = nearest_on_segment(x, a, b);
            if best.is_none_or(|(least, ..)| squared < least) {
                best = Some((squared, ends, t));
            }
        }
        best.map_or(x, |(_, [a, b], t)| {
            let off = x - carrier.vertices[a].lerp(carrier.vertices[b], t);
            let [p, q] = [a, b].map(|e| image.turned(e, off));
            image.positions[a].lerp(image.positions[b], t) + p.lerp(q, t)
        })
    }
}
