//! Dense blocks that go to fixed places of a sparse matrix.
use nalgebra::DMatrix;

/// Marks an entry whose row or column is held fixed.
const SKIPPED: u32 = u32::MAX;

/// Sink of the dense blocks of contributions: the first pass records which entries exist, later passes add values in
/// the same order without any search.
pub struct Blocks<'a> {
    target: Target<'a>,
    /// Multiplies all values.
    factor: f64,
}

enum Target<'a> {
    Record(&'a mut Vec<(u32, u32)>),
    Mark(&'a mut [bool]),
    Trace(&'a mut f64),
    Add {
        places: &'a [u32],
        cursor: usize,
        values: &'a mut [f64],
    },
}

impl<'a> Blocks<'a> {
    /// Records the places of all blocks as (row, column), in call order.
    pub fn record(places: &'a mut Vec<(u32, u32)>) -> Self {
        Self::to(Target::Record(places))
    }

    /// Marks the rows of all blocks.
    pub(crate) fn mark(rows: &'a mut [bool]) -> Self {
        Self::to(Target::Mark(rows))
    }

    /// Adds up the diagonal.
    pub(crate) fn trace(sum: &'a mut f64) -> Self {
        Self::to(Target::Trace(sum))
    }

    /// Adds to `values`; `places[i]` is the position of the i-th recorded entry, see `Blocks::skipped`.
    pub fn add_to(places: &'a [u32], values: &'a mut [f64]) -> Self {
        Self::to(Target::Add {
            places,
            cursor: 0,
            values,
        })
    }

    /// All entries (row, column, value) of what `add` adds, in call order; it is called twice.
    pub fn collect(mut add: impl FnMut(&mut Blocks<'_>)) -> Vec<(u32, u32, f64)> {
        let mut places = Vec::new();
        add(&mut Blocks::record(&mut places));
        let order: Vec<u32> = (0..places.len() as u32).collect();
        let mut values = vec![0.0; places.len()];
        add(&mut Blocks::add_to(&order, &mut values));
        let entries = places.into_iter().zip(values);
        entries.map(|((row, column), value)| (row, column, value)).collect()
    }

    fn to(target: Target<'a>) -> Self {
        Self { target, factor: 1.0 }
    }

    /// Multiplies the values of all that `add` adds by `factor`.
    pub fn weigh(&mut self, factor: f64, add: impl FnOnce(&mut Self)) {
        let before = self.factor;
        self.factor *= factor;
        add(self);
        self.factor = before;
    }

    /// The place of an entry that is dropped.
    pub(crate) const fn skipped() -> u32 {
        SKIPPED
    }

    /// Number of entries added so far, to compare with the number recorded.
    #[must_use]
    pub fn entries(&self) -> usize {
        match &self.target {
            Target::Record(places) => places.len(),
            Target::Mark(_) | Target::Trace(_) => 0,
            Target::Add { cursor, .. } => *cursor,
        }
    }

    /// Adds a dense block: `values` row by row, `rows.len() × columns.len()` entries.
    pub fn add(&mut self, rows: &[usize], columns: &[usize], values: &[f64]) {
        debug_assert_eq!(rows.len() * columns.len(), values.len());
        match &mut self.target {
            Target::Record(places) => {
                for &row in rows {
                    places.extend(columns.iter().map(|&column| (row as u32, column as u32)));
                }
            }
            Target::Mark(marked) => rows.iter().for_each(|&row| marked[row] = true),
            Target::Trace(sum) => {
                let entries = rows
                    .iter()
                    .flat_map(|row| columns.iter().map(move |column| row == column));
                let diagonal = entries.zip(values).filter(|(is_diagonal, _)| *is_diagonal);
                **sum += self.factor * diagonal.map(|(_, value)| value).sum::<f64>();
            }
            Target::Add {
                places,
                cursor,
                values: target,
            } => {
                for (value, &place) in values.iter().zip(&places[*cursor..]) {
                    if place != SKIPPED {
                        target[place as usize] += self.factor * value;
                    }
                }
                *cursor += values.len();
            }
        }
    }
}

/// A dense matrix of `n` rows from the blocks of `add`, which is called twice.
pub fn dense(n: usize, add: &mut dyn FnMut(&mut Blocks<'_>)) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    for (row, column, value) in Blocks::collect(add) {
        matrix[(row as usize, column as usize)] += value;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stiffness between two coordinates and, weighed, a mass with a row that no column of its block belongs to.
    fn add(blocks: &mut Blocks<'_>) {
        blocks.add(&[0, 1], &[0, 1], &[2.0, -2.0, -2.0, 2.0]);
        blocks.weigh(10.0, |blocks| {
            blocks.add(&[1, 2], &[1], &[0.5, 0.25]);
            blocks.weigh(3.0, |blocks| blocks.add(&[2], &[2], &[1.0]));
            blocks.add(&[2], &[], &[]);
        });
        blocks.add(&[2], &[2], &[7.0]);
    }

    #[test]
    fn weights_multiply_and_end_with_what_they_weigh() {
        let (places, values): (Vec<_>, Vec<_>) = (Blocks::collect(add).into_iter())
            .map(|(row, column, value)| ((row, column), value))
            .unzip();
        assert_eq!(places, [(0, 0), (0, 1), (1, 0), (1, 1), (1, 1), (2, 1), (2, 2), (2, 2)]);
        assert_eq!(values, [2.0, -2.0, -2.0, 2.0, 5.0, 2.5, 30.0, 7.0]);
    }

    #[test]
    fn a_trace_is_the_sum_of_the_diagonal() {
        let mut sum = 0.0;
        add(&mut Blocks::trace(&mut sum));
        assert_eq!(sum, 2.0 + 2.0 + 5.0 + 30.0 + 7.0);
    }
}
