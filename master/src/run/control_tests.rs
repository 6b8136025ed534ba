//! The controlled macro step, on the coupling test problem: a two-mass pantograph under one mode of a wire.
//!
//! Wire: 10 kg, 100 N·s/m, k(t) = 2500 (1 + a sin 2π f t) N/m. Contact: 50 kN/m in compression. Start: equilibrium at 110 N.

use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

use super::*;
use crate::algorithm::Sides;
use crate::interface::{contact, load, strip};
use crate::parallel::Parallel;
use crate::recorder::Recorder;
use crate::report::Progress;
use crate::report::Show;
use crate::results::LineGeometry;
use crate::run::{Outcome, Steps, Watch, run_controlled};
use crate::slave::{Abilities, Slave, SlaveError};

const STIFFNESS: f64 = 5e4;
const PRELOAD: f64 = 110.0;
const WIRE: f64 = 2500.0;

/// Amplitude (–) and frequency (Hz) of the wire's stiffness: never lost, and lost 16 % of the time.
const CLOSED: (f64, f64) = (0.3, 1.1667);
const BOUNCING: (f64, f64) = (1.5, 2.0);

fn contact_force(z: f64, w: f64) -> f64 {
    (STIFFNESS * (z - w)).max(0.0)
}

fn pantograph_rate(y: &[f64; 4], force: f64) -> [f64; 4] {
    let [z1, v1, z2, v2] = *y;
    let (spring, start) = (
        4200.0 * (z1 - z2) + 10.0 * (v1 - v2),
        PRELOAD / WIRE + PRELOAD / STIFFNESS,
    );
    let base = 50.0 * (z2 - start) + 90.0 * v2;
    [v1, (PRELOAD - force - spring) / 7.2, v2, (spring - base) / 15.0]
}

fn wire_rate(y: &[f64; 2], force: f64, t: f64, (amplitude, frequency): (f64, f64)) -> [f64; 2] {
    let k = WIRE * (1.0 + amplitude * (TAU * frequency * t).sin());
    [y[1], (force - 100.0 * y[1] - k * y[0]) / 10.0]
}

/// One step of the classical Runge-Kutta method.
fn rk4<const N: usize>(y: &[f64; N], t: f64, h: f64, rate: impl Fn(f64, &[f64; N]) -> [f64; N]) -> [f64; N] {
    let at = |k: &[f64; N], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let k1 = rate(t, y);
    let k2 = rate(t + 0.5 * h, &at(&k1, 0.5 * h));
    let k3 = rate(t + 0.5 * h, &at(&k2, 0.5 * h));
    let k4 = rate(t + h, &at(&k3, h));
    std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

fn start() -> ([f64; 4], [f64; 2]) {
    let wire = PRELOAD / WIRE;
    let strip = wire + PRELOAD / STIFFNESS;
    ([strip, 0.0, strip, 0.0], [wire, 0.0])
}

/// Contact force every millisecond of both as one system.
fn truth(drive: (f64, f64), duration: f64) -> Vec<f64> {
    let (p, w) = start();
    let mut y = [p[0], p[1], p[2], p[3], w[0], w[1]];
    let h = 2e-5;
    let mut forces = vec![contact_force(y[0], y[4])];
    for n in 0..(duration / h).round() as usize {
        y = rk4(&y, n as f64 * h, h, |t, y| {
            let force = contact_force(y[0], y[4]);
            let [a, b, c, d] = pantograph_rate(&[y[0], y[1], y[2], y[3]], force);
            let [e, f] = wire_rate(&[y[4], y[5]], force, t, drive);
            [a, b, c, d, e, f]
        });
        if (n + 1) % 50 == 0 {
            forces.push(contact_force(y[0], y[4]));
        }
    }
    forces
}

#[derive(Clone, Copy)]
struct Likes {
    rollback: bool,
    variable_step: bool,
}

const ALL: Likes = Likes {
    rollback: true,
    variable_step: true,
};

fn abilities(likes: Likes) -> Abilities {
    Abilities {
        rollback: likes.rollback,
        input_derivatives: 3,
        variable_step: likes.variable_step,
    }
}

struct Wire {
    y: [f64; 2],
    kept: [f64; 2],
    drive: (f64, f64),
    inputs: Polynomial,
    forces: [f64; contact::SAMPLE_COUNT],
    mean: f64,
    likes: Likes,
}

struct Head {
    y: [f64; 4],
    kept: [f64; 4],
    inputs: Polynomial,
    likes: Likes,
}

/// Parts of a step: a multiple of ten, none longer than 0.1 ms.
fn parts(h: f64) -> usize {
    10 * (h / 1e-3 - 1e-9).ceil().max(1.0) as usize
}

macro_rules! slave {
    ($type:ty, $name:literal, $step:item, $outputs:item) => {
        impl $type {
            $step
            $outputs
        }
        impl Slave for $type {
            fn name(&self) -> &str {
                $name
            }
            fn abilities(&self) -> Abilities {
                abilities(self.likes)
            }
            fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
                self.inputs.clear(0);
                self.inputs.value.copy_from_slice(values);
                Ok(())
            }
            fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
                self.inputs.derivatives[order - 1].copy_from_slice(values);
                Ok(())
            }
            fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
                self.go(t, h);
                Ok(())
            }
            fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
                values.fill(0.0);
                self.show(values);
                Ok(())
            }
            fn save(&mut self) -> Result<(), SlaveError> {
                assert!(self.likes.rollback);
                self.kept = self.y;
                Ok(())
            }
            fn restore(&mut self) -> Result<(), SlaveError> {
                assert!(self.likes.rollback);
                self.y = self.kept;
                Ok(())
            }
        }
    };
}

