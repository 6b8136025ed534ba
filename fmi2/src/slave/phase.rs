//! Legal calls by phase [FMI 2.0, 4.2.4].

use crate::model_description::{Causality, Initial, Variability, Variable};

/// Phase of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Phase {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated = 0,
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialization = 1,
    /// At a communication point.
    Step = 2,
    /// After a step that returned `fmi2Discard`.
    StepFailed = 3,
    /// After `fmi2Error`.
    Error = 4,
    /// After a panic of the model: its values cannot be trusted.
    Poisoned = 5,
    /// After `fmi2Terminate`.
    Terminated = 6,
}

impl Phase {
    /// The phase with that number, as it is serialised.
    pub(super) fn from_number(number: u8) -> Option<Self> {
        [
            Self::Instantiated,
            Self::Initialization,
            Self::Step,
            Self::StepFailed,
            Self::Error,
            Self::Poisoned,
            Self::Terminated,
        ]
        .into_iter()
        .find(|phase| *phase as u8 == number)
    }

    /// Name in messages.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Instantiated => "before initialisation",
            Self::Initialization => "in initialisation mode",
            Self::Step => "between steps",
            Self::StepFailed => "after a discarded step",
            Self::Error => "after an error",
            Self::Poisoned => "after a panic",
            Self::Terminated => "after fmi2Terminate",
        }
    }

    /// The table of calls and phases [FMI 2.0, 4.2.4]. Values may also be read after an error, for diagnosis, and
    /// any value in initialisation mode.
    pub(super) fn allows(self, call: Call) -> bool {
        use Phase::{Error, Initialization, Instantiated, Poisoned, Step, StepFailed, Terminated};
        match call {
            Call::SetupExperiment | Call::EnterInitializationMode => self == Instantiated,
            Call::ExitInitializationMode => self == Initialization,
            Call::Set | Call::SetRealInputDerivatives => {
                matches!(self, Instantiated | Initialization | Step)
            }
            Call::Get | Call::GetDirectionalDerivative => {
                matches!(self, Initialization | Step | StepFailed | Error | Terminated)
            }
            Call::GetRealOutputDerivatives => {
                matches!(self, Step | StepFailed | Error | Terminated)
            }
            Call::DoStep | Call::CancelStep => self == Step,
            Call::GetFmuState => self != Poisoned,
            Call::SetFmuState | Call::OtherState => true,
            Call::Terminate => matches!(self, Step | StepFailed),
            Call::GetStatus => matches!(self, Step | StepFailed | Terminated),
            Call::Reset | Call::SetDebugLogging => true,
        }
    }

    /// True if `variable` may be set [FMI 2.0, 4.2.4]; inputs also before initialisation mode, because importers set
    /// them there.
    pub(super) fn allows_setting(self, variable: &Variable) -> bool {
        if variable.variability == Variability::Constant || variable.causality == Causality::Independent {
            return false;
        }
        let input = variable.causality == Causality::Input;
        match self {
            Self::Instantiated => input || matches!(variable.initial, Some(Initial::Exact | Initial::Approx)),
            Self::Initialization => input || variable.initial == Some(Initial::Exact),
            Self::Step => {
                let parameter = variable.causality == Causality::Parameter;
                input || parameter && variable.variability == Variability::Tunable
            }
            _ => false,
        }
    }
}

/// Calls that share a row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Call {
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Set,
    Get,
    SetRealInputDerivatives,
    GetRealOutputDerivatives,
    GetDirectionalDerivative,
    DoStep,
    CancelStep,
    GetFmuState,
    SetFmuState,
    /// Free, serialise, deserialise: calls that do not touch the model.
    OtherState,
    Terminate,
    GetStatus,
    Reset,
    SetDebugLogging,
}

impl Call {
    /// True for a call that changes nothing: refused arguments leave the instance unchanged.
    pub(super) fn is_query(self) -> bool {
        matches!(
            self,
            Self::Get
                | Self::GetRealOutputDerivatives
                | Self::GetDirectionalDerivative
                | Self::CancelStep
                | Self::GetFmuState
                | Self::OtherState
                | Self::GetStatus
                | Self::SetDebugLogging
        )
    }
}
