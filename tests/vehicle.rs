//! The thesis with its vehicle, through the program: from wheel to wire, coupled and as one system.
use std::f64::consts::TAU;

use integration_tests::fmus::DEFAULT;
use integration_tests::runs::{Run, prepared, run, scene_with};
use nalgebra::{Complex, Matrix4, Vector4};
use simulation::{Mode, prepare};

/// Two and a half seconds; the force is looked at after the first.
const SHORT: [&str; 2] = ["run.duration=2.5", "run.evaluate={time=[1.0,2.5]}"];

fn short(mode: Mode, more: &[&str]) -> Run {
    run(scene_with(DEFAULT, &[&SHORT[..], more].concat()), mode, "vehicle")
}

#[test]
fn coupled_and_as_one_system_the_force_is_the_same() {
    let whole = short(Mode::Monolithic, &[]);
    let coupled = short(Mode::Inprocess, &[]);
    assert!(whole.summary.complete && coupled.summary.complete);
    let difference = whole.filtered_difference(&coupled) / whole.sigma();
    println!("{difference}");
    assert!(difference < 1e-3, "{difference}");
}

#[test]
fn coupled_and_as_one_system_sigma_is_the_same_and_shorter_macro_steps_come_closer() {
    // The shorter macro step on either side throughout, so that only the coupling differs.
    let micro = "solver.micro_step=5e-4";
    let more = ["run.duration=2.0", "run.evaluate={time=[0.5,2.0]}", micro];
    let of = |mode, keys: &[&str]| run(scene_with(DEFAULT, &[&more[..], keys].concat()), mode, "vehicle");
    let whole = of(Mode::Monolithic, &[]);
    // Second order but for droppers that go slack; and the scene's own choice, far below that at 1 ms.
    for (algorithm, closer, most) in [("gauss_seidel", 0.6, 1e-2), ("auto", 0.8, 5e-4)] {
        let [long, shorter] = ["1e-3", "5e-4"].map(|step| {
            let coupling = [
                format!("coupling.macro_step={step}"),
                format!("coupling.algorithm={algorithm}"),
            ];
            let coupled = of(Mode::Inprocess, &[&coupling[0], &coupling[1]]);
            let (sigma, expected) = (coupled.sigma(), whole.sigma());
            let apart = whole.raw_difference(&coupled);
            println!("{algorithm}, {step} s: σ {sigma:.4} N of {expected:.4} N, raw force {apart:.2e} N apart");
            // The bound of the project at 1 ms.
            assert!((sigma / expected - 1.0).abs() < 0.02, "{sigma} {expected}");
            apart / expected
        });
        assert!(shorter < closer * long, "{algorithm}: {shorter} {long}");
        assert!(long < most, "{algorithm}: {long} of σ");
    }
}

#[test]
fn fmus_of_the_full_scene_run_their_components_bit_for_bit() {
    let keys = ["run.duration=0.6", "run.evaluate={time=[0.1,0.5]}"];
    let [inside, outside] =
        [Mode::Inprocess, Mode::Cosimulation].map(|mode| run(scene_with(DEFAULT, &keys), mode, "vehicle"));
    assert_eq!(inside.record.time.len(), 601);
    assert_eq!(inside.record.pantographs, outside.record.pantographs);
    assert_eq!(inside.record.supports, outside.record.supports);
}