slave!(
    Wire,
    "wire",
    fn go(&mut self, t: f64, h: f64) {
        let n = parts(h);
        let d = h / n as f64;
        let (inputs, drive) = (&self.inputs, self.drive);
        let force = |tau: f64, w: f64| contact_force(inputs.at(strip::Z, tau), w);
        self.mean = 0.5 * force(0.0, self.y[0]);
        for i in 0..n {
            self.y = rk4(&self.y, i as f64 * d, d, |tau, y| {
                wire_rate(y, force(tau, y[0]), t + tau, drive)
            });
            let now = force((i + 1) as f64 * d, self.y[0]);
            self.mean += if i + 1 == n { 0.5 * now } else { now };
            if (i + 1) % (n / 10) == 0 {
                self.forces[(i + 1) / (n / 10) - 1] = now;
            }
        }
        self.mean /= n as f64;
    },
    fn show(&self, values: &mut [f64]) {
        values[contact::FORCE] = self.forces[contact::SAMPLE_COUNT - 1];
        values[contact::FZ] = -values[contact::FORCE];
        values[contact::MEAN_FZ] = -self.mean;
        values[contact::SAMPLES..contact::SAMPLES + contact::SAMPLE_COUNT].copy_from_slice(&self.forces);
    }
);

slave!(
    Head,
    "head",
    fn go(&mut self, _t: f64, h: f64) {
        let n = parts(h);
        let d = h / n as f64;
        let inputs = &self.inputs;
        for i in 0..n {
            self.y = rk4(&self.y, i as f64 * d, d, |tau, y| {
                pantograph_rate(y, -inputs.at(load::FZ, tau))
            });
        }
    },
    fn show(&self, values: &mut [f64]) {
        values[strip::Z] = self.y[0];
        values[strip::VZ] = self.y[1];
    }
);

fn slaves(drive: (f64, f64), likes: Likes, count: usize) -> (Wire, Vec<Box<dyn Slave>>) {
    let (p, w) = start();
    let wire = Wire {
        y: w,
        kept: w,
        drive,
        inputs: Polynomial::zeros(count * strip::MOTION),
        forces: [PRELOAD; contact::SAMPLE_COUNT],
        mean: PRELOAD,
        likes,
    };
    let head = || -> Box<dyn Slave> {
        Box::new(Head {
            y: p,
            kept: p,
            inputs: Polynomial::zeros(load::COUNT),
            likes,
        })
    };
    (wire, (0..count).map(|_| head()).collect())
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
        force_tolerance: 1e-6,
        reason: "named",
    }
}

