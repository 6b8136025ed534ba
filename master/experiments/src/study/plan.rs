//! Runs of a study: a base case, sweeps that change one thing at a time, and a ladder of balanced meshes and steps.

use super::options::{Options, Sweep};
use super::run_spec::{Class, Exchange, Mesh, RunSpec, Subject, correction_sets, reduce_key};
use super::vehicle::OWN;
use crate::compare::algorithms;
use crate::engine::Variant;
use crate::engine::table::{AUTO, RunRow, joined};
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
    /// Row before the run is made.
    pub row: RunRow,
    /// Sweeps that the run is part of.
    pub sweeps: Vec<Sweep>,
    /// Expected work, coordinates times micro steps.
    pub work: f64,
}

impl StudyRun {
    /// Run of a specification.
    pub(super) fn new(subject: &Subject, spec: RunSpec, sweep: Sweep) -> Self {
        let variant = subject.variant(&spec);
        let scene = system::load(subject.text_of(&spec), &subject.name, &variant.overrides).ok();
        let row = match &scene {
            Some(scene) => RunRow::planned(&subject.name, scene, variant.mode, &variant.algorithm),
            None => asked_for(subject, &spec, &variant),
        };
        Self {
            work: subject.work(&spec),
            scene: scene.map(|scene| scene.to_toml()),
            row,
            variant,
            sweeps: vec![sweep],
            spec,
        }
    }

    /// `true` where two runs are one.
    pub(super) fn same(&self, other: &Self) -> bool {
        // What stands on no track is judged by what stands on each.
        let track = |run: &Self| {
            run.spec
                .vehicle_variant
                .as_ref()
                .map_or(OWN, |variant| variant.name.track)
        };
        // What is judged by another model of the vehicle is not judged by the reference of the mesh.
        self.is_for_vehicle() == other.is_for_vehicle()
            && self.variant.mode == other.variant.mode
            && self.variant.algorithm == other.variant.algorithm
            && track(self) == track(other)
            && match (&self.scene, &other.scene) {
                (Some(own), Some(theirs)) => own == theirs,
                (None, None) => self.spec == other.spec,
                _ => false,
            }
    }

    /// Makes it part of a sweep too.
    pub fn join(&mut self, sweep: Sweep) {
        if !self.sweeps.contains(&sweep) {
            self.sweeps.push(sweep);
        }
    }

    /// `true` where the run is there for the vehicle alone: nothing else competes with it.
    pub(super) fn is_for_vehicle(&self) -> bool {
        self.sweeps == [Sweep::Vehicle]
    }

    /// `true` where it is there for the growth of cost with the number of spans.
    pub(super) fn is_growth(&self) -> bool {
        self.sweeps.contains(&Sweep::Spans)
    }

    /// Rows that it competes with.
    pub(super) fn class(&self) -> Class {
        Class::of(&self.spec.reductions.join("+"))
    }
}

/// Row of a run whose scene cannot be read: what was asked for.
fn asked_for(subject: &Subject, spec: &RunSpec, variant: &Variant) -> RunRow {
    let mut row = RunRow {
        scene: subject.name.clone(),
        mode: variant.mode.name().to_owned(),
        algorithm: variant.algorithm.clone(),
        micro_step: Some(spec.micro_step),
        reduction: joined(&spec.reductions, "none"),
        ..RunRow::default()
    };
    if let (Mesh::Of { division, corrections }, Some((line, _))) = (&spec.mesh, subject.scene.modelled_line()) {
        row.divide(line, *division);
        row.mesh = joined(corrections, "plain");
    }
    if let Exchange::Of {
        extrapolation,
        macro_step,
        ..
    } = &spec.exchange
    {
        row.macro_step = Some(*macro_step);
        row.extrapolation = extrapolation.map(|degree| degree as u64);
    }
    row
}

/// The base case: what resolves the waves and the band of the filter.
pub(super) fn base(subject: &Subject) -> RunSpec {
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
pub(super) fn plan(subject: &Subject, options: &Options) -> Vec<StudyRun> {
    let mut plan = Plan {
        subject,
        options,
        base: base(subject),
        runs: Vec::new(),
    };
    plan.scene();
    plan.add(Sweep::Mesh, plan.base.clone());
    if subject.meshed {
        plan.mesh();
    }
    plan.micro_step();
    if !sliding_joint::holds(&subject.scene) {
        plan.coupling();
    }
    plan.rho_inf();
    if subject.meshed {
        plan.reductions();
    }
    plan.vehicle();
    if subject.meshed {
        plan.ladder();
        plan.spans();
    }
    let mut runs = plan.runs;
    for run in &mut runs {
        run.sweeps.retain(|sweep| options.sweeps_over(*sweep));
    }
    runs.retain(|run| !run.sweeps.is_empty());
    runs
}

/// Runs in the order in which they were asked for; none twice.
struct Plan<'a> {
    subject: &'a Subject,
    options: &'a Options,
    base: RunSpec,
    runs: Vec<StudyRun>,
}

