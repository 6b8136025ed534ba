//! Low-rank terms on top of a factored matrix.

/// Entry of the factored matrix on the diagonal of the multiplier of a constraint that moves.
pub(crate) const PLACEHOLDER: f64 = 1.0;

/// One row `u` of a low-rank term.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UpdateRow {
    /// Contribution and slot; with `version` the identity of the row's values.
    pub key: u64,
    /// Changes when the values of the row with this key change.
    pub version: u64,
    pub start: usize,
    pub end: usize,
}

/// A small dense matrix `C` that couples consecutive rows: the term is `U C Uᵀ`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UpdateCore {
    pub first_row: usize,
    pub size: usize,
    pub start: usize,
}

/// Collects the terms `U C Uᵀ` that are added to the factored matrix: moving contact, switched droppers.
///
/// A term is recognised by its `key` (unique within the system: see `Updates::set_owner`) and `version`: as long as
/// both stay the same, the solver keeps `A₀⁻¹ u` and does not solve again.
#[derive(Debug, Default)]
pub struct Updates {
    owner: u64,
    coordinates: usize,
    scale: f64,
    rate_weight: f64,
    multipliers: Vec<f64>,
    borders: usize,
    pub(crate) rows: Vec<UpdateRow>,
    pub(crate) indices: Vec<usize>,
    pub(crate) values: Vec<f64>,
    pub(crate) cores: Vec<UpdateCore>,
    pub(crate) core_values: Vec<f64>,
}

impl Updates {
    /// Forgets all terms, keeping the memory.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.indices.clear();
        self.values.clear();
        self.cores.clear();
        self.core_values.clear();
        self.borders = 0;
    }

    /// Sets the contribution that pushes next; the system calls it.
    pub(crate) fn set_owner(&mut self, owner: usize) {
        self.owner = (owner as u64) << 32;
    }

    /// Number of rows, the rank of all terms together.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rows.len()
    }

    /// Adds `coefficient · u uᵀ`; `entries` are the non-zero entries (index, value) of `u`, `slot` numbers the
    /// contribution's own rows.
    pub fn rank_one(&mut self, slot: u32, version: u64, coefficient: f64, entries: impl Iterator<Item = (usize, f64)>) {
        let first_row = self.rows.len();
        self.row(slot, version, entries);
        self.core(first_row, 1, &[coefficient]);
    }

    /// Sets the number of coordinates before the multipliers, the scale of constraint rows in the factored matrix, and
    /// the weight of rates of constraints that move, s.
    pub(crate) fn set_borders(&mut self, coordinates: usize, scale: f64, rate_weight: f64) {
        self.coordinates = coordinates;
        self.scale = scale;
        self.rate_weight = rate_weight;
    }

    /// Returns `true` if a border was pushed.
    pub(crate) fn has_borders(&self) -> bool {
        self.borders > 0
    }

    /// Takes over the multipliers at the present iterate.
    pub(crate) fn set_multipliers(&mut self, lambda: &[f64]) {
        self.multipliers.clear();
        self.multipliers.extend_from_slice(lambda);
    }

    /// The multiplier with this number at the present iterate, for the geometric stiffness of its constraint, N.
    #[must_use]
    pub fn multiplier(&self, number: usize) -> f64 {
        self.multipliers[number]
    }

    /// Adds row and column of a constraint that [`crate::Constraint::moves`] as the border of the matrix that belongs
    /// to the `multiplier` with this number; takes three slots. `entries` are index, `g_q` and `∂ġ/∂q` (1/s) if one of
    /// these is not zero.
    ///
    /// The column is `u = g_q`, the row `w = g_q + τ ∂ġ/∂q`, with `τ` the weight of rates in a time step. The factored
    /// matrix has `PLACEHOLDER` on the diagonal of that multiplier and nothing else in its row. With the unit vector
    /// `e` of the multiplier the term is `s (u eᵀ + e wᵀ) − PLACEHOLDER e eᵀ`, `s` the scale of constraint rows, and
    /// the low-rank formula becomes the elimination of a bordered matrix, with the divisor `s² wᵀ A⁻¹ u`.
    pub fn border(
        &mut self,
        first_slot: u32,
        version: u64,
        multiplier: usize,
        entries: impl Iterator<Item = (usize, f64, f64)> + Clone,
    ) {
        self.borders += 1;
        let (first_row, s, weight) = (self.rows.len(), self.scale, self.rate_weight);
        let column = entries.clone().map(|(index, direction, _)| (index, direction));
        self.row(first_slot, version, column);
        let row = entries.map(|(index, direction, of_rate)| (index, direction + weight * of_rate));
        self.row(first_slot + 1, version, row);
        let unknown = self.coordinates + multiplier;
        self.row(first_slot + 2, unknown as u64, std::iter::once((unknown, 1.0)));
        self.core(first_row, 3, &[0.0, 0.0, s, 0.0, 0.0, 0.0, 0.0, s, -PLACEHOLDER]);
    }

    /// Adds the dense matrix `matrix` (row by row) on the coordinates `indices`.
    pub fn dense(&mut self, first_slot: u32, indices: &[usize], matrix: &[f64]) {
        let first_row = self.rows.len();
        for (i, &index) in indices.iter().enumerate() {
            // The row is a unit vector: its index is its version.
            self.row(first_slot + i as u32, index as u64, std::iter::once((index, 1.0)));
        }
        self.core(first_row, indices.len(), matrix);
    }

    /// Non-zero entries (index, value) of a row.
    pub(crate) fn entries(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let UpdateRow { start, end, .. } = self.rows[row];
        (start..end).map(|i| (self.indices[i], self.values[i]))
    }

    /// Adds all terms to a dense matrix of `size` rows (row by row); for tests of contributions.
    pub fn add_to_dense(&self, size: usize, matrix: &mut [f64]) {
        for core in &self.cores {
            for a in 0..core.size {
                for b in 0..core.size {
                    let coefficient = self.core_values[core.start + a * core.size + b];
                    for (i, left) in self.entries(core.first_row + a) {
                        for (j, right) in self.entries(core.first_row + b) {
                            matrix[i * size + j] += coefficient * left * right;
                        }
                    }
                }
            }
        }
    }

    fn row(&mut self, slot: u32, version: u64, entries: impl Iterator<Item = (usize, f64)>) {
        let start = self.indices.len();
        for (index, value) in entries {
            self.indices.push(index);
            self.values.push(value);
        }
        self.rows.push(UpdateRow {
            key: self.owner | u64::from(slot),
            version,
            start,
            end: self.indices.len(),
        });
    }

    fn core(&mut self, first_row: usize, size: usize, values: &[f64]) {
        debug_assert_eq!(size * size, values.len());
        self.cores.push(UpdateCore {
            first_row,
            size,
            start: self.core_values.len(),
        });
        self.core_values.extend_from_slice(values);
    }
}