fn control(tolerance: f64, duration: f64) -> Control {
    Control {
        duration,
        tolerance,
        min: 1e-4,
        max: 1e-2,
        first: 1e-3,
        micro_step: 5e-4,
        stiffness: STIFFNESS,
        degree: 2,
    }
}

fn controlled(drive: (f64, f64), control: Control, likes: Likes) -> Outcome {
    let (mut line, mut pantographs) = slaves(drive, likes, 1);
    let mut sides = Sides {
        line: &mut line,
        pantographs: &mut pantographs,
    };
    let (mut algorithm, _) = crate::algorithm::build(&coupling(scene::Algorithm::GaussSeidel), &sides);
    let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).unwrap();
    let recorder = Recorder::new(control.duration, 1e-3, 1, &[], LineGeometry::default());
    let progress = Progress::simulated("", control.duration, Show::Never);
    let interrupted = AtomicBool::new(false);
    let watch = Watch {
        interrupted: &interrupted,
        progress: &progress,
    };
    let mut controller = Controller::new(control, 1, sides.can_roll_back());
    let outcome = run_controlled(
        &mut sides,
        &mut *algorithm,
        &mut exchange,
        recorder,
        &mut controller,
        &watch,
    );
    assert!(outcome.failure.is_none(), "{:?}", outcome.failure);
    assert_eq!(
        outcome.simulated, control.duration,
        "the last step ends at the duration"
    );
    outcome
}

fn rms(outcome: &Outcome, truth: &[f64]) -> f64 {
    let found = &outcome.record.pantographs[0].force;
    assert_eq!(found.len(), truth.len());
    let sum: f64 = found.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / truth.len() as f64).sqrt()
}

fn passes(outcome: &Outcome) -> u64 {
    outcome.macro_steps + outcome.steps.refused
}

#[test]
fn the_error_follows_the_tolerance_and_takes_few_passes() {
    let truth = truth(CLOSED, 10.0);
    let mut errors = Vec::new();
    for tolerance in [0.1, 0.01, 0.001] {
        let outcome = controlled(CLOSED, control(tolerance, 10.0), ALL);
        let error = rms(&outcome, &truth);
        println!(
            "tolerance {tolerance} N: error {error:.5} N, {} passes, {} refused, {} turns, {:.5} to {:.5} s",
            passes(&outcome),
            outcome.steps.refused,
            outcome.steps.turns,
            outcome.steps.smallest,
            outcome.steps.largest
        );
        assert!(error < 8.0 * tolerance, "tolerance {tolerance} N: error {error} N");
        assert!(
            outcome.steps.turns < outcome.macro_steps / 20,
            "{} turns",
            outcome.steps.turns
        );
        errors.push(error);
    }
    assert!(
        errors[1] < 0.35 * errors[0] && errors[2] < 0.35 * errors[1],
        "{errors:?}"
    );
    let outcome = controlled(CLOSED, control(0.004, 10.0), ALL);
    let error = rms(&outcome, &truth);
    println!("tolerance 0.004 N: error {error:.5} N, {} passes", passes(&outcome));
    assert!(error <= 0.018, "{error} N");
    assert!(passes(&outcome) <= 2500, "{} passes", passes(&outcome));
}

#[test]
fn contact_that_is_lost_again_and_again_never_ends_a_run() {
    let truth = truth(BOUNCING, 5.0);
    let lost = truth.iter().filter(|&&force| force == 0.0).count();
    assert!(lost > 500, "lost in {lost} of 5000 samples");
    for tolerance in [10.0, 1.0, 0.1, 1e-6] {
        let outcome = controlled(BOUNCING, control(tolerance, 5.0), ALL);
        println!(
            "tolerance {tolerance} N: error {:.4} N, {} steps, {} refused, {} turns, {:.5} to {:.5} s",
            rms(&outcome, &truth),
            outcome.macro_steps,
            outcome.steps.refused,
            outcome.steps.turns,
            outcome.steps.smallest,
            outcome.steps.largest
        );
        assert!(
            outcome.steps.refused <= outcome.macro_steps / 4,
            "{} refused",
            outcome.steps.refused
        );
        assert!(
            outcome.steps.smallest >= 1e-4 * 0.6,
            "a step of half the smallest power of two at least"
        );
    }
}

