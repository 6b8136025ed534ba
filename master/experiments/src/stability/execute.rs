//! Making the table: cases side by side, the runs of each in turn.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::cases::{Case, Coupled, Knob};
use super::maps::{Boundary, Map, Task, tasks};
use super::trial::{Figures, Made, Way, make, refined, steps};
use crate::table_of_runs::significant;
use crate::table_of_runs::{Cell, Column, Row, Status};
use results::report::Progress;
use simulation::Mode;

/// Wall time after which a run is ended, s: the longest one needs a tenth of it.
const LIMIT: u64 = 300;

/// Coupling algorithms.
pub const ALGORITHMS: [&str; 5] = ["jacobi", "gauss_seidel", "iterated", "interface_jacobian", "auto"];

/// Halvings of the step in the search for a stable one.
const HALVINGS: u32 = 3;

/// Bisections between the harmless and the hard value of a knob.
const KNOB_BISECTIONS: u32 = 4;

/// Bisections between the last stable step and the first one that is not.
const BISECTIONS: u32 = 2;

/// One run of a case.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Line {
    /// Name of the case.
    pub case: String,
    /// What is hard about it.
    pub about: String,
    /// The columns of all tables.
    #[serde(flatten)]
    pub row: Row,
    /// The figures that prove it.
    #[serde(flatten)]
    pub figures: Figures,
}

/// The table of the hard cases, complete or not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StabilityTable {
    /// Whether every run was made.
    pub complete: bool,
    /// One per run.
    pub lines: Vec<Line>,
    /// Where runs stop being stable.
    pub maps: Vec<Map>,
}

impl StabilityTable {
    /// Number of rows with a status.
    #[must_use]
    pub fn count(&self, status: Status) -> usize {
        self.lines.iter().filter(|line| line.row.status == Some(status)).count()
    }

    /// The rows.
    #[must_use]
    pub fn rows(&self) -> Vec<Row> {
        self.lines.iter().map(|line| line.row.clone()).collect()
    }

    /// The columns before and behind the common ones.
    #[must_use]
    pub fn columns(&self) -> (Vec<Column>, Vec<Column>) {
        let cells = |cell: &dyn Fn(&Line) -> String| self.lines.iter().map(cell).collect();
        let figure = |pick: fn(&Figures) -> Option<f64>| cells(&|line| pick(&line.figures).cell());
        (
            vec![("case", cells(&|line| line.case.clone()))],
            vec![
                ("about", cells(&|line| line.about.clone())),
                ("energy_growth_W", figure(|figures| figures.energy_growth)),
                ("energy_share_percent", figure(|figures| figures.energy_share)),
                ("omega_h", figure(|figures| figures.omega_h)),
                ("amplification", figure(|figures| figures.amplification)),
                (
                    "most_newton_iterations",
                    cells(&|line| line.figures.most_iterations.cell()),
                ),
                ("constraint_drift_m", figure(|figures| figures.drift)),
                ("constraint_rate_m_per_s", figure(|figures| figures.drift_rate)),
                ("largest_force_N", figure(|figures| figures.largest_force)),
                ("slack_droppers", cells(&|line| line.figures.slack_droppers.cell())),
                ("boundary", cells(&|line| line.figures.boundary.clone())),
            ],
        )
    }
}

/// What is to be done.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Cases.
    pub cases: Vec<Case>,
    /// Whether the automatic choice is run through FMUs too.
    pub fmus: bool,
    /// Whether limits get their boundary.
    pub boundaries: bool,
    /// Points of a curve of the maps; 0 draws none.
    pub resolution: usize,
    /// Runs made side by side.
    pub workers: usize,
}

impl Plan {
    /// The ways in which a case is run, one system first.
    fn ways(&self, case: &Case) -> Vec<Way> {
        let mut ways = vec![Way::ONE];
        if case.coupled == Coupled::All {
            let coupled = |mode, algorithm| Way { mode, algorithm };
            ways.extend(ALGORITHMS.map(|algorithm| coupled(Mode::Inprocess, algorithm)));
            if self.fmus {
                ways.push(coupled(Mode::Cosimulation, "auto"));
            }
        }
        ways
    }
}

