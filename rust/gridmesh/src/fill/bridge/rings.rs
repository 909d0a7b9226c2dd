//! The triangular lattice on a cylinder or a cone, as rings of vertices around its axis.
//!
//! Ring `j + 1` has `growth` vertices more than ring `j`: the cone has an angle of `growth` times 60 degrees, also more
//! than 360. Each ring turns by 60 degrees at `growth` corners, which lie on rays outwards; between them rows of
//! the lattice run straight. Every vertex has six neighbours, but for those of the first ring.
//!
//! The vertices of a ring are numbered along it; numbers go on beyond its length in the universal cover, where
//! those that differ by its length are one vertex.

/// A vertex: its ring, and its number along it in the universal cover.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Node {
    pub ring: i64,
    pub at: i64,
}

/// What lies at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Corners before it.
    before: i64,
    /// Corners in it: at most one but on the first ring.
    pub corners: i64,
}

impl Place {
    /// The neighbours on the next ring: the first and the last.
    pub fn up(self, node: Node) -> [Node; 2] {
        let up = |more: i64| Node { ring: node.ring + 1, at: node.at + self.before + more };
        [up(0), up(1 + self.corners)]
    }

    /// The last neighbour on the ring before.
    pub fn down(self, node: Node) -> Node {
        Node { ring: node.ring - 1, at: node.at - self.before - self.corners }
    }
}

/// The rings from `first` on.
#[derive(Clone, Debug)]
pub(super) struct Rings {
    /// Vertices of ring 0.
    length: i64,
    /// Corners of ring 0, by their place, ascending; several may be in one.
    corners: Vec<i64>,
    /// Where around the axis each corner's ray is, ascending within one round of length 1.
    rays: Vec<f64>,
    /// The first ring that has a vertex between any two corners, or corners that meet.
    pub first: i64,
}

impl Rings {
    /// Ring 0 has `length` vertices and corners at `corners`, ascending and below `length`.
    pub fn new(length: usize, corners: Vec<i64>, rays: Vec<f64>) -> Self {
        let length = length as i64;
        let gap = |a: usize| {
            let next = corners.get(a + 1).copied().unwrap_or(corners[0] + length);
            next - corners[a]
        };
        // Without corners the rings go on for ever; more than its length nobody needs.
        let least = (0..corners.len()).map(gap).min().unwrap_or(length);
        // A gap shrinks by one with each ring.
        let rings = least.min((length - 3) / (corners.len() as i64).max(1)).max(0);
        Rings { length, corners, rays, first: -rings }
    }

    /// Vertices that each ring has more than the one before.
    pub fn growth(&self) -> i64 {
        self.corners.len() as i64
    }

    /// Vertices of a ring.
    pub fn len(&self, ring: i64) -> i64 {
        self.length + ring * self.growth()
    }

    /// The number of the corner `a` along a ring.
    fn corner(&self, a: i64, ring: i64) -> i64 {
        let k = self.growth();
        self.corners[a.rem_euclid(k) as usize] + a.div_euclid(k) * self.length + (a + 1) * ring
    }

    /// The corners at a vertex and before it.
    pub fn place(&self, node: Node) -> Place {
        let k = self.growth();
        if k == 0 {
            return Place { before: 0, corners: 0 };
        }
        let round = node.at.div_euclid(self.len(node.ring));
        let at = node.at.rem_euclid(self.len(node.ring));
        // On rings before ring 0 the first corners lie before vertex 0, and those of later rounds take their places.
        let rounds = -self.corner(0, node.ring).div_euclid(self.len(node.ring));
        let (mut low, mut high) = ((rounds - 1).max(0) * k, (rounds + 1) * k);
        while low < high {
            let middle = (low + high) / 2;
            if self.corner(middle, node.ring) < at { low = middle + 1 } else { high = middle }
        }
        let mut corners = 0;
        while corners < k && self.corner(low + corners, node.ring) == at {
            corners += 1;
        }
        Place { before: low + round * k, corners }
    }

