//! Elongations of a span's droppers as coordinates in place of displacements.
use dynamics::SparseMatrix;

/// Replaces one displacement per dropper, at a node that no other dropper hangs from:
///
/// ```text
/// δ = Σ bᵢ qᵢ,    q_p = (δ − Σ_{i≠p} bᵢ qᵢ)/b_p
/// ```
///
/// `δ` takes the number of `q_p`. In the new coordinates the spring and the damper of a dropper are one diagonal entry
/// each.
#[derive(Debug)]
pub(super) struct Elongations(Vec<Elongation>);

#[derive(Debug)]
struct Elongation {
    /// `p`.
    place: usize,
    /// `b_p`.
    own: f64,
    /// `bᵢ` of the other coordinates.
    others: Vec<(usize, f64)>,
}

impl Elongations {
    /// Replacement for droppers with these `∂δ/∂q`, each as (coordinate, value); the largest entry, and of equal ones
    /// the last, is replaced.
    pub fn new(gradients: impl Iterator<Item = Vec<(usize, f64)>>) -> Self {
        let elongation = |mut entries: Vec<(usize, f64)>| {
            let largest = (0..entries.len()).max_by(|&i, &j| entries[i].1.abs().total_cmp(&entries[j].1.abs()))?;
            let (place, own) = entries.swap_remove(largest);
            Some(Elongation {
                place,
                own,
                others: entries,
            })
        };
        Self(gradients.filter_map(elongation).collect())
    }

    /// Coordinates of the elongations, in the order of the droppers.
    pub fn places(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().map(|elongation| elongation.place)
    }

    /// Transforms a symmetric matrix to the new coordinates.
    pub fn transform(&self, matrix: &SparseMatrix) -> SparseMatrix {
        let rows: Vec<(usize, Vec<(usize, f64)>)> = (self.0.iter())
            .map(|Elongation { place, own, others }| {
                let others = others.iter().map(|&(i, b)| (i, -b / own));
                (*place, others.chain([(*place, 1.0 / own)]).collect())
            })
            .collect();
        matrix.congruent(&rows)
    }

    /// Converts displacements to elongations, in place.
    pub fn measure(&self, values: &mut [f64]) {
        for elongation in &self.0 {
            let value = elongation.own * values[elongation.place] + elongation.of_others(values);
            values[elongation.place] = value;
        }
    }

    /// Converts elongations to displacements, in place.
    pub fn displace(&self, values: &mut [f64]) {
        for elongation in &self.0 {
            let value = (values[elongation.place] - elongation.of_others(values)) / elongation.own;
            values[elongation.place] = value;
        }
    }
}

impl Elongation {
    fn of_others(&self, values: &[f64]) -> f64 {
        self.others.iter().map(|&(i, b)| b * values[i]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five unknowns in a row, with a dropper between the second and the fourth that leans onto the third.
    #[test]
    fn the_energy_is_the_same_in_both_coordinates() {
        let mut entries = Vec::new();
        for i in 0..5_u32 {
            entries.push((i, i, f64::from(i + 1)));
            if i > 0 {
                entries.push((i, i - 1, -0.3));
                entries.push((i - 1, i, -0.3));
            }
        }
        let matrix = SparseMatrix::from_entries(5, entries);
        let elongations = Elongations::new([vec![(1, 0.8), (2, 0.6), (3, -0.8)]].into_iter());
        assert_eq!(elongations.places().collect::<Vec<_>>(), [3]);
        let energy = |matrix: &SparseMatrix, q: &[f64]| -> f64 { matrix.quadratic_form(q) };
        let q = [0.3, -1.1, 0.7, 2.0, -0.4];
        let mut new = q;
        elongations.measure(&mut new);
        assert!((new[3] - (0.8 * -1.1 + 0.6 * 0.7 - 0.8 * 2.0)).abs() < 1e-15);
        let (expected, found) = (energy(&matrix, &q), energy(&elongations.transform(&matrix), &new));
        assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
        elongations.displace(&mut new);
        assert!(new.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-15), "{new:?}");
    }

    #[test]
    fn the_spring_of_a_dropper_is_one_diagonal_entry() {
        let gradient = [(0, 0.6), (1, 0.8), (2, -1.0)];
        let outer = gradient
            .iter()
            .flat_map(|&(i, a)| gradient.iter().map(move |&(j, b)| (i, j, 7.0 * a * b)));
        let spring = SparseMatrix::from_entries(3, outer.collect());
        let rows = gradient.iter().map(|&(i, b)| (i as usize, b)).collect();
        let found = Elongations::new(std::iter::once(rows)).transform(&spring);
        for row in 0..3 {
            for column in 0..3 {
                let unit: Vec<f64> = (0..3).map(|i| if i == column { 1.0 } else { 0.0 }).collect();
                let expected = if (row, column) == (2, 2) { 7.0 } else { 0.0 };
                assert!(
                    (found.row_product(row, &unit) - expected).abs() < 1e-14,
                    "{row} {column}"
                );
            }
        }
    }
}
