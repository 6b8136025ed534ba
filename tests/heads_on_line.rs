//! Heads with several strips on a line: coupled runs against one system, numbering, record.
use integration_tests::runs::{
    EN_250, EN_300, Run, SECOND_ON_THESIS_LINE, audited, finished, prepared, rms, run, scene_with,
};
use simulation::Mode;
use system::disturbance::Discards;

fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// Four spans of the reference model on a coarse mesh, which does not enter the error of the coupling.
const SHORT: [&str; 5] = [
    "catenary.spans=4",
    "catenary.mesh.elements_per_interval=2",
    "run.duration=1.8",
    "run.evaluate={time=[0.3,1.7]}",
    "run.start_x=30",
];

const RIGID: &str = "pantograph[1].strips=[{ x = 0.29 }, { x = -0.29 }]";
const PITCH: &str = "pantograph[1].pitch={ inertia = 0.4, stiffness = 100.0, damping = 2.0 }";
const SPRUNG: &str = "pantograph[1].strips=[{ x = 0.29, mass = 1.5, stiffness = 5000.0, damping = 10.0 }, { x = \
                      -0.29, mass = 1.5, stiffness = 5000.0, damping = 10.0 }]";

fn short(mode: Mode, more: &[&str]) -> Run {
    run(scene_with(EN_250, &[&SHORT[..], more].concat()), mode, "heads")
}

#[test]
fn a_line_under_a_head_coupled_at_a_millisecond_is_as_one_system() {
    for head in [&[RIGID][..], &[RIGID, PITCH], &[SPRUNG]] {
        let whole = short(Mode::Monolithic, head);
        let coupled = short(Mode::Inprocess, head);
        let scene = scene_with(EN_250, &[&SHORT[..], head].concat());
        let start = prepared(scene, "heads").scene.pantographs[0].start.unwrap();
        let percent = 100.0 * whole.filtered_difference(&coupled) / whole.sigma();
        println!("{head:?}: {percent:.4} % of σ = {:.2} N", whole.sigma());
        assert!(percent < 0.2, "{head:?}: {percent} %");
        for run in [&whole, &coupled] {
            let pantograph = &run.record.pantographs[0];
            assert_eq!(pantograph.strips.len(), 2);
            for (row, force) in pantograph.force.iter().enumerate() {
                let sum: f64 = pantograph.strips.iter().map(|strip| strip.force[row]).sum();
                assert_eq!(sum, *force);
            }
            // Both begin at rest: the line presses as the pantograph pushes, but for the tolerance of that balance.
            assert!(
                (pantograph.force[0] - start.force).abs() < 1e-5,
                "{} {start:?}",
                pantograph.force[0]
            );
        }
    }
}

#[test]
fn other_algorithms_couple_heads_as_well() {
    let whole = short(Mode::Monolithic, &[RIGID, PITCH]);
    for (algorithm, bound) in [
        ("gauss_seidel", 1.0),
        ("jacobi", 2.0),
        ("iterated", 1.0),
        ("interface_jacobian", 0.2),
    ] {
        let algorithm = format!("coupling.algorithm=\"{algorithm}\"");
        let coupled = short(Mode::Inprocess, &[RIGID, PITCH, &algorithm]);
        let percent = 100.0 * whole.filtered_difference(&coupled) / whole.sigma();
        println!("{algorithm}: {percent:.4} %");
        assert!(percent < bound, "{algorithm}: {percent} %");
    }
}

#[test]
fn a_list_of_one_strip_in_the_middle_changes_no_bit() {
    let plain = short(Mode::Monolithic, &[]);
    let listed = short(Mode::Monolithic, &["pantograph[1].strips=[{ x = 0.0 }]"]);
    assert_eq!(plain.record.pantographs, listed.record.pantographs);
}

