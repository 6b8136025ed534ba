//! The coupling test problem: two small slaves that integrate so well that a run shows nothing but the coupling's
//! error.
//!
//! A two-mass pantograph (EN 50318) under a wire of one mode with a stiffness that changes in time, unilateral penalty
//! contact on the wire's side, 10 s from rest. The truth is the same as one system, by Runge-Kutta in steps of 10 µs.
//! The contact's oscillation (17 Hz) is nearly undamped: the coupling itself must neither add nor remove energy.

mod slaves;
mod system;
#[cfg(test)]
mod tests;

use std::sync::{Arc, Mutex};

use scene::{Coupling, Force, Order};

use crate::algorithm::{self, Exchange, Sides};
use crate::run::Stepper;
use crate::slave::Slave;
use component::exchange::{contact, line_output_count};

pub use slaves::{Pantograph, Switches, Wire};
pub use system::{Parameters, Truth};

/// Simulated time, s.
pub const DURATION: f64 = 10.0;

/// A force beyond this multiple of the largest true one has diverged.
const DIVERGED: f64 = 10.0;

/// One row of the table: an algorithm between slaves of certain abilities.
#[derive(Clone, Debug)]
pub struct Case {
    /// Description of the case, for people.
    pub name: String,
    /// Algorithm and exchange; its `macro_step` is that of the run.
    pub coupling: Coupling,
    /// Abilities of the line.
    pub line: Switches,
    /// Abilities of the pantograph.
    pub pantograph: Switches,
    /// The mechanical problem.
    pub parameters: Parameters,
}

/// Result of a run of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Communication step, s.
    pub macro_step: f64,
    /// True where the run came to its end with a bounded force, and lost contact only where the reference does.
    pub stable: bool,
    /// rms error of the raw force at the communication points against the truth, N; not finite where it diverged.
    pub rms_error: f64,
    /// Smallest contact force at a communication point, N.
    pub smallest_force: f64,
    /// Steps of the pantograph per macro step, those taken back included (–).
    pub passes_per_step: f64,
    /// Energy that the coupling added, J.
    pub energy_residual: f64,
    /// The same as a share of the work that crossed the contact (–).
    pub energy_share: f64,
    /// Note of the coupling on the energy that it added.
    pub energy_note: Option<String>,
    /// Account of the algorithm.
    pub report: Option<String>,
    /// Reason why the run did not come to its end.
    pub failure: Option<String>,
}

fn coupling(algorithm: scene::Algorithm, order: Order, force: Force, extrapolation: usize) -> Coupling {
    Coupling {
        algorithm,
        order,
        force,
        extrapolation,
        macro_step: 1e-3,
        step_control: None,
        parallel: scene::Parallel::Never,
        max_iterations: 20,
        force_tolerance: 2e-3,
    }
}

/// The standard set: every algorithm as it is commonly used and at its best, and `auto` between slaves of all
/// abilities.
#[must_use]
pub fn cases() -> Vec<Case> {
    use scene::Algorithm::{Auto, GaussSeidel, InterfaceJacobian, Iterated, Jacobi};
    let blind = Switches {
        input_derivatives: 0,
        rollback: false,
    };
    let onward = Switches {
        rollback: false,
        ..Switches::ALL
    };
    let case = |name: &str, coupling: Coupling, switches: Switches, parameters: Parameters| Case {
        name: name.to_owned(),
        coupling,
        line: Switches {
            rollback: switches.rollback,
            ..Switches::ALL
        },
        pantograph: switches,
        parameters,
    };
    let (line, head) = (Order::CatenaryFirst, Order::PantographFirst);
    let (end, mean, whole) = (Force::End, Force::Mean, Force::Interpolated);
    let plain = |name: &str, algorithm, order, force, extrapolation| {
        case(
            name,
            coupling(algorithm, order, force, extrapolation),
            Switches::ALL,
            Parameters::CLOSED,
        )
    };
    let auto = coupling(Auto, head, whole, 2);
    let single = Coupling {
        max_iterations: 1,
        ..auto.clone()
    };
    vec![
        plain("jacobi, held", Jacobi, line, end, 0),
        plain("jacobi, extrapolation 1, mean", Jacobi, line, mean, 1),
        plain("jacobi, extrapolation 2, interpolated", Jacobi, line, whole, 2),
        plain("gauss_seidel, held", GaussSeidel, line, end, 0),
        plain("gauss_seidel, extrapolation 1, mean", GaussSeidel, line, mean, 1),
        plain(
            "gauss_seidel, extrapolation 2, interpolated",
            GaussSeidel,
            line,
            whole,
            2,
        ),
        plain(
            "gauss_seidel, pantograph first, extrapolation 2, interpolated",
            GaussSeidel,
            head,
            whole,
            2,
        ),
        plain("iterated, mean", Iterated, line, mean, 1),
        plain("iterated, interpolated", Iterated, line, whole, 1),
        plain(
            "interface_jacobian, extrapolation 1, mean",
            InterfaceJacobian,
            head,
            mean,
            1,
        ),
        plain(
            "interface_jacobian, extrapolation 1, linear",
            InterfaceJacobian,
            head,
            end,
            1,
        ),
        plain(
            "interface_jacobian, extrapolation 2, interpolated",
            InterfaceJacobian,
            head,
            whole,
            2,
        ),
        case("auto", auto.clone(), Switches::ALL, Parameters::CLOSED),
        case("auto, one pass", single.clone(), Switches::ALL, Parameters::CLOSED),
        case("auto, no rollback", auto.clone(), onward, Parameters::CLOSED),
        case(
            "auto, pantograph without input derivatives and rollback",
            auto.clone(),
            blind,
            Parameters::CLOSED,
        ),
        case("auto, contact lost", auto.clone(), Switches::ALL, Parameters::LOSING),
        case(
            "auto, one pass, contact lost",
            single,
            Switches::ALL,
            Parameters::LOSING,
        ),
        case(
            "auto, head 1 kg, contact 500 kN/m",
            auto,
            Switches::ALL,
            Parameters::STIFF,
        ),
    ]
}

