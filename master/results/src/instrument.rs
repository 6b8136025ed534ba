//! Contact force as a measuring train takes it: load cells under the strips, and accelerometers beside them.
//!
//! ```text
//! F_cell = F − L + m a + 2/π m_b ü                balance of what lies on the cells, its weight taken off
//! F_measured = (1 + e_g) F_cell − (1 + e_m) m a + L̄
//! m_b/2 ü + c u̇ + k u = −F − 2/π m_b a           first mode sin(π s/l) of a uniform beam on its ends, F in the middle
//! ```
//!
//! `a` is the acceleration of the head where the accelerometers sit, over the cells; `m` the mass above the cells,
//! `m_b` that of the strip that bends, `u` the deflection of its middle, `L` the lift of the air above the cells, `L̄`
//! its mean over the record. A rigid strip has `ü = 0`: lift and errors apart, the sum is the contact force [EN 50317].
//! A strip that bends hides the acceleration of its middle from the accelerometers. For a head held still
//!
//! ```text
//! F_measured/F = 1 + (4/π) r²/(1 − r² + 2 i ζ r)      r = f/f₀
//! ```
//!
//! of which the whole beam, `½ (1/cos b + 1/cosh b)` with `b = π/2 √r`, differs by the modes above the first.
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
    /// Mass of the strip that bends, kg.
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

/// Share of a uniform beam on its ends that moves in its first mode, by the amplitude of the middle, –.
const MODAL: f64 = 0.5;

/// Share of it that the ends feel and act on, –.
const SHARED: f64 = std::f64::consts::FRAC_2_PI;

impl Bending {
    /// Angular frequency, modal mass, stiffness and damping: rad/s, kg, N/m, N s/m.
    fn constants(&self) -> (f64, f64, f64, f64) {
        let omega = std::f64::consts::TAU * self.frequency_hz;
        let mass = MODAL * self.mass_kg;
        let (stiffness, damping) = (mass * omega * omega, 2.0 * self.damping_ratio * mass * omega);
        (omega, mass, stiffness, damping)
    }

    /// Inertia force `2/π m_b ü` of the mode on the cells at every sample, N: `force` (N) presses on the middle of the
    /// strip, whose ends move with `acceleration` (m/s²).
    fn inertia(&self, force: &[f64], acceleration: &[f64], step: f64) -> Vec<f64> {
        let (omega, mass, stiffness, damping) = self.constants();
        let shared = SHARED * self.mass_kg;
        let parts = (omega * step / ANGLE).ceil().max(1.0) as usize;
        let h = step / parts as f64;
        let bent = |[deflection, rate]: [f64; 2], force: f64, ends: f64| {
            (-force - stiffness * deflection - damping * rate - shared * ends) / mass
        };
        let mut state = [-force.first().copied().unwrap_or_default() / stiffness, 0.0];
        let mut rates = Vec::with_capacity(force.len());
        for index in 0..force.len() {
            let (now, ends) = (force[index], acceleration[index]);
            rates.push(state[1]);
            let Some((&next, &next_ends)) = force.get(index + 1).zip(acceleration.get(index + 1)) else {
                break;
            };
            for part in 0..parts {
                let slope = |state: [f64; 2], share: f64| {
                    let share = (part as f64 + share) / parts as f64;
                    let load = (now + share * (next - now), ends + share * (next_ends - ends));
                    [state[1], bent(state, load.0, load.1)]
                };
                let by = |slope: [f64; 2], h: f64| [state[0] + h * slope[0], state[1] + h * slope[1]];
                let k1 = slope(state, 0.0);
                let k2 = slope(by(k1, 0.5 * h), 0.5);
                let k3 = slope(by(k2, 0.5 * h), 0.5);
                let k4 = slope(by(k3, h), 1.0);
                for i in 0..2 {
                    state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
                }
            }
        }
        // Of the rate: the balance at a sample sees loads that the straight lines between samples do not reach.
        derivative(&rates, step).into_iter().map(|rate| shared * rate).collect()
    }

    /// Ratio of measured to true force for a head held still, –.
    pub(crate) fn gain_at(&self, frequency: f64) -> f64 {
        let ratio = frequency / self.frequency_hz;
        let (re, im) = (1.0 - ratio * ratio, 2.0 * self.damping_ratio * ratio);
        let excess = SHARED / MODAL * ratio * ratio;
        (re + excess).hypot(im) / re.hypot(im)
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
            |mode| mode.inertia(&head.force, &acceleration, step),
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
