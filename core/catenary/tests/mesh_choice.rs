//! Mesh, corrections and micro step chosen for a scene, and refusals of those that cannot be.

use catenary::mesh::{MeshError, corrections_left_out, expected_error, expected_error_at, load};
use scene::{Correction, Division, Scene, WireKind};

const EN_250: &str = include_str!("../../../scenes/en50318-250.toml");
const EN: &str = EN_250;
const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");
const CONTROLLED: &str = include_str!("../../../scenes/thesis-controlled.toml");
const THESIS: &str = include_str!("../../../scenes/thesis-pantograph.toml");
const LUMPED: &str = include_str!("../../../scenes/thesis-lumped.toml");
const JOINT: &str = include_str!("../../../scenes/thesis-sliding-joint.toml");

fn read(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_string()).collect();
    load(text, "x.toml", &overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn message(text: &str, overrides: &[&str]) -> String {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_string()).collect();
    match load(text, "x.toml", &overrides) {
        Ok(_) => "accepted".to_string(),
        Err(error) => error.to_string(),
    }
}

fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the scene does not contain {from:?}");
    text.replacen(from, to, 1)
}

fn holds(message: &str, fragments: &[&str]) {
    for fragment in fragments {
        assert!(message.contains(fragment), "{fragment:?} is not in:\n{message}");
    }
}

/// The mesh of the scene.
const MESH: &str = "elements_per_interval = 8               # chosen with the corrections: the force is 0.5 % of its \
                    standard deviation from the converged one\ncorrections = \"auto\"";

const BEAM: [&str; 2] = [
    "catenary.mesh.element=beam",
    "catenary.contact_wire.beam={ shear_stiffness = 5.6e6, torsional_stiffness = 145.0, rotary_inertia = 1.5e-5 }",
];

#[test]
fn a_contact_wire_of_beams_is_spatial_without_corrections_and_survives_writing() {
    let scene = read(EN_250, &BEAM);
    assert!(scene.corrections().is_empty() && !scene.is_planar());
    assert_eq!(read(&scene.to_toml(), &[]), scene);
}

#[test]
fn what_is_made_for_cables_is_refused_with_beams() {
    for (more, key) in [
        ("model.reduce=[\"planar\"]", "model.reduce"),
        ("model.reduce=[\"linearised\"]", "model.reduce"),
        ("model.reduce=[\"flat\"]", "model.reduce"),
        ("model.reduce=[\"window\"]", "model.reduce"),
        (
            "catenary.mesh.corrections=[\"mass_correction\"]",
            "catenary.mesh.corrections",
        ),
        (
            "catenary.contact_wire.bending_stiffness=0",
            "catenary.contact_wire.bending_stiffness",
        ),
    ] {
        let overrides = [BEAM[0], BEAM[1], more].map(str::to_owned);
        let error = load(EN_250, "x.toml", &overrides).unwrap_err().to_string();
        assert!(
            error.contains(key) && error.contains("catenary.mesh.element = \"beam\""),
            "{error}"
        );
    }
    let text = EN_250.replace("element = \"cable\"", "element = \"beam\"\nerror_percent = 1.0");
    let error = load(&text, "x.toml", &[BEAM[1].to_owned()]).unwrap_err().to_string();
    assert!(error.contains("the rule was measured with cable elements"), "{error}");
}

