//! Measures of the triangles around a vertex of a front.

use glam::DVec3;

use crate::geometry::corner::Ideal;

/// What [`Fan::sharpest`] is at least where a corner of a quad is reflex: more than any cotangent that is let be.
pub(super) const REFLEX: f64 = 1e6;

/// The triangles around a vertex, of quads those at their corners. To its measures `at` tells where vertices lie.
#[derive(Clone, Copy)]
pub(super) struct Fan<'a> {
    /// The two vertices of each that follow the one in the middle.
    pub pairs: &'a [[u32; 2]],
    /// What each should look like; none if all are to be equilateral.
    pub ideals: Option<&'a [Ideal]>,
}

impl<'a> Fan<'a> {
    /// The two vertices of each triangle that follow the one in the middle, and what it should look like.
    pub fn iter(&self) -> impl Iterator<Item = (u32, u32, Ideal)> {
        let ideals = self.ideals;
        let ideal = move |k: usize| ideals.map_or(Ideal::Equilateral, |ideals| ideals[k]);
        self.pairs.iter().enumerate().map(move |(k, &[a, b])| (a, b, ideal(k)))
    }

    /// Least cosine between the surface's normal at a vertex at `point` and the triangles around it: how
    /// well they stand for the surface. A vertex that leaves a narrow ridge cuts it off.
    pub fn facing(&self, at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3) -> f64 {
        let cosine = |&[a, b]: &[u32; 2]| {
            let (a, b) = (at(a) - point, at(b) - point);
            a.cross(b).normalize_or_zero().dot(normal)
        };
        self.pairs.iter().map(cosine).fold(f64::INFINITY, f64::min)
    }

    /// Largest cotangent of the angles of the triangles around a vertex at `point`; of quads the cotangent of the
    /// corner that is furthest from a right angle; from [`REFLEX`] on, the more the further, if one is reflex, seen along the surface's
    /// normal there.
    pub fn sharpest(&self, at: impl Fn(u32) -> DVec3, point: DVec3, normal: DVec3) -> f64 {
        let largest = |(i, j, ideal): (u32, u32, Ideal)| {
            let (a, b) = (at(i) - point, at(j) - point);
            let c = b - a;
            let cosine = match ideal {
                Ideal::Equilateral => a.dot(b).max(b.dot(c)).max(-a.dot(c)),
                Ideal::Own => a.dot(b).abs(),
                Ideal::Next => a.dot(c).abs(),
                Ideal::Last => b.dot(c).abs(),
            };
            let area = a.cross(b);
            let facing = area.dot(normal);
            if ideal != Ideal::Equilateral && facing <= 0.0 {
                // A right angle at the wrong side counts most.
                return REFLEX * (2.0 - facing / cosine.hypot(facing).max(f64::MIN_POSITIVE));
            }
            cosine / area.length()
        };
        self.iter().map(largest).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Least ratio of twice the area to the sum of the squared sides of the triangles around a vertex at
    /// `point`; 0.29 if they are equilateral. Of corners of quads the sides are the quad's, and the ratio is scaled to
    /// the same.
    pub fn worst(&self, at: impl Fn(u32) -> DVec3, point: DVec3) -> f64 {
        const SCALE: f64 = 0.577_350_269_189_625_8;
        let ratio = |(i, j, ideal): (u32, u32, Ideal)| {
            let (a, b) = (at(i) - point, at(j) - point);
            let area = a.cross(b).length();
            let [a, b, c] = [a, b, b - a].map(|side| side.length_squared());
            match ideal {
                Ideal::Equilateral => area / (a + b + c),
                Ideal::Own => SCALE * area / (a + b),
                Ideal::Next => SCALE * area / (a + c),
                Ideal::Last => SCALE * area / (b + c),
            }
        };
        self.iter().map(ratio).fold(f64::INFINITY, f64::min)
    }
}
