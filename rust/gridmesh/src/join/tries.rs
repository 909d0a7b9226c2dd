//! Patches that were tried for a strip, and which of them is best.

use glam::DVec3;

use super::patch::Patch;

/// Angles, in radians, below which a patch is worse for it.
const FINE: f64 = 0.35;

/// So many irregular vertices weigh as much as an angle of nothing instead of a fine one.
const FLAT: f64 = 60.0;

/// Irregular vertices that a tube or a fill may have, by vertex, before it is compared with others.
const FEW: f64 = 0.04;

/// The same before the strip itself is tried as well: nine joints of ten have fewer.
const SEVERAL: f64 = 0.15;

/// A patch and what is wrong with it.
pub(super) struct Try {
    pub patch: Patch,
    /// Changes the volume by more than a blend does.
    pub far: bool,
    /// Triangles, or pairs of them, that meet something.
    pub meetings: usize,
    pub angle: f64,
    /// Vertices with other numbers of triangles than wanted, those of the rims too.
    pub odd: usize,
    /// Where something meets.
    pub places: Vec<DVec3>,
}

impl Try {
    /// Less is better.
    fn faults(&self) -> (bool, usize, f64) {
        (self.far, self.meetings, self.odd as f64 + FLAT * (1.0 - self.angle / FINE).max(0.0))
    }

    pub fn is_sound(&self) -> bool {
        !self.far && self.meetings == 0
    }

    pub fn is_fine(&self) -> bool {
        self.is_sound() && self.angle > FINE
    }

    /// Whether hardly more vertices are irregular than in other joints.
    pub fn is_even(&self) -> bool {
        (self.odd as f64) <= SEVERAL * self.patch.vertices.len() as f64
    }

    pub fn is_good(&self) -> bool {
        self.is_fine() && (self.odd as f64) <= FEW * self.patch.vertices.len() as f64
    }
}

/// That of two with fewer faults; the first of equal ones.
pub(super) fn better(a: Try, b: Try) -> Try {
    if a.faults() <= b.faults() { a } else { b }
}
