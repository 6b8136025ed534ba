//! The trials themselves.

use fmi2::import::Fmu;

use super::{NOT_SEEN, Probe, Request};
use crate::driven::{fixed_step, start_value};
use crate::quantity::Side;
use cosim::fmu_slave::{CosimulationError, FmuSlave, Role};
use cosim::slave::{Abilities, Slave, SlaveError};

/// Change of a force that responses are watched under, N.
const FORCE: f64 = 20.0;

/// Change of a velocity that a controller is watched under, m/s.
const VELOCITY: f64 = 0.1;

/// Change of a height, m: what presses some 50 N more on a stiff contact.
const HEIGHT: f64 = 1e-3;

/// Difference after going back that counts as none, relative to the value and at least to 1: some 1e-6 N of contact
/// force.
const EXACT: f64 = 1e-11;

/// Part of its effect by which a followed derivative may miss the pieces.
const FOLLOWED: f64 = 0.25;

/// Number of halvings of a discarded first step, as in a run.
const HALVINGS: i32 = 6;

/// Pieces of a step.
const PIECES: usize = 16;

/// Steps that a response is watched over.
const WATCHED: usize = 4;

/// Values watched on an instance.
#[derive(Clone, Debug, PartialEq)]
struct Seen(Vec<f64>);

/// Instances that are tried.
pub(super) struct Bench<'a> {
    fmu: &'a Fmu,
    request: &'a Request,
    role: Role,
    claimed: Abilities,
    /// Step that is taken, s.
    h: f64,
    /// Values of the inputs, in the FMU's units.
    rest: Vec<f64>,
    /// The change that is tried, in the FMU's units; 0 on inputs that are left alone.
    change: Vec<f64>,
    /// The output that is watched: velocity, or else height; the force of a line.
    watched: usize,
    slave: Option<FmuSlave>,
    /// True where the first state of `slave` is saved and going back can be relied on.
    can_return: bool,
}

impl<'a> Bench<'a> {
    /// Nothing is started yet.
    pub fn new(fmu: &'a Fmu, request: &'a Request) -> Self {
        let description = fmu.description();
        let wiring = &request.wiring;
        let capabilities = &description.co_simulation;
        let names = |wires: &[crate::Wire]| wires.iter().map(|wire| wire.variable.clone()).collect();
        let role = Role {
            name: "trial".to_owned(),
            inputs: names(&wiring.inputs),
            outputs: names(&wiring.outputs),
            parameters: request.parameters.clone(),
            initial: request.initial.clone(),
            duration: request.duration,
            input_derivatives: dynamics::MAX_ORDER,
            logging: false,
            isolation: request.isolation.clone(),
        };
        let rest = wiring.inputs.iter().enumerate().map(|(k, wire)| {
            let start = start_value(description, wire).unwrap_or(0.0);
            request
                .initial
                .get(k)
                .copied()
                .unwrap_or(wire.factor * start + wire.offset)
        });
        let change = wiring.inputs.iter().map(|wire| {
            wire.factor
                * match (wiring.side, wire.name.as_str()) {
                    (Side::Pantograph, "force") => FORCE,
                    (Side::Pantograph, "force_z") => -FORCE,
                    (Side::Line, "strip[1].z") => HEIGHT,
                    (Side::Controller, "force") => FORCE,
                    (Side::Controller, "velocity" | "head_velocity") => VELOCITY,
                    (Side::Controller, "position" | "head_height") => HEIGHT,
                    _ => 0.0,
                }
        });
        let names: &[&str] = match wiring.side {
            Side::Pantograph => &["velocity", "height"],
            Side::Line => &["contact[1].force", "contact[1].fz"],
            Side::Controller => &["command"],
        };
        let watched = names
            .iter()
            .find_map(|name| wiring.outputs.iter().position(|wire| wire.name == *name))
            .unwrap_or(0);
        Self {
            fmu,
            request,
            role,
            claimed: Abilities {
                rollback: capabilities.can_get_and_set_fmu_state,
                input_derivatives: usize::from(capabilities.can_interpolate_inputs),
                variable_step: capabilities.can_handle_variable_communication_step_size,
            },
            h: fixed_step(description).unwrap_or(request.step),
            rest: rest.collect(),
            change: change.collect(),
            watched,
            slave: None,
            can_return: false,
        }
    }

