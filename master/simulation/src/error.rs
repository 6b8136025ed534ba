//! Why a run cannot begin.

use std::error::Error;

use catenary::CatenaryError;
use scene::SceneError;

use cosim::algorithm::CouplingError;
use cosim::fmu_slave::CosimulationError;
use cosim::package::PackageError;
use cosim::slave::SlaveError;
use suppliers::SupplierError;
use suppliers::settling::SettlingError;
use system::equilibrium::EquilibriumError;
use system::one_system::OneSystemError;

/// Why a run cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The line is larger than the memory that is free.
    #[error(
        "catenary.spans = {spans}: the line has {coordinates:.0} coordinates and needs about {needed:.1} GB of memory, \
         and this machine has {free:.1} GB free: must be {remedy}"
    )]
    Memory {
        /// Spans of the line.
        spans: usize,
        /// Coordinates of the line.
        coordinates: f64,
        /// Memory that it needs, GB.
        needed: f64,
        /// Memory that is free, GB.
        free: f64,
        /// Other values that would do.
        remedy: &'static str,
    },
    /// The line has no static state.
    #[error("the line of the scene")]
    Line(#[from] CatenaryError),
    /// The line in the wind.
    #[error(transparent)]
    Galloping(#[from] system::galloping::GallopingError),
    /// There is no start.
    #[error("the state at t = 0")]
    Equilibrium(#[from] EquilibriumError),
    /// Statics that find no answer, with the keys of the scene to be looked at.
    #[error("{statics_hints}")]
    NoStatics {
        /// Keys with their values.
        statics_hints: String,
        /// Missing item.
        #[source]
        source: Box<SetupError>,
    },
    /// A demand of the scene that the mode cannot meet.
    #[error("--mode {mode}: {what}")]
    NotInThisMode {
        /// Name of the mode.
        mode: &'static str,
        /// Demand of the scene.
        what: String,
    },
    /// A demand that no mode can meet yet.
    #[error("{0}")]
    NotAvailable(String),
    /// An FMU file cannot be used.
    #[error(transparent)]
    FmuFile(Box<fmi2::Error>),
    /// An FMU file that the scene names cannot be used.
    #[error("{key}")]
    SceneFmu {
        /// Key of the scene.
        key: String,
        /// Reason.
        #[source]
        source: Box<fmi2::Error>,
    },
    /// A supplied FMU does not fit what the scene says of it.
    #[error("{key}")]
    Wiring {
        /// Key of the scene.
        key: String,
        /// Reason.
        #[source]
        source: Box<SupplierError>,
    },
    /// An FMU cannot be made.
    #[error(transparent)]
    Package(Box<PackageError>),
    /// An FMU does not start.
    #[error(transparent)]
    Cosimulation(#[from] CosimulationError),
    /// A pantograph cannot be built.
    #[error("pantograph[{pantograph}]")]
    Pantograph {
        /// From 1.
        pantograph: usize,
        /// Reason.
        #[source]
        source: vehicle::VehicleError,
    },
    /// One system cannot be built.
    #[error(transparent)]
    Monolithic(#[from] OneSystemError),
    /// The coupling cannot be set up.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// The phase at rest before t = 0.
    #[error(transparent)]
    Settling(#[from] SettlingError),
    /// A slave does not give its outputs at the start.
    #[error(transparent)]
    Slave(#[from] SlaveError),
}

impl From<PackageError> for SetupError {
    fn from(error: PackageError) -> Self {
        Self::Package(Box::new(error))
    }
}

impl SetupError {
    /// True where the input is wrong, false where the computation failed.
    #[must_use]
    pub fn is_input(&self) -> bool {
        matches!(
            self,
            Self::Scene(_)
                | Self::Memory { .. }
                | Self::Line(_)
                | Self::Equilibrium(_)
                | Self::NoStatics { .. }
                | Self::NotInThisMode { .. }
                | Self::NotAvailable(_)
                | Self::FmuFile(_)
                | Self::SceneFmu { .. }
        ) || matches!(self, Self::Wiring { source, .. } if source.is_input())
            || matches!(self, Self::Cosimulation(source) if source.is_input())
            || matches!(self, Self::Settling(source) if source.is_input())
    }

    /// True where an FMU file is the reason, which all runs of a scene have in common.
    #[must_use]
    pub fn concerns_all_runs(&self) -> bool {
        matches!(self, Self::Package(_) | Self::FmuFile(_) | Self::SceneFmu { .. })
    }
}

/// `true` where an error comes of the process of an isolated FMU: it was killed or crashed, took too long, or did not
/// start.
#[must_use]
pub fn lost_a_process(error: &(dyn Error + 'static)) -> bool {
    // An error that shows the message of the one that it holds shows its source too, and not the one itself.
    match error.downcast_ref() {
        Some(SetupError::Cosimulation(held)) => suppliers::lost_a_process(held),
        Some(SetupError::Wiring { source, .. }) => suppliers::lost_a_process(&**source),
        _ => suppliers::lost_a_process(error) || error.source().is_some_and(lost_a_process),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmi2::instance::InstanceError;
    use fmi2::isolation::IsolationError;
    use system::run::Failure;

    #[test]
    fn a_run_whose_fmu_lost_its_process_is_told_from_one_that_its_fmu_refused() {
        let gone = || IsolationError::Gone {
            instance: "pantograph".to_owned(),
        };
        let refused = || IsolationError::Reported {
            message: "no".to_owned(),
            kind: fmi2::isolation::Reported::Refused,
        };
        let in_a_step = |error: IsolationError| {
            let source = Box::new(InstanceError::Isolation(error));
            SlaveError::Step {
                slave: "pantograph".to_owned(),
                t: 0.5,
                h: 1e-3,
                retryable: false,
                source,
            }
        };
        let wired = |error: IsolationError| SetupError::Wiring {
            key: "pantograph[1]".to_owned(),
            source: Box::new(SupplierError::Fmu(CosimulationError::Isolation(error))),
        };
        let ways: [fn(SlaveError) -> Box<dyn Error>; 3] = [
            |error| Box::new(Failure::Step(CouplingError::Slave(error))),
            |error| Box::new(SetupError::from(SettlingError::Step(error))),
            |error| Box::new(SetupError::Cosimulation(CosimulationError::Slave(error))),
        ];
        for way in ways {
            assert!(lost_a_process(&*way(in_a_step(gone()))));
            assert!(!lost_a_process(&*way(in_a_step(refused()))));
        }
        assert!(lost_a_process(&wired(gone())) && !lost_a_process(&wired(refused())));
    }
}
