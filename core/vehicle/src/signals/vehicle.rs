//! Additional signals and parameters of scenes with a vehicle.
use crate::Subsystem;
use component::{DeclaredSignal, Parameter, SignalEntry, SignalGroup};
use scene::{Curve as TrackCurve, Scene, Train as VehicleParts, Vehicle};
use std::sync::Arc;

/// Outputs of the base before those of the wheels; `base.z` is an output of every pantograph.
static BASE: [SignalEntry<Subsystem>; 3] = [
    SignalEntry::output(
        DeclaredSignal::real("base.x", "m", "Position of the pantograph's base along the track"),
        |side, _| side.base().position.x,
    ),
    SignalEntry::output(
        DeclaredSignal::real(
            "base.y",
            "m",
            "Lateral position of the pantograph's base, positive to the left",
        ),
        |side, _| side.base().position.y,
    ),
    SignalEntry::output(
        DeclaredSignal::real(
            "base.roll",
            "rad",
            "Roll angle of the pantograph's base about the direction of travel",
        ),
        |side, _| side.base_roll(),
    ),
];

static WHEEL: [SignalEntry<Subsystem>; 2] = [
    SignalEntry::output(
        DeclaredSignal::real(
            "load",
            "N",
            "Force of the rail, perpendicular to the plane of the rails, on wheel {}, left and right wheel of each \
             wheelset in turn",
        ),
        Subsystem::wheel_load,
    ),
    SignalEntry::output(
        DeclaredSignal::real(
            "derailment_quotient",
            "1",
            "Y/Q of wheel {}, left and right wheel of each wheelset in turn: force outward on the rail in the plane of \
             the rails over the one perpendicular to it",
        ),
        Subsystem::derailment_quotient,
    ),
];

/// Outputs of the base after those of the wheels, so that value references of older models stay.
static MORE_BASE: [SignalEntry<Subsystem>; 2] = [
    SignalEntry::output(
        DeclaredSignal::real(
            "base.pitch",
            "rad",
            "Pitch angle of the pantograph's base about the lateral axis, positive where its front is lowered",
        ),
        |side, _| side.base_angles()[1],
    ),
    SignalEntry::output(
        DeclaredSignal::real(
            "base.yaw",
            "rad",
            "Yaw angle of the pantograph's base about the vertical, positive where its front is turned to the left",
        ),
        |side, _| side.base_angles()[2],
    ),
];

/// Additional signals on a vehicle with this many wheels; empty groups without vehicle.
pub(super) fn groups(wheels: Option<usize>) -> [SignalGroup<Subsystem>; 3] {
    let group = |name, entries, members| SignalGroup {
        name,
        entries,
        members,
        parts: None,
    };
    let base = usize::from(wheels.is_some());
    [
        group(None, &BASE[..], base),
        group(Some("wheel"), &WHEEL[..], wheels.unwrap_or(0)),
        group(None, &MORE_BASE[..], base),
    ]
}

/// Number of wheels of the scene's vehicle.
pub(super) fn wheel_count(scene: &Scene) -> usize {
    let parts = scene.vehicle.as_deref().and_then(Vehicle::train);
    let wheelsets = parts.and_then(|parts| parts.body(&parts.wheels.wheelset));
    wheelsets.map_or(0, |body| 2 * body.positions.len())
}

/// Parameter of the vehicle at an expression on its entry in the scene, which gives an `Option` of the field; 0 without
/// it.
macro_rules! parameter {
    ($name:expr, $unit:literal, $text:expr, |$parts:ident| $read:expr, $write:expr) => {
        Parameter::new(
            $name,
            $unit,
            $text,
            move |scene: &Scene| {
                let parts = scene.vehicle.as_deref().and_then(Vehicle::train);
                parts.and_then(|$parts| $read).unwrap_or_default()
            },
            move |scene: &mut Scene, value| {
                let parts = scene
                    .vehicle
                    .as_mut()
                    .and_then(|vehicle| parts_mut(Arc::make_mut(vehicle)));
                if let Some(field) = parts.and_then(|$parts| $write) {
                    *field = value;
                }
            },
        )
    };
}

fn parts_mut(vehicle: &mut Vehicle) -> Option<&mut VehicleParts> {
    match vehicle {
        Vehicle::Vertical(parts) | Vehicle::Full(parts) => Some(parts),
        Vehicle::RigidMotion(_) => None,
    }
}

