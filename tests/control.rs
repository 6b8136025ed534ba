//! Controlled pantographs: against linear theory on a rigid wire, between the modes, and by what control is for.
use component::Component;
use control::SampledLoop;
use dynamics::{Blocks, Columns, Force, Layout, Marker, Motion, NewtonOptions, Simulator, State, Weights};
use integration_tests::runs::{EN_250, Run, prepared, run, scene_with};
use integration_tests::under_wire::UnderWire;
use nalgebra::{Complex, DMatrix, Vector3};
use scene::{PantographModel as Entry, Scene};
use simulation::Mode;
use system::one_system::stepped::SteppedSystem;
use vehicle::{PantographModel, Subsystem};

/// Stiffness of the wire, N/m: of the order of a line's.
const WIRE: f64 = 3000.0;

/// A wire without mass over the head: presses with `force − k (z − z₀)`, N.
struct Wire {
    head: Box<dyn Marker>,
    height: f64,
    force: f64,
}

impl Force for Wire {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let pressed = self.pressed(motion);
        let mut columns = Columns::default();
        self.head.columns(motion, &mut columns);
        columns.add_force(&Vector3::new(0.0, 0.0, -pressed), &Vector3::zeros(), force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let mut columns = Columns::default();
        self.head.columns(motion, &mut columns);
        let columns = columns.as_slice();
        let indices: Vec<usize> = columns.iter().map(|column| column.index).collect();
        let products = columns.iter().flat_map(|row| {
            columns
                .iter()
                .map(move |column| weights.q * WIRE * row.translation.z * column.translation.z)
        });
        let values: Vec<f64> = products.collect();
        blocks.add(&indices, &indices, &values);
    }
}

impl Wire {
    fn pressed(&self, motion: &Motion<'_>) -> f64 {
        self.force + WIRE * self.rise(motion)
    }

    fn rise(&self, motion: &Motion<'_>) -> f64 {
        self.head.frame(motion).position.z - self.height
    }
}

fn controlled(control: &str) -> Scene {
    let keys = [
        "pantograph[1].reference_height=5.3",
        &format!("pantograph[1].control={control}"),
    ];
    scene_with(EN_250, &keys)
}

/// Simulator at `deviation` from rest, with internal steps of `step` s, and its controllers.
fn simulator(scene: &Scene, deviation: &[f64], step: f64) -> (Simulator<UnderWire<Wire>>, Vec<control::Channel>) {
    let mut layout = Layout::new();
    let (mut model, rest) = PantographModel::started(scene, 0, &mut layout).unwrap();
    let channel = model.controlled(scene, 0, rest.force, 0).unwrap();
    let mut state: State = layout.state_at_rest();
    model.set_initial(&rest, &mut state);
    let n = state.q.len();
    for i in 0..n {
        state.q[i] += deviation[i];
        state.v[i] += deviation[n + i];
    }
    let wire = Wire {
        head: model.strip(),
        height: rest.height,
        force: rest.force,
    };
    let system = UnderWire { layout, model, wire };
    let options = NewtonOptions {
        tolerance: 1e-11,
        ..NewtonOptions::default()
    };
    let mut simulator = Simulator::new(system, state, vec![0.0], step, 1.0, options);
    simulator.start_accelerations().unwrap();
    (simulator, channel.into_iter().collect())
}

fn advance(
    simulator: &mut Simulator<UnderWire<Wire>>,
    channels: &mut [control::Channel],
    t: f64,
    h: f64,
    seen: &mut dyn FnMut(f64),
) {
    control::advance(
        simulator,
        channels,
        (t, h),
        &mut |_, _| {},
        &mut |system, (motion, state), _, reading| {
            system.model.read(&motion, &state.v_dot, reading);
            reading.force = system.wire.pressed(&motion);
        },
        &mut |system, (motion, ..)| seen(system.wire.rise(&motion)),
    )
    .unwrap();
}

fn linear(scene: &Scene) -> SampledLoop {
    let pantograph = &scene.pantographs[0];
    let Entry::Lumped(lumped) = &pantograph.model else {
        panic!("a lumped pantograph")
    };
    SampledLoop::new(pantograph.control.as_ref().unwrap(), lumped, WIRE).unwrap()
}

