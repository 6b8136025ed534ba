//! All eigenpairs between two values.
use super::banded::dot;
use super::{BandedFactor, BandedMatrix, EigenError, Eigenpairs};
use crate::{SparseMatrix, SplitMix64};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

/// A part of the spectrum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice {
    /// Lowest and highest eigenvalue.
    pub bounds: [f64; 2],
    /// Eigenvalues below the slice.
    pub before: usize,
    /// Eigenvalues within.
    pub count: usize,
}

/// Vectors in a block: eigenvalues of lines of equal parts come in groups.
const BLOCK: usize = 4;
/// Residual of a converged eigenvector of the inverse, in units of its eigenvalue.
const CONVERGED: f64 = 1e-9;
/// Part of a column beyond others above which its product with the mass follows from theirs, –.
const FOLLOWS: f64 = 1e-3;
/// Part of an image beyond the basis below which a direction is spent, –.
const SPENT: f64 = 1e-13;

/// Columns of `rows` numbers, one after the other.
struct Columns {
    rows: usize,
    values: Vec<f64>,
}

impl Columns {
    fn new(rows: usize) -> Self {
        let values = Vec::new();
        Self { rows, values }
    }

    fn count(&self) -> usize {
        self.values.len() / self.rows
    }

    fn view(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.values, self.rows, self.count())
    }

    fn view_mut(&mut self) -> MatMut<'_, f64> {
        let (rows, count) = (self.rows, self.count());
        MatMut::from_column_major_slice_mut(&mut self.values, rows, count)
    }

    fn column(&self, column: usize) -> &[f64] {
        &self.values[column * self.rows..][..self.rows]
    }

    fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.values[column * self.rows..][..self.rows]
    }
}

/// Krylov space of `A = (K − σ M)⁻¹ M` with a basis `V`, `Vᵀ M V = 1`.
struct Krylov<'a> {
    mass: &'a SparseMatrix,
    factor: BandedFactor,
    /// `V` and `M V`.
    basis: Columns,
    with_mass: Columns,
    /// `Vᵀ M A v` for each vector, as far as there was a basis when its image was made.
    projected: Vec<Vec<f64>>,
    random: SplitMix64,
}

impl Krylov<'_> {
    /// `Vᵀ M w` of all columns `w`, which are taken away from these.
    fn remove(&self, w: &mut Columns) -> Mat<f64> {
        let mut all = Mat::zeros(self.basis.count(), w.count());
        for _ in 0..2 {
            let mut along = Mat::<f64>::zeros(all.nrows(), all.ncols());
            let mass = self.with_mass.view();
            matmul(
                along.as_mut(),
                Accum::Replace,
                mass.transpose(),
                w.view(),
                1.0,
                Par::Seq,
            );
            let basis = self.basis.view();
            matmul(w.view_mut(), Accum::Add, basis, along.as_ref(), -1.0, Par::Seq);
            all += along;
        }
        all
    }

    /// Appends the columns of `w` that are independent of each other; those of `w` are orthogonal to the basis. Returns
    /// the norms of all columns.
    fn append(&mut self, mut w: Columns, scale: &[f64]) -> Vec<f64> {
        let first = self.basis.count();
        let rows = w.rows;
        let values = self.mass.multiply_columns(&w.values);
        let mut products = Columns { rows, values };
        let mut norms = Vec::with_capacity(w.count());
        for (k, scale) in scale.iter().enumerate() {
            let (own, product) = (w.column_mut(k), products.column_mut(k));
            let before = dot(own, product).max(0.0).sqrt();
            norms.push(before);
            for _ in 0..2 {
                for other in first..self.basis.count() {
                    let along = dot(self.with_mass.column(other), own);
                    subtract(along, self.basis.column(other), own);
                    subtract(along, self.with_mass.column(other), product);
                }
            }
            let mut norm = dot(own, product).max(0.0).sqrt();
            if norm < FOLLOWS * before {
                product.fill(0.0);
                self.mass.multiply_add(own, product);
                norm = dot(own, product).max(0.0).sqrt();
            }
            if norm > SPENT * scale && self.basis.count() < rows {
                self.basis.values.extend(own.iter().map(|w| w / norm));
                self.with_mass.values.extend(product.iter().map(|w| w / norm));
            }
        }
        norms
    }

    /// Appends random directions.
    fn begin(&mut self) {
        let rows = self.mass.size();
        let values = (0..rows * BLOCK).map(|_| self.random.unit() - 0.5).collect();
        let mut w = Columns { rows, values };
        self.remove(&mut w);
        self.append(w, &[1.0; BLOCK]);
    }

    /// `A` on the basis vectors from `first` on.
    fn images(&self, first: usize) -> Columns {
        let rows = self.mass.size();
        let mut values = self.with_mass.values[first * rows..].to_vec();
        self.factor.solve_columns(&mut values);
        Columns { rows, values }
    }

    /// Eigenvalues and eigenvectors of the projection of `A`; none where the iteration for them fails.
    fn ritz(&self) -> Option<(Vec<f64>, Mat<f64>)> {
        let entry = |row: usize, column: usize| {
            let (early, late) = (row.min(column), row.max(column));
            self.projected[late].get(early).copied().unwrap_or(0.0)
        };
        let size = self.projected.len();
        let found = Mat::from_fn(size, size, entry).self_adjoint_eigen(Side::Lower).ok()?;
        Some((
            found.S().column_vector().iter().copied().collect(),
            found.U().to_owned(),
        ))
    }
}

