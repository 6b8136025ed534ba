//! Heads with several strips: what is read is what was typed, and what no head can be is refused with its remedy.

use scene::{HeadPitch, HeadStrip, PantographModel, Scene, Start, StripSpring};

const EN: &str = include_str!("../../../scenes/en50318-250.toml");
const THESIS: &str = include_str!("../../../scenes/thesis-pantograph.toml");

/// The scene with `strips` and more keys of its pantograph.
fn read(text: &str, keys: &[&str]) -> Result<Scene, String> {
    let keys: Vec<String> = keys.iter().map(|key| format!("pantograph[1].{key}")).collect();
    Scene::from_toml(text, "x.toml", &keys).map_err(|error| error.to_string())
}

#[test]
fn a_head_is_read_as_typed_and_survives_writing() {
    let mut scene = read(
        EN,
        &[
            "strips=[{ x = 0.29, mass = 1.5, stiffness = 5000 }, { x = -0.3, mass = 1.6, stiffness = 4000, \
             damping = 7 }]",
        ],
    )
    .unwrap();
    let strip = |x, mass, stiffness, damping| HeadStrip {
        x,
        spring: Some(StripSpring {
            mass,
            stiffness,
            damping,
        }),
    };
    let expected = [strip(0.29, 1.5, 5000.0, 0.0), strip(-0.3, 1.6, 4000.0, 7.0)];
    assert_eq!(scene.pantographs[0].strips(), expected);
    scene.pantographs[0].set_strip_start(
        1,
        Start {
            height: 5.31,
            force: 70.0,
        },
        Start {
            height: 5.3,
            force: 50.0,
        },
    );
    assert_eq!(
        scene.pantographs[0].start,
        Some(Start {
            height: 5.305,
            force: 120.0
        })
    );
    assert_eq!(read(&scene.to_toml(), &[]).unwrap(), scene);

    let scene = read(
        EN,
        &[
            "strips=[{ x = 0.29 }, { x = -0.29 }]",
            "pitch={ inertia = 0.4, stiffness = 0 }",
        ],
    )
    .unwrap();
    let PantographModel::Lumped(lumped) = &scene.pantographs[0].model else {
        panic!("lumped");
    };
    let pitch = HeadPitch {
        inertia: 0.4,
        stiffness: 0.0,
        damping: 0.0,
    };
    assert_eq!(
        (lumped.strips.as_slice(), lumped.pitch),
        (&[HeadStrip::fixed(0.29), HeadStrip::fixed(-0.29)][..], Some(pitch))
    );
    assert_eq!(read(&scene.to_toml(), &[]).unwrap(), scene);
}

#[test]
fn strips_are_numbered_over_all_heads_and_stand_where_their_heads_carry_them() {
    let pantograph = &EN[EN.find("[[pantograph]]").unwrap()..EN.find("[coupling]").unwrap()];
    let second = pantograph.replace("offset_x = 0.0", "offset_x = -15.0");
    let text = EN.replace("[coupling]", &format!("{second}[coupling]"));
    let mut scene = read(&text, &["strips=[{ x = 0.3 }, { x = 0.0 }, { x = -0.3 }]"]).unwrap();
    assert_eq!((scene.strip_count(), scene.strip_counts()), (4, vec![3, 1]));
    assert_eq!(
        (scene.head_of(2), scene.head_of(3), scene.strips_of(1)),
        ((0, 2), (1, 0), 3..4)
    );
    let places: Vec<f64> = (0..4).map(|strip| scene.strip_start_x(strip)).collect();
    assert_eq!(places, [20.3, 20.0, 19.7, 5.0]);
    scene.pantographs[0].start = Some(Start {
        height: 5.3,
        force: 120.0,
    });
    // Equal parts of the force where nothing else is known.
    assert_eq!(
        scene.strip_start(2),
        Some(Start {
            height: 5.3,
            force: 40.0
        })
    );
    assert_eq!(scene.strip_start(3), None);
}

