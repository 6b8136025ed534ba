//! Co-simulation against the same equations as one system: the difference is the error of the coupling.
use integration_tests::runs::{EN_250, EN_300, Run, prepared, rms, run, scene_with};
use simulation::Mode;

/// Four spans of the reference model on a coarse mesh, which does not enter the error of the coupling. At this speed
/// contact is never lost, so that the orders are those of smooth motion but for droppers that go slack.
const SHORT: [&str; 5] = [
    "catenary.spans=4",
    "catenary.mesh.elements_per_interval=2",
    "run.duration=1.8",
    "run.evaluate={time=[0.3,1.7]}",
    "run.start_x=30",
];

fn short(mode: Mode, more: &[&str]) -> Run {
    run(scene_with(EN_250, &[&SHORT[..], more].concat()), mode, "coupling")
}

/// `[coupling]` as overrides.
fn coupling(algorithm: &str, force: &str, extrapolation: usize) -> [String; 3] {
    [
        format!("coupling.algorithm=\"{algorithm}\""),
        format!("coupling.force=\"{force}\""),
        format!("coupling.extrapolation={extrapolation}"),
    ]
}

/// Slope of a straight line through the logarithms of errors at steps that double.
fn order(errors: &[f64]) -> f64 {
    let middle = 0.5 * (errors.len() - 1) as f64;
    let (mut along, mut square) = (0.0, 0.0);
    for (i, error) in errors.iter().enumerate() {
        along += (i as f64 - middle) * error.log2();
        square += (i as f64 - middle).powi(2);
    }
    along / square
}

/// Convergence of one coupling to the monolithic run, both sides at the smallest macro step throughout.
struct Convergence {
    /// rms of the filtered force, % of σ, smallest step first.
    filtered: Vec<f64>,
    /// rms of the raw force at the communication points of the longest step, % of σ.
    raw: Vec<f64>,
}

impl Convergence {
    /// Macro steps `smallest`, twice, four and eight times that, s.
    fn of(algorithm: &str, force: &str, extrapolation: usize, smallest: f64) -> Self {
        let micro = format!("solver.micro_step={smallest}");
        let truth = short(Mode::Monolithic, &[&micro]);
        assert_eq!(
            truth.summary.pantographs[0].contact_force.loss_of_contact_percent,
            Some(0.0)
        );
        let percent = 100.0 / truth.sigma();
        let overrides = coupling(algorithm, force, extrapolation);
        let (mut filtered, mut raw) = (Vec::new(), Vec::new());
        // Samples of the output grid of 1 ms that are communication points of every run.
        let stride = ((8.0 * smallest / 1e-3).round() as usize).max(1);
        let points = |run: &Run| -> Vec<f64> { run.raw().iter().copied().step_by(stride).collect() };
        for doublings in 0..4 {
            let step = format!("coupling.macro_step={}", smallest * f64::from(1 << doublings));
            let mut all: Vec<&str> = overrides.iter().map(String::as_str).collect();
            all.extend([micro.as_str(), step.as_str()]);
            let coupled = short(Mode::Inprocess, &all);
            filtered.push(percent * truth.filtered_difference(&coupled));
            raw.push(percent * rms(&points(&truth), &points(&coupled)));
        }
        let shown = |errors: &[f64]| {
            let errors: Vec<String> = errors.iter().map(|error| format!("{error:.4}")).collect();
            errors.join(", ")
        };
        println!(
            "{algorithm}, {force}, extrapolation {extrapolation}, {smallest} s and 2, 4, 8 times that, % of σ: \
             filtered {} (order {:.2}); raw {} (order {:.2})",
            shown(&filtered),
            order(&filtered),
            shown(&raw),
            order(&raw),
        );
        Self { filtered, raw }
    }

    fn has_order(&self, expected: f64, tolerance: f64) {
        let measured = order(&self.raw);
        assert!(
            (measured - expected).abs() < tolerance,
            "order {measured:.2} of the raw force"
        );
        assert!(
            self.filtered.windows(2).all(|pair| pair[0] < pair[1]),
            "every shorter step is better: {:?}",
            self.filtered
        );
        assert!(
            self.raw.windows(2).all(|pair| pair[0] < pair[1]),
            "every shorter step is better: {:?}",
            self.raw
        );
    }
}

