//! Command line arguments, as typed.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Arg, ArgAction, Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use crate::command::{self, CommandError, galloping, latency, run, sensitivity, study, sweep, validate, wear};
use experiments::compare;
use fmi2::isolation;

mod help;
pub(crate) mod values;

use help::{EXIT_STATUS, RUN_STATUS, compare_help, reproduce_help, stability_help, study_help, sweep_help};
use values::{or, step};

/// Scene that runs without arguments.
pub(crate) const DEFAULT_SCENE: &str = "scenes/thesis.toml";

/// Pantograph and overhead line: co-simulation of two FMUs, and the same models as one system.
///
/// Without a command: `run scenes/thesis.toml`.
#[derive(Debug, Parser)]
#[command(
    name = "master",
    display_name = "Pantoline",
    version = concat!(env!("CARGO_PKG_VERSION"), " (master)"),
    about,
    after_help = RUN_STATUS
)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    common: Common,
}

/// Options of all commands.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Directory that results are written to [default: results/SCENE; of package target/fmu/SCENE]
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
    #[command(after_help = RUN_STATUS)]
    Run(run::RunArguments),
    /// Runs a scene in all modes and with all coupling algorithms: differences and costs side by side
    #[command(after_long_help = compare_help())]
    Compare {
        /// Scene file, or an .ssp
        #[arg(required_unless_present = "test_problem", conflicts_with = "test_problem")]
        scene: Option<PathBuf>,
        /// Runs the coupling test problem instead of a scene: two masses under one wire mode
        #[arg(long)]
        test_problem: bool,
        /// Macro steps, in ms or with a unit (0.5, 0.5ms, 500us, 5e-4s), separated by commas
        /// [default: 0.1,0.2,0.5,1,2,5,10; of the test problem 0.2,1,2,5]
        #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true)]
        #[arg(value_parser = step)]
        macro_steps: Vec<f64>,
        /// Times that every run is made; its wall time is the median
        #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..))]
        repeats: u16,
    },
    /// Speed against error: sweeps mesh, steps, coupling and reductions against a converged reference
    #[command(after_long_help = study_help())]
    Study(study::StudyArguments),
    /// Runs the hard cases: what is stable, and where it stops being so
    #[command(after_long_help = stability_help(), arg = hidden_set())]
    Stability {
        /// Cases to run, separated by commas [default: all]
        #[arg(long, value_name = "LIST", value_delimiter = ',')]
        cases: Vec<String>,
        /// Shortens the longest cases, and draws no maps
        #[arg(long)]
        quick: bool,
    },
    /// Runs many cases of one scene on all cores, into one table
    #[command(after_long_help = sweep_help())]
    Sweep(sweep::SweepArguments),
    /// How much results depend on numbers that are not known for certain: each at the ends of its range
    #[command(after_help = EXIT_STATUS)]
    Sensitivity(sensitivity::SensitivityArguments),
    /// Lets a train pass many times over a line that wears: map of wear, life of wire and strip
    #[command(after_help = EXIT_STATUS)]
    Wear(wear::WearArguments),
    /// Runs a scene at the pace of real time: how long its steps take, and how many end late
    #[command(arg = hidden_out(), after_help = EXIT_STATUS)]
    Latency(latency::LatencyArguments),
    /// Lets the line of a scene gallop in a steady wind: critical speed, growth and limit cycle, without pantographs
    #[command(after_help = EXIT_STATUS)]
    Galloping(galloping::GallopingArguments),
    /// Solves the statics of a scene, says what will be modelled and draws the line
    #[command(after_help = EXIT_STATUS)]
    Check {
        /// Scene file, or an .ssp
        scene: PathBuf,
        /// No page and no tables of the line.
        #[arg(long)]
        no_report: bool,
    },
    /// Writes Catenary.fmu and Pantograph.fmu for a scene
    #[command(after_help = EXIT_STATUS)]
    Package {
        /// Scene file, or an .ssp
        #[arg(default_value = DEFAULT_SCENE)]
        scene: PathBuf,
        /// Also writes the model descriptions into this directory, with a placeholder for the GUID
        #[arg(long, value_name = "DIR", num_args = 0..=1, require_equals = true)]
        #[arg(default_missing_value = "modelDescription")]
        write_descriptions: Option<PathBuf>,
    },
    /// Writes the co-simulation of a scene as an .ssp (SSP 1.0) that other tools open
    #[command(after_help = EXIT_STATUS)]
    Export {
        /// Scene file, or an .ssp
        scene: PathBuf,
    },
    /// Shows variables and capabilities of any FMI 2.0 FMU, and how it would be wired
    #[command(args = [hidden_set(), hidden_out()], after_help = EXIT_STATUS)]
    Inspect {
        /// FMU file
        fmu: PathBuf,
    },
    /// Runs one FMU for another process of this program, over its standard input
    #[command(name = isolation::SUBCOMMAND, hide = true)]
    IsolatedFmu,
    /// Computes a published piece of work again: its tables and figures, published beside computed
    #[command(after_long_help = reproduce_help())]
    Reproduce {
        /// Publication to compute again
        what: Publication,
        /// Fewer meshes, and open quantities on the published mesh only
        #[arg(long)]
        quick: bool,
    },
    /// Runs a reference model of a standard in every mode: figures against their ranges, as a record to keep
    #[command(args = [hidden_set()], after_help = RUN_STATUS)]
    Validate(validate::ValidateArguments),
    /// Explains a key of a scene, a figure, a limit of a standard or a note
    #[command(args = [hidden_set(), hidden_out()], after_help = EXIT_STATUS)]
    Explain {
        /// Word as in a scene, a table or a report: run.low_pass_hz, std, "EN 50367 mean", mesh
        #[arg(required = true, value_name = "WORD")]
        words: Vec<String>,
        /// Scene whose table of limits holds, `assessment`: limits of your own stand in their places
        #[arg(long, value_name = "SCENE")]
        scene: Option<PathBuf>,
    },
    /// Prints a script that completes commands and options in a shell
    #[command(args = [hidden_set(), hidden_out(), hidden_json()], after_help = EXIT_STATUS)]
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Renders report.html again; several directories are overlaid
    #[command(arg = hidden_set(), after_help = EXIT_STATUS)]
    Report {
        /// Output directories of finished runs
        #[arg(required = true, value_name = "DIR")]
        directories: Vec<PathBuf>,
    },
}

