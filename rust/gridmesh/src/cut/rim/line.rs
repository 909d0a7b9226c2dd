//! The cut's line in a strip: which of its vertices follow each other, and where they are on the unrolled line.

use glam::DVec3;

use super::strip::Strip;

impl Strip<'_> {
    /// True if the line's edge stays shorter than `longest` when `u` moves into `v`.
    pub fn may_go(&self, u: u32, v: u32, longest: f64) -> bool {
        match *self.on_line(u) {
            [a, b] if a == v || b == v => self.position(a).distance(self.position(b)) < longest,
            _ => false,
        }
    }

    /// Draws the line through `v`, which is beside it, instead of its neighbour `u` on it.
    pub fn draw_through(&mut self, u: u32, v: u32, least: f64) -> bool {
        let &[a, b] = self.on_line(u) else { return false };
        if !self.on_line(v).is_empty() {
            return false;
        }
        let ([at_a, to_u], [from_u, at_b]) = (self.place(a, u), self.place(u, b));
        let [p, q, r] = [a, u, b].map(|w| self.position(w));
        // How far along the line `v` is from `u`.
        let along = |to: DVec3| (self.position(v) - q).dot(to - q) / (to - q).length_squared();
        let (back, ahead) = (along(p), along(r));
        let by = if ahead > back { ahead * (at_b - from_u) } else { -back * (to_u - at_a) };
        // Beside `u`, and not beside the next one.
        if !((0.0..0.6).contains(&ahead.max(back)) && self.merge(u, v, least)) {
            return false;
        }
        self.unlink(u, a);
        self.unlink(u, b);
        self.link(a, v, [at_a, to_u + by]);
        self.link(v, b, [from_u + by, at_b]);
        true
    }

    /// Diameter of the box around the line that a vertex lies on.
    pub fn line_size(&self, v: u32) -> f64 {
        let mut low = self.position(v);
        let mut high = low;
        for &first in self.on_line(v) {
            let (mut last, mut at) = (v, first);
            // Where lines touch each other, this one may not lead back.
            for _ in 0..self.line.len() {
                if at == v {
                    return low.distance(high);
                }
                let p = self.position(at);
                (low, high) = (low.min(p), high.max(p));
                let Some(&next) = self.on_line(at).iter().find(|&&w| w != last) else { break };
                (last, at) = (at, next);
            }
        }
        low.distance(high)
    }

    /// Where an edge of the line begins and ends on the unrolled line.
    pub fn place(&self, from: u32, to: u32) -> [f64; 2] {
        let [x, y] = self.parted.cut.get(&(from.min(to), from.max(to))).copied().unwrap_or_default();
        if from < to { [x, y] } else { [y, x] }
    }

    pub fn unlink(&mut self, a: u32, b: u32) {
        self.parted.cut.remove(&(a.min(b), a.max(b)));
        for (v, old) in [(a, b), (b, a)] {
            if let Some(list) = self.line.get_mut(&v) {
                list.retain(|&w| w != old);
                if list.is_empty() {
                    self.line.remove(&v);
                }
            }
        }
    }

    pub fn link(&mut self, a: u32, b: u32, [x, y]: [f64; 2]) {
        self.parted.cut.insert((a.min(b), a.max(b)), if a < b { [x, y] } else { [y, x] });
        for (v, new) in [(a, b), (b, a)] {
            self.line.entry(v).or_default().push(new);
        }
    }
}
