//! Short edges made longer by moving vertices apart: what flat patches and bodies have in common.

use crate::geometry::active::Rounds;

/// Cotangents of the angles, 28, 20, 14 and 9 degrees, below which corners do not fall for longer edges: one for each
/// stage, in which what the one before left is tried.
pub(crate) const THIN: [f64; 4] =
    [1.880_726_465_346_332, 2.747_477_419_454_622, 4.010_780_933_535_845, 6.313_751_514_675_043];

/// The same for corners of quads: 45, 38, 32 and 28 degrees, and as far above a right angle.
pub(crate) const THIN_OF_QUADS: [f64; 4] =
    [1.0, 1.279_941_632_193_079, 1.600_334_529_041_05, 1.880_726_465_346_332];

/// Rounds over the vertices with short edges in a stage.
pub(crate) const ROUNDS: Rounds = Rounds { most: 24, stuck: 4 };

/// What an edge of this length lacks: the square of its share of the length wanted. So that where edges are crowded
/// all of them give way.
pub(crate) fn lack(length: f64, wanted: f64) -> f64 {
    (1.0 - length / wanted).max(0.0).powi(2)
}
