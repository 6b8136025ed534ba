//! `master study`.

use std::path::PathBuf;

use clap::Args;

use super::{CommandError, SceneFile, interrupted, print, print_json, say};
use crate::cli::Common;
use crate::cli::values::{above_zero, elements, or, reductions, spans, spectral_radius, sweep};
use experiments::study::{self, CSV, Options, PAGE, Study, StudyError, Sweep};
use experiments::table_of_runs::{self, macro_step};
use results::report::{Progress, Show};
use results::{OutputDirectory, ResultsError};

/// Arguments of `master study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// Scene file, or an .ssp
    pub(crate) scene: PathBuf,
    /// Elements per dropper interval, up to 200, separated by commas [default: 1,2,4,8,16]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = elements)]
    pub(crate) elements: Vec<usize>,
    /// Micro steps, in ms or with a unit, separated by commas [default: 0.25,0.5,1,2]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = macro_step)]
    pub(crate) micro_steps: Vec<f64>,
    /// Macro steps, in ms or with a unit, separated by commas [default: 1,2,5]
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = macro_step)]
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
        Ok(Options {
            elements: or(
                &self.elements,
                if self.quick {
                    &Options::QUICK_ELEMENTS
                } else {
                    &Options::ELEMENTS
                },
            ),
            micro_steps: or(
                &self.micro_steps,
                if self.quick {
                    &Options::QUICK_MICRO_STEPS
                } else {
                    &Options::MICRO_STEPS
                },
            ),
            macro_steps: or(&self.macro_steps, &Options::MACRO_STEPS),
            rho_inf: or(&self.rho_inf, if self.quick { &[] } else { &Options::RHO_INF }),
            reductions: self.reductions.clone(),
            repeats: self.repeats.into(),
            quick: self.quick,
            tolerance: self.reference_tolerance,
            work: self.reference_work,
            spans: self.spans.clone(),
            window_spans: self.window_spans.clone(),
            sweeps: self.sweeps.clone(),
        })
    }
}

impl From<StudyError> for CommandError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Setup(error) => Self::Setup(error),
            StudyError::Results(error) => Self::Results(error),
        }
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
    let interrupted = interrupted(common);
    file.notes.iter().for_each(|note| say(common)(note));
    let script = study::script(file.scene, &file.name, &file.base, &common.overrides, options);
    let script = script.map_err(|error| in_scene(error.into()))?;
    if script.planned.is_empty() {
        let why = script.empty_sweeps().join("; ");
        let file = path.to_owned();
        return Err(CommandError::NothingToStudy { file, why });
    }
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    let store = script.store(&directory).map_err(CommandError::Directory)?;
    // An older page may belong to another study than the table.
    output.remove(PAGE).map_err(CommandError::Directory)?;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share(&file.name, show);
    let mut keep = |study: &Study| write_table(&output, study).map_err(StudyError::from);
    let study = study::study(&script, &store, interrupted, &progress, &mut keep);
    let study = study.map_err(|error| in_scene(error.into()))?;
    progress.finish();
    output
        .write_page(PAGE, &study::page(&study))
        .map_err(CommandError::Results)?;
    if common.json {
        print_json(&study)?;
    } else if !common.quiet {
        print(&format!(
            "{}\n  {CSV} and {PAGE} in {}\n",
            study::text(&study),
            directory.display()
        ))?;
    }
    if study.complete {
        return Ok(());
    }
    Err(CommandError::Incomplete {
        reason: format!(
            "{} of {} runs were made; the same command goes on from there",
            study.made(),
            study.rows.len()
        ),
        directory,
    })
}

fn write_table(output: &OutputDirectory, study: &Study) -> Result<(), ResultsError> {
    let (rows, columns) = study.table();
    output.replace(CSV, |out, path| table_of_runs::write(out, path, &rows, &[], &columns))
}