#[test]
fn without_rollback_no_step_is_refused_and_the_steps_still_adapt() {
    let likes = Likes { rollback: false, ..ALL };
    let truth = truth(BOUNCING, 3.0);
    let outcome = controlled(BOUNCING, control(1.0, 3.0), likes);
    assert_eq!((outcome.steps.refused, outcome.rollbacks), (0, 0));
    assert!(
        outcome.steps.largest > 4.0 * outcome.steps.smallest,
        "{:?}",
        outcome.steps
    );
    let coarse = controlled(BOUNCING, control(30.0, 3.0), likes);
    let errors = (rms(&outcome, &truth), rms(&coarse, &truth));
    assert!(
        outcome.macro_steps > coarse.macro_steps && errors.0 < errors.1,
        "{errors:?} N"
    );
}

#[test]
fn steps_are_deterministic_and_end_at_any_duration() {
    for duration in [0.3, 0.31234, 0.1 + 0.2] {
        let (one, two) = (
            controlled(CLOSED, control(0.1, duration), ALL),
            controlled(CLOSED, control(0.1, duration), ALL),
        );
        assert_eq!(one.record, two.record);
        assert_eq!(one.steps, two.steps);
    }
}

#[test]
fn steps_lie_on_the_grid_of_the_micro_step() {
    let with = |min: f64, max: f64, micro_step: f64| Control {
        min,
        max,
        micro_step,
        ..control(0.1, 1.0)
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
fn a_jump_is_refused_a_bounded_number_of_times_and_both_sides_are_taken_back() {
    let mut controller = Controller::new(control(1.0, 10.0), 1, true);
    let (mut refusals, (_, mut h)) = (0, controller.next().unwrap());
    while controller.judge_error(1e6, false) == Verdict::Refused {
        refusals += 1;
        let (_, shorter) = controller.next().unwrap();
        assert!(shorter < h, "a refused step is repeated shorter");
        h = shorter;
    }
    assert!(refusals > 0 && refusals <= REFUSALS, "{refusals}");
    // A run with refusals has the same slaves' states as the points that were accepted.
    let outcome = controlled(BOUNCING, control(0.1, 5.0), ALL);
    assert!(outcome.steps.refused > 0, "no step was refused");
    assert_eq!(outcome.rollbacks, outcome.steps.refused);
}

/// Errors that swing through zero, as those of an oscillation do, and scatter.
#[test]
fn errors_that_swing_leave_the_step_alone() {
    let mut controller = Controller::new(control(1.0, 100.0), 1, true);
    let mut steps = Steps::default();
    let scale = 1.0 / 3e-3_f64.powi(3);
    for n in 0..4000 {
        let (_, h) = controller.next().unwrap();
        let error = (1.3 * f64::from(n)).sin().abs() * scale * h.powi(3);
        if controller.judge_error(error, false) == Verdict::Accepted {
            steps.done(h);
        }
    }
    assert!(steps.turns < 40, "{} turns in 4000 steps", steps.turns);
    let (_, h) = controller.next().unwrap();
    assert!((2e-3..=4e-3).contains(&h), "{h}");
}

/// Two heads under one wire each, so that both sides of a pair have something to do.
struct Pair(Wire, Wire);

impl Slave for Pair {
    fn name(&self) -> &str {
        "pair"
    }
    fn abilities(&self) -> Abilities {
        abilities(ALL)
    }
    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.0.set_inputs(&values[..strip::MOTION])?;
        self.1.set_inputs(&values[strip::MOTION..])
    }
    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.0.set_input_derivatives(order, &values[..strip::MOTION])?;
        self.1.set_input_derivatives(order, &values[strip::MOTION..])
    }
    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.0.do_step(t, h)?;
        self.1.do_step(t, h)
    }
    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        let (first, second) = values.split_at_mut(contact::COUNT);
        self.0.outputs(first)?;
        self.1.outputs(second)
    }
    fn save(&mut self) -> Result<(), SlaveError> {
        self.0.save()?;
        self.1.save()
    }
    fn restore(&mut self) -> Result<(), SlaveError> {
        self.0.restore()?;
        self.1.restore()
    }
}

