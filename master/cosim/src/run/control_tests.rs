//! The controlled macro step, on the coupling test problem.

use std::sync::atomic::AtomicBool;

use super::*;
use crate::algorithm::Sides;
use component::Observer;
use component::exchange::contact;
use results::recorder::Recorder;
use results::{LineGeometry, Record};

use crate::algorithm::CouplingError;
use crate::run::{Outcome, Steps, Watch, run_controlled};
use crate::slave::{Abilities, Slave, SlaveError};
use crate::test_problem::{Pantograph, Parameters, Switches, Wire, truth};

const BLIND: Switches = Switches {
    rollback: false,
    ..Switches::ALL
};

fn slaves(parameters: Parameters, switches: Switches) -> (Wire, Vec<Box<dyn Slave>>) {
    let head: Box<dyn Slave> = Box::new(Pantograph::new(parameters, switches));
    (Wire::new(parameters, switches), vec![head])
}

fn coupling(algorithm: scene::Algorithm) -> scene::Coupling {
    scene::Coupling {
        algorithm,
        order: scene::Order::PantographFirst,
        force: scene::Force::Interpolated,
        extrapolation: 2,
        macro_step: 1e-3,
        step_control: None,
        parallel: scene::Parallel::Never,
        max_iterations: 20,
        force_tolerance: 1e-4,
    }
}

const PREDICTION: Estimate = Estimate::Prediction { degree: 2 };

fn control(tolerance: f64, duration: f64, estimate: Estimate) -> Control {
    Control {
        duration,
        tolerance,
        min: 1e-4,
        max: 2e-2,
        first: 1e-3,
        micro_step: 5e-4,
        stiffness: Parameters::CLOSED.contact_stiffness,
        estimate,
    }
}

/// With `auto` and steps that follow the error.
fn perform(parameters: Parameters, control: Control, switches: Switches) -> Found {
    let (line, mut pantographs) = slaves(parameters, switches);
    let mut line = Noting::new(line);
    let mut sides = Sides {
        line: &mut line,
        pantographs: &mut pantographs,
    };
    let (mut algorithm, _) = crate::algorithm::build(&coupling(scene::Algorithm::Auto), &sides);
    let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).unwrap();
    let mut recorder = Recorder::new(control.duration, 1e-3, 1, &[], LineGeometry::default());
    let interrupted = AtomicBool::new(false);
    let watch = Watch::new(&interrupted, &());
    let mut controller = Controller::new(control, 1, sides.can_roll_back());
    let outcome = run_controlled(
        &mut sides,
        &mut *algorithm,
        &mut exchange,
        &mut recorder,
        &mut controller,
        &watch,
    );
    assert!(outcome.failure.is_none(), "{:?}", outcome.failure);
    assert_eq!(
        outcome.simulated, control.duration,
        "the last step ends at the duration"
    );
    // A step of the pantograph, those taken back included.
    let passes = sides.pantographs[0].work().micro_steps;
    Found {
        outcome,
        record: recorder.finish(),
        passes,
        points: line.points,
    }
}

fn controlled(parameters: Parameters, control: Control, switches: Switches) -> Outcome<CouplingError> {
    perform(parameters, control, switches).outcome
}

/// Result of a run.
struct Found {
    outcome: Outcome<CouplingError>,
    record: Record,
    passes: u64,
    /// Times and contact forces at communication points, s and N.
    points: Vec<(f64, f64)>,
}

impl Found {
    /// rms error of the force at the communication points, each with the length of its step, N.
    fn rms(&self, parameters: &Parameters) -> f64 {
        let truth = truth(parameters);
        let mut last = 0.0;
        let square = |&(t, force): &(f64, f64)| (t - std::mem::replace(&mut last, t)) * (force - truth.at(t)).powi(2);
        (self.points.iter().map(square).sum::<f64>() / self.outcome.simulated).sqrt()
    }
}

/// A wire that notes its force at each end of a step that stands.
struct Noting {
    wire: Wire,
    end: f64,
    points: Vec<(f64, f64)>,
    kept: f64,
}

impl Noting {
    fn new(wire: Wire) -> Self {
        Self {
            wire,
            end: 0.0,
            points: Vec::new(),
            kept: 0.0,
        }
    }
}