/// Masses, stiffnesses and dampers of the scene's vehicle.
pub(super) fn parameters(scene: &Scene) -> Vec<Parameter> {
    const AXES: [&str; 3] = ["x", "y", "z"];
    let mut parameters = Vec::new();
    let Some(parts) = scene.vehicle.as_deref().and_then(Vehicle::train) else {
        return parameters;
    };
    for (i, body) in parts.bodies.iter().enumerate() {
        parameters.push(parameter!(
            format!("vehicle.bodies[{}].mass", i + 1),
            "kg",
            format!("Mass of each {}", body.name),
            |parts| parts.bodies.get(i).map(|body| body.mass),
            parts.bodies.get_mut(i).map(|body| &mut body.mass)
        ));
    }
    for (i, bushing) in parts.bushings.iter().enumerate() {
        let path = format!("vehicle.bushings[{}]", i + 1);
        for (axis, title) in AXES.into_iter().enumerate() {
            if bushing.stiffness[axis] != 0.0 {
                parameters.push(parameter!(
                    format!("{path}.stiffness[{}]", axis + 1),
                    "N/m",
                    format!("Stiffness of each {} along {title}", bushing.name),
                    |parts| parts.bushings.get(i).map(|bushing| bushing.stiffness[axis]),
                    parts.bushings.get_mut(i).map(|bushing| &mut bushing.stiffness[axis])
                ));
            }
            if bushing.damping[axis] != 0.0 {
                parameters.push(parameter!(
                    format!("{path}.damping[{}]", axis + 1),
                    "N.s/m",
                    format!("Damping of each {} along {title}", bushing.name),
                    |parts| parts.bushings.get(i).map(|bushing| bushing.damping[axis]),
                    parts.bushings.get_mut(i).map(|bushing| &mut bushing.damping[axis])
                ));
            }
        }
    }
    parameters.extend(curves(scene));
    if parts.contact.is_some() {
        parameters.push(parameter!(
            "vehicle.contact.friction".to_owned(),
            "1",
            "Friction coefficient between wheels and rails".to_owned(),
            |parts| parts.contact.as_ref().map(|contact| contact.friction),
            parts.contact.as_mut().map(|contact| &mut contact.friction)
        ));
    }
    parameters
}

/// Parameters of the curves of the track.
fn curves(scene: &Scene) -> Vec<Parameter> {
    /// Name, meaning and access of a length of a curve.
    struct CurveLength(
        &'static str,
        &'static str,
        fn(&TrackCurve) -> f64,
        fn(&mut TrackCurve, f64),
    );
    macro_rules! length {
        ($field:ident, $text:literal) => {
            CurveLength(
                stringify!($field),
                $text,
                |curve| curve.$field,
                |curve, value| curve.$field = value,
            )
        };
    }
    const LENGTHS: [CurveLength; 6] = [
        length!(radius, "Radius of the curve"),
        length!(cant, "Height of the outer rail above the inner one"),
        length!(start, "Begin of the transition into the curve"),
        length!(transition, "Length of each transition"),
        length!(length, "Length of the arc"),
        length!(rounding, "Length over which the ends of cant ramps are rounded"),
    ];
    let Some(track) = scene.track.as_deref() else {
        return Vec::new();
    };
    let mut parameters = Vec::new();
    for i in 0..track.curves.len() {
        let path = track.curve_key(i);
        for CurveLength(name, text, get, set) in LENGTHS {
            parameters.push(Parameter::new(
                format!("{path}.{name}"),
                "m",
                text,
                move |scene| {
                    let curve = scene.track.as_deref().and_then(|track| track.curves.get(i));
                    curve.map_or(0.0, get)
                },
                move |scene, value| {
                    let track = scene.track.as_mut().map(Arc::make_mut);
                    if let Some(curve) = track.and_then(|track| track.curves.get_mut(i)) {
                        set(curve, value);
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
        let text = include_str!("../../../../scenes/thesis-own-mesh.toml");
        let base = "vehicle.pantograph_base=[11.95005378, 0.3, 3.425]".to_owned();
        let full = Scene::from_toml(text, "thesis-own-mesh.toml", &[base]).unwrap();
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
