//! `master wear`.

use std::path::PathBuf;

use clap::Args;

use super::run::ModeArgument;
use super::{CommandError, SceneFile, interrupted, print, print_json, say};
use crate::cli::Common;
use cosim::package;
use passages::{CSV, Forces, JSON, PAGE, Surroundings, Wishes, run};
use results::OutputDirectory;
use results::report::{Progress, Show};
use simulation::Mode;

/// Arguments of `master wear`.
#[derive(Debug, Args)]
pub struct WearArguments {
    /// Scene file with a table `wear`
    scene: PathBuf,
    /// Passages of the train
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    passages: u64,
    /// Passages before the worn line is simulated again [default: by wear.depth_step, an eighth at most]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u64).range(1..))]
    every: Option<u64>,
    /// Static forces compared on the line as it is, % of those of the scene, separated by commas, or none
    #[arg(long, value_name = "LIST", default_value = "80,100,120", value_parser = Forces::typed)]
    forces: Forces,
    /// How line and pantographs are put together
    #[arg(long, value_enum, default_value = "monolithic")]
    mode: ModeArgument,
}

/// Lets a train pass many times over a line that wears.
///
/// # Errors
/// See [`CommandError`].
pub fn wear(arguments: &WearArguments, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(&arguments.scene, common)?;
    let say = say(common);
    file.notes.iter().for_each(|note| say(note));
    let directory = common
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("results").join(format!("{}-wear", file.name)));
    let mut output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    let holder = format!("`master wear` of {}", arguments.scene.display());
    output.lock(&holder).map_err(CommandError::Directory)?;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share(&file.name, show);
    let wishes = Wishes {
        passages: arguments.passages,
        every: arguments.every,
        forces: arguments.forces.0.clone(),
    };
    let around = Surroundings {
        name: &file.name,
        base: &file.base,
        mode: Mode::from(arguments.mode),
        logging: common.verbose > 1,
        fmus: package::folder(&format!("{}-wear", file.name)),
        interrupted: interrupted(common),
        progress: &progress,
    };
    let record = run(&file.scene, &wishes, &around, &output).map_err(|source| CommandError::Passages {
        file: arguments.scene.clone(),
        source: Box::new(source),
    })?;
    progress.finish();
    record.write(&output).map_err(CommandError::Results)?;
    if common.json {
        print_json(&record)?;
    } else if !common.quiet {
        print(&format!(
            "{}\n{CSV}, {JSON} and {PAGE} in {}\n",
            record.text(),
            directory.display()
        ))?;
    }
    if record.complete {
        return Ok(());
    }
    let (done, all) = (record.passages(), record.asked);
    let reason = format!("{done} of {all} passages are done; the same command goes on from there");
    Err(CommandError::Incomplete { directory, reason })
}
