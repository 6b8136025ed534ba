//! A scene that is read is the one that was typed, and a written one reads again as the same.

use scene::{
    Algorithm, ContactLaw, Evaluate, Files, Force, Line, Offset, Order, PantographModel, ParameterValue, Reduction,
    Scene, SceneFile, Start, Statics, Wire,
};

const EN_250: &str = include_str!("../../../scenes/en50318-250.toml");
const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");
const THESIS: &str = include_str!("../../../scenes/thesis-pantograph.toml");
const VEHICLE: &str = include_str!("../../../scenes/thesis-own-mesh.toml");

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
            let origin = path.display().to_string();
            let files = Files::new(|file| {
                std::fs::read_to_string(format!("{folder}/{file}")).map_err(|error| error.to_string())
            });
            let read = SceneFile::read(&text, &origin, &[], &files);
            let read = read.and_then(|file| file.check(&|_| Vec::new()).map(|()| file.scene));
            let scene = read.unwrap_or_else(|error| panic!("{error}"));
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
    let motion = "vehicle={ model = \"rigid_motion\", motion = { time = [0.0, 0.5], z = [0.0, 0.01], roll = [0.0, \
                  -0.1], \
         pitch = [2e-3, -1e-3], x = [0.0, 0.03], yaw = [1e-3, 0.0] } }";
    let spectrum = "track.irregularities={ model = \"spectrum\", seed = 7, wavelengths = [3.0, 80.0], \
                    vertical_roughness = 4.032e-7, lateral_roughness = 2.119e-7, corners = [0.0206, 0.8246, 0.4380], \
                    fade = 20.0 }";
    let points =
        "track.irregularities={ model = \"points\", x = [0.0, 10.0], z_left = [0.0, 0.01], z_right = [0.0, 0.02] }";
    let file = "track.irregularities={ model = \"points\", file = \"track.csv\" }";
    let curve = "track.curve={ radius = 1500.0, direction = \"left\", cant = 0.1, start = 100.0, transition = 80.0, \
                 length = 200.0, \
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
            "track.irregularities={{ model = \"points\", x = [0.0, 10.0], z_left = [0.0, 0.01], z_right = [0.0, \
             {right}] }}"
        )
    };
    assert!(planar(&[]));
    assert!(planar(&[&bump("0.01")]));
    assert!(!planar(&[&bump("0.02")]));
    assert!(!planar(&[
        "track.curve={ radius = 1500.0, direction = \"left\", cant = 0.0, start = 100.0, transition = 80.0, length = \
         200.0, \
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
            "catenary.contact_wire.diameter=0.0132",
            "catenary.tensioning={ friction = 0.03, travel = 2.5 }",
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
    assert_eq!(catenary.first().stagger_at(3), -0.2);
    assert_eq!(lumped(&scene).friction, [0.0, 2.5]);
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
        panic!("a supplied FMU")
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
    let named = read(EN_250, &["coupling.algorithm=jacobi"]);
    assert_eq!(named.coupling.algorithm, Algorithm::Jacobi);
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
            "catenary.droppers.positions = [5.0, 23.0, 41.0, 55.0] m: 18 m of span 1, from 5 m to 23 m, are without a \
             dropper, and lines \
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
        panic!("a supplied FMU")
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
    let thesis = include_str!("../../../scenes/thesis-own-mesh.toml");
    let penalty = read(thesis, &["contact={law=\"sliding_joint\"}"]);
    let named = Scene {
        title: penalty.title.clone(),
        ..scene
    };
    assert_eq!(named, penalty);
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
fn waves_of_a_wire_obey_its_law() {
    // A string, a wire that bends, and one that hardly does anything else: m ω² = T k² + EI k⁴ with k = ω/c.
    for (bending_stiffness, omega) in [(0.0, 500.0), (131.0, 1000.0), (131.0, 1e6)] {
        let wire = Wire::new(1.35, 2.0e4, 1.7e7, bending_stiffness);
        let wave_number = omega / wire.phase_speed(omega);
        let pulled = 2.0e4 * wave_number.powi(2) + bending_stiffness * wave_number.powi(4);
        assert!(
            (pulled / (1.35 * omega * omega) - 1.0).abs() < 1e-12,
            "{bending_stiffness}"
        );
    }
    let string = Wire::new(1.35, 2.0e4, 1.7e7, 0.0);
    assert!((string.phase_speed(9.0) / string.wave_speed() - 1.0).abs() < 1e-15);
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

/// Everything that `[wind]` may hold beside the uplift.
const WIND: &str = "\
[wind]
speed = 20.5
yaw_deg = -35.0
air_density = 1.225
gust = { velocity = [0, 8, 0.5], start_x = 100, length = 60 }
turbulence = { spectrum = \"kaimal\", intensities = [0.15, 0.12, 0.08], length_scales = [120, 60, 20], \
                            coherence_decays = [10, 7, 7], seed = 4 }
record = [[0, 1, 2, 3, 100], [1, 1, 2, 3, 100]]
wires = { drag_coefficient = 1.2, contact_wire_diameter = 0.012, messenger_wire_diameter = 0.011, \
          dropper_diameter = 0.005, registration_arm_drag_area = 0.03, \
          contact_wire_polar = { angles_deg = [-90, 0, 90], drag = [2, 1, 2], lift = [1, 0, -1] } }

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

#[test]
fn weather_survives_writing_and_a_thickness_holds_for_all_wires() {
    let change = "catenary.change={ temperature = [-20, 5], ice = { thickness = 0.01, messenger_wire = 0.02 } }";
    let diameters = [
        "catenary.contact_wire.diameter=0.012",
        "catenary.messenger_wire.diameter=0.014",
    ];
    let scene = read(EN_250, &[change, diameters[0], diameters[1]]);
    let line = scene.modelled_line().unwrap().0;
    let change = line.change.as_ref().unwrap();
    assert_eq!(change.temperature, [-20.0, 5.0]);
    let ice = change.ice.unwrap();
    assert_eq!((ice.contact_wire, ice.messenger_wire, ice.density), (0.01, 0.02, 900.0));
    // A ring of ice: π ((r + t)² − r²) ρ.
    let ring =
        |radius: f64, thickness: f64| std::f64::consts::PI * 900.0 * ((radius + thickness).powi(2) - radius.powi(2));
    assert!((line.ice_on(scene::WireKind::Contact) - ring(0.006, 0.01)).abs() < 1e-12); // rounding
    assert!((line.ice_on(scene::WireKind::Messenger) - ring(0.007, 0.02)).abs() < 1e-12); // rounding
    assert_eq!(read(&scene.to_toml(), &[]), scene);
}
