//! The bent drawing, and the way back from the bent plane.

use glam::DVec2;

use super::carrier::{Carrier, Line};
use super::chords::Chords;
use super::grid::TriangleGrid;
use crate::drawing::contours::read_contours;
use crate::drawing::curve::ClosedCurve;
use crate::geometry::segments::orientation;

/// A carrier with its image under a conformal map: log scale and rotation at the vertices.
pub struct Image {
    pub positions: Vec<DVec2>,
    pub u: Vec<f64>,
    pub v: Vec<f64>,
}

impl Image {
    /// The linear part of the map near a vertex.
    pub(super) fn turned(&self, i: usize, d: DVec2) -> DVec2 {
        let (scale, rotation) = self.derivative(i);
        scale * rotation.rotate(d)
    }

    /// True if no triangle of the carrier is turned over (exact).
    pub fn is_upright(&self, carrier: &Carrier) -> bool {
        let at = |v: u32| self.positions[v as usize];
        carrier.triangles.iter().all(|t| orientation(at(t[0]), at(t[1]), at(t[2])) > 0.0)
    }

    /// The linear part of the map near a vertex, as scale and rotation.
    fn derivative(&self, i: usize) -> (f64, DVec2) {
        (libm::exp(self.u[i]), DVec2::from_angle(self.v[i]))
    }

    /// A point beside the chord between two vertices of a contour, bent: from both ends by their own
    /// derivatives, which are given.
    fn beside(
        &self,
        carrier: &Carrier,
        (ends, derivatives): ([usize; 2], [(f64, DVec2); 2]),
        t: f64,
        point: DVec2,
    ) -> DVec2 {
        let turned = |k: usize, d: DVec2| derivatives[k].0 * derivatives[k].1.rotate(d);
        let [a, b] = [0, 1].map(|k| self.positions[ends[k]] + turned(k, point - carrier.vertices[ends[k]]));
        let middle = self.positions[ends[0]].lerp(self.positions[ends[1]], t);
        let off = point - carrier.vertices[ends[0]].lerp(carrier.vertices[ends[1]], t);
        let [p, q] = [0, 1].map(|k| turned(k, off));
        // Half the chord's image, half the ends' derivatives: exact for quadratic maps.
        0.5 * (middle + p.lerp(q, t) + a.lerp(b, t))
    }
}

/// The contours of a bent drawing and the arc lengths on the drawing that theirs stand for.
pub struct BentContours {
    pub contours: Vec<ClosedCurve>,
    arcs: Vec<ArcMap>,
    /// Whether the drawn points are among theirs.
    pub in_detail: bool,
}

/// Samples of bent contours: for each contour the images, and their arc lengths on the drawing.
pub type Samples = (Vec<Vec<DVec2>>, Vec<Vec<f64>>);

/// Arc lengths at the points of a bent contour, and on the drawing; both from the bent contour's start.
struct ArcMap {
    bent: Vec<f64>,
    drawn: Vec<f64>,
}

impl BentContours {
    /// The images of the drawn points, or where those meet themselves or each other, of the carrier's
    /// boundary alone. None if that does too.
    pub fn new(carrier: &Carrier, image: &Image, lines: &[Line]) -> Option<Self> {
        Self::with(carrier, image, lines, true).or_else(|| Self::with(carrier, image, lines, false))
    }

    fn with(carrier: &Carrier, image: &Image, lines: &[Line], in_detail: bool) -> Option<Self> {
        let (rings, drawn) = Self::samples(carrier, image, lines, in_detail);
        let lengths: Vec<f64> = lines.iter().map(Line::length).collect();
        Self::of_rings(&rings, &drawn, &lengths, in_detail)
    }

    /// The images of the carrier's boundary and, in detail, of the drawn points between.
    pub fn samples(carrier: &Carrier, image: &Image, lines: &[Line], in_detail: bool) -> Samples {
        let mut rings: Vec<Vec<DVec2>> = Vec::new();
        let mut drawn: Vec<Vec<f64>> = Vec::new();
        for (rim, line) in carrier.rims.iter().zip(lines) {
            let (mut ring, mut at) = (Vec::new(), Vec::new());
            let mut next = 0;
            // Of the vertex before, if any.
            let mut known: Option<(f64, DVec2)> = None;
            for (i, &from) in rim.arcs.iter().enumerate() {
                ring.push(image.positions[rim.start + i]);
                at.push(from);
                let to = rim.end(i);
                let ends = [rim.start + i, rim.next(i)];
                let mut derivatives = None;
                let before = known.take();
                while in_detail && next < line.points.len() && line.arcs[next] < to {
                    let s = line.arcs[next];
                    if s > from {
                        let t = (s - from) / (to - from);
                        let derivatives = *derivatives.get_or_insert_with(|| {
                            let first = before.unwrap_or_else(|| image.derivative(ends[0]));
                            [first, image.derivative(ends[1])]
                        });
                        known = Some(derivatives[1]);
                        ring.push(image.beside(carrier, (ends, derivatives), t, line.points[next]));
                        at.push(s);
                    }
                    next += 1;
                }
            }
            rings.push(ring);
            drawn.push(at);
        }
        (rings, drawn)
    }

