//! Additional signals and parameters of scenes with a vehicle.
use crate::Subsystem;
use component::{Parameter, Signal};
use scene::{Curve as TrackCurve, Scene, Train as VehicleParts, Vehicle};
use std::sync::Arc;

/// Outputs of the base before those of the wheels; `base.z` is an output of every pantograph.
const BASE_OUTPUTS: [(&str, &str, &str); 3] = [
    ("base.x", "m", "Position of the pantograph's base along the track"),
    (
        "base.y",
        "m",
        "Lateral position of the pantograph's base, positive to the left",
    ),
    (
        "base.roll",
        "rad",
        "Roll angle of the pantograph's base about the direction of travel",
    ),
];

/// Outputs of the base after those of the wheels, so that value references of older models stay.
const MORE_BASE_OUTPUTS: [(&str, &str, &str); 2] = [
    (
        "base.pitch",
        "rad",
        "Pitch angle of the pantograph's base about the lateral axis, positive where its front is lowered",
    ),
    (
        "base.yaw",
        "rad",
        "Yaw angle of the pantograph's base about the vertical, positive where its front is turned to the left",
    ),
];

/// Number of wheels of the scene's vehicle.
fn wheel_count(scene: &Scene) -> usize {
    let parts = scene.vehicle.as_deref().and_then(scene::Vehicle::train);
    let wheelsets = parts.and_then(|parts| parts.body(&parts.wheels.wheelset));
    wheelsets.map_or(0, |body| 2 * body.positions.len())
}

