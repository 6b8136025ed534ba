//! Runs of a study: a base case, sweeps that change one thing at a time, and a ladder of balanced meshes and steps.

use super::options::{Options, Sweep};
use super::run_spec::{Class, Exchange, Mesh, RunSpec, Subject};
use super::vehicle::OWN;
use crate::compare::algorithms;
use crate::engine::Variant;
use crate::engine::table::{AUTO, RunRow};
use simulation::Mode;
use simulation::sliding_joint;

/// One run of the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRun {
    /// Variant of the scene.
    pub spec: RunSpec,
    /// Variant of the scene.
    pub variant: Variant,
    /// Scene of the run with every default written out; nothing where the scene refuses the run.
    pub scene: Option<String>,
    /// Sweeps that the run is part of.
    pub sweeps: Vec<Sweep>,
    /// Expected work, coordinates times micro steps.
    pub work: f64,
}

impl StudyRun {
    /// Run of a specification.
    #[must_use]
    pub fn new(subject: &Subject, spec: RunSpec, sweep: Sweep) -> Self {
        let variant = subject.variant(&spec);
        let scene = system::load(subject.text_of(&spec), &subject.name, &variant.overrides);
        Self {
            work: subject.work(&spec),
            scene: scene.ok().map(|scene| scene.to_toml()),
            variant,
            sweeps: vec![sweep],
            spec,
        }
    }

    /// `true` where two runs are one.
    #[must_use]
    pub fn same(&self, other: &Self) -> bool {
        // What is judged by another model of the vehicle is not judged by the reference of the mesh.
        let judges_alike = self.is_for_vehicle() == other.is_for_vehicle();
        let one = judges_alike
            && self.variant.mode == other.variant.mode
            && self.variant.algorithm == other.variant.algorithm;
        // What stands on no track is judged by what stands on each.
        let track = |run: &Self| {
            run.spec
                .vehicle_variant
                .as_ref()
                .map_or(OWN, |vehicle_variant| vehicle_variant.name.track)
        };
        one && track(self) == track(other)
            && match (&self.scene, &other.scene) {
                (Some(own), Some(theirs)) => own == theirs,
                (None, None) => self.spec == other.spec,
                _ => false,
            }
    }

    /// `true` where the run is there for the vehicle alone: nothing else competes with it.
    #[must_use]
    pub fn is_for_vehicle(&self) -> bool {
        self.sweeps == [Sweep::Vehicle]
    }

    /// `true` where it is there for the growth of cost with the number of spans.
    #[must_use]
    pub fn is_growth(&self) -> bool {
        self.sweeps.contains(&Sweep::Spans)
    }

    /// Rows that it competes with.
    #[must_use]
    pub fn class(&self) -> Class {
        Class::of(&self.spec.reductions.join("+"))
    }
}

/// Runs in the order in which they were asked for; none twice.
struct Runs<'a> {
    subject: &'a Subject,
    runs: Vec<StudyRun>,
}

impl Runs<'_> {
    fn add(&mut self, spec: RunSpec, sweep: Sweep) {
        let planned = StudyRun::new(self.subject, spec, sweep);
        match self.runs.iter_mut().find(|had| had.same(&planned)) {
            Some(had) => {
                if !had.sweeps.contains(&sweep) {
                    had.sweeps.push(sweep);
                }
            }
            None => self.runs.push(planned),
        }
    }
}

/// The base case: what resolves the waves and the band of the filter.
#[must_use]
pub fn base(subject: &Subject) -> RunSpec {
    RunSpec {
        mesh: subject.corrected(subject.elements),
        micro_step: subject.micro_step,
        rho_inf: subject.scene.solver.rho_inf,
        newton_tolerance: subject.scene.solver.newton_tolerance,
        reductions: subject.reductions.clone(),
        exchange: subject.plain_exchange(subject.micro_step),
        spans: None,
        vehicle_variant: None,
    }
}

/// All runs but those of the references.
#[must_use]
pub fn plan(subject: &Subject, options: &Options) -> Vec<StudyRun> {
    let mut runs = Runs {
        subject,
        runs: Vec::new(),
    };
    scene(&mut runs);
    runs.add(base(subject), Sweep::Mesh);
    mesh(&mut runs, options);
    micro_step(&mut runs, options);
    coupling(&mut runs, options);
    rho_inf(&mut runs, options);
    reductions(&mut runs, options);
    vehicle(&mut runs);
    ladder(&mut runs, options);
    spans(&mut runs, options);
    if !options.sweeps.is_empty() {
        for run in &mut runs.runs {
            run.sweeps.retain(|sweep| options.sweeps.contains(sweep));
        }
        runs.runs.retain(|run| !run.sweeps.is_empty());
    }
    runs.runs
}

