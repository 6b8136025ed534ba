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
//! Force given to a pantograph, by `coupling.force` (steps in turn, the line first / where the force is not known yet):
//!
//! | force | force known | force predicted |
//! | --- | --- | --- |
//! | `mean` | mean of the step, held: the impulse is the same on both sides | mean extrapolated with the degree, held |
//! | `interpolated` | line from the start to the end force | polynomial of the degree through the last end forces |
//! | `end` | end force, held | last end force, held |
//!
//! A prediction does not look past a point at which the contact was open.
//!
//! Order and stability limit of the algorithms on an undamped head on a spring (ω frequency, h macro step; largest `ωh`
//! as [`stability`] finds them; "–": grows slowly at any step):
//!
//! | algorithm | line gets | pantograph gets | order | stable to `ωh` | needs |
//! | --- | --- | --- | --- | --- | --- |
//! | jacobi, `mean`, 1 | `z + v τ` | extrapolated mean | 2 | – | nothing |
//! | jacobi, `interpolated`, 2 | `z + v τ + a τ²/2` | extrapolated parabola | 3 | 0.6 | derivatives 2, 2 |
//! | gauss_seidel, line first, `mean`, 1 | `z + v τ` | mean of the step | 2 | 2.0, neutral | line follows velocities |
//! | gauss_seidel, line first, `interpolated`, 2 | `z + v τ + a τ²/2` | straight line | 2 | 1.5 | derivatives 2, 1 |
//! | gauss_seidel, pantograph first, `interpolated`, 2 | cubic | extrapolated parabola | 3 | 0.9 | derivatives 3, 2 |
//! | iterated | cubic | mean, or straight line | 2 | 3.4, neutral | derivatives 3, 1, rollback |
//! | interface_jacobian, one pass, `mean` | cubic | held mean, and last defect | 2 | 1.2 | derivatives 3, 0 |
//! | interface_jacobian, one pass, `end` | cubic | straight line through the end forces | 2 | – | derivatives 3, 1 |
//! | interface_jacobian, one pass, 1 | cubic | extrapolated line, and last defect | 4 | 1.26 | derivatives 3, 1 |
//! | interface_jacobian, one pass, 2 | cubic | extrapolated parabola, and last defect | 4 | 1.33 | derivatives 3, 2 |
//! | interface_jacobian, repeated | cubic | mean and moment of the force | 4 | 2.9, neutral | same, rollback |
//! | auto, one pass | as chosen | as chosen | 4, then 2 | 2.0, beyond in parts | the same |
//!
//! `iterated` keeps Aitken's relaxation: one strip is one stiff direction, and it settles in 3 to 5 passes wherever the
//! repeated step has a solution; `interface_jacobian` is the one with a Jacobian. `order` means nothing to
//! `interface_jacobian`, which always steps the pantographs first, and says so.
//!
//! `auto` ([`Auto`]) takes `interface_jacobian` where the pantographs follow a force inside the step and `ωh` allows
//! it, else `gauss_seidel` with the mean.

mod auto;
mod exchange;
mod frequency;
mod gauss_seidel;
mod interface_jacobian;
mod iterated;
mod jacobi;
#[cfg(test)]
mod mock;
mod oscillator;
mod polynomial;
mod predict;
pub mod stability;
#[cfg(test)]
mod tests;
mod waveform;

pub use auto::Auto;
pub use exchange::{Defect, Exchange};
pub use frequency::Frequency;
pub use gauss_seidel::GaussSeidel;
pub use interface_jacobian::InterfaceJacobian;
pub use iterated::Iterated;
pub use jacobi::Jacobi;
pub use polynomial::Polynomial;
pub(crate) use predict::strips as predicted_strips;
pub use waveform::{Shape, Waveform};

use scene::{Coupling, Force, Order};

use crate::slave::{Slave, SlaveError};

/// The two sides of the coupling.
pub struct Sides<'a> {
    /// The line, with all strips.
    pub line: &'a mut dyn Slave,
    /// One slave per strip, in the same order; see [`crate::head`] for heads with several.
    pub pantographs: &'a mut [Box<dyn Slave>],
}