/// With index 1 joints open by the order of h², with index 3 they do not.
#[test]
fn the_augmented_formulation_of_a_scene_gives_the_force_of_the_default_one() {
    let of = |formulation: &str| {
        let formulation = format!("solver.formulation={formulation}");
        // All six bodies of the pantograph with their joints.
        let more = [
            "model.reduce=none",
            "run.duration=1.5",
            "run.evaluate={time=[0.2,1.4]}",
            &formulation,
        ];
        run(scene_with(DEFAULT, &more), Mode::Monolithic, "vehicle")
    };
    let (default, augmented) = (of("index_3"), of("index_1_baumgarte"));
    assert!(augmented.written.contains("formulation = \"index_1_baumgarte\""));
    let constraints = augmented.summary.model.constraints;
    let difference = default.raw_difference(&augmented);
    println!(
        "{constraints} constraints, σ {} N, raw rms {difference:e} N",
        default.sigma()
    );
    // 8 joints of the pantograph, 5 or 3 rows each, and the two of the vehicle.
    assert!(constraints > 40, "{constraints}");
    // Newton's method ends at 1e-4 N; another formulation is at work.
    assert!(difference > 0.0 && difference < 1e-3, "{difference}");
}

/// The run enters it after half a second and is in its arc from 2.4 s on; 7 cm of cant are missing.
const CURVE: &str = "track.curve={ radius = 1400.0, direction = \"left\", cant = 0.1, start = 75.0, \
                     transition = 75.0, length = 300.0, rounding = 6.0 }";

#[test]
fn coupled_and_as_one_system_the_force_is_the_same_in_a_curve() {
    let of = |mode| {
        let more = [CURVE, "run.duration=4.0", "run.evaluate={time=[1.0,4.0]}"];
        run(scene_with(DEFAULT, &more), mode, "vehicle")
    };
    let (whole, coupled) = (of(Mode::Monolithic), of(Mode::Inprocess));
    assert!(whole.summary.complete && coupled.summary.complete);
    let difference = whole.filtered_difference(&coupled) / whole.sigma();
    println!("{difference}");
    // The strip turns with the track while the exchanged motion says its roll, not its yaw.
    assert!(difference < 3e-3, "{difference}");
    let track = whole
        .summary
        .model
        .parts
        .iter()
        .find(|part| part.part == "track")
        .unwrap();
    for fragment in [
        "left curve from 75.0 to 525.0 m, radius 1400 m, cant 100 mm",
        "cant deficiency",
        "radial pull",
    ] {
        assert!(track.reason.contains(fragment), "{}", track.reason);
    }
}

#[test]
fn the_summary_says_what_of_vehicle_and_track_is_modelled() {
    let modelled = |overrides: &[&str]| {
        let model = prepared(scene_with(DEFAULT, overrides), "vehicle").model();
        ["vehicle", "wheel_rail", "track"].map(|name| {
            let part = model.parts.iter().find(|part| part.part == name).unwrap();
            assert!(!part.reason.is_empty());
            part.modelled
        })
    };
    assert_eq!(modelled(&[]), [true, true, true]);
    assert_eq!(modelled(&["vehicle.model=vertical"]), [true, false, true]);
}

#[test]
fn the_summary_says_which_curve_is_not_reached_and_where_wheels_do_not_roll_steadily() {
    let reason = |name: &str, overrides: &[&str]| {
        let model = prepared(scene_with(DEFAULT, overrides), "vehicle").model();
        let part = model.parts.into_iter().find(|part| part.part == name);
        part.unwrap().reason
    };
    // The base starts at 56.7 m, the foremost wheel 3.2 m ahead: in 2.5 s they come to 199 m.
    let far = |start: &str| CURVE.replace("start = 75.0", start);
    let not = "which the run does not reach: its foremost wheel or base comes to 19";
    let found = reason("track", &[SHORT[0], SHORT[1], &far("start = 215.0")]);
    assert!(found.contains(not) && !found.contains("deficiency"), "{found}");
    let found = reason("track", &[SHORT[0], SHORT[1], &far("start = 195.0")]);
    assert!(
        !found.contains("does not reach") && found.contains("deficiency"),
        "{found}"
    );
    // Rails that go to the left where the run starts.
    let bent = "track.irregularities={ model = \"points\", x = [30.0, 45.0, 55.0, 70.0], \
                y_left = [0.0, 2.5e-3, -2.5e-3, 0.0], y_right = [0.0, 2.5e-3, -2.5e-3, 0.0] }";
    assert_eq!(reason("wheel_rail", &[]), "wheels roll on rails");
    let found = reason("wheel_rail", &[bent]);
    assert!(found.contains("do not roll steadily where they start"), "{found}");
}