/// Runs of the scene as it is: as one system and coupled.
fn scene(runs: &mut Runs<'_>) {
    let subject = runs.subject;
    let reductions = subject.scene.model.reductions.iter();
    // As it divides the scene's macro step, which a run as one system does not have here.
    let row = RunRow::planned(&subject.name, &subject.scene, Mode::Monolithic, "");
    let own = RunSpec {
        mesh: Mesh::Scene,
        micro_step: row.micro_step.unwrap_or(subject.scene.solver.micro_step),
        reductions: reductions.map(|reduction| reduction.name().to_owned()).collect(),
        exchange: Exchange::Scene,
        ..base(subject)
    };
    if subject.one_system {
        let exchange = Exchange::None;
        runs.add(
            RunSpec {
                exchange,
                ..own.clone()
            },
            Sweep::Scene,
        );
    }
    if !sliding_joint::holds(&subject.scene) {
        runs.add(own, Sweep::Scene);
    }
}

/// `true` where there is a mesh without corrections beside the corrected one.
fn both(subject: &Subject) -> bool {
    subject
        .corrections
        .as_ref()
        .is_some_and(|corrections| !corrections.is_empty())
}

fn mesh(runs: &mut Runs<'_>, options: &Options) {
    let subject = runs.subject;
    if !subject.meshed {
        return;
    }
    let with = |mesh: Mesh| RunSpec { mesh, ..base(subject) };
    for &elements in &options.elements {
        runs.add(with(subject.corrected(elements)), Sweep::Mesh);
        runs.add(with(subject.mesh(elements, Vec::new())), Sweep::Mesh);
    }
    let corrections = subject.corrections.clone().unwrap_or_default();
    if options.quick || corrections.len() < 2 {
        return;
    }
    // Each correction alone, and all but one.
    for index in 0..corrections.len() {
        runs.add(
            with(subject.mesh(subject.elements, vec![corrections[index].clone()])),
            Sweep::Mesh,
        );
        let mut others = corrections.clone();
        others.remove(index);
        runs.add(with(subject.mesh(subject.elements, others)), Sweep::Mesh);
    }
}

fn micro_step(runs: &mut Runs<'_>, options: &Options) {
    let subject = runs.subject;
    for &micro_step in &options.micro_steps {
        let with = |mesh: Mesh| RunSpec {
            mesh,
            micro_step,
            exchange: subject.plain_exchange(micro_step),
            ..base(subject)
        };
        runs.add(with(subject.corrected(subject.elements)), Sweep::MicroStep);
        if both(subject) {
            runs.add(with(subject.mesh(subject.elements, Vec::new())), Sweep::MicroStep);
        }
    }
}

/// The automatic choice at every macro step; the other algorithms, and degrees of extrapolation, at the middle one.
fn coupling(runs: &mut Runs<'_>, options: &Options) {
    let subject = runs.subject;
    if sliding_joint::holds(&subject.scene) {
        return;
    }
    let mut steps = options.macro_steps.clone();
    steps.sort_by(f64::total_cmp);
    let with = |algorithm: &str, extrapolation: Option<usize>, macro_step: f64| RunSpec {
        exchange: Exchange::Of {
            algorithm: algorithm.to_owned(),
            extrapolation,
            macro_step,
        },
        // No longer than the macro step: a run and its row say the same.
        micro_step: subject.micro_step.min(macro_step),
        ..base(subject)
    };
    for &step in &steps {
        runs.add(with(AUTO, None, step), Sweep::Coupling);
    }
    let Some(&middle) = steps.get(steps.len() / 2) else {
        return;
    };
    if options.quick {
        return;
    }
    for algorithm in algorithms() {
        runs.add(with(algorithm, None, middle), Sweep::Coupling);
    }
    for degree in 0..=2 {
        runs.add(
            with(scene::Algorithm::GaussSeidel.name(), Some(degree), middle),
            Sweep::Coupling,
        );
    }
}

/// All on one mesh: with those corrections that go with every one of them.
fn rho_inf(runs: &mut Runs<'_>, options: &Options) {
    let subject = runs.subject;
    let with = |corrections: &[String], rho_inf: f64| RunSpec {
        mesh: subject.mesh(subject.elements, corrections.to_vec()),
        rho_inf,
        ..base(subject)
    };
    let goes = |corrections: &Vec<String>| {
        let mut all = options.rho_inf.iter();
        all.all(|rho_inf| subject.takes(&subject.variant(&with(corrections, *rho_inf)).overrides))
    };
    let corrections = subject.correction_sets().into_iter().find(goes).unwrap_or_default();
    for &rho_inf in &options.rho_inf {
        runs.add(with(&corrections, rho_inf), Sweep::RhoInf);
    }
}