    /// An instance at its start.
    fn in_place(&mut self) -> Result<&mut FmuSlave, CosimulationError> {
        if self.can_return
            && let Some(slave) = &mut self.slave
        {
            slave.restore()?;
        } else {
            // Some FMUs allow one instance at a time.
            self.slave = None;
            let mut slave = FmuSlave::start(self.fmu, self.role.clone())?;
            if self.can_return {
                slave.save()?;
            }
            self.slave = Some(slave);
        }
        Ok(self.slave.as_mut().expect("made above"))
    }

    /// The inputs, changed by `part`.
    fn inputs(&self, part: f64) -> Vec<f64> {
        self.rest
            .iter()
            .zip(&self.change)
            .map(|(rest, change)| rest + part * change)
            .collect()
    }

    fn seen(slave: &mut FmuSlave, count: usize) -> Result<Seen, SlaveError> {
        let mut values = vec![0.0; count];
        slave.outputs(&mut values)?;
        Ok(Seen(values))
    }

    /// Steps of one length from the start, each with the inputs changed by its part; what is watched afterwards.
    fn watch(&mut self, parts: &[f64], h: f64) -> Result<f64, CosimulationError> {
        let (outputs, watched) = (self.request.wiring.outputs.len(), self.watched);
        let inputs: Vec<Vec<f64>> = parts.iter().map(|part| self.inputs(*part)).collect();
        let slave = self.in_place()?;
        for (n, inputs) in inputs.iter().enumerate() {
            slave.set_inputs(inputs)?;
            slave.do_step(n as f64 * h, h)?;
        }
        Ok(Self::seen(slave, outputs)?.0[watched])
    }

    /// Tries one claim after the other.
    ///
    /// # Errors
    /// The instance ends or refuses what every FMU must do; `found` says what was being tried.
    pub fn run(&mut self, found: &mut Probe) -> Result<(), CosimulationError> {
        let stage = |found: &mut Probe, text: String| found.stage = text;
        stage(found, "initialising an instance".to_owned());
        self.in_place()?;
        stage(found, format!("taking the first step, of {} s", self.h));
        self.first_step(found)?;
        let capability = "canGetAndSetFMUstate";
        if self.claimed.rollback {
            stage(found, format!("trying {capability}"));
            let (holds, how) = self.goes_back();
            found.rollback = Some(holds);
            found.add(capability, true, if holds { "holds" } else { "does not hold" }, how);
            self.can_return = holds;
            self.slave = None;
        } else {
            found.add(capability, false, "not claimed", "nothing is tried".to_owned());
        }
        if self.request.wiring.side == Side::Controller {
            // Its steps are its samples, under held inputs.
            stage(found, "watching the response to a change".to_owned());
            self.response(found)?;
            found.stage = "done".to_owned();
            return Ok(());
        }
        let capability = "canHandleVariableCommunicationStepSize";
        if self.claimed.variable_step {
            stage(found, format!("trying {capability}"));
            let (holds, how) = self.varies();
            found.variable_step = Some(holds);
            found.add(capability, true, if holds { "holds" } else { "does not hold" }, how);
        } else {
            let how = match fixed_step(self.fmu.description()) {
                Some(step) => {
                    format!("steps of {step} s, the stepSize of its default experiment; a macro step is cut into them")
                }
                None => "every step has the length of the macro step".to_owned(),
            };
            found.add(capability, false, "not claimed", how);
        }
        stage(found, "watching the response to a change".to_owned());
        self.response(found)?;
        let capability = "canInterpolateInputs";
        if self.claimed.input_derivatives > 0 {
            stage(found, format!("trying {capability}"));
            self.derivatives(found)?;
        } else {
            found.add(
                capability,
                false,
                "not claimed",
                "inputs are held over a step".to_owned(),
            );
        }
        let capabilities = &self.fmu.description().co_simulation;
        let how = "not tried: no algorithm of this program builds on it".to_owned();
        found.add(
            "providesDirectionalDerivative",
            capabilities.provides_directional_derivative,
            "not used",
            how,
        );
        found.stage = "done".to_owned();
        Ok(())
    }

