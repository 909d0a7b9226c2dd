//! How good a patch in the plane is.

use glam::DVec2;

use crate::error::Result;
use crate::progress::Progress;
use crate::relax::first_inverted;

/// Counts and shapes of a patch whose loop vertices are `0..n_loop`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Quality {
    /// Interior vertices with a valence other than six.
    pub irregular: usize,
    /// Interior vertices.
    pub interior: usize,
    /// Sum over the loop of how far the patch valence is from the wanted one.
    pub excess: usize,
    /// Least angle, in radians; negative if a triangle is inverted.
    pub min_angle: f64,
    /// Mean of twice the inscribed by the circumscribed radius; inverted triangles count as zero.
    pub mean_ratio: f64,
    /// Every triangle is counter-clockwise by the exact predicate.
    pub embedded: bool,
    /// Edges across the patch between loop vertices.
    pub chords: usize,
    /// Those of them that the mesh has already.
    pub repeated: usize,
}

/// Triangles between two questions whether to go on.
const ASK_EVERY: usize = 1 << 15;

/// Measures a patch.
///
/// # Errors
/// [`Error::Cancelled`](crate::error::Error::Cancelled).
pub(in crate::fill) fn measure(
    positions: &[DVec2],
    triangles: &[[u32; 3]],
    wanted: &[i32],
    taken: &dyn Fn(usize, usize) -> bool,
    progress: Progress<'_>,
) -> Result<Quality> {
    let n = wanted.len();
    let mut valence = vec![0i32; positions.len()];
    let mut quality = Quality { min_angle: std::f64::consts::PI, ..Quality::default() };
    for (at, t) in triangles.iter().enumerate() {
        if at % ASK_EVERY == 0 {
            progress.report(0.0)?;
        }
        for (k, &v) in t.iter().enumerate() {
            valence[v as usize] += 1;
            let (i, j) = (v as usize, t[(k + 1) % 3] as usize);
            // Each chord is seen twice, once from either end.
            if i < j && j < n && j - i > 1 && j - i < n - 1 {
                quality.chords += 1;
                quality.repeated += usize::from(taken(i, j));
            }
        }
        let [a, b, c] = t.map(|v| positions[v as usize]);
        let double = (b - a).perp_dot(c - a);
        let [x, y, z] = [(b - c).length(), (c - a).length(), (a - b).length()];
        let perimeter = x + y + z;
        if double > 0.0 {
            quality.mean_ratio += 4.0 * double * double / (x * y * z * perimeter);
        }
        for (u, v) in [(b - a, c - a), (c - b, a - b), (a - c, b - c)] {
            let angle = libm::atan2(u.perp_dot(v), u.dot(v));
            quality.min_angle = quality.min_angle.min(if angle.is_finite() { angle } else { -1.0 });
        }
    }
    quality.mean_ratio /= triangles.len().max(1) as f64;
    quality.interior = positions.len() - n;
    quality.irregular = valence[n..].iter().filter(|&&v| v != 6).count();
    quality.excess = wanted.iter().zip(&valence).map(|(w, v)| (v + 1 - w).unsigned_abs() as usize).sum();
    let centre = positions[..n].iter().sum::<DVec2>() / n as f64;
    quality.embedded = true;
    for part in triangles.chunks(ASK_EVERY) {
        progress.report(0.0)?;
        quality.embedded = quality.embedded && first_inverted(positions, part, centre).is_none();
    }
    Ok(quality)
}

impl Quality {
    /// One number to choose by; less is better, infinite for patches that must not be used. For an
    /// `even` loop, irregular vertices weigh more than all else but folds.
    pub fn badness(&self, n_loop: usize, even: bool) -> f64 {
        if self.repeated > 0 {
            return f64::INFINITY;
        }
        let weight = if even && n_loop > 5 && n_loop != 7 { 20.0 } else { 1.0 };
        let irregular = weight * self.irregular as f64 / self.interior.max(6) as f64;
        let sharp = (1.0 - self.min_angle.to_degrees() / 25.0).clamp(0.0, 2.0);
        let folded = if self.embedded { 0.0 } else { 100.0 };
        folded
            + self.excess as f64 / n_loop as f64
            + irregular
            + 4.0 * (1.0 - self.mean_ratio)
            + sharp * sharp
    }
}
