//! Static condensation: unknowns that are coupled with none of their like are eliminated first, at the cost of a
//! division each.
//!
//! ```text
//! S = A_cc − Σ aₗ aₗᵀ/dₗ,    S x_c = b_c − Σ aₗ bₗ/dₗ,    xₗ = (bₗ − aₗᵀ x_c)/dₗ
//! ```
//!
//! The modes of a reduced span are such unknowns: each is coupled with the two supports of its span only, so that the
//! reduced matrix is as long and thin as the line itself.
use crate::linear::buffer::{Buffer, LINE};
use crate::linear::products::{Product, Products, Subtract};
use pulp::Arch;
use std::ops::Range;

/// Fewer condensed unknowns are not worth it.
const FEWEST: usize = 16;

/// The condensed unknowns of a part: its last ones.
pub(crate) struct Condensed {
    /// Number of other unknowns, which come first.
    pub core: usize,
    /// Condensed with the same neighbours.
    groups: Vec<CondensedGroup>,
    neighbours: Vec<u32>,
    /// Positions of the couplings and of the diagonal entry of each condensed unknown among the values of the part.
    couplings: Vec<u32>,
    diagonals: Vec<u32>,
    /// Values of the part that are entries of the reduced matrix too, and their positions there.
    kept: Vec<(u32, u32)>,
    /// Per group, row by row, positions of `a aᵀ`.
    fill: Vec<u32>,
    reduced: Vec<f64>,
    /// `a` of the last factors, for each group neighbour by neighbour, each filled up with zeros to whole cache lines,
    /// and `1/d`. Groups with equal coefficients read those of the first of them: spans that are alike stay in the
    /// first cache.
    coefficients: Buffer,
    inverses: Vec<f64>,
    /// `b` of the condensed unknowns in the loaded right side.
    pub loaded: Vec<f64>,
    /// Buffers: one number per neighbour of a group, and one per condensed unknown, filled up likewise.
    scratch: Vec<f64>,
    forces: Buffer,
    arch: Arch,
}

/// Consecutive condensed unknowns with the same neighbours, as the modes of one span.
#[derive(Debug)]
struct CondensedGroup {
    unknowns: Range<usize>,
    /// Among `neighbours`.
    neighbours: Range<usize>,
    /// First of its couplings.
    couplings: usize,
    /// First of its own coefficients, and of those that it reads.
    place: usize,
    coefficients: usize,
}

impl CondensedGroup {
    /// Numbers per neighbour among the coefficients.
    fn stride(&self) -> usize {
        self.unknowns.len().next_multiple_of(LINE)
    }

    /// Number of its coefficients.
    fn size(&self) -> usize {
        self.neighbours.len() * self.stride()
    }

    /// The coefficients of one neighbour.
    fn row(&self, neighbour: usize) -> Range<usize> {
        let first = self.coefficients + neighbour * self.stride();
        first..first + self.stride()
    }

    /// The coefficients of all neighbours.
    fn rows(&self) -> Range<usize> {
        self.coefficients..self.coefficients + self.size()
    }
}

