//! A pantograph as one simulation unit: contact forces come in, the strip's motion goes out.
use crate::given_motion::{Displaced, angles};
use crate::model::marker_acceleration;
use crate::{AppliedForce, PantographModel, Vehicle, VehicleError, WIND_INPUTS};
use component::exchange::instrument;
use control::{Channel, ControllerState, Reading};
use dynamics::{Constraint, Counters, FollowedInput, Force, Frame, Layout, Motion, Simulator, StepError, System};
use nalgebra::Vector3;
use scene::{Reduction, Scene};
use serde::{Deserialize, Serialize};

/// Inputs of a pantograph with one strip: force on the strip in x, y, z (N), lateral position of the contact (m), wind
/// in x, y, z (m/s). The first four come again for each further strip.
pub const INPUTS: usize = AppliedForce::INPUTS + WIND_INPUTS;

/// Difference between the start force of the scene and the force of rest at the start height up to which the start
/// counts as rest, N.
const AT_REST: f64 = 1e-3;

/// Part of a step within which two times are one.
const ROUNDING: f64 = 1e-9;

/// A pantograph under a contact force from outside.
struct Model {
    layout: Layout,
    pantograph: PantographModel,
    /// One per strip.
    contacts: Vec<AppliedForce>,
}

impl System for Model {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.pantograph.forces(visit);
        for contact in &mut self.contacts {
            visit(contact);
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.pantograph.constraints(visit);
    }
}

impl Model {
    /// Reads the instruments of the controller; `u` are the inputs that they have felt last.
    fn read_instruments(&self, motion: &Motion<'_>, v_dot: &[f64], u: &[f64], reading: &mut Reading) {
        self.pantograph.read(motion, v_dot, reading);
        let forces = self.contacts.iter().map(|contact| u[contact.first + 2]);
        reading.force = -forces.sum::<f64>();
    }
}

/// The strip's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripMotion {
    /// Position of the strip's middle, m.
    pub position: Vector3<f64>,
    /// Velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Roll angle about the direction of travel, rad.
    pub roll: f64,
}

/// State needed by a [`Subsystem`] to continue bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    simulator: dynamics::Checkpoint,
    inputs: Vec<FollowedInput>,
    reached: Vec<f64>,
    work: Vec<f64>,
    controllers: Vec<ControllerState>,
}

/// One pantograph of a scene.
pub struct Subsystem {
    simulator: Simulator<Model>,
    inputs: Vec<FollowedInput>,
    /// Controller of the pantograph, where it has one; its force is the last input.
    controllers: Vec<Channel>,
    /// Inputs at the end of the last step; inputs set since then jump.
    reached: Vec<f64>,
    /// Work done by the contact on each strip since the start, J.
    work: Vec<f64>,
    /// Power of the contact on each strip at the end of the last internal step, W, and its integral over the step, J.
    power: Vec<(f64, f64)>,
    before: Checkpoint,
    /// Room for the values of the inputs.
    values: Vec<f64>,
}

impl Subsystem {
    /// Pantograph `index` (from 0) of a scene in the start state: at rest at the start height of the scene, or at the
    /// reference height; a start force other than the force of rest there begins with the acceleration it causes.
    ///
    /// # Errors
    /// See [`VehicleError`].
    pub fn new(scene: &Scene, index: usize) -> Result<Self, VehicleError> {
        let mut layout = Layout::new();
        let (mut pantograph, rest) = PantographModel::started(scene, index, &mut layout)?;
        let strips = pantograph.strips();
        pantograph.add_wind_input(strips * AppliedForce::INPUTS);
        let mut state = layout.state_at_rest();
        pantograph.set_initial(&rest, &mut state);
        let top = scene.pantographs[index].top();
        let contacts = (0..strips).map(|strip| AppliedForce {
            top: top.clone(),
            ..pantograph.applied_force_at(strip, strip * AppliedForce::INPUTS)
        });
        let contacts = contacts.collect();
        let forces: Vec<f64> = (0..strips)
            .map(|strip| {
                let start = scene.pantographs[index].strip_start(strip);
                start.map_or(rest.strip_forces[strip], |start| start.force)
            })
            .collect();
        let solver = &scene.solver;
        let mut inputs = vec![FollowedInput::default(); strips * AppliedForce::INPUTS + WIND_INPUTS];
        for (inputs, force) in inputs.chunks_exact_mut(AppliedForce::INPUTS).zip(&forces) {
            inputs[2].set(-force);
        }
        let mut u: Vec<f64> = inputs.iter().map(FollowedInput::value).collect();
        let controller = pantograph.controlled(scene, index, forces.iter().sum(), u.len())?;
        let controllers: Vec<Channel> = controller.into_iter().collect();
        u.resize(u.len() + controllers.len(), 0.0);
        let at_rest = pantograph.is_balanced(&rest, &forces, AT_REST);
        let model = Model {
            layout,
            pantograph,
            contacts,
        };
        let reached = u.clone();
        let mut simulator = Simulator::new(
            model,
            state,
            u,
            solver.micro_step,
            solver.rho_inf,
            solver.newton_options(),
        );
        if let Some((_, contact)) = scene.modelled_line().filter(|_| scene.model.has(Reduction::Modal)) {
            simulator.keep_periods(contact.stiffness);
        }
        if !at_rest {
            simulator.start_accelerations()?;
        }
        simulator.prepare()?;
        Ok(Self {
            simulator,
            inputs,
            controllers,
            reached,
            work: vec![0.0; strips],
            power: vec![(0.0, 0.0); strips],
            before: Checkpoint::default(),
            values: Vec::new(),
        })
    }

