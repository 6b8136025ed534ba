//! What is read is what was typed, and what is written reads again as the same.

use scene::{
    Algorithm, ContactLaw, Correction, Division, Evaluate, Force, Line, Offset, Order, PantographModel, ParameterValue,
    Reduction, Scene, Start, Statics,
};

const EN_250: &str = include_str!("../../../scenes/en50318-250.toml");
const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");
const THESIS: &str = include_str!("../../../scenes/thesis-pantograph.toml");
const LUMPED: &str = include_str!("../../../scenes/thesis-lumped.toml");
const VEHICLE: &str = include_str!("../../../scenes/thesis.toml");

fn read(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_string()).collect();
    Scene::from_toml(text, "x.toml", &overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn lumped(scene: &Scene) -> &scene::Lumped {
    match &scene.pantographs[0].model {
        PantographModel::Lumped(lumped) => lumped,
        other => panic!("not lumped: {other:?}"),
    }
}

#[test]
fn every_shipped_scene_is_accepted() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let mut read_scenes = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let text = std::fs::read_to_string(&path).unwrap();
            let scene =
                Scene::from_toml(&text, &path.display().to_string(), &[]).unwrap_or_else(|error| panic!("{error}"));
            assert!(scene.source.is_some(), "{} names no source", path.display());
            assert_eq!(scene.questions(), Vec::<String>::new(), "{}", path.display());
            read_scenes += 1;
        }
    }
    assert!(read_scenes >= 3);
}

#[test]
fn a_written_scene_reads_again_as_an_equal_one() {
    for text in [EN_250, EN_300, THESIS, VEHICLE] {
        let scene = read(text, &[]);
        let written = scene.to_toml();
        let again = read(&written, &[]);
        assert_eq!(again, scene);
        assert_eq!(again.to_toml(), written);
    }
}

#[test]
fn a_vehicle_and_its_track_survive_writing() {
    let motion = "vehicle={ model = \"rigid_motion\", motion = { time = [0.0, 0.5], z = [0.0, 0.01], roll = [0.0, -0.1], \
         pitch = [2e-3, -1e-3], x = [0.0, 0.03], yaw = [1e-3, 0.0] } }";
    let spectrum = "track.irregularities={ model = \"spectrum\", seed = 7, wavelengths = [3.0, 80.0], \
                    vertical_roughness = 4.032e-7, lateral_roughness = 2.119e-7, corners = [0.0206, 0.8246, 0.4380], fade = 20.0 }";
    let points =
        "track.irregularities={ model = \"points\", x = [0.0, 10.0], z_left = [0.0, 0.01], z_right = [0.0, 0.02] }";
    let file = "track.irregularities={ model = \"points\", file = \"track.csv\" }";
    let curve = "track.curve={ radius = 1500.0, direction = \"left\", cant = 0.1, start = 100.0, transition = 80.0, length = 200.0, \
                 rounding = 6.0 }";
    let table = curve.trim_start_matches("track.curve=");
    let reverse = table.replace("left", "right").replace("100.0", "500.0");
    let curves = format!("track.curve=[{table}, {reverse}]");
    for (text, overrides) in [
        (THESIS, [motion].as_slice()),
        (VEHICLE, &[curve]),
        (VEHICLE, &[&curves, spectrum]),
        (VEHICLE, &[spectrum]),
        (VEHICLE, &[points]),
        (VEHICLE, &[file, "vehicle.model=vertical"]),
    ] {
        let scene = read(text, overrides);
        assert_eq!(read(&scene.to_toml(), &[]), scene);
    }
}

