//! The six directions of the triangular lattice, and turns between them.

use std::ops::{Add, Sub};

use crate::lattice::axial::Axial;

/// One of the six lattice directions, numbered counter-clockwise in steps of 60 degrees.
///
/// ```text
///      2   1
///       \ /
///   3 -- * -- 0
///       / \
///      4   5
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Dir(u8);

impl Dir {
    /// All directions, counter-clockwise from east.
    pub const ALL: [Dir; 6] = [Dir(0), Dir(1), Dir(2), Dir(3), Dir(4), Dir(5)];

    const OFFSETS: [Axial; 6] = [
        Axial::new(1, 0),
        Axial::new(0, 1),
        Axial::new(-1, 1),
        Axial::new(-1, 0),
        Axial::new(0, -1),
        Axial::new(1, -1),
    ];

    /// The direction with this number, taken modulo six.
    pub const fn new(number: i32) -> Dir {
        Dir(number.rem_euclid(6) as u8)
    }

    /// 0 to 5.
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The neighbour of the origin in this direction.
    pub const fn offset(self) -> Axial {
        Self::OFFSETS[self.0 as usize]
    }

    /// The direction whose offset this is.
    #[inline]
    pub fn from_offset(offset: Axial) -> Option<Dir> {
        Self::ALL.into_iter().find(|dir| dir.offset() == offset)
    }

    /// Turned by `turn` times 60 degrees counter-clockwise.
    pub const fn rotate(self, turn: i32) -> Dir {
        Dir::new(self.0 as i32 + turn)
    }

    /// Turned by 180 degrees.
    pub const fn opposite(self) -> Dir {
        self.rotate(3)
    }

    /// The turn, -2 to 3, that leads from this direction to `next`; positive to the left.
    ///
    /// Its absolute value is the paper's `dirDiff` (figure 11). On a boundary with the patch on
    /// its left the patch valence of the vertex is `4 - turn`.
    pub const fn turn_to(self, next: Dir) -> i32 {
        let turn = (next.0 as i32 - self.0 as i32).rem_euclid(6);
        if turn > 3 { turn - 6 } else { turn }
    }
}

impl Axial {
    /// The six neighbours, counter-clockwise from the eastern one.
    pub fn neighbours(self) -> [Axial; 6] {
        Dir::ALL.map(|dir| self + dir)
    }

    /// The direction of a step to `other`, if it is a neighbour.
    pub fn step_to(self, other: Axial) -> Option<Dir> {
        Dir::from_offset(other - self)
    }
}

impl Add<Dir> for Axial {
    type Output = Axial;
    fn add(self, dir: Dir) -> Axial {
        self + dir.offset()
    }
}

impl Sub<Dir> for Axial {
    type Output = Axial;
    fn sub(self, dir: Dir) -> Axial {
        self - dir.offset()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_undo_rotations() {
        for dir in Dir::ALL {
            for turn in -2..=3 {
                assert_eq!(dir.turn_to(dir.rotate(turn)), turn);
            }
            assert_eq!(dir.offset() + dir.opposite().offset(), Axial::default());
            assert_eq!(dir.offset() + dir.rotate(2).offset(), dir.rotate(1).offset());
        }
    }
}
