//! Points of the triangular lattice in axial coordinates.

use std::ops::{Add, Mul, Neg, Sub};

/// A point of the triangular lattice: `q` steps east and `r` steps north-east (60 degrees up).
///
/// ```text
///        r
///       /
///      /
///     *-----> q
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Axial {
    /// Steps along direction 0 (east).
    pub q: i32,
    /// Steps along direction 1 (60 degrees counter-clockwise of east).
    pub r: i32,
}

impl Axial {
    /// The point `q` steps east and `r` steps north-east of the origin.
    pub const fn new(q: i32, r: i32) -> Self {
        Self { q, r }
    }

    /// Number of lattice edges on a shortest path to `other` (the paper's `d_ij`, section II-A).
    pub fn distance(self, other: Axial) -> i32 {
        let d = other - self;
        d.q.abs().max(d.r.abs()).max((d.q + d.r).abs())
    }
}

impl Add for Axial {
    type Output = Axial;
    fn add(self, other: Axial) -> Axial {
        Axial::new(self.q + other.q, self.r + other.r)
    }
}

impl Sub for Axial {
    type Output = Axial;
    fn sub(self, other: Axial) -> Axial {
        Axial::new(self.q - other.q, self.r - other.r)
    }
}

impl Neg for Axial {
    type Output = Axial;
    fn neg(self) -> Axial {
        Axial::new(-self.q, -self.r)
    }
}

impl Mul<i32> for Axial {
    type Output = Axial;
    fn mul(self, factor: i32) -> Axial {
        Axial::new(self.q * factor, self.r * factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::dir::Dir;

    #[test]
    fn neighbours_are_at_distance_one_and_point_back() {
        let p = Axial::new(-3, 7);
        for (i, n) in p.neighbours().into_iter().enumerate() {
            assert_eq!(p.distance(n), 1);
            assert_eq!(p.step_to(n), Some(Dir::ALL[i]));
            assert_eq!(n.step_to(p), Some(Dir::ALL[i].opposite()));
        }
    }

    #[test]
    fn distance_is_the_length_of_a_shortest_path() {
        assert_eq!(Axial::new(0, 0).distance(Axial::new(3, -3)), 3);
        assert_eq!(Axial::new(0, 0).distance(Axial::new(2, 3)), 5);
        assert_eq!(Axial::new(1, 1).distance(Axial::new(1, 1)), 0);
    }
}
