//! Signals and parameters of the pantograph as a component: names and units.
use crate::subsystem::INPUTS;
use crate::{Checkpoint, Subsystem, VehicleError};
use component::{Component, Parameter, Signal, StepFailure};
use dynamics::StepError;
use scene::{PantographModel, Scene};

mod vehicle;

/// Outputs after the inputs, in order.
const OUTPUTS: [(&str, &str, &str); 12] = [
    ("strip[1].x", "m", "Position of the strip's middle along the track"),
    (
        "strip[1].y",
        "m",
        "Lateral position of the strip's middle, positive to the left",
    ),
    ("strip[1].z", "m", "Height of the strip's middle above the top of rail"),
    ("strip[1].vx", "m/s", "Velocity of the strip along the track"),
    ("strip[1].vy", "m/s", "Lateral velocity of the strip"),
    ("strip[1].vz", "m/s", "Vertical velocity of the strip"),
    (
        "strip[1].roll",
        "rad",
        "Roll angle of the strip about the direction of travel",
    ),
    (
        "strip[1].work",
        "J",
        "Work done by the contact on the strip since the start",
    ),
    (
        "strip[1].wind.drag",
        "N",
        "Drag of the wind on the body of the strip, along the air that meets it",
    ),
    (
        "strip[1].wind.lift",
        "N",
        "Lift of the wind on the body of the strip, across the air that meets it, positive upward",
    ),
    ("base.z", "m", "Height of the base above the top of rail"),
    ("uplift_force", "N", "Force that raises the pantograph"),
];

impl Component for Subsystem {
    type Checkpoint = Checkpoint;
    type Error = VehicleError;

    const IDENTIFIER: &'static str = "Pantograph";
    const DESCRIPTION: &'static str =
        "Pantograph on a travelling base under a contact force that is given from outside.";

