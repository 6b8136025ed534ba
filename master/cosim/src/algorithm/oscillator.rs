//! The bare oscillator as two slaves that leave no error but the coupling's: a free mass, and a spring as its line.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Polynomial;
use crate::slave::{Abilities, Slave, SlaveError};
use component::exchange::{contact, load, strip};

/// `m z̈ = F + f₀`, integrated exactly for a force that is a polynomial of degree up to 3.
#[derive(Clone)]
pub(super) struct Head {
    pub(super) mass: f64,
    pub(super) preload: f64,
    pub(super) z: f64,
    pub(super) v: f64,
    pub(super) work: f64,
    pub(super) inputs: Polynomial,
    pub(super) able: usize,
    pub(super) variable_step: bool,
    pub(super) kept: (f64, f64, f64),
    /// Steps done, those taken back included.
    pub(super) steps: Arc<AtomicUsize>,
}

impl Head {
    pub(super) fn new(mass: f64, z: f64) -> Self {
        let inputs = Polynomial::zeros(load::COUNT);
        Self {
            mass,
            preload: 0.0,
            z,
            v: 0.0,
            work: 0.0,
            inputs,
            able: 3,
            variable_step: true,
            kept: (0.0, 0.0, 0.0),
            steps: Arc::default(),
        }
    }
}

impl Slave for Head {
    fn name(&self) -> &str {
        "head"
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: true,
            input_derivatives: self.able,
            variable_step: self.variable_step,
        }
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.hold(values);
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        assert!(order <= self.able, "order {order} was not offered");
        self.inputs.follow(order, values);
        Ok(())
    }

    fn do_step(&mut self, _t: f64, h: f64) -> Result<(), SlaveError> {
        let force = &self.inputs;
        let [f1, f2, f3] = [0, 1, 2].map(|k| force.derivatives[k][load::FZ]);
        let f0 = force.value[load::FZ] + self.preload;
        let m = self.mass;
        self.z += h * (self.v + h / m * (f0 / 2.0 + h * (f1 / 6.0 + h * (f2 / 24.0 + h * f3 / 120.0))));
        self.v += h / m * (f0 + h * (f1 / 2.0 + h * (f2 / 6.0 + h * f3 / 24.0)));
        self.steps.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.fill(0.0);
        values[strip::Z] = self.z;
        values[strip::VZ] = self.v;
        values[strip::WORK] = self.work;
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = (self.z, self.v, self.work);
        Ok(())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        (self.z, self.v, self.work) = self.kept;
        Ok(())
    }
}

/// A massless line: `F = k z(τ)` on the polynomial that it is given, exact mean.
pub(super) struct Spring {
    pub(super) stiffness: f64,
    pub(super) inputs: Polynomial,
    pub(super) able: usize,
    pub(super) mean: f64,
    pub(super) end: f64,
    /// Value of `contact.force`, positive where the contact counts as closed, without samples; `None`: the force of the
    /// spring, and samples of it.
    pub(super) shown: Option<f64>,
    samples: [f64; contact::SAMPLE_COUNT],
    pub(super) steps: usize,
    pub(super) kept: (f64, f64, usize),
}

impl Spring {
    pub(super) fn new(stiffness: f64, z: f64) -> Self {
        let force = -stiffness * z;
        let inputs = Polynomial::zeros(strip::MOTION);
        Self {
            stiffness,
            inputs,
            able: 3,
            mean: force,
            end: force,
            shown: Some(1.0),
            samples: [-force; contact::SAMPLE_COUNT],
            steps: 0,
            kept: (force, force, 0),
        }
    }
}

impl Slave for Spring {
    fn name(&self) -> &str {
        "spring"
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: true,
            input_derivatives: self.able,
            variable_step: true,
        }
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.inputs.hold(values);
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        assert!(order <= self.able, "order {order} was not offered");
        self.inputs.follow(order, values);
        Ok(())
    }

    fn do_step(&mut self, _t: f64, h: f64) -> Result<(), SlaveError> {
        self.mean = -self.stiffness * self.inputs.mean(strip::Z, h);
        self.end = -self.stiffness * self.inputs.at(strip::Z, h);
        for (j, sample) in self.samples.iter_mut().enumerate() {
            let part = (j + 1) as f64 / contact::SAMPLE_COUNT as f64;
            *sample = self.stiffness * self.inputs.at(strip::Z, part * h);
        }
        self.steps += 1;
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.fill(0.0);
        values[contact::FZ] = self.end;
        values[contact::MEAN_FZ] = self.mean;
        match self.shown {
            Some(shown) => values[contact::FORCE] = shown,
            None => {
                values[contact::FORCE] = -self.end;
                values[contact::SAMPLES..contact::SAMPLES + contact::SAMPLE_COUNT].copy_from_slice(&self.samples);
            }
        }
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = (self.mean, self.end, self.steps);
        Ok(())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        (self.mean, self.end, self.steps) = self.kept;
        Ok(())
    }
}

/// The bare oscillator of unit mass and stiffness (ω = 1), `away` m from rest under a preload in N: while the contact
/// stays closed, what is a line's force can be told from what is open.
pub(super) fn closed(away: f64, preload: f64) -> (Spring, Head) {
    let mut line = Spring::new(1.0, preload + away);
    line.shown = None;
    let mut head = Head::new(1.0, preload + away);
    head.preload = preload;
    (line, head)
}