#[test]
fn on_smooth_track_the_vehicle_hardly_changes_the_contact_force() {
    let with = short(Mode::Monolithic, &[]);
    let text = include_str!("../scenes/thesis-pantograph.toml");
    let without = run(scene_with(text, &SHORT), Mode::Monolithic, "vehicle");
    // A base that gives way by 1.7 MN/m under a pantograph of a few kN/m.
    let difference = with.filtered_difference(&without) / without.sigma();
    assert!(difference > 0.0 && difference < 0.02, "{difference}");
}

/// The force on the base's own motion against that on the vehicle, in percent of σ, for columns of that motion.
#[test]
fn on_rough_track_a_given_motion_with_pitch_makes_the_force_of_the_vehicle() {
    const COLUMNS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];
    let rough = [
        "track.irregularities={ model = \"spectrum\", seed = 1, wavelengths = [3.0, 80.0], \
         vertical_roughness = 4.032e-7, lateral_roughness = 2.119e-7, corners = [0.0206, 0.8246, 0.4380], fade = 20.0 \
             }",
        "model.reduce=none",
    ];
    let scene = scene_with(DEFAULT, &[&SHORT[..], &rough].concat());
    let mut alone = prepared(scene.clone(), "vehicle").scene;
    alone.run.duration += 0.1;
    let mut side = vehicle::Subsystem::new(&alone, 0).unwrap();
    let rows: Vec<(f64, [f64; 6])> = (0..=510)
        .map(|i| {
            let time = f64::from(i) * 5e-3;
            let ([x, y, z], [roll, pitch, yaw]) = {
                let found = side.base_displaced();
                (found.displacement, found.angles)
            };
            side.advance_to(time, 5e-3).unwrap();
            (time, [x, y, z, roll, pitch, yaw])
        })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let full = run(scene, Mode::Monolithic, "vehicle");
    let error = |columns: &[&str]| {
        let places: Vec<usize> = (0..6).filter(|&i| columns.contains(&COLUMNS[i])).collect();
        let mut text = format!("time,{}\n", columns.join(","));
        for (time, values) in &rows {
            let cells: String = places.iter().map(|&i| format!(",{:?}", values[i])).collect();
            text.push_str(&format!("{time:?}{cells}\n"));
        }
        let path = folder.path().join("base.csv");
        std::fs::write(&path, text).unwrap();
        let motion = format!("vehicle={{ model = \"rigid_motion\", motion = {{ file = {path:?} }} }}");
        let plain = include_str!("../scenes/thesis-pantograph.toml");
        let given = scene_with(plain, &[&SHORT[..], &[&motion, "model.reduce=none"]].concat());
        let given = run(given, Mode::Monolithic, "vehicle");
        100.0 * full.filtered_difference(&given) / full.sigma()
    };
    let [without, turned, all] = [
        &["y", "z", "roll"][..],
        &["y", "z", "roll", "pitch"],
        &["x", "y", "z", "roll", "pitch", "yaw"],
    ]
    .map(error);
    println!("without pitch {without} %, with pitch alone {turned} %, all {all} %");
    // The rest is the effect of the contact force on the vehicle, as large on smooth track: 1.7 MN/m under a few kN/m.
    assert!(all < 0.05 && all < 0.02 * without, "{without} {turned} {all}");
}

