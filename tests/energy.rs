//! Energy: conservation without damping, and the balance of a run.
use integration_tests::runs::{SECOND_ON_THESIS_LINE, audited, prepared, scene_with};
use simulation::Finished;
use system::disturbance::{Deflection, Disturbance};
use system::one_system::Evidence;

const SHORT_LINE: &str = include_str!("../master/experiments/src/stability/base.toml");

/// A run as one system with its energy followed.
fn run(overrides: &[&str], deflection: Option<Deflection>) -> (Finished, Evidence) {
    run_scene(SHORT_LINE, overrides, deflection)
}

fn run_scene(text: &str, overrides: &[&str], deflection: Option<Deflection>) -> (Finished, Evidence) {
    let mut prepared = prepared(scene_with(text, overrides), "energy");
    prepared.disturbance = Disturbance {
        deflection,
        ..Disturbance::default()
    };
    audited(prepared, "energy")
}

/// No damping anywhere, a trapezoid in time, and the coarsest mesh.
const UNDAMPED: [&str; 7] = [
    "coupling.macro_step=5e-4",
    "solver.micro_step=5e-4",
    "catenary.damping.alpha=0",
    "catenary.damping.beta=0",
    "pantograph.0.dampings=[0,0]",
    "solver.rho_inf=1",
    "catenary.mesh.elements_per_interval=1",
];

