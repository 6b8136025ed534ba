//! A pantograph whose head has several strips, as one slave per strip.
//!
//! Coupling algorithms know strips, not heads. The slaves of the strips of a head share the pantograph: inputs are kept
//! until all of its strips are asked to step, and the pantograph steps once. An algorithm that sets the inputs of all
//! slaves of a macro step and steps all of them before it reads any, as all do, sees no difference.

#[cfg(test)]
mod tests;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use component::exchange::{load, strip};
use component::{Frame, Work};

use crate::slave::{Abilities, Slave, SlaveError};

/// Pantograph of a head, and its inputs for the step to come.
struct Head {
    slave: Box<dyn Slave>,
    /// Inputs of all strips, in order: values, then derivatives by order.
    inputs: Vec<Vec<f64>>,
    /// Highest order of derivatives of any strip.
    orders: usize,
    /// Strips that were asked to step.
    asked: Vec<bool>,
    /// Outputs of all strips where they were read since the last step.
    outputs: Vec<f64>,
    read: bool,
}

/// Strip of a head with several.
struct StripOfHead {
    name: String,
    abilities: Abilities,
    /// From 0.
    number: usize,
    head: Arc<Mutex<Head>>,
}

/// Slaves of the strips of a pantograph: the pantograph itself where `strips` is one.
#[must_use]
pub fn strips_of(slave: Box<dyn Slave>, strips: usize) -> Vec<Box<dyn Slave>> {
    if strips == 1 {
        return vec![slave];
    }
    let (name, abilities) = (slave.name().to_owned(), slave.abilities());
    let head = Arc::new(Mutex::new(Head {
        slave,
        inputs: vec![vec![0.0; strips * load::COUNT]; dynamics::MAX_ORDER + 1],
        orders: 0,
        asked: vec![false; strips],
        outputs: vec![0.0; strips * strip::OUTPUTS],
        read: false,
    }));
    let one = |number: usize| -> Box<dyn Slave> {
        Box::new(StripOfHead {
            name: format!("{name}, strip {}", number + 1),
            abilities,
            number,
            head: Arc::clone(&head),
        })
    };
    (0..strips).map(one).collect()
}

impl Head {
    /// Part of the inputs of a strip.
    fn of(number: usize) -> std::ops::Range<usize> {
        number * load::COUNT..(number + 1) * load::COUNT
    }

    fn step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.slave.set_inputs(&self.inputs[0])?;
        for order in 1..=self.orders {
            self.slave.set_input_derivatives(order, &self.inputs[order])?;
        }
        self.orders = 0;
        self.read = false;
        self.slave.do_step(t, h)
    }
}

impl StripOfHead {
    fn head(&self) -> MutexGuard<'_, Head> {
        self.head.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The pantograph, for the first strip alone: what is asked of all strips is done once.
    fn first(&self) -> Option<MutexGuard<'_, Head>> {
        (self.number == 0).then(|| self.head())
    }
}

impl Slave for StripOfHead {
    fn name(&self) -> &str {
        &self.name
    }

    fn abilities(&self) -> Abilities {
        self.abilities
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        let (mut head, own) = (self.head(), Head::of(self.number));
        head.asked[self.number] = false;
        head.inputs[0][own.clone()].copy_from_slice(values);
        for derivatives in &mut head.inputs[1..] {
            derivatives[own.clone()].fill(0.0);
        }
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        let mut head = self.head();
        head.orders = head.orders.max(order);
        head.inputs[order][Head::of(self.number)].copy_from_slice(values);
        Ok(())
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        let mut head = self.head();
        head.asked[self.number] = true;
        if head.asked.contains(&false) {
            return Ok(());
        }
        head.asked.fill(false);
        head.step(t, h)
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        let head = &mut *self.head();
        if !head.read {
            head.slave.outputs(&mut head.outputs)?;
            head.read = true;
        }
        values.copy_from_slice(&head.outputs[self.number * strip::OUTPUTS..][..strip::OUTPUTS]);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.first().map_or(Ok(()), |mut head| head.slave.save())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.first().map_or(Ok(()), |mut head| {
            head.read = false;
            head.asked.fill(false);
            head.slave.restore()
        })
    }

    fn work(&mut self) -> Work {
        self.first().map_or_else(Work::default, |mut head| head.slave.work())
    }

    fn spent(&self) -> Option<Duration> {
        self.first().and_then(|head| head.slave.spent())
    }

    fn draw(&mut self, frame: &mut Frame) {
        if let Some(mut head) = self.first() {
            head.slave.draw(frame);
        }
    }

    fn finish_drawing(&mut self, frames: &mut [Frame]) {
        if let Some(mut head) = self.first() {
            head.slave.finish_drawing(frames);
        }
    }
}