#[test]
fn a_line_is_planar_under_a_symmetric_vehicle_on_rails_that_are_alike() {
    let planar = |overrides: &[&str]| read(VEHICLE, overrides).is_planar();
    let bump = |right: &str| {
        format!(
            "track.irregularities={{ model = \"points\", x = [0.0, 10.0], z_left = [0.0, 0.01], z_right = [0.0, {right}] }}"
        )
    };
    assert!(planar(&[]));
    assert!(planar(&[&bump("0.01")]));
    assert!(!planar(&[&bump("0.02")]));
    assert!(!planar(&[
        "track.curve={ radius = 1500.0, direction = \"left\", cant = 0.0, start = 100.0, transition = 80.0, length = 200.0, \
                       rounding = 6.0 }"
    ]));
    assert!(!planar(&["vehicle.bodies[2].positions[1]=[1.2954, 0.1, 0.7088]"]));
    assert!(planar(&[&bump("0.02"), "vehicle.model=vertical"]));
}

#[test]
fn everything_optional_survives_writing() {
    let mut scene = read(
        EN_250,
        &[
            "catenary.statics=nodal_displacement",
            "catenary.droppers.lengths=[1.1, 1.0, 0.9, 0.85, 0.8, 0.85, 0.9, 1.0, 1.1]",
            "catenary.contact_wire.breaking_force=40000",
            "catenary.registration_arms.free_uplift=0.24",
            "catenary.registration_arms.uplift_stop=true",
            "run.electrification=dc_1_5kv",
            "solver.formulation=index_1_baumgarte",
            "catenary.span_length=[60, 60.5, 61, 60, 60, 60, 60, 60, 60, 59]",
            "catenary.stagger=[0.2, -0.2]",
            "run.evaluate={ time = [2.0, 3.0] }",
            "run.initialise=as_given",
            "pantograph[1].unilateral=[true, false]",
            "pantograph[1].friction=[0, 2.5]",
            "pantograph[1].reference_height=5.31",
            "model.reduce=auto",
        ],
    );
    scene.pantographs[0].start = Some(Start {
        height: 5.3 + 1e-3 / 3.0,
        force: 116.1,
    });
    assert_eq!(read(&scene.to_toml(), &[]), scene);
    let Line::Modelled(catenary) = &scene.catenary else {
        panic!("a modelled line")
    };
    assert_eq!(catenary.statics, Statics::NodalDisplacement);
    assert_eq!(catenary.support_x(3), 60.0 + 60.5 + 61.0);
    assert_eq!(catenary.length(), 600.5);
    assert_eq!(catenary.stagger_at(3), -0.2);
    assert_eq!(lumped(&scene).friction, [0.0, 2.5]);
}

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
        let error = Scene::from_toml(EN_250, "x.toml", &overrides).unwrap_err().to_string();
        assert!(
            error.contains(key) && error.contains("catenary.mesh.element = \"beam\""),
            "{error}"
        );
    }
    let text = EN_250.replace("element = \"cable\"", "element = \"beam\"\nerror_percent = 1.0");
    let error = Scene::from_toml(&text, "x.toml", &[BEAM[1].to_owned()])
        .unwrap_err()
        .to_string();
    assert!(error.contains("the rule was measured with cable elements"), "{error}");
}

#[test]
fn a_third_party_pantograph_and_line_survive_writing() {
    let (before, rest) = EN_250.split_once("[catenary]").unwrap();
    let after = &rest[rest.find("[coupling]").unwrap()..];
    let text = format!(
        r#"{before}
[catenary]
fmu = "line.fmu"
outputs = {{ "contact[1].force" = {{ variable = "F" }} }}

[[pantograph]]
fmu = "vendor/panto.fmu"
isolate = true
environment = {{ LD_PRELOAD = "libpython3.11.so", PYTHONPATH = "/opt/a b" }}
parameters = {{ m1 = 7.2, "static.force" = 110.0, n = 3, on = true, name = "a \"b\"" }}
inputs = {{ force = {{ variable = "F_c", factor = -1.0 }} }}
outputs = {{ height = {{ variable = "z1", offset = "align" }}, velocity = {{ variable = "v1", offset = 5.0 }} }}

{after}"#
    );
    let scene = read(&text, &["run.evaluate={ time = [2, 3] }"]);
    assert_eq!(read(&scene.to_toml(), &[]), scene);
    assert!(scene.contact.is_none() && scene.modelled_line().is_none());
    let PantographModel::Supplied(side) = &scene.pantographs[0].model else {
        panic!("somebody else's")
    };
    assert_eq!(
        (side.fmu.as_str(), side.isolate, side.step_timeout),
        ("vendor/panto.fmu", true, 60.0)
    );
    assert_eq!(side.environment["LD_PRELOAD"], "libpython3.11.so");
    assert_eq!(side.environment["PYTHONPATH"], "/opt/a b");
    assert_eq!(side.parameters["static.force"], ParameterValue::Number(110.0));
    assert_eq!(side.parameters["n"], ParameterValue::Number(3.0));
    assert_eq!(side.parameters["on"], ParameterValue::Boolean(true));
    assert_eq!(side.inputs["force"].factor, Some(-1.0));
    assert_eq!(side.inputs["force"].offset, Offset::Value(0.0));
    assert_eq!(side.outputs["height"].offset, Offset::Align);
    assert_eq!(side.outputs["velocity"].offset, Offset::Value(5.0));
}