impl Slave for Noting {
    fn name(&self) -> &str {
        self.wire.name()
    }
    fn abilities(&self) -> Abilities {
        self.wire.abilities()
    }
    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.wire.set_inputs(values)
    }
    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.wire.set_input_derivatives(order, values)
    }
    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.end = t + h;
        self.wire.do_step(t, h)
    }
    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        self.wire.outputs(values)?;
        if self.end > 0.0 {
            self.points.push((self.end, values[contact::FORCE]));
        }
        Ok(())
    }
    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = self.end;
        self.wire.save()
    }
    fn restore(&mut self) -> Result<(), SlaveError> {
        self.end = self.kept;
        while self.points.last().is_some_and(|(t, _)| *t > self.kept) {
            self.points.pop();
        }
        self.wire.restore()
    }
}

/// Tolerance (N), bounds of the error in tolerances, most macro steps with those refused.
fn follows(parameters: Parameters, control: Control, switches: Switches, bounds: (f64, f64), most: u64) {
    let found = perform(parameters, control, switches);
    let Outcome { macro_steps, steps, .. } = found.outcome;
    let error = found.rms(&parameters) / control.tolerance;
    println!(
        "tolerance {} N: error {error:.3} tolerances, {macro_steps} steps, {} passes, {steps:?}",
        control.tolerance, found.passes
    );
    assert!((bounds.0..=bounds.1).contains(&error), "{error} tolerances");
    assert!(macro_steps + steps.refused <= most, "{macro_steps} steps");
    assert!(
        steps.refused <= macro_steps / 8 && steps.turns <= macro_steps / 8,
        "{steps:?}"
    );
}

#[test]
fn the_error_is_that_of_the_tolerance_while_contact_is_lost_again_and_again() {
    let lost = truth(&Parameters::LOSING)
        .forces()
        .iter()
        .filter(|force| **force == 0.0)
        .count();
    assert!(lost > 100_000, "lost for {lost} of 1000000 times");
    for (tolerance, most) in [(3.0, 850), (1.0, 1050), (0.3, 1350), (0.1, 1750)] {
        let control = control(tolerance, 10.0, Estimate::Course);
        follows(Parameters::LOSING, control, Switches::ALL, (0.2, 2.0), most);
    }
}

#[test]
fn without_rollback_the_error_follows_the_tolerance_from_extrapolation() {
    // Well below the tolerance with the contact closed, about the tolerance where it is lost, for errors that are not
    // seen before they are made. The longest steps, of omega h above 0.7, are another exchange, which the estimate does
    // not know: there 3.
    for (tolerance, most, error) in [
        (0.3, 1500, 4.0),
        (0.03, 1400, 0.4),
        (0.01, 1850, 0.4),
        (0.003, 2600, 0.4),
    ] {
        let control = control(tolerance, 10.0, PREDICTION);
        follows(Parameters::CLOSED, control, BLIND, (0.1, error), most);
    }
    for (tolerance, most) in [(1.0, 3000), (0.3, 4100), (0.1, 5000), (0.01, 9500)] {
        let control = control(tolerance, 10.0, PREDICTION);
        follows(Parameters::LOSING, control, BLIND, (0.3, 3.5), most);
    }
}

/// The bound on passes is that of the exchange which was best before.
#[test]
fn a_hundredth_of_a_newton_takes_few_passes() {
    let control = control(0.01, 10.0, Estimate::Course);
    let found = perform(Parameters::CLOSED, control, Switches::ALL);
    let error = found.rms(&Parameters::CLOSED);
    println!("{error} N, {} passes", found.passes);
    assert!(
        error <= 0.006 && found.passes <= 2300,
        "{error} N, {} passes",
        found.passes
    );
}

#[test]
fn no_tolerance_ends_a_run_that_loses_contact() {
    for tolerance in [1e3, 10.0, 1e-6] {
        for (switches, estimate) in [(Switches::ALL, Estimate::Course), (BLIND, PREDICTION)] {
            let outcome = controlled(Parameters::LOSING, control(tolerance, 1.5, estimate), switches);
            assert!(outcome.steps.smallest >= 0.6e-4, "{:?}", outcome.steps);
            assert_eq!(
                outcome.steps.refused > 0,
                switches.rollback && tolerance < 1.0,
                "{:?}",
                outcome.steps
            );
        }
    }
}

