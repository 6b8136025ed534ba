//! Boundaries beyond which runs are not stable, by bisection over the step, and by theory.

use std::sync::LazyLock;

use scene::Coupling;
use serde::{Deserialize, Serialize};

use super::bench::{CaseBench, Way, both_steps, refined};
use super::cases::{Case, HardParameter};
use super::judge::ALGORITHMS;
use crate::engine::table::{ENERGY, RAW_ERROR};
use crate::engine::{Bench, Unmade, entries};
use cosim::algorithm::stability::spectral_radius;
use cosim::test_problem::{self, Parameters, Switches, Truth};
use results::statistics::ForceStatistics;
use simulation::Mode;

/// Simulated time of a run of the test problem, s: fifty periods of its contact.
const DURATION: f64 = 3.0;

/// Bounds of the steps that are tried, s.
const STEPS: (f64, f64) = (5e-5, 2e-2);

/// Ratio of a step that is not stable to the longest stable one, –: three bisections of a factor of two.
const KNOWN_TO: f64 = 1.091;

/// Unit of the macro steps on the line, s: its micro step, so that one reference serves all.
const UNIT: f64 = 5e-4;

/// Largest macro step on the line in these units.
const MOST_UNITS: f64 = 40.0;

/// Resolution and end of the table of growth over `ωh`, –.
const NUMBERS: (f64, usize) = (0.02, 200);

/// Growth per step that counts as none, –.
const NEUTRAL: f64 = 1e-5;

/// Origin of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CurveKind {
    /// Bisection with runs of the test problem.
    TestProblem,
    /// Bisection with runs of the short line.
    ShortLine,
    /// The spectral radius of the algorithm against the contact's damping.
    Theory,
}

/// Points (x, y) of a boundary in a map.
pub type Boundary = Vec<(f64, f64)>;

/// The boundary of one algorithm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapCurve {
    /// Algorithm; `monolithic` where nothing is coupled.
    pub algorithm: &'static str,
    /// Origin.
    pub kind: CurveKind,
    /// The quantity of the map's axis, and the longest stable step there, s; 0 where none was found.
    pub points: Boundary,
}

/// Longest stable steps over one quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// Heading.
    pub title: String,
    /// Title of the axis, with the unit.
    pub x: String,
    /// `true` where the axis is logarithmic.
    pub logarithmic: bool,
    /// Title of the other axis.
    pub y: String,
    /// Caption.
    pub caption: String,
    /// Curves.
    #[serde(skip_deserializing)]
    pub curves: Vec<MapCurve>,
    /// Quantity of the axis.
    #[serde(skip_serializing)]
    axis: MapAxis,
}

/// The quantity of a map's axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum MapAxis {
    Stiffness,
    HeadMass,
    SpeedRatio,
    MicroStep,
}

/// The maps without their curves, data in `maps.toml`.
static MAPS: LazyLock<Vec<Map>> = LazyLock::new(|| entries(include_str!("maps.toml")));

/// One curve to be found.
#[derive(Clone, Debug)]
pub struct Task {
    map: usize,
    algorithm: &'static str,
    kind: CurveKind,
    x: Vec<f64>,
}

/// `count` values from `from` to `to` in equal ratios.
fn ratios(from: f64, to: f64, count: usize) -> Vec<f64> {
    let last = (count.max(2) - 1) as f64;
    (0..count.max(2))
        .map(|k| from * (to / from).powf(k as f64 / last))
        .collect()
}

/// The curves of all maps, `resolution` points each.
pub(super) fn tasks(resolution: usize) -> Vec<Task> {
    use CurveKind::{ShortLine, TestProblem, Theory};
    let few = resolution.div_ceil(2);
    let three = |from: f64, to: f64, on_the_line: f64| {
        vec![
            (Theory, ratios(from, to, resolution)),
            (TestProblem, ratios(from, to, resolution)),
            (ShortLine, ratios(from, on_the_line, few.min(3))),
        ]
    };
    let mut tasks = Vec::new();
    for (map, of) in MAPS.iter().enumerate() {
        let ranges = match of.axis {
            MapAxis::Stiffness => three(1e4, 1e8, 1e6),
            MapAxis::HeadMass => three(0.5, 15.0, 15.0),
            MapAxis::SpeedRatio => {
                let last = (few.max(2) - 1) as f64;
                let ratio = |k: usize| 0.15 + 0.8 * k as f64 / last;
                vec![(ShortLine, (0..few.max(2)).map(ratio).collect())]
            }
            MapAxis::MicroStep => vec![(ShortLine, ratios(1e4, 1e7, few + 2))],
        };
        let algorithms = match of.axis {
            MapAxis::MicroStep => &["monolithic"][..],
            _ => &ALGORITHMS,
        };
        for (kind, x) in &ranges {
            tasks.extend(algorithms.iter().map(|&algorithm| Task {
                map,
                algorithm,
                kind: *kind,
                x: x.clone(),
            }));
        }
    }
    tasks
}

