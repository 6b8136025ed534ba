//! Sparse factorisation.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

/// Expected shape of a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Symmetric and positive definite but for parts that are small enough to leave out: Cholesky, half the work of LU.
    Definite,
    /// Anything regular.
    General,
}

/// A square sparse matrix with a fixed pattern: analysed once, factored as often as its values change.
pub(crate) struct SparseFactor {
    pattern: SymbolicSparseColMat<u32>,
    cholesky: Option<Cholesky>,
    lu: Option<Lu>,
    /// `true` if the last factorisation is that of `lu`.
    general: bool,
}

struct Cholesky {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    memory: MemBuffer,
}

struct Lu {
    symbolic: SymbolicLu<u32>,
    numeric: NumericLu<u32, f64>,
    memory: MemBuffer,
}

impl SparseFactor {
    /// Analyses a pattern in compressed columns (row indices ascending within a column).
    pub fn analyse(size: usize, column_starts: Vec<usize>, row_indices: Vec<usize>, shape: Shape) -> Self {
        // Narrow indices: solutions are bound by memory.
        let narrow = |indices: Vec<usize>| indices.into_iter().map(|index| index as u32).collect();
        let pattern = SymbolicSparseColMat::new_checked(size, size, narrow(column_starts), None, narrow(row_indices));
        let cholesky = (shape == Shape::Definite).then(|| Cholesky::analyse(&pattern));
        Self {
            pattern,
            cholesky,
            lu: None,
            general: false,
        }
    }

    /// Factors the matrix with these values. A matrix that was expected to be definite and is not gets an LU
    /// factorisation.
    ///
    /// Returns `true` if faer found it regular; a pivot may still be so small that a solution is not finite.
    pub fn factor(&mut self, values: &[f64]) -> bool {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), values);
        if let Some(cholesky) = &mut self.cholesky
            && cholesky.factor(matrix)
        {
            self.general = false;
            return true;
        }
        self.general = true;
        let pattern = &self.pattern;
        self.lu.get_or_insert_with(|| Lu::analyse(pattern)).factor(matrix)
    }

    /// Returns `true` if the last factors are those of a symmetric matrix.
    pub fn is_symmetric(&self) -> bool {
        !self.general
    }

    /// Solves in place with the last factors.
    pub fn solve(&mut self, right_side: &mut [f64]) {
        let rows = right_side.len();
        let right_side = MatMut::from_column_major_slice_mut(right_side, rows, 1);
        match (&mut self.cholesky, &mut self.lu) {
            (_, Some(lu)) if self.general => lu.solve(right_side),
            (Some(cholesky), _) => cholesky.solve(right_side),
            _ => unreachable!("solved before it was factored"),
        }
    }
}

impl Cholesky {
    fn analyse(pattern: &SymbolicSparseColMat<u32>) -> Self {
        // Single columns: the band of a line is too narrow for dense blocks to pay.
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(pattern.as_ref(), Side::Lower, SymmetricOrdering::Amd, params)
            .expect("the pattern is valid and memory suffices");
        let scratch = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Self {
            values: vec![0.0; symbolic.len_val()],
            symbolic,
            memory: MemBuffer::new(scratch),
        }
    }

    fn factor(&mut self, matrix: SparseColMatRef<'_, u32, f64>) -> bool {
        self.symbolic
            .factorize_numeric_llt(
                &mut self.values,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .is_ok()
    }

    fn solve(&mut self, right_side: MatMut<'_, f64>) {
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right_side,
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

impl Lu {
    fn analyse(pattern: &SymbolicSparseColMat<u32>) -> Self {
        let symbolic = factorize_symbolic_lu(pattern.as_ref(), LuSymbolicParams::default())
            .expect("the pattern is valid and memory suffices");
        let scratch = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Self {
            symbolic,
            numeric: NumericLu::new(),
            memory: MemBuffer::new(scratch),
        }
    }

    fn factor(&mut self, matrix: SparseColMatRef<'_, u32, f64>) -> bool {
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                matrix,
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .is_ok()
    }

    fn solve(&mut self, right_side: MatMut<'_, f64>) {
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            right_side,
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}