#[test]
fn a_mesh_takes_every_correction_that_it_can_have() {
    let all = [
        Correction::ContactCompliance,
        Correction::BendingLayers,
        Correction::MassCorrection,
    ];
    let corrections = |text: &str, overrides: &[&str]| read(text, overrides).corrections().to_vec();
    assert_eq!(corrections(EN_250, &[]), all);
    assert_eq!(corrections(EN_250, &["catenary.mesh.corrections=auto"]), all);
    assert!(corrections(EN_250, &["catenary.mesh.corrections=none"]).is_empty());
    assert!(corrections(THESIS, &[]).is_empty());
    // Held ends bear longer steps than those under tensioning weights.
    let long = ["solver.micro_step=1.9e-3", "coupling.macro_step=1.9e-3"];
    assert_eq!(corrections(EN_250, &long), all[..2]);
    assert_eq!(
        corrections(EN_250, &[&long[..], &["catenary.wire_ends=fixed"]].concat()),
        all
    );
    // In one order, whatever that of the file.
    let two = "catenary.mesh.corrections=[\"mass_correction\", \"contact_compliance\"]";
    assert_eq!(
        corrections(EN_250, &[two]),
        [Correction::ContactCompliance, Correction::MassCorrection]
    );
    for (overrides, left_out, reason) in [
        (
            &["solver.rho_inf=0.8"][..],
            Correction::MassCorrection,
            "solver.rho_inf = 0.8 is below 0.9",
        ),
        (
            &["solver.micro_step=0.002", "coupling.macro_step=0.002"],
            Correction::MassCorrection,
            "internal steps of 2.0000 ms are too long beside 1.2837 ms",
        ),
        (
            &["catenary.mesh.elements_per_interval=64"],
            Correction::BendingLayers,
            "is below the bending length",
        ),
        (
            &[
                "run.speed_kmh=450",
                "run.allow_supercritical=true",
                "run.duration=4",
                "run.evaluate={time=[1,3]}",
            ],
            Correction::ContactCompliance,
            "is not slower than the waves",
        ),
    ] {
        let scene = read(EN_250, overrides);
        let reasons = corrections_left_out(&scene);
        let found = reasons
            .iter()
            .find(|(correction, _)| *correction == left_out)
            .expect("left out");
        assert!(found.1.contains(reason), "{}", found.1);
        assert_eq!(read(&scene.to_toml(), &[]), scene);
    }
    let written = read(EN_250, &[]).to_toml();
    let line = "corrections = [\"contact_compliance\", \"bending_layers\", \"mass_correction\"]";
    assert!(written.lines().any(|written| written == line), "{written}");
}

#[test]
fn elements_are_no_longer_than_their_limit_and_an_override_takes_the_place_of_the_other_key() {
    let even = read(EN_300, &["catenary.mesh.element_length=0.93"]);
    let (line, _) = even.modelled_line().unwrap();
    assert_eq!(line.mesh.division, Division::UpTo(0.93));
    assert_eq!(elements(&even), 66);
    assert_eq!(line.shortest_element(WireKind::Contact), 5.0 / 6.0);
    assert_eq!(line.longest_element(), 6.5 / 7.0);
    let written = even.to_toml();
    assert!(written.contains("\nelement_length = 0.93\n") && !written.contains("elements_per_interval"));
    assert_eq!(read(&written, &[]), even);
    // And back, on what has the length; the last of both counts.
    assert_eq!(
        read(&written, &["catenary.mesh.elements_per_interval=8"]).to_toml(),
        read(EN_300, &[]).to_toml()
    );
    let both = [
        "catenary.mesh.element_length=2",
        "catenary.mesh.elements_per_interval=3",
    ];
    assert_eq!(elements(&read(EN_300, &both)), 30);
    assert_eq!(elements(&read(EN_300, &[both[1], both[0]])), 36);
    // What asks for an error chooses the corrections too.
    let asked = read(EN_300, &["catenary.mesh.error_percent=1"]);
    assert_eq!(elements(&asked), 76);
    // A step of the file that is too long for the error gives way, one that is asked for beside it does not.
    let fine = read(EN_300, &["catenary.mesh.error_percent=0.1"]);
    assert!(fine.solver.micro_step < asked.solver.micro_step);
    assert!(expected_error(&fine).unwrap().total() <= 0.1);
    holds(
        &message(EN_300, &["catenary.mesh.error_percent=0.1", "solver.micro_step=0.001"]),
        &[
            "catenary.mesh.error_percent = 0.1 %: must be at least 0.2",
            "with solver.micro_step = 1 ms",
        ],
    );
    // One element for each interval is enough for a long limit.
    assert_eq!(elements(&read(EN_300, &["catenary.mesh.element_length=1000"])), 10);
    // The mass correction is made for steps up to a quarter of a wave's time through 5/6 m, 1.712 ms. Steps longer by
    // √2 go without it.
    let steps = |ms: &str| {
        let keys = [
            format!("solver.micro_step={ms}e-3"),
            format!("coupling.macro_step={ms}e-3"),
        ];
        read(EN_300, &["catenary.mesh.element_length=0.93", &keys[0], &keys[1]])
    };
    assert!(steps("2.40").corrections().contains(&Correction::MassCorrection));
    assert!(!steps("2.43").corrections().contains(&Correction::MassCorrection));
}