#[test]
fn strips_are_numbered_over_all_heads() {
    let second = "pantograph=[{ model = \"lumped\", static_force = 120, strip = { width = 1.2 }, masses = [7.2, 15], \
                  stiffnesses = [4200, 50], dampings = [10, 90], strips = [{ x = 0.29 }, { x = -0.29 }] }, { model = \
                  \"lumped\", offset_x = -25, static_force = 120, strip = { width = 1.2 }, masses = [7.2, 15], \
                  stiffnesses = [4200, 50], dampings = [10, 90] }]";
    let keys = [
        "run.start_x=60",
        "run.duration=1.4",
        "run.evaluate={time=[0.3,1.3]}",
        second,
    ];
    let [whole, coupled] = [Mode::Monolithic, Mode::Inprocess].map(|mode| short(mode, &keys));
    let [leading, trailing] = &whole.record.pantographs[..] else {
        panic!("two heads");
    };
    let starts = leading.strips.iter().chain([trailing]).map(|strip| strip.contact_x[0]);
    for (x, expected) in starts.zip([60.29, 59.71, 35.0]) {
        assert!((x - expected).abs() < 1e-3, "{x}");
    }
    let force = |run: &Run, pantograph: usize| run.record.pantographs[pantograph].force.clone();
    for pantograph in [0, 1] {
        let (whole, coupled) = (force(&whole, pantograph), force(&coupled, pantograph));
        let percent = 100.0 * rms(&whole, &coupled) / deviation(&whole);
        assert!(
            percent < 0.2,
            "pantograph {}: {percent} % of the raw force",
            pantograph + 1
        );
    }
}

#[test]
fn the_fmus_of_a_head_with_two_strips_give_what_the_core_gives() {
    for head in [&[RIGID, PITCH][..], &[SPRUNG]] {
        let time = ["run.duration=0.5", "run.evaluate={time=[0.1,0.4]}"];
        let [own, fmus] = [Mode::Inprocess, Mode::Cosimulation].map(|mode| short(mode, &[head, &time].concat()));
        assert_eq!(own.record.pantographs, fmus.record.pantographs);
    }
}

#[test]
fn steps_under_a_head_that_are_taken_back_and_repeated_give_the_same_bits() {
    for head in [&[RIGID, PITCH][..], &[SPRUNG]] {
        let time = ["run.duration=0.5", "run.evaluate={time=[0.1,0.4]}"];
        let scene = scene_with(EN_250, &[&SHORT[..], head, &time].concat());
        // Refused by the slaves where an output differs in a bit.
        let mut repeated = prepared(scene.clone(), "heads");
        repeated.disturbance.repeated = true;
        let repeated = finished(repeated, Mode::Inprocess, "heads");
        let plain = finished(prepared(scene.clone(), "heads"), Mode::Inprocess, "heads");
        assert_eq!(repeated.record.pantographs, plain.record.pantographs);
        // Discarded steps are done anew in halves.
        let mut discarded = prepared(scene, "heads");
        discarded.disturbance.discards = Some(Discards { one_in: 40, seed: 7 });
        let discarded = finished(discarded, Mode::Inprocess, "heads");
        let (a, b) = (
            &plain.record.pantographs[0].force,
            &discarded.record.pantographs[0].force,
        );
        assert!(rms(a, b) < 0.05 * deviation(a), "{} N of {} N", rms(a, b), deviation(a));
    }
}

#[test]
fn the_energy_of_line_and_head_is_accounted_for() {
    for head in [&[RIGID, PITCH][..], &[SPRUNG]] {
        let still = [
            "coupling.macro_step=5e-4",
            "solver.micro_step=5e-4",
            "solver.rho_inf=1",
            "catenary.damping.alpha=0",
            "catenary.damping.beta=0",
            "pantograph[1].dampings=[0, 0]",
        ];
        let scene = scene_with(EN_250, &[&SHORT[..], head, &still].concat());
        let (_, evidence) = audited(prepared(scene, "heads"), "heads");
        let made = evidence.worst_residual.abs() / evidence.exchanged;
        println!("{head:?}: {evidence:?}");
        // Droppers that go slack within a step, and the second order of the step.
        assert!(made < 0.01, "{made}");
    }
}

#[test]
fn a_resolved_scene_of_a_head_runs_again_bit_for_bit() {
    for head in [&[RIGID][..], &[RIGID, PITCH], &[SPRUNG]] {
        let time = ["run.duration=0.3", "run.evaluate={time=[0.1,0.2]}"];
        let first = short(Mode::Inprocess, &[head, &time].concat());
        let again = run(scene_with(&first.written, &[]), Mode::Inprocess, "heads");
        assert_eq!(first.written, again.written);
        assert_eq!(first.record.pantographs, again.record.pantographs);
    }
}