    /// The pantograph and its present motion, for drawing.
    pub fn pantograph(&mut self) -> (&PantographModel, Motion<'_>) {
        let (model, motion) = self.simulator.parts();
        (&model.pantograph, motion)
    }

    /// Number of strips.
    #[must_use]
    pub fn strips(&self) -> usize {
        self.work.len()
    }

    /// Sets an input, see [`INPUTS`].
    pub fn set_contact_input(&mut self, input: usize, value: f64) {
        self.inputs[input].set(value);
        self.refresh_inputs();
    }

    /// The present value of an input.
    #[must_use]
    pub fn contact_input(&self, input: usize) -> f64 {
        self.inputs[input].value()
    }

    /// Sets the derivative of `order` 1…3 of an input at the start of the next step.
    pub fn set_contact_input_derivative(&mut self, input: usize, order: usize, value: f64) {
        self.inputs[input].set_derivative(order, value);
    }

    fn refresh_inputs(&mut self) {
        let mut u = std::mem::take(&mut self.values);
        u.clear();
        u.extend(self.inputs.iter().map(FollowedInput::value));
        u.extend_from_slice(&self.simulator.inputs()[self.inputs.len()..]);
        self.simulator.set_inputs(&u);
        self.values = u;
    }

    /// Advances from `t` to `t + h`, s.
    ///
    /// # Errors
    /// See [`StepError`]; the state is then as before.
    pub fn advance_to(&mut self, t: f64, h: f64) -> Result<(), StepError> {
        let mut before = std::mem::take(&mut self.before);
        self.save_to(&mut before);
        let result = match self.advance(t, h) {
            Ok(()) => Ok(()),
            Err(error) => self.restore_from(&before).and(Err(error)),
        };
        self.before = before;
        result
    }

    fn advance(&mut self, t: f64, h: f64) -> Result<(), StepError> {
        self.simulator.jump(&self.reached, h)?;
        let (model, motion) = self.simulator.parts();
        for (strip, (last, work)) in self.power.iter_mut().enumerate() {
            (*last, *work) = (power(&model.contacts[strip], &motion), 0.0);
        }
        let (inputs, powers, reached) = (&self.inputs, &mut self.power, &self.reached);
        control::advance(
            &mut self.simulator,
            &mut self.controllers,
            (t, h),
            &mut |tau, u| {
                for (value, input) in u.iter_mut().zip(inputs) {
                    *value = input.at(tau);
                }
            },
            &mut |model, (motion, state), _, reading| {
                // At the start of the step the instruments have felt the last one; its end is `t` but for rounding.
                let u = if motion.t - t > ROUNDING * h { motion.u } else { reached };
                model.read_instruments(&motion, &state.v_dot, u, reading);
            },
            &mut |model, (motion, _, dt, _)| {
                for ((last, work), contact) in powers.iter_mut().zip(&model.contacts) {
                    let now = power(contact, &motion);
                    *work += 0.5 * dt * (*last + now);
                    *last = now;
                }
            },
        )?;
        for (work, (_, more)) in self.work.iter_mut().zip(&self.power) {
            *work += more;
        }
        self.reached.copy_from_slice(self.simulator.inputs());
        for input in &mut self.inputs {
            input.finish(input.at(h));
        }
        Ok(())
    }

