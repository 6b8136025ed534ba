//! `master sensitivity`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::run::ModeArgument;
use super::sweep::text_of;
use super::{CommandError, found, interrupted, print, print_json};
use crate::cli::Common;
use ::sweep::sensitivity::{self, CSV, JSON, PAGE, Parameter, Sensitivity};
use ::sweep::{Base, Options, Sweep};
use cosim::package;
use results::Machine;
use results::OutputDirectory;
use results::report::{Progress, Show};
use simulation::Mode;
use simulation::paths::scene_name;

/// Arguments of `master sensitivity`.
#[derive(Debug, Args)]
pub struct SensitivityArguments {
    /// Scene file with ranges of its numbers
    scene: PathBuf,
    /// Range of a number, or its distribution as in KEY=normal(MEAN,STD), in place of that of the scene; repeatable
    #[arg(long, value_name = "KEY=LOW:HIGH", allow_hyphen_values = true)]
    range: Vec<String>,
    /// How line and pantographs are put together
    #[arg(long, value_enum, default_value = "monolithic")]
    mode: ModeArgument,
    /// Cases made side by side [default: number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
}

/// Folder of the analysis beside that of runs of the same scene.
pub fn folder(runs: &Path) -> PathBuf {
    let name = runs.file_name().unwrap_or_default().to_string_lossy();
    runs.with_file_name(format!("{name}-sensitivity"))
}

/// Runs a scene with each uncertain number at the ends of its range.
///
/// # Errors
/// See [`CommandError`].
pub fn sensitivity(arguments: &SensitivityArguments, common: &Common) -> Result<(), CommandError> {
    let path = found(&arguments.scene);
    let text = text_of(&path, &arguments.scene)?;
    let (name, mode) = (scene_name(&path), Mode::from(arguments.mode));
    let scene_folder = path.parent().unwrap_or(Path::new(""));
    let origin = arguments.scene.display().to_string();
    let base = Base::new(&name, &origin, scene_folder, text, common.overrides.clone());
    let parameters = Parameter::of(&base, &arguments.range)?;
    let identity = sensitivity::identity(&base)?;
    let options = Options {
        mode,
        jobs: arguments.jobs.map_or(Machine::this().cores, usize::from),
        series: false,
        logging: common.verbose > 1,
        fmus: package::folder(&format!("{name}-sensitivity")),
    };
    let sweep = Sweep::new(base, sensitivity::wishes(&parameters), options)?;
    if mode == Mode::Cosimulation {
        // The libraries are made before runs that need them stand side by side.
        package::Libraries::find()?;
    }
    let default = || folder(&Path::new("results").join(&name));
    let directory = common.out.clone().unwrap_or_else(default);
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share(&name, show);
    let summary = sweep.run(&directory, interrupted(common), &progress)?;
    progress.finish();
    if !summary.complete {
        let reason = format!(
            "{} of {} runs are finished; the same command goes on from there",
            summary.finished, summary.cases
        );
        return Err(CommandError::Incomplete { directory, reason });
    }
    let records = sweep.records(&directory)?;
    let found = Sensitivity::of((&name, mode.name(), identity), &parameters, &records);
    found.write(&output).map_err(CommandError::Results)?;
    if common.json {
        print_json(&found)?;
    } else if !common.quiet {
        print(&format!(
            "{}\n{CSV}, {JSON} and {PAGE} in {}\n",
            found.text(),
            directory.display()
        ))?;
    }
    Ok(())
}
