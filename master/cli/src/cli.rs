//! Command line arguments, as typed.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Arg, ArgAction, Args, Parser, Subcommand, ValueEnum};
use scene::{Division, MAX_SPANS, Reduction};

use crate::command::{self, CommandError};
use experiments::compare;
use experiments::study::{Options, Sweep};
use experiments::table_of_runs::{AUTO, SETTLE, STATUS_RULE, macro_step};
use fmi2::isolation;
use simulation::Mode;

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
    /// Directory that results are written to [default: results/SCENE; of package target/fmu/SCENE]; check writes none
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
        #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = macro_step)]
        macro_steps: Vec<f64>,
        /// Times that every run is made; its wall time is the median
        #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..))]
        repeats: u16,
    },
    /// Speed against error: sweeps mesh, steps, coupling and reductions against a converged reference
    #[command(after_long_help = study_help())]
    Study {
        /// Scene file, or an .ssp
        scene: PathBuf,
        /// Elements per dropper interval, up to 200, separated by commas [default: 1,2,4,8,16]
        #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = elements)]
        elements: Vec<usize>,
        /// Micro steps, in ms or with a unit, separated by commas [default: 0.25,0.5,1,2]
        #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = macro_step)]
        micro_steps: Vec<f64>,
        /// Macro steps, in ms or with a unit, separated by commas [default: 1,2,5]
        #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = macro_step)]
        macro_steps: Vec<f64>,
        /// Spectral radii of generalised-α at infinite frequency, separated by commas [default: 0.5,0.8,0.9,1]
        #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spectral_radius)]
        rho_inf: Vec<f64>,
        /// Sets of reductions joined by + and separated by commas: none,planar,linearised+window
        #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = reductions)]
        reductions: Vec<String>,
        /// Times that every run is timed, one run at a time; its wall time is the median
        #[arg(long, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u16).range(1..))]
        repeats: u16,
        /// Fewer runs: less of the mesh, of couplings and of the ladder
        #[arg(long)]
        quick: bool,
        /// Difference of two successive levels at which the reference has converged, % of its standard deviation
        #[arg(long, value_name = "PERCENT", default_value_t = Options::TOLERANCE, value_parser = above_zero)]
        reference_tolerance: f64,
        /// Most work of one run of the reference, coordinates times micro steps
        #[arg(long, value_name = "WORK", default_value_t = Options::WORK, value_parser = above_zero)]
        reference_work: f64,
        /// Also measures the cost of the whole line at these numbers of spans: 10,20,40,80
        #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spans)]
        spans: Vec<usize>,
        /// Also measures the cost of a window at these numbers of spans: 80,400,2000
        #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = spans)]
        window_spans: Vec<usize>,
        /// Sweeps to make, separated by commas: scene,mesh,micro_step,coupling,rho_inf,reductions,vehicle,ladder,spans [default: all]
        #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = sweep)]
        sweeps: Vec<Sweep>,
    },
    /// Runs the hard cases: what is stable, and where it stops being so
    #[command(after_long_help = stability_help(), arg = no_set())]
    Stability {
        /// Cases to run, separated by commas [default: all]
        #[arg(long, value_name = "LIST", value_delimiter = ',')]
        cases: Vec<String>,
        /// Shortens the longest cases, and draws no maps
        #[arg(long)]
        quick: bool,
    },
    /// Solves the statics of a scene and says what will be modelled
    Check {
        /// Scene file, or an .ssp
        scene: PathBuf,
    },
    /// Writes Catenary.fmu and Pantograph.fmu for a scene
    Package {
        /// Scene file, or an .ssp
        #[arg(default_value = DEFAULT_SCENE)]
        scene: PathBuf,
        /// Also writes the model descriptions into this directory, with a placeholder for the GUID
        #[arg(long, value_name = "DIR", num_args = 0..=1, require_equals = true, default_missing_value = "modelDescription")]
        write_descriptions: Option<PathBuf>,
    },
    /// Writes the co-simulation of a scene as an .ssp (SSP 1.0) that other tools open
    Export {
        /// Scene file, or an .ssp
        scene: PathBuf,
    },
    /// Shows variables and capabilities of any FMI 2.0 FMU, and how it would be wired
    #[command(arg = no_set())]
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
        /// What to reproduce
        what: Publication,
        /// Fewer meshes, and open quantities on the published mesh only
        #[arg(long)]
        quick: bool,
    },
    /// Renders report.html again; several directories are overlaid
    #[command(arg = no_set())]
    Report {
        /// Output directories of finished runs
        #[arg(required = true, value_name = "DIR")]
        directories: Vec<PathBuf>,
    },
}

