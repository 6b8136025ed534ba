//! An FMU behind its wires, with the steps that it takes.

use fmi2::import::Fmu;
use fmi2::model_description::{Causality, ModelDescription};
use scene::Supplied;

use super::SupplierError;
use super::probe::{Probe, Request, isolation};
use super::wiring::{Wire, Wiring};
use crate::isolated::isolation_of;
use cosim::fmu_slave::{FmuSlave, Role};
use cosim::slave::{Abilities, Slave, SlaveError};

/// Highest order of derivatives that a step is cut into pieces for.
const HIGHEST: usize = dynamics::MAX_ORDER;

/// Part of a step by which a macro step may miss a whole number of an FMU's steps.
const ROUNDING: f64 = 1e-9;

/// A macro step that is no multiple of the only step that an FMU takes.
#[derive(Debug, thiserror::Error)]
#[error(
    "it takes steps of {unit} s only: a macro step must be a multiple of that, such as coupling.macro_step = {nearest}"
)]
struct NoMultiple {
    unit: f64,
    nearest: f64,
}

/// The multiple of `unit` nearest to `h`, both in s, without the digits of rounding.
pub(super) fn nearest_multiple(unit: f64, h: f64) -> f64 {
    let exact = unit * (h / unit).round().max(1.0);
    let digits = 15 - exact.log10().floor() as i32 - 3;
    let scale = 10_f64.powi(digits);
    let short = (exact * scale).round() / scale;
    if (short / exact - 1.0).abs() < 1e-12 {
        short
    } else {
        exact
    }
}

/// Number of steps of `unit` s in `h` s; `None` where it is not whole.
#[must_use]
pub fn pieces(unit: f64, h: f64) -> Option<usize> {
    let count = (h / unit).round();
    (count >= 1.0 && (h / unit - count).abs() <= ROUNDING * count).then_some(count as usize)
}

/// The only step that an FMU takes as far as its description says, s.
pub(super) fn fixed_step(description: &ModelDescription) -> Option<f64> {
    if description.co_simulation.can_handle_variable_communication_step_size {
        return None;
    }
    let step = description
        .default_experiment
        .and_then(|experiment| experiment.step_size);
    step.filter(|step| *step > 0.0)
}

/// An initialised FMU that is given polynomials of our values and steps as it can.
pub(super) struct Driven {
    slave: FmuSlave,
    wiring: Wiring,
    abilities: Abilities,
    /// The only step it takes, s.
    unit: Option<f64>,
    /// Inputs and their derivatives at the start of the coming step, in the FMU's units.
    given: [Vec<f64>; HIGHEST + 1],
    /// Highest order that has been set since the inputs were.
    degree: usize,
    sent: Vec<f64>,
    read: Vec<f64>,
    /// Lead of the FMU's clock over that of the run, s.
    pub ahead: f64,
}

/// Settings of the FMU besides its wiring.
pub(super) struct Setting<'a> {
    /// Name of the instance: ASCII.
    pub name: String,
    /// Table of the FMU in the scene.
    pub entry: &'a Supplied,
    /// Values of inputs during the initialisation, in the FMU's units; none leaves its own.
    pub initial: Vec<f64>,
    /// Parameters besides those of the scene.
    pub parameters: Vec<(String, scene::ParameterValue)>,
    /// Stop time, s.
    pub duration: f64,
    /// True to ask for the FMU's debug messages.
    pub logging: bool,
}

/// The request for a trial in communication steps of `step` s.
pub(super) fn request(wiring: &Wiring, step: f64, setting: &Setting<'_>) -> Request {
    let of_scene = setting.entry.parameters.clone();
    Request {
        wiring: wiring.clone(),
        step,
        duration: setting.duration,
        parameters: setting.parameters.iter().cloned().chain(of_scene).collect(),
        initial: setting.initial.clone(),
        isolation: isolation(setting.entry),
    }
}

/// The role of an FMU behind `wiring`.
pub(super) fn role(wiring: &Wiring, setting: &Setting<'_>) -> Role {
    let names = |wires: &[Wire]| wires.iter().map(|wire| wire.variable.clone()).collect();
    let own = setting
        .entry
        .parameters
        .iter()
        .map(|(name, value)| (name.clone(), value.clone()));
    Role {
        name: setting.name.clone(),
        inputs: names(&wiring.inputs),
        outputs: names(&wiring.outputs),
        parameters: setting.parameters.iter().cloned().chain(own).collect(),
        initial: setting.initial.clone(),
        duration: setting.duration,
        input_derivatives: HIGHEST,
        logging: setting.logging,
        isolation: isolation_of(setting.entry),
    }
}

impl Driven {
    /// Instantiates and initialises the FMU; what it can do is what `probe` found.
    ///
    /// # Errors
    /// A variable that does not exist, whatever the FMU reports, and in this process an FMU that ended its trial.
    pub fn start(fmu: &Fmu, wiring: Wiring, setting: &Setting<'_>, probe: &Probe) -> Result<Self, SupplierError> {
        if !setting.entry.isolate {
            probe.check_start()?;
        }
        let file = fmu.path().file_name().unwrap_or_default().to_string_lossy();
        let slave = FmuSlave::start(fmu, role(&wiring, setting))?.called(format!("{} ({file})", setting.name));
        let abilities = probe.abilities(slave.abilities());
        let slave = slave.able(abilities);
        let inputs = || vec![0.0; wiring.inputs.len()];
        Ok(Self {
            abilities,
            unit: fixed_step(fmu.description()),
            given: std::array::from_fn(|_| inputs()),
            degree: 0,
            sent: inputs(),
            read: vec![0.0; wiring.outputs.len()],
            ahead: 0.0,
            slave,
            wiring,
        })
    }

