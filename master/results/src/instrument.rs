//! Contact force as a measuring train takes it: load cells under the strips, and accelerometers beside them.
//!
//! ```text
//! F_cell = F − L + m a + m_b ü                    balance of what lies on the cells, its weight taken off
//! F_measured = (1 + e_g) F_cell − (1 + e_m) m a + L̄
//! m_b ü + c u̇ + k u = −F − m_b a                  first bending mode of a strip, moved at its ends
//! ```
//!
//! `a` is the acceleration of the head where the accelerometers sit, over the cells; `m` the mass above the cells,
//! `m_b` the part of it that bends, `u` its deflection, `L` the lift of the air above the cells, `L̄` its mean. A rigid strip
//! has `ü = 0`: force, lift and errors apart, the sum is the contact force [EN 50317]. A strip that bends hides the
//! acceleration of its middle from the accelerometers. For a head held still
//!
//! ```text
//! F_measured/F = (k + i c ω)/(k + i c ω − m_b ω²)
//! ```
//!
//! The simulated head is rigid: bending acts on the measurement, not back on the line.
//!
//! Source: `[Massat]` J.-P. Massat, doctoral thesis, École Centrale de Lyon, 2007, p. 144: two force sensors and two
//! accelerometers under one head.

use scene::Measurement;
use serde::{Deserialize, Serialize};

use crate::statistics::{ForceStatistics, rms_difference};
use crate::{Evaluation, StripRecord};

/// Largest angle of the bending mode in a step of its integration, rad: beyond, RK4 loses digits that are shown.
const ANGLE: f64 = 0.1;

/// Frequencies that gains are given at, Hz.
const FREQUENCIES: [f64; 5] = [2.0, 5.0, 10.0, 15.0, 20.0];

/// Instruments of a head.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Instrument {
    /// Mass above the load cells, kg.
    #[serde(rename = "strip_mass_kg")]
    pub strip_mass: f64,
    /// First bending mode of a strip; absent for a rigid one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bending: Option<Bending>,
    /// Rows of the time series from one sample to the next.
    pub stride: usize,
    /// Error of the gain of the cells, –.
    pub cell_error: f64,
    /// Error of the mass that accelerations are multiplied by, –.
    pub mass_error: f64,
    /// True where the mean lift of the air is added.
    pub aerodynamic_correction: bool,
}

/// Bending mode of a strip on its cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bending {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Mass that moves in it, kg.
    pub mass_kg: f64,
    /// Damping ratio, –.
    pub damping_ratio: f64,
}

/// A measured contact force beside the true one, over the evaluation range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Statistics of the measured force, filtered as the true one is, N.
    pub filtered: ForceStatistics,
    /// rms of the difference of both filtered forces, in percent of the standard deviation of the true one.
    pub error_percent_of_std: Option<f64>,
    /// Ratio of measured to true force for a head held still.
    pub gains: Vec<Gain>,
}

/// Ratio of measured to true force at a frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Ratio of the amplitudes, –.
    pub gain: f64,
}

impl Bending {
    /// Angular frequency, stiffness and damping: rad/s, N/m, N s/m.
    fn constants(&self) -> (f64, f64, f64) {
        let omega = std::f64::consts::TAU * self.frequency_hz;
        let stiffness = self.mass_kg * omega * omega;
        (omega, stiffness, 2.0 * self.damping_ratio * self.mass_kg * omega)
    }

    /// Inertia force `m_b ü` of the mode at every sample, N: `force` (N) presses on the middle of the strip, whose ends
    /// move with `velocity` (m/s) and `acceleration` (m/s²).
    fn inertia(&self, force: &[f64], velocity: &[f64], acceleration: &[f64], step: f64) -> Vec<f64> {
        let (omega, stiffness, damping) = self.constants();
        let parts = (omega * step / ANGLE).ceil().max(1.0) as usize;
        let h = step / parts as f64;
        // Deflection, and velocity of the middle: no acceleration of the ends is needed.
        let slope = |state: [f64; 2], force: f64, ends: f64| {
            let [deflection, middle] = state;
            let rate = middle - ends;
            [rate, (-force - stiffness * deflection - damping * rate) / self.mass_kg]
        };
        let start = |of: &[f64]| of.first().copied().unwrap_or_default();
        let mut state = [-start(force) / stiffness, start(velocity)];
        let mut found = Vec::with_capacity(force.len());
        for index in 0..force.len() {
            let (now, ends) = (force[index], velocity[index]);
            let [deflection, middle] = state;
            let spring = stiffness * deflection + damping * (middle - ends);
            found.push(-now - spring - self.mass_kg * acceleration[index]);
            let Some((&next, &next_ends)) = force.get(index + 1).zip(velocity.get(index + 1)) else {
                break;
            };
            for part in 0..parts {
                let at = |share: f64| {
                    let share = (part as f64 + share) / parts as f64;
                    (now + share * (next - now), ends + share * (next_ends - ends))
                };
                let step_by =
                    |from: [f64; 2], slope: [f64; 2], by: f64| [from[0] + by * slope[0], from[1] + by * slope[1]];
                let (begin, middle, end) = (at(0.0), at(0.5), at(1.0));
                let k1 = slope(state, begin.0, begin.1);
                let k2 = slope(step_by(state, k1, 0.5 * h), middle.0, middle.1);
                let k3 = slope(step_by(state, k2, 0.5 * h), middle.0, middle.1);
                let k4 = slope(step_by(state, k3, h), end.0, end.1);
                for i in 0..2 {
                    state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
                }
            }
        }
        found
    }

