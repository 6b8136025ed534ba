//! The line as one simulation unit: strips come in, contact forces go out.
//!
//! ```text
//! file      subject
//! model     the line of a scene together with the strips on it
//! exchange  forces and work between strips and line over a communication step
//! of_wire   contact of a strip with one of several contact wires
//! signals   names, units and dependencies of inputs and outputs
//! at_rest   static equilibrium over strips of given heights
//! ```
mod at_rest;
mod exchange;
mod model;
mod of_wire;
mod signals;

pub use at_rest::LineAtRest;
pub use exchange::SAMPLES;
use exchange::{ContactIntegrals, Exchange};
pub use model::{CatenaryError, Model, StaticsInputs, contact_pair, scene_line, static_line, strip_contact};
use signals::input_direction;

use crate::{OverheadLine, StaticLine};
use contact::{ContactPair, ContactState, ContactTotal, STRIP_INPUTS, STRIP_VALUES};
use dynamics::{Counters, FollowedInput, Layout, Motion, Simulator, StaticOptions, StepError, System};
use nalgebra::Vector3;
use scene::Scene;
use serde::{Deserialize, Serialize};

/// Position and speed of a strip at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripStart {
    /// Position along the track, m.
    pub x: f64,
    /// Lateral position, m.
    pub y: f64,
    /// Height above rail, m.
    pub height: f64,
    /// Speed along the track from the start on, m/s.
    pub speed: f64,
}

impl StripStart {
    /// Strip `index` (from 0, over all heads) of a scene, at `height` in m.
    #[must_use]
    pub fn of(scene: &Scene, index: usize, height: f64) -> Self {
        Self {
            x: scene.strip_start_x(index),
            y: scene.strip_start_y(),
            height,
            speed: scene.run.speed,
        }
    }
}

/// Contact quantities at the communication point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOutputs {
    /// Contact force, N.
    pub force: f64,
    /// Force on the strip, N.
    pub on_strip: Vector3<f64>,
    /// Mean of [`ContactOutputs::force`] over the last communication step, N.
    pub mean_force: f64,
    /// Mean of [`ContactOutputs::on_strip`] over the last communication step, N.
    pub mean_on_strip: Vector3<f64>,
    /// Contact force at j/10 of the last communication step, j = 1…10, N.
    pub samples: [f64; SAMPLES],
    /// Work done by the strip on the line since the start, J.
    pub work: f64,
    /// Contact point on the wire, m; the strip's own position beyond the wire.
    pub position: Vector3<f64>,
    /// Vertical velocity of the wire there, m/s.
    pub wire_vz: f64,
    /// Gap, m, positive when open.
    pub gap: f64,
    /// True if wire and strip touch.
    pub closed: bool,
}

/// Complete state of a [`Subsystem`], to continue bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    simulator: dynamics::Checkpoint,
    inputs: Vec<FollowedInput>,
    follow_velocity: bool,
    exchanges: Vec<Exchange>,
}

/// The line of a scene with prescribed strips.
pub struct Subsystem {
    simulator: Simulator<Model>,
    inputs: Vec<FollowedInput>,
    follow_velocity: bool,
    exchanges: Vec<Exchange>,
    before: Checkpoint,
    integrals: ContactIntegrals,
    u: Vec<f64>,
    /// Contact quantities evaluated since the last change.
    outputs: Vec<Option<ContactOutputs>>,
    static_energy: f64,
}

impl Subsystem {
    /// The line of a solved static state with the strips of the scene; [`Subsystem::start`] must follow.
    ///
    /// # Errors
    /// See [`CatenaryError`].
    pub fn new(scene: &Scene, statics: &StaticLine) -> Result<Self, CatenaryError> {
        let mut layout = Layout::new();
        let line = scene_line(scene, statics, &mut layout)?;
        Self::with_line(scene, layout, line)
    }

    /// Subsystem with a line of any kind in its own layout, at rest at zero coordinates.
    ///
    /// # Errors
    /// See [`CatenaryError`].
    pub fn with_line(scene: &Scene, layout: Layout, line: Box<dyn OverheadLine>) -> Result<Self, CatenaryError> {
        let model = Model::with_prescribed_strips(scene, layout, line)?;
        let strips = scene.strip_count();
        let solver = &scene.solver;
        let u = vec![0.0; strips * STRIP_VALUES];
        let state = model.layout().state_at_rest();
        let options = solver.newton_options();
        let mut simulator = Simulator::new(model, state, u.clone(), solver.micro_step, solver.rho_inf, options);
        Ok(Self {
            static_energy: {
                let (model, motion) = simulator.parts();
                model.line.energy(&motion)
            },
            simulator,
            inputs: vec![FollowedInput::default(); strips * STRIP_INPUTS],
            follow_velocity: true,
            exchanges: vec![Exchange::default(); strips],
            before: Checkpoint::default(),
            integrals: ContactIntegrals::new(strips),
            outputs: vec![None; strips],
            u,
        })
    }

