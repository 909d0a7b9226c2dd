//! Sparse Cholesky factorisation of symmetric positive definite matrices: the one place that knows faer.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::error::{Error, Result};
use crate::progress::{Progress, aside};

/// Matrices with more entries are analysed and factored aside: faer does not ask whether to go on.
const LARGE: usize = 1 << 16;

/// The nonzero pattern of a matrix, ordered and analysed once.
#[derive(Clone, Debug)]
pub(crate) struct Pattern(Arc<Analysed>);

#[derive(Debug)]
struct Analysed {
    stage: &'static str,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
}

impl Pattern {
    /// Of the upper triangle with the diagonal, column by column: `row_idx[col_ptr[c]..col_ptr[c + 1]]` are the rows of
    /// column `c`, ascending. `stage` is named in errors. O(n log n) in practice.
    pub fn new(
        stage: &'static str,
        col_ptr: Vec<usize>,
        row_idx: Vec<usize>,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let analysed = if row_idx.len() > LARGE {
            aside(progress, move || Analysed::new(stage, col_ptr, row_idx))??
        } else {
            Analysed::new(stage, col_ptr, row_idx)?
        };
        Ok(Pattern(Arc::new(analysed)))
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.0.row_idx.len()
    }

    /// Where the entry of a row and a column is stored, `row <= column`; where it would be if there is none.
    pub fn slot(&self, row: usize, column: usize) -> usize {
        let from = self.0.col_ptr[column];
        from + self.0.row_idx[from..self.0.col_ptr[column + 1]].partition_point(|&r| r < row)
    }

    /// Factors the matrix with these entries, stored as the pattern is.
    pub fn factor(&self, values: Vec<f64>, progress: Progress<'_>) -> Result<Factor> {
        let pattern = Arc::clone(&self.0);
        let values = if self.entries() > LARGE {
            aside(progress, move || pattern.factor(&values))??
        } else {
            pattern.factor(&values)?
        };
        Ok(Factor { pattern: Arc::clone(&self.0), values })
    }
}

impl Analysed {
    fn new(stage: &'static str, col_ptr: Vec<usize>, row_idx: Vec<usize>) -> Result<Self> {
        let n = col_ptr.len().saturating_sub(1);
        let symbolic = factorize_symbolic_cholesky(
            SymbolicSparseColMatRef::new_checked(n, n, &col_ptr, None, &row_idx),
            Side::Upper,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                // Supernodes are multiplied by the widest instructions that the processor has, which round differently.
                // Without them bodies of 100,000 triangles take 7 % longer, of 10,000 no longer.
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
                ..Default::default()
            },
        )
        .map_err(|error| Error::Solver { stage, reason: error.to_string() })?;
        Ok(Analysed { stage, col_ptr, row_idx, symbolic })
    }

    fn len(&self) -> usize {
        self.col_ptr.len() - 1
    }

    /// The values of the factor of the matrix with these entries.
    fn factor(&self, values: &[f64]) -> Result<Vec<f64>> {
        let n = self.len();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.col_ptr, None, &self.row_idx);
        let mut factor = vec![0.0; self.symbolic.len_val()];
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| self.failed("out of memory"))?;
        self.symbolic
            .factorize_numeric_llt(
                &mut factor,
                SparseColMatRef::new(pattern, values),
                Side::Upper,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|error| self.failed(&format!("the matrix is not positive definite ({error})")))?;
        Ok(factor)
    }

    fn failed(&self, reason: &str) -> Error {
        Error::Solver { stage: self.stage, reason: reason.to_owned() }
    }
}

/// A factored matrix.
pub(crate) struct Factor {
    pattern: Arc<Analysed>,
    values: Vec<f64>,
}

impl Factor {
    /// Solves for `columns` right-hand sides, stored one after the other, in place.
    pub fn solve(&self, rhs: &mut [f64], columns: usize) -> Result<()> {
        let n = self.pattern.len();
        let symbolic = &self.pattern.symbolic;
        let scratch = symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| self.pattern.failed("out of memory"))?;
        LltRef::<'_, usize, f64>::new(symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(rhs, n, columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        if rhs.iter().all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(self.pattern.failed("the solution is not finite"))
        }
    }
}
