//! The line as a component: table of its signals, and its parameters.
use super::SAMPLES;
use crate::{CatenaryError, Checkpoint, Sensitivity, StripStart, Subsystem, static_line};
use ::contact::STRIP_INPUTS;
use component::exchange::{contact, contact_of_wire, strip, support};
use component::{Access, Component, DeclaredSignal, Parameter, SignalEntry, SignalGroup, SignalKind, StepFailure};
use dynamics::StepError;
use nalgebra::Vector3;
use scene::Scene;

const _: () = assert!(STRIP_INPUTS == strip::MOTION && SAMPLES == contact::SAMPLE_COUNT);

/// An output of a contact: its value from the [`ContactOutputs`](crate::ContactOutputs), and for one that depends on
/// the strip's motion without a step in between, its change from the [`Sensitivity`].
macro_rules! contact_output {
    ($index:expr, |$contact:ident| $value:expr) => {
        SignalEntry::output(contact::SIGNALS[$index], |line: &mut Subsystem, strip| {
            let $contact = line.contact(strip);
            $value
        })
    };
    ($index:expr, |$contact:ident| $value:expr, |$change:pat_param| $direct:expr) => {
        SignalEntry {
            declared: contact::SIGNALS[$index],
            access: Access::Output {
                get: |line: &mut Subsystem, strip| {
                    let $contact = line.contact(strip);
                    $value
                },
                rate: |line, strip| line.contact_rates(strip).map_or(0.0, |$change: Sensitivity| $direct),
                partial: Some(|line, strip, input| {
                    line.contact_sensitivity(strip, input)
                        .map_or(0.0, |$change: Sensitivity| $direct)
                }),
            },
        }
    };
}

/// Contact force at sample `J` of the last communication step.
const fn sample<const J: usize>() -> SignalEntry<Subsystem> {
    SignalEntry::output(contact::SIGNALS[contact::SAMPLES + J], |line: &mut Subsystem, strip| {
        line.contact(strip).samples[J]
    })
}

/// Motion of a strip; the inputs of the subsystem have the order of [`strip`].
const fn motion(index: usize, start: fn(&Scene, usize) -> f64) -> SignalEntry<Subsystem> {
    SignalEntry {
        declared: strip::SIGNALS[index],
        access: Access::Input {
            start,
            get: Subsystem::strip_input,
            set: Subsystem::set_strip_input,
            set_derivative: Subsystem::set_strip_input_derivative,
        },
    }
}

static STRIP: [SignalEntry<Subsystem>; strip::MOTION] = [
    motion(strip::X, |scene, index| strip_start(scene, index).x),
    motion(strip::Y, |_, _| 0.0),
    motion(strip::Z, |scene, index| strip_start(scene, index).height),
    motion(strip::VX, |scene, index| strip_start(scene, index).speed),
    motion(strip::VY, |_, _| 0.0),
    motion(strip::VZ, |_, _| 0.0),
    motion(strip::ROLL, |_, _| 0.0),
];

static CONTACT: [SignalEntry<Subsystem>; contact::SIGNALS.len()] = [
    contact_output!(contact::FORCE, |contact| contact.force, |change| change.force),
    contact_output!(contact::FX, |contact| contact.on_strip.x, |change| change
        .force_on_strip
        .x),
    contact_output!(contact::FY, |contact| contact.on_strip.y, |change| change
        .force_on_strip
        .y),
    contact_output!(contact::FZ, |contact| contact.on_strip.z, |change| change
        .force_on_strip
        .z),
    contact_output!(contact::MEAN_FORCE, |contact| contact.mean_force),
    contact_output!(contact::MEAN_FX, |contact| contact.mean_on_strip.x),
    contact_output!(contact::MEAN_FY, |contact| contact.mean_on_strip.y),
    contact_output!(contact::MEAN_FZ, |contact| contact.mean_on_strip.z),
    sample::<0>(),
    sample::<1>(),
    sample::<2>(),
    sample::<3>(),
    sample::<4>(),
    sample::<5>(),
    sample::<6>(),
    sample::<7>(),
    sample::<8>(),
    sample::<9>(),
    contact_output!(contact::WORK, |contact| contact.work),
    contact_output!(contact::X, |contact| contact.position.x, |change| change.position.x),
    contact_output!(contact::Y, |contact| contact.position.y, |change| change.position.y),
    contact_output!(contact::WIRE_Z, |contact| contact.position.z, |change| change
        .position
        .z),
    contact_output!(contact::WIRE_VZ, |contact| contact.wire_vz, |change| change.velocity.z),
    contact_output!(contact::GAP, |contact| contact.gap, |change| change.gap),
    contact_output!(contact::CLOSED, |contact| f64::from(u8::from(contact.closed)), |_| 0.0),
];