#[test]
fn the_poles_of_a_simulated_loop_are_those_of_theory() {
    for control in [
        "{ law=\"lqr\", sample_time=0.01, effort_weight=0.5, wire_stiffness=3000 }",
        "{ law=\"skyhook\", sample_time=0.01, damping=300 }",
    ] {
        let scene = controlled(control);
        let n = 2;
        let mut over_sample = DMatrix::zeros(2 * n, 2 * n);
        for column in 0..2 * n {
            let mut deviation = vec![0.0; 2 * n];
            deviation[column] = 1e-3;
            let (mut simulator, mut channels) = simulator(&scene, &deviation, 1e-5);
            advance(&mut simulator, &mut channels, 0.0, 0.01, &mut |_| {});
            let (rest, _) = self::simulator(&scene, &[0.0; 4], 1e-5);
            let (now, rest) = (simulator.state(), rest.state());
            for i in 0..n {
                over_sample[(i, column)] = (now.q[i] - rest.q[i]) / 1e-3;
                over_sample[(n + i, column)] = now.v[i] / 1e-3;
            }
        }
        let expected = linear(&scene).poles();
        for pole in over_sample.complex_eigenvalues().iter() {
            let distance = |other: &Complex<f64>| (pole - other).norm();
            let nearest = expected.iter().map(distance).fold(f64::INFINITY, f64::min);
            // The error of the integrator is (ω h)²/12 of the fastest motion.
            assert!(nearest < 1e-6, "{control}: {pole} is {nearest:.1e} from {expected:?}");
        }
    }
}

#[test]
fn the_delay_that_makes_a_simulated_loop_unstable_is_that_of_theory() {
    let pid = |delay: f64| {
        controlled(&format!(
            "{{ law=\"pid\", sample_time=0.02, kp=1.5, actuator={{ delay={delay} }} }}"
        ))
    };
    let margin = linear(&pid(0.0)).delay_margin();
    assert!(
        margin > 0.002 && margin < 0.019,
        "a delay that a scene may have: {margin}"
    );
    let (below, beyond) = (growth(&pid(0.97 * margin), 0.02), growth(&pid(1.03 * margin), 0.02));
    assert!(below < 1.0 && beyond > 1.0, "{below} {beyond}");
}

/// Largest rise of the head in the last third of 900 samples by that in the second third, from a small motion.
fn growth(scene: &Scene, sample: f64) -> f64 {
    let (mut simulator, mut channels) = simulator(scene, &[1e-3, 0.0, 0.0, 0.0], 5e-4);
    let mut largest = |from: usize, to: usize| {
        let mut most = 0.0_f64;
        for number in from..to {
            let t = sample * number as f64;
            advance(&mut simulator, &mut channels, t, sample, &mut |rise| {
                most = most.max(rise.abs())
            });
        }
        most
    };
    largest(0, 300);
    let (early, late) = (largest(300, 600), largest(600, 900));
    late / early
}

#[test]
fn the_delay_that_makes_the_loop_of_a_linkage_unstable_is_that_of_its_linear_motions() {
    let line = include_str!("../scenes/thesis-pantograph.toml");
    let sample = 0.02;
    // Joints and links of the mechanism have no dampers: a proportional controller alone is unstable.
    for law in [
        "law=\"pid\", kp=2.4, kd=0.48, derivative_lag=0.05, sample_time=0.02, actuator={ delay=D }",
        "law=\"pid\", kp=2.4, kd=0.48, derivative_lag=0.05, sample_time=0.02, \
         actuator={ joint=\"base-lower_arm\", delay=D }",
        "law=\"skyhook\", damping=3000, sample_time=0.02, actuator={ joint=\"lower_arm-upper_arm\", delay=D }",
    ] {
        let scene = |delay: f64| {
            let control = law.replace('D', &delay.to_string());
            let control = format!("pantograph[1].control={{ {control} }}");
            scene_with(
                line,
                &["model.reduce=[\"linkage\"]", "run.initialise=\"as_given\"", &control],
            )
        };
        let linear = PantographModel::linearised(&scene(0.0), 0).unwrap().unwrap();
        let control = scene(0.0).pantographs[0].control.clone().unwrap();
        let margin = SampledLoop::of(&control, &linear, WIRE).unwrap().delay_margin();
        assert!(
            margin > 0.002 && margin < 0.019,
            "{law}: a delay that a scene may have: {margin}"
        );
        let (below, beyond) = (
            growth(&scene(0.97 * margin), sample),
            growth(&scene(1.03 * margin), sample),
        );
        assert!(below < 1.0 && beyond > 1.0, "{law}: {margin} {below} {beyond}");
    }
}

/// Three spans of the reference model on a coarse mesh.
const SHORT: [&str; 5] = [
    "catenary.spans=4",
    "catenary.mesh.elements_per_interval=2",
    "run.duration=2.4",
    "run.evaluate={time=[0.4,2.3]}",
    "run.start_x=20",
];

fn short(mode: Mode, control: &str) -> Run {
    let control = format!("pantograph[1].control={control}");
    let keys = [&SHORT[..], &[control.as_str()]].concat();
    run(scene_with(EN_250, &keys), mode, "control")
}

