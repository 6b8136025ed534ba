//! Solutions with a factored matrix plus low-rank terms.
use crate::Updates;
use crate::matrix::IterationMatrix;

/// Solves `(A₀ + U C Uᵀ) x = b` by the Sherman–Morrison–Woodbury formula
///
/// ```text
/// x = y − Y (I + C UᵀY)⁻¹ C Uᵀ y,    y = A₀⁻¹ b,    Y = A₀⁻¹ U
/// ```
///
/// and keeps the columns of `Y` as long as their rows do not change.
#[derive(Debug, Default)]
pub(crate) struct Woodbury {
    /// Sorted by key.
    columns: Vec<Column>,
    /// For each row of the updates its place in `columns`.
    places: Vec<usize>,
    system: Vec<f64>,
    right_side: Vec<f64>,
    gram: Vec<f64>,
    scratch: Vec<f64>,
    /// Solutions computed, for the work counters.
    pub solves: u64,
}

#[derive(Debug)]
struct Column {
    key: u64,
    version: Option<u64>,
    y: Vec<f64>,
}

impl Woodbury {
    /// Forgets all kept columns: the matrix was factored anew, or a state was restored.
    pub fn clear(&mut self) {
        for column in &mut self.columns {
            column.version = None;
        }
    }

    /// Solves; returns false where the updated matrix is singular.
    pub fn solve(&mut self, matrix: &mut IterationMatrix, updates: &Updates, b: &[f64], x: &mut [f64]) -> bool {
        matrix.solve(b, x);
        self.solves += 1;
        let rank = updates.rank();
        if rank == 0 {
            return true;
        }
        self.refresh(matrix, updates, b.len());
        self.gram.resize(rank * rank, 0.0);
        self.right_side.resize(rank, 0.0);
        self.system.resize(rank * rank, 0.0);
        self.scratch.resize(rank, 0.0);
        for i in 0..rank {
            for j in 0..rank {
                self.gram[i * rank + j] = dot(updates, i, &self.columns[self.places[j]].y);
            }
            self.scratch[i] = dot(updates, i, x);
        }
        // (I + C G) z = C Uᵀ y
        self.system.fill(0.0);
        for core in &updates.cores {
            let c = &updates.core_values[core.start..core.start + core.size * core.size];
            for i in 0..core.size {
                let row = core.first_row + i;
                let mut sum = 0.0;
                for k in 0..core.size {
                    let value = c[i * core.size + k];
                    let inner = core.first_row + k;
                    sum += value * self.scratch[inner];
                    for j in 0..rank {
                        self.system[row * rank + j] += value * self.gram[inner * rank + j];
                    }
                }
                self.right_side[row] = sum;
            }
        }
        for i in 0..rank {
            self.system[i * rank + i] += 1.0;
        }
        if !solve_dense(&mut self.system, &mut self.right_side, rank) {
            return false;
        }
        for (&place, &z) in self.places.iter().zip(&self.right_side) {
            if z != 0.0 {
                for (target, y) in x.iter_mut().zip(&self.columns[place].y) {
                    *target -= z * y;
                }
            }
        }
        true
    }

    fn refresh(&mut self, matrix: &mut IterationMatrix, updates: &Updates, size: usize) {
        self.places.clear();
        for row in &updates.rows {
            if let Err(place) = self.columns.binary_search_by_key(&row.key, |column| column.key) {
                let column = Column {
                    key: row.key,
                    version: None,
                    y: vec![0.0; size],
                };
                self.columns.insert(place, column);
            }
        }
        for row in &updates.rows {
            let place = self
                .columns
                .binary_search_by_key(&row.key, |column| column.key)
                .expect("inserted above");
            self.places.push(place);
            if self.columns[place].version == Some(row.version) {
                continue;
            }
            self.scratch.resize(size, 0.0);
            self.scratch.fill(0.0);
            for k in row.start..row.end {
                self.scratch[updates.indices[k]] += updates.values[k];
            }
            let column = &mut self.columns[place];
            matrix.solve(&self.scratch, &mut column.y);
            column.version = Some(row.version);
            self.solves += 1;
        }
    }
}

fn dot(updates: &Updates, row: usize, x: &[f64]) -> f64 {
    let row = updates.rows[row];
    (row.start..row.end)
        .map(|k| updates.values[k] * x[updates.indices[k]])
        .sum()
}

/// Gaussian elimination with partial pivoting on a small dense matrix (row by row); false where it is singular.
fn solve_dense(a: &mut [f64], b: &mut [f64], n: usize) -> bool {
    for column in 0..n {
        let pivot = (column..n)
            .max_by(|&i, &j| a[i * n + column].abs().total_cmp(&a[j * n + column].abs()))
            .expect("the range is not empty");
        if a[pivot * n + column] == 0.0 || !a[pivot * n + column].is_finite() {
            return false;
        }
        if pivot != column {
            for k in 0..n {
                a.swap(pivot * n + k, column * n + k);
            }
            b.swap(pivot, column);
        }
        for row in column + 1..n {
            let factor = a[row * n + column] / a[column * n + column];
            if factor != 0.0 {
                for k in column..n {
                    a[row * n + k] -= factor * a[column * n + k];
                }
                b[row] -= factor * b[column];
            }
        }
    }
    for row in (0..n).rev() {
        let sum: f64 = (row + 1..n).map(|k| a[row * n + k] * b[k]).sum();
        b[row] = (b[row] - sum) / a[row * n + row];
    }
    true
}
