//! Coupling algorithms: who steps when, and from which values.
//!
//! An algorithm advances a line and its pantographs over one macro step. It sees the [`Slave`] trait only.
//!
//! The strips that the line needs are predicted from the last communication points with the degree `extrapolation`:
//!
//! | degree | position | velocity |
//! | --- | --- | --- |
//! | 0 | held | held |
//! | 1 | `z + v τ` | held |
//! | 2 | `z + v τ + a τ²/2` | `v + a τ`, with `a` from the last two positions and velocities |
//!
//! What a pantograph is given, by `coupling.force` (steps in turn, the line first / where the force is not known yet):
//!
//! | force | force known | force predicted |
//! | --- | --- | --- |
//! | `mean` | mean of the step, held: the impulse is the same on both sides | mean extrapolated with the degree, held |
//! | `interpolated` | line from the start to the end force | polynomial of the degree through the last end forces |
//! | `end` | end force, held | last end force, held |
//!
//! A prediction does not look past a point at which the contact was open.

mod exchange;
mod gauss_seidel;
mod iterated;
mod jacobi;
#[cfg(test)]
mod mock;
mod polynomial;
mod predict;
#[cfg(test)]
mod tests;

pub use exchange::{Exchange, Point};
pub use gauss_seidel::GaussSeidel;
pub use iterated::Iterated;
pub use jacobi::Jacobi;
pub use polynomial::Polynomial;
pub(crate) use predict::strips as predicted_strips;

use scene::{Coupling, Force, Order};

use crate::slave::{Slave, SlaveError};

/// The two sides of the coupling.
pub struct Sides<'a> {
    /// The line, with all strips.
    pub line: &'a mut dyn Slave,
    /// One slave per strip, in the same order.
    pub pantographs: &'a mut [Box<dyn Slave>],
}

impl Sides<'_> {
    /// Whether every slave can go back to a saved state.
    #[must_use]
    pub fn can_roll_back(&self) -> bool {
        self.without_rollback().is_none()
    }

    /// Name of the first slave that cannot go back to a saved state.
    #[must_use]
    pub fn without_rollback(&self) -> Option<&str> {
        let line: &dyn Slave = &*self.line;
        std::iter::once(line)
            .chain(self.pantographs.iter().map(|slave| &**slave))
            .find(|slave| !slave.abilities().rollback)
            .map(Slave::name)
    }

    /// Whether every slave takes steps of any length.
    #[must_use]
    pub fn can_vary_step(&self) -> bool {
        self.line.abilities().variable_step && self.pantographs.iter().all(|slave| slave.abilities().variable_step)
    }

    /// Name of the first slave that takes steps of one length only.
    #[must_use]
    pub fn with_fixed_step(&self) -> Option<&str> {
        let line: &dyn Slave = &*self.line;
        std::iter::once(line)
            .chain(self.pantographs.iter().map(|slave| &**slave))
            .find(|slave| !slave.abilities().variable_step)
            .map(Slave::name)
    }

    /// Keeps the present state of every slave.
    ///
    /// # Errors
    /// The first error of a slave.
    pub fn save(&mut self) -> Result<(), SlaveError> {
        self.line.save()?;
        self.pantographs.iter_mut().try_for_each(|slave| slave.save())
    }

    /// Takes every slave back to the state kept last.
    ///
    /// # Errors
    /// The first error of a slave.
    pub fn restore(&mut self) -> Result<(), SlaveError> {
        self.line.restore()?;
        self.pantographs.iter_mut().try_for_each(|slave| slave.restore())
    }
}

