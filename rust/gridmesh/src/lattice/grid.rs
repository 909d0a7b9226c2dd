//! The two kinds of grid: what searches, bands and assemblies need to know of them.

use std::fmt::Debug;

use crate::lattice::axial::Axial;
use crate::lattice::dir::Dir;
use crate::lattice::reflection::Reflection;

/// A lattice of the plane whose points are pairs of integers and whose directions are numbered
/// counter-clockwise.
///
/// Turns count by one direction, positive to the left.
pub trait Grid: Copy + Debug + Default + PartialEq + Eq + Send + Sync + 'static {
    /// Number of directions: even.
    const DIRECTIONS: u32;
    /// Number of directions in half a turn.
    const OPPOSITE: u32 = Self::DIRECTIONS / 2;
    /// Turns that a boundary path may make, the patch on its left.
    const TURNS: &'static [i32];
    /// Whether edges inside the patch may not join two vertices of its boundary paths.
    const FORBIDS_CHORDS: bool;

    /// The neighbour of the origin in a direction.
    fn offset(dir: u32) -> Axial;

    /// The direction after a turn of at most one full circle either way.
    fn turned(dir: u32, turn: i32) -> u32;

    /// A point of the lattice turned by one direction about the origin.
    fn rotated(point: Axial) -> Axial;

    /// The mirror image of a point; the axis goes through (0, 0).
    fn image(axis: Reflection, point: Axial) -> Axial;

    /// The mirror image of a direction.
    fn image_dir(axis: Reflection, dir: u32) -> u32;

    /// On which side of the axis a point lies: 0 on it, else its distance in half steps across, or more, positive to
    /// the left of direction 0 or on its side.
    fn side(axis: Reflection, point: Axial) -> i32;

    /// The direction of the edges that the axis cuts in the middle, from the positive side: those of points with side 1.
    fn crossing(axis: Reflection) -> Option<u32>;

    /// The direction of a step to a neighbour.
    fn step(from: Axial, to: Axial) -> Option<u32> {
        let offset = to - from;
        (0..Self::DIRECTIONS).find(|&dir| Self::offset(dir) == offset)
    }

    /// The turn from one direction to another, up to half a circle; positive to the left.
    fn turn(enter: u32, leave: u32) -> i32 {
        let turn = (leave + Self::DIRECTIONS - enter) % Self::DIRECTIONS;
        if turn > Self::OPPOSITE { turn as i32 - Self::DIRECTIONS as i32 } else { turn as i32 }
    }

    /// The turn at each vertex of a closed path.
    fn turns(path: &[Axial]) -> impl Iterator<Item = i32> {
        let n = path.len();
        (0..n).map(move |i| {
            let enter = Self::step(path[(i + n - 1) % n], path[i]);
            let leave = Self::step(path[i], path[(i + 1) % n]);
            enter.zip(leave).map_or(0, |(enter, leave)| Self::turn(enter, leave))
        })
    }
}

/// The lattice of equilateral triangles: six directions, see [`Dir`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Triangular;

/// The lattice of unit squares: four directions, `(1, 0)` first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Square;

impl Grid for Triangular {
    const DIRECTIONS: u32 = 6;
    // Two steps left make a tip with an edge across; three turn back.
    const TURNS: &'static [i32] = &[0, 1, -1, -2];
    const FORBIDS_CHORDS: bool = true;

    fn offset(dir: u32) -> Axial {
        Dir::ALL[dir as usize].offset()
    }

    #[inline]
    fn turned(dir: u32, turn: i32) -> u32 {
        // Directions 0 to 5 after turns from -6 on: a remainder costs more.
        const AFTER: [u8; 16] = [0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5, 0, 1, 2, 3];
        u32::from(AFTER[(dir as i32 + turn + 6) as usize & 15])
    }

    fn rotated(point: Axial) -> Axial {
        Axial::new(-point.r, point.q + point.r)
    }

    fn image(axis: Reflection, point: Axial) -> Axial {
        axis.point(point)
    }

    fn image_dir(axis: Reflection, dir: u32) -> u32 {
        axis.dir(Dir::new(dir as i32)).index() as u32
    }

    fn side(axis: Reflection, point: Axial) -> i32 {
        axis.side(point)
    }

    fn crossing(axis: Reflection) -> Option<u32> {
        axis.crossing().map(|dir| dir.index() as u32)
    }
}

impl Grid for Square {
    const DIRECTIONS: u32 = 4;
    const TURNS: &'static [i32] = &[0, 1, -1];
    // The paths of squares lie a row inside the rim.
    const FORBIDS_CHORDS: bool = false;

    fn offset(dir: u32) -> Axial {
        const OFFSETS: [Axial; 4] =
            [Axial::new(1, 0), Axial::new(0, 1), Axial::new(-1, 0), Axial::new(0, -1)];
        OFFSETS[dir as usize]
    }

    #[inline]
    fn turned(dir: u32, turn: i32) -> u32 {
        (dir as i32 + turn) as u32 & 3
    }

    fn rotated(point: Axial) -> Axial {
        Axial::new(-point.r, point.q)
    }

    fn image(axis: Reflection, point: Axial) -> Axial {
        match axis {
            Reflection::Along => Axial::new(point.q, -point.r),
            Reflection::Across => Axial::new(-point.q, point.r),
        }
    }

    fn image_dir(axis: Reflection, dir: u32) -> u32 {
        match axis {
            Reflection::Along => (4 - dir) & 3,
            Reflection::Across => (6 - dir) & 3,
        }
    }

    fn side(axis: Reflection, point: Axial) -> i32 {
        match axis {
            Reflection::Along => 2 * point.r,
            Reflection::Across => 2 * point.q,
        }
    }

    fn crossing(_axis: Reflection) -> Option<u32> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions_and_turns_agree<G: Grid>() {
        for dir in 0..G::DIRECTIONS {
            let opposite = G::turned(dir, G::OPPOSITE as i32);
            assert_eq!(G::offset(dir) + G::offset(opposite), Axial::default());
            assert_eq!(G::rotated(G::offset(dir)), G::offset(G::turned(dir, 1)));
            assert_eq!(G::step(Axial::new(3, -2), Axial::new(3, -2) + G::offset(dir)), Some(dir));
            for &turn in G::TURNS {
                assert_eq!(G::turn(dir, G::turned(dir, turn)), turn);
                assert_eq!(G::turned(G::turned(dir, turn), -turn), dir);
            }
        }
    }

    fn images_are_reflections<G: Grid>() {
        for axis in [Reflection::Along, Reflection::Across] {
            for q in -3..4 {
                for r in -3..4 {
                    let p = Axial::new(q, r);
                    assert_eq!(G::image(axis, G::image(axis, p)), p);
                    assert_eq!(G::side(axis, G::image(axis, p)), -G::side(axis, p));
                    assert_eq!(G::side(axis, p) == 0, G::image(axis, p) == p);
                    for dir in 0..G::DIRECTIONS {
                        let to = p + G::offset(dir);
                        assert_eq!(
                            G::image(axis, to),
                            G::image(axis, p) + G::offset(G::image_dir(axis, dir))
                        );
                        if G::side(axis, p) > 0 {
                            let crosses = G::side(axis, p) == 1 && Some(dir) == G::crossing(axis);
                            assert_eq!(to == G::image(axis, p), crosses);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn images_are_reflections_on_both_grids() {
        images_are_reflections::<Triangular>();
        images_are_reflections::<Square>();
    }

    #[test]
    fn directions_and_turns_agree_on_both_grids() {
        directions_and_turns_agree::<Triangular>();
        directions_and_turns_agree::<Square>();
    }
}
