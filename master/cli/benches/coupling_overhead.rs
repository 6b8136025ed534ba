//! The master's own work per macro step: two slaves that do nothing, no output row, and an output row in every step.

use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use component::exchange::{contact, strip};
use cosim::algorithm::{self, Exchange, Sides};
use cosim::run;
use cosim::slave::{Abilities, Slave, SlaveError};
use criterion::{Criterion, criterion_group, criterion_main};
use results::LineGeometry;
use results::recorder::Recorder;
use results::report::{Progress, Show};
use system::run::{Schedule, Watch};

const H: f64 = 1e-3;
const SCENE: &str = include_str!("../../../scenes/en50318-300.toml");

/// A slave whose work is nil: constant outputs, inputs forgotten.
struct Nil {
    outputs: Vec<f64>,
    rollback: bool,
}

impl Slave for Nil {
    fn name(&self) -> &str {
        "nil"
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: self.rollback,
            input_derivatives: 3,
            variable_step: true,
        }
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        black_box(values);
        Ok(())
    }

    fn set_input_derivatives(&mut self, _order: usize, values: &[f64]) -> Result<(), SlaveError> {
        black_box(values);
        Ok(())
    }

    fn do_step(&mut self, _t: f64, _h: f64) -> Result<(), SlaveError> {
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.copy_from_slice(&self.outputs);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        Ok(())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        Ok(())
    }
}

/// Wall time of `steps` macro steps with a row every `output_step` s.
fn time_loop(coupling: &scene::Coupling, steps: u64, output_step: f64) -> Duration {
    let nil = |count: usize| Nil {
        outputs: vec![1.0; count],
        rollback: false,
    };
    let mut line = nil(contact::COUNT);
    let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(nil(strip::OUTPUTS))];
    let mut sides = Sides {
        line: &mut line,
        pantographs: &mut pantographs,
    };
    let (mut algorithm, _) = algorithm::build(coupling, &sides);
    let mut exchange = Exchange::start(&mut sides, 0.0, contact::COUNT).expect("constant outputs");
    let duration = H * steps as f64;
    let schedule = Schedule {
        duration,
        macro_step: H,
        may_shorten: true,
    };
    let mut recorder = Recorder::new(duration, output_step, 1, &[], LineGeometry::default());
    let (never, progress) = (AtomicBool::new(false), Progress::simulated("", duration, Show::Never));
    let watch = Watch::new(&never, &progress);
    let begin = Instant::now();
    let outcome = run::run(
        &mut sides,
        &mut *algorithm,
        &mut exchange,
        &mut recorder,
        schedule,
        &watch,
    );
    let wall = begin.elapsed();
    assert!(outcome.failure.is_none() && outcome.macro_steps == steps);
    wall
}

fn overhead(criterion: &mut Criterion) {
    let overrides = ["coupling.algorithm=\"gauss_seidel\"".to_owned()];
    let scene = system::load(SCENE, "en50318-300.toml", &overrides).expect("the shipped scene is good");
    let mean = scene.coupling.clone();
    let parabola = scene::Coupling {
        order: scene::Order::PantographFirst,
        force: scene::Force::Interpolated,
        extrapolation: 2,
        ..mean.clone()
    };
    let mut group = criterion.benchmark_group("macro_step");
    // Iterations are macro steps; loops are long, so that the start and the 500 pictures of a run count for little.
    for (name, coupling) in [("mean_force", &mean), ("parabola_and_cubic", &parabola)] {
        group.bench_function(format!("{name}/no_row"), |b| {
            b.iter_custom(|n| {
                let steps = n.max(200_000);
                time_loop(coupling, steps, H * steps as f64).mul_f64(n as f64 / steps as f64)
            });
        });
        group.bench_function(format!("{name}/row"), |b| {
            b.iter_custom(|n| {
                let steps = n.max(200_000);
                time_loop(coupling, steps, H).mul_f64(n as f64 / steps as f64)
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    targets = overhead
}
criterion_main!(benches);
