//! The hard cases as an experiment: every case in every way, and the curves of the maps, made side by side.

use std::time::Duration;

use fmi2::scratch::Scratch;
use serde::Serialize;

use super::bench::{CaseBench, Way};
use super::cases::Case;
use super::figures::Figures;
use super::maps::{Boundary, Map, Task, assemble, tasks};
use crate::engine::table::{Columns, RunRow, Status};
use crate::engine::{Bench, Experiment, Planned, Sheet, Table, Unmade};
use results::report::Page;
use simulation::Mode;

/// Wall time after which a run is ended: far more than the longest one needs.
const LIMIT: Duration = Duration::from_secs(300);

/// Coupling algorithms.
pub const ALGORITHMS: [&str; 5] = ["jacobi", "gauss_seidel", "iterated", "interface_jacobian", "auto"];

/// One run of a case.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Line {
    /// Name of the case.
    pub case: String,
    /// Its difficulty.
    pub about: String,
    /// The columns of all tables.
    #[serde(flatten)]
    pub row: RunRow,
    /// The figures that prove it.
    #[serde(flatten)]
    pub figures: Figures,
}

/// The table of the hard cases, complete or not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StabilityTable {
    /// `true` where every run was made.
    pub complete: bool,
    /// One per run.
    pub lines: Vec<Line>,
    /// Boundaries beyond which runs are not stable.
    pub maps: Vec<Map>,
}

impl Table for StabilityTable {
    fn sheet(&self) -> Sheet {
        let columns = || Columns::of(&self.lines);
        Sheet {
            leading: columns().column("case", |line| line.case.clone()).finish(),
            rows: self.lines.iter().map(|line| line.row.clone()).collect(),
            trailing: columns()
                .column("about", |line| line.about.clone())
                .column("energy_growth_W", |line| line.figures.energy_growth)
                .column("energy_share_percent", |line| line.figures.energy_share)
                .column("omega_h", |line| line.figures.omega_h)
                .column("amplification", |line| line.figures.amplification)
                .column("most_newton_iterations", |line| line.figures.most_iterations)
                .column("constraint_drift_m", |line| line.figures.drift)
                .column("constraint_rate_m_per_s", |line| line.figures.drift_rate)
                .column("largest_force_N", |line| line.figures.largest_force)
                .column("slack_droppers", |line| line.figures.slack_droppers)
                .column("boundary", |line| line.figures.boundary.clone())
                .finish(),
        }
    }

    fn is_complete(&self) -> bool {
        self.complete
    }

    fn text(&self) -> String {
        super::text::text(self)
    }

    fn sections(&self) -> Page {
        super::page::page(self)
    }
}

/// The hard cases to be run.
#[derive(Debug)]
pub struct Stability {
    cases: Vec<Case>,
    /// `true` where limits get their boundary.
    boundaries: bool,
    /// Each case in each way: number of the case, way.
    lines: Vec<(usize, Way)>,
    /// Curves of the maps.
    tasks: Vec<Task>,
    /// Packages of FMUs.
    _fmus: Option<Scratch>,
}

impl Stability {
    /// All cases in all ways, through FMUs too with `fmus`, boundaries of limits with `boundaries`; `resolution` is the
    /// number of points of a curve of the maps, 0 draws none.
    ///
    /// # Errors
    /// A folder for packages that cannot be made.
    pub fn new(cases: Vec<Case>, fmus: bool, boundaries: bool, resolution: usize) -> std::io::Result<Self> {
        let folder = fmus.then(Scratch::new).transpose()?;
        let at = |case: Case| match &folder {
            Some(folder) => case.with_fmus(folder.path()),
            None => case,
        };
        let cases: Vec<Case> = cases.into_iter().map(at).collect();
        let lines = cases.iter().enumerate();
        let lines = lines.flat_map(|(index, case)| ways(case, fmus).into_iter().map(move |way| (index, way)));
        Ok(Self {
            lines: lines.collect(),
            cases,
            boundaries,
            tasks: if resolution > 0 { tasks(resolution) } else { Vec::new() },
            _fmus: folder,
        })
    }
}

