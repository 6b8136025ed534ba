//! The line as a component: names, units and dependencies of its inputs and outputs.
use super::SAMPLES;
use crate::contact::STRIP_INPUTS;
use crate::{CatenaryError, Checkpoint, Sensitivity, StripStart, Subsystem, static_line};
use component::{Component, Kind, Parameter, Role, Signal, StepFailure};
use dynamics::StepError;
use nalgebra::Vector3;
use scene::Scene;

/// Outputs of one contact, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ContactSignal {
    Force,
    OnStrip(usize),
    MeanForce,
    MeanOnStrip(usize),
    Sample(usize),
    Work,
    Position(usize),
    WireZ,
    WireVz,
    Gap,
    Closed,
}

const CONTACT_SIGNALS: usize = 23;

impl ContactSignal {
    fn at(offset: usize) -> Self {
        match offset {
            0 => Self::Force,
            1..=3 => Self::OnStrip(offset - 1),
            4 => Self::MeanForce,
            5..=7 => Self::MeanOnStrip(offset - 5),
            8..=17 => Self::Sample(offset - 8),
            18 => Self::Work,
            19..=20 => Self::Position(offset - 19),
            21 => Self::WireZ,
            22 => Self::WireVz,
            _ => unreachable!("a contact has {} signals", CONTACT_SIGNALS + 2),
        }
    }
}

/// Meaning of a position in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineSignal {
    Input { strip: usize, input: usize },
    Contact { strip: usize, signal: ContactSignal },
    Uplift(usize),
    Slack,
    Energy,
    FollowVelocity,
}

/// Signals per contact: those by offset, then gap and closed.
const PER_CONTACT: usize = CONTACT_SIGNALS + 2;

impl Subsystem {
    fn place(&self, signal: usize) -> LineSignal {
        let strips = self.strips();
        let outputs = strips * STRIP_INPUTS;
        let supports = outputs + strips * PER_CONTACT;
        let rest = supports + self.supports();
        if signal < outputs {
            LineSignal::Input {
                strip: signal / STRIP_INPUTS,
                input: signal % STRIP_INPUTS,
            }
        } else if signal < supports {
            let offset = (signal - outputs) % PER_CONTACT;
            LineSignal::Contact {
                strip: (signal - outputs) / PER_CONTACT,
                signal: match offset {
                    CONTACT_SIGNALS => ContactSignal::Gap,
                    offset if offset > CONTACT_SIGNALS => ContactSignal::Closed,
                    offset => ContactSignal::at(offset),
                },
            }
        } else if signal < rest {
            LineSignal::Uplift(signal - supports)
        } else {
            match signal - rest {
                0 => LineSignal::Slack,
                1 => LineSignal::Energy,
                _ => LineSignal::FollowVelocity,
            }
        }
    }
}

/// Picks the change of a contact output per unit of a change of the contact.
fn pick(signal: ContactSignal, change: &Sensitivity) -> f64 {
    match signal {
        ContactSignal::Force => change.force,
        ContactSignal::OnStrip(axis) => change.force_on_strip[axis],
        ContactSignal::Position(axis) => change.position[axis],
        ContactSignal::WireZ => change.position.z,
        ContactSignal::WireVz => change.velocity.z,
        ContactSignal::Gap => change.gap,
        _ => 0.0,
    }
}

impl Component for Subsystem {
    type Checkpoint = Checkpoint;
    type Error = CatenaryError;

    const IDENTIFIER: &'static str = "Catenary";
    const DESCRIPTION: &'static str = "Overhead line of ANCF wires under collector strips that are given from outside.";

    fn load(text: &str, origin: &str) -> Result<Scene, scene::SceneError> {
        crate::mesh::load(text, origin, &[])
    }

    fn check(scene: &Scene, origin: &str) -> Result<(), scene::SceneError> {
        crate::mesh::check(scene, origin)
    }

    fn signals(scene: &Scene) -> Vec<Signal> {
        let mut signals = Vec::new();
        for strip in 0..scene.pantographs.len() {
            signals.extend(strip_inputs(scene, strip));
        }
        for strip in 0..scene.pantographs.len() {
            contact_outputs(strip, &mut signals);
        }
        let supports = scene.modelled_line().map_or(0, |(line, _)| line.spans() + 1);
        signals.extend((1..=supports).map(|k| {
            let text = format!("Rise of the contact wire at support {k} above its height at the start");
            Signal::output(format!("support[{k}].uplift"), "m", text)
        }));
        signals.push(Signal::new(
            "droppers.slack",
            Role::Output,
            Kind::Integer,
            0.0,
            "Number of droppers without force",
        ));
        signals.push(Signal::output(
            "energy",
            "J",
            "Kinetic and potential energy of the line above its static state without strips",
        ));
        signals.push(Signal::new(
            "inputs.follow_velocity",
            Role::Setting,
            Kind::Boolean,
            1.0,
            "Whether a strip without input derivatives moves on with its velocity inside a step",
        ));
        signals
    }

