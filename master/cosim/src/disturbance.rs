//! Slaves under a disturbance: moved strips, discarded steps, steps repeated from a saved state.

use component::exchange::strip;
use component::{Frame, Work};
use dynamics::SplitMix64;
use system::disturbance::{Disturbance, Lift};

use crate::slave::{Abilities, Slave, SlaveError};

/// Puts a disturbance on the slaves of a coupled run, in place; `line_outputs` is the number of the line's outputs,
/// `strips` that of the strips of each pantograph.
pub fn disturb(
    disturbance: &Disturbance,
    line: &mut Box<dyn Slave>,
    pantographs: &mut [Box<dyn Slave>],
    line_outputs: usize,
    strips: &[usize],
) {
    if disturbance.lift.is_none() && disturbance.discards.is_none() && !disturbance.repeated {
        return;
    }
    let without_lift = Disturbance {
        lift: None,
        ..disturbance.clone()
    };
    wrap(line, &without_lift, line_outputs, 0);
    for (index, (pantograph, strips)) in pantographs.iter_mut().zip(strips).enumerate() {
        wrap(pantograph, disturbance, strips * strip::OUTPUTS, index as u64 + 1);
    }
}

fn wrap(slave: &mut Box<dyn Slave>, disturbance: &Disturbance, outputs: usize, number: u64) {
    let free: Box<dyn Slave> = Box::new(Absent);
    let inner = std::mem::replace(slave, free);
    *slave = Box::new(Disturbed::new(inner, disturbance, outputs, number));
}

/// Stands in for a slave while it is wrapped.
struct Absent;

impl Slave for Absent {
    fn name(&self) -> &str {
        ""
    }
    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: false,
            input_derivatives: 0,
            variable_step: false,
        }
    }
    fn set_inputs(&mut self, _: &[f64]) -> Result<(), SlaveError> {
        Ok(())
    }
    fn set_input_derivatives(&mut self, _: usize, _: &[f64]) -> Result<(), SlaveError> {
        Ok(())
    }
    fn do_step(&mut self, _: f64, _: f64) -> Result<(), SlaveError> {
        Ok(())
    }
    fn outputs(&mut self, _: &mut [f64]) -> Result<(), SlaveError> {
        Ok(())
    }
    fn save(&mut self) -> Result<(), SlaveError> {
        Ok(())
    }
    fn restore(&mut self) -> Result<(), SlaveError> {
        Ok(())
    }
}

/// A step that was discarded on purpose.
#[derive(Debug, thiserror::Error)]
#[error("discarded on purpose")]
struct Discarded;

/// A slave that does not come back to the same.
#[derive(Debug, thiserror::Error)]
#[error("output {output} is {again} when the step is repeated from a saved state, and was {first}")]
struct NotRepeated {
    output: usize,
    first: f64,
    again: f64,
}

/// A slave with a [`Disturbance`] on it.
struct Disturbed {
    inner: Box<dyn Slave>,
    lift: Option<Lift>,
    /// Pseudo-random sequence, and one call in how many fails.
    dice: Option<(SplitMix64, u64)>,
    repeated: bool,
    /// Inputs and their derivatives as set last, by order.
    given: Vec<Vec<f64>>,
    orders: usize,
    /// Outputs of a step and of its repetition.
    seen: [Vec<f64>; 2],
    t: f64,
    /// Work of the contacts on the motion of the lift, J, one per strip of a pantograph.
    work: Vec<f64>,
    kept: (f64, Vec<f64>),
}

impl Disturbed {
    fn new(inner: Box<dyn Slave>, disturbance: &Disturbance, outputs: usize, number: u64) -> Self {
        Self {
            inner,
            lift: disturbance.lift.clone(),
            dice: disturbance.discards.map(|discards| {
                let seed = discards.seed.wrapping_add(number.wrapping_mul(0x9E37));
                (SplitMix64::new(seed), discards.one_in.max(2))
            }),
            repeated: disturbance.repeated,
            given: vec![Vec::new(); dynamics::MAX_ORDER + 1],
            orders: 0,
            seen: [vec![0.0; outputs], vec![0.0; outputs]],
            t: 0.0,
            work: vec![0.0; outputs / strip::OUTPUTS],
            kept: (0.0, vec![0.0; outputs / strip::OUTPUTS]),
        }
    }