    fn first_step(&mut self, found: &mut Probe) -> Result<(), CosimulationError> {
        let (outputs, inputs) = (self.request.wiring.outputs.len(), self.inputs(0.0));
        let height = self
            .request
            .wiring
            .outputs
            .iter()
            .position(|wire| wire.name == "height");
        let shortest = self.h * 0.5_f64.powi(HALVINGS);
        let start = loop {
            let h = self.h;
            let slave = self.in_place()?;
            let start = Self::seen(slave, outputs)?;
            slave.set_inputs(&inputs)?;
            match slave.do_step(0.0, h) {
                Ok(()) => {
                    Self::seen(slave, outputs)?;
                    break start;
                }
                // A run takes shorter steps as well where the FMU asks for them.
                Err(error) if error.is_retryable() && self.claimed.variable_step && 0.5 * h >= shortest => {
                    self.h = 0.5 * h;
                    self.slave = None;
                }
                Err(error) => return Err(error.into()),
            }
        };
        let h = self.h;
        let wires = &self.request.wiring.outputs;
        found.start_height = height.map(|k| wires[k].factor * start.0[k] + wires[k].offset);
        found.add(
            "a step",
            true,
            "holds",
            format!("of {h} s from its start; the outputs are finite"),
        );
        Ok(())
    }

    /// True where the same steps after going back end in the same outputs.
    fn goes_back(&mut self) -> (bool, String) {
        let worst = self.returned();
        match worst {
            Ok(0.0) => (
                true,
                "the same three steps after going back, twice: the same bits".to_owned(),
            ),
            Ok(worst) if worst <= EXACT => (
                true,
                format!("the same three steps after going back, twice: the same to within {worst:.1e}"),
            ),
            Ok(worst) => (
                false,
                format!(
                    "the same three steps after going back end elsewhere, by {worst:.1e} of the outputs: it is not \
                     taken back"
                ),
            ),
            Err(error) => (false, cosim::chain(&error)),
        }
    }

    /// Largest relative difference of outputs between steps and the same steps after going back.
    fn returned(&mut self) -> Result<f64, CosimulationError> {
        let (outputs, h) = (self.request.wiring.outputs.len(), self.h);
        let before = self.inputs(0.0);
        let parts = [1.0, -0.5, 0.25].map(|part| self.inputs(part));
        let slave = self.in_place()?;
        slave.set_inputs(&before)?;
        slave.do_step(0.0, h)?;
        slave.save()?;
        let mut seen: Vec<Vec<Seen>> = Vec::new();
        for pass in 0..3 {
            if pass > 0 {
                slave.restore()?;
            }
            let mut steps = Vec::new();
            for (n, inputs) in parts.iter().enumerate() {
                slave.set_inputs(inputs)?;
                slave.do_step((n + 1) as f64 * h, h)?;
                steps.push(Self::seen(slave, outputs)?);
            }
            seen.push(steps);
        }
        let mut worst = 0.0_f64;
        for pass in &seen[1..] {
            for (again, first) in pass.iter().zip(&seen[0]) {
                for (a, b) in again.0.iter().zip(&first.0) {
                    worst = worst.max((a - b).abs() / b.abs().max(1.0));
                }
            }
        }
        Ok(worst)
    }

    fn varies(&mut self) -> (bool, String) {
        let h = self.h;
        let steps = [h, h / 2.0, h / 3.0];
        let mut try_all = || -> Result<(), CosimulationError> {
            let inputs = self.inputs(0.0);
            let slave = self.in_place()?;
            let mut t = 0.0;
            for step in steps {
                slave.set_inputs(&inputs)?;
                slave.do_step(t, step)?;
                t += step;
            }
            Ok(())
        };
        match try_all() {
            Ok(()) => (
                true,
                format!("steps of {:.3e}, {:.3e} and {:.3e} s", steps[0], steps[1], steps[2]),
            ),
            Err(error) => {
                // An instance after an error is of no use.
                self.slave = None;
                (false, cosim::chain(&error))
            }
        }
    }