    fn frame(&mut self, strip: usize) -> Frame {
        let (model, motion) = self.simulator.parts();
        model.contacts[strip].marker.frame(&motion)
    }

    /// Motion of the strip, the first of several, now.
    pub fn strip(&mut self) -> StripMotion {
        self.strip_at(0)
    }

    /// Motion of strip `strip` (from 0) now.
    pub fn strip_at(&mut self, strip: usize) -> StripMotion {
        let frame = self.frame(strip);
        StripMotion {
            position: frame.position,
            velocity: frame.velocity,
            roll: frame.axes[(2, 1)].atan2(frame.axes[(1, 1)]),
        }
    }

    /// See [`PantographModel::wind_on_head`].
    pub fn wind_on_head(&mut self) -> [f64; 2] {
        let (pantograph, motion) = self.pantograph();
        pantograph.wind_on_head(&motion)
    }

    /// Drag and lift of the air on the body of the head, N, of which each strip has an equal part.
    pub fn wind_on_strip(&mut self) -> [f64; 2] {
        let strips = self.strips() as f64;
        self.wind_on_head().map(|force| force / strips)
    }

    /// The pantograph's base in the world.
    pub fn base(&mut self) -> Frame {
        let (pantograph, motion) = self.pantograph();
        pantograph.base_frame(&motion)
    }

    /// Roll, pitch and yaw of the base, rad, see [`GivenMotion`](crate::GivenMotion).
    pub fn base_angles(&mut self) -> [f64; 3] {
        angles(&self.base().axes)
    }

    /// Roll angle of the base about the direction of travel, rad.
    pub fn base_roll(&mut self) -> f64 {
        self.base_angles()[0]
    }

    /// The motion of the base as one that could be given to it.
    pub fn base_displaced(&mut self) -> Displaced {
        let (pantograph, motion) = self.pantograph();
        pantograph.base_displaced(&motion)
    }

    /// Number of wheels of the vehicle under the pantograph; 0 without vehicle.
    #[must_use]
    pub fn wheels(&self) -> usize {
        let vehicle = self.simulator.system.pantograph.vehicle();
        vehicle.map_or(0, Vehicle::wheel_count)
    }

    /// Vertical force of the rail on a wheel (from 0: left and right wheel of each wheelset in turn), N; 0 if there is
    /// no such wheel.
    pub fn wheel_load(&mut self, wheel: usize) -> f64 {
        let (pantograph, motion) = self.pantograph();
        let vehicle = pantograph.vehicle();
        vehicle.map_or(0.0, |vehicle| vehicle.wheel_load(wheel, &motion))
    }

    /// Y/Q of a wheel, counted as in [`Subsystem::wheel_load`]; 0 if no lateral force is modelled.
    pub fn derailment_quotient(&mut self, wheel: usize) -> f64 {
        let (pantograph, motion) = self.pantograph();
        let vehicle = pantograph.vehicle();
        vehicle.map_or(0.0, |vehicle| vehicle.derailment_quotient(wheel, &motion))
    }

    /// Acceleration of the middle of strip `strip` (from 0) from the accelerations of the coordinates, m/s², without
    /// the centripetal acceleration of a turning body.
    pub fn strip_acceleration(&mut self, strip: usize) -> Vector3<f64> {
        let (model, motion, state) = self.simulator.parts_with_state();
        marker_acceleration(&*model.contacts[strip].marker, &motion, &state.v_dot)
    }

    /// Angular velocity of strip `strip` (from 0), rad/s, world axes.
    pub fn strip_angular_velocity(&mut self, strip: usize) -> Vector3<f64> {
        self.frame(strip).angular_velocity
    }

    /// Work done by the contact on strip `strip` (from 0) since the start, J.
    #[must_use]
    pub fn work(&self, strip: usize) -> f64 {
        self.work[strip]
    }

    /// Part of each strip in the force of the controlled drive now, N, or in its moment, N·m; 0 without one.
    pub fn drive_force_of_strip(&mut self) -> f64 {
        let strips = self.strips() as f64;
        let (pantograph, motion) = self.pantograph();
        pantograph.drive_force(&motion) / strips
    }