impl Plan<'_> {
    fn add(&mut self, sweep: Sweep, spec: RunSpec) {
        let planned = StudyRun::new(self.subject, spec, sweep);
        match self.runs.iter_mut().find(|had| had.same(&planned)) {
            Some(had) => had.join(sweep),
            None => self.runs.push(planned),
        }
    }

    /// The base case with as many elements in each dropper interval, and some corrections.
    fn on_mesh(&self, elements: usize, corrections: &[String]) -> RunSpec {
        RunSpec {
            mesh: self.subject.mesh(elements, corrections.to_vec()),
            ..self.base.clone()
        }
    }

    /// A run with another micro step, s.
    fn at_step(&self, micro_step: f64, spec: RunSpec) -> RunSpec {
        RunSpec {
            micro_step,
            exchange: self.subject.plain_exchange(micro_step),
            ..spec
        }
    }

    /// Runs of the scene as it is: as one system and coupled.
    fn scene(&mut self) {
        let subject = self.subject;
        let reductions = subject.scene.model.reductions.iter();
        // As it divides the scene's macro step, which a run as one system does not have here.
        let row = RunRow::planned(&subject.name, &subject.scene, Mode::Monolithic, "");
        let coupled = RunSpec {
            mesh: Mesh::Scene,
            micro_step: row.micro_step.unwrap_or(subject.scene.solver.micro_step),
            reductions: reductions.map(|reduction| reduction.name().to_owned()).collect(),
            exchange: Exchange::Scene,
            ..self.base.clone()
        };
        if subject.one_system {
            let exchange = Exchange::None;
            let alone = RunSpec {
                exchange,
                ..coupled.clone()
            };
            self.add(Sweep::Scene, alone);
        }
        if !sliding_joint::holds(&subject.scene) {
            self.add(Sweep::Scene, coupled);
        }
    }

    fn mesh(&mut self) {
        let corrections = self.subject.best_corrections();
        for &elements in &self.options.elements {
            self.add(Sweep::Mesh, self.on_mesh(elements, corrections));
            self.add(Sweep::Mesh, self.on_mesh(elements, &[]));
        }
        if self.options.quick || corrections.len() < 2 {
            return;
        }
        // Each correction alone, and all but one.
        let elements = self.subject.elements;
        for (index, one) in corrections.iter().enumerate() {
            self.add(Sweep::Mesh, self.on_mesh(elements, std::slice::from_ref(one)));
            let others = [&corrections[..index], &corrections[index + 1..]].concat();
            self.add(Sweep::Mesh, self.on_mesh(elements, &others));
        }
    }

    fn micro_step(&mut self) {
        for &micro_step in &self.options.micro_steps {
            self.add(Sweep::MicroStep, self.at_step(micro_step, self.base.clone()));
            if !self.subject.best_corrections().is_empty() {
                let plain = self.on_mesh(self.subject.elements, &[]);
                self.add(Sweep::MicroStep, self.at_step(micro_step, plain));
            }
        }
    }

    /// The automatic choice at every macro step; the other algorithms, and degrees of extrapolation, at the middle one.
    fn coupling(&mut self) {
        let mut steps = self.options.macro_steps.clone();
        steps.sort_by(f64::total_cmp);
        for &step in &steps {
            self.couple(AUTO, None, step);
        }
        let middle = steps.get(steps.len() / 2).filter(|_| !self.options.quick);
        let Some(&middle) = middle else { return };
        for algorithm in algorithms() {
            self.couple(algorithm, None, middle);
        }
        for degree in 0..=2 {
            self.couple(scene::Algorithm::GaussSeidel.name(), Some(degree), middle);
        }
    }

    fn couple(&mut self, algorithm: &str, extrapolation: Option<usize>, macro_step: f64) {
        let algorithm = algorithm.to_owned();
        let spec = RunSpec {
            // No longer than the macro step: a run and its row say the same.
            micro_step: self.subject.micro_step.min(macro_step),
            exchange: Exchange::Of {
                algorithm,
                extrapolation,
                macro_step,
            },
            ..self.base.clone()
        };
        self.add(Sweep::Coupling, spec);
    }

    /// All on one mesh: with those corrections that go with every one of them.
    fn rho_inf(&mut self) {
        let (subject, options) = (self.subject, self.options);
        let with = |corrections: &[String], rho_inf: f64| RunSpec {
            rho_inf,
            ..self.on_mesh(subject.elements, corrections)
        };
        let goes = |corrections: &Vec<String>| {
            let mut all = options.rho_inf.iter();
            all.all(|rho_inf| subject.takes(&subject.variant(&with(corrections, *rho_inf)).overrides))
        };
        let corrections = correction_sets().find(goes).unwrap_or_default();
        let specs = options.rho_inf.iter().map(|rho_inf| with(&corrections, *rho_inf));
        let specs: Vec<RunSpec> = specs.collect();
        specs.into_iter().for_each(|spec| self.add(Sweep::RhoInf, spec));
    }

    fn reductions(&mut self) {
        for reductions in self.reduction_sets() {
            let base = self.base.clone();
            self.add(Sweep::Reductions, RunSpec { reductions, ..base });
        }
    }

    /// The usual sets, each with what the scene has anyway; those that were asked for as they are.
    fn reduction_sets(&self) -> Vec<Vec<String>> {
        let subject = self.subject;
        let set = |text: &String| -> Vec<String> {
            let names = text.split('+').map(str::trim);
            let named = names.filter(|name| !name.is_empty() && *name != "none");
            named.map(str::to_owned).collect()
        };
        if !self.options.reductions.is_empty() {
            return self.options.reductions.iter().map(set).collect();
        }
        let linkage = |pantograph: &scene::Pantograph| matches!(pantograph.model, scene::PantographModel::Linkage(_));
        let mut sets = vec![Vec::new(), subject.with(&[])];
        if subject.scene.pushed_sideways().is_none() {
            sets.push(vec!["planar".to_owned()]);
        }
        if subject.scene.pantographs.iter().any(linkage) {
            sets.push(subject.with(&["linkage"]));
        }
        let usual = [&["linearised"][..], &["window"], &["linearised", "window"]];
        sets.extend(usual.map(|names| subject.with(names)));
        sets
    }

    /// The base case on everything else that the pantograph may stand on, with all reductions that change nothing
    /// there.
    fn vehicle(&mut self) {
        for vehicle_variant in &self.subject.vehicles.all {
            let spec = RunSpec {
                reductions: vec![AUTO.to_owned()],
                vehicle_variant: Some(vehicle_variant.clone()),
                ..self.base.clone()
            };
            self.add(Sweep::Vehicle, spec);
        }
    }

    fn ladder(&mut self) {
        let (subject, quick) = (self.subject, self.options.quick);
        let corrections = subject.best_corrections();
        let tolerance = subject.scene.solver.newton_tolerance.max(LADDER_TOLERANCE);
        let classes: [&[&str]; 4] = [&[], &["window"], &["linearised"], &["linearised", "window"]];
        for names in classes {
            let reductions = subject.with(names);
            if !names.is_empty() && !subject.takes(&[reduce_key(&reductions)]) {
                continue;
            }
            for &(elements, micro_step, _) in LADDER.iter().filter(|(.., short)| *short || !quick) {
                let elements = (subject.elements * elements).div_ceil(8).max(1);
                let rung = RunSpec {
                    mesh: subject.even_mesh(elements, corrections.to_vec()),
                    reductions: reductions.clone(),
                    newton_tolerance: tolerance,
                    ..self.base.clone()
                };
                self.add(
                    Sweep::Ladder,
                    self.at_step(0.125 * micro_step * subject.micro_step, rung),
                );
            }
        }
        if !corrections.is_empty() && !quick {
            let fine = RunSpec {
                mesh: subject.even_mesh(2 * subject.elements, Vec::new()),
                newton_tolerance: tolerance,
                ..self.base.clone()
            };
            self.add(Sweep::Ladder, self.at_step(0.25 * subject.micro_step, fine));
        }
    }

    fn spans(&mut self) {
        let options = self.options;
        for (names, counts) in [(&[][..], &options.spans), (&["window"][..], &options.window_spans)] {
            for &count in counts {
                let spec = RunSpec {
                    reductions: self.subject.with(names),
                    spans: Some(count),
                    ..self.base.clone()
                };
                self.add(Sweep::Spans, spec);
            }
        }
    }
}

/// Steps of the ladder: elements of the longest dropper interval and micro step, both in eighths of the base case's;
/// `true` where the step is one with `quick` too. Shorter intervals have elements of the same length: fewer for the
/// same error, and longer steps with the mass correction.
const LADDER: [(usize, f64, bool); 19] = [
    (2, 16.0, false),
    (4, 16.0, true),
    (4, 8.0, false),
    (6, 8.0, true),
    (7, 12.8, true),
    (7, 11.0, true),
    (7, 8.0, false),
    (7, 7.0, true),
    (8, 11.6, true),
    (8, 10.0, true),
    (8, 8.0, true),
    (9, 10.0, true),
    (10, 8.0, false),
    (12, 8.0, false),
    (8, 6.0, true),
    (8, 4.0, false),
    (12, 4.0, true),
    (14, 4.0, true),
    (16, 4.0, false),
];

/// Residual that ends Newton's method on the ladder, N: it moves the filtered force far less than the meshes of the
/// ladder do, and saves corrections.
const LADDER_TOLERANCE: f64 = 0.3;
