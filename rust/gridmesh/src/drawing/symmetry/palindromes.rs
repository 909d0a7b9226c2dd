//! Where a cyclic sequence reads the same in both directions.

/// The places of a cyclic sequence of even length from which on it reads the same forwards and
/// backwards, ascending and below half the length: the other half are those opposite. Numbers that
/// differ by at most `near` are the same. Linear.
///
/// Source: G. Manacher, J. ACM 22(3), 1975, on the sequence written twice.
pub(super) fn palindromes(cycle: &[f64], near: f64) -> Vec<usize> {
    let m = cycle.len();
    let same = |i: usize, j: usize| (cycle[i % m] - cycle[j % m]).abs() <= near;
    let n = 2 * m;
    // Places on each side of a place that agree, up to half the cycle; of the palindrome that reaches
    // farthest the middle.
    let mut radius = vec![0; n];
    let mut middle = 0;
    for i in 1..n {
        let end = middle + radius[middle];
        let mut r = if i <= end { radius[2 * middle - i].min(end - i) } else { 0 };
        while r < m / 2 && r < i && i + r + 1 < n && same(i - r - 1, i + r + 1) {
            r += 1;
        }
        radius[i] = r;
        if i + r > middle + radius[middle] {
            middle = i;
        }
    }
    (m / 2..m).filter(|&i| radius[i] >= m / 2).map(|i| i - m / 2).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_places_are_found() {
        // Against the definition, with letters few enough that cycles often read alike.
        for seed in 0..4000u32 {
            let m = 2 * (2 + seed as usize % 6);
            let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
            let cycle: Vec<f64> = (0..m)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    f64::from(state >> 31)
                })
                .collect();
            let expected: Vec<usize> = (0..m / 2)
                .filter(|&k| (0..m).all(|i| cycle[(k + i) % m] == cycle[(k + m - i) % m]))
                .collect();
            assert_eq!(palindromes(&cycle, 0.0), expected, "{cycle:?}");
        }
        assert_eq!(palindromes(&[1.0; 8], 0.0), [0, 1, 2, 3]);
    }
}
