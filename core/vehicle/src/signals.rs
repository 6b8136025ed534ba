//! The pantograph as a component: table of its signals, and its parameters.
use crate::{AppliedForce, Checkpoint, INPUTS, Subsystem, VehicleError};
use component::exchange::{instrument, load, moment, strip};
use component::{Access, Component, DeclaredSignal, Parameter, SignalEntry, SignalGroup, StepFailure};
use dynamics::StepError;
use scene::{ControlLaw, PantographModel, Scene};

mod head;
mod vehicle;

const _: () = assert!(INPUTS == load::COUNT + WIND.len() && AppliedForce::INPUTS == load::COUNT);

/// Input at `first` (strips of the pantograph, member of the group) plus its entry in the table of its group.
macro_rules! input {
    ($declared:expr, $start:expr, |$strips:pat_param, $member:pat_param| $first:expr) => {
        SignalEntry {
            declared: $declared,
            access: Access::Input {
                start: $start,
                get: |side: &Subsystem, $member, entry| {
                    let $strips = side.strips();
                    side.contact_input($first + entry)
                },
                set: |side, $member, entry, value| {
                    let $strips = side.strips();
                    side.set_contact_input($first + entry, value);
                },
                set_derivative: |side, $member, entry, order, value| {
                    let $strips = side.strips();
                    side.set_contact_input_derivative($first + entry, order, value);
                },
            },
        }
    };
}

/// Load of a strip.
const fn load_entry(index: usize, start: fn(&Scene, usize) -> f64) -> SignalEntry<Subsystem> {
    input!(load::SIGNALS[index], start, |_, strip| strip * load::COUNT)
}

static LOAD: [SignalEntry<Subsystem>; load::COUNT] = [
    load_entry(load::FX, |_, _| 0.0),
    load_entry(load::FY, |_, _| 0.0),
    load_entry(load::FZ, |scene, strip| {
        -scene.strip_start(strip).map_or(0.0, |start| start.force)
    }),
    load_entry(load::Y, |_, _| 0.0),
];

const fn wind(name: &'static str, description: &'static str) -> SignalEntry<Subsystem> {
    input!(
        DeclaredSignal::real(name, "m/s", description),
        |_, _| 0.0,
        |strips, _| strips * load::COUNT
    )
}

static WIND: [SignalEntry<Subsystem>; 3] = [
    wind(
        "wind.vx",
        "Wind along the track, added to the scene's own; acts where the scene has a wind",
    ),
    wind(
        "wind.vy",
        "Lateral wind, added to the scene's own; acts where the scene has a wind",
    ),
    wind(
        "wind.vz",
        "Vertical wind, added to the scene's own; acts where the scene has a wind",
    ),
];

const fn position<const AXIS: usize>() -> SignalEntry<Subsystem> {
    SignalEntry::output_with_rate(
        strip::SIGNALS[strip::X + AXIS],
        |side: &mut Subsystem, strip| side.strip_at(strip).position[AXIS],
        |side, strip| side.strip_at(strip).velocity[AXIS],
    )
}

const fn velocity<const AXIS: usize>() -> SignalEntry<Subsystem> {
    SignalEntry::output_with_rate(
        strip::SIGNALS[strip::VX + AXIS],
        |side: &mut Subsystem, strip| side.strip_at(strip).velocity[AXIS],
        |side, strip| side.strip_acceleration(strip)[AXIS],
    )
}

/// Outputs of a strip, with its part in the drive.
const fn strip_outputs(control: DeclaredSignal) -> [SignalEntry<Subsystem>; strip::OUTPUTS] {
    [
        position::<0>(),
        position::<1>(),
        position::<2>(),
        velocity::<0>(),
        velocity::<1>(),
        velocity::<2>(),
        SignalEntry::output_with_rate(
            strip::SIGNALS[strip::ROLL],
            |side, strip| side.strip_at(strip).roll,
            |side, strip| side.strip_angular_velocity(strip).x,
        ),
        SignalEntry::output(strip::SIGNALS[strip::WORK], |side, strip| side.work(strip)),
        SignalEntry::output(strip::SIGNALS[strip::WIND_DRAG], |side, _| side.wind_on_strip()[0]),
        SignalEntry::output(strip::SIGNALS[strip::WIND_LIFT], |side, _| side.wind_on_strip()[1]),
        SignalEntry::output(control, |side, _| side.drive_force_of_strip()),
    ]
}

