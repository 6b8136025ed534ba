//! `master latency`.

use std::path::PathBuf;

use clap::Args;

use super::run::ModeArgument;
use super::{CommandError, SceneFile, interrupted, nothing_to_write, print, print_json, say};
use crate::cli::Common;
use crate::cli::values::above_zero;
use cosim::package;
use simulation::latency::Latency;
use simulation::{FmuSource, Mode};

/// Arguments of `master latency`.
#[derive(Debug, Args)]
pub struct LatencyArguments {
    /// Scene file, or an .ssp
    scene: PathBuf,
    /// How line and pantographs are put together
    #[arg(long, value_enum, default_value = "cosimulation")]
    mode: ModeArgument,
    /// Real time to measure for, in s: the run is repeated until it has passed
    #[arg(long, value_name = "S", default_value = "10", value_parser = above_zero)]
    duration: f64,
}

/// Runs a scene in real time and measures its steps.
///
/// # Errors
/// See [`CommandError`].
pub fn latency(arguments: &LatencyArguments, common: &Common) -> Result<(), CommandError> {
    nothing_to_write("master latency", common)?;
    let path = arguments.scene.as_path();
    let file = SceneFile::read(path, common)?;
    file.notes.iter().for_each(|note| say(common)(note));
    let source = FmuSource {
        folder: package::folder(&file.name),
        logging: common.verbose > 1,
    };
    let latency = Latency {
        scene: &file.scene,
        name: &file.name,
        base: &file.base,
        mode: Mode::from(arguments.mode),
        source: &source,
        duration: arguments.duration,
    };
    let report = latency
        .measure(interrupted(common), &())
        .map_err(|error| CommandError::from(error).in_scene(path))?;
    if common.json {
        print_json(&report)?;
    } else if !common.quiet {
        print(&report.text())?;
    }
    if report.incomplete_reason.is_empty() {
        return Ok(());
    }
    Err(CommandError::Unfinished {
        reason: report.incomplete_reason,
    })
}