impl Condensed {
    /// Finds the condensed unknowns in a symmetric pattern in compressed columns (row indices ascending), and the
    /// pattern without them; `None` if there are few.
    pub fn analyse(column_starts: &[usize], row_indices: &[usize]) -> Option<(Self, Vec<usize>, Vec<usize>)> {
        let size = column_starts.len() - 1;
        let column = |c: usize| &row_indices[column_starts[c]..column_starts[c + 1]];
        let core = (0..size)
            .rev()
            .find(|&c| column(c).last().is_some_and(|&row| row > c))
            .map_or(0, |c| c + 1);
        if size - core < FEWEST || core == 0 {
            return None;
        }
        let mut columns: Vec<Vec<usize>> = (0..core)
            .map(|c| column(c).iter().copied().filter(|&row| row < core).collect())
            .collect();
        let (mut groups, mut neighbours): (Vec<CondensedGroup>, Vec<u32>) = (Vec::new(), Vec::new());
        let (mut couplings, mut diagonals) = (Vec::new(), Vec::new());
        let mut before: Option<&[usize]> = None;
        for c in core..size {
            let (last, others) = column(c).split_last()?;
            if *last != c {
                return None;
            }
            let own = c - core;
            match groups.last_mut().filter(|_| before == Some(others)) {
                Some(group) => group.unknowns.end = own + 1,
                None => {
                    for &row in others {
                        columns[row].extend_from_slice(others);
                    }
                    let first = neighbours.len();
                    neighbours.extend(others.iter().map(|&row| row as u32));
                    let place = groups.last().map_or(0, |last| last.place + last.size());
                    groups.push(CondensedGroup {
                        unknowns: own..own + 1,
                        neighbours: first..neighbours.len(),
                        couplings: couplings.len(),
                        place,
                        coefficients: place,
                    });
                    before = Some(others);
                }
            }
            couplings.extend((column_starts[c]..column_starts[c + 1] - 1).map(|place| place as u32));
            diagonals.push(column_starts[c + 1] as u32 - 1);
        }
        for rows in &mut columns {
            rows.sort_unstable();
            rows.dedup();
        }
        let mut reduced_starts = vec![0];
        for rows in &columns {
            reduced_starts.push(reduced_starts[reduced_starts.len() - 1] + rows.len());
        }
        let rows: Vec<usize> = columns.concat();
        let place = |row: usize, c: usize| {
            let of_column = &rows[reduced_starts[c]..reduced_starts[c + 1]];
            of_column
                .binary_search(&row)
                .ok()
                .map(|at| (reduced_starts[c] + at) as u32)
        };
        // Entries that are left of a column are among the reduced ones, both ascending.
        let mut kept = Vec::new();
        for c in 0..core {
            let mut next = reduced_starts[c];
            let places = column_starts[c]..column_starts[c + 1];
            for place in places.take_while(|&place| row_indices[place] < core) {
                while rows[next] != row_indices[place] {
                    next += 1;
                }
                kept.push((place as u32, next as u32));
            }
        }
        let mut fill = Vec::new();
        for group in &groups {
            let around = &neighbours[group.neighbours.clone()];
            for &a in around {
                for &b in around {
                    fill.push(place(a as usize, b as usize)?);
                }
            }
        }
        let widest = groups.iter().map(|group| group.neighbours.len()).max().unwrap_or(0);
        let longest = groups.iter().map(CondensedGroup::stride).max().unwrap_or(0);
        let condensed = Self {
            core,
            coefficients: Buffer::new(groups.last().map_or(0, |last| last.place + last.size())),
            scratch: vec![0.0; widest],
            forces: Buffer::new(longest),
            arch: Arch::new(),
            inverses: vec![0.0; size - core],
            loaded: vec![0.0; size - core],
            reduced: vec![0.0; rows.len()],
            groups,
            neighbours,
            couplings,
            diagonals,
            kept,
            fill,
        };
        Some((condensed, reduced_starts, rows))
    }

    /// The values of the reduced matrix; `None` if a condensed unknown has no positive diagonal entry.
    pub fn reduce(&mut self, values: &[f64]) -> Option<&[f64]> {
        self.reduced.fill(0.0);
        for &(from, to) in &self.kept {
            self.reduced[to as usize] = values[from as usize];
        }
        for i in 0..self.groups.len() {
            let (before, group) = self.groups.split_at_mut(i);
            let group = &mut group[0];
            group.coefficients = group.place;
            let (width, count) = (group.neighbours.len(), group.unknowns.len());
            let couplings = &self.couplings[group.couplings..group.couplings + width * count];
            for (unknown, places) in couplings.chunks_exact(width.max(1)).enumerate() {
                for (neighbour, &place) in places.iter().enumerate() {
                    self.coefficients[group.row(neighbour).start + unknown] = values[place as usize];
                }
            }
            let own = &self.coefficients[group.rows()];
            let same =
                |other: &&CondensedGroup| other.stride() == group.stride() && self.coefficients[other.rows()] == *own;
            if let Some(other) = before.iter().find(same) {
                group.coefficients = other.coefficients;
            }
        }
        for (inverse, &diagonal) in self.inverses.iter_mut().zip(&self.diagonals) {
            let diagonal = values[diagonal as usize];
            // Not a number is not positive either.
            if diagonal.is_nan() || diagonal <= 0.0 {
                return None;
            }
            *inverse = 1.0 / diagonal;
        }
        let mut fill = self.fill.iter();
        for group in &self.groups {
            let width = group.neighbours.len();
            let inverses = &self.inverses[group.unknowns.clone()];
            let scaled = &mut self.forces[..group.stride()];
            scaled.fill(0.0);
            for i in 0..width {
                let row = self.coefficients[group.row(i)].iter().zip(inverses);
                for (scaled, (a, inverse)) in scaled.iter_mut().zip(row) {
                    *scaled = a * inverse;
                }
                for (j, &place) in (0..width).zip(&mut fill) {
                    self.reduced[place as usize] -=
                        self.arch.dispatch(Product(&self.coefficients[group.row(j)], scaled));
                }
            }
        }
        Some(&self.reduced)
    }

