//! Solutions with a factored matrix plus low-rank terms.
use crate::Updates;
use crate::lu::Lu;
use crate::matrix::{IterationMatrix, Places};
use crate::part::{Part, Piece, Thresholds};
use std::ops::Range;

/// Solves `(A + U C Uᵀ) x = b` by the Sherman–Morrison–Woodbury formula in the form
///
/// ```text
/// (I + C UᵀY) z = C Uᵀ A⁻¹ b,    x = A⁻¹ (b − U z),    Y = A⁻¹ U
/// ```
///
/// in which `z` are the forces of the low-rank terms. With a symmetric `A` one has `Uᵀ A⁻¹ b = Yᵀ b`, so that there is one solution,
/// and it reaches no further than its right side. Columns of `Y` are kept as long as their rows do not change.
#[derive(Debug, Default)]
pub(crate) struct Woodbury {
    columns: Vec<Column>,
    /// Places in `columns`, sorted by key.
    by_key: Vec<usize>,
    /// For each row of the updates its place in `columns`.
    places: Vec<usize>,
    /// `uᵢ · yⱼ` of columns `i` and `j`; not a number where it has not been computed since one of them changed.
    gram: Vec<Vec<f64>>,
    lu: Lu,
    /// What `lu` was made of: rows and coefficients.
    rows: Vec<(u64, u64)>,
    coefficients: Vec<f64>,
    products: Vec<f64>,
    z: Vec<f64>,
    /// Solutions computed, for the work counters.
    pub solves: u64,
}

#[derive(Debug)]
struct Column {
    key: u64,
    version: Option<u64>,
    /// Number of its part, and the column there.
    pieces: Vec<(usize, Piece)>,
}

/// Entries (local number, value) of a row in one part.
fn entries<'a>(
    places: &'a Places,
    updates: &'a Updates,
    row: usize,
    part: usize,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let row = updates.rows[row];
    (row.start..row.end).filter_map(move |k| {
        let (number, local) = places.of(updates.indices[k])?;
        (number == part).then_some((local, updates.values[k]))
    })
}

impl Woodbury {
    /// Forgets all kept columns: the matrix was factored anew, or a state was restored.
    pub fn clear(&mut self) {
        for column in &mut self.columns {
            column.version = None;
        }
        self.rows.clear();
    }

    /// `z` of the last solution, one per row of its updates.
    pub fn forces(&self) -> &[f64] {
        &self.z
    }

    /// Solves; `x` must be zero and stays so where there is nothing above the thresholds to solve. `changed` sees the ranges of
    /// unknowns with a solution and of those whose equations it enters. Returns false where the updated matrix is singular.
    pub fn solve(
        &mut self,
        matrix: &mut IterationMatrix,
        updates: &Updates,
        b: &[f64],
        thresholds: Thresholds,
        x: &mut [f64],
        changed: &mut dyn FnMut(Range<usize>, Range<usize>),
    ) -> bool {
        let IterationMatrix { parts, places, .. } = matrix;
        self.refresh(parts, places, updates);
        self.solves += 1;
        self.z.clear();
        for part in parts.iter_mut() {
            part.load(b, thresholds);
        }
        let regular = updates.rank() == 0 || self.update(parts, places, updates);
        for part in parts {
            part.solve(thresholds, x, changed);
        }
        regular
    }

    /// Takes the forces of the low-rank terms out of the loaded right side.
    fn update(&mut self, parts: &mut [Part], places: &Places, updates: &Updates) -> bool {
        let rank = updates.rank();
        self.products.clear();
        for row in 0..rank {
            let pieces = self.columns[self.places[row]].pieces.iter();
            let product = pieces.map(|(part, piece)| parts[*part].product(piece, entries(places, updates, row, *part)));
            self.products.push(product.sum());
        }
        if !self.factor(parts, places, updates) {
            return false;
        }
        // (I + C G) z = C Uᵀ A⁻¹ b
        for core in &updates.cores {
            let rows = core.first_row..core.first_row + core.size;
            let c = &updates.core_values[core.start..core.start + core.size * core.size];
            self.z.extend(c.chunks_exact(core.size).map(|c| {
                c.iter()
                    .zip(&self.products[rows.clone()])
                    .map(|(c, s)| c * s)
                    .sum::<f64>()
            }));
        }
        self.lu.solve(&mut self.z);
        for row in 0..rank {
            let z = self.z[row];
            if z != 0.0 {
                for (part, piece) in &self.columns[self.places[row]].pieces {
                    parts[*part].subtract(z, piece, entries(places, updates, row, *part));
                }
            }
        }
        true
    }

