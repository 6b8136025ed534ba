//! Command line arguments, as typed.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};

use crate::command::{self, CommandError};
use crate::isolation;
use crate::simulation::Mode;

/// Scene that is run when nothing is said.
const DEFAULT_SCENE: &str = "scenes/thesis.toml";

/// Pantograph and overhead line: co-simulation of two FMUs, and the same models as one system.
///
/// Without a command: `run scenes/thesis.toml`.
#[derive(Debug, Parser)]
#[command(name = "master", version, about)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    common: Common,
}

/// Options of all commands.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Directory that results are written to [default: results/SCENE]
    #[arg(long, global = true, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Overrides a key of the scene; repeatable
    #[arg(long = "set", global = true, value_name = "KEY.PATH=VALUE")]
    pub overrides: Vec<String>,
    /// Prints the result as JSON on stdout, and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// Says more; debug messages of FMUs are logged
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    pub verbose: u8,
    /// Prints errors only
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Runs a scene and writes its results
    Run {
        /// Scene file, or an .ssp
        #[arg(default_value = DEFAULT_SCENE)]
        scene: PathBuf,
        /// How line and pantographs are put together
        #[arg(long, value_enum, default_value = "cosimulation")]
        mode: ModeArgument,
    },
    /// Solves the statics of a scene and says what will be modelled
    Check {
        /// Scene file
        scene: PathBuf,
    },
    /// Writes Catenary.fmu and Pantograph.fmu for a scene
    Package {
        /// Scene file
        #[arg(default_value = DEFAULT_SCENE)]
        scene: PathBuf,
        /// Also writes the model descriptions into this directory, with a placeholder for the GUID
        #[arg(long, value_name = "DIR", num_args = 0..=1, require_equals = true, default_missing_value = "modelDescription")]
        write_descriptions: Option<PathBuf>,
    },
    /// Writes the co-simulation of a scene as an .ssp (SSP 1.0) that other tools open
    Export {
        /// Scene file
        scene: PathBuf,
    },
    /// Shows variables and capabilities of any FMI 2.0 FMU, and how it would be wired
    Inspect {
        /// FMU file
        fmu: PathBuf,
    },
    /// Runs one FMU for another process of this program, over its standard input
    #[command(name = isolation::SUBCOMMAND, hide = true)]
    IsolatedFmu,
    /// Renders report.html again; several directories are overlaid
    Report {
        /// Output directories of finished runs
        #[arg(required = true, value_name = "DIR")]
        directories: Vec<PathBuf>,
    },
}

/// `--mode`.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ModeArgument {
    /// FMUs through their C interface
    Cosimulation,
    /// One system, one integrator
    Monolithic,
    /// The FMUs' subsystems without FMI
    Inprocess,
}

impl From<ModeArgument> for Mode {
    fn from(argument: ModeArgument) -> Self {
        match argument {
            ModeArgument::Cosimulation => Self::Cosimulation,
            ModeArgument::Monolithic => Self::Monolithic,
            ModeArgument::Inprocess => Self::Inprocess,
        }
    }
}

/// Runs the program; the exit status is 0 done, 1 not completed, 2 wrong usage, scene or FMU.
#[must_use]
pub fn main() -> ExitCode {
    // Prints help or the mistake and exits with 0 or 2.
    let Arguments { command, common } = Arguments::parse();
    isolation::this_program_serves();
    fmi2::import::guard::install(fmi2::import::guard::Report::Sentence);
    let command = command.unwrap_or(Command::Run {
        scene: DEFAULT_SCENE.into(),
        mode: ModeArgument::Cosimulation,
    });
    let result = match command {
        Command::Run { scene, mode } => command::run::run(&scene, mode.into(), &common),
        Command::Check { scene } => command::check::check(&scene, &common),
        Command::Package {
            scene,
            write_descriptions,
        } => command::package::package(&scene, write_descriptions.as_deref(), &common),
        Command::Export { scene } => command::export::export(&scene, &common),
        Command::Inspect { fmu } => command::inspect::inspect(&fmu, &common),
        Command::IsolatedFmu => isolation::serve().map_err(CommandError::Isolation),
        Command::Report { directories } => command::report::report(&directories, &common),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", crate::simulation::chain(&error));
            ExitCode::from(error.exit_code())
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn options_may_stand_before_and_behind_the_command() {
        for line in [
            ["master", "--out", "x", "run", "a.toml"],
            ["master", "run", "a.toml", "--out", "x"],
        ] {
            let arguments = Arguments::try_parse_from(line).unwrap();
            assert_eq!(arguments.common.out, Some(PathBuf::from("x")));
        }
    }

    #[test]
    fn an_unknown_command_is_wrong_usage() {
        let error = Arguments::try_parse_from(["master", "frobnicate"]).unwrap_err();
        assert_eq!(error.exit_code(), 2);
    }
}