/// `--set` of a command that reads no scene: refused with a reason, and not in its help.
fn hidden_set() -> Arg {
    Arg::new("overrides").long("set").action(ArgAction::Append).hide(true)
}

/// `--out` of a command that writes no files: refused with a reason, and not in its help.
fn hidden_out() -> Arg {
    let path = clap::value_parser!(PathBuf);
    Arg::new("out").long("out").value_parser(path).hide(true)
}

/// `--json` of a command whose output is not a result: not in its help.
fn hidden_json() -> Arg {
    Arg::new("json").long("json").action(ArgAction::SetTrue).hide(true)
}

/// Publications that `reproduce` computes again.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Publication {
    /// Kulkarni 2016
    Thesis,
}

/// Runs the program; exit status: 0 done, 1 not completed, 2 wrong usage, scene or FMU, 3 limits fail with
/// `--fail-on-limits`.
#[must_use]
pub fn main() -> ExitCode {
    // Prints help or the mistake and exits with 0 or 2.
    let Arguments { command, common } = Arguments::parse();
    command::keep_stdout();
    isolation::this_program_serves();
    fmi2::import::guard::install(fmi2::import::guard::Report::Sentence);
    let command = command.unwrap_or_else(|| Command::Run(run::RunArguments::default()));
    let result = match command {
        Command::Run(arguments) => run::run(&arguments, &common),
        Command::Compare {
            scene,
            test_problem: _,
            macro_steps,
            repeats,
        } => {
            let repeats = repeats.into();
            match scene {
                Some(scene) => {
                    command::compare::compare(&scene, &or(&macro_steps, &compare::MACRO_STEPS), repeats, &common)
                }
                None => {
                    command::compare::test_problem(&or(&macro_steps, &compare::TEST_PROBLEM_STEPS), repeats, &common)
                }
            }
        }
        Command::Study(arguments) => study::study(&arguments, &common),
        Command::Sweep(arguments) => sweep::sweep(&arguments, &common),
        Command::Sensitivity(arguments) => sensitivity::sensitivity(&arguments, &common),
        Command::Galloping(arguments) => galloping::galloping(&arguments, &common),
        Command::Wear(arguments) => wear::wear(&arguments, &common),
        Command::Latency(arguments) => latency::latency(&arguments, &common),
        Command::Reproduce {
            what: Publication::Thesis,
            quick,
        } => command::reproduce::thesis(quick, &common),
        Command::Stability { cases, quick } => command::stability::stability(&cases, quick, &common),
        Command::Check { scene, no_report } => command::check::check(&scene, no_report, &common),
        Command::Package {
            scene,
            write_descriptions,
        } => command::package::package(&scene, write_descriptions.as_deref(), &common),
        Command::Export { scene } => command::export::export(&scene, &common),
        Command::Inspect { fmu } => command::inspect::inspect(&fmu, &common),
        Command::IsolatedFmu => isolation::serve().map_err(CommandError::Isolation),
        Command::Validate(arguments) => validate::validate(&arguments, &common),
        Command::Explain { words, scene } => command::explain::explain(&words, scene.as_deref(), &common),
        Command::Completions { shell } => command::completions::completions(shell, &common),
        Command::Report { directories } => command::report::report(&directories, &common),
    };
    let status = result.err().map_or(0, |error| {
        command::complain(&format!("error: {}", cosim::chain(&error)));
        error.exit_code()
    });
    fmi2::supervision::ended(status)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use experiments::study::Sweep;

    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    /// Why a line is refused.
    fn refusal(line: &[&str]) -> String {
        Arguments::try_parse_from(line).unwrap_err().to_string()
    }

    #[test]
    fn a_study_refuses_what_no_scene_can_have_with_what_would_be_right() {
        let study = |flag, value| refusal(&["master", "study", "a.toml", flag, value]);
        for wrong in ["foo", "planar+foo", "planar+planar", "none+planar", "planar,"] {
            let said = study("--reductions", wrong);
            assert!(
                said.contains("none, auto, or one or more of planar, linearised, flat, window, modal, linkage"),
                "{said}"
            );
        }
        for right in ["none", "auto", "planar, linearised+window"] {
            assert!(Arguments::try_parse_from(["master", "study", "a.toml", "--reductions", right]).is_ok());
        }
        assert!(study("--elements", "2,500").contains("'500'") && study("--elements", "500").contains("from 1 to 200"));
        assert!(study("--spans", "0").contains("from 1 to 5000"));
    }

    #[test]
    fn macro_steps_are_read_in_milliseconds_or_with_a_unit() {
        let short = ["0.1", "0.1ms", "100us", "100 µs", "1e-4s"].map(|text| (text, 1e-4));
        for (text, step) in short.into_iter().chain([("10", 1e-2)]) {
            assert_eq!(values::step(text), Ok(step), "{text}");
        }
        for text in ["0", "-1", "fast", "", "ms", "nan", "inf", "1 km"] {
            let refused = values::step(text).unwrap_err();
            assert!(refused.contains("positive number in ms"), "{text}: {refused}");
        }
    }

    #[test]
    fn a_flag_without_its_sweep_is_refused() {
        let flags = [("--spans", Sweep::Spans, true), ("--elements", Sweep::Mesh, false)];
        let said = |sweeps: &[Sweep]| command::study::check_flags(sweeps, &flags).map_err(|error| error.to_string());
        assert!(said(&[]).is_ok() && said(&[Sweep::Mesh, Sweep::Spans]).is_ok());
        let refused = said(&[Sweep::Mesh]).unwrap_err();
        assert!(
            refused.starts_with("--spans: --sweeps mesh leaves out") && refused.ends_with("--sweeps mesh,spans"),
            "{refused}"
        );
    }

    #[test]
    fn help_lists_set_where_there_is_a_scene() {
        let help = |name: &str| refusal(&["master", name, "--help"]);
        for name in ["run", "compare", "study", "sweep", "check", "reproduce"] {
            assert!(help(name).contains("--set"), "{name}");
        }
        for name in ["stability", "inspect", "report"] {
            assert!(!help(name).contains("--set"), "{name}");
            // It is understood, so that the command can say why not.
            let line = ["master", name, "x", "--set", "a=b"];
            let line = if name == "stability" {
                &["master", name, "--set", "a=b"][..]
            } else {
                &line
            };
            assert_eq!(
                Arguments::try_parse_from(line).unwrap().common.overrides,
                ["a=b"],
                "{name}"
            );
        }
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