impl Sides<'_> {
    /// True where every slave can go back to a saved state.
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

    /// True where every slave takes steps of any length.
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

/// Reason why a macro step was not completed.
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
    /// True where the step may be tried again with a smaller length.
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

    /// True where the algorithm itself saves the slaves at the start of a step.
    fn saves(&self) -> bool {
        false
    }

    /// In how many equal parts a step of `h` s from the present point should be done, each a step of its own; asked
    /// before each step where every slave takes any.
    fn parts(&mut self, _exchange: &Exchange, _h: f64) -> usize {
        1
    }

    /// Tells the circular frequency of the contact, rad/s, where it is known beforehand.
    fn know(&mut self, _frequency: f64) {}

    /// Account for the summary, where the name of the algorithm does not tell.
    fn report(&self) -> Option<String> {
        None
    }

    /// Notes for the reader.
    fn warning(&self) -> Option<String> {
        None
    }
}

/// `[coupling]` with the keys that `"auto"` decides on before the run, and with the algorithm that stands in for one
/// that needs more than the slaves can do; all else as it is.
///
/// Decisions taken in the run, see [`Auto`], are taken again when the scene as written is run.
fn resolve(coupling: &Coupling, sides: &Sides<'_>) -> (Coupling, &'static str) {
    let mut resolved = coupling.clone();
    let mut reason = "named in the scene";
    if coupling.algorithm == scene::Algorithm::Iterated && !sides.can_roll_back() {
        resolved.algorithm = scene::Algorithm::GaussSeidel;
        reason = "gauss_seidel in place of iterated, which the scene names";
    }
    if coupling.algorithm != scene::Algorithm::Auto {
        return (resolved, reason);
    }
    if auto::follows(sides) {
        (resolved.order, resolved.force, resolved.extrapolation) = (Order::PantographFirst, Force::Interpolated, 2);
        reason = if sides.can_roll_back() && coupling.max_iterations > 1 {
            "auto: Newton with the interface Jacobian, a step is repeated where that is worth it"
        } else {
            "auto: one pass, whose error is made up for in the next step; long steps pass the line's mean force on"
        };
    } else {
        (resolved.order, resolved.force, resolved.extrapolation) = (Order::CatenaryFirst, Force::Mean, 1);
        reason = "auto: a pantograph holds its inputs: Gauss-Seidel, the line first, passes the line's mean force on, \
                  which conserves the impulse";
    }
    (resolved, reason)
}

/// Algorithm built from `[coupling]`.
pub struct Choice {
    /// The keys in use.
    pub coupling: Coupling,
    /// Reason of the choice, and abilities that slaves lack, for the summary.
    pub reason: String,
}

/// The algorithm that `[coupling]` asks for.
#[must_use]
pub fn build(coupling: &Coupling, sides: &Sides<'_>) -> (Box<dyn Algorithm>, Choice) {
    let repeats = match coupling.algorithm {
        scene::Algorithm::Jacobi | scene::Algorithm::GaussSeidel => false,
        scene::Algorithm::Iterated | scene::Algorithm::InterfaceJacobian | scene::Algorithm::Auto => true,
    };
    let (resolved, why) = resolve(coupling, sides);
    let coupling = &resolved;
    let strips = sides.pantographs.len();
    let mut reason = why.to_owned();
    let rollback = sides.can_roll_back();
    if let Some(slave) = sides.without_rollback()
        && repeats
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
        scene::Algorithm::Iterated => (Box::new(Iterated::new(coupling, strips)), 3, interpolated),
        scene::Algorithm::GaussSeidel => (
            Box::new(GaussSeidel::new(coupling, strips)),
            if pantograph_first { 3 } else { coupling.extrapolation },
            interpolated * if pantograph_first { coupling.extrapolation } else { 1 },
        ),
        scene::Algorithm::Auto => {
            let (line, load) = if auto::follows(sides) { (3, 2) } else { (1, 0) };
            (Box::new(Auto::new(coupling, sides)), line, load)
        }
        scene::Algorithm::InterfaceJacobian => {
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
    let choice = Choice {
        coupling: resolved,
        reason,
    };
    (algorithm, choice)
}
