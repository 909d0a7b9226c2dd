//! The threshold that parts the pixels best.

use crate::picture::field::Picture;

const BINS: usize = 256;

/// The threshold of the greatest variance between the pixels below and above it, between 0 and 1.
///
/// Values are counted in 256 steps; in the middle of those thresholds that are equally good, and 1/2 for a picture
/// of one value. Source: Otsu, A threshold selection method from gray-level histograms, 1979.
pub fn otsu(picture: &Picture) -> f64 {
    let mut counts = [0_u64; BINS];
    for &value in picture.values() {
        counts[((value * (BINS - 1) as f32).round() as usize).min(BINS - 1)] += 1;
    }
    let all: u64 = counts.iter().sum();
    let whole: u64 = counts.iter().zip(0_u64..).map(|(count, bin)| count * bin).sum();
    let (mut below, mut sum) = (0_u64, 0_u64);
    // The best variance, and the first and the last bin that have it.
    let mut best = (0.0, 0, 0);
    for (bin, count) in counts.iter().enumerate().take(BINS - 1) {
        below += count;
        sum += count * bin as u64;
        if below == 0 || below == all {
            continue;
        }
        let (low, high) = (below as f64, (all - below) as f64);
        let difference = sum as f64 / low - (whole - sum) as f64 / high;
        let variance = low * high * difference * difference;
        if variance > best.0 {
            best = (variance, bin, bin);
        } else if variance == best.0 {
            best.2 = bin;
        }
    }
    if best.0 == 0.0 {
        return 0.5;
    }
    ((best.1 + best.2 + 1) as f64 / 2.0 / (BINS - 1) as f64).clamp(1e-3, 1.0 - 1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_groups() {
        let mut values = vec![0.1_f32; 900];
        values.extend(vec![0.7; 100]);
        let picture = Picture::new(100, 10, values).unwrap();
        assert!((otsu(&picture) - 0.4).abs() < 0.01);
        let plain = Picture::new(10, 10, vec![0.3; 100]).unwrap();
        assert_eq!(otsu(&plain), 0.5);
    }
}
