//! Dense blocks that go to fixed places of a sparse matrix.

/// Marks an entry whose row or column is held fixed.
const SKIPPED: u32 = u32::MAX;

/// Where contributions put dense blocks: the first pass records which entries exist, later passes add values in the same
/// order without any search.
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
    pub fn mark(rows: &'a mut [bool]) -> Self {
        Self::to(Target::Mark(rows))
    }

    /// Adds up the diagonal.
    pub fn trace(sum: &'a mut f64) -> Self {
        Self::to(Target::Trace(sum))
    }

    /// Adds to `values`; `places[i]` is the position of the i-th recorded entry, see [`Blocks::skipped`].
    pub fn add_to(places: &'a [u32], values: &'a mut [f64]) -> Self {
        Self::to(Target::Add {
            places,
            cursor: 0,
            values,
        })
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
    #[must_use]
    pub const fn skipped() -> u32 {
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
                let entries = rows.iter().flat_map(|row| columns.iter().map(move |column| row == column));
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
