//! Unknowns that are coupled with none of their like: eliminated first, at the cost of a division each.
//!
//! ```text
//! S = A_cc − Σ aₗ aₗᵀ/dₗ,    S x_c = b_c − Σ aₗ bₗ/dₗ,    xₗ = (bₗ − aₗᵀ x_c)/dₗ
//! ```
//!
//! The modes of a reduced span are such leaves: each is coupled with the two supports of its span only, so that what is left is as
//! long and thin as the line itself.
use crate::buffer::{Buffer, LINE};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Fewer leaves are not worth it.
const FEWEST: usize = 16;

/// The leaves of a part: its last unknowns.
pub(crate) struct Leaves {
    /// Number of other unknowns, which come first.
    pub core: usize,
    /// Leaves with the same neighbours.
    groups: Vec<Group>,
    neighbours: Vec<u32>,
    /// Where the couplings and the diagonal entry of each leaf stand among the values of the part.
    couplings: Vec<u32>,
    diagonals: Vec<u32>,
    /// Per value of the part its place among those of the reduced matrix, if it is there.
    kept: Vec<Option<u32>>,
    /// Per group, row by row, where `a aᵀ` goes.
    fill: Vec<u32>,
    reduced: Vec<f64>,
    /// `a` of the last factors, for each group neighbour by neighbour, each filled up with zeros to whole cache lines, and `1/d`.
    coefficients: Buffer,
    inverses: Vec<f64>,
    /// `b` of the leaves of the loaded right side.
    pub loaded: Vec<f64>,
    /// As many numbers as a group has neighbours, and leaves, filled up likewise.
    scratch: Vec<f64>,
    forces: Buffer,
    arch: Arch,
}

/// Consecutive leaves with the same neighbours, as the modes of one span.
#[derive(Debug)]
struct Group {
    leaves: Range<usize>,
    /// Among `neighbours`.
    neighbours: Range<usize>,
    /// First of its couplings, and of its coefficients.
    couplings: usize,
    coefficients: usize,
}

impl Group {
    /// Numbers per neighbour among the coefficients.
    fn stride(&self) -> usize {
        self.leaves.len().next_multiple_of(LINE)
    }

    /// Where the coefficients of one neighbour stand.
    fn row(&self, neighbour: usize) -> Range<usize> {
        let first = self.coefficients + neighbour * self.stride();
        first..first + self.stride()
    }

    /// Where the coefficients of all neighbours stand.
    fn rows(&self) -> Range<usize> {
        self.coefficients..self.row(self.neighbours.len()).start
    }
}

/// `Σ a b` of whole cache lines.
struct Product<'a>(&'a [f64], &'a [f64]);

impl WithSimd for Product<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (x, y) = (S::as_simd_f64s(self.0).0, S::as_simd_f64s(self.1).0);
        let mut sum = simd.splat_f64s(0.0);
        for (&x, &y) in x.iter().zip(y) {
            sum = simd.mul_add_e_f64s(x, y, sum);
        }
        simd.reduce_sum_f64s(sum)
    }
}

/// `sums[j] = Σ rows[j] x` of whole cache lines, four rows side by side: one sum after the other would wait for its additions.
struct Products<'a> {
    rows: &'a [f64],
    x: &'a [f64],
    sums: &'a mut [f64],
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let stride = self.x.len();
        let x = S::as_simd_f64s(self.x).0;
        for (rows, sums) in self.rows.chunks(4 * stride).zip(self.sums.chunks_mut(4)) {
            if let [a, b, c, d] = sums {
                let row = |j: usize| &S::as_simd_f64s(&rows[j * stride..(j + 1) * stride]).0[..x.len()];
                let rows = [row(0), row(1), row(2), row(3)];
                let mut totals = [simd.splat_f64s(0.0); 4];
                for (i, &x) in x.iter().enumerate() {
                    for (total, row) in totals.iter_mut().zip(rows) {
                        *total = simd.mul_add_e_f64s(row[i], x, *total);
                    }
                }
                for (sum, total) in [a, b, c, d].into_iter().zip(totals) {
                    *sum = simd.reduce_sum_f64s(total);
                }
            } else {
                for (row, sum) in rows.chunks_exact(stride).zip(sums) {
                    *sum = Product(row, self.x).with_simd(simd);
                }
            }
        }
    }
}

