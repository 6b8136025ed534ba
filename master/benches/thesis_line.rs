//! Whole runs of the thesis line: monolithic, in-process and co-simulated by turns, so that all see the same machine.
//!
//! Prints the median real-time factor of each mode (wall seconds of the time loop per simulated second) and its ratio to the
//! monolithic one.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use master::package;
use master::report::{Progress, Show};
use master::run::Watch;
use master::simulation::{FmuSource, Mode, prepare};
use scene::Scene;

const REPEATS: usize = 5;
const SCENE: &str = include_str!("../../scenes/thesis.toml");

fn real_time_factor(mode: Mode) -> f64 {
    let overrides = ["run.duration=4.0", "run.evaluate={time=[1.0,4.0]}"].map(String::from);
    let scene = Scene::from_toml(SCENE, "thesis.toml", &overrides).expect("the shipped scene is good");
    let prepared = prepare(scene, "thesis", Path::new("."), false).expect("the shipped scene has an equilibrium");
    let interrupted = AtomicBool::new(false);
    let progress = Progress::simulated("thesis", 4.0, Show::Never);
    let watch = Watch {
        interrupted: &interrupted,
        progress: &progress,
    };
    let source = FmuSource {
        folder: package::folder("bench-thesis"),
        say: &|_| {},
        logging: false,
    };
    let finished = prepared
        .run(mode, &source, &watch, |_| Ok::<(), Box<dyn std::error::Error>>(()))
        .expect("the run starts");
    assert!(finished.failure.is_none(), "the run is complete");
    finished.info.cost.real_time_factor.expect("a run of 4 s has a factor")
}

fn main() {
    // `cargo test` runs benches too, without this flag that `cargo bench` gives.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let modes = [Mode::Monolithic, Mode::Inprocess, Mode::Cosimulation];
    let mut factors = modes.map(|_| Vec::new());
    for _ in 0..REPEATS {
        for (mode, factors) in modes.iter().zip(&mut factors) {
            factors.push(real_time_factor(*mode));
        }
    }
    let medians = factors.map(|mut factors| {
        factors.sort_by(f64::total_cmp);
        factors[REPEATS / 2]
    });
    println!("thesis line, 4 s at 1 ms, median of {REPEATS} runs each");
    for (mode, median) in modes.iter().zip(medians) {
        println!(
            "{:<14} real-time factor {median:.3}, {:.2} x monolithic",
            mode.name(),
            median / medians[0]
        );
    }
}