#[test]
fn slaves_on_threads_of_their_own_give_the_same_bits() {
    for algorithm in [
        scene::Algorithm::Jacobi,
        scene::Algorithm::GaussSeidel,
        scene::Algorithm::Iterated,
    ] {
        let run_with = |threads: bool| {
            let (first, mut pantographs) = slaves(CLOSED, ALL, 1);
            let (second, more) = slaves(BOUNCING, ALL, 1);
            let one = |mut wire: Wire| {
                wire.inputs = Polynomial::zeros(strip::MOTION);
                wire
            };
            let mut line = Pair(one(first), one(second));
            pantographs.extend(more);
            if threads {
                let said = crate::parallel::arrange(&mut pantographs, &[true, true], true);
                assert_eq!(said.as_deref(), Some("on threads of their own: head, head"));
            }
            let mut sides = Sides {
                line: &mut line,
                pantographs: &mut pantographs,
            };
            let (mut algorithm, _) = crate::algorithm::build(&coupling(algorithm), &sides);
            let mut exchange = Exchange::start(&mut sides, 0.0, 2 * contact::COUNT).unwrap();
            let mut points = Vec::new();
            for n in 1..=300 {
                algorithm.step(&mut sides, &mut exchange, 5e-4).unwrap();
                exchange.accept(f64::from(n) * 5e-4);
                points.push(exchange.point(0).clone());
            }
            points
        };
        assert_eq!(run_with(false), run_with(true), "{algorithm}");
    }
}

/// A slave that fails or panics in its second step.
struct Failing {
    panics: bool,
    steps: usize,
}

impl Slave for Failing {
    fn name(&self) -> &str {
        "failing"
    }
    fn abilities(&self) -> Abilities {
        abilities(ALL)
    }
    fn set_inputs(&mut self, _: &[f64]) -> Result<(), SlaveError> {
        Ok(())
    }
    fn set_input_derivatives(&mut self, _: usize, _: &[f64]) -> Result<(), SlaveError> {
        Ok(())
    }
    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.steps += 1;
        if self.steps < 2 {
            return Ok(());
        }
        assert!(!self.panics, "a panic of the slave");
        let source = Box::new(std::io::Error::other("on purpose"));
        let slave = "failing".into();
        let retryable = true;
        Err(SlaveError::Step {
            slave,
            t,
            h,
            retryable,
            source,
        })
    }
    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.fill(self.steps as f64);
        Ok(())
    }
    fn save(&mut self) -> Result<(), SlaveError> {
        Ok(())
    }
    fn restore(&mut self) -> Result<(), SlaveError> {
        self.steps = 0;
        Ok(())
    }
}

#[test]
fn a_failure_on_another_thread_is_reported_by_the_next_call_and_can_be_taken_back() {
    let failing = |panics| Parallel::new(Box::new(Failing { panics, steps: 0 })).ok().unwrap();
    let (mut slave, mut values) = (failing(false), [0.0]);
    slave.do_step(0.0, 1.0).unwrap();
    slave.outputs(&mut values).unwrap();
    assert_eq!(values, [1.0]);
    slave.do_step(1.0, 1.0).unwrap();
    let error = slave.outputs(&mut values).unwrap_err();
    assert!(
        error.is_retryable() && error.to_string().contains("failing: the step from t = 1 s"),
        "{error}"
    );
    slave.do_step(1.0, 1.0).unwrap();
    slave.restore().unwrap();
    slave.outputs(&mut values).unwrap();
    assert_eq!(values, [0.0], "a failed step is taken back without a word");

    let mut slave = failing(true);
    slave.do_step(0.0, 1.0).unwrap();
    slave.do_step(1.0, 1.0).unwrap();
    let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| slave.outputs(&mut [0.0])));
    assert!(panicked.is_err(), "a panic goes on where the step is waited for");
}