/// `forces −= Σ aⱼ xⱼ`
struct Subtract<'a> {
    rows: &'a [f64],
    x: &'a [f64],
    forces: &'a mut [f64],
}

impl WithSimd for Subtract<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (row, x) in self.rows.chunks_exact(self.forces.len()).zip(self.x) {
            for (force, a) in self.forces.iter_mut().zip(row) {
                *force -= a * x;
            }
        }
    }
}

impl Leaves {
    /// Finds the leaves in a symmetric pattern in compressed columns (row indices ascending), and the pattern that is left without
    /// them; `None` where there are few.
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
        let (mut groups, mut neighbours): (Vec<Group>, Vec<u32>) = (Vec::new(), Vec::new());
        let (mut couplings, mut diagonals) = (Vec::new(), Vec::new());
        let mut before: Option<&[usize]> = None;
        for c in core..size {
            let (last, others) = column(c).split_last()?;
            if *last != c {
                return None;
            }
            let leaf = c - core;
            match groups.last_mut().filter(|_| before == Some(others)) {
                Some(group) => group.leaves.end = leaf + 1,
                None => {
                    for &row in others {
                        columns[row].extend_from_slice(others);
                    }
                    let first = neighbours.len();
                    neighbours.extend(others.iter().map(|&row| row as u32));
                    groups.push(Group {
                        leaves: leaf..leaf + 1,
                        neighbours: first..neighbours.len(),
                        couplings: couplings.len(),
                        coefficients: groups.last().map_or(0, |last| last.rows().end),
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
        let mut kept = vec![None; row_indices.len()];
        for c in 0..core {
            for at in column_starts[c]..column_starts[c + 1] {
                kept[at] = (row_indices[at] < core).then(|| place(row_indices[at], c)).flatten();
            }
        }
        let mut fill = Vec::new();
        for group in &groups {
            let own = &neighbours[group.neighbours.clone()];
            for &a in own {
                for &b in own {
                    fill.push(place(a as usize, b as usize)?);
                }
            }
        }
        let widest = groups.iter().map(|group| group.neighbours.len()).max().unwrap_or(0);
        let longest = groups.iter().map(Group::stride).max().unwrap_or(0);
        let leaves = Self {
            core,
            coefficients: Buffer::new(groups.last().map_or(0, |last| last.rows().end)),
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
        Some((leaves, reduced_starts, rows))
    }

    /// The values of the reduced matrix; `None` where a leaf has no positive diagonal entry.
    pub fn reduce(&mut self, values: &[f64]) -> Option<&[f64]> {
        self.reduced.fill(0.0);
        for (&value, place) in values.iter().zip(&self.kept) {
            if let Some(place) = place {
                self.reduced[*place as usize] = value;
            }
        }
        for group in &self.groups {
            let (width, count) = (group.neighbours.len(), group.leaves.len());
            let couplings = &self.couplings[group.couplings..group.couplings + width * count];
            for (i, &place) in couplings.iter().enumerate() {
                self.coefficients[group.row(i % width).start + i / width] = values[place as usize];
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
            let inverses = &self.inverses[group.leaves.clone()];
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

    /// Passes the loaded right side of the leaves on: `add(unknown, value)` takes it into that of the others.
    pub fn eliminate(&mut self, mut add: impl FnMut(usize, f64)) {
        for group in &self.groups {
            let loaded = &self.loaded[group.leaves.clone()];
            if loaded.iter().all(|&value| value == 0.0) {
                continue;
            }
            let scaled = &mut self.forces[..group.stride()];
            scaled[loaded.len()..].fill(0.0);
            let values = loaded.iter().zip(&self.inverses[group.leaves.clone()]);
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

    /// The solution of the leaves from that of the others, `of(unknown)`: `set(leaves, values)` sees those of the groups where it is not
    /// zero, and `touched` the range of neighbours of each of these groups.
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
            let count = group.leaves.len();
            let forces = &mut self.forces[..group.stride()];
            forces[..count].copy_from_slice(&self.loaded[group.leaves.clone()]);
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
            for (value, inverse) in solution.iter_mut().zip(&self.inverses[group.leaves.clone()]) {
                *value *= inverse;
            }
            set(group.leaves.clone(), solution);
            if let (Some(&first), Some(&last)) = (neighbours.first(), neighbours.last()) {
                touched(first as usize..last as usize + 1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unknowns in a row with sixteen leaves on both: solved by hand and through the reduced matrix.
    #[test]
    fn eliminating_leaves_solves_the_whole_system() {
        let (core, leaves) = (2, 16);
        let size = core + leaves;
        let entry = |i: usize, j: usize| -> f64 {
            match (i < core, j < core) {
                (true, true) => [[9.0, -1.0], [-1.0, 7.0]][i][j],
                (false, false) => f64::from(u8::from(i == j)) * (3.0 + i as f64),
                _ => 0.1 * (i.max(j) as f64) - 0.3 * (i.min(j) as f64),
            }
        };
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..size {
            for i in (0..size).filter(|&i| i < core || j < core || i == j) {
                rows.push(i);
                values.push(entry(i, j));
            }
            starts.push(rows.len());
        }
        let (mut found, reduced_starts, reduced_rows) = Leaves::analyse(&starts, &rows).unwrap();
        assert_eq!(
            (found.core, reduced_starts, reduced_rows),
            (2, vec![0, 2, 4], vec![0, 1, 0, 1])
        );
        let exact: Vec<f64> = (0..size).map(|i| 1.0 + 0.5 * i as f64).collect();
        let right: Vec<f64> = (0..size)
            .map(|i| (0..size).map(|j| entry(i, j) * exact[j]).sum())
            .collect();
        let s = found.reduce(&values).unwrap().to_vec();
        found.loaded.copy_from_slice(&right[core..]);
        let mut b = [right[0], right[1]];
        found.eliminate(|unknown, value| b[unknown] += value);
        let determinant = s[0] * s[3] - s[1] * s[2];
        let x = [
            (b[0] * s[3] - b[1] * s[2]) / determinant,
            (b[1] * s[0] - b[0] * s[1]) / determinant,
        ];
        for i in 0..core {
            assert!((x[i] - exact[i]).abs() < 1e-12);
        }
        let mut last = vec![0.0; leaves];
        let mut touched = Vec::new();
        found.substitute(
            |unknown| x[unknown],
            |leaves, values| last[leaves].copy_from_slice(values),
            |range| touched.push(range),
        );
        assert_eq!(
            (touched.len(), touched.first()),
            (1, Some(&(0..2))),
            "the leaves act on both"
        );
        for leaf in 0..leaves {
            assert!((last[leaf] - exact[core + leaf]).abs() < 1e-12);
        }
    }

    #[test]
    fn products_side_by_side_are_those_of_one_row_after_the_other() {
        // Rows beyond fours.
        let (rows, count) = (7, 3 * LINE);
        let values: Vec<f64> = (0..rows * count)
            .map(|i| f64::from((i * 37 % 19) as u8) - 9.0)
            .collect();
        let x: Vec<f64> = (0..count).map(|i| f64::from((i * 5 % 7) as u8) - 3.0).collect();
        let mut sums = vec![0.0; rows];
        Arch::new().dispatch(Products {
            rows: &values,
            x: &x,
            sums: &mut sums,
        });
        for (row, sum) in values.chunks_exact(count).zip(sums) {
            let exact: f64 = row.iter().zip(&x).map(|(a, b)| a * b).sum();
            // Whole numbers: nothing is rounded.
            assert_eq!(sum, exact);
        }
    }

    #[test]
    fn a_chain_has_no_leaves() {
        let size = 40_usize;
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for c in 0..size {
            rows.extend(c.saturating_sub(1)..(c + 2).min(size));
            starts.push(rows.len());
        }
        assert!(Leaves::analyse(&starts, &rows).is_none());
    }
}
