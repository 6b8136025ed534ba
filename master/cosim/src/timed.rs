//! A slave whose time is taken.

use std::time::{Duration, Instant};

use crate::slave::{Abilities, Slave, SlaveError};
use component::Frame;
use component::Work;

/// A slave that knows how long its caller has waited for it: in steps, for outputs, and while it kept and took back its
/// state.
///
/// Inputs are not looked at: they are handed over in less time than a look at the clock is worth. Slaves that step side
/// by side are waited for one after the other, so that the times of all never add up to more than the caller's own.
pub struct Timed {
    slave: Box<dyn Slave>,
    spent: Duration,
}

impl Timed {
    /// Takes the time of `slave` from now on.
    #[must_use]
    pub fn new(slave: Box<dyn Slave>) -> Self {
        Self {
            slave,
            spent: Duration::ZERO,
        }
    }

    fn timed<T>(&mut self, call: impl FnOnce(&mut dyn Slave) -> T) -> T {
        let begin = Instant::now();
        let result = call(&mut *self.slave);
        self.spent += begin.elapsed();
        result
    }
}

impl Slave for Timed {
    fn name(&self) -> &str {
        self.slave.name()
    }

    fn abilities(&self) -> Abilities {
        self.slave.abilities()
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.slave.set_inputs(values)
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.slave.set_input_derivatives(order, values)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.timed(|slave| slave.do_step(t, h))
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        self.timed(|slave| slave.outputs(values))
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.timed(|slave| slave.save())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.timed(|slave| slave.restore())
    }

    fn work(&mut self) -> Work {
        self.slave.work()
    }

    fn spent(&self) -> Option<Duration> {
        Some(self.spent)
    }

    fn draw(&mut self, frame: &mut Frame) {
        self.timed(|slave| slave.draw(frame));
    }

    fn finish_drawing(&mut self, frames: &mut [Frame]) {
        self.slave.finish_drawing(frames);
    }
}
