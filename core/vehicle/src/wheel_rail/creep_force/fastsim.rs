//! Kalker's simplified theory.
use super::dual::Number;
use super::law::Inputs;
use std::f64::consts::PI;

/// Grid of the contact ellipse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fastsim {
    /// Strips along the rolling direction.
    pub strips: usize,
    /// Cells per strip.
    pub cells: usize,
}

/// Number of arguments of the tractions, see [`Fastsim::forces`].
const NUMBERS: usize = 4;

/// Traction component and the derivatives by these arguments.
type Component = [f64; 1 + NUMBERS];

impl Fastsim {
    /// ```text
    /// L₁ = 8a/(3 C₁₁ G),   L₂ = 8a/(3 C₂₂ G),   L₃ = π a √(a/b)/(4 C₂₃ G)
    /// ∂p_x/∂x = ξ_x/L₁ − φ y/L₃,   ∂p_y/∂x = ξ_y/L₂ + φ x/L₃,   p = 0 at the leading edge
    /// |p| ≤ 2 μN/(π a b) (1 − x²/a² − y²/b²), scaled back where it is more          [Kalker 1982]
    /// ```
    ///
    /// In units of the largest bound and of the semi-axes the tractions depend on four numbers only: the slopes of the
    /// tractions by the two creepages and by the spin across and along.
    pub(super) fn forces<N: Number>(self, inputs: &Inputs<N>) -> [N; 3] {
        let [x, y, spin] = inputs.creepage;
        let [c11, c22, c23] = inputs.coefficients;
        let (a, b) = (inputs.along, inputs.across);
        // a/(L p₀) with p₀ = 2 μN/(π a b)
        let per_bound = a * b * inputs.limit.inverse() * (0.5 * PI * inputs.shear_modulus);
        let by_spin = per_bound * c23 * spin * (4.0 / PI) * (a * b).sqrt();
        let numbers = [
            per_bound * c11 * x * (3.0 / 8.0),
            per_bound * c22 * y * (3.0 / 8.0),
            // a b φ/(L₃ p₀) and a² φ/(L₃ p₀)
            by_spin * b * a.inverse(),
            by_spin,
        ];
        let sums = self.sums(numbers.map(Number::value));
        let sum = |k: usize| {
            (0..NUMBERS).fold(N::constant(sums[k][0]), |sum, i| {
                sum + (numbers[i] * sums[k][1 + i]).change()
            })
        };
        let scale = inputs.limit * (2.0 / PI);
        [scale * sum(0), scale * sum(1), scale * (a * sum(2) - b * sum(3))]
    }

    /// `∫ p_x`, `∫ p_y`, `∫ x p_y`, `∫ y p_x` over the unit circle, with their derivatives by the four numbers.
    fn sums(self, numbers: [f64; NUMBERS]) -> [Component; 4] {
        let mut sums = [[0.0; 1 + NUMBERS]; 4];
        let width = 2.0 / self.strips as f64;
        for strip in 0..self.strips {
            let y = -1.0 + width * (strip as f64 + 0.5);
            let half = (1.0 - y * y).sqrt();
            let step = 2.0 * half / self.cells as f64;
            let mut traction: [Component; 2] = [[0.0; 1 + NUMBERS]; 2];
            let mut before = half;
            for cell in 0..self.cells {
                // From the leading edge to the middle of the first cell, then from middle to middle.
                let x = half - step * (cell as f64 + 0.5);
                let (length, between) = (before - x, 0.5 * (before + x));
                let [px, py] = &mut traction;
                px[0] -= length * (numbers[0] - numbers[2] * y);
                px[1] -= length;
                px[3] += length * y;
                py[0] -= length * (numbers[1] + numbers[3] * between);
                py[2] -= length;
                py[4] -= length * between;
                limit(&mut traction, half * half - x * x);
                let area = width * step;
                for k in 0..1 + NUMBERS {
                    sums[0][k] += area * traction[0][k];
                    sums[1][k] += area * traction[1][k];
                    sums[2][k] += area * x * traction[1][k];
                    sums[3][k] += area * y * traction[0][k];
                }
                before = x;
            }
        }
        sums
    }
}

/// Scales a traction beyond the bound back to the bound.
fn limit(traction: &mut [Component; 2], bound: f64) {
    let [px, py] = traction;
    let size = px[0].hypot(py[0]);
    if size <= bound {
        return;
    }
    let direction = [px[0] / size, py[0] / size];
    for k in 1..1 + NUMBERS {
        // Only the part across the traction remains of the change.
        let across = (direction[0] * py[k] - direction[1] * px[k]) * bound / size;
        (px[k], py[k]) = (-direction[1] * across, direction[0] * across);
    }
    (px[0], py[0]) = (direction[0] * bound, direction[1] * bound);
}
