//! What is done to a run on purpose, to see whether it survives: strips moved against their pantographs, steps discarded, every
//! step gone back on.

use dynamics::SplitMix64;

use crate::interface::strip;
use crate::results::Frame;
use crate::slave::{Abilities, Slave, SlaveError, Work};

/// One smooth ramp of a [`Lift`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// When it begins, s.
    pub start: f64,
    /// How long it takes, s.
    pub duration: f64,
    /// By what it raises the strip, m; negative lowers it.
    pub rise: f64,
}

/// A motion of every strip relative to its pantograph: lowering and raising, or, the other way round, steps in the height of
/// the wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lift(pub Vec<Ramp>);

impl Lift {
    /// Height (m) and its rate (m/s) at `t` s: the sum of the ramps, each `3 τ² − 2 τ³`.
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        self.0.iter().fold((0.0, 0.0), |(height, rate), ramp| {
            let part = ((t - ramp.start) / ramp.duration).clamp(0.0, 1.0);
            (
                height + ramp.rise * part * part * (3.0 - 2.0 * part),
                rate + ramp.rise / ramp.duration * 6.0 * part * (1.0 - part),
            )
        })
    }
}

/// Steps that slaves discard as if they had not converged, at pseudo-random times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Discards {
    /// Start of the sequence.
    pub seed: u64,
    /// One in so many calls, in the mean; at least 2.
    pub one_in: u64,
}

/// A start of the line at rest out of its equilibrium: half a sine in each span, neighbours against each other, both wires
/// alike. That is nearly the first mode of a line of equal spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pluck {
    /// m.
    pub amplitude: f64,
}

/// What is done to a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hardship {
    /// Moves the strips.
    pub lift: Option<Lift>,
    /// Steps that fail.
    pub discards: Option<Discards>,
    /// Every step is made, taken back and made again, and must come out the same bit for bit.
    pub rehearsed: bool,
    /// Starts the line of one system out of its equilibrium.
    pub pluck: Option<Pluck>,
    /// Whether the energy of the one system is followed; its macro step is then its micro step.
    pub audited: bool,
}

impl Hardship {
    /// Puts it on the slaves of a coupled run, in place; `line_outputs` is the number of the line's outputs.
    pub(crate) fn put_on(&self, line: &mut Box<dyn Slave>, pantographs: &mut [Box<dyn Slave>], line_outputs: usize) {
        if self.lift.is_none() && self.discards.is_none() && !self.rehearsed {
            return;
        }
        let without_lift = Self {
            lift: None,
            ..self.clone()
        };
        burden(line, &without_lift, line_outputs, 0);
        for (index, pantograph) in pantographs.iter_mut().enumerate() {
            burden(pantograph, self, strip::OUTPUTS, index as u64 + 1);
        }
    }
}

fn burden(slave: &mut Box<dyn Slave>, hardship: &Hardship, outputs: usize, number: u64) {
    let free: Box<dyn Slave> = Box::new(Nobody);
    let inner = std::mem::replace(slave, free);
    *slave = Box::new(Burdened::new(inner, hardship, outputs, number));
}

/// Stands in for a slave while it is wrapped.
struct Nobody;

impl Slave for Nobody {
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

/// A slave with a [`Hardship`] on it.
struct Burdened {
    inner: Box<dyn Slave>,
    lift: Option<Lift>,
    /// Pseudo-random sequence, and one call in how many fails.
    dice: Option<(SplitMix64, u64)>,
    rehearsed: bool,
    /// Inputs and their derivatives as set last, by order.
    given: Vec<Vec<f64>>,
    orders: usize,
    /// Outputs of a step and of its repetition.
    seen: [Vec<f64>; 2],
    t: f64,
    /// Work of the contact on the motion of the lift, J.
    work: f64,
    kept: (f64, f64),
}

impl Burdened {
    fn new(inner: Box<dyn Slave>, hardship: &Hardship, outputs: usize, number: u64) -> Self {
        Self {
            inner,
            lift: hardship.lift.clone(),
            dice: hardship.discards.map(|discards| {
                let seed = discards.seed.wrapping_add(number.wrapping_mul(0x9E37));
                (SplitMix64::new(seed), discards.one_in.max(2))
            }),
            rehearsed: hardship.rehearsed,
            given: vec![Vec::new(); dynamics::MAX_ORDER + 1],
            orders: 0,
            seen: [vec![0.0; outputs], vec![0.0; outputs]],
            t: 0.0,
            work: 0.0,
            kept: (0.0, 0.0),
        }
    }

    /// Whether this call is to fail.
    fn fails(&mut self) -> bool {
        let dice = self.dice.as_mut();
        dice.is_some_and(|(random, one_in)| random.next() % *one_in == 0)
    }

    /// Vertical force that the slave was given, `tau` s into the step, N.
    fn force(&self, tau: f64) -> f64 {
        use crate::interface::load;
        let mut term = 1.0;
        let mut sum = 0.0;
        for (order, values) in self.given[..=self.orders].iter().enumerate() {
            if order > 0 {
                term *= tau / order as f64;
            }
            sum += term * values.get(load::FZ).copied().unwrap_or(0.0);
        }
        sum
    }
}

impl Slave for Burdened {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn abilities(&self) -> Abilities {
        self.inner.abilities()
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        if self.rehearsed {
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
        if self.rehearsed {
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
            let power = |k: usize| {
                let tau = h * k as f64 / f64::from(parts);
                self.force(tau) * lift.at(t + tau).1
            };
            let weight = |k: usize| match k {
                0 => 1.0,
                k if k == parts as usize => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let sum: f64 = (0..=parts as usize).map(|k| weight(k) * power(k)).sum();
            self.work += sum * h / (3.0 * f64::from(parts));
        }
        self.t = t + h;
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        self.inner.outputs(values)?;
        if let Some(lift) = &self.lift {
            let (height, rate) = lift.at(self.t);
            values[strip::Z] += height;
            values[strip::VZ] += rate;
            values[strip::WORK] += self.work;
        }
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = (self.t, self.work);
        self.inner.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        (self.t, self.work) = self.kept;
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

/// A strip moved by a [`Lift`].
pub(crate) struct Lifted {
    /// The strip on its pantograph.
    pub marker: Box<dyn dynamics::Marker>,
    /// How it moves.
    pub lift: Lift,
}

impl dynamics::Marker for Lifted {
    fn frame(&self, motion: &dynamics::Motion<'_>) -> dynamics::Frame {
        let mut frame = self.marker.frame(motion);
        let (height, rate) = self.lift.at(motion.t);
        frame.position.z += height;
        frame.velocity.z += rate;
        frame
    }

    fn columns(&self, motion: &dynamics::Motion<'_>, columns: &mut dynamics::Columns) {
        self.marker.columns(motion, columns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lift_ends_where_its_ramps_lead_and_its_rate_is_its_derivative() {
        let lift = Lift(vec![
            Ramp {
                start: 0.1,
                duration: 0.2,
                rise: -0.05,
            },
            Ramp {
                start: 0.5,
                duration: 0.1,
                rise: 0.05,
            },
        ]);
        assert_eq!(lift.at(0.0), (0.0, 0.0));
        assert!((lift.at(0.4).0 + 0.05).abs() < 1e-15 && lift.at(0.7).0.abs() < 1e-15);
        for t in [0.15, 0.25, 0.55] {
            let h = 1e-6;
            let slope = (lift.at(t + h).0 - lift.at(t - h).0) / (2.0 * h);
            assert!((slope - lift.at(t).1).abs() < 1e-8, "{t}: {slope} {}", lift.at(t).1);
        }
    }
}
