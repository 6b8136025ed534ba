//! One case in one way: its run, the one system that judges it, and the boundary where it stops being stable.

use super::cases::{Case, HardParameter};
use super::figures::Judged;
use crate::engine::table::{RunRow, Status};
use crate::engine::{Bench, Unmade};
use results::report::format::significant;
use simulation::Mode;

/// Micro steps of the reference in one of the run.
const REFINED: f64 = 2.0;

/// Halvings of the step in the search for a stable one.
const HALVINGS: u32 = 3;

/// Bisections between the harmless and the hard value of a parameter.
const PARAMETER_BISECTIONS: u32 = 4;

/// Bisections between the last stable step and the first one that is not.
const BISECTIONS: u32 = 2;

/// Way of running a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Way {
    /// Composition of line and pantographs.
    pub mode: Mode,
    /// Coupling algorithm; none in one system.
    pub algorithm: &'static str,
}

impl Way {
    /// One system.
    pub const ONE: Self = Self {
        mode: Mode::Monolithic,
        algorithm: "",
    };
}

/// Macro and micro step of a case with these keys, s; `None` where the scene is refused.
pub(super) fn steps(case: &Case, keys: &[String]) -> Option<(f64, f64)> {
    let scene = case.run(&Way::ONE, keys).scene().ok()?;
    let row = RunRow::planned(&case.name, &scene, Mode::Inprocess, "");
    row.macro_step.zip(row.micro_step)
}

/// The keys of one micro step for both sides, s.
pub(super) fn both_steps(step: f64) -> [String; 2] {
    [
        format!("coupling.macro_step={step:?}"),
        format!("solver.micro_step={step:?}"),
    ]
}

/// The keys that refine the micro step (s) of a run for its reference.
pub(super) fn refined(micro_step: f64) -> Vec<String> {
    both_steps(micro_step / REFINED).to_vec()
}

/// A case on the bench.
pub(super) struct CaseBench<'a> {
    pub case: &'a Case,
    pub bench: &'a Bench<'a>,
}

impl CaseBench<'_> {
    /// A run of the case with other keys, judged by another run with its name.
    pub fn make(&self, way: &Way, keys: &[String], judge: Option<(&str, &Judged)>) -> Result<Judged, Unmade> {
        let run = self.case.run(way, keys);
        let made = self.bench.run_part(&run, 0.0)?;
        Ok(Judged::of(&run, made, judge))
    }

    /// A run of the case with other keys, judged by the one system; that by itself at a finer micro step.
    pub fn run(&self, way: &Way, keys: &[String]) -> Result<Judged, Unmade> {
        let Some((_, micro)) = steps(self.case, keys) else {
            return self.make(way, keys, None);
        };
        let is_step = |key: &&String| key.starts_with("coupling.macro_step") || key.starts_with("solver.micro_step");
        let mut one_keys: Vec<String> = keys.iter().filter(|key| !is_step(key)).cloned().collect();
        one_keys.extend(both_steps(micro));
        let mut finer_keys = one_keys.clone();
        finer_keys.extend(refined(micro));
        let finer = self.make(&Way::ONE, &finer_keys, None)?;
        let finest = finer.row.micro_step.unwrap_or(f64::NAN);
        let name = format!("monolithic, micro step {finest:?} s");
        let judge = finer.row.is_stable().then_some((name.as_str(), &finer));
        let mut one = self.make(&Way::ONE, &one_keys, judge)?;
        if !finer.row.is_stable() && one.row.is_stable() {
            let reason = format!("at a finer micro step: {}", finer.row.reason);
            one.row.judge((Status::Limit, reason));
        }
        if way.mode == Mode::Monolithic {
            return Ok(one);
        }
        if !matches!(one.row.status, Some(Status::Stable | Status::Limit)) {
            return self.make(way, keys, None);
        }
        let name = format!("monolithic, micro step {micro:?} s");
        let mut made = self.make(way, keys, Some((name.as_str(), &one)))?;
        if made.row.is_stable() && one.row.status == Some(Status::Limit) {
            made.row
                .judge((Status::Limit, format!("as one system: {}", one.row.reason)));
        }
        Ok(made)
    }

    /// Boundary at which a run that is not stable becomes so.
    pub fn boundary(&self, way: &Way) -> Result<String, Unmade> {
        match self.case.parameter {
            Some(parameter) => self.by_parameter(way, parameter),
            None => self.by_step(way),
        }
    }

    /// `true` where a run with other keys is stable.
    fn is_stable(&self, way: &Way, keys: &[String]) -> Result<bool, Unmade> {
        Ok(self.run(way, keys)?.row.is_stable())
    }

    /// The value of the parameter between the harmless and the hard one, by bisection of its logarithm.
    fn by_parameter(&self, way: &Way, parameter: HardParameter) -> Result<String, Unmade> {
        let (name, unit, ends) = parameter.range();
        let shown = |value: f64| format!("{} {unit}", significant(Some(value)).unwrap_or_default());
        let mut stable = |value: f64| self.is_stable(way, &[parameter.set(value)]);
        if !stable(ends.0)? {
            return Ok(format!("not stable at a {name} of {} either", shown(ends.0)));
        }
        let (good, bad) = bisected(ends, PARAMETER_BISECTIONS, &mut stable)?;
        Ok(format!("stable at a {name} of {}, not at {}", shown(good), shown(bad)))
    }

    /// The longest step: macro and micro step shortened together, halved and then bisected.
    fn by_step(&self, way: &Way) -> Result<String, Unmade> {
        let Some((macro_step, micro)) = steps(self.case, &[]) else {
            return Ok(String::new());
        };
        let (which, start) = if way.mode == Mode::Monolithic {
            ("micro step", micro)
        } else {
            ("macro step", macro_step)
        };
        let mut stable = |step: f64| {
            let keys = [
                format!("coupling.macro_step={step:?}"),
                format!("solver.micro_step={:?}", step.min(micro)),
            ];
            self.is_stable(way, &keys)
        };
        let shown = |step: f64| format!("{} ms", (1e6 * step).round() / 1e3);
        let mut bad = start;
        for _ in 0..HALVINGS {
            let step = 0.5 * bad;
            if stable(step)? {
                let (good, bad) = bisected((step, bad), BISECTIONS, &mut stable)?;
                return Ok(format!("stable to a {which} of {}, not at {}", shown(good), shown(bad)));
            }
            bad = step;
        }
        Ok(format!("not stable down to a {which} of {}", shown(bad)))
    }
}

/// A stable and an unstable value brought nearer to each other, the logarithm of their ratio halved so many times.
fn bisected(
    (mut good, mut bad): (f64, f64),
    times: u32,
    stable: &mut dyn FnMut(f64) -> Result<bool, Unmade>,
) -> Result<(f64, f64), Unmade> {
    for _ in 0..times {
        let middle = (good * bad).sqrt();
        if stable(middle)? {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Ok((good, bad))
}