/// The window and the linearised line follow the strips of a head as they follow one strip.
#[test]
fn reductions_of_the_line_carry_heads() {
    let of = |reduce: &str| {
        let keys = [
            "catenary.mesh.elements_per_interval=2",
            "run.duration=3.0",
            "run.evaluate={time=[0.5,3.0]}",
            RIGID,
            PITCH,
            reduce,
        ];
        run(scene_with(EN_300, &keys), Mode::Monolithic, "heads")
    };
    let whole = of("model.reduce=[\"planar\", \"linearised\"]");
    let window = of("model.reduce=[\"planar\", \"linearised\", \"window\"]");
    let percent = 100.0 * whole.filtered_difference(&window) / whole.sigma();
    println!("window: {percent:.3} % of σ");
    assert!(percent < 0.5, "{percent} %");
    let nonlinear = of("model.reduce=[\"planar\"]");
    let percent = 100.0 * nonlinear.filtered_difference(&whole) / nonlinear.sigma();
    println!("linearised: {percent:.3} % of σ");
    // Droppers stay unilateral in a linearised line; the reference line is linear but for them.
    assert!(percent < 2.0, "{percent} %");
}

/// A base that stands 20 mm higher presses more by what the grounded spring of 50 N/m gives, less what line and springs
/// above yield.
#[test]
fn heads_on_a_raised_base_press_more_by_its_spring() {
    let motion = "vehicle={ model = \"rigid_motion\", motion = { time = [0.0], z = [0.02] } }";
    let time = ["run.duration=0.3", "run.evaluate={time=[0.1,0.2]}"];
    for head in [&[RIGID, PITCH][..], &[SPRUNG]] {
        let level = short(Mode::Monolithic, &[head, &time].concat());
        let [whole, coupled] =
            [Mode::Monolithic, Mode::Inprocess].map(|mode| short(mode, &[head, &time, &[motion]].concat()));
        let force = |run: &Run| run.record.pantographs[0].force[0];
        let more = force(&whole) - force(&level);
        assert!((0.9..1.0).contains(&more), "{more} N");
        let (a, b) = (&whole.record.pantographs[0].force, &coupled.record.pantographs[0].force);
        assert!(
            rms(a, b) < 0.002 * deviation(a),
            "{} N of {} N",
            rms(a, b),
            deviation(a)
        );
    }
}

#[test]
fn the_air_lifts_the_head_and_its_strips_have_equal_parts_of_it() {
    let wind = "wind={ speed = 5.0, yaw_deg = 0.0, air_density = 1.225, pantograph = { uplift = 0.004 } }";
    let time = ["run.duration=0.3", "run.evaluate={time=[0.1,0.2]}"];
    for head in [&[RIGID][..], &[SPRUNG]] {
        let [whole, coupled] =
            [Mode::Monolithic, Mode::Inprocess].map(|mode| short(mode, &[head, &time, &[wind]].concat()));
        let plain = short(Mode::Monolithic, &[head, &time].concat());
        let [with, without] = [&whole, &plain].map(|run| &run.record.pantographs[0]);
        let lift = &with.wind.as_ref().unwrap().lift;
        let parts = with.strips.iter().map(|strip| strip.wind.as_ref().unwrap().lift[0]);
        assert!(
            lift[0] > 10.0 && parts.clone().all(|part| part == 0.5 * lift[0]),
            "{} N",
            lift[0]
        );
        // All of it but what the grounded spring of 50 N/m takes as the line rises.
        let more = with.force[0] - without.force[0];
        assert!((0.97..1.0).contains(&(more / lift[0])), "{more} N of {} N", lift[0]);
        let (a, b) = (&with.force, &coupled.record.pantographs[0].force);
        assert!(
            rms(a, b) < 0.002 * deviation(a),
            "{} N of {} N",
            rms(a, b),
            deviation(a)
        );
    }
}

