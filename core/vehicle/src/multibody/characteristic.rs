//! Force–displacement curves from point lists: bump stops, progressive springs.
use dynamics::monotone_slopes;

/// Reason why a list of points is no characteristic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CharacteristicError {
    /// Fewer than two points, or lists of different lengths.
    Lengths,
    /// Displacements that do not ascend.
    Order,
    /// Forces that do not ascend with the displacement: such a spring would pull when pushed.
    Falling,
}

/// Force that grows with a displacement, from a list of points: a monotone piecewise cubic with continuous slope
/// [Fritsch & Carlson, SIAM Journal on Numerical Analysis 17 (1980) 238–246], continued along the end slopes.
#[derive(Clone, Debug, PartialEq)]
pub struct Characteristic {
    displacements: Vec<f64>,
    forces: Vec<f64>,
    slopes: Vec<f64>,
    /// Integral of the force from the first point to each point, J.
    energies: Vec<f64>,
    /// Energy at zero displacement, J.
    at_zero: f64,
}

/// Force, stiffness and energy at one displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// N.
    pub force: f64,
    /// N/m.
    pub stiffness: f64,
    /// J, zero at zero displacement.
    pub energy: f64,
}

impl Characteristic {
    /// Characteristic through displacements (m, ascending) and forces (N, not falling).
    ///
    /// # Errors
    /// See [`CharacteristicError`].
    pub fn new(displacements: &[f64], forces: &[f64]) -> Result<Self, CharacteristicError> {
        let n = displacements.len();
        if n < 2 || forces.len() != n {
            return Err(CharacteristicError::Lengths);
        }
        if !displacements.windows(2).all(|pair| pair[0] < pair[1]) {
            return Err(CharacteristicError::Order);
        }
        if !forces.windows(2).all(|pair| pair[0] <= pair[1]) {
            return Err(CharacteristicError::Falling);
        }
        let slopes = monotone_slopes(displacements, forces, None);
        let width = |i: usize| displacements[i + 1] - displacements[i];
        let mut energies = vec![0.0];
        for i in 0..n - 1 {
            let h = width(i);
            let area = 0.5 * h * (forces[i] + forces[i + 1]) + h * h / 12.0 * (slopes[i] - slopes[i + 1]);
            energies.push(energies[i] + area);
        }
        let mut curve = Self {
            displacements: displacements.to_vec(),
            forces: forces.to_vec(),
            slopes,
            energies,
            at_zero: 0.0,
        };
        curve.at_zero = curve.at(0.0).energy;
        Ok(curve)
    }

    /// Force, stiffness and energy at a displacement, m.
    #[must_use]
    pub fn at(&self, s: f64) -> Point {
        let last = self.displacements.len() - 1;
        let end = if s <= self.displacements[0] {
            Some(0)
        } else if s >= self.displacements[last] {
            Some(last)
        } else {
            None
        };
        if let Some(end) = end {
            let beyond = s - self.displacements[end];
            let (force, slope) = (self.forces[end], self.slopes[end]);
            return Point {
                force: force + slope * beyond,
                stiffness: slope,
                energy: self.energies[end] + beyond * (force + 0.5 * slope * beyond) - self.at_zero,
            };
        }
        // No number is on any side of a point: the result is none either, for the solver to report.
        let i = self.displacements.partition_point(|&at| at <= s).saturating_sub(1);
        let h = self.displacements[i + 1] - self.displacements[i];
        let x = (s - self.displacements[i]) / h;
        let (f0, f1) = (self.forces[i], self.forces[i + 1]);
        let (d0, d1) = (h * self.slopes[i], h * self.slopes[i + 1]);
        let (c2, c3) = (3.0 * (f1 - f0) - 2.0 * d0 - d1, 2.0 * (f0 - f1) + d0 + d1);
        Point {
            force: f0 + x * (d0 + x * (c2 + x * c3)),
            stiffness: (d0 + x * (2.0 * c2 + x * 3.0 * c3)) / h,
            energy: self.energies[i] + h * x * (f0 + x * (0.5 * d0 + x * (c2 / 3.0 + x * 0.25 * c3))) - self.at_zero,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lateral bump stop of the Manchester benchmark, both sides.
    fn bump_stop() -> Characteristic {
        Characteristic::new(
            &[-0.040, -0.035, -0.030, -0.025, 0.025, 0.030, 0.035, 0.040],
            &[-3730.0, -1760.0, -600.0, 0.0, 0.0, 600.0, 1760.0, 3730.0],
        )
        .unwrap()
    }

    #[test]
    fn the_curve_runs_through_its_points_and_never_falls() {
        let curve = bump_stop();
        assert!((curve.at(0.035).force - 1760.0).abs() < 1e-9);
        assert!((curve.at(-0.030).force + 600.0).abs() < 1e-9);
        assert_eq!(curve.at(0.01).force, 0.0);
        let mut last = f64::NEG_INFINITY;
        for i in -600..=600 {
            let force = curve.at(f64::from(i) * 1e-4).force;
            assert!(force >= last - 1e-9, "{i}: {force} after {last}");
            last = force;
        }
    }

    #[test]
    fn force_is_the_derivative_of_energy_and_stiffness_that_of_force() {
        let curve = bump_stop();
        assert_eq!(curve.at(0.0).energy, 0.0);
        for s in [-0.05, -0.0333, -0.0251, 0.012, 0.0262, 0.0311, 0.0399, 0.06] {
            let h = 1e-7;
            let (plus, minus, here) = (curve.at(s + h), curve.at(s - h), curve.at(s));
            // Central differences: rounding of the energies / h.
            assert!(((plus.energy - minus.energy) / (2.0 * h) - here.force).abs() < 1e-4);
            assert!(((plus.force - minus.force) / (2.0 * h) - here.stiffness).abs() < 1e-1);
        }
    }

    #[test]
    fn a_displacement_that_is_no_number_gives_a_force_that_is_none() {
        let point = bump_stop().at(f64::NAN);
        assert!(point.force.is_nan() && point.stiffness.is_nan() && point.energy.is_nan());
    }

    #[test]
    fn lists_that_are_no_characteristic_are_refused() {
        let refusal = |s: &[f64], f: &[f64]| Characteristic::new(s, f).unwrap_err();
        assert_eq!(refusal(&[0.0], &[0.0]), CharacteristicError::Lengths);
        assert_eq!(refusal(&[0.0, 1.0], &[0.0]), CharacteristicError::Lengths);
        assert_eq!(refusal(&[0.0, 0.0], &[0.0, 1.0]), CharacteristicError::Order);
        assert_eq!(refusal(&[0.0, 1.0], &[1.0, 0.0]), CharacteristicError::Falling);
    }
}
