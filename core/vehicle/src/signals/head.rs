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

#[cfg(test)]
mod tests {
    use crate::Subsystem;
    use component::Component;
    use scene::Scene;

    const EN: &str = include_str!("../../../../scenes/en50318-250.toml");

    fn scene(keys: &[&str]) -> Scene {
        let height = ["pantograph[1].reference_height=5.3"];
        let keys: Vec<String> = height.iter().chain(keys).map(|key| (*key).to_owned()).collect();
        Scene::from_toml(EN, "x.toml", &keys).unwrap()
    }

    #[test]
    fn each_strip_has_its_load_and_its_motion_and_the_wind_comes_after_the_loads() {
        let two = scene(&["pantograph[1].strips=[{ x = 0.3 }, { x = -0.2 }]"]);
        let signals = Subsystem::signals(&two);
        let place = |name: &str| signals.iter().position(|signal| signal.name == name).unwrap();
        let mut side = Subsystem::build(&two).unwrap();
        for (name, input) in [("contact[1].fz", 2), ("contact[2].fz", 6), ("wind.vz", 10)] {
            side.set_input(place(name), 7.0);
            assert_eq!(side.contact_input(input), 7.0, "{name}");
        }
        let [front, rear] = ["strip[1].x", "strip[2].x"].map(|name| side.output(place(name)));
        assert!((front - rear - 0.5).abs() < 1e-12, "rounding of 20 m: {front} {rear}");
        // A scene of one strip has the variables that it always had.
        let names = |scene: &Scene| -> Vec<String> {
            Subsystem::signals(scene)
                .into_iter()
                .map(|signal| signal.name)
                .collect()
        };
        let one = names(&scene(&[]));
        assert_eq!(one, names(&scene(&["pantograph[1].strips=[{ x = 0.0 }]"])));
        assert!(!one.iter().any(|name| name.contains("[2]")));
    }

    #[test]
    fn values_of_the_head_are_parameters() {
        let pitching = scene(&[
            "pantograph[1].strips=[{ x = 0.3 }, { x = -0.3 }]",
            "pantograph[1].pitch={ inertia = 0.4, stiffness = 100 }",
        ]);
        let sprung = scene(&["pantograph[1].strips=[{ x = 0.3, mass = 1.5, stiffness = 5000 }]"]);
        for (scene, name, value) in [
            (&pitching, "pitch.stiffness", 100.0),
            (&sprung, "strips[1].mass", 1.5),
            (&sprung, "strips[1].stiffness", 5000.0),
        ] {
            let (mut scene, parameters) = (scene.clone(), Subsystem::parameters(scene));
            let parameter = parameters.iter().find(|parameter| parameter.name == name).unwrap();
            assert_eq!(parameter.value(&scene), value);
            parameter.set(&mut scene, 2.0 * value);
            assert_eq!(parameter.value(&scene), 2.0 * value);
        }
    }

    #[test]
    fn the_strips_of_a_head_follow_its_start_and_it_follows_theirs() {
        let mut two = scene(&["pantograph[1].strips=[{ x = 0.3 }, { x = -0.3 }]"]);
        let set = |two: &mut Scene, name: &str, value: f64| {
            let parameters = Subsystem::parameters(two);
            parameters
                .iter()
                .find(|parameter| parameter.name == name)
                .unwrap()
                .set(two, value);
        };
        set(&mut two, "start.height", 5.3);
        set(&mut two, "start.force", 120.0);
        set(&mut two, "strip[2].start.force", 50.0);
        set(&mut two, "strip[1].start.height", 5.4);
        let start = two.pantographs[0].start.unwrap();
        // Rounding of a mean and a sum.
        assert!((start.height - 5.35).abs() < 1e-12 && (start.force - 110.0).abs() < 1e-12);
        set(&mut two, "start.height", 5.45);
        assert!((two.strip_start(0).unwrap().height - 5.5).abs() < 1e-12);
        assert!((two.strip_start(1).unwrap().height - 5.4).abs() < 1e-12);
        set(&mut two, "strip[2].start.x", 20.0);
        assert!((two.strip_start_x(0) - 20.6).abs() < 1e-12);
    }
}
