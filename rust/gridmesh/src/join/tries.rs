//! Patches of strips, those that were tried, and which of them is best.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::site::Site;
use crate::fill::even::local::Local;

/// Angles, in radians, below which a patch is worse for it.
const FINE: f64 = 0.35;

/// So many irregular vertices weigh as much as an angle of nothing instead of a fine one.
const FLAT: f64 = 60.0;

/// Irregular vertices that a tube or a fill may have, by vertex, before it is compared with others.
const FEW: f64 = 0.04;

/// The same before the strip itself is tried as well. With 0.15 one irregular vertex in 150 is saved in 200 random joints, which take 6 %
/// longer, and characters of a few parts nearly twice as long.
const SEVERAL: f64 = 0.2;

/// How a patch was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A lattice tube between two rims.
    Tube,
    /// A grid patch in one rim.
    Fill,
    /// The union's own surface, triangulated anew.
    Strip,
    /// The same with the line as a crease, though a blend was asked for.
    Crease,
    /// The union's own triangles.
    Exact,
}

/// What takes the place of a strip.
#[derive(Clone)]
pub(super) struct Patch {
    pub kind: Kind,
    /// Its new vertices.
    pub vertices: Vec<DVec3>,
    /// Numbers from that of the parts' vertices on are the new vertices.
    pub triangles: Vec<[u32; 3]>,
    /// What the volume gains by it.
    pub gained: f64,
    /// That is more than by a blend, or less than minus that.
    pub far: bool,
}

impl Patch {
    /// It by itself, the vertices of its border first; `None` if it has other vertices of the parts.
    pub fn local(&self, site: &Site<'_>, border: &[u32]) -> Option<Local> {
        let (n, m) = (site.parts.vertices.len() as u32, border.len() as u32);
        let place = border.iter().zip(0..).map(|(&v, k)| (v, k)).collect::<FxHashMap<u32, u32>>();
        let number = |v: u32| if v < n { place.get(&v).copied() } else { Some(m + v - n) };
        let mut triangles = Vec::with_capacity(self.triangles.len());
        for t in &self.triangles {
            let [Some(a), Some(b), Some(c)] = t.map(number) else { return None };
            triangles.push([a, b, c]);
        }
        let rims = border.iter().map(|&v| site.parts.vertices[v as usize]);
        let positions = rims.chain(self.vertices.iter().copied()).collect();
        let sides = vec![0; triangles.len()];
        Some(Local::new(positions, triangles, sides, border.len()))
    }

    /// The middle of each triangle.
    pub fn middles(&self, site: &Site<'_>) -> Vec<DVec3> {
        let old = &site.parts.vertices;
        let at =
            |v: u32| old.get(v as usize).copied().unwrap_or_else(|| self.vertices[v as usize - old.len()]);
        self.triangles.iter().map(|t| t.map(at).iter().sum::<DVec3>() / 3.0).collect()
    }

    /// Takes vertices and triangles from what was made of [`local`](Patch::local).
    pub fn retake(&mut self, site: &Site<'_>, border: &[u32], local: &Local) {
        let (n, m) = (site.parts.vertices.len() as u32, border.len() as u32);
        let name = |v: u32| if v < m { border[v as usize] } else { n + v - m };
        self.vertices = local.positions[border.len()..].to_vec();
        self.triangles = local.triangles.iter().map(|t| t.map(name)).collect();
    }
}

/// A patch and what is wrong with it.
pub(super) struct Try {
    pub patch: Patch,
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
        (self.patch.far, self.meetings, self.odd as f64 + FLAT * (1.0 - self.angle / FINE).max(0.0))
    }

    pub fn is_sound(&self) -> bool {
        !self.patch.far && self.meetings == 0
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
