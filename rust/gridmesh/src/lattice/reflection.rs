//! Reflections of the lattice onto itself that keep the origin: two axes at right angles.

use crate::lattice::axial::Axial;
use crate::lattice::dir::Dir;

/// A mirror axis through lattice point (0, 0).
///
/// Up to rotations there are no others: every mirror axis of the lattice runs along a lattice
/// direction or at right angles to one, and meets a lattice point.
///
/// ```text
///      Along                Across
///
///      2   1                2 | 1
///       \ /                  \|/
///   ----- * -----          3 --*-- 0
///       / \                  /|\
///      4   5                4 | 5
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reflection {
    /// The axis runs along direction 0; its positive side is north.
    Along,
    /// The axis crosses direction 0 at a right angle; its positive side is east.
    Across,
}

impl Reflection {
    /// The mirror image of a lattice point.
    pub const fn point(self, p: Axial) -> Axial {
        match self {
            Reflection::Along => Axial::new(p.q + p.r, -p.r),
            Reflection::Across => Axial::new(-p.q - p.r, p.r),
        }
    }

    /// The mirror image of a direction.
    pub const fn dir(self, dir: Dir) -> Dir {
        match self {
            Reflection::Along => Dir::new(-(dir.index() as i32)),
            Reflection::Across => Dir::new(3 - dir.index() as i32),
        }
    }

    /// Where a point lies: 0 on the axis, above 0 on its positive side. Neighbours of points on the
    /// axis are at 1 or 2, and if two points at 1 and -1 are mirror images an edge joins them.
    pub const fn side(self, p: Axial) -> i32 {
        match self {
            Reflection::Along => 2 * p.r,
            Reflection::Across => 2 * p.q + p.r,
        }
    }

    /// The direction in which an edge crosses the axis at a right angle, away from the positive side.
    pub const fn crossing(self) -> Option<Dir> {
        match self {
            Reflection::Along => None,
            Reflection::Across => Some(Dir::new(3)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_lattice_reflections() {
        for axis in [Reflection::Along, Reflection::Across] {
            for q in -4..4 {
                for r in -4..4 {
                    let p = Axial::new(q, r);
                    assert_eq!(axis.point(axis.point(p)), p);
                    assert_eq!(axis.side(axis.point(p)), -axis.side(p));
                    assert_eq!(axis.side(p) == 0, axis.point(p) == p);
                    for dir in Dir::ALL {
                        assert_eq!(axis.point(p + dir), axis.point(p) + axis.dir(dir));
                        if axis.side(p) > 0 {
                            let crosses = axis.side(p) == 1 && Some(dir) == axis.crossing();
                            assert_eq!(p + dir == axis.point(p), crosses);
                        }
                    }
                }
            }
        }
    }
}