/// A piece of work: a case, or a curve of a map.
enum Job<'a> {
    Case(usize, &'a Case),
    Curve(usize, &'a Task),
}

/// A worker's run under way: when it began, and the flag that ends it.
#[derive(Default)]
struct Guard {
    since: Mutex<Option<Instant>>,
    stop: AtomicBool,
}

impl Guard {
    /// Makes a run that is ended when it takes too long.
    fn watched<T>(&self, run: impl FnOnce(&AtomicBool) -> T) -> (T, bool) {
        self.stop.store(false, Ordering::Relaxed);
        *self.since.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
        let result = run(&self.stop);
        let began = self.since.lock().unwrap_or_else(PoisonError::into_inner).take();
        let late = began.is_some_and(|began| began.elapsed() >= Duration::from_secs(LIMIT));
        (result, late)
    }
}

/// Makes all runs; `keep` is given the table from time to time, so that nothing computed is lost.
///
/// # Errors
/// What `keep` returns.
pub fn execute<E>(
    plan: &Plan,
    interrupted: &AtomicBool,
    progress: &Progress,
    keep: &mut dyn FnMut(&StabilityTable) -> Result<(), E>,
) -> Result<StabilityTable, E> {
    let tasks = if plan.resolution > 0 {
        tasks(plan.resolution)
    } else {
        Vec::new()
    };
    // The longest first, so that no worker is left with one at the end.
    let mut jobs: Vec<Job<'_>> = plan
        .cases
        .iter()
        .enumerate()
        .map(|(i, case)| Job::Case(i, case))
        .collect();
    jobs.sort_by_key(|job| match job {
        Job::Case(_, case) => !case.slow,
        Job::Curve(..) => true,
    });
    jobs.extend(tasks.iter().enumerate().map(|(i, task)| Job::Curve(i, task)));
    let lines: Vec<Mutex<Vec<Line>>> = plan
        .cases
        .iter()
        .map(|case| Mutex::new(plan.ways(case).iter().map(|way| planned(case, way)).collect()))
        .collect();
    let curves: Vec<Mutex<Option<Boundary>>> = tasks.iter().map(|_| Mutex::new(None)).collect();
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let guards: Vec<Guard> = (0..plan.workers.max(1)).map(|_| Guard::default()).collect();
    let table = |complete: bool| {
        let mut lines_so_far = Vec::new();
        for lines in &lines {
            lines_so_far.extend(lines.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned());
        }
        let points = curves
            .iter()
            .map(|curve| curve.lock().unwrap_or_else(PoisonError::into_inner).clone());
        StabilityTable {
            complete,
            lines: lines_so_far,
            maps: super::maps::assemble(&tasks, points.collect()),
        }
    };
    keep(&table(false))?;
    std::thread::scope(|scope| {
        for guard in &guards {
            scope.spawn(|| {
                loop {
                    let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        return;
                    };
                    if interrupted.load(Ordering::Relaxed) {
                        return;
                    }
                    match job {
                        Job::Case(index, case) => run_case(plan, case, guard, interrupted, &lines[*index]),
                        Job::Curve(index, task) => {
                            let (points, _) = guard.watched(|stop| task.points(stop, interrupted));
                            *curves[*index].lock().unwrap_or_else(PoisonError::into_inner) = points;
                        }
                    }
                    done.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
        let mut kept = 0;
        loop {
            let finished = done.load(Ordering::Relaxed);
            progress.set(finished as f64 / jobs.len() as f64);
            if finished > kept {
                kept = finished;
                if let Err(error) = keep(&table(false)) {
                    next.store(jobs.len(), Ordering::Relaxed);
                    guards
                        .iter()
                        .for_each(|guard| guard.stop.store(true, Ordering::Relaxed));
                    return Err(error);
                }
            }
            let stopped = interrupted.load(Ordering::Relaxed);
            for guard in &guards {
                let since = *guard.since.lock().unwrap_or_else(PoisonError::into_inner);
                if stopped || since.is_some_and(|since| since.elapsed() >= Duration::from_secs(LIMIT)) {
                    guard.stop.store(true, Ordering::Relaxed);
                }
            }
            if finished == jobs.len() || stopped {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    })?;
    let mut table = table(false);
    table.complete = table.lines.iter().all(|line| line.row.status.is_some())
        && curves
            .iter()
            .all(|curve| curve.lock().unwrap_or_else(PoisonError::into_inner).is_some());
    keep(&table)?;
    Ok(table)
}

/// The line of a run that has not been made.
fn planned(case: &Case, way: &Way) -> Line {
    Line {
        case: case.name.clone(),
        about: case.about.clone(),
        row: Row {
            scene: case.name.clone(),
            mode: way.mode.name().to_owned(),
            algorithm: way.algorithm.to_owned(),
            ..Row::default()
        },
        figures: Figures::default(),
    }
}

/// Makes the runs of a case, one after the other, and puts each into its line.
fn run_case(plan: &Plan, case: &Case, guard: &Guard, interrupted: &AtomicBool, lines: &Mutex<Vec<Line>>) {
    let mut bench = Bench {
        case,
        guard,
        interrupted,
        judged: Vec::new(),
    };
    for (index, way) in plan.ways(case).iter().enumerate() {
        let mut made = bench.run(way, &[]);
        if interrupted.load(Ordering::Relaxed) {
            return;
        }
        if plan.boundaries && !case.slow && matches!(made.row.status, Some(Status::Limit | Status::Diverged)) {
            made.figures.boundary = bench.boundary(way);
        }
        if interrupted.load(Ordering::Relaxed) {
            return;
        }
        let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        lines[index].row = made.row;
        lines[index].figures = made.figures;
    }
}

/// A case on trial; what coupled runs are judged by is made once for each micro step.
struct Bench<'a> {
    case: &'a Case,
    guard: &'a Guard,
    interrupted: &'a AtomicBool,
    /// Keys, and the one system with them.
    judged: Vec<(Vec<String>, Made)>,
}

impl Bench<'_> {
    fn make(&self, way: &Way, keys: &[String], judge: Option<(&str, &Made)>) -> Made {
        let (mut made, late) = self.guard.watched(|stop| make(self.case, way, keys, judge, stop));
        if late {
            made.row.status = Some(Status::Diverged);
            made.row.remark(&format!("ended after {LIMIT} s of wall time"));
        }
        made
    }

    /// A run of the case with other keys, judged by the one system; that by itself at a finer micro step.
    fn run(&mut self, way: &Way, keys: &[String]) -> Made {
        let Some((_, micro)) = steps(self.case, keys) else {
            return self.make(way, keys, None);
        };
        let is_step = |key: &&String| key.starts_with("coupling.macro_step") || key.starts_with("solver.micro_step");
        let mut one_keys: Vec<String> = keys.iter().filter(|key| !is_step(key)).cloned().collect();
        one_keys.extend([
            format!("coupling.macro_step={micro:?}"),
            format!("solver.micro_step={micro:?}"),
        ]);
        let known = self.judged.iter().position(|(keys, _)| *keys == one_keys);
        let index = known.unwrap_or_else(|| {
            let mut finer_keys = one_keys.clone();
            finer_keys.extend(refined(micro));
            let finer = self.make(&Way::ONE, &finer_keys, None);
            let name = format!(
                "monolithic, micro step {:?} s",
                finer.row.micro_step.unwrap_or(f64::NAN)
            );
            let judge = finer.is_stable().then_some((name.as_str(), &finer));
            let mut one = self.make(&Way::ONE, &one_keys, judge);
            if !finer.is_stable() && one.is_stable() {
                one.row.status = Some(Status::Limit);
                one.row.remark(&format!("at a finer micro step: {}", finer.row.reason));
            }
            self.judged.push((one_keys, one));
            self.judged.len() - 1
        });
        let one = &self.judged[index].1;
        if way.mode == Mode::Monolithic {
            return one.clone();
        }
        if !matches!(one.row.status, Some(Status::Stable | Status::Limit)) {
            return self.make(way, keys, None);
        }
        let name = format!("monolithic, micro step {micro:?} s");
        let mut made = self.make(way, keys, Some((name.as_str(), one)));
        if made.is_stable() && one.row.status == Some(Status::Limit) {
            made.row.status = Some(Status::Limit);
            made.row.remark(&format!("as one system: {}", one.row.reason));
        }
        made
    }

    /// Where a run that is not stable becomes so.
    fn boundary(&mut self, way: &Way) -> String {
        match self.case.knob {
            Some(knob) => self.by_knob(way, &knob),
            None => self.by_step(way),
        }
    }

    /// The value of the knob between the harmless and the hard one, by bisection of its logarithm.
    fn by_knob(&mut self, way: &Way, knob: &Knob) -> String {
        let (name, unit) = knob.name.split_once(" [").unwrap_or((knob.name, "]"));
        let unit = unit.trim_end_matches(']');
        let shown = |value: f64| significant(Some(value)).unwrap_or_default();
        let (mut good, mut bad) = (knob.harmless, knob.hard);
        if !self.run(way, &[knob.set(good)]).is_stable() {
            return format!("not stable at a {name} of {} {unit} either", shown(good));
        }
        for _ in 0..KNOB_BISECTIONS {
            if self.interrupted.load(Ordering::Relaxed) {
                return String::new();
            }
            let middle = (good * bad).sqrt();
            if self.run(way, &[knob.set(middle)]).is_stable() {
                good = middle;
            } else {
                bad = middle;
            }
        }
        format!(
            "stable at a {name} of {} {unit}, not at {} {unit}",
            shown(good),
            shown(bad)
        )
    }

    /// The longest step: macro and micro step shortened together, halved and then bisected.
    fn by_step(&mut self, way: &Way) -> String {
        let Some((macro_step, micro)) = steps(self.case, &[]) else {
            return String::new();
        };
        let start = if way.mode == Mode::Monolithic {
            micro
        } else {
            macro_step
        };
        let keys = |step: f64| {
            vec![
                format!("coupling.macro_step={step:?}"),
                format!("solver.micro_step={:?}", step.min(micro)),
            ]
        };
        let (mut unstable, mut stable) = (start, None);
        for _ in 0..HALVINGS {
            let step = 0.5 * unstable;
            if self.interrupted.load(Ordering::Relaxed) {
                return String::new();
            }
            if self.run(way, &keys(step)).is_stable() {
                stable = Some(step);
                break;
            }
            unstable = step;
        }
        let which = if way.mode == Mode::Monolithic {
            "micro step"
        } else {
            "macro step"
        };
        let milliseconds = |step: f64| format!("{} ms", (1e6 * step).round() / 1e3);
        let Some(mut stable) = stable else {
            return format!("not stable down to a {which} of {}", milliseconds(unstable));
        };
        for _ in 0..BISECTIONS {
            let step = (stable * unstable).sqrt();
            if self.run(way, &keys(step)).is_stable() {
                stable = step;
            } else {
                unstable = step;
            }
        }
        format!(
            "stable to a {which} of {}, not at {}",
            milliseconds(stable),
            milliseconds(unstable)
        )
    }
}