#[test]
fn every_number_survives_writing_bit_for_bit() {
    // Neighbours of round numbers, the smallest and largest exponents that pass the checks, thirds.
    for typed in [
        "0.1",
        "0.30000000000000004",
        "20.000000000000004",
        "1e-300",
        "4.9e-324",
        "1.7976931348623157e308",
        "3.3333333333333335e-5",
    ] {
        let scene = read(EN_250, &[&format!("coupling.force_tolerance={typed}")]);
        let again = read(&scene.to_toml(), &[]);
        let expected: f64 = typed.parse().unwrap();
        assert_eq!(scene.coupling.force_tolerance.to_bits(), expected.to_bits());
        assert_eq!(again.coupling.force_tolerance.to_bits(), expected.to_bits());
    }
    let scene = read(EN_250, &["pantograph[1].offset_x=-0.0"]);
    assert_eq!(
        read(&scene.to_toml(), &[]).pantographs[0].offset_x.to_bits(),
        (-0.0_f64).to_bits()
    );
}

#[test]
fn every_speed_survives_the_conversion_from_and_to_kmh_bit_for_bit() {
    // km/h to m/s is not invertible on all numbers; what came from km/h must come back.
    for i in 1..2000 {
        let kmh = f64::from(i) * 0.217 + 1e-3 / f64::from(i);
        let scene = read(
            EN_250,
            &[
                &format!("run.speed_kmh={kmh:?}"),
                "run.evaluate={ time = [0.0, 0.1] }",
                "run.duration=0.5",
            ],
        );
        assert_eq!(scene.run.speed.to_bits(), (kmh / 3.6).to_bits());
        assert_eq!(
            read(&scene.to_toml(), &[]).run.speed.to_bits(),
            scene.run.speed.to_bits(),
            "{kmh} km/h"
        );
    }
    assert!(read(EN_250, &[]).to_toml().contains("speed_kmh = 250.0\n"));
    assert!(
        read(THESIS, &["run.speed_kmh=199.9"])
            .to_toml()
            .contains("speed_kmh = 199.9\n")
    );
}

#[test]
fn defaults_are_resolved_and_written_out() {
    let text = &EN_250[..EN_250.find("[coupling]").unwrap()];
    let scene = read(text, &[]);
    let coupling = &scene.coupling;
    assert_eq!(
        (coupling.algorithm, coupling.order, coupling.force),
        (Algorithm::Auto, Order::PantographFirst, Force::Interpolated)
    );
    assert_eq!(
        (coupling.extrapolation, coupling.macro_step, coupling.max_iterations),
        (2, 0.001, 20)
    );
    assert!(coupling.reason.starts_with("auto"), "{}", coupling.reason);
    let named = read(EN_250, &["coupling.algorithm=jacobi"]);
    assert_eq!(named.coupling.reason, "named in the scene");
    assert_eq!(
        (
            scene.solver.micro_step,
            scene.solver.rho_inf,
            scene.solver.max_iterations
        ),
        (0.001, 0.9, 30)
    );
    assert_eq!(
        scene.model.reductions,
        [Reduction::Planar],
        "nothing pushes this line sideways"
    );
    assert_eq!(
        (lumped(&scene).unilateral.as_slice(), lumped(&scene).friction.as_slice()),
        ([false; 2].as_slice(), [0.0; 2].as_slice())
    );
    let written = scene.to_toml();
    for line in [
        "[coupling]",
        "algorithm = \"auto\"",
        "force_tolerance = 0.002",
        "[solver]",
        "jacobian = \"modified\"",
        "[model]",
        "reduce = [\"planar\"]",
        "unilateral = [false, false]",
        "[[pantograph]]",
        "[catenary.contact_wire]",
        "evaluate = { spans = [5, 6] }",
        "strip = { width = 1.2 }",
        "spans = 10",
        "span_length = 60.0",
    ] {
        assert!(
            written.lines().any(|written| written == line),
            "{line} is not in\n{written}"
        );
    }
}

