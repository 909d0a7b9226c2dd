//! Edits of a strip that keep its vertices: edges turned, vertices moved.

use glam::DVec3;

use super::strip::Strip;
use crate::cut::divide::node::Node;
use crate::cut::divide::parted::Part;

impl Strip<'_> {
    /// Turns the edge from `a` to `b` if that makes the smallest angle of its triangles larger.
    pub fn flip(&mut self, a: u32, b: u32) -> bool {
        if self.is_cut(a, b) {
            return false;
        }
        let [s, t] = self.with_edge(a, b)[..] else { return false };
        let (Some(&p), Some(&q)) = (self.part(s), self.part(t)) else { return false };
        let apex = |part: &Part| part.corners.into_iter().find(|&v| v != a && v != b);
        let (Some(c), Some(d)) = (apex(&p), apex(&q)) else { return false };
        if c == d || p.left != q.left || (self.is_border(c) && self.is_border(d)) || self.has_edge(c, d) {
            return false;
        }
        let (x, y) =
            (p.corners.map(|v| if v == b { d } else { v }), p.corners.map(|v| if v == a { d } else { v }));
        let before = self.min_angle(p.corners).min(self.min_angle(q.corners));
        if self.min_angle(x).min(self.min_angle(y)) <= before + 1e-9 {
            return false;
        }
        let homes = self.homes(&[a, b, c, d]);
        let (Some(x), Some(y)) = (self.rehomed(&p, x, &homes), self.rehomed(&p, y, &homes)) else {
            return false;
        };
        self.replace(s, None);
        self.replace(t, Some(y));
        self.replace(s, Some(x));
        self.altered.extend([p.face, q.face]);
        true
    }

    /// Moves a new vertex inside one plane to the middle of its neighbours, if that makes its smallest angle
    /// larger.
    pub fn centre(&mut self, v: u32) -> bool {
        let Some(k) = (v as usize).checked_sub(self.parted.n_old) else { return false };
        if self.is_border(v) || !self.on_line(v).is_empty() {
            return false;
        }
        let around = self.triangles_at(v).to_vec();
        let parts = around.iter().filter_map(|&t| self.part(t).copied()).collect::<Vec<_>>();
        let near = self.neighbours(v);
        let least =
            |strip: &Self| parts.iter().map(|p| strip.min_angle(p.corners)).fold(f64::INFINITY, f64::min);
        let (before, old) = (least(self), self.parted.nodes[k]);
        let homes = self.homes(&near);
        let middle = near.iter().map(|&w| self.position(w)).sum::<DVec3>() / near.len().max(1) as f64;
        // Back onto the surface.
        let Some(home) = self.home_of(middle, &homes) else { return false };
        let (_, weights) = home.facet.closest(middle);
        self.parted.nodes[k] = Node::within(self.vertices, home.corners, weights);
        let fits = least(self) > before
            && parts.iter().all(|p| {
                self.is_upright(p.corners, p.home)
                    && self.is_near(p.corners, &self.facet(p.home), p.home, &homes)
            });
        if fits {
            parts.iter().for_each(|p| self.touch(p.corners));
        } else {
            self.parted.nodes[k] = old;
        }
        fits
    }
}
