//! `master study`.

use std::path::PathBuf;

use clap::Args;

use super::experiment::{Files, Outputs};
use super::{CommandError, SceneFile, say};
use crate::cli::Common;
use crate::cli::values::{above_zero, elements, or, reductions, spans, spectral_radius, step, sweep};
use experiments::study::{self, CSV, FOLDER, Options, PAGE, Sweep};

/// Table and page of the study.
const FILES: Files = Files { csv: CSV, page: PAGE };

/// Arguments of `master study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Scene file, or an .ssp
    pub(crate) scene: PathBuf,
    /// Elements per dropper interval, up to 200, separated by commas [default: 1,2,4,8,16]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = elements)]
    pub(crate) elements: Vec<usize>,
    /// Micro steps, in ms or with a unit, separated by commas [default: 0.25,0.5,1,2]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = step)]
    pub(crate) micro_steps: Vec<f64>,
    /// Macro steps, in ms or with a unit, separated by commas [default: 1,2,5]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = step)]
    pub(crate) macro_steps: Vec<f64>,
    /// Spectral radii of generalised-α at infinite frequency, separated by commas [default: 0.5,0.8,0.9,1]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spectral_radius)]
    pub(crate) rho_inf: Vec<f64>,
    /// Sets of reductions joined by + and separated by commas: none,planar,linearised+window
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = reductions)]
    pub(crate) reductions: Vec<String>,
    /// Times that every run is timed, one run at a time; its wall time is the median
    #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) repeats: u16,
    /// Fewer runs: less of the mesh, of couplings and of the ladder
    #[arg(long)]
    pub(crate) quick: bool,
    /// Difference of two successive levels at which the reference has converged, % of its standard deviation
    #[arg(long, value_name = "PERCENT", default_value_t = Options::TOLERANCE, value_parser = above_zero)]
    pub(crate) reference_tolerance: f64,
    /// Most work of one run of the reference, coordinates times micro steps
    #[arg(long, value_name = "WORK", default_value_t = Options::WORK, value_parser = above_zero)]
    pub(crate) reference_work: f64,
    /// Also measures the cost of the whole line at these numbers of spans: 10,20,40,80
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spans)]
    pub(crate) spans: Vec<usize>,
    /// Also measures the cost of a window at these numbers of spans: 80,400,2000
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spans)]
    pub(crate) window_spans: Vec<usize>,
    /// Sweeps to make, separated by commas: scene, mesh, micro_step, coupling, rho_inf, reductions, vehicle, ladder,
    /// spans [default: all]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = sweep)]
    pub(crate) sweeps: Vec<Sweep>,
}

impl StudyArguments {
    /// Options of the study.
    fn options(&self) -> Result<Options, CommandError> {
        let flags = [
            ("--elements", Sweep::Mesh, !self.elements.is_empty()),
            ("--micro-steps", Sweep::MicroStep, !self.micro_steps.is_empty()),
            ("--macro-steps", Sweep::Coupling, !self.macro_steps.is_empty()),
            ("--rho-inf", Sweep::RhoInf, !self.rho_inf.is_empty()),
            ("--reductions", Sweep::Reductions, !self.reductions.is_empty()),
            ("--spans", Sweep::Spans, !self.spans.is_empty()),
            ("--window-spans", Sweep::Spans, !self.window_spans.is_empty()),
        ];
        check_flags(&self.sweeps, &flags)?;
        let usual = Options::usual(self.quick);
        Ok(Options {
            elements: or(&self.elements, &usual.elements),
            micro_steps: or(&self.micro_steps, &usual.micro_steps),
            macro_steps: or(&self.macro_steps, &usual.macro_steps),
            rho_inf: or(&self.rho_inf, &usual.rho_inf),
            reductions: self.reductions.clone(),
            repeats: self.repeats.into(),
            tolerance: self.reference_tolerance,
            work: self.reference_work,
            spans: self.spans.clone(),
            window_spans: self.window_spans.clone(),
            sweeps: self.sweeps.clone(),
            ..usual
        })
    }
}

/// Refuses typed flags whose sweep `sweeps` leaves out; a flag comes with its sweep and true where it was typed.
///
/// # Errors
/// [`CommandError::NoSweep`], [`CommandError::NoSpans`].
pub fn check_flags(sweeps: &[Sweep], flags: &[(&'static str, Sweep, bool)]) -> Result<(), CommandError> {
    let typed = || flags.iter().filter(|(_, _, typed)| *typed);
    if sweeps.contains(&Sweep::Spans) && !typed().any(|(_, sweep, _)| *sweep == Sweep::Spans) {
        return Err(CommandError::NoSpans);
    }
    let idle = typed().find(|(_, sweep, _)| !sweeps.is_empty() && !sweeps.contains(sweep));
    let Some(&(flag, missing, _)) = idle else {
        return Ok(());
    };
    let names: Vec<&str> = sweeps.iter().map(|sweep| sweep.name()).collect();
    let sweeps = names.join(",");
    Err(CommandError::NoSweep { flag, sweeps, missing })
}

/// Studies speed against error of a scene, and writes the table and the page.
///
/// # Errors
/// See [`CommandError`].
pub fn study(arguments: &StudyArguments, common: &Common) -> Result<(), CommandError> {
    let options = arguments.options()?;
    let path = arguments.scene.as_path();
    let file = SceneFile::read(path, common)?;
    let directory = file.output(common);
    let in_scene = |error: CommandError| error.in_scene(path);
    file.notes.iter().for_each(|note| say(common)(note));
    let script = study::script(file.scene, &file.name, &file.base, &common.overrides, options);
    let script = script.map_err(|error| in_scene(error.into()))?;
    if script.planned.is_empty() {
        let why = script.empty_sweeps().join("; ");
        let file = path.to_owned();
        return Err(CommandError::NothingToStudy { file, why });
    }
    let outputs = Outputs::open(&directory, FOLDER, FILES, common)?;
    let table = outputs.run(&script, &file.name, &|study| study::keep_ranks(&outputs.store, study));
    outputs.finish(&table.map_err(|error| in_scene(error.into()))?)
}