#[test]
fn a_strip_that_rolls_is_the_same_strip_on_either_side() {
    // A damper feels the roll rate, which is no input of the line but the derivative of the roll input in time.
    const LINKAGE: &str = include_str!("../scenes/thesis-pantograph.toml");
    let of = |mode, step: &str| {
        let overrides = [
            "catenary.spans=3",
            "run.start_x=20",
            "run.duration=0.4",
            "run.evaluate={time=[0.05,0.4]}",
            "vehicle={model=\"rigid_motion\",motion={time=[0,0.1,0.3],roll=[0,0.05,0]}}",
            "contact.damping=1000",
            &format!("coupling.macro_step={step}"),
            &format!("solver.micro_step={step}"),
        ];
        run(scene_with(LINKAGE, &overrides), mode, "rolling")
    };
    let errors = ["1e-3", "5e-4"].map(|step| {
        let (whole, parts) = (of(Mode::Monolithic, step), of(Mode::Inprocess, step));
        let apart = 100.0 * rms(whole.raw(), parts.raw()) / whole.sigma();
        let energy = parts.summary.coupling.energy_residual.expect("it is known");
        println!("rolling, {step} s: {apart:.4} % of σ, {energy:e} J");
        [apart, energy.abs()]
    });
    // Without the rate the error would not fall with the step.
    let [long, short] = errors;
    assert!(long[0] < 1.0 && long[1] < 0.03, "{errors:?}");
    assert!((0..2).all(|k| short[k] < 0.8 * long[k]), "{errors:?}");
}

#[test]
fn under_a_standing_strip_no_damper_acts_and_with_its_speed_it_does_on_either_side() {
    // Slopes of the wire of 1e-3 make a damper of 1e4 N s/m press or pull with several times the contact force, at
    // which no line rests under a strip that moves along.
    for start_x in ["20", "23", "40"] {
        let at = |damping: &str, mode| {
            let overrides = [
                "catenary.spans=3",
                "run.duration=0.2",
                "run.evaluate={time=[0,0.2]}",
                &format!("run.start_x={start_x}"),
                &format!("contact.damping={damping}"),
            ];
            run(scene_with(EN_300, &overrides), mode, "damped-start")
        };
        let [undamped, whole] = ["0", "1e4"].map(|damping| at(damping, Mode::Monolithic));
        let [stands, moves] = [&undamped, &whole].map(|run| {
            let pantograph = &run.record.pantographs[0];
            (pantograph.force[0], pantograph.strip_z[0])
        });
        assert!(
            (stands.1 - moves.1).abs() < 1e-9,
            "the same place: {stands:?}, {moves:?}"
        );
        assert!(
            (stands.0 - moves.0).abs() > 20.0,
            "its damper acts at once: {stands:?}, {moves:?}"
        );
        let parts = at("1e4", Mode::Inprocess);
        let apart = rms(whole.raw(), parts.raw()) / whole.sigma();
        assert!(apart < 1e-3, "x = {start_x} m: {apart} of σ");
    }
}

// The orders are those of the raw force: the low-pass filtered error changes sign with the step. Slack droppers and the
// vibrations of the coarse mesh, which the steps hardly resolve, spread the orders by about ±0.3.

#[test]
fn gauss_seidel_with_the_mean_force_is_of_second_order_in_the_macro_step() {
    let convergence = Convergence::of("gauss_seidel", "mean", 1, 5e-4);
    convergence.has_order(2.0, 0.35);
    assert!(convergence.filtered[1] < 0.5, "at 1 ms");
}

#[test]
fn gauss_seidel_with_quadratic_strips_and_interpolated_force_is_of_second_order() {
    let convergence = Convergence::of("gauss_seidel", "interpolated", 2, 5e-4);
    // The next term still shows at these steps: 2.4 on the corrected mesh.
    convergence.has_order(2.2, 0.4);
    assert!(convergence.filtered[1] < 0.1, "at 1 ms");
}

#[test]
fn jacobi_with_linear_prediction_is_of_second_order() {
    let convergence = Convergence::of("jacobi", "mean", 1, 5e-4);
    convergence.has_order(2.0, 0.35);
}

#[test]
fn held_strips_are_of_first_order() {
    // Asymptotic at shorter steps only: held values feed the contact's vibration.
    let convergence = Convergence::of("gauss_seidel", "mean", 0, 1.25e-4);
    convergence.has_order(1.0, 0.35);
}

#[test]
fn a_held_force_acts_from_the_beginning_of_its_step() {
    // Otherwise held forces come half an internal step late, which makes the coupling at least of first order.
    let scene = prepared(scene_with(EN_250, &SHORT), "coupling").scene;
    let force = scene.pantographs[0].start.unwrap().force;
    let scene::PantographModel::Lumped(lumped) = &scene.pantographs[0].model else {
        panic!("not lumped")
    };
    let mut pantograph = vehicle::Subsystem::new(&scene, 0).unwrap();
    let (more, h) = (50.0, scene.solver.micro_step);
    pantograph.set_contact_input(2, -(force + more));
    pantograph.advance_to(0.0, h).unwrap();
    let momentum = lumped.masses[0] * pantograph.strip().velocity.z;
    println!("{momentum} kg m/s of an impulse of {} N s", -more * h);
    // Springs and dampers take a share h c/m = 1e-3.
    assert!((momentum + more * h).abs() < 3e-3 * more * h);
}

