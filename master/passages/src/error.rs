//! Reasons that end many passages, or keep them from beginning.

use results::ResultsError;
use simulation::SetupError;

/// Reasons that end many passages, or keep them from beginning.
#[derive(Debug, thiserror::Error)]
pub enum PassagesError {
    /// A demand on the scene.
    #[error("{0}")]
    Scene(String),
    /// A run that cannot begin.
    #[error("{passages} passages")]
    Setup {
        /// Passages before it.
        passages: u64,
        /// Reason.
        #[source]
        source: Box<SetupError>,
    },
    /// A run that does not reach its end.
    #[error("the run after {passages} passages is incomplete: {reason}")]
    Incomplete {
        /// Passages before it.
        passages: u64,
        /// Reason.
        reason: String,
    },
    /// Files.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl PassagesError {
    /// `true` where usage or scene are wrong.
    #[must_use]
    pub fn is_input(&self) -> bool {
        match self {
            Self::Scene(_) => true,
            Self::Setup { source, .. } => source.is_input(),
            Self::Incomplete { .. } | Self::Results(_) => false,
        }
    }
}