    fn signals(scene: &Scene) -> Vec<Signal> {
        let force = scene.pantographs[0].start.map_or(0.0, |start| start.force);
        let inputs: [(&str, &'static str, f64, &str); INPUTS] = [
            ("contact[1].fx", "N", 0.0, "Force on the strip along the track"),
            ("contact[1].fy", "N", 0.0, "Lateral force on the strip"),
            (
                "contact[1].fz",
                "N",
                -force,
                "Vertical force on the strip, negative when the wire presses it down",
            ),
            ("contact[1].y", "m", 0.0, "Lateral position of the contact"),
            (
                "wind.vx",
                "m/s",
                0.0,
                "Wind along the track, added to the scene's own; acts where the scene has a wind",
            ),
            (
                "wind.vy",
                "m/s",
                0.0,
                "Lateral wind, added to the scene's own; acts where the scene has a wind",
            ),
            (
                "wind.vz",
                "m/s",
                0.0,
                "Vertical wind, added to the scene's own; acts where the scene has a wind",
            ),
        ];
        let inputs = inputs.map(|(name, unit, start, text)| Signal::input(name, unit, start, text));
        let outputs = OUTPUTS.map(|(name, unit, text)| Signal::output(name, unit, text));
        let vehicle = vehicle::outputs(scene);
        inputs.into_iter().chain(outputs).chain(vehicle).collect()
    }

    fn parameters(scene: &Scene) -> Vec<Parameter> {
        let mut parameters = match &scene.pantographs[0].model {
            PantographModel::Lumped(lumped) => lumped_parameters(lumped.masses.len()),
            PantographModel::Linkage(_) => linkage_parameters(),
            PantographModel::Supplied(_) => Vec::new(),
        };
        parameters.extend(component::solver_parameters());
        parameters.extend(component::start_parameters(0, ""));
        parameters.extend(vehicle::parameters(scene));
        parameters
    }

    fn build(scene: &Scene) -> Result<Self, VehicleError> {
        Self::new(scene, 0)
    }

    fn set_input(&mut self, signal: usize, value: f64) {
        self.set_contact_input(signal, value);
    }

    fn input(&self, signal: usize) -> f64 {
        self.contact_input(signal)
    }

    fn set_input_derivative(&mut self, signal: usize, order: usize, value: f64) {
        self.set_contact_input_derivative(signal, order, value);
    }

    fn output(&mut self, signal: usize) -> f64 {
        match signal - INPUTS {
            output @ 0..=2 => self.strip().position[output],
            output @ 3..=5 => self.strip().velocity[output - 3],
            6 => self.strip().roll,
            7 => self.work(),
            output @ 8..=9 => self.wind_on_head()[output - 8],
            10 => self.base().position.z,
            11 => self.pantograph().0.uplift_force(),
            output @ 12..=13 => self.base().position[output - 12],
            14 => self.base_roll(),
            output => self.vehicle_output(output - 15),
        }
    }

    fn output_rate(&mut self, signal: usize) -> f64 {
        match signal.checked_sub(INPUTS) {
            Some(output @ 0..=2) => self.strip().velocity[output],
            Some(output @ 3..=5) => self.strip_acceleration()[output - 3],
            Some(6) => self.strip_angular_velocity().x,
            _ => 0.0,
        }
    }

    fn sensitivity(&mut self, _output: usize, _input: usize) -> f64 {
        // No time has passed, so that a force has moved nothing.
        0.0
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

/// Parameter of the pantograph at the field that `field` returns.
fn parameter(
    name: impl Into<String>,
    unit: &'static str,
    text: impl Into<String>,
    field: impl Fn(&mut PantographModel) -> Option<&mut f64> + Clone + Send + Sync + 'static,
) -> Parameter {
    let read = field.clone();
    Parameter::new(
        name,
        unit,
        text,
        move |scene| {
            read(&mut scene.pantographs[0].model.clone())
                .copied()
                .unwrap_or_default()
        },
        move |scene, value| {
            if let Some(place) = field(&mut scene.pantographs[0].model) {
                *place = value;
            }
        },
    )
}

fn lumped(model: &mut PantographModel) -> Option<&mut scene::Lumped> {
    match model {
        PantographModel::Lumped(lumped) => Some(lumped),
        _ => None,
    }
}

fn linkage(model: &mut PantographModel) -> Option<&mut scene::Linkage> {
    match model {
        PantographModel::Linkage(linkage) => Some(linkage),
        _ => None,
    }
}

fn lumped_parameters(masses: usize) -> Vec<Parameter> {
    let mut parameters = vec![
        parameter(
            "static_force",
            "N",
            "Upward force of the raised pantograph at rest",
            |model| lumped(model).map(|entry| &mut entry.static_force),
        ),
        parameter(
            "reference_height",
            "m",
            "Height of the strip at which all springs of the chain are unstretched",
            |model| lumped(model).and_then(|entry| entry.reference_height.as_mut()),
        ),
    ];
    for i in 0..masses {
        let number = i + 1;
        parameters.push(parameter(
            format!("masses[{number}]"),
            "kg",
            format!("Mass {number}, counted from the collector head"),
            move |model| lumped(model).map(|entry| &mut entry.masses[i]),
        ));
        parameters.push(parameter(
            format!("stiffnesses[{number}]"),
            "N/m",
            format!("Stiffness below mass {number}"),
            move |model| lumped(model).map(|entry| &mut entry.stiffnesses[i]),
        ));
        parameters.push(parameter(
            format!("dampings[{number}]"),
            "N.s/m",
            format!("Damping below mass {number}"),
            move |model| lumped(model).map(|entry| &mut entry.dampings[i]),
        ));
    }
    parameters
}

fn linkage_parameters() -> Vec<Parameter> {
    vec![
        parameter("uplift.force", "N", "Vertical force on the raised arm", |model| {
            linkage(model).map(|entry| &mut entry.uplift.force)
        }),
        parameter(
            "uplift.distance",
            "m",
            "Distance of that force from the arm's base joint",
            |model| linkage(model).map(|entry| &mut entry.uplift.distance),
        ),
        parameter(
            "collector_suspension.stiffness",
            "N/m",
            "Stiffness of the collector suspension",
            |model| linkage(model).map(|entry| &mut entry.collector_suspension.stiffness),
        ),
        parameter(
            "collector_suspension.damping",
            "N.s/m",
            "Damping of the collector suspension",
            |model| linkage(model).map(|entry| &mut entry.collector_suspension.damping),
        ),
    ]
}
