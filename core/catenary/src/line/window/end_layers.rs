//! Bending layers at the ends of a reduced span.
use dynamics::SparseMatrix;

/// Bending layers that follow the other coordinates without inertia: of a layer at a support each of two reduced spans
/// has a half.
///
/// ```text
/// a = −Σ K_ai q_i / K_aa
/// ```
///
/// Two independent halves could move against each other: a kink at the support, of so little mass that the inertia
/// corrected for the time step would not be positive at steps that the whole layer allows.
///
/// Each entry holds `a` and the weights `−K_ai/K_aa` of the others `i`, in the form of [`SparseMatrix::congruent`].
#[derive(Debug)]
pub(super) struct EndLayers(Vec<(usize, Vec<(usize, f64)>)>);

impl EndLayers {
    /// Eliminates the layers with these numbers from stiffness, damping and mass of a span; their rows and columns
    /// become zero.
    pub fn eliminate(places: &[usize], [stiffness, damping, mass]: [&mut SparseMatrix; 3]) -> Self {
        let mut followers = Vec::with_capacity(places.len());
        for &place in places {
            let (own, others): (Vec<_>, Vec<_>) = stiffness.row(place).partition(|entry| entry.0 == place);
            let weights = others.into_iter().map(|(i, value)| (i, -value / own[0].1));
            let following = [(place, weights.collect())];
            *stiffness = stiffness.congruent(&following);
            *damping = damping.congruent(&following);
            *mass = mass.congruent(&[(place, Vec::new())]);
            followers.extend(following);
        }
        Self(followers)
    }

    /// Sets the layers from the other coordinates of the span.
    pub fn follow(&self, values: &mut [f64]) {
        // Reverse order: a layer eliminated early may follow one eliminated later.
        for (place, weights) in self.0.iter().rev() {
            values[*place] = weights.iter().map(|&(i, weight)| weight * values[i]).sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_is_in_equilibrium_and_the_rest_is_as_stiff_as_with_it() {
        let entries = |values: &[[f64; 4]; 4]| -> SparseMatrix {
            let all = (0..4).flat_map(|i| (0..4).map(move |j| (i as u32, j as u32, values[i][j])));
            SparseMatrix::from_entries(4, all.collect())
        };
        let whole = entries(&[
            [5.0, -1.0, 0.5, 0.2],
            [-1.0, 4.0, -1.0, 0.0],
            [0.5, -1.0, 6.0, -0.7],
            [0.2, 0.0, -0.7, 3.0],
        ]);
        let (mut stiffness, mut damping, mut mass) = (whole.clone(), whole.clone(), whole.clone());
        let layers = EndLayers::eliminate(&[0, 3], [&mut stiffness, &mut damping, &mut mass]);
        let mut q = [0.0, 0.3, -0.8, 0.0];
        layers.follow(&mut q);
        for (row, free) in [(0, true), (1, false), (2, false), (3, true)] {
            let force = whole.row_product(row, &q);
            let reduced = stiffness.row_product(row, &q);
            let expected = if free { 0.0 } else { force };
            assert!(
                (reduced - expected).abs() < 1e-14 && (!free || force.abs() < 1e-14),
                "{row}: {force} {reduced}"
            );
            assert!((damping.row_product(row, &q) - reduced).abs() < 1e-14);
        }
        assert_eq!(mass.row(0).count() + mass.row(3).count(), 0);
        assert_eq!(mass.row(1).map(|entry| entry.1).collect::<Vec<_>>(), [4.0, -1.0]);
    }
}