/// Additional outputs of scenes with a vehicle.
pub(super) fn outputs(scene: &Scene) -> Vec<Signal> {
    if scene.vehicle.is_none() {
        return Vec::new();
    }
    let signal = |(name, unit, text): (&'static str, &'static str, &'static str)| Signal::output(name, unit, text);
    let (base, more) = (BASE_OUTPUTS.map(signal), MORE_BASE_OUTPUTS.map(signal));
    let wheels = (1..=wheel_count(scene)).flat_map(|i| {
        let which = format!("wheel {i}, left and right wheel of each wheelset in turn");
        [
            Signal::output(
                format!("wheel[{i}].load"),
                "N",
                format!("Force of the rail, perpendicular to the plane of the rails, on {which}"),
            ),
            Signal::output(
                format!("wheel[{i}].derailment_quotient"),
                "1",
                format!(
                    "Y/Q of {which}: force outward on the rail in the plane of the rails over the one perpendicular \
                     to it"
                ),
            ),
        ]
    });
    base.into_iter().chain(wheels).chain(more).collect()
}

impl Subsystem {
    /// Values of the outputs after `base.roll`: load and derailment quotient of each wheel in turn, then pitch and yaw.
    pub(super) fn vehicle_output(&mut self, output: usize) -> f64 {
        let parts = self.pantograph().0.vehicle();
        let wheels = 2 * parts.map_or(0, |parts| parts.wheel_count());
        match output.checked_sub(wheels) {
            Some(angle) => self.base_angles()[1 + angle],
            None if output.is_multiple_of(2) => self.wheel_load(output / 2),
            None => self.derailment_quotient(output / 2),
        }
    }
}

/// Parameter of the vehicle at the field that `field` returns.
fn parameter(
    name: String,
    unit: &'static str,
    text: String,
    field: impl Fn(&mut VehicleParts) -> Option<&mut f64> + Clone + Send + Sync + 'static,
) -> Parameter {
    fn parts_of(vehicle: &mut Vehicle) -> Option<&mut VehicleParts> {
        match vehicle {
            Vehicle::Vertical(parts) | Vehicle::Full(parts) => Some(parts),
            Vehicle::RigidMotion(_) => None,
        }
    }
    let read = field.clone();
    Parameter::new(
        name,
        unit,
        text,
        move |scene| {
            let mut vehicle = scene.vehicle.as_deref().cloned();
            let parts = vehicle.as_mut().and_then(parts_of);
            parts.and_then(&read).copied().unwrap_or_default()
        },
        move |scene, value| {
            let parts = scene
                .vehicle
                .as_mut()
                .and_then(|vehicle| parts_of(Arc::make_mut(vehicle)));
            if let Some(place) = parts.and_then(&field) {
                *place = value;
            }
        },
    )
}

/// Masses, stiffnesses and dampers of the scene's vehicle.
pub(super) fn parameters(scene: &Scene) -> Vec<Parameter> {
    const AXES: [&str; 3] = ["x", "y", "z"];
    let mut parameters = Vec::new();
    let Some(parts) = scene.vehicle.as_deref().and_then(Vehicle::train) else {
        return parameters;
    };
    for (i, body) in parts.bodies.iter().enumerate() {
        parameters.push(parameter(
            format!("vehicle.bodies[{}].mass", i + 1),
            "kg",
            format!("Mass of each {}", body.name),
            move |parts| parts.bodies.get_mut(i).map(|body| &mut body.mass),
        ));
    }
    for (i, bushing) in parts.bushings.iter().enumerate() {
        let path = format!("vehicle.bushings[{}]", i + 1);
        for (axis, title) in AXES.into_iter().enumerate() {
            if bushing.stiffness[axis] != 0.0 {
                parameters.push(parameter(
                    format!("{path}.stiffness[{}]", axis + 1),
                    "N/m",
                    format!("Stiffness of each {} along {title}", bushing.name),
                    move |parts| parts.bushings.get_mut(i).map(|bushing| &mut bushing.stiffness[axis]),
                ));
            }
            if bushing.damping[axis] != 0.0 {
                parameters.push(parameter(
                    format!("{path}.damping[{}]", axis + 1),
                    "N.s/m",
                    format!("Damping of each {} along {title}", bushing.name),
                    move |parts| parts.bushings.get_mut(i).map(|bushing| &mut bushing.damping[axis]),
                ));
            }
        }
    }
    parameters.extend(curves(scene));
    if parts.contact.is_some() {
        parameters.push(parameter(
            "vehicle.contact.friction".to_owned(),
            "1",
            "Friction coefficient between wheels and rails".to_owned(),
            |parts| parts.contact.as_mut().map(|contact| &mut contact.friction),
        ));
    }
    parameters
}

/// Parameters of the curves of the track.
fn curves(scene: &Scene) -> Vec<Parameter> {
    type Field = fn(&mut TrackCurve) -> &mut f64;
    const FIELDS: [(&str, &str, Field); 6] = [
        ("radius", "Radius of the curve", |curve| &mut curve.radius),
        ("cant", "Height of the outer rail above the inner one", |curve| {
            &mut curve.cant
        }),
        ("start", "Begin of the transition into the curve", |curve| {
            &mut curve.start
        }),
        ("transition", "Length of each transition", |curve| &mut curve.transition),
        ("length", "Length of the arc", |curve| &mut curve.length),
        (
            "rounding",
            "Length over which the ends of cant ramps are rounded",
            |curve| &mut curve.rounding,
        ),
    ];
    let Some(track) = scene.track.as_deref() else {
        return Vec::new();
    };
    let mut parameters = Vec::new();
    for i in 0..track.curves.len() {
        let path = track.curve_key(i);
        for (name, text, field) in FIELDS {
            parameters.push(Parameter::new(
                format!("{path}.{name}"),
                "m",
                text,
                move |scene| {
                    let curve = scene.track.as_deref().and_then(|track| track.curves.get(i));
                    curve.map_or(0.0, |curve| *field(&mut curve.clone()))
                },
                move |scene, value| {
                    let track = scene.track.as_mut().map(Arc::make_mut);
                    if let Some(curve) = track.and_then(|track| track.curves.get_mut(i)) {
                        *field(curve) = value;
                    }
                },
            ));
        }
    }
    parameters
}

#[cfg(test)]
mod tests {
    use super::*;
    use component::Component;

    #[test]
    fn outputs_of_base_and_wheels_are_found_under_their_names() {
        let text = include_str!("../../../../scenes/thesis.toml");
        let base = "vehicle.pantograph_base=[11.95005378, 0.3, 3.425]".to_owned();
        let full = Scene::from_toml(text, "thesis.toml", &[base]).unwrap();
        let text = include_str!("../../../../scenes/thesis-pantograph.toml");
        let motion = "vehicle={ model = \"rigid_motion\", \
             motion = { time = [0.0], roll = [0.01], pitch = [0.02], yaw = [0.03] } }";
        let given = Scene::from_toml(text, "x.toml", &[motion.to_owned(), "model.reduce=none".to_owned()]).unwrap();
        for (scene, wheels) in [(full, 8), (given, 0)] {
            let signals = Subsystem::signals(&scene);
            let mut side = Subsystem::new(&scene, 0).unwrap();
            let mut output = |name: &str| {
                let place = signals.iter().position(|signal| signal.name == name).unwrap();
                Component::output(&mut side, place)
            };
            let angles = ["base.roll", "base.pitch", "base.yaw"].map(&mut output);
            let last = (1..=wheels).map(|wheel| output(&format!("wheel[{wheel}].load")));
            let loads: Vec<f64> = last.collect();
            let quotient = (wheels > 0).then(|| output("wheel[8].derailment_quotient"));
            assert_eq!(angles, side.base_angles());
            assert!(angles.iter().all(|angle| *angle != 0.0), "{angles:?}");
            for (wheel, load) in loads.into_iter().enumerate() {
                assert!(load > 5e4 && load == side.wheel_load(wheel));
            }
            assert!(quotient.is_none_or(|found| found != 0.0 && found == side.derailment_quotient(7)));
            assert!(scene.vehicle.as_deref().unwrap().train().is_some() || angles[1] > 0.0199);
        }
    }
}
