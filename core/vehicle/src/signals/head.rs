//! Parameters of a head with several strips.
use component::Parameter;
use scene::{HeadPitch, Lumped, PantographModel, Scene, StripSpring};

/// Names, units and places of the values of a spring or of a pitching head.
type Values<T, const N: usize> = [(&'static str, &'static str, &'static str, fn(&mut T) -> &mut f64); N];

const SPRING: Values<StripSpring, 3> = [
    ("mass", "kg", "Mass of strip {} on its spring", |spring| {
        &mut spring.mass
    }),
    ("stiffness", "N/m", "Stiffness of the spring under strip {}", |spring| {
        &mut spring.stiffness
    }),
    ("damping", "N.s/m", "Damping of the spring under strip {}", |spring| {
        &mut spring.damping
    }),
];

const PITCH: Values<HeadPitch, 3> = [
    (
        "inertia",
        "kg.m2",
        "Moment of inertia of the head about its lateral axis",
        |pitch| &mut pitch.inertia,
    ),
    ("stiffness", "N.m/rad", "Rotational stiffness of the head", |pitch| {
        &mut pitch.stiffness
    }),
    ("damping", "N.m.s/rad", "Rotational damping of the head", |pitch| {
        &mut pitch.damping
    }),
];

fn lumped(scene: &mut Scene) -> Option<&mut Lumped> {
    match &mut scene.pantographs[0].model {
        PantographModel::Lumped(lumped) => Some(lumped),
        _ => None,
    }
}

fn spring(lumped: &mut Lumped, strip: usize) -> Option<&mut StripSpring> {
    lumped.strips.get_mut(strip)?.spring.as_mut()
}

/// Parameter at a place of the lumped pantograph; 0 without it.
fn parameter(
    name: String,
    unit: &'static str,
    text: String,
    place: impl Fn(&mut Lumped) -> Option<&mut f64> + Copy + Send + Sync + 'static,
) -> Parameter {
    Parameter::new(
        name,
        unit,
        text,
        move |scene| match &scene.pantographs[0].model {
            PantographModel::Lumped(lumped) => place(&mut lumped.clone()).map_or(0.0, |value| *value),
            _ => 0.0,
        },
        move |scene, value| {
            if let Some(place) = lumped(scene).and_then(place) {
                *place = value;
            }
        },
    )
}

/// Springs under strips, and the pitching head.
pub(super) fn parameters(lumped: &Lumped) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    for strip in (0..lumped.strips.len()).filter(|&strip| lumped.strips[strip].spring.is_some()) {
        let number = strip + 1;
        parameters.extend(SPRING.map(|(name, unit, text, of)| {
            let text = text.replace("{}", &number.to_string());
            parameter(format!("strips[{number}].{name}"), unit, text, move |lumped| {
                spring(lumped, strip).map(of)
            })
        }));
    }
    if lumped.pitch.is_some() {
        parameters.extend(PITCH.map(|(name, unit, text, of)| {
            parameter(format!("pitch.{name}"), unit, text.to_owned(), move |lumped| {
                lumped.pitch.as_mut().map(of)
            })
        }));
    }
    parameters
}