    /// Bent rings with the arc lengths on the drawing of their points, and the lengths of the drawn contours.
    /// None if the rings meet themselves or each other.
    pub fn of_rings(
        rings: &[Vec<DVec2>],
        drawn: &[Vec<f64>],
        lengths: &[f64],
        in_detail: bool,
    ) -> Option<Self> {
        let contours = read_contours(&rings[0], &rings[1..]).ok()?;
        let arcs = contours
            .iter()
            .zip(drawn)
            .zip(lengths)
            .map(|((contour, at), &length)| ArcMap::new(contour, at, length))
            .collect::<Option<Vec<ArcMap>>>()?;
        Some(Self { contours, arcs, in_detail })
    }

    /// The arc length on the drawing at one on a bent contour; both unwrapped, increasing together.
    pub fn drawn_arc(&self, contour: usize, s: f64) -> f64 {
        self.arcs[contour].drawn(s)
    }
}

impl ArcMap {
    /// `at`: arc length on the drawing of each point that the contour was read from.
    fn new(contour: &ClosedCurve, at: &[f64], length: f64) -> Option<Self> {
        let n = contour.points().len();
        let mut drawn: Vec<f64> = Vec::with_capacity(n + 1);
        for &s in &contour.arc()[..n] {
            let (segment, t) = contour.source(s);
            // Points are dropped where they repeat: then the segment that is left is the longest.
            let i = (segment as usize + usize::from(t > 0.5)) % at.len();
            let lap = drawn.last().map_or(0.0, |last| ((last - at[i]) / length).ceil().max(0.0));
            drawn.push(at[i] + lap * length);
        }
        drawn.push(drawn[0] + length);
        drawn.windows(2).all(|s| s[0] < s[1]).then(|| Self { bent: contour.arc().to_vec(), drawn })
    }

    fn drawn(&self, s: f64) -> f64 {
        let n = self.drawn.len() - 1;
        let (whole, length) = (self.bent[n], self.drawn[n] - self.drawn[0]);
        let lap = (s / whole).floor();
        let s = s - lap * whole;
        let i = self.bent.partition_point(|&a| a <= s).clamp(1, n) - 1;
        let t = ((s - self.bent[i]) / (self.bent[i + 1] - self.bent[i])).clamp(0.0, 1.0);
        self.drawn[i] + t * (self.drawn[i + 1] - self.drawn[i]) + lap * length
    }
}

/// Finds the place on the drawing of points of the bent plane.
pub struct WayBack<'a> {
    carrier: &'a Carrier,
    image: &'a Image,
    grid: TriangleGrid,
    chords: Chords<'a>,
    /// The inverse of the map's linear part near each vertex: scale and rotation.
    backs: Vec<(f64, DVec2)>,
}

impl<'a> WayBack<'a> {
    pub fn new(carrier: &'a Carrier, image: &'a Image) -> Self {
        let grid = TriangleGrid::new(&image.positions, &carrier.triangles);
        let back = |(u, v): (&f64, &f64)| (libm::exp(-u), DVec2::from_angle(-v));
        let backs = image.u.iter().zip(&image.v).map(back).collect();
        Self { carrier, image, grid, chords: Chords::new(carrier, &image.positions), backs }
    }

    /// A small step from a vertex's image, on the drawing.
    fn turned_back(&self, i: usize, d: DVec2) -> DVec2 {
        let (scale, rotation) = self.backs[i];
        scale * rotation.rotate(d)
    }

    /// The point of the drawing that was bent onto `x`: barycentric on the carrier, corrected by the
    /// derivatives at the corners; outside by the derivative at the nearest chord.
    pub fn at(&self, x: DVec2) -> DVec2 {
        let (carrier, image) = (self.carrier, self.image);
        if let Some((t, weights)) = self.grid.locate(x, &image.positions, &carrier.triangles) {
            let corners = carrier.triangles[t].map(|v| v as usize);
            return self.blend(x, &corners, &weights);
        }
        self.chords.nearest(x).map_or(x, |(ends, t)| self.off_chord(x, ends, t))
    }

    /// The same for a point beside a place of a contour, given by its arc length on the drawing.
    pub fn beside(&self, contour: usize, s: f64, x: DVec2) -> DVec2 {
        let rim = &self.carrier.rims[contour];
        let s = s.rem_euclid(rim.length);
        let i = rim.arcs.partition_point(|&a| a <= s).clamp(1, rim.len()) - 1;
        let t = ((s - rim.arcs[i]) / (rim.end(i) - rim.arcs[i])).clamp(0.0, 1.0);
        self.off_chord(x, [rim.start + i, rim.next(i)], t)
    }

    fn off_chord(&self, x: DVec2, ends: [usize; 2], t: f64) -> DVec2 {
        let (carrier, image) = (self.carrier, self.image);
        let foot = image.positions[ends[0]].lerp(image.positions[ends[1]], t);
        let [p, q] = ends.map(|e| self.turned_back(e, x - foot));
        carrier.vertices[ends[0]].lerp(carrier.vertices[ends[1]], t) + p.lerp(q, t)
    }

    /// Half the linear map, half the corners' own derivatives: exact for quadratic maps.
    fn blend(&self, x: DVec2, corners: &[usize; 3], weights: &[f64; 3]) -> DVec2 {
        let (carrier, image) = (self.carrier, self.image);
        let mut sum = DVec2::ZERO;
        for (&c, &w) in corners.iter().zip(weights) {
            sum += w * (carrier.vertices[c] + 0.5 * self.turned_back(c, x - image.positions[c]));
        }
        sum
    }
}