/// Elements of each wire in a span.
fn elements(scene: &Scene) -> usize {
    let (line, _) = scene.modelled_line().unwrap();
    line.elements_per_span(line.mesh.division)
}

/// The mesh of a scene without one that asks for an error.
fn for_error(text: &str, error: f64, more: &[&str]) -> Scene {
    let mesh = format!("catenary.mesh={{error_percent={error}}}");
    let overrides = [&[mesh.as_str()], more].concat();
    read(text, &overrides)
}

#[test]
fn a_mesh_follows_the_error_that_is_asked_for() {
    let text = &EN_300.replace("micro_step = 0.001", "# micro_step left out");
    assert_ne!(text, EN_300);
    let mut last = 0;
    for error in [10.0, 3.0, 1.0, 0.5, 0.35] {
        let scene = for_error(text, error, &[]);
        let expected = expected_error(&scene).unwrap();
        let elements = elements(&scene);
        assert!(expected.total() <= error, "{error} %: {expected:?}");
        assert!(elements >= last, "{error} %: {elements} after {last}");
        last = elements;
        // What is written is the choice, and reads as the same.
        assert_eq!(read(&scene.to_toml(), &[]), scene);
        assert!(!scene.to_toml().contains("error_percent"));
    }
    let scene = for_error(text, 1.0, &[]);
    let mesh = &scene.modelled_line().unwrap().0.mesh;
    // Eight elements in 6.5 m, seven in 5 and 5.5 m.
    assert_eq!(
        (
            mesh.division,
            elements(&scene),
            mesh.corrections.len(),
            scene.solver.micro_step
        ),
        (Division::UpTo(0.8125), 76, 3, 1.4e-3)
    );
    // A macro step that leaves room for longer micro steps: elements of one length take them with the mass correction.
    let long = for_error(text, 2.0, &["coupling.macro_step=0.0016"]);
    assert_eq!(
        (elements(&long), long.solver.micro_step, long.corrections().len()),
        (66, 1.6e-3, 3)
    );
    // On intervals of one length, as many in each.
    let equal = [
        "catenary.span_length=30",
        "catenary.droppers.positions=[10, 20]",
        "catenary.spans=20",
    ];
    let equal = for_error(text, 1.0, &equal);
    assert!(matches!(
        equal.modelled_line().unwrap().0.mesh.division,
        Division::PerInterval(_)
    ));
    // Slower trains shorten no waves; a lower pass asks for less.
    let fewer = |more: &[&str]| elements(&for_error(text, 1.0, more)) < 76;
    assert!(fewer(&[
        "run.speed_kmh=200",
        "run.duration=3",
        "run.evaluate={time=[1,2]}"
    ]));
    assert!(fewer(&["run.low_pass_hz=10"]));
    // A step that is given stays.
    let given = for_error(EN_300, 1.0, &["solver.micro_step=0.0005"]);
    assert_eq!(given.solver.micro_step, 5e-4);
}

