//! Slaves on threads of their own against the same in turn.

use scene::{Coupling, Force, Order};

use super::*;
use crate::algorithm::{Exchange, Sides, build};
use crate::slave::{Abilities, Slave, SlaveError};
use crate::test_problem::{Pantograph, Parameters, Switches, Wire};
use component::exchange::{contact, strip};

fn slaves(parameters: Parameters) -> (Wire, Box<dyn Slave>) {
    let head = Box::new(Pantograph::new(parameters, Switches::ALL));
    (Wire::new(parameters, Switches::ALL), head)
}

fn coupling(algorithm: scene::Algorithm) -> Coupling {
    Coupling {
        algorithm,
        order: Order::PantographFirst,
        force: Force::Interpolated,
        extrapolation: 2,
        macro_step: 5e-4,
        step_control: None,
        parallel: scene::Parallel::Always,
        max_iterations: 20,
        force_tolerance: 1e-4,
    }
}

/// Two heads under one wire each, so that both sides of a pair have something to do.
struct Pair(Wire, Wire);

impl Slave for Pair {
    fn name(&self) -> &str {
        "pair"
    }
    fn abilities(&self) -> Abilities {
        Switches::ALL.abilities()
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
        scene::Algorithm::InterfaceJacobian,
    ] {
        let run_with = |threads: bool| {
            let (first, head) = slaves(Parameters::CLOSED);
            let (second, other) = slaves(Parameters::LOSING);
            let mut line = Pair(first, second);
            let mut pantographs = vec![head, other];
            if threads {
                let said = arrange(&mut pantographs, &[true, true], true);
                assert_eq!(
                    said.as_deref(),
                    Some("on threads of their own: two-mass pantograph, two-mass pantograph")
                );
            }
            let mut sides = Sides {
                line: &mut line,
                pantographs: &mut pantographs,
            };
            let (mut algorithm, _) = build(&coupling(algorithm), &sides);
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
        Switches::ALL.abilities()
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
