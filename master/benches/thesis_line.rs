//! Whole runs of the shipped lines: monolithic, in-process and co-simulated by turns, so that all see the same machine.
//!
//! Prints the median real-time factor of each mode (wall seconds of the time loop per simulated second) and its ratio to the
//! monolithic one; the time of one monolithic step beside the floors of two corrections and of those that it makes; and what the FMI
//! layer takes per macro step.

#[path = "../../core/catenary/benches/floor/mod.rs"]
mod floor;

use std::path::Path;
use std::sync::atomic::AtomicBool;

use floor::Floors;
use master::package;
use master::report::{Progress, Show};
use master::results::RunInfo;
use master::run::Watch;
use master::simulation::{FmuSource, Mode, prepare};
use scene::Scene;

const REPEATS: usize = 7;
const SCENES: [(&str, &str, f64); 2] = [
    ("thesis", include_str!("../../scenes/thesis-pantograph.toml"), 10.0),
    ("en50318-300", include_str!("../../scenes/en50318-300.toml"), 2.0),
];

fn run((name, text, duration): (&str, &str, f64), mode: Mode) -> RunInfo {
    let overrides = [
        format!("run.duration={duration}"),
        format!("run.evaluate={{time=[1.0,{duration}]}}"),
    ];
    let scene = Scene::from_toml(text, &format!("{name}.toml"), &overrides).expect("the shipped scene is good");
    let prepared = prepare(scene, name, Path::new("."), false).expect("the shipped scene has an equilibrium");
    let interrupted = AtomicBool::new(false);
    let progress = Progress::simulated(name, duration, Show::Never);
    let watch = Watch::new(&interrupted, &progress);
    let source = FmuSource {
        folder: package::folder(&format!("bench-{name}")),
        say: &|_| {},
        logging: false,
    };
    let finished = prepared
        .run(mode, &source, &watch, |_| Ok::<(), Box<dyn std::error::Error>>(()))
        .expect("the run starts");
    assert!(finished.failure.is_none(), "the run is complete");
    finished.info
}

/// The sum of what a step needs at least that makes so many `corrections`: as many forces of all elements, as many solutions.
fn step_floor(info: &RunInfo, corrections: f64) -> f64 {
    let floors = Floors::here();
    corrections * (info.model.elements as f64 * floors.force + info.model.coordinates as f64 * floors.solve)
}

fn main() {
    // `cargo test` runs benches too, without this flag that `cargo bench` gives.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let modes = [Mode::Monolithic, Mode::Inprocess, Mode::Cosimulation];
    for scene in SCENES {
        let mut walls = modes.map(|_| Vec::new());
        let mut infos = modes.map(|_| None);
        for _ in 0..REPEATS {
            for ((mode, walls), info) in modes.iter().zip(&mut walls).zip(&mut infos) {
                let done = run(scene, *mode);
                walls.push(done.cost.wall_s);
                *info = Some(done);
            }
        }
        walls.iter_mut().for_each(|walls| walls.sort_by(f64::total_cmp));
        let medians = walls.each_ref().map(|walls| walls[REPEATS / 2]);
        let fastest = walls[0][0];
        let [monolithic, _, coupled] = infos.map(|info| info.expect("every mode has run"));
        let (name, _, duration) = scene;
        println!("{name}: {duration} s, median of {REPEATS} runs each");
        for (mode, median) in modes.iter().zip(medians) {
            println!(
                "{:<14} real-time factor {:.3}, {:.2} x monolithic",
                mode.name(),
                median / duration,
                median / medians[0]
            );
        }
        let cost = &monolithic.cost;
        let steps = cost.micro_steps as f64;
        let corrections = cost.newton_iterations as f64 / steps;
        println!(
            "{corrections:.2} Newton iterations per step, {} factorisations",
            cost.factorizations
        );
        for (what, corrections) in [("two corrections", 2.0), ("the corrections it makes", corrections)] {
            for (which, wall) in [("fastest", fastest), ("median", medians[0])] {
                floor::print(
                    &format!("{name}: one monolithic step, {which}, against {what}"),
                    wall / steps,
                    Some(step_floor(&monolithic, corrections)),
                );
            }
        }
        let round_trips = coupled.cost.macro_steps as f64;
        floor::print(
            &format!("{name}: FMI round trip of both sides, what co-simulation takes beyond in-process coupling"),
            (medians[2] - medians[1]) / round_trips,
            None,
        );
    }
}