#[test]
fn a_scene_without_a_mesh_gets_the_one_for_an_error_of_one_percent() {
    let (before, rest) = EN_300.split_once("[catenary.mesh]").unwrap();
    let after = &rest[rest.find("\n[").unwrap()..];
    let without = format!("{before}{after}");
    let free_step = without.replace("micro_step = 0.001", "# micro_step left out");
    for text in [&without, &free_step, &format!("{before}[catenary.mesh]\n{after}")] {
        let scene = read(text, &[]);
        // An error that is asked for has the macro step chosen, too.
        let asked = ["catenary.mesh={error_percent=1.0}", "coupling.macro_step=0.001"];
        assert_eq!(scene, read(text, &asked));
        assert_eq!(read(&scene.to_toml(), &[]), scene);
    }
    // A division that is set takes the place of the choice.
    assert_eq!(
        elements(&read(&without, &["catenary.mesh.elements_per_interval=3"])),
        30
    );
    // A joint has a rule of its own.
    let joined = read(&without, &["contact={law=\"sliding_joint\"}"]);
    assert!(expected_error(&joined).unwrap().total() <= 1.0);
    let refusal = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_string()).collect();
        load(&without, "x.toml", &overrides).unwrap_err().to_string()
    };
    let slow = refusal(&["run.speed_kmh=30", "run.evaluate={time=[1,4]}"]);
    let told = "catenary.mesh is missing: must be a table with elements_per_interval or element_length, as none can \
                be chosen for the \
                default error_percent = 1 %: no rule is known for run.speed_kmh = 30 km/h";
    assert!(slow.contains(told), "{slow}");
    let beam = refusal(&[BEAM[1]]);
    assert!(
        beam.contains("catenary.contact_wire.beam = { … }: must be left out with catenary.mesh.element = \"cable\""),
        "{beam}"
    );
}

/// Keys of a run at `kmh` that is filtered at `hz`, long enough to be read.
fn slow_run(kmh: f64, hz: f64) -> [String; 4] {
    [
        format!("run.speed_kmh={kmh}"),
        "run.duration=5".to_owned(),
        "run.evaluate={time=[1,4]}".to_owned(),
        format!("run.low_pass_hz={hz}"),
    ]
}

/// The error that is expected of a scene with `more`, at `kmh` and `hz`.
fn expected(text: &str, (kmh, hz): (f64, f64), more: &[&str]) -> MeshError {
    let run = slow_run(kmh, hz);
    let run: Vec<&str> = run.iter().map(String::as_str).collect();
    expected_error(&read(text, &[&run[..], more].concat())).unwrap()
}

#[test]
fn expected_errors_are_those_that_were_measured() {
    // Speed in km/h, filter in Hz, elements, step in ms, and the error measured against 16 corrected elements at 0.25
    // ms, %.
    type Case = (f64, f64, usize, f64, f64);
    let en: &[Case] = &[
        (300.0, 3.0, 4, 1.0, 0.65),
        (300.0, 5.0, 2, 1.0, 3.85),
        (300.0, 10.0, 4, 1.0, 2.93),
        (300.0, 3.0, 8, 2.0, 1.25),
        (300.0, 10.0, 8, 2.0, 4.42),
        (300.0, 20.0, 8, 1.0, 0.41),
        (200.0, 20.0, 6, 1.0, 0.95),
        (120.0, 10.0, 4, 1.0, 0.87),
        (120.0, 20.0, 4, 1.0, 5.06),
        (120.0, 20.0, 3, 1.0, 12.15),
        (120.0, 20.0, 8, 1.0, 0.39),
        (60.0, 3.0, 2, 1.0, 1.05),
        (60.0, 10.0, 4, 1.0, 1.27),
        (60.0, 20.0, 6, 1.0, 2.67),
        (60.0, 20.0, 8, 1.0, 0.98),
        (60.0, 10.0, 8, 2.0, 2.98),
    ];
    let thesis: &[Case] = &[
        (200.0, 1.0, 4, 1.0, 1.91),
        (200.0, 5.0, 8, 1.0, 0.64),
        (200.0, 10.0, 2, 1.0, 7.65),
        (120.0, 5.0, 4, 1.0, 0.58),
        (120.0, 20.0, 3, 1.0, 9.21),
        (60.0, 5.0, 6, 1.0, 0.76),
        (60.0, 20.0, 8, 1.0, 1.25),
    ];
    for (text, cases) in [(EN_300, en), (LUMPED, thesis)] {
        for &(kmh, hz, elements, step, measured) in cases {
            let keys = [
                format!("catenary.mesh.elements_per_interval={elements}"),
                format!("solver.micro_step={step}e-3"),
                format!("coupling.macro_step={step}e-3"),
            ];
            let expected = expected(text, (kmh, hz), &[&keys[0], &keys[1], &keys[2]]).total();
            let ratio = expected / measured;
            assert!(
                (0.5..6.0).contains(&ratio),
                "{kmh} km/h, {hz} Hz, {elements} elements, {step} ms: {expected:.2} %, measured {measured} %"
            );
        }
    }
    let plain = "catenary.mesh.corrections=none";
    for (kmh, hz, elements, measured) in [
        (300.0, 3.0, 8, 0.60),
        (300.0, 5.0, 4, 4.47),
        (120.0, 20.0, 4, 28.9),
        (60.0, 5.0, 8, 2.57),
        (60.0, 20.0, 8, 13.9),
    ] {
        let elements = format!("catenary.mesh.elements_per_interval={elements}");
        let ratio = expected(EN_300, (kmh, hz), &[plain, &elements]).total() / measured;
        assert!(
            (0.5..4.0).contains(&ratio),
            "plain, {kmh} km/h, {hz} Hz, {elements}: {ratio:.2}"
        );
    }
    // Hardly damped, of 8 corrected elements and of a step without correction.
    let damping = "catenary.damping.beta=2e-5";
    let long = ["solver.micro_step=2e-3", "coupling.macro_step=2e-3"];
    let ratio = expected(EN_300, (300.0, 20.0), &[damping]).total() / 1.18;
    assert!((0.7..1.5).contains(&ratio), "{ratio:.2}");
    let ratio = expected(EN_300, (300.0, 20.0), &[damping, long[0], long[1]]).total() / 14.7;
    assert!((0.7..1.5).contains(&ratio), "{ratio:.2}");
}

