//! Options, errors and work counters of Newton's method.
use crate::{Formulation, System};
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::fmt;
use std::sync::Arc;

/// Residual of generalised forces up to which a time step serves before its second correction, N.
///
/// First corrections leave residuals alike from step to step, which act as a force that is not there. What second
/// corrections leave is mostly far below a tolerance.
const OF_FIRST_CORRECTION: f64 = 1e-2;

/// Occasions for a new iteration matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Jacobian {
    /// One factorisation is kept until it converges too slowly (default).
    Modified,
    /// Factored in every iteration, exact contact tangent included: quadratic convergence.
    Full,
}

/// Options of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Largest residual of a generalised force at convergence, N (N·m for slopes and rotations), evaluated or estimated
    /// from the contractions of the steps before.
    pub tolerance: f64,
    /// Largest residual of a constraint at convergence, m (–).
    pub constraint_tolerance: f64,
    /// Iterations before the step is given up.
    pub max_iterations: usize,
    /// See [`Jacobian`].
    pub jacobian: Jacobian,
    /// See [`Formulation`]; statics have no accelerations and take index 3.
    pub formulation: Formulation,
    /// Corrections of every time step, whatever they leave, without a new factorisation: for steps that must end in
    /// time. `None`: as many as it takes.
    pub passes: Option<usize>,
}

impl Default for NewtonOptions {
    /// 1e-6 N is 1e-8 of a contact force; 1e-12 m is rounding at the size of a pantograph.
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            constraint_tolerance: 1e-12,
            max_iterations: 30,
            jacobian: Jacobian::Modified,
            formulation: Formulation::Index3,
            passes: None,
        }
    }
}

impl NewtonOptions {
    /// Part of the tolerance up to which the residual of a time step serves after so many corrections.
    pub(crate) fn served_after(&self, corrections: usize) -> f64 {
        if corrections < 2 {
            (OF_FIRST_CORRECTION / self.tolerance).min(1.0)
        } else {
            1.0
        }
    }

    /// Tolerance for the residual of an unknown; the first unknowns are `coordinates`, then come constraints.
    pub(crate) fn tolerance_of(&self, unknown: usize, coordinates: usize) -> f64 {
        if unknown < coordinates {
            self.tolerance
        } else {
            self.constraint_tolerance
        }
    }
}

/// Error of a part that is not of this program, such as an FMU; its kind is found by downcasting its sources.
#[derive(Clone, Debug)]
pub struct OutsideError(Arc<dyn Error + Send + Sync>);

impl OutsideError {
    /// An error of a part outside.
    pub fn new(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self(Arc::from(error.into()))
    }
}

impl fmt::Display for OutsideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Error for OutsideError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.0.source()
    }
}

/// The same error, not one with the same text.
impl PartialEq for OutsideError {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Reasons why no equilibrium was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Newton's method used all its iterations; a smaller `h` may help.
    #[error(
        "no equilibrium at t = {t} s (h = {h} s): residual {residual:.3e} {unit} after {iterations} iterations, \
         tolerance {tolerance:.1e} {unit}, largest at {coordinate}",
        unit = unit(coordinate)
    )]
    NotConverged {
        /// Time aimed at, s.
        t: f64,
        /// Step, s; 0 for statics.
        h: f64,
        /// Iterations used.
        iterations: usize,
        /// Largest residual left, N or m.
        residual: f64,
        /// Tolerance, N or m.
        tolerance: f64,
        /// Name of the coordinate with the largest residual.
        coordinate: String,
    },
    /// The iteration matrix is singular: the model is under-constrained, no `h` will help.
    #[error("iteration matrix is singular at t = {t} s, near {coordinate}")]
    Singular {
        /// Time aimed at, s.
        t: f64,
        /// Name of a coordinate that nothing holds.
        coordinate: String,
    },
    /// A force or coordinate is not a finite number.
    #[error("{coordinate} has no finite residual at t = {t} s")]
    NotFinite {
        /// Time aimed at, s.
        t: f64,
        /// Name of the coordinate.
        coordinate: String,
    },
    /// The communication step has more internal steps than are made at once.
    #[error("a step of h = {h} s at t = {t} s has more than {MOST_MICRO_STEPS} internal steps of {micro_step} s")]
    TooLong {
        /// Start of the step, s.
        t: f64,
        /// Step, s.
        h: f64,
        /// Longest internal step, s.
        micro_step: f64,
    },
    /// A controller outside of the system gives no command.
    #[error("no command of the controller at t = {t} s")]
    NoCommand {
        /// Time of the sample, s.
        t: f64,
        /// Error of the controller.
        #[source]
        source: OutsideError,
    },
    /// A saved state is of another system, or damaged.
    #[error("the saved state is not of this system: it has {found} {what}, must have {expected}")]
    OtherSystem {
        /// Things that are counted.
        what: &'static str,
        /// Their number in the saved state.
        found: usize,
        /// Their number in this system.
        expected: usize,
    },
}

/// Most internal steps of a communication step: hours of simulated time, and no importer asks for more at once.
pub const MOST_MICRO_STEPS: usize = 100_000_000;

impl StepError {
    /// Refuses a saved state that has another number of things than the system.
    ///
    /// # Errors
    /// [`StepError::OtherSystem`].
    pub fn unless_as_many(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self::OtherSystem { what, found, expected })
    }

    /// Returns `true` if a master may roll back and try again with a smaller step (`fmi2Discard`): a residual that is
    /// no number may be the overshoot of a step that was too long.
    #[must_use]
    pub fn is_retryable(&self) -> bool {
        matches!(
            self,
            Self::NotConverged { .. } | Self::NotFinite { .. } | Self::TooLong { .. }
        )
    }
}

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Time steps.
    pub micro_steps: u64,
    /// Newton corrections.
    pub newton_iterations: u64,
    /// Numeric factorisations.
    pub factorizations: u64,
    /// Solutions with the factors.
    pub solves: u64,
    /// Most Newton corrections of one time step.
    #[serde(default)]
    pub most_iterations: u64,
    /// Time steps whose last residual was estimated and not evaluated.
    #[serde(default)]
    pub estimated: u64,
    /// Time steps of fixed [`NewtonOptions::passes`] that ended above a tolerance.
    #[serde(default)]
    pub above_tolerance: u64,
}

/// Name of constraint equations in messages.
const EQUATION: &str = "constraint equation";

/// Name of a coordinate or multiplier for messages.
pub(crate) fn name(system: &dyn System, unknown: usize) -> String {
    let coordinates = system.layout().coordinates();
    if unknown < coordinates {
        system.layout().name(unknown)
    } else {
        format!("{EQUATION} {}", unknown - coordinates + 1)
    }
}

/// Unit of the residual of an unknown with a name of [`name`].
fn unit(name: &str) -> &'static str {
    if name.starts_with(EQUATION) { "m" } else { "N" }
}
