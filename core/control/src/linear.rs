//! A linear pantograph on a spring, from sample to sample.

use nalgebra::{DMatrix, DVector};

/// Part of a sample below which a delay is none.
const NO_DELAY: f64 = 1e-9;

/// A lumped pantograph without friction whose elements push and pull, its head on a wire of stiffness `k_w`, and the
/// drive with its lag:
///
/// ```text
/// M q̈ + C q̇ + (K + k_w e₁e₁ᵀ) q = e_d f,    T ḟ = u − f
/// ```
///
/// The state is `q`, `q̇` and, with a lag, `f`: deviations from rest. In general `e₁` is `∂z/∂q` of the head and `e_d`
/// that of what is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPantograph {
    state: DMatrix<f64>,
    input: DVector<f64>,
    head: DVector<f64>,
    driven: DVector<f64>,
    wire_stiffness: f64,
}

/// Any pantograph, linear about rest, without the wire and its drive's lag.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearParts {
    /// `M`
    pub mass: DMatrix<f64>,
    /// `C`
    pub damping: DMatrix<f64>,
    /// `K`
    pub stiffness: DMatrix<f64>,
    /// `∂z/∂q` of the head.
    pub head: DVector<f64>,
    /// Generalised forces of a unit of the drive.
    pub drive: DVector<f64>,
}

/// Unit vector `index` of `n`.
fn unit(n: usize, index: usize) -> DVector<f64> {
    DVector::from_fn(n, |row, _| f64::from(u8::from(row == index)))
}

impl LinearPantograph {
    /// The pantograph with its head on a wire of `wire_stiffness` N/m.
    #[must_use]
    pub fn new(lumped: &scene::Lumped, actuator: &scene::Actuator, wire_stiffness: f64) -> Self {
        let n = lumped.masses.len();
        let driven = actuator.mass.map_or(n - 1, |mass| mass - 1);
        let has_lag = actuator.lag > 0.0;
        let size = 2 * n + usize::from(has_lag);
        let mut state = DMatrix::zeros(size, size);
        let mut input = DVector::zeros(size);
        for i in 0..n {
            state[(i, n + i)] = 1.0;
        }
        let mut add = |row: usize, column: usize, stiffness: f64, damping: f64| {
            state[(n + row, column)] -= stiffness / lumped.masses[row];
            state[(n + row, n + column)] -= damping / lumped.masses[row];
        };
        add(0, 0, wire_stiffness, 0.0);
        for (i, (&stiffness, &damping)) in lumped.stiffnesses.iter().zip(&lumped.dampings).enumerate() {
            add(i, i, stiffness, damping);
            if i + 1 < n {
                add(i, i + 1, -stiffness, -damping);
                add(i + 1, i, -stiffness, -damping);
                add(i + 1, i + 1, stiffness, damping);
            }
        }
        if has_lag {
            state[(n + driven, 2 * n)] = 1.0 / lumped.masses[driven];
            state[(2 * n, 2 * n)] = -1.0 / actuator.lag;
            input[2 * n] = 1.0 / actuator.lag;
        } else {
            input[n + driven] = 1.0 / lumped.masses[driven];
        }
        Self {
            state,
            input,
            head: unit(n, 0),
            driven: unit(n, driven),
            wire_stiffness,
        }
    }

    /// Pantograph of these parts with its head on a wire of `wire_stiffness` N/m; none where its mass is singular.
    #[must_use]
    pub fn of(parts: &LinearParts, actuator: &scene::Actuator, wire_stiffness: f64) -> Option<Self> {
        let n = parts.head.len();
        let has_lag = actuator.lag > 0.0;
        let size = 2 * n + usize::from(has_lag);
        let mass = parts.mass.clone().lu();
        let on_wire = &parts.stiffness + &parts.head * parts.head.transpose() * wire_stiffness;
        let drive = mass.solve(&parts.drive)?;
        let (mut state, mut input) = (DMatrix::zeros(size, size), DVector::zeros(size));
        state.view_mut((0, n), (n, n)).fill_with_identity();
        state.view_mut((n, 0), (n, n)).copy_from(&-mass.solve(&on_wire)?);
        state.view_mut((n, n), (n, n)).copy_from(&-mass.solve(&parts.damping)?);
        if has_lag {
            state.view_mut((n, 2 * n), (n, 1)).copy_from(&drive);
            state[(2 * n, 2 * n)] = -1.0 / actuator.lag;
            input[2 * n] = 1.0 / actuator.lag;
        } else {
            input.rows_mut(n, n).copy_from(&drive);
        }
        Some(Self {
            state,
            input,
            head: parts.head.clone(),
            driven: parts.drive.clone(),
            wire_stiffness,
        })
    }

    /// Number of coordinates: masses of a chain.
    #[must_use]
    pub fn masses(&self) -> usize {
        self.head.len()
    }

    /// Rise of the head in a state whose first entries are those of this pantograph, m.
    pub(crate) fn rise(&self, state: &DVector<f64>) -> f64 {
        self.head.dot(&state.rows(0, self.masses()))
    }

    /// Least deviation of the coordinates that raises the head by `rise` m.
    pub(crate) fn raised(&self, rise: f64) -> DVector<f64> {
        &self.head * (rise / self.head.norm_squared())
    }

    /// Velocity of the head, m/s.
    pub(crate) fn head_velocity(&self, state: &DVector<f64>) -> f64 {
        self.head.dot(&state.rows(self.masses(), self.masses()))
    }