/// Why a macro step was not completed.
#[derive(Debug, thiserror::Error)]
pub enum CouplingError {
    /// A slave failed.
    #[error(transparent)]
    Slave(#[from] SlaveError),
    /// The repeated step does not settle.
    #[error(
        "the coupling does not settle at t = {t} s (h = {h} s): the force still changes by {residual:.3e} N after \
         {iterations} iterations, tolerance {tolerance:.1e} N"
    )]
    NotConverged {
        /// Start of the step, s.
        t: f64,
        /// Length of the step, s.
        h: f64,
        /// Iterations done.
        iterations: usize,
        /// Last change of the force, N.
        residual: f64,
        /// Change that would have been accepted, N.
        tolerance: f64,
    },
    /// The algorithm needs what a slave cannot do.
    #[error(
        "coupling.algorithm = \"{algorithm}\": {slave} cannot go back to a saved state; must be \"jacobi\" or \"gauss_seidel\""
    )]
    NoRollback {
        /// Name of the algorithm.
        algorithm: &'static str,
        /// Name of the slave.
        slave: String,
    },
}

impl CouplingError {
    /// Whether the step may be tried again with a smaller length.
    #[must_use]
    pub fn is_retryable(&self) -> bool {
        match self {
            Self::Slave(error) => error.is_retryable(),
            Self::NotConverged { .. } => true,
            Self::NoRollback { .. } => false,
        }
    }
}

/// A way to advance both sides over one macro step.
pub trait Algorithm {
    /// Advances both sides from the present point of `exchange` by `h` s and writes what they have reached into
    /// [`Exchange::reached`]; the caller accepts it.
    ///
    /// Returns how often a side was taken back.
    ///
    /// # Errors
    /// [`CouplingError`]; the slaves may then stand anywhere inside the step, `exchange` is unchanged.
    fn step(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<u64, CouplingError>;

    /// Whether it saves the slaves at the start of a step itself.
    fn saves(&self) -> bool {
        false
    }
}

/// The algorithm that `[coupling]` asks for, and why, for the summary.
///
/// # Errors
/// [`CouplingError::NoRollback`] where a slave cannot do what the algorithm needs.
pub fn build(coupling: &Coupling, sides: &Sides<'_>) -> Result<(Box<dyn Algorithm>, String), CouplingError> {
    let strips = sides.pantographs.len();
    let (algorithm, predicted_force): (Box<dyn Algorithm>, bool) = match coupling.algorithm {
        scene::Algorithm::Jacobi => (Box::new(Jacobi::new(coupling, strips)), true),
        scene::Algorithm::GaussSeidel => (
            Box::new(GaussSeidel::new(coupling, strips)),
            coupling.order == Order::PantographFirst,
        ),
        scene::Algorithm::Iterated => {
            if let Some(slave) = sides.without_rollback() {
                let algorithm = coupling.algorithm.name();
                return Err(CouplingError::NoRollback {
                    algorithm,
                    slave: slave.to_owned(),
                });
            }
            (Box::new(Iterated::new(coupling, strips)), false)
        }
    };
    let mut reason = coupling.reason.to_owned();
    if coupling.algorithm == scene::Algorithm::Iterated && coupling.order == Order::PantographFirst {
        reason.push_str("; iterated always steps the line first");
    }
    let hermite = coupling.algorithm == scene::Algorithm::Iterated
        || (coupling.algorithm == scene::Algorithm::GaussSeidel && predicted_force);
    let strip_order = if hermite { 3 } else { coupling.extrapolation };
    let force_order = match coupling.force {
        Force::Interpolated if predicted_force => coupling.extrapolation,
        Force::Interpolated => 1,
        Force::Mean | Force::End => 0,
    };
    let line: &dyn Slave = &*sides.line;
    let needs =
        std::iter::once((line, strip_order)).chain(sides.pantographs.iter().map(|slave| (&**slave, force_order)));
    for (slave, order) in needs {
        let able = slave.abilities().input_derivatives;
        if able == 0 && order > 0 {
            reason.push_str(&format!(
                "; {} takes no input derivatives: its inputs are held at their mean over the step",
                slave.name()
            ));
        } else if able < order {
            reason.push_str(&format!(
                "; {} takes input derivatives of order {able} only: its inputs are polynomials of that degree",
                slave.name()
            ));
        }
    }
    Ok((algorithm, reason))
}
