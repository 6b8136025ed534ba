//! `master galloping`.

use std::path::PathBuf;

use clap::Args;

use super::{CommandError, SceneFile, interrupted, print, print_json, say};
use crate::cli::Common;
use crate::cli::values::above_zero;
use results::OutputDirectory;
use simulation::galloping::Galloping;

/// Arguments of `master galloping`.
#[derive(Debug, Args)]
pub struct GallopingArguments {
    /// Scene file, with [wind.wires] and a table of drag and lift
    scene: PathBuf,
    /// Speeds of the steady wind, in m/s; left out, some about the critical one
    #[arg(long, value_name = "U,…", value_delimiter = ',', value_parser = above_zero)]
    speeds: Vec<f64>,
    /// Amplitude of the motion at the start, in m
    #[arg(long, value_name = "A", default_value = "0.01", value_parser = above_zero)]
    amplitude: f64,
    /// Simulated time, in s
    #[arg(long, value_name = "S", default_value = "120", value_parser = above_zero)]
    duration: f64,
}

/// Lets the line of a scene gallop in a steady wind.
///
/// # Errors
/// See [`CommandError`].
pub fn galloping(arguments: &GallopingArguments, common: &Common) -> Result<(), CommandError> {
    let file = SceneFile::read(&arguments.scene, common)?;
    file.notes.iter().for_each(|note| say(common)(note));
    let asked = Galloping {
        speeds: arguments.speeds.clone(),
        amplitude: arguments.amplitude,
        duration: arguments.duration,
    };
    let report = asked.run(&file.scene, &file.name, interrupted(common));
    let report = report.map_err(|error| CommandError::from(error).in_scene(&arguments.scene))?;
    if common.json {
        print_json(&report)?;
    } else if !common.quiet {
        print(&report.text())?;
    }
    if let Some(out) = &common.out {
        let folder = OutputDirectory::open(out.clone()).map_err(CommandError::Directory)?;
        report.write(&folder).map_err(CommandError::Results)?;
    }
    Ok(())
}