#[test]
fn equal_steps_are_as_exact_as_steps_of_any_length() {
    // A change of step length must not cost what the exchange has gained: between the errors of the longest and the
    // shortest.
    let along = |pattern: &[f64]| {
        let (mut line, mut pantographs) = slaves(Parameters::CLOSED, Switches::ALL);
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let (mut algorithm, _) = crate::algorithm::build(&coupling(scene::Algorithm::Auto), &sides);
        let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).unwrap();
        let truth = truth(&Parameters::CLOSED);
        let (mut sum, mut count, mut t) = (0.0, 0, 0.0);
        for h in pattern.iter().cycle() {
            algorithm.step(&mut sides, &mut exchange, *h).unwrap();
            t += h;
            exchange.accept(t);
            sum += (exchange.point(0).contact(0)[contact::FORCE] - truth.at(t)).powi(2);
            count += 1;
            if t > 5.0 {
                break;
            }
        }
        (sum / f64::from(count)).sqrt()
    };
    let (long, short, mixed) = (
        along(&[4e-3]),
        along(&[1e-3]),
        along(&[4e-3, 4e-3, 1e-3, 5e-4, 5e-4, 2e-3]),
    );
    println!("{long} N, {short} N, mixed {mixed} N");
    assert!(short < mixed && mixed < long, "{short} N, {mixed} N, {long} N");
}

/// The states are compared through what they lead to: every output of both sides, bit for bit.
#[test]
fn a_step_that_was_taken_back_leaves_no_trace() {
    let through = |refuses: bool| {
        let (mut line, mut pantographs) = slaves(Parameters::LOSING, Switches::ALL);
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        // Gauss-Seidel keeps nothing from step to step but what is in the exchange.
        let (mut algorithm, _) = crate::algorithm::build(&coupling(scene::Algorithm::GaussSeidel), &sides);
        let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).unwrap();
        let mut points = Vec::new();
        for n in 1..=600 {
            if refuses && n % 7 == 0 {
                sides.save().unwrap();
                algorithm.step(&mut sides, &mut exchange, 1e-2).unwrap();
                sides.restore().unwrap();
                let mut there = exchange.clone();
                there.read_line(&mut sides).unwrap();
                there.read_pantographs(&mut sides).unwrap();
                assert_eq!(there.reached.line, exchange.point(0).line);
                assert_eq!(there.reached.strips, exchange.point(0).strips);
            }
            algorithm.step(&mut sides, &mut exchange, 2e-3).unwrap();
            exchange.accept(f64::from(n) * 2e-3);
            points.push(exchange.point(0).clone());
        }
        points
    };
    assert_eq!(through(false), through(true));
    let control = control(0.1, 5.0, Estimate::Course);
    let outcome = controlled(Parameters::LOSING, control, Switches::ALL);
    assert!(outcome.steps.refused > 0, "no step was refused");
    let found = perform(Parameters::LOSING, control, Switches::ALL);
    assert!(
        found.points.windows(2).all(|pair| pair[0].0 < pair[1].0),
        "time goes on only"
    );
}

#[test]
fn a_step_with_its_judgement_allocates_nothing() {
    for algorithm in [scene::Algorithm::Auto, scene::Algorithm::GaussSeidel] {
        let (mut line, mut pantographs) = slaves(Parameters::LOSING, Switches::ALL);
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let estimate = match algorithm {
            scene::Algorithm::Auto => Estimate::Course,
            _ => PREDICTION,
        };
        let (mut algorithm, _) = crate::algorithm::build(&coupling(algorithm), &sides);
        let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).unwrap();
        let mut recorder = Recorder::new(5.0, 1e-3, 1, &[], LineGeometry::default());
        recorder.start(exchange.point(0));
        let mut controller = Controller::new(control(0.1, 5.0, estimate), 1, true);
        let (mut steps, mut refused) = (0, 0);
        let mut go = |count: usize| {
            for _ in 0..count {
                let (end, h) = controller.next().unwrap();
                sides.save().unwrap();
                algorithm.step(&mut sides, &mut exchange, h).unwrap();
                match controller.judge(&exchange, h) {
                    Verdict::Accepted => {
                        exchange.accept(end);
                        recorder.step(exchange.point(1), exchange.point(0));
                        steps += 1;
                    }
                    Verdict::Refused => {
                        sides.restore().unwrap();
                        refused += 1;
                    }
                }
            }
        };
        go(20);
        let allocated = allocation_counter::measure(|| go(300));
        assert_eq!(allocated.count_total, 0, "{steps} steps, {refused} refused");
        assert!(refused > 0 && steps > 200, "{steps} steps, {refused} refused");
    }
}