    fn parameters(scene: &Scene) -> Vec<Parameter> {
        parameters(scene)
    }

    fn build(scene: &Scene) -> Result<Self, CatenaryError> {
        let statics = static_line(scene)?;
        let mut subsystem = Self::new(scene, &statics)?;
        let starts: Vec<StripStart> = (0..scene.pantographs.len())
            .map(|strip| strip_start(scene, strip))
            .collect();
        subsystem.start(&starts)?;
        Ok(subsystem)
    }

    fn set_input(&mut self, signal: usize, value: f64) {
        match self.place(signal) {
            LineSignal::Input { strip, input } => self.set_strip_input(strip, input, value),
            LineSignal::FollowVelocity => self.set_follow_velocity(value != 0.0),
            place => unreachable!("{place:?} is not an input"),
        }
    }

    fn input(&self, signal: usize) -> f64 {
        match self.place(signal) {
            LineSignal::Input { strip, input } => self.strip_input(strip, input),
            place => unreachable!("{place:?} is not an input"),
        }
    }

    fn set_input_derivative(&mut self, signal: usize, order: usize, value: f64) {
        match self.place(signal) {
            LineSignal::Input { strip, input } => self.set_strip_input_derivative(strip, input, order, value),
            place => unreachable!("{place:?} is not an input"),
        }
    }

    fn output(&mut self, signal: usize) -> f64 {
        match self.place(signal) {
            LineSignal::Contact { strip, signal } => {
                let contact = self.contact(strip);
                match signal {
                    ContactSignal::Force => contact.force,
                    ContactSignal::OnStrip(axis) => contact.on_strip[axis],
                    ContactSignal::MeanForce => contact.mean_force,
                    ContactSignal::MeanOnStrip(axis) => contact.mean_on_strip[axis],
                    ContactSignal::Sample(j) => contact.samples[j],
                    ContactSignal::Work => contact.work,
                    ContactSignal::Position(axis) => contact.position[axis],
                    ContactSignal::WireZ => contact.position.z,
                    ContactSignal::WireVz => contact.wire_vz,
                    ContactSignal::Gap => contact.gap,
                    ContactSignal::Closed => f64::from(u8::from(contact.closed)),
                }
            }
            LineSignal::Uplift(k) => self.support_uplift(k),
            LineSignal::Slack => self.slack_droppers() as f64,
            LineSignal::Energy => self.energy(),
            LineSignal::FollowVelocity => f64::from(u8::from(self.follows_velocity())),
            LineSignal::Input { strip, input } => self.strip_input(strip, input),
        }
    }

    fn output_rate(&mut self, signal: usize) -> f64 {
        match self.place(signal) {
            LineSignal::Contact { strip, signal } => {
                self.contact_rates(strip).map_or(0.0, |rates| pick(signal, &rates))
            }
            LineSignal::Uplift(k) => self.support_uplift_rate(k),
            _ => 0.0,
        }
    }

    fn sensitivity(&mut self, output: usize, input: usize) -> f64 {
        match (self.place(output), self.place(input)) {
            (LineSignal::Contact { strip, signal }, LineSignal::Input { strip: other, input }) if strip == other => {
                self.contact_sensitivity(strip, input)
                    .map_or(0.0, |change| pick(signal, &change))
            }
            _ => 0.0,
        }
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), StepFailure> {
        self.advance_to(t, h).map_err(failure)
    }

    fn save(&mut self, checkpoint: &mut Checkpoint) {
        self.save_to(checkpoint);
    }

    fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), StepFailure> {
        self.restore_from(checkpoint).map_err(failure)
    }

    fn work(&self) -> component::Work {
        let counters = self.counters();
        component::Work {
            micro_steps: counters.micro_steps,
            newton_iterations: counters.newton_iterations,
            factorizations: counters.factorizations,
            most_iterations: counters.most_iterations,
        }
    }
}

fn failure(error: StepError) -> StepFailure {
    StepFailure {
        retryable: error.is_retryable(),
        reason: error.to_string(),
    }
}

