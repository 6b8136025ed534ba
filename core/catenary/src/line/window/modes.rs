//! The lowest modes of a span held at its supports.
use dynamics::SparseMatrix;
use dynamics::eigen::{BandedFactor, Eigenpairs, lowest_eigenpairs, restricted};

/// Modes of a span of one tension length along the track, and as many across it, that are kept whatever their
/// frequency: the first two of each wire.
pub(super) const APART: usize = 4;

/// Share of its mass with which a direction stays behind while the modes of others are searched: none, but for a mass
/// matrix that stays definite.
const FOLLOWS: f64 = 1e-6;

/// Choice of the modes of a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// Number of modes that are kept.
    pub count: usize,
    /// Lowest modes among which they are found, no fewer.
    pub searched: usize,
    /// Modes along, and modes across the track that are kept whatever their frequency.
    pub apart: usize,
}

impl Kept {
    /// The choice of a part of several such spans beside each other.
    pub fn times(self, beside: usize) -> Self {
        Self {
            count: beside * self.count,
            searched: beside * self.searched,
            apart: beside * self.apart,
        }
    }

    /// Modes of `K φ = ω² M φ` in their order, columns `φ` with `φᵀ M φ = 1`, and `ω²`: the first ones along the track,
    /// then the others by ascending frequency. `along` and `across` are one at the coordinates of the direction, zero
    /// elsewhere.
    ///
    /// Tension changes run along the line at kilometres per second, as waves longer than the spans far beyond the
    /// frequencies of the contact force. With the quasi-static shape alone the mass of a span would stand at its
    /// supports, and these waves would be too fast.
    ///
    /// Waves across the track hardly lift a wire, so that the modes up and along the track are those of a line whose
    /// wires follow across the track without inertia; the first modes across join them, and all together are made
    /// modes of the span [Rayleigh & Ritz]. Modes of the whole span would not do: a wire swings equally fast up and
    /// across, so that each of its modes is both.
    pub fn modes(
        self,
        (stiffness, factor): (&SparseMatrix, &BandedFactor),
        mass: &SparseMatrix,
        [along, across]: [&[bool]; 2],
    ) -> Eigenpairs {
        let is_spatial = across.contains(&true);
        let of_others = if is_spatial { self.apart } else { 0 };
        let searched = self.searched - of_others;
        let one_after_another = |found: Eigenpairs, count: usize| -> Eigenpairs {
            let is_along = |mode: &Vec<f64>| {
                let momentum = mass.multiply_columns(mode);
                let share = momentum.iter().zip(mode).zip(along);
                share
                    .map(|((p, x), along)| if *along { p * x } else { 0.0 })
                    .sum::<f64>()
                    > 0.5
            };
            let pairs = found.values.into_iter().zip(found.vectors);
            let mut left = self.apart;
            let (first, others): (Vec<_>, Vec<_>) = pairs.partition(|(_, mode)| {
                let is_first = left > 0 && is_along(mode);
                left -= usize::from(is_first);
                is_first
            });
            let (values, vectors) = first.into_iter().chain(others).take(count).unzip();
            Eigenpairs { values, vectors }
        };
        if !is_spatial {
            let found = lowest_eigenpairs((stiffness, factor), mass, searched);
            return one_after_another(found, self.count);
        }
        let weighted = |weight: &dyn Fn(usize) -> f64| {
            let entries = (0..mass.size()).flat_map(|row| {
                let entries = mass.row(row);
                entries.map(move |(column, value)| (row as u32, column as u32, value * weight(row) * weight(column)))
            });
            SparseMatrix::from_entries(mass.size(), entries.collect())
        };
        let still = FOLLOWS.sqrt();
        let up = weighted(&|index| if across[index] { still } else { 1.0 });
        let sideways = weighted(&|index| if across[index] { 1.0 } else { still });
        let up = lowest_eigenpairs((stiffness, factor), &up, searched);
        let up = one_after_another(up, self.count - of_others);
        let sideways = lowest_eigenpairs((stiffness, factor), &sideways, of_others);
        let all = [up.vectors, sideways.vectors].concat().concat();
        one_after_another(restricted(&all, [stiffness, mass]), self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dynamics::eigen::BandedMatrix;
    use dynamics::testing::string_of_masses;

    /// A string that swings equally fast up and across, whose modes are therefore any mixture of both.
    #[test]
    fn of_a_string_in_space_all_modes_up_and_the_first_across_are_kept() {
        let n = 60;
        let in_space = |plane: &SparseMatrix| {
            let entries = (0..n).flat_map(|row| plane.row(row).map(move |(column, value)| (row, column, value)));
            // Coordinate 2 i is across and 2 i + 1 up; a weak coupling mixes them.
            let entries = entries.flat_map(|(i, j, value)| {
                let mixed = 1e-9 * value;
                let place = |i: usize, axis: usize| (2 * i + axis) as u32;
                [(0, 0, value), (1, 1, value), (0, 1, mixed), (1, 0, mixed)]
                    .map(|(a, b, value)| (place(i, a), place(j, b), value))
            });
            SparseMatrix::from_entries(2 * n, entries.collect())
        };
        let [stiffness, mass] = string_of_masses(n as u32);
        let (stiffness, mass) = (in_space(&stiffness), in_space(&mass));
        let factor = BandedFactor::new(&BandedMatrix::from(&stiffness));
        let across: Vec<bool> = (0..2 * n).map(|i| i % 2 == 0).collect();
        let kept = Kept {
            count: 12,
            searched: 12,
            apart: 4,
        };
        let along = vec![false; 2 * n];
        let found = kept.modes((&stiffness, &factor), &mass, [&along, &across]);
        // The first four both up and across, then four more up.
        let order = [1, 1, 2, 2, 3, 3, 4, 4, 5, 6, 7, 8];
        for (k, square) in order.into_iter().zip(&found.values) {
            let angle = f64::from(k) * std::f64::consts::PI / (2 * n + 2) as f64;
            let exact = 4.0 * angle.sin().powi(2);
            assert!((square / exact - 1.0).abs() < 1e-4, "mode {k}: {square} {exact}");
        }
        for mode in &found.vectors[8..] {
            let sideways = mode.iter().zip(&across).filter(|(_, across)| **across);
            let share: f64 = sideways.map(|(x, _)| x * x).sum();
            assert!(share < 1e-6, "{share}");
        }
    }
}