#[test]
fn from_twenty_hertz_and_two_hundred_km_h_on_errors_go_by_waves() {
    let line = read(EN_300, &[]);
    let c = line.modelled_line().unwrap().0.contact_wire.wave_speed();
    for (kmh, hz, beta) in [
        (300.0, 20.0, "1e-4"),
        (300.0, 30.0, "1e-4"),
        (200.0, 20.0, "5e-5"),
        (400.0, 20.0, "1e-3"),
    ] {
        let beta = format!("catenary.damping.beta={beta}");
        let error = expected(EN_300, (kmh, hz), &[&beta]);
        let mu = 6.5 / 8.0 * hz / (c * (c - kmh / 3.6)).sqrt();
        let waves = (200.0 * mu.powi(4)).max(10.0 * mu.powi(2)).min(80.0 * mu.powi(2));
        assert!(
            (error.space / waves - 1.0).abs() < 1e-9,
            "{kmh} km/h, {hz} Hz: {error:?}, {waves}"
        );
        assert!(
            (error.time / (500.0 * (1e-3 * hz).powi(2)) - 1.0).abs() < 1e-9,
            "{error:?}"
        );
    }
    // Steps that the messenger wire cannot be corrected for are an error like those of the contact wire.
    let light = "catenary.messenger_wire.mass_per_length=0.5";
    let error = expected(EN_300, (300.0, 20.0), &[light]);
    let messenger = 0.25 * (5.0 / 8.0) / (16_000.0_f64 / 0.5).sqrt();
    let off = 5000.0 * (1e-6 - messenger.powi(2)) * 400.0;
    assert!((error.time / (0.2 + off) - 1.0).abs() < 1e-9, "{error:?}, {off}");
    // A lower filter never makes more of it, nor anything of nothing.
    let mut last = f64::INFINITY;
    for hz in [30.0, 20.0, 19.9, 15.0, 10.0, 5.0, 2.0] {
        let error = expected(EN_300, (300.0, hz), &[]).total();
        assert!(error <= last && error > 0.3, "{hz} Hz: {error}");
        last = error;
    }
}

