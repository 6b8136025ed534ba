//! The runs of a reproduction.

use serde::Serialize;

use super::open::{OPEN, Value};
use super::published::{CASES, Case};
use super::wind::readings;
use crate::engine::{Variant, words};
use simulation::Mode;

words! {
    /// Purpose of a run.
    pub enum RunGroup {
        /// A published case, as its scene has it.
        Published = "published",
        /// A published case on another mesh.
        Mesh = "mesh",
        /// A reading of the published wind.
        Reading = "reading",
        /// A quantity that the publication leaves open.
        Open = "open",
    }
}

impl RunGroup {
    /// `true` where its runs are published cases with nothing changed but the mesh.
    pub(super) fn is_case(self) -> bool {
        matches!(self, Self::Published | Self::Mesh)
    }
}

/// A mesh of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Mesh {
    /// Plain elements, so many per dropper interval: nine intervals make a span, so that 1 is the thesis' mesh.
    Plain(usize),
    /// Eight elements per interval with all corrections, at half the thesis' step: converged to one percent of the
    /// standard deviation.
    Corrected,
}

impl Mesh {
    /// From the thesis' mesh to a converged one.
    pub const ALL: [Self; 5] = [
        Self::Plain(1),
        Self::Plain(2),
        Self::Plain(4),
        Self::Plain(8),
        Self::Corrected,
    ];

    /// Name.
    pub(super) fn name(self) -> String {
        match self {
            Self::Plain(count) => format!("{} elements per span", 9 * count),
            Self::Corrected => "72 corrected elements per span".to_owned(),
        }
    }

    /// The keys that make it.
    pub(super) fn keys(self) -> Vec<String> {
        let (elements, corrections) = match self {
            Self::Plain(count) => (count, "none"),
            Self::Corrected => (8, "auto"),
        };
        let mut keys = vec![
            format!("catenary.mesh.elements_per_interval={elements}"),
            format!("catenary.mesh.corrections={corrections:?}"),
        ];
        if self == Self::Corrected {
            keys.push("solver.micro_step=0.0005".to_owned());
        }
        keys
    }
}

/// A run to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct ReproductionRun {
    /// Purpose.
    pub group: RunGroup,
    /// The published case that it is a variant of.
    pub case: &'static Case,
    /// Mesh of the line.
    pub mesh: Mesh,
    /// Quantity that was changed besides the mesh; empty for a published case.
    pub quantity: &'static str,
    /// To what, with its unit.
    pub value: String,
    /// Variant of the scene.
    pub variant: Variant,
}

impl ReproductionRun {
    /// The run with a quantity that has another value.
    fn with(mut self, quantity: &'static str, value: Value) -> Self {
        // Behind the mesh, whose step it may change.
        self.variant.overrides.extend(value.keys);
        (self.quantity, self.value) = (quantity, value.name);
        self
    }
}

/// All runs: the published cases in both ways of running them, all of them on finer meshes, the readings of the wind,
/// and, on the thesis' mesh and on the converged one, each open quantity over its range. `quick` leaves out the finer
/// plain meshes but one, and the open quantities on the converged mesh. `overrides` hold for all runs, and give way to
/// what a run is about.
pub(super) fn plan(quick: bool, overrides: &[String]) -> Vec<ReproductionRun> {
    let [thesis, ..] = Mesh::ALL;
    let mut runs = Vec::new();
    for case in CASES.iter() {
        runs.push(planned(RunGroup::Published, case, thesis, Mode::Monolithic));
    }
    runs.push(planned(RunGroup::Published, &CASES[0], thesis, Mode::Cosimulation));
    for mesh in Mesh::ALL {
        if mesh != thesis && (!quick || mesh == Mesh::Plain(2)) {
            let of_case = |case| planned(RunGroup::Mesh, case, mesh, Mode::Monolithic);
            runs.extend(CASES.iter().map(of_case));
        }
    }
    for reading in readings() {
        runs.push(planned(RunGroup::Reading, &CASES[2], thesis, Mode::Monolithic).with("wind", reading));
    }
    for mesh in [thesis, Mesh::Corrected] {
        if quick && mesh == Mesh::Corrected {
            continue;
        }
        let own = mesh.keys();
        for open in OPEN.iter().filter(|open| open.is_on(mesh)) {
            for value in open.values() {
                // The mesh's own value is the case itself.
                if value.keys.iter().all(|key| own.contains(key)) {
                    continue;
                }
                let run = planned(RunGroup::Open, &CASES[open.case], mesh, Mode::Monolithic);
                runs.push(run.with(&open.quantity, value));
            }
        }
    }
    for run in &mut runs {
        run.variant.overrides.splice(0..0, overrides.iter().cloned());
    }
    runs
}

fn planned(group: RunGroup, case: &'static Case, mesh: Mesh, mode: Mode) -> ReproductionRun {
    let own = matches!(group, RunGroup::Published | RunGroup::Reading);
    ReproductionRun {
        group,
        case,
        mesh,
        quantity: "",
        value: String::new(),
        variant: Variant {
            mode,
            algorithm: if mode == Mode::Monolithic { "" } else { "auto" }.to_owned(),
            overrides: if own { Vec::new() } else { mesh.keys() },
        },
    }
}