/// Command of a controller whose commands are given; it holds until the next one.
const fn command(declared: DeclaredSignal) -> [SignalEntry<Subsystem>; 1] {
    [SignalEntry {
        declared,
        access: Access::Input {
            start: |_, _| 0.0,
            get: |side: &Subsystem, _, _| side.given_command(),
            set: |side, _, _, value| side.give_command(value),
            set_derivative: |_, _, _, _, _| {},
        },
    }]
}

/// Reading of an instrument.
macro_rules! reading {
    ($declared:expr, $index:ident) => {
        SignalEntry::output($declared, |side: &mut Subsystem, _| side.shown(instrument::$index))
    };
    ($index:ident) => {
        reading!(instrument::SIGNALS[instrument::$index], $index)
    };
}

/// Readings of the controller's instruments, for whoever gives the commands.
const fn instruments(
    velocity: DeclaredSignal,
    position: DeclaredSignal,
) -> [SignalEntry<Subsystem>; instrument::COUNT] {
    [
        reading!(FORCE),
        reading!(DESIRED),
        reading!(velocity, VELOCITY),
        reading!(position, POSITION),
        reading!(HEAD_HEIGHT),
        reading!(HEAD_VELOCITY),
        reading!(HEAD_ACCELERATION),
    ]
}

static STRIP: [SignalEntry<Subsystem>; strip::OUTPUTS] = strip_outputs(strip::SIGNALS[strip::CONTROL]);
static STRIP_BY_MOMENT: [SignalEntry<Subsystem>; strip::OUTPUTS] = strip_outputs(moment::CONTROL);
static COMMAND: [SignalEntry<Subsystem>; 1] = command(instrument::INPUT);
static COMMANDED_MOMENT: [SignalEntry<Subsystem>; 1] = command(moment::COMMAND);
static INSTRUMENTS: [SignalEntry<Subsystem>; instrument::COUNT] = instruments(
    instrument::SIGNALS[instrument::VELOCITY],
    instrument::SIGNALS[instrument::POSITION],
);
static INSTRUMENTS_OF_JOINT: [SignalEntry<Subsystem>; instrument::COUNT] =
    instruments(moment::VELOCITY, moment::POSITION);

/// Signals of the pantograph below the strip.
static PANTOGRAPH: [SignalEntry<Subsystem>; 2] = [
    SignalEntry::output(
        DeclaredSignal::real("base.z", "m", "Height of the base above the top of rail"),
        |side, _| side.base().position.z,
    ),
    SignalEntry::output(
        DeclaredSignal::real("uplift_force", "N", "Force that raises the pantograph"),
        |side, _| side.pantograph().0.uplift_force(),
    ),
];

/// Drive of a pantograph, for its signals.
struct Driven {
    takes_commands: bool,
    on_joint: bool,
}

/// Signals of a pantograph with this many strips on a vehicle with this many wheels, or on none; with commands from
/// outside or without.
fn groups(strips: usize, wheels: Option<usize>, driven: &Driven) -> [SignalGroup<Subsystem>; 9] {
    let (outputs, command, readings) = if driven.on_joint {
        (&STRIP_BY_MOMENT[..], &COMMANDED_MOMENT[..], &INSTRUMENTS_OF_JOINT[..])
    } else {
        (&STRIP[..], &COMMAND[..], &INSTRUMENTS[..])
    };
    let commanded = usize::from(driven.takes_commands);
    let group = |name, entries, members| SignalGroup {
        name,
        entries,
        members,
        parts: None,
    };
    let [base, wheel, more_base] = vehicle::groups(wheels);
    [
        group(Some(load::GROUP), &LOAD[..], strips),
        group(None, &WIND[..], 1),
        group(None, command, commanded),
        group(Some(strip::GROUP), outputs, strips),
        group(None, &PANTOGRAPH[..], 1),
        group(None, readings, commanded),
        base,
        wheel,
        more_base,
    ]
}

impl Component for Subsystem {
    type Checkpoint = Checkpoint;
    type Error = VehicleError;
    type Groups = [SignalGroup<Self>; 9];

    const IDENTIFIER: &'static str = "Pantograph";
    const DESCRIPTION: &'static str =
        "Pantograph on a travelling base under a contact force that is given from outside.";

