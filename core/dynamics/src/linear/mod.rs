//! Linear systems of Newton's method: assembled, factored part by part, corrected by low-rank terms.
//!
//! | file | subject |
//! | --- | --- |
//! | `pattern` | entries of the iteration matrix, and the sets of unknowns that they couple |
//! | `iteration_matrix` | assembly of `[m M + K + D, g_qᵀ; g_q, 0]`, factored part by part |
//! | `part` | one set of coupled unknowns: choice and use of its factorisation |
//! | `block_tridiagonal` | Cholesky factorisation of long, thin structures in small blocks |
//! | `condensed` | static condensation of unknowns that are coupled with none of their like |
//! | `sparse_factor` | general sparse Cholesky and LU factorisation |
//! | `dense_lu` | Gaussian elimination of small dense matrices |
//! | `eigen` | eigenvalues and eigenvectors of long, thin structures |
//! | `low_rank` | low-rank updates of a factored matrix |
//! | `factored_matrix` | the iteration matrix by itself, for linear answers |
//! | `sparse` | sparse matrix for products |
//! | `products`, `buffer` | products and storage in whole cache lines |

pub(crate) mod block_tridiagonal;
pub(crate) mod buffer;
pub(crate) mod condensed;
pub(crate) mod dense_lu;
pub mod eigen;
pub(crate) mod factored_matrix;
pub(crate) mod iteration_matrix;
pub(crate) mod low_rank;
pub(crate) mod part;
pub(crate) mod pattern;
pub(crate) mod products;
pub(crate) mod sparse;
pub(crate) mod sparse_factor;

pub use block_tridiagonal::{BlockTridiagonal, LocalColumn, Precision};
pub use dense_lu::Lu;
pub use factored_matrix::FactoredMatrix;
pub use low_rank::Updates;
pub use pattern::uncoupled;
pub use sparse::SparseMatrix;