#[test]
fn co_simulation_controls_as_one_system_does() {
    for control in [
        "{ law=\"pid\", sample_time=0.005, kp=0.7, ki=1, actuator={ lag=0.01, delay=0.002, limit=60 }, \
         sensors={ delay=0.001, force_noise=1 } }",
        // Samples within and beyond the macro steps.
        "{ law=\"skyhook\", sample_time=0.0035, damping=200, actuator={ rate_limit=2000 } }",
        "{ law=\"lqr\", sample_time=0.004, effort_weight=0.5, wire_stiffness=3000 }",
    ] {
        let (one, coupled) = (short(Mode::Monolithic, control), short(Mode::Inprocess, control));
        let drive = |run: &Run| run.record.pantographs[0].control.clone().unwrap();
        let largest = drive(&one).iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        assert!(largest > 5.0, "the drive acts: {largest}");
        let difference = (coupled.sigma() / one.sigma() - 1.0).abs();
        assert!(difference < 0.005, "{control}: {difference}");
    }
}

#[test]
fn co_simulation_drives_a_joint_as_one_system_does() {
    let line = include_str!("../scenes/thesis-pantograph.toml");
    let control = "pantograph[1].control={ law=\"skyhook\", sample_time=0.005, damping=700, \
                   actuator={ joint=\"base-lower_arm\", lag=0.01, limit=80 }, sensors={ delay=0.001 } }";
    let keys = [
        "catenary.spans=4",
        "run.duration=2",
        "run.evaluate={time=[0.4,1.9]}",
        control,
    ];
    let [one, coupled] = [Mode::Monolithic, Mode::Inprocess].map(|mode| run(scene_with(line, &keys), mode, "joint"));
    let moment = one.record.pantographs[0].control.as_ref().unwrap();
    assert!(moment.iter().any(|moment| moment.abs() > 5.0), "the drive acts");
    let difference = (coupled.sigma() / one.sigma() - 1.0).abs();
    assert!(difference < 0.005, "{difference}");
}

#[test]
fn a_controlled_pantograph_goes_back_to_a_kept_state_bit_for_bit() {
    let scene = controlled(
        "{ law=\"pid\", sample_time=0.003, kp=0.7, ki=1, kd=0.002, actuator={ lag=0.01, delay=0.002 }, \
         sensors={ force_noise=1 } }",
    );
    let mut side = Subsystem::build(&scene).unwrap();
    let signals = Subsystem::signals(&scene);
    let place = |name: &str| signals.iter().position(|signal| signal.name == name).unwrap();
    let (load, drive, z) = (
        place("contact[1].fz"),
        place("strip[1].control.force"),
        place("strip[1].z"),
    );
    let start = side.input(load);
    let steps = |side: &mut Subsystem, from: usize| -> Vec<[u64; 2]> {
        let step = |n: usize| {
            side.set_input(load, start - 20.0 * (n as f64).sin());
            side.do_step(1e-3 * n as f64, 1e-3).unwrap();
            [drive, z].map(|signal| side.output(signal).to_bits())
        };
        (from..from + 20).map(step).collect()
    };
    steps(&mut side, 0);
    let mut kept = vehicle::Checkpoint::default();
    side.save(&mut kept);
    let first = steps(&mut side, 20);
    side.restore(&kept).unwrap();
    assert_eq!(first, steps(&mut side, 20));
    assert!(
        first.iter().any(|values| f64::from_bits(values[0]).abs() > 1.0),
        "the drive acts"
    );
}

/// Values of a signal at the end of every macro step of one system; `command` may give the drive a command before each
/// step from the contact force.
fn stepped(control: &str, command: &mut dyn FnMut(f64) -> Option<f64>) -> Vec<u64> {
    let control = format!("pantograph[1].control={control}");
    let scene = scene_with(EN_250, &[&SHORT[..], &[control.as_str()]].concat());
    let prepared = prepared(scene, "given");
    let statics = prepared.statics.as_deref().unwrap();
    let mut system = SteppedSystem::new(&prepared.scene, statics, &[]).unwrap();
    let place = |system: &SteppedSystem, name: &str| system.signals().iter().position(|signal| signal.name == name);
    let force = place(&system, "contact[1].fz").unwrap();
    let given = place(&system, "pantograph[1].control.force");
    (0..300)
        .map(|_| {
            let pressed = -system.value(force);
            if let (Some(command), Some(given)) = (command(pressed), given) {
                system.set(given, command);
            }
            system.advance().unwrap();
            system.value(force).to_bits()
        })
        .collect()
}

