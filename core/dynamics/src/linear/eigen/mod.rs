//! Eigenvalues and eigenvectors of long, thin structures.
//!
//! | file | subject |
//! | --- | --- |
//! | `attachment` | eigenpairs of what is answered to given forces beyond known eigenpairs |
//! | `banded` | symmetric banded matrices and their factors `L D Lᵀ` |
//! | `slice` | all eigenpairs between two values, by shifted and inverted block Lanczos |
//! | `subspace` | the lowest eigenpairs of a small pencil, and those of a subspace |
mod attachment;
mod banded;
mod slice;
mod subspace;

pub use attachment::attachment_pairs;
pub use banded::{BandedFactor, BandedMatrix};
pub use subspace::{lowest_eigenpairs, restricted};

use crate::SparseMatrix;
use slice::{Slice, eigenpairs};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Eigenpairs of a slice at which the slice is cut no further.
const PER_SLICE: usize = 40;

/// Eigenpairs `K φ = λ M φ` with `φᵀ M φ = 1`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Eigenpairs {
    /// Eigenvalues in ascending order.
    pub values: Vec<f64>,
    /// Eigenvectors, one after the other.
    pub vectors: Vec<Vec<f64>>,
}

impl Eigenpairs {
    /// The first ones.
    fn first(mut self, count: usize) -> Self {
        self.values.truncate(count);
        self.vectors.truncate(count);
        self
    }

    /// These and others, in ascending order.
    #[must_use]
    pub fn merged(self, others: Self) -> Self {
        let of = |pairs: Self| pairs.values.into_iter().zip(pairs.vectors);
        let mut all: Vec<_> = of(self).chain(of(others)).collect();
        all.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let (values, vectors) = all.into_iter().unzip();
        Self { values, vectors }
    }
}

/// Reason why eigenpairs were not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EigenError {
    /// The mass matrix is not positive definite.
    #[error("the mass matrix has {negative} eigenvalues that are not positive")]
    Mass {
        /// Their number.
        negative: usize,
    },
    /// Fewer eigenpairs converged than the factors of the shifted matrix tell.
    #[error("{found} of {expected} eigenvalues between {low} and {high} were found")]
    Missing {
        /// Converged eigenpairs.
        found: usize,
        /// Eigenvalues between the bounds.
        expected: usize,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
}

/// All eigenpairs of a positive definite pencil below `most`: the number of eigenvalues below a value is that of the
/// negative pivots of `K − λ M` (Sylvester's law of inertia), so that none is missed. Slices of the spectrum are solved
/// side by side on all cores; the result does not depend on their number.
///
/// # Errors
/// See [`EigenError`].
pub fn eigenpairs_below(stiffness: &BandedMatrix, mass: &BandedMatrix, most: f64) -> Result<Eigenpairs, EigenError> {
    let negative = BandedFactor::new(mass).negative();
    if negative > 0 {
        return Err(EigenError::Mass { negative });
    }
    let below = |value: f64| BandedFactor::shifted(stiffness, value, mass).negative();
    let mut slices = Vec::new();
    let whole = Slice {
        bounds: [0.0, most],
        before: 0,
        count: below(most),
    };
    cut(whole, &below, &mut slices);
    let sparse = SparseMatrix::from(mass);
    let found = Mutex::new(vec![None; slices.len()]);
    let next = AtomicUsize::new(0);
    let workers = std::thread::available_parallelism()
        .map_or(1, usize::from)
        .min(slices.len());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(slice) = slices.get(place) else {
                        break;
                    };
                    let pairs = eigenpairs(stiffness, (mass, &sparse), slice);
                    found.lock().unwrap_or_else(PoisonError::into_inner)[place] = Some(pairs);
                }
            });
        }
    });
    let mut all = Eigenpairs::default();
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    for pairs in found.into_iter().flatten() {
        let pairs = pairs?;
        all.values.extend(pairs.values);
        all.vectors.extend(pairs.vectors);
    }
    Ok(all)
}

/// Cuts a slice at the middle of its frequencies until each part is small; empty parts are left out.
fn cut(slice: Slice, below: &dyn Fn(f64) -> usize, slices: &mut Vec<Slice>) {
    if slice.count == 0 {
        return;
    }
    let [low, high] = slice.bounds;
    let middle = (0.5 * (low.sqrt() + high.sqrt())).powi(2);
    if slice.count <= PER_SLICE || high - low <= 1e-9 * high {
        slices.push(slice);
        return;
    }
    let before = below(middle);
    let lower = Slice {
        bounds: [low, middle],
        before: slice.before,
        count: before - slice.before,
    };
    let upper = Slice {
        bounds: [middle, high],
        before,
        count: slice.count - lower.count,
    };
    cut(lower, below, slices);
    cut(upper, below, slices);
}

#[cfg(test)]
mod tests;