    /// Ratio of measured to true force for a head held still, –.
    pub(crate) fn gain_at(&self, frequency: f64) -> f64 {
        let (_, stiffness, damping) = self.constants();
        let omega = std::f64::consts::TAU * frequency;
        let spring = stiffness.hypot(damping * omega);
        spring / (stiffness - self.mass_kg * omega * omega).hypot(damping * omega)
    }
}

impl Instrument {
    /// Instruments of a scene whose time series has a row every `output_step` s.
    #[must_use]
    pub fn new(measurement: &Measurement, output_step: f64) -> Self {
        let mass_kg = measurement.bending_mass_share * measurement.strip_mass;
        let bending = measurement.bending_frequency.filter(|_| mass_kg > 0.0);
        Self {
            strip_mass: measurement.strip_mass,
            bending: bending.map(|frequency_hz| Bending {
                frequency_hz,
                mass_kg,
                damping_ratio: measurement.bending_damping_ratio,
            }),
            stride: measurement.stride(output_step),
            cell_error: measurement.cell_error_percent / 100.0,
            mass_error: measurement.mass_error_percent / 100.0,
            aerodynamic_correction: measurement.aerodynamic_correction,
        }
    }

    /// Measured force of a head at every `stride`-th row of its record, N; `step` is the time between two rows, s.
    #[must_use]
    pub fn measured(&self, head: &StripRecord, step: f64) -> Vec<f64> {
        let acceleration = derivative(&head.strip_vz, step);
        let bending = self.bending.map_or_else(
            || vec![0.0; head.force.len()],
            |mode| mode.inertia(&head.force, &head.strip_vz, &acceleration, step),
        );
        let lift = head.wind.as_ref().map(|wind| &wind.lift);
        let mean = lift.map_or(0.0, |lift| lift.iter().sum::<f64>() / lift.len().max(1) as f64);
        let correction = if self.aerodynamic_correction { mean } else { 0.0 };
        let sample = |index: usize| {
            let inertia = self.strip_mass * acceleration[index];
            let lift = lift.map_or(0.0, |lift| lift[index]);
            let cell = head.force[index] - lift + inertia + bending[index];
            (1.0 + self.cell_error) * cell - (1.0 + self.mass_error) * inertia + correction
        };
        (0..head.force.len()).step_by(self.stride.max(1)).map(sample).collect()
    }

    /// The measured force of a head, filtered as the evaluation filters the true one, N, and the times of its samples
    /// among those of the record (s); nothing where it cannot be filtered.
    #[must_use]
    pub fn filtered(&self, head: &StripRecord, evaluation: &Evaluation, time: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let step = evaluation.output_step;
        if head.strip_vz.len() != head.force.len() {
            return None;
        }
        let sampled = self.measured(head, step);
        let filter = evaluation
            .filter
            .design(evaluation.low_pass_hz, step * self.stride as f64)
            .ok()?;
        let times = time.iter().step_by(self.stride.max(1)).copied().collect();
        Some((times, filter.filter(&sampled).ok()?))
    }

    /// Figures of pantograph `index` (from 0): `filtered` is the true force as the evaluation filters it, N, whole
    /// record, over `time`, s.
    #[must_use]
    pub fn figures(
        &self,
        (index, head): (usize, &StripRecord),
        filtered: &[f64],
        evaluation: &Evaluation,
        time: &[f64],
    ) -> Option<Measured> {
        let (times, measured) = self.filtered(head, evaluation, time)?;
        let range = evaluation.samples(&times, index);
        let truth: Vec<f64> = filtered.iter().step_by(self.stride.max(1)).copied().collect();
        let (measured, truth) = (measured.get(range.clone())?, truth.get(range)?);
        let (statistics, true_statistics) = (ForceStatistics::of(measured)?, ForceStatistics::of(truth)?);
        let rms = rms_difference(measured, truth)?;
        let gain = |frequency_hz: f64| Gain {
            frequency_hz,
            gain: (1.0 + self.cell_error) * self.bending.map_or(1.0, |mode| mode.gain_at(frequency_hz)),
        };
        let gains = FREQUENCIES
            .into_iter()
            .filter(|frequency| *frequency <= evaluation.low_pass_hz);
        Some(Measured {
            filtered: statistics,
            error_percent_of_std: (true_statistics.std > 0.0).then(|| 100.0 * rms / true_statistics.std),
            gains: gains.map(gain).collect(),
        })
    }
}

/// Derivative of samples `step` s apart: central, at both ends one-sided.
fn derivative(values: &[f64], step: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |index: usize| {
        let (from, to) = (index.saturating_sub(1), (index + 1).min(last));
        if to == from {
            return 0.0;
        }
        (values[to] - values[from]) / (step * (to - from) as f64)
    };
    (0..values.len()).map(at).collect()
}