#[test]
fn a_long_stretch_without_a_dropper_is_questioned_and_accepted() {
    let scene = read(EN_250, &["catenary.droppers.positions=[5, 23, 41, 55]"]);
    assert_eq!(
        scene.questions(),
        [
            "catenary.droppers.positions = [5.0, 23.0, 41.0, 55.0] m: 18 m of span 1, from 5 m to 23 m, are without a dropper, and lines \
          have one every 4 to 12 m; is a position missing?"
        ]
    );
    assert!(read(EN_250, &[]).questions().is_empty());
}

#[test]
fn reductions_joined_by_plus_are_those_of_a_list() {
    let reductions = |value: &str| read(EN_250, &[&format!("model.reduce={value}")]).model.reductions;
    let expected = [Reduction::Linearised, Reduction::Window];
    for value in [
        "linearised+window",
        "\"linearised + window\"",
        "[\"linearised\", \"window\"]",
    ] {
        assert_eq!(reductions(value), expected, "{value}");
    }
}

#[test]
fn overrides_reach_every_kind_of_value() {
    let scene = read(
        EN_250,
        &[
            "run.speed_kmh=200",
            "coupling.algorithm=\"jacobi\"",
            "coupling.order=pantograph_first",
            "pantograph.0.static_force=100",
            "pantograph[1].masses[2]=14.5",
            "pantograph[1].strip.width=1.45",
            "catenary.stagger=[0.2, -0.2]",
            "run.allow_supercritical=true",
            "solver.newton_tolerance=1e-7",
            "run.evaluate.spans=[4, 4]",
            "title=A title = with signs",
            "pantograph[1].static_force=110",
        ],
    );
    assert_eq!(scene.run.speed, 200.0 / 3.6);
    assert_eq!(
        (scene.coupling.algorithm, scene.coupling.order),
        (Algorithm::Jacobi, Order::PantographFirst)
    );
    assert_eq!(lumped(&scene).static_force, 110.0, "the last override wins");
    assert_eq!((lumped(&scene).masses[1], lumped(&scene).strip.width), (14.5, 1.45));
    assert_eq!(
        (scene.run.allow_supercritical, scene.solver.newton_tolerance),
        (true, 1e-7)
    );
    assert_eq!(scene.run.evaluate, Evaluate::Spans { first: 4, last: 4 });
    assert_eq!(scene.title, "A title = with signs");
}

#[test]
fn a_quoted_key_of_an_override_may_hold_dots_and_signs() {
    let (before, rest) = EN_250.split_once("[[pantograph]]").unwrap();
    let after = &rest[rest.find("[coupling]").unwrap()..];
    let text = format!("{before}[[pantograph]]\nfmu = \"p.fmu\"\n{after}");
    let scene = read(&text, &["pantograph[1].parameters.\"static.force=\"=110"]);
    let PantographModel::Supplied(side) = &scene.pantographs[0].model else {
        panic!("somebody else's")
    };
    assert_eq!(side.parameters["static.force="], ParameterValue::Number(110.0));
    assert_eq!(read(&scene.to_toml(), &[]), scene);
}