/// `--set` of a command that reads no scene: refused with a reason, and not in its help.
fn no_set() -> Arg {
    Arg::new("overrides").long("set").action(ArgAction::Append).hide(true)
}

/// What `compare` does, at the end of its help.
fn compare_help() -> String {
    format!(
        "Runs: monolithic; with FMUs every algorithm at every macro step; in process the automatic choice. One at a time, so that \
         wall times can be compared. They end when the last strip has left the evaluation range and the low-pass filter has \
         settled ({SETTLE} periods of its cut-off).\n\n\
         Micro steps: only the coupling shall differ, so a coupled run and its monolithic reference have the same micro step, \
         never longer than a macro step compared with it. Macro steps from half the scene's micro step on share one, that of the \
         scene or the smallest of them; shorter ones are taken in groups that span less than a factor of five, each at its \
         smallest and with its own reference. With a micro step of 1 ms in the scene, the default list makes two groups: 0.5 to \
         10 ms at 0.5 ms, and 0.1 and 0.2 ms at 0.1 ms. `--set solver.micro_step=…` shortens all of them.\n\n\
         Keys: order, force and extrapolation of the scene belong to the algorithm that it names, the others run with their own \
         defaults; `--set coupling.…` holds for all.\n\n\
         Status: {STATUS_RULE}.\n\n\
         compare.csv is written after every run; rows without a status have not been run."
    )
}

/// What `study` does, at the end of its help.
fn study_help() -> String {
    format!(
        "Reference: elements doubled and micro step halved until two successive levels agree within the tolerance; the nonlinear \
         line with two meshes (corrected and plain), which confirm each other. Their last difference is stated as what is not known \
         of the reference. Linearised and flat lines have references of their own.\n\n\
         Runs: a base case that resolves the waves ahead of the pantograph and the band of the low-pass filter; sweeps that \
         change one thing of it; where the scene has a vehicle, every model of it that the scene has what it needs for, on its track \
         and, where that is smooth, on one with irregularities of the lower level of ORE B176; a ladder of balanced recipes for each class of reductions. They end when the last strip has left \
         the evaluation range and the low-pass filter has settled ({SETTLE} periods of its cut-off).\n\n\
         Errors are computed on all cores at once, wall times one run at a time afterwards. Every run is kept in the folder study \
         of the output directory: a study that was ended goes on where it was, with the same program.\n\n\
         Status: {STATUS_RULE}."
    )
}

/// A number of things, at least one and at most `most`.
fn count(text: &str, most: usize) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(count) if (1..=most).contains(&count) => Ok(count),
        _ => Err(format!("must be a whole number from 1 to {most}")),
    }
}

/// Elements of a dropper interval.
fn elements(text: &str) -> Result<usize, String> {
    count(text, Division::MOST)
}

/// Spans of a line.
fn spans(text: &str) -> Result<usize, String> {
    count(text, MAX_SPANS)
}

/// A set of reductions, as it is typed.
fn reductions(text: &str) -> Result<String, String> {
    let known = || Reduction::ALL.iter().map(|reduction| reduction.name());
    let names: Vec<&str> = text.split('+').map(str::trim).collect();
    let alone = names.len() == 1 && ["none", AUTO].contains(&names[0]);
    let once = |(index, name): (usize, &&str)| known().any(|known| known == *name) && !names[..index].contains(name);
    if alone || names.iter().enumerate().all(once) {
        return Ok(names.join("+"));
    }
    let known: Vec<&str> = known().collect();
    Err(format!(
        "must be none, {AUTO}, or one or more of {} joined by +, each once",
        known.join(", ")
    ))
}

/// A sweep of a study by its name.
fn sweep(text: &str) -> Result<Sweep, String> {
    let found = Sweep::CHOICE.into_iter().find(|sweep| sweep.name() == text.trim());
    found.ok_or_else(|| format!("must be one of {}", Sweep::CHOICE.map(Sweep::name).join(", ")))
}

/// A number above zero.
fn above_zero(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a number above 0".to_owned()),
    }
}

/// A spectral radius, –.
fn spectral_radius(text: &str) -> Result<f64, String> {
    match text.trim().parse() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("must be a number from 0 to 1".to_owned()),
    }
}

/// What was typed, or the default where nothing was.
fn or<T: Clone>(typed: Vec<T>, default: &[T]) -> Vec<T> {
    if typed.is_empty() { default.to_vec() } else { typed }
}

