//! Slaves made of FMUs.

use component::Component;
use fmi2::import::{Fmu, StepOutcome};
use fmi2::model_description::{BaseType, Causality, Variable};
use scene::{ParameterValue, Scene};

pub use crate::parameter::ExpectedValue;
use crate::slave::{Abilities, Slave, SlaveError, finite};
use component::Frame;
use component::Work;
use fmi2::instance::{FmuInstance, InstanceError, SavedState};
use fmi2::isolation::{Isolation, IsolationError, Reported};

mod drawing;
mod start;

use drawing::{CoreDrawing, Drawing};
pub use start::check_names;
use start::{find, initialised, references};

/// Reason why an FMU cannot take part.
#[derive(Debug, thiserror::Error)]
pub enum CosimulationError {
    /// The FMU itself reports it.
    #[error(transparent)]
    Fmi(#[from] fmi2::Error),
    /// Report or end of the process in which the FMU is isolated.
    #[error(transparent)]
    Isolation(#[from] IsolationError),
    /// No usable outputs at the start.
    #[error(transparent)]
    Slave(#[from] SlaveError),
    /// A variable that the wiring names.
    #[error("{fmu}: there is no {role} \"{variable}\"{nearest}")]
    NoVariable {
        /// Name of the model.
        fmu: String,
        /// `real input`, `real output` or `parameter`.
        role: &'static str,
        /// Name asked for.
        variable: String,
        /// `, did you mean …`, or nothing.
        nearest: String,
    },
    /// A parameter's value has another type.
    #[error("{fmu}: the parameter \"{variable}\" = {} must be {expected}", shown(value))]
    WrongType {
        /// Name of the model.
        fmu: String,
        /// Name of the parameter.
        variable: String,
        /// Value of the scene.
        value: ParameterValue,
        /// Value that the parameter takes.
        expected: ExpectedValue,
    },
}

impl From<InstanceError> for CosimulationError {
    fn from(error: InstanceError) -> Self {
        match error {
            InstanceError::Fmi(error) => Self::Fmi(error),
            InstanceError::Isolation(error) => Self::Isolation(error),
        }
    }
}

impl CosimulationError {
    /// True where the request is to blame, not the behaviour of the FMU.
    #[must_use]
    pub fn is_input(&self) -> bool {
        matches!(self, Self::NoVariable { .. } | Self::WrongType { .. }) || self.is_unfit()
    }

    /// True where the FMU cannot be used on this system at all.
    #[must_use]
    pub fn is_unfit(&self) -> bool {
        matches!(
            self,
            Self::Fmi(fmi2::Error::NoBinary { .. })
                | Self::Isolation(
                    IsolationError::Reported {
                        kind: Reported::Unfit,
                        ..
                    } | IsolationError::NotHere
                )
        )
    }

    /// True where a call of the FMU returned a bad status, so that another call may still be tried.
    #[must_use]
    pub fn is_refusal(&self) -> bool {
        matches!(
            self,
            Self::Fmi(fmi2::Error::Call { .. })
                | Self::Isolation(IsolationError::Reported {
                    kind: Reported::Refused,
                    ..
                })
        )
    }
}

/// A value as a scene has it.
fn shown(value: &ParameterValue) -> String {
    match value {
        ParameterValue::Number(number) => number.to_string(),
        ParameterValue::Boolean(flag) => flag.to_string(),
        ParameterValue::String(text) => format!("{text:?}"),
    }
}

/// Task of an FMU in a run.
#[derive(Clone, Debug, Default)]
pub struct Role {
    /// Name of the instance and of the slave.
    pub name: String,
    /// Names of the real inputs, in the order of the slices.
    pub inputs: Vec<String>,
    /// Names of the real outputs, in the order of the slices.
    pub outputs: Vec<String>,
    /// Values set before the initialisation.
    pub parameters: Vec<(String, ParameterValue)>,
    /// Values of the inputs set before the end of the initialisation; none leaves the FMU's own.
    pub initial: Vec<f64>,
    /// Stop time, s.
    pub duration: f64,
    /// Highest order of input derivatives that the FMU is known to follow; the standard has no word for it.
    pub input_derivatives: usize,
    /// True to ask for the FMU's debug messages.
    pub logging: bool,
    /// Isolation of the FMU; `None` where the FMU runs in this process.
    pub isolation: Option<Isolation>,
}

/// An initialised instance of an FMU as a slave.
pub struct FmuSlave {
    name: String,
    instance: Box<dyn FmuInstance>,
    logging: bool,
    abilities: Abilities,
    inputs: Vec<u32>,
    outputs: Vec<u32>,
    output_names: Vec<String>,
    orders: Vec<i32>,
    /// Counts of its work that it has, the first of [`fmu::WORK`].
    work: Vec<u32>,
    state: Option<SavedState>,
    t: f64,
    drawing: Option<Box<dyn Drawing>>,
    remarks: Vec<String>,
}

/// A step of which an FMU has completed a part only.
#[derive(Debug, thiserror::Error)]
#[error("fmi2DoStep returned fmi2Discard{0}")]
struct Discarded(String);

impl FmuSlave {
    /// Makes an instance, sets its parameters and initialises it at t = 0.
    ///
    /// # Errors
    /// A variable that does not exist, and whatever the FMU reports.
    pub fn start(fmu: &Fmu, role: Role) -> Result<Self, CosimulationError> {
        let description = fmu.description();
        let inputs = references(description, &role.inputs, Causality::Input)?;
        let outputs = references(description, &role.outputs, Causality::Output)?;
        let work = fmu::WORK.map(|(name, _)| {
            let fits = |variable: &Variable| variable.base_type() == BaseType::Integer;
            find(description, name, "integer output", fits).map(|variable| variable.value_reference)
        });
        let capabilities = &description.co_simulation;
        let abilities = Abilities {
            rollback: capabilities.can_get_and_set_fmu_state,
            input_derivatives: if capabilities.can_interpolate_inputs {
                role.input_derivatives
            } else {
                0
            },
            variable_step: capabilities.can_handle_variable_communication_step_size,
        };
        let mut remarks = Vec::new();
        let mut instance = match initialised(fmu, &role, &inputs, Some(role.duration)) {
            Err(refusal) if refusal.is_refusal() => {
                // Some FMUs refuse a stop time, or one beyond what they were made for.
                let Ok(instance) = initialised(fmu, &role, &inputs, None) else {
                    return Err(refusal);
                };
                remarks.push(format!(
                    "it refuses the stop time {} s and is run without one",
                    role.duration
                ));
                instance
            }
            other => other?,
        };
        instance.will_read(&outputs);
        let count = inputs.len();
        let mut slave = Self {
            name: role.name,
            instance,
            logging: role.logging,
            abilities,
            inputs,
            outputs,
            output_names: role.outputs,
            orders: vec![0; count],
            // FMUs of an older program lack the last of them.
            work: work.into_iter().map_while(Result::ok).collect(),
            state: None,
            t: 0.0,
            drawing: None,
            remarks,
        };
        slave.print_log();
        Ok(slave)
    }

    /// Prints the FMU's messages where they were asked for.
    fn print_log(&mut self) {
        if self.logging {
            for message in self.instance.take_log() {
                eprintln!("{}: {} {}", self.name, message.status, message.text);
            }
        }
    }

    /// Calls it `name` in messages.
    #[must_use]
    pub fn called(mut self, name: String) -> Self {
        self.name = name;
        self
    }

    /// Makes it claim no more than `abilities`.
    #[must_use]
    pub fn able(mut self, abilities: Abilities) -> Self {
        self.abilities = abilities;
        self
    }

    /// Notes on exceptions made for the FMU.
    #[must_use]
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// Makes it draw itself with a component of the core, built from `scene`, that takes over the FMU's states; for
    /// FMUs packaged from that scene only.
    #[must_use]
    pub fn drawn_by<C: Component>(mut self, scene: Scene, draw: fn(&mut C, &mut Frame)) -> Self {
        self.drawing = Some(Box::new(CoreDrawing {
            scene,
            draw,
            kept: Vec::new(),
        }));
        self
    }

    /// The instance, for what a slave does not offer.
    pub fn instance(&mut self) -> &mut dyn FmuInstance {
        &mut *self.instance
    }

    fn failed(&self, action: &'static str) -> impl FnOnce(InstanceError) -> SlaveError {
        let slave = self.name.clone();
        move |error| SlaveError::Call {
            slave,
            action,
            source: Box::new(error),
        }
    }

    fn step_failed(
        &self,
        t: f64,
        h: f64,
        retryable: bool,
        source: impl std::error::Error + Send + Sync + 'static,
    ) -> SlaveError {
        SlaveError::Step {
            slave: self.name.clone(),
            t,
            h,
            retryable,
            source: Box::new(source),
        }
    }
}

impl Slave for FmuSlave {
    fn name(&self) -> &str {
        &self.name
    }

    fn abilities(&self) -> Abilities {
        self.abilities
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        if values.is_empty() {
            return Ok(());
        }
        let result = self.instance.set_real(&self.inputs, values);
        result.map_err(self.failed("take its inputs"))
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        if values.is_empty() {
            return Ok(());
        }
        self.orders.fill(order as i32);
        let result = self
            .instance
            .set_real_input_derivatives(&self.inputs, &self.orders, values);
        result.map_err(self.failed("take input derivatives"))
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        match self.instance.do_step(t, h) {
            Ok(StepOutcome::Ok) => {
                self.t = t + h;
                self.print_log();
                Ok(())
            }
            Ok(StepOutcome::Discard) => {
                let log: Vec<String> = self
                    .instance
                    .take_log()
                    .into_iter()
                    .map(|message| message.text)
                    .collect();
                let mut text = String::new();
                if let Ok(Some(reached)) = self.instance.last_successful_time()
                    && reached > t
                {
                    text.push_str(&format!(" after it had come to t = {reached} s"));
                }
                let ended = self.instance.wants_to_terminate().unwrap_or(false);
                text.push_str(match (ended, self.abilities.rollback) {
                    (true, _) => ", as it wants to end the simulation",
                    (false, true) => "",
                    (false, false) => "; it cannot go back to try a shorter step: use a smaller coupling.macro_step",
                });
                if log.is_empty() {
                    text.push_str("; -vv asks it for the reason");
                } else {
                    text.push_str(&format!(": {}", log.join("; ")));
                }
                Err(self.step_failed(t, h, !ended, Discarded(text)))
            }
            Err(error) => Err(self.step_failed(t, h, false, error)),
        }
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        let result = self.instance.get_real(&self.outputs, values);
        result.map_err(self.failed("give its outputs"))?;
        finite(&self.name, &self.output_names, values, self.t)
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        let result = match self.state {
            Some(state) => self.instance.save_state_again(state),
            None => self.instance.save_state().map(|state| self.state = Some(state)),
        };
        result.map_err(self.failed("save its state"))
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        let state = self.state.expect("the contract of Slave: save comes before restore");
        let result = self.instance.restore_state(state);
        result.map_err(self.failed("go back to its saved state"))
    }

    fn work(&mut self) -> Work {
        let mut counts = [0; fmu::WORK.len()];
        let known = &mut counts[..self.work.len()];
        if !known.is_empty() && self.instance.get_integer(&self.work, known).is_err() {
            return Work::default();
        }
        let [micro_steps, newton_iterations, factorizations, above_tolerance] =
            counts.map(|count| u64::try_from(count).unwrap_or(0));
        Work {
            micro_steps,
            newton_iterations,
            factorizations,
            most_iterations: 0,
            above_tolerance,
        }
    }

    fn draw(&mut self, frame: &mut Frame) {
        let Some(drawing) = &mut self.drawing else { return };
        // A state that cannot be had leaves an empty picture: drawing never ends a run.
        let bytes = self.instance.save_state().and_then(|state| {
            let bytes = self.instance.serialize_state(state);
            self.instance.free_state(state)?;
            bytes
        });
        drawing.keep(bytes.unwrap_or_default(), frame);
    }

    fn finish_drawing(&mut self, frames: &mut [Frame]) {
        if let Some(drawing) = &mut self.drawing {
            drawing.finish(frames);
        }
    }
}