#[test]
fn the_evaluation_range_follows_each_strip() {
    let pantograph = &EN_250[EN_250.find("[[pantograph]]").unwrap()..EN_250.find("[coupling]").unwrap()];
    let second = pantograph.replace("offset_x = 0.0", "offset_x = -18.0");
    let scene = read(&EN_250.replace("[coupling]", &format!("{second}[coupling]")), &[]);
    assert_eq!(
        (scene.evaluation_x(0), scene.evaluation_x(1)),
        ((240.0, 360.0), (240.0, 360.0))
    );
    let speed = 250.0 / 3.6;
    assert_eq!(scene.evaluation_time(0), (220.0 / speed, 340.0 / speed));
    assert_eq!(scene.evaluation_time(1), (238.0 / speed, 358.0 / speed));
    assert_eq!(scene.strip_start_x(1), 2.0);
    assert_eq!(scene.strip_x(0, 1.0), 20.0 + speed);
    let timed = read(EN_250, &["run.evaluate={ time = [2.0, 3.0] }"]);
    assert_eq!(timed.evaluation_x(0), (20.0 + speed * 2.0, 20.0 + speed * 3.0));
}

#[test]
fn a_sliding_joint_has_no_spring_and_is_written_as_it_is_read() {
    const JOINT: &str = include_str!("../../../scenes/thesis-sliding-joint.toml");
    let scene = read(JOINT, &[]);
    let contact = scene.contact.unwrap();
    assert_eq!(
        (contact.law, contact.stiffness, contact.damping),
        (ContactLaw::SlidingJoint, f64::INFINITY, 0.0)
    );
    let written = scene.to_toml();
    assert!(!written.contains("= inf"), "{written}");
    assert_eq!(read(&written, &[]), scene);
    // Nothing but the law is another than in the scene that it is compared with.
    let thesis = include_str!("../../../scenes/thesis.toml");
    let penalty = read(thesis, &["contact={law=\"sliding_joint\"}"]);
    let named = Scene {
        title: penalty.title.clone(),
        ..scene
    };
    assert_eq!(named, penalty);
    // What its mesh lacks has no spring to be in series with.
    let corrected = read(JOINT, &["catenary.mesh.corrections=\"auto\""]);
    assert!(
        !corrected.corrections().contains(&Correction::ContactCompliance)
            && corrected.corrections().contains(&Correction::BendingLayers)
    );
    let left_out = corrected.corrections_left_out();
    let reason = &left_out
        .iter()
        .find(|(correction, _)| *correction == Correction::ContactCompliance)
        .unwrap()
        .1;
    assert!(reason.contains("sliding_joint"), "{reason}");
    let with_correction = "catenary.mesh.corrections=[\"contact_compliance\"]".to_owned();
    let refused = Scene::from_toml(JOINT, "x.toml", &[with_correction])
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("must be left out: contact.law is \"sliding_joint\""),
        "{refused}"
    );
}

#[test]
fn supports_and_droppers_are_where_the_spans_put_them() {
    let scene = read(THESIS, &[]);
    let (catenary, contact) = scene.modelled_line().unwrap();
    assert_eq!((catenary.spans(), catenary.length()), (20, 1125.0));
    assert_eq!(catenary.supports_x().len(), 21);
    assert_eq!(catenary.supports_x()[3], 168.75);
    let droppers = catenary.droppers_x();
    assert_eq!((droppers.len(), droppers[0], droppers[8]), (160, 6.25, 62.5));
    assert_eq!(contact.stiffness, 50000.0);
    assert!(
        (catenary.contact_wire.wave_speed() - 124.5).abs() < 0.05,
        "the printed digits of the wave speed"
    );
}

#[test]
fn a_supercritical_run_is_accepted_where_it_is_asked_for() {
    let fast = ["run.speed_kmh=500", "run.duration=4", "run.allow_supercritical=true"];
    assert!(read(EN_250, &fast).run.speed > 121.7);
}