/// A short strip with long horns under a wire that leads beyond the strip at every support.
const HORNS: [&str; 2] = [
    "catenary.stagger=[0.3, -0.3]",
    "pantograph[1].strip={ width = 0.4, horns = { y = [0.25, 0.35, 0.5], z = [-0.005, -0.03, -0.12] } }",
];

/// Largest distance of the wire from the middle of the head while they touch, m.
fn farthest(run: &Run) -> f64 {
    let strip = &run.record.pantographs[0];
    let touching = strip.aside.iter().zip(&strip.force).filter(|(_, force)| **force > 0.0);
    touching.map(|(aside, _)| aside.abs()).fold(0.0, f64::max)
}

#[test]
fn a_wire_on_the_horns_is_coupled_as_in_one_system() {
    let [whole, coupled] = [Mode::Monolithic, Mode::Inprocess].map(|mode| short(mode, &HORNS));
    let percent = 100.0 * whole.filtered_difference(&coupled) / whole.sigma();
    let aside = farthest(&whole);
    println!(
        "horns: {percent:.4} % of σ = {:.2} N, {aside:.3} m from the middle",
        whole.sigma()
    );
    assert!(aside > 0.22, "{aside}");
    assert!(percent < 0.2, "{percent} %");
    let notes = &whole.summary.notes;
    assert!(
        notes
            .iter()
            .any(|note| note.contains("the wire was on a horn of the head")),
        "{notes:?}"
    );
    let time = ["run.duration=0.5", "run.evaluate={time=[0.1,0.4]}"];
    let [own, fmus] = [Mode::Inprocess, Mode::Cosimulation].map(|mode| short(mode, &[&HORNS[..], &time].concat()));
    assert_eq!(own.record.pantographs, fmus.record.pantographs);
}

/// The wire of the second tension length comes from beside the head, down onto a horn and up to the strip.
#[test]
fn a_wire_that_comes_from_the_side_at_an_overlap_rises_up_the_horn() {
    let keys = [
        "catenary.tension_length[2].contact_wire_height=[5.8, 5.3, 5.3, 5.3, 5.3, 5.3, 5.3, 5.3]",
        "catenary.tension_length[2].stagger=[1.2, 0.4, 0.1, -0.1, 0.2, -0.2, 0.2, -0.2]",
        "pantograph[1].strip={ width = 0.5, horns = { y = [0.3, 0.4, 0.6], z = [-0.005, -0.03, -0.15] } }",
        "catenary.mesh.elements_per_interval=2",
        "run.start_x=230",
        "run.duration=2.2",
        "run.evaluate={time=[0.2,2.1]}",
    ];
    let overlap = include_str!("../scenes/overlap.toml");
    let [whole, coupled] =
        [Mode::Monolithic, Mode::Inprocess].map(|mode| run(scene_with(overlap, &keys), mode, "horns"));
    let percent = 100.0 * whole.filtered_difference(&coupled) / whole.sigma();
    println!(
        "overlap: {percent:.4} % of σ = {:.2} N, {:.3} m aside",
        whole.sigma(),
        farthest(&whole)
    );
    for note in &whole.summary.notes {
        println!("{note}");
    }
    assert!(percent < 0.2, "{percent} %");
}

#[test]
fn a_start_on_a_horn_is_at_rest_and_energy_is_accounted_for() {
    let still = [
        HORNS[0],
        HORNS[1],
        "run.start_x=5",
        "coupling.macro_step=5e-4",
        "solver.micro_step=5e-4",
        "solver.rho_inf=1",
        "catenary.damping.alpha=0",
        "catenary.damping.beta=0",
        "pantograph[1].dampings=[0, 0]",
    ];
    let scene = scene_with(EN_250, &[&SHORT[..], &still].concat());
    let (run, evidence) = audited(prepared(scene, "horns"), "horns");
    let strip = &run.record.pantographs[0];
    // Vertical equilibrium: the pantograph pushes with its force at rest, of which the horn takes more.
    println!("{} {:?}", strip.force[0], evidence);
    assert!(strip.aside[0].abs() > 0.2 && strip.force[0] > 100.0);
    let early = &strip.strip_z[..20];
    assert!(early.iter().all(|z| (z - early[0]).abs() < 1e-3), "{early:?}");
    let made = evidence.worst_residual.abs() / evidence.exchanged;
    assert!(made < 0.01, "{made}");
}