    fn groups_of(scene: &Scene) -> Self::Groups {
        let strips = scene.pantographs[0].strips().len();
        let control = scene.pantographs[0].control.as_ref();
        let driven = Driven {
            takes_commands: control.is_some_and(|control| control.law == ControlLaw::Given),
            on_joint: control.is_some_and(|control| control.actuator.joint.is_some()),
        };
        let wheels = scene.vehicle.is_some().then(|| vehicle::wheel_count(scene));
        groups(strips, wheels, &driven)
    }

    fn groups(&self) -> Self::Groups {
        // A pantograph without vehicle ends before the groups of the vehicle.
        let driven = Driven {
            takes_commands: self.takes_commands(),
            on_joint: self.drives_joint(),
        };
        groups(self.strips(), Some(self.wheels()), &driven)
    }

    fn parameters(scene: &Scene) -> Vec<Parameter> {
        let mut parameters = match &scene.pantographs[0].model {
            PantographModel::Lumped(lumped) => {
                let mut parameters = lumped_parameters(lumped.masses.len());
                parameters.extend(head::parameters(lumped));
                parameters
            }
            PantographModel::Linkage(_) => linkage_parameters(),
            PantographModel::Supplied(_) => Vec::new(),
        };
        parameters.extend(component::solver_parameters());
        parameters.extend(component::start_parameters());
        if scene.pantographs[0].has_several_strips() {
            parameters.extend((0..scene.strip_count()).flat_map(component::strip_start_parameters));
        }
        parameters.extend(vehicle::parameters(scene));
        parameters
    }

    fn build(scene: &Scene) -> Result<Self, VehicleError> {
        Self::new(scene, 0)
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

/// Parameter of the pantograph at a field of its entry in the scene; 0 for a pantograph of another kind.
macro_rules! parameter {
    ($kind:ident, $name:expr, $unit:literal, $text:expr, $($field:tt)+) => {
        Parameter::new(
            $name,
            $unit,
            $text,
            move |scene| match &scene.pantographs[0].model {
                PantographModel::$kind(entry) => entry.$($field)+,
                _ => 0.0,
            },
            move |scene, value| {
                if let PantographModel::$kind(entry) = &mut scene.pantographs[0].model {
                    entry.$($field)+ = value;
                }
            },
        )
    };
}

/// Reference height of a lumped pantograph that has one in the scene.
fn reference_height() -> Parameter {
    Parameter::new(
        "reference_height",
        "m",
        "Height of the strip at which all springs of the chain are unstretched",
        |scene| match &scene.pantographs[0].model {
            PantographModel::Lumped(entry) => entry.reference_height.unwrap_or_default(),
            _ => 0.0,
        },
        |scene, value| {
            if let PantographModel::Lumped(entry) = &mut scene.pantographs[0].model
                && let Some(height) = &mut entry.reference_height
            {
                *height = value;
            }
        },
    )
}

fn lumped_parameters(masses: usize) -> Vec<Parameter> {
    let mut parameters = vec![
        parameter!(
            Lumped,
            "static_force",
            "N",
            "Upward force of the raised pantograph at rest",
            static_force
        ),
        reference_height(),
    ];
    for i in 0..masses {
        let number = i + 1;
        parameters.extend([
            parameter!(
                Lumped,
                format!("masses[{number}]"),
                "kg",
                format!("Mass {number}, counted from the collector head"),
                masses[i]
            ),
            parameter!(
                Lumped,
                format!("stiffnesses[{number}]"),
                "N/m",
                format!("Stiffness below mass {number}"),
                stiffnesses[i]
            ),
            parameter!(
                Lumped,
                format!("dampings[{number}]"),
                "N.s/m",
                format!("Damping below mass {number}"),
                dampings[i]
            ),
        ]);
    }
    parameters
}

fn linkage_parameters() -> Vec<Parameter> {
    vec![
        parameter!(
            Linkage,
            "uplift.force",
            "N",
            "Vertical force on the raised arm",
            uplift.force
        ),
        parameter!(
            Linkage,
            "uplift.distance",
            "m",
            "Distance of that force from the arm's base joint",
            uplift.distance
        ),
        parameter!(
            Linkage,
            "collector_suspension.stiffness",
            "N/m",
            "Stiffness of the collector suspension",
            collector_suspension.stiffness
        ),
        parameter!(
            Linkage,
            "collector_suspension.damping",
            "N.s/m",
            "Damping of the collector suspension",
            collector_suspension.damping
        ),
    ]
}
