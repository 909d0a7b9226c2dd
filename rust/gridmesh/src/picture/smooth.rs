//! Smoothing: the longest stretch around each sample that a parabola fits.

use glam::DVec2;

use crate::error::Result;
use crate::picture::heights::Sample;

/// Half the length of the stretches tried, longest first, in pixels.
const REACHES: [f64; 7] = [12.0, 8.5, 6.0, 4.2, 3.0, 2.1, 1.5];

/// How far samples may be from the parabola: what quantised coverage makes of a straight edge, in pixels.
const EXACT: f64 = 0.15;

/// The same for crossings between two pixels.
const LINEAR: f64 = 0.3;

/// No sample moves farther than this, in pixels; half a pixel at most where there is more noise.
const FARTHEST: f64 = 0.3;

/// Contours of more samples report in between.
const REPORT: usize = 4096;

/// Smooths a closed line, corners excepted; no stretch goes beyond a corner.
///
/// Each sample is replaced by the value there of the parabola that fits a stretch around it best, the longest
/// stretch whose samples all lie as near to it as coverage can tell. Curvature is kept.
pub fn smooth(
    samples: Vec<Sample>,
    strength: f64,
    noise: f64,
    report: impl Fn(f64) -> Result<()>,
) -> Result<Vec<Sample>> {
    let line = Line::new(&samples, noise);
    let mut smoothed = samples.clone();
    for i in 0..samples.len() {
        if i.is_multiple_of(REPORT) {
            report(0.3 + 0.7 * i as f64 / samples.len() as f64)?;
        }
        if !samples[i].corner {
            smoothed[i].at = line.smoothed(i, strength);
        }
    }
    Ok(smoothed)
}

/// A closed line of samples, by arc length.
struct Line<'a> {
    samples: &'a [Sample],
    /// Length of the segment to the next sample.
    lengths: Vec<f64>,
    noise: f64,
}

impl<'a> Line<'a> {
    fn new(samples: &'a [Sample], noise: f64) -> Self {
        let n = samples.len();
        let lengths = (0..n).map(|i| samples[i].at.distance(samples[(i + 1) % n].at)).collect();
        Self { samples, lengths, noise }
    }

    /// Samples around one, with their arc lengths from it, in one direction, up to a corner.
    fn walk(&self, i: usize, reach: f64, ahead: bool, stretch: &mut Vec<(f64, usize)>) {
        let n = self.samples.len();
        let (mut at, mut arc) = (i, 0.0);
        for _ in 0..n / 3 {
            let next = if ahead { (at + 1) % n } else { (at + n - 1) % n };
            arc += self.lengths[if ahead { at } else { next }];
            if arc > reach {
                break;
            }
            at = next;
            stretch.push((if ahead { arc } else { -arc }, at));
            if self.samples[at].corner {
                break;
            }
        }
    }

    fn smoothed(&self, i: usize, strength: f64) -> DVec2 {
        let here = self.samples[i].at;
        let mut stretch = Vec::with_capacity(64);
        for reach in REACHES {
            stretch.clear();
            stretch.push((0.0, i));
            self.walk(i, reach * strength, true, &mut stretch);
            self.walk(i, reach * strength, false, &mut stretch);
            if stretch.len() < 4 {
                break;
            }
            if let Some(at) = self.fit(&stretch, here) {
                return here + (at - here).clamp_length_max((FARTHEST * self.noise).min(0.5));
            }
        }
        here
    }

    /// The parabola through a stretch, at arc length 0, if all samples are near to it.
    fn fit(&self, stretch: &[(f64, usize)], here: DVec2) -> Option<DVec2> {
        let points = || stretch.iter().map(|&(s, k)| (s, self.samples[k].at - here));
        let parabola = Parabola::fit(points())?;
        let near = stretch.iter().zip(points()).all(|(&(_, k), (s, point))| {
            let sample = self.samples[k];
            let allowed = if sample.exact || sample.corner { EXACT } else { LINEAR };
            parabola.off(s, point) <= allowed * self.noise
        });
        near.then_some(here + parabola.coefficients[0])
    }
}

