//! Sparse weighted least squares with a pattern that is analysed once.

use crate::error::{Error, Result};
use crate::geometry::cholesky::Pattern;
use crate::progress::Progress;

fn failed(reason: impl ToString) -> Error {
    Error::Solver { stage: "fill", reason: reason.to_string() }
}

/// Equations `sum coefficient x unknown = right side`, of which the weighted sum of squares is made
/// least. Single weights may be negative as long as the whole is positive definite.
///
/// Which unknowns each equation has is fixed here; coefficients and right sides come with each
/// solve. Takes memory proportional to the sum of the squared numbers of unknowns per equation.
pub(crate) struct LeastSquares {
    unknowns: usize,
    start: Vec<u32>,
    columns: Vec<u32>,
    /// For each equation and each pair of its entries `(a, b)`, `b <= a`: where the product goes.
    slots: Vec<u32>,
    pattern: Pattern,
}

impl LeastSquares {
    /// `columns[start[i]..start[i + 1]]` are the unknowns of equation `i`, each once. Every unknown
    /// must be in some equation.
    pub fn new(unknowns: usize, start: Vec<u32>, columns: Vec<u32>, progress: Progress<'_>) -> Result<Self> {
        let row = |i: usize| &columns[start[i] as usize..start[i + 1] as usize];
        let n_rows = start.len() - 1;
        // The equations of each unknown.
        let mut first = vec![0u32; unknowns + 1];
        for &c in &columns {
            first[c as usize + 1] += 1;
        }
        for c in 0..unknowns {
            first[c + 1] += first[c];
        }
        let mut next = first.clone();
        let mut rows_of = vec![0u32; columns.len()];
        for i in 0..n_rows {
            for &c in row(i) {
                rows_of[next[c as usize] as usize] = i as u32;
                next[c as usize] += 1;
            }
        }
        // Upper triangle, column by column.
        let mut col_ptr = vec![0];
        let mut row_idx: Vec<usize> = vec![];
        let mut mark = vec![u32::MAX; unknowns];
        for c in 0..unknowns as u32 {
            let begin = row_idx.len();
            for &i in &rows_of[first[c as usize] as usize..first[c as usize + 1] as usize] {
                for &d in row(i as usize) {
                    if d <= c && mark[d as usize] != c {
                        mark[d as usize] = c;
                        row_idx.push(d as usize);
                    }
                }
            }
            if mark[c as usize] != c {
                return Err(failed(format_args!("unknown {c} is in no equation")));
            }
            row_idx[begin..].sort_unstable();
            col_ptr.push(row_idx.len());
        }
        let pattern = Pattern::new("fill", col_ptr, row_idx, progress)?;
        progress.report(0.0)?;
        let mut slots = vec![];
        for i in 0..n_rows {
            for (k, &a) in row(i).iter().enumerate() {
                for &b in &row(i)[..=k] {
                    slots.push(pattern.slot(a.min(b) as usize, a.max(b) as usize) as u32);
                }
            }
        }
        Ok(LeastSquares { unknowns, start, columns, slots, pattern })
    }

    /// Where the coefficients of equation `i` are.
    fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }

    /// Solves for `K` right sides at once.
    pub fn solve<const K: usize>(
        &self,
        coefficients: &[f64],
        weights: &[f64],
        right: &[[f64; K]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; K]>> {
        let n = self.unknowns;
        let mut values = vec![0.0; self.pattern.entries()];
        let mut x = vec![0.0; K * n];
        let mut slot = self.slots.iter();
        for (i, right) in right.iter().enumerate() {
            let range = self.range(i);
            let (columns, entries) = (&self.columns[range.clone()], &coefficients[range]);
            for (k, (&c, &a)) in columns.iter().zip(entries).enumerate() {
                let a = weights[i] * a;
                for (&b, &at) in entries[..=k].iter().zip(slot.by_ref()) {
                    values[at as usize] += a * b;
                }
                for (r, value) in right.iter().enumerate() {
                    x[r * n + c as usize] += a * value;
                }
            }
        }
        progress.report(0.0)?;
        let factor = self.pattern.factor(values, progress)?;
        progress.report(0.0)?;
        factor.solve(&mut x, K)?;
        progress.report(0.0)?;
        Ok((0..n).map(|c| std::array::from_fn(|r| x[r * n + c])).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_fitted() {
        // y = a + b t through five points, and the same twice as steep.
        let start = (0..=5).map(|i| 2 * i).collect();
        let system = LeastSquares::new(2, start, [0, 1].repeat(5), Progress::NONE).unwrap();
        let coefficients = (0..5).flat_map(|t| [1.0, f64::from(t)]).collect::<Vec<_>>();
        let right = [1.0, 3.1, 4.9, 7.1, 8.9].map(|y| [y, 2.0 * y]);
        let found = system.solve(&coefficients, &[1.0; 5], &right, Progress::NONE).unwrap();
        assert!((found[0][0] - 1.04).abs() < 1e-12 && (found[1][0] - 1.98).abs() < 1e-12, "{found:?}");
        assert!((found[1][1] - 3.96).abs() < 1e-12);
        assert!(LeastSquares::new(2, vec![0, 1], vec![0], Progress::NONE).is_err());
    }
}
