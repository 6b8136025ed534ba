//! `[coupling]`: how the two sides exchange values.

use crate::choice::choice;
use crate::keys::{Entry, Keys, Number, Sentences, placeholder};

/// `[coupling]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// Which algorithm; with `"auto"` the other keys say what it begins with, which goes by the slaves.
    pub algorithm: Algorithm,
    /// Which side steps first where they step in turn.
    pub order: Order,
    /// Force that the pantograph is given over a step.
    pub force: Force,
    /// Degree of the polynomial that inputs follow inside a step, 0 to 2 (–).
    pub extrapolation: usize,
    /// Communication step, s; 1 ms by default. Where it is controlled, the first one, and the only one where a slave
    /// takes no other: 1 ms or what `min` and `max` leave of it.
    pub macro_step: f64,
    /// How the macro step is controlled; `None` where all steps are equal.
    pub step_control: Option<StepControl>,
    /// Use of threads for slaves that may step at the same time.
    pub parallel: Parallel,
    /// Most passes of a macro step with [`Algorithm::Iterated`] and [`Algorithm::InterfaceJacobian`]; 20 by default:
    /// they contract by more than half each time, or do not converge at all. With 1 no slave is taken back.
    pub max_iterations: usize,
    /// Change of the contact force by a further pass that is not worth that pass, N; 2e-3 by default: short macro steps
    /// are then done in one pass, long ones in a few, with an error far below that of the mesh.
    pub force_tolerance: f64,
}

/// `coupling.macro_step = { tolerance = …, min = …, max = … }`: the macro step follows the error that it makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// Estimated error of the contact force that a step may make, N.
    pub tolerance: f64,
    /// Shortest macro step, s; 0.1 ms by default. A step of this length is taken whatever its error.
    pub min: f64,
    /// Longest macro step, s; 10 ms by default, beyond which no exchange without iterations follows a collector head on
    /// its contact stiffness.
    pub max: f64,
}

impl StepControl {
    /// The micro step, s, or the longest of its halves, quarters, … between `min` and `max` where macro steps are
    /// shorter than it.
    #[must_use]
    pub fn longest_part(&self, micro_step: f64) -> f64 {
        // A rest of rounding is no difference; the shortest step is taken even where it is above the longest.
        const ROUNDING: f64 = 1e-6;
        let mut step = micro_step;
        while step > self.max * (1.0 + ROUNDING) && 0.5 * step >= self.min * (1.0 - ROUNDING) {
            step *= 0.5;
        }
        step
    }
}