#[test]
fn a_scene_that_was_changed_can_be_checked_again() {
    let mut scene = read(EN_250, &[]);
    scene.check("x.toml").unwrap();
    scene.run.duration = 80.0;
    let error = scene.check("x.toml").unwrap_err().to_string();
    assert!(
        error.starts_with("x.toml: run.duration = 80 s: must be at most"),
        "{error}"
    );
}

#[test]
fn the_axis_of_every_bar_runs_through_its_joints() {
    let scene = read(THESIS, &[]);
    let PantographModel::Linkage(linkage) = &scene.pantographs[0].model else {
        panic!("a linkage")
    };
    let mut seen = 0;
    for body in linkage.bodies.iter().filter(|body| body.orientation != [0.0; 3]) {
        let rotation = body.rotation();
        for joint in linkage
            .joints
            .iter()
            .filter(|joint| joint.first == body.name || joint.second == body.name)
        {
            let arm = [0, 1, 2].map(|i| joint.point[i] - body.position[i]);
            let local = [0, 1, 2].map(|j| (0..3).map(|i| rotation[i][j] * arm[i]).sum::<f64>());
            // The tables print eight decimals of a metre.
            assert!(
                local[1].abs() < 2e-8 && local[2].abs() < 2e-8,
                "{} at {:?}: {local:?}",
                body.name,
                joint.point
            );
            assert!(local[0].abs() > 0.6);
            seen += 1;
        }
    }
    assert_eq!(seen, 10, "three joints on each arm, two on each link");
    assert_eq!(linkage.collector_guide().unwrap().second, "pan_head");
    let point = linkage.uplift_point().unwrap();
    assert!(
        (linkage.base[0] - point[0] - 0.8133).abs() < 1e-4,
        "0.8133 m from A, printed to four digits: {point:?}"
    );
}

#[test]
fn a_rotation_matrix_is_orthogonal_and_turns_about_minus_y_for_the_upper_bars() {
    let scene = read(THESIS, &[]);
    let PantographModel::Linkage(linkage) = &scene.pantographs[0].model else {
        panic!("a linkage")
    };
    let body = scene::Body {
        orientation: [0.3, 0.7, -1.1],
        ..linkage.bodies[0].clone()
    };
    let a = body.rotation();
    for i in 0..3 {
        for j in 0..3 {
            let product: f64 = (0..3).map(|k| a[k][i] * a[k][j]).sum();
            assert!((product - f64::from(u8::from(i == j))).abs() < 1e-15, "rounding");
        }
    }
    let upper_arm = linkage.body("upper_arm").unwrap();
    let (theta, a) = (upper_arm.orientation[1], upper_arm.rotation());
    for (value, expected) in [
        (a[0][0], theta.cos()),
        (a[2][0], theta.sin()),
        (a[0][2], -theta.sin()),
        (a[1][1], 1.0),
    ] {
        assert!((value - expected).abs() < 1e-15, "rounding");
    }
}

#[test]
fn exchange_keys_that_are_left_out_are_those_the_algorithm_uses() {
    for (algorithm, expected) in [
        ("jacobi", ("catenary_first", "mean", 1)),
        ("gauss_seidel", ("catenary_first", "mean", 1)),
        ("iterated", ("catenary_first", "mean", 1)),
        ("interface_jacobian", ("pantograph_first", "interpolated", 2)),
        ("auto", ("pantograph_first", "interpolated", 2)),
    ] {
        let scene = read(EN_250, &[&format!("coupling={{ algorithm = \"{algorithm}\" }}")]);
        let coupling = &scene.coupling;
        let found = (coupling.order.name(), coupling.force.name(), coupling.extrapolation);
        assert_eq!(found, expected, "{algorithm}");
    }
}