#[test]
fn repeated_steps_of_one_internal_step_are_the_monolithic_run() {
    let truth = short(Mode::Monolithic, &[]);
    let overrides = coupling("iterated", "interpolated", 1);
    let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
    let coupled = short(Mode::Inprocess, &overrides);
    let (filtered, raw) = (truth.filtered_difference(&coupled), truth.raw_difference(&coupled));
    println!("iterated at 1 ms, force interpolated: {filtered:e} N filtered, {raw:e} N raw");
    // Newton's tolerance of 1e-4 N on either side.
    assert!(raw < 1e-3);
}

#[test]
fn repeated_steps_do_not_depend_on_the_prediction() {
    let runs = [0, 1, 2].map(|extrapolation| {
        let overrides = coupling("iterated", "mean", extrapolation);
        let mut overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        overrides.extend([
            "coupling.macro_step=0.002",
            "run.duration=1.0",
            "run.evaluate={time=[0.1,0.9]}",
        ]);
        short(Mode::Inprocess, &overrides)
    });
    for (extrapolation, other) in runs.iter().enumerate() {
        let (apart, rollbacks) = (runs[1].raw_difference(other), other.summary.cost.rollbacks);
        println!("iterated, extrapolation {extrapolation}: {apart:e} N from extrapolation 1, {rollbacks} rollbacks");
        // Forces settle to 1e-6 N, Newton's method to 1e-4 N.
        assert!(apart < 1e-3);
        assert!(
            rollbacks >= other.summary.cost.macro_steps,
            "every step is repeated at least once"
        );
    }
    let once = runs[2].summary.cost.rollbacks;
    assert!(
        once < runs[0].summary.cost.rollbacks,
        "a better prediction needs fewer repetitions"
    );
}

#[test]
fn fmus_repeat_the_run_of_their_components_bit_for_bit() {
    for algorithm in ["gauss_seidel", "jacobi", "iterated"] {
        let overrides = coupling(algorithm, "mean", 1);
        let mut overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        overrides.extend(["run.duration=0.4", "run.evaluate={time=[0.1,0.3]}"]);
        let [inside, outside] = [Mode::Inprocess, Mode::Cosimulation].map(|mode| short(mode, &overrides));
        assert_eq!(inside.record.time.len(), 401);
        assert_eq!(inside.record.time, outside.record.time);
        assert_eq!(inside.record.pantographs, outside.record.pantographs, "{algorithm}");
        assert_eq!(inside.record.supports, outside.record.supports, "{algorithm}");
        let work = |run: &Run| {
            let cost = &run.summary.cost;
            [
                cost.macro_steps,
                cost.micro_steps,
                cost.newton_iterations,
                cost.factorizations,
                cost.rollbacks,
            ]
        };
        println!("{algorithm}: {:?}", work(&inside));
        assert_eq!(work(&inside), work(&outside), "{algorithm}");
    }
}

/// Decisions of `auto` repeat: the scene as written gives the same force, bit for bit.
#[test]
fn a_scene_with_the_automatic_choice_runs_again_bit_for_bit_from_what_was_written() {
    for more in [
        &["coupling.macro_step=5e-3"][..],
        &["coupling.macro_step=1e-2", "coupling.max_iterations=1"],
    ] {
        let keys = [&SHORT[..], &["run.duration=0.6", "run.evaluate={time=[0.1,0.5]}"], more].concat();
        let scene = scene_with(EN_250, &[&keys[..], &["coupling.algorithm=auto"]].concat());
        let first = run(scene, Mode::Inprocess, "coupling");
        let written = &first.written;
        assert!(written.contains("algorithm = \"auto\""), "{written}");
        let again = system::load(written, "scene.toml", &[]).unwrap();
        let second = run(again, Mode::Inprocess, "coupling");
        assert_eq!(first.summary.coupling.reason, second.summary.coupling.reason);
        assert!(
            first.summary.coupling.reason.contains("omega h"),
            "{}",
            first.summary.coupling.reason
        );
        let bits = |run: &Run| {
            run.record.pantographs[0]
                .force
                .iter()
                .map(|force| force.to_bits())
                .collect::<Vec<_>>()
        };
        assert_eq!(bits(&first), bits(&second));
    }
}