    /// Way and velocity of what is driven, m and m/s, or rad and rad/s.
    pub(crate) fn driven_way(&self, state: &DVector<f64>) -> [f64; 2] {
        [0, self.masses()].map(|first| self.driven.dot(&state.rows(first, self.masses())))
    }

    /// Mass that is driven, from 0, of a chain.
    pub(crate) fn driven_mass(&self) -> usize {
        self.driven.imax()
    }

    /// Stiffness of the wire, N/m.
    #[must_use]
    pub fn wire_stiffness(&self) -> f64 {
        self.wire_stiffness
    }

    /// Acceleration of the head, m/s², in a state whose first entries are those of this pantograph, under a command.
    pub(crate) fn head_acceleration(&self, state: &DVector<f64>, command: f64) -> f64 {
        let n = self.masses();
        let accelerations = self.state.rows(n, n) * state.rows(0, self.size()) + self.input.rows(n, n) * command;
        self.head.dot(&accelerations)
    }

    /// State that is the force of the drive; none without a lag.
    pub(crate) fn drive_state(&self) -> Option<usize> {
        (self.size() > 2 * self.masses()).then_some(2 * self.masses())
    }

    /// Number of states.
    #[must_use]
    pub fn size(&self) -> usize {
        self.input.len()
    }

    /// Transition over `time` s: of the state, and by an input held for that time.
    fn transition(&self, time: f64) -> (DMatrix<f64>, DVector<f64>) {
        // exp of [A B; 0 0] has both [C. Van Loan, IEEE Trans. Automatic Control 23 (1978) 395].
        let n = self.size();
        let mut both = DMatrix::zeros(n + 1, n + 1);
        both.view_mut((0, 0), (n, n)).copy_from(&(&self.state * time));
        both.view_mut((0, n), (n, 1)).copy_from(&(&self.input * time));
        let both = both.exp();
        (
            both.view((0, 0), (n, n)).into_owned(),
            both.column(n).rows(0, n).into_owned(),
        )
    }
}

/// The same from sample to sample, with commands that take effect a delay after the sample:
///
/// ```text
/// z = (x, u₋₁, …, u₋ₚ),    z₊ = A z + B u
/// ```
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Delayed {
    pub state: DMatrix<f64>,
    pub input: DVector<f64>,
}

impl Delayed {
    /// With a delay of `delay` s and samples `sample` s apart.
    pub(crate) fn new(plant: &LinearPantograph, sample: f64, delay: f64) -> Self {
        let n = plant.size();
        let whole = (delay / sample + NO_DELAY).floor();
        let rest = (delay - whole * sample).max(0.0);
        let whole = whole as usize;
        let is_split = rest > NO_DELAY * sample;
        let past = whole + usize::from(is_split);
        let mut state = DMatrix::zeros(n + past, n + past);
        let mut input = DVector::zeros(n + past);
        let (over_sample, _) = plant.transition(sample);
        state.view_mut((0, 0), (n, n)).copy_from(&over_sample);
        // The older command acts until the delay is over, the newer one after it.
        let (after, newer) = plant.transition(sample - rest);
        let (_, older) = plant.transition(rest);
        if whole == 0 {
            input.rows_mut(0, n).copy_from(&newer);
        } else {
            state.view_mut((0, n + whole - 1), (n, 1)).copy_from(&newer);
        }
        if is_split {
            state.view_mut((0, n + whole), (n, 1)).copy_from(&(after * older));
        }
        if past > 0 {
            input[n] = 1.0;
        }
        for i in 1..past {
            state[(n + i, n + i - 1)] = 1.0;
        }
        Self { state, input }
    }

    /// Number of states.
    pub(crate) fn size(&self) -> usize {
        self.input.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One mass of 10 kg on 4 kN/m with 20 N·s/m, on a wire of 6 kN/m.
    fn plant() -> LinearPantograph {
        let lumped = scene::Lumped::new(1.0, 100.0, &[10.0], &[4000.0], &[20.0]);
        LinearPantograph::new(&lumped, &scene::Actuator::default(), 6000.0)
    }

    #[test]
    fn the_transition_is_that_of_a_damped_oscillator() {
        let (time, decay, stiffness) = (0.013_f64, 1.0_f64, 10_000.0);
        let (over, by_input) = plant().transition(time);
        let omega = (1000.0_f64 - decay * decay).sqrt();
        let (sin, cos) = (omega * time).sin_cos();
        let shrunk = (-decay * time).exp();
        let expected = [
            shrunk * (cos + decay / omega * sin),
            shrunk * sin / omega,
            -shrunk * 1000.0 / omega * sin,
            shrunk * (cos - decay / omega * sin),
        ];
        let found = [over[(0, 0)], over[(0, 1)], over[(1, 0)], over[(1, 1)]];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        }
        // A step of the force moves the mass to F/k.
        assert!((by_input[0] - (1.0 - expected[0]) / stiffness).abs() < 1e-14);
    }

    #[test]
    fn a_delay_shifts_the_response_in_time() {
        let sample = 0.005;
        for delay in [0.0, 0.002, 0.005, 0.0075] {
            let delayed = Delayed::new(&plant(), sample, delay);
            let mut state = DVector::zeros(delayed.size());
            for _ in 0..4 {
                state = &delayed.state * state + &delayed.input;
            }
            let (_, expected) = plant().transition(4.0 * sample - delay);
            // Rounding.
            assert!((state[0] - expected[0]).abs() < 1e-15, "{delay}");
        }
    }
}