#[test]
fn a_motion_from_a_file_is_that_of_the_same_lists() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..=100)
        .map(|i| {
            let t = f64::from(i) * 0.01;
            format!("{t:?},{:?}\n", 0.01 * (1.0 - (6.0 * t).cos()))
        })
        .collect();
    let path = folder.path().join("base.csv");
    std::fs::write(&path, format!("time,z\n{rows}")).unwrap();
    let text = include_str!("../scenes/thesis-pantograph.toml");
    let motion = format!("vehicle={{ model = \"rigid_motion\", motion = {{ file = {path:?} }} }}");
    let prepared = prepared(scene_with(text, &[&motion]), "vehicle");
    let Some(scene::Vehicle::RigidMotion(found)) = prepared.scene.vehicle.as_deref() else {
        panic!("a given motion");
    };
    assert_eq!(found.file, None);
    assert_eq!(found.time.len(), 101);
    assert_eq!(found.z[100], 0.01 * (1.0 - 6.0_f64.cos()));
    assert!(found.y.iter().all(|y| *y == 0.0));
    // The written scene holds the lists and needs no file.
    let again = scene_with(&prepared.scene.to_toml(), &[]);
    assert_eq!(again.vehicle, prepared.scene.vehicle);
}

/// Rise of a car body over that of the rails where all wheelsets go up and down alike with the angular frequency
/// `omega` (rad/s): car body and bolsters, frames, equalizers and wheelsets on the vertical springs and dampers of the
/// scene.
fn transfer_to_car_body(omega: f64) -> Complex<f64> {
    let masses = [24_170.0 + 2.0 * 1107.0, 2.0 * 3214.0, 4.0 * 469.0, 4.0 * 2091.0];
    let springs = [8.0 * 215e3, 8.0 * 1.22e6, 8.0 * 2e8, 8.0 * 1.2e9];
    let dampers = [4.0 * 20e3, 8.0 * 4e3, 8.0 * 20e3, 8.0 * 1e5];
    let link = |i: usize| Complex::new(springs[i], omega * dampers[i]);
    let mut dynamic = Matrix4::zeros();
    for i in 0..4 {
        dynamic[(i, i)] += link(i) - omega * omega * masses[i];
        if i < 3 {
            dynamic[(i + 1, i + 1)] += link(i);
            dynamic[(i, i + 1)] -= link(i);
            dynamic[(i + 1, i)] -= link(i);
        }
    }
    let excited = Vector4::new(Complex::ZERO, Complex::ZERO, Complex::ZERO, link(3));
    dynamic.lu().solve(&excited).unwrap()[0]
}

/// `A sin(ω t) + B cos(ω t)` in a series of `step` (s) over whole periods: A and B.
fn harmonic(series: &[f64], omega: f64, start: f64, step: f64) -> [f64; 2] {
    let n = series.len() as f64;
    let mean = series.iter().sum::<f64>() / n;
    let mut found = [0.0; 2];
    for (i, value) in series.iter().enumerate() {
        let (sine, cosine) = (omega * (start + i as f64 * step)).sin_cos();
        found[0] += 2.0 / n * (value - mean) * sine;
        found[1] += 2.0 / n * (value - mean) * cosine;
    }
    found
}

const COLUMNS: &str = "x,z_left,z_right\n";