    /// The line and its present motion, for drawing.
    pub fn line(&mut self) -> (&dyn OverheadLine, dynamics::Motion<'_>) {
        let (model, motion) = self.simulator.parts();
        (&*model.line, motion)
    }

    /// Number of generalised coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.simulator.system.layout().coordinates()
    }

    /// Starts at rest in equilibrium with strips that stand at these places. The strips then move with their speed,
    /// with which the contacts' dampers act: on a slope of the wire the damper's force comes at once.
    ///
    /// # Errors
    /// When there is no static equilibrium.
    pub fn start(&mut self, strips: &[StripStart]) -> Result<(), CatenaryError> {
        for (inputs, start) in self.inputs.chunks_exact_mut(STRIP_INPUTS).zip(strips) {
            let values = [start.x, start.y, start.height, 0.0, 0.0, 0.0, 0.0];
            for (input, value) in inputs.iter_mut().zip(values) {
                input.set(value);
            }
        }
        self.refresh_inputs();
        // A stiff strip put under the line at rest presses with many times its final force, so the contact stiffens
        // step by step.
        let mut limit = SETTLING_STIFFNESS;
        loop {
            let mut limited = false;
            for contact in &mut self.simulator.system.contacts {
                limited |= contact.limit_stiffness(limit);
            }
            self.simulator.settle(&StaticOptions::modified())?;
            if !limited {
                break;
            }
            limit *= 4.0;
        }
        let q = self.simulator.state().q.clone();
        self.simulator.system.line.set_uplift_reference(&q);
        for (strip, start) in strips.iter().enumerate() {
            self.inputs[strip * STRIP_INPUTS + 3].set(start.speed);
        }
        self.refresh_inputs();
        if strips.iter().any(|start| start.speed != 0.0)
            && self.simulator.system.contacts.iter().any(ContactPair::is_damped)
        {
            self.simulator.start_accelerations()?;
        }
        self.simulator.prepare()?;
        self.outputs.fill(None);
        for strip in 0..self.exchanges.len() {
            let total = self.total(strip);
            let force = total.map_or(0.0, |total| total.force);
            self.exchanges[strip] = Exchange {
                mean_force: force,
                mean_on_strip: total.map_or_else(Vector3::zeros, |total| total.on_strip),
                samples: [force; SAMPLES],
                work: 0.0,
            };
        }
        Ok(())
    }

    /// Sets input `input` (0…6: x, y, z, vx, vy, vz, roll) of a strip.
    pub fn set_strip_input(&mut self, strip: usize, input: usize, value: f64) {
        self.inputs[strip * STRIP_INPUTS + input].set(value);
        self.refresh_inputs();
    }

    /// The present value of an input.
    #[must_use]
    pub fn strip_input(&self, strip: usize, input: usize) -> f64 {
        self.inputs[strip * STRIP_INPUTS + input].value()
    }

    /// Sets the derivative of `order` 1…3 of an input at the start of the next step.
    pub fn set_strip_input_derivative(&mut self, strip: usize, input: usize, order: usize, value: f64) {
        self.inputs[strip * STRIP_INPUTS + input].set_derivative(order, value);
    }

    /// Lets strips without input derivatives move on with their velocity inside a step.
    pub fn set_follow_velocity(&mut self, follow: bool) {
        self.follow_velocity = follow;
    }

    /// See [`Subsystem::set_follow_velocity`].
    #[must_use]
    pub fn follows_velocity(&self) -> bool {
        self.follow_velocity
    }

    /// Advances from `t` to `t + h`, s.
    ///
    /// # Errors
    /// See [`StepError`]; the state is then as before.
    pub fn advance_to(&mut self, t: f64, h: f64) -> Result<(), StepError> {
        // An internal step that fails takes itself back: only steps before it have to be kept.
        if self.simulator.micro_steps(h) == 1 {
            let result = self.advance(t, h);
            self.outputs.fill(None);
            if result.is_err() {
                self.refresh_inputs();
            }
            return result;
        }
        let mut before = std::mem::take(&mut self.before);
        self.save_to(&mut before);
        let result = self.advance(t, h);
        self.outputs.fill(None);
        let result = match result {
            Ok(()) => Ok(()),
            Err(error) => self.restore_from(&before).and(Err(error)),
        };
        self.before = before;
        result
    }

    fn advance(&mut self, t: f64, h: f64) -> Result<(), StepError> {
        let mut integrals = std::mem::take(&mut self.integrals);
        let (model, motion) = self.simulator.parts();
        integrals.begin(model, &motion);
        let (inputs, follow) = (&self.inputs, self.follow_velocity);
        let result = self.simulator.advance(
            t,
            h,
            &mut |tau, u| follow_inputs(inputs, follow, tau, u),
            &mut |model, motion, _, dt| integrals.add(model, &motion, dt),
        );
        if result.is_ok() {
            integrals.finish(&mut self.exchanges);
            follow_inputs(&self.inputs, self.follow_velocity, h, &mut self.u);
            for (inputs, values) in strips_of(&mut self.inputs, &mut self.u) {
                for (input, value) in inputs.iter_mut().zip(values) {
                    input.finish(*value);
                }
            }
        }
        self.integrals = integrals;
        result
    }

    /// Contact quantities of a strip, with the inputs set since the last step.
    pub fn contact(&mut self, strip: usize) -> ContactOutputs {
        if let Some(outputs) = self.outputs[strip] {
            return outputs;
        }
        let outputs = self.evaluate_outputs(strip);
        self.outputs[strip] = Some(outputs);
        outputs
    }

    /// Contact of a strip with all contact wires.
    fn total(&mut self, strip: usize) -> Option<ContactTotal> {
        let (model, motion) = self.simulator.parts();
        let contacts = model.contacts_of(strip).iter();
        ContactTotal::of(contacts.filter_map(|pair| pair.state(&motion)))
    }

    /// Force that a strip bears at rest, N.
    fn borne(&mut self, strip: usize) -> f64 {
        let (model, motion) = self.simulator.parts();
        let contacts = model.contacts_of(strip).iter();
        let borne = contacts.filter_map(|pair| Some(pair.state(&motion)?.borne()));
        borne.fold(0.0, |sum, force| sum + force)
    }

    /// Middle of a strip, m: the place of its contact where no wire reaches over it.
    fn middle_of(&self, strip: usize) -> Vector3<f64> {
        let place = |k: usize| self.inputs[strip * STRIP_INPUTS + k].value();
        Vector3::new(place(0), place(1), place(2))
    }

    fn evaluate_outputs(&mut self, strip: usize) -> ContactOutputs {
        let exchange = self.exchanges[strip];
        let beyond = self.middle_of(strip);
        let total = self.total(strip);
        ContactOutputs {
            force: total.map_or(0.0, |total| total.force),
            on_strip: total.map_or_else(Vector3::zeros, |total| total.on_strip),
            mean_force: exchange.mean_force,
            mean_on_strip: exchange.mean_on_strip,
            samples: exchange.samples,
            work: exchange.work,
            position: total.map_or(beyond, |total| total.position),
            wire_vz: total.map_or(0.0, |total| total.wire_vz),
            gap: total.map_or(f64::MAX, |total| total.gap),
            closed: total.is_some_and(|total| total.closed),
        }
    }

    /// Derivative of the contact outputs with respect to input `input` of a strip, states frozen.
    pub fn contact_sensitivity(&mut self, strip: usize, input: usize) -> Option<crate::Sensitivity> {
        self.changes(strip, |pair, contact, motion| {
            pair.sensitivity(contact, motion, input_direction(input))
        })
    }

    /// Rates of the contact outputs along the present motion, per second.
    pub fn contact_rates(&mut self, strip: usize) -> Option<crate::Sensitivity> {
        self.changes(strip, ContactPair::rates)
    }

    /// Change of the contact outputs from the changes of the contacts of a strip.
    fn changes(
        &mut self,
        strip: usize,
        change: impl Fn(&ContactPair, &ContactState, &Motion<'_>) -> crate::Sensitivity,
    ) -> Option<crate::Sensitivity> {
        let (model, motion) = self.simulator.parts();
        let part = |pair: &ContactPair| {
            let contact = pair.state(&motion)?;
            Some((contact, change(pair, &contact, &motion)))
        };
        match model.contacts_of(strip) {
            [only] => part(only).map(|(_, change)| change),
            all => ContactTotal::change(all.iter().filter_map(part)),
        }
    }

    fn refresh_inputs(&mut self) {
        for (inputs, values) in strips_of(&mut self.inputs, &mut self.u) {
            // The roll rate keeps its value at the end of the last step.
            for (value, input) in values.iter_mut().zip(inputs) {
                *value = input.value();
            }
        }
        self.outputs.fill(None);
        self.simulator.set_inputs(&self.u);
    }

    /// Rise of the contact wire at support `k` (from 0) above its height at the start, m; 0 for a line without supports
    /// of its own.
    pub fn support_uplift(&mut self, k: usize) -> f64 {
        let (model, motion) = self.simulator.parts();
        model.line.uplift(k, motion.q)
    }

    /// Rate of [`Subsystem::support_uplift`], m/s.
    pub fn support_uplift_rate(&mut self, k: usize) -> f64 {
        let (model, motion) = self.simulator.parts();
        model.line.uplift_rate(k, motion.q, motion.v)
    }

    /// Number of strips.
    #[must_use]
    pub fn strips(&self) -> usize {
        self.exchanges.len()
    }

    /// Number of contact wires.
    #[must_use]
    pub fn contact_wires(&self) -> usize {
        self.simulator.system.line.contact_wires()
    }

    /// Number of supports.
    #[must_use]
    pub fn supports(&self) -> usize {
        self.simulator.system.line.support_count()
    }

    /// Number of droppers without force.
    pub fn slack_droppers(&mut self) -> usize {
        let (model, motion) = self.simulator.parts();
        model.line.slack_count(&motion)
    }

    /// Kinetic and potential energy of the line above its static state without strips, J.
    pub fn energy(&mut self) -> f64 {
        let kinetic = self.simulator.kinetic_energy();
        let (model, motion) = self.simulator.parts();
        kinetic + model.line.energy(&motion) - self.static_energy
    }

    /// Work done by the solver.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.simulator.counters()
    }

    /// Stores the complete state into `checkpoint`, reusing its memory.
    pub fn save_to(&mut self, checkpoint: &mut Checkpoint) {
        self.simulator.save(&mut checkpoint.simulator);
        checkpoint.inputs.clone_from(&self.inputs);
        checkpoint.follow_velocity = self.follow_velocity;
        checkpoint.exchanges.clone_from(&self.exchanges);
    }

    /// Goes back to a checkpoint.
    ///
    /// # Errors
    /// A state of another line, and one whose matrix cannot be factored again.
    pub fn restore_from(&mut self, checkpoint: &Checkpoint) -> Result<(), StepError> {
        StepError::unless_as_many("inputs", checkpoint.inputs.len(), self.inputs.len())?;
        StepError::unless_as_many("strips", checkpoint.exchanges.len(), self.exchanges.len())?;
        self.outputs.fill(None);
        self.simulator.restore(&checkpoint.simulator)?;
        self.inputs.clone_from(&checkpoint.inputs);
        self.follow_velocity = checkpoint.follow_velocity;
        self.exchanges.clone_from(&checkpoint.exchanges);
        Ok(())
    }
}

