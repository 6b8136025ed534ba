//! `[coupling]`: how the two sides exchange values.

use crate::choice::{Choice, choice};
use crate::keys::{Entry, Keys, Number};

/// `[coupling]`.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// Which algorithm; `"auto"` is already resolved.
    pub algorithm: Algorithm,
    /// Which side steps first where they step in turn.
    pub order: Order,
    /// What force the pantograph is given over a step.
    pub force: Force,
    /// Degree of the polynomial that inputs follow inside a step, 0 to 2 (–).
    pub extrapolation: usize,
    /// Communication step, s; 1 ms by default.
    pub macro_step: f64,
    /// Most iterations of a macro step with [`Algorithm::Iterated`]; 20 by default: it contracts by more than half each time,
    /// or does not converge at all.
    pub max_iterations: usize,
    /// Change of the contact force between two iterations that ends them, N; 1e-6 by default, far below what statistics print.
    pub force_tolerance: f64,
    /// Why this algorithm: named in the scene, or what `"auto"` went by. Not in the file and not compared.
    pub reason: &'static str,
}

impl PartialEq for Coupling {
    fn eq(&self, other: &Self) -> bool {
        let Self {
            algorithm,
            order,
            force,
            extrapolation,
            macro_step,
            max_iterations,
            force_tolerance,
            reason: _,
        } = self;
        *algorithm == other.algorithm
            && *order == other.order
            && *force == other.force
            && *extrapolation == other.extrapolation
            && *macro_step == other.macro_step
            && *max_iterations == other.max_iterations
            && *force_tolerance == other.force_tolerance
    }
}

choice! {
    /// `coupling.algorithm`.
    pub enum Algorithm {
        /// Both sides step at once from the values of the last communication point.
        Jacobi = "jacobi",
        /// One side after the other, the second with the first one's new values.
        GaussSeidel = "gauss_seidel",
        /// Gauss-Seidel, repeated with rollback until the force stays the same.
        Iterated = "iterated",
    }
    unavailable: ["interface_jacobian"]
}

choice! {
    /// `coupling.order`.
    pub enum Order {
        /// The line first: it needs the extrapolated strip.
        CatenaryFirst = "catenary_first",
        /// The pantographs first: they need the extrapolated force.
        PantographFirst = "pantograph_first",
    }
    unavailable: []
}

choice! {
    /// `coupling.force`: what the pantograph is given over a step.
    pub enum Force {
        /// The mean of the contact force over the line's step: the impulse is the same on both sides.
        Mean = "mean",
        /// The polynomial through the forces at communication points.
        Interpolated = "interpolated",
        /// The force at the end of the line's step, held.
        End = "end",
    }
    unavailable: []
}

const NAMED: &str = "named in the scene";
const AUTO: &str = "auto: Gauss-Seidel, the line first, passes the line's mean force on, which conserves the impulse, \
                    and asks neither side to step back";

impl Entry for Coupling {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        // `None` is "auto", also where the key is left out.
        let named = Algorithm::NAMES
            .iter()
            .map(|(word, algorithm)| (*word, Some(*algorithm)));
        let names: Vec<(&'static str, Option<Algorithm>)> = std::iter::once(("auto", None)).chain(named).collect();
        let algorithm = keys
            .word_among(
                "algorithm",
                was.map(|coupling| Some(coupling.algorithm)),
                &names,
                Algorithm::UNAVAILABLE,
                Some(None),
            )
            .flatten();
        if keys.holds_table("macro_step") {
            keys.refuse(
                "macro_step",
                "a controlled macro step is not available in this version: must be a number in s",
            );
        }
        Self {
            algorithm: algorithm.unwrap_or(Algorithm::GaussSeidel),
            order: keys.word("order", was.map(|coupling| coupling.order), Some(Order::CatenaryFirst)),
            force: keys.word("force", was.map(|coupling| coupling.force), Some(Force::Mean)),
            extrapolation: keys.count(
                "extrapolation",
                was.map(|coupling| coupling.extrapolation),
                0..=2,
                Some(1),
            ),
            macro_step: if keys.holds_table("macro_step") {
                f64::NAN
            } else {
                keys.number(
                    "macro_step",
                    was.map(|coupling| coupling.macro_step),
                    Number::positive("s").default(1e-3),
                )
            },
            max_iterations: keys.count(
                "max_iterations",
                was.map(|coupling| coupling.max_iterations),
                1..=1000,
                Some(20),
            ),
            force_tolerance: keys.number(
                "force_tolerance",
                was.map(|coupling| coupling.force_tolerance),
                Number::positive("N").default(1e-6),
            ),
            reason: match (algorithm, was) {
                (_, Some(coupling)) => coupling.reason,
                (Some(_), None) => NAMED,
                (None, None) => AUTO,
            },
        }
    }
}