    /// Response to a change of the input: direction, and resistance.
    fn response(&mut self, found: &mut Probe) -> Result<(), CosimulationError> {
        let h = self.h;
        let left_alone = self.watch(&[0.0; WATCHED], h)?;
        let changed = self.watch(&[1.0; WATCHED], h)?;
        let wire = &self.request.wiring.outputs[self.watched];
        let difference = wire.factor * (changed - left_alone);
        let name = &wire.name;
        if difference.abs() <= EXACT {
            let how = format!("{name} does not change within {WATCHED} steps");
            found.add("response", true, NOT_SEEN, how);
            return Ok(());
        }
        match self.request.wiring.side {
            Side::Pantograph => {
                let time = WATCHED as f64 * h;
                let impulse = if name == "velocity" { time } else { 0.5 * time * time };
                let mass = -FORCE * impulse / difference;
                let how = format!(
                    "{FORCE} N more change {name} by {difference:.3e} within {WATCHED} steps: as {mass:.3} kg would"
                );
                found.add("response", true, if mass > 0.0 { "pushed down" } else { "lifted" }, how);
                found.effective_mass = Some(mass);
            }
            Side::Controller => {
                let how = format!(
                    "{FORCE} N more, or {VELOCITY} m/s, change {name} by {difference:.3e} N within {WATCHED} samples"
                );
                found.add("response", true, "commands", how);
            }
            Side::Line => {
                let sign = if name.ends_with("fz") { -1.0 } else { 1.0 };
                let stiffness = sign * difference / HEIGHT;
                let how = format!(
                    "a strip {HEIGHT} m higher changes the force by {:.3} N",
                    sign * difference
                );
                found.add(
                    "response",
                    true,
                    if stiffness > 0.0 {
                        "presses harder"
                    } else {
                        "presses less"
                    },
                    how,
                );
                found.stiffness = Some(stiffness);
            }
        }
        Ok(())
    }

    /// The end of one step with a derivative of `order` that makes up the change at its end.
    fn with_derivative(&mut self, order: usize) -> Result<f64, CosimulationError> {
        let (outputs, watched, h) = (self.request.wiring.outputs.len(), self.watched, self.h);
        let inputs = self.inputs(0.0);
        let mut scale = 1.0;
        for k in 1..=order {
            scale *= k as f64 / h;
        }
        let rates: Vec<f64> = self.change.iter().map(|change| change * scale).collect();
        let slave = self.in_place()?;
        slave.set_inputs(&inputs)?;
        slave.set_input_derivatives(order, &rates)?;
        slave.do_step(0.0, h)?;
        Ok(Self::seen(slave, outputs)?.0[watched])
    }

    fn derivatives(&mut self, found: &mut Probe) -> Result<(), CosimulationError> {
        let capability = "canInterpolateInputs";
        let varies = found.variable_step == Some(true);
        let held = self.watch(&[0.0], self.h)?;
        let mut highest = 0;
        let mut how = Vec::new();
        for order in 1..=dynamics::MAX_ORDER {
            if !varies && order > 1 {
                how.push("higher orders cannot be told without steps of different lengths".to_owned());
                break;
            }
            // Mean of the part τᵏ over each piece of the step, or over all of it.
            let pieces = if varies { PIECES } else { 1 };
            let power = order as i32 + 1;
            let parts: Vec<f64> = (0..pieces)
                .map(|n| {
                    let end = |n: usize| (n as f64 / pieces as f64).powi(power);
                    (end(n + 1) - end(n)) * pieces as f64 / f64::from(power)
                })
                .collect();
            let expected = self.watch(&parts, self.h / pieces as f64)? - held;
            if expected.abs() <= EXACT * held.abs().max(1.0) * 10.0 {
                how.push(format!("order {order} cannot be told: nothing responds within a step"));
                found.input_derivatives = (order > 1).then_some(highest);
                found.add(capability, true, "not known", how.join("; "));
                return Ok(());
            }
            let effect = match self.with_derivative(order) {
                Ok(reached) => reached - held,
                Err(error) => {
                    // An instance after an error is of no use.
                    self.slave = None;
                    how.push(format!("order {order}: {}", cosim::chain(&error)));
                    break;
                }
            };
            let ratio = effect / expected;
            // An FMU with one internal step in this one takes the mean of both ends, 1/2 instead of 1/(k + 1).
            let most = if order == 1 { 1.0 } else { 0.5 * (order + 1) as f64 };
            let follows = if varies {
                (1.0 - FOLLOWED..=most * (1.0 + FOLLOWED)).contains(&ratio)
            } else {
                (0.4..=1.3).contains(&ratio)
            };
            if !follows {
                how.push(format!(
                    "order {order} has {ratio:.2} of the effect that it should have"
                ));
                break;
            }
            how.push(format!("order {order} is followed"));
            highest = order;
        }
        found.input_derivatives = Some(highest);
        found.add(
            capability,
            true,
            if highest > 0 { "holds" } else { "does not hold" },
            how.join("; "),
        );
        Ok(())
    }
}