    /// Sets the command of a controller whose commands are given, N, or N·m on a joint.
    pub fn give_command(&mut self, command: f64) {
        for channel in &mut self.controllers {
            channel.controller.give(command);
        }
    }

    /// Command that was given, N.
    #[must_use]
    pub fn given_command(&self) -> f64 {
        let controller = self.controllers.first();
        controller.map_or(0.0, |channel| channel.controller.given())
    }

    /// Reading of an instrument of the controller now, see [`instrument`]; 0 without controller.
    pub fn shown(&mut self, index: usize) -> f64 {
        let Some(channel) = self.controllers.first_mut() else {
            return 0.0;
        };
        let (model, motion, state) = self.simulator.parts_with_state();
        let reached = &self.reached;
        let desired = channel.controller.desired();
        let shown = channel.controller.show(motion.t, &mut |reading| {
            model.read_instruments(&motion, &state.v_dot, reached, reading);
        });
        instruments(shown, desired)[index]
    }

    /// True where the controlled drive is a moment on a joint.
    #[must_use]
    pub fn drives_joint(&self) -> bool {
        self.simulator.system.pantograph.drives_joint()
    }

    /// True where commands come from outside.
    #[must_use]
    pub fn takes_commands(&self) -> bool {
        self.controllers
            .iter()
            .any(|channel| channel.controller.takes_commands())
    }

    /// Number of generalised coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.simulator.system.layout.coordinates()
    }

    /// Number of constraint equations.
    #[must_use]
    pub fn constraints(&self) -> usize {
        self.simulator.system.layout.constraints()
    }

    /// Work done by the solver.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.simulator.counters()
    }

    /// Stores the whole state into `checkpoint`, reusing memory.
    pub fn save_to(&mut self, checkpoint: &mut Checkpoint) {
        self.simulator.save(&mut checkpoint.simulator);
        checkpoint.inputs.clear();
        checkpoint.inputs.extend_from_slice(&self.inputs);
        checkpoint.reached.clone_from(&self.reached);
        checkpoint.work.clone_from(&self.work);
        checkpoint.controllers.clear();
        let states = self.controllers.iter().map(|channel| channel.controller.state());
        checkpoint.controllers.extend(states);
    }

    /// Restores a checkpoint.
    ///
    /// # Errors
    /// A state of another pantograph, and one whose matrix cannot be factored again.
    pub fn restore_from(&mut self, checkpoint: &Checkpoint) -> Result<(), StepError> {
        StepError::unless_as_many("inputs", checkpoint.inputs.len(), self.inputs.len())?;
        StepError::unless_as_many("inputs", checkpoint.reached.len(), self.reached.len())?;
        StepError::unless_as_many("strips", checkpoint.work.len(), self.work.len())?;
        let controllers = checkpoint.controllers.len();
        StepError::unless_as_many("controllers", controllers, self.controllers.len())?;
        self.simulator.restore(&checkpoint.simulator)?;
        self.inputs.copy_from_slice(&checkpoint.inputs);
        self.reached.clone_from(&checkpoint.reached);
        self.work.clone_from(&checkpoint.work);
        for (channel, state) in self.controllers.iter_mut().zip(&checkpoint.controllers) {
            channel.controller.set_state(*state);
        }
        Ok(())
    }
}

/// Values of the instruments, in the order of [`instrument`]; `desired` is the contact force aimed at, N.
#[must_use]
pub fn instruments(shown: &Reading, desired: f64) -> [f64; instrument::COUNT] {
    let mut values = [0.0; instrument::COUNT];
    for (index, value) in [
        (instrument::FORCE, shown.force),
        (instrument::DESIRED, desired),
        (instrument::VELOCITY, shown.driven),
        (instrument::POSITION, shown.driven_place),
        (instrument::HEAD_HEIGHT, shown.head_height),
        (instrument::HEAD_VELOCITY, shown.head_velocity),
        (instrument::HEAD_ACCELERATION, shown.head_acceleration),
    ] {
        values[index] = value;
    }
    values
}

/// Power of a contact on its strip, W.
fn power(contact: &AppliedForce, motion: &Motion<'_>) -> f64 {
    let frame = contact.marker.frame(motion);
    let u = &motion.u[contact.first..];
    let velocity = frame.velocity + frame.angular_velocity.cross(&contact.lever(&frame, motion));
    Vector3::new(u[0], u[1], u[2]).dot(&velocity)
}
