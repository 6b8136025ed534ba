//! Gains of the linear-quadratic regulator.

use nalgebra::{DMatrix, DVector};

use crate::linear::Delayed;

/// Change of the solution, as a share of it, that counts as none.
const STILL: f64 = 1e-12;

/// Most doublings: each squares the distance.
const DOUBLINGS: usize = 60;

/// No gains make the loop stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no linear-quadratic gains: the driven mass does not reach every motion of the pantograph; must be another \
     actuator.mass or other weights"
)]
pub struct NoGains;

/// Gains `K` of `u = −K z` with least `Σ zᵀ Q z + R u²` over all samples; the cost between samples is not counted.
///
/// The Riccati equation is solved by doubling [E. Chu, H. Fan, W. Lin, C. Wang, Int. J. Control 77 (2004) 767].
///
/// # Errors
/// A loop that no gains stabilise.
pub(crate) fn gains(plant: &Delayed, weights: &DMatrix<f64>, effort_weight: f64) -> Result<Vec<f64>, NoGains> {
    let n = plant.size();
    let identity = DMatrix::<f64>::identity(n, n);
    let mut a = plant.state.clone();
    let mut g = &plant.input * plant.input.transpose() / effort_weight;
    let mut h = weights.clone();
    for _ in 0..DOUBLINGS {
        let lu = (&identity + &g * &h).lu();
        let of_a = lu.solve(&a).ok_or(NoGains)?;
        let of_g = lu.solve(&g).ok_or(NoGains)?;
        let change = a.transpose() * &h * &of_a;
        g += &a * of_g * a.transpose();
        a *= of_a;
        h += &change;
        if !change.iter().all(|value| value.is_finite()) {
            return Err(NoGains);
        }
        if change.amax() <= STILL * h.amax() {
            let by_input: DVector<f64> = &h * &plant.input;
            let scale = effort_weight + plant.input.dot(&by_input);
            return Ok((plant.state.transpose() * by_input / scale).iter().copied().collect());
        }
    }
    Err(NoGains)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_state_has_the_root_of_its_quadratic_equation() {
        // P = a² P − (a b P)²/(r + b² P) + q
        let (a, b, q, r) = (1.2_f64, 0.5, 3.0, 2.0);
        let plant = Delayed {
            state: DMatrix::from_element(1, 1, a),
            input: DVector::from_element(1, b),
        };
        let found = gains(&plant, &DMatrix::from_element(1, 1, q), r).unwrap()[0];
        let half = (r * (1.0 - a * a) - b * b * q) / 2.0;
        let p = (-half + (half * half + b * b * q * r).sqrt()) / (b * b);
        assert!((found - a * b * p / (r + b * b * p)).abs() < 1e-13);
    }

    #[test]
    fn a_motion_out_of_reach_that_grows_is_refused() {
        let plant = Delayed {
            state: DMatrix::from_row_slice(2, 2, &[1.1, 0.0, 0.0, 0.9]),
            input: DVector::from_column_slice(&[0.0, 1.0]),
        };
        assert_eq!(gains(&plant, &DMatrix::identity(2, 2), 1.0), Err(NoGains));
    }
}