/// An output of a strip's contact with one wire, with its change.
macro_rules! output_of_wire {
    ($index:expr, |$contact:ident| $value:expr, |$change:pat_param| $direct:expr) => {
        SignalEntry {
            declared: contact_of_wire::SIGNALS[$index],
            access: Access::Output {
                get: |line: &mut Subsystem, part| {
                    let $contact = line.contact_of_wire(part);
                    $value
                },
                rate: |line, part| line.rates_of_wire(part).map_or(0.0, |$change: Sensitivity| $direct),
                partial: Some(|line, part, input| {
                    line.sensitivity_of_wire(part, input)
                        .map_or(0.0, |$change: Sensitivity| $direct)
                }),
            },
        }
    };
}

static CONTACT_OF_WIRE: [SignalEntry<Subsystem>; contact_of_wire::SIGNALS.len()] = [
    output_of_wire!(contact_of_wire::FORCE, |contact| contact.force, |change| change.force),
    output_of_wire!(contact_of_wire::X, |contact| contact.position.x, |change| change
        .position
        .x),
    output_of_wire!(contact_of_wire::Y, |contact| contact.position.y, |change| change
        .position
        .y),
    output_of_wire!(contact_of_wire::Z, |contact| contact.position.z, |change| change
        .position
        .z),
    output_of_wire!(contact_of_wire::GAP, |contact| contact.gap, |change| change.gap),
    output_of_wire!(
        contact_of_wire::CLOSED,
        |contact| f64::from(u8::from(contact.closed)),
        |_| 0.0
    ),
];

static SUPPORT: [SignalEntry<Subsystem>; 1] = [SignalEntry::output_with_rate(
    support::SIGNALS[support::UPLIFT],
    Subsystem::support_uplift,
    Subsystem::support_uplift_rate,
)];

/// Signals of the line as a whole.
static LINE: [SignalEntry<Subsystem>; 3] = [
    SignalEntry::output(
        DeclaredSignal {
            name: "droppers.slack",
            kind: SignalKind::Integer,
            description: "Number of droppers without force",
        },
        |line, _| line.slack_droppers() as f64,
    ),
    SignalEntry::output(
        DeclaredSignal::real(
            "energy",
            "J",
            "Kinetic and potential energy of the line above its static state without strips",
        ),
        |line, _| line.energy(),
    ),
    SignalEntry {
        declared: DeclaredSignal {
            name: "inputs.follow_velocity",
            kind: SignalKind::Boolean,
            description: "Whether a strip without input derivatives moves on with its velocity inside a step",
        },
        access: Access::Parameter {
            start: 1.0,
            get: |line| f64::from(u8::from(line.follows_velocity())),
            set: |line, value| line.set_follow_velocity(value != 0.0),
        },
    },
];

/// Signals of a line with this many strips, contact wires and supports.
fn groups(strips: usize, wires: usize, supports: usize) -> [SignalGroup<Subsystem>; 5] {
    let group = |name, entries, members| SignalGroup {
        name,
        entries,
        members,
        parts: None,
    };
    // The only wire has the signals of the strip's contact.
    let several = if wires > 1 { strips } else { 0 };
    let of_wires = SignalGroup {
        parts: Some((contact_of_wire::PART, wires)),
        ..group(Some(contact_of_wire::GROUP), &CONTACT_OF_WIRE[..], several)
    };
    [
        group(Some(strip::GROUP), &STRIP[..], strips),
        group(Some(contact::GROUP), &CONTACT[..], strips),
        group(Some(support::GROUP), &SUPPORT[..], supports),
        group(None, &LINE[..], 1),
        of_wires,
    ]
}