/// Contact stiffness under which a line of any usual tension settles at once, N/m: that of EN 50318.
const SETTLING_STIFFNESS: f64 = 5e4;

/// Inputs of each strip with the values that define its motion.
fn strips_of<'a>(
    inputs: &'a mut [FollowedInput],
    u: &'a mut [f64],
) -> impl Iterator<Item = (&'a mut [FollowedInput], &'a mut [f64])> {
    inputs
        .chunks_exact_mut(STRIP_INPUTS)
        .zip(u.chunks_exact_mut(STRIP_VALUES))
}

/// Sets the values of all strips' motion at `tau` s after the start of the step: a position with derivatives follows
/// them, else its velocity if `follow`, else it is held.
fn follow_inputs(inputs: &[FollowedInput], follow: bool, tau: f64, u: &mut [f64]) {
    for (inputs, u) in inputs.chunks_exact(STRIP_INPUTS).zip(u.chunks_exact_mut(STRIP_VALUES)) {
        for (k, (input, value)) in inputs.iter().zip(&mut *u).enumerate() {
            *value = if k < 3 && follow && !input.has_derivatives() {
                input.value() + inputs[k + 3].integral(tau)
            } else {
                input.at(tau)
            };
        }
        u[STRIP_INPUTS] = inputs[STRIP_INPUTS - 1].rate(tau);
    }
}