    /// Factors `I + C G`, unless it is the matrix factored last.
    fn factor(&mut self, parts: &[Part], places: &Places, updates: &Updates) -> bool {
        let rank = updates.rank();
        let rows = || updates.rows.iter().map(|row| (row.key, row.version));
        if self.rows.iter().copied().eq(rows()) && self.coefficients == updates.core_values {
            return true;
        }
        self.rows.clear();
        for i in 0..rank {
            for j in 0..rank {
                let (left, right) = (self.places[i], self.places[j]);
                if self.gram[left][right].is_nan() {
                    let pieces = self.columns[right].pieces.iter();
                    let product = pieces.map(|(part, piece)| {
                        let own = entries(places, updates, i, *part);
                        own.map(|(unknown, value)| value * parts[*part].entry(piece, unknown))
                            .sum::<f64>()
                    });
                    self.gram[left][right] = product.sum();
                }
            }
        }
        let system = self.lu.matrix(rank);
        for core in &updates.cores {
            let c = &updates.core_values[core.start..core.start + core.size * core.size];
            for i in 0..core.size {
                let row = core.first_row + i;
                let target = &mut system[row * rank..(row + 1) * rank];
                for k in 0..core.size {
                    let gram = &self.gram[self.places[core.first_row + k]];
                    for (target, &place) in target.iter_mut().zip(&self.places) {
                        *target += c[i * core.size + k] * gram[place];
                    }
                }
            }
        }
        (0..rank).for_each(|i| system[i * rank + i] += 1.0);
        if self.lu.factor().is_err() {
            return false;
        }
        self.rows.extend(rows());
        self.coefficients.clone_from(&updates.core_values);
        true
    }

    /// Finds the columns of all rows, and solves for those that have changed.
    fn refresh(&mut self, parts: &mut [Part], places: &Places, updates: &Updates) {
        self.places.clear();
        for (row, &identity) in updates.rows.iter().enumerate() {
            let found = self
                .by_key
                .binary_search_by_key(&identity.key, |&place| self.columns[place].key);
            let place = match found {
                Ok(at) => self.by_key[at],
                Err(at) => self.insert(at, identity.key),
            };
            self.places.push(place);
            if self.columns[place].version == Some(identity.version) {
                continue;
            }
            let column = &mut self.columns[place];
            // A column that no longer reaches a part keeps its memory there for later.
            for (number, part) in parts.iter_mut().enumerate() {
                let at = column.pieces.iter().position(|(of, _)| *of == number);
                let at = match at {
                    Some(at) => at,
                    None if entries(places, updates, row, number).next().is_none() => continue,
                    None => {
                        column.pieces.push((number, part.new_piece()));
                        column.pieces.len() - 1
                    }
                };
                part.column(entries(places, updates, row, number), &mut column.pieces[at].1);
            }
            column.version = Some(identity.version);
            self.solves += 1;
            self.gram[place].fill(f64::NAN);
            self.gram.iter_mut().for_each(|gram| gram[place] = f64::NAN);
        }
    }

    /// Adds a column whose key belongs at place `at` of the sorted keys.
    fn insert(&mut self, at: usize, key: u64) -> usize {
        let place = self.columns.len();
        self.columns.push(Column {
            key,
            version: None,
            pieces: Vec::new(),
        });
        self.by_key.insert(at, place);
        self.gram.iter_mut().for_each(|gram| gram.push(f64::NAN));
        self.gram.push(vec![f64::NAN; place + 1]);
        place
    }
}