#[test]
fn commands_from_outside_do_what_the_same_rule_inside_does() {
    let inside = "{ law=\"pid\", sample_time=0.001, kp=0.5, force=110, actuator={ lag=0.01 } }";
    let outside = "{ law=\"given\", sample_time=0.001, actuator={ lag=0.01 } }";
    let expected = stepped(inside, &mut |_| None);
    let found = stepped(outside, &mut |force| Some(0.5 * (110.0 - force)));
    assert_eq!(found, expected, "bit for bit");
    assert_ne!(found, stepped(outside, &mut |_| None));
}

#[test]
fn a_loop_that_runs_away_is_told_before_and_after_and_its_results_are_kept() {
    let away = short(
        Mode::Monolithic,
        "{ law=\"pid\", sample_time=0.02, kp=8, actuator={ limit=400 } }",
    );
    let notes = away.summary.notes.join("\n");
    for said in [
        "pantograph[1].control: the loop is unstable",
        "at its limit",
        "has run away",
        "smaller gains",
    ] {
        assert!(notes.contains(said), "nothing about {said:?}: {notes}");
    }
    assert!(
        away.summary.complete && away.record.time.len() > 1000,
        "results are kept"
    );
    let calm = short(Mode::Monolithic, "{ law=\"skyhook\", sample_time=0.005, damping=100 }");
    let notes = calm.summary.notes.join("\n");
    assert!(
        !notes.contains("run away") && notes.contains("the loop is stable"),
        "{notes}"
    );
}

#[test]
fn control_makes_the_force_on_the_thesis_line_steadier() {
    let line = include_str!("../scenes/thesis-lumped.toml");
    let sigma = |control: Option<&str>| {
        let keys = [
            "run.duration=5",
            "run.evaluate={time=[1.5,4.8]}",
            "run.output_step=0.002",
        ];
        let control = control.map(|control| format!("pantograph[1].control={control}"));
        let keys: Vec<&str> = keys.into_iter().chain(control.as_deref()).collect();
        let run = run(scene_with(line, &keys), Mode::Monolithic, "thesis");
        (run.sigma(), run.statistics().mean)
    };
    let (without, mean) = sigma(None);
    let pid = "{ law=\"pid\", sample_time=0.005, force=106.7, kp=0.3, ki=0.05, kd=0.05, derivative_lag=0.06, \
               actuator={ lag=0.01 }, sensors={ delay=0.001 } }";
    let (by_pid, mean_by_pid) = sigma(Some(pid));
    assert!(by_pid < 0.9 * without, "{by_pid} {without}");
    assert!(mean_by_pid <= mean, "{mean_by_pid} {mean}");
    let regulated = "{ law=\"lqr\", sample_time=0.005, effort_weight=0.5, wire_stiffness=3000, velocity_weight=1e4, \
                     actuator={ lag=0.01 } }";
    let (with, mean_with) = sigma(Some(regulated));
    assert!(with < 0.92 * without, "{with} {without}");
    assert!(mean_with <= mean, "{mean_with} {mean}");
}

#[test]
fn signals_of_a_drive_on_a_joint_have_the_units_of_a_moment() {
    let line = include_str!("../scenes/thesis-pantograph.toml");
    let control = "pantograph[1].control={ law=\"given\", sample_time=0.005, actuator={ joint=\"base-lower_arm\" } }";
    let scene = scene_with(line, &[control]);
    for (name, unit) in [
        ("control.force", "N.m"),
        ("strip[1].control.force", "N.m"),
        ("control.measured.force", "N"),
        ("control.measured.velocity", "rad/s"),
        ("control.measured.position", "rad"),
        ("control.measured.head_velocity", "m/s"),
    ] {
        let signal = Subsystem::signals(&scene)
            .into_iter()
            .find(|signal| signal.name == name);
        assert_eq!(signal.unwrap().kind, component::SignalKind::Real(unit), "{name}");
    }
    // Positive moments turn the joint to the side of positive readings, where the strip is higher.
    let after = |moment: f64| {
        let mut side = Subsystem::build(&scene).unwrap();
        let signals = Subsystem::signals(&scene);
        let place = |name: &str| signals.iter().position(|signal| signal.name == name).unwrap();
        side.set_input(place("control.force"), moment);
        for step in 0..20 {
            side.do_step(5e-3 * f64::from(step), 5e-3).unwrap();
        }
        assert_eq!(side.output(place("strip[1].control.force")), moment);
        ["control.measured.position", "strip[1].z"].map(|name| side.output(place(name)))
    };
    let [up, down] = [after(40.0), after(-40.0)];
    assert!(up[0] > down[0] && up[1] > down[1], "{up:?} {down:?}");
}