/// Block Lanczos with full orthogonalisation in the product of `M` [Grimes, Lewis & Simon, SIAM J. Matrix Anal. Appl.
/// 15 (1994) 228]: eigenvalues `θ` of `A` are `1/(λ − σ)`, largest next to the shift `σ` in the middle of the slice.
pub(super) fn eigenpairs(
    stiffness: &BandedMatrix,
    (banded, mass): (&BandedMatrix, &SparseMatrix),
    slice: &Slice,
) -> Result<Eigenpairs, EigenError> {
    let n = stiffness.size();
    let [low, high] = slice.bounds;
    let shift = 0.5 * (low + high);
    let mut krylov = Krylov {
        mass,
        factor: BandedFactor::shifted(stiffness, shift, banded),
        basis: Columns::new(n),
        with_mass: Columns::new(n),
        projected: Vec::new(),
        random: SplitMix64::stream(0x006d_6f64_616c, slice.before as u64),
    };
    krylov.begin();
    let mut next_check = 2 * slice.count + 6 * BLOCK;
    let mut found = 0;
    while krylov.projected.len() < n {
        let first = krylov.projected.len();
        let mut images = krylov.images(first);
        let scale: Vec<f64> = (0..images.count())
            .map(|k| dot(images.column(k), images.column(k)).sqrt())
            .collect();
        let along = krylov.remove(&mut images);
        for k in 0..along.ncols() {
            krylov
                .projected
                .push((0..along.nrows()).map(|row| along[(row, k)]).collect());
        }
        let size = krylov.projected.len();
        let norms = krylov.append(images, &scale);
        if krylov.basis.count() == size && size < n {
            krylov.begin();
        }
        if size < next_check.min(n) {
            continue;
        }
        next_check = size + slice.count / 3 + 2 * BLOCK;
        let Some((values, weights)) = krylov.ritz() else {
            continue;
        };
        let converged: Vec<usize> = (0..size)
            .filter(|&k| {
                let lambda = shift + 1.0 / values[k];
                let last = norms.iter().enumerate();
                let left: f64 = last.map(|(i, norm)| (weights[(first + i, k)] * norm).abs()).sum();
                lambda > low && lambda <= high && left <= CONVERGED * values[k].abs()
            })
            .collect();
        found = converged.len();
        if found == slice.count {
            return Ok(chosen(&krylov.basis, (&values, &weights, shift), converged));
        }
    }
    Err(EigenError::Missing {
        found,
        expected: slice.count,
        low,
        high,
    })
}

/// `y −= α x`.
fn subtract(alpha: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= alpha * x;
    }
}

/// The converged eigenvectors by ascending eigenvalue.
fn chosen(
    basis: &Columns,
    (values, weights, shift): (&[f64], &Mat<f64>, f64),
    mut converged: Vec<usize>,
) -> Eigenpairs {
    let lambda = |k: &usize| shift + 1.0 / values[*k];
    converged.sort_by(|a, b| lambda(a).total_cmp(&lambda(b)));
    let size = weights.nrows();
    let weights = Mat::from_fn(size, converged.len(), |row, k| weights[(row, converged[k])]);
    let mut found = Columns {
        rows: basis.rows,
        values: vec![0.0; basis.rows * converged.len()],
    };
    let basis = basis.view().get(.., ..size);
    matmul(found.view_mut(), Accum::Replace, basis, weights.as_ref(), 1.0, Par::Seq);
    Eigenpairs {
        values: converged.iter().map(lambda).collect(),
        vectors: (0..converged.len()).map(|k| found.column(k).to_vec()).collect(),
    }
}
