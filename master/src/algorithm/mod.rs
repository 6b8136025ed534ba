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
mod interface_jacobian;
mod iterated;
mod jacobi;
#[cfg(test)]
mod mock;
mod polynomial;
mod predict;
#[cfg(test)]
mod tests;
pub mod waveform;

pub use exchange::{Defect, Exchange, Point};
pub use gauss_seidel::GaussSeidel;
pub use interface_jacobian::InterfaceJacobian;
pub use iterated::Iterated;
pub use jacobi::Jacobi;
pub use polynomial::Polynomial;

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
}

impl CouplingError {
    /// Whether the step may be tried again with a smaller length.
    #[must_use]
    pub fn is_retryable(&self) -> bool {
        match self {
            Self::Slave(error) => error.is_retryable(),
            Self::NotConverged { .. } => true,
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

/// `[coupling]` with `"auto"` replaced by what suits the slaves; all else as it is.
///
/// One rule: [`InterfaceJacobian`] where every pantograph follows a force inside the step, for then what a pass leaves over
/// can be made up for in the next one. A pantograph that holds its inputs cannot; [`GaussSeidel`] with the mean force, the
/// line first, keeps the impulse exactly and is neutral up to `ωh = 2`.
#[must_use]
pub fn resolve(coupling: &Coupling, sides: &Sides<'_>) -> Coupling {
    let mut resolved = coupling.clone();
    if coupling.algorithm != scene::Algorithm::Auto {
        return resolved;
    }
    let follows = sides
        .pantographs
        .iter()
        .all(|slave| slave.abilities().input_derivatives > 0);
    if follows {
        resolved.algorithm = scene::Algorithm::InterfaceJacobian;
        (resolved.order, resolved.force, resolved.extrapolation) = (Order::PantographFirst, Force::Interpolated, 2);
        resolved.reason = if !sides.can_roll_back() || coupling.max_iterations == 1 {
            "auto: one pass, whose error is made up for in the next step; stable while the contact's frequency times the \
             macro step is below 1.2, beyond that the macro step must be shorter"
        } else {
            "auto: Newton with the interface Jacobian of the step, most steps in one pass whose error is made up for in the \
             next step"
        };
    } else {
        resolved.algorithm = scene::Algorithm::GaussSeidel;
        (resolved.order, resolved.force, resolved.extrapolation) = (Order::CatenaryFirst, Force::Mean, 1);
        resolved.reason = "auto: a pantograph holds its inputs over a step: Gauss-Seidel, the line first, passes the line's \
                           mean force on, which conserves the impulse; stable while the contact's frequency times the macro \
                           step is below 2, beyond that the macro step must be shorter";
    }
    resolved
}

/// The algorithm that `[coupling]` asks for, and why, for the summary.
#[must_use]
pub fn build(coupling: &Coupling, sides: &Sides<'_>) -> (Box<dyn Algorithm>, String) {
    let coupling = &resolve(coupling, sides);
    let strips = sides.pantographs.len();
    let mut reason = coupling.reason.to_owned();
    let rollback = sides.can_roll_back();
    if let Some(slave) = sides.without_rollback()
        && matches!(
            coupling.algorithm,
            scene::Algorithm::Iterated | scene::Algorithm::InterfaceJacobian
        )
    {
        reason.push_str(&format!("; {slave} cannot go back to a saved state: one pass per step"));
    }
    let pantograph_first = coupling.order == Order::PantographFirst;
    let interpolated = usize::from(coupling.force == Force::Interpolated);
    // Orders of input derivatives: of the line, of a pantograph.
    let (algorithm, strip_order, force_order): (Box<dyn Algorithm>, usize, usize) = match coupling.algorithm {
        scene::Algorithm::Jacobi => (
            Box::new(Jacobi::new(coupling, strips)),
            coupling.extrapolation,
            interpolated * coupling.extrapolation,
        ),
        scene::Algorithm::Iterated if rollback => (Box::new(Iterated::new(coupling, strips)), 3, interpolated),
        scene::Algorithm::GaussSeidel | scene::Algorithm::Iterated => (
            Box::new(GaussSeidel::new(coupling, strips)),
            if pantograph_first { 3 } else { coupling.extrapolation },
            interpolated * if pantograph_first { coupling.extrapolation } else { 1 },
        ),
        scene::Algorithm::InterfaceJacobian | scene::Algorithm::Auto => {
            if !pantograph_first {
                reason.push_str("; interface_jacobian always steps the pantographs first");
            }
            let order = match coupling.force {
                Force::Mean => 0,
                Force::End => 1,
                Force::Interpolated => 2,
            };
            (Box::new(InterfaceJacobian::new(coupling, strips, rollback)), 3, order)
        }
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
    (algorithm, reason)
}
