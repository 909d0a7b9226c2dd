//! The drawn curve by arc length, and the boundary vertices on it.

use glam::DVec2;

/// A closed polyline with its arc length, in lattice units; the patch lies on its left.
#[derive(Clone, Copy, Debug)]
pub struct Contour<'a> {
    /// The n corners, closed implicitly, no two in a row equal.
    pub points: &'a [DVec2],
    /// n + 1 cumulative lengths: `arc[0] = 0`, `arc[n]` = the length of the contour.
    pub arc: &'a [f64],
}

impl Contour<'_> {
    /// The length of the contour.
    pub fn length(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// The point at arc length `s`, any real number. Logarithmic in the number of points.
    pub fn point_at(&self, s: f64) -> DVec2 {
        let s = self.wrap(s);
        self.on_segment(s, self.segment_of(s))
    }

    /// As [`Contour::point_at`], searching from `segment` on, which is updated.
    pub(super) fn point_near(&self, s: f64, segment: &mut u32) -> DVec2 {
        let s = self.wrap(s);
        let mut i = *segment as usize;
        for _ in 0..6 {
            if s < self.arc[i] {
                i = if i == 0 { self.points.len() - 1 } else { i - 1 };
            } else if s >= self.arc[i + 1] {
                i = if i + 1 == self.points.len() { 0 } else { i + 1 };
            } else {
                break;
            }
        }
        if s < self.arc[i] || s >= self.arc[i + 1] {
            i = self.segment_of(s);
        }
        *segment = i as u32;
        self.on_segment(s, i)
    }

    /// The arc position on the first lap.
    pub fn wrap(&self, s: f64) -> f64 {
        let length = self.length();
        let wrapped = if s >= 0.0 && s < length { s } else { s - length * (s / length).floor() };
        if wrapped < length { wrapped } else { 0.0 }
    }

    pub(super) fn segment_of(&self, s: f64) -> usize {
        self.arc.partition_point(|&a| a <= s).clamp(1, self.points.len()) - 1
    }

    fn on_segment(&self, s: f64, i: usize) -> DVec2 {
        let (from, to) = (self.arc[i], self.arc[i + 1]);
        let end = if i + 1 == self.points.len() { 0 } else { i + 1 };
        // A vertex on a corner of the drawing has the corner's own bytes.
        let near = 1e-13 * self.length();
        if s - from <= near {
            self.points[i]
        } else if to - s <= near {
            self.points[end]
        } else {
            self.points[i].lerp(self.points[end], (s - from) / (to - from))
        }
    }
}

/// The boundary vertices of one contour: vertices `start..start + s.len()`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rim {
    /// Number of the first vertex.
    pub start: usize,
    /// Arc positions, strictly increasing, `s[last] < s[0]` + the contour's length; any lap.
    pub s: Vec<f64>,
    /// Vertices that must not slide (they sit on drawn corners); cleared when one is released.
    pub pinned: Vec<bool>,
    /// Pinned vertices that stay even if a triangle starves there; they go only if a triangle
    /// would stay inverted.
    pub held: Vec<bool>,
}