#[test]
fn a_micro_step_is_chosen_among_the_parts_of_the_macro_step() {
    let text = &EN_300.replace("micro_step = 0.001", "# micro_step left out");
    let chosen = |error: f64, macro_step: &str| {
        let key = format!("coupling.macro_step={macro_step}");
        let scene = for_error(text, error, &[&key]);
        assert!(expected_error(&scene).unwrap().total() <= error, "{macro_step}");
        assert_eq!(read(&scene.to_toml(), &[]), scene);
        scene.internal_step()
    };
    for (macro_step, micro_step) in [
        // Those of the list, whole.
        ("0.001", 1e-3),
        ("0.0005", 5e-4),
        ("0.002", 1e-3),
        ("0.00125", 1.25e-3),
        ("0.00005", 5e-5),
        // Others.
        ("0.0016", 0.8e-3),
        ("0.0015", 1.5e-3),
        ("0.0007", 0.7e-3),
        ("0.0011", 1.1e-3),
        ("0.0013", 1.3e-3),
        ("0.0033333333333333335", 1e-2 / 9.0),
        ("0.00002", 2e-5),
    ] {
        let step = chosen(1.0, macro_step);
        assert!((step / micro_step - 1.0).abs() < 1e-9, "{macro_step} s: {step} s");
    }
    // A part of the list is written as that.
    assert_eq!(
        for_error(text, 1.0, &["coupling.macro_step=0.0025"]).solver.micro_step,
        1.25e-3
    );
    // A controlled one that is always shorter than the list.
    let control = "coupling.macro_step={tolerance=1.0, min=1e-5, max=4e-5}";
    assert_eq!(for_error(text, 1.0, &[control]).internal_step(), 4e-5);
}

#[test]
fn a_step_that_the_mass_is_not_corrected_for_makes_its_own_error() {
    let scene = read(
        EN_300,
        &["coupling.macro_step={tolerance=1.0}", "solver.micro_step=0.00125"],
    );
    assert_eq!((scene.internal_step(), scene.internal_step_of(1e-3)), (1.25e-3, 1e-3));
    let time = |step: f64| expected_error_at(&scene, step).unwrap().time;
    // 0.02 and 0.025 are the steps in periods of 20 Hz.
    assert!((time(1.25e-3) - 500.0 * 0.025_f64.powi(2)).abs() < 1e-12);
    assert!((time(1e-3) - (500.0 * 0.02_f64.powi(2) + 5000.0 * (0.025_f64.powi(2) - 0.02_f64.powi(2)))).abs() < 1e-12);
}

/// A mistake in one key is told once, whatever follows from it.
#[test]
fn one_mistake_is_one_line() {
    let told = message(&edited(EN, "duration = 7.0", "duration = 1e300"), &[]);
    assert_eq!(
        told,
        "x.toml:6: run.duration = 1e300 s: must be at most 100000 s: 1e8 steps of 0.001 s"
    );
    for error in ["0.0", "-1.0", "nan"] {
        let told = message(&edited(EN, MESH, &format!("error_percent = {error}")), &[]);
        holds(
            &told,
            &["catenary.mesh.error_percent = ", " %: must be positive and finite"],
        );
        assert_eq!(told.lines().count(), 1, "{told}");
    }
    // A mesh is not chosen, nor a step halved, for values that are refused.
    for keys in [
        &["run.speed_kmh=-250"][..],
        &["run.low_pass_hz=0"],
        &["catenary.damping.beta=-1"],
        &["solver.rho_inf=-1"],
        &["coupling.macro_step=0"],
        &["solver.micro_step=inf", "coupling.macro_step={tolerance=1.0}"],
    ] {
        for mesh in [
            "catenary.mesh={error_percent=1.0}",
            "catenary.mesh.corrections=\"auto\"",
        ] {
            let told = message(EN, &[keys, &[mesh]].concat());
            holds(&told, &[keys[0].split('=').next().unwrap(), "must be"]);
            assert_eq!(told.lines().count(), 1, "{told}");
        }
    }
    let negative = message(EN, &["coupling.macro_step={tolerance=1.0, min=-0.01, max=-0.001}"]);
    holds(&negative, &["coupling.macro_step.max = -0.001 s: must be positive"]);
    holds(
        &message(EN, &["catenary.mesh={error_percent=1e-300}"]),
        &["catenary.mesh.error_percent = 1e-300 %: must be at least 0.1 %"],
    );
}