/// The bogies are in phase if their distance is a wavelength; the wheelsets of each stand 2.5908 m apart, which leaves
/// `cos(π 2.5908 m/λ)` of the wave for its middle.
#[test]
fn on_a_measured_sine_the_car_body_heaves_with_v_over_the_wavelength_as_its_springs_let_it() {
    const AMPLITUDE: f64 = 3e-3;
    const STEP: f64 = 1e-3;
    let wavelength = 12.573_f64;
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..=2000)
        .map(|i| {
            let x = f64::from(i) * 0.2;
            let rise = AMPLITUDE * (TAU * x / wavelength).sin();
            format!("{x:?},{rise:?},{rise:?}\n")
        })
        .collect();
    std::fs::write(folder.path().join("rails.csv"), format!("# measured\n{COLUMNS}{rows}")).unwrap();
    let file = "track.irregularities={ model = \"points\", file = \"rails.csv\" }";
    // Below the bounce at 1.15 Hz, near it, and above it.
    for (model, hertz) in [("vertical", 0.6), ("vertical", 1.3), ("vertical", 3.0), ("full", 1.3)] {
        let omega = TAU * hertz;
        let speed = wavelength * hertz;
        let keys = [
            file.to_owned(),
            format!("vehicle.model={model}"),
            format!("run.speed_kmh={:?}", 3.6 * speed),
        ];
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        let scene = prepare(scene_with(DEFAULT, &keys), "rails", folder.path(), false)
            .unwrap()
            .scene;
        let mut side = vehicle::Subsystem::new(&scene, 0).unwrap();
        // The middle of the vehicle is in front of the base.
        let ahead = 11.950_053_78 - 7.5819;
        let middle = side.base().position.x - ahead;
        // The transient of the start decays with 1.4 1/s and more; then three periods.
        let (settle, periods) = ((6.0 / STEP) as usize, (3.0 / hertz / STEP).round() as usize);
        let mut heave = Vec::with_capacity(periods);
        for n in 0..settle + periods {
            side.advance_to(n as f64 * STEP, STEP).unwrap();
            if n >= settle {
                // Bogies that pitch on the wave pull at the car body below its centre of mass, which pitches it.
                let pitch = side.base_angles()[1];
                heave.push(side.base().position.z + ahead * pitch);
            }
        }
        let [sine, cosine] = harmonic(&heave, omega, (settle + 1) as f64 * STEP, STEP);
        // The wave under the middle is that of both bogies but for the sign of half a wavelength.
        let bogies = -AMPLITUDE * (std::f64::consts::PI * 2.5908 / wavelength).cos();
        let phase = TAU * middle / wavelength;
        let excited = Complex::from_polar(bogies, phase);
        let found = Complex::new(sine, cosine) / excited;
        let expected = transfer_to_car_body(omega);
        println!("{model}, {hertz} Hz: {found:.4} of {expected:.4}");
        assert!(
            (found - expected).norm() < 0.01 * expected.norm(),
            "{model}, {hertz} Hz: {found} {expected}"
        );
    }
}

#[test]
fn measured_rails_that_make_no_sense_are_refused_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |text: Option<&str>| {
        if let Some(text) = text {
            std::fs::write(folder.path().join("rails.csv"), text).unwrap();
        }
        let file = "track.irregularities={ model = \"points\", file = \"rails.csv\" }";
        match prepare(scene_with(DEFAULT, &[file]), "scene.toml", folder.path(), false) {
            Ok(_) => "accepted".to_owned(),
            Err(error) => error.to_string(),
        }
    };
    let key = "track.irregularities.file = \"rails.csv\": ";
    for (text, expected) in [
        (None, "cannot be read: "),
        (Some("x,z_left\n0,0\n1,0,0\n"), "line 3 has 3 entries, must have 2"),
        (
            Some("x,z_left\n0,0\n1,high\n"),
            "line 3, z_left: \"high\" must be a finite number",
        ),
        (
            Some("x,z_left\n0,0\nnan,0\n"),
            "line 3, x: \"nan\" must be a finite number",
        ),
        (
            Some("x,left\n0,0\n"),
            "column \"left\": unknown; known columns: x, z_left, z_right, y_left, y_right",
        ),
        (Some("z_left\n0\n"), "must have a column \"x\""),
        (Some("x,z_left\n"), "has no rows"),
    ] {
        let found = refusal(text);
        assert!(found.starts_with(&format!("{key}{expected}")), "{text:?}: {found}");
    }
    let back = refusal(Some("x,z_left\n0,0\n2,0\n1,0\n"));
    println!("{back}");
    assert!(back.contains("track.irregularities.x"), "{back}");
    assert_eq!(refusal(Some("x,z_left\n0,0\n1000,0\n")), "accepted");
}
