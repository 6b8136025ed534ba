//! Solutions with a factored matrix plus low-rank terms.
use crate::Updates;
use crate::linear::dense_lu::Lu;
use crate::linear::iteration_matrix::{IterationMatrix, UnknownLocations};
use crate::linear::part::{Part, PartColumn, Thresholds};
use std::ops::Range;

/// Solves `(A + U C Uᵀ) x = b` by the Sherman–Morrison–Woodbury formula in the form
///
/// ```text
/// (I + C UᵀY) z = C Uᵀ A⁻¹ b,    x = A⁻¹ (b − U z),    Y = A⁻¹ U
/// ```
///
/// in which `z` are the forces of the low-rank terms. A symmetric `A` has `Uᵀ A⁻¹ b = Yᵀ b`, so that there is one
/// solution, and it reaches no further than its right side. Columns of `Y` are kept as long as their rows do not
/// change.
#[derive(Debug, Default)]
pub(crate) struct Woodbury {
    columns: Vec<KeptColumn>,
    /// UnknownLocations in `columns`, sorted by key.
    by_key: Vec<usize>,
    /// For each row of the updates its position in `columns`.
    places: Vec<usize>,
    /// `uᵢ · yⱼ` of columns `i` and `j`.
    gram: Vec<Vec<Product>>,
    lu: Lu,
    /// Content of `lu`: rows and coefficients.
    rows: Vec<(u64, u64)>,
    coefficients: Vec<f64>,
    products: Vec<f64>,
    z: Vec<f64>,
    /// Solutions computed, for the work counters.
    pub solves: u64,
}

#[derive(Debug)]
struct KeptColumn {
    key: u64,
    version: Option<u64>,
    /// Number of solutions for it.
    turn: u64,
    shares: Vec<Share>,
}

/// A product of two columns, valid as long as the sum of their turns does not change.
#[derive(Clone, Copy, Debug)]
struct Product {
    turns: u64,
    value: f64,
}

impl Product {
    const NONE: Self = Self {
        turns: u64::MAX,
        value: f64::NAN,
    };
}

/// Share of a column in one part.
#[derive(Debug)]
struct Share {
    /// Number of the part.
    part: usize,
    /// Entries of `u`: unknown of the part, value.
    u: Vec<(usize, f64)>,
    y: PartColumn,
}

impl Woodbury {
    /// Forgets all kept columns: call it after a new factorisation, or when a state was restored.
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

    /// Solves; `x` must hold the last solution, or zeros, and becomes zero if nothing is above the thresholds.
    /// `changed` sees the ranges of unknowns with a solution and of those whose equations it enters. Returns `false` if
    /// the updated matrix is singular or a solution is not finite.
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
        let mut regular = updates.rank() == 0 || self.update(parts, updates);
        for part in parts {
            regular &= part.solve(thresholds, x, changed);
        }
        regular
    }

    /// Takes the forces of the low-rank terms out of the loaded right side.
    fn update(&mut self, parts: &mut [Part], updates: &Updates) -> bool {
        self.products.clear();
        for &place in &self.places {
            let shares = self.columns[place].shares.iter();
            let product = shares.map(|Share { part, u, y }| parts[*part].product(y, u));
            self.products.push(product.sum());
        }
        if !self.factor(parts, updates) {
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
        for (&place, &z) in self.places.iter().zip(&self.z) {
            if z != 0.0 {
                for Share { part, u, y } in &self.columns[place].shares {
                    parts[*part].subtract(z, y, u);
                }
            }
        }
        true
    }

    /// Factors `I + C G`, unless it is the matrix factored last.
    fn factor(&mut self, parts: &[Part], updates: &Updates) -> bool {
        let rank = updates.rank();
        let rows = || updates.rows.iter().map(|row| (row.key, row.version));
        if self.rows.iter().copied().eq(rows()) && self.coefficients == updates.core_values {
            return true;
        }
        self.rows.clear();
        for i in 0..rank {
            for j in 0..rank {
                let (left, right) = (self.places[i], self.places[j]);
                let turns = self.columns[left].turn + self.columns[right].turn;
                if self.gram[left][right].turns != turns {
                    let mut value = 0.0;
                    for Share { part, u, .. } in &self.columns[left].shares {
                        let other = self.columns[right].shares.iter().find(|share| share.part == *part);
                        if let Some(Share { y, .. }) = other {
                            let own = u.iter().map(|&(unknown, value)| value * parts[*part].entry(y, unknown));
                            value += own.sum::<f64>();
                        }
                    }
                    self.gram[left][right] = Product { turns, value };
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
                        *target += c[i * core.size + k] * gram[place].value;
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
    fn refresh(&mut self, parts: &mut [Part], places: &UnknownLocations, updates: &Updates) {
        self.places.clear();
        for &identity in &updates.rows {
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
            let KeptColumn {
                version, turn, shares, ..
            } = &mut self.columns[place];
            // A column that no longer reaches a part keeps its memory there for later.
            shares.iter_mut().for_each(|share| share.u.clear());
            for k in identity.start..identity.end {
                let Some((number, unknown)) = places.of(updates.indices[k]) else {
                    continue;
                };
                let at = shares.iter().position(|share| share.part == number);
                let at = at.unwrap_or_else(|| {
                    shares.push(Share {
                        part: number,
                        u: Vec::new(),
                        y: parts[number].new_column(),
                    });
                    shares.len() - 1
                });
                shares[at].u.push((unknown, updates.values[k]));
            }
            for Share { part, u, y } in shares {
                parts[*part].column(u, y);
            }
            *version = Some(identity.version);
            *turn += 1;
            self.solves += 1;
        }
    }

    /// Adds a column whose key belongs at position `at` of the sorted keys.
    fn insert(&mut self, at: usize, key: u64) -> usize {
        let place = self.columns.len();
        self.columns.push(KeptColumn {
            key,
            version: None,
            turn: 0,
            shares: Vec::new(),
        });
        self.by_key.insert(at, place);
        self.gram.iter_mut().for_each(|gram| gram.push(Product::NONE));
        self.gram.push(vec![Product::NONE; place + 1]);
        place
    }
}