#[test]
fn macro_steps_of_many_parts_are_refused_where_they_are_longer_than_the_run() {
    for step in ["1000", "1e6", "6e13", "1e300"] {
        let mesh = ["catenary.mesh={error_percent=1.0}", "solver={}"];
        let told = message(EN, &[&mesh[..], &[&format!("coupling.macro_step={step}")]].concat());
        holds(&told, &["coupling.macro_step = ", "must be at most run.duration"]);
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}

#[test]
fn no_line_left_out_and_no_value_replaced_makes_the_reader_panic() {
    let begins = |message: &str| message == "accepted" || message.lines().all(|line| line.starts_with("x.toml"));
    for scene in [EN, THESIS] {
        let lines: Vec<&str> = scene.lines().collect();
        for i in 0..lines.len() {
            let without = [&lines[..i], &lines[i + 1..]].concat().join("\n");
            let told = message(&without, &[]);
            assert!(begins(&told), "without {:?}: {told}", lines[i]);
            let Some((key, _)) = lines[i].split_once('=') else {
                continue;
            };
            for value in [
                "-1",
                "0",
                "nan",
                "1e308",
                "9223372036854775807",
                "\"x\"",
                "\"\"",
                "[]",
                "[[]]",
                "{}",
                "[{}]",
                "true",
                "1979-05-27",
            ] {
                let replaced = format!("{key}= {value}");
                let with = [&lines[..i], &[replaced.as_str()], &lines[i + 1..]].concat().join("\n");
                let told = message(&with, &[]);
                assert!(begins(&told), "with {replaced:?}: {told}");
            }
        }
    }
}

#[test]
fn a_correction_that_cannot_be_is_refused_with_its_reason() {
    let corrections = "catenary.mesh.corrections=[\"contact_compliance\", \"bending_layers\", \"mass_correction\"]";
    for (more, what, reason) in [
        (
            &["solver.micro_step=0.002", "coupling.macro_step=0.002"][..],
            "\"mass_correction\": must be left out: internal steps of 2.0000 ms are too long beside 1.2837 ms",
            "the corrected mass would not be positive",
        ),
        (
            &["solver.rho_inf=0.5"],
            "\"mass_correction\": must be left out: solver.rho_inf = 0.5",
            "below 0.9",
        ),
        (
            &[
                "run.speed_kmh=450",
                "run.allow_supercritical=true",
                "run.duration=4",
                "run.evaluate={time=[1,3]}",
            ],
            "\"contact_compliance\": must be left out: the strip at 125.00 m/s",
            "√(tension / mass_per_length)",
        ),
        (
            &["catenary.mesh.elements_per_interval=64"],
            "\"bending_layers\": must be left out: the shortest element, 0.0781 m",
            "contact wire",
        ),
    ] {
        let message = message(EN, &[&[corrections], more].concat());
        holds(&message, &["catenary.mesh.corrections = ", what, reason]);
    }
}

#[test]
fn an_error_that_no_mesh_makes_is_refused() {
    let mesh = "catenary.mesh={error_percent=1.0}";
    let fast = [
        "run.speed_kmh=450",
        "run.allow_supercritical=true",
        "run.duration=4",
        "run.evaluate={time=[1,3]}",
    ];
    holds(
        &message(EN, &[&[mesh], &fast[..]].concat()),
        &["catenary.mesh.error_percent = 1 %: no rule is known for 450.0 km/h on wires with waves of 438.2"],
    );
    let slow = ["run.speed_kmh=20", "run.duration=4", "run.evaluate={time=[1,3]}"];
    let cases: [(&[&str], &str); 4] = [
        (
            &["run.low_pass_hz=1"],
            "run.low_pass_hz = 1 Hz: must be at least 1.16 Hz, at which spans of 60.00 m pass at 250.0 km/h",
        ),
        (&slow, "run.speed_kmh = 20 km/h: must be at least 60 km/h"),
        (
            &["catenary.damping.beta=0"],
            "catenary.damping.beta = 0 s: must be at least 0.00002 s",
        ),
        (&["solver.rho_inf=0.7"], "solver.rho_inf = 0.7: must be at least 0.8"),
    ];
    for (keys, why) in cases {
        let refused = "catenary.mesh.error_percent = 1 %: no rule is known for ";
        let found = message(EN, &[&[mesh], keys].concat());
        holds(
            &found,
            &[refused, why, "give elements_per_interval or element_length instead"],
        );
    }
    let long = ["solver.micro_step=0.005", "coupling.macro_step=0.005"];
    holds(
        &message(EN, &[&[mesh], &long[..]].concat()),
        &[
            "catenary.mesh.error_percent = 1 %: must be at least",
            "with solver.micro_step = 5 ms",
        ],
    );
}

/// No spring under a joint that more flexibility could be in series with.
#[test]
fn a_sliding_joint_takes_no_compliance_of_the_contact() {
    let corrected = read(JOINT, &["catenary.mesh.corrections=\"auto\""]);
    assert!(
        !corrected.corrections().contains(&Correction::ContactCompliance)
            && corrected.corrections().contains(&Correction::BendingLayers)
    );
    let left_out = corrections_left_out(&corrected);
    let reason = &left_out
        .iter()
        .find(|(correction, _)| *correction == Correction::ContactCompliance)
        .unwrap()
        .1;
    assert!(reason.contains("sliding_joint"), "{reason}");
    let with_correction = "catenary.mesh.corrections=[\"contact_compliance\"]";
    let refused = message(JOINT, &[with_correction]);
    assert!(
        refused.contains("must be left out: contact.law is \"sliding_joint\""),
        "{refused}"
    );
}

#[test]
fn steps_follow_an_error_that_is_asked_for() {
    let steps = |text: &str, more: &[&str]| {
        let scene = for_error(text, 1.0, more);
        (scene.coupling.macro_step, scene.solver.micro_step)
    };
    assert_eq!(steps(EN_300, &[]), (1.4e-3, 1.4e-3));
    // Exact in time but for the force of a strip, modes take the longest step.
    assert_eq!(steps(EN_300, &["model.reduce=[\"modal\"]"]), (2.5e-3, 2.5e-3));
    // Steps that are given stay.
    assert_eq!(steps(EN_300, &["coupling.macro_step=0.002"]), (2e-3, 1e-3));
    assert_eq!(steps(EN_300, &["solver.micro_step=0.0005"]), (1e-3, 5e-4));
    let long = EN_300.replace("macro_step = 0.001", "macro_step = 0.002");
    assert_eq!(steps(&long, &["solver.micro_step=0.0005"]), (2e-3, 5e-4));
    // Of an error in a file, the macro step that it does not give.
    let before = EN_300.split_once("elements_per_interval = 8").unwrap().0;
    let after = EN_300.split_once("axial_strain").unwrap().1;
    let in_file = format!("{before}error_percent = 1.0\naxial_strain{after}");
    let chosen = |text: &str| read(text, &[]).coupling.macro_step;
    assert_eq!(chosen(&in_file), 1e-3);
    let open = in_file
        .replace("macro_step = 0.001", "")
        .replace("micro_step = 0.001", "");
    assert_eq!(chosen(&open), 1.4e-3);
    // No rule knows the coupling with samples of a control.
    assert_eq!(steps(CONTROLLED, &[]).0, 1e-3);
}

/// A written scene that leaves its mesh to be chosen reads as the same, and the choice is the same.
#[test]
fn an_open_mesh_survives_writing() {
    for mesh in [
        "{error_percent=1.0}",
        "{elements_per_interval=8}",
        "{elements_per_interval=8, corrections=\"none\"}",
    ] {
        for step in ["micro_step = 0.0005", "# micro_step left out"] {
            let text = EN_300.replace("micro_step = 0.001", step);
            let overrides = [format!("catenary.mesh={mesh}")];
            let open = Scene::from_toml(&text, "x.toml", &overrides).unwrap();
            let again = Scene::from_toml(&open.to_toml(), "x.toml", &[]).unwrap();
            assert_eq!(again, open, "{mesh}, {step}");
            assert_eq!(read(&open.to_toml(), &[]), load(&text, "x.toml", &overrides).unwrap());
        }
    }
}

#[test]
fn a_mesh_that_is_not_chosen_is_no_line() {
    let open = Scene::from_toml(EN_300, "x.toml", &["catenary.mesh={error_percent=1.0}".to_owned()]).unwrap();
    let error = catenary::static_line(&open).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("a resolved scene is needed"), "{error}");
}