/// The maps with the curves that have been found.
pub(super) fn assemble(tasks: &[Task], points: Vec<Option<Boundary>>) -> Vec<Map> {
    let mut maps = MAPS.to_vec();
    for (task, points) in tasks.iter().zip(points) {
        if let Some(points) = points {
            maps[task.map].curves.push(MapCurve {
                algorithm: task.algorithm,
                kind: task.kind,
                points,
            });
        }
    }
    maps.retain(|map| !map.curves.is_empty());
    maps
}

/// The longest stable step between two bounds: doubled from the first one until a run is not stable, then brought
/// nearer to that by steps between both as long as there is one; 0 where the first bound is not stable.
fn longest(
    (first, last): (f64, f64),
    between: fn(f64, f64) -> Option<f64>,
    stable: &mut dyn FnMut(f64) -> Result<bool, Unmade>,
) -> Result<f64, Unmade> {
    let (mut good, mut step) = (0.0, first);
    let mut bad = loop {
        if !stable(step)? {
            break step;
        }
        good = step;
        if step >= last {
            return Ok(good);
        }
        step = (2.0 * step).min(last);
    };
    while let Some(middle) = between(good, bad).filter(|_| good > 0.0) {
        if stable(middle)? {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Ok(good)
}

/// A step between these, in equal ratios.
fn in_ratio(good: f64, bad: f64) -> Option<f64> {
    (bad > KNOWN_TO * good).then(|| (good * bad).sqrt())
}

/// A whole number between these.
fn whole(good: f64, bad: f64) -> Option<f64> {
    (bad - good > 1.0 + (good / 8.0).floor()).then(|| (0.5 * (good + bad)).floor())
}

/// `[coupling]` of an algorithm with its own defaults.
pub(super) fn coupling(algorithm: &str) -> Option<Coupling> {
    let case = Case::plain();
    let keys = [format!("coupling.algorithm=\"{algorithm}\"")];
    let scene = case.run(&Way::ONE, &keys).scene().ok();
    scene.map(|scene| scene.coupling)
}

impl Task {
    /// Finds the points.
    pub(super) fn points(&self, bench: &Bench<'_>) -> Result<Boundary, Unmade> {
        let theory = coupling(self.algorithm).filter(|_| self.kind == CurveKind::Theory);
        let growth = theory.map_or_else(Vec::new, |coupling| growth(&coupling));
        let mut points = Vec::new();
        for &x in &self.x {
            let step = match (self.kind, MAPS[self.map].axis) {
                (CurveKind::Theory, _) => self.by_theory(&growth, x),
                (CurveKind::TestProblem, axis) => {
                    let of = format!("boundary of the test problem: {} {axis:?} {x:?}", self.algorithm);
                    bench.value(&of, || self.by_test_problem(x))?
                }
                (CurveKind::ShortLine, MapAxis::MicroStep) => self.micro_step(x, bench)?,
                (CurveKind::ShortLine, _) => self.on_the_line(x, bench)?,
            };
            points.push((x, step));
        }
        bench.go_on()?;
        Ok(points)
    }

    fn parameters(&self, x: f64) -> Parameters {
        let mut parameters = Parameters::CLOSED;
        match MAPS[self.map].axis {
            MapAxis::Stiffness => parameters.contact_stiffness = x,
            MapAxis::HeadMass => parameters.masses[0] = x,
            MapAxis::SpeedRatio | MapAxis::MicroStep => {}
        }
        parameters
    }

    /// The short line there.
    fn short_line(&self, x: f64) -> Case {
        let mut case = Case::plain();
        case.disturbance.audited = false;
        case.overrides.extend(match MAPS[self.map].axis {
            MapAxis::Stiffness | MapAxis::MicroStep => vec![HardParameter::ContactStiffness(x).key()],
            MapAxis::HeadMass => vec![HardParameter::HeadMass(x).key()],
            MapAxis::SpeedRatio => at_speed(x),
        });
        case
    }

    /// Step at which the growth per step of the contact's oscillation exceeds the decay by its damping, s.
    fn by_theory(&self, growth: &[f64], x: f64) -> f64 {
        let parameters = self.parameters(x);
        let omega = parameters.contact_frequency();
        let decay = contact_decay(&parameters);
        let number = |k: usize| NUMBERS.0 * (k + 1) as f64;
        let grows = |k: usize| growth[k].ln() > decay * number(k) / omega + NEUTRAL;
        let first = (0..growth.len()).find(|&k| grows(k)).unwrap_or(growth.len());
        if first == 0 { 0.0 } else { number(first - 1) / omega }
    }

    fn by_test_problem(&self, x: f64) -> f64 {
        let parameters = self.parameters(x);
        let Some(coupling) = coupling(self.algorithm) else {
            return 0.0;
        };
        let truth = Truth::solve(&parameters, DURATION);
        let sigma = ForceStatistics::of(truth.forces()).map_or(0.0, |force| force.std);
        let case = test_problem::Case {
            name: self.algorithm.to_owned(),
            coupling,
            line: Switches::ALL,
            pantograph: Switches::ALL,
            parameters,
        };
        let found = longest(STEPS, in_ratio, &mut |step| {
            let outcome = test_problem::run_against(&truth, &case, step);
            let right = outcome.rms_error <= RAW_ERROR / 100.0 * sigma;
            Ok(outcome.stable && right && 100.0 * outcome.energy_share.abs() <= ENERGY)
        });
        // These runs cannot fail, and are not asked to end.
        found.unwrap_or(0.0)
    }

    fn on_the_line(&self, x: f64, bench: &Bench<'_>) -> Result<f64, Unmade> {
        let keys = |units: f64| {
            [
                format!("solver.micro_step={UNIT:?}"),
                format!("coupling.macro_step={:?}", units * UNIT),
            ]
        };
        let case = &self.short_line(x);
        let case = CaseBench { case, bench };
        let one = case.make(&Way::ONE, &keys(1.0), None)?;
        let way = Way {
            mode: Mode::Inprocess,
            algorithm: self.algorithm,
        };
        let units = longest((1.0, MOST_UNITS), whole, &mut |units| {
            Ok(case.make(&way, &keys(units), Some(("", &one)))?.row.is_stable())
        })?;
        Ok(units * UNIT)
    }

    /// Longest micro step at which one system resolves the raw force, s: halved from 4 ms.
    fn micro_step(&self, x: f64, bench: &Bench<'_>) -> Result<f64, Unmade> {
        let case = &self.short_line(x);
        let case = CaseBench { case, bench };
        let mut step = 4e-3;
        while step >= 1e-4 {
            let finer = case.make(&Way::ONE, &refined(step), None)?;
            let made = case.make(&Way::ONE, &both_steps(step), Some(("", &finer)))?;
            if made.row.is_stable() {
                return Ok(step);
            }
            step *= std::f64::consts::FRAC_1_SQRT_2;
        }
        Ok(0.0)
    }
}

/// The short line at a share `x` of its wave speed, within its length.
fn at_speed(x: f64) -> Vec<String> {
    let speed = x * (20_000.0_f64 / 1.35).sqrt();
    let duration = (125.0 / speed).min(2.0);
    vec![
        format!("run.speed_kmh={:?}", 3.6 * speed),
        format!("run.duration={duration:?}"),
        format!("run.evaluate={{time=[{:?},{:?}]}}", 0.25 * duration, 0.75 * duration),
    ]
}

/// Growth per step of an undamped oscillation over `ωh`, –.
fn growth(coupling: &Coupling) -> Vec<f64> {
    (0..NUMBERS.1)
        .map(|k| spectral_radius(coupling, NUMBERS.0 * (k + 1) as f64).unwrap_or(f64::INFINITY))
        .collect()
}

/// Rate at which the oscillation of head and wire on the contact decays, 1/s: the dampers of both on its mode, which
/// moves them in the inverse ratio of their masses.
fn contact_decay(parameters: &Parameters) -> f64 {
    let [head, wire] = [1.0 / parameters.masses[0], 1.0 / parameters.wire_mass];
    let damping = parameters.dampings[0] * head * head + parameters.wire_damping * wire * wire;
    0.5 * damping / (head + wire)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_stable_step_is_found_to_a_tenth_of_a_factor_of_two() {
        let found = |bounds, between, stable: &dyn Fn(f64) -> bool| {
            let found = longest(bounds, between, &mut |step| Ok(stable(step)));
            found.unwrap()
        };
        let steps = |stable: &dyn Fn(f64) -> bool| found(STEPS, in_ratio, stable);
        let units = |stable: &dyn Fn(f64) -> bool| found((1.0, MOST_UNITS), whole, stable);
        for limit in [7.3e-5, 1e-3, 0.0123] {
            let found = steps(&|step| step <= limit);
            assert!(found <= limit && found > limit / 2.0_f64.powf(0.13), "{limit}: {found}");
        }
        assert_eq!(steps(&|_| false), 0.0);
        assert_eq!(steps(&|_| true), STEPS.1);
        assert_eq!(units(&|units| units <= 5.0), 5.0);
        let coarse = units(&|units| units <= 23.0);
        assert!((21.0..=23.0).contains(&coarse), "{coarse}");
        assert_eq!(units(&|_| true), MOST_UNITS);
        assert_eq!(units(&|_| false), 0.0);
    }

    #[test]
    fn the_contact_decays_as_its_mode_does() {
        // Equal masses and dampers: the mode's damping is that of one of them, c/(2 m).
        let parameters = Parameters {
            masses: [10.0, 15.0],
            dampings: [100.0, 90.0],
            ..Parameters::CLOSED
        };
        assert!((contact_decay(&parameters) - 5.0).abs() < 1e-12);
    }
}