#[test]
fn steps_are_deterministic_and_end_at_any_duration() {
    for duration in [0.3, 0.31234, 0.1 + 0.2] {
        let run = || {
            perform(
                Parameters::CLOSED,
                control(0.1, duration, Estimate::Course),
                Switches::ALL,
            )
        };
        let (one, two) = (run(), run());
        assert_eq!(one.record, two.record);
        assert_eq!(one.outcome.steps, two.outcome.steps);
    }
}

#[test]
fn steps_lie_on_the_grid_of_the_micro_step() {
    let with = |min: f64, max: f64, micro_step: f64| Control {
        min,
        max,
        micro_step,
        ..control(0.1, 1.0, Estimate::Course)
    };
    // Halves of the micro step below it, multiples above; never below `min`, never above `max`.
    for (control, lengths) in [
        (with(1e-4, 3.5e-3, 1e-3), &[1.25e-4, 2.5e-4, 5e-4, 1e-3, 2e-3, 3e-3][..]),
        (with(1.5e-3, 4e-3, 1e-3), &[2e-3, 3e-3, 4e-3]),
        (with(1e-3, 1e-3, 1e-3), &[1e-3]),
    ] {
        let grid = Grid::new(&control);
        let mut found: Vec<f64> = (1..=64)
            .map(|n| grid.at_most(f64::from(n)) as f64 * grid.unit)
            .collect();
        found.dedup();
        assert_eq!(found.len(), lengths.len(), "{found:?}");
        assert!(
            found.iter().zip(lengths).all(|(a, b)| (a / b - 1.0).abs() < 1e-9),
            "{found:?}"
        );
    }
}

#[test]
fn a_jump_is_refused_a_bounded_number_of_times_and_the_step_comes_back_after_it() {
    let mut controller = Controller::new(control(1.0, 10.0, Estimate::Course), 1, true);
    let (mut refusals, (end, first)) = (0, controller.next().unwrap());
    let mut h = first;
    while controller.judge_error(1e6, false, false) == Verdict::Refused {
        refusals += 1;
        let (_, shorter) = controller.next().unwrap();
        assert!(shorter < h, "a refused step is repeated shorter");
        h = shorter;
    }
    assert!(refusals > 0 && refusals <= REFUSALS, "{refusals}");
    while let (reached, length) = controller.next().unwrap()
        && reached <= end + 1e-9
    {
        assert!(length < first);
        controller.judge_error(0.5, false, false);
    }
    let (_, length) = controller.next().unwrap();
    assert!((length - first).abs() < 1e-9, "{length} s");
}

/// Errors that swing through zero, as those of an oscillation do, and scatter.
#[test]
fn errors_that_swing_leave_the_step_alone() {
    let mut controller = Controller::new(control(1.0, 100.0, PREDICTION), 1, true);
    let mut steps = Steps::default();
    let scale = 1.0 / 3e-3_f64.powi(3);
    for n in 0..4000 {
        let (_, h) = controller.next().unwrap();
        let error = (1.3 * f64::from(n)).sin().abs() * scale * h.powi(3);
        if controller.judge_error(error, false, false) == Verdict::Accepted {
            steps.done(h);
        }
    }
    assert!(steps.turns < 40, "{} turns in 4000 steps", steps.turns);
    let (_, h) = controller.next().unwrap();
    assert!((2e-3..=4e-3).contains(&h), "{h}");
}
