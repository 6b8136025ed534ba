//! Sparse LU factorisation: the only module that names faer.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par};

/// A square sparse matrix with a fixed pattern: analysed once, factored as often as its values change.
pub(crate) struct SparseLu {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
}

impl SparseLu {
    /// Analyses a pattern in compressed columns (row indices ascending within a column).
    pub fn analyse(size: usize, column_starts: Vec<usize>, row_indices: Vec<usize>) -> Self {
        let pattern = SymbolicSparseColMat::new_checked(size, size, column_starts, None, row_indices);
        let symbolic = factorize_symbolic_lu(pattern.as_ref(), LuSymbolicParams::default())
            .expect("the pattern is valid and memory suffices");
        let scratch = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Self {
            pattern,
            symbolic,
            numeric: NumericLu::new(),
            memory: MemBuffer::new(scratch),
        }
    }

    /// Factors the matrix with these values. Returns whether faer found it regular; a pivot may still be so small that a
    /// solution is not finite.
    pub fn factor(&mut self, values: &[f64]) -> bool {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), values);
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

    /// Solves in place with the last factors.
    pub fn solve(&mut self, right_side: &mut [f64]) {
        let rows = right_side.len();
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right_side, rows, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}
