//! Supplied FMUs: pantographs and lines behind the scene's wiring, and system structures in and out.
//!
//! ```text
//! module      subject
//! guess       which variables are probably meant, where the scene does not say
//! wiring      linear maps between our values and the FMU's
//! units       units of variables against ours
//! quantity    what our names in the wiring stand for
//! probe       what the FMU can do, tried out
//! driven      the FMU behind its wires, with the steps it takes
//! velocity    rates of what is offered without one
//! pantograph  such an FMU as a pantograph
//! line        such an FMU as a line
//! controller  such an FMU as the rule of a controlled drive
//! commanded   a pantograph whose commands come from such a controller
//! settling    the phase at rest before t = 0
//! inspect     report on an FMU, with a wiring to paste
//! ssp         systems in and out
//! ```

#![forbid(unsafe_code)]

mod commanded;
mod controller;
mod driven;
mod guess;
pub mod inspect;
mod isolated;
mod line;
mod pantograph;
mod probe;
mod quantity;
pub mod settling;
pub mod ssp;
mod units;
mod velocity;
mod wiring;

pub use commanded::Commanded;
pub use controller::SuppliedController;
pub use driven::pieces;
pub use guess::Guess;
use guess::{guess, side};
pub use isolated::time_limit;
pub use line::{StripAtStart, SuppliedLine, own_heights};
pub use pantograph::{SuppliedPantograph, aligned};
pub use probe::{Finding, Probe};
use probe::{Request, isolation, probe};
pub use quantity::Side;
use quantity::unit;
pub use wiring::{Wire, Wiring, WiringError};

use std::error::Error;

use cosim::fmu_slave::CosimulationError;
use fmi2::instance::InstanceError;
use fmi2::isolation::IsolationError;

/// Reason why a supplied FMU cannot take part.
#[derive(Debug, thiserror::Error)]
pub enum SupplierError {
    /// Variables of the FMU, or an error reported by the FMU.
    #[error(transparent)]
    Fmu(#[from] CosimulationError),
    /// Wiring of the FMU.
    #[error(transparent)]
    Wiring(#[from] WiringError),
    /// A force on its strip moves it the wrong way.
    #[error(
        "{variable}: {force} N more push the strip up: the sign is probably the other one; must be factor = {factor}"
    )]
    Sign {
        /// Our name of the input.
        name: String,
        /// The FMU's name.
        variable: String,
        /// Force tried, N.
        force: f64,
        /// Factor that would push down.
        factor: f64,
    },
    /// The macro step is no multiple of the FMU's own.
    #[error(
        "coupling.macro_step = {macro_step} s: the FMU takes steps of {unit} s only (stepSize of its default \
         experiment, canHandleVariableCommunicationStepSize = false): must be a multiple of that, such as {nearest}"
    )]
    Step {
        /// Step of the scene, s.
        macro_step: f64,
        /// Step of the FMU, s.
        unit: f64,
        /// A multiple, s.
        nearest: f64,
    },
    /// The time between two samples is no multiple of the step of a controller.
    #[error(
        "pantograph[{pantograph}].control.sample_time = {sample_time} s: the controller takes steps of {unit} s only \
         (stepSize of its default experiment, canHandleVariableCommunicationStepSize = false): must be a multiple of \
         that, such as {nearest}"
    )]
    Sample {
        /// Number of the pantograph.
        pantograph: usize,
        /// Time between two samples, s.
        sample_time: f64,
        /// Step of the FMU, s.
        unit: f64,
        /// A multiple, s.
        nearest: f64,
    },
    /// The strip starts far above the wire.
    #[error(
        "the strip starts at a height of {height:.3} m, where it would press with more than {force} N: the wire, at \
         {wire:.3} m without a strip, would be at {lifted:.3} m then; must be nearer the wire, by the FMU's \
         parameters, a number of metres as offset, or offset = \"align\""
    )]
    Height {
        /// Height of the strip at its start, m.
        height: f64,
        /// Height of the wire without a strip, m.
        wire: f64,
        /// Force that no strip starts with, N.
        force: f64,
        /// Height of the wire under it, m.
        lifted: f64,
    },
    /// A crash, an endless call or an end of the process in the trial.
    #[error("it is not loaded into this program: {failure}")]
    Trial {
        /// Report of the trial.
        failure: String,
    },
}

impl SupplierError {
    /// True where the scene or the file is to blame, not the program.
    #[must_use]
    pub fn is_input(&self) -> bool {
        match self {
            Self::Fmu(error) => error.is_input(),
            Self::Trial { .. } => false,
            Self::Wiring(_) | Self::Sign { .. } | Self::Step { .. } | Self::Sample { .. } | Self::Height { .. } => true,
        }
    }
}

/// `true` where an error comes of the process of an isolated FMU: it was killed or crashed, took too long, or did not
/// start.
#[must_use]
pub fn lost_a_process(error: &(dyn Error + 'static)) -> bool {
    if let Some(error) = error.downcast_ref::<IsolationError>() {
        return !matches!(error, IsolationError::Reported { .. } | IsolationError::NotHere);
    }
    // An error that shows the message of the one that it holds shows its source too, and not the one itself.
    let held: Option<&(dyn Error + 'static)> = if let Some(InstanceError::Isolation(held)) = error.downcast_ref() {
        Some(held)
    } else if let Some(CosimulationError::Isolation(held)) = error.downcast_ref() {
        Some(held)
    } else {
        match error.downcast_ref() {
            Some(SupplierError::Fmu(held)) => Some(held),
            Some(SupplierError::Trial { .. }) => return true,
            _ => error.source(),
        }
    };
    held.is_some_and(lost_a_process)
}

/// Simulated time that an FMU is told for a run of `duration` s: the phase at rest before it, and a last step that is
/// no shorter than the others, included.
fn told_duration(scene: &scene::Scene) -> f64 {
    scene.run.duration + crate::settling::LONGEST + 2.0 * scene.coupling.macro_step
}

/// Refuses a macro step that an FMU cannot be stepped with.
fn check_step(unit: Option<f64>, macro_step: f64) -> Result<(), SupplierError> {
    match unit {
        Some(unit) if driven::pieces(unit, macro_step).is_none() => Err(SupplierError::Step {
            macro_step,
            unit,
            nearest: driven::nearest_multiple(unit, macro_step),
        }),
        _ => Ok(()),
    }
}