/// The usual sets, each with what the scene has anyway; those that were asked for as they are.
fn reduction_sets(subject: &Subject, options: &Options) -> Vec<Vec<String>> {
    let set = |text: &str| -> Vec<String> {
        let names = text
            .split('+')
            .map(str::trim)
            .filter(|name| !name.is_empty() && *name != "none");
        names.map(str::to_owned).collect()
    };
    if !options.reductions.is_empty() {
        return options.reductions.iter().map(|text| set(text)).collect();
    }
    let linkage = |pantograph: &scene::Pantograph| matches!(pantograph.model, scene::PantographModel::Linkage(_));
    let mut sets = vec![Vec::new(), subject.with(&[])];
    if subject.scene.pushed_sideways().is_none() {
        sets.push(set("planar"));
    }
    if subject.scene.pantographs.iter().any(linkage) {
        sets.push(subject.with(&["linkage"]));
    }
    sets.push(subject.with(&["linearised"]));
    sets.push(subject.with(&["window"]));
    sets.push(subject.with(&["linearised", "window"]));
    sets
}

fn reductions(runs: &mut Runs<'_>, options: &Options) {
    let subject = runs.subject;
    if !subject.meshed {
        return;
    }
    for reductions in reduction_sets(subject, options) {
        runs.add(
            RunSpec {
                reductions,
                ..base(subject)
            },
            Sweep::Reductions,
        );
    }
}

/// The base case on everything else that the pantograph may stand on, with all reductions that change nothing there.
fn vehicle(runs: &mut Runs<'_>) {
    let subject = runs.subject;
    for vehicle_variant in &subject.vehicle_variants {
        let spec = RunSpec {
            reductions: vec![AUTO.to_owned()],
            vehicle_variant: Some(vehicle_variant.clone()),
            ..base(subject)
        };
        runs.add(spec, Sweep::Vehicle);
    }
}

/// Steps of the ladder: elements of the longest dropper interval and micro step, both in eighths of the base case's.
/// Shorter intervals have elements of the same length: fewer for the same error, and longer steps with the mass
/// correction.
const LADDER: [(usize, f64); 19] = [
    (2, 16.0),
    (4, 16.0),
    (4, 8.0),
    (6, 8.0),
    (7, 12.8),
    (7, 11.0),
    (7, 8.0),
    (7, 7.0),
    (8, 11.6),
    (8, 10.0),
    (8, 8.0),
    (9, 10.0),
    (10, 8.0),
    (12, 8.0),
    (8, 6.0),
    (8, 4.0),
    (12, 4.0),
    (14, 4.0),
    (16, 4.0),
];

/// Steps of the ladder with `quick`.
const SHORT_LADDER: [(usize, f64); 12] = [
    (4, 16.0),
    (6, 8.0),
    (7, 12.8),
    (7, 11.0),
    (7, 7.0),
    (8, 11.6),
    (8, 10.0),
    (8, 8.0),
    (9, 10.0),
    (8, 6.0),
    (12, 4.0),
    (14, 4.0),
];

/// Residual that ends Newton's method on the ladder, N: it moves the filtered force far less than the meshes of the
/// ladder do, and saves corrections.
const LADDER_TOLERANCE: f64 = 0.3;

fn ladder(runs: &mut Runs<'_>, options: &Options) {
    let subject = runs.subject;
    if !subject.meshed {
        return;
    }
    let rungs = if options.quick { &SHORT_LADDER[..] } else { &LADDER[..] };
    let spec = |(elements, micro_step): (usize, f64), corrections: &[String], reductions: &[String]| {
        let elements = (subject.elements * elements).div_ceil(8).max(1);
        let micro_step = 0.125 * micro_step * subject.micro_step;
        RunSpec {
            mesh: subject.even_mesh(elements, corrections.to_vec()),
            micro_step,
            reductions: reductions.to_vec(),
            exchange: subject.plain_exchange(micro_step),
            newton_tolerance: subject.scene.solver.newton_tolerance.max(LADDER_TOLERANCE),
            ..base(subject)
        }
    };
    let corrections = subject.corrections.clone().unwrap_or_default();
    let classes: [&[&str]; 4] = [&[], &["window"], &["linearised"], &["linearised", "window"]];
    for names in classes {
        let reductions = subject.with(names);
        if !names.is_empty() && !subject.takes_reductions(&reductions) {
            continue;
        }
        for &rung in rungs {
            runs.add(spec(rung, &corrections, &reductions), Sweep::Ladder);
        }
    }
    if both(subject) && !options.quick {
        let mut fine = spec((16, 4.0), &[], &subject.reductions);
        fine.micro_step = 0.25 * subject.micro_step;
        fine.exchange = subject.plain_exchange(fine.micro_step);
        runs.add(fine, Sweep::Ladder);
    }
}

fn spans(runs: &mut Runs<'_>, options: &Options) {
    let subject = runs.subject;
    if !subject.meshed {
        return;
    }
    for (names, counts) in [(&[][..], &options.spans), (&["window"][..], &options.window_spans)] {
        for &count in counts {
            let spec = RunSpec {
                reductions: subject.with(names),
                spans: Some(count),
                ..base(subject)
            };
            runs.add(spec, Sweep::Spans);
        }
    }
}
