//! Which entries the iteration matrix has, and which unknowns hang together.

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
    /// The pattern of `entries` (row, column) on the unknowns that are `free`; each of these has an entry on the diagonal.
    pub fn new(free: &[bool], entries: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let size = free.len();
        let diagonal = (0..size as u32).filter(|&i| free[i as usize]).map(|i| (i, i));
        let entries = entries.chain(diagonal);
        let mut links = Links::new(size);
        let mut counted = vec![0; size + 1];
        for (row, column) in entries.clone() {
            links.join(row as usize, column as usize);
            counted[column as usize + 1] += 1;
        }
        for column in 0..size {
            counted[column + 1] += counted[column];
        }
        let mut all = vec![0; counted[size]];
        let mut next = counted.clone();
        for (row, column) in entries {
            all[next[column as usize]] = row;
            next[column as usize] += 1;
        }
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in 0..size {
            let of_column = &mut all[counted[column]..counted[column + 1]];
            of_column.sort_unstable();
            let before = rows.len();
            for &row in of_column.iter() {
                if rows[before..].last() != Some(&row) {
                    rows.push(row);
                }
            }
            starts.push(rows.len());
        }
        let mut sets: Vec<Vec<usize>> = Vec::new();
        let mut set_of = vec![usize::MAX; size];
        for unknown in (0..size).filter(|&i| free[i]) {
            let root = links.root(unknown);
            if root == unknown {
                set_of[root] = sets.len();
                sets.push(Vec::new());
            }
            sets[set_of[root]].push(unknown);
        }
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

    /// Number of an entry of the pattern.
    ///
    /// # Panics
    /// When it is none.
    pub fn place(&self, row: u32, column: u32) -> u32 {
        let rows = self.column(column as usize);
        let within = rows.binary_search(&row).expect("every entry was put into the pattern");
        self.firsts[column as usize] + within as u32
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
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for (place, (row, column)) in order.into_iter().enumerate() {
            assert_eq!(pattern.place(row, column), place as u32, "{row}, {column}");
        }
        assert_eq!(pattern.len(), order.len());
    }
}
