//! A pantograph whose commands come from a controller FMU.

use component::exchange::instrument;
use component::{Frame, Work};
use cosim::algorithm::Polynomial;
use cosim::slave::{Abilities, Slave, SlaveError};
use scene::Scene;

use crate::SuppliedController;
use crate::driven::pieces;

/// A pantograph with its controller, as one slave: a macro step goes from sample to sample, and the controller is asked
/// at each. The pantograph has the command as its last input and the readings of its instruments as last outputs.
pub struct Commanded {
    slave: Box<dyn Slave>,
    controller: SuppliedController,
    /// True where samples fall on communication points only, so that a repeated macro step asks the same again.
    aligned: bool,
    /// Inputs of the macro step, the command included.
    inputs: Polynomial,
    /// The same from a sample on.
    part: Polynomial,
    outputs: Vec<f64>,
}

impl Commanded {
    /// A pantograph with `inputs` and `outputs` beside those of its controller.
    #[must_use]
    pub fn new(
        slave: Box<dyn Slave>,
        controller: SuppliedController,
        scene: &Scene,
        (inputs, outputs): (usize, usize),
    ) -> Self {
        let whole = pieces(scene.coupling.macro_step, controller.samples().time(1)).is_some();
        Self {
            aligned: whole && scene.coupling.step_control.is_none(),
            slave,
            controller,
            inputs: Polynomial::zeros(inputs + 1),
            part: Polynomial::zeros(inputs + 1),
            outputs: vec![0.0; outputs + instrument::COUNT],
        }
    }

    /// Asks the controller for the command of sample `number`.
    fn ask(&mut self, number: i64) -> Result<(), SlaveError> {
        self.slave.outputs(&mut self.outputs)?;
        let mut shown = [0.0; instrument::COUNT];
        shown.copy_from_slice(&self.outputs[self.outputs.len() - instrument::COUNT..]);
        let command = self.controller.command(number, &shown)?;
        if let Some(last) = self.inputs.value.last_mut() {
            *last = command;
        }
        Ok(())
    }

    /// Steps the pantograph from `tau` s after the start of the macro step, at `from` s, by `h` s.
    fn advance(&mut self, tau: f64, from: f64, h: f64) -> Result<(), SlaveError> {
        self.inputs.shift_to(tau, &mut self.part);
        self.part.send(&mut *self.slave, h)?;
        self.slave.do_step(from, h)
    }
}

impl Slave for Commanded {
    fn name(&self) -> &str {
        self.slave.name()
    }

    fn abilities(&self) -> Abilities {
        let own = self.slave.abilities();
        Abilities {
            rollback: own.rollback && (self.aligned || self.controller.can_return()),
            ..own
        }
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.clear(0);
        self.inputs.value[..values.len()].copy_from_slice(values);
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.derivatives[order - 1][..values.len()].copy_from_slice(values);
        self.inputs.degree = self.inputs.degree.max(order);
        Ok(())
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        let (end, samples) = (t + h, self.controller.samples());
        let mut from = t;
        while from < end {
            let number = samples.first_from(from);
            if samples.is_due(samples.time(number), from) {
                self.ask(number)?;
            }
            // A sample at the end belongs to the step that follows.
            let next = samples.time(samples.first_after(from));
            let to = if next < end * (1.0 - 1e-12) - 1e-12 { next } else { end };
            let length = if from == t && to == end { h } else { to - from };
            self.advance(from - t, from, length)?;
            from = to;
        }
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        self.slave.outputs(&mut self.outputs)?;
        values.copy_from_slice(&self.outputs[..values.len()]);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.controller.save()?;
        self.slave.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.controller.restore()?;
        self.slave.restore()
    }

    fn work(&mut self) -> Work {
        self.slave.work()
    }

    fn draw(&mut self, frame: &mut Frame) {
        self.slave.draw(frame);
    }

    fn finish_drawing(&mut self, frames: &mut [Frame]) {
        self.slave.finish_drawing(frames);
    }
}