    /// Condenses the loaded right side: `add(unknown, value)` adds to that of the other unknowns.
    pub fn eliminate(&mut self, mut add: impl FnMut(usize, f64)) {
        for group in &self.groups {
            let loaded = &self.loaded[group.unknowns.clone()];
            if loaded.iter().all(|&value| value == 0.0) {
                continue;
            }
            let scaled = &mut self.forces[..group.stride()];
            scaled[loaded.len()..].fill(0.0);
            let values = loaded.iter().zip(&self.inverses[group.unknowns.clone()]);
            for (scaled, (value, inverse)) in scaled.iter_mut().zip(values) {
                *scaled = value * inverse;
            }
            let neighbours = &self.neighbours[group.neighbours.clone()];
            let sums = &mut self.scratch[..neighbours.len()];
            self.arch.dispatch(Products {
                rows: &self.coefficients[group.rows()],
                x: scaled,
                sums: &mut *sums,
            });
            for (&neighbour, sum) in neighbours.iter().zip(sums) {
                add(neighbour as usize, -*sum);
            }
        }
    }

    /// Recovers the condensed unknowns from the solution `of(unknown)` of the others: `set(unknowns, values)` sees
    /// those of the groups with a solution that is not zero, and `touched` the range of neighbours of each of these
    /// groups.
    pub fn substitute(
        &mut self,
        mut of: impl FnMut(usize) -> f64,
        mut set: impl FnMut(Range<usize>, &[f64]),
        mut touched: impl FnMut(Range<usize>),
    ) {
        for group in &self.groups {
            let neighbours = &self.neighbours[group.neighbours.clone()];
            let around = &mut self.scratch[..neighbours.len()];
            for (value, &neighbour) in around.iter_mut().zip(neighbours) {
                *value = of(neighbour as usize);
            }
            let count = group.unknowns.len();
            let forces = &mut self.forces[..group.stride()];
            forces[..count].copy_from_slice(&self.loaded[group.unknowns.clone()]);
            forces[count..].fill(0.0);
            if around.iter().any(|value| *value != 0.0) {
                self.arch.dispatch(Subtract {
                    rows: &self.coefficients[group.rows()],
                    x: around,
                    forces,
                });
            }
            let solution = &mut forces[..count];
            if solution.iter().all(|&force| force == 0.0) {
                continue;
            }
            for (value, inverse) in solution.iter_mut().zip(&self.inverses[group.unknowns.clone()]) {
                *value *= inverse;
            }
            set(group.unknowns.clone(), solution);
            if let (Some(&first), Some(&last)) = (neighbours.first(), neighbours.last()) {
                touched(first as usize..last as usize + 1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entry of a matrix of two unknowns with sixteen condensed ones on both.
    fn entry(i: usize, j: usize) -> f64 {
        match (i < 2, j < 2) {
            (true, true) => [[9.0, -1.0], [-1.0, 7.0]][i][j],
            (false, false) => f64::from(u8::from(i == j)) * (3.0 + i as f64),
            _ => 0.1 * (i.max(j) as f64) - 0.3 * (i.min(j) as f64),
        }
    }

    /// The columns of a matrix where it is not zero: starts, rows and values.
    fn compressed(size: usize, entry: &dyn Fn(usize, usize) -> f64) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..size {
            for i in (0..size).filter(|&i| entry(i, j) != 0.0) {
                rows.push(i);
                values.push(entry(i, j));
            }
            starts.push(rows.len());
        }
        (starts, rows, values)
    }

    /// Solves through the reduced matrix; returns the largest error, and the number of groups with a solution.
    fn solve(
        found: &mut Condensed,
        (starts, rows): (&[usize], &[usize]),
        values: &[f64],
        entry: &dyn Fn(usize, usize) -> f64,
    ) -> (f64, usize) {
        let core = found.core;
        let size = core + found.loaded.len();
        let exact: Vec<f64> = (0..size).map(|i| 1.0 + 0.5 * i as f64).collect();
        let product = |i: usize| (0..size).map(|j| entry(i, j) * exact[j]).sum::<f64>();
        let reduced = found.reduce(values).unwrap();
        let mut matrix = nalgebra::DMatrix::zeros(core, core);
        for column in 0..core {
            for place in starts[column]..starts[column + 1] {
                matrix[(rows[place], column)] = reduced[place];
            }
        }
        found
            .loaded
            .iter_mut()
            .enumerate()
            .for_each(|(own, value)| *value = product(core + own));
        let mut b = nalgebra::DVector::from_fn(core, |i, _| product(i));
        found.eliminate(|unknown, value| b[unknown] += value);
        let x = matrix.lu().solve(&b).unwrap();
        let mut all = x.as_slice().to_vec();
        all.resize(size, 0.0);
        let mut touched = 0;
        found.substitute(
            |unknown| x[unknown],
            |own, values| all[core + own.start..core + own.end].copy_from_slice(values),
            |_| touched += 1,
        );
        let off = all.iter().zip(&exact).map(|(x, exact)| (x - exact).abs());
        (off.fold(0.0, f64::max), touched)
    }

    #[test]
    fn condensation_solves_the_whole_system() {
        let (starts, rows, values) = compressed(18, &entry);
        let (mut found, reduced_starts, reduced_rows) = Condensed::analyse(&starts, &rows).unwrap();
        assert_eq!(
            (found.core, &reduced_starts, &reduced_rows),
            (2, &vec![0, 2, 4], &vec![0, 1, 0, 1])
        );
        let (off, groups) = solve(&mut found, (&reduced_starts, &reduced_rows), &values, &entry);
        assert!(off < 1e-11 && groups == 1, "{off}, {groups}");
    }

    /// Four unknowns in a chain with sixteen condensed ones on the first two and sixteen on the last two: once with the
    /// same couplings, once with another one, and with the same ones again.
    #[test]
    fn groups_that_are_alike_share_their_coefficients_while_they_are() {
        let of = |other: f64| {
            move |i: usize, j: usize| -> f64 {
                let (low, high) = (i.min(j), i.max(j));
                match (low, high) {
                    (_, 0..4) => [9.0, -1.0, 0.0, 0.0][high - low],
                    // The diagonal entries need not be the same ones.
                    (4.., _) => f64::from(u8::from(i == j)) * (3.0 + i as f64),
                    (_, 4..20) if low < 2 => entry(low, high - 2),
                    (_, 20..) if low >= 2 => {
                        entry(low - 2, high - 18) + if (low, high) == (3, 30) { other } else { 0.0 }
                    }
                    _ => 0.0,
                }
            }
        };
        let (starts, rows, _) = compressed(36, &of(0.0));
        let (mut found, reduced_starts, reduced_rows) = Condensed::analyse(&starts, &rows).unwrap();
        for (other, shared) in [(0.0, true), (0.25, false), (0.0, true)] {
            let (_, _, values) = compressed(36, &of(other));
            let (off, groups) = solve(&mut found, (&reduced_starts, &reduced_rows), &values, &of(other));
            assert!(off < 1e-10 && groups == 2, "{off}, {groups}");
            assert_eq!(
                found.groups[0].coefficients == found.groups[1].coefficients,
                shared,
                "{other}"
            );
        }
    }

    #[test]
    fn a_chain_has_nothing_to_condense() {
        let size = 40_usize;
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for c in 0..size {
            rows.extend(c.saturating_sub(1)..(c + 2).min(size));
            starts.push(rows.len());
        }
        assert!(Condensed::analyse(&starts, &rows).is_none());
    }
}
