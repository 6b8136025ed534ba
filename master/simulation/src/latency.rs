//! Step times of a scene that is paced in real time.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use component::{Percentiles, Progress};
use results::report::format::counted;
use scene::Scene;
use serde::Serialize;
use system::run::Watch;
use system::step_times::StepTimes;

use crate::{FmuSource, Mode, SetupError, StaticLines, prepare_on};

/// Longest empty loop, s: rare disturbances show within.
const LONGEST_EMPTY_LOOP: f64 = 10.0;

/// A measurement of step times.
pub struct Latency<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Name of the scene.
    pub name: &'a str,
    /// Folder that paths in the scene begin at.
    pub base: &'a Path,
    /// How line and pantographs are put together.
    pub mode: Mode,
    /// Source of the FMUs.
    pub source: &'a FmuSource,
    /// Real time that steps are measured for, s: the run is repeated until it has passed.
    pub duration: f64,
}

/// Step times of a paced run.
#[derive(Clone, Debug, Serialize)]
pub struct LatencyReport {
    /// Name of the scene.
    pub scene: String,
    /// Mode.
    pub mode: &'static str,
    /// Time between two steps, s.
    pub macro_step_s: f64,
    /// Steps measured.
    pub steps: u64,
    /// Runs that these steps are of.
    pub runs: u64,
    /// Wall times of steps.
    pub step_times: Percentiles,
    /// Steps that ended after the next one was due, %.
    pub missed_percent: f64,
    /// Times by which steps began late.
    pub late: Percentiles,
    /// Times by which the passes of an empty loop at the same pace began late: disturbances of the machine.
    pub empty_loop: Percentiles,
    /// Why the last run did not reach its end; empty where all did.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub incomplete_reason: String,
}

impl Latency<'_> {
    /// Measures; ends early where `interrupted` is set or a run fails.
    ///
    /// # Errors
    /// See [`SetupError`].
    pub fn measure(&self, interrupted: &AtomicBool, progress: &dyn Progress) -> Result<LatencyReport, SetupError> {
        let macro_step_s = self.scene.coupling.macro_step;
        let empty = empty_loop(macro_step_s, self.duration.min(LONGEST_EMPTY_LOOP), interrupted);
        let lines = StaticLines::keeping(1);
        let mut all = StepTimes::new(false);
        let (mut runs, mut incomplete_reason) = (0, String::new());
        let begin = Instant::now();
        while incomplete_reason.is_empty() && !interrupted.load(Ordering::Relaxed) {
            let scene = self.scene.clone();
            let mut prepared = prepare_on(&lines, scene, self.name, self.base, self.source.logging)?;
            prepared.pictures = false;
            let watch = Watch {
                paced: true,
                ..Watch::new(interrupted, progress)
            };
            let finished = prepared.run(self.mode, self.source, &watch, |_| Ok::<(), SetupError>(()))?;
            all.add(&finished.step_times);
            incomplete_reason = finished.info.incomplete_reason;
            runs += 1;
            if begin.elapsed().as_secs_f64() >= self.duration {
                break;
            }
        }
        Ok(LatencyReport {
            scene: self.name.to_owned(),
            mode: self.mode.name(),
            macro_step_s,
            steps: all.count(),
            runs,
            step_times: all.steps(),
            missed_percent: 100.0 * all.missed() as f64 / (all.count().max(1)) as f64,
            late: all.late(),
            empty_loop: empty.late(),
            incomplete_reason,
        })
    }
}

/// A paced loop without work.
fn empty_loop(step: f64, duration: f64, interrupted: &AtomicBool) -> StepTimes {
    let mut times = StepTimes::new(true);
    for n in 0..(duration / step) as u64 {
        if interrupted.load(Ordering::Relaxed) {
            break;
        }
        times.begin(n as f64 * step);
        times.end((n + 1) as f64 * step);
    }
    times
}

impl LatencyReport {
    /// The report as a table of text.
    #[must_use]
    pub fn text(&self) -> String {
        let row = |name: &str, times: &Percentiles| {
            let cells = [times.p50_s, times.p99_s, times.p99_9_s, times.p99_99_s, times.longest_s];
            let cells: String = cells.iter().map(|time| format!("{:>10.1}", 1e6 * time)).collect();
            format!("{name:<28}{cells}\n")
        };
        let mut text = format!(
            "{} ({}), paced at {} ms: {} steps in {}, {:.3} % ended late\n\n\
             {:<28}{:>10}{:>10}{:>10}{:>10}{:>10}\n",
            self.scene,
            self.mode,
            1e3 * self.macro_step_s,
            self.steps,
            counted(self.runs, "run", "runs"),
            self.missed_percent,
            "time in µs",
            "50 %",
            "99 %",
            "99.9 %",
            "99.99 %",
            "longest"
        );
        text.push_str(&row("step", &self.step_times));
        text.push_str(&row("late start of a step", &self.late));
        text.push_str(&row("late start, empty loop", &self.empty_loop));
        if !self.incomplete_reason.is_empty() {
            text.push_str(&format!(
                "\nThe last run did not reach its end: {}\n",
                self.incomplete_reason
            ));
        }
        text
    }
}