impl Entry for StepControl {
    const SENTENCES: Sentences = &[
        (
            "tolerance",
            "Estimated error of the contact force that a step may make.",
        ),
        ("min", "Shortest macro step, taken whatever its error."),
        ("max", "Longest macro step."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let control = Self {
            tolerance: keys.number("tolerance", was.map(|control| control.tolerance), Number::positive("N")),
            min: keys.number(
                "min",
                was.map(|control| control.min),
                Number::positive("s").default(1e-4),
            ),
            max: keys.number(
                "max",
                was.map(|control| control.max),
                Number::positive("s").default(1e-2),
            ),
        };
        if control.max < control.min {
            // The key that is written is the one to be corrected.
            let (name, expected) = if keys.has("max", false) {
                ("max", format!("must be at least min = {} s", control.min))
            } else {
                ("min", format!("must be at most max = {} s", control.max))
            };
            keys.refuse(name, expected);
        }
        control
    }
}

choice! {
    /// `coupling.algorithm`.
    pub enum Algorithm {
        /// The algorithm that suits the slaves.
        Auto = "auto",
        /// Both sides step at once from the values of the last communication point.
        Jacobi = "jacobi",
        /// One side after the other, the second with the first one's new values.
        GaussSeidel = "gauss_seidel",
        /// Gauss-Seidel, repeated with rollback until the force stays the same.
        Iterated = "iterated",
        /// Newton on the force over the macro step; what is left over is made up for in the next step.
        InterfaceJacobian = "interface_jacobian",
    }
    unavailable: []
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
    /// `coupling.force`: force that the pantograph is given over a step.
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

choice! {
    /// `coupling.parallel`: threads for slaves that may step at the same time. Results are the same.
    pub enum Parallel {
        /// For slaves that make it pay: pantographs of model `"linkage"` with all their bodies.
        Auto = "auto",
        /// All pantographs, FMUs of others included.
        Always = "always",
        /// No slave.
        Never = "never",
    }
    unavailable: []
}

impl Default for Coupling {
    /// An empty table.
    fn default() -> Self {
        placeholder()
    }
}

impl Algorithm {
    /// Defaults of `order`, `force` and `extrapolation`: the best ones for the algorithm.
    fn defaults(self) -> (Order, Force, usize) {
        match self {
            Self::Auto | Self::InterfaceJacobian => (Order::PantographFirst, Force::Interpolated, 2),
            Self::Jacobi | Self::GaussSeidel | Self::Iterated => (Order::CatenaryFirst, Force::Mean, 1),
        }
    }
}

impl Entry for Coupling {
    const SENTENCES: Sentences = &[
        (
            "algorithm",
            "Exchange algorithm; `\"auto\"` takes what suits the slaves.",
        ),
        (
            "order",
            "Side that steps first where the sides step in turn; the default suits the algorithm.",
        ),
        (
            "force",
            "Force given to the pantograph over a step: mean, interpolated or end value of the contact force; the \
             default suits the algorithm.",
        ),
        (
            "extrapolation",
            "Degree of the polynomial that inputs follow inside a step; the default suits the algorithm.",
        ),
        (
            "macro_step",
            "Communication step, or a table that lets the step follow the error made; left out with \
             `error_percent`, it is as long as the micro step chosen.",
        ),
        (
            "parallel",
            "Threads for slaves that may step at the same time; results are the same.",
        ),
        (
            "max_iterations",
            "Most passes of a macro step with `\"iterated\"` and `\"interface_jacobian\"`.",
        ),
        (
            "force_tolerance",
            "Change of the contact force by a further pass below which no pass follows.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let algorithm = keys.word(
            "algorithm",
            was.map(|coupling| coupling.algorithm),
            Some(Algorithm::Auto),
        );
        let (order, force, extrapolation) = algorithm.defaults();
        if keys.describes() {
            keys.inline_table::<StepControl>("macro_step", None);
        }
        let controlled = keys.holds_table("macro_step") || was.is_some_and(|coupling| coupling.step_control.is_some());
        let step_control = controlled.then(|| {
            let was = was.and_then(|coupling| coupling.step_control.as_ref());
            keys.inline_table("macro_step", was)
        });
        Self {
            algorithm,
            order: keys.word("order", was.map(|coupling| coupling.order), Some(order)),
            force: keys.word("force", was.map(|coupling| coupling.force), Some(force)),
            extrapolation: keys.count(
                "extrapolation",
                was.map(|coupling| coupling.extrapolation),
                0..=2,
                Some(extrapolation),
            ),
            macro_step: match step_control {
                Some(StepControl { min, max, .. }) => 1e-3_f64.min(max).max(min),
                None => keys.number(
                    "macro_step",
                    was.map(|coupling| coupling.macro_step),
                    Number::positive("s").default(1e-3),
                ),
            },
            step_control,
            parallel: keys.word("parallel", was.map(|coupling| coupling.parallel), Some(Parallel::Auto)),
            max_iterations: keys.count(
                "max_iterations",
                was.map(|coupling| coupling.max_iterations),
                1..=1000,
                Some(20),
            ),
            force_tolerance: keys.number(
                "force_tolerance",
                was.map(|coupling| coupling.force_tolerance),
                Number::positive("N").default(2e-3),
            ),
        }
    }
}