/// A point that moves with arc length like a parabola.
pub(super) struct Parabola {
    coefficients: [DVec2; 3],
    scale: f64,
}

impl Parabola {
    /// That of least squares through points at arc lengths; none through fewer than three places.
    pub(super) fn fit(points: impl Iterator<Item = (f64, DVec2)> + Clone) -> Option<Self> {
        let scale = points.clone().map(|(s, _)| s.abs()).fold(1e-9, f64::max);
        let mut m = [0.0; 5];
        let mut sums = [DVec2::ZERO; 3];
        for (s, point) in points {
            let s = s / scale;
            let mut power = 1.0;
            for (k, moment) in m.iter_mut().enumerate() {
                *moment += power;
                if k < 3 {
                    sums[k] += power * point;
                }
                power *= s;
            }
        }
        let minors = [m[2] * m[4] - m[3] * m[3], m[1] * m[4] - m[2] * m[3], m[1] * m[3] - m[2] * m[2]];
        let (middle, last) = (m[0] * m[4] - m[2] * m[2], m[0] * m[2] - m[1] * m[1]);
        let mixed = m[0] * m[3] - m[1] * m[2];
        let determinant = m[0] * minors[0] - m[1] * minors[1] + m[2] * minors[2];
        if determinant <= 1e-9 * m[0] * m[0] * m[0] {
            return None;
        }
        let a = minors[0] * sums[0] - minors[1] * sums[1] + minors[2] * sums[2];
        let b = -minors[1] * sums[0] + middle * sums[1] - mixed * sums[2];
        let c = minors[2] * sums[0] - mixed * sums[1] + last * sums[2];
        Some(Self { coefficients: [a / determinant, b / determinant, c / determinant], scale })
    }

    /// How far a point at an arc length is from it; along it points may lie where they like.
    pub(super) fn off(&self, s: f64, point: DVec2) -> f64 {
        let (s, [a, b, c]) = (s / self.scale, self.coefficients);
        let (fitted, slope) = (a + s * (b + s * c), b + 2.0 * s * c);
        (point - fitted).perp_dot(slope.normalize_or_zero()).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: impl Iterator<Item = DVec2>) -> Vec<Sample> {
        points.enumerate().map(|(crossing, at)| Sample { crossing, at, exact: true, corner: false }).collect()
    }

    #[test]
    fn noise_goes_and_curvature_stays() {
        let turn = std::f64::consts::TAU / 250.0;
        // Trembles by a tenth of a pixel, at random.
        let mut seed = 1_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 40) as f64 / (1_u64 << 24) as f64 * 0.2 - 0.1
        };
        let circle = line((0..250).map(|k| (40.0 + noise()) * DVec2::from_angle(turn * f64::from(k))));
        let smoothed = smooth(circle.clone(), 1.0, 1.0, |_| Ok(())).unwrap();
        let off = |samples: &[Sample]| {
            let squares = samples.iter().map(|sample| (sample.at.length() - 40.0).powi(2)).sum::<f64>();
            (squares / samples.len() as f64).sqrt()
        };
        assert!(off(&smoothed) < 0.5 * off(&circle), "{} {}", off(&smoothed), off(&circle));
        let mean = smoothed.iter().map(|sample| sample.at.length()).sum::<f64>() / 250.0;
        assert!((mean - 40.0).abs() < 0.01);
    }

    #[test]
    fn an_unmarked_corner_is_not_rounded_off() {
        let side = |k: i32| f64::from(k.rem_euclid(80));
        let square = line((0..320).map(|k| match k / 80 {
            0 => DVec2::new(side(k), 0.0),
            1 => DVec2::new(80.0, side(k)),
            2 => DVec2::new(80.0 - side(k), 80.0),
            _ => DVec2::new(0.0, 80.0 - side(k)),
        }));
        let smoothed = smooth(square.clone(), 1.0, 1.0, |_| Ok(())).unwrap();
        for (a, b) in square.iter().zip(&smoothed) {
            assert!(a.at.distance(b.at) < 0.2);
        }
    }
}