    /// The neighbours on the next ring: the first and the last.
    pub fn up(&self, node: Node) -> [Node; 2] {
        self.place(node).up(node)
    }

    /// The vertex as numbered within one round.
    pub fn reduced(&self, node: Node) -> Node {
        Node { ring: node.ring, at: node.at.rem_euclid(self.len(node.ring)) }
    }

    /// Where around the axis a vertex lies, in rounds.
    pub fn around(&self, node: Node) -> f64 {
        let k = self.growth();
        if k == 0 {
            // Each ring is shifted by half a step.
            return (node.at as f64 - 0.5 * node.ring as f64) / self.length as f64;
        }
        let Place { before, corners } = self.place(node);
        if corners > 0 {
            return self.ray(before);
        }
        let (from, to) = (self.corner(before - 1, node.ring), self.corner(before, node.ring));
        let share = (node.at - from) as f64 / (to - from) as f64;
        self.ray(before - 1) + share * (self.ray(before) - self.ray(before - 1))
    }

    fn ray(&self, a: i64) -> f64 {
        let k = self.growth();
        self.rays[a.rem_euclid(k) as usize] + a.div_euclid(k) as f64
    }

    /// The vertex of a ring that is nearest to where `around` says.
    pub fn nearest(&self, ring: i64, around: f64) -> i64 {
        let k = self.growth();
        if k == 0 {
            return (around * self.length as f64 + 0.5 * ring as f64).round() as i64;
        }
        let round = (around - self.rays[0]).floor();
        let within = around - round;
        let a = self.rays.partition_point(|&ray| ray <= within) as i64 - 1 + round as i64 * k;
        let (from, to) = (self.corner(a, ring), self.corner(a + 1, ring));
        let width = self.ray(a + 1) - self.ray(a);
        let share = if width > 0.0 { (around - self.ray(a)) / width } else { 0.5 };
        from + (share * (to - from) as f64).round() as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rings() -> Vec<Rings> {
        vec![
            Rings::new(12, vec![], vec![]),
            Rings::new(12, vec![0, 2, 4, 6, 8, 10], (0..6).map(|a| f64::from(a) / 6.0).collect()),
            Rings::new(5, vec![1, 1, 3], vec![0.2, 0.25, 0.7]),
            Rings::new(20, vec![7], vec![0.4]),
        ]
    }

    #[test]
    fn every_vertex_has_six_neighbours() {
        for rings in rings() {
            for ring in rings.first + 1..rings.first + 5 {
                let n = rings.len(ring);
                let mut below = vec![0; n as usize];
                for at in 0..rings.len(ring - 1) {
                    let [first, last] = rings.up(Node { ring: ring - 1, at });
                    for at in first.at..=last.at {
                        below[at.rem_euclid(n) as usize] += 1;
                    }
                    // Neighbours share one of theirs.
                    assert_eq!(rings.up(Node { ring: ring - 1, at: at + 1 })[0], last);
                }
                for at in 0..n {
                    let node = Node { ring, at };
                    let [first, last] = rings.up(node);
                    assert_eq!(last.at - first.at + 1 + below[at as usize], 4);
                    let down = rings.place(node).down(node);
                    let [first, last] = rings.up(down);
                    assert!((first.at..=last.at).contains(&at), "{node:?} {down:?}");
                }
            }
        }
    }

    #[test]
    fn places_around_the_axis_rise_and_are_found_again() {
        for rings in rings() {
            for ring in rings.first + 1..rings.first + 5 {
                let n = rings.len(ring);
                let places = (-n..2 * n).map(|at| rings.around(Node { ring, at })).collect::<Vec<_>>();
                assert!(places.is_sorted());
                for (at, &around) in (-n..2 * n).zip(&places) {
                    assert_eq!(rings.nearest(ring, around), at);
                }
                assert!((places[n as usize] - places[0] - 1.0).abs() < 1e-12);
            }
        }
    }
}