/// Start of a strip in the scene; by default on the wire without pressing.
fn strip_start(scene: &Scene, strip: usize) -> StripStart {
    let resting = scene.modelled_line().map_or(0.0, |(line, _)| line.contact_wire_height);
    let height = scene.pantographs[strip].start.map_or(resting, |start| start.height);
    StripStart::of(scene, strip, height)
}

fn strip_inputs(scene: &Scene, strip: usize) -> [Signal; STRIP_INPUTS] {
    let start = strip_start(scene, strip);
    let i = strip + 1;
    [
        ("x", "m", start.x, "Position of the strip's middle along the track"),
        (
            "y",
            "m",
            0.0,
            "Lateral position of the strip's middle, positive to the left",
        ),
        (
            "z",
            "m",
            start.height,
            "Height of the strip's middle above the top of rail",
        ),
        ("vx", "m/s", start.speed, "Velocity of the strip along the track"),
        ("vy", "m/s", 0.0, "Lateral velocity of the strip"),
        ("vz", "m/s", 0.0, "Vertical velocity of the strip"),
        (
            "roll",
            "rad",
            0.0,
            "Roll angle of the strip about the direction of travel",
        ),
    ]
    .map(|(name, unit, start, text)| Signal::input(format!("strip[{i}].{name}"), unit, start, text))
}

fn contact_outputs(strip: usize, signals: &mut Vec<Signal>) {
    let i = strip + 1;
    let inputs: Vec<usize> = (strip * STRIP_INPUTS..(strip + 1) * STRIP_INPUTS).collect();
    let mut add = |name: String, unit, text: String, direct: bool| {
        let fed: &[usize] = if direct { &inputs } else { &[] };
        signals.push(Signal::output(format!("contact[{i}].{name}"), unit, text).fed_by(fed));
    };
    let axes = ["x", "y", "z"];
    add(
        "force".into(),
        "N",
        "Normal contact force, compression positive".into(),
        true,
    );
    for axis in axes {
        add(format!("f{axis}"), "N", format!("Force on the strip in {axis}"), true);
    }
    add(
        "mean_force".into(),
        "N",
        "Mean of the normal contact force over the last communication step".into(),
        false,
    );
    for axis in axes {
        let text = format!("Mean of the force on the strip in {axis} over the last communication step");
        add(format!("mean_f{axis}"), "N", text, false);
    }
    for j in 1..=SAMPLES {
        let text = format!("Normal contact force at {j}/{SAMPLES} of the last communication step");
        add(format!("sample[{j}]"), "N", text, false);
    }
    add(
        "work".into(),
        "J",
        "Work done by the strip on the line since the start".into(),
        false,
    );
    add(
        "x".into(),
        "m",
        "Position of the contact point along the track".into(),
        true,
    );
    add("y".into(), "m", "Lateral position of the contact point".into(), true);
    add(
        "wire.z".into(),
        "m",
        "Height of the contact wire at the contact point".into(),
        true,
    );
    add(
        "wire.vz".into(),
        "m/s",
        "Vertical velocity of the contact wire at the contact point".into(),
        true,
    );
    add(
        "gap".into(),
        "m",
        "Gap between strip and wire, positive when open".into(),
        true,
    );
    signals.push(
        Signal::new(
            format!("contact[{i}].closed"),
            Role::Output,
            Kind::Boolean,
            0.0,
            "Whether strip and wire touch",
        )
        .fed_by(&inputs),
    );
}

/// Value of the modelled line: name, unit, meaning, and access.
type LineValue = (
    &'static str,
    &'static str,
    &'static str,
    fn(&mut scene::Catenary) -> &mut f64,
);

