//! Reasons that end a sweep, or keep it from beginning.

use std::path::PathBuf;

use results::ResultsError;
use scene::SceneError;
use simulation::SetupError;

/// Reasons that end a sweep, or keep it from beginning; those of a single case stand in its row.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A wish of the command line or of the sweep's file.
    #[error("{place}: {what}")]
    Wish {
        /// File and key, or option of the command line.
        place: String,
        /// Value, and what would be right.
        what: String,
    },
    /// The scene itself.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// FMUs that all cases need.
    #[error(transparent)]
    Setup(Box<SetupError>),
    /// A folder with another sweep.
    #[error(
        "{}: holds the results of another sweep ({differs}); must be another folder, or one without {}",
        folder.display(),
        crate::journal::JOURNAL
    )]
    OtherSweep {
        /// Folder.
        folder: PathBuf,
        /// Parts that differ.
        differs: String,
    },
    /// A folder in which another process works.
    #[error(
        "{}: another process carries out a sweep there; must be another folder, or wait for its end",
        folder.display()
    )]
    Busy {
        /// Folder.
        folder: PathBuf,
    },
    /// Files of the sweep.
    #[error(transparent)]
    Results(#[from] ResultsError),
}

impl From<SetupError> for SweepError {
    fn from(error: SetupError) -> Self {
        Self::Setup(Box::new(error))
    }
}

impl SweepError {
    /// A wish that cannot be met.
    pub(crate) fn wish(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Wish {
            place: place.into(),
            what: what.into(),
        }
    }

    /// `true` where usage, scene or files given are wrong.
    #[must_use]
    pub fn is_input(&self) -> bool {
        match self {
            Self::Setup(error) => error.is_input(),
            Self::Results(_) => false,
            _ => true,
        }
    }
}