#[test]
fn a_linearised_line_carries_horns() {
    let of = |reduce: &str| short(Mode::Monolithic, &[HORNS[0], HORNS[1], reduce]);
    let [whole, linear] = ["model.reduce=[]", "model.reduce=[\"linearised\"]"].map(of);
    let percent = 100.0 * whole.filtered_difference(&linear) / whole.sigma();
    println!("linearised: {percent:.3} % of σ");
    // As much as without horns.
    assert!(farthest(&linear) > 0.22 && percent < 1.0, "{percent} %");
}

#[test]
fn a_wire_blown_over_the_end_of_a_horn_is_lost_and_told() {
    let keys = [
        "catenary.stagger=[-0.35, -0.35]",
        HORNS[1],
        "run.start_x=55",
        "wind={ speed=38, yaw_deg=90, air_density=1.225, wires={ drag_coefficient=1.2, contact_wire_diameter=0.0135, \
         messenger_wire_diameter=0.012 } }",
    ];
    let run = short(Mode::Monolithic, &keys);
    for note in &run.summary.notes {
        println!("{note}");
    }
    println!("{}", farthest(&run));
    let notes = &run.summary.notes;
    assert!(
        notes
            .iter()
            .any(|note| note.contains("over the end of a horn (dewirement)")),
        "{notes:?}"
    );
}

/// A second of the thesis' linkage on a short line.
fn linkage(mode: Mode, keys: &[&str]) -> Run {
    let thesis = include_str!("../scenes/thesis-pantograph.toml");
    run(
        scene_with(thesis, &[&SECOND_ON_THESIS_LINE[..], keys].concat()),
        mode,
        "heads",
    )
}

const TWO: &str = "pantograph[1].strips=[{ x = 0.29 }, { x = -0.29 }]";

#[test]
fn two_strips_on_a_linkage_are_coupled_as_in_one_system_also_on_its_one_motion() {
    for reduce in ["model.reduce=[\"planar\"]", "model.reduce=[\"planar\", \"linkage\"]"] {
        let [whole, coupled] = [Mode::Monolithic, Mode::Inprocess].map(|mode| linkage(mode, &[TWO, reduce]));
        let percent = 100.0 * whole.filtered_difference(&coupled) / whole.sigma();
        let start: Vec<f64> = whole.record.pantographs[0]
            .strips
            .iter()
            .map(|strip| strip.force[0])
            .collect();
        println!(
            "{reduce}: {percent:.4} % of σ = {:.2} N, at rest {start:?}",
            whole.sigma()
        );
        assert!(percent < 0.2, "{reduce}: {percent} %");
        // Both begin at rest.
        let z = &whole.record.pantographs[0].strip_z;
        assert!((z[5] - z[0]).abs() < 1e-4, "{:?}", &z[..6]);
    }
}

#[test]
fn two_strips_a_micrometre_apart_with_half_the_stiffness_each_are_one_strip() {
    let one = linkage(Mode::Monolithic, &["contact.damping=0"]);
    let halves = linkage(
        Mode::Monolithic,
        &[
            "contact.damping=0",
            "contact.stiffness=25000",
            "pantograph[1].strips=[{ x = 5e-7 }, { x = -5e-7 }]",
        ],
    );
    let difference = one.raw_difference(&halves) / deviation(one.raw());
    println!("{difference:e} of σ");
    assert!(difference < 1e-3, "{difference}");
    let strips = &halves.record.pantographs[0].strips;
    assert!((strips[0].force[0] - strips[1].force[0]).abs() < 1e-2, "evenly at rest");
}

#[test]
fn the_fmus_of_a_linkage_with_two_strips_give_what_the_core_gives() {
    let time = [TWO, "run.duration=0.4", "run.evaluate={time=[0.1,0.3]}"];
    let [own, fmus] = [Mode::Inprocess, Mode::Cosimulation].map(|mode| linkage(mode, &time));
    assert_eq!(own.record.pantographs, fmus.record.pantographs);
}