impl Component for Subsystem {
    type Checkpoint = Checkpoint;
    type Error = CatenaryError;
    type Groups = [SignalGroup<Self>; 5];

    const IDENTIFIER: &'static str = "Catenary";
    const DESCRIPTION: &'static str = "Overhead line of ANCF wires under collector strips that are given from outside.";

    fn load(text: &str, origin: &str) -> Result<Scene, scene::SceneError> {
        crate::mesh::load(text, origin, &[])
    }

    fn check(scene: &Scene, origin: &str) -> Result<(), scene::SceneError> {
        crate::mesh::check(scene, origin)
    }

    fn groups_of(scene: &Scene) -> Self::Groups {
        let line = scene.modelled_line().map(|(line, _)| line);
        let wires = line.map_or(0, scene::Catenary::contact_wires);
        groups(scene.strip_count(), wires, line.map_or(0, |line| line.spans() + 1))
    }

    fn groups(&self) -> Self::Groups {
        groups(self.strips(), self.contact_wires(), self.supports())
    }

    fn parameters(scene: &Scene) -> Vec<Parameter> {
        parameters(scene)
    }

    fn build(scene: &Scene) -> Result<Self, CatenaryError> {
        let statics = static_line(scene)?;
        let mut subsystem = Self::new(scene, &statics)?;
        let starts: Vec<StripStart> = (0..scene.strip_count())
            .map(|strip| strip_start(scene, strip))
            .collect();
        subsystem.start(&starts)?;
        Ok(subsystem)
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
            above_tolerance: counters.above_tolerance,
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
    let x = scene.strip_start_x(strip);
    let resting = scene.modelled_line().map_or(0.0, |(line, _)| line.chord_height(x));
    let height = scene.strip_start(strip).map_or(resting, |start| start.height);
    StripStart::of(scene, strip, height)
}

/// Parameter of the modelled line or of its contact at a field of the entry in the scene; 0 without a modelled line.
macro_rules! parameter {
    ($name:literal, $unit:literal, $text:literal, $entry:ident.$($field:ident).+) => {
        Parameter::new(
            $name,
            $unit,
            $text,
            |scene| scene.modelled_line().map_or(0.0, |line| parameter!(@entry $entry line).$($field).+),
            |scene, value| {
                if let Some(line) = modelled(scene) {
                    parameter!(@entry $entry line).$($field).+ = value;
                }
            },
        )
    };
    (@entry catenary $line:ident) => { $line.0 };
    (@entry contact $line:ident) => { $line.1 };
}

fn modelled(scene: &mut Scene) -> Option<(&mut scene::Catenary, &mut scene::Contact)> {
    match (&mut scene.catenary, &mut scene.contact) {
        (scene::Line::Modelled(catenary), Some(contact)) => Some((catenary, contact)),
        _ => None,
    }
}

/// Parameter of the messenger wire; 0 on a line without one, where nothing sets it.
fn messenger(
    name: &'static str,
    unit: &'static str,
    text: &'static str,
    of: fn(&mut scene::Wire) -> &mut f64,
) -> Parameter {
    Parameter::new(
        name,
        unit,
        text,
        move |scene| {
            let wire = scene.modelled_line().and_then(|(line, _)| line.messenger_wire);
            wire.map_or(0.0, |mut wire| *of(&mut wire))
        },
        move |scene, value| {
            if let Some(wire) = modelled(scene).and_then(|(line, _)| line.messenger_wire.as_mut()) {
                *of(wire) = value;
            }
        },
    )
}

/// Parameter of a list per support or span, in m: its first entry, with which the others move.
fn geometry(name: &'static str, text: &'static str, of: fn(&mut scene::TensionLength) -> &mut Vec<f64>) -> Parameter {
    let first = move |scene: &Scene| {
        let mut line = scene.modelled_line()?.0.tension_lengths[0].clone();
        of(&mut line).first().copied()
    };
    Parameter::new(
        name,
        "m",
        text,
        move |scene| first(scene).unwrap_or(0.0),
        move |scene, value| {
            let change = value - first(scene).unwrap_or(0.0);
            let lines = modelled(scene)
                .into_iter()
                .flat_map(|(line, _)| &mut line.tension_lengths);
            for line in lines {
                let list = of(line);
                match list.as_mut_slice() {
                    [only] => *only = value,
                    all => all.iter_mut().for_each(|entry| *entry += change),
                }
            }
        },
    )
}

fn parameters(scene: &Scene) -> Vec<Parameter> {
    let mut parameters = vec![
        geometry(
            "catenary.contact_wire_height",
            "Height of the contact wire at the supports above the top of rail",
            |line| &mut line.contact_wire_height,
        ),
        geometry(
            "catenary.encumbrance",
            "Height of the messenger wire above the contact wire at the supports",
            |line| &mut line.encumbrance,
        ),
        geometry("catenary.presag", "Lowering of the contact wire at mid-span", |line| {
            &mut line.presag
        }),
        parameter!(
            "catenary.gravity",
            "m/s2",
            "Gravitational acceleration",
            catenary.gravity
        ),
        parameter!(
            "catenary.contact_wire.mass_per_length",
            "kg/m",
            "Mass per length of the contact wire",
            catenary.contact_wire.mass_per_length
        ),
        parameter!(
            "catenary.contact_wire.tension",
            "N",
            "Tension of the contact wire",
            catenary.contact_wire.tension
        ),
        parameter!(
            "catenary.contact_wire.axial_stiffness",
            "N",
            "Axial stiffness EA of the contact wire",
            catenary.contact_wire.axial_stiffness
        ),
        parameter!(
            "catenary.contact_wire.bending_stiffness",
            "N.m2",
            "Bending stiffness EI of the contact wire",
            catenary.contact_wire.bending_stiffness
        ),
        messenger(
            "catenary.messenger_wire.mass_per_length",
            "kg/m",
            "Mass per length of the messenger wire",
            |wire| &mut wire.mass_per_length,
        ),
        messenger(
            "catenary.messenger_wire.tension",
            "N",
            "Tension of the messenger wire",
            |wire| &mut wire.tension,
        ),
        messenger(
            "catenary.messenger_wire.axial_stiffness",
            "N",
            "Axial stiffness EA of the messenger wire",
            |wire| &mut wire.axial_stiffness,
        ),
        messenger(
            "catenary.messenger_wire.bending_stiffness",
            "N.m2",
            "Bending stiffness EI of the messenger wire",
            |wire| &mut wire.bending_stiffness,
        ),
        parameter!(
            "catenary.droppers.stiffness",
            "N/m",
            "Stiffness of a taut dropper",
            catenary.droppers.stiffness
        ),
        parameter!(
            "catenary.droppers.damping",
            "N.s/m",
            "Damping of a taut dropper",
            catenary.droppers.damping
        ),
        parameter!(
            "catenary.droppers.mass",
            "kg",
            "Mass of a dropper",
            catenary.droppers.mass
        ),
        parameter!(
            "catenary.supports.messenger_vertical_stiffness",
            "N/m",
            "Vertical stiffness of a messenger support",
            catenary.supports.messenger_vertical_stiffness
        ),
        parameter!(
            "catenary.supports.messenger_longitudinal_stiffness",
            "N/m",
            "Longitudinal stiffness of a messenger support",
            catenary.supports.messenger_longitudinal_stiffness
        ),
        parameter!(
            "catenary.registration_arms.vertical_stiffness",
            "N/m",
            "Vertical stiffness of a registration arm",
            catenary.registration_arms.vertical_stiffness
        ),
        parameter!(
            "catenary.registration_arms.mass",
            "kg",
            "Mass of a registration arm on the contact wire",
            catenary.registration_arms.mass
        ),
        parameter!(
            "catenary.damping.alpha",
            "1/s",
            "Rayleigh damping of the wires in proportion to mass",
            catenary.damping.alpha
        ),
        parameter!(
            "catenary.damping.beta",
            "s",
            "Rayleigh damping of the wires in proportion to transverse stiffness",
            catenary.damping.beta
        ),
        parameter!(
            "contact.stiffness",
            "N/m",
            "Penalty stiffness of the contact",
            contact.stiffness
        ),
        parameter!(
            "contact.damping",
            "N.s/m",
            "Penalty damping of the contact",
            contact.damping
        ),
    ];
    parameters.extend(component::solver_parameters());
    for strip in 0..scene.strip_count() {
        parameters.extend(component::strip_start_parameters(strip));
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