fn with(more: &[&'static str]) -> Vec<&'static str> {
    UNDAMPED.iter().chain(more).copied().collect()
}

#[test]
fn an_undamped_line_without_contact_keeps_its_energy_for_100_seconds() {
    let keys = with(&[
        "coupling.macro_step=1e-3",
        "solver.micro_step=1e-3",
        "catenary.spans=2",
        "run.speed_kmh=1",
        "run.duration=100",
        "run.evaluate={time=[10,90]}",
        "run.initialise=\"as_given\"",
        "pantograph.0.reference_height=4.5",
        "pantograph.0.static_force=1",
        "pantograph.0.stiffnesses=[4200,5000]",
    ]);
    let (finished, evidence) = run(&keys, Some(Deflection { amplitude: 0.05 }));
    assert!(finished.record.pantographs[0].force.iter().all(|force| *force == 0.0));
    // Half sines in taut wires: (T₁ + T₂)/4 (π a/L)² per metre, and what the sagging messenger wire adds.
    let slope = std::f64::consts::PI * 0.05 / 50.0;
    let strings = 36_000.0 / 4.0 * slope * slope * 100.0;
    assert!(
        (evidence.deflected / strings - 1.0).abs() < 0.3,
        "{} J, as strings {strings} J",
        evidence.deflected
    );
    let lost = evidence.worst_residual / evidence.deflected;
    println!("{} J, worst {lost:.1e} of it", evidence.deflected);
    assert!(lost < 1e-3, "{lost}");
}

#[test]
fn energy_is_accounted_for_to_a_thousandth_with_every_damper() {
    // Dampers of the case, and the micro step: a dropper that closes within a step is taken for damped in a part of it.
    let cases: [(&[&str], &str); 5] = [
        (&[], "nothing"),
        (
            &["catenary.damping.alpha=0.0125", "catenary.damping.beta=1e-4"],
            "wires",
        ),
        (&["pantograph.0.dampings=[10,90]"], "pantograph"),
        (&["contact.damping=200"], "contact"),
        (
            &[
                "catenary.droppers.damping=100",
                "coupling.macro_step=2.5e-4",
                "solver.micro_step=2.5e-4",
            ],
            "droppers",
        ),
    ];
    for (keys, damped) in cases {
        let (finished, evidence) = run(&with(keys), None);
        let left = evidence.worst_residual / evidence.exchanged;
        println!(
            "{damped}: driven {:.3} J, heat {:.3} J, left over {left:.1e}",
            evidence.driven, evidence.dissipated
        );
        assert!(left < 1e-3, "{damped}: {evidence:?}");
        assert!(
            evidence.driven > 1.0,
            "{damped}: the train does work, {} J",
            evidence.driven
        );
        assert_eq!(
            evidence.dissipated > 1e-3,
            damped != "nothing",
            "{damped}: {}",
            evidence.dissipated
        );
        assert!(finished.record.pantographs[0].force.iter().any(|force| *force > 150.0));
    }
}

#[test]
fn energy_is_accounted_for_on_a_corrected_mesh() {
    let keys = with(&[
        "catenary.mesh.elements_per_interval=6",
        "catenary.mesh.corrections=\"auto\"",
    ]);
    let (_, evidence) = run(&keys, None);
    let left = evidence.worst_residual / evidence.exchanged;
    println!("driven {:.3} J, left over {left:.1e}", evidence.driven);
    assert!(left < 1e-3 && evidence.driven > 1.0, "{evidence:?}");
}

#[test]
fn numerical_damping_shows_as_a_loss() {
    let (_, evidence) = run(&with(&["solver.rho_inf=0.5"]), None);
    let left = evidence.residual / evidence.exchanged;
    // Four times the remainder of the trapezoidal rule, and of the other sign than made energy.
    assert!(left < -1.2e-3, "{left}");
}

#[test]
fn the_joints_of_a_linkage_take_and_give_no_energy() {
    let scene = include_str!("../scenes/thesis-pantograph.toml");
    // All bodies and joints.
    let keys = [&SECOND_ON_THESIS_LINE[..], &["model.reduce=[\"planar\"]"]].concat();
    let (_, evidence) = run_scene(scene, &keys, None);
    let left = evidence.worst_residual / evidence.exchanged;
    println!(
        "linkage: driven {:.3} J, heat {:.3} J, left over {left:.1e}",
        evidence.driven, evidence.dissipated
    );
    assert!(left < 1e-3, "{evidence:?}");
    assert!(evidence.drift[0] < 1e-9 && evidence.constraints > 20, "{evidence:?}");
}

#[test]
fn a_driven_joint_brings_the_power_that_the_balance_has() {
    let scene = include_str!("../scenes/thesis-pantograph.toml");
    let control = "pantograph[1].control={law=\"skyhook\", sample_time=0.005, damping=400, \
                   actuator={joint=\"base-lower_arm\", lag=0.01}}";
    // All bodies and joints, and the one motion.
    for reduce in ["model.reduce=[\"planar\"]", "model.reduce=[\"planar\", \"linkage\"]"] {
        let keys = [&SECOND_ON_THESIS_LINE[..], &[reduce, control]].concat();
        let (finished, evidence) = run_scene(scene, &keys, None);
        let moment = finished.record.pantographs[0].control.as_ref().unwrap();
        assert!(moment.iter().any(|moment| moment.abs() > 10.0), "the drive acts");
        let left = evidence.worst_residual / evidence.exchanged;
        assert!(left < 1e-3, "{reduce}: {evidence:?}");
    }
}

/// Stiff droppers without dampers vibrate faster than the step follows: the energy made so is the residual of the whole
/// balance, and the run reports the figure.
#[test]
fn energy_made_at_droppers_is_what_the_balance_lacks_and_a_run_says_so() {
    let said = |finished: &Finished| {
        let notes = finished.info.notes.iter();
        notes
            .filter(|note| note.contains("J at droppers"))
            .cloned()
            .collect::<Vec<_>>()
    };
    let (finished, evidence) = run(&["catenary.droppers.stiffness=1e7"], None);
    let made = evidence.made_at_droppers;
    assert!(made > 100.0, "{made} J");
    // Numerical damping (rho_inf = 0.9) takes a part back that is small while so much is made.
    assert!((made / evidence.residual - 1.0).abs() < 0.02, "{made} J, {evidence:?}");
    let said_there = said(&finished);
    assert_eq!(said_there.len(), 1);
    assert!(said_there[0].contains(&format!("made {made:.3} J")), "{said_there:?}");

    let (finished, evidence) = run(&[], None);
    assert!(evidence.made_at_droppers.abs() < 0.05, "{evidence:?}");
    assert_eq!(said(&finished), [""; 0]);
}