#[test]
fn what_no_head_can_be_is_refused_with_key_value_and_remedy() {
    const TWO: &str = "strips=[{ x = 0.29 }, { x = -0.29 }]";
    const PITCH: &str = "pitch={ inertia = 0.4, stiffness = 100 }";
    let cases: &[(&[&str], &str)] = &[
        (
            &["strips=[]"],
            "pantograph[1].strips = []: must be at least one table under the header",
        ),
        (&["strips=[{ y = 0.29 }]"], "pantograph[1].strips[1].y: unknown key"),
        (
            &["strips=[{ mass = 1.0, stiffness = 5000 }]"],
            "pantograph[1].strips[1].x is missing: must be a number in m",
        ),
        (
            &["strips=[{ x = 0.29 }, { x = 0.29 }]"],
            "pantograph[1].strips[2].x = 0.29 m: must differ from strips[1].x",
        ),
        (
            &["strips=[{ x = 290 }, { x = -290 }]"],
            "pantograph[1].strips[1].x = 290 m: must be within ±2 m",
        ),
        (
            &["strips=[{ x = 0.29, mass = 1.5 }]"],
            "pantograph[1].strips[1].mass = 1.5: must have stiffness (N/m) beside it",
        ),
        (
            &["strips=[{ x = 0.29, stiffness = 5000 }]"],
            "pantograph[1].strips[1].stiffness = 5000: must have mass (kg)",
        ),
        (
            &["strips=[{ x = 0.29, damping = 10 }]"],
            "pantograph[1].strips[1].damping = 10: must be left out, or mass (kg)",
        ),
        (
            &["strips=[{ x = 0.29, mass = 0, stiffness = 5000 }]"],
            "pantograph[1].strips[1].mass = 0 kg: must be positive and finite",
        ),
        (
            &["strips=[{ x = 0.29, mass = 1.5, stiffness = 5000 }, { x = -0.29 }]"],
            "pantograph[1].strips[2].mass = left out: must be given",
        ),
        (
            &[PITCH],
            "pantograph[1].pitch = { … }: must be left out, or strips have two or more places",
        ),
        (
            &[
                "strips=[{ x = 0.29, mass = 1.5, stiffness = 5000 }, { x = -0.29, mass = 1.5, stiffness = 5000 }]",
                PITCH,
            ],
            "pantograph[1].pitch = { … }: must be left out: strips on springs of their own",
        ),
        (
            &[TWO, "pitch={ inertia = 0, stiffness = 100 }"],
            "pantograph[1].pitch.inertia = 0 kg m²: must be positive",
        ),
        (
            &[TWO, "pitch={ inertia = 0.4 }"],
            "pantograph[1].pitch.stiffness is missing: must be",
        ),
        (
            &[TWO, "strip_start=[{ height = 5.3, force = 60 }]"],
            "pantograph[1].strip_start = 1 entry: must have 2, one per strip, and start beside it",
        ),
        (
            &["strip_start=[{ height = 5.3, force = 60 }]"],
            "pantograph[1].strip_start = 1 entry: must be left out: a head with one strip has start alone",
        ),
    ];
    for (keys, fragment) in cases {
        let message = read(EN, keys).expect_err(fragment);
        assert!(message.contains(fragment), "{fragment:?} is not in:\n{message}");
    }
}

#[test]
fn a_head_with_several_strips_is_refused_where_one_strip_is_all_that_can_be() {
    const TWO: &str = "strips=[{ x = 0.29 }, { x = -0.29 }]";
    let refused = |text: &str, fragment: &str| {
        let message = read(text, &[TWO]).expect_err(fragment);
        assert!(message.contains(fragment), "{fragment:?} is not in:\n{message}");
    };
    let (begin, end) = (EN.find("[contact]").unwrap(), EN.find("[[pantograph]]").unwrap());
    let joint = format!("{}[contact]\nlaw = \"sliding_joint\"\n{}", &EN[..begin], &EN[end..]);
    refused(
        &joint,
        "pantograph[1].strips = 2 entries: must be one strip, or contact.law \"penalty\"",
    );
    let pantograph = &EN[EN.find("[[pantograph]]").unwrap()..EN.find("[coupling]").unwrap()];
    let with = |second: &str| EN.replace("[coupling]", &format!("{second}[coupling]"));
    refused(
        &with("[[pantograph]]\noffset_x = -15.0\nfmu = \"vendor.fmu\"\n"),
        "pantograph[1].strips = 2 entries: must be one strip beside pantograph[2].fmu",
    );
    let near = pantograph.replace("offset_x = 0.0", "offset_x = -0.2");
    refused(
        &with(&near),
        "pantograph[2].offset_x = -0.2 m: must be less than -0.29 m: the strips of the head",
    );
    let supplied = EN.replacen(pantograph, "[[pantograph]]\nfmu = \"vendor.fmu\"\n", 1);
    refused(&supplied, "pantograph[1].strips: must be left out: fmu is given");
}

#[test]
fn strips_of_a_linkage_are_fixed_to_its_head() {
    const TWO: &str = "strips=[{ x = 0.29 }, { x = -0.29 }]";
    let scene = read(THESIS, &[TWO]).unwrap();
    assert_eq!(
        scene.pantographs[0].strips(),
        [HeadStrip::fixed(0.29), HeadStrip::fixed(-0.29)]
    );
    assert_eq!(read(&scene.to_toml(), &[]).unwrap(), scene);
    let pitch = read(THESIS, &[TWO, "pitch={ inertia = 0.4, stiffness = 0 }"]).unwrap_err();
    assert!(
        pitch.contains("pantograph[1].pitch: must be left out: model is \"linkage\""),
        "{pitch}"
    );
    let spring = "strips=[{ x = 0.29, mass = 1.5, stiffness = 5000 }, { x = -0.29, mass = 1.5, stiffness = 5000 }]";
    let sprung = read(THESIS, &[spring]).unwrap_err();
    assert!(
        sprung.contains("strips[1].mass") && sprung.contains("need model = \"lumped\""),
        "{sprung}"
    );
}

#[test]
fn each_strip_must_stay_on_the_line() {
    let place = |start: &str| {
        let keys = [
            start.to_owned(),
            "pantograph[1].strips=[{ x = 0.5 }, { x = -0.5 }]".to_owned(),
        ];
        Scene::from_toml(EN, "x.toml", &keys).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
    };
    assert_eq!(place("run.start_x=0.6"), "accepted");
    let message = place("run.start_x=0.4");
    assert!(
        message.contains("strip 2 of pantograph[1] starts at x = -0.09999999999999998 m"),
        "{message}"
    );
}
