//! `[solver]`: time integration of each side.

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::keys::{Entry, Keys, Number, Sentences, placeholder};
use crate::write::shown_number;

/// Largest residual that may end Newton's method, N: the error of the filtered force stays small against that of a
/// mesh.
const LARGEST_TOLERANCE: f64 = 1.0;

/// Corrections of a step under `solver.fixed_work`: two bring a nonlinear line to about 0.1 N, the third one a dropper
/// or a contact that opens or closes.
const PASSES: usize = 3;

/// `[solver]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Solver {
    /// Longest time step of both sides, s; divides the macro step evenly where that is longer. 1 ms by default.
    pub micro_step: f64,
    /// Spectral radius of generalised-α at infinite frequency (–), 0 to 1; 0.9 by default, which costs no accuracy
    /// below 20 Hz.
    pub rho_inf: f64,
    /// How constraints are treated.
    pub formulation: Formulation,
    /// Residual that ends Newton's method, N; 1e-3 by default, far below any effect on the filtered force; at most 1 N.
    pub newton_tolerance: f64,
    /// Most Newton iterations per step; 30 by default: switching droppers need a few, more is divergence.
    pub max_iterations: usize,
    /// When the iteration matrix is factorised.
    pub jacobian: Jacobian,
    /// Steps of bounded work: three corrections each, no factorisation after the first.
    pub fixed_work: bool,
}

choice! {
    /// `solver.formulation`.
    pub enum Formulation {
        /// Index-3 constraints with multipliers inside generalised-α.
        Index3 = "index_3",
        /// Accelerations and multipliers from one system of equations, constraints of accelerations [Thesis, Eq. (19)].
        Index1Baumgarte = "index_1_baumgarte",
    }
    unavailable: []
}

choice! {
    /// `solver.jacobian`.
    pub enum Jacobian {
        /// Kept over iterations and steps until convergence slows down.
        Modified = "modified",
        /// In every iteration.
        Full = "full",
    }
    unavailable: []
}

impl Entry for Solver {
    const SENTENCES: Sentences = &[
        (
            "micro_step",
            "Longest internal step of both sides, which divides the macro step evenly; left out with \
             `error_percent`, it is chosen too.",
        ),
        ("rho_inf", "Spectral radius of generalised-α at infinite frequency."),
        (
            "formulation",
            "Constraints of positions with multipliers (index 3), or of accelerations with Baumgarte stabilisation \
             (index 1).",
        ),
        ("newton_tolerance", "Residual that ends Newton's method."),
        ("max_iterations", "Most Newton iterations per step."),
        (
            "jacobian",
            "Factorisation of the iteration matrix: kept until convergence slows down, or in every iteration.",
        ),
        (
            "fixed_work",
            "Steps of bounded work, for real time: three Newton iterations each whatever they leave, one factorisation \
             ahead of the first step. Steps that end above `newton_tolerance` are counted.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            micro_step: keys.number(
                "micro_step",
                was.map(|solver| solver.micro_step),
                Number::positive("s").default(1e-3),
            ),
            rho_inf: keys.number(
                "rho_inf",
                was.map(|solver| solver.rho_inf),
                Number::between(0.0, 1.0).default(0.9),
            ),
            formulation: keys.word(
                "formulation",
                was.map(|solver| solver.formulation),
                Some(Formulation::Index3),
            ),
            newton_tolerance: keys.number(
                "newton_tolerance",
                was.map(|solver| solver.newton_tolerance),
                Number::positive("N").at_most(LARGEST_TOLERANCE).default(1e-3),
            ),
            max_iterations: keys.count(
                "max_iterations",
                was.map(|solver| solver.max_iterations),
                1..=1000,
                Some(30),
            ),
            jacobian: keys.word("jacobian", was.map(|solver| solver.jacobian), Some(Jacobian::Modified)),
            fixed_work: keys.flag("fixed_work", was.map(|solver| solver.fixed_work), false),
        }
    }
}

impl Default for Solver {
    /// An empty table.
    fn default() -> Self {
        placeholder()
    }
}

impl Solver {
    pub(crate) fn check(&self, found: &mut Found) {
        if self.fixed_work && self.jacobian == Jacobian::Full {
            let expected = "must be \"modified\" with solver.fixed_work, which factors once, ahead of the first step";
            refuse(found, "solver.jacobian", "\"full\"", expected);
        }
        if self.newton_tolerance > LARGEST_TOLERANCE {
            let expected = format!(
                "must be at most {LARGEST_TOLERANCE} N, which moves the filtered force by up to 0.5 % of its standard \
                 deviation; 10 N \
                 move it by 3 %, 100 N by 30 %"
            );
            refuse(
                found,
                "solver.newton_tolerance",
                shown_number(self.newton_tolerance, "N"),
                expected,
            );
        }
    }

    /// Options of Newton's method.
    #[must_use]
    pub fn newton_options(&self) -> dynamics::NewtonOptions {
        dynamics::NewtonOptions {
            tolerance: self.newton_tolerance,
            max_iterations: self.max_iterations,
            jacobian: match self.jacobian {
                Jacobian::Modified => dynamics::Jacobian::Modified,
                Jacobian::Full => dynamics::Jacobian::Full,
            },
            formulation: match self.formulation {
                Formulation::Index3 => dynamics::Formulation::Index3,
                Formulation::Index1Baumgarte => dynamics::Formulation::Index1Baumgarte,
            },
            passes: self.fixed_work.then_some(PASSES),
            ..dynamics::NewtonOptions::default()
        }
    }
}