#[test]
fn a_mesh_takes_every_correction_that_it_can_have() {
    use scene::Correction;
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
    let long = ["solver.micro_step=1.3e-3", "coupling.macro_step=1.3e-3"];
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
            "internal steps of 2.0000 ms are longer than 1.2778 ms",
        ),
        (
            &[
                "catenary.contact_wire.bending_stiffness=0",
                "catenary.messenger_wire.bending_stiffness=0",
            ],
            Correction::BendingLayers,
            "both wires are strings",
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
        let reasons = scene.corrections_left_out();
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
fn the_internal_step_divides_the_macro_step() {
    for (overrides, step) in [
        (&[][..], 1e-3),
        (&["coupling.macro_step=0.0025"], 2.5e-3 / 3.0),
        (&["coupling.macro_step=0.0002"], 2e-4),
        (&["coupling.macro_step={tolerance=1.0}"], 1e-3),
        // Where all macro steps are shorter than the micro step, its half or quarter; but none below the shortest.
        (&["coupling.macro_step={tolerance=1.0, max=9e-4}"], 5e-4),
        (&["coupling.macro_step={tolerance=1.0, max=3e-4}"], 2.5e-4),
        (&["coupling.macro_step={tolerance=1.0, min=9e-4, max=9e-4}"], 1e-3),
    ] {
        assert_eq!(read(EN_250, overrides).internal_step(), step);
    }
}

#[test]
fn elements_are_no_longer_than_their_limit_and_an_override_takes_the_place_of_the_other_key() {
    let even = read(EN_300, &["catenary.mesh.element_length=0.93"]);
    let (line, _) = even.modelled_line().unwrap();
    assert_eq!(line.mesh.division, Division::UpTo(0.93));
    assert_eq!(elements(&even), 66);
    assert_eq!(line.shortest_element(), 5.0 / 6.0);
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
    // One element for each interval is enough for a long limit.
    assert_eq!(elements(&read(EN_300, &["catenary.mesh.element_length=1000"])), 10);
    // The mass correction takes steps up to a quarter of a wave's time through 5/6 m, 1.704 ms.
    let steps = |ms: &str| {
        let keys = [
            format!("solver.micro_step={ms}e-3"),
            format!("coupling.macro_step={ms}e-3"),
        ];
        read(EN_300, &["catenary.mesh.element_length=0.93", &keys[0], &keys[1]])
    };
    assert!(steps("1.70").corrections().contains(&Correction::MassCorrection));
    assert!(!steps("1.71").corrections().contains(&Correction::MassCorrection));
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
        let expected = scene.expected_mesh_error().unwrap();
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
        (Division::UpTo(0.8125), 76, 3, 1e-3)
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
        assert_eq!(scene, read(text, &["catenary.mesh={error_percent=1.0}"]));
        assert_eq!(read(&scene.to_toml(), &[]), scene);
    }
    // A division that is set takes the place of the choice.
    assert_eq!(
        elements(&read(&without, &["catenary.mesh.elements_per_interval=3"])),
        30
    );
    // A joint has a rule of its own.
    let joined = read(&without, &["contact={law=\"sliding_joint\"}"]);
    assert!(joined.expected_mesh_error().unwrap().total() <= 1.0);
    let refusal = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_string()).collect();
        Scene::from_toml(&without, "x.toml", &overrides)
            .unwrap_err()
            .to_string()
    };
    let slow = refusal(&["run.speed_kmh=30", "run.evaluate={time=[1,4]}"]);
    let told = "catenary.mesh is missing: must be a table with elements_per_interval or element_length, as none can be chosen for the \
                default error_percent = 1: no rule is known for run.speed_kmh = 30 km/h";
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
fn expected(text: &str, (kmh, hz): (f64, f64), more: &[&str]) -> scene::MeshError {
    let run = slow_run(kmh, hz);
    let run: Vec<&str> = run.iter().map(String::as_str).collect();
    read(text, &[&run[..], more].concat()).expected_mesh_error().unwrap()
}

