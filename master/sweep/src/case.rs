//! One case: its scene, its run, its record.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use component::Progress;
use cosim::chain;
use experiments::engine::table::Status;
use results::{Record as Series, RunInfo};
use serde::{Deserialize, Serialize};
use simulation::{Finished, FmuSource, Mode, SetupError, StaticLines, prepare_on};
use system::run::Watch;

use crate::base::Base;
use crate::plan::{Case, Plan};
use crate::record::{Record, SeriesPlace};

/// Surroundings of all cases.
pub struct Cases<'a> {
    /// Scene.
    pub base: &'a Base,
    /// Plan.
    pub plan: &'a Plan,
    /// Mode of the runs.
    pub mode: Mode,
    /// FMUs of a co-simulation.
    pub source: &'a FmuSource,
    /// Lines at rest that several cases have in common.
    pub lines: &'a StaticLines,
    /// Pantographs of a case that has no scene.
    pub pantographs: usize,
    /// `true` where filtered forces are kept.
    pub series: bool,
}

/// A finished case with its filtered forces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Record; places of its series are not known yet.
    pub record: Record,
    /// Filtered forces, N, one series for each pantograph.
    pub series: Vec<Vec<f64>>,
}

impl Cases<'_> {
    /// Makes a case; nothing where `stop` ended it. One that cannot begin is refused, one that panics has diverged,
    /// each with its reason.
    #[must_use]
    pub fn make(&self, case: &Case, stop: &AtomicBool, progress: &dyn Progress) -> Option<Made> {
        let caught = catch_unwind(AssertUnwindSafe(|| self.made(case, stop, progress)));
        caught.unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or_default();
            Some(self.failed(case, Status::Diverged, &format!("panicked: {text}")))
        })
    }

    fn failed(&self, case: &Case, status: Status, reason: &str) -> Made {
        let record = Record::without_figures(case.number, status, reason, self.pantographs);
        Made {
            record,
            series: Vec::new(),
        }
    }

    fn made(&self, case: &Case, stop: &AtomicBool, progress: &dyn Progress) -> Option<Made> {
        if let Some(undefined) = self.plan.undefined(case) {
            return Some(self.failed(case, Status::Refused, &undefined));
        }
        match self.run(case, stop, progress) {
            Ok(finished) if finished.failure.is_some() && stop.load(Ordering::Relaxed) => None,
            Ok(finished) => {
                let record = Record::of(case.number, &finished.info, &finished.record);
                Some(self.with_series(record, &finished.info, &finished.record))
            }
            Err(_) if stop.load(Ordering::Relaxed) => None,
            Err(error) => {
                let reason = self.plan.with_expressions(case, &chain(&error));
                Some(self.failed(case, Status::Refused, &reason))
            }
        }
    }

    fn run(&self, case: &Case, stop: &AtomicBool, progress: &dyn Progress) -> Result<Finished, SetupError> {
        let Base { name, folder, .. } = self.base;
        let scene = self.base.scene(&self.plan.overrides(case))?;
        let mut prepared = prepare_on(self.lines, scene, name, folder, self.source.logging)?;
        prepared.pictures = false;
        prepared.run(self.mode, self.source, &Watch::new(stop, progress), |_| Ok(()))
    }

    fn with_series(&self, mut record: Record, info: &RunInfo, series: &Series) -> Made {
        let mut kept = Vec::new();
        if self.series && record.status == Status::Stable {
            for (index, strip) in series.pantographs.iter().enumerate() {
                let range = info.evaluation.samples(&series.time, index);
                // A stable case has a filtered force.
                let force = info.evaluation.filtered(&strip.force).unwrap_or_default();
                let from = series.time.get(range.start).copied().unwrap_or_default();
                record.series.push(SeriesPlace {
                    from,
                    step: info.evaluation.output_step,
                    ..SeriesPlace::default()
                });
                kept.push(force.get(range).unwrap_or_default().to_vec());
            }
        }
        Made { record, series: kept }
    }
}