/// What `stability` does, at the end of its help.
fn stability_help() -> String {
    format!(
        "Every case is run as one system, in process with every coupling algorithm, and with the automatic choice through FMUs.\n\n\
         Status: {STATUS_RULE}.\n\n\
         References: a coupled run is compared with the monolithic one at the same micro step, the monolithic one with itself at half the micro \
         step. The monolithic one is also limit where the time integration made more than 1 % of the energy \
         exchanged; a coupled one is at most limit where the monolithic one is. A run that is not stable is repeated with other \
         values of what makes it hard, or with its step halved up to three times: where it becomes stable is its boundary.\n\n\
         Without --cases and --quick the boundaries are mapped by bisection: macro step against contact stiffness, head mass and \
         speed, micro step against contact stiffness.\n\n\
         Runs are made side by side, one per core: they have no wall times, and the table is the same for any number of cores."
    )
}

/// What `reproduce` does, at the end of its help.
fn reproduce_help() -> String {
    "thesis: S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois at Chicago, \
     2016.\n\n\
     Runs: the four published cases as their scenes have them, the first one through FMUs too; all four on meshes of 18, 36 and 72 \
     elements per span and on a converged one; and every quantity that the thesis leaves open over its plausible range, one at a \
     time, on the thesis' mesh and, where it can matter there, on the converged one. Nothing is tuned to a published value. `--set` \
     holds for all runs.\n\n\
     Runs are made side by side, one per core: their wall times are no measure of speed. reproduction.csv is written after every \
     run; rows without a status have not been run. Behind the runs it says what they are worth: a row of group `relation` for each \
     published change on each mesh, published and computed, and whether it holds; a row of group `spread` for each open quantity on each \
     mesh, its smallest and largest standard deviation and whether the published one lies inside."
        .to_owned()
}

/// What `reproduce` knows.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Publication {
    /// Kulkarni 2016
    Thesis,
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
    command::keep_stdout();
    isolation::this_program_serves();
    fmi2::import::guard::install(fmi2::import::guard::Report::Sentence);
    let command = command.unwrap_or(Command::Run {
        scene: DEFAULT_SCENE.into(),
        mode: ModeArgument::Cosimulation,
    });
    let result = match command {
        Command::Run { scene, mode } => command::run::run(&scene, mode.into(), &common),
        Command::Compare {
            scene,
            test_problem: _,
            macro_steps,
            repeats,
        } => {
            let repeats = repeats.into();
            match scene {
                Some(scene) => {
                    command::compare::compare(&scene, &or(macro_steps, &compare::MACRO_STEPS), repeats, &common)
                }
                None => command::compare::test_problem(&or(macro_steps, &compare::TRIAL_STEPS), repeats, &common),
            }
        }
        Command::Study {
            scene,
            elements,
            micro_steps,
            macro_steps,
            rho_inf,
            reductions,
            repeats,
            quick,
            reference_tolerance,
            reference_work,
            spans,
            window_spans,
            sweeps,
        } => {
            let flags = [
                ("--elements", Sweep::Mesh, !elements.is_empty()),
                ("--micro-steps", Sweep::MicroStep, !micro_steps.is_empty()),
                ("--macro-steps", Sweep::Coupling, !macro_steps.is_empty()),
                ("--rho-inf", Sweep::RhoInf, !rho_inf.is_empty()),
                ("--reductions", Sweep::Reductions, !reductions.is_empty()),
                ("--spans", Sweep::Spans, !spans.is_empty()),
                ("--window-spans", Sweep::Spans, !window_spans.is_empty()),
            ];
            let checked = command::study::check_flags(&sweeps, &flags);
            let options = Options {
                elements: or(
                    elements,
                    if quick {
                        &Options::QUICK_ELEMENTS
                    } else {
                        &Options::ELEMENTS
                    },
                ),
                micro_steps: or(
                    micro_steps,
                    if quick {
                        &Options::QUICK_MICRO_STEPS
                    } else {
                        &Options::MICRO_STEPS
                    },
                ),
                macro_steps: or(macro_steps, &Options::MACRO_STEPS),
                rho_inf: or(rho_inf, if quick { &[] } else { &Options::RHO_INF }),
                reductions,
                repeats: repeats.into(),
                quick,
                tolerance: reference_tolerance,
                work: reference_work,
                spans,
                window_spans,
                sweeps,
            };
            checked.and_then(|()| command::study::study(&scene, options, &common))
        }
        Command::Reproduce {
            what: Publication::Thesis,
            quick,
        } => command::reproduce::thesis(quick, &common),
        Command::Stability { cases, quick } => command::stability::stability(&cases, quick, &common),
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
            eprintln!("error: {}", cosim::chain(&error));
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
                said.contains("none, auto, or one or more of planar, linearised, flat, window, linkage"),
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
        for name in ["run", "compare", "study", "check", "reproduce"] {
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
