//! Abilities of an FMU, tried out on instances of their own.
//!
//! A description may claim too much. Each claim that a coupling builds on is put to the test once:
//!
//! | claim | test |
//! | --- | --- |
//! | `canGetAndSetFMUstate` | three steps, back, the same steps: the outputs must be the same |
//! | `canHandleVariableCommunicationStepSize` | a step, half of it, a third of it |
//! | `canInterpolateInputs` | a step with derivatives of order 1, 2, 3 against pieces with the input held at its mean |
//! | (the wiring) | more force must push the strip down; a strip that rises must press harder |
//!
//! `providesDirectionalDerivative` and dependencies are not tested: this program builds on neither.

use crate::isolated::{isolation_of, time_limit};
use fmi2::import::Fmu;
use scene::{ParameterValue, Supplied};
use serde::Serialize;

use super::SupplierError;
use super::wiring::Wiring;
use cosim::slave::Abilities;
use fmi2::isolation::{self, Isolation};

mod bench;

use bench::Bench;

/// One claim.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Ability in question.
    pub subject: String,
    /// Claim of the description.
    pub claimed: String,
    /// `holds`, `does not hold`, `not claimed`, or what was found.
    pub found: String,
    /// Trial behind the finding.
    pub how: String,
}

/// Finding on a response that does not exist.
const NOT_SEEN: &str = "not seen";

/// Finding.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Probe {
    /// Trial under way, or the last one.
    pub stage: String,
    /// One per claim tried.
    pub findings: Vec<Finding>,
    /// True where the FMU goes back to a saved state exactly.
    pub rollback: Option<bool>,
    /// True where the FMU takes steps of different lengths.
    pub variable_step: Option<bool>,
    /// Highest order of input derivatives that it follows.
    pub input_derivatives: Option<usize>,
    /// Effective mass of the strip over a step, kg; negative where a force on the strip lifts it.
    pub effective_mass: Option<f64>,
    /// Height of the strip at its start, in our unit and without a scene's offset, m.
    pub start_height: Option<f64>,
    /// Stiffness with which a line answers a rising strip, N/m.
    pub stiffness: Option<f64>,
    /// Reason why the trial came to no end.
    pub failure: Option<String>,
    /// True where the process of the trial ended before the first step was done.
    pub ended_at_start: bool,
}

/// Request for a trial.
#[derive(Clone, Debug)]
pub struct Request {
    /// The FMU behind its wires.
    pub wiring: Wiring,
    /// Communication step of the run, s.
    pub step: f64,
    /// Simulated time that the FMU is told, s.
    pub duration: f64,
    /// Values of parameters.
    pub parameters: Vec<(String, ParameterValue)>,
    /// Isolation of the instances; nothing for a trial in this process.
    pub isolation: Option<Isolation>,
    /// Values of inputs during the initialisation, in the FMU's units; none leaves its own.
    pub initial: Vec<f64>,
}

impl Probe {
    /// Declared abilities that passed the trial.
    #[must_use]
    pub fn abilities(&self, claimed: Abilities) -> Abilities {
        let broken = self.failure.is_some();
        Abilities {
            rollback: claimed.rollback && self.rollback.unwrap_or(!broken),
            input_derivatives: claimed
                .input_derivatives
                .min(self.input_derivatives.unwrap_or(usize::from(!broken))),
            variable_step: claimed.variable_step && self.variable_step.unwrap_or(true),
        }
    }

    /// Refuses an FMU that has ended the process of its trial before the first step was done: it is not loaded into
    /// this process.
    ///
    /// # Errors
    /// [`SupplierError::Trial`] with the reason.
    pub fn check_start(&self) -> Result<(), SupplierError> {
        match &self.failure {
            Some(failure) if self.ended_at_start => Err(SupplierError::Trial {
                failure: failure.clone(),
            }),
            _ => Ok(()),
        }
    }

    /// Claims that do not hold, and what else a user should know.
    pub fn remarks(&self) -> impl Iterator<Item = String> {
        let broken = self.findings.iter().filter_map(|finding| match finding.found.as_str() {
            "does not hold" => Some(format!(
                "it claims {}, which does not hold: {}",
                finding.subject, finding.how
            )),
            NOT_SEEN => Some(format!(
                "it was not seen to answer to what the other side does to it, is it wired to the right variables? {}",
                finding.how
            )),
            _ => None,
        });
        broken.chain(self.failure.clone())
    }

    pub(super) fn add(&mut self, subject: &str, claimed: bool, found: &str, how: String) {
        self.findings.push(Finding {
            subject: subject.to_owned(),
            claimed: claimed.to_string(),
            found: found.to_owned(),
            how,
        });
    }
}

/// Isolation of a trial: in processes of their own where this program can start such; each call may take
/// as long as `entry` says.
#[must_use]
pub fn isolation(entry: &Supplied) -> Option<Isolation> {
    isolation_of(entry).or_else(|| {
        (cfg!(unix) && isolation::is_at_hand()).then(|| Isolation {
            time_limit: time_limit(entry),
            memory_limit: None,
            environment: std::collections::BTreeMap::new(),
        })
    })
}

/// Tries an FMU.
#[must_use]
pub fn probe(fmu: &Fmu, request: &Request) -> Probe {
    let mut found = Probe::default();
    if let Err(error) = Bench::new(fmu, request).run(&mut found) {
        found.ended_at_start = found.findings.is_empty() && crate::lost_a_process(&error);
        let consequence = if found.ended_at_start {
            ""
        } else {
            ", so that its claims are not relied on"
        };
        found.failure = Some(format!(
            "the trial ended while {}{consequence}: {}",
            found.stage,
            cosim::chain(&error)
        ));
    }
    found
}
