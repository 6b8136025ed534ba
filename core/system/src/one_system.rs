//! Line and pantographs as one system: no coupling, one integrator.

pub mod stepped;
mod whole;

use catenary::{
    CatenaryError, LineAtRest, Slackening, StaticLine, StripContact, StripStart, scene_line, strip_contact,
};
use control::{Channel, ControllerState, Ended, Rule};
use dynamics::{Checkpoint, EnergyBalance, Layout, Simulator, State, StepError, System};
use scene::{PantographModel as Entry, Reduction, Scene};
use serde::{Deserialize, Serialize};
use vehicle::{PantographModel, VehicleError, WIND_INPUTS};

use component::exchange::{contact, line_output_count, strip};
use component::{Frame, Point, Share, Work};

use self::whole::Whole;
use crate::ENERGY_SHARE;
use crate::disturbance::{Deflection, Disturbance, Lifted};
use crate::picture;
use crate::time_shares::{self, Profile};

/// Difference of forces below which the start counts as rest, N.
const AT_REST: f64 = 1e-3;

/// Reason why there is no single system.
#[derive(Debug, thiserror::Error)]
pub enum OneSystemError {
    /// The line.
    #[error(transparent)]
    Line(#[from] CatenaryError),
    /// A pantograph.
    #[error("pantograph[{pantograph}]")]
    Pantograph {
        /// From 1.
        pantograph: usize,
        /// Reason.
        #[source]
        source: VehicleError,
    },
    /// The start.
    #[error("the accelerations at the start")]
    Start(#[source] StepError),
}

/// A scene as one system in time.
pub struct OneSystem {
    simulator: Simulator<Whole>,
    supports: Vec<usize>,
    audit: Option<Audit>,
    repetition: Option<Box<Checkpoint>>,
    control: Control,
    unrepeated: u64,
    /// Sum of the amounts of work that crossed the contacts, step by step, J.
    crossed: f64,
}

/// Controllers of the pantographs that have one.
#[derive(Default)]
struct Control {
    channels: Vec<Channel>,
    /// Pantograph (from 0) of each.
    pantographs: Vec<usize>,
}

impl Control {
    /// Advances the system from `t` to `t + h`, s; see [`control::advance`].
    fn advance(
        &mut self,
        simulator: &mut Simulator<Whole>,
        (t, h): (f64, f64),
        after: &mut dyn FnMut(&mut Whole, Ended<'_>),
    ) -> Result<(), StepError> {
        let pantographs = &self.pantographs;
        control::advance(
            simulator,
            &mut self.channels,
            (t, h),
            &mut |_, _| {},
            &mut |whole, (motion, state), k, reading| whole.read_instruments(&motion, state, pantographs[k], reading),
            after,
        )
    }

    /// States of the controllers.
    fn states(&self) -> impl Iterator<Item = ControllerState> {
        self.channels.iter().map(|channel| channel.controller.state())
    }

    fn set_states(&mut self, states: &[ControllerState]) {
        for (channel, state) in self.channels.iter_mut().zip(states) {
            channel.controller.set_state(*state);
        }
    }
}

/// Observed values besides the contact.
struct Audit {
    balance: EnergyBalance,
    deflected: f64,
    slack: usize,
}

/// Observations of one system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Energy that nothing accounts for at the end, J; positive where the integration has made it.
    pub residual: f64,
    /// Largest amount of the energy, J.
    pub worst_residual: f64,
    /// Work of prescribed motion and heat, their amounts summed step by step, J.
    pub exchanged: f64,
    /// Energy that the line was deflected with, J.
    pub deflected: f64,
    /// Work of prescribed motion, J.
    pub driven: f64,
    /// Heat of dampers and friction, J.
    pub dissipated: f64,
    /// Part of the residual that droppers make by going slack and taut within steps, J; see [`Slackening`].
    pub made_at_droppers: f64,
    /// Largest violation of a constraint, m, and of its rate, m/s.
    pub drift: [f64; 2],
    /// Number of constraints.
    pub constraints: usize,
    /// Most droppers without tension at one time.
    pub slack_droppers: usize,
    /// Steps that did not come out the same when they were repeated from a saved state.
    pub unrepeated: u64,
}

impl OneSystem {
    /// A resolved scene at its start; the supports of these numbers (from 1) are read out.
    ///
    /// # Errors
    /// See [`OneSystemError`].
    pub fn new(scene: &Scene, statics: &StaticLine, supports: &[usize]) -> Result<Self, OneSystemError> {
        Self::with_inputs(scene, statics, supports, 0)
    }

    /// As [`OneSystem::new`], with inputs for the wind on each pantograph, 0 at the start.
    fn with_wind(scene: &Scene, statics: &StaticLine, supports: &[usize]) -> Result<Self, OneSystemError> {
        Self::with_inputs(scene, statics, supports, WIND_INPUTS * scene.pantographs.len())
    }

    fn with_inputs(
        scene: &Scene,
        statics: &StaticLine,
        supports: &[usize],
        inputs: usize,
    ) -> Result<Self, OneSystemError> {
        let mut layout = Layout::new();
        let mut line = scene_line(scene, statics, &mut layout)?;
        let mut pantographs = Vec::new();
        let mut starts = Vec::new();
        for index in 0..scene.pantographs.len() {
            let refused = |source| OneSystemError::Pantograph {
                pantograph: index + 1,
                source,
            };
            let (mut pantograph, start) = PantographModel::started(scene, index, &mut layout).map_err(refused)?;
            if inputs > 0 {
                pantograph.add_wind_input(WIND_INPUTS * index);
            }
            starts.push(start);
            pantographs.push(pantograph);
        }

        // The line settles under the strips as it does alone; a linkage has its own statics.
        let mut alone = LineAtRest::new(scene, statics)?;
        let strips: Vec<StripStart> = (0..scene.strip_count())
            .map(|strip| {
                let (head, _) = scene.head_of(strip);
                let several = scene.pantographs[head].has_several_strips();
                let start = scene.strip_start(strip).filter(|_| several);
                let height = start.map_or(starts[head].height, |start| start.height);
                StripStart::of(scene, strip, height)
            })
            .collect();
        alone.start(&strips)?;
        let wires = line.contact_wires();
        let contacts = (0..strips.len() * wires).map(|contact| {
            let (strip, wire) = (contact / wires, contact % wires);
            let (head, own) = scene.head_of(strip);
            strip_contact(
                scene,
                &*line,
                (strip, wire),
                pantographs[head].strip_at(own),
                &mut layout,
            )
        });
        let contacts = contacts.collect::<Result<Vec<_>, _>>()?;
        let mut control = Control::default();
        for (index, pantograph) in pantographs.iter_mut().enumerate() {
            let start = scene.strips_of(index).map(|strip| alone.force(strip)).sum();
            let channel = pantograph.controlled(scene, index, start, inputs + control.channels.len());
            let channel = channel.map_err(|source| OneSystemError::Pantograph {
                pantograph: index + 1,
                source,
            })?;
            if let Some(channel) = channel {
                control.channels.push(channel);
                control.pantographs.push(index);
            }
        }
        let mut state = layout.state_at_rest();
        let settled = alone.q();
        state.q[..settled.len()].copy_from_slice(settled);
        line.continue_from(&alone.settled());
        line.set_uplift_reference(&state.q);
        // A joint or a damper that moves on along a sloping or bent wire is not in balance at rest.
        let mut balanced = contacts
            .iter()
            .all(|contact| matches!(contact, StripContact::Penalty(pair) if !pair.is_damped()));
        for (index, (pantograph, start)) in pantographs.iter_mut().zip(&starts).enumerate() {
            pantograph.set_initial(start, &mut state);
            let forces: Vec<f64> = scene.strips_of(index).map(|strip| alone.force(strip)).collect();
            balanced &= pantograph.is_balanced(start, &forces, AT_REST);
        }
        let heads = (0..strips.len()).map(|strip| scene.head_of(strip).0);
        let heads = heads.map(|head| (head, scene.strips_of(head).len())).collect();
        let dropper_stiffness = scene.modelled_line().map_or(0.0, |(line, _)| line.droppers.stiffness);
        let whole = Whole {
            layout,
            line,
            pantographs,
            heads,
            contacts,
            slackening: Slackening::new(dropper_stiffness),
            profile: Some(Box::default()),
        };
        let solver = &scene.solver;
        let mut simulator = Simulator::new(
            whole,
            state,
            vec![0.0; inputs + control.channels.len()],
            solver.micro_step,
            solver.rho_inf,
            solver.newton_options(),
        );
        simulator.halve(crate::run::HALVINGS);
        if scene.model.has(Reduction::Modal) {
            simulator.keep_periods(0.0);
        }
        if balanced {
            simulator.begin();
        } else {
            simulator.start_accelerations().map_err(OneSystemError::Start)?;
        }
        simulator.prepare().map_err(OneSystemError::Start)?;
        Ok(Self {
            simulator,
            supports: supports.to_vec(),
            audit: None,
            repetition: None,
            control,
            unrepeated: 0,
            crossed: 0.0,
        })
    }

    /// Takes the commands of pantograph `index` (from 0), which come from outside, from a rule.
    pub fn command_by(&mut self, index: usize, rule: Box<dyn Rule>) {
        if let Some(place) = self.control.pantographs.iter().position(|&own| own == index) {
            self.control.channels[place].controller.obey(rule);
        }
    }

    /// Puts a disturbance on the run to come; steps are not discarded, as there is no way to take them back. The first
    /// step that fails ends a run whose energy is followed.
    ///
    /// # Errors
    /// A deflected line without accelerations at the start.
    pub fn disturb(&mut self, disturbance: &Disturbance) -> Result<(), OneSystemError> {
        if let Some(lift) = &disturbance.lift {
            for contact in &mut self.simulator.system.contacts {
                let lift = lift.clone();
                contact.replace_strip(|marker| Box::new(Lifted { marker, lift }));
            }
        }
        self.repetition = disturbance.repeated.then(Box::default);
        if disturbance.audited || disturbance.repeated {
            self.simulator.halve(0);
        }
        let at_rest = disturbance.audited.then(|| self.simulator.energy_balance().energy());
        if let Some(deflection) = disturbance.deflection {
            self.deflection(deflection.amplitude)?;
        }
        self.audit = at_rest.map(|at_rest| {
            let balance = self.simulator.energy_balance();
            Audit {
                deflected: balance.energy() - at_rest,
                balance,
                slack: 0,
            }
        });
        Ok(())
    }

    /// See [`crate::disturbance::Deflection`]; `amplitude` in m.
    fn deflection(&mut self, amplitude: f64) -> Result<(), OneSystemError> {
        let mut state = self.simulator.state().clone();
        let Some(line) = self.simulator.system.line.shape() else {
            return Ok(());
        };
        Deflection { amplitude }.write(line, &mut state.q);
        self.simulator.set_state(state);
        self.simulator.start_accelerations().map_err(OneSystemError::Start)
    }

    /// Observations of the run so far, where the run is audited.
    #[must_use]
    pub fn evidence(&self) -> Option<Evidence> {
        let Audit {
            balance,
            deflected,
            slack,
        } = self.audit.as_ref()?;
        Some(Evidence {
            residual: balance.residual(),
            worst_residual: balance.worst_residual(),
            exchanged: balance.exchanged(),
            deflected: *deflected,
            driven: balance.driven(),
            dissipated: balance.dissipated(),
            made_at_droppers: self.simulator.system.slackening.made(),
            drift: balance.drift(),
            constraints: self.simulator.system.layout().constraints(),
            slack_droppers: *slack,
            unrepeated: self.unrepeated,
        })
    }

    /// Note for the reader on the energy that the time steps have made at the droppers; nothing where the energy is a
    /// small share of the work that crossed the contact.
    #[must_use]
    pub fn energy_note(&self) -> Option<String> {
        let made = self.simulator.system.slackening.made();
        (made > ENERGY_SHARE * self.crossed).then(|| {
            format!(
                "the time steps made {made:.3} J at droppers that go slack and taut ({:.1} % of the {:.1} J of work \
                 that crossed the contact), so that the force may vary more than it should: a shorter \
                 solver.micro_step or some catenary.droppers.damping leaves less",
                100.0 * made / self.crossed,
                self.crossed
            )
        })
    }

    /// Note on internal steps that failed and were done in halves.
    #[must_use]
    pub fn failure_note(&self) -> Option<String> {
        let halved = self.simulator.halved();
        let first = halved.first.as_ref()?;
        Some(crate::run::halved_note(halved.count, first))
    }

    /// True where every pantograph of a scene is modelled here.
    #[must_use]
    pub fn can(scene: &Scene) -> bool {
        let own = |pantograph: &scene::Pantograph| !matches!(pantograph.model, Entry::Supplied(_));
        scene.modelled_line().is_some() && scene.pantographs.iter().all(own)
    }

    /// Number of generalised coordinates and of constraints.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        let layout = self.simulator.system.layout();
        (layout.coordinates(), layout.constraints())
    }

    /// Values exchanged between the two sides, as a communication point at `t` in s.
    #[must_use]
    pub fn point(&mut self, t: f64) -> Point {
        let strips = self.simulator.system.heads.len();
        let mut point = Point {
            t,
            from: t,
            line: vec![0.0; line_output_count(strips, self.supports.len())],
            strips: vec![0.0; strips * strip::OUTPUTS],
        };
        let supports = &self.supports;
        let (whole, motion, lambda) = self.simulator.parts_with_multipliers();
        whole.read((&motion, lambda), supports, &mut point);
        point
    }

    /// Advances from `t` to `t + h`; `see(previous, present)` is given the two ends of every internal step.
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn advance(
        &mut self,
        t: f64,
        h: f64,
        points: &mut [Point; 2],
        see: &mut dyn FnMut(&Point, &Point),
    ) -> Result<(), StepError> {
        self.with_profile(Profile::begin);
        let result = self.advance_all(t, h, points, see);
        self.with_profile(Profile::end);
        result
    }

    fn with_profile(&mut self, call: impl FnOnce(&mut Profile)) {
        self.simulator.system.profile.as_deref_mut().map(call);
    }

    /// Shares of the time loop of a run, which took `wall` s.
    #[must_use]
    pub fn shares(&self, wall: f64) -> Vec<Share> {
        let profile = self.simulator.system.profile.as_deref();
        profile.map_or_else(Vec::new, |profile| profile.shares(wall))
    }

    fn advance_all(
        &mut self,
        t: f64,
        h: f64,
        points: &mut [Point; 2],
        see: &mut dyn FnMut(&Point, &Point),
    ) -> Result<(), StepError> {
        let first = self.repeat_ahead(t, h)?;
        let supports = &self.supports;
        let crossed = &mut self.crossed;
        self.control
            .advance(&mut self.simulator, (t, h), &mut |whole, (motion, lambda, _, end)| {
                whole.turn_to(time_shares::MASTER);
                let [previous, present] = points;
                present.from = previous.t;
                present.t = end;
                whole.slackening.step(whole.line.elongations());
                whole.read((&motion, lambda), supports, present);
                straighten(previous, present);
                *crossed += work_between(previous, present);
                see(previous, present);
                points.swap(0, 1);
                whole.step_done();
            })?;
        self.unrepeated += u64::from(first.is_some_and(|first| first != *self.simulator.state()));
        if let Some(audit) = &mut self.audit {
            self.simulator.balance(&mut audit.balance, h);
            let (whole, motion) = self.simulator.parts();
            audit.slack = audit.slack.max(whole.line.slack_count(&motion));
        }
        Ok(())
    }

    /// Makes the step to come and takes it back, where that was asked for; returns what it led to.
    fn repeat_ahead(&mut self, t: f64, h: f64) -> Result<Option<State>, StepError> {
        let Some(checkpoint) = &mut self.repetition else {
            return Ok(None);
        };
        self.simulator.save(checkpoint);
        let controllers: Vec<_> = self.control.states().collect();
        self.control.advance(&mut self.simulator, (t, h), &mut |_, _| {})?;
        let state = self.simulator.state().clone();
        self.simulator.restore(checkpoint)?;
        self.control.set_states(&controllers);
        Ok(Some(state))
    }

    /// Work done by the solver.
    #[must_use]
    pub fn work(&self) -> Work {
        let counters = self.simulator.counters();
        Work {
            micro_steps: counters.micro_steps,
            newton_iterations: counters.newton_iterations,
            factorizations: counters.factorizations,
            most_iterations: counters.most_iterations,
            above_tolerance: counters.above_tolerance,
        }
    }

    /// Adds line and pantographs to a picture.
    pub fn draw(&mut self, frame: &mut Frame) {
        let (whole, motion) = self.simulator.parts();
        picture::draw_wires(&*whole.line, &motion, frame);
        for pantograph in &whole.pantographs {
            picture::draw_outline(pantograph, &motion, frame);
        }
    }
}

/// Amounts of work that crossed the contacts in a step, by the mean vertical forces, J.
fn work_between(start: &Point, end: &Point) -> f64 {
    (0..end.strip_count())
        .map(|i| {
            let force = 0.5 * (start.contact(i)[contact::FZ] + end.contact(i)[contact::FZ]);
            (force * (end.strip(i)[strip::Z] - start.strip(i)[strip::Z])).abs()
        })
        .sum()
}

/// Fills the samples of a step with the straight line between its end forces.
fn straighten(start: &Point, end: &mut Point) {
    let strips = end.strip_count();
    for (i, values) in end.line.chunks_exact_mut(contact::COUNT).take(strips).enumerate() {
        let (from, to) = (start.contact(i)[contact::FORCE], values[contact::FORCE]);
        for (j, sample) in values[contact::SAMPLES..contact::SAMPLES + contact::SAMPLE_COUNT]
            .iter_mut()
            .enumerate()
        {
            *sample = from + (to - from) * (j + 1) as f64 / contact::SAMPLE_COUNT as f64;
        }
    }
}