/// The ways in which a case is run, one system first.
fn ways(case: &Case, fmus: bool) -> Vec<Way> {
    let mut ways = vec![Way::ONE];
    if case.coupled {
        let coupled = |mode, algorithm| Way { mode, algorithm };
        ways.extend(ALGORITHMS.map(|algorithm| coupled(Mode::Inprocess, algorithm)));
        if fmus {
            ways.push(coupled(Mode::Cosimulation, "auto"));
        }
    }
    ways
}

/// Outcome of a job.
#[derive(Clone, Debug)]
pub enum StabilityFound {
    /// A line of the table.
    Line(Box<Line>),
    /// Points of a curve.
    MapCurve(Boundary),
}

impl Experiment for Stability {
    /// Number of a line of the table, or behind those of a curve.
    type Job = usize;
    type Found = StabilityFound;
    type Table = StabilityTable;

    fn plan(&self) -> Vec<Planned<usize>> {
        let line = |(index, (case, way)): (usize, &(usize, Way))| {
            // Long ones first, then those that judge others, so that no worker waits for another.
            let slow = if self.cases[*case].slow { 4.0 } else { 2.0 };
            let work = if *way == Way::ONE { slow + 1.0 } else { slow };
            Planned::beside(index, work)
        };
        let lines = self.lines.iter().enumerate().map(line);
        let all = self.lines.len() + self.tasks.len();
        let curves = (self.lines.len()..all).map(|index| Planned::beside(index, 1.0));
        lines.chain(curves).collect()
    }

    fn make(&self, index: &usize, bench: &Bench<'_>) -> Result<StabilityFound, Unmade> {
        let Some((case, way)) = self.lines.get(*index) else {
            let task = &self.tasks[index - self.lines.len()];
            return Ok(StabilityFound::MapCurve(task.points(bench)?));
        };
        let case = CaseBench {
            case: &self.cases[*case],
            bench,
        };
        Ok(StabilityFound::Line(Box::new(self.line(&case, way)?)))
    }

    fn judge(&self, found: &[Option<StabilityFound>]) -> StabilityTable {
        let (lines, curves) = found.split_at(self.lines.len());
        let line = |(found, (case, way)): (&Option<StabilityFound>, &(usize, Way))| match found {
            Some(StabilityFound::Line(line)) => Line::clone(line),
            _ => planned(&self.cases[*case], way),
        };
        let points = |found: &Option<StabilityFound>| match found {
            Some(StabilityFound::MapCurve(points)) => Some(points.clone()),
            _ => None,
        };
        StabilityTable {
            complete: found.iter().all(Option::is_some),
            lines: lines.iter().zip(&self.lines).map(line).collect(),
            maps: assemble(&self.tasks, curves.iter().map(points).collect()),
        }
    }

    fn whole_forces(&self) -> bool {
        false
    }

    fn limit(&self) -> Option<Duration> {
        Some(LIMIT)
    }
}

impl Stability {
    /// The line of a case in one way.
    fn line(&self, case: &CaseBench<'_>, way: &Way) -> Result<Line, Unmade> {
        let mut judged = case.run(way, &[])?;
        let open = matches!(judged.row.status, Some(Status::Limit | Status::Diverged));
        if self.boundaries && !case.case.slow && open {
            judged.figures.boundary = case.boundary(way)?;
        }
        Ok(Line {
            row: judged.row,
            figures: judged.figures,
            ..planned(case.case, way)
        })
    }
}

/// The line of a run that has not been made.
fn planned(case: &Case, way: &Way) -> Line {
    Line {
        case: case.name.clone(),
        about: case.about.clone(),
        row: RunRow {
            scene: case.name.clone(),
            mode: way.mode.name().to_owned(),
            algorithm: way.algorithm.to_owned(),
            ..RunRow::default()
        },
        figures: Figures::default(),
    }
}
