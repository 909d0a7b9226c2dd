//! Where the boundary vertices are on their contours, and how far they may slide.

use glam::DVec2;

use super::contour::{Contour, Rim};

/// The boundary vertices of all contours in one list.
#[derive(Debug)]
pub(super) struct Slide<'a> {
    contours: &'a [Contour<'a>],
    /// Arc position of each boundary vertex; neighbours are in order up to the lap.
    pub s: Vec<f64>,
    /// Vertices that must stay where they are.
    pub pinned: Vec<bool>,
    /// Whether it stays pinned where a triangle starves.
    pub held: Vec<bool>,
    /// Where the vertex was mapped to: sliding away from there costs a little.
    pub home: Vec<f64>,
    /// Contour segment of the last position, where a search begins.
    segment: Vec<u32>,
    contour: Vec<u32>,
    before: Vec<u32>,
    after: Vec<u32>,
    /// Per contour: its length and the mean spacing of its vertices.
    lengths: Vec<(f64, f64)>,
}

/// Neighbours keep this share of the mean spacing between them.
const MIN_SPACING: f64 = 0.15;

impl<'a> Slide<'a> {
    pub fn new(contours: &'a [Contour<'a>], rims: &[Rim]) -> Slide<'a> {
        let n: usize = rims.iter().map(|rim| rim.s.len()).sum();
        let mut slide = Slide {
            contours,
            s: Vec::with_capacity(n),
            pinned: Vec::with_capacity(n),
            held: Vec::with_capacity(n),
            home: Vec::new(),
            segment: Vec::with_capacity(n),
            contour: Vec::with_capacity(n),
            before: Vec::with_capacity(n),
            after: Vec::with_capacity(n),
            lengths: Vec::with_capacity(rims.len()),
        };
        for (k, (rim, contour)) in rims.iter().zip(contours).enumerate() {
            let (start, n) = (slide.s.len() as u32, rim.s.len() as u32);
            slide.s.extend(&rim.s);
            slide.pinned.extend(&rim.pinned);
            slide.held.extend(&rim.held);
            for i in 0..n {
                slide.before.push(start + (i + n - 1) % n);
                slide.after.push(start + (i + 1) % n);
                slide.contour.push(k as u32);
                slide.segment.push(contour.segment_of(contour.wrap(rim.s[i as usize])) as u32);
            }
            slide.lengths.push((contour.length(), contour.length() / f64::from(n)));
        }
        slide.home.clone_from(&slide.s);
        slide
    }

    pub fn len(&self) -> usize {
        self.s.len()
    }

    /// Holds a vertex at arc position `s`, between its neighbours.
    pub fn hold(&mut self, vertex: usize, s: f64) {
        self.s[vertex] = s;
        self.home[vertex] = s;
        self.pinned[vertex] = true;
        self.held[vertex] = true;
    }

    /// The point at arc position `s` of the contour of `vertex`, near which it is.
    pub fn point(&mut self, vertex: usize, s: f64) -> DVec2 {
        self.contours[self.contour[vertex] as usize].point_near(s, &mut self.segment[vertex])
    }

    /// Arc distances to the neighbours, back and ahead.
    pub fn spacing(&self, vertex: usize) -> (f64, f64) {
        let length = self.lengths[self.contour[vertex] as usize].0;
        let (before, after) = (self.before[vertex] as usize, self.after[vertex] as usize);
        let back = self.s[vertex] - self.s[before] + if before >= vertex { length } else { 0.0 };
        let ahead = self.s[after] - self.s[vertex] + if after <= vertex { length } else { 0.0 };
        (back, ahead)
    }

    /// How far the vertex may slide back and ahead.
    pub fn room(&self, vertex: usize) -> (f64, f64) {
        let (back, ahead) = self.spacing(vertex);
        let gap = MIN_SPACING * self.lengths[self.contour[vertex] as usize].1;
        ((back - gap).max(0.0), (ahead - gap).max(0.0))
    }

    /// Draws every vertex that may slide towards the middle of its neighbours and makes the result
    /// its home. Projected vertices bunch where the curve turns away from the lattice path; bunched
    /// ones are what inverts triangles.
    pub fn even_out(&mut self) {
        const WEIGHT: f64 = 3.0;
        for _ in 0..6 {
            for v in 0..self.len() {
                if !self.pinned[v] {
                    let (back, ahead) = self.spacing(v);
                    let middle = self.s[v] + 0.5 * (ahead - back);
                    self.s[v] = (self.home[v] + WEIGHT * middle) / (1.0 + WEIGHT);
                }
            }
        }
        self.home.clone_from(&self.s);
    }

    /// Spaces the vertices within `reach` of `vertex` evenly, between pinned ones. Returns them.
    pub fn spread(&mut self, vertex: usize, reach: usize) -> Vec<usize> {
        let mut moved = Vec::new();
        let mut first = vertex;
        let mut count = 1;
        for _ in 0..reach {
            let before = self.before[first] as usize;
            if self.pinned[first] && first != vertex || before == vertex {
                break;
            }
            first = before;
            count += 1;
        }
        let mut last = vertex;
        for _ in 0..reach {
            let after = self.after[last] as usize;
            if self.pinned[last] && last != vertex || after == first {
                break;
            }
            last = after;
            count += 1;
        }
        let mut runs = vec![first];
        if self.pinned[vertex] && vertex != first && vertex != last {
            runs.push(vertex);
        }
        runs.push(last);
        debug_assert!(count >= runs.len());
        for run in runs.windows(2) {
            self.space_evenly(run[0], run[1], &mut moved);
        }
        moved
    }

    fn space_evenly(&mut self, from: usize, to: usize, moved: &mut Vec<usize>) {
        let length = self.lengths[self.contour[from] as usize].0;
        let mut inner = Vec::new();
        let mut v = self.after[from] as usize;
        while v != to {
            inner.push(v);
            v = self.after[v] as usize;
        }
        // Whole laps do not matter to the curve, but to the order: keep every vertex on its lap.
        let total = self.s[to] - self.s[from] + if to <= from { length } else { 0.0 };
        for (i, &v) in inner.iter().enumerate() {
            let s = self.s[from] + total * (i + 1) as f64 / (inner.len() + 1) as f64;
            self.s[v] = if v < from { s - length } else { s };
            self.home[v] = self.s[v];
        }
        moved.extend(inner);
    }

    /// Copies positions and pins back.
    pub fn store(&self, rims: &mut [Rim]) {
        let mut start = 0;
        for rim in rims {
            let end = start + rim.s.len();
            rim.s.copy_from_slice(&self.s[start..end]);
            rim.pinned.copy_from_slice(&self.pinned[start..end]);
            rim.held.copy_from_slice(&self.held[start..end]);
            start = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [DVec2; 4] =
        [DVec2::ZERO, DVec2::new(4.0, 0.0), DVec2::new(4.0, 4.0), DVec2::new(0.0, 4.0)];
    const ARC: [f64; 5] = [0.0, 4.0, 8.0, 12.0, 16.0];

    fn in_order(slide: &Slide) -> bool {
        (0..slide.len()).all(|v| slide.spacing(v).0 > 0.0 && slide.spacing(v).1 > 0.0)
    }

    #[test]
    fn spreading_across_the_seam_keeps_the_order() {
        let contours = [Contour { points: &SQUARE, arc: &ARC }];
        let s = vec![0.1, 0.2, 0.3, 8.0, 15.7, 15.8, 15.9];
        let rims = [Rim { start: 0, held: vec![false; s.len()], pinned: vec![false; s.len()], s }];
        for vertex in 0..7 {
            for reach in 1..9 {
                let mut slide = Slide::new(&contours, &rims);
                slide.spread(vertex, reach);
                assert!(in_order(&slide), "{vertex} {reach} {:?}", slide.s);
            }
        }
    }

    #[test]
    fn pinned_vertices_stay_when_others_are_spread_or_evened_out() {
        let contours = [Contour { points: &SQUARE, arc: &ARC }];
        let s = vec![0.0, 0.2, 0.3, 4.0, 4.5, 12.0];
        let rims = [Rim {
            start: 0,
            held: vec![false; s.len()],
            pinned: vec![true, false, false, true, false, false],
            s,
        }];
        for vertex in 0..6 {
            let mut slide = Slide::new(&contours, &rims);
            slide.spread(vertex, 3);
            assert_eq!((slide.s[0], slide.s[3]), (0.0, 4.0));
            slide.even_out();
            assert_eq!((slide.s[0], slide.s[3]), (0.0, 4.0));
            assert!(in_order(&slide));
            assert_eq!(slide.point(3, slide.s[3]), SQUARE[1]);
        }
    }
}
