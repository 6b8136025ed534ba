//! Runs of scenes through the program's own functions, and differences between them.
use cosim::package;
use results::report::{Progress, Show};
use results::statistics::ForceStatistics;
use results::{Record, Summary};
use scene::Scene;
use simulation::{Finished, FmuSource, Mode, Prepared, SetupError, prepare};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use system::one_system::Evidence;
use system::run::Watch;

/// The reference model of EN 50318 at 250 km/h.
pub const EN_250: &str = include_str!("../scenes/en50318-250.toml");
/// The reference model of EN 50318 at 300 km/h.
pub const EN_300: &str = include_str!("../scenes/en50318-300.toml");

/// Some spans of a line, and a journey over three of them.
pub const THREE_SPANS: [&str; 4] = [
    "catenary.spans=5",
    "run.start_x=40",
    "run.duration=2.2",
    "run.evaluate={time=[0.3,2.0]}",
];

/// A second on a short line of the thesis, without the dampers of its droppers and of the integrator.
pub const SECOND_ON_THESIS_LINE: [&str; 6] = [
    "catenary.spans=3",
    "run.start_x=20",
    "run.duration=1",
    "run.evaluate={time=[0.2,0.8]}",
    "solver.rho_inf=1",
    "catenary.droppers.damping=0",
];

/// A complete run.
pub struct Run {
    /// Summary as the program would write it.
    pub summary: Summary,
    /// The scene as the program writes it.
    pub written: String,
    /// Series of the run.
    pub record: Record,
    /// Low-pass filtered contact force of the first pantograph, whole record, N.
    pub filtered: Vec<f64>,
    /// Samples of the evaluation range.
    pub range: Range<usize>,
}

impl Run {
    /// Statistics of the filtered force in the evaluation range, N.
    #[must_use]
    pub fn statistics(&self) -> ForceStatistics {
        ForceStatistics::of(&self.filtered[self.range.clone()]).unwrap()
    }

    /// Standard deviation of the filtered force in the evaluation range, N.
    #[must_use]
    pub fn sigma(&self) -> f64 {
        self.statistics().std
    }

    /// Raw contact force in the evaluation range, N.
    #[must_use]
    pub fn raw(&self) -> &[f64] {
        &self.record.pantographs[0].force[self.range.clone()]
    }

    /// rms difference of the filtered force in the evaluation range, N.
    #[must_use]
    pub fn filtered_difference(&self, other: &Self) -> f64 {
        assert_eq!(self.range, other.range);
        rms(&self.filtered[self.range.clone()], &other.filtered[other.range.clone()])
    }

    /// rms difference of the raw force in the evaluation range, N.
    #[must_use]
    pub fn raw_difference(&self, other: &Self) -> f64 {
        rms(self.raw(), other.raw())
    }
}

/// Root mean square of the difference of two series.
///
/// # Panics
/// When they differ in length.
#[must_use]
pub fn rms(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt()
}

/// A scene with other values.
///
/// # Panics
/// When it is refused.
#[must_use]
pub fn scene_with(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    system::load(text, "scene.toml", &overrides).unwrap()
}

/// The scene with its statics and its start.
///
/// # Panics
/// When there are none.
#[must_use]
pub fn prepared(scene: Scene, name: &str) -> Prepared {
    prepare(scene, name, Path::new("."), false).unwrap()
}

/// Runs a scene from its statics to its summary; FMUs go to a folder of that `name`, apart from those of the program.
///
/// # Panics
/// When the run does not come to its end.
#[must_use]
pub fn run(scene: Scene, mode: Mode, name: &str) -> Run {
    run_beside(scene, mode, name, Path::new("."))
}

/// [`run`] for a scene whose file is in the folder `base`.
///
/// # Panics
/// When the run does not come to its end.
#[must_use]
pub fn run_beside(scene: Scene, mode: Mode, name: &str, base: &Path) -> Run {
    let mut written = String::new();
    let finished = finished_telling(prepare(scene, name, base, false).unwrap(), mode, name, |scene| {
        written = scene.to_toml();
    });
    let info = &finished.info;
    let filtered = info.evaluation.filtered(&finished.record.pantographs[0].force).unwrap();
    let range = info.evaluation.samples(&finished.record.time, 0);
    assert!(!range.is_empty());
    Run {
        summary: Summary::new(info, &finished.record),
        written,
        record: finished.record,
        filtered,
        range,
    }
}

/// Runs a prepared scene to its end.
///
/// # Panics
/// When the run does not come to its end.
#[must_use]
pub fn finished(prepared: Prepared, mode: Mode, name: &str) -> Finished {
    finished_telling(prepared, mode, name, |_| {})
}

/// Runs a prepared scene as one system with its energy followed.
///
/// # Panics
/// When the run does not come to its end.
#[must_use]
pub fn audited(mut prepared: Prepared, name: &str) -> (Finished, Evidence) {
    prepared.disturbance.audited = true;
    let finished = finished(prepared, Mode::Monolithic, name);
    let evidence = finished.evidence.unwrap();
    (finished, evidence)
}

/// [`finished`]; `tell` is given the scene as it is run.
fn finished_telling(prepared: Prepared, mode: Mode, name: &str, mut tell: impl FnMut(&Scene)) -> Finished {
    let never = AtomicBool::new(false);
    let progress = Progress::simulated(name, prepared.scene.run.duration, Show::Never);
    let watch = Watch::new(&never, &progress);
    let source = FmuSource {
        folder: package::folder(&format!("test-{name}")),
        logging: false,
    };
    let finished = prepared
        .run(mode, &source, &watch, |scene| {
            tell(scene);
            Ok::<(), Box<SetupError>>(())
        })
        .unwrap();
    assert!(finished.failure.is_none(), "{name}: {:?}", finished.failure);
    finished
}