    /// True where this call is to fail.
    fn fails(&mut self) -> bool {
        let dice = self.dice.as_mut();
        dice.is_some_and(|(random, one_in)| random.next() % *one_in == 0)
    }

    /// Vertical force that strip `strip` (from 0) was given, `tau` s into the step, N.
    fn force(&self, strip: usize, tau: f64) -> f64 {
        use component::exchange::load;
        let mut term = 1.0;
        let mut sum = 0.0;
        for (order, values) in self.given[..=self.orders].iter().enumerate() {
            if order > 0 {
                term *= tau / order as f64;
            }
            sum += term * values.get(strip * load::COUNT + load::FZ).copied().unwrap_or(0.0);
        }
        sum
    }
}

impl Slave for Disturbed {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn abilities(&self) -> Abilities {
        self.inner.abilities()
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        if self.repeated {
            self.inner.save()?;
        }
        self.given[0].clear();
        self.given[0].extend_from_slice(values);
        self.orders = 0;
        self.inner.set_inputs(values)
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.given[order].clear();
        self.given[order].extend_from_slice(values);
        for between in self.orders + 1..order {
            self.given[between].clear();
        }
        self.orders = order;
        self.inner.set_input_derivatives(order, values)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        let failed = |retryable, source| SlaveError::Step {
            slave: self.inner.name().to_owned(),
            t,
            h,
            retryable,
            source,
        };
        if self.dice.is_some() {
            let error = failed(true, Box::new(Discarded));
            if self.fails() {
                return Err(error);
            }
        }
        self.inner.do_step(t, h)?;
        if self.repeated {
            self.inner.outputs(&mut self.seen[0])?;
            self.inner.restore()?;
            self.inner.set_inputs(&self.given[0])?;
            for order in 1..=self.orders {
                if !self.given[order].is_empty() {
                    self.inner.set_input_derivatives(order, &self.given[order])?;
                }
            }
            self.inner.do_step(t, h)?;
            self.inner.outputs(&mut self.seen[1])?;
            let [first, again] = &self.seen;
            if let Some(output) = (0..first.len()).find(|&i| first[i].to_bits() != again[i].to_bits()) {
                let (first, again) = (first[output], again[output]);
                return Err(SlaveError::Step {
                    slave: self.inner.name().to_owned(),
                    t,
                    h,
                    retryable: false,
                    source: Box::new(NotRepeated { output, first, again }),
                });
            }
        }
        if let Some(lift) = &self.lift {
            // Simpson's rule in ten parts.
            let parts = 10;
            let power = |strip: usize, k: usize| {
                let tau = h * k as f64 / f64::from(parts);
                self.force(strip, tau) * lift.at(t + tau).1
            };
            let weight = |k: usize| match k {
                0 => 1.0,
                k if k == parts as usize => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let work = |strip: usize| {
                let sum: f64 = (0..=parts as usize).map(|k| weight(k) * power(strip, k)).sum();
                sum * h / (3.0 * f64::from(parts))
            };
            let more: Vec<f64> = (0..self.work.len()).map(work).collect();
            for (work, more) in self.work.iter_mut().zip(more) {
                *work += more;
            }
        }
        self.t = t + h;
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        self.inner.outputs(values)?;
        if let Some(lift) = &self.lift {
            let (height, rate) = lift.at(self.t);
            for (values, work) in values.chunks_exact_mut(strip::OUTPUTS).zip(&self.work) {
                values[strip::Z] += height;
                values[strip::VZ] += rate;
                values[strip::WORK] += work;
            }
        }
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept.0 = self.t;
        self.kept.1.copy_from_slice(&self.work);
        self.inner.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.t = self.kept.0;
        self.work.copy_from_slice(&self.kept.1);
        self.inner.restore()
    }

    fn work(&mut self) -> Work {
        self.inner.work()
    }

    fn draw(&mut self, frame: &mut Frame) {
        self.inner.draw(frame);
    }

    fn finish_drawing(&mut self, frames: &mut [Frame]) {
        self.inner.finish_drawing(frames);
    }
}