    pub fn name(&self) -> &str {
        self.slave.name()
    }

    /// Notes on exceptions made for the FMU.
    pub fn remarks(&self) -> &[String] {
        self.slave.remarks()
    }

    pub fn wiring(&self) -> &Wiring {
        &self.wiring
    }

    /// The only step it takes, s.
    pub fn unit(&self) -> Option<f64> {
        self.unit
    }

    /// Abilities in macro steps of `h` s: a step that is cut into pieces follows its inputs from piece to piece.
    pub fn abilities(&self, h: f64) -> Abilities {
        let cut = self
            .unit
            .and_then(|unit| pieces(unit, h))
            .is_some_and(|count| count > 1);
        Abilities {
            input_derivatives: if cut { HIGHEST } else { self.abilities.input_derivatives },
            ..self.abilities
        }
    }

    /// Sets the values (order 0) or derivatives of all inputs; `ours` says what each wire's value is in our units.
    pub fn set(&mut self, order: usize, mut ours: impl FnMut(usize) -> f64) {
        let wires = self.wiring.inputs.iter().zip(&mut self.given[order]).enumerate();
        for (k, (wire, given)) in wires {
            *given = wire.factor * ours(k) + if order == 0 { wire.offset } else { 0.0 };
        }
        if order == 0 {
            for given in &mut self.given[1..] {
                given.fill(0.0);
            }
        }
        self.degree = order;
    }

    /// Advances by `h` s from `t` s of the run.
    ///
    /// # Errors
    /// Error reported by the FMU, and a step that the FMU does not take.
    pub fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        let t = t + self.ahead;
        let (count, piece) = match self.unit {
            None => (1, h),
            Some(unit) => match pieces(unit, h) {
                Some(count) => (count, unit),
                None => {
                    let nearest = nearest_multiple(unit, h);
                    return Err(SlaveError::Step {
                        slave: self.slave.name().to_owned(),
                        t,
                        h,
                        retryable: false,
                        source: Box::new(NoMultiple { unit, nearest }),
                    });
                }
            },
        };
        let able = self.abilities.input_derivatives;
        for n in 0..count {
            let tau = n as f64 * piece;
            if able == 0 && count > 1 && self.degree > 0 {
                // Held at the mean over the piece: the impulse is that of the polynomial.
                for k in 0..self.sent.len() {
                    self.sent[k] = (self.integral(k, tau + piece) - self.integral(k, tau)) / piece;
                }
                self.slave.set_inputs(&self.sent)?;
            } else {
                for order in 0..=self.degree.min(able) {
                    for k in 0..self.sent.len() {
                        self.sent[k] = self.derivative(k, order, tau);
                    }
                    if order == 0 {
                        self.slave.set_inputs(&self.sent)?;
                    } else {
                        self.slave.set_input_derivatives(order, &self.sent)?;
                    }
                }
            }
            self.slave.do_step(t + tau, piece)?;
        }
        Ok(())
    }

    /// Derivative of `order` of input `k` at `tau` s after the start of the step.
    fn derivative(&self, k: usize, order: usize, tau: f64) -> f64 {
        let (mut sum, mut power) = (0.0, 1.0);
        for m in order..=self.degree {
            sum += self.given[m][k] * power;
            power *= tau / (m - order + 1) as f64;
        }
        sum
    }

    /// Integral of input `k` over the first `tau` s of the step.
    fn integral(&self, k: usize, tau: f64) -> f64 {
        let (mut sum, mut power) = (0.0, tau);
        for m in 0..=self.degree {
            sum += self.given[m][k] * power;
            power *= tau / (m + 2) as f64;
        }
        sum
    }

    /// Reads all outputs, in our units, and hands them to `take` with their wire.
    ///
    /// # Errors
    /// Error reported by the FMU, and values that are no numbers.
    pub fn read(&mut self, mut take: impl FnMut(usize, f64)) -> Result<(), SlaveError> {
        self.slave.outputs(&mut self.read)?;
        for (k, (wire, value)) in self.wiring.outputs.iter().zip(&self.read).enumerate() {
            take(k, wire.factor * value + wire.offset);
        }
        Ok(())
    }

    /// Adds `offset`, in our unit, to the output `k`.
    pub fn shift(&mut self, k: usize, offset: f64) {
        self.wiring.outputs[k].offset += offset;
    }

    pub fn save(&mut self) -> Result<(), SlaveError> {
        self.slave.save()
    }

    pub fn restore(&mut self) -> Result<(), SlaveError> {
        self.slave.restore()
    }
}

/// Start value of the input that `wire` leads to, in our unit.
pub(super) fn start_value(description: &ModelDescription, wire: &Wire) -> Option<f64> {
    let variable = description
        .variables
        .iter()
        .find(|variable| variable.name == wire.variable && variable.causality == Causality::Input)?;
    Some((variable.real_start()? - wire.offset) / wire.factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_macro_step_is_cut_into_whole_steps_or_refused() {
        assert_eq!(pieces(2.5e-4, 1e-3), Some(4));
        assert_eq!(pieces(1e-3, 1e-3), Some(1));
        assert_eq!(pieces(1e-3 / 3.0, 1e-3), Some(3));
        assert_eq!(pieces(4e-4, 1e-3), None);
        assert_eq!(pieces(2e-3, 1e-3), None);
        assert_eq!(nearest_multiple(3e-4, 1e-3), 9e-4);
        assert_eq!(nearest_multiple(1e-2, 1e-3), 1e-2);
    }
}