/// The truth of a problem, solved once per process.
#[must_use]
pub fn truth(parameters: &Parameters) -> Arc<Truth> {
    static SOLVED: Mutex<Vec<(Parameters, Arc<Truth>)>> = Mutex::new(Vec::new());
    let mut solved = SOLVED.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some((_, truth)) = solved.iter().find(|(known, _)| known == parameters) {
        return Arc::clone(truth);
    }
    let truth = Arc::new(Truth::solve(parameters, DURATION));
    solved.push((*parameters, Arc::clone(&truth)));
    truth
}

/// Runs a case with communication points every `macro_step` s.
#[must_use]
pub fn run(case: &Case, macro_step: f64) -> Outcome {
    run_against(&truth(&case.parameters), case, macro_step)
}

/// The same against a truth that is at hand, for as long as it goes.
#[must_use]
pub fn run_against(truth: &Truth, case: &Case, macro_step: f64) -> Outcome {
    let mut line = Wire::new(case.parameters, case.line);
    let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(Pantograph::new(case.parameters, case.pantograph))];
    let mut sides = Sides {
        line: &mut line,
        pantographs: &mut pantographs,
    };
    let coupling = Coupling {
        macro_step,
        ..case.coupling.clone()
    };
    let (mut algorithm, _) = algorithm::build(&coupling, &sides);
    let steps = (truth.duration() / macro_step).round() as usize;
    let largest = truth.forces().iter().fold(0.0_f64, |max, force| max.max(*force));
    let smallest = truth.forces().iter().fold(f64::INFINITY, |min, force| min.min(*force));
    let mut outcome = Outcome {
        macro_step,
        stable: true,
        rms_error: f64::NAN,
        smallest_force: f64::INFINITY,
        passes_per_step: 0.0,
        energy_residual: 0.0,
        energy_share: 0.0,
        energy_note: None,
        report: None,
        failure: None,
    };
    let mut exchange = match Exchange::start(&mut sides, 0.0, line_output_count(1, 0)) {
        Ok(exchange) => exchange,
        Err(error) => {
            outcome.failure = Some(error.to_string());
            return outcome;
        }
    };
    let mut stepper = Stepper::new(&mut sides, &mut *algorithm, &mut exchange);
    let (mut squares, mut done) = (0.0, 0);
    for n in 1..=steps {
        let end = n as f64 * macro_step;
        if let Err(error) = stepper.advance(end, macro_step, &mut |_| {}) {
            outcome.failure = Some(error.to_string());
            break;
        }
        done = n;
        let force = stepper.exchange.point(0).contact(0)[contact::FORCE];
        outcome.smallest_force = outcome.smallest_force.min(force);
        squares += (force - truth.at(end)).powi(2);
        if force.is_nan() || force > DIVERGED * largest {
            outcome.failure = Some(format!("the contact force is {force} N at t = {end} s"));
            break;
        }
    }
    outcome.stable = outcome.failure.is_none() && (smallest <= 0.0 || outcome.smallest_force > 0.0);
    outcome.energy_residual = exchange.energy_residual();
    outcome.energy_share = exchange.energy_share();
    outcome.energy_note = exchange.energy_note();
    outcome.report = algorithm.report();
    if done == steps && outcome.failure.is_none() {
        outcome.rms_error = (squares / steps as f64).sqrt();
    }
    outcome.passes_per_step = sides.pantographs[0].work().micro_steps as f64 / done.max(1) as f64;
    outcome
}