/// Values of the line that an importer can set.
const LINE_VALUES: [LineValue; 21] = [
    (
        "contact_wire_height",
        "m",
        "Height of the contact wire at the supports above the top of rail",
        |c| &mut c.contact_wire_height,
    ),
    (
        "encumbrance",
        "m",
        "Height of the messenger wire above the contact wire at the supports",
        |c| &mut c.encumbrance,
    ),
    ("presag", "m", "Lowering of the contact wire at mid-span", |c| {
        &mut c.presag
    }),
    ("gravity", "m/s2", "Gravitational acceleration", |c| &mut c.gravity),
    (
        "contact_wire.mass_per_length",
        "kg/m",
        "Mass per length of the contact wire",
        |c| &mut c.contact_wire.mass_per_length,
    ),
    ("contact_wire.tension", "N", "Tension of the contact wire", |c| {
        &mut c.contact_wire.tension
    }),
    (
        "contact_wire.axial_stiffness",
        "N",
        "Axial stiffness EA of the contact wire",
        |c| &mut c.contact_wire.axial_stiffness,
    ),
    (
        "contact_wire.bending_stiffness",
        "N.m2",
        "Bending stiffness EI of the contact wire",
        |c| &mut c.contact_wire.bending_stiffness,
    ),
    (
        "messenger_wire.mass_per_length",
        "kg/m",
        "Mass per length of the messenger wire",
        |c| &mut c.messenger_wire.mass_per_length,
    ),
    ("messenger_wire.tension", "N", "Tension of the messenger wire", |c| {
        &mut c.messenger_wire.tension
    }),
    (
        "messenger_wire.axial_stiffness",
        "N",
        "Axial stiffness EA of the messenger wire",
        |c| &mut c.messenger_wire.axial_stiffness,
    ),
    (
        "messenger_wire.bending_stiffness",
        "N.m2",
        "Bending stiffness EI of the messenger wire",
        |c| &mut c.messenger_wire.bending_stiffness,
    ),
    ("droppers.stiffness", "N/m", "Stiffness of a taut dropper", |c| {
        &mut c.droppers.stiffness
    }),
    ("droppers.damping", "N.s/m", "Damping of a taut dropper", |c| {
        &mut c.droppers.damping
    }),
    ("droppers.mass", "kg", "Mass of a dropper", |c| &mut c.droppers.mass),
    (
        "supports.messenger_vertical_stiffness",
        "N/m",
        "Vertical stiffness of a messenger support",
        |c| &mut c.supports.messenger_vertical_stiffness,
    ),
    (
        "supports.messenger_longitudinal_stiffness",
        "N/m",
        "Longitudinal stiffness of a messenger support",
        |c| &mut c.supports.messenger_longitudinal_stiffness,
    ),
    (
        "registration_arms.vertical_stiffness",
        "N/m",
        "Vertical stiffness of a registration arm",
        |c| &mut c.registration_arms.vertical_stiffness,
    ),
    (
        "registration_arms.mass",
        "kg",
        "Mass of a registration arm on the contact wire",
        |c| &mut c.registration_arms.mass,
    ),
    (
        "damping.alpha",
        "1/s",
        "Rayleigh damping of the wires in proportion to mass",
        |c| &mut c.damping.alpha,
    ),
    (
        "damping.beta",
        "s",
        "Rayleigh damping of the wires in proportion to transverse stiffness",
        |c| &mut c.damping.beta,
    ),
];

/// Value of the contact with its signal.
type ContactValue = (
    &'static str,
    &'static str,
    &'static str,
    fn(&mut scene::Contact) -> &mut f64,
);

fn modelled(scene: &mut Scene) -> Option<(&mut scene::Catenary, &mut scene::Contact)> {
    match (&mut scene.catenary, &mut scene.contact) {
        (scene::Line::Modelled(catenary), Some(contact)) => Some((catenary, contact)),
        _ => None,
    }
}

fn parameters(scene: &Scene) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    for (name, unit, text, field) in LINE_VALUES {
        parameters.push(Parameter::new(
            format!("catenary.{name}"),
            unit,
            text,
            move |scene| modelled(&mut scene.clone()).map_or(0.0, |(line, _)| *field(line)),
            move |scene, value| {
                if let Some((line, _)) = modelled(scene) {
                    *field(line) = value;
                }
            },
        ));
    }
    let contact: [ContactValue; 2] = [
        ("contact.stiffness", "N/m", "Penalty stiffness of the contact", |c| {
            &mut c.stiffness
        }),
        ("contact.damping", "N.s/m", "Penalty damping of the contact", |c| {
            &mut c.damping
        }),
    ];
    for (name, unit, text, field) in contact {
        parameters.push(Parameter::new(
            name,
            unit,
            text,
            move |scene| modelled(&mut scene.clone()).map_or(0.0, |(_, contact)| *field(contact)),
            move |scene, value| {
                if let Some((_, contact)) = modelled(scene) {
                    *field(contact) = value;
                }
            },
        ));
    }
    parameters.extend(component::solver_parameters());
    for strip in 0..scene.pantographs.len() {
        parameters.extend(component::start_parameters(strip, &format!("strip[{}].", strip + 1)));
    }
    parameters
}

/// Unit vectors along which the inputs move a strip: translation, rotation and velocity per unit of input `input`.
pub(super) fn input_direction(input: usize) -> [Vector3<f64>; 3] {
    let (zero, unit) = (Vector3::zeros(), Vector3::ith(input % 3, 1.0));
    match input {
        0..=2 => [unit, zero, zero],
        3..=5 => [zero, zero, unit],
        _ => [zero, Vector3::x(), zero],
    }
}
