//! Entries of the iteration matrix, and the sets of unknowns that they couple.

/// The entries of a symmetric pattern: columns with ascending rows, ordered by sets of coupled unknowns.
pub(crate) struct Pattern {
    /// Rows of column `j` are `rows[starts[j]..starts[j + 1]]`.
    starts: Vec<usize>,
    rows: Vec<u32>,
    /// Number of the first entry of each column when the sets follow one another.
    firsts: Vec<u32>,
    /// The unknowns of each set, ascending; sets in the order of their smallest unknowns.
    pub sets: Vec<Vec<usize>>,
}

impl Pattern {
    /// The pattern of `entries` (row, column) on the unknowns that are `free`; each of these has an entry on the
    /// diagonal.
    pub fn new(free: &[bool], entries: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let size = free.len();
        let diagonal = (0..size as u32).filter(|&i| free[i as usize]).map(|i| (i, i));
        let entries = entries.chain(diagonal);
        let mut links = Links::new(size);
        let (mut in_row, mut in_column) = (vec![0; size + 1], vec![0; size + 1]);
        // `for_each`, not `for`: a chain of iterators is then not asked at every entry which of its links is next.
        entries.clone().for_each(|(row, column)| {
            if row > column {
                links.join(row as usize, column as usize);
            }
            in_row[row as usize + 1] += 1;
            in_column[column as usize + 1] += 1;
        });
        for counted in [&mut in_row, &mut in_column] {
            for i in 0..size {
                counted[i + 1] += counted[i];
            }
        }
        // Sorted by row, then by column with the rows in their order: no comparison of entries.
        let mut columns = vec![0; in_row[size]];
        let mut next = in_row.clone();
        entries.for_each(|(row, column)| {
            columns[next[row as usize]] = column;
            next[row as usize] += 1;
        });
        let mut all = vec![0; in_column[size]];
        let mut ends = in_column.clone();
        for row in 0..size {
            for &column in &columns[in_row[row]..in_row[row + 1]] {
                let (first, end) = (in_column[column as usize], &mut ends[column as usize]);
                if *end == first || all[*end - 1] != row as u32 {
                    all[*end] = row as u32;
                    *end += 1;
                }
            }
        }
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(all.len()));
        for column in 0..size {
            rows.extend_from_slice(&all[in_column[column]..ends[column]]);
            starts.push(rows.len());
        }
        let sets = links.sets(free);
        let mut firsts = vec![0; size];
        let mut first = 0;
        for &column in sets.iter().flatten() {
            firsts[column] = first;
            first += (starts[column + 1] - starts[column]) as u32;
        }
        Self {
            starts,
            rows,
            firsts,
            sets,
        }
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Rows of a column, ascending.
    pub fn column(&self, column: usize) -> &[u32] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }

    /// Finds the numbers of entries.
    pub fn finder(&self) -> Finder<'_> {
        Finder {
            pattern: self,
            next: vec![0; self.starts.len()],
        }
    }
}

/// Finds entries of a pattern: at once if those of each column come in their order, as in a dense block row by row.
pub(crate) struct Finder<'a> {
    pattern: &'a Pattern,
    /// Behind the last entry found of each column.
    next: Vec<u32>,
}

impl Finder<'_> {
    /// Number of an entry of the pattern.
    ///
    /// # Panics
    /// When it is none.
    pub fn place(&mut self, row: u32, column: u32) -> u32 {
        let rows = self.pattern.column(column as usize);
        let next = &mut self.next[column as usize];
        if rows.get(*next as usize) != Some(&row) {
            *next = rows.binary_search(&row).expect("every entry was put into the pattern") as u32;
        }
        *next += 1;
        self.pattern.firsts[column as usize] + *next - 1
    }
}

/// Union of coupled unknowns; the root of a set is its smallest member.
struct Links {
    parent: Vec<usize>,
}

impl Links {
    fn new(size: usize) -> Self {
        Self {
            parent: (0..size).collect(),
        }
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        let (low, high) = (i.min(j), i.max(j));
        self.parent[high] = low;
    }

    /// The sets of the unknowns that are `free`, each ascending, in the order of their smallest ones.
    fn sets(&mut self, free: &[bool]) -> Vec<Vec<usize>> {
        let mut sets: Vec<Vec<usize>> = Vec::new();
        let mut set_of = vec![usize::MAX; free.len()];
        for unknown in (0..free.len()).filter(|&i| free[i]) {
            let root = self.root(unknown);
            if root == unknown {
                set_of[root] = sets.len();
                sets.push(Vec::new());
            }
            sets[set_of[root]].push(unknown);
        }
        sets
    }
}

/// Sets of the unknowns that are `free`, each ascending, that no entry (row, column) of a symmetric matrix couples to
/// one another.
#[must_use]
pub fn uncoupled(free: &[bool], entries: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut links = Links::new(free.len());
    entries
        .filter(|&(row, column)| row > column && free[row] && free[column])
        .for_each(|(row, column)| links.join(row, column));
    links.sets(free)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_chains_are_two_sets_and_what_is_not_free_divides() {
        let entries = [(2, 0), (3, 1), (4, 2), (5, 3), (2, 4)];
        let sets = |free: [bool; 6]| uncoupled(&free, entries.into_iter());
        assert_eq!(sets([true; 6]), [vec![0, 2, 4], vec![1, 3, 5]]);
        let without = [true, true, false, true, true, true];
        assert_eq!(sets(without), [vec![0], vec![1, 3, 5], vec![4]]);
    }

    #[test]
    fn sets_are_what_hangs_together_and_entries_are_numbered_set_by_set() {
        // 0–2–5 and 1–4; 3 is held fixed and would couple them.
        let free = [true, true, true, false, true, true];
        let entries = [(2, 0), (0, 2), (5, 2), (2, 5), (1, 4), (4, 1), (4, 1)];
        let pattern = Pattern::new(&free, entries.into_iter());
        assert_eq!(pattern.sets, [vec![0, 2, 5], vec![1, 4]]);
        assert_eq!(pattern.column(2), [0, 2, 5]);
        let order = [
            (0, 0),
            (2, 0),
            (0, 2),
            (2, 2),
            (5, 2),
            (2, 5),
            (5, 5),
            (1, 1),
            (4, 1),
            (1, 4),
            (4, 4),
        ];
        let mut finder = pattern.finder();
        for (place, (row, column)) in order.into_iter().enumerate() {
            assert_eq!(finder.place(row, column), place as u32, "{row}, {column}");
        }
        for (place, (row, column)) in order.into_iter().enumerate().rev() {
            assert_eq!(finder.place(row, column), place as u32, "backwards: {row}, {column}");
        }
        assert_eq!(pattern.len(), order.len());
    }
}
