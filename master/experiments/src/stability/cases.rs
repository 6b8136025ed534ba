//! The hard cases, read from `cases.toml`.

use std::sync::Arc;

use serde::Deserialize;

use super::bench::Way;
use crate::engine::{Run, Stage, Variant};
use simulation::Mode;
use system::disturbance::{Deflection, Discards, Disturbance, Lift, Ramp};

/// A line of three spans under a lumped pantograph.
const SHORT_LINE: &str = include_str!("base.toml");

/// The six-body linkage of the thesis.
const LINKAGE: &str = include_str!("../../../../scenes/thesis-pantograph.toml");

/// The cases as data.
const CASES: &str = include_str!("cases.toml");

/// Part of its time that a quick look gives to an undamped case, –.
const QUICK: f64 = 0.1;

/// The cases as they are written, and what several of them have in common.
#[derive(Default, Deserialize)]
struct File {
    linkage: Vec<String>,
    undamped: Vec<String>,
    lowered: Vec<[f64; 3]>,
    case: Vec<Written>,
}

/// A case as it is written.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Written {
    name: String,
    about: String,
    linkage: bool,
    undamped: Option<f64>,
    set: Vec<String>,
    hard: Option<HardParameter>,
    lift: Vec<[f64; 3]>,
    lowered: bool,
    repeated: bool,
    discard_one_in: Option<u64>,
    deflection: Option<f64>,
    slow: bool,
}

/// The key that makes a case hard, with its value there.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HardParameter {
    /// N/m.
    ContactStiffness(f64),
    /// kg.
    HeadMass(f64),
}

impl HardParameter {
    /// Name, unit, a value that is harmless, and that of the case; both positive.
    pub(super) fn range(self) -> (&'static str, &'static str, (f64, f64)) {
        match self {
            Self::ContactStiffness(hard) => ("contact stiffness", "N/m", (5e4, hard)),
            Self::HeadMass(hard) => ("head mass", "kg", (7.2, hard)),
        }
    }

    /// The override that sets it to another value.
    pub(super) fn set(self, value: f64) -> String {
        match self {
            Self::ContactStiffness(_) => format!("contact.stiffness={value:?}"),
            Self::HeadMass(_) => format!("pantograph.0.masses=[{value:?},15.0]"),
        }
    }

    /// The override that makes the case hard.
    pub(super) fn key(self) -> String {
        let (.., (_, hard)) = self.range();
        self.set(hard)
    }
}

/// A scene, its disturbance, and the boundary that is looked for.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name in the table.
    pub name: String,
    /// Difficulty, one line.
    pub about: String,
    /// The scene that the overrides change.
    pub stage: Arc<Stage>,
    /// Keys, in the form of the command line.
    pub overrides: Vec<String>,
    /// Disturbance of the run.
    pub disturbance: Disturbance,
    /// Parameter by which its boundary is looked for; the step where there is none.
    pub parameter: Option<HardParameter>,
    /// `true` where it is run with every algorithm, and with the automatic choice through FMUs; the others have no
    /// meaning in a coupled run.
    pub coupled: bool,
    /// `true` where it takes long: no boundary is looked for.
    pub slow: bool,
}

impl Case {
    fn of(written: Written, common: &File, quick: bool) -> Self {
        let mut overrides: Vec<String> = Vec::new();
        if written.linkage {
            overrides.extend_from_slice(&common.linkage);
        }
        if let Some(seconds) = written.undamped {
            let seconds = if quick { QUICK * seconds } else { seconds };
            overrides.extend_from_slice(&common.undamped);
            overrides.extend([
                format!("run.duration={seconds}"),
                format!("run.evaluate={{time=[{},{}]}}", 0.1 * seconds, 0.9 * seconds),
            ]);
        }
        overrides.extend(written.set);
        overrides.extend(written.hard.map(HardParameter::key));
        let ramp = |&[start, duration, rise]: &[f64; 3]| Ramp { start, duration, rise };
        let ramps = if written.lowered {
            &common.lowered
        } else {
            &written.lift
        };
        Self {
            stage: Arc::new(Stage {
                name: written.name.clone(),
                base: ".".into(),
                scene: if written.linkage { LINKAGE } else { SHORT_LINE }.to_owned(),
                ..Stage::default()
            }),
            name: written.name,
            about: written.about,
            overrides,
            disturbance: Disturbance {
                audited: true,
                lift: (!ramps.is_empty()).then(|| Lift(ramps.iter().map(ramp).collect())),
                repeated: written.repeated,
                discards: written.discard_one_in.map(|one_in| Discards { seed: 50318, one_in }),
                deflection: written.deflection.map(|amplitude| Deflection { amplitude }),
            },
            parameter: written.hard,
            coupled: written.deflection.is_none(),
            slow: written.slow,
        }
    }

    /// The scene that all others change.
    pub(super) fn plain() -> Self {
        let written = Written {
            name: "plain".to_owned(),
            ..Written::default()
        };
        Self::of(written, &File::default(), false)
    }

    /// This case with packages of FMUs below `folder`.
    pub(super) fn with_fmus(mut self, folder: &std::path::Path) -> Self {
        let stage = Arc::make_mut(&mut self.stage);
        stage.fmus = folder.join(&stage.name);
        self
    }

    /// A run of the case in one way, with other keys besides.
    pub(super) fn run(&self, way: &Way, keys: &[String]) -> Run {
        let mut overrides = self.overrides.clone();
        if !way.algorithm.is_empty() {
            overrides.push(format!("coupling.algorithm=\"{}\"", way.algorithm));
        }
        overrides.extend_from_slice(keys);
        let variant = Variant {
            mode: way.mode,
            algorithm: way.algorithm.to_owned(),
            overrides,
        };
        let mut run = Run::of(&self.stage, variant);
        run.disturbance = Disturbance {
            audited: self.disturbance.audited && way.mode == Mode::Monolithic,
            ..self.disturbance.clone()
        };
        run
    }
}

/// All cases, in the order of the table; a quick look shortens the longest.
#[must_use]
pub fn cases(quick: bool) -> Vec<Case> {
    let mut file: File = toml::from_str(CASES).expect("the cases are part of the program, and a test reads them");
    let cases = std::mem::take(&mut file.case);
    cases
        .into_iter()
        .map(|written| Case::of(written, &file, quick))
        .collect()
}
