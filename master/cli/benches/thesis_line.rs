//! Whole runs of the shipped lines: monolithic, in-process and co-simulated by turns, so that all see the same machine.
//!
//! Prints the median real-time factor of each mode (wall seconds of the time loop per simulated second) and its ratio
//! to the monolithic one; the time of one monolithic step, alone and with its share of the time loop's records, beside
//! the floors of two corrections and of those that it makes; and what the FMI layer takes per macro step.

#[path = "../../../core/catenary/benches/floor/mod.rs"]
mod floor;

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use cosim::package;
use floor::Floors;
use results::RunInfo;
use results::report::{Progress, Show};
use simulation::{FmuSource, Mode, Prepared, prepare};
use system::one_system::OneSystem;
use system::run::Watch;

const REPEATS: usize = 7;
/// Simulated time that is measured at once where steps are alone, s.
const SLICE: f64 = 0.01;
const SCENES: [(&str, &str, f64); 2] = [
    ("thesis", include_str!("../../../scenes/thesis-pantograph.toml"), 10.0),
    ("en50318-300", include_str!("../../../scenes/en50318-300.toml"), 2.0),
];

fn prepared((name, text, duration): (&str, &str, f64)) -> Prepared {
    let overrides = [
        format!("run.duration={duration}"),
        format!("run.evaluate={{time=[1.0,{duration}]}}"),
    ];
    let scene = system::load(text, &format!("{name}.toml"), &overrides).expect("the shipped scene is good");
    prepare(scene, name, Path::new("."), false).expect("the shipped scene has an equilibrium")
}

fn run(scene: (&str, &str, f64), mode: Mode) -> RunInfo {
    let (name, _, duration) = scene;
    let interrupted = AtomicBool::new(false);
    let progress = Progress::simulated(name, duration, Show::Never);
    let watch = Watch::new(&interrupted, &progress);
    let source = FmuSource {
        folder: package::folder(&format!("bench-{name}")),
        logging: false,
    };
    let finished = prepared(scene)
        .run(mode, &source, &watch, |_| Ok::<(), Box<dyn std::error::Error>>(()))
        .expect("the run starts");
    assert!(finished.failure.is_none(), "the run is complete");
    finished.info
}

/// The same steps without a time loop around them: nothing is recorded. Wall time in s of each [`SLICE`] of the run.
fn steps_alone(scene: (&str, &str, f64)) -> Vec<f64> {
    let (_, _, duration) = scene;
    let prepared = prepared(scene);
    let statics = prepared.statics.as_ref().expect("the line is modelled here");
    let mut whole = OneSystem::new(&prepared.scene, statics, &[]).expect("the shipped scene has a start");
    let mut points = [whole.point(0.0), whole.point(0.0)];
    let mut slice = |k: usize| {
        let begin = Instant::now();
        whole
            .advance(k as f64 * SLICE, SLICE, &mut points, &mut |_, _| {})
            .expect("the run is complete");
        begin.elapsed().as_secs_f64()
    };
    (0..(duration / SLICE).round() as usize).map(&mut slice).collect()
}

/// Sum of all slices if each takes what it took in the run of this rank, 0 for its fastest one. Other work on the
/// machine comes and goes in milliseconds: no whole run is free of it.
fn together(runs: &[Vec<f64>], rank: usize) -> f64 {
    let of_slice = |k: usize| {
        let mut times: Vec<f64> = runs.iter().map(|run| run[k]).collect();
        times.sort_by(f64::total_cmp);
        times[rank]
    };
    (0..runs[0].len()).map(of_slice).sum()
}

/// The sum of what a step needs at least that makes so many `corrections`: as many forces of all elements, as many
/// solutions.
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
        let mut alone = Vec::new();
        for _ in 0..REPEATS {
            alone.push(steps_alone(scene));
            for ((mode, walls), info) in modes.iter().zip(&mut walls).zip(&mut infos) {
                let done = run(scene, *mode);
                walls.push(done.cost.wall_s);
                *info = Some(done);
            }
        }
        walls.iter_mut().for_each(|walls| walls.sort_by(f64::total_cmp));
        let medians = walls.each_ref().map(|walls| walls[REPEATS / 2]);
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
        let times = [
            (
                "one monolithic step",
                [together(&alone, 0), together(&alone, REPEATS / 2)],
            ),
            ("the same with what is recorded", [walls[0][0], medians[0]]),
        ];
        for (what, corrections) in [("two corrections", 2.0), ("the corrections it makes", corrections)] {
            for (of, [fastest, median]) in &times {
                for (which, wall) in [("fastest", fastest), ("median", median)] {
                    floor::print(
                        &format!("{name}: {of}, {which}, against {what}"),
                        wall / steps,
                        Some(step_floor(&monolithic, corrections)),
                    );
                }
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