#[test]
fn expected_errors_are_those_that_were_measured() {
    // Speed in km/h, filter in Hz, elements, step in ms, and the error measured against 16 corrected elements at 0.25 ms, %.
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
        let waves = (200.0 * mu.powi(4)).min(80.0 * mu.powi(2));
        assert!(
            (error.space / waves - 1.0).abs() < 1e-9,
            "{kmh} km/h, {hz} Hz: {error:?}, {waves}"
        );
        assert!(
            (error.time / (500.0 * (1e-3 * hz).powi(2)) - 1.0).abs() < 1e-9,
            "{error:?}"
        );
    }
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
        assert!(scene.expected_mesh_error().unwrap().total() <= error, "{macro_step}");
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
        ("0.0015", 0.75e-3),
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
        for_error(text, 1.0, &["coupling.macro_step=0.003"]).solver.micro_step,
        1e-3
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
    let time = |step: f64| scene.expected_mesh_error_at(step).unwrap().time;
    // 0.02 and 0.025 are the steps in periods of 20 Hz.
    assert!((time(1.25e-3) - 500.0 * 0.025_f64.powi(2)).abs() < 1e-12);
    assert!((time(1e-3) - (500.0 * 0.02_f64.powi(2) + 5000.0 * (0.025_f64.powi(2) - 0.02_f64.powi(2)))).abs() < 1e-12);
}

/// Everything that `[wind]` may hold beside the uplift.
const WIND: &str = "\
[wind]
speed = 20.5
yaw_deg = -35.0
air_density = 1.225
gust = { velocity = [0, 8, 0.5], start_x = 100, length = 60 }
turbulence = { spectrum = \"kaimal\", intensities = [0.15, 0.12, 0.08], length_scales = [120, 60, 20], coherence_decays = [10, 7, 7], seed = 4 }
record = [[0, 1, 2, 3, 100], [1, 1, 2, 3, 100]]
wires = { drag_coefficient = 1.2, contact_wire_diameter = 0.012, messenger_wire_diameter = 0.011 }

[[wind.pantograph.surfaces]]
body = \"pan_head\"
angles_deg = [-10, 0, 10]
drag = [0.06, 0.05, 0.06]
lift = [-0.02, 0.02, 0.05]
markers = [[0, 0.5, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5], [0, -0.5, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5]]

[[wind.pantograph.surfaces]]
body = \"upper_arm\"
drag = 0.07
lift = 0.02

[coupling]
";

#[test]
fn a_wind_survives_writing_and_pushes_the_line_sideways() {
    let scene = read(&THESIS.replacen("[coupling]\n", WIND, 1), &[]);
    let written = scene.to_toml();
    assert_eq!(read(&written, &[]), scene);
    assert_eq!(read(&written, &[]).to_toml(), written);
    assert!(!scene.model.has(Reduction::Planar) && scene.model.has(Reduction::Linkage));
    assert_eq!(
        scene.pushed_sideways().unwrap(),
        "wind.yaw_deg = -35 pushes the wires sideways"
    );
    let wind = scene.wind.as_ref().unwrap();
    assert_eq!(wind.turbulence.unwrap().time_step, 0.05);
    // It comes from the right, and blows to the left and against the train.
    let [x, y, z] = wind.mean_velocity();
    let (s, c) = 35_f64.to_radians().sin_cos();
    assert!((x + 20.5 * c).abs() < 1e-14 && (y - 20.5 * s).abs() < 1e-14 && z == 0.0); // rounding
    let ahead = "wind.yaw_deg=0";
    let still = read(
        &THESIS.replacen(
            "[coupling]\n",
            "[wind]\nspeed = 0\nyaw_deg = 0\nair_density = 1.2\n[coupling]\n",
            1,
        ),
        &[],
    );
    assert!(still.model.has(Reduction::Planar));
    // A head wind leaves the wires in their plane, a gust from the side does not.
    assert_eq!(
        read(&THESIS.replacen("[coupling]\n", WIND, 1), &[ahead])
            .pushed_sideways()
            .unwrap(),
        "wind.gust pushes the wires sideways"
    );
    let uplift = read(
        EN_250,
        &["wind={ speed = 0, yaw_deg = 0, air_density = 1.2, pantograph = { uplift = 0.0125 } }"],
    );
    assert_eq!(read(&uplift.to_toml(), &[]), uplift);
}
