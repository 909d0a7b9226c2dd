//! Which point of one line belongs to which of another that runs beside it.

use glam::DVec2;

/// Pairs of fractions of two lines' lengths, both strictly increasing from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Matching {
    /// At equal distances of a common parameter, 0 to 1.
    pairs: Vec<[f64; 2]>,
    /// Greatest distance between two matched points.
    pub(crate) difference: f64,
    /// Where: the point of the first line.
    pub(crate) at: DVec2,
}

impl Matching {
    /// Matches two lines, each given by the point at a fraction of its length. Their ends belong
    /// together.
    ///
    /// Equal fractions, if that leaves no points more than `near` apart. Otherwise the sequence of
    /// pairs that runs along both with the least sum of squared distances (dynamic time warping
    /// within an eighth of the length), smoothed. O(samples squared).
    pub(crate) fn new(
        first: impl Fn(f64) -> DVec2,
        second: impl Fn(f64) -> DVec2,
        samples: usize,
        near: f64,
    ) -> Self {
        let along = |line: &dyn Fn(f64) -> DVec2| -> Vec<DVec2> {
            (0..=samples).map(|i| line(i as f64 / samples as f64)).collect()
        };
        let (a, b) = (along(&first), along(&second));
        let mut found = Self { pairs: vec![[0.0; 2], [1.0; 2]], difference: 0.0, at: DVec2::ZERO };
        found.measure(a.iter().zip(&b).map(|(&p, &q)| (p, q)));
        if found.difference <= near {
            return found;
        }
        let mut warped = Self { pairs: warp(&a, &b), ..found.clone() };
        let matched = |w: f64| warped.pair(w);
        let pairs: Vec<(DVec2, DVec2)> = (0..=samples)
            .map(|i| {
                let [s, t] = matched(i as f64 / samples as f64);
                (first(s), second(t))
            })
            .collect();
        warped.measure(pairs.into_iter());
        if warped.difference < found.difference { warped } else { found }
    }

    fn measure(&mut self, pairs: impl Iterator<Item = (DVec2, DVec2)>) {
        (self.difference, self.at) = pairs.fold((0.0, DVec2::ZERO), |worst, (p, q)| {
            let d = p.distance(q);
            if d > worst.0 || worst.1 == DVec2::ZERO { (d.max(worst.0), p) } else { worst }
        });
    }

    /// The fractions at the common parameter.
    pub(crate) fn pair(&self, w: f64) -> [f64; 2] {
        let n = self.pairs.len() - 1;
        let at = w.clamp(0.0, 1.0) * n as f64;
        let i = (at as usize).min(n - 1);
        let (from, to) = (self.pairs[i], self.pairs[i + 1]);
        let t = at - i as f64;
        [0, 1].map(|k| from[k] + t * (to[k] - from[k]))
    }

    /// The common parameter of a fraction of the first (0) or second line (1).
    pub(crate) fn parameter(&self, line: usize, fraction: f64) -> f64 {
        let n = self.pairs.len() - 1;
        let i = self.pairs.partition_point(|pair| pair[line] <= fraction).clamp(1, n) - 1;
        let (from, to) = (self.pairs[i][line], self.pairs[i + 1][line]);
        ((i as f64 + (fraction - from) / (to - from)) / n as f64).clamp(0.0, 1.0)
    }
}

/// The cheapest monotone sequence of pairs, smoothed, at equal distances of their mean.
fn warp(a: &[DVec2], b: &[DVec2]) -> Vec<[f64; 2]> {
    const SMOOTH: usize = 4;
    const STRAIGHT: f64 = 0.1;
    let n = a.len() - 1;
    let width = n / 8 + 1;
    let columns = 2 * width + 1;
    // Row i holds the columns j = i - width ..= i + width.
    let mut cost = vec![f64::INFINITY; (n + 1) * columns];
    let slot = |i: usize, j: usize| -> Option<usize> {
        let k = (j + width).checked_sub(i)?;
        (k < columns).then_some(i * columns + k)
    };
    let steps = [(1, 1), (1, 0), (0, 1)];
    let before = |i: usize, j: usize, (di, dj): (usize, usize)| -> Option<usize> {
        slot(i.checked_sub(di)?, j.checked_sub(dj)?)
    };
    for (i, p) in a.iter().enumerate() {
        let first = i.saturating_sub(width);
        for (j, q) in b.iter().enumerate().take(i + width + 1).skip(first) {
            let Some(here) = slot(i, j) else { continue };
            let least = steps.iter().filter_map(|&step| before(i, j, step)).map(|k| cost[k]);
            let least = if i + j == 0 { 0.0 } else { least.fold(f64::INFINITY, f64::min) };
            cost[here] = least + p.distance_squared(*q);
        }
    }
    let mut path = vec![(n, n)];
    let (mut i, mut j) = (n, n);
    while i + j > 0 {
        let cost_of = |step: (usize, usize)| before(i, j, step).map_or(f64::INFINITY, |k| cost[k]);
        let mut best = steps[0];
        for step in steps {
            if cost_of(step) < cost_of(best) {
                best = step;
            }
        }
        let Some((di, dj)) = Some(best).filter(|&step| cost_of(step).is_finite()) else { break };
        (i, j) = (i - di, j - dj);
        path.push((i, j));
    }
    path.reverse();
    // The lead of the first line over the second, at equal distances of their mean.
    let mut lead = vec![0.0; n + 1];
    let mut at = 0;
    for (w, lead) in lead.iter_mut().enumerate() {
        while at + 1 < path.len() && path[at].0 + path[at].1 < 2 * w {
            at += 1;
        }
        *lead = path[at].0 as f64 - path[at].1 as f64;
    }
    for _ in 0..SMOOTH {
        let old = lead.clone();
        for w in 1..n {
            lead[w] = 0.25 * (old[w - 1] + 2.0 * old[w] + old[w + 1]);
        }
    }
    (lead[0], lead[n]) = (0.0, 0.0);
    // Neither line may stand still.
    for w in 1..=n {
        let most = 2.0 * (1.0 - STRAIGHT);
        lead[w] = lead[w].clamp(lead[w - 1] - most, lead[w - 1] + most);
    }
    for w in (0..n).rev() {
        let most = 2.0 * (1.0 - STRAIGHT);
        lead[w] = lead[w].clamp(lead[w + 1] - most, lead[w + 1] + most);
    }
    lead.iter()
        .enumerate()
        .map(|(w, lead)| [(w as f64 + 0.5 * lead) / n as f64, (w as f64 - 0.5 * lead) / n as f64])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_drawn_unevenly_is_matched() {
        // The same bent line, once with a wiggle in its length.
        let first = |t: f64| DVec2::new(t, if t < 0.5 { 0.0 } else { 2.0 * (t - 0.5) });
        let second = |t: f64| first(t + 0.05 * (std::f64::consts::PI * t).sin());
        let matching = Matching::new(first, second, 256, 1e-3);
        assert!(matching.difference < 0.02, "{}", matching.difference);
        let mut last = [-1.0; 2];
        for i in 0..=1000 {
            let w = f64::from(i) / 1000.0;
            let pair = matching.pair(w);
            assert!(pair[0] > last[0] && pair[1] > last[1]);
            for (line, &fraction) in pair.iter().enumerate() {
                assert!((matching.parameter(line, fraction) - w).abs() < 1e-9);
            }
            last = pair;
        }
        assert_eq!((matching.pair(0.0), matching.pair(1.0)), ([0.0; 2], [1.0; 2]));
    }
}
